//! What an object keeps the robot off: the object itself, and the floor in its inner corners that no
//! body can enter; and the same of a room's sharp corners.
//!
//! A map made by touch is a map of reachable floor. Two faces that meet in an inner corner were
//! touched up to where the body no longer fits; behind that, whether they meet in an edge, in a
//! round, or with something between them, nobody has seen. The outline that a body of a radius can
//! touch is the closing of the object with a disc of it (Serra 1982): moved out by the radius, then
//! in again.

use crate::geometry::{Piece, Point, Ring, angle};
use cavalier_contours::polyline::{PlineSource, PlineSourceMut, PlineVertex, Polyline};

/// Outlines that differ by less than this share of their area are the same.
const SAME: f64 = 1e-4;
/// In a corner sharper than this the switches do not see the walls to where they meet, nor nearly, radians.
const SHARP: f64 = 1.4;
/// Of a wall no more than this share is taken for the round at one of its ends.
const OF_WALL: f64 = 0.45;

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

/// The outline of a room, counter-clockwise like `ring`, with every sharp corner between straight walls as
/// round as a robot feels it whose centre stays `clearance` metres off the walls: where they meet behind
/// that, and whether they do, nobody has seen. None when there is no such corner.
#[must_use]
pub fn felt(ring: &Ring, clearance: f64) -> Option<Ring> {
    let count = ring.pieces.len();
    let rounds: Vec<Option<(f64, f64)>> = (0..count)
        .map(|k| sharp_corner(&ring.pieces[(k + count - 1) % count], &ring.pieces[k], clearance))
        .collect();
    if count < 3 || rounds.iter().all(Option::is_none) {
        return None;
    }
    let mut pieces = Vec::with_capacity(2 * count);
    for (k, piece) in ring.pieces.iter().enumerate() {
        let cut = |round: &Option<(f64, f64)>| round.map_or(0.0, |(cut, _)| cut);
        let (first, last) = (cut(&rounds[k]), cut(&rounds[(k + 1) % count]));
        let length = piece.length();
        let from = if first > 0.0 { piece.at(first / length) } else { piece.from() };
        let to = if last > 0.0 { piece.at(1.0 - last / length) } else { piece.to() };
        if let Some((cut, turn)) = rounds[k] {
            let before = &ring.pieces[(k + count - 1) % count];
            let begin = before.at(1.0 - cut / before.length());
            pieces.push(Piece::with_bulge(begin, from, angle::tan(turn / 4.0)));
        }
        pieces.push(Piece::with_bulge(from, to, piece.bulge()));
    }
    Some(Ring { pieces })
}

/// How much of either wall the round takes at the corner from `before` to `after`, metres, and by how much
/// the walls turn there, radians; none where the corner is not sharp.
fn sharp_corner(before: &Piece, after: &Piece, clearance: f64) -> Option<(f64, f64)> {
    let straight = |piece: &Piece| matches!(piece, Piece::Line { .. });
    if !straight(before) || !straight(after) {
        return None;
    }
    let turn = angle::wrap(angle::of(after.tangent(0.0)) - angle::of(before.tangent(1.0)));
    let inside = angle::PI - turn;
    if turn <= 0.0 || !(1e-3..SHARP).contains(&inside) {
        return None;
    }
    let cut = clearance / angle::tan(inside / 2.0);
    Some((cut.min(OF_WALL * before.length().min(after.length())), turn))
}

/// The largest of the outlines at `offset` metres from `outline`, to its left.
fn largest(outline: &Polyline<f64>, offset: f64) -> Option<Polyline<f64>> {
    let outlines = outline.parallel_offset(offset);
    outlines.into_iter().max_by(|a, b| a.area().total_cmp(&b.area()))
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_sharp_corner_of_a_room_is_as_round_as_it_was_felt_and_a_square_one_stays() {
        // A right angle at the origin, 45 degrees at either tip.
        let corners = [(0.0, 0.0), (3.0, 0.0), (0.0, 3.0)];
        let room = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        let felt = felt(&room, 0.145).expect("another outline");
        assert_eq!(felt.pieces.len(), 5, "two sharp corners");
        assert!(felt.distance(Point::new(0.0, 0.0)) < 1e-9);
        // The centre of the robot is where it has its clearance of both walls.
        let half = angle::PI / 8.0;
        let center = Point::new(3.0 - 0.145 / angle::tan(half), 0.145);
        assert!((felt.distance(center) - 0.145).abs() < 1e-9);
        let tip = center + angle::unit(-half) * 0.145;
        assert!(felt.distance(tip) < 1e-6 && !felt.contains(Point::new(2.9, 0.02)));
        assert!(felt.area() < room.area() && felt.area() > 0.98 * room.area());
        let square = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)];
        let square = Ring::polygon(&square.map(|(x, y)| Point::new(x, y)));
        assert_eq!(super::felt(&square, 0.145), None);
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
