//! Where the commands meet the simulator, the session and the console. The functions here are the
//! whole of that meeting; everything else in [`super`] is written against them.

use super::CommandError;
use crate::cli::{ArgumentError, Common, FrameFormat, FrameSize, Noise, SnapshotArgs};
use crate::geometry::Pose;
use crate::journal::{Header, Journal, Recording};
use crate::robot::Chassis;
use crate::runtime::Runner;
use std::fs::File;
use std::path::Path;

/// A world that was read and found good.
#[derive(Debug)]
pub struct World {
    name: String,
    start: Pose,
    extent: (f64, f64),
}

impl World {
    /// What it is called.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where the robot stands at the beginning.
    #[must_use]
    pub fn start(&self) -> Pose {
        self.start
    }

    /// Extent of the room in x and y, metres.
    #[must_use]
    pub fn extent(&self) -> (f64, f64) {
        self.extent
    }

    /// Whether the body of `chassis` fits at `start`.
    ///
    /// # Errors
    /// Says what is in its way.
    pub fn can_start_at(&self, _start: Pose, _chassis: &Chassis) -> Result<(), String> {
        Ok(())
    }
}

/// Reads a world.
///
/// # Errors
/// Says what is wrong, with file, line and key.
pub fn world(path: &Path) -> Result<World, String> {
    Err(format!(
        "{}: this version has no simulator to read worlds for",
        path.display()
    ))
}

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
    _world: World,
    _header: Header,
    _noise: Noise,
    _journal: Journal<File>,
) -> Result<Box<dyn Runner>, CommandError> {
    Err(absent("`periplus run`"))
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
