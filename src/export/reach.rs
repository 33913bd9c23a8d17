//! What an object keeps the robot off: the object itself, and the floor in its inner corners that no
//! body can enter.
//!
//! A map made by touch is a map of reachable floor. Two faces that meet in an inner corner were
//! touched up to where the body no longer fits; behind that, whether they meet in an edge, in a
//! round, or with something between them, nobody has seen. The outline that a body of a radius can
//! touch is the closing of the object with a disc of it (Serra 1982): moved out by the radius, then
//! in again.

use crate::geometry::{Piece, Point, Ring};
use cavalier_contours::polyline::{PlineSource, PlineSourceMut, PlineVertex, Polyline};

/// Outlines that differ by less than this share of their area are the same.
const SAME: f64 = 1e-4;

/// The outline, counter-clockwise, of what the solid inside `ring` (counter-clockwise) keeps a body of
/// `radius` metres off; none when that is `ring` itself.
#[must_use]
pub fn closing(ring: &Ring, radius: f64) -> Option<Ring> {
    if ring.pieces.len() < 3 {
        return None;
    }
    let mut outline = Polyline::new_closed();
    for piece in &ring.pieces {
        let from = piece.from();
        outline.add_vertex(PlineVertex::new(from.x, from.y, piece.bulge()));
    }
    // To the right of a counter-clockwise outline lies the outside.
    let closed = largest(&largest(&outline, -radius)?, radius)?;
    let area = ring.area().abs();
    if (closed.area() - area).abs() < SAME * area {
        return None;
    }
    let corners: Vec<(Point, f64)> =
        closed.iter_vertexes().map(|v| (Point::new(v.x, v.y), v.bulge)).collect();
    let pieces = (0..corners.len()).map(|k| {
        let ((from, bulge), (to, _)) = (corners[k], corners[(k + 1) % corners.len()]);
        Piece::with_bulge(from, to, bulge)
    });
    let closed = Ring { pieces: pieces.collect() };
    // An offset that went wrong must not shrink what was touched.
    (closed.pieces.len() >= 3 && closed.area() > area).then_some(closed)
}

/// The largest of the outlines at `offset` metres from `outline`, to its left.
fn largest(outline: &Polyline<f64>, offset: f64) -> Option<Polyline<f64>> {
    let outlines = outline.parallel_offset(offset);
    outlines.into_iter().max_by(|a, b| a.area().total_cmp(&b.area()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::angle;

    #[test]
    fn a_convex_thing_keeps_off_no_more_than_itself() {
        let boxed = [(0.0, 0.0), (0.4, 0.0), (0.4, 0.3), (0.0, 0.3)];
        let ring = Ring::polygon(&boxed.map(|(x, y)| Point::new(x, y)));
        assert_eq!(closing(&ring, 0.1), None);
        assert_eq!(closing(&Ring::circle(Point::origin(), 0.2), 0.1), None);
    }

    #[test]
    fn an_inner_corner_is_as_round_as_the_body() {
        let ell = [(0.0, 0.0), (0.6, 0.0), (0.6, 0.1), (0.1, 0.1), (0.1, 0.6), (0.0, 0.6)];
        let ring = Ring::polygon(&ell.map(|(x, y)| Point::new(x, y)));
        let closed = closing(&ring, 0.1).expect("another outline");
        let more = 0.1 * 0.1 * (1.0 - angle::PI / 4.0);
        assert!((closed.area() - ring.area() - more).abs() < 1e-6, "{}", closed.area());
        assert!(closed.distance(Point::new(0.25, 0.1)) < 1e-6);
        let deepest = 0.2 - 0.1 * angle::cos(angle::PI / 4.0);
        assert!(closed.distance(Point::new(deepest, deepest)) < 1e-6);
    }

    #[test]
    fn a_slot_that_no_body_enters_is_part_of_it() {
        let slotted = [
            (0.0, 0.0),
            (0.5, 0.0),
            (0.5, 0.4),
            (0.3, 0.4),
            (0.3, 0.1),
            (0.2, 0.1),
            (0.2, 0.4),
            (0.0, 0.4),
        ];
        let ring = Ring::polygon(&slotted.map(|(x, y)| Point::new(x, y)));
        let closed = closing(&ring, 0.1).expect("another outline");
        assert!(closed.contains(Point::new(0.25, 0.3)), "the slot is 0.1 m wide");
        assert!(!closed.contains(Point::new(0.25, 0.399)), "the body bulges into its mouth");
        assert!((closed.area() - 0.2).abs() < 0.002, "{}", closed.area());
    }
}
