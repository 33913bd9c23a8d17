//! Driving makes the pose less certain: by the gyro's walk, drift and scale, and by the wheels; less
//! so where wheels and gyro can be weighed against each other.

use super::balance::Load;
use super::{AGAINST, BIAS, GATE, POSE, SCALE, Step, Survey, TRACK, WHEELS};
use crate::geometry::Vector;

/// Angle random walk of the gyro, radians per root second (0.05 degrees, MPU-6050 class).
pub const HEADING_WALK: f64 = 8.727e-4;

/// Where the wheels err by no more than this in turns (radians), they tell of the floor and of the gyro.
const UNTURNED: f64 = 3.0e-4;

/// What a straight drive is off by, as a share of it, each by itself: how the floor takes the wheels.
pub const STRIDE_SHARE: f64 = 0.005;
/// What the wheels lose on the way besides, by slips, metres per root metre.
pub const ALONG: f64 = 0.0015;
/// What the robot is put off to the side by more than its heading explains, likewise.
pub const ASIDE: f64 = 0.0007;

/// What a step makes of the errors that change while the robot drives: those of the pose, and of what
/// the wheels turned more than the gyro.
pub(super) struct Onward {
    moved: Vector,
    seconds: f64,
    turned: f64,
    ahead: f64,
}

impl Onward {
    /// The rows that change.
    pub(super) const ROWS: [usize; 4] = [POSE, POSE + 1, POSE + 2, AGAINST];

    pub(super) fn over(step: &Step) -> Self {
        let moved = step.to.position - step.from.position;
        Self { moved, seconds: step.seconds, turned: step.turned(), ahead: step.ahead() }
    }

    /// The changed rows of what `old` tells row by row.
    #[inline]
    pub(super) fn apply(&self, old: impl Fn(usize) -> f64) -> [f64; 4] {
        let (moved, heading) = (self.moved, old(POSE + 2));
        // Drift over the step turns the heading, and half of it the way.
        let drift = self.seconds * old(BIAS) + self.turned * old(SCALE);
        let turn = heading + drift / 2.0;
        [
            old(POSE) - moved.y * turn,
            old(POSE + 1) + moved.x * turn,
            heading + drift,
            old(AGAINST) + drift - self.ahead * old(WHEELS) - self.turned * old(TRACK),
        ]
    }
}

impl Survey {
    /// The robot made `step`.
    pub fn predict(&mut self, step: &Step) {
        // Before and after a turn: in it the gyro is the better judge, about it the wheels are.
        if let Some(load) = self.balance.before(step) {
            self.weigh(&load);
        }
        self.drift(step);
        if let Some(load) = self.balance.take(step) {
            self.weigh(&load);
        }
    }

    /// Weighs what the wheels say of the turns since they were weighed last against the gyro.
    fn weigh(&mut self, load: &Load) {
        let row = [(AGAINST, 1.0)];
        // Two wheels, each rounded to a tick.
        let rounding = self.resolution * self.resolution / 6.0;
        let innovation = load.against - self.expected(&row);
        *self.covariance.head(AGAINST, AGAINST) += load.scrub();
        let spread = self.covariance.spread(&row) + rounding;
        let wander = self.grip.wander() * load.length;
        let walk = HEADING_WALK * HEADING_WALK * load.seconds;
        if load.scrub() < UNTURNED * UNTURNED {
            self.grip.learn(load.length, innovation, spread, walk, rounding);
        }
        let square = innovation * innovation;
        // A slip says nothing of the heading; what comes after it does again.
        let slip = if square < GATE * GATE * (spread + wander) { 0.0 } else { square };
        *self.covariance.head(AGAINST, AGAINST) += wander + slip;
        self.update(&row, innovation, rounding);
    }

    /// Spreads the errors over a step.
    fn drift(&mut self, step: &Step) {
        let onward = Onward::over(step);
        self.covariance.step(&onward);
        let new = onward.apply(|k| self.mean[k]);
        for (row, value) in Onward::ROWS.into_iter().zip(new) {
            self.mean[row] = value;
        }
        let (moved, seconds) = (onward.moved, step.seconds);
        let length = step.length();
        let along = STRIDE_SHARE * STRIDE_SHARE * step.strides() + ALONG * ALONG * length;
        let along = if length > 0.0 { along / (length * length) } else { 0.0 };
        let aside = ASIDE * ASIDE * length;
        let walk = HEADING_WALK * HEADING_WALK * self.grip.walk() * seconds;
        *self.covariance.head(0, 0) += along * moved.x * moved.x + aside;
        *self.covariance.head(1, 1) += along * moved.y * moved.y + aside;
        *self.covariance.head(0, 1) += along * moved.x * moved.y;
        *self.covariance.head(1, 0) += along * moved.x * moved.y;
        for (row, column) in [(2, 2), (2, AGAINST), (AGAINST, 2), (AGAINST, AGAINST)] {
            *self.covariance.head(row, column) += walk;
        }
    }

    /// The gyro was seen to drift at `rate` (radians per second, beyond what was taken out) while the
    /// robot stood still for `seconds`.
    pub fn rest(&mut self, seconds: f64, rate: f64) {
        let row = [(BIAS, 1.0)];
        let innovation = -rate - self.mean[BIAS];
        self.update(&row, innovation, HEADING_WALK * HEADING_WALK * self.grip.walk() / seconds);
    }
}
