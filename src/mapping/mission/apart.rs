//! What the lap went round that is no part of the wall: made objects of while the shape is found, each with
//! its own contacts, and with the tip by which the lap joined it to the wall; and what the outline has lost but is one
//! with the wall drawn into that. What stands apart, the `shape` says; nothing is driven for it.

use super::phases::REFINED;
use super::{Mission, Output};
use crate::geometry::{Ring, Segment};
use crate::mapping::event::EventKind;
use crate::mapping::map::Contact;
use crate::mapping::shape::{self, ALL_AROUND, BUT_FOR_ITS_BACK, Enclosed, Loops, Needle, Thing};
use crate::mapping::unreached::{Beyond, Unreached};
use crate::mapping::wall::{Stroke, is_felt_on_both_hands, length_within};
use crate::robot::Chassis;

/// Contacts of a tip lie on it, and on the outline of what it is the tip of, within this, metres.
const ON_TIP: f64 = 0.015;
/// It lies no farther than this from what was drawn without it, metres: as far apart as two looks at a face.
const TO_TIP: f64 = 0.65;
/// What the outline has lost ends no farther than this from where a needle of it does, metres.
const OF_LOST: f64 = 0.1;
/// That is no more than so many times as large with it.
const MOST_GROWN: f64 = 1.5;
/// No wall has more things beside it that it was fitted without.
const MOST_JOINED: u32 = 20;

impl Mission {
    /// Makes objects of what the lap went round within the room; false when there is nothing.
    pub(super) fn take_out_enclosed(&mut self, out: &mut Vec<Output>) -> bool {
        let Enclosed { things, wall } = shape::enclosed(&self.map.contacts);
        if things.is_empty() {
            return false;
        }
        self.map.contacts = wall;
        for contacts in things {
            self.stands_apart(Thing::of(contacts), out);
        }
        true
    }

    /// Gives what the lap went round, and what is an object already, the tip that it is joined to the outline by;
    /// what remains of the outline.
    fn give_tips(&mut self, outline: Ring) -> Ring {
        let mut outline = outline;
        while !self.map.objects.is_empty()
            && let Some((rest, tip)) =
                shape::tip(&outline, &self.map.contacts, &self.way, &self.settings.chassis)
        {
            let is_own = |c: &Contact| tip.distance(c.point) < rest.distance(c.point).min(ON_TIP);
            let (own, walls): (Vec<Contact>, Vec<Contact>) =
                self.map.contacts.iter().copied().partition(is_own);
            let whole = self.map.objects.iter().enumerate().find_map(|(k, object)| {
                let mut contacts = [object.contacts.as_slice(), own.as_slice()].concat();
                contacts.sort_by(|a, b| a.time.total_cmp(&b.time));
                let thing = Thing::of(contacts);
                let reaches = own.iter().all(|c| thing.outline.distance(c.point) < ON_TIP);
                let grown = 1.0..MOST_GROWN;
                let is_it =
                    reaches && grown.contains(&(thing.outline.area() / object.outline.area()));
                (is_it && object.outline.distance(tip.middle()) < TO_TIP).then_some((k, thing))
            });
            let Some((k, thing)) = whole.filter(|_| !own.is_empty()) else { break };
            let object = &mut self.map.objects[k];
            *object = thing.numbered(object.id);
            (self.map.contacts, outline) = (walls, rest);
        }
        outline
    }

    /// Makes objects of what only gaps too narrow to pass join to the outline, and of what the outline has
    /// lost; what remains of it.
    pub(super) fn set_apart(&mut self, outline: Ring, out: &mut Vec<Output>) -> Ring {
        let was_joined = self.fit(Loops::Touched).is_none();
        let chassis = &self.settings.chassis;
        let (rest, islands) = shape::islands(outline, &self.map.contacts, &self.way, chassis);
        // Each of them has the contacts that lie nearest to it, and the wall has the rest.
        let (walls, own): (Vec<Contact>, Vec<Contact>) =
            std::mem::take(&mut self.map.contacts).into_iter().partition(|contact| {
                let off = |ring: &Ring| ring.distance(contact.point);
                islands.iter().all(|ring| off(ring) >= off(&rest))
            });
        let (walls, lost, rest) = self.lost_by(walls, rest);
        self.map.contacts = walls;
        let parts = shape::shared_out(&own, &islands);
        let alone = !islands.is_empty() || !lost.is_empty();
        for (outline, contacts) in islands.into_iter().zip(parts) {
            let class = shape::class_of(&outline);
            self.stands_apart(Thing { outline, class, contacts }, out);
        }
        for thing in lost {
            self.stands_apart(thing, out);
        }
        let rest = self.give_tips(rest);
        // A round room is seen to be round when nothing hangs on it any longer; and where the contacts could
        // only be joined, a fit may be made of what is left.
        let again = (alone || was_joined).then(|| self.fit(Loops::All)).flatten();
        let is_same = |ring: &Ring| (ring.area() / rest.area() - 1.0).abs() < REFINED;
        // Where the map ends at a strait nothing was felt, and a fit would draw wall there.
        let joined = was_joined && self.map.beyond.is_empty();
        let is_better = |ring: &Ring| {
            let is_driven_over = is_driven_over(ring, &rest, &self.way, &self.settings.chassis);
            (ring.is_circle() || (joined && is_same(ring))) && !is_driven_over
        };
        again.filter(is_better).unwrap_or(rest)
    }

    /// What `outline` has lost of the `contacts` that were made beside it: those that it keeps, the things, and what
    /// remains of it.
    fn lost_by(&self, contacts: Vec<Contact>, outline: Ring) -> (Vec<Contact>, Vec<Thing>, Ring) {
        let (mut contacts, mut rest) = (contacts, outline);
        let mut given_up = Vec::new();
        // By a needle of the outline some of a thing, or all of it, is not lost to it yet.
        while let Some((needle, its)) = self
            .needles(&rest, &contacts)
            .into_iter()
            .find(|(_, its)| its.iter().any(|thing| thing.is_apart))
        {
            let its = its.into_iter().filter(|thing| thing.is_apart).map(|lost| lost.thing);
            for thing in its {
                contacts.retain(|contact| !thing.contacts.contains(contact));
                given_up.push(thing);
            }
            rest = needle.bare;
        }
        let (kept, mut things) = shape::lost(&contacts, &rest, ALL_AROUND);
        things.extend(given_up);
        (kept, things, rest)
    }

    /// The outline with what it has lost but for needles, and what is one with the wall: between the two there is
    /// no floor for the body.
    pub(super) fn joined(&self, outline: Ring) -> Ring {
        let mut outline = outline;
        let whole = |outline: &Ring| {
            let needles = self.needles(outline, &self.map.contacts);
            needles.into_iter().find_map(|(needle, its)| {
                let joined = its.iter().filter(|thing| !thing.is_apart);
                let mut whole = joined.filter_map(|thing| needle.about(&thing.thing.outline));
                whole.find(|whole| {
                    !is_driven_over(whole, outline, &self.way, &self.settings.chassis)
                })
            })
        };
        // One for each thing at most.
        for _ in 0..MOST_JOINED {
            let Some(whole) = whole(&outline) else { break };
            outline = whole;
        }
        outline
    }

    /// The needles of `outline`, each with the things that it ends at, which the outline without it has lost of the
    /// `contacts`. By the wall nobody sees the back of a thing.
    fn needles(&self, outline: &Ring, contacts: &[Contact]) -> Vec<(Needle, Vec<Lost>)> {
        let chassis = &self.settings.chassis;
        let with_its = |needle: Needle| {
            let (_, mut things) = shape::lost(contacts, &needle.bare, BUT_FOR_ITS_BACK);
            things.retain(|thing| thing.outline.distance(needle.tip) < OF_LOST);
            let lost = |thing: Thing| {
                let is_apart = shape::is_apart(&needle.bare, &thing.outline, chassis);
                Lost { thing, is_apart }
            };
            let its = things.into_iter().map(lost).collect();
            (needle, its)
        };
        let needles = shape::needles(outline, contacts, &self.way, chassis);
        needles.into_iter().map(with_its).collect()
    }

    /// Ends the map at straits; what remains of `outline`. What was seen behind them is kept by itself.
    pub(super) fn end_at_straits(&mut self, outline: Ring, out: &mut Vec<Output>) -> Ring {
        let here = [self.settings.start.position, self.tracker.pose().position];
        let chassis = &self.settings.chassis;
        let is_felt = |gate: &Segment| is_felt_on_both_hands(&self.way, chassis, gate);
        let (rest, behind) = shape::cut_at_straits(outline, here, chassis, is_felt);
        let (there, walls): (Vec<Contact>, Vec<Contact>) =
            std::mem::take(&mut self.map.contacts).into_iter().partition(|contact| {
                let off = |ring: &Ring| ring.distance(contact.point);
                behind.iter().any(|ring| off(ring) < off(&rest))
            });
        self.map.contacts = walls;
        let parts = shape::shared_out(&there, &behind);
        let beyond = behind.into_iter().zip(parts);
        self.map.beyond = beyond.map(|(outline, contacts)| Beyond { outline, contacts }).collect();
        let gaps = self.map.beyond.iter().filter_map(|one| one.told(&self.settings.chassis));
        for Unreached { at, width, area } in gaps.collect::<Vec<_>>() {
            self.tell(EventKind::Strait { at, width, area: area.unwrap_or(0.0) }, out);
        }
        rest
    }

    pub(super) fn stands_apart(&mut self, thing: Thing, out: &mut Vec<Output>) {
        let id = self.map.next_id();
        self.map.objects.push(thing.numbered(id));
        self.tell(EventKind::ObjectApart { id }, out);
    }
}

/// A thing that an outline has lost.
struct Lost {
    thing: Thing,
    /// Whether the body fits between the two.
    is_apart: bool,
}

/// Whether `ring` has a side across floor that the robot drove on by `way`, and `rest` has none there: such a side
/// joins what is not beside each other. Where the way is outside by less than half of the body, the two only run
/// elsewhere between things that the robot hardly got through.
fn is_driven_over(ring: &Ring, rest: &Ring, way: &[Stroke], chassis: &Chassis) -> bool {
    let more = length_within(way, rest).0 - length_within(way, ring).0;
    more > chassis.radius
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Pose};
    use crate::mapping::wall::Wall;
    use crate::robot::SwitchSet;

    #[test]
    fn a_side_a_little_elsewhere_is_not_driven_over_and_one_across_a_bay_is() {
        // Into a bay of 0.6 m between x = 2 and 2.6, and out again.
        let chassis = Chassis::default();
        let mut wall = Wall::new(&chassis);
        let corners = [(0.2, 0.2), (2.3, 0.2), (2.3, -0.4), (2.3, 0.2), (4.0, 0.2)];
        for pair in corners.windows(2) {
            for k in 0..=20_u32 {
                let share = f64::from(k) / 20.0;
                let at = |a: f64, b: f64| a + (b - a) * share;
                let (x, y) = (at(pair[0].0, pair[1].0), at(pair[0].1, pair[1].1));
                wall.carve(Pose::new(x, y, 0.0), SwitchSet::only(usize::from(k % 2 == 0)), 0.0, 0);
            }
        }
        let room = |deep: f64| {
            let bay = [(2.0, 0.0), (2.0, -deep), (2.6, -deep), (2.6, 0.0)];
            let all =
                [(0.0, 0.0)].into_iter().chain(bay).chain([(4.2, 0.0), (4.2, 2.0), (0.0, 2.0)]);
            Ring::polygon(&all.map(|(x, y)| Point::new(x, y)).collect::<Vec<_>>())
        };
        let is_over =
            |deep: f64| is_driven_over(&room(deep), &room(0.55), wall.strokes(), &chassis);
        assert!(!is_over(0.55) && !is_over(0.38), "the wall runs beside the way");
        assert!(is_over(0.05), "a chord");
    }
}
