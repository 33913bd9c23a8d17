//! Past an object on one side, to the end of the line, and past it on the other side when the line is driven the
//! other way (paper III.F; two-pass contour). Both sides together go round it; where they do not, it is gone
//! round as a whole, which is for `rounds`; and what is met on no line again is left open.

use super::drive::Drive;
use super::rounds::{Round, here};
use super::{Doing, Scene, Tour};
use crate::geometry::{Point, Pose, angle};
use crate::mapping::circuit::Leg;
use crate::mapping::event::{EventKind, Failure};
use crate::mapping::follow::{Ask, Side};
use crate::mapping::map::Contact;
use crate::mapping::passing::{Passing, Way};
use crate::mapping::shape::things;
use crate::mapping::survey::Hung;
use crate::mapping::wall::{Sighting, Stroke, Wall};

/// Both sides of a thing, passed one after the other, are seen so near to each other where they meet, metres:
/// 0.16 at most where they are of one thing and the robot knows its place.
const JOINED: f64 = 0.3;

/// A pass under way.
#[derive(Debug, Clone)]
pub(super) struct Pass {
    passing: Box<Passing>,
    drive: Box<Drive>,
    /// The side that was passed before.
    half: Option<Half>,
}

impl Pass {
    /// The contacts that are being collected.
    pub(super) fn wall(&self) -> &Wall {
        &self.passing.wall
    }

    /// The same, to add to.
    pub(super) fn wall_mut(&mut self) -> &mut Wall {
        &mut self.passing.wall
    }

    /// The line it interrupted.
    pub(super) fn into_drive(self) -> Drive {
        *self.drive
    }
}

/// One side of an object, in the order in which it was passed.
#[derive(Debug, Clone)]
pub(super) struct Half {
    /// The line on which it was met.
    line: u32,
    /// That was driven from its end.
    backwards: bool,
    /// The hand on which the robot had it.
    side: Side,
    contacts: Vec<Contact>,
    /// The way past it.
    strokes: Vec<Stroke>,
}

impl Half {
    fn seen(pass: &Pass) -> Self {
        let Pass { passing, drive, .. } = pass;
        let side = passing.side();
        let towards = |seen: &&Sighting| {
            let bearing = angle::wrap(seen.beam - seen.pose.heading) * side.sign();
            seen.sensor.is_none() || (-0.3..2.7).contains(&bearing)
        };
        let contacts = passing.wall.surfaces().filter(towards).map(Sighting::contact).collect();
        let strokes = passing.wall.strokes().to_vec();
        Self { line: drive.id, backwards: drive.backwards, side, contacts, strokes }
    }

    /// On which line it was met.
    pub(super) fn line(&self) -> u32 {
        self.line
    }

    /// Whether what `drive` meets at `place` is the other side of it.
    fn ends_at(&self, drive: &Drive, place: Point) -> bool {
        let near = |last: &Contact| (last.point - place).norm() < JOINED;
        let the_other_way = self.line == drive.id && self.backwards != drive.backwards;
        the_other_way && self.contacts.last().is_some_and(near)
    }

    /// Whether the `other` side begins where this one ends, and ends where it begins: of 360 degrees nothing is
    /// left out.
    fn joins(&self, other: &Self) -> bool {
        let meet = |a: Option<&Contact>, b: Option<&Contact>| {
            a.zip(b).is_some_and(|(a, b)| (a.point - b.point).norm() < JOINED)
        };
        let (this, other) = (&self.contacts, &other.contacts);
        meet(this.last(), other.first()) && meet(other.last(), this.first())
    }

    /// All that was seen of it, gone round with the floor on the same hand as on every round, and the way.
    fn with(mut self, mut other: Self) -> (Vec<Contact>, Vec<Stroke>) {
        self.contacts.append(&mut other.contacts);
        if self.side == Side::Right {
            self.contacts.reverse();
        }
        (self.contacts, [self.strokes, other.strokes].concat())
    }
}

impl Tour {
    /// Something unknown on the line, seen at `place`: past it, on `side` if it was not passed before.
    pub(super) fn begin_to_pass(
        &mut self,
        drive: Box<Drive>,
        place: Point,
        side: Side,
        wall: Wall,
        scene: &Scene<'_>,
    ) {
        let half = self.halves.iter().rposition(|half| half.ends_at(&drive, place));
        let half = half.map(|at| self.halves.swap_remove(at));
        let side = half.as_ref().map_or(side, |half| half.side);
        let line = Pose { position: drive.from, heading: angle::of(drive.to - drive.from) };
        let passing = Box::new(Passing::new(&self.chassis, side, wall, line, scene.tracker));
        self.doing = Doing::Passing(Pass { passing, drive, half });
    }

    /// Past an object on one side. The first pass leaves half of it open, and the line is driven again from its
    /// end; the second closes it.
    pub(super) fn pass(&mut self, mut pass: Pass, scene: &mut Scene<'_>) -> Option<Ask> {
        match pass.passing.next(scene.tracker, &scene.rest) {
            Way::Leg(Leg::Go(ask)) => {
                self.doing = Doing::Passing(pass);
                return Some(ask);
            }
            // No way past on this side.
            Way::Leg(Leg::Closed(..) | Leg::Failed(_)) => self.all_the_way_round(pass, scene),
            Way::Back => {
                self.driven += pass.drive.come_to(scene.rest.pose.position);
                let seen = Half::seen(&pass);
                match pass.half.take() {
                    None => {
                        self.halves.push(seen);
                        pass.drive.again = true;
                        scene.tell.push(EventKind::ObjectHalf { id: scene.map.next_id() });
                        self.resume(pass.drive);
                    }
                    Some(half) if half.joins(&seen) => self.passed(half.with(seen), pass, scene),
                    Some(_) => self.all_the_way_round(pass, scene),
                }
            }
        }
        None
    }

    /// Passed on both sides: it is on the map.
    fn passed(
        &mut self,
        (contacts, way): (Vec<Contact>, Vec<Stroke>),
        pass: Pass,
        scene: &mut Scene<'_>,
    ) {
        let found = things(&contacts, &way, &self.chassis);
        if let Some(at) = self.cannot_be(&found, scene) {
            // It is past it, and beside nothing.
            self.doing = Doing::Driving(pass.drive);
            self.go_astray(at, None, scene);
            return;
        }
        let hung = Hung::Once(here(scene));
        self.record_round(found, &hung, scene);
        self.resume(pass.drive);
    }

    /// All lines are driven: of things that were passed on one side and met on no line again, no more is known than
    /// what was seen of them.
    pub(super) fn leave_open(&mut self, scene: &mut Scene<'_>) {
        for half in std::mem::take(&mut self.halves) {
            if !self.is_known(&half.contacts) {
                let id = scene.map.next_id();
                self.record_open(id, half.contacts, Failure::OneSided, scene);
            }
        }
    }

    /// What cannot be passed on both sides is gone round as a whole.
    fn all_the_way_round(&mut self, pass: Pass, scene: &Scene<'_>) {
        let Pass { passing, drive, .. } = pass;
        let (side, wall) = (passing.side(), passing.wall);
        let round = Round::new(&self.chassis, side, wall, drive, scene.map.next_id());
        self.doing = Doing::Rounding(round);
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::room_gone_along;
    use super::*;
    use crate::mapping::follow::AtRest;
    use crate::mapping::map::ContactKind;
    use crate::mapping::survey::Survey;
    use crate::robot::{DoneReason, SwitchSet};

    /// One side of a column of 0.3 m, from `begin` to `end` (degrees round its middle), on line 7.
    fn half(backwards: bool, begin: i32, end: i32) -> Half {
        let contact = |degrees: i32| {
            let towards = angle::unit(f64::from(degrees).to_radians());
            let (point, from) = (Point::origin() + towards * 0.3, Point::origin() + towards * 0.45);
            Contact { point, from, sensor: Some(2), kind: ContactKind::Range, time: 0.0 }
        };
        let contacts = (begin..=end).step_by(10).map(contact).collect();
        Half { line: 7, backwards, side: Side::Left, contacts, strokes: Vec::new() }
    }

    #[test]
    fn the_other_side_is_met_where_this_one_ends_by_who_comes_the_other_way() {
        let half = half(false, 0, 180);
        let line = |id, backwards| {
            let (from, to) = (Point::new(2.0, 0.0), Point::new(-2.0, 0.0));
            Drive { backwards, ..Drive::new(id, from, to) }
        };
        let (end, begin) = (Point::new(-0.3, -0.05), Point::new(0.3, -0.05));
        assert!(half.ends_at(&line(7, true), end));
        assert!(!half.ends_at(&line(7, true), begin), "another thing on the same line");
        assert!(!half.ends_at(&line(7, false), end), "led back to where it met it first");
        assert!(!half.ends_at(&line(8, true), end));
    }

    #[test]
    fn a_thing_that_is_not_met_again_stays_on_the_map_as_what_was_seen_of_it() {
        let (settings, mut map, mut tracker) = room_gone_along(0.3);
        let mut survey = Survey::new(0.003);
        survey.mark(settings.start.position, 0);
        let mut tour = Tour::new(&settings, &map, &survey);
        // In the middle of the room.
        let mut seen = half(false, 0, 170);
        for contact in &mut seen.contacts {
            let by = crate::geometry::Vector::new(1.5, 0.5);
            (contact.point, contact.from) = (contact.point + by, contact.from + by);
        }
        tour.halves = vec![seen];
        let (pose, closed, reason) = (settings.start, SwitchSet::EMPTY, DoneReason::Complete);
        let mut told = Vec::new();
        let scene = &mut Scene {
            tracker: &mut tracker,
            survey: &mut survey,
            rest: AtRest { pose, closed, reason },
            map: &mut map,
            tell: &mut told,
        };
        // Where it was gone round meanwhile, it is on the map already.
        tour.halves.extend(tour.halves.clone());
        tour.leave_open(scene);
        assert_eq!((tour.halves.len(), scene.map.objects.len()), (0, 1));
        assert!(!scene.map.objects[0].closed);
        let open = EventKind::ObjectOpen { id: 1, why: Failure::OneSided };
        assert_eq!(scene.tell.last(), Some(&open));
    }

    #[test]
    fn two_sides_are_all_of_it_only_where_they_meet_at_both_ends() {
        let first = half(false, 0, 170);
        assert!(first.joins(&half(true, 190, 350)));
        assert!(!first.joins(&half(true, 190, 270)), "a quarter that nobody saw");
        assert!(!first.joins(&half(true, 0, 170)), "the same side once more");
        let (contacts, _) = first.with(half(true, 190, 350));
        assert_eq!(contacts.len(), 18 + 17);
    }
}
