//! What the host's end of the line tells the rest of the program: who the robot is, whether it is
//! there, what it said.

use crate::robot::{Chassis, CommandId, SensorMount, Telemetry};

/// Whether the robot is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Health {
    /// It has not said yet who it is.
    Opening,
    /// It is there.
    Up,
    /// Nothing was heard for half a second.
    Stale,
    /// It is gone; nothing is sent but the question whether it is back.
    Lost(Loss),
}

/// Why a link is lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Loss {
    /// Nobody answered when the port was opened.
    #[error("no answer from the robot: is it switched on, and is the baud rate right?")]
    NoAnswer,
    /// It speaks another version of the protocol.
    #[error("the robot speaks another version of the protocol")]
    Version,
    /// Nothing was heard for too long.
    #[error("nothing heard from the robot for 1.5 s")]
    Silent,
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
    /// Telemetry, in order and each once.
    Telemetry(Telemetry),
    /// The link is better or worse than before.
    Health(Health),
    /// A command was refused, in the robot's words.
    Refused(CommandId, String),
    /// A command that was not acknowledged before a stop was never begun.
    NotBegun(CommandId),
}

/// Who the robot is, as far as it has said.
#[derive(Debug, Clone, Default)]
pub(super) struct Introduction {
    pub(super) hello: Option<(u32, usize, String)>,
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
