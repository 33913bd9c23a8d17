//! What the host's end of the line tells the rest of the program: who the robot is, whether it is
//! there, what it said.

use crate::robot::{Chassis, CommandId, SensorMount, Telemetry, Unfit};

/// Whether the robot is there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Health {
    /// It has not said yet who it is.
    Opening,
    /// It is there.
    Up,
    /// It told nothing of itself for half a second.
    Stale,
    /// It is gone; nothing is sent but the question whether it is back.
    Lost(Loss),
}

/// Why a link is lost.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Loss {
    /// Nobody answered when the port was opened.
    #[error(
        "no answer from the robot: is it switched on, does another program hold it, and, on a serial line, is \
         the baud rate right (--baud)?"
    )]
    NoAnswer,
    /// Something is said, and none of it in this protocol.
    #[error(
        "something answers, but not in this protocol: it says \"{0}\"; is the baud rate right (--baud), \
         and is the robot at this port?"
    )]
    Foreign(Sample),
    /// It speaks, but never said all that `H` asks for.
    #[error(
        "the robot answers, but does not introduce itself with h, c and every s; see `periplus protocol`"
    )]
    Unintroduced,
    /// It speaks another version of the protocol.
    #[error("the robot speaks another version of the protocol")]
    Version,
    /// It says that it has a body that no robot can have.
    #[error("the robot says that it has a body which it cannot have: {0}; see `periplus protocol`")]
    Unfit(Unfit),
    /// It would not stop by itself.
    #[error(
        "the robot says that it drives on for {} s after its host falls silent (its watchdog); see `periplus \
         protocol`", .0 / 1000
    )]
    Patient(u32),
    /// Nothing was heard for too long.
    #[error("nothing heard from the robot for 1.5 s")]
    Silent,
    /// It answers, and tells nothing of itself.
    #[error("the robot answers, but has sent no report for 1.5 s")]
    Mute,
    /// A command was not acknowledged.
    #[error("the robot does not acknowledge commands")]
    Unacknowledged,
    /// A motion never ended.
    #[error("a motion did not end although its time was up")]
    Endless,
    /// The port is gone.
    #[error("the port was closed or unplugged")]
    Unplugged,
}

/// The first bytes of what was heard, fit to be shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Sample {
    bytes: [u8; Self::LENGTH],
    count: usize,
}

impl Sample {
    const LENGTH: usize = 24;

    /// Adds what was heard next; only the first of it is kept.
    pub(super) fn add(&mut self, bytes: &[u8]) {
        let rest = &mut self.bytes[self.count..];
        let count = rest.len().min(bytes.len());
        rest[..count].copy_from_slice(&bytes[..count]);
        self.count += count;
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }
}

/// Printable ASCII as it is, everything else in hexadecimal: nothing of it can steer a terminal.
impl std::fmt::Display for Sample {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for &byte in &self.bytes[..self.count] {
            match byte {
                b'"' | b'\\' | 0..=31 | 127.. => write!(f, "\\x{byte:02X}")?,
                _ => write!(f, "{}", char::from(byte))?,
            }
        }
        if self.count == Self::LENGTH { f.write_str("…") } else { Ok(()) }
    }
}

/// Who the robot is.
#[derive(Debug, Clone, PartialEq)]
pub struct Identity {
    /// Its name.
    pub name: String,
    /// Another one after every start.
    pub boot: u32,
    /// Its body with its switches.
    pub chassis: Chassis,
}

/// What the host learns from the line.
#[derive(Debug, Clone, PartialEq)]
pub enum Heard {
    /// The robot said who it is, for the first time or again.
    Hello(Box<Identity>),
    /// It is another robot than before, or it was started again: ticks count from elsewhere.
    Rebooted,
    /// In the same life its numbers have begun anew, with another host or without: what it did and told
    /// meanwhile is not known.
    Forgotten,
    /// Telemetry, in order and each once.
    Telemetry(Telemetry),
    /// A message that was made later than it came: the robot's clock cannot be right.
    Early {
        /// Seconds of robot time by which it went on too far.
        seconds: f64,
        /// The motion that it was the end of.
        ended: Option<CommandId>,
    },
    /// It waits for its host for so many seconds before it stops by itself, and is no simulated one whose time
    /// goes as much faster.
    Patient(f64),
    /// The link is better or worse than before.
    Health(Health),
    /// A command was refused, in the robot's words.
    Refused(CommandId, String),
    /// A command that was not acknowledged before a stop was never begun.
    NotBegun(CommandId),
    /// Nothing was heard of the robot for so long while it moved that it was stopped.
    Blinded,
}

/// Who the robot is, as far as it has said.
#[derive(Debug, Clone, Default)]
pub(super) struct Introduction {
    pub(super) hello: Option<(u32, usize, String)>,
    /// How long the robot waits for its host, milliseconds.
    pub(super) watchdog: u32,
    pub(super) body: Option<Chassis>,
    pub(super) switches: Vec<Option<SensorMount>>,
}

impl Introduction {
    pub(super) fn complete(&self) -> Option<Identity> {
        let (boot, count, name) = self.hello.clone()?;
        let sensors: Option<Vec<SensorMount>> =
            (0..count).map(|index| self.switches.get(index).cloned().flatten()).collect();
        Some(Identity { name, boot, chassis: Chassis { sensors: sensors?, ..self.body.clone()? } })
    }
}
