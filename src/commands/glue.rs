//! Where the commands meet the simulator, the session and the console. The functions here are the
//! whole of that meeting; everything else in [`super`] is written against them.

use super::CommandError;
use crate::cli::{ArgumentError, Common, FrameFormat, FrameSize, SnapshotArgs};
use crate::journal::{Header, Journal, Recording};
use crate::runtime::Runner;
use crate::runtime::simulated::{Headless, SimulatedRun};
use crate::simulator::{NoiseProfile, World};
use std::fs::File;
use std::path::Path;

/// Checks a keymap.
///
/// # Errors
/// Says what is wrong, with file, line and key.
pub fn check_keymap(path: &Path) -> Result<(), String> {
    Err(format!(
        "{}: this version has no console to read keymaps for",
        path.display()
    ))
}

/// A run in the simulator, ready to be driven; it keeps the record.
///
/// # Errors
/// When the simulator refuses the world.
pub fn simulated(
    world: &World,
    header: &Header,
    noise: NoiseProfile,
    journal: Journal<File>,
) -> Result<Box<dyn Runner>, CommandError> {
    let run = SimulatedRun::new(world, header.clone(), noise, Some(journal));
    Ok(Box::new(Headless::new(run)))
}

/// The console on a world, or on the built-in one.
///
/// # Errors
/// When the world or the keymap is wrong, or the terminal cannot be used.
pub fn console(
    _world: Option<&Path>,
    _keymap: Option<&Path>,
    _common: &Common,
) -> Result<u8, CommandError> {
    Err(absent("the console"))
}

/// The console over a record.
///
/// # Errors
/// As [`console`].
pub fn replay(_recording: Recording, _keymap: Option<&Path>) -> Result<u8, CommandError> {
    Err(absent("`periplus replay`"))
}

/// A frame of a record at an instant, in robot seconds.
///
/// # Errors
/// When the record does not reach that instant.
pub fn snapshot_of_record(
    _recording: Recording,
    _at: f64,
    _size: FrameSize,
    _format: FrameFormat,
) -> Result<String, CommandError> {
    Err(absent("`periplus snapshot`"))
}

/// A frame of a world after a phase.
///
/// # Errors
/// When the world is wrong.
pub fn snapshot_of_world(_args: &SnapshotArgs, _common: &Common) -> Result<String, CommandError> {
    Err(absent("`periplus snapshot`"))
}

fn absent(what: &'static str) -> CommandError {
    ArgumentError::absent(what, "session and simulator are not joined yet").into()
}
