//! Things told apart by the floor between them: the robot does not fit through, but its beams have looked
//! into the gap from both sides, and met nothing. What no such floor parts is one thing; and so is what stands
//! nearer together than the body would come between ([`super::gap`]). Knows contacts and the robot's way.

use super::gap::Gap;
use super::object::object_outline;
use crate::geometry::raster::Grid;
use crate::geometry::segment::chords;
use crate::geometry::{Point, Ring, Segment, Vector, angle};
use crate::mapping::map::{Contact, ContactKind};
use crate::mapping::wall::{Stroke, swept};
use crate::robot::Chassis;
use std::collections::{BTreeMap, BTreeSet};

/// How finely the floor is looked at, metres.
const CELL: f64 = 0.005;
/// What is larger than so many of them, 7 m square, is not looked at so finely.
const MOST_CELLS: usize = 2_000_000;
/// About the contacts, metres.
const MARGIN: f64 = 0.03;
/// What is nearer than this to a contact is no floor, metres.
const TOUCHED: f64 = 0.008;
/// What nobody has looked at and is no wider than twice so many cells joins nothing: beams are held to be
/// free a little less far than they reach, and no board is so thin.
const THIN: usize = 2;
/// Contacts that scatter more than this about the surfaces they are of do not tell how far the beams of their
/// switches reach, metres: those of worn switches.
const EXACT: f64 = 0.0025;
/// What is wider than twice so many cells and was not looked at may be a board.
const BOARD: usize = 3;
/// A contact lies no farther than this from the middle of what it is of, metres.
const BESIDE: f64 = 0.05;
/// Things nearer to each other than this are as good as joined, metres.
const APART: f64 = 0.06;
/// A robot goes straight round what is no larger than this, metres.
const SMALL: f64 = 0.5;
/// A thing that was seen from nowhere within so wide an angle was not gone round, radians.
const MOST_UNSEEN: f64 = 2.6;
/// Nothing is pressed into the body so far, nor is its way, beside what it goes round, off by so much, metres.
const PRESSED: f64 = 0.03;
/// A thing has at least so many contacts.
const FEWEST: usize = 4;

/// What the robot has looked at beside the `contacts` it made on the way of `strokes`, and what is left.
struct Unswept {
    grid: Grid,
    solid: Vec<bool>,
}

impl Unswept {
    fn beside(contacts: &[Contact], strokes: &[Stroke], chassis: &Chassis) -> Option<Self> {
        let (low, high) = bounds(contacts)?;
        let grid = Grid::over(low, high, CELL, MARGIN);
        if grid.len() > MOST_CELLS {
            return None;
        }
        let free = swept(strokes, chassis, &grid);
        let mut solid: Vec<bool> = free.into_iter().map(|free| !free).collect();
        for contact in contacts.iter().filter(|contact| contact.kind == ContactKind::Range) {
            for cell in about(&grid, contact.point, TOUCHED) {
                solid[cell] = true;
            }
        }
        Some(Self { grid, solid })
    }

    /// Of which piece each of the `contacts` is, when what is no wider than twice `thin` cells joins nothing.
    fn pieces(&self, contacts: &[Contact], thin: usize) -> Vec<Option<usize>> {
        let core = eroded(&self.solid, &self.grid, thin);
        let labels = together(labelled(&core, &self.grid), &self.grid);
        contacts.iter().map(|contact| nearest(&labels, &self.grid, contact.point)).collect()
    }
}

/// The `contacts` of each of the things that floor parts, in their order, when the robot came by the way of
/// `strokes`; none where they are all of one.
#[must_use]
pub(super) fn divided(
    contacts: &[Contact],
    strokes: &[Stroke],
    chassis: &Chassis,
) -> Option<Vec<Vec<Contact>>> {
    if !are_exact(contacts, chassis) {
        return None;
    }
    let of = Unswept::beside(contacts, strokes, chassis)?.pieces(contacts, THIN);
    let of = as_one(&shared_out(contacts, &of)?, contacts, chassis);
    let parts: Vec<Vec<Contact>> = grouped(contacts, &of).into_values().collect();
    let whole = || parts.iter().all(|part| widest_unseen(part) < MOST_UNSEEN);
    (parts.len() > 1 && (whole() || is_driven_over(contacts, strokes, chassis))).then_some(parts)
}

/// Whether the body of the robot was, on the way of `strokes`, within what all its `contacts` together enclose:
/// seen from one side only or not, what it came between is several.
fn is_driven_over(contacts: &[Contact], strokes: &[Stroke], chassis: &Chassis) -> bool {
    let sides = chords(&object_outline(contacts, true).0, CELL);
    let within = (chassis.radius - PRESSED).powi(2);
    let enters = |way: &Segment| sides.iter().any(|side| way.gap_squared(side) < within);
    strokes.iter().any(|stroke| enters(&stroke.way()))
}

/// Of which piece each of the `contacts` is, when `of` tells it for those that lie on one: the others are of
/// that of their nearest neighbour, and so are the few on what is no thing. None where all are of one.
fn shared_out(contacts: &[Contact], of: &[Option<usize>]) -> Option<Vec<usize>> {
    let mut counts = BTreeMap::<usize, usize>::new();
    for piece in of.iter().flatten() {
        *counts.entry(*piece).or_default() += 1;
    }
    counts.retain(|_, count| *count >= FEWEST);
    if counts.len() < 2 {
        return None;
    }
    let sure: Vec<(Point, usize)> = contacts
        .iter()
        .zip(of)
        .filter_map(|(contact, piece)| Some((contact.point, (*piece)?)))
        .filter(|(_, piece)| counts.contains_key(piece))
        .collect();
    let piece_of = |(contact, piece): (&Contact, &Option<usize>)| {
        let off = |p: Point| (p - contact.point).norm();
        let beside = || sure.iter().min_by(|a, b| off(a.0).total_cmp(&off(b.0))).map(|it| it.1);
        piece.filter(|piece| counts.contains_key(piece)).or_else(beside)
    };
    contacts.iter().zip(of).map(piece_of).collect()
}

/// The `contacts` of each of the pieces that they are `of`.
fn grouped(contacts: &[Contact], of: &[usize]) -> BTreeMap<usize, Vec<Contact>> {
    let mut parts = BTreeMap::<usize, Vec<Contact>>::new();
    for (contact, piece) in contacts.iter().zip(of) {
        parts.entry(*piece).or_default().push(*contact);
    }
    parts.into_iter().map(|(piece, part)| (piece, in_order(part))).collect()
}

/// The pieces that the `contacts` are `of`, those as one between which the body would not come
/// ([`super::gap`]), though a beam looked through.
fn as_one(of: &[usize], contacts: &[Contact], chassis: &Chassis) -> Vec<usize> {
    let outlined = |(piece, part): (usize, Vec<Contact>)| (piece, object_outline(&part, true).0);
    let rings: Vec<(usize, Ring)> = grouped(contacts, of).into_iter().map(outlined).collect();
    let free = |p: Point| rings.iter().all(|(_, ring)| !ring.contains(p));
    let mut stands_for: BTreeMap<usize, usize> = rings.iter().map(|(k, _)| (*k, *k)).collect();
    for (k, (one, ring)) in rings.iter().enumerate() {
        for (other, beside) in &rings[k + 1..] {
            let apart = |gap: Gap| gap.parts(free, chassis);
            if !Gap::between(ring, beside).is_some_and(apart) {
                let (kept, gone) = (stands_for[one], stands_for[other]);
                stands_for.values_mut().filter(|piece| **piece == gone).for_each(|it| *it = kept);
            }
        }
    }
    of.iter().map(|piece| stands_for[piece]).collect()
}

/// Whether `contacts` lie on their surfaces well enough to tell how far the beams of their switches reach.
fn are_exact(contacts: &[Contact], chassis: &Chassis) -> bool {
    super::scatter(contacts, chassis.reach()) < EXACT
}

/// Whether `parts` of what was gone round on the way of `strokes` are one thing after all, though their worn
/// switches have laid its faces through each other: what nobody has looked at joins them, as wide as a board
/// is with what beams leave out beside it.
#[must_use]
pub(super) fn are_one(parts: &[Vec<Contact>], strokes: &[Stroke], chassis: &Chassis) -> bool {
    let contacts = parts.concat();
    // Of exact contacts the chords that join the parts tell more. Of a way that nobody recorded nothing is
    // known.
    if strokes.is_empty() || are_exact(&contacts, chassis) {
        return false;
    }
    let Some(unswept) = Unswept::beside(&contacts, strokes, chassis) else { return false };
    let (of, mut found) = (unswept.pieces(&contacts, BOARD), BTreeSet::new());
    let mut of = of.into_iter();
    parts.iter().any(|part| {
        let mut counts = BTreeMap::<usize, usize>::new();
        for piece in of.by_ref().take(part.len()).flatten() {
            *counts.entry(piece).or_default() += 1;
        }
        let most = counts.into_iter().max_by_key(|(_, count)| *count);
        most.is_some_and(|(piece, _)| !found.insert(piece))
    })
}

/// The widest angle about the middle of a thing from within which nothing of it was seen, radians.
fn widest_unseen(contacts: &[Contact]) -> f64 {
    let Some((low, high)) = bounds(contacts) else { return angle::TAU };
    let middle = nalgebra::center(&low, &high);
    angle::widest_gap(contacts.iter().map(|c| angle::of(c.from - middle)).collect())
}

/// The contacts of one thing in the order in which a robot goes round it counter-clockwise: it came by more
/// than once, with another thing between. Round what is large it may not go so straight.
fn in_order(mut contacts: Vec<Contact>) -> Vec<Contact> {
    let Some((low, high)) = bounds(&contacts) else { return contacts };
    let middle = nalgebra::center(&low, &high);
    if (high - low).norm() < SMALL {
        let bearing = |contact: &Contact| angle::of(contact.from - middle);
        contacts.sort_by(|a, b| bearing(a).total_cmp(&bearing(b)));
    }
    contacts
}

fn bounds(contacts: &[Contact]) -> Option<(Point, Point)> {
    let first = contacts.first()?.point;
    Some(contacts.iter().fold((first, first), |(low, high), contact| {
        (low.inf(&contact.point), high.sup(&contact.point))
    }))
}

/// The cells within `radius` of `p`.
fn about(grid: &Grid, p: Point, radius: f64) -> impl Iterator<Item = usize> {
    let corner = Vector::new(radius, radius);
    let ((x0, y0), (x1, y1)) = (grid.locate(p - corner), grid.locate(p + corner));
    let cells = (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| (x, y)));
    cells
        .filter(move |&(x, y)| (grid.center(x, y) - p).norm() < radius)
        .map(|(x, y)| y * grid.width + x)
}

/// `solid` without a rim of so many cells.
fn eroded(solid: &[bool], grid: &Grid, rim: usize) -> Vec<bool> {
    let mut core = solid.to_vec();
    for _ in 0..rim {
        let before = core.clone();
        for (cell, core) in core.iter_mut().enumerate() {
            let whole = |next: &Option<usize>| next.is_none_or(|next| before[next]);
            *core &= grid.neighbours(cell).iter().all(whole);
        }
    }
    core
}

/// For every cell of `core` which piece of it the cell belongs to.
fn labelled(core: &[bool], grid: &Grid) -> Vec<Option<usize>> {
    let mut labels = vec![None; core.len()];
    let mut next = 0;
    for seed in 0..core.len() {
        if !core[seed] || labels[seed].is_some() {
            continue;
        }
        let mut stack = vec![seed];
        labels[seed] = Some(next);
        while let Some(cell) = stack.pop() {
            for beside in grid.neighbours(cell).into_iter().flatten() {
                if core[beside] && labels[beside].is_none() {
                    labels[beside] = Some(next);
                    stack.push(beside);
                }
            }
        }
        next += 1;
    }
    labels
}

/// The pieces that `labels` names, those nearer to each other than [`APART`] as one: where the pose was a
/// little off a beam seems to have crossed a board.
fn together(mut labels: Vec<Option<usize>>, grid: &Grid) -> Vec<Option<usize>> {
    loop {
        let at_rim = |cell: &usize| {
            labels[*cell].is_some()
                && grid.neighbours(*cell).iter().flatten().any(|next| labels[*next].is_none())
        };
        let rims: Vec<usize> = (0..labels.len()).filter(at_rim).collect();
        let other = |cell: usize| {
            let near = about(grid, grid.point(cell), APART);
            near.filter_map(|next| labels[next]).find(|label| Some(*label) != labels[cell])
        };
        let Some((one, another)) =
            rims.iter().find_map(|&cell| Some((labels[cell]?, other(cell)?)))
        else {
            return labels;
        };
        for label in labels.iter_mut().filter(|label| **label == Some(another)) {
            *label = Some(one);
        }
    }
}

/// The piece nearest to `p`, if one is near.
fn nearest(labels: &[Option<usize>], grid: &Grid, p: Point) -> Option<usize> {
    let off = |cell: &usize| (grid.point(*cell) - p).norm();
    about(grid, p, BESIDE)
        .filter(|cell| labels[*cell].is_some())
        .min_by(|a, b| off(a).total_cmp(&off(b)))
        .and_then(|cell| labels[cell])
}

#[cfg(test)]
mod tests {
    use super::super::neck::told_apart;
    use super::*;
    use crate::geometry::Pose;
    use crate::mapping::wall::Wall;
    use crate::robot::SwitchSet;

    /// From (x, y) to (x, y).
    type Block = ((f64, f64), (f64, f64));

    /// Two legs of 5 cm, 0.18 m apart.
    const LEGS: [Block; 2] = [((-0.14, -0.025), (-0.09, 0.025)), ((0.09, -0.025), (0.14, 0.025))];
    /// A board of 2 cm between them.
    const BOARD_BETWEEN: Block = ((-0.1, -0.01), (0.1, 0.01));

    /// How far `p` is off the nearest of `blocks`, metres.
    fn off(blocks: &[Block], p: Point) -> f64 {
        let from = |((x0, y0), (x1, y1)): &Block| {
            Vector::new((x0 - p.x).max(p.x - x1).max(0.0), (y0 - p.y).max(p.y - y1).max(0.0)).norm()
        };
        blocks.iter().map(from).fold(f64::INFINITY, f64::min)
    }

    /// Which switches are closed at `pose`.
    fn closed(blocks: &[Block], chassis: &Chassis, pose: Pose) -> SwitchSet {
        let sees = |bearing: f64| {
            let ray = angle::unit(pose.heading + bearing);
            let mut steps = (0..60).map(|k| pose.position + ray * (0.1 + 0.001 * f64::from(k)));
            steps.any(|p| off(blocks, p) < 5e-4)
        };
        let mounts = chassis.sensors.iter().enumerate();
        mounts
            .filter(|(_, mount)| sees(mount.angle))
            .fold(SwitchSet::EMPTY, |set, (k, _)| set.with(k, true))
    }

    /// What a robot sees of `blocks` that goes round them at 0.145 m, looking to both sides every 2 cm.
    fn gone_round(blocks: &[Block]) -> (Vec<Contact>, Wall) {
        let chassis = Chassis::default();
        let mut wall = Wall::new(&chassis);
        let mut contacts = Vec::new();
        let all = SwitchSet(u16::MAX);
        for k in 0..90 {
            let bearing = angle::TAU * f64::from(k) / 90.0;
            // Inwards until it is near enough.
            let inwards =
                |far: i32| Point::from(angle::unit(bearing) * (0.5 - 0.001 * f64::from(far)));
            let Some(at) = (0..400).map(inwards).find(|p| off(blocks, *p) < 0.145) else {
                continue;
            };
            let mut pose = Pose { position: at, heading: bearing };
            wall.carve(pose, all, 0.0, 0);
            for turn in (0..9).chain((0..9).rev()) {
                let before = closed(blocks, &chassis, pose);
                pose.heading = bearing + 0.1 * f64::from(turn);
                let shut = before.union(closed(blocks, &chassis, pose));
                wall.carve(pose, shut, 0.0, 0);
            }
            // The place of the surface that is nearest.
            let toward = |turn: i32| at + angle::unit(0.01 * f64::from(turn)) * 0.146;
            let touched = (0..629).map(toward).find(|p| off(blocks, *p) < 1e-3);
            contacts.extend(touched.map(|point| Contact {
                point,
                from: at,
                sensor: Some(0),
                kind: ContactKind::Range,
                time: f64::from(k),
            }));
        }
        (contacts, wall)
    }

    /// The same with switches that reach 6 mm too far and too little by turns.
    fn worn(mut contacts: Vec<Contact>) -> Vec<Contact> {
        for (k, contact) in contacts.iter_mut().enumerate() {
            let outward = (contact.from - contact.point).normalize();
            contact.point += outward * (if k % 2 == 0 { 0.006 } else { -0.006 });
        }
        contacts
    }

    #[test]
    fn legs_between_which_beams_looked_and_met_nothing_are_two() {
        let (contacts, wall) = gone_round(&LEGS);
        let parts = divided(&contacts, wall.strokes(), &Chassis::default()).expect("two legs");
        assert_eq!(parts.len(), 2);
        for part in &parts {
            let left = part[0].point.x < 0.0;
            assert!(part.len() > 10 && part.iter().all(|c| (c.point.x < 0.0) == left), "{part:?}");
        }
        let worn: Vec<Vec<Contact>> = parts.into_iter().map(worn).collect();
        assert!(!are_one(&worn, wall.strokes(), &Chassis::default()));
    }

    #[test]
    fn legs_that_were_gone_round_as_part_of_a_room_are_two_as_well() {
        let (contacts, wall) = gone_round(&LEGS);
        // By its outline it is one thing, round everything.
        let ((x0, y0), (x1, y1)) = (LEGS[0].0, LEGS[1].1);
        let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)];
        let island = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        let chassis = Chassis::default();
        let rings = told_apart(island.clone(), &contacts, wall.strokes(), &chassis);
        let [one, other] = &rings[..] else { panic!("two legs: {rings:?}") };
        for (leg, (low, high)) in [one, other].into_iter().zip(LEGS) {
            let middle = nalgebra::center(&Point::new(low.0, low.1), &Point::new(high.0, high.1));
            assert!((leg.middle() - middle).norm() < 0.01, "{leg:?}");
        }
        // Had nobody kept the way, nothing would be known of what is between them.
        assert_eq!(told_apart(island.clone(), &contacts, &[], &chassis), [island]);
    }

    #[test]
    fn legs_with_a_board_between_them_are_one() {
        let (contacts, wall) = gone_round(&[LEGS[0], LEGS[1], BOARD_BETWEEN]);
        assert_eq!(divided(&contacts, wall.strokes(), &Chassis::default()), None);
        let contacts = worn(contacts);
        let (left, right) = contacts.iter().partition(|contact| contact.point.x < 0.0);
        assert!(are_one(&[left, right], wall.strokes(), &Chassis::default()));
    }

    #[test]
    fn legs_between_which_the_body_would_not_come_are_one() {
        let near = [((-0.08, -0.02), (-0.04, 0.02)), ((0.04, -0.02), (0.08, 0.02))];
        let (contacts, wall) = gone_round(&near);
        let chassis = Chassis::default();
        let seen_apart = Unswept::beside(&contacts, wall.strokes(), &chassis)
            .map(|unswept| unswept.pieces(&contacts, THIN).into_iter().flatten().collect())
            .is_some_and(|pieces: BTreeSet<usize>| pieces.len() > 1);
        assert!(seen_apart, "beams looked through");
        assert_eq!(divided(&contacts, wall.strokes(), &chassis), None);
    }

    #[test]
    fn what_was_seen_from_one_side_alone_is_not_divided() {
        let (contacts, wall) = gone_round(&LEGS);
        let outer: Vec<Contact> =
            contacts.into_iter().filter(|contact| contact.from.x.abs() > 0.13).collect();
        assert_eq!(divided(&outer, wall.strokes(), &Chassis::default()), None);
    }

    #[test]
    fn what_the_robot_drove_between_is_two_though_one_was_seen_from_one_side_alone() {
        let blocks = [((-0.26, -0.025), (-0.16, 0.025)), ((0.16, -0.025), (0.26, 0.025))];
        let (mut contacts, wall) = gone_round(&blocks);
        contacts.retain(|contact| contact.from.x < 0.22);
        let chassis = Chassis::default();
        assert_eq!(divided(&contacts, wall.strokes(), &chassis), None, "it may be anything");
        let mut between = Wall::new(&chassis);
        for y in [0.4, -0.4] {
            between.carve(Pose::new(0.0, y, -angle::PI / 2.0), SwitchSet::EMPTY, 0.0, 0);
        }
        let way = [wall.strokes(), between.strokes()].concat();
        let parts = divided(&contacts, &way, &chassis).expect("two legs");
        assert_eq!(parts.len(), 2);
        // It came half of its body between them, and went back.
        let mut into = Wall::new(&chassis);
        for y in [0.4, 0.075] {
            into.carve(Pose::new(0.0, y, -angle::PI / 2.0), SwitchSet::EMPTY, 0.0, 0);
        }
        let way = [wall.strokes(), into.strokes()].concat();
        assert_eq!(divided(&contacts, &way, &chassis), Some(parts));
    }

    #[test]
    fn contacts_of_worn_switches_divide_nothing() {
        let (contacts, wall) = gone_round(&LEGS);
        let contacts = worn(contacts);
        assert_eq!(divided(&contacts, wall.strokes(), &Chassis::default()), None);
    }

    #[test]
    fn nothing_is_made_of_no_contacts() {
        assert_eq!(divided(&[], &[], &Chassis::default()), None);
        assert!(!are_one(&[vec![], vec![]], &[], &Chassis::default()));
    }
}
