//! `periplus export`: hands over one result of a run under another name; of one under way as
//! well, made from its record.

use super::{CommandError, glue, output};
use crate::cli::{ExportArgs, ExportFormat};
use crate::export::native::MapFile;
use crate::export::{RunRecord, geojson, png, ros, svg};
use crate::runtime::folder::{self, write_whole};
use crate::runtime::recorded::Rebuilt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Writes the result that was asked for.
///
/// # Errors
/// When the folder holds no such result, or the file cannot be written.
pub fn export(args: &ExportArgs) -> Result<u8, CommandError> {
    let name = match args.format {
        ExportFormat::Geojson => "map.geojson",
        ExportFormat::Json => "map.json",
        ExportFormat::Svg => "map.svg",
        ExportFormat::Png => "map.png",
        ExportFormat::Ros => return ros(args),
    };
    if is_standard_output(&args.out) {
        output::print_bytes(&result(args, name)?.bytes)?;
        return Ok(0);
    }
    spare_results(&args.dir, &args.out)?;
    let Found { bytes, .. } = result(args, name)?;
    spare_others(args, &args.out)?;
    write_whole(&args.out, &bytes)?;
    Ok(0)
}

/// A YAML file, and its picture beside it.
fn ros(args: &ExportArgs) -> Result<u8, CommandError> {
    let (yaml, picture) = (&args.out, args.out.with_extension("pgm"));
    let refused = |why: String| Err(CommandError::Input(format!("{}: {why}", yaml.display())));
    let writes = "--format ros writes a YAML file and its picture beside it; name the YAML file";
    if is_standard_output(yaml) || folder::is_device(yaml) {
        return refused(format!("{writes}, for example map.yaml"));
    }
    if picture == *yaml {
        let example = yaml.with_extension("yaml");
        return refused(format!("{writes}, for example {}", example.display()));
    }
    if folder::is_device(&picture) {
        return refused(format!("{} is in the way of its picture", picture.display()));
    }
    // Found out by writing, it would leave half of a pair.
    if let Some(there) = [yaml, &picture].into_iter().find(|file| file.is_dir()) {
        let why = "there is a folder of that name; name another file";
        return Err(CommandError::Input(format!("{}: {why}", there.display())));
    }
    spare_results(&args.dir, yaml)?;
    spare_results(&args.dir, &picture)?;
    let Found { bytes, from } = result(args, "map.json")?;
    let unfit =
        |error: &dyn std::error::Error| CommandError::Input(format!("{}: {error}", from.display()));
    let map = MapFile::parse(&String::from_utf8_lossy(&bytes)).map_err(|error| unfit(&error))?;
    let name = picture.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let files = ros::write(&map, &name).map_err(|error| unfit(&error))?;
    spare_others(args, yaml)?;
    spare_others(args, &picture)?;
    write_whole(&picture, &files.pgm)?;
    write_whole(yaml, files.yaml.as_bytes())?;
    Ok(0)
}

/// Whether `out` is what a shell calls standard output.
fn is_standard_output(out: &Path) -> bool {
    ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].iter().any(|name| out == Path::new(name))
}

/// Refuses to write over what a run left, be it this run or another.
fn spare_results(dir: &Path, out: &Path) -> Result<(), CommandError> {
    // What a link leads to is what would be lost.
    let whole = std::fs::canonicalize(out).unwrap_or_else(|_error| out.to_owned());
    let place = |path: &Path| {
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        let parent = parent.map_or_else(|| PathBuf::from("."), Path::to_owned);
        std::fs::canonicalize(&parent).unwrap_or(parent)
    };
    let folder = place(&whole);
    let is_result =
        whole.file_name().is_some_and(|name| folder::RESULTS.iter().any(|r| name == *r));
    let holds_run = folder::MARKS.iter().any(|mark| folder.join(mark).exists())
        || std::fs::canonicalize(dir).is_ok_and(|dir| dir == folder);
    if is_result && holds_run {
        return Err(CommandError::Input(format!(
            "--out {}: that file belongs to the run in {}; name another one",
            out.display(),
            folder.display()
        )));
    }
    Ok(())
}

/// Refuses to write over a file that is there, unless that is what was asked for. An empty one is no loss,
/// and what is no file is never replaced.
fn spare_others(args: &ExportArgs, out: &Path) -> Result<(), CommandError> {
    let there = std::fs::metadata(out);
    if args.force || !there.is_ok_and(|data| data.is_file() && data.len() > 0) {
        return Ok(());
    }
    let why = "is there already; name another file, or write over it with --force";
    Err(CommandError::Input(format!("{}: {why}", out.display())))
}

/// One result of a run.
struct Found {
    bytes: Vec<u8>,
    /// The file that it is, or that it was made from.
    from: PathBuf,
}

/// One result of the run.
fn result(args: &ExportArgs, name: &str) -> Result<Found, CommandError> {
    let path = args.dir.join(name);
    let refused = |what: &str| {
        let hint = why_missing(&args.dir);
        Err(CommandError::Input(format!("{}: {what}; {hint}", path.display())))
    };
    match std::fs::read(&path) {
        Ok(bytes) if bytes.is_empty() => refused("the file is empty"),
        Ok(bytes) if name.ends_with("json") && !is_json(&bytes) => refused("the file is damaged"),
        Ok(bytes) if went_on_after(&args.dir, &path) => newest(&args.dir, name, bytes),
        Ok(bytes) => Ok(Found { bytes, from: path }),
        Err(error) if error.kind() == ErrorKind::NotFound => match rebuilt(&args.dir)? {
            Some(Made { run, .. }) => {
                output::say(
                    "periplus: there are no results of the run yet; this is made from its record",
                );
                Ok(Found { bytes: of(&run.record(), name)?, from: args.dir.join("journal") })
            }
            None => refused(&error.to_string()),
        },
        Err(error) => refused(&error.to_string()),
    }
}

/// The `bytes` of a result that is older than the record, unless the run went on since: then the same made from
/// the record. Who copies a folder gives its files another age, so it is asked what the record makes.
fn newest(dir: &Path, name: &str, bytes: Vec<u8>) -> Result<Found, CommandError> {
    let why = match rebuilt(dir) {
        // What is whole of a damaged record says nothing of a run that it ends before.
        Ok(Some(Made { run, damaged: true })) if !is_longer(&run.record(), dir) => {
            ", of which no more than the result tells is whole".to_owned()
        }
        Ok(Some(Made { run, .. })) => {
            let record = run.record();
            let reason = why_stopped(dir);
            let told = reason.as_deref().and_then(|reason| run.stopped_because(reason));
            for record in std::iter::once(&record).chain(&told) {
                if is_made_of(record, dir, name, &bytes)? {
                    return Ok(Found { bytes, from: dir.join(name) });
                }
            }
            output::say(
                "periplus: the run went on after its results were written; this is made from its record",
            );
            return Ok(Found { bytes: of(&record, name)?, from: dir.join("journal") });
        }
        Ok(None) => ", which cannot be used".to_owned(),
        Err(error) => format!(", which cannot be used ({error})"),
    };
    output::say(&format!(
        "periplus: {} is older than the record of its run{why}",
        dir.join(name).display()
    ));
    Ok(Found { bytes, from: dir.join(name) })
}

/// Whether the `bytes` of a result are what `record` makes of it, but for what only a simulator knows.
fn is_made_of(
    record: &RunRecord<'_>,
    dir: &Path,
    name: &str,
    bytes: &[u8],
) -> Result<bool, CommandError> {
    let anew = of(record, name)?;
    if anew == bytes {
        return Ok(true);
    }
    if name != "map.geojson" || besides_paths(&anew) != besides_paths(bytes) {
        return Ok(false);
    }
    let drawn = of(record, "map.svg")?;
    Ok(std::fs::read(dir.join("map.svg")).is_ok_and(|there| there == drawn))
}

/// Why a run was stopped, as its results have it: that a signal came, or its operator left, is in no record.
fn why_stopped(dir: &Path) -> Option<String> {
    let report = report(dir)?;
    let reason = report.get("reason")?.as_str()?;
    (report.get("outcome")? == "stopped").then(|| reason.to_owned())
}

/// The report of the run, where there is one.
fn report(dir: &Path) -> Option<serde_json::Value> {
    let text = std::fs::read_to_string(dir.join("report.json")).ok()?;
    serde_json::from_str(&text).ok()
}

/// Whether `record` tells of more of its run than the results in `dir` do: of more seconds.
fn is_longer(record: &RunRecord<'_>, dir: &Path) -> bool {
    let told = report(dir).and_then(|report| {
        let seconds = |phase: &serde_json::Value| phase.get("simulated_s")?.as_f64();
        report.get("phases")?.as_array()?.iter().map(seconds).sum::<Option<f64>>()
    });
    let whole: f64 = record.progress.iter().map(|phase| phase.seconds).sum();
    // A report counts in milliseconds.
    told.is_none_or(|told| whole > told + 0.01)
}

/// The lines of a `map.geojson` but for the trajectories, which have the vertices of the true one where a
/// simulator told it, as a record never does; a picture shows them all the same.
fn besides_paths(bytes: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(bytes);
    let is_path = |line: &&str| line.contains("\"role\":\"path\"") || line.contains("true_path");
    let lines = text.lines().filter(|line| !is_path(line));
    lines.map(|line| line.trim_end_matches(',').to_owned()).collect()
}

/// Whether the record of the run was written to after `result` was: a run that was taken up again, or went on after
/// an export of the console, leaves what it had then until it ends.
fn went_on_after(dir: &Path, result: &Path) -> bool {
    let written = |path: &Path| std::fs::metadata(path).and_then(|data| data.modified()).ok();
    written(&dir.join("journal")).zip(written(result)).is_some_and(|(record, of)| record > of)
}

/// A run, made once more from its record.
struct Made {
    run: Rebuilt,
    /// Whether something is left out of the record, and not at its end.
    damaged: bool,
}

/// What the record says of a run that has not left its results, because it was killed or goes on; none where there
/// is no record of anything.
fn rebuilt(dir: &Path) -> Result<Option<Made>, CommandError> {
    if !dir.join("journal").exists() {
        return Ok(None);
    }
    let Ok(recording) = crate::journal::read_whole_part(dir) else { return Ok(None) };
    // The last line of a run that goes on is not whole as a rule.
    let damaged = recording.torn.is_some_and(|torn| torn.damaged);
    if damaged {
        glue::warn_torn(&recording);
    }
    let run = Rebuilt::of(recording).map_err(|difference| {
        let why = format!("the record plays back another way than the run went: {difference}");
        CommandError::Input(format!("{}: {why}", dir.display()))
    })?;
    Ok(Some(Made { run, damaged }))
}

/// The bytes of one result, made from the record.
fn of(record: &RunRecord<'_>, name: &str) -> Result<Vec<u8>, CommandError> {
    let drawing = || svg::write(record, &svg::Options::default());
    Ok(match name {
        "map.geojson" => geojson::write(record).into_bytes(),
        "map.json" => MapFile::of(record).write().into_bytes(),
        "map.png" => png::render(&drawing(), png::WIDTH)
            .map_err(|error| CommandError::Input(format!("{name}: cannot be made: {error}")))?,
        _ => drawing().into_bytes(),
    })
}

fn is_json(bytes: &[u8]) -> bool {
    serde_json::from_slice::<serde::de::IgnoredAny>(bytes).is_ok()
}

/// What to do about a result that is not there or not whole.
fn why_missing(dir: &Path) -> String {
    if !dir.join("journal").exists() {
        return "name the --out folder of a run".to_owned();
    }
    match crate::journal::read_whole_part(dir) {
        Ok(_) => "remove it, and it is made again from the record of the run".to_owned(),
        Err(error) => format!("and the record of the run cannot be read: {error}"),
    }
}
