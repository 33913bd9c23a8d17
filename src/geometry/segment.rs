//! Straight segments and the distances between them, the currency of rasters and indexes: arcs
//! are cut into chords first, so that the inner loops know one kind of piece only.

use super::{Point, Ring, Vector, cross};

/// A straight segment, with what distance queries need worked out once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Where it begins.
    pub from: Point,
    /// From its beginning to its end.
    pub along: Vector,
    /// Where it ends, to the last bit: added up from the two above it would not be where the next one begins.
    to: Point,
    /// One over its squared length; zero for a segment without length.
    inverse: f64,
}

impl Segment {
    /// The segment between two points.
    #[must_use]
    pub fn new(from: Point, to: Point) -> Self {
        let along = to - from;
        let square = along.norm_squared();
        Self { from, along, to, inverse: if square > 1e-18 { 1.0 / square } else { 0.0 } }
    }

    /// Where it ends.
    #[must_use]
    pub fn to(&self) -> Point {
        self.to
    }

    /// Length, metres.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.along.norm()
    }

    /// The point of the segment nearest to `p`.
    #[must_use]
    pub fn nearest(&self, p: Point) -> Point {
        let t = ((p - self.from).dot(&self.along) * self.inverse).clamp(0.0, 1.0);
        self.from + self.along * t
    }

    /// Squared distance from `p`, square metres.
    #[must_use]
    pub fn distance_squared(&self, p: Point) -> f64 {
        let away = p - self.from;
        let t = (away.dot(&self.along) * self.inverse).clamp(0.0, 1.0);
        (away - self.along * t).norm_squared()
    }

    /// Squared distance between two segments, square metres; zero when they meet.
    #[must_use]
    pub fn gap_squared(&self, other: &Self) -> f64 {
        if self.crosses(other) {
            return 0.0;
        }
        self.distance_squared(other.from)
            .min(self.distance_squared(other.to()))
            .min(other.distance_squared(self.from))
            .min(other.distance_squared(self.to()))
    }

    /// Whether the two properly cross; touching ends are left to the distances.
    #[must_use]
    pub fn crosses(&self, other: &Self) -> bool {
        let a = cross(self.along, other.from - self.from);
        let b = cross(self.along, other.to() - self.from);
        let c = cross(other.along, self.from - other.from);
        let d = cross(other.along, self.to() - other.from);
        a * b < 0.0 && c * d < 0.0
    }
}

/// The outline as segments; arcs are cut into chords within `sagitta` metres. Pieces without
/// length vanish.
#[must_use]
pub fn chords(ring: &Ring, sagitta: f64) -> Vec<Segment> {
    let points = ring.to_points(sagitta);
    let count = points.len();
    (0..count)
        .map(|k| Segment::new(points[k], points[(k + 1) % count]))
        .filter(|segment| segment.inverse > 0.0)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_that_cross_touch_or_miss_have_the_distance_drawn_on_paper() {
        let cross_beam = Segment::new(Point::new(0.0, 0.0), Point::new(2.0, 0.0));
        let cases = [
            ((1.0, -1.0), (1.0, 1.0), 0.0, "crossing"),
            ((1.0, 0.0), (1.0, 1.0), 0.0, "touching"),
            ((1.0, 0.5), (1.0, 1.0), 0.25, "above"),
            ((3.0, 1.0), (3.0, 2.0), 2.0, "off the end"),
            ((0.5, 0.3), (1.5, 0.3), 0.09, "parallel"),
        ];
        for (a, b, want, what) in cases {
            let other = Segment::new(Point::new(a.0, a.1), Point::new(b.0, b.1));
            let gap = cross_beam.gap_squared(&other);
            assert!((gap - want).abs() < 1e-12, "{what}: {gap} instead of {want}");
        }
    }
}
