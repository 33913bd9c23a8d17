//! The command set: move, turn, stop. All that the host may ask of the robot (paper III.B).

use super::SwitchSet;
use serde::{Deserialize, Serialize};

/// Numbers the commands of a session in order; a repeated number is the same command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct CommandId(pub u32);

/// What ends a motion early: the first edge of a switch named here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Guard {
    /// Switches whose closing (something came within d) ends the motion. A switch that is already
    /// closed when the motion begins does not end it until it has opened and closed again.
    pub rise: SwitchSet,
    /// Switches whose opening ends the motion.
    pub fall: SwitchSet,
}

/// One motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", tag = "motion")]
pub enum Motion {
    /// Straight, holding the heading by gyro.
    Move {
        /// Metres; negative is backwards.
        distance: f64,
        /// Metres per second, positive.
        speed: f64,
    },
    /// In place.
    Turn {
        /// Radians, counter-clockwise positive, by gyro.
        angle: f64,
        /// Radians per second, positive.
        rate: f64,
    },
    /// Standing still, for the gyro's zero; ends after the time limit.
    Rest,
}

/// A motion with its limits, as it is sent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Command {
    /// Its number.
    pub id: CommandId,
    /// What to do.
    pub motion: Motion,
    /// What ends it early.
    pub guard: Guard,
    /// The robot stops by itself after this many seconds.
    pub time_limit: f64,
}
