//! Chords: pieces of an outline that cross a gap which the robot did not enter. Nobody has touched them; they
//! only join what was seen on both sides. Knows an outline, its contacts and where switches stayed closed, not
//! what stands behind the gap.

use crate::geometry::{Piece, Point, Ring, angle, cross, meeting};
use crate::mapping::follow;
use crate::mapping::map::Contact;
use crate::robot::Chassis;
use std::ops::Range;

/// A contact this near to a chord speaks for it, metres ...
pub(super) const SUPPORT: f64 = 0.015;
/// ... unless it is this near to its end, metres.
const END: f64 = 0.045;
/// A chord across a gap is at least this long, metres: behind a narrower gap the thing is wall for
/// every purpose of the robot's.
pub(super) const SHORTEST: f64 = 0.05;
/// Where a wall ends, the outline turns away from the floor by at least this (sine).
const WALL_ENDS: f64 = 0.17;
/// No more than this is seen of the end face of a wall beside a gap, metres.
const END_FACE: f64 = 0.1;
/// Narrower gaps are none that anybody would want to know of, metres.
const NARROWEST: f64 = 0.08;
/// A gap beside one that is so many times as wide is the end of the wall there, cut off: nothing stands between the two.
const END_OF_WIDER: f64 = 2.0;
/// The walls of a corner are seen to where the switches reach them, or to so many metres before that.
const SHORT_OF: f64 = 0.1;
/// What runs across a corner and is wider than the body by less than this, metres, may be a wall.
const BEVEL: f64 = 0.02;

/// What is seen through the middle of a gap, shares of its chord, stands farther behind it than this, metres.
const MIDDLE: Range<f64> = 0.33..0.67;
const BEHIND: f64 = 0.03;

/// On which side of an outline the robot was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Floor {
    /// Within: the outline of a room.
    Inside,
    /// Around: the outline of a thing.
    Outside,
}

/// Whether the piece crosses a gap: straight, as long as one of `lengths`, metres, and touched nowhere between
/// its ends from its `floor` side. What was seen from behind is the tip of something that the neck passes.
pub(super) fn is_chord(
    piece: &Piece,
    floor: Floor,
    touched: &[(Point, Point)],
    lengths: &Range<f64>,
) -> bool {
    let length = piece.length();
    if !matches!(piece, Piece::Line { .. }) || !lengths.contains(&length) {
        return false;
    }
    let end = END.min(length / 4.0);
    !touches(piece, floor, touched).any(|(s, _)| (end..length - end).contains(&s))
}

/// Whether something stands on the straight piece all the same, as those `beams` say of switches that were
/// closed on its `floor` side: more than once they ended on its middle, or little behind that. Between two
/// looks at a long wall there are no contacts, but its switch stays closed.
pub(super) fn is_held(piece: &Piece, floor: Floor, beams: &[(Point, Point)]) -> bool {
    let (from, along) = (piece.from(), piece.to() - piece.from());
    let left = if floor == Floor::Inside { 1.0 } else { -1.0 };
    let ends_on_it = |&&(rim, tip): &&(Point, Point)| {
        let (before, behind) = (left * cross(along, rim - from), left * cross(along, tip - from));
        let at = rim + (tip - rim) * (before / (before - behind));
        let share = along.dot(&(at - from)) / along.norm_squared();
        before > 0.0 && behind < 0.0 && MIDDLE.contains(&share) && (tip - at).norm() < BEHIND
    };
    beams.iter().filter(ends_on_it).count() > 1
}

/// The contacts on a straight piece from its `floor` side, and how far along it each lies, metres; those
/// beyond its ends too.
fn touches<'a>(
    piece: &Piece,
    floor: Floor,
    touched: &'a [(Point, Point)],
) -> impl Iterator<Item = (f64, Point)> + use<'a> {
    let (from, to) = (piece.from(), piece.to());
    let along = (to - from).normalize();
    let left = if floor == Floor::Inside { 1.0 } else { -1.0 };
    let piece = *piece;
    touched.iter().filter_map(move |&(p, seen_from)| {
        let is_behind = left * cross(along, seen_from - p) < 0.0;
        (piece.distance(p) < SUPPORT && !is_behind).then(|| (along.dot(&(p - from)), p))
    })
}

/// The outline with corners moved to where a side was seen last, where the fit begins a chord of those
/// `lengths`, metres, before that: the contacts between lie as well on the side itself. None where there is no
/// such corner.
pub(super) fn seen_to_its_ends(
    outline: &Ring,
    floor: Floor,
    touched: &[(Point, Point)],
    lengths: &Range<f64>,
) -> Option<Ring> {
    let count = outline.pieces.len();
    let mut pieces = outline.pieces.clone();
    let mut has_moved = false;
    for k in 0..count {
        for (side, begins) in [((k + count - 1) % count, true), ((k + 1) % count, false)] {
            let Some(last) = last_seen(&pieces[k], &pieces[side], begins, floor, touched) else {
                continue;
            };
            let (beside, chord) = if begins {
                (line(pieces[side].from(), last), line(last, pieces[k].to()))
            } else {
                (line(last, pieces[side].to()), line(pieces[k].from(), last))
            };
            if is_chord(&chord, floor, touched, lengths) {
                (pieces[side], pieces[k], has_moved) = (beside, chord, true);
            }
        }
    }
    has_moved.then_some(Ring { pieces })
}

/// The contact on `piece` farthest from the corner at which it begins, or ends, beside `side`, when all that
/// were made near that corner lie as well on the side, as it goes on.
fn last_seen(
    piece: &Piece,
    side: &Piece,
    begins: bool,
    floor: Floor,
    touched: &[(Point, Point)],
) -> Option<Point> {
    let straight = |piece: &Piece| matches!(piece, Piece::Line { .. }) && piece.length() > 1e-6;
    if !straight(piece) || !straight(side) {
        return None;
    }
    let length = piece.length();
    let onward = (side.to() - side.from()).normalize();
    let is_on_side = |p: Point| cross(onward, p - side.from()).abs() < SUPPORT;
    let from_corner = |s: f64| if begins { s } else { length - s };
    let near = touches(piece, floor, touched)
        .map(|(s, p)| (from_corner(s), p))
        .filter(|(s, _)| (0.0..length - END).contains(s));
    let near: Vec<(f64, Point)> = near.collect();
    let last = near.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    near.iter().all(|(_, p)| is_on_side(*p)).then_some(last.1)
}

fn line(from: Point, to: Point) -> Piece {
    Piece::with_bulge(from, to, 0.0)
}

/// The chords of a room's `outline` across gaps that the robot did not enter: near one end of each a
/// wall ends, at once or behind what was seen of its end face. Between two walls that both go on
/// behind it, a chord only cuts off their corner, if they were seen as near to that as walls are, or if it is hardly
/// wider than the body. Beside those of the outline as it is, those that show when walls which the fit ended too early
/// are taken to where they were seen last.
#[must_use]
pub fn mouths(outline: &Ring, contacts: &[Contact], chassis: &Chassis) -> Vec<Piece> {
    let touched: Vec<(Point, Point)> = contacts.iter().map(|c| (c.point, c.from)).collect();
    let lengths = NARROWEST..chassis.passable_gap();
    let mut found = mouths_of(outline, &touched, &lengths, chassis);
    if let Some(moved) = seen_to_its_ends(outline, Floor::Inside, &touched, &lengths) {
        let is_new = |mouth: &Piece| {
            let off = |known: &Piece| (known.at(0.5) - mouth.at(0.5)).norm();
            found.iter().all(|known| off(known) > known.length())
        };
        let more: Vec<Piece> =
            mouths_of(&moved, &touched, &lengths, chassis).into_iter().filter(is_new).collect();
        found.extend(more);
    }
    found
}

/// The same of the outline as it is, seen as `touched` from the floor within.
fn mouths_of(
    outline: &Ring,
    touched: &[(Point, Point)],
    lengths: &Range<f64>,
    chassis: &Chassis,
) -> Vec<Piece> {
    let pieces = &outline.pieces;
    let count = pieces.len();
    let turns = |k: usize| {
        let (before, after) = (&pieces[(k + count - 1) % count], &pieces[k % count]);
        cross(before.tangent(1.0), after.tangent(0.0)) < -WALL_ENDS
    };
    // Corners reached from the chord over no more than an end face.
    let face = |k: usize| pieces[k % count].length() < END_FACE;
    let ends_before = |k: usize| turns(k) || (face(k + count - 1) && turns(k + count - 1));
    let ends_after = |k: usize| turns(k + 1) || (face(k + 1) && turns(k + 2));
    let beside = |k: usize| [(k + count - 1) % count, (k + 1) % count];
    let is_gap = |k: usize| {
        let [before, after] = beside(k).map(|n| &pieces[n]);
        is_chord(&pieces[k], Floor::Inside, touched, lengths)
            && (ends_before(k) || ends_after(k) || ends_early(before, &pieces[k], after, chassis))
    };
    let gaps: Vec<bool> = (0..count).map(is_gap).collect();
    let is_mouth = |&k: &usize| {
        let is_wider =
            |&n: &usize| gaps[n] && pieces[n].length() > END_OF_WIDER * pieces[k].length();
        gaps[k] && !beside(k).iter().any(is_wider)
    };
    (0..count).filter(is_mouth).map(|k| pieces[k]).collect()
}

/// Whether one of the walls `before` and `after`, which meet behind the `chord` if they go on, ends before that: the
/// robot, whose centre comes as near to a corner as its clearance of both walls lets it, would have seen more of it.
fn ends_early(before: &Piece, chord: &Piece, after: &Piece, chassis: &Chassis) -> bool {
    let (along, onward) = (before.tangent(1.0), after.tangent(0.0));
    let (from, to) = (chord.from(), chord.to());
    // A bevel hardly wider than the body may lie between two looks.
    if cross(along, onward) < WALL_ENDS || (to - from).norm() < 2.0 * chassis.radius + BEVEL {
        return false;
    }
    let clear = follow::clearance(chassis);
    let seen = (chassis.reach() * chassis.reach() - clear * clear).sqrt();
    let turn = angle::wrap(angle::of(onward) - angle::of(along));
    let unseen = (clear * angle::tan(turn / 2.0) - seen).max(0.0);
    let (before, after) = (meeting(from, along, to, onward), meeting(to, -onward, from, along));
    before.min(after) > 0.0 && before.max(after) > unseen + SHORT_OF
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::map::ContactKind;

    #[test]
    fn a_side_goes_on_to_where_it_was_seen_last() {
        // The lower side of a wedge whose tip at (0.9, 0) is 0.25 m off a wall; the fit has left it 0.1 m too
        // early, with a corner at (0.8, 0.01).
        let seen_from = |x: f64, y: f64| (Point::new(x, y), Point::new(x, y - 0.15));
        let side: Vec<(Point, Point)> =
            (0..=18).map(|k| seen_from(f64::from(k) * 0.05, 0.0)).collect();
        let at = |x: f64, y: f64| Point::new(x, y);
        let corners = [at(0.0, 0.0), at(0.8, 0.01), at(1.15, -0.03), at(1.15, 1.0), at(0.0, 1.0)];
        // As seen from outside: the floor lies below.
        let outline = Ring::polygon(&corners);
        let lengths = 0.12..0.4;
        assert!(!is_chord(&outline.pieces[1], Floor::Outside, &side, &lengths));
        let moved = seen_to_its_ends(&outline, Floor::Outside, &side, &lengths).expect("a corner");
        assert_eq!(moved.pieces[1].from(), at(0.9, 0.0));
        assert_eq!(moved.pieces[0].to(), at(0.9, 0.0));
        assert!(is_chord(&moved.pieces[1], Floor::Outside, &side, &lengths));
        // Not where it was seen beyond the middle: then it is wall.
        let wall: Vec<(Point, Point)> =
            side.iter().copied().chain([seen_from(1.0, -0.012)]).collect();
        assert_eq!(seen_to_its_ends(&outline, Floor::Outside, &wall, &lengths), None);
        // Nor where what is left is too short to be a gap.
        let near: Vec<(Point, Point)> =
            side.iter().copied().chain([seen_from(1.05, -0.014)]).collect();
        let straight = [at(0.0, 0.0), at(0.8, 0.0), at(1.15, -0.01), at(1.15, 1.0), at(0.0, 1.0)];
        let outline = Ring::polygon(&straight);
        assert_eq!(seen_to_its_ends(&outline, Floor::Outside, &near, &lengths), None);
    }

    #[test]
    fn a_gap_behind_a_wall_that_was_ended_too_early_is_one() {
        // An opening from (1.9, 0) to (2.02, 0) in the lower wall: the fit has ended the wall 0.1 m before it.
        let at = |x: f64, y: f64| Point::new(x, y);
        let outline = Ring::polygon(&[
            at(0.0, 0.0),
            at(1.8, 0.0),
            at(2.02, -0.02),
            at(2.02, 0.0),
            at(4.0, 0.0),
            at(4.0, 3.0),
            at(0.0, 3.0),
        ]);
        let seen = |x: f64| Contact {
            point: at(x, 0.0),
            from: at(x, 0.15),
            sensor: Some(0),
            kind: ContactKind::Range,
            time: 0.0,
        };
        let wall = |to: u32| (0..=to).map(|k| f64::from(k) / 20.0).chain([2.04, 2.1]);
        let told = |to: u32| {
            let contacts: Vec<Contact> = wall(to).map(seen).collect();
            mouths(&outline, &contacts, &Chassis::default())
        };
        let ends = |mouth: &Piece| (mouth.from(), mouth.to());
        assert_eq!(
            told(38).iter().map(ends).collect::<Vec<_>>(),
            [(at(1.9, 0.0), at(2.02, -0.02))]
        );
        // As it is where nobody saw the wall go on, and none where it was seen as far as the other side.
        assert_eq!(
            told(36).iter().map(ends).collect::<Vec<_>>(),
            [(at(1.8, 0.0), at(2.02, -0.02))]
        );
        assert_eq!(told(40), Vec::new());
    }

    #[test]
    fn a_wall_that_was_not_seen_to_its_corner_ends_at_a_gap() {
        let at = |x: f64, y: f64| Point::new(x, y);
        // The walls y = 0 and x = 4 would meet at (4, 0): seen to `short` and to `high` before that.
        let told = |short: f64, high: f64, top: f64| {
            let room =
                [at(0.0, 0.0), at(4.0 - short, 0.0), at(4.0, high), at(top, 3.0), at(0.0, 3.0)];
            mouths(&Ring::polygon(&room), &[], &Chassis::default()).len()
        };
        assert_eq!((told(0.16, 0.16, 4.0), told(0.17, 0.15, 4.0)), (0, 0), "as near as they are");
        assert_eq!((told(0.21, 0.1, 4.0), told(0.28, 0.1, 4.0)), (1, 1), "no wall there");
        assert_eq!(told(0.19, 0.1, 4.0), 0, "a bevel");
        // Into a corner of 60 degrees less of them is seen.
        assert_eq!((told(0.2, 0.1, 2.3), told(0.32, 0.1, 2.3)), (0, 1));
    }

    #[test]
    fn the_end_of_a_wall_that_is_cut_off_beside_a_gap_is_no_gap_of_its_own() {
        // A wall along x = 2.25 ends at a gap of 0.3 m, its corner cut off by one contact on its end face.
        let at = |x: f64, y: f64| Point::new(x, y);
        let room = [at(0.0, 0.0), at(2.25, 0.0), at(2.25, 0.95), at(2.27, 1.04), at(2.0, 1.17)];
        let room = Ring::polygon(&[&room[..], &[at(0.0, 1.17)]].concat());
        let found = mouths(&room, &[], &Chassis::default());
        let ends: Vec<_> = found.iter().map(|mouth| (mouth.from(), mouth.to())).collect();
        assert_eq!(ends, [(at(2.27, 1.04), at(2.0, 1.17))]);
        // A chord beside it that is no gap itself, however long, takes nothing of one.
        let room = [(0.0, 0.0), (2.0, 0.0), (2.0, -0.05), (2.09, -0.05), (2.25, 0.07), (2.6, 1.0)];
        let room = room.into_iter().chain([(2.6, 3.0), (0.0, 3.0)]).map(|(x, y)| at(x, y));
        let found = mouths(&Ring::polygon(&room.collect::<Vec<_>>()), &[], &Chassis::default());
        let ends: Vec<_> = found.iter().map(|mouth| (mouth.from(), mouth.to())).collect();
        assert_eq!(ends, [(at(2.0, -0.05), at(2.09, -0.05))]);
    }

    #[test]
    fn where_a_switch_stays_closed_there_is_no_gap() {
        let piece = line(Point::new(0.0, 0.0), Point::new(0.3, 0.0));
        let beams = |from: f64, to: f64, count: usize| {
            let beam = |k: usize| (0.14 + 0.01 * k as f64, from, to);
            let ends = |(x, from, to)| (Point::new(x, from), Point::new(x, to));
            (0..count).map(beam).map(ends).collect::<Vec<(Point, Point)>>()
        };
        assert!(is_held(&piece, Floor::Inside, &beams(0.04, -0.02, 3)));
        // What closed them may stand well behind; they came from behind; one says nothing.
        for other in [beams(0.01, -0.05, 3), beams(-0.04, 0.02, 3), beams(0.04, -0.02, 1)] {
            assert!(!is_held(&piece, Floor::Inside, &other));
        }
        assert!(is_held(&piece, Floor::Outside, &beams(-0.04, 0.02, 3)));
    }
}
