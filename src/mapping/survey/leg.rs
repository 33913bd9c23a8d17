//! What the wheels say of the heading on a stretch without a turn.
//!
//! The gyro wanders with time, two encoders with the way: over a long straight drive the wheels are
//! the better judges of whether the robot has turned, over a turn the gyro is (gyrodometry:
//! Borenstein and Feng 1996, here weighed instead of switched). How good the wheels are on this
//! floor is learnt from how well they agree with the gyro.

use crate::geometry::{Pose, angle};
use crate::mapping::map::Spun;

/// One step of the way, between two readings of the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Where it was believed to begin.
    pub from: Pose,
    /// Where it was believed to end.
    pub to: Pose,
    /// Time the robot was not at rest, seconds.
    pub seconds: f64,
    /// How far gyro and wheels had turned in all at its beginning, and at its end.
    pub spun: (Spun, Spun),
}

impl Step {
    fn length(&self) -> f64 {
        (self.to.position - self.from.position).norm()
    }

    /// Whether it belongs to a turn: a bend of less than a metre of radius.
    fn turns(&self) -> bool {
        self.wound() > 0.004 + self.length()
    }

    fn wound(&self) -> f64 {
        self.spun.1.wound - self.spun.0.wound
    }

    fn gyro(&self) -> f64 {
        self.spun.1.gyro - self.spun.0.gyro
    }

    fn wheels(&self) -> f64 {
        self.spun.1.wheels - self.spun.0.wheels
    }

    /// By how much the believed heading changed, radians.
    pub(super) fn turned(&self) -> f64 {
        angle::wrap(self.to.heading - self.from.heading)
    }
}

/// Shorter stretches say less than one encoder tick does, metres.
const LEAST_LENGTH: f64 = 0.5;
/// What a turn of the wheels may be off by, as a share of it: scrub, wheel base.
const TURN_SHARE: f64 = 0.005;
const NET_SHARE: f64 = 0.01;
/// What the wheels are believed to wander before anything is known of the floor, square radians per
/// metre (0.1 degrees a root metre), and how many metres that belief is worth.
const WANDER: f64 = 3.0e-6;
const WORTH: f64 = 10.0;
/// No floor is believed to be better than this, square radians per metre.
const LEAST_WANDER: f64 = 1.0e-7;

/// What was learnt of how the wheels hold the floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grip {
    /// Weighted metres, and the squares beyond what was expected without any wander.
    metres: f64,
    squares: f64,
}

impl Default for Grip {
    fn default() -> Self {
        Self { metres: WORTH, squares: WORTH * WANDER }
    }
}

impl Grip {
    /// Variance of the wheels' heading, square radians per metre.
    pub(super) fn wander(self) -> f64 {
        (self.squares / self.metres).max(LEAST_WANDER)
    }

    /// Learns from a leg of `length` metres that was off by `innovation`, with `spread` (square
    /// radians) expected had the wheels not wandered at all.
    pub(super) fn learn(&mut self, length: f64, innovation: f64, spread: f64) {
        // A slip is no wander.
        let square = (innovation * innovation).min(12.0 * (spread + self.wander() * length));
        // What is itself uncertain by more than the wander says little of it.
        let weight = (WANDER * length / (spread + WANDER * length)).powi(2);
        self.metres += weight * length;
        self.squares += weight * (square - spread);
    }
}

/// A stretch without a turn, as it grows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Leg {
    /// Metres.
    pub(super) length: f64,
    /// By how much the wheels turned more than the gyro, radians.
    pub(super) off: f64,
    net: f64,
    squares: f64,
}

impl Leg {
    /// Takes the next step; the leg that ended with it, if it was long enough to count.
    pub(super) fn take(&mut self, step: &Step) -> Option<Self> {
        if step.turns() {
            return self.end();
        }
        self.length += step.length();
        self.off += step.wheels() - step.gyro();
        self.net += step.gyro();
        self.squares += step.wound().powi(2);
        None
    }

    /// Ends it here.
    pub(super) fn end(&mut self) -> Option<Self> {
        Some(std::mem::take(self)).filter(|leg| leg.length > LEAST_LENGTH)
    }

    /// Whether `step`, just taken, was the first of it.
    pub(super) fn began_with(&self, step: &Step) -> bool {
        self.length <= step.length()
    }

    /// Variance of `off` but for the wander of the wheels and of the gyro, square radians; one tick
    /// of one wheel is `resolution` radians.
    pub(super) fn variance(&self, resolution: f64) -> f64 {
        // Two wheels, at both ends, each rounded to a tick.
        resolution * resolution / 3.0
            + TURN_SHARE * TURN_SHARE * self.squares
            + (NET_SHARE * self.net).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(metres: f64, gyro: f64, wheels: f64) -> Step {
        let spun = (Spun::default(), Spun { gyro, wheels, wound: gyro.abs() });
        let to = Pose::new(metres, 0.0, gyro);
        Step { from: Pose::new(0.0, 0.0, 0.0), to, seconds: 0.1, spun }
    }

    #[test]
    fn a_leg_ends_with_a_turn_and_counts_when_it_is_long() {
        let mut leg = Leg::default();
        for _ in 0..10 {
            assert!(leg.take(&step(0.02, 0.0, 0.001)).is_none());
        }
        assert!(leg.take(&step(0.0, 0.2, 0.2)).is_none(), "0.2 m say nothing");
        for _ in 0..30 {
            assert!(leg.take(&step(0.02, 0.0, 0.001)).is_none());
        }
        let whole = leg.take(&step(0.0, 0.2, 0.2)).expect("0.6 m");
        assert!((whole.length - 0.6).abs() < 1e-9 && (whole.off - 0.03).abs() < 1e-9);
        assert_eq!(leg, Leg::default());
    }

    #[test]
    fn the_floor_is_judged_by_how_well_wheels_and_gyro_agree() {
        let spread = 1.0e-6;
        let (mut good, mut bad) = (Grip::default(), Grip::default());
        for k in 0..100 {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            good.learn(2.0, sign * 0.001, spread);
            bad.learn(2.0, sign * 0.005, spread);
        }
        assert!(good.wander() < 0.5 * WANDER, "{}", good.wander());
        // 25e-6 in 2 m are 12e-6 a metre.
        assert!((bad.wander() - 12.0e-6).abs() < 2.0e-6, "{}", bad.wander());
    }
}
