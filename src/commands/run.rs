//! `periplus run`: a whole run without a terminal.

use super::{CommandError, glue, output};
use crate::cli::{ArgumentError, RunArgs};
use crate::journal::{Header, Journal};
use crate::runtime::{Driven, OutputFolder, Runner, Signals, drive};
use std::path::Path;

/// Maps, writes every result and gives the exit status.
///
/// # Errors
/// When arguments or input are wrong, before anything is written.
pub fn run(args: RunArgs) -> Result<u8, CommandError> {
    let (common, places) = args.common.with_config()?;
    let until = args.until.or(places.until);
    if places.port.is_some() {
        return Err(ArgumentError::absent("`port`", "give a world instead").into());
    }
    let world = args.robot.world()?.or(places.world);
    let world = world.ok_or_else(|| missing("--world FILE"))?;
    let out = common.out.clone().ok_or_else(|| missing("--out DIR"))?;
    OutputFolder::refuse_taken(&out)?;

    let world = glue::world(&world).map_err(CommandError::Input)?;
    let settings = common.settings(world.start())?;
    alpha_fits(settings.alpha, world.extent())?;
    let noise = common.noise.unwrap_or_default();
    let header = Header {
        settings,
        source: world.name().to_owned(),
        noise: noise.to_string(),
        until,
    };
    world
        .can_start_at(header.settings.start, &header.settings.chassis)
        .map_err(CommandError::Input)?;

    let (folder, file) = OutputFolder::create(&out)?;
    let journal = Journal::begin(file, &header).map_err(|source| CommandError::System {
        what: "the record of the run",
        source,
    })?;
    let mut runner = glue::simulated(world, header, noise, journal)?;
    let signals = Signals::listen().map_err(|source| CommandError::System {
        what: "listening for signals",
        source,
    })?;
    let driven = drive(&mut *runner, &signals);
    finish(&mut *runner, &driven, &folder)
}

/// Writes what is known, however the run ended.
fn finish(
    runner: &mut dyn Runner,
    driven: &Driven,
    folder: &OutputFolder,
) -> Result<u8, CommandError> {
    let mut status = driven.status();
    if let Err(error) = runner.finish_journal() {
        output::say(&format!(
            "periplus: the record of the run is not whole: {error}"
        ));
        status = status.max(1);
    }
    let record = runner.record(&driven.ending, driven.wall_seconds);
    for failure in folder.write_results(&record) {
        output::say(&format!("periplus: {failure}"));
        status = status.max(1);
    }
    let ending = &driven.ending;
    let outcome = format!("{:?}", ending.outcome).to_lowercase();
    output::print(&format!(
        "{outcome}: {}; results in {}\n",
        ending.reason,
        shown(folder.path())
    ))?;
    Ok(status)
}

fn shown(path: &Path) -> String {
    path.display().to_string()
}

fn missing(flag: &'static str) -> ArgumentError {
    ArgumentError::Missing {
        command: "run",
        flag,
    }
}

/// Refuses an α that no line of any plan in this room could be spaced by.
fn alpha_fits(alpha: f64, (width, height): (f64, f64)) -> Result<(), ArgumentError> {
    let limit = width.max(height);
    if alpha > limit {
        return Err(ArgumentError::AlphaTooLarge {
            alpha,
            width,
            height,
            limit,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_must_fit_the_room() {
        assert!(alpha_fits(0.25, (5.0, 4.0)).is_ok());
        let error = alpha_fits(6.0, (5.0, 4.0)).expect_err("six metres in five");
        assert_eq!(
            error.to_string(),
            "α of 6 m is larger than the room (5.00 x 4.00 m): give --alpha a length below 5.00"
        );
    }
}
