//! What one closed lap says: the contacts of what it went round, and the things that these are.

use crate::geometry::angle;
use crate::mapping::adjust::Adjustment;
use crate::mapping::circuit::Closure;
use crate::mapping::follow::{self, Side};
use crate::mapping::map::{Contact, ObjectClass};
use crate::mapping::shape::{Thing, post, things};
use crate::mapping::wall::{Sighting, Stroke, Wall};
use crate::robot::Chassis;

/// The way round a post is no longer than this many times the circle about it.
const POST_ROUNDS: f64 = 1.3;

/// A crossing farther than this from where the lap began, metres, once both are adjusted, is not its end: ...
const CROSSED_ELSEWHERE: f64 = 0.15;
/// ... that is looked for so far beyond it, metres driven.
const BEYOND_CROSSING: f64 = 3.0;

/// `closure` with its end where the robot, adjusted, was back where the lap began. A crossing found by
/// odometry may lie before that, and what stands between would be missing.
#[must_use]
pub fn whole_lap(wall: &Wall, closure: &Closure, adjustment: &Adjustment) -> Closure {
    let (from, to) = (&closure.from, &closure.to);
    let begun = adjustment.pose(from.pose, from.time_us).position;
    let off = |pose, time_us| (adjustment.pose(pose, time_us).position - begun).norm();
    if off(to.pose, to.time_us) < CROSSED_ELSEWHERE {
        return *closure;
    }
    let beyond =
        |seen: &&Sighting| (0.0..BEYOND_CROSSING).contains(&(seen.travelled - to.travelled));
    let back =
        wall.log().iter().filter(beyond).min_by(|one, other| {
            off(one.pose, one.time_us).total_cmp(&off(other.pose, other.time_us))
        });
    back.map_or(*closure, |seen| closure.over_at(seen.travelled))
}

/// The contacts of one lap round something, and `adjustment` with them, after its own faces have put them right:
/// those that lay through each other apart, and those that are smooth straight.
pub fn straight_contacts(
    wall: &Wall,
    closure: &Closure,
    adjustment: &mut Adjustment,
    chassis: &Chassis,
) -> Vec<Contact> {
    let mut contacts = lap_contacts(wall, closure, adjustment);
    adjustment.part(&mut contacts, chassis.reach());
    let strokes = lap_strokes(wall, closure, adjustment);
    let seen = things(&contacts, &strokes, chassis);
    adjustment.straighten(&mut contacts, seen.iter().map(|thing| &thing.outline));
    adjustment.part(&mut contacts, chassis.reach());
    contacts
}

/// The things that one lap, adjusted, went round; `contacts` are those of [`lap_contacts`]. A post is
/// known by all that was seen of it rather than by contacts.
#[must_use]
pub fn lap_things(
    wall: &Wall,
    closure: &Closure,
    adjustment: &Adjustment,
    contacts: Vec<Contact>,
    chassis: &Chassis,
) -> Vec<Thing> {
    let around = 2.0 * angle::PI * (follow::clearance(chassis) + post::MOST_RADIUS);
    if closure.length() < POST_ROUNDS * around {
        let seen: Vec<Sighting> =
            wall.log().iter().filter(|seen| closure.holds(seen.travelled)).copied().collect();
        let place = |point, time_us| adjustment.place(point, time_us);
        if let Some(outline) = post::post(&seen, chassis, place) {
            return vec![Thing { outline, class: ObjectClass::Circle, contacts }];
        }
    }
    let strokes = lap_strokes(wall, closure, adjustment);
    things(&contacts, &strokes, chassis)
}

/// The way of one lap, adjusted.
#[must_use]
pub fn lap_strokes(wall: &Wall, closure: &Closure, adjustment: &Adjustment) -> Vec<Stroke> {
    let place = |point, time_us| adjustment.place(point, time_us);
    let of_lap = wall.strokes().iter().filter(|stroke| closure.holds(stroke.travelled));
    of_lap.map(|stroke| stroke.placed(place)).collect()
}

/// The contacts of one lap, adjusted, in order. What the switches on the other hand saw belongs to
/// something else and is left out.
#[must_use]
pub fn lap_contacts(wall: &Wall, closure: &Closure, adjustment: &Adjustment) -> Vec<Contact> {
    let towards = |seen: &Sighting| {
        let bearing = angle::wrap(seen.beam - seen.pose.heading) * closure.side.sign();
        seen.sensor.is_none() || (-0.3..2.7).contains(&bearing)
    };
    let mut contacts: Vec<Contact> = wall
        .surfaces()
        .filter(|seen| towards(seen))
        .filter(|seen| closure.holds(seen.travelled))
        .map(|seen| {
            let mut contact = seen.contact();
            contact.point = adjustment.place(contact.point, seen.time_us);
            contact.from = adjustment.place(contact.from, seen.time_us);
            contact
        })
        .collect();
    // The fit expects the floor on the right of the order, as it is with the wall on the left.
    if closure.side == Side::Right {
        contacts.reverse();
    }
    contacts
}
