//! Pockets: gaps too narrow to pass into which the robot squeezed all the same. Takes contacts in time
//! order and leaves out what was seen in there; knows nothing of their order along the wall, nor of
//! lines and arcs.

use crate::mapping::map::Contact;
use crate::robot::Chassis;

/// A wall on the robot's hand is seen to this much more than its reach, metres.
const SLACK: f64 = 0.02;
/// A visit to a pocket ends as near as this to where it began, metres, ...
const MOUTH: f64 = 0.06;
/// ... after so much of the way at least, and at most, metres: behind a long one there is a room.
const SHORTEST_VISIT: f64 = 0.25;
const LONGEST_VISIT: f64 = 2.5;

/// Without what was seen in pockets: where the robot squeezed into a gap too narrow to pass (a strait), went
/// to and fro in it and came out again, the way through all it saw there would be a tangle. What is left
/// is the two sides of the mouth. `reach` is body radius plus range of the switches, metres.
pub(super) fn without_pockets(contacts: &[Contact], reach: f64) -> Vec<Contact> {
    let narrow: Vec<bool> = (0..contacts.len()).map(|k| is_narrow(contacts, k, reach)).collect();
    let mut travelled = 0.0;
    let way: Vec<f64> = (0..contacts.len())
        .map(|k| {
            travelled += (contacts[k].from - contacts[k.saturating_sub(1)].from).norm();
            travelled
        })
        .collect();
    let mut kept = Vec::with_capacity(contacts.len());
    let mut k = 0;
    while k < contacts.len() {
        kept.push(contacts[k]);
        let out = || {
            let back =
                |n: &usize| narrow[*n] && (contacts[*n].from - contacts[k].from).norm() < MOUTH;
            let last = (k + 1..contacts.len()).take_while(|n| way[*n] - way[k] < LONGEST_VISIT);
            last.filter(back).last().filter(|n| way[*n] - way[k] > SHORTEST_VISIT)
        };
        k = if narrow[k] { out().unwrap_or(k + 1) } else { k + 1 };
    }
    kept
}

/// Whether the robot, where it saw contact `index`, had wall on both hands, too near to each other for
/// the map to go on between.
fn is_narrow(contacts: &[Contact], index: usize, reach: f64) -> bool {
    let seen = contacts[index];
    let here = seen.point - seen.from;
    // Every contact is compared with every other one: most are far away, which is told without a root.
    let near = (reach + SLACK).powi(2);
    contacts.iter().any(|other| {
        let there = other.point - seen.from;
        there.norm_squared() < near
            && (other.point - seen.point).norm() < 2.0 * reach - Chassis::STRAIT_MARGIN
            && here.dot(&there) < -0.5 * here.norm() * there.norm()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::mapping::map::ContactKind;

    const REACH: f64 = 0.16;

    fn seen(from: (f64, f64), point: (f64, f64)) -> Contact {
        Contact {
            point: Point::new(point.0, point.1),
            from: Point::new(from.0, from.1),
            sensor: Some(2),
            kind: ContactKind::Range,
            time: 0.0,
        }
    }

    /// Along the wall y = 0 towards a gap at x = 2 that is `gap` wide, 0.6 m up into it, to and fro,
    /// out again and on along the wall.
    fn visit(gap: f64) -> Vec<Contact> {
        let steps =
            |from: f64, to: f64| (0..12).map(move |k| from + (to - from) * f64::from(k) / 12.0);
        let (left, right, middle) = (2.0, 2.0 + gap, 2.0 + gap / 2.0);
        let mut contacts: Vec<Contact> =
            steps(0.0, 2.0).map(|x| seen((x, -0.145), (x, 0.0))).collect();
        contacts.extend(steps(0.05, 0.6).map(|y| seen((middle, y), (left, y))));
        for _ in 0..3 {
            contacts.extend(steps(0.6, 0.3).map(|y| seen((middle, y), (right, y))));
            contacts.extend(steps(0.3, 0.6).map(|y| seen((middle, y), (left, y))));
        }
        contacts.extend(steps(0.6, 0.05).map(|y| seen((middle, y), (right, y))));
        contacts.extend(steps(right, 4.0).map(|x| seen((x, -0.145), (x, 0.0))));
        contacts
    }

    #[test]
    fn what_was_seen_in_a_pocket_too_narrow_to_pass_is_left_out() {
        let all = visit(0.29);
        let kept = without_pockets(&all, REACH);
        let deep = kept.iter().filter(|c| c.point.y > 0.2).count();
        assert!(deep < 6, "{deep} of {} are left", kept.len());
        assert_eq!(
            kept.iter().filter(|c| c.point.y == 0.0).count(),
            24,
            "the wall beside it stays"
        );
    }

    #[test]
    fn what_was_seen_in_a_gap_that_can_be_passed_stays() {
        for gap in [0.31, 0.36] {
            let all = visit(gap);
            assert_eq!(without_pockets(&all, REACH).len(), all.len(), "{gap} m");
        }
    }

    #[test]
    fn a_room_with_a_pocket_has_an_outline_that_leaves_it_out() {
        let wall = |from: (f64, f64), to: (f64, f64), off: (f64, f64)| {
            (0..12).map(move |k| {
                let at = |a: f64, b: f64| a + (b - a) * f64::from(k) / 12.0;
                let (x, y) = (at(from.0, to.0), at(from.1, to.1));
                seen((x + off.0, y + off.1), (x, y))
            })
        };
        // A room of 4 x 0.7 m beyond the wall with the gap: much of what is seen is seen in the pocket.
        let mut contacts = visit(0.29);
        contacts.extend(wall((4.0, 0.0), (4.0, -0.7), (-0.145, 0.0)));
        contacts.extend(wall((4.0, -0.7), (0.0, -0.7), (0.0, 0.145)));
        contacts.extend(wall((0.0, -0.7), (0.0, 0.0), (0.145, 0.0)));
        // Its floor on the left hand.
        for contact in &mut contacts {
            contact.point.y = -contact.point.y;
            contact.from.y = -contact.from.y;
        }
        let outline = crate::mapping::shape::AlongWall::of(&contacts, REACH)
            .outline(0.0, crate::mapping::shape::Loops::Touched)
            .expect("a room");
        assert!((outline.area() - 2.8).abs() < 0.1, "{}", outline.area());
        assert!(!outline.contains(Point::new(2.145, -0.4)), "the pocket is no part of it");
    }
}
