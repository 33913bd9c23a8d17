//! Rounds: what a lap went round more than once. Before a gap as wide as the body, what the follower sees
//! decides whether it goes through or over to the other side, and it may be led round an island until it goes
//! over; and a lap that did not close where it could goes round the whole room again. Takes contacts in time
//! order and keeps one round; knows nothing of their order along the wall, nor of lines and arcs.

use crate::geometry::{Piece, Point, Ring, Segment, angle, cross};
use crate::mapping::map::Contact;

/// A round leads as near as this past the place where it began, metres, ...
const SAME_PLACE: f64 = 0.05;
/// ... with what is seen there in the same direction, radians, ...
const SAME_SIDE: f64 = 0.5;
/// ... and the robot's way encloses at least this share of what it would round a thing without extent, ...
const LEAST: f64 = 0.8;
/// ... or so much of the floor within a room, square metres: of a nook it leaves little to go round.
const WITHIN: f64 = 0.02;
/// A room is gone round again when the lap without that round encloses at least this share of it, ...
const AS_MUCH: f64 = 0.7;
/// ... and leads as near as this, metres, past at least this share of the places on the round. Past those of another
/// room of the same size, behind a gap, it does not.
const BESIDE: f64 = 0.2;
const SEEN_AGAIN: f64 = 0.7;
/// Rounds at most: the follower goes on after that, or the lap has failed.
const MOST: usize = 8;

/// Without all rounds but one of each thing that the lap went round again: without what was driven between
/// two looks at the same wall from the same place, turning the other way than the lap as a whole does, or
/// the same way while the rest encloses about as much again, in the same place.
/// `reach` is body radius plus range of the switches, metres.
pub(super) fn once_round(contacts: &[Contact], reach: f64) -> Vec<Contact> {
    let mut kept = contacts.to_vec();
    for _ in 0..MOST {
        let Some((first, last)) = again(&kept, reach) else { break };
        kept.drain(first..last);
    }
    kept
}

/// The first contact of a round that the lap made again, and the first one after it: there the robot had
/// come past where the round began. Of several that lie within each other the shortest.
fn again(contacts: &[Contact], reach: f64) -> Option<(usize, usize)> {
    let origin = contacts.first()?.from;
    let at = |k: usize| contacts[k].from - origin;
    let mut swept = 0.0;
    // Twice what the way encloses up to each contact, seen from the first.
    let doubled: Vec<f64> = (0..contacts.len())
        .map(|k| {
            swept += cross(at(k.saturating_sub(1)), at(k));
            swept
        })
        .collect();
    let least = LEAST * angle::PI * reach * reach;
    let enclosed = |i: usize, k: usize| doubled[k] - doubled[i] + cross(at(k), at(i));
    // What was gone round lies within; before a gap nearly wide enough the wall is left and met at one place.
    let is_around = |i: usize, k: usize| {
        let way: Vec<Point> = contacts[i..k].iter().map(|contact| contact.from).collect();
        Ring::polygon(&way).contains(contacts[i].point)
    };
    let is_beside = |i: usize, k: usize| {
        let legs = |part: &[Contact]| -> Vec<Segment> {
            part.windows(2).map(|two| Segment::new(two[0].from, two[1].from)).collect()
        };
        let rest = [legs(&contacts[..=i]), legs(&contacts[k..])].concat();
        let near =
            |c: &&Contact| rest.iter().any(|leg| leg.distance_squared(c.from) < BESIDE * BESIDE);
        let seen = contacts[i..k].iter().filter(near).count();
        seen as f64 >= SEEN_AGAIN * (k - i) as f64
    };
    let is_round = |i: usize, k: usize| {
        let (round, whole) = (enclosed(i, k), enclosed(0, contacts.len() - 1));
        if whole / round < 0.0 {
            round.abs() > 2.0 * least && is_around(i, k)
        } else {
            round.abs() > 2.0 * WITHIN && whole / round - 1.0 > AS_MUCH && is_beside(i, k)
        }
    };
    let is_near =
        |i: usize, k: usize, reached: f64| (at(k) - at(i)).norm_squared() < reached * reached;
    let is_past = |i: usize, k: usize| {
        let step = Piece::with_bulge(contacts[k - 1].from, contacts[k].from, 0.0);
        step.distance(contacts[i].from) < SAME_PLACE
    };
    let bearings: Vec<f64> = contacts.iter().map(|c| angle::of(c.point - c.from)).collect();
    let is_alike = |i: usize, k: usize| angle::wrap(bearings[i] - bearings[k]).abs() < SAME_SIDE;
    // From left to right, so that only those about as far to the right as a contact are compared with it.
    let mut abreast: Vec<usize> = (0..contacts.len()).collect();
    abreast.sort_by(|&i, &k| at(i).x.total_cmp(&at(k).x));
    let mut back: Vec<(usize, usize)> = Vec::new();
    for k in 1..contacts.len() {
        let reached = SAME_PLACE + (at(k) - at(k - 1)).norm();
        let first = abreast.partition_point(|&i| at(i).x < at(k).x - reached);
        let others = abreast[first..].iter().take_while(|&&i| at(i).x <= at(k).x + reached);
        let past =
            others.filter(|&&i| i < k && is_near(i, k, reached) && is_alike(i, k) && is_past(i, k));
        back.extend(past.map(|&i| (i, k)));
    }
    // What is a round takes long to tell: the shortest are asked first.
    back.sort_unstable_by_key(|&(i, k)| (k - i, i));
    back.into_iter().find(|&(i, k)| is_round(i, k))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{REACH, along};
    use super::*;

    /// A lap of a room along whose lower wall a box stands, that went round the box so often.
    fn lap(rounds: usize) -> Vec<Contact> {
        let around = [(2.0, 0.25), (1.7, 0.55), (2.0, 0.85), (2.3, 0.55), (2.0, 0.25)];
        let mut contacts = along(&[(0.0, 0.0), (2.0, 0.0)], 1.0);
        for _ in 0..rounds {
            contacts.extend(along(&around, 1.0));
        }
        contacts.extend(along(&[(2.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (0.0, 0.0)], 1.0));
        contacts
    }

    #[test]
    fn of_what_was_gone_round_again_one_round_is_kept() {
        for rounds in [2, 3] {
            let (once, kept) = (lap(1), once_round(&lap(rounds), REACH));
            assert_eq!(kept.len(), once.len(), "{rounds} rounds");
            let is_seen = |c: &Contact| kept.iter().any(|k| (k.point - c.point).norm() < 0.01);
            assert!(once.iter().all(is_seen), "{rounds} rounds");
        }
    }

    #[test]
    fn of_a_room_that_was_gone_round_again_one_round_is_kept() {
        let mut contacts = lap(0);
        contacts.extend(lap(0));
        contacts.extend(along(&[(0.0, 0.0), (0.5, 0.0)], 1.0));
        let (kept, once) = (once_round(&contacts, REACH).len(), lap(0).len());
        assert!(kept.abs_diff(once) < 20, "{kept} of {once}");
    }

    #[test]
    fn of_a_nook_that_was_gone_round_again_one_round_is_kept() {
        // The way in it encloses 0.06 square metres.
        let lap = |rounds: usize| {
            let mut contacts = along(&[(0.0, 0.0), (2.0, 0.0)], 1.0);
            for _ in 0..rounds {
                contacts.extend(along(&[(2.0, 0.0), (2.0, -0.6), (2.45, -0.6), (2.45, 0.0)], 1.0));
            }
            contacts
                .extend(along(&[(2.45, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (0.0, 0.0)], 1.0));
            contacts
        };
        let (kept, once) = (once_round(&lap(2), REACH).len(), lap(1).len());
        assert!(kept.abs_diff(once) < 3, "{kept} of {once}");
        assert_eq!(once_round(&lap(1), REACH).len(), lap(1).len());
    }

    #[test]
    fn a_second_room_as_large_as_the_first_is_no_round_of_it() {
        // Between the two is a gap in which the robot sees the same corner from the same place on its way in and
        // on its way out.
        let corner =
            Contact { from: Point::new(1.98, 1.0), ..along(&[(1.95, 0.9), (1.95, 0.95)], 1.0)[0] };
        let mut lap = along(&[(0.0, 0.0), (1.95, 0.0), (1.95, 0.9)], 1.0);
        lap.push(corner);
        lap.extend(along(
            &[(2.0, 0.9), (2.0, 0.0), (4.0, 0.0), (4.0, 2.0), (2.0, 2.0), (2.0, 1.15)],
            1.0,
        ));
        lap.push(corner);
        lap.extend(along(&[(1.95, 1.15), (1.95, 2.0), (0.0, 2.0), (0.0, 0.0)], 1.0));
        assert_eq!(once_round(&lap, REACH).len(), lap.len());
    }

    #[test]
    fn a_lap_that_goes_round_nothing_again_stays_whole() {
        for mut contacts in [lap(0), lap(1)] {
            // Its beginning is seen again at its end.
            contacts.extend(along(&[(0.0, 0.0), (0.5, 0.0)], 1.0));
            assert_eq!(once_round(&contacts, REACH).len(), contacts.len());
        }
        // A thing is gone round from outside, and past where that began.
        let around = [(0.0, 0.0), (0.0, 0.6), (0.6, 0.6), (0.6, 0.0), (0.0, 0.0), (0.0, 0.6)];
        let contacts = along(&around, 1.0);
        assert_eq!(once_round(&contacts, REACH).len(), contacts.len());
    }
}
