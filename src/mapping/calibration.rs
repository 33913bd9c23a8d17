//! What a run has found out about the robot itself: its wheels and its gyro, from how they agree with each
//! other and with the walls.
//!
//! On a lap driven one way round and then the other, what errs with the sense of the turns changes its
//! sign and what errs with time or way does not, so that the four can be told apart: wheels of different
//! size, the wheel base, the gyro's scale and its drift (the bidirectional square path of Borenstein and
//! Feng 1996, with the room's own walls in place of the square). The common size of the wheels takes a
//! tape. Reads the survey and changes nothing.

use super::survey::{HEADING_WALK, Survey};
use crate::geometry::angle;
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

/// How the robot went, as far as that matters here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Driven {
    /// What the gyro is believed to drift at, radians per second.
    pub drift: f64,
    /// How many times as far as was believed the wheels carried it.
    pub stretch: f64,
    /// Seconds of motion in one lap.
    pub lap: f64,
}

impl Calibration {
    /// What `survey` says of a robot that is believed to be built as `chassis` and was `driven` like that.
    ///
    /// Neither of two neighbouring walls tells a gyro that turns too far from a corner that is too wide:
    /// only the whole turn of a lap does, and over that the gyro walks. How well it is known is taken from
    /// there, since the survey, which takes every touch for a new one, thinks too well of it.
    #[must_use]
    pub fn of(survey: &Survey, chassis: &Chassis, driven: &Driven) -> Self {
        let Driven { drift, stretch, lap } = *driven;
        let errs = survey.of_the_robot();
        let whole_turns = HEADING_WALK * (2.0 * lap).sqrt() / (2.0 * angle::TAU);
        let base = chassis.wheel_base;
        let straight = base * stretch;
        let value = |value: f64, sd: f64| Measured { value, sd };
        Self {
            wheel_base: value(
                straight / (1.0 - errs.track.value),
                straight * errs.track.sd.max(whole_turns),
            ),
            wheel_ratio: value(1.0 + errs.wheels.value * base, errs.wheels.sd * base),
            gyro_scale: value(1.0 / (1.0 - errs.scale.value), errs.scale.sd.max(whole_turns)),
            gyro_drift: value(drift + errs.drift.value, errs.drift.sd),
            tick: chassis.tick * stretch,
        }
    }
}
