//! What a lap went round on the way although it stands apart: from both sides of a gap that it did not
//! pass, the robot saw the same stretch of wall, and the contacts, joined in order, cross themselves
//! there. Counted with their sense (every place as often as the line goes round it), they enclose the
//! floor, and leave out what stands in it. And what an outline has lost, or the map does not have yet, although
//! it was gone round. Knows contacts and outlines alone; what becomes of the map, the mission decides.

use super::object::{Thing, things};
use crate::geometry::{Point, Ring, Vector, angle};
use crate::mapping::map::{Contact, ContactKind};
use crate::mapping::wall::Stroke;
use crate::robot::Chassis;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::float::simplify::SimplifyShape;

/// Nothing smaller is taken for a thing, square metres: contacts that came in the wrong order leave
/// such holes.
const SMALLEST: f64 = 4e-3;
/// Contacts of a thing lie within it, or no farther off it than this, metres.
const BESIDE: f64 = 0.03;
/// A thing has at least so many contacts of its own.
const FEWEST: usize = 8;

/// Contacts this near to the wall may be its own, metres.
const OF_WALL: f64 = 0.02;
/// Those that are off it by more than this, metres, are not; ...
const OFF_WALL: f64 = 0.08;
/// ... nearer to each other than this, metres, they are of one thing; ...
const TOGETHER: f64 = 0.1;
/// ... which was gone round if no two neighbouring bearings it was seen at are as far apart, radians; ...
pub const ALL_AROUND: f64 = 2.0;
/// ... and but for its back, that is turned to a wall behind which there is no room for the body, if they are no
/// farther apart than this.
pub const BUT_FOR_ITS_BACK: f64 = 2.9;

/// What a lap went round.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Enclosed {
    /// The contacts of each thing within the room.
    pub things: Vec<Vec<Contact>>,
    /// Those of the wall.
    pub wall: Vec<Contact>,
}

/// The things that the `contacts` of a lap go round within the room, apart from its wall; none when they
/// go round none. In the order of time: what was driven round and round is what is looked for.
#[must_use]
pub fn enclosed(contacts: &[Contact]) -> Enclosed {
    let surfaces: Vec<&Contact> =
        contacts.iter().filter(|contact| contact.kind != ContactKind::Edge).collect();
    let points: Vec<Point> = surfaces.iter().map(|contact| contact.point).collect();
    let mut line: Vec<[f64; 2]> = points.iter().map(|p| [p.x, p.y]).collect();
    if Ring::polygon(&points).area() < 0.0 {
        line.reverse();
    }
    let ring = |contour: &Vec<[f64; 2]>| {
        let points: Vec<Point> = contour.iter().map(|&[x, y]| Point::new(x, y)).collect();
        Ring::polygon(&points)
    };
    let shapes = line.simplify_shape_as::<i64>(FillRule::Positive);
    let parts = shapes.iter().map(|shape| shape.iter().map(ring).collect::<Vec<Ring>>());
    let area = |part: &[Ring]| part.first().map_or(0.0, |outer| outer.area().abs());
    let Some(room) = parts.max_by(|a, b| area(a).total_cmp(&area(b))) else {
        return Enclosed::default();
    };
    let Some((outer, holes)) = room.split_first() else { return Enclosed::default() };
    let holes = holes.iter().filter(|hole| hole.area().abs() > SMALLEST);
    let things: Vec<Vec<Contact>> = holes
        .map(|hole| {
            let of_it = |p: Point| hole.contains(p) || hole.distance(p) < BESIDE;
            let own =
                |c: &&&Contact| of_it(c.point) && hole.distance(c.point) < outer.distance(c.point);
            surfaces.iter().filter(own).map(|contact| **contact).collect::<Vec<Contact>>()
        })
        .filter(|own| own.len() >= FEWEST)
        .collect();
    let of_thing = |contact: &Contact| things.iter().any(|own| own.contains(contact));
    let of_wall = |c: &&Contact| outer.distance(c.point) < OF_WALL && !of_thing(c);
    let wall = contacts.iter().filter(of_wall).copied().collect();
    Enclosed { things, wall }
}

/// Those of the wall's `contacts` that its `outline` keeps, and things that it has lost: made well within
/// the room, where no two neighbouring bearings that one was seen at are as far apart as `widest`, radians. A fit
/// that crosses itself about a thin post may leave it out altogether; what was gone round stands there all the same.
/// Where no outline runs along what was seen of it, as where the lap went round it twice, it is left for the tour to
/// find.
#[must_use]
pub fn lost(contacts: &[Contact], outline: &Ring, widest: f64) -> (Vec<Contact>, Vec<Thing>) {
    let off = |p: Point| outline.contains(p) && outline.distance(p) > OFF_WALL;
    let mut things = Vec::new();
    let together = |one, other| are_near(contacts, one, other);
    let mut groups = gone_round(contacts, off, together, widest);
    groups.retain(|group| {
        let thing = Thing::of(group.iter().map(|&k| contacts[k]).collect());
        let is_drawn = thing.is_drawn();
        things.extend(is_drawn.then_some(thing));
        is_drawn
    });
    let is_kept = |k: &usize| groups.iter().all(|group| group.binary_search(k).is_err());
    let kept = (0..contacts.len()).filter(is_kept).map(|k| contacts[k]).collect();
    (kept, things)
}

/// What was gone round, on the way of `strokes`, beside what is on the map already: made of those `contacts`, in
/// the order in which they were made, that are not `beside` that.
#[must_use]
pub fn unmapped(
    contacts: &[Contact],
    beside: impl Fn(Point) -> bool,
    strokes: &[Stroke],
    chassis: &Chassis,
) -> Vec<Thing> {
    let surfaces: Vec<Contact> =
        contacts.iter().filter(|contact| contact.kind != ContactKind::Edge).copied().collect();
    // A long side is touched seldom, but one touch after the other; and the first follows the last.
    let together = |one: usize, other: usize| {
        let apart = one.abs_diff(other);
        apart == 1 || apart + 1 == surfaces.len() || are_near(&surfaces, one, other)
    };
    let groups = gone_round(&surfaces, |p| !beside(p), together, ALL_AROUND);
    let of = |group: Vec<usize>| group.into_iter().map(|k| surfaces[k]).collect::<Vec<Contact>>();
    let found = groups.into_iter().flat_map(|group| things(&of(group), strokes, chassis));
    found.filter(Thing::is_drawn).collect()
}

/// Whether two of the `contacts` are of one thing, near as they are to each other.
fn are_near(contacts: &[Contact], one: usize, other: usize) -> bool {
    (contacts[one].point - contacts[other].point).norm() < TOGETHER
}

/// Those of the `contacts` that are `off` everything else, in groups `together` that were gone round: where each
/// stands among all of them, in the order in which they were made.
fn gone_round(
    contacts: &[Contact],
    off: impl Fn(Point) -> bool,
    together: impl Fn(usize, usize) -> bool,
    widest: f64,
) -> Vec<Vec<usize>> {
    let is_off = |contact: &Contact| contact.kind != ContactKind::Edge && off(contact.point);
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (k, _) in contacts.iter().enumerate().filter(|(_, contact)| is_off(contact)) {
        let (joined, others): (Vec<_>, Vec<_>) =
            groups.into_iter().partition(|group| group.iter().any(|&other| together(k, other)));
        groups = others;
        groups.push(joined.into_iter().flatten().chain([k]).collect());
    }
    groups.retain(|group| is_gone_round(group.iter().map(|&k| &contacts[k]), widest));
    for group in &mut groups {
        group.sort_unstable();
    }
    groups
}

/// Whether `contacts` enough to draw something were made of it, at bearings of which no two neighbouring ones are as
/// far apart as `widest`, radians.
pub(super) fn is_gone_round<'a>(
    contacts: impl Iterator<Item = &'a Contact> + Clone,
    widest: f64,
) -> bool {
    let count = contacts.clone().count();
    let middle = contacts.clone().map(|c| c.point.coords).sum::<Vector>() / count.max(1) as f64;
    let bearings = contacts.map(|c| angle::of(c.from.coords - middle)).collect();
    count >= FEWEST && angle::widest_gap(bearings) < widest
}

#[cfg(test)]
mod tests {
    use super::super::testing::along;
    use super::*;

    #[test]
    fn a_box_whose_gap_was_seen_from_both_sides_stands_apart() {
        // Along the lower wall to x = 2.1, round a box that stands 0.25 m off it, and on from x = 1.9.
        let mut contacts = along(&[(0.0, 0.0), (2.1, 0.0)], 1.0);
        let around = [(2.0, 0.25), (1.7, 0.55), (2.0, 0.85), (2.3, 0.55), (2.0, 0.25)];
        contacts.extend(along(&around, 1.0));
        contacts.extend(along(&[(1.9, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (0.0, 0.0)], 1.0));
        let apart = enclosed(&contacts).things;
        assert_eq!(apart.len(), 1, "{apart:?}");
        assert!(apart[0].iter().all(|c| c.point.y > 0.2 && c.point.y < 0.9));
        assert!(apart[0].len() > 20, "{}", apart[0].len());
    }

    #[test]
    fn a_post_that_the_outline_leaves_out_is_not_lost() {
        let walls = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (0.0, 0.0)];
        let corners: Vec<Point> = walls[..4].iter().map(|&(x, y)| Point::new(x, y)).collect();
        let outline = Ring::polygon(&corners);
        let post = |turns: f64| {
            (0..16).map(move |k| {
                let away = angle::unit(f64::from(k) * turns * angle::TAU / 16.0);
                let (point, from) =
                    (Point::new(1.0, 1.0) + away * 0.03, Point::new(1.0, 1.0) + away * 0.2);
                Contact { point, from, ..along(&walls, 1.0)[0] }
            })
        };
        let seen =
            |turns: f64| along(&walls, 1.0).into_iter().chain(post(turns)).collect::<Vec<_>>();
        let (kept, things) = lost(&seen(0.9), &outline, ALL_AROUND);
        assert_eq!(things.iter().map(|thing| thing.contacts.len()).collect::<Vec<_>>(), [16]);
        assert_eq!(kept.len(), along(&walls, 1.0).len());
        // Seen from one side only it may be anything.
        let (kept, things) = lost(&seen(0.4), &outline, ALL_AROUND);
        assert!(things.is_empty() && kept.len() == seen(0.4).len());
        assert!(lost(&seen(0.4), &outline, BUT_FOR_ITS_BACK).1.is_empty());
        // So is one whose back was not seen, where nobody could stand to see it.
        assert!(lost(&seen(0.62), &outline, ALL_AROUND).1.is_empty());
        assert_eq!(lost(&seen(0.62), &outline, BUT_FOR_ITS_BACK).1.len(), 1);
    }

    #[test]
    fn a_post_on_a_round_that_led_on_to_what_is_mapped_is_unmapped() {
        // From the post on round a board that is on the map: most of what was seen is known.
        let corners = [(1.3, 1.0), (3.0, 1.0), (3.0, 1.05), (1.3, 1.05), (1.3, 1.0)];
        let board =
            Ring::polygon(&corners[..4].iter().map(|&(x, y)| Point::new(x, y)).collect::<Vec<_>>());
        let mut seen = along(&corners, -1.0);
        let (known, one) = (seen.len(), seen[0]);
        seen.extend((0..14).map(|k| {
            let away = angle::unit(angle::PI - f64::from(k - 7) * angle::TAU / 16.0);
            let (point, from) =
                (Point::new(1.0, 1.0) + away * 0.03, Point::new(1.0, 1.0) + away * 0.16);
            Contact { point, from, ..one }
        }));
        let chassis = Chassis::default();
        let beside = |p| board.contains(p) || board.distance(p) < 0.15;
        let things = unmapped(&seen, beside, &[], &chassis);
        let [post] = &things[..] else { panic!("{things:?}") };
        assert!(known > 20 && post.contacts.len() == 14, "{known} {}", post.contacts.len());
        assert!((post.outline.middle() - Point::new(1.0, 1.0)).norm() < 0.01);
        assert!(unmapped(&seen[..known], beside, &[], &chassis).is_empty());
    }

    #[test]
    fn a_long_thing_on_such_a_round_is_one_though_its_sides_were_touched_seldom() {
        let known = along(&[(3.0, 1.0), (1.3, 1.0)], 1.0);
        let plank = [(0.0, 0.9), (1.0, 0.9), (1.0, 1.1), (0.0, 1.1), (0.0, 0.9)];
        let seldom = along(&plank, -1.0).into_iter().step_by(4);
        let touches = seldom.len();
        let mut seen: Vec<Contact> = seldom.chain(known).collect();
        // The round may begin in the middle of a side.
        for begun in [0, 2] {
            seen.rotate_left(begun);
            let things = unmapped(&seen, |p| p.x > 1.25, &[], &Chassis::default());
            let [thing] = &things[..] else { panic!("{begun}: {things:?}") };
            assert!((thing.outline.area() - 0.2).abs() < 0.01, "{:?}", thing.outline);
            assert_eq!(thing.contacts.len(), touches, "{begun}: all of it");
        }
    }

    #[test]
    fn a_plain_room_has_nothing_in_it() {
        let walls = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (0.0, 0.0)];
        assert!(enclosed(&along(&walls, 1.0)).things.is_empty());
        assert!(enclosed(&[]).things.is_empty());
    }
}
