//! Frees a polygon of its crossings. Contacts out of order make loops of nothing; noise lays sides of something real
//! through each other. Knows points alone, not what they are of.

use super::chain::{TOLERANCE, thinned};
use crate::geometry::segment::Segment;
use crate::geometry::simple::crossings;
use crate::geometry::{Point, Ring, Vector, cross, meeting};

/// A loop at a crossing may be no more than contacts out of order up to this length, metres; a longer one is of
/// something, however thin that is.
const OUT_OF_ORDER: f64 = 0.3;
/// A loop longer than this, metres, may be an island, and is turned over only where that is wanted.
const LARGEST_LOOP: f64 = 1.0;
/// Where a loop goes or is turned over, a side that was cut in two keeps its end where it loses more than this by a
/// short cut to where the other one began, metres: as much is noise.
const CUT_OFF: f64 = 0.02;

/// A simple polygon from one that still crosses itself. The shorter loop at each crossing goes, unless it
/// is of something: what hangs on a neck that crosses itself is turned over, and the neck is open again, and so is
/// the end of a thin board whose faces noise has laid through each other. A loop of more than a metre goes like
/// that where its two sides that cross are to be `turned`; none else. What goes or is turned over leaves the sides
/// that crossed their ends.
pub(super) fn untangled(
    mut points: Vec<Point>,
    turned: impl Fn([(Point, Point); 2]) -> bool,
) -> Option<Ring> {
    // Contacts out of order make loops that enclose next to nothing.
    const THICK: f64 = 0.012;
    for _ in 0..200 {
        let Some(&(i, k)) = crossings(&points).first() else {
            let thin = thinned(&points, TOLERANCE);
            return (thin.len() >= 3).then(|| Ring::polygon(&thin));
        };
        let side = |n: usize| (points[n], points[(n + 1) % points.len()]);
        let ((a, b), (c, d)) = (side(i), side(k));
        let at = crossing(a, b, c, d).unwrap_or(b);
        // From the crossing round to the crossing.
        let length = |from: usize, to: usize| -> f64 {
            let between = (from..to).map(|n| side(n % points.len()));
            between.map(|(here, there)| (there - here).norm()).sum()
        };
        let inner = (b - at).norm() + length(i + 1, k) + (c - at).norm();
        let outer = (d - at).norm() + length(k + 1, points.len() + i) + (a - at).norm();
        let is_large = inner.min(outer) > LARGEST_LOOP;
        if is_large && !turned([(a, b), (c, d)]) {
            return None;
        }
        let mut looped: Vec<Point> = if inner <= outer {
            points[i + 1..=k].to_vec()
        } else {
            points[k + 1..].iter().chain(&points[..=i]).copied().collect()
        };
        looped.push(at);
        let is_cut_off = |from: Point, to: Point| {
            Segment::new(from, to).distance_squared(at) > CUT_OFF * CUT_OFF
        };
        let of_something = inner.min(outer) > OUT_OF_ORDER
            || Ring::polygon(&looped).area().abs() > THICK * inner.min(outer);
        if of_something {
            points[i + 1..=k].reverse();
            let [before, after] = beside(at, [(a, b), (c, d)]);
            if is_cut_off(b, d) {
                points.insert(k + 1, after);
            }
            if is_cut_off(a, c) {
                points.insert(i + 1, before);
            }
        } else if inner <= outer {
            points.splice(i + 1..=k, is_cut_off(a, d).then_some(at));
        } else {
            points.truncate(k + 1);
            points.drain(..=i);
            points.extend(is_cut_off(c, b).then_some(at));
        }
    }
    None
}

/// Two places beside the crossing `at` of two sides, one for each way that turns there from one side onto the
/// other when the loop between them is turned over: so far apart that those do not touch.
fn beside(at: Point, [(a, b), (c, d)]: [(Point, Point); 2]) -> [Point; 2] {
    let unit = |v: Vector| v.try_normalize(0.0).unwrap_or_else(Vector::zeros);
    let apart = unit(unit(b - a) + unit(d - c)) * (TOLERANCE / 2.0);
    [at - apart, at + apart]
}

/// Where the straight lines a-b and c-d meet.
pub(super) fn crossing(a: Point, b: Point, c: Point, d: Point) -> Option<Point> {
    let (u, v) = (b - a, d - c);
    (cross(u, v).abs() > 1e-12).then(|| a + u * meeting(a, u, c, v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Piece;

    fn polygon(corners: &[(f64, f64)]) -> Vec<Point> {
        corners.iter().map(|&(x, y)| Point::new(x, y)).collect()
    }

    fn corners_of(ring: &Ring) -> Vec<Point> {
        ring.pieces.iter().map(Piece::from).collect()
    }

    #[test]
    fn a_side_that_a_gap_crosses_near_its_end_stays() {
        // Right of a box of 0.3 m stands a pillar of 0.2 by 0.6 m on the lower wall. The robot does not pass between
        // them: one gap leads to the box and one back. Noise has put the second 10 mm across the pillar's corner.
        let points = polygon(&[
            (0.0, 0.0),
            (2.0, 0.0),
            (2.0, 0.6),
            (1.8, 0.8),
            (1.5, 0.8),
            (1.5, 1.1),
            (1.8, 1.1),
            (1.81, 0.8),
            (2.002, 0.59),
            (2.2, 0.6),
            (2.2, 0.0),
            (4.0, 0.0),
            (4.0, 3.0),
            (0.0, 3.0),
        ]);
        let mended = untangled(points, |_| true).expect("a room with a box");
        assert!(crossings(&corners_of(&mended)).is_empty(), "{mended:?}");
        for (what, x, y) in
            [("the pillar's side", 2.0, 0.3), ("its corner", 2.0, 0.59), ("the box", 1.5, 0.95)]
        {
            let off = mended.distance(Point::new(x, y));
            assert!(off < 0.01, "{what} is {off} m off: {mended:?}");
        }
    }

    #[test]
    fn a_face_at_whose_beginning_contacts_came_out_of_order_stays() {
        // The same box and pillar. Seen from the one side of the gap the pillar's top has begun already, and from
        // the other its side has not ended.
        let mut points = polygon(&[
            (0.0, 0.0),
            (2.0, 0.0),
            (2.0, 0.57),
            (1.8, 0.8),
            (1.5, 0.8),
            (1.5, 1.1),
            (1.8, 1.1),
            (1.81, 0.81),
            (2.009, 0.598),
            (2.018, 0.599),
            (2.0, 0.572),
            (1.998, 0.6),
            (2.2, 0.596),
            (2.2, 0.0),
            (4.0, 0.0),
            (4.0, 3.0),
            (0.0, 3.0),
        ]);
        for begun in 0..points.len() {
            points.rotate_left(1);
            let mended = untangled(points.clone(), |_| true).expect("a room with a box");
            assert!(crossings(&corners_of(&mended)).is_empty(), "{mended:?}");
            for (what, x, y) in [("the pillar's top", 2.1, 0.598), ("the box", 1.5, 0.95)] {
                let off = mended.distance(Point::new(x, y));
                assert!(off < 0.01, "{what} is {off} m off, from {begun} on: {mended:?}");
            }
        }
    }

    #[test]
    fn a_long_board_whose_faces_cross_is_turned_over_where_that_is_wanted() {
        // A board of 1.5 m by 20 mm on the lower wall; half a metre up its faces have changed places.
        let points = polygon(&[
            (0.0, 0.0),
            (1.99, 0.0),
            (2.01, 0.5),
            (2.01, 1.5),
            (1.99, 1.5),
            (1.99, 0.5),
            (2.01, 0.0),
            (4.0, 0.0),
            (4.0, 3.0),
            (0.0, 3.0),
        ]);
        assert_eq!(untangled(points.clone(), |_| false), None, "it may be an island");
        let mended = untangled(points, |_| true).expect("a room with a board");
        assert!(crossings(&corners_of(&mended)).is_empty());
        assert!((mended.area() - 11.97).abs() < 0.005, "{}", mended.area());
    }

    #[test]
    fn the_end_of_a_thin_board_whose_faces_cross_stays_on_the_map() {
        // A board of 0.8 m by 20 mm on the lower wall; for its last 0.4 m the faces have changed places.
        let points = polygon(&[
            (0.0, 0.0),
            (1.99, 0.0),
            (2.006, 0.8),
            (1.994, 0.8),
            (2.01, 0.0),
            (4.0, 0.0),
            (4.0, 3.0),
            (0.0, 3.0),
        ]);
        let mended = untangled(points, |_| false).expect("a room with a board");
        assert!(crossings(&corners_of(&mended)).is_empty());
        assert!(mended.distance(Point::new(2.0, 0.8)) < 0.01, "its end is lost");
    }
}
