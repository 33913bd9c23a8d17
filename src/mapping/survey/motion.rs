//! Driving makes the pose less certain: by the gyro's walk, drift and scale, and by the wheels; less
//! so on straight stretches, where wheels and gyro are weighed against each other.

use super::leg::Leg;
use super::{BIAS, GATE, SCALE, Step, Survey, WANDER, WHEELS};
use nalgebra::{Matrix3, Vector3};

/// Angle random walk of the gyro, radians per root second (0.05 degrees, MPU-6050 class).
const HEADING_WALK: f64 = 1.0e-3;

impl Survey {
    /// The robot made `step`; the wheels' own error adds `wheel_sd` metres per root metre.
    pub fn predict(&mut self, step: &Step, wheel_sd: f64) {
        if let Some(leg) = self.leg.take(step) {
            self.weigh(&leg);
        }
        if self.leg.began_with(step) {
            self.begin_leg();
        }
        self.drift(step, wheel_sd);
    }

    /// Counts what the gyro wanders from here on.
    fn begin_leg(&mut self) {
        self.covariance.row_mut(WANDER).fill(0.0);
        self.covariance.column_mut(WANDER).fill(0.0);
        self.mean[WANDER] = 0.0;
    }

    /// Weighs what the wheels say of the heading at the end of `leg` against the gyro.
    fn weigh(&mut self, leg: &Leg) {
        let row = [(WANDER, 1.0), (WHEELS, -leg.length)];
        let predicted = self.expected(&row);
        let innovation = leg.off - predicted;
        let least = leg.variance(self.resolution);
        let spread = self.spread(&row) + least;
        let variance = least + self.grip.wander() * leg.length;
        self.grip.learn(leg.length, innovation, spread);
        if innovation * innovation < GATE * GATE * (spread + variance - least) {
            self.update(&row, innovation, variance);
        }
    }

    /// Spreads the errors over a step.
    fn drift(&mut self, step: &Step, wheel_sd: f64) {
        let moved = step.to.position - step.from.position;
        let (seconds, turned) = (step.seconds, step.turned());
        let mut onward = Matrix3::identity();
        onward[(0, 2)] = -moved.y;
        onward[(1, 2)] = moved.x;
        // Drift over the step turns the heading, and half of it the way.
        let lever = Vector3::new(-moved.y / 2.0, moved.x / 2.0, 1.0);
        let (by_bias, by_scale) = (lever * seconds, lever * turned);
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
            self.covariance[(WANDER, column)] += seconds * self.covariance[(BIAS, column)]
                + turned * self.covariance[(SCALE, column)];
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
            self.covariance[(row, WANDER)] +=
                seconds * self.covariance[(row, BIAS)] + turned * self.covariance[(row, SCALE)];
        }
        let pose = onward * Vector3::new(self.mean[0], self.mean[1], self.mean[2])
            + by_bias * self.mean[BIAS]
            + by_scale * self.mean[SCALE];
        for row in 0..3 {
            self.mean[row] = pose[row];
        }
        self.mean[WANDER] += seconds * self.mean[BIAS] + turned * self.mean[SCALE];
        let along = wheel_sd * wheel_sd * moved.norm();
        let walk = HEADING_WALK * HEADING_WALK * seconds;
        self.covariance[(0, 0)] += along;
        self.covariance[(1, 1)] += along;
        for (row, column) in [(2, 2), (2, WANDER), (WANDER, 2), (WANDER, WANDER)] {
            self.covariance[(row, column)] += walk;
        }
    }

    /// The gyro was seen to drift at `rate` (radians per second, beyond what was taken out) while the
    /// robot stood still for `seconds`.
    pub fn rest(&mut self, seconds: f64, rate: f64) {
        let row = [(BIAS, 1.0)];
        let innovation = -rate - self.mean[BIAS];
        self.update(&row, innovation, HEADING_WALK * HEADING_WALK / seconds);
    }
}
