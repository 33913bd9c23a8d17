//! Outlines of extrinsic objects, which the robot met from outside: fitted where it went all the way round,
//! else drawn as far as it saw. Knows nothing of where else on the map a thing may stand.

use super::assemble::Loops;
use super::classify::SHALLOW;
use super::order;
use super::rectangle::rectangle;
use crate::geometry::hull::{deepest_bay, jarvis};
use crate::geometry::{Piece, Point, Ring, angle, cross};
use crate::mapping::map::{Contact, ContactKind, MappedObject, ObjectClass};
use crate::mapping::wall::Stroke;
use crate::robot::Chassis;
use std::cell::LazyCell;

/// The robot's reach only bounds inner corners of a bay here, metres.
const REACH: f64 = 0.16;
/// A rectangle may lie this much looser on the contacts than a ring of more pieces.
const LOOSER: f64 = 1.2;
/// A hull is as close to the contacts as a ring when it lies no more than so many times as far off, or than
/// so many times this, metres; the ring has folded up when the hull is so many times as large.
const AS_CLOSE: f64 = 1.6;
const CLOSE: f64 = 0.001;
/// Of a thing no larger than this across, metres, both of its sides may be met at once, and beside a wall its edges are
/// met as often as its face: contacts lie within it by this much more.
const SMALL: f64 = 0.12;
const CLOSE_IF_SMALL: f64 = 0.0025;
const FOLDED: f64 = 1.2;
/// The chord that closes what was not gone round is its other side when it is no longer than this share of
/// the way along what was seen, ...
const MOST_UNSEEN: f64 = 0.5;
/// ... and else what was seen is as deep as this, metres.
const DEPTH: f64 = 0.01;
/// Fitted anew an object is the same when its area is no more than so many times as large, or as small.
const MOST_GROWTH: f64 = 2.0;
/// Contacts lie on an outline within this, metres, ...
const ON: f64 = 0.015;
/// ... and when fewer than this share of them do, it is no picture of what was touched.
const NEARLY_ALL: f64 = 0.9;
/// An outline that comes as near to itself as this has come back, metres; ...
const PINCHED: f64 = 0.001;
/// ... and a spike is what it goes round there, if it is less than this, square metres.
const SPIKE: f64 = 3e-4;
/// How far a corner may be from a right angle, radians.
const RIGHT: f64 = 5.0 * angle::PI / 180.0;

/// The surface of an object from its contacts in time order, counter-clockwise, and what it looks
/// like. When it is not `closed`, the ring runs along what was seen of it.
#[must_use]
pub fn object_outline(contacts: &[Contact], closed: bool) -> (Ring, ObjectClass) {
    if !closed {
        return (chain(contacts), ObjectClass::Open);
    }
    // The floor lies outside: the fitted ring runs clockwise round the solid.
    let ordered = order::along_wall(contacts, REACH);
    let fitted = super::fitted(&ordered, REACH, 0.0, Loops::All).map(Ring::counter_clockwise);
    let is_sound = |ring: &&Ring| share_on(ring, contacts) >= NEARLY_ALL;
    let fit = fitted.as_ref().filter(is_sound);
    let spread = fit.map_or(f64::INFINITY, |ring| spread(ring, contacts));
    if let Some(ring) =
        rectangle(contacts).filter(|ring| self::spread(ring, contacts) < LOOSER * spread)
    {
        return (ring, ObjectClass::Rectangle);
    }
    // Untangled only where it is asked for.
    let joined = LazyCell::new(|| super::chain::outline(&ordered).map(Ring::counter_clockwise));
    let join = || joined.as_ref().filter(is_sound);
    let found = match fit {
        // One with a spike is better than none.
        Some(ring) if has_spike(ring) => join().filter(|other| !has_spike(other)).or(fit),
        fit => fit.or_else(join),
    };
    let ring = match found {
        Some(ring) if !leaves_out(ring, contacts) => ring.clone(),
        Some(_) => hull(contacts),
        // None is a picture of what was touched: the one that misses fewest.
        None => [fitted.as_ref(), joined.as_ref()].into_iter().flatten().cloned().fold(
            hull(contacts),
            |best, other| {
                let is_closer = share_on(&other, contacts) >= share_on(&best, contacts);
                if is_closer { other } else { best }
            },
        ),
    };
    let class = class_of(&ring);
    (ring, class)
}

/// The surface of a closed object fitted anew to its `contacts`, which have moved since `outline` was fitted;
/// none where that lies no closer to them, or would be another thing.
#[must_use]
pub fn closer(outline: &Ring, contacts: &[Contact]) -> Option<(Ring, ObjectClass)> {
    let (ring, class) = object_outline(contacts, true);
    let same = 1.0 / MOST_GROWTH..MOST_GROWTH;
    let closer = spread(&ring, contacts) < spread(outline, contacts)
        && same.contains(&(ring.area() / outline.area()));
    closer.then_some((ring, class))
}

/// One of the things that a round went round.
#[derive(Debug, Clone, PartialEq)]
pub struct Thing {
    /// Its surface, counter-clockwise.
    pub outline: Ring,
    /// What it looks like.
    pub class: ObjectClass,
    /// The contacts that lie on it.
    pub contacts: Vec<Contact>,
}

impl Thing {
    /// What was gone round all the way, from all that was seen of it.
    #[must_use]
    pub fn of(contacts: Vec<Contact>) -> Self {
        let (outline, class) = object_outline(&contacts, true);
        Self { outline, class, contacts }
    }

    /// Whether its outline runs along nearly all that was seen of it, and encloses what lies behind that: one
    /// that comes back the way it went encloses nothing.
    pub(super) fn is_drawn(&self) -> bool {
        let is_solid =
            |c: &&Contact| behind(c, DEPTH / 2.0).is_some_and(|p| self.outline.contains(p));
        let solid = self.contacts.iter().filter(is_solid).count();
        share_on(&self.outline, &self.contacts) >= NEARLY_ALL && 2 * solid > self.contacts.len()
    }

    /// As it goes into the map.
    #[must_use]
    pub fn numbered(self, id: u32) -> MappedObject {
        let Self { outline, class, contacts } = self;
        MappedObject { id, class, outline, closed: true, contacts }
    }
}

/// What was gone round once, all the way, as one: mostly one thing, several where the robot does not
/// fit between them but saw, on the way of `strokes`, that they are apart.
#[must_use]
pub fn things(contacts: &[Contact], strokes: &[Stroke], chassis: &Chassis) -> Vec<Thing> {
    let contacts = super::stray::without_strays(contacts, chassis);
    match super::divide::divided(&contacts, strokes, chassis) {
        Some(parts) => parts.into_iter().flat_map(|part| necked(part, strokes, chassis)).collect(),
        None => necked(contacts, strokes, chassis),
    }
}

/// The same of what no floor that was seen parts: things that only untouched chords join are several.
pub(super) fn necked(contacts: Vec<Contact>, strokes: &[Stroke], chassis: &Chassis) -> Vec<Thing> {
    let thing = Thing::of(contacts);
    if thing.class != ObjectClass::Concave {
        return vec![thing];
    }
    let Thing { outline, contacts, .. } = thing;
    let rings = super::neck::apart(outline, &contacts, strokes, chassis);
    let parts = super::neck::shared_out(&contacts, &rings);
    let thing = |(outline, contacts)| Thing { class: class_of(&outline), outline, contacts };
    rings.into_iter().zip(parts).map(thing).collect()
}

/// A contact this near to something mapped belongs to it, metres: nothing that stands so near to it
/// could be gone round for itself.
pub const KNOWN: f64 = 0.15;
/// What was gone round is something known when this share of its contacts lies on that.
const SAME: f64 = 0.6;

/// Whether what was seen is one of the `mapped` things, or several of them.
pub fn is_mapped<'a>(
    contacts: &[Contact],
    mapped: &(impl Iterator<Item = &'a Ring> + Clone),
) -> bool {
    let on_map = contacts.iter().filter(|c| mapped.clone().any(|r| r.distance(c.point) < KNOWN));
    on_map.count() as f64 > SAME * contacts.len() as f64
}

/// Whether all that was seen lies on `ring`.
#[must_use]
pub fn lies_on(contacts: &[Contact], ring: &Ring) -> bool {
    contacts.iter().all(|contact| ring.distance(contact.point) < KNOWN)
}

/// Root mean square distance of the contacts from the ring, metres.
fn spread(ring: &Ring, contacts: &[Contact]) -> f64 {
    let touched = contacts.iter().filter(|c| c.kind != ContactKind::Edge);
    let (sum, count) = touched.fold((0.0, 0), |(sum, count), contact| {
        (sum + ring.distance(contact.point).powi(2), count + 1)
    });
    (sum / f64::from(count.max(1))).sqrt()
}

/// Whether `ring` leaves out what its contacts enclose, as one that folds up does where a side of the thing
/// was not seen: its convex hull lies as close to them, and is larger.
fn leaves_out(ring: &Ring, contacts: &[Contact]) -> bool {
    let hull = hull(contacts);
    let is_small = hull.bounds().is_some_and(|(low, high)| (high - low).norm() < SMALL);
    let close = if is_small { CLOSE_IF_SMALL } else { CLOSE };
    let as_close = spread(&hull, contacts) < AS_CLOSE * spread(ring, contacts).max(close);
    as_close && hull.area() > FOLDED * ring.area()
}

/// Share of the contacts that lie on the ring; none do on one that encloses nothing.
fn share_on(ring: &Ring, contacts: &[Contact]) -> f64 {
    let touched = contacts.iter().filter(|c| c.kind != ContactKind::Edge);
    let (on, all) = touched.fold((0, 0), |(on, all), contact| {
        (on + u32::from(ring.distance(contact.point) < ON), all + 1)
    });
    if ring.area().abs() > 1e-5 { f64::from(on) / f64::from(all.max(1)) } else { 0.0 }
}

/// Whether a spike stands out of the outline, as a touch out of line leaves one beside a thin post: it comes
/// back to itself, and what it goes round there is next to nothing. Two things that it joins by a neck are
/// not.
fn has_spike(ring: &Ring) -> bool {
    // Pieces that are hardly any keep no others apart.
    let long: Vec<Piece> =
        ring.pieces.iter().copied().filter(|piece| piece.length() > PINCHED).collect();
    let count = long.len();
    let meets = |k: usize, j: usize| j == k || (j + 1) % count == k;
    let small = |k: usize, j: usize| {
        let way = (j + count - k) % count;
        let part: Vec<Piece> = (0..=way).map(|n| long[(k + n) % count]).collect();
        let part = Ring { pieces: part };
        let points = part.to_points(PINCHED);
        Ring::polygon(&points).area().abs() < SPIKE
    };
    (0..count).any(|k| {
        let corner = long[k].from();
        (0..count)
            .filter(|&j| !meets(k, j) && long[j].distance(corner) < PINCHED)
            .any(|j| small(k, j) || small(j, (k + count - 1) % count))
    })
}

/// What the outline of a closed object looks like.
#[must_use]
pub fn class_of(ring: &Ring) -> ObjectClass {
    if ring.is_circle() {
        return ObjectClass::Circle;
    }
    let count = ring.pieces.len();
    let right = (0..count).all(|k| {
        let (u, v) = (ring.pieces[k].tangent(1.0), ring.pieces[(k + 1) % count].tangent(0.0));
        (angle::atan2(cross(u, v), u.dot(&v)) - angle::FRAC_PI_2).abs() < RIGHT
    });
    if count == 4 && right {
        ObjectClass::Rectangle
    } else if deepest_bay(&ring.to_points(1e-3)) < SHALLOW {
        ObjectClass::Convex
    } else {
        ObjectClass::Concave
    }
}

fn hull(contacts: &[Contact]) -> Ring {
    let points: Vec<Point> = contacts.iter().map(|c| c.point).collect();
    let corners: Vec<Point> = jarvis(&points).into_iter().map(|k| points[k]).collect();
    Ring::polygon(&corners)
}

/// What lies `depth` metres behind a contact, as seen from where it was made.
fn behind(contact: &Contact, depth: f64) -> Option<Point> {
    let away = (contact.point - contact.from).try_normalize(1e-9)?;
    Some(contact.point + away * depth)
}

/// Whether what the `contacts`, joined in order and closed by a chord, go round is where most of them were made from:
/// then they are of what the robot stands in.
#[must_use]
pub fn is_seen_from_within(contacts: &[Contact]) -> bool {
    let points: Vec<Point> = contacts.iter().map(|contact| contact.point).collect();
    let closed = Ring::polygon(&points);
    let within = contacts.iter().filter(|contact| closed.contains(contact.from)).count();
    2 * within > contacts.len()
}

/// What was seen of something that was not gone round, closed by a chord: where the chord is short that is
/// nearly all of it. Where it is long nobody knows what lies behind, and the floor on the other side, which
/// may be the half of a room, is not taken for solid: then only what was seen counts, and a little depth. So it is
/// where it was seen from within: a robot that is lost and takes the wall of its room for a thing stands in the middle
/// of that.
fn chain(contacts: &[Contact]) -> Ring {
    let seen = order::along_open(contacts);
    let mut points: Vec<Point> = seen.iter().map(|c| c.point).collect();
    let gone: f64 = points.windows(2).map(|two| (two[1] - two[0]).norm()).sum();
    let chord = points.first().zip(points.last()).map_or(0.0, |(a, b)| (b - a).norm());
    if chord > MOST_UNSEEN * gone || is_seen_from_within(&seen) {
        points.extend(seen.iter().rev().filter_map(|c| behind(c, DEPTH)));
    }
    Ring::polygon(&points).counter_clockwise()
}

#[cfg(test)]
mod tests {
    use super::super::testing::along;
    use super::*;

    /// A robot that is lost may go round in its own room and take the wall for a thing.
    #[test]
    fn what_was_seen_from_within_is_not_solid() {
        let room = along(&[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (0.0, 0.3)], 1.0);
        assert!(is_seen_from_within(&room));
        let (outline, class) = object_outline(&room, false);
        assert_eq!(class, ObjectClass::Open);
        assert!(!outline.contains(Point::new(2.0, 1.5)));
        assert!((0.05..0.3).contains(&outline.area()), "{}", outline.area());
        // Its other side is, once it was gone round outside.
        let box_ = along(&[(0.0, 0.0), (0.4, 0.0), (0.4, 0.3), (0.0, 0.3), (0.0, 0.1)], -1.0);
        assert!(!is_seen_from_within(&box_));
        let (outline, _) = object_outline(&box_, false);
        assert!(outline.contains(Point::new(0.2, 0.15)), "{}", outline.area());
    }

    #[test]
    fn a_half_seen_wall_does_not_make_the_room_behind_it_solid() {
        // 6 m of a wall with a step in it; a chord from end to end would cut off 0.6 m².
        let seen = along(&[(0.0, 0.0), (3.0, 0.0), (3.0, 0.2), (6.0, 0.2)], -1.0);
        let (outline, class) = object_outline(&seen, false);
        assert_eq!(class, ObjectClass::Open);
        assert!(outline.area() < 6.3 * 1.5 * DEPTH, "{} m²", outline.area());
        assert!(seen.iter().all(|contact| outline.distance(contact.point) < 1e-9));
        let middle = Point::new(3.0, 0.1);
        for off in [-0.5, 0.5] {
            let beside = middle + crate::geometry::Vector::new(off, off);
            assert!(!outline.contains(beside) && outline.distance(beside) > 0.3);
        }
    }

    #[test]
    fn of_a_thing_seen_nearly_all_round_the_chord_is_its_other_side() {
        let seen = along(&[(0.0, 0.0), (0.6, 0.0), (0.6, 0.4), (0.0, 0.4)], -1.0);
        let (outline, _) = object_outline(&seen, false);
        assert!(outline.contains(Point::new(0.3, 0.2)), "{outline:?}");
        assert!((outline.area() - 0.24).abs() < 0.03, "{} m²", outline.area());
    }

    #[test]
    fn a_spike_beside_a_post_is_seen() {
        // Round a post of 34 mm: three arcs, and the touch that came first, 11 mm off.
        let post = |spike: bool| {
            let at = |x: f64, y: f64| Point::new(x, y);
            let mut pieces = vec![
                Piece::with_bulge(at(2.315, 1.3363), at(2.3554, 1.2967), 0.610_553),
                Piece::with_bulge(at(2.3554, 1.2967), at(2.3678, 1.3544), 0.592_451),
            ];
            if spike {
                pieces.push(Piece::with_bulge(at(2.3678, 1.3544), at(2.3124, 1.3338), 0.592_451));
                let way = [(2.3124, 1.3338), (2.316, 1.3385), (2.3037, 1.3111), (2.3093, 1.3099)];
                let way = way.map(|(x, y)| at(x, y));
                pieces.extend(way.windows(2).map(|two| Piece::with_bulge(two[0], two[1], 0.0)));
                pieces.push(Piece::with_bulge(way[3], at(2.315, 1.3363), 0.0));
            } else {
                pieces.push(Piece::with_bulge(at(2.3678, 1.3544), at(2.315, 1.3363), 0.58));
            }
            Ring { pieces }
        };
        assert!(has_spike(&post(true)));
        assert!(!has_spike(&post(false)));
        let board = Ring::polygon(
            &[(0.0, 0.0), (1.0, 0.0), (1.0, 0.02), (0.0, 0.02)].map(|(x, y)| Point::new(x, y)),
        );
        assert!(!has_spike(&board), "thin is no spike");
        // Two boxes and a neck between them that has no width.
        let way =
            [(0.0, 0.0), (0.2, 0.0), (0.2, 0.1), (0.3, 0.1), (0.3, 0.0), (0.5, 0.0), (0.5, 0.2)];
        let back = [(0.3, 0.2), (0.3, 0.1002), (0.2, 0.1002), (0.2, 0.2), (0.0, 0.2)];
        let necked: Vec<Point> = way.iter().chain(&back).map(|&(x, y)| Point::new(x, y)).collect();
        assert!(!has_spike(&Ring::polygon(&necked)));
    }

    #[test]
    fn an_outline_that_comes_back_the_way_it_went_is_not_drawn() {
        let corners = [(0.0, 0.0), (0.5, 0.0), (0.5, 0.4), (0.0, 0.4)];
        let seen = along(&[&corners[..], &corners[..1]].concat(), -1.0);
        let thing = Thing::of(seen.clone());
        assert!(thing.is_drawn(), "{:?}", thing.outline);
        // There, and back 1 mm beside.
        let back = [(0.001, 0.399), (0.499, 0.399), (0.499, 0.001), (0.0, 0.001)];
        let way: Vec<Point> = corners.iter().chain(&back).map(|&(x, y)| Point::new(x, y)).collect();
        let folded = Thing { outline: Ring::polygon(&way), ..Thing::of(seen) };
        assert!(!folded.is_drawn(), "{} m²", folded.outline.area());
    }

    #[test]
    fn a_ring_that_folds_up_where_nothing_was_seen_leaves_out_what_is_there() {
        // Two sides of a leg, whose others nobody saw; a fit has joined them along themselves.
        let seen = along(&[(0.0, 0.0), (0.08, 0.0), (0.08, 0.07)], -1.0);
        let corners = [(0.0, 0.0), (0.08, 0.0), (0.08, 0.07), (0.078, 0.003)];
        let folded = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        assert!(leaves_out(&folded, &seen), "{} m²", folded.area());
        // A bay that was seen is none.
        let bay = [(0.0, 0.0), (0.3, 0.0), (0.3, 0.3), (0.15, 0.1), (0.0, 0.3)];
        let ring = Ring::polygon(&bay.map(|(x, y)| Point::new(x, y)));
        assert!(!leaves_out(&ring, &along(&[&bay[..], &bay[..1]].concat(), -1.0)));
    }

    #[test]
    fn an_outline_follows_its_contacts_when_they_have_moved() {
        let board = |depth: f64| [(0.0, 0.0), (1.0, 0.0), (1.0, depth), (0.0, depth), (0.0, 0.0)];
        let seen = along(&board(0.02), -1.0);
        let as_it_was = object_outline(&along(&board(0.012), -1.0), true).0;
        let (ring, class) = closer(&as_it_was, &seen).expect("8 mm thicker");
        assert_eq!(class, ObjectClass::Rectangle);
        assert!((0.0185..0.0205).contains(&ring.area()), "{} m²", ring.area());
        assert_eq!(closer(&ring, &seen), None, "no closer than it is");
        let box_of_it = Ring::polygon(
            &[(0.0, -0.5), (1.0, -0.5), (1.0, 0.5), (0.0, 0.5)].map(|(x, y)| Point::new(x, y)),
        );
        assert_eq!(closer(&box_of_it, &seen), None, "fifty times as large");
    }
}
