//! One piece of an outline: straight or a circular arc.

use super::{Point, Vector, angle, cross, perp};
use serde::{Deserialize, Serialize};

/// One piece of an outline, from its start to its end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Piece {
    /// A straight piece.
    Line {
        /// Where it begins.
        from: Point,
        /// Where it ends.
        to: Point,
    },
    /// A circular piece.
    Arc {
        /// Centre of the circle.
        center: Point,
        /// Radius, metres, positive.
        radius: f64,
        /// Direction from the centre to the start, radians.
        start: f64,
        /// Angle swept from the start, radians; positive is counter-clockwise.
        sweep: f64,
    },
}

/// An arc that rises less than this above its chord, metres, is none: its centre would be so far away that
/// no number tells where its ends are.
const FLAT: f64 = 1e-6;

impl Piece {
    /// Where the piece begins.
    #[must_use]
    pub fn from(&self) -> Point {
        match *self {
            Self::Line { from, .. } => from,
            Self::Arc { center, radius, start, .. } => center + angle::unit(start) * radius,
        }
    }

    /// Where the piece ends.
    #[must_use]
    pub fn to(&self) -> Point {
        match *self {
            Self::Line { to, .. } => to,
            Self::Arc { center, radius, start, sweep } => {
                center + angle::unit(start + sweep) * radius
            }
        }
    }

    /// Length along the piece, metres.
    #[must_use]
    pub fn length(&self) -> f64 {
        match *self {
            Self::Line { from, to } => (to - from).norm(),
            Self::Arc { radius, sweep, .. } => radius * sweep.abs(),
        }
    }

    /// The point a share `t` (0 to 1) of the length along the piece.
    #[must_use]
    pub fn at(&self, t: f64) -> Point {
        match *self {
            Self::Line { from, to } => from + (to - from) * t,
            Self::Arc { center, radius, start, sweep } => {
                center + angle::unit(start + sweep * t) * radius
            }
        }
    }

    /// Unit direction of travel a share `t` along the piece; zero for a piece without length.
    #[must_use]
    pub fn tangent(&self, t: f64) -> Vector {
        match *self {
            Self::Line { from, to } => {
                (to - from).try_normalize(1e-12).unwrap_or_else(Vector::zeros)
            }
            Self::Arc { start, sweep, .. } => {
                perp(angle::unit(start + sweep * t)) * if sweep < 0.0 { -1.0 } else { 1.0 }
            }
        }
    }

    /// The share of the length (0 to 1) at which the piece comes nearest to `p`.
    #[must_use]
    pub fn nearest(&self, p: Point) -> f64 {
        match *self {
            Self::Line { from, to } => {
                let along = to - from;
                let square = along.norm_squared();
                if square < 1e-18 { 0.0 } else { ((p - from).dot(&along) / square).clamp(0.0, 1.0) }
            }
            Self::Arc { center, start, sweep, .. } => {
                let toward = angle::of(p - center);
                let turned = if sweep < 0.0 {
                    angle::wrap_positive(start - toward)
                } else {
                    angle::wrap_positive(toward - start)
                };
                let size = sweep.abs();
                if turned <= size {
                    turned / size.max(1e-12)
                } else if turned - size < (angle::TAU - size) / 2.0 {
                    1.0
                } else {
                    0.0
                }
            }
        }
    }

    /// What lies between the shares `from` and `to` (0 to 1) of the length.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        match *self {
            Self::Line { .. } => Self::Line { from: self.at(from), to: self.at(to) },
            Self::Arc { center, radius, start, sweep } => Self::Arc {
                center,
                radius,
                start: angle::wrap(start + sweep * from),
                sweep: sweep * (to - from),
            },
        }
    }

    /// Distance from `p` to the nearest point of the piece, metres.
    #[must_use]
    pub fn distance(&self, p: Point) -> f64 {
        (self.at(self.nearest(p)) - p).norm()
    }

    /// The piece run the other way.
    #[must_use]
    pub fn reversed(&self) -> Self {
        match *self {
            Self::Line { from, to } => Self::Line { from: to, to: from },
            Self::Arc { center, radius, start, sweep } => {
                Self::Arc { center, radius, start: angle::wrap(start + sweep), sweep: -sweep }
            }
        }
    }

    /// tan(sweep / 4), as in DXF; zero for a straight piece.
    #[must_use]
    pub fn bulge(&self) -> f64 {
        match self {
            Self::Line { .. } => 0.0,
            Self::Arc { sweep, .. } => angle::tan(sweep / 4.0),
        }
    }

    /// The circular piece from `from` to `to` with `bulge` = tan(sweep / 4), as in DXF; a straight
    /// one where the arc would rise less than a micrometre above its chord.
    #[must_use]
    pub fn with_bulge(from: Point, to: Point, bulge: f64) -> Self {
        let chord = to - from;
        let length = chord.norm();
        if (bulge * length / 2.0).abs() < FLAT || length == 0.0 {
            return Self::Line { from, to };
        }
        let sweep = 4.0 * angle::atan(bulge);
        let radius = length / (2.0 * angle::sin(sweep.abs() / 2.0));
        // The centre lies left of the chord for a counter-clockwise arc below a half turn.
        let offset = radius * angle::cos(sweep.abs() / 2.0) * bulge.signum();
        let center = from + chord * 0.5 + perp(chord) * (offset / length);
        Self::Arc { center, radius, start: angle::of(from - center), sweep }
    }

    /// Bulge of the arc from `a` through `p` to `c`: the angle at `p` is half of what the arc lacks of a
    /// whole turn (inscribed angle).
    #[must_use]
    pub fn bulge_through(a: Point, p: Point, c: Point) -> f64 {
        let (u, v) = (a - p, c - p);
        let side = cross(u, v);
        let half = angle::atan2(side.abs(), u.dot(&v)) / 2.0;
        -side.signum() / angle::tan(half).max(1e-9)
    }

    /// The same piece with its ends at `from` and `to`. An arc keeps its bulge; the ends of one of more than
    /// half a turn say little of where its circle lies, and it goes on through its middle, which `moved`
    /// moves.
    #[must_use]
    pub fn between(&self, from: Point, to: Point, moved: impl Fn(Point) -> Point) -> Self {
        match self {
            Self::Line { .. } => Self::Line { from, to },
            Self::Arc { sweep, .. } if sweep.abs() > angle::PI => {
                Self::with_bulge(from, to, Self::bulge_through(from, moved(self.at(0.5)), to))
            }
            Self::Arc { .. } => Self::with_bulge(from, to, self.bulge()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Programs that draw write such bulges for straight walls: what rounding left of nothing.
    #[test]
    fn a_bulge_of_next_to_nothing_leaves_the_ends_where_they_are() {
        let (from, to) = (Point::new(0.3, 0.7), Point::new(5.1, 2.9));
        for exponent in 1..20 {
            for bulge in [1.0, -1.0].map(|sign| sign * 10_f64.powi(-exponent)) {
                let piece = Piece::with_bulge(from, to, bulge);
                let off = (piece.from() - from).norm().max((piece.to() - to).norm());
                assert!(off < 1e-8, "bulge {bulge}: the ends are {off} m off, {piece:?}");
                let rise = bulge * (to - from).norm() / 2.0;
                let middle = nalgebra::center(&from, &to);
                let told = (piece.at(0.5) - middle).norm();
                assert!((told - rise.abs()).abs() < 2e-6, "bulge {bulge}: rises by {told}");
            }
        }
    }
}
