//! Position fixes: a touch of a surface that is already mapped corrects the pose.
//!
//! An extended Kalman filter over (x, y, heading) whose measurement is the distance of a contact
//! from the mapped surface, along that surface's normal (Thrun, Burgard, Fox: Probabilistic
//! Robotics, ch. 3.3). Touches of walls in two directions fix the position; two touches of one
//! wall fix the heading. Keeps only the covariance; the pose itself lives in the tracker.

use crate::geometry::{Point, Pose, Vector, angle, perp};
use nalgebra::{Matrix3, Vector3};

/// Where a contact should lie: a point of the mapped surface and its unit normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// The mapped point nearest to the contact.
    pub at: Point,
    /// Unit normal, to either side.
    pub normal: Vector,
}

/// How far a wheel may err, metres per metre (slip and per-move noise together).
const DISTANCE_SD: f64 = 0.012;
/// Angle random walk of the gyro and what is left of its drift, radians per root second.
const HEADING_SD: f64 = 0.0016;
/// Contact and map together, metres.
const CONTACT_SD: f64 = 0.005;

/// What is believed of the pose's error.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseFilter {
    covariance: Matrix3<f64>,
}

impl Default for PoseFilter {
    fn default() -> Self {
        let position = 0.005_f64.powi(2);
        Self { covariance: Matrix3::from_diagonal(&Vector3::new(position, position, 2.5e-5)) }
    }
}

impl PoseFilter {
    /// The robot drove from `from` to `to` in `seconds`.
    pub fn predict(&mut self, from: Pose, to: Pose, seconds: f64) {
        let moved = to.position - from.position;
        let mut step = Matrix3::identity();
        step[(0, 2)] = -moved.y;
        step[(1, 2)] = moved.x;
        self.covariance = step * self.covariance * step.transpose();
        // Half of what a straight move may err, so that many short moves add up like one long one.
        let distance = moved.norm();
        let spread = DISTANCE_SD * DISTANCE_SD * distance * distance.max(0.05);
        self.covariance[(0, 0)] += spread;
        self.covariance[(1, 1)] += spread;
        self.covariance[(2, 2)] += HEADING_SD * HEADING_SD * seconds;
    }

    /// Takes a contact at `contact`, seen from `pose`, that should lie on `surface`; returns the
    /// corrected pose, or none when it is too far off to be that surface.
    pub fn update(&mut self, pose: Pose, contact: Point, surface: &Surface) -> Option<Pose> {
        let arm = contact - pose.position;
        let normal = surface.normal;
        let row = Vector3::new(normal.x, normal.y, normal.dot(&perp(arm)));
        let off = normal.dot(&(contact - surface.at));
        let spread = (self.covariance * row).dot(&row) + CONTACT_SD * CONTACT_SD;
        if off * off > 9.0 * spread || off.abs() > 0.12 {
            return None;
        }
        let gain = self.covariance * row / spread;
        self.covariance -= gain * (row.transpose() * self.covariance);
        self.covariance = (self.covariance + self.covariance.transpose()) / 2.0;
        let change = -gain * off;
        Some(Pose {
            position: pose.position + Vector::new(change.x, change.y),
            heading: angle::wrap(pose.heading + change.z),
        })
    }

    /// One standard deviation of the position in its worse direction, metres.
    #[must_use]
    pub fn position_sd(&self) -> f64 {
        let (xx, xy, yy) =
            (self.covariance[(0, 0)], self.covariance[(0, 1)], self.covariance[(1, 1)]);
        let middle = f64::midpoint(xx, yy);
        let spread = angle::hypot((xx - yy) / 2.0, xy);
        (middle + spread).max(0.0).sqrt()
    }

    /// One standard deviation of the heading, radians.
    #[must_use]
    pub fn heading_sd(&self) -> f64 {
        self.covariance[(2, 2)].max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_walls_fix_the_position_and_two_touches_the_heading() {
        let truth = Pose::new(1.0, 1.0, 0.3);
        let mut believed = Pose::new(1.02, 0.985, 0.29);
        let mut filter = PoseFilter::default();
        for _ in 0..20 {
            let before = Pose { position: believed.position - Vector::new(0.2, 0.0), ..believed };
            filter.predict(before, believed, 3.0);
        }
        for (bearing, normal) in [
            (-0.3, Vector::new(1.0, 0.0)),
            (0.2, Vector::new(1.0, 0.0)),
            (1.27, Vector::new(0.0, 1.0)),
            (1.57, Vector::new(0.0, 1.0)),
        ] {
            let local = Point::from(angle::unit(bearing) * 0.16);
            let real = truth.to_world(local);
            let surface = Surface { at: real, normal };
            let fixed = filter.update(believed, believed.to_world(local), &surface);
            believed = fixed.unwrap_or(believed);
        }
        assert!((believed.position - truth.position).norm() < 0.004, "{believed:?}");
        assert!(angle::wrap(believed.heading - truth.heading).abs() < 0.02, "{believed:?}");
        assert!(filter.position_sd() < 0.01, "{}", filter.position_sd());
    }

    #[test]
    fn a_contact_that_is_far_off_changes_nothing() {
        let mut filter = PoseFilter::default();
        let pose = Pose::new(0.0, 0.0, 0.0);
        let surface = Surface { at: Point::new(0.3, 0.0), normal: Vector::new(1.0, 0.0) };
        assert_eq!(filter.update(pose, Point::new(0.16, 0.0), &surface), None);
    }
}
