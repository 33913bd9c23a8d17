//! `periplus export`: hands over one result of a finished run under another name.

use super::CommandError;
use crate::cli::{ExportArgs, ExportFormat};
use crate::export::native::MapFile;
use crate::export::ros;
use crate::runtime::folder::write_whole;

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
    write_whole(&args.out, &result(args, name)?)?;
    Ok(0)
}

/// A YAML file, and its picture beside it.
fn ros(args: &ExportArgs) -> Result<u8, CommandError> {
    let text = result(args, "map.json")?;
    let path = args.dir.join("map.json");
    let map = MapFile::parse(&String::from_utf8_lossy(&text))
        .map_err(|error| CommandError::Input(format!("{}: {error}", path.display())))?;
    let picture = args.out.with_extension("pgm");
    if picture == args.out {
        return Err(CommandError::Input(format!(
            "{}: --format ros writes a YAML file and its picture beside it; name the YAML file, \
             for example {}",
            args.out.display(),
            args.out.with_extension("yaml").display()
        )));
    }
    let name = picture.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let Some(files) = ros::write(&map, &name) else {
        return Err(CommandError::Input(format!(
            "{}: the boundary is not closed; a ROS map needs an inside and an outside",
            path.display()
        )));
    };
    write_whole(&picture, &files.pgm)?;
    write_whole(&args.out, files.yaml.as_bytes())?;
    Ok(0)
}

/// The bytes of one result of the run.
fn result(args: &ExportArgs, name: &str) -> Result<Vec<u8>, CommandError> {
    let path = args.dir.join(name);
    std::fs::read(&path).map_err(|error| {
        let hint = if args.dir.join("journal").exists() {
            "the run has not ended there; its record is whole, its results were never written"
        } else {
            "name the --out folder of a finished run"
        };
        CommandError::Input(format!("{}: {error}; {hint}", path.display()))
    })
}
