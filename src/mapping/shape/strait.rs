//! Straits: places of a room's floor that are narrower than the robot's swath, with a room behind them. The
//! follower gets through some of them and not through others like them; the map ends at all of them, so that what
//! is on it does not depend on that. A corner, or a corridor with nothing wider at its end, has no strait.
//! Knows an outline and the body, not where the robot drove.

use crate::geometry::index::SegmentIndex;
use crate::geometry::raster::Grid;
use crate::geometry::segment::{Segment, chords};
use crate::geometry::{Piece, Point, Ring, angle, ring};
use crate::robot::Chassis;

/// Along an arc the narrowest place is looked for at this pace, metres.
const PACE: f64 = 0.02;
/// How finely a room is looked for, metres.
const CELL: f64 = 0.02;
/// Pitch of the buckets that hold walls, metres.
const BUCKET: f64 = 0.25;
/// Chords stand for arcs within this, metres.
const SAGITTA: f64 = 0.001;
/// What is nearer to the ends of a chord is wall that it begins at, metres.
const END: f64 = 1e-6;

/// The floor within `outline` as far as `here` can be reached from without passing a strait, and what lies behind
/// each strait, counter-clockwise: the last piece of that is the chord across the strait, where it is narrowest. A
/// strait between the places `here` is left, since the robot went from one to the other. So is one that
/// was not felt as one (`is_felt`): its two sides may have been seen half a lap from each other, with the drift of
/// that between them.
#[must_use]
pub fn cut_at_straits(
    outline: Ring,
    here: [Point; 2],
    chassis: &Chassis,
    is_felt: impl Fn(&Segment) -> bool,
) -> (Ring, Vec<Ring>) {
    let mut outline = outline;
    let mut behind = Vec::new();
    while let Some((rest, beyond)) = first_cut(&outline, here, chassis, &is_felt) {
        outline = rest;
        behind.push(beyond);
    }
    (outline, behind)
}

/// A way across the floor from the beginning of a piece to a place on another one.
struct Chord {
    from: usize,
    to: usize,
    t: f64,
    length: f64,
}

/// The two sides of the narrowest strait.
fn first_cut(
    outline: &Ring,
    here: [Point; 2],
    chassis: &Chassis,
    is_felt: &impl Fn(&Segment) -> bool,
) -> Option<(Ring, Ring)> {
    // An arc that comes towards the other side is narrowest somewhere along it.
    let fine = Ring { pieces: outline.pieces.iter().flat_map(stepped).collect() };
    let walls = SegmentIndex::new(chords(&fine, SAGITTA), BUCKET);
    let mut all = across(&fine, &walls, chassis.strait());
    all.sort_by(|one, other| one.length.total_cmp(&other.length));
    let is_strait = |chord: &&Chord| {
        let (from, to) = (&fine.pieces[chord.from], &fine.pieces[chord.to]);
        is_felt(&Segment::new(from.from(), to.at(chord.t)))
    };
    all.iter().filter(is_strait).find_map(|chord| {
        let (left, right) = split(&fine, chord);
        let (rest, beyond) = if left.contains(here[0]) { (left, right) } else { (right, left) };
        let both = here.iter().all(|p| rest.contains(*p));
        (both && has_room(&beyond, &walls, chassis)).then_some((rest, beyond))
    })
}

/// An arc that bulges into the floor in steps, any other piece as it is.
fn stepped(piece: &Piece) -> Vec<Piece> {
    if piece.bulge() >= 0.0 {
        return vec![*piece];
    }
    let count = (piece.length() / PACE).ceil().max(1.0) as u32;
    let at = |k: u32| f64::from(k) / f64::from(count);
    (0..count).map(|k| piece.part(at(k), at(k + 1))).collect()
}

/// The ways across the floor, shorter than `most`, from every corner to what it faces.
fn across(outline: &Ring, walls: &SegmentIndex, most: f64) -> Vec<Chord> {
    let pieces = &outline.pieces;
    let count = pieces.len();
    let mut all = Vec::new();
    for from in 0..count {
        let corner = pieces[from].from();
        for to in (0..count).filter(|&to| to != from && (to + 1) % count != from) {
            let t = pieces[to].nearest(corner);
            let foot = pieces[to].at(t);
            let length = (foot - corner).norm();
            if length < most && length > 2.0 * END && is_open(outline, walls, corner, foot) {
                all.push(Chord { from, to, t, length });
            }
        }
    }
    all
}

/// Whether floor lies between two places of the outline, all the way.
fn is_open(outline: &Ring, walls: &SegmentIndex, from: Point, to: Point) -> bool {
    let along = (to - from) * (END / (to - from).norm());
    let between = Segment::new(from + along, to - along);
    outline.contains(nalgebra::center(&from, &to)) && walls.gap(&between, END) > 0.0
}

/// What lies on both sides of `chord`: behind its beginning and before it, each with the chord as its last piece.
fn split(outline: &Ring, chord: &Chord) -> (Ring, Ring) {
    let pieces = &outline.pieces;
    let count = pieces.len();
    let run = |from: usize, to: usize| {
        (0..(to + count - from) % count).map(move |k| pieces[(from + k) % count])
    };
    let (corner, foot) = (pieces[chord.from].from(), pieces[chord.to].at(chord.t));
    let (before, after) =
        (pieces[chord.to].part(0.0, chord.t), pieces[chord.to].part(chord.t, 1.0));
    let line = |from, to| Piece::Line { from, to };
    let long = |piece: &Piece| piece.length() > END;
    let left = run(chord.from, chord.to).chain([before]).filter(long).chain([line(foot, corner)]);
    let right = [after].into_iter().chain(run((chord.to + 1) % count, chord.from));
    let right = right.filter(long).chain([line(corner, foot)]);
    (whole(left), whole(right))
}

/// The ring of `pieces`, with the steps of an arc taken together again.
fn whole(pieces: impl Iterator<Item = Piece>) -> Ring {
    let mut all: Vec<Piece> = Vec::new();
    for piece in pieces {
        match (all.last_mut(), piece) {
            (
                Some(Piece::Arc { center, radius, sweep, .. }),
                Piece::Arc { center: same, radius: as_large, sweep: more, .. },
            ) if *center == same && *radius == as_large => *sweep += more,
            _ => all.push(piece),
        }
    }
    Ring { pieces: all }
}

/// Whether somewhere within `beyond` the robot would touch nothing, were it there.
fn has_room(beyond: &Ring, walls: &SegmentIndex, chassis: &Chassis) -> bool {
    let reach = chassis.reach();
    let Some(chord) = beyond.pieces.last() else { return false };
    let points = beyond.to_points(SAGITTA);
    let Some((low, high)) = ring::bounds(&points) else { return false };
    if beyond.area() < angle::PI * reach * reach {
        return false;
    }
    let grid = Grid::over(low, high, CELL, 0.0);
    (0..grid.len()).map(|k| grid.point(k)).any(|p| {
        let touches_nothing = walls.distance_within(p, reach) >= reach;
        touches_nothing && chord.distance(p) >= reach && beyond.contains(p)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rooms of 2 x 2 m side by side, with a doorway `gap` wide in the wall of 0.1 m between them.
    fn rooms(gap: f64) -> Ring {
        let (low, high) = (1.0 - gap / 2.0, 1.0 + gap / 2.0);
        let corners = [
            (0.0, 0.0),
            (2.0, 0.0),
            (2.0, low),
            (2.1, low),
            (2.1, 0.0),
            (4.1, 0.0),
            (4.1, 2.0),
            (2.1, 2.0),
            (2.1, high),
            (2.0, high),
            (2.0, 2.0),
            (0.0, 2.0),
        ];
        Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)))
    }

    fn cut(room: Ring, here: [(f64, f64); 2]) -> (Ring, Vec<Ring>) {
        cut_at_straits(room, here.map(|(x, y)| Point::new(x, y)), &Chassis::default(), |_| true)
    }

    #[test]
    fn a_room_ends_where_it_is_narrower_than_can_be_passed_for_sure() {
        let (rest, behind) = cut(rooms(0.28), [(0.5, 0.5), (1.5, 1.0)]);
        assert_eq!(behind.len(), 1);
        // The doorway goes to one of the two rooms.
        assert!((rest.area() - 4.0).abs() < 0.03, "{}", rest.area());
        assert!((rest.area() + behind[0].area() - rooms(0.28).area()).abs() < 1e-9);
        let strait = behind[0].pieces.last().expect("a chord");
        assert!((strait.length() - 0.28).abs() < 1e-9);
        assert!(rest.distance(strait.at(0.5)) < 1e-9, "it is of both");
    }

    #[test]
    fn where_it_is_not_felt_on_both_hands_it_is_none() {
        let here = [Point::new(0.5, 0.5), Point::new(1.5, 1.0)];
        let felt = |gate: &Segment| gate.distance_squared(Point::new(2.05, 1.0)) > 0.1;
        assert!(cut_at_straits(rooms(0.28), here, &Chassis::default(), felt).1.is_empty());
    }

    #[test]
    fn the_room_that_the_robot_is_in_is_kept() {
        let (rest, behind) = cut(rooms(0.28), [(3.0, 0.5), (3.0, 1.0)]);
        assert_eq!(behind.len(), 1);
        assert!(rest.contains(Point::new(3.0, 1.0)) && behind[0].contains(Point::new(1.0, 1.0)));
    }

    #[test]
    fn a_strait_that_the_robot_went_through_on_its_way_is_left() {
        assert!(cut(rooms(0.28), [(0.5, 0.5), (3.0, 1.0)]).1.is_empty());
    }

    #[test]
    fn what_can_be_passed_is_no_strait() {
        assert!(cut(rooms(0.31), [(0.5, 0.5), (1.5, 1.0)]).1.is_empty());
    }

    #[test]
    fn a_niche_and_a_sharp_corner_have_no_room_behind_them() {
        let corners =
            [(0.0, 0.0), (4.0, 0.0), (0.5, 1.0), (0.5, 2.0), (0.25, 2.0), (0.25, 1.0), (0.0, 1.0)];
        let room = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        assert!(cut(room, [(0.5, 0.5), (0.6, 0.5)]).1.is_empty());
    }

    #[test]
    fn an_arc_that_comes_near_the_other_wall_makes_a_strait() {
        // A half column of 0.75 m radius on the lower wall of a corridor 1 m wide.
        let line = |a: (f64, f64), b: (f64, f64)| Piece::Line {
            from: Point::new(a.0, a.1),
            to: Point::new(b.0, b.1),
        };
        let column = Piece::Arc {
            center: Point::new(2.0, 0.0),
            radius: 0.75,
            start: angle::PI,
            sweep: -angle::PI,
        };
        let corridor = Ring {
            pieces: vec![
                line((0.0, 0.0), (1.25, 0.0)),
                column,
                line((2.75, 0.0), (4.0, 0.0)),
                line((4.0, 0.0), (4.0, 1.0)),
                line((4.0, 1.0), (0.0, 1.0)),
                line((0.0, 1.0), (0.0, 0.0)),
            ],
        };
        let (rest, behind) = cut(corridor.clone(), [(0.5, 0.5), (0.6, 0.5)]);
        assert_eq!(behind.len(), 1);
        assert!((behind[0].pieces.last().expect("a chord").length() - 0.25).abs() < 1e-3);
        assert!((rest.area() - corridor.area() / 2.0).abs() < 0.02, "{}", rest.area());
        // The steps in which the arc was looked at are gone.
        assert_eq!((rest.pieces.len(), behind[0].pieces.len()), (5, 5));
    }
}
