//! When the lap has its shape, and at the end, all that was read is adjusted at once, and the map follows. How
//! it is adjusted is for `network` to know, and what comes after it for `phases`.

use super::{Mission, Output};
use crate::geometry::{Point, Pose};
use crate::mapping::event::EventKind;
use crate::mapping::map::{Contact, PathPoint};
use crate::mapping::network::{
    Adjusted, Datum, Given, WITHIN, WITHIN_LAP, WITHIN_ROUND, displacement,
};
use crate::mapping::shape;

/// That all of it was adjusted.
pub(super) struct Whole {
    /// What errors all of it has in common, as far as that can be told.
    pub(super) datum: Option<Datum>,
}

impl Mission {
    /// Adjusts all observations at once, and moves what was mapped, and the trajectory, to where they are
    /// by that: from coarse to fine, since with all of it moved more contacts are seen to be of surfaces.
    /// Nothing moves where it cannot be done to the end; what errors all of it has in common if it was.
    pub(super) fn adjust_whole(&mut self, out: &mut Vec<Output>) -> Option<Whole> {
        self.adjust(if self.map.is_round() { &WITHIN_ROUND } else { &WITHIN }, false, out)
    }

    /// The same when the lap alone is driven. In a round room, where nothing that was seen tells how far the robot
    /// has turned, nothing tells what the gyro drifts either: there all of it at once knows no better than the
    /// filter, and nothing moves.
    pub(super) fn adjust_lap(&mut self, out: &mut Vec<Output>) -> Option<Whole> {
        self.adjust(&WITHIN_LAP, true, out)
    }

    /// The same by such steps; only where all of it has a `turn` that can be told.
    fn adjust(&mut self, steps: &[f64], turn: bool, out: &mut Vec<Output>) -> Option<Whole> {
        let before = (self.map.clone(), self.way.clone(), self.beside.clone());
        let (pose, path) = (self.tracker.pose(), self.tracker.path().to_vec());
        let mut last = None;
        for (k, &within) in steps.iter().enumerate() {
            let is_last = k + 1 == steps.len();
            let adjusted = self.adjusted(within, is_last);
            last = adjusted.filter(|all| !(turn && is_last) || all.datum.is_some()).map(|all| {
                self.follow(&all);
                (all.used, all.datum, all.errors)
            });
            if last.is_none() {
                (self.map, self.way, self.beside) = before;
                self.tracker.path_mut().clone_from(&path);
                self.tracker.settle(pose);
                self.rest.pose = pose;
                return None;
            }
        }
        let off = |(before, now): (&PathPoint, &PathPoint)| {
            (now.pose.position - before.pose.position).norm_squared()
        };
        let squares: f64 = path.iter().zip(self.tracker.path()).map(off).sum();
        let moved = (squares / path.len().max(1) as f64).sqrt();
        let (used, datum, errors) = last?;
        // The way is told by a gyro and by wheels that err like that; what comes is.
        self.survey.errs(&errors);
        self.tracker.set_bias(errors.drift);
        self.tell(EventKind::AdjustedWhole { moved, used }, out);
        let begun = |datum: Datum| self.begun_off.map_or(datum, |off| datum.begun_off(off));
        Some(Whole { datum: datum.map(begun) })
    }

    fn adjusted(&self, within: f64, datum: bool) -> Option<Adjusted> {
        let beams: Vec<f64> =
            self.settings.chassis.sensors.iter().map(|mount| mount.angle).collect();
        self.network.adjust(&Given {
            path: self.tracker.path(),
            map: &self.map,
            beams: &beams,
            stretch: self.tracker.stretched(),
            tick: self.settings.chassis.tick,
            resolution: self.tracker.resolution(),
            grip: self.survey.grip(),
            bias: self.tracker.bias(),
            held: self.tracker.held(),
            within,
            datum,
        })
    }

    /// Moves all that was mapped, and the trajectory, along.
    fn follow(&mut self, adjusted: &Adjusted) {
        let moved = |contacts: &[Contact]| -> Vec<Contact> {
            contacts.iter().map(|contact| adjusted.contact(contact)).collect()
        };
        let now = moved(&self.map.contacts);
        if let Some(shape) = &mut self.map.shape {
            let before = &self.map.contacts;
            shape.outline = shape.outline.deformed(|p| displacement(before, &now, p));
        }
        self.map.contacts = now;
        for beyond in &mut self.map.beyond {
            let now = moved(&beyond.contacts);
            let before = std::mem::replace(&mut beyond.contacts, now);
            let now = &beyond.contacts;
            beyond.outline = beyond.outline.deformed(|p| displacement(&before, now, p));
        }
        for object in &mut self.map.objects {
            let now = moved(&object.contacts);
            let before = std::mem::replace(&mut object.contacts, now);
            let now = &object.contacts;
            let by = |p: Point| displacement(&before, now, p);
            // Faces of something thin may cross when each corner moves by itself: then all of it moves as one.
            object.outline = shape::uncrossed(&object.outline.deformed(by)).unwrap_or_else(|| {
                let middle = by(object.outline.middle());
                object.outline.deformed(|_| middle)
            });
        }
        for stroke in &mut self.way {
            let place = |at, time_us| adjusted.pose(Pose { position: at, heading: 0.0 }, time_us);
            *stroke = stroke.placed(|at, time_us| place(at, time_us).position);
        }
        for point in self.tracker.path_mut() {
            point.pose = adjusted.pose(point.pose, point.time_us);
        }
        let before = self.tracker.pose();
        let here = adjusted.pose(before, self.tracker.time_us());
        self.beside = self.beside.take().map(|beside| beside.moved(&before, &here));
        self.tracker.settle(here);
        self.rest.pose = here;
    }
}
