//! `periplus run`: a whole run without a terminal.

use super::ending::{self, BOTH_WAYS, Kept, Told};
use super::{CommandError, glue, real, world};
use crate::cli::{ArgumentError, RunArgs};
use crate::export::body;
use crate::journal::{Header, Journal};
use crate::mapping::map::Phase;
use crate::runtime::{Driven, OutputFolder, Runner, Signals, drive};

/// Maps, writes every result and gives the exit status.
///
/// # Errors
/// When arguments or input are wrong, before anything is written.
pub fn run(args: RunArgs) -> Result<u8, CommandError> {
    map(args, Told::Ending)
}

fn map(args: RunArgs, told: Told) -> Result<u8, CommandError> {
    let (common, places) = args.common.with_config()?;
    let until = args.until.or(places.until);
    if common.mapping.tape.is_some() && until == Some(Phase::Boundary) {
        let why =
            "until: shape at least with --tape, which is laid on walls, and they are fitted then";
        return Err(CommandError::Input(why.to_owned()));
    }
    let keeping = &common.keeping;
    let out = keeping.resume.clone().or(keeping.out.clone());
    let out = out.ok_or_else(|| missing(told, "--out DIR"))?;
    if let Some(address) = real::address(&args.robot, places.port)? {
        super::tell_unused(&common);
        return real::run(&address, &common, until, &out, told);
    }
    super::only_real(keeping.resume.as_deref())?;
    let world = args.robot.world.or(places.world);
    let world = world.ok_or_else(|| missing(told, "--world FILE or --port DEVICE"))?;
    OutputFolder::refuse_taken(&out)?;
    let world = world::load(&world, &common)?;
    let noise = common.robot.noise.unwrap_or_default();
    let header = Header {
        settings: common.settings(world.start, common.body()?),
        source: world.name.clone(),
        noise: noise.to_string(),
        until,
        robot: None,
    };

    let (folder, file) = OutputFolder::create(&out)?;
    let journal = Journal::begin(file, &header).map_err(|source| {
        folder.discard_unbegun();
        CommandError::Unrecorded { path: folder.journal(), source }
    })?;
    let mut runner = glue::simulated(&world, &header, noise, journal)?;
    let signals = Signals::listen()
        .map_err(|source| CommandError::System { what: "listening for signals", source })?;
    let driven = drive(&mut *runner, &signals);
    finish(&mut *runner, &driven, &folder, told)
}

/// Measures wheels and gyro, writes `chassis.toml` besides the results, tells the figures and gives the exit
/// status.
///
/// # Errors
/// As [`run`].
pub fn calibrate(mut args: RunArgs) -> Result<u8, CommandError> {
    // A settings file may say as much as the flags.
    let (asked, places) = args.common.clone().with_config()?;
    if asked.mapping.laps.is_some_and(|laps| laps < BOTH_WAYS) {
        let why = "laps: two at least, one way round and the other, or nothing is measured";
        return Err(CommandError::Input(why.to_owned()));
    }
    args.until = args.until.or(places.until);
    // One that goes on does so as it was begun.
    if asked.keeping.resume.is_none() {
        args.common.mapping.laps = asked.mapping.laps.or(Some(BOTH_WAYS));
        args.until = args.until.or(Some(Phase::Shape));
    }
    if args.until == Some(Phase::Boundary) {
        let why =
            "until: shape at least, for the laps are laid on the walls, or nothing is measured";
        return Err(CommandError::Input(why.to_owned()));
    }
    map(args, Told::Measured)
}

/// Writes what is known, however the run ended.
fn finish(
    runner: &mut dyn Runner,
    driven: &Driven,
    folder: &OutputFolder,
    told: Told,
) -> Result<u8, CommandError> {
    let recorded = runner.finish_journal();
    let record = runner.record(&driven.ending, driven.wall_seconds);
    let kept = Kept::unless(folder.complaint(recorded, &folder.write_results(&record)));
    let mut status = kept.status(driven.status());
    ending::print_squared(&record)?;
    ending::print_unreached(&record)?;
    if told == Told::Measured {
        status = status.max(ending::print_measured(body::figures(&record), folder)?);
    }
    ending::print(&driven.ending, folder, &kept)?;
    Ok(status)
}

fn missing(told: Told, flag: &'static str) -> ArgumentError {
    let command = match told {
        Told::Ending => "run",
        Told::Measured => "calibrate",
    };
    ArgumentError::Missing { command, flag }
}
