//! What each command does: it brings the command line, the files and the running parts together.
//! Every failure becomes one message on standard error and an exit status; nothing here maps,
//! draws or parses by itself.

pub mod check;
pub mod ending;
pub mod error;
pub mod export;
pub mod glue;
pub mod output;
pub mod real;
pub mod run;
pub mod world;

pub use error::CommandError;

use crate::cli::{
    Cli, Command, Common, ConsoleArgs, FrameSize, ReplayArgs, ScreenFlags, SnapshotArgs,
};
use crate::console::layout::{MIN_COLS, MIN_ROWS, Regions};
use std::ffi::OsStr;
use std::io::IsTerminal;
use std::path::Path;

/// Does what the command line says and gives the exit status.
#[must_use]
pub fn dispatch(cli: Cli) -> u8 {
    // Where it cannot be had, long files end the program as they always did.
    let _ = crate::runtime::Signals::outlive_long_files();
    let result = match cli.command {
        None => console(cli.console),
        Some(Command::Console(args)) => console(args),
        Some(Command::Run(args)) => run::run(args),
        Some(Command::Calibrate(args)) => run::calibrate(args),
        Some(Command::Replay(args)) => replay(&args),
        Some(Command::Snapshot(args)) => snapshot(&args),
        Some(Command::Export(args)) => export::export(&args),
        Some(Command::Check(args)) => check::check(&args),
        Some(Command::Robot(args)) => real::robot(&args),
        Some(Command::Ports) => real::ports(),
        Some(Command::Protocol) => output::print(crate::wire::PROTOCOL).map(|()| 0),
    };
    status(result)
}

/// Gives the parser's answer to a command line that it does not hand on, and the exit status: help and version
/// are results, a complaint is talk.
#[must_use]
pub fn answer(answer: &clap::Error) -> u8 {
    if answer.use_stderr() {
        // That nobody listens changes nothing.
        let _ = answer.print();
        return answer.exit_code() as u8;
    }
    status(output::printed(answer.print()).map(|()| 0))
}

/// The exit status of a command; why it could not be done is told.
fn status(result: Result<u8, CommandError>) -> u8 {
    match result {
        Ok(status) => status,
        Err(CommandError::ReaderGone) => 0,
        Err(error) => {
            output::say(&format!("periplus: {error}"));
            error.status()
        }
    }
}

fn console(args: ConsoleArgs) -> Result<u8, CommandError> {
    let (common, places) = args.common.with_config()?;
    let (keys, theme) = (args.screen.keymap.or(places.keymap), args.screen.theme.or(places.theme));
    let screen = ScreenFlags { keymap: keys, theme };
    needs_terminal()?;
    if let Some(address) = real::address(&args.robot, places.port)? {
        tell_unused(&common);
        return real::console(&address, glue::options(&screen)?, &common);
    }
    only_real(common.keeping.resume.as_deref())?;
    let world = args.robot.world.or(places.world);
    glue::console(world.as_deref(), &screen, &common)
}

/// Says that a real robot's body is what it says itself.
fn tell_unused(common: &Common) {
    if common.robot.chassis.is_some() {
        output::say(
            "periplus: --chassis is not used with --port: a robot says itself what its body is; put the \
             figures of the file into the robot",
        );
    }
}

fn replay(args: &ReplayArgs) -> Result<u8, CommandError> {
    let recording = crate::journal::read_whole_part(&args.dir)?;
    needs_terminal()?;
    glue::replay(recording, &args.screen)
}

fn snapshot(args: &SnapshotArgs) -> Result<u8, CommandError> {
    let FrameSize { columns, rows } = args.size;
    if Regions::of(columns, rows).is_none() {
        let why = format!("--size {columns}x{rows}: a frame needs {MIN_COLS}x{MIN_ROWS} at least");
        return Err(CommandError::Input(why));
    }
    let (mapping, robot) = (args.mapping.clone(), args.robot.clone());
    let (common, _) = Common { mapping, robot, ..Common::default() }.with_config()?;
    let frame = match (&args.replay, args.at) {
        (Some(dir), Some(at)) => {
            let recording = crate::journal::read_whole_part(dir)?;
            glue::snapshot_of_record(recording, at, args.size, args.format)?
        }
        _ => glue::snapshot_of_world(args, &common)?,
    };
    output::print(&frame)?;
    Ok(0)
}

/// Only a real robot goes on living when its host is gone.
fn only_real(resume: Option<&Path>) -> Result<(), CommandError> {
    let Some(dir) = resume else { return Ok(()) };
    let header = crate::journal::read(dir).map(|recording| recording.header);
    let why = match header {
        Ok(header) if header.robot.is_some() => {
            "that run goes on with the robot that it was begun with: give its --port".to_owned()
        }
        Ok(header) => format!(
            "that run was made in the simulator and cannot be gone on with; it is made again by its \
             seed: `periplus run --world FILE --seed {} --out DIR`, with the other flags as they were",
            header.settings.seed
        ),
        Err(error) => {
            let why = "takes the folder of a run of a real robot, and --port; a simulated run is made \
                       again by its seed";
            return Err(CommandError::Input(format!("{error}; --resume {why}")));
        }
    };
    Err(CommandError::Input(format!("--resume {}: {why}", dir.display())))
}

/// Whether a terminal of this name has a screen to draw on.
fn draws(term: &OsStr) -> bool {
    !term.is_empty() && term != "dumb"
}

/// The console needs a terminal both ways.
fn needs_terminal() -> Result<(), CommandError> {
    // One that says it is dumb, or nothing, cannot place a character.
    let draws = !cfg!(unix) || std::env::var_os("TERM").is_some_and(|term| draws(&term));
    if std::io::stdin().is_terminal() && std::io::stdout().is_terminal() && draws {
        Ok(())
    } else {
        Err(CommandError::NoTerminal)
    }
}
