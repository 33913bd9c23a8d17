//! Driving makes the pose less certain: by the gyro's walk, drift and scale, and by the wheels; less
//! so where wheels and gyro can be weighed against each other.

use super::balance::Load;
use super::{AGAINST, BIAS, GATE, SCALE, Step, Survey, TRACK, WHEELS};
use nalgebra::{Matrix3, Vector3};

/// Angle random walk of the gyro, radians per root second (0.05 degrees, MPU-6050 class).
const HEADING_WALK: f64 = 1.0e-3;

/// What a straight drive is off by, as a share of it, each by itself: how the floor takes the wheels.
const STRIDE: f64 = 0.005;
/// What the wheels lose on the way besides, by slips, metres per root metre.
const ALONG: f64 = 0.0015;
/// What the robot is put off to the side by more than its heading explains, likewise.
const ASIDE: f64 = 0.0007;

/// A row of the filter that gains by other rows in each step, by how much of each.
type Gains = [(usize, f64); 4];

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
        self.covariance[(AGAINST, AGAINST)] += load.scrub();
        let spread = self.spread(&row) + rounding;
        let wander = self.grip.wander() * load.length;
        self.grip.learn(
            load.length,
            innovation,
            spread,
            HEADING_WALK * HEADING_WALK * load.seconds,
        );
        let square = innovation * innovation;
        // A slip says nothing of the heading; what comes after it does again.
        let slip = if square < GATE * GATE * (spread + wander) { 0.0 } else { square };
        self.covariance[(AGAINST, AGAINST)] += wander + slip;
        self.update(&row, innovation, rounding);
    }

    /// Spreads the errors over a step.
    fn drift(&mut self, step: &Step) {
        let moved = step.to.position - step.from.position;
        let (seconds, turned) = (step.seconds, step.turned());
        let mut onward = Matrix3::identity();
        onward[(0, 2)] = -moved.y;
        onward[(1, 2)] = moved.x;
        // Drift over the step turns the heading, and half of it the way.
        let lever = Vector3::new(-moved.y / 2.0, moved.x / 2.0, 1.0);
        let (by_bias, by_scale) = (lever * seconds, lever * turned);
        let against: Gains =
            [(WHEELS, -step.ahead()), (TRACK, -turned), (BIAS, seconds), (SCALE, turned)];
        let size = self.mean.len();
        for column in 0..size {
            let old = Vector3::new(
                self.covariance[(0, column)],
                self.covariance[(1, column)],
                self.covariance[(2, column)],
            );
            let new = onward * old
                + by_bias * self.covariance[(BIAS, column)]
                + by_scale * self.covariance[(SCALE, column)];
            for row in 0..3 {
                self.covariance[(row, column)] = new[row];
            }
            let gain: f64 = against.iter().map(|(k, by)| by * self.covariance[(*k, column)]).sum();
            self.covariance[(AGAINST, column)] += gain;
        }
        for row in 0..size {
            let old = Vector3::new(
                self.covariance[(row, 0)],
                self.covariance[(row, 1)],
                self.covariance[(row, 2)],
            );
            let new = onward * old
                + by_bias * self.covariance[(row, BIAS)]
                + by_scale * self.covariance[(row, SCALE)];
            for column in 0..3 {
                self.covariance[(row, column)] = new[column];
            }
            let gain: f64 = against.iter().map(|(k, by)| by * self.covariance[(row, *k)]).sum();
            self.covariance[(row, AGAINST)] += gain;
        }
        let pose = onward * Vector3::new(self.mean[0], self.mean[1], self.mean[2])
            + by_bias * self.mean[BIAS]
            + by_scale * self.mean[SCALE];
        for row in 0..3 {
            self.mean[row] = pose[row];
        }
        self.mean[AGAINST] += self.expected(&against);
        let length = step.length();
        let along = STRIDE * STRIDE * step.strides() + ALONG * ALONG * length;
        let along = if length > 0.0 { along / (length * length) } else { 0.0 };
        let aside = ASIDE * ASIDE * length;
        let walk = HEADING_WALK * HEADING_WALK * self.grip.walk() * seconds;
        self.covariance[(0, 0)] += along * moved.x * moved.x + aside;
        self.covariance[(1, 1)] += along * moved.y * moved.y + aside;
        self.covariance[(0, 1)] += along * moved.x * moved.y;
        self.covariance[(1, 0)] += along * moved.x * moved.y;
        for (row, column) in [(2, 2), (2, AGAINST), (AGAINST, 2), (AGAINST, AGAINST)] {
            self.covariance[(row, column)] += walk;
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
