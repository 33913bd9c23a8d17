//! What an object keeps the robot off: the object itself, and the floor in its inner corners that no
//! body can enter; and the same of a room's sharp corners.
//!
//! A map made by touch is a map of reachable floor. Two faces that meet in an inner corner were
//! touched up to where the body no longer fits; behind that, whether they meet in an edge, in a
//! round, or with something between them, nobody has seen. The outline that a body of a radius can
//! touch is the closing of the object with a disc of it (Serra 1982): moved out by the radius, then
//! in again. The outline of what was touched runs straight across such a corner, from the last contact on one face to
//! the first on the other, and no body would feel that: it is moved in first.

use crate::geometry::simple::crossings;
use crate::geometry::{Piece, Point, Ring, angle, cross, meeting, perp};
use cavalier_contours::polyline::{PlineSource, PlineSourceMut, PlineVertex, Polyline};

/// Outlines that differ by less than this share of their area are the same.
const SAME: f64 = 1e-4;
/// Shares of the radius that are tried first where the whole of it goes wrong.
const SMALLER: [f64; 3] = [0.125, 0.25, 0.5];
/// In a corner sharper than this the switches do not see the walls to where they meet, nor nearly, radians.
const SHARP: f64 = 1.4;
/// Of a wall no more than this share is taken for the round at one of its ends.
const OF_WALL: f64 = 0.45;
/// Where a round touches is halved in on so often: a wall of 10 m to a hundredth of a micrometre.
const HALVINGS: usize = 30;
/// What runs across an inner corner is no longer than this, metres: in one of 30 degrees the switches see the faces to
/// where they are 0.25 m apart ...
const WIDEST: f64 = 0.25;
/// ... and no longer than this, metres, where the body was farther in, by so many metres.
const WIDEST_ENTERED: f64 = 0.6;
const ENTERED: f64 = 0.03;
/// A contact nearer than this to what runs across a corner was made on it, metres, ...
const ON_IT: f64 = 0.01;
/// ... but near its ends, by this share of it, where it was made on the faces.
const OF_ENDS: f64 = 0.15;
/// Faces that are as good as parallel meet nowhere, as the two sides of a slot: sine of 20 degrees.
const LEAST_SINE: f64 = 0.34;
/// It is moved in by this share of the way to where the faces would meet, at least, and so far that it lies behind what
/// a body feels, by this share of what that leaves.
const MOVED_IN: f64 = 0.5;
const BEHIND: f64 = 0.9;
/// What was touched in a corner is of its faces when it is nearer to them than this, metres.
const OF_FACES: f64 = 0.015;

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
    // What a small disc closes a large one does too; with notches of a few millimetres gone, an offset that
    // lost its way among them finds it.
    let closed = closed(&outline, radius).or_else(|| {
        SMALLER.iter().find_map(|share| closed(&closed(&outline, radius * share)?, radius))
    })?;
    let area = ring.area().abs();
    if closed.area() - area < SAME * area {
        return None;
    }
    let corners: Vec<(Point, f64)> =
        closed.iter_vertexes().map(|v| (Point::new(v.x, v.y), v.bulge)).collect();
    let pieces = (0..corners.len()).map(|k| {
        let ((from, bulge), (to, _)) = (corners[k], corners[(k + 1) % corners.len()]);
        Piece::with_bulge(from, to, bulge)
    });
    let closed = Ring { pieces: pieces.collect() };
    (closed.pieces.len() >= 3).then_some(closed)
}

/// The outline `ring`, counter-clockwise, of something solid, with what runs straight across its inner corners moved
/// in, where none of the `touched` places is on it: the faces are straight on beyond their last contacts. The `body` was
/// there, its radius in metres.
#[must_use]
pub fn moved_in(ring: &Ring, touched: &[Point], body: (&[Point], f64)) -> Ring {
    let count = ring.pieces.len();
    let mut ring = ring.clone();
    for k in 0..count {
        let (before, after) = ((k + count - 1) % count, (k + 1) % count);
        let [face, across, other] = [before, k, after].map(|k| ring.pieces[k]);
        let is_near = |p: &Point, off: f64| {
            let is_between = (OF_ENDS..1.0 - OF_ENDS).contains(&across.nearest(*p));
            is_between && across.distance(*p) < off
        };
        let is_wide = |length: f64| {
            let (way, radius) = body;
            length > WIDEST_ENTERED
                || (length > WIDEST && !way.iter().any(|p| is_near(p, radius - ENTERED)))
        };
        let is_felt = |corner: &Point| {
            touched.iter().any(|p| is_near(p, ON_IT) || is_within(&across, *corner, *p))
        };
        let corner = inner_corner(&face, &across, &other);
        let Some(corner) = corner.filter(|it| !is_wide(across.length()) && !is_felt(it)) else {
            continue;
        };
        let far = unfelt(&across, corner, body.1);
        let [from, to] = [across.from(), across.to()].map(|end| {
            let arm = end - corner;
            corner + arm * (1.0 - MOVED_IN).min(far / arm.norm())
        });
        let mut opened = ring.clone();
        opened.pieces[before] = Piece::with_bulge(face.from(), from, 0.0);
        opened.pieces[k] = Piece::with_bulge(from, to, 0.0);
        opened.pieces[after] = Piece::with_bulge(to, other.to(), 0.0);
        // What was seen of the other side of thin boards may lie there.
        if crossings(&opened.to_points(super::SAGITTA)).is_empty() {
            ring = opened;
        }
    }
    ring
}

/// Whether `p` lies between what runs `across` a corner and that, and is of neither face.
fn is_within(across: &Piece, corner: Point, p: Point) -> bool {
    let sides = [across.from(), across.to(), corner];
    let is_in = (0..3).all(|k| cross(sides[(k + 1) % 3] - sides[k], p - sides[k]) > 0.0);
    let is_of = |end: Point| cross((end - corner).normalize(), p - corner).abs() < OF_FACES;
    is_in && !is_of(across.from()) && !is_of(across.to())
}

/// How far from a `corner` what runs straight across it, from face to face like `across`, may end so that a body of
/// `radius` metres does not feel it, metres: a disc comes as near to the corner as its radius over the sine of half its
/// angle, less the radius.
fn unfelt(across: &Piece, corner: Point, radius: f64) -> f64 {
    let (one, other) = (across.from() - corner, across.to() - corner);
    let half = angle::wrap(angle::of(one) - angle::of(other)).abs() / 2.0;
    let (sine, cosine) = (angle::sin(half), angle::cos(half));
    BEHIND * radius * (1.0 - sine) / (sine * cosine)
}

/// Where the straight faces `before` and `after` of something solid would meet that `across` joins, if that is an inner
/// corner; counter-clockwise.
fn inner_corner(before: &Piece, across: &Piece, after: &Piece) -> Option<Point> {
    let is_straight = |piece: &&Piece| matches!(piece, Piece::Line { .. });
    if ![before, across, after].iter().all(is_straight) {
        return None;
    }
    let (along, back) = (before.tangent(1.0), -after.tangent(0.0));
    let (from, to) = (across.from(), across.to());
    let over = to - from;
    // To the right of a counter-clockwise outline lies the floor: it turns there twice.
    if cross(along, over) >= 0.0 || cross(over, -back) >= 0.0 || cross(along, back) < LEAST_SINE {
        return None;
    }
    let (on, off) = (meeting(from, along, to, back), meeting(to, back, from, along));
    (on > 0.0 && off > 0.0).then(|| from + along * on)
}

/// `outline` moved out by `radius` and in again; none where an offset went wrong, which shrinks what was
/// touched.
fn closed(outline: &Polyline<f64>, radius: f64) -> Option<Polyline<f64>> {
    // To the right of a counter-clockwise outline lies the outside.
    let closed = largest(&largest(outline, -radius)?, radius)?;
    (closed.area() > (1.0 - SAME) * outline.area()).then_some(closed)
}

/// The outline of a room, counter-clockwise like `ring`, with every sharp corner as round as a robot feels it
/// whose centre stays `clearance` metres off the walls: where they meet behind that, and whether they do,
/// nobody has seen. None when there is no such corner.
#[must_use]
pub fn felt(ring: &Ring, clearance: f64) -> Option<Ring> {
    let count = ring.pieces.len();
    let rounds: Vec<Option<Round>> = (0..count)
        .map(|k| Round::at(&ring.pieces[(k + count - 1) % count], &ring.pieces[k], clearance))
        .collect();
    if count < 3 || rounds.iter().all(Option::is_none) {
        return None;
    }
    let mut pieces = Vec::with_capacity(2 * count);
    for (k, piece) in ring.pieces.iter().enumerate() {
        let begin = rounds[k].as_ref().map_or(0.0, |round| round.end);
        let end = rounds[(k + 1) % count].as_ref().map_or(1.0, |round| round.begin);
        if let Some(round) = &rounds[k] {
            let before = &ring.pieces[(k + count - 1) % count];
            let bulge = angle::tan(round.turn / 4.0);
            pieces.push(Piece::with_bulge(before.at(round.begin), piece.at(begin), bulge));
        }
        pieces.push(piece.part(begin, end));
    }
    Some(Ring { pieces })
}

/// A circular arc that takes the place of a sharp corner and touches both its walls.
struct Round {
    /// Where it leaves the wall before the corner, a share of that wall's length.
    begin: f64,
    /// Where it meets the wall behind the corner, a share of that wall's length.
    end: f64,
    /// By how much it turns, radians, counter-clockwise.
    turn: f64,
}

impl Round {
    /// The round of radius `clearance`, metres, at the corner from `before` to `after`, or the largest there
    /// is room for; none where the corner is not sharp.
    fn at(before: &Piece, after: &Piece, clearance: f64) -> Option<Self> {
        let inside =
            angle::PI - angle::wrap(angle::of(after.tangent(0.0)) - angle::of(before.tangent(1.0)));
        if !(1e-3..SHARP).contains(&inside) {
            return None;
        }
        Self::touching(before, after, clearance).or_else(|| {
            let (mut fits, mut largest) = (0.0, None);
            let mut too_large = clearance;
            for _ in 0..HALVINGS {
                let radius = f64::midpoint(fits, too_large);
                match Self::touching(before, after, radius) {
                    Some(round) => (fits, largest) = (radius, Some(round)),
                    None => too_large = radius,
                }
            }
            largest
        })
    }

    /// The round of `radius` metres; none where it takes more than [`OF_WALL`] of a wall.
    fn touching(before: &Piece, after: &Piece, radius: f64) -> Option<Self> {
        // The room is to the left of its outline.
        let center = |t: f64| before.at(t) + perp(before.tangent(t)) * radius;
        let clear = |t: f64| after.distance(center(t)) >= radius;
        let (mut off, mut near) = (1.0 - OF_WALL, 1.0);
        if !clear(off) {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(off, near);
            if clear(middle) { off = middle } else { near = middle }
        }
        let end = after.nearest(center(off));
        let turn = angle::wrap(angle::of(after.tangent(end)) - angle::of(before.tangent(off)));
        (end <= OF_WALL && turn > 0.0).then_some(Self { begin: off, end, turn })
    }
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
    fn a_sharp_corner_at_a_curved_wall_is_as_round_as_it_was_felt() {
        // The long side bends into the room, and out of it.
        for bulge in [-0.12, 0.04] {
            let corners = [(0.0, 0.0), (3.0, 0.0), (0.0, 3.0)].map(|(x, y)| Point::new(x, y));
            let [a, b, c] = corners;
            let walls = [Piece::with_bulge(a, b, 0.0), Piece::with_bulge(b, c, bulge)];
            let room = Ring { pieces: [&walls[..], &[Piece::with_bulge(c, a, 0.0)]].concat() };
            let felt = felt(&room, 0.145).expect("another outline");
            assert_eq!(felt.pieces.len(), 5, "two sharp corners");
            let Piece::Arc { center, radius, .. } = felt.pieces[1] else { panic!("{felt:?}") };
            assert!((radius - 0.145).abs() < 1e-6, "{radius}");
            assert!(walls.iter().all(|wall| (wall.distance(center) - 0.145).abs() < 1e-6));
            // The curved wall is where it was, only shorter.
            let (wall, left) = (&walls[1], &felt.pieces[2]);
            assert!((0..=8).all(|k| wall.distance(left.at(f64::from(k) / 8.0)) < 1e-9));
            assert!(left.length() < wall.length() - 0.1);
        }
    }

    #[test]
    fn the_round_of_a_sharp_corner_leaves_half_of_a_short_wall() {
        let corners = [(0.0, 0.0), (3.0, 0.0), (2.9, 0.1), (0.0, 0.3)];
        let room = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        let felt = felt(&room, 0.145).expect("another outline");
        let short = &room.pieces[1];
        let left = felt.pieces.iter().map(|piece| piece.at(0.5));
        assert!(left.into_iter().any(|middle| short.distance(middle) < 1e-6), "{felt:?}");
        assert!(felt.area() < room.area() && felt.area() > 0.9 * room.area());
    }

    #[test]
    fn notches_of_millimetres_do_not_hide_the_round_of_an_inner_corner() {
        // Two boards that nearly meet; the switches saw into the gap of 9 mm between them.
        let boards = [
            (1.9569, 0.5204),
            (1.9381, 0.5008),
            (0.7425, 0.6706),
            (0.7391, 0.6502),
            (1.9472, 0.4776),
            (1.9491, 0.4952),
            (1.9536, 0.5048),
            (1.9593, 0.5022),
            (1.9633, 0.5022),
            (1.9755, 0.5173),
            (1.8235, 1.2498),
            (1.8235, 1.2512),
            (1.8283, 1.349),
            (1.9673, 1.6984),
            (1.9477, 1.7051),
            (1.7908, 1.3068),
        ];
        let ring = Ring::polygon(&boards.map(|(x, y)| Point::new(x, y)));
        let closed = closing(&ring, 0.1).expect("another outline");
        // The same from buffers of shapely 2.1, with arcs of 32 chords a quarter.
        assert!((closed.area() - 0.0553).abs() < 5e-5, "{}", closed.area());
    }

    #[test]
    fn what_runs_across_an_inner_corner_is_felt_only_where_it_was_touched() {
        // Two boards at 75 degrees, seen to where they are 0.13 m apart.
        let boards = [
            (0.7609, 0.6708),
            (0.7582, 0.6515),
            (1.9465, 0.475),
            (1.9784, 0.503),
            (1.8153, 1.3047),
            (1.7944, 1.3066),
            (1.9381, 0.6026),
            (1.8516, 0.5093),
            (1.2, 0.6057),
        ]
        .map(|(x, y)| Point::new(x, y));
        let ring = Ring::polygon(&boards);
        let corner = Point::new(1.9604, 0.4932);
        let nowhere: (&[Point], f64) = (&[], 0.1);
        let opened = moved_in(&ring, &boards, nowhere);
        assert!((opened.distance(corner) - ring.distance(corner) / 2.0).abs() < 0.005);
        // The closing of the two boards where they do meet.
        let met = [&boards[..6], &[corner], &boards[8..]].concat();
        let met = closing(&Ring::polygon(&met), 0.1).expect("another outline").area();
        let area = |ring: &Ring| closing(ring, 0.1).expect("another outline").area();
        assert!((area(&opened) - met).abs() < 1e-4, "{} and {met}", area(&opened));
        assert!(area(&ring) > met + 1e-3, "what runs across is felt: {}", area(&ring));
        // What was seen between the ends of the boards, where they nearly meet, is no corner.
        let seen = [(1.9496, 0.4931), (1.9433, 0.5013), (1.9503, 0.508), (1.9584, 0.4993)];
        let between = seen.map(|(x, y)| Point::new(x, y));
        let slotted = [&boards[..3], &between, &boards[3..]].concat();
        let slotted = moved_in(&Ring::polygon(&slotted), &slotted, nowhere);
        assert!(between.iter().all(|p| slotted.distance(*p) < 1e-9));
        assert!(slotted.distance(nalgebra::center(&boards[6], &corner)) < 0.001, "{slotted:?}");
        // Somebody has put a board across, and the robot has felt it.
        let felt = [&boards[..], &[Point::new(1.895, 0.556)]].concat();
        assert_eq!(moved_in(&ring, &felt, nowhere), ring);
        // Outer corners with a bevel, and boxes, stay as they are.
        let bevelled = [(0.0, 0.0), (0.4, 0.0), (0.4, 0.2), (0.3, 0.3), (0.0, 0.3)];
        let bevelled = Ring::polygon(&bevelled.map(|(x, y)| Point::new(x, y)));
        assert_eq!(moved_in(&bevelled, &[], nowhere), bevelled);
    }

    #[test]
    fn a_wide_side_across_an_inner_corner_that_the_body_was_in_is_moved_in() {
        // Two boards again, one of which was not looked at for 0.4 m before the corner.
        let boards = [
            (0.741, 0.676),
            (0.737, 0.656),
            (1.942, 0.475),
            (1.973, 0.504),
            (1.811, 1.305),
            (1.792, 1.305),
            (1.879, 0.89),
            (1.829, 0.511),
        ];
        let ring = Ring::polygon(&boards.map(|(x, y)| Point::new(x, y)));
        // The robot turned in the corner, where it has its clearance of both boards.
        let place = Point::new(1.778, 0.655);
        let of = |way: &[Point]| moved_in(&ring, &[], (way, 0.1));
        assert_eq!(of(&[]), ring);
        assert_eq!(of(&[Point::new(1.7, 0.7)]), ring, "not so far in");
        let opened = of(&[place]);
        assert!(ring.distance(place) < 0.07 && opened.distance(place) > 0.1, "{opened:?}");
    }

    #[test]
    fn a_side_across_an_inner_corner_is_moved_in_behind_what_a_body_feels() {
        let at = |x: f64, y: f64| Point::new(x, y);
        // An L of two thick walls whose corner at (0, 0) is cut off at 0.4 m, and seen from the upper right.
        let cut = |by: f64| {
            let outer = [at(-0.1, 1.5), at(-0.1, -0.1), at(1.5, -0.1), at(1.5, 0.0)];
            Ring::polygon(&[&outer[..], &[at(by, 0.0), at(0.0, by), at(0.0, 1.5)]].concat())
        };
        let whole = [at(-0.1, 1.5), at(-0.1, -0.1), at(1.5, -0.1), at(1.5, 0.0), at(0.0, 0.0)];
        let whole = Ring::polygon(&[&whole[..], &[at(0.0, 1.5)]].concat());
        let felt = closing(&whole, 0.1).expect("a round").area();
        let body = [at(0.19, 0.19), at(0.145, 0.145)];
        for by in [0.4, 0.17, 0.1] {
            let opened = moved_in(&cut(by), &[], (&body, 0.1));
            let area = closing(&opened, 0.1).map_or(opened.area(), |ring| ring.area());
            assert!((area - felt).abs() < 1e-4, "{by}: {area}, {felt}");
        }
        // What was touched in the corner is there.
        let standing = [at(0.12, 0.12)];
        assert_eq!(moved_in(&cut(0.4), &standing, (&body, 0.1)), cut(0.4), "behind it");
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
