//! Spurs: what was seen across a passage on the other hand than the wall that is followed. In the order along the
//! wall it comes between two contacts of this side, and the outline would run across the passage to it and back,
//! over floor that the robot drove on. Such a spur is left out of the order where it comes back to where it left;
//! where contacts in that order make no sound outline, what is longer is looked for. Knows nothing of lines and arcs.

use super::island::{ALL_AROUND, is_gone_round};
use super::order;
use crate::geometry::segment::Segment;
use crate::mapping::map::{Contact, ContactKind};

/// A spur has no more than this share of all contacts, or was gone round: a part of the room with more is none.
const LARGEST: f64 = 0.1;

/// Contacts `ordered` along the wall without spurs that come back, nearer than `reach` metres (body radius plus range
/// of the switches), to where they left this side; `way` is where the robot drove. The mouths of two passages are
/// crossed as well, but then what lies between them is of this side, and farther from end to end.
pub(super) fn on_this_side(ordered: &[Contact], way: &[Segment], reach: f64) -> Vec<Contact> {
    let surface: Vec<usize> =
        (0..ordered.len()).filter(|&k| ordered[k].kind != ContactKind::Edge).collect();
    let driven_over = |pair: &&[usize]| {
        let side = Segment::new(ordered[pair[0]].point, ordered[pair[1]].point);
        side.along.norm() > reach && way.iter().any(|leg| side.crosses(leg))
    };
    // From the last contact of this side before the passage to the first one behind it.
    let crossed: Vec<&[usize]> = surface.windows(2).filter(driven_over).collect();
    let spurs: Vec<(usize, usize)> = crossed
        .windows(2)
        .map(|two| (two[0][0], two[1][1]))
        .filter(|&(left, back)| (ordered[back].point - ordered[left].point).norm() < reach)
        .collect();
    let is_of_one = |k: usize| spurs.iter().any(|&(left, back)| left < k && k < back);
    let number = |(k, contact)| (!is_of_one(k)).then_some(contact);
    ordered.iter().copied().enumerate().filter_map(number).collect()
}

/// The `contacts` that are of no spur, and those of spurs, of a robot whose switches reach `reach` metres from its
/// centre; none when there is no spur.
#[must_use]
pub fn without_spurs(contacts: &[Contact], reach: f64) -> Option<(Vec<Contact>, Vec<Contact>)> {
    let surface = |c: &&Contact| c.kind != ContactKind::Edge;
    let ordered: Vec<Contact> =
        order::along_wall(contacts, reach).iter().filter(surface).copied().collect();
    let count = ordered.len();
    let way: Vec<Segment> = super::legs(contacts).collect();
    let driven_over = |k: &usize| {
        let side = Segment::new(ordered[*k].point, ordered[(k + 1) % count].point);
        way.iter().any(|leg| side.crosses(leg))
    };
    let crossed: Vec<usize> = (0..count).filter(driven_over).collect();
    let runs = crossed.iter().enumerate().map(|(n, &before)| {
        let next = crossed[(n + 1) % crossed.len()];
        // From behind one crossed side to before the next, round the end of the list.
        let length = (next + count - before - 1) % count + 1;
        (before + 1..=before + length).map(|k| ordered[k % count]).collect::<Vec<Contact>>()
    });
    let most = (LARGEST * count as f64) as usize;
    let is_spur = |run: &Vec<Contact>| {
        run.len() <= most || (2 * run.len() < count && is_gone_round(run.iter(), ALL_AROUND))
    };
    let spurs: Vec<Contact> = runs.filter(is_spur).flatten().collect();
    let (apart, kept): (Vec<Contact>, Vec<Contact>) =
        contacts.iter().partition(|contact| spurs.contains(contact));
    (!apart.is_empty()).then_some((kept, apart))
}

#[cfg(test)]
mod tests {
    use super::super::testing::along;
    use super::*;
    use crate::geometry::{Point, Vector};
    use crate::mapping::shape::{AlongWall, Loops};

    /// Along the walls of a room of 4 x 3 m, in which a thing stands 0.3 m off the lower wall at x = 2; seen from
    /// the passage between them where that is `seen`.
    fn room(seen: bool) -> Vec<Contact> {
        let corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (0.0, 0.0)];
        let mut contacts = along(&corners, 1.0);
        let at = contacts.iter().position(|c| c.point.x > 2.0).expect("a wall");
        let across = Contact { point: Point::new(2.0, 0.3), ..contacts[at] };
        let beside = Contact { point: Point::new(2.02, 0.3), ..contacts[at] };
        if seen {
            contacts.splice(at..at, [across, beside]);
        }
        contacts
    }

    #[test]
    fn what_was_seen_across_a_passage_is_left_out() {
        let contacts = room(true);
        let (kept, across) = without_spurs(&contacts, 0.16).expect("a spur");
        assert_eq!((kept.len() + 2, across.len()), (contacts.len(), 2));
        assert!(kept.iter().all(|c| c.point.y != 0.3));
        let outline = AlongWall::of(&kept, 0.16).outline(0.0, Loops::Touched).expect("a room");
        assert!((outline.area() - 12.0).abs() < 0.05, "{}", outline.area());
    }

    #[test]
    fn a_spur_that_comes_back_is_left_out_of_the_order_and_the_wall_between_two_mouths_is_not() {
        let p = Point::new;
        let seen = |&point: &Point| Contact {
            point,
            from: point + Vector::new(0.0, 0.15),
            sensor: None,
            kind: ContactKind::Range,
            time: 0.0,
        };
        let order = |points: &[Point], way: &[Point]| {
            let way: Vec<Segment> =
                way.windows(2).map(|two| Segment::new(two[0], two[1])).collect();
            let contacts: Vec<Contact> = points.iter().map(seen).collect();
            let kept = on_this_side(&contacts, &way, 0.16);
            kept.iter().map(|contact| contact.point).collect::<Vec<Point>>()
        };
        let wall = |from: u32, to: u32| (from..=to).map(|k| p(f64::from(k) * 0.05, 0.0));
        let sound: Vec<Point> = wall(0, 60).collect();
        let across = [p(1.5, 0.3), p(1.52, 0.3)];
        let spur: Vec<Point> = wall(0, 30).chain(across).chain(wall(31, 60)).collect();
        assert_eq!(order(&spur, &[p(0.0, 0.15), p(3.0, 0.15)]), sound);
        assert_eq!(order(&spur, &[p(0.0, 0.4), p(3.0, 0.4)]), spur, "a thing at the wall");
        // In by the one and out by the other.
        let mouths: Vec<Point> = wall(0, 20).chain(wall(25, 33)).chain(wall(38, 60)).collect();
        let behind = [p(1.1, 0.2), p(1.1, -0.2), p(1.8, -0.2), p(1.8, 0.2)];
        assert_eq!(order(&mouths, &behind), mouths);
    }

    #[test]
    fn a_room_without_a_passage_has_no_spur() {
        assert_eq!(without_spurs(&room(false), 0.16), None);
        assert_eq!(without_spurs(&[], 0.16), None);
    }
}
