//! What a run has found out about the robot itself: its wheels and its gyro, from how they agree with each
//! other and with the walls.
//!
//! On a lap driven one way round and then the other, what errs with the sense of the turns changes its
//! sign and what errs with time or way does not, so that the four can be told apart: wheels of different
//! size, the wheel base, the gyro's scale and its drift (the bidirectional square path of Borenstein
//! and Feng 1996, UMB mark, with the room's own walls in place of the square). The common size of the wheels takes a
//! tape.

use super::survey::Survey;
use crate::robot::Chassis;
use serde::{Deserialize, Serialize};

/// A figure and its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// What it is.
    pub value: f64,
    /// One standard deviation.
    pub sd: f64,
}

/// What is known of wheels and gyro.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Distance between the wheels' tracks, metres.
    pub wheel_base: Measured,
    /// What the right wheel is believed to travel over what the left one is, going straight.
    pub wheel_ratio: Measured,
    /// What the gyro tells over what the robot turns.
    pub gyro_scale: Measured,
    /// What the gyro tells of a robot at rest, radians per second.
    pub gyro_drift: Measured,
    /// Travel of a wheel per encoder tick, metres; as it was believed when no tape was laid.
    pub tick: f64,
}

impl Calibration {
    /// What `survey` says of a robot that is believed to be built as `chassis`, whose gyro is believed to
    /// drift at `drift` (radians per second) and whose wheels carried it `stretch` times as far as they
    /// were believed to.
    #[must_use]
    pub fn of(survey: &Survey, chassis: &Chassis, drift: f64, stretch: f64) -> Self {
        let own = survey.of_the_robot();
        let base = chassis.wheel_base;
        let straight = base * stretch;
        let value = |value: f64, sd: f64| Measured { value, sd };
        Self {
            wheel_base: value(straight / (1.0 + own.track.value), straight * own.track.sd),
            wheel_ratio: value(1.0 - own.wheels.value * base, own.wheels.sd * base),
            gyro_scale: value(1.0 / (1.0 + own.scale.value), own.scale.sd),
            gyro_drift: value(drift - own.bias.value, own.bias.sd),
            tick: chassis.tick * stretch,
        }
    }
}
