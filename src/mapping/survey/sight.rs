//! What is seen makes the survey more certain: a lap laid on its own beginning, a touch of something
//! mapped, and walls that are straight or round.

use super::{FIRST_KNOT, GATE, POSE, Survey, Tie};
use crate::geometry::{Point, Pose, Vector, perp};
use nalgebra::{DVector, Matrix3, Vector3};

/// A contact about the surface it lies on, metres: jitter of the switch, fit of the wall.
const CONTACT_SD: f64 = 0.002;
/// How far off a surface may be before anything is known of it, metres.
const SURFACE_SD: f64 = 0.3;

/// Where a contact should lie: a point of the mapped surface, its unit normal to either side, and
/// what that surface hangs on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// The mapped point nearest to the contact, as believed now.
    pub at: Point,
    /// Unit normal.
    pub normal: Vector,
    /// What it hangs on.
    pub tie: Tie,
    /// Standard deviation of the mapped contacts about it, metres: large where it is ragged.
    pub sd: f64,
    /// A contact farther off than this is not of it, metres.
    pub within: f64,
}

/// How far something seen from the lap lies off a surface that may lie anywhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    /// The knots between which it was seen.
    tie: (usize, usize),
    /// By how much it moves off with the errors of these knots.
    knots: [[f64; 3]; 2],
    /// By how much the surface follows with each of its unknowns.
    surface: [f64; 3],
    /// How far off it is, metres.
    off: f64,
    variance: f64,
}

impl Look {
    /// Whether both hang on the same knots.
    #[must_use]
    pub fn is_of(&self, other: &Self) -> bool {
        self.tie == other.tie
    }

    /// Adds another that hangs on the same knots.
    pub fn add(&mut self, other: &Self) {
        for k in 0..3 {
            self.knots[0][k] += other.knots[0][k];
            self.knots[1][k] += other.knots[1][k];
            self.surface[k] += other.surface[k];
        }
        self.off += other.off;
    }

    /// The mean of `count` that were added, good to `variance` (square metres).
    #[must_use]
    pub fn mean_of(mut self, count: f64, variance: f64) -> Self {
        for k in 0..3 {
            self.knots[0][k] /= count;
            self.knots[1][k] /= count;
            self.surface[k] /= count;
        }
        Self { off: self.off / count, variance, ..self }
    }
}

impl Survey {
    /// Lays the pose at knot `late` on the place of knot `early`. By how much it is off was measured
    /// with `normal` and `right`, the normal equations of (x, y, heading); directions that they say
    /// nothing of stay as they are.
    pub fn close(&mut self, early: &Tie, late: &Tie, normal: &Matrix3<f64>, right: &Vector3<f64>) {
        let rows = self.relation(early, late);
        let eigen = normal.symmetric_eigen();
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value < 1.0 {
                continue;
            }
            let row: Vec<(usize, f64)> = rows
                .iter()
                .zip(vector.iter())
                .flat_map(|(row, weight)| row.iter().map(move |(k, w)| (*k, w * weight)))
                .collect();
            let predicted = self.expected(&row);
            let measured = -vector.dot(right) / value;
            self.update(&row, measured - predicted, 1.0 / value);
        }
    }

    /// Takes a contact at `contact`, seen from `pose`, that should lie on `surface`; returns the
    /// corrected pose, or none when it is too far off to be that surface.
    pub fn touch(&mut self, pose: Pose, contact: Point, surface: &Surface) -> Option<Pose> {
        // Once, and not for each two of the rows.
        self.covariance.settle();
        let normal = surface.normal;
        let arm = contact - pose.position;
        let mut row =
            vec![(POSE, normal.x), (POSE + 1, normal.y), (POSE + 2, normal.dot(&perp(arm)))];
        // What is known of the pose beyond what was handed out, the contact moves with already.
        let off = normal.dot(&(contact - surface.at)) + self.expected(&row);
        row.extend(self.across(surface, normal, -1.0));
        let variance = CONTACT_SD.max(surface.sd).powi(2);
        let spread = self.covariance.spread(&row) + variance;
        if off * off > GATE * GATE * spread || off.abs() > surface.within {
            return None;
        }
        self.update(&row, -off, variance);
        Some(self.take_pose(pose))
    }

    /// By how much `surface` moves along `normal` with the errors of its knots, `sign` times.
    fn across(&self, surface: &Surface, normal: Vector, sign: f64) -> [(usize, f64); 6] {
        let tie = surface.tie;
        let of = |index: usize, weight: f64| {
            let start = FIRST_KNOT + 3 * index;
            let lever = normal.dot(&perp(surface.at - self.knots[index].at));
            let weight = sign * weight;
            [
                (start, weight * normal.x),
                (start + 1, weight * normal.y),
                (start + 2, weight * lever),
            ]
        };
        let ([a, b, c], [d, e, f]) = (of(tie.first, 1.0 - tie.share), of(tie.second, tie.share));
        [a, b, c, d, e, f]
    }

    /// Variance of the distance between two surfaces, across the first of them, square metres.
    #[must_use]
    pub fn between(&self, one: &Surface, other: &Surface) -> f64 {
        let mut row = self.across(one, one.normal, 1.0).to_vec();
        row.extend(self.across(other, one.normal, -1.0));
        self.covariance.spread(&row)
    }

    /// Moves `far` away from `near` along the normal of that, `by` so many metres, which is as sure as `near`.
    pub fn part(&mut self, near: &Surface, far: &Surface, by: f64) {
        let mut row = self.across(far, near.normal, 1.0).to_vec();
        row.extend(self.across(near, near.normal, -1.0));
        let innovation = by - self.expected(&row);
        let variance = near.sd * near.sd;
        if innovation * innovation < GATE * GATE * (self.covariance.spread(&row) + variance) {
            self.update(&row, innovation, variance);
        }
    }

    /// What is `off` a surface along `normal`, at `point` as believed when its knots were marked;
    /// `surface` says how that surface moves off with its unknowns.
    #[must_use]
    pub fn look(
        &self,
        point: Point,
        normal: Vector,
        tie: &Tie,
        off: f64,
        surface: [f64; 3],
    ) -> Look {
        let of = |index: usize, weight: f64| {
            let lever = normal.dot(&perp(point - self.knots[index].at));
            [weight * normal.x, weight * normal.y, weight * lever]
        };
        let knots = [of(tie.first, 1.0 - tie.share), of(tie.second, tie.share)];
        Look { tie: (tie.first, tie.second), knots, surface, off, variance: 0.0 }
    }

    /// Lays all of `looks` on one surface that is itself unknown. Looks that cannot be of it at all
    /// are passed over.
    pub fn lay(&mut self, looks: &[Look]) {
        let size = self.mean.len();
        self.covariance.extend(SURFACE_SD * SURFACE_SD);
        self.mean =
            std::mem::replace(&mut self.mean, DVector::zeros(0)).resize_vertically(size + 3, 0.0);
        for look in looks {
            let mut row: Vec<(usize, f64)> = Vec::with_capacity(9);
            for (index, weights) in [look.tie.0, look.tie.1].into_iter().zip(look.knots) {
                let start = FIRST_KNOT + 3 * index;
                row.extend(weights.into_iter().enumerate().map(|(k, w)| (start + k, w)));
            }
            row.extend(look.surface.into_iter().enumerate().map(|(k, w)| (size + k, -w)));
            let predicted = self.expected(&row);
            let innovation = -look.off - predicted;
            let spread = self.covariance.spread(&row) + look.variance;
            if innovation * innovation < GATE * GATE * spread {
                self.update(&row, innovation, look.variance);
            }
        }
        self.covariance.shorten();
        self.mean =
            std::mem::replace(&mut self.mean, DVector::zeros(0)).resize_vertically(size, 0.0);
    }
}
