//! Touches of the bumper that lie nowhere. It says that the rim met something and not where; that is guessed, and the
//! guess moved where a beam or the body goes through it (`wall`). Once what the robot met was seen from other
//! places, a guess that nothing else lies near is known to be wrong. Knows contacts and the body's size.

use crate::mapping::map::{Contact, ContactKind};
use crate::robot::Chassis;

/// What the rim met is seen this near to it, metres: it gives a little, and both err.
const AT_RIM: f64 = 0.03;
/// Nearer to a touch than this another contact is of what was touched, metres.
const BACKED: f64 = 0.05;
/// Made nearer to each other than this, metres, two touches may be one guess made twice.
const ELSEWHERE: f64 = 0.03;

/// `contacts` without the touches that were of something else than lies there: nothing else was made near them from
/// another place, and what was seen lies at the rim of the body where it was touched.
pub(super) fn without_strays(contacts: &[Contact], chassis: &Chassis) -> Vec<Contact> {
    let is_guess = |c: &Contact| c.kind == ContactKind::Touch && c.sensor.is_none();
    let is_stray = |touch: &Contact| {
        let is_backed = |other: &Contact| {
            let elsewhere = !is_guess(other) || (other.from - touch.from).norm() > ELSEWHERE;
            elsewhere && (other.point - touch.point).norm() < BACKED
        };
        let was_met = |other: &Contact| {
            let off = (other.point - touch.from).norm() - chassis.radius;
            other.kind == ContactKind::Range && off.abs() < AT_RIM
        };
        let others = || contacts.iter().filter(|other| *other != touch);
        is_guess(touch) && others().any(was_met) && !others().any(is_backed)
    };
    contacts.iter().filter(|contact| !is_stray(contact)).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::super::things;
    use super::*;
    use crate::geometry::{Point, angle};

    /// A leg of 2 cm at the origin, seen all round.
    fn leg() -> Vec<Contact> {
        let contact = |k: i32| {
            let towards = angle::unit(angle::TAU * f64::from(k) / 24.0);
            let (point, from) = (Point::from(towards * 0.02), Point::from(towards * 0.165));
            Contact { point, from, sensor: Some(2), kind: ContactKind::Range, time: f64::from(k) }
        };
        (0..24).map(contact).collect()
    }

    /// The body touches it where it stands 0.12 m to the right of the middle, and guesses `bearing` from there.
    fn touch(bearing: f64) -> Contact {
        let from = Point::new(0.12, 0.0);
        let point = from + angle::unit(bearing) * Chassis::default().radius;
        Contact { point, from, sensor: None, kind: ContactKind::Touch, time: 0.5 }
    }

    #[test]
    fn a_touch_that_was_guessed_on_the_wrong_side_is_no_part_of_a_leg() {
        let chassis = Chassis::default();
        let with = |bearing: f64| [vec![touch(bearing)], leg()].concat();
        let wrong = without_strays(&with(1.8), &chassis);
        assert_eq!(wrong, leg());
        let right = with(angle::PI);
        assert_eq!(without_strays(&right, &chassis), right);
        let [thing] = &things(&with(1.8), &[], &chassis)[..] else { panic!("one leg") };
        assert!(thing.outline.middle().coords.norm() < 0.003, "{:?}", thing.outline);
    }

    #[test]
    fn a_touch_that_nothing_else_explains_stays() {
        let chassis = Chassis::default();
        // Too far from the leg to be of that.
        let away = Point::new(0.3, 0.0);
        let far =
            Contact { from: away, point: away + angle::unit(1.0) * chassis.radius, ..touch(0.0) };
        let all = [leg(), vec![far]].concat();
        assert_eq!(without_strays(&all, &chassis), all);
        // Another one, made from elsewhere, lies there too.
        let two = touch(1.8);
        let other = Contact { from: two.from + angle::unit(1.8) * 0.2, point: two.point, ..two };
        let all = [leg(), vec![two, other]].concat();
        assert_eq!(without_strays(&all, &chassis), all);
    }
}
