//! Whether a straight line stays inside a simple polygon, decided exactly: the answer is that of
//! a closed polygon covering the closed segment, walls grazed and vertices touched included.
//!
//! Orientation comes from Shewchuk's adaptive predicate (crate `robust`), so collinear walls and
//! vertices met in passing are decided by the numbers given, never by a tolerance.

use super::Point;
use std::cell::Cell;

/// A simple polygon, counter-clockwise, from whose corners lines are judged.
#[derive(Debug, Clone)]
pub struct Sight {
    corners: Vec<Point>,
    /// The edge that stopped the last line: it often stops the next one too.
    last: Cell<usize>,
}

/// Sign of the turn a, b, c: 1 to the left, -1 to the right, 0 for exactly straight.
#[must_use]
pub fn turn(a: Point, b: Point, c: Point) -> i8 {
    let left = (b.x - a.x) * (c.y - a.y);
    let right = (b.y - a.y) * (c.x - a.x);
    let det = left - right;
    // Shewchuk's first filter: beyond it rounding cannot have changed the sign.
    if det.abs() > 4e-16 * (left.abs() + right.abs()) {
        return if det > 0.0 { 1 } else { -1 };
    }
    let coord = |p: Point| robust::Coord { x: p.x, y: p.y };
    let exact = robust::orient2d(coord(a), coord(b), coord(c));
    i8::from(exact > 0.0) - i8::from(exact < 0.0)
}

impl Sight {
    /// For a polygon through `corners`, counter-clockwise.
    #[must_use]
    pub fn new(corners: Vec<Point>) -> Self {
        Self { corners, last: Cell::new(0) }
    }

    /// Whether the line from corner `from` to corner `to` stays inside.
    #[must_use]
    pub fn corner_to_corner(&self, from: usize, to: usize) -> bool {
        let (a, b) = (self.corners[from], self.corners[to]);
        self.opens(from, b) && self.opens(to, a) && self.is_free(a, b, usize::MAX)
    }

    /// Whether the line from corner `from` to `end`, a place on edge `edge` (from corner `edge` to
    /// the next) but not at its ends, stays inside. The place counts as being on the edge, whatever
    /// rounding did to it.
    #[must_use]
    pub fn corner_to_edge(&self, from: usize, edge: usize, end: Point) -> bool {
        let start = self.corners[from];
        let (a, b) = (self.corners[edge], self.corners[self.next(edge)]);
        turn(a, b, start) >= 0 && self.opens(from, end) && self.is_free(start, end, edge)
    }

    fn next(&self, corner: usize) -> usize {
        if corner + 1 == self.corners.len() { 0 } else { corner + 1 }
    }

    /// Whether going from corner `at` towards `q` leads into the polygon or along its rim.
    fn opens(&self, at: usize, q: Point) -> bool {
        let before = self.corners[(at + self.corners.len() - 1) % self.corners.len()];
        let (here, after) = (self.corners[at], self.corners[self.next(at)]);
        let (left_of_out, left_of_in) = (turn(here, after, q) >= 0, turn(before, here, q) >= 0);
        if turn(before, here, after) >= 0 {
            left_of_out && left_of_in
        } else {
            left_of_out || left_of_in
        }
    }

    /// Whether the open line from `a` to `b` meets no edge but `own` except by grazing it.
    fn is_free(&self, a: Point, b: Point, own: usize) -> bool {
        let last = self.last.get();
        if last < self.corners.len() && last != own && self.stops(a, b, last) {
            return false;
        }
        let blocker = (0..self.corners.len()).find(|&k| k != own && self.stops(a, b, k));
        if let Some(edge) = blocker {
            self.last.set(edge);
        }
        blocker.is_none()
    }

    /// Whether edge `k` cuts the line from `a` to `b`, or its first corner lies on that line and
    /// one of the line's halves leaves the polygon there.
    fn stops(&self, a: Point, b: Point, k: usize) -> bool {
        let (p, q) = (self.corners[k], self.corners[self.next(k)]);
        let (low_x, high_x) = if a.x < b.x { (a.x, b.x) } else { (b.x, a.x) };
        let (low_y, high_y) = if a.y < b.y { (a.y, b.y) } else { (b.y, a.y) };
        let apart = (p.x < low_x && q.x < low_x)
            || (p.x > high_x && q.x > high_x)
            || (p.y < low_y && q.y < low_y)
            || (p.y > high_y && q.y > high_y);
        if apart {
            return false;
        }
        let side = turn(a, b, p);
        if side == 0 {
            let along = b - a;
            let at = (p - a).dot(&along);
            let within = at > 0.0 && at < along.norm_squared() && p != a && p != b;
            return within && !(self.opens(k, a) && self.opens(k, b));
        }
        side * turn(a, b, q) < 0 && turn(p, q, a) * turn(p, q, b) < 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn comb() -> Vec<Point> {
        [
            (0, 0),
            (8, 0),
            (8, 4),
            (6, 4),
            (6, 2),
            (5, 2),
            (5, 4),
            (3, 4),
            (3, 2),
            (2, 2),
            (2, 4),
            (0, 4),
        ]
        .iter()
        .map(|&(x, y)| Point::new(f64::from(x), f64::from(y)))
        .collect()
    }

    /// Covered, decided the slow way on a lattice: the line is cut where it meets the lines of any
    /// edge, and the middle of each part must lie inside or on the rim. All in whole numbers.
    fn covers(corners: &[Point], a: Point, b: Point) -> bool {
        let whole = |p: Point| ((p.x * 2.0).round() as i128, (p.y * 2.0).round() as i128);
        let ring: Vec<_> = corners.iter().map(|&p| whole(p)).collect();
        let (a, b) = (whole(a), whole(b));
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        // Parameters along the line as fractions with positive denominators.
        let mut cuts = vec![(0, 1), (1, 1)];
        for k in 0..ring.len() {
            let (p, q) = (ring[k], ring[(k + 1) % ring.len()]);
            let (ex, ey) = (q.0 - p.0, q.1 - p.1);
            let det = dx * ey - dy * ex;
            let (num, den) = if det == 0 {
                ((p.0 - a.0) * dx + (p.1 - a.1) * dy, dx * dx + dy * dy)
            } else {
                ((p.0 - a.0) * ey - (p.1 - a.1) * ex, det)
            };
            let (num, den) = if den < 0 { (-num, -den) } else { (num, den) };
            if num > 0 && num < den {
                cuts.push((num, den));
            }
        }
        cuts.sort_by(|l, r| (l.0 * r.1).cmp(&(r.0 * l.1)));
        cuts.windows(2).all(|w| {
            let (n, d) = (w[0].0 * w[1].1 + w[1].0 * w[0].1, 2 * w[0].1 * w[1].1);
            inside_or_on(&ring, (a.0 * d + dx * n, a.1 * d + dy * n), d)
        })
    }

    fn inside_or_on(ring: &[(i128, i128)], p: (i128, i128), scale: i128) -> bool {
        let mut inside = false;
        for k in 0..ring.len() {
            let (q, r) = (ring[k], ring[(k + 1) % ring.len()]);
            let (q, r) = ((q.0 * scale, q.1 * scale), (r.0 * scale, r.1 * scale));
            let side = (r.0 - q.0) * (p.1 - q.1) - (r.1 - q.1) * (p.0 - q.0);
            let between = p.0 >= q.0.min(r.0) && p.0 <= q.0.max(r.0);
            if side == 0 && between && p.1 >= q.1.min(r.1) && p.1 <= q.1.max(r.1) {
                return true;
            }
            if (q.1 <= p.1) != (r.1 <= p.1) && ((side > 0) == (r.1 > q.1)) {
                inside = !inside;
            }
        }
        inside
    }

    fn agree(corners: &[Point]) {
        let sight = Sight::new(corners.to_vec());
        let count = corners.len();
        for from in 0..count {
            for to in (0..count).filter(|&to| to != from) {
                let want = covers(corners, corners[from], corners[to]);
                let got = sight.corner_to_corner(from, to);
                assert_eq!(got, want, "{} to {} in {corners:?}", corners[from], corners[to]);
            }
            for edge in (0..count).filter(|&e| e != from && (e + 1) % count != from) {
                let end = nalgebra::center(&corners[edge], &corners[(edge + 1) % count]);
                let want = covers(corners, corners[from], end);
                let got = sight.corner_to_edge(from, edge, end);
                assert_eq!(got, want, "{} to {end} in {corners:?}", corners[from]);
            }
        }
    }

    #[test]
    fn a_comb_with_walls_in_line_is_judged_as_by_covers() {
        agree(&comb());
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(7), cases: 200, ..ProptestConfig::default() })]
        /// Rooms between a jagged floor and a jagged ceiling on a coarse lattice: full of walls
        /// in line with each other and of vertices that lines just touch.
        #[test]
        fn jagged_rooms_are_judged_as_by_covers(
            low in prop::collection::vec(0_i32..4, 2..7),
            high in prop::collection::vec(4_i32..8, 2..7),
            steps in any::<bool>(),
        ) {
            let mut corners = Vec::new();
            let stride = if steps { 2.0 } else { 1.0 };
            let wide = low.len().max(high.len()) as f64 * 2.0;
            for (k, &y) in low.iter().enumerate() {
                corners.push(Point::new(k as f64 * stride, f64::from(y)));
                if steps { corners.push(Point::new(k as f64 * stride + 2.0, f64::from(y))); }
            }
            corners.push(Point::new(wide + 1.0, 4.0));
            for (k, &y) in high.iter().enumerate().rev() {
                if steps { corners.push(Point::new(k as f64 * stride + 2.0, f64::from(y))); }
                corners.push(Point::new(k as f64 * stride, f64::from(y)));
            }
            // Neighbours on one spot or straight through are no corners.
            corners.dedup();
            prop_assume!(corners.len() > 3 && low[0] < high[0]);
            agree(&corners);
        }
    }
}
