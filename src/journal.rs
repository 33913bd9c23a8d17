//! The record of a run: append-only text, one record a line, each with a checksum, so that a
//! crash costs at most the last line and any text tool can look inside. It knows the vocabulary
//! of robot and core, and nothing of where the bytes go.
//!
//! ```text
//! periplus-journal 1 {"settings":{...},"source":"L-shaped room",...} 9c1d2a07
//! 0 0 i {"intent":"run"} 5a3f0c11
//! 1 20000 r [20000,12,12,0.0001,0,0] 77e0be02
//! ```
//! A line holds: sequence number from 0, robot time in microseconds, a letter for the kind, the
//! payload as JSON, and the CRC-32 of everything before the last space, in hexadecimal. Kinds:
//! `c` command, `t` telemetry, `r` telemetry that is a periodic report (as a list: time,
//! left ticks, right ticks, heading, closed switches, bumper), `i` intent, `e` event, `p` end of
//! a phase with a hash of the state, `l` another life of the robot.

pub mod hash;
pub mod reader;
pub mod writer;

pub use hash::state_hash;
pub use reader::{JournalError, Recording, Torn, read, read_open, read_whole_part};
pub use writer::Journal;

use crate::mapping::event::Event;
use crate::mapping::map::Phase;
use crate::mapping::settings::Settings;
use crate::robot::{Command, Intent, Odometer, Telemetry};
use serde::{Deserialize, Serialize};

/// The version of the format that this program writes, and the newest that it reads.
pub const VERSION: u32 = 1;

/// First word of every journal.
const MAGIC: &str = "periplus-journal";

/// Whether this is all that there is of a record whose header was never written whole: nothing of a run
/// is lost with it.
#[must_use]
pub fn is_unbegun(bytes: &[u8]) -> bool {
    let magic = MAGIC.as_bytes();
    !bytes.contains(&b'\n') && (magic.starts_with(bytes) || bytes.starts_with(magic))
}

/// What a run was started with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// The settings, with α as it was at the start.
    pub settings: Settings,
    /// Name of the world or of the port.
    pub source: String,
    /// Name of the noise profile; empty for a real robot.
    #[serde(default)]
    pub noise: String,
    /// Phase whose end completes the run; none for all of them.
    #[serde(default)]
    pub until: Option<Phase>,
    /// Which robot it was, when it was a real one: only that one can go on with the run.
    #[serde(default)]
    pub robot: Option<RobotMark>,
}

/// Tells one life of one robot from all others.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RobotMark {
    /// What it calls itself.
    pub name: String,
    /// Another number after every start of the robot.
    pub boot: u32,
}

/// A life of the robot after the one that the header names: it was started again within the run, or before
/// the run was taken up again, and the run has been told that it was carried.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Life {
    /// Another number after every start of the robot.
    pub boot: u32,
    /// What is added to all that it counts in this life, for the run to go on counting where it was.
    pub beyond: Odometer,
}

/// One line of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Robot time, microseconds.
    pub time_us: u64,
    /// What happened.
    pub entry: Entry,
}

/// What can happen in a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Entry {
    /// The host sent a command.
    Command(Command),
    /// The robot said something.
    Telemetry(Telemetry),
    /// The operator wished something.
    Intent(Intent),
    /// The core told something.
    Event(Event),
    /// A phase ended.
    PhaseEnd(PhaseEnd),
    /// The robot is in another life.
    Life(Life),
}

/// The end of a phase: a place where a replay can be held against the record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct PhaseEnd {
    /// Which phase.
    pub phase: Phase,
    /// [`state_hash`] of the map at that instant.
    pub state: u64,
}

#[cfg(test)]
mod tests;
