//! What the wheels say of the heading.
//!
//! The gyro wanders with time, two encoders with the way and by a share of each turn: over a straight
//! drive or a small turn the wheels are the better judges of how far the robot has turned, over a
//! large turn the gyro is (gyrodometry: Borenstein and Feng 1996, here weighed instead of switched).
//! How good the wheels are on this floor is learnt from how well they agree with the gyro.

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
    pub(super) fn length(&self) -> f64 {
        (self.to.position - self.from.position).norm()
    }

    /// The straight drives in it, squared one by one, square metres.
    pub(super) fn strides(&self) -> f64 {
        self.spun.1.strides - self.spun.0.strides
    }

    /// Metres driven forwards.
    pub(super) fn ahead(&self) -> f64 {
        (self.to.position - self.from.position).dot(&self.from.direction())
    }

    /// Whether there is a turn in it that the gyro is the better judge of.
    fn turns(&self) -> bool {
        self.wound() > LARGE
    }

    fn wound(&self) -> f64 {
        self.spun.1.wound - self.spun.0.wound
    }

    fn against(&self) -> f64 {
        let of = |spun: Spun| spun.wheels - spun.gyro;
        of(self.spun.1) - of(self.spun.0)
    }

    /// By how much the believed heading changed, radians.
    pub(super) fn turned(&self) -> f64 {
        angle::wrap(self.to.heading - self.from.heading)
    }
}

/// Turns larger than this are weighed by themselves, radians.
const LARGE: f64 = 0.2;
/// Wheels and gyro are weighed at least this often, metres.
const OFTEN: f64 = 0.4;
/// What chance adds to a turn of the wheels, as a share of it: scrub.
pub const TURN_SHARE: f64 = 0.005;
/// How much the wheels may wander on a floor, square radians per metre: from 0.02 to 0.6 degrees a
/// root metre.
const FLOORS: [f64; 7] = [1.0e-7, 3.0e-7, 1.0e-6, 3.0e-6, 1.0e-5, 3.0e-5, 1.0e-4];
/// Before anything is known each of them is believed half as much as the one before.
const RARER: f64 = 0.5;
/// How far the gyro may wander, as a share of what its datasheet says (standard deviation).
const GYROS: [f64; 3] = [1.0, 0.3, 0.1];
/// Before anything is known each of them is believed that much less than the one before: a gyro
/// better than its datasheet has to prove it.
const FINER: f64 = 0.1;
/// What is farther off than this, in variances, is a slip, and no wander.
const SLIP: f64 = 12.0;

/// What was learnt of how the wheels hold the floor and how still the gyro is: the likelihood of
/// each pair of [`FLOORS`] and [`GYROS`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grip {
    /// Natural logarithms; a row for each of [`GYROS`].
    likelihood: [[f64; FLOORS.len()]; GYROS.len()],
    /// Variance of the wheels' heading, square radians per metre.
    wander: f64,
    /// Variance of the gyro's walk, as a share of what its datasheet says.
    walk: f64,
}

impl Default for Grip {
    fn default() -> Self {
        let prior = |gyro: usize, floor: usize| {
            floor as f64 * libm::log(RARER) + gyro as f64 * libm::log(FINER)
        };
        let likelihood = std::array::from_fn(|gyro| std::array::from_fn(|k| prior(gyro, k)));
        Self { likelihood, wander: 0.0, walk: 1.0 }.weighed()
    }
}

impl Grip {
    /// Variance of the wheels' heading, square radians per metre: the geometric mean of the floors,
    /// weighed by how likely they are.
    pub(super) fn wander(&self) -> f64 {
        self.wander
    }

    /// Variance of the gyro's walk as a share of what its datasheet says, likewise.
    pub(super) fn walk(&self) -> f64 {
        self.walk
    }

    fn weighed(self) -> Self {
        let best = self.likelihood.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
        let (mut wander, mut walk, mut all) = (0.0, 0.0, 0.0);
        for (gyro, row) in GYROS.iter().zip(&self.likelihood) {
            for (floor, likelihood) in FLOORS.iter().zip(row) {
                let weight = libm::exp(likelihood - best);
                wander += weight * libm::log(*floor);
                walk += weight * 2.0 * libm::log(*gyro);
                all += weight;
            }
        }
        Self { wander: libm::exp(wander / all), walk: libm::exp(walk / all), ..self }
    }

    /// Learns from `length` metres that were off by `innovation`, with `spread` (square radians)
    /// expected had the wheels not wandered at all; in `spread`, `walk` is what the gyro would have
    /// wandered by its datasheet, times what is believed of it. Of that the touches of walls on the way may have
    /// taken out more than is left; `rounding`, square radians, nothing takes out.
    pub(super) fn learn(
        &mut self,
        length: f64,
        innovation: f64,
        spread: f64,
        walk: f64,
        rounding: f64,
    ) {
        let still = (spread - walk * self.walk).max(rounding);
        for (gyro, row) in GYROS.iter().zip(&mut self.likelihood) {
            for (floor, likelihood) in FLOORS.iter().zip(row) {
                let variance = still + gyro * gyro * walk + floor * length;
                let square = (innovation * innovation / variance).min(SLIP);
                *likelihood -= 0.5 * (libm::log(variance) + square);
            }
        }
        *self = self.weighed();
    }
}

/// What has come together since wheels and gyro were weighed last.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Load {
    /// By how much the wheels have turned more than the gyro since the beginning, radians.
    pub(super) against: f64,
    /// Metres since they were weighed last.
    pub(super) length: f64,
    /// Seconds of motion since then.
    pub(super) seconds: f64,
    /// Turns to and fro since then, squared one by one, square radians.
    squares: f64,
}

impl Load {
    /// Variance of what the wheels turned, by chance, in the turns, square radians.
    pub(super) fn scrub(&self) -> f64 {
        TURN_SHARE * TURN_SHARE * self.squares
    }
}

/// Where wheels and gyro are weighed against each other.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Balance {
    load: Load,
    /// Whether the load is a turn, or the first steps of one.
    turning: bool,
}

impl Balance {
    /// What to weigh before `step` is taken: all that came before a large turn, and the turn after it.
    pub(super) fn before(&mut self, step: &Step) -> Option<Load> {
        let turning = std::mem::replace(&mut self.turning, step.turns());
        let something = self.load.length > 0.0 || turning;
        (turning != step.turns() && something).then(|| self.empty())
    }

    /// Takes the next step; what to weigh after it, if it is time to.
    pub(super) fn take(&mut self, step: &Step) -> Option<Load> {
        self.load.length += step.length();
        self.load.seconds += step.seconds;
        self.load.against += step.against();
        self.load.squares += step.spun.1.squares - step.spun.0.squares;
        (!step.turns() && self.load.length > OFTEN).then(|| self.empty())
    }

    fn empty(&mut self) -> Load {
        let load = self.load;
        self.load = Load { against: load.against, ..Load::default() };
        load
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(metres: f64, gyro: f64, wheels: f64) -> Step {
        let spun = (
            Spun::default(),
            Spun { gyro, wheels, wound: gyro.abs(), squares: gyro * gyro, strides: 0.0 },
        );
        let to = Pose::new(metres, 0.0, gyro);
        Step { from: Pose::new(0.0, 0.0, 0.0), to, seconds: 0.1, spun }
    }

    #[test]
    fn they_are_weighed_every_so_often_and_about_large_turns() {
        let mut balance = Balance::default();
        let straight = step(0.15, 0.0, 0.001);
        assert!(balance.before(&straight).is_none() && balance.take(&straight).is_none());
        assert!(balance.take(&straight).is_none(), "0.3 m say little");
        let third = balance.take(&straight).expect("0.45 m");
        assert!((third.length - 0.45).abs() < 1e-9 && (third.against - 0.003).abs() < 1e-9);
        assert!(balance.take(&straight).is_none());
        let turn = step(0.0, 0.3, 0.31);
        let before = balance.before(&turn).expect("a large turn comes");
        assert!((before.length - 0.15).abs() < 1e-9 && (before.against - 0.004).abs() < 1e-9);
        assert!(before.scrub() < 1e-12);
        assert!(balance.take(&turn).is_none(), "it may go on");
        let turned = balance.before(&straight).expect("the turn has ended");
        // All since the beginning is told again: rounding to ticks does not add up.
        assert!(turned.length < 1e-9 && (turned.against - 0.014).abs() < 1e-9);
        assert!((turned.scrub().sqrt() - 0.3 * TURN_SHARE).abs() < 1e-9);
        assert!(balance.before(&straight).is_none(), "nothing came together");
    }

    #[test]
    fn the_floor_is_judged_by_how_well_wheels_and_gyro_agree() {
        let spread = 1.0e-6;
        let (mut good, mut bad) = (Grip::default(), Grip::default());
        assert!((1.0e-7..1.0e-6).contains(&good.wander()), "{}", good.wander());
        for k in 0..100 {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            good.learn(2.0, sign * 0.001, spread, 0.0, 0.0);
            bad.learn(2.0, sign * 0.005, spread, 0.0, 0.0);
        }
        assert!(good.wander() < 1.5e-7, "{}", good.wander());
        // 25e-6 in 2 m are 12e-6 a metre.
        assert!((0.9e-5..1.5e-5).contains(&bad.wander()), "{}", bad.wander());
    }

    #[test]
    fn what_touches_took_out_of_the_walk_is_not_taken_out_twice() {
        let mut grip = Grip::default();
        for _ in 0..100 {
            grip.learn(0.02, 1.0e-5, 2.0e-7, 4.0e-6, 1.0e-8);
            assert!(grip.wander().is_finite() && grip.walk().is_finite(), "{grip:?}");
        }
        assert!((0.0099..=1.0).contains(&grip.walk()), "{}", grip.walk());
    }
}
