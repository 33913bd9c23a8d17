//! What the operator may do about a lap that has closed: take it (and go on), drive another one that is
//! averaged in, or drop it and look for the boundary anew.

use super::{Mission, Outcome, Output, Task};
use crate::geometry::Pose;
use crate::mapping::chart::Chart;
use crate::mapping::event::{EventKind, Failure};
use crate::mapping::map::{Phase, RoomMap};
use crate::mapping::network::{Datum, Network, Offset};
use crate::mapping::retrace::{Along, Retrace};
use crate::mapping::search::Search;
use crate::mapping::settings::MOST_LAPS;
use crate::mapping::shape;

impl Mission {
    /// Whether a lap has closed and no line of the plan is driven yet.
    fn has_fresh_lap(&self) -> bool {
        let begun = matches!(&self.task, Task::Tour(tour) if tour.has_begun());
        let at_rest = !begun && !matches!(self.task, Task::Retrace(_) | Task::Relocate(..));
        self.map.closed && at_rest && self.outcome == Outcome::Going && self.lost.is_none()
    }

    /// Whether the laps so far can be dropped, and so another one be driven as well: one has closed and no line of
    /// the plan is driven, or the robot has paused on a lap more.
    #[must_use]
    pub fn laps_are_open(&self) -> bool {
        let going = self.outcome == Outcome::Going && self.lost.is_none();
        let again = matches!(self.task, Task::Retrace(_)) && going && !self.is_moving();
        again || self.has_fresh_lap()
    }

    /// One lap more: at once when one has closed, else as soon as it has. False when lines of the plan
    /// are driven already, nothing is, or there are as many laps as there may be.
    pub fn lap_again(&mut self, out: &mut Vec<Output>) -> bool {
        if self.settings.laps >= MOST_LAPS {
            return false;
        }
        if matches!(self.task, Task::Search(_) | Task::Retrace(_)) {
            self.settings.laps += 1;
            self.tell(EventKind::LapsWanted { laps: self.settings.laps }, out);
            return true;
        }
        if !self.has_fresh_lap() {
            return false;
        }
        self.settings.laps = self.map.laps + 1;
        self.map.plan = None;
        self.rejoin_beyond();
        self.phase = Phase::Boundary;
        self.tell(EventKind::PhaseBegan { phase: Phase::Boundary }, out);
        self.begin_retrace(out);
        true
    }

    /// What was seen behind straits is part of the lap again, in the order in which it was seen: without it a wall
    /// would be drawn across them.
    fn rejoin_beyond(&mut self) {
        let behind = std::mem::take(&mut self.map.beyond);
        let contacts = &mut self.map.contacts;
        // With the wall on the right the last of them comes first.
        let ends = contacts.first().zip(contacts.last());
        let turned = ends.is_some_and(|(first, last)| first.time > last.time);
        contacts.extend(behind.into_iter().flat_map(|beyond| beyond.contacts));
        contacts.sort_by(|a, b| a.time.total_cmp(&b.time));
        if turned {
            contacts.reverse();
        }
    }

    /// Drops the lap, and the objects that were met before it; the boundary is looked for anew from where
    /// the robot stands. False when there is none, or lines of the plan are driven already; on a further lap, while
    /// the robot moves.
    pub fn lap_anew(&mut self, out: &mut Vec<Output>) -> bool {
        if !self.laps_are_open() {
            return false;
        }
        self.phase = Phase::Boundary;
        let here = self.tracker.pose();
        let datum = self.map.accuracy.as_ref().and_then(|accuracy| accuracy.datum);
        // Without a shape nothing was adjusted yet, and the survey knows.
        let by_survey = || {
            // It knows the worse of two directions; both are no worse than that.
            let shift = self.survey.position_sd() * f64::sqrt(2.0);
            let off = Offset { turn: self.survey.heading_sd(), shift };
            self.begun_off.map_or(off, |before| before.and(off))
        };
        let off = datum.as_ref().map_or_else(by_survey, Datum::offset);
        let doubted = std::mem::take(&mut self.map.doubted);
        let dropped = self.map.objects.len();
        self.map = RoomMap { doubted, ..RoomMap::default() };
        self.search_from(here);
        self.begun_off = Some(off);
        self.tell(EventKind::PhaseBegan { phase: Phase::Boundary }, out);
        self.tell(EventKind::BegunAnew { dropped }, out);
        true
    }

    /// Looks for the boundary anew from `here`, as if the run began there: of the laps, those count that were asked
    /// for before it.
    pub(super) fn search_from(&mut self, here: Pose) {
        self.tracker.begin_anew(here);
        self.network = Network::new(here);
        self.begun_off = None;
        (self.laps, self.settings.laps) = (0, self.laps_asked);
        self.task = Task::Search(Box::new(Search::new(&self.settings, here)));
    }

    /// Drives the next lap that is wanted, or goes on to the shape.
    pub(super) fn next_lap(&mut self, out: &mut Vec<Output>) {
        if self.map.laps < self.settings.laps {
            self.begin_retrace(out);
        } else {
            self.end_boundary(out);
        }
    }

    pub(super) fn end_boundary(&mut self, out: &mut Vec<Output>) {
        self.tell(EventKind::PhaseEnded { phase: Phase::Boundary }, out);
        self.phase = Phase::Shape;
        self.tell(EventKind::PhaseBegan { phase: Phase::Shape }, out);
        self.task = Task::Shape;
    }

    fn begin_retrace(&mut self, out: &mut Vec<Output>) {
        let outline = match self.fitted_outline() {
            Ok(outline) => outline,
            Err(why) => return self.cut_lap(why, out),
        };
        let Some(beside) = &self.beside else { return self.end_boundary(out) };
        let so_far = RoomMap {
            contacts: self.map.contacts.clone(),
            objects: self.map.objects.clone(),
            shape: Some(shape::identify(outline, &self.map.contacts)),
            ..RoomMap::default()
        };
        let chart = Chart::new(&so_far, &self.survey);
        let retrace = Retrace::new(&self.settings.chassis, beside, chart, &self.tracker);
        self.tell(EventKind::LapAgain { lap: self.map.laps + 1 }, out);
        self.task = Task::Retrace(Box::new(retrace));
    }

    /// No more laps, because of `why`.
    fn cut_lap(&mut self, why: Failure, out: &mut Vec<Output>) {
        self.settings.laps = self.map.laps;
        self.tell(EventKind::LapCut { why }, out);
        self.end_boundary(out);
    }

    pub(super) fn retrace(&mut self, mut retrace: Box<Retrace>, out: &mut Vec<Output>) {
        match retrace.next(&self.tracker, &self.rest) {
            Along::Go(ask) => {
                self.task = Task::Retrace(retrace);
                self.order(&ask, out);
            }
            Along::Round => {
                self.average(*retrace, out);
                self.next_lap(out);
            }
            // What was touched until then is as good as ever.
            Along::Held => {
                self.average(*retrace, out);
                self.cut_lap(Failure::Boxed, out);
            }
        }
    }

    /// Moves what is mapped to where the survey believes it after the lap.
    fn average(&mut self, mut retrace: Retrace, out: &mut Vec<Output>) {
        let before = self.tracker.pose();
        let beside = retrace.beside();
        let begun_us = retrace.begun_us();
        let moved = retrace.moved(&self.survey);
        self.place_contacts();
        self.settle(begun_us);
        self.beside = Some(beside.moved(&before, &self.tracker.pose()));
        self.map.laps += 1;
        let (lap, touches) = (self.map.laps, retrace.touches());
        self.tell(EventKind::LapAveraged { lap, touches, moved }, out);
    }
}
