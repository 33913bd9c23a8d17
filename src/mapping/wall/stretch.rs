//! A straight stretch of wall, fitted to a few contacts.

use crate::geometry::{Point, Vector, angle, cross, meeting};

/// A straight stretch of wall: a point on it and its unit direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// A point on it.
    pub at: Point,
    /// Unit direction.
    pub along: Vector,
    /// Root mean square distance of the points it was fitted to, metres.
    pub residual: f64,
}

impl Stretch {
    /// Total least squares through `points`; none for fewer than two distinct points.
    #[must_use]
    pub fn through(points: &[Point]) -> Option<Self> {
        let count = points.len() as f64;
        if points.len() < 2 {
            return None;
        }
        let sum = points.iter().fold(Vector::zeros(), |sum, p| sum + p.coords);
        let at = Point::from(sum / count);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for p in points {
            let off = p - at;
            xx += off.x * off.x;
            xy += off.x * off.y;
            yy += off.y * off.y;
        }
        if xx + yy < 1e-8 {
            return None;
        }
        let along = angle::unit(angle::atan2(2.0 * xy, xx - yy) / 2.0);
        let across: f64 = points.iter().map(|p| cross(along, p - at).powi(2)).sum();
        Some(Self { at, along, residual: (across / count).sqrt() })
    }

    /// Distance along the ray from `from` towards `direction` to this stretch; none if they run
    /// (nearly) side by side or it lies behind.
    #[must_use]
    pub fn meets(&self, from: Point, direction: Vector) -> Option<f64> {
        if cross(direction, self.along).abs() < 0.1 {
            return None;
        }
        let distance = meeting(from, direction, self.at, self.along);
        (distance > 0.0).then_some(distance)
    }

    /// Distance of `p` from the line, metres, unsigned.
    #[must_use]
    pub fn distance(&self, p: Point) -> f64 {
        cross(self.along, p - self.at).abs()
    }
}
