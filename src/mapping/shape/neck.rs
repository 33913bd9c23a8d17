//! Things that stand so near to each other that the robot could not pass between: it went round them
//! as one, and the outline joins them by two chords across the gap, which nobody has touched. A
//! thing that only such chords join to the wall is an object of its own, and two objects joined
//! like that are two; that the gap is too narrow to pass does not make it solid. Where the body would
//! not fit between, nor sweeps what lies there, they are one obstacle ([`super::gap`]); and so they are where
//! worn switches laid two faces through each other and what nobody has looked at may be a board
//! ([`super::divide`]). Of a thing that the outline has lost a tip may be left on it, or a needle ([`super::needle`]).
//! Knows outlines, contacts, and the way where they need it; not what becomes of the map.

use super::chord::{Floor, SHORTEST, SUPPORT, is_chord, is_held, seen_to_its_ends};
use super::gap::{Gap, TOUCHING};
use super::object::{necked, object_outline};
use crate::geometry::simple::crossings;
use crate::geometry::{Piece, Point, Ring};
use crate::mapping::map::{Contact, ContactKind};
use crate::mapping::wall::{Stroke, closed_beams};
use crate::robot::Chassis;
use std::ops::Range;

/// A chord joins what was seen on both sides, and need not run straight across: it is up to as many
/// times as long as the gap is wide.
pub(super) const SLANT: f64 = 1.4;
/// Corners next to the chords that may be left out to make an outline simple.
const TRIMMED: usize = 3;
/// The two chords of a neck begin, and end, no farther apart than this, metres: about as far as the
/// switches see into a gap from both of its ends.
pub(super) const NECK: f64 = 0.34;
/// Nothing smaller than this is cut off, square metres.
const SMALLEST: f64 = 8e-4;
/// What is thinner than this is no thing, metres.
const THINNEST: f64 = 0.006;
/// Nothing larger than this share of the room is cut off it.
const LARGEST: f64 = 0.25;
/// The fit to a thing's own contacts is as large as what was cut, within this factor.
const ALIKE: f64 = 1.5;
/// What is fitted to a thing has all of its corners as near as this, metres.
const LEFT_OUT: f64 = 0.06;
/// The beams of closed switches are looked at this far apart, metres.
const PACE: f64 = 0.01;
/// Cuts at most.
const MOST_CUTS: u32 = 20;
/// Chords stand for arcs within this, metres.
const SAGITTA: f64 = 0.001;

/// The outline of a room without the things that only untouched chords join to it, and the outlines
/// of those, counter-clockwise.
#[must_use]
pub fn islands(
    outline: Ring,
    contacts: &[Contact],
    strokes: &[Stroke],
    chassis: &Chassis,
) -> (Ring, Vec<Ring>) {
    let mut outline = outline;
    let mut found = Vec::new();
    let mut cuts = 0;
    let seen = Touched::on(contacts, strokes, chassis);
    while cuts < MOST_CUTS
        && let Some((rest, island)) = cut(&outline, &seen, Floor::Inside, chassis)
    {
        outline = rest;
        cuts += 1;
        // What is thinner than that is a corner that was touched unevenly, and nothing standing there.
        if 2.0 * island.area().abs() > THINNEST * island.perimeter() {
            let own: Vec<Contact> = contacts
                .iter()
                .filter(|c| island.distance(c.point) < outline.distance(c.point))
                .copied()
                .collect();
            found.extend(told_apart(island, &own, strokes, chassis));
        }
    }
    (outline, found)
}

/// The tip of something that chords across a gap join to the outline of a room, too small to be a thing of its
/// own: the outline without it, and the tip, counter-clockwise. Where a lap goes round a thing behind a gap its
/// contacts cross each other at that, and what lies before the crossing stays on the wall.
#[must_use]
pub fn tip(
    outline: &Ring,
    contacts: &[Contact],
    strokes: &[Stroke],
    chassis: &Chassis,
) -> Option<(Ring, Ring)> {
    let seen = Touched::on(contacts, strokes, chassis);
    let lengths = TOUCHING..SLANT * chassis.passable_gap();
    let crosses = |piece: &Piece| seen.is_crossed_by(piece, Floor::Inside, &lengths);
    necks(outline, crosses).into_iter().find_map(|(i, k)| {
        let (rest, tip) = parted(outline, i, k)?;
        let gap = Gap::between(&rest, &tip)?;
        let is_small = (0.0..SMALLEST).contains(&-tip.area()) && rest.area() > 0.0;
        (is_small && !gap.is_closed() && !gap.is_passed(chassis))
            .then(|| (rest, tip.counter_clockwise()))
    })
}

/// Whether `thing` stands apart from the `outline` of the room that is about it: the body would fit between, or
/// sweeps what is between.
#[must_use]
pub fn is_apart(outline: &Ring, thing: &Ring, chassis: &Chassis) -> bool {
    let free = |p: Point| outline.contains(p) && !thing.contains(p);
    Gap::between(outline, thing).is_some_and(|gap| gap.parts(free, chassis))
}

/// The outlines of the things of which `island`, on which `contacts` were made on the way of `strokes`, is
/// made up: floor that was looked at parts them ([`super::divide`]), or only untouched chords join them.
pub(super) fn told_apart(
    island: Ring,
    contacts: &[Contact],
    strokes: &[Stroke],
    chassis: &Chassis,
) -> Vec<Ring> {
    match super::divide::divided(contacts, strokes, chassis) {
        Some(parts) => {
            let things = parts.into_iter().flat_map(|part| necked(part, strokes, chassis));
            things.map(|thing| thing.outline).collect()
        }
        None => apart(island, contacts, strokes, chassis),
    }
}

/// The things that only untouched chords join into the one of `outline`, which was gone round from
/// outside on the way of `strokes`; all counter-clockwise. Seen by worn switches they are one thing
/// where something as wide as a board may join them that nobody has looked at.
#[must_use]
pub(super) fn apart(
    outline: Ring,
    contacts: &[Contact],
    strokes: &[Stroke],
    chassis: &Chassis,
) -> Vec<Ring> {
    let mut found = vec![outline.clone()];
    let mut looked_at = 0;
    let seen = Touched::on(contacts, strokes, chassis);
    while looked_at < found.len() && found.len() < MOST_CUTS as usize {
        if let Some((one, other)) = cut(&found[looked_at], &seen, Floor::Outside, chassis) {
            found[looked_at] = one;
            found.push(other);
        } else {
            looked_at += 1;
        }
    }
    let parts = shared_out(contacts, &found);
    if found.len() > 1 && super::divide::are_one(&parts, strokes, chassis) {
        return vec![outline];
    }
    found
}

/// Those of the `contacts` that lie nearest to each of `rings`.
#[must_use]
pub fn shared_out(contacts: &[Contact], rings: &[Ring]) -> Vec<Vec<Contact>> {
    let mut parts = vec![Vec::new(); rings.len()];
    for contact in contacts {
        let off = |k: &usize| rings[*k].distance(contact.point);
        if let Some(k) = (0..rings.len()).min_by(|a, b| off(a).total_cmp(&off(b))) {
            parts[k].push(*contact);
        }
    }
    parts
}

/// What is known to stand.
pub(super) struct Touched<'a> {
    contacts: &'a [Contact],
    /// Where surfaces were touched, and from where.
    places: Vec<(Point, Point)>,
    /// The beams of closed switches.
    beams: Vec<(Point, Point)>,
}

impl<'a> Touched<'a> {
    /// What the `contacts` that were made on the way of `strokes` say.
    pub(super) fn on(contacts: &'a [Contact], strokes: &[Stroke], chassis: &Chassis) -> Self {
        let surfaces = contacts.iter().filter(|c| c.kind != ContactKind::Edge);
        let places = surfaces.map(|c| (c.point, c.from)).collect();
        Self { contacts, places, beams: closed_beams(strokes, chassis, PACE) }
    }

    /// Whether `piece` of an outline crosses a gap as long as one of `lengths`, metres, in which nothing stands.
    pub(super) fn is_crossed_by(&self, piece: &Piece, floor: Floor, lengths: &Range<f64>) -> bool {
        is_chord(piece, floor, &self.places, lengths) && !is_held(piece, floor, &self.beams)
    }
}

/// The two parts of `outline`, where two chords join them and nothing else does: for a room, its
/// outline and what stands in it.
fn cut(
    outline: &Ring,
    seen: &Touched<'_>,
    floor: Floor,
    chassis: &Chassis,
) -> Option<(Ring, Ring)> {
    let longest = SLANT * chassis.passable_gap();
    let cut = |outline: &Ring, lengths: &Range<f64>| {
        cut_at(outline, seen.contacts, floor, chassis, |piece| {
            seen.is_crossed_by(piece, floor, lengths)
        })
    };
    cut(outline, &(SHORTEST..longest)).or_else(|| {
        // What is left between two touches of a thin wall is no gap: these must be as wide as one that counts.
        let lengths = TOUCHING..longest;
        cut(&seen_to_its_ends(outline, floor, &seen.places, &lengths)?, &lengths)
    })
}

/// The same where those pieces of `outline` are chords that `crosses` takes for such.
fn cut_at(
    outline: &Ring,
    contacts: &[Contact],
    floor: Floor,
    chassis: &Chassis,
    crosses: impl Fn(&Piece) -> bool,
) -> Option<(Ring, Ring)> {
    necks(outline, crosses).into_iter().find_map(|(i, k)| {
        let (rest, island) = split(outline, i, k, floor)?;
        // Both as they were cut and as they are fitted: a fit may leave out a thin end.
        let gap = Gap::between(&rest, &island)?;
        if gap.is_closed() || gap.is_passed(chassis) {
            return None;
        }
        let (rest, island) = match floor {
            Floor::Inside => {
                let island = fitted(island, &rest, contacts);
                (rest, island)
            }
            Floor::Outside => {
                (fitted(rest.clone(), &island, contacts), fitted(island, &rest, contacts))
            }
        };
        let free = |p: Point| (floor == Floor::Inside) == rest.contains(p) && !island.contains(p);
        let gap = Gap::between(&rest, &island)?;
        gap.parts(free, chassis).then_some((rest, island))
    })
}

/// The pairs of chords of `outline`, which are the pieces that `crosses` takes for such, between which it is
/// narrow, the narrowest first.
fn necks(outline: &Ring, crosses: impl Fn(&Piece) -> bool) -> Vec<(usize, usize)> {
    let pieces = &outline.pieces;
    let chords: Vec<usize> = (0..pieces.len()).filter(|&k| crosses(&pieces[k])).collect();
    let width = |i: usize, k: usize| {
        let (a, b) = (&pieces[i], &pieces[k]);
        (a.from() - b.to()).norm().max((a.to() - b.from()).norm())
    };
    let mut pairs: Vec<(usize, usize)> = chords
        .iter()
        .enumerate()
        .flat_map(|(n, &i)| chords[n + 1..].iter().flat_map(move |&k| [(i, k), (k, i)]))
        .filter(|&(i, k)| width(i, k) < NECK)
        .collect();
    // The narrowest neck first: a wide one may be of several things, each with a neck of its own.
    pairs.sort_by(|one, other| width(one.0, one.1).total_cmp(&width(other.0, other.1)));
    pairs
}

/// The outline of what was cut off, fitted to its own contacts, where that looks like it: the cut
/// left its tip out.
fn fitted(island: Ring, rest: &Ring, contacts: &[Contact]) -> Ring {
    let own: Vec<Contact> = contacts
        .iter()
        .filter(|c| island.distance(c.point) < rest.distance(c.point).min(SUPPORT))
        .copied()
        .collect();
    let (ring, _) = object_outline(&own, true);
    let (area, cut) = (ring.area(), island.area());
    let alike = area > cut / ALIKE && area < cut * ALIKE;
    let simple = crossings(&ring.to_points(SAGITTA)).is_empty();
    let whole = island.pieces.iter().all(|piece| ring.distance(piece.from()) < LEFT_OUT);
    if own.len() >= 4 && alike && simple && whole { ring } else { island }
}

/// The outline cut at the chords `i` and `k`: what lies between them on the way from `i` to `k` is the second.
fn parted(outline: &Ring, i: usize, k: usize) -> Option<(Ring, Ring)> {
    let pieces = &outline.pieces;
    let count = pieces.len();
    let between = |from: usize, to: usize| -> Vec<Piece> {
        let steps = (to + count - from - 1) % count;
        (1..=steps).map(|n| pieces[(from + n) % count]).collect()
    };
    let closed = |mut ring: Vec<Piece>| -> Option<Ring> {
        let (first, last) = (ring.first()?.from(), ring.last()?.to());
        if (first - last).norm() > 1e-4 {
            ring.push(Piece::with_bulge(last, first, 0.0));
        }
        Some(Ring { pieces: ring })
    };
    let is_simple = |ring: &Ring| crossings(&ring.to_points(SAGITTA)).is_empty();
    let trimmed = |whole: &[Piece]| {
        let trims = (0..=2 * TRIMMED).flat_map(|sum| (0..=sum).map(move |m| (m, sum - m)));
        let simple = trims
            .filter(|(m, n)| *m <= TRIMMED && *n <= TRIMMED && m + n < whole.len())
            .find_map(|(m, n)| closed(whole[m..whole.len() - n].to_vec()).filter(is_simple));
        // A contact of the other face of a thin wall may reach through the side that was put in.
        simple.or_else(|| super::uncrossed(&closed(whole.to_vec())?))
    };
    Some((trimmed(&between(k, i))?, trimmed(&between(i, k))?))
}

/// The same where both are large enough to be something: the second is the island.
fn split(outline: &Ring, i: usize, k: usize, floor: Floor) -> Option<(Ring, Ring)> {
    let (rest, island) = parted(outline, i, k)?;
    if floor == Floor::Outside {
        let sound = |ring: &Ring| ring.pieces.len() >= 2 && ring.area() > SMALLEST;
        let within = |one: &Ring, other: &Ring| other.contains(one.pieces[0].from());
        let two = sound(&rest) && sound(&island);
        return (two && !within(&rest, &island) && !within(&island, &rest))
            .then_some((rest, island));
    }
    let area = island.area();
    // A column is one arc, closed where the neck was, and so is a round room.
    if island.pieces.len() < 2
        || rest.pieces.len() < 2
        || -area < SMALLEST
        || -area > LARGEST * rest.area()
    {
        return None;
    }
    let points = island.to_points(SAGITTA);
    let inside = points.iter().all(|p| rest.contains(*p) || rest.distance(*p) < 1e-3);
    inside.then(|| (rest, island.counter_clockwise()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contact(x: f64, y: f64) -> Contact {
        Contact {
            point: Point::new(x, y),
            from: Point::new(x, y),
            sensor: Some(0),
            kind: ContactKind::Range,
            time: 0.0,
        }
    }

    /// A room of 4 x 3 m with a box of 0.4 m that stands on its corner 0.28 m off the lower wall,
    /// joined to it at x = 2.0 by a neck 0.04 m wide.
    fn room() -> Ring {
        joined(&[(1.74, 0.54), (2.02, 0.82), (2.3, 0.54)], 0.28)
    }

    /// The same room with another thing that the neck, `gap` metres long, leads to.
    fn joined(thing: &[(f64, f64)], gap: f64) -> Ring {
        let mut corners = vec![(0.0, 0.0), (2.0, 0.0), (2.0, gap)];
        corners.extend(thing);
        corners.extend([(2.04, gap), (2.04, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)]);
        let points: Vec<Point> = corners.into_iter().map(|(x, y)| Point::new(x, y)).collect();
        Ring::polygon(&points)
    }

    #[test]
    fn a_box_behind_a_gap_is_cut_off() {
        let (rest, found) =
            islands(room(), &[contact(1.0, 0.0), contact(1.74, 0.54)], &[], &Chassis::default());
        assert_eq!(found.len(), 1);
        assert!((found[0].area() - 0.1564).abs() < 1e-9, "{}", found[0].area());
        assert!((rest.area() - 12.0).abs() < 1e-9, "{}", rest.area());
    }

    #[test]
    fn a_tip_behind_a_gap_is_no_thing_but_is_told() {
        let (chassis, seen) = (Chassis::default(), [contact(1.0, 0.0), contact(2.02, 0.3)]);
        let left_over = joined(&[(2.02, 0.3)], 0.28);
        assert!(islands(left_over.clone(), &seen, &[], &chassis).1.is_empty());
        let (rest, found) = tip(&left_over, &seen, &[], &chassis).expect("a tip");
        assert!((found.area() - 0.0004).abs() < 1e-9, "{}", found.area());
        assert!((rest.area() - 12.0).abs() < 1e-9, "{}", rest.area());
        // A box is no tip, nor is what hangs on a neck that could be passed, or that was touched.
        assert_eq!(tip(&room(), &seen, &[], &chassis), None);
        let touched = [contact(2.0, 0.1), contact(2.04, 0.1)];
        assert_eq!(tip(&left_over, &touched, &[], &chassis), None);
        let slim = Chassis { radius: 0.04, range: 0.02, ..Chassis::default() };
        assert_eq!(tip(&left_over, &seen, &[], &slim), None);
    }

    #[test]
    fn a_box_whose_side_runs_along_the_wall_is_one_obstacle_with_it() {
        let side_on = joined(&[(1.8, 0.18), (1.8, 0.58), (2.2, 0.58), (2.2, 0.18)], 0.18);
        let (rest, found) =
            islands(side_on.clone(), &[contact(1.0, 0.0)], &[], &Chassis::default());
        assert!(found.is_empty());
        assert_eq!(rest, side_on);
    }

    #[test]
    fn of_two_boxes_in_a_row_behind_gaps_each_is_cut_off() {
        let first = [(1.74, 0.54), (2.0, 0.8)];
        let second = [(2.0, 1.08), (1.74, 1.36), (2.02, 1.64), (2.3, 1.36), (2.04, 1.08)];
        let row: Vec<(f64, f64)> =
            first.into_iter().chain(second).chain([(2.04, 0.8), (2.3, 0.54)]).collect();
        let (rest, found) =
            islands(joined(&row, 0.28), &[contact(1.0, 0.0)], &[], &Chassis::default());
        assert_eq!(found.len(), 2);
        for ring in found {
            assert!((ring.area() - 0.157).abs() < 0.01, "{}", ring.area());
        }
        assert!((rest.area() - 12.0).abs() < 1e-9, "{}", rest.area());
    }

    #[test]
    fn a_neck_that_was_touched_is_wall() {
        let (rest, found) =
            islands(room(), &[contact(2.0, 0.1), contact(2.04, 0.1)], &[], &Chassis::default());
        assert!(found.is_empty());
        assert_eq!(rest, room());
    }

    #[test]
    fn two_boxes_that_were_gone_round_as_one_are_two() {
        let corners = [
            (0.0, 0.0),
            (0.3, 0.3),
            (0.58, 0.01),
            (0.72, 0.01),
            (1.0, 0.3),
            (1.3, 0.0),
            (1.0, -0.3),
            (0.72, -0.01),
            (0.58, -0.01),
            (0.3, -0.3),
        ];
        let points: Vec<Point> = corners.into_iter().map(|(x, y)| Point::new(x, y)).collect();
        let outline = Ring::polygon(&points).counter_clockwise();
        let found =
            apart(outline, &[contact(0.3, 0.3), contact(1.0, 0.3)], &[], &Chassis::default());
        assert_eq!(found.len(), 2);
        for ring in found {
            assert!((ring.area() - 0.18).abs() < 0.01, "{}", ring.area());
        }
    }

    #[test]
    fn a_gap_that_could_be_passed_is_no_neck() {
        let slim = Chassis { radius: 0.04, range: 0.02, ..Chassis::default() };
        let (_, found) = islands(room(), &[], &[], &slim);
        assert!(found.is_empty());
    }
}
