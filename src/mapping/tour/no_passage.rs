//! A round that runs on to the boundary: there is no passage between that and what it goes round. It is
//! gone along the other way as well, and is what was seen from wall to wall.

use super::rounds::{Round, here};
use super::{Doing, Scene, Tour};
use crate::geometry::Point;
use crate::mapping::event::{EventKind, Failure};
use crate::mapping::follow::{Ask, LONGEST_STRIDE, Side};
use crate::mapping::map::{Contact, MappedObject};
use crate::mapping::shape::{KNOWN, is_seen_from_within, things};
use crate::mapping::survey::Hung;
use crate::mapping::wall::Sighting;
use crate::robot::Chassis;

/// So many contacts of the boundary in a row, and it is the boundary that is followed.
const SURELY: usize = 14;
/// Less than so many contacts off the boundary are no object of its own.
const LEAST_SEEN: usize = 6;
/// Contacts nearer to the boundary than this may be its own, metres.
const BESIDE_BOUNDARY: f64 = 0.08;
/// A look sees the wall so much ahead and behind at most, metres: by twice that two looks a stride apart may leave
/// out more of it than the stride.
const AHEAD: f64 = 0.1;
/// What is hidden behind an object is looked at in steps of this, metres.
const STEP: f64 = 0.02;

/// What a round that was reversed at the boundary had come to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reversed {
    /// Metres travelled when it turned ...
    at: f64,
    /// ... and when it is back where it began, and has seen what it had seen.
    back_at: f64,
    /// How many contacts of the object there were when it turned.
    seen: usize,
}

impl Tour {
    /// Whether `seen` is farther than `reach` metres from the boundary.
    pub(super) fn is_off_boundary(&self, seen: &Sighting, reach: f64) -> bool {
        self.chart.outline().distance(seen.point) > reach
    }

    /// How many contacts off the boundary a round has made since it had driven `travelled` metres.
    fn seen_since(&self, round: &Round, travelled: f64) -> usize {
        let log = round.circuit.wall.log().iter();
        let of_it = |seen: &&Sighting| seen.alive && self.is_off_boundary(seen, KNOWN);
        log.filter(|seen| seen.travelled > travelled).filter(of_it).count()
    }

    /// Whether the round has run on to the boundary: there is no passage between.
    pub(super) fn is_at_boundary(&self, round: &Round) -> bool {
        let log = round.circuit.wall.log();
        // What is gone along backwards begins at the boundary: first back to where it was met.
        let travelled = log.last().map_or(0.0, |seen| seen.travelled);
        if round.reversed.is_some_and(|reversed| travelled < reversed.back_at) {
            return false;
        }
        let recent: Vec<&Sighting> = log.iter().rev().filter(|s| s.alive).take(SURELY).collect();
        recent.len() == SURELY && recent.iter().all(|seen| !self.is_off_boundary(seen, KNOWN))
    }

    /// Goes round the other way from here, along what was seen last.
    pub(super) fn reverse(&self, round: &mut Round, scene: &mut Scene<'_>) {
        scene.tell.push(EventKind::TurnedBack { id: round.id });
        let seen = self.seen_since(round, f64::NEG_INFINITY);
        let at = scene.tracker.travelled();
        let begun = round.circuit.wall.log().first().map_or(at, |seen| seen.travelled);
        round.turn_back(&self.chassis, Reversed { at, back_at: 2.0 * at - begun, seen });
    }

    /// The object was gone along from the boundary to the boundary: what lies between them behind it is
    /// a gap too narrow to pass, and its outline is closed by a straight line there.
    pub(super) fn closed_by_boundary(
        &mut self,
        round: Round,
        scene: &mut Scene<'_>,
    ) -> Option<Ask> {
        let of_it = |seen: &&Sighting| self.is_off_boundary(seen, BESIDE_BOUNDARY);
        let surfaces = round.circuit.wall.surfaces().filter(of_it);
        // What it had near when it turned was seen on the way towards the boundary: the last of it comes first.
        let turned = round.reversed.map_or(f64::NEG_INFINITY, |reversed| reversed.at);
        let (before, after): (Vec<&Sighting>, Vec<&Sighting>) =
            surfaces.partition(|seen| seen.travelled <= turned);
        let mut contacts: Vec<Contact> =
            before.into_iter().rev().chain(after).map(Sighting::contact).collect();
        // Led along the boundary instead of back, it has not seen the object again.
        let again = round.reversed.is_some_and(|reversed| {
            self.seen_since(&round, reversed.at) >= LEAST_SEEN.max(reversed.seen / 2)
        });
        if !again || !self.hides_behind(&contacts) {
            return self.left_open(round, Failure::WallLost, scene);
        }
        if round.circuit.side() == Side::Right {
            contacts.reverse();
        }
        if let Some(at) = self.cannot_be_there(&contacts, scene) {
            let beside = round.beside(&self.chassis);
            self.doing = Doing::Driving(round.drive);
            self.go_astray(at, Some(beside), scene);
            return None;
        }
        let tie = here(scene);
        if self.is_known(&contacts) {
            // It leads nowhere to go round it once more.
            scene.tell.push(EventKind::ObjectKnown { id: round.id });
            return self.go_on(round.drive, scene);
        }
        for thing in things(&contacts, round.circuit.wall.strokes(), &self.chassis) {
            let id = scene.map.next_id();
            self.record(
                MappedObject { closed: false, ..thing.numbered(id) },
                Hung::Once(tie),
                scene,
            );
            scene.tell.push(EventKind::ObjectBehind { id });
        }
        self.resume(round.drive);
        None
    }

    /// Whether a thing seen from wall to wall by `contacts` hides no more than a gap behind it: from the
    /// last of them straight to the first, the boundary is always near, and each was made no farther than
    /// two looks a stride apart from one before. Where the pose is lost, what was followed may have been the
    /// boundary itself, seen from the floor within it. (In a strait at which the map ends as well the walls are seen
    /// from within, but from beyond the map.)
    fn hides_behind(&self, contacts: &[Contact]) -> bool {
        let gap = self.chassis.passable_gap();
        let (Some(first), Some(last)) = (contacts.first(), contacts.last()) else { return false };
        let near = |p: Point| self.chart.outline().distance(p) < gap + BESIDE_BOUNDARY;
        let behind = last.point - first.point;
        let steps = (behind.norm() / STEP).ceil().max(1.0);
        let on_the_floor =
            contacts.iter().filter(|c| self.chart.outline().contains(c.from)).count();
        let is_the_boundary = 2 * on_the_floor > contacts.len() && is_seen_from_within(contacts);
        !is_the_boundary
            && (0..=steps as u32).all(|k| near(first.point + behind * (f64::from(k) / steps)))
            && (1..contacts.len()).all(|k| {
                // Not from the one just before: a look sees ahead and behind by turns.
                let off = |other: &Contact| (other.point - contacts[k].point).norm();
                contacts[..k].iter().rev().any(|other| off(other) < LONGEST_STRIDE + 2.0 * AHEAD)
            })
    }
}

impl Round {
    /// Begins the round anew the other way, beside what is near.
    fn turn_back(&mut self, chassis: &Chassis, reversed: Reversed) {
        let (side, wall) = self.beside(chassis);
        let anew = Self::new(chassis, side.other(), wall, self.drive.clone(), self.id);
        *self = Self { reversed: Some(reversed), compared: self.compared, ..anew };
    }
}
