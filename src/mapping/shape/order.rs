//! Puts contacts into their order along the wall. Time order is nearly right: swings look ahead
//! and behind, and at an inner corner the front switch meets the next wall before the side switch
//! has left this one. The order wanted is the shortest way through all of them, near to the order
//! in time. Knows nothing of lines and arcs.

use super::pocket::without_pockets;
use super::round::once_round;
use crate::geometry::{Point, Vector, cross};
use crate::mapping::map::{Contact, ContactKind};
use std::ops::Range;

/// How far a contact may be moved in the order, in places: at once, or first not far. What a swing of the robot
/// saw in no order finds its place near by then, and not on the other face of a thin wall.
const WINDOWS: [&[usize]; 2] = [&[64], &[12, 64]];
/// How long a stretch may be reversed, in places.
const REVERSED: usize = 24;
/// Longest stretch that is moved as one.
const CHAIN: usize = 4;
/// What turning to see the surface from the opposite side counts as, metres: keeps the two faces
/// of a thin wall apart.
const SIDE: f64 = 0.4;
/// How much wall at most is seen twice at the end of a lap, metres of travel.
const OVERLAP: f64 = 1.6;
/// Places nearer to each other than this are one: the robot comes to rest there and turns, metres.
const SAME_STAND: f64 = 0.05;
/// Two walls face each other's way by less than this where they make a corner (cosine).
const CORNERED: f64 = 0.5;
/// A contact is no second look at another when the places and the places they were seen from are farther
/// apart than this together, metres: a wall is looked at every half metre.
const SAME_LOOK: f64 = 1.0;

/// Contacts in order along the wall, floor on the left of the way; the last adjoins the first.
/// Edge contacts are put where they fit best between the others; `reach` is body radius plus range of
/// the switches, metres.
pub(super) fn along_wall(contacts: &[Contact], reach: f64) -> Vec<Contact> {
    let usable = contacts.iter().filter(|c| is_finite(c));
    let (edges, mut surface): (Vec<Contact>, Vec<Contact>) =
        usable.copied().partition(|c| c.kind == ContactKind::Edge);
    end_lap(&mut surface);
    let mut surface = once_round(&without_pockets(&surface, reach), reach);
    shorten(&mut surface);
    let half = surface.len() / 2;
    surface.rotate_left(half);
    shorten(&mut surface);
    if !floor_on_left(&surface) {
        surface.reverse();
    }
    insert_edges(&mut surface, &edges);
    surface
}

/// The same of a way that does not come back to where it began: its first and last contact stay its ends.
/// Edge contacts are left out.
pub(super) fn along_open(contacts: &[Contact]) -> Vec<Contact> {
    let mut surface: Vec<Contact> =
        contacts.iter().filter(|c| c.kind != ContactKind::Edge && is_finite(c)).copied().collect();
    shorten(&mut surface);
    if !floor_on_left(&surface) {
        surface.reverse();
    }
    surface
}

fn is_finite(contact: &Contact) -> bool {
    let finite = |p: Point| p.coords.iter().all(|v| v.is_finite());
    finite(contact.point) && finite(contact.from)
}

/// How many contacts belong to the first time round: where the tail comes nearest to the first
/// contact, seen from the same place and the same side, the lap is over.
fn end_of_lap(contacts: &[Contact]) -> usize {
    let count = contacts.len();
    let Some(first) = contacts.first() else {
        return 0;
    };
    let off = |c: &Contact| (c.point - first.point).norm() + (c.from - first.from).norm();
    // The other face of a thin wall may be nearer than the next contact of this one.
    let faces = |c: &Contact| (c.from - c.point).dot(&(first.from - first.point)) > 0.0;
    let mut travelled = 0.0;
    let mut best = (SAME_LOOK, count);
    for k in (count / 2 + 1..count).rev() {
        if k + 1 < count {
            travelled += (contacts[k + 1].from - contacts[k].from).norm();
        }
        if travelled > OVERLAP {
            break;
        }
        if faces(&contacts[k]) && off(&contacts[k]) < best.0 {
            best = (off(&contacts[k]), k + 1);
        }
    }
    best.1
}

/// Leaves out what was seen after the first time round; but where that ends in a corner, not the wall that leads there
/// and was met last, from about the place where the lap ended.
fn end_lap(contacts: &mut Vec<Contact>) {
    let end = end_of_lap(contacts);
    let Some(last) = end.checked_sub(1).map(|k| contacts[k]) else { return };
    let towards = |c: &Contact| (c.from - c.point).normalize();
    let is_there = |c: &&Contact| (c.from - last.from).norm() < SAME_STAND;
    let turns_there = |c: &&Contact| towards(c).dot(&towards(&last)) < CORNERED;
    let late: Vec<Contact> =
        contacts[end..].iter().take_while(is_there).filter(turns_there).copied().collect();
    contacts.truncate(end);
    contacts.extend(late);
}

/// Whether the floor, where the robot was, lies on the left of the way.
fn floor_on_left(contacts: &[Contact]) -> bool {
    let votes: f64 = contacts
        .windows(2)
        .map(|pair| {
            let step = pair[1].point - pair[0].point;
            cross(step, pair[0].from - pair[0].point) + cross(step, pair[1].from - pair[1].point)
        })
        .sum();
    votes >= 0.0
}

/// A contact lifted out of the plane by the side it was seen from.
#[derive(Clone, Copy)]
struct Lifted {
    point: Point,
    side: Vector,
    /// Which contact it is.
    number: usize,
}

impl Lifted {
    fn of((number, contact): (usize, &Contact)) -> Self {
        let side = (contact.from - contact.point).try_normalize(1e-9).unwrap_or_else(Vector::zeros);
        Self { point: contact.point, side: side * SIDE, number }
    }

    fn distance(&self, other: &Self) -> f64 {
        let planar = (self.point - other.point).norm_squared();
        // Bearings a quarter turn and more apart happen at one corner; far beyond, it is another
        // face.
        let opposite = (-self.side.dot(&other.side) - SIDE * SIDE / 2.0).max(0.0);
        (planar + opposite).sqrt()
    }

    /// Whether the two are surely as far apart as the root of `square`, or farther: in the plane alone, which is told
    /// without a root.
    fn is_beyond(&self, other: &Self, square: f64) -> bool {
        (self.point - other.point).norm_squared() >= square
    }
}

/// Shortens the way through the contacts by reversing and moving short stretches; the ends stay. No such way
/// is sure to be the shortest: of those that are found the shorter one counts.
fn shorten(contacts: &mut Vec<Contact>) {
    let lifted: Vec<Lifted> = contacts.iter().enumerate().map(Lifted::of).collect();
    let length =
        |way: &Vec<Lifted>| -> f64 { way.windows(2).map(|two| two[0].distance(&two[1])).sum() };
    let ways = WINDOWS.map(|windows| shortened(lifted.clone(), windows));
    if let Some(way) = ways.iter().min_by(|a, b| length(a).total_cmp(&length(b))) {
        *contacts = way.iter().map(|lifted| contacts[lifted.number]).collect();
    }
}

fn shortened(mut way: Vec<Lifted>, windows: &[usize]) -> Vec<Lifted> {
    for &window in windows {
        let mut changes = Changes::new(way.len());
        for _ in 0..8 {
            changes.round += 1;
            let reversed = reverse_stretches(&mut way, window, &mut changes);
            let moved = move_stretches(&mut way, window, &mut changes);
            if !reversed && !moved {
                break;
            }
        }
    }
    way
}

/// Where the order was changed lately: what could not be bettered in the round before is not looked at again where
/// nothing changed since.
struct Changes {
    round: usize,
    /// The round of the last change, for so many places together.
    last: Vec<usize>,
}

impl Changes {
    const TOGETHER: usize = 16;

    fn new(places: usize) -> Self {
        Self { round: 0, last: vec![0; places / Self::TOGETHER + 1] }
    }

    /// Whether anything among `places` was changed in the round before, or in this one.
    fn are_in(&self, places: Range<usize>) -> bool {
        let parts = places.start / Self::TOGETHER..=(places.end - 1) / Self::TOGETHER;
        self.last[parts].iter().any(|&round| round + 1 >= self.round)
    }

    fn note(&mut self, places: Range<usize>) {
        let parts = places.start / Self::TOGETHER..=(places.end - 1) / Self::TOGETHER;
        self.last[parts].fill(self.round);
    }
}

fn reverse_stretches(way: &mut [Lifted], window: usize, changes: &mut Changes) -> bool {
    let mut improved = false;
    for i in 0..way.len().saturating_sub(3) {
        let end = (i + REVERSED.min(window)).min(way.len() - 1);
        if !changes.are_in(i..end + 1) {
            continue;
        }
        let before = way[i].distance(&way[i + 1]);
        for k in i + 2..end {
            if way[i].is_beyond(&way[k], before * before) {
                continue;
            }
            let joined = way[i].distance(&way[k]);
            if joined >= before {
                continue;
            }
            let change =
                joined + way[i + 1].distance(&way[k + 1]) - before - way[k].distance(&way[k + 1]);
            if change < -1e-7 {
                way[i + 1..=k].reverse();
                changes.note(i + 1..k + 1);
                improved = true;
                break;
            }
        }
    }
    improved
}

fn move_stretches(way: &mut [Lifted], window: usize, changes: &mut Changes) -> bool {
    let mut improved = false;
    for length in 1..=CHAIN {
        for at in 1..way.len().saturating_sub(length + 1) {
            let (low, high) =
                (at.saturating_sub(window), (at + length + window).min(way.len() - 1));
            if changes.are_in(low..high + 1)
                && let Some(changed) = move_stretch(way, (at, length), (low, high))
            {
                changes.note(changed);
                improved = true;
            }
        }
    }
    improved
}

/// Moves the stretch of `length` contacts at `at` to the best place between `low` and `high`; the places whose
/// contacts changed.
fn move_stretch(
    way: &mut [Lifted],
    (at, length): (usize, usize),
    (low, high): (usize, usize),
) -> Option<Range<usize>> {
    let (before, after) = (way[at - 1], way[at + length]);
    let (head, tail) = (way[at], way[at + length - 1]);
    let gain = before.distance(&head) + tail.distance(&after) - before.distance(&after);
    if gain < 1e-7 {
        return None;
    }
    let mut best = (gain - 1e-7, None);
    for places in [low..(at - 1).max(low), at + length..high] {
        for (k, two) in places.clone().zip(way[places.start..=places.end].windows(2)) {
            let (left, right) = (&two[0], &two[1]);
            let square = best.0 * best.0;
            if left.is_beyond(&head, square) && left.is_beyond(&tail, square) {
                continue;
            }
            let (to_head, to_tail) = (left.distance(&head), left.distance(&tail));
            if to_head >= best.0 && to_tail >= best.0 {
                continue;
            }
            let open = left.distance(right);
            let straight = to_head + tail.distance(right) - open;
            let turned = to_tail + head.distance(right) - open;
            if straight.min(turned) < best.0 {
                best = (straight.min(turned), Some((k, turned < straight)));
            }
        }
    }
    let (k, turned) = best.1?;
    if turned {
        way[at..at + length].reverse();
    }
    if k < at {
        way[k + 1..at + length].rotate_right(length);
        Some(k + 1..at + length)
    } else {
        way[at..=k].rotate_left(length);
        Some(at..k + 1)
    }
}

fn insert_edges(surface: &mut Vec<Contact>, edges: &[Contact]) {
    let count = surface.len();
    if count == 0 {
        return;
    }
    let mut lifted: Vec<Lifted> = surface.iter().enumerate().map(Lifted::of).collect();
    lifted.push(lifted[0]);
    let steps: Vec<f64> = lifted.windows(2).map(|two| two[0].distance(&two[1])).collect();
    let mut places: Vec<(usize, Contact)> = edges
        .iter()
        .map(|edge| {
            let here = Lifted::of((count, edge));
            let off: Vec<f64> = lifted.iter().map(|contact| contact.distance(&here)).collect();
            let detours = off.windows(2).zip(&steps).map(|(two, step)| two[0] + two[1] - step);
            let place = detours.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            (place.map_or(0, |(place, _)| place), *edge)
        })
        .collect();
    places.sort_by_key(|place| place.0);
    for (place, edge) in places.into_iter().rev() {
        surface.insert(place + 1, edge);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A contact of a level wall at (`x`, `y`), seen from above it (`side` 1) or below (-1).
    fn seen(x: f64, y: f64, side: f64) -> Contact {
        Contact {
            point: Point::new(x, y),
            from: Point::new(x, y + side * 0.145),
            sensor: Some(2),
            kind: ContactKind::Range,
            time: 0.0,
        }
    }

    #[test]
    fn what_is_not_looked_at_again_could_not_be_bettered() {
        // Contacts of a long wall and back along the next one, out of order by chance.
        let mut seed: u32 = 5;
        let mut chance = |most: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 16) % most
        };
        for stray in [2, 9, 40] {
            let mut contacts: Vec<Contact> = (0..300)
                .map(|k| {
                    let along = f64::from(k) * 0.03;
                    let off = f64::from(chance(10)) * 0.002;
                    if k < 150 { seen(along, off, 1.0) } else { seen(9.0 - along, 0.4 + off, -1.0) }
                })
                .collect();
            for k in 0..contacts.len() {
                let other = (k + chance(stray) as usize).min(contacts.len() - 1);
                contacts.swap(k, other);
            }
            let lifted = contacts.iter().enumerate().map(Lifted::of).collect();
            let mut way = shortened(lifted, &[64]);
            let mut everywhere = Changes::new(way.len());
            let reversed = reverse_stretches(&mut way, 64, &mut everywhere);
            assert!(!reversed && !move_stretches(&mut way, 64, &mut everywhere), "{stray} places");
        }
    }

    #[test]
    fn the_lap_of_a_thin_wall_does_not_end_on_its_other_face() {
        // Round a board of 1 m by 20 mm, from the middle of its upper face clockwise; the contact next to
        // the first lies farther from it than the other face does.
        let along =
            |from: f64, to: f64| (0..4).map(move |k| from + (to - from) * f64::from(k) / 3.0);
        let mut round: Vec<Contact> = along(0.5, 1.0).map(|x| seen(x, 0.02, 1.0)).collect();
        round.extend(along(1.0, 0.0).map(|x| seen(x, 0.0, -1.0)));
        round.extend([0.0, 0.05, 0.1].map(|x| seen(x, 0.02, 1.0)));
        assert_eq!(end_of_lap(&round), round.len());
    }

    #[test]
    fn a_lap_that_ends_in_a_corner_ends_with_both_its_walls() {
        // Begun 0.2 m from the corner; back there the robot sees where it began, turns, and sees the wall that
        // leads there, and where it began again.
        let upright = |y: f64, from: (f64, f64)| Contact {
            point: Point::new(0.0, y),
            from: Point::new(from.0, from.1),
            ..seen(0.0, 0.0, 1.0)
        };
        let mut round: Vec<Contact> =
            (0..20).map(|k| seen(0.2 + f64::from(k) * 0.2, 0.0, 1.0)).collect();
        round.extend((0..20).map(|k| {
            let y = 4.0 - f64::from(k) * 0.18;
            upright(y, (0.145, y))
        }));
        round.push(seen(0.2, 0.0, 1.0));
        let mut whole = round.clone();
        let corner = [0.2, 0.05].map(|y| upright(y, (0.2, 0.15)));
        whole.extend(corner);
        round.push(corner[0]);
        round.push(seen(0.22, 0.0, 1.0));
        round.push(corner[1]);
        round.extend([0.5, 0.8].map(|x| seen(x, 0.0, 1.0)));
        end_lap(&mut round);
        assert_eq!(round, whole);
    }

    #[test]
    fn a_lap_that_ends_before_the_first_contact_is_seen_again_is_whole() {
        // Along the lower face of a board from its tip, and back along the upper one to the tip; on the way a
        // wall beyond is seen that faces as the first contact does.
        let along =
            |from: f64, to: f64| (0..8).map(move |k| from + (to - from) * f64::from(k) / 7.0);
        let mut round: Vec<Contact> = along(0.02, 1.5).map(|x| seen(x, 0.0, -1.0)).collect();
        round.extend(along(1.5, 0.9).map(|x| seen(x, 0.02, 1.0)));
        round.push(seen(0.9, 0.31, -1.0));
        round.extend(along(0.9, 0.02).map(|x| seen(x, 0.02, 1.0)));
        assert_eq!(end_of_lap(&round), round.len());
    }
}
