//! Going round what a line meets: one full round, at first contact or where a pass on both sides (`passes`)
//! does not lead round it.

use super::drive::{Drive, Purpose};
use super::no_passage::Reversed;
use super::{Doing, MOST_LEFT_OPEN, Scene, Tour};
use crate::geometry::Point;
use crate::mapping::adjust::Adjustment;
use crate::mapping::circuit::{Circuit, Leg};
use crate::mapping::event::{EventKind, Failure};
use crate::mapping::follow::{Ask, Side};
use crate::mapping::lay::Overlap;
use crate::mapping::map::{Contact, LineReason, LineStatus, MappedObject, ObjectClass, RoomMap};
use crate::mapping::search::{lap_strokes, lap_things, straight_contacts, whole_lap};
use crate::mapping::settings::Contour;
use crate::mapping::shape::{KNOWN, Thing, is_mapped, lies_on, object_outline, unmapped};
use crate::mapping::survey::{Hung, Surface, Survey, Tie};
use crate::mapping::wall::{Sighting, Wall};
use crate::robot::Chassis;

/// The floor is looked at anew when what stands on it is believed to have moved this far, metres.
const MATTERS: f64 = 0.003;
/// Going round something large, the pose is kept in the survey every so often, metres: what was seen on its
/// far side does not turn with its near one.
const KEPT_EVERY: f64 = 2.0;
/// Metres driven again after a round has closed, for its misclosure.
const ROUND_OVERLAP: f64 = 0.25;

/// Contacts of a whole round were not seen from where the robot is at its end: each says little of
/// its pose, metres, ...
const ROUND_SD: f64 = 0.05;
/// ... and since they are off together, all of them no more than so many that each are off by themselves.
const ROUND_WORTH: f64 = 4.0;

impl Tour {
    /// Something unknown: goes round it.
    pub(super) fn meet(
        &mut self,
        mut drive: Box<Drive>,
        seen: Sighting,
        bearing: f64,
        by: String,
        scene: &mut Scene<'_>,
    ) -> Option<Ask> {
        let id = scene.map.next_id();
        // Right or centre: anti-clockwise, the robot turns left and keeps it on its right (III.F).
        let side = if bearing > 0.1 { Side::Left } else { Side::Right };
        drive.way.clear();
        let wall = Wall::of(&self.chassis, [seen]);
        if self.cannot_be_at(seen.point, scene) {
            self.doing = Doing::Driving(drive);
            self.go_astray(seen.point, Some((side, wall)), scene);
            return None;
        }
        scene.tell.push(EventKind::ObjectFound { id, by });
        // Who is not on a line has no line to come back to.
        if self.contour == Contour::TwoPass && drive.is_on_line() {
            self.begin_to_pass(drive, seen.point, side, wall, scene);
            return None;
        }
        self.doing = Doing::Rounding(Round::new(&self.chassis, side, wall, drive, id));
        None
    }

    pub(super) fn round(&mut self, mut round: Round, scene: &mut Scene<'_>) -> Option<Ask> {
        if self.is_at_boundary(&round) {
            if round.reversed.is_some() {
                return self.closed_by_boundary(round, scene);
            }
            self.reverse(&mut round, scene);
        }
        if self.recognise(&mut round, scene) {
            // Met again and again, it is not passed on this line.
            return self.go_on(round.drive, scene);
        }
        match round.circuit.next(scene.tracker, &scene.rest) {
            Leg::Go(ask) => {
                let gap = round.circuit.closed_gap();
                scene.tell.extend(gap.map(|width| EventKind::LedBack { width }));
                round.mark(scene);
                self.doing = Doing::Rounding(round);
                Some(ask)
            }
            Leg::Closed(closure, overlap) if closure.is_extrinsic() => {
                let since = closure.from.time_us;
                let mut adjustment = Adjustment::new(scene.tracker, &closure, &overlap, since);
                let closure = whole_lap(&round.circuit.wall, &closure, &adjustment);
                let contacts = straight_contacts(
                    &round.circuit.wall,
                    &closure,
                    &mut adjustment,
                    &self.chassis,
                );
                let before = scene.tracker.pose();
                let hung = round.close(&overlap, scene);
                let after = scene.tracker.pose();
                if self.is_known(&contacts) {
                    // Where it stands so near that the round led on to what is known, it is none of that.
                    let known = |p: Point| self.chart.distance(p).0 < KNOWN;
                    let strokes = lap_strokes(&round.circuit.wall, &closure, &adjustment);
                    let fresh = unmapped(&contacts, known, &strokes, &self.chassis);
                    let is_fresh = !fresh.is_empty();
                    self.record_round(fresh, &hung, scene);
                    // The pose was off, or it would not have been met as something new.
                    let share = contacts.len() as f64 / ROUND_WORTH;
                    let least = ROUND_SD * share.max(1.0).sqrt();
                    for contact in &contacts {
                        let surface =
                            self.chart.surface_at(scene.survey, contact.point, contact.from, KNOWN);
                        let fixed = surface.and_then(|surface| {
                            let surface = Surface { sd: surface.sd.max(least), ..surface };
                            scene.survey.touch(scene.tracker.pose(), contact.point, &surface)
                        });
                        if let Some(pose) = fixed {
                            scene.tracker.correct(pose);
                        }
                    }
                    if is_fresh {
                        self.resume(round.drive);
                        return None;
                    }
                    scene.tell.push(EventKind::ObjectKnown { id: round.id });
                    // Met again and again, it stands where the map does not have it.
                    return self.go_on(round.drive, scene);
                }
                let wall = &round.circuit.wall;
                let found = lap_things(wall, &closure, &adjustment, contacts, &self.chassis);
                if let Some(at) = self.cannot_be(&found, scene) {
                    // What it is beside was seen before the round had closed.
                    let near = round.circuit.wall.near().map(|seen| seen.moved(&before, &after));
                    let beside = (round.circuit.side(), Wall::of(&self.chassis, near));
                    self.doing = Doing::Driving(round.drive);
                    self.go_astray(at, Some(beside), scene);
                    return None;
                }
                self.refute(&found, since, scene);
                self.record_round(found, &hung, scene);
                self.resume(round.drive);
                None
            }
            Leg::Closed(..) => self.left_open(round, Failure::LapEndless, scene),
            Leg::Failed(why) => self.left_open(round, why, scene),
        }
    }

    /// Whether what was gone round is on the map already.
    pub(super) fn is_known(&self, contacts: &[Contact]) -> bool {
        is_mapped(contacts, &self.chart.objects())
    }

    pub(super) fn left_open(
        &mut self,
        round: Round,
        why: Failure,
        scene: &mut Scene<'_>,
    ) -> Option<Ask> {
        let off = round.circuit.wall.surfaces().filter(|seen| self.is_off_boundary(seen, KNOWN));
        let contacts: Vec<Contact> = off.map(Sighting::contact).collect();
        if let Some(at) = self.cannot_be_there(&contacts, scene) {
            let beside = round.beside(&self.chassis);
            self.doing = Doing::Driving(round.drive);
            self.go_astray(at, Some(beside), scene);
            return None;
        }
        self.record_open(round.id, contacts, why, scene);
        self.go_on(round.drive, scene)
    }

    /// Adds what `contacts` tell of something that was not gone round to map and chart, if they tell anything.
    pub(super) fn record_open(
        &mut self,
        id: u32,
        contacts: Vec<Contact>,
        why: Failure,
        scene: &mut Scene<'_>,
    ) {
        scene.tell.push(EventKind::ObjectOpen { id, why });
        if contacts.len() >= 3 {
            let (outline, _) = object_outline(&contacts, false);
            let class = ObjectClass::Open;
            let object = MappedObject { id, class, outline, closed: false, contacts };
            let hung = Hung::Once(here(scene));
            self.record(object, hung, scene);
        }
    }

    /// On along the line past what could not be gone round, but not for ever.
    pub(super) fn go_on(&mut self, mut drive: Box<Drive>, scene: &mut Scene<'_>) -> Option<Ask> {
        drive.left_open += 1;
        if drive.left_open >= MOST_LEFT_OPEN {
            let why = Some(LineReason::ObjectOnLine);
            self.end_line(&drive, LineStatus::Blocked, why, scene);
            self.floor = None;
            self.wall.clear();
        } else {
            self.resume(drive);
        }
        None
    }

    /// Adds what a whole round went round to map and chart, with what it hangs on.
    pub(super) fn record_round(&mut self, found: Vec<Thing>, hung: &Hung, scene: &mut Scene<'_>) {
        // Of two that stand close to each other one may be on the map already; and what was seen across a gap may
        // be the wall there.
        let is_new = |thing: &Thing| {
            !self.is_known(&thing.contacts) && !lies_on(&thing.contacts, self.chart.outline())
        };
        let fresh: Vec<Thing> = found.into_iter().filter(is_new).collect();
        for (n, thing) in fresh.into_iter().enumerate() {
            let id = scene.map.next_id();
            self.record(thing.numbered(id), hung.clone(), scene);
            scene.tell.push(EventKind::gone_round(id, n == 0));
        }
    }

    /// Adds an object to map and chart, with what it hangs on.
    pub(super) fn record(&mut self, object: MappedObject, hung: Hung, scene: &mut Scene<'_>) {
        self.chart.add(&object, hung);
        scene.map.objects.push(object);
    }

    /// Lets floor and map follow what the survey has learnt, when it is enough to matter.
    pub(super) fn follow_survey(&mut self, survey: &Survey, map: &mut RoomMap) {
        if self.chart.refresh(survey) > MATTERS {
            self.floor = None;
            self.chart.publish(survey, map);
        }
    }

    /// On with what was left to go round something; with a line after bearings, where they are called for.
    pub(super) fn resume(&mut self, mut drive: Box<Drive>) {
        self.floor = None;
        self.wall.clear();
        drive.way.clear();
        self.doing = if drive.purpose == Purpose::Line {
            self.suspended = Some(drive);
            Doing::Choosing
        } else {
            Doing::Driving(drive)
        };
    }
}

/// The pose of now, kept in the survey for what hangs on it.
pub(super) fn here(scene: &mut Scene<'_>) -> Tie {
    scene.survey.mark(scene.tracker.pose().position, scene.tracker.time_us())
}

/// A round under way.
#[derive(Debug, Clone)]
pub(super) struct Round {
    pub(super) circuit: Box<Circuit>,
    pub(super) drive: Box<Drive>,
    pub(super) id: u32,
    /// Where the round began: what is mapped on it hangs on that.
    pub(super) begun: Option<(Tie, Point)>,
    /// Metres travelled when the pose was last kept in the survey.
    pub(super) kept: f64,
    /// Metres travelled when what it goes round was last compared with the map.
    pub(super) compared: f64,
    /// Where it came back to its beginning, as far as it looks.
    pub(super) back: Option<(Tie, Point)>,
    /// It ran on to the boundary, and goes round the other way since.
    pub(super) reversed: Option<Reversed>,
}

impl Round {
    pub(super) fn new(
        chassis: &Chassis,
        side: Side,
        wall: Wall,
        drive: Box<Drive>,
        id: u32,
    ) -> Self {
        let circuit = Box::new(Circuit::new(chassis, side, wall, ROUND_OVERLAP));
        Self {
            circuit,
            drive,
            id,
            begun: None,
            kept: 0.0,
            compared: 0.0,
            back: None,
            reversed: None,
        }
    }

    /// On which hand it follows what, with what is near.
    pub(super) fn beside(&self, chassis: &Chassis) -> (Side, Wall) {
        (self.circuit.side(), Wall::of(chassis, self.circuit.wall.near().copied()))
    }

    /// The line it interrupted.
    pub(super) fn into_drive(self) -> Drive {
        *self.drive
    }

    /// Keeps the pose in the survey where the round begins, and where it comes back to that.
    fn mark(&mut self, scene: &mut Scene<'_>) {
        let travelled = scene.tracker.travelled();
        if self.begun.is_none() && self.circuit.first_anchor().is_some() {
            self.begun = Some((here(scene), scene.tracker.pose().position));
            self.kept = travelled;
        }
        if self.begun.is_some() && travelled > self.kept + KEPT_EVERY {
            here(scene);
            self.kept = travelled;
        }
        if !self.circuit.looks_closed() {
            self.back = None;
        } else if self.back.is_none() {
            self.back = Some((here(scene), scene.tracker.pose().position));
        }
    }

    /// Lays the end of the round on its beginning, which corrects the pose; what its contacts hang
    /// on.
    fn close(&self, overlap: &Overlap, scene: &mut Scene<'_>) -> Hung {
        let Some((begun, _)) = &self.begun else { return Hung::Once(here(scene)) };
        let Some((back, at)) = &self.back else { return Hung::Once(*begun) };
        overlap.close(scene.survey, begun, back, *at);
        scene.tracker.correct(scene.survey.take_pose(scene.tracker.pose()));
        Hung::Along(scene.survey.mapped_from(begun, back))
    }
}
