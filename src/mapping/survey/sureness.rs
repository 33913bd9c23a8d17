//! How sure the survey is of the robot's pose and of places, read off its covariance. Nothing here changes
//! what is believed.

use super::{FIRST_KNOT, POSE, Survey, Tie};
use crate::geometry::{Point, angle, perp};
use nalgebra::{Matrix2, Matrix3};

impl Survey {
    /// Rows of (x, y, heading) of the error of `place`, which hangs on `tie`.
    pub(super) fn hanging(&self, place: Point, tie: &Tie) -> [Vec<(usize, f64)>; 3] {
        let mut rows: [Vec<(usize, f64)>; 3] = [const { Vec::new() }; 3];
        for (index, share) in [(tie.first, 1.0 - tie.share), (tie.second, tie.share)] {
            let Some(knot) = self.knots.get(index) else { continue };
            let (start, arm) = (FIRST_KNOT + 3 * index, perp(place - knot.at));
            rows[0].extend([(start, share), (start + 2, share * arm.x)]);
            rows[1].extend([(start + 1, share), (start + 2, share * arm.y)]);
            rows[2].push((start + 2, share));
        }
        rows
    }

    /// Covariance of the error of the pose beside `place`, which hangs on `tie`: x, y in metres, heading in
    /// radians. What both are off by together does not count.
    #[must_use]
    pub fn spread_beside(&self, place: Point, tie: &Tie) -> Matrix3<f64> {
        let mut rows = [POSE, POSE + 1, POSE + 2].map(|row| vec![(row, 1.0)]);
        for (row, place) in rows.iter_mut().zip(self.hanging(place, tie)) {
            row.extend(place.into_iter().map(|(k, weight)| (k, -weight)));
        }
        Matrix3::from_fn(|i, j| {
            let terms =
                rows[i].iter().flat_map(|(k, v)| rows[j].iter().map(move |(l, w)| (*k, *l, v * w)));
            terms.map(|(k, l, weight)| self.covariance.of(k, l) * weight).sum()
        })
    }

    /// One standard deviation, in its worse direction, of the robot's position beside `place`, which hangs
    /// on `tie`, metres. What both are off by together does not count.
    #[must_use]
    pub fn looseness(&self, place: Point, tie: &Tie) -> f64 {
        worse(&self.spread_beside(place, tie).fixed_view::<2, 2>(0, 0).into_owned())
    }

    /// One standard deviation of the robot's position in its worse direction, metres.
    #[must_use]
    pub fn position_sd(&self) -> f64 {
        self.worst(POSE)
    }

    /// One standard deviation of the position of what hangs on a tie, in its worse direction,
    /// metres.
    #[must_use]
    pub fn sd_of(&self, tie: &Tie) -> f64 {
        let of = |index: usize| self.worst(FIRST_KNOT + 3 * index);
        of(tie.first) * (1.0 - tie.share) + of(tie.second) * tie.share
    }

    fn worst(&self, row: usize) -> f64 {
        worse(&Matrix2::from_fn(|i, j| self.covariance.of(row + i, row + j)))
    }

    /// Covariance of the place `point` that hangs on `tie`, x and y, square metres.
    #[must_use]
    pub fn spread_at(&self, point: Point, tie: &Tie) -> Matrix2<f64> {
        let rows = self.hanging(point, tie);
        Matrix2::from_fn(|i, j| {
            let terms = rows[i].iter().flat_map(|(k, v)| {
                rows[j].iter().map(move |(l, w)| self.covariance.of(*k, *l) * v * w)
            });
            terms.sum()
        })
    }

    /// One standard deviation of the heading, radians.
    #[must_use]
    pub fn heading_sd(&self) -> f64 {
        self.covariance.of(POSE + 2, POSE + 2).max(0.0).sqrt()
    }
}

/// Standard deviation along the longer axis of the ellipse of a plane covariance.
#[must_use]
pub fn worse(spread: &Matrix2<f64>) -> f64 {
    let (xx, xy, yy) = (spread[(0, 0)], spread[(0, 1)], spread[(1, 1)]);
    let (middle, spread) = (f64::midpoint(xx, yy), angle::hypot((xx - yy) / 2.0, xy));
    (middle + spread).max(0.0).sqrt()
}
