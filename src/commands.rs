//! What each command does: it brings the command line, the files and the running parts together.
//! Every failure becomes one message on standard error and an exit status; nothing here maps,
//! draws or parses by itself.

pub mod check;
pub mod error;
pub mod export;
pub mod glue;
pub mod output;
pub mod run;
pub mod world;

pub use error::CommandError;

use crate::cli::{ArgumentError, Cli, Command, ConsoleArgs, ReplayArgs, SnapshotArgs};
use std::io::IsTerminal;

/// Does what the command line says and gives the exit status.
#[must_use]
pub fn dispatch(cli: Cli) -> u8 {
    let result = match cli.command {
        None => console(cli.console),
        Some(Command::Console(args)) => console(args),
        Some(Command::Run(args)) => run::run(args),
        Some(Command::Replay(args)) => replay(&args),
        Some(Command::Snapshot(args)) => snapshot(&args),
        Some(Command::Export(args)) => export::export(&args),
        Some(Command::Check(args)) => check::check(&args),
        Some(Command::Robot(_)) => Err(absent(
            "`periplus robot`",
            "the simulated robot runs inside the console and `periplus run` only",
        )),
        Some(Command::Ports) => Err(absent(
            "`periplus ports`",
            "real robots cannot be driven yet, so no port is looked at",
        )),
    };
    match result {
        Ok(status) => status,
        Err(CommandError::ReaderGone) => 0,
        Err(error) => {
            output::say(&format!("periplus: {error}"));
            error.status()
        }
    }
}

fn absent(what: &'static str, instead: &'static str) -> CommandError {
    ArgumentError::absent(what, instead).into()
}

fn console(args: ConsoleArgs) -> Result<u8, CommandError> {
    let (common, places) = args.common.with_config()?;
    let world = args.robot.world()?.or(places.world);
    needs_terminal()?;
    glue::console(world.as_deref(), args.keymap.or(places.keymap).as_deref(), &common)
}

fn replay(args: &ReplayArgs) -> Result<u8, CommandError> {
    let recording = crate::journal::read(&args.dir)?;
    needs_terminal()?;
    glue::replay(recording, args.keymap.as_deref())
}

fn snapshot(args: &SnapshotArgs) -> Result<u8, CommandError> {
    let (common, _) = args.common.clone().with_config()?;
    let frame = match (&args.replay, args.at) {
        (Some(dir), Some(at)) => {
            glue::snapshot_of_record(crate::journal::read(dir)?, at, args.size, args.format)?
        }
        _ => glue::snapshot_of_world(args, &common)?,
    };
    output::print(&frame)?;
    Ok(0)
}

/// The console needs a terminal both ways.
fn needs_terminal() -> Result<(), CommandError> {
    if std::io::stdin().is_terminal() && std::io::stdout().is_terminal() {
        Ok(())
    } else {
        Err(CommandError::NoTerminal)
    }
}
