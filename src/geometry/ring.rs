//! Closed outlines of straight and circular pieces.

use super::{Piece, Point, Vector, angle, cross};
use serde::{Deserialize, Serialize};

/// A closed outline: each piece begins where the one before it ends.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Ring {
    /// The pieces in order.
    pub pieces: Vec<Piece>,
}

/// The place on a ring nearest to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Index of the piece.
    pub piece: usize,
    /// Share of that piece's length, 0 to 1.
    pub t: f64,
    /// The place itself.
    pub point: Point,
    /// How far away it is, metres.
    pub distance: f64,
}

impl Ring {
    /// A polygon through `vertices`, which closes itself.
    #[must_use]
    pub fn polygon(vertices: &[Point]) -> Self {
        let count = vertices.len();
        let pieces = (0..count)
            .map(|k| Piece::Line { from: vertices[k], to: vertices[(k + 1) % count] })
            .collect();
        Self { pieces }
    }

    /// A full circle, counter-clockwise from the direction +x.
    #[must_use]
    pub fn circle(center: Point, radius: f64) -> Self {
        Self { pieces: vec![Piece::Arc { center, radius, start: 0.0, sweep: angle::TAU }] }
    }

    /// Whether it is one whole circle.
    #[must_use]
    pub fn is_circle(&self) -> bool {
        matches!(self.pieces[..], [Piece::Arc { .. }])
    }

    /// Signed area, square metres; positive when the ring runs counter-clockwise.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.pieces
            .iter()
            .map(|piece| {
                let chord = cross(piece.from().coords, piece.to().coords) / 2.0;
                match *piece {
                    Piece::Line { .. } => chord,
                    Piece::Arc { radius, sweep, .. } => {
                        chord + radius * radius * (sweep - angle::sin(sweep)) / 2.0
                    }
                }
            })
            .sum()
    }

    /// Length of the outline, metres.
    #[must_use]
    pub fn perimeter(&self) -> f64 {
        self.pieces.iter().map(Piece::length).sum()
    }

    /// The place on the ring nearest to `p`; none for a ring without pieces.
    #[must_use]
    pub fn nearest(&self, p: Point) -> Option<Foot> {
        self.nearest_where(p, |_, _| true)
    }

    /// The nearest of those places on the ring that `counts` accepts, of each piece the one nearest to
    /// `p`: told the piece and the share of its length.
    #[must_use]
    pub fn nearest_where(&self, p: Point, counts: impl Fn(&Piece, f64) -> bool) -> Option<Foot> {
        let mut best: Option<Foot> = None;
        for (index, piece) in self.pieces.iter().enumerate() {
            let t = piece.nearest(p);
            let point = piece.at(t);
            let distance = (point - p).norm();
            if best.is_none_or(|b| distance < b.distance) && counts(piece, t) {
                best = Some(Foot { piece: index, t, point, distance });
            }
        }
        best
    }

    /// Distance from `p` to the outline, metres; infinite for a ring without pieces.
    #[must_use]
    pub fn distance(&self, p: Point) -> f64 {
        self.nearest(p).map_or(f64::INFINITY, |foot| foot.distance)
    }

    /// Whether `p` lies inside, by winding number; on the outline itself either answer may come.
    #[must_use]
    pub fn contains(&self, p: Point) -> bool {
        // Each piece begins where the one before it ends, to the last bit: the ends of an arc are worked out, and a
        // height that lies between two versions of one corner would be counted twice, or not at all.
        let mut crossings = 0;
        let Some(mut from) = self.pieces.last().map(Piece::to) else { return false };
        for piece in &self.pieces {
            let to = piece.to();
            crossings += match *piece {
                Piece::Line { .. } => crossing(from, to, p),
                Piece::Arc { .. } => {
                    // Chords of at most an eighth turn; the sliver between chord and arc is
                    // decided by the circle itself.
                    arc_crossings(piece, (from, to), p)
                }
            };
            from = to;
        }
        crossings != 0
    }

    /// The outline as points, without repeating the first; arcs are cut into chords whose middle
    /// lies at most `sagitta` metres off the arc.
    #[must_use]
    pub fn to_points(&self, sagitta: f64) -> Vec<Point> {
        let mut points = Vec::new();
        for piece in &self.pieces {
            let steps = match *piece {
                Piece::Line { .. } => 1,
                Piece::Arc { radius, sweep, .. } => chord_count(radius, sweep, sagitta),
            };
            points.extend((0..steps).map(|k| piece.at(f64::from(k) / f64::from(steps))));
        }
        points
    }

    /// The same outline run the other way.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self { pieces: self.pieces.iter().rev().map(Piece::reversed).collect() }
    }

    /// The same outline, counter-clockwise.
    #[must_use]
    pub fn counter_clockwise(self) -> Self {
        if self.area() < 0.0 { self.reversed() } else { self }
    }

    /// The same ring with its corners moved; an arc keeps its bulge, a full circle its radius, and an arc of
    /// more than half a turn is moved by its middle too.
    #[must_use]
    pub fn deformed(&self, displacement: impl Fn(Point) -> Vector) -> Self {
        if let [Piece::Arc { center, radius, start, sweep }] = self.pieces[..] {
            let around: Vec<Vector> = (0..4)
                .map(|k| {
                    displacement(center + angle::unit(f64::from(k) * angle::PI / 2.0) * radius)
                })
                .collect();
            let mean = around.iter().sum::<Vector>() / around.len() as f64;
            return Self {
                pieces: vec![Piece::Arc { center: center + mean, radius, start, sweep }],
            };
        }
        let corners: Vec<Point> =
            self.pieces.iter().map(|piece| piece.from() + displacement(piece.from())).collect();
        let count = corners.len();
        let pieces = self.pieces.iter().enumerate().map(|(k, piece)| {
            piece.between(corners[k], corners[(k + 1) % count], |p| p + displacement(p))
        });
        Self { pieces: pieces.collect() }
    }

    /// The box around the outline: its lowest and highest corner; none without pieces.
    #[must_use]
    pub fn bounds(&self) -> Option<(Point, Point)> {
        bounds(&self.to_points(1e-3))
    }

    /// The middle of its bounds; the origin without pieces.
    #[must_use]
    pub fn middle(&self) -> Point {
        self.bounds().map_or_else(Point::origin, |(low, high)| nalgebra::center(&low, &high))
    }
}

/// The box around some points: its lowest and highest corner; none without points.
#[must_use]
pub fn bounds(points: &[Point]) -> Option<(Point, Point)> {
    let first = *points.first()?;
    Some(points.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p))))
}

/// How many chords an arc needs so that none strays more than `sagitta` metres from it. No chord is asked to span
/// less than a milliradian: of a circle of more than 8e6 times the sagitta (800 m for a tenth of a millimetre) they
/// stray farther, by the radius over 8e6.
#[must_use]
pub fn chord_count(radius: f64, sweep: f64, sagitta: f64) -> u32 {
    let widest = 2.0 * angle::acos(1.0 - (sagitta / radius).min(1.0));
    ((sweep.abs() / widest.max(1e-3)).ceil() as u32).max(2)
}

/// +1 or -1 when the straight piece crosses the ray from `p` towards +x, else 0.
fn crossing(from: Point, to: Point, p: Point) -> i32 {
    let side = cross(to - from, p - from);
    if from.y <= p.y && to.y > p.y && side > 0.0 {
        1
    } else if from.y > p.y && to.y <= p.y && side < 0.0 {
        -1
    } else {
        0
    }
}

/// The same for an arc, whose `ends` it has in common with its neighbours.
fn arc_crossings(arc: &Piece, ends: (Point, Point), p: Point) -> i32 {
    let Piece::Arc { center, radius, sweep, .. } = *arc else {
        return 0;
    };
    let steps = ((sweep.abs() / angle::FRAC_PI_4).ceil() as u32).max(1);
    let (mut total, mut from) = (0, ends.0);
    for k in 1..=steps {
        let to = if k == steps { ends.1 } else { arc.at(f64::from(k) / f64::from(steps)) };
        total += crossing(from, to, p);
        // Within the sliver between the chord and the arc the chord's answer is one turn short.
        let outward = if sweep > 0.0 { -1.0 } else { 1.0 };
        let beyond_chord = cross(to - from, p - from) * outward > 0.0;
        if beyond_chord && (p - center).norm() < radius {
            total += if sweep > 0.0 { 1 } else { -1 };
        }
        from = to;
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stadium() -> Ring {
        let corner = |x: f64, y: f64| Point::new(x, y);
        Ring {
            pieces: vec![
                Piece::with_bulge(corner(0.0, 0.0), corner(4.0, 0.0), 0.0),
                Piece::with_bulge(corner(4.0, 0.0), corner(4.0, 2.0), 1.0),
                Piece::with_bulge(corner(4.0, 2.0), corner(0.0, 2.0), 0.0),
                Piece::with_bulge(corner(0.0, 2.0), corner(0.0, 0.0), 1.0),
            ],
        }
    }

    /// A place as high as a corner where an arc begins is inside or outside as one a hair higher is.
    #[test]
    fn the_height_at_which_an_arc_begins_is_counted_once() {
        for (k, bulge) in (0..400).flat_map(|k| [(k, 0.3), (k, -0.2)]) {
            let (low, high) = (0.5 + 0.1 * f64::from(k % 20), 3.0 + 0.1 * f64::from(k / 20));
            let corners = [
                (0.0, 0.0, 0.0),
                (6.0, 0.0, 0.0),
                (6.0, low, bulge),
                (6.0, high, 0.0),
                (6.0, 6.0, 0.0),
            ];
            let corners = corners.iter().chain(&[(0.0, 6.0, 0.0)]);
            let corners: Vec<(Point, f64)> =
                corners.map(|&(x, y, bulge)| (Point::new(x, y), bulge)).collect();
            let pieces = (0..corners.len()).map(|k| {
                let next = corners[(k + 1) % corners.len()].0;
                Piece::with_bulge(corners[k].0, next, corners[k].1)
            });
            let ring = Ring { pieces: pieces.collect() };
            for y in [low, high] {
                assert!(ring.contains(Point::new(1.0, y)), "{y} of {low} to {high}, {bulge}");
                assert!(!ring.contains(Point::new(-1.0, y)), "{y} of {low} to {high}, {bulge}");
            }
        }
    }

    #[test]
    fn a_stadium_has_the_area_and_perimeter_of_the_textbook() {
        let ring = stadium();
        assert!((ring.area() - (8.0 + angle::PI)).abs() < 1e-9, "{}", ring.area());
        assert!((ring.perimeter() - (8.0 + angle::TAU)).abs() < 1e-9, "{}", ring.perimeter());
        assert!((ring.reversed().area() + ring.area()).abs() < 1e-9);
    }

    #[test]
    fn a_round_room_stays_round_when_the_ends_of_its_wall_move_by_millimetres() {
        // A circle of 1.8 m with a notch; its wall is one arc whose ends are 0.3 m apart.
        let (radius, half) = (1.8, 0.083);
        let on = |bearing: f64| Point::origin() + angle::unit(bearing) * radius;
        let (from, to) = (on(half), on(-half));
        let wall = Piece::Arc {
            center: Point::origin(),
            radius,
            start: half,
            sweep: angle::TAU - 2.0 * half,
        };
        let notch = [to, Point::new(1.5, -0.15), Point::new(1.5, 0.15), from];
        let mut pieces = vec![wall];
        pieces.extend(notch.windows(2).map(|two| Piece::Line { from: two[0], to: two[1] }));
        let ring = Ring { pieces };
        // One end of it 4 mm farther along.
        let moved = ring.deformed(|p| Vector::new(0.0, if p == from { 0.004 } else { 0.0 }));
        let Piece::Arc { center, radius: now, .. } = moved.pieces[0] else {
            unreachable!("an arc stays one")
        };
        // The centre stays as far from both ends: half as far along.
        let off = (center - Point::new(0.0, 0.002)).norm();
        assert!((now - radius).abs() < 2e-4 && off < 2e-4, "{now} at {center}");
        assert!((moved.area() - ring.area()).abs() < 0.01);
        // And all of it moves as one.
        let by = Vector::new(0.3, -0.2);
        assert!((ring.deformed(|_| by).pieces[0].at(0.5) - wall.at(0.5) - by).norm() < 1e-9);
    }

    #[test]
    fn containment_agrees_with_the_shape_on_a_lattice() {
        let ring = stadium();
        for i in -20..=80 {
            for j in -20..=60 {
                let p = Point::new(f64::from(i) * 0.0837, f64::from(j) * 0.0713);
                let nearest_on_spine = Point::new(p.x.clamp(0.0, 4.0), 1.0);
                let off = (p - nearest_on_spine).norm() - 1.0;
                let in_box = p.x > 0.0 && p.x < 4.0 && p.y > 0.0 && p.y < 2.0;
                if off.abs() > 1e-6 {
                    assert_eq!(ring.contains(p), off < 0.0 || in_box, "at {p}");
                }
            }
        }
    }

    #[test]
    fn an_arc_that_bends_inwards_is_cut_out() {
        let quarter = angle::tan(angle::PI / 8.0);
        let vertices = [(0.0, 0.0, -quarter), (2.0, 0.0, 0.0), (2.0, 2.0, 0.0), (0.0, 2.0, 0.0)];
        let pieces = (0..4)
            .map(|k| {
                let (x0, y0, bulge) = vertices[k];
                let (x1, y1, _) = vertices[(k + 1) % 4];
                Piece::with_bulge(Point::new(x0, y0), Point::new(x1, y1), bulge)
            })
            .collect();
        let ring = Ring { pieces };
        let segment = (angle::PI / 4.0 * 2.0) - 1.0;
        assert!((ring.area() - (4.0 - segment)).abs() < 1e-9, "{}", ring.area());
        assert!(!ring.contains(Point::new(1.0, 0.2)));
        assert!(ring.contains(Point::new(1.0, 0.5)));
    }

    #[test]
    fn chords_stay_within_the_sagitta() {
        let ring = Ring::circle(Point::new(1.0, 1.0), 2.0);
        let points = ring.to_points(0.001);
        for (k, a) in points.iter().enumerate() {
            let b = points[(k + 1) % points.len()];
            let middle = nalgebra::center(a, &b);
            assert!(2.0 - (middle - Point::new(1.0, 1.0)).norm() <= 0.001 + 1e-12);
        }
    }
}
