//! What the robot reports. This is everything that the mapping core ever learns of the world.

use super::{CommandId, SwitchSet};
use serde::{Deserialize, Serialize};

/// Encoders and gyro at one instant of the robot's own clock.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Odometer {
    /// Robot time, microseconds since it started.
    pub time_us: u64,
    /// Left encoder, ticks, forwards positive, counted since the robot started.
    pub left_ticks: i64,
    /// Right encoder, likewise.
    pub right_ticks: i64,
    /// Integrated gyro, radians, counter-clockwise positive, not wrapped.
    pub heading: f64,
}

/// A switch changed, located to the tick.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Edge {
    /// Which switch.
    pub sensor: usize,
    /// True when it closed (something came within d), false when it opened.
    pub rising: bool,
    /// Encoders and gyro at that instant.
    pub odometer: Odometer,
}

/// Why a motion ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DoneReason {
    /// The whole distance or angle was travelled.
    Complete,
    /// A guarded switch fired.
    Guard {
        /// Which one.
        sensor: usize,
        /// Whether it closed.
        rising: bool,
    },
    /// The bumper was pressed.
    Bumper,
    /// The wheels or the body did not move although driven.
    Stalled,
    /// The time limit ran out.
    TimeLimit,
    /// The host said stop.
    Stopped,
    /// Nothing was heard from the host for too long.
    HostSilent,
}

impl std::fmt::Display for DoneReason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Complete => f.write_str("all of it was travelled"),
            Self::Guard { sensor, rising } => {
                write!(f, "switch {sensor} {}", if *rising { "closed" } else { "opened" })
            }
            Self::Bumper => f.write_str("bumper"),
            Self::Stalled => f.write_str("stalled"),
            Self::TimeLimit => f.write_str("its time ran out"),
            Self::Stopped => f.write_str("stopped"),
            Self::HostSilent => f.write_str("the robot did not hear the host"),
        }
    }
}

/// One message from the robot.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "telemetry")]
pub enum Telemetry {
    /// The periodic report.
    Report {
        /// Encoders and gyro.
        odometer: Odometer,
        /// Which switches are closed.
        switches: SwitchSet,
        /// Whether the bumper is pressed.
        bumper: bool,
    },
    /// A switch changed. Sent before any later message.
    Edge(Edge),
    /// A motion ended and the robot stands still.
    Done {
        /// Which motion.
        id: CommandId,
        /// Why.
        reason: DoneReason,
        /// Encoders and gyro at rest.
        odometer: Odometer,
        /// Which switches are closed now.
        switches: SwitchSet,
        /// Whether the bumper is pressed now.
        bumper: bool,
    },
}

impl Telemetry {
    /// What wheels, gyro and clock counted then.
    #[must_use]
    pub fn odometer(&self) -> &Odometer {
        match self {
            Self::Report { odometer, .. } | Self::Done { odometer, .. } => odometer,
            Self::Edge(edge) => &edge.odometer,
        }
    }
}
