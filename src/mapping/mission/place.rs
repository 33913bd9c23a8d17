//! A robot that was carried, or started anew: what it was doing is left undone, and it goes on as soon
//! as it knows again where it is.

use super::{Lost, Mission, Outcome, Output, Task};
use crate::geometry::{Pose, Ring, angle};
use crate::mapping::event::EventKind;
use crate::mapping::map::MappedObject;
use crate::mapping::relocate::recognise::Place;
use crate::mapping::relocate::{About, Relocation, Seek};
use crate::mapping::tour::{Astray, Tour};
use crate::robot::DoneReason;

/// The pose is never surer than this beside the walls it was found by, metres and radians: they are
/// ragged, and neighbouring contacts err together.
const SUREST: (f64, f64) = (0.02, 0.01);

/// A robot that was farther off than this, metres, and than so many standard deviations of its pose, is not
/// where it was believed to be for more than drift.
const ASTRAY_BY: f64 = 0.1;
/// Nor one whose heading was farther off than this, radians, and than so many of its standard deviations.
const ASTRAY_TURN: f64 = 0.05;
const DEVIATIONS: f64 = 3.0;
/// A robot that doubts its place so often in a row and does not find it, at first near where it believes it is
/// and then anywhere, does not go on. One that is not lost has not found it once at most, in 158 runs with worn
/// wheels.
const LOST: u32 = 3;

impl Mission {
    /// The robot stands elsewhere, about at `near` if anybody knows; false while it moves or when the
    /// run is over.
    pub fn placed(&mut self, near: Option<Pose>, out: &mut Vec<Output>) -> bool {
        if self.is_moving() || self.outcome != Outcome::Going {
            return false;
        }
        self.tell(EventKind::Carried, out);
        self.survey.started_anew();
        let about = if near.is_some() { About::Told } else { About::Nothing };
        match (std::mem::replace(&mut self.task, Task::Over), near) {
            (Task::Search(_), Some(near)) => self.begin_anew(near, out),
            (task @ Task::Search(_), None) => {
                self.task = task;
                self.lose(about);
                self.wait_for_word(EventKind::PlaceNeeded, out);
            }
            (Task::Relocate(relocation, mut tour), _) => {
                if self.doubts() {
                    // Nobody will find out any more whether it was right to.
                    self.take_back(&relocation, &mut tour, out);
                }
                tour.interrupt(&mut self.map);
                self.task = Task::Tour(tour);
                self.lose(about);
            }
            (Task::Tour(mut tour), _) => {
                tour.interrupt(&mut self.map);
                self.task = Task::Tour(tour);
                self.lose(about);
            }
            (Task::Retrace(_), _) => {
                self.end_boundary(out);
                self.lose(about);
            }
            (task @ (Task::Shape | Task::Plan | Task::Over), _) => {
                self.task = task;
                self.lose(about);
            }
        }
        if let (Some(near), true) = (near, self.lost.is_some()) {
            self.tracker.settle(near);
        }
        self.rest.pose = self.tracker.pose();
        self.rest.reason = DoneReason::Complete;
        true
    }

    /// The lap begins anew at `from`: there is no boundary yet to know a place by.
    fn begin_anew(&mut self, from: Pose, out: &mut Vec<Output>) {
        let dropped = std::mem::take(&mut self.map.objects).len();
        self.search_from(from);
        self.lost = None;
        self.tell(EventKind::BegunAnew { dropped }, out);
    }

    fn wait_for_word(&mut self, why: EventKind, out: &mut Vec<Output>) {
        self.lost = self.lost.map(|lost| Lost { waits: true, ..lost });
        self.tell(why, out);
    }

    fn lose(&mut self, about: About) {
        if let Some(before) = self.lost {
            self.tracker.forget(before.since);
        }
        let since = self.tracker.path().len();
        self.lost = Some(Lost { since, about, waits: false });
        self.network.break_off();
    }

    /// Whether it looks for its place since it doubts it.
    fn doubts(&self) -> bool {
        self.lost.is_some_and(|lost| lost.about.is_doubt())
    }

    /// Takes back what is not sure of what was done before the `relocation` began.
    fn take_back(&mut self, relocation: &Relocation, tour: &mut Tour, out: &mut Vec<Output>) {
        let mut told = Vec::new();
        tour.take_back(relocation.begun_us(), &mut self.map, &mut told);
        self.tell_all(told, out);
    }

    /// What the robot met cannot be where it believes it is: it looks for its place, from beside that.
    pub(super) fn go_astray(&mut self, tour: Box<Tour>, astray: Astray, out: &mut Vec<Output>) {
        self.tell(EventKind::Astray { at: self.tracker.pose().position }, out);
        let since = self.tracker.path().len();
        let about = if self.unfound == 0 { About::Doubted } else { About::Lost };
        self.lost = Some(Lost { since, about, waits: false });
        // The round that gave it away may have corrected the pose at its end.
        self.rest.pose = self.tracker.pose();
        let mut relocation = self.relocation(&tour);
        if let Some(beside) = astray.beside {
            relocation = relocation.beside(&self.settings, beside);
        }
        self.relocate(Box::new(relocation), tour, out);
    }

    pub(super) fn begin_relocating(&mut self, tour: Box<Tour>, out: &mut Vec<Output>) {
        let relocation = self.relocation(&tour);
        self.relocate(Box::new(relocation), tour, out);
    }

    pub(super) fn relocation(&self, tour: &Tour) -> Relocation {
        let about = self.lost.map_or(About::Nothing, |lost| lost.about);
        let chart = tour.chart();
        // What it mapped since its place was last sure may be where it is not.
        let until = if about.is_doubt() { tour.sure_us() } else { u64::MAX };
        let known = |object: &MappedObject| object.closed && object.seen_us().1 <= until;
        let all = self.map.objects.iter().zip(chart.objects());
        let objects: Vec<Ring> =
            all.filter(|(object, _)| known(object)).map(|(_, ring)| ring.clone()).collect();
        Relocation::new(&self.settings, chart.outline(), objects, &self.tracker, about)
    }

    pub(super) fn relocate(
        &mut self,
        mut relocation: Box<Relocation>,
        mut tour: Box<Tour>,
        out: &mut Vec<Output>,
    ) {
        let doubts = self.doubts();
        let mut told = Vec::new();
        let seek = relocation.next(&mut self.tracker, &self.rest, &mut told);
        self.rest.pose = self.tracker.pose();
        self.tell_all(told, out);
        match seek {
            Seek::Go(ask) => {
                self.task = Task::Relocate(relocation, tour);
                self.order(&ask, out);
            }
            Seek::Found(place) => {
                let driven = relocation.driven(&self.tracker);
                let was_elsewhere = self.was_elsewhere(relocation.from(), &place, &tour);
                let since = self.found(&place, &tour);
                if doubts {
                    self.tracker.lead_to(tour.sure_us(), since, &place.onto);
                    let mut told = Vec::new();
                    tour.settle_doubt(self.tracker.time_us(), &mut self.map, &mut told);
                    // For some time, and what it did meanwhile it did elsewhere.
                    if was_elsewhere {
                        tour.take_back(relocation.begun_us(), &mut self.map, &mut told);
                    }
                    self.tell_all(told, out);
                }
                tour.be_sure(self.tracker.time_us());
                self.unfound = 0;
                self.task = Task::Tour(tour);
                let at = self.tracker.pose().position;
                self.tell(EventKind::PlaceFound { at, driven }, out);
            }
            Seek::Unclear(_) if doubts && self.unfound + 1 < LOST => {
                self.unfound += 1;
                self.lost = None;
                self.task = Task::Tour(tour);
                self.tell(EventKind::StillAstray, out);
            }
            Seek::Unclear(places) => {
                if doubts {
                    self.take_back(&relocation, &mut tour, out);
                }
                self.task = Task::Tour(tour);
                self.wait_for_word(EventKind::PlaceUnclear { places }, out);
            }
        }
    }

    /// Whether a robot that was believed to be at `from`, and was at `place`, was farther off than its pose is
    /// unsure.
    fn was_elsewhere(&self, from: Pose, place: &Place, tour: &Tour) -> bool {
        let sd = tour.chart().looseness(&self.survey, from.position);
        is_elsewhere(&from, &place.of(from), (sd, self.survey.heading_sd()))
    }

    /// Takes the pose, and what was driven in a frame of its own, to the map; the place of the trajectory at
    /// which that begins.
    fn found(&mut self, place: &Place, tour: &Tour) -> usize {
        let Some(lost) = self.lost.take() else { return usize::MAX };
        self.tracker.carry(lost.since, &place.onto);
        let pose = self.tracker.pose();
        self.rest.pose = pose;
        self.rest.reason = DoneReason::Complete;
        // The scatter of one contact is told; neighbours err together, hence twice that.
        let sd = ((2.0 * place.sd.0).max(SUREST.0), (2.0 * place.sd.1).max(SUREST.1));
        if let Some(tie) = tour.chart().tie_at(&self.survey, pose.position) {
            self.survey.found(pose.position, &tie, sd);
        }
        lost.since
    }
}

/// Whether a robot that `was` there, and believed to be at `from`, known to `sd` (metres and radians), was farther off
/// or turned more than that explains. One that was pushed and turned may have come near by chance, and maps what it
/// meets at another bearing.
fn is_elsewhere(from: &Pose, was: &Pose, sd: (f64, f64)) -> bool {
    let off = (was.position - from.position).norm();
    let turned = angle::wrap(was.heading - from.heading).abs();
    off > (DEVIATIONS * sd.0).max(ASTRAY_BY) || turned > (DEVIATIONS * sd.1).max(ASTRAY_TURN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_is_elsewhere_that_is_farther_off_or_turned_more_than_its_pose_is_unsure() {
        let from = Pose::new(1.0, 2.0, 3.1);
        let is = |x: f64, turn: f64, sd| is_elsewhere(&from, &Pose::new(x, 2.0, 3.1 + turn), sd);
        let known = (0.02, 0.01);
        assert!(!is(1.08, 0.04, known) && !is(1.0, -0.04, known), "drift");
        assert!(is(1.15, 0.0, known), "pushed");
        assert!(is(1.02, 0.12, known) && is(1.02, -0.12, known), "turned, and near by chance");
        assert!(!is(1.15, 0.12, (0.06, 0.05)), "no more than it is unsure by");
    }
}
