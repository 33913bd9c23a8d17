//! The whole run as one state machine: telemetry in, one command at a time and events out.
//!
//! [`Mission::telemetry`] takes what the robot says and only learns from it; [`Mission::proceed`]
//! decides what comes next, and is called when the robot is at rest and the session allows it. The
//! phases follow one another as the paper's section III does; Shape and Plan need no motion, so
//! one call each is all of them. No clock, no I/O, no error: odd input becomes an event.

mod again;
mod apart;
mod broken;
mod hearing;
mod idle;
mod phases;
mod place;
mod planned;
mod taping;
mod whole;
mod wishes;

use super::event::{Event, EventKind, Failure};
use super::follow::{Ask, AtRest};
use super::map::{Contact, Phase, RoomMap};
use super::network::{Network, Offset};
use super::odometry::Tracker;
use super::relocate::{About, Relocation};
use super::retrace::{Beside, Retrace};
use super::search::Search;
use super::settings::Settings;
use super::survey::Survey;
use super::tour::Tour;
use super::trust::Trust;
use super::wall::{Stroke, Turning, Wall};
use crate::robot::{Command, CommandId, DoneReason, Guard, Motion, SwitchSet};
use idle::Idle;
use planned::PlannedOn;

/// What the core wants done or told.
#[derive(Debug, Clone, PartialEq)]
pub enum Output {
    /// Send this to the robot; with the reason, for the operator.
    Command(Command, &'static str),
    /// Something happened.
    Event(Event),
}

/// How a run stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// There is more to do.
    Going,
    /// Everything is done.
    Complete,
    /// It ended short of its goal.
    Failed(Failure),
}

/// What the run is busy with; the data of each phase lives in its variant.
#[derive(Debug, Clone)]
enum Task {
    Search(Box<Search>),
    /// The lap is driven again, to be averaged in.
    Retrace(Box<Retrace>),
    Shape,
    Plan,
    Tour(Box<Tour>),
    /// The robot was carried off from its tour, or doubts its place on it, and looks for it.
    Relocate(Box<Relocation>, Box<Tour>),
    Over,
}

/// A robot that does not know where it is: its pose is in a frame of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Lost {
    /// Place of the trajectory from which on that is so.
    since: usize,
    /// What is known about where it is.
    about: About,
    /// Nothing more can be done without the operator's word.
    waits: bool,
}

/// A motion that was sent and has not ended.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Awaited {
    id: CommandId,
    turning: Turning,
}

/// A run.
#[derive(Debug, Clone)]
pub struct Mission {
    settings: Settings,
    tracker: Tracker,
    survey: Survey,
    network: Network,
    map: RoomMap,
    phase: Phase,
    task: Task,
    outcome: Outcome,
    rest: AtRest,
    /// What the switches say, and what of it is believed.
    raw: SwitchSet,
    closed: SwitchSet,
    bumper: bool,
    bumps: u32,
    next_id: u32,
    awaited: Option<Awaited>,
    idle: Idle,
    began: bool,
    laps: u32,
    /// Laps that were asked for before the run.
    laps_asked: u32,
    lost: Option<Lost>,
    /// How often it doubted its place and did not find it, since it found it last: walls that lie where they have
    /// to in between do not begin the count anew, since a robot that doubts again was somewhere else all the same.
    unfound: u32,
    /// The way of the first lap, as its contacts are believed.
    way: Vec<Stroke>,
    /// What the lap that closed last ended beside.
    beside: Option<Beside>,
    trust: Trust,
    /// What is under way rests on a switch that chatters: it is begun again.
    afresh: bool,
    /// How often the tour went on after all was adjusted: once at most.
    went_on: u32,
    /// What the place is off by at which the lap was begun anew; none where it is the start, or the operator's word.
    begun_off: Option<Offset>,
    /// What the plan was made on.
    planned_on: PlannedOn,
}

impl Mission {
    /// A run with `settings`; the robot stands at `settings.start`.
    #[must_use]
    pub fn new(settings: Settings) -> Self {
        let rest =
            AtRest { pose: settings.start, closed: SwitchSet::EMPTY, reason: DoneReason::Complete };
        let tracker = Tracker::new(&settings.chassis, settings.start);
        Self {
            survey: Survey::new(tracker.resolution()),
            network: Network::new(settings.start),
            tracker,
            map: RoomMap::default(),
            phase: Phase::Boundary,
            task: Task::Search(Box::new(Search::new(&settings, settings.start))),
            outcome: Outcome::Going,
            rest,
            raw: SwitchSet::EMPTY,
            closed: SwitchSet::EMPTY,
            bumper: false,
            bumps: 0,
            next_id: 0,
            awaited: None,
            idle: Idle::default(),
            began: false,
            laps: 0,
            laps_asked: settings.laps,
            lost: None,
            unfound: 0,
            way: Vec::new(),
            beside: None,
            trust: Trust::new(&settings.chassis, settings.start.position),
            afresh: false,
            went_on: 0,
            begun_off: None,
            planned_on: PlannedOn::default(),
            settings,
        }
    }

    /// Whether the robot is at rest and [`Mission::proceed`] may be called.
    #[must_use]
    pub fn is_ready(&self) -> bool {
        self.awaited.is_none() && self.outcome == Outcome::Going && !self.waits_for_place()
    }

    /// Whether the robot's place is not known at present.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.lost.is_some()
    }

    /// Whether it cannot find its place without the operator's word.
    #[must_use]
    pub fn waits_for_place(&self) -> bool {
        self.lost.is_some_and(|lost| lost.waits)
    }

    /// How the run stands.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        self.outcome
    }

    /// Which phase the run is in.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// What the run was started with, α as it is now.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Where the robot is believed to be, and how it got there.
    #[must_use]
    pub fn tracker(&self) -> &Tracker {
        &self.tracker
    }

    /// One standard deviation of the position, metres.
    #[must_use]
    pub fn position_sd(&self) -> f64 {
        if self.map.closed {
            self.survey.position_sd()
        } else {
            0.005 + 0.004 * self.tracker.travelled()
        }
    }

    /// Whether the survey follows the robot: there are walls to touch.
    fn is_surveying(&self) -> bool {
        self.phase == Phase::Objects || matches!(self.task, Task::Retrace(_))
    }

    /// Which switches are closed, and whether the bumper is pressed.
    #[must_use]
    pub fn switches(&self) -> (SwitchSet, bool) {
        (self.closed, self.bumper)
    }

    /// Whether a motion is under way.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.awaited.is_some()
    }

    /// The command whose end is waited for.
    #[must_use]
    pub fn awaited(&self) -> Option<CommandId> {
        self.awaited.map(|awaited| awaited.id)
    }

    /// Motions so far that ended because the bumper was pressed or the robot stalled. It is what a host
    /// hears of any robot: a touch in passing, in a turn say, that ends no motion is none.
    #[must_use]
    pub fn bumps(&self) -> u32 {
        self.bumps
    }

    /// Laps closed so far in the Boundary phase.
    #[must_use]
    pub fn laps(&self) -> u32 {
        self.laps
    }

    /// The map without the trajectory, which the tracker holds.
    #[must_use]
    pub fn map(&self) -> &RoomMap {
        &self.map
    }

    /// A copy of the map with the trajectory and, while a lap is under way, its raw contacts.
    #[must_use]
    pub fn map_now(&self) -> RoomMap {
        let mut map = self.map.clone();
        let known = self.lost.map_or(usize::MAX, |lost| lost.since);
        map.path = self.tracker.path().iter().take(known).copied().collect();
        // Of a lap that was given up the map has them.
        if !map.closed && !matches!(self.task, Task::Over) {
            map.contacts = self.live_contacts();
        }
        if self.settings.square { map.squared() } else { map }
    }

    /// The contacts of the lap or round that is under way, as they were seen.
    #[must_use]
    pub fn live_contacts(&self) -> Vec<Contact> {
        let wall = match &self.task {
            Task::Search(search) => Some(search.wall()),
            Task::Tour(tour) => Some(tour.wall()),
            Task::Retrace(retrace) => Some(&retrace.wall),
            Task::Relocate(..) | Task::Shape | Task::Plan | Task::Over => None,
        };
        wall.map_or_else(Vec::new, Wall::contacts)
    }

    /// How much of the phase is done, 0 to 1, where it can be told.
    #[must_use]
    pub fn share(&self) -> Option<f64> {
        match &self.task {
            Task::Search(search) => {
                let closed = super::circuit::Circuit::looks_closed;
                search.circuit().is_some_and(closed).then_some(0.95)
            }
            Task::Retrace(retrace) => Some(retrace.share(&self.tracker)),
            Task::Tour(tour) | Task::Relocate(_, tour) => Some(tour.share()),
            Task::Shape | Task::Plan => Some(0.0),
            Task::Over => (self.outcome == Outcome::Complete).then_some(1.0),
        }
    }

    fn wall_mut(&mut self) -> Option<&mut Wall> {
        match &mut self.task {
            Task::Search(search) => Some(search.wall_mut()),
            Task::Retrace(retrace) => Some(&mut retrace.wall),
            Task::Tour(tour) => Some(tour.wall_mut()),
            Task::Relocate(relocation, _) => Some(relocation.wall_mut()),
            Task::Shape | Task::Plan | Task::Over => None,
        }
    }

    fn tell(&mut self, kind: EventKind, out: &mut Vec<Output>) {
        out.push(Output::Event(Event { time_us: self.tracker.time_us(), kind }));
    }

    fn tell_all(&mut self, kinds: Vec<EventKind>, out: &mut Vec<Output>) {
        for kind in kinds {
            self.tell(kind, out);
        }
    }

    fn fail(&mut self, why: Failure, out: &mut Vec<Output>) {
        self.outcome = Outcome::Failed(why);
        self.tell(EventKind::Failed { why }, out);
    }

    fn order(&mut self, ask: &Ask, out: &mut Vec<Output>) {
        let chassis = &self.settings.chassis;
        let (motion, seconds) = match ask.motion {
            Motion::Move { distance, speed } => {
                let speed = speed.min(chassis.cruise());
                // In the robot's own metres.
                let distance = distance / self.tracker.stretched();
                (Motion::Move { distance, speed }, distance.abs() / speed)
            }
            Motion::Turn { angle, rate } => {
                let rate = rate.min(chassis.turn_rate);
                (Motion::Turn { angle, rate }, angle.abs() / rate)
            }
            Motion::Rest => (Motion::Rest, 1.0),
        };
        self.next_id += 1;
        let guard = Guard {
            rise: self.trust.believed(ask.guard.rise),
            fall: self.trust.believed(ask.guard.fall),
        };
        let command =
            Command { id: CommandId(self.next_id), motion, guard, time_limit: seconds * 1.5 + 2.0 };
        let turning = match motion {
            Motion::Turn { angle, .. } => Turning::By(angle.signum()),
            Motion::Move { .. } | Motion::Rest => Turning::No,
        };
        self.awaited = Some(Awaited { id: command.id, turning });
        self.idle.asked(motion, self.tracker.reading());
        out.push(Output::Command(command, ask.why));
    }

    /// Forgets what a switch that chatters made of the way in hand; what is mapped stays.
    fn begin_afresh(&mut self) {
        self.rest = AtRest { closed: self.closed, reason: DoneReason::Complete, ..self.rest };
        self.task = match std::mem::replace(&mut self.task, Task::Over) {
            Task::Search(_) => Task::Search(Box::new(Search::new(&self.settings, self.rest.pose))),
            Task::Tour(mut tour) => {
                tour.interrupt(&mut self.map);
                Task::Tour(tour)
            }
            Task::Relocate(_, tour) => Task::Relocate(Box::new(self.relocation(&tour)), tour),
            task @ (Task::Retrace(_) | Task::Shape | Task::Plan | Task::Over) => task,
        };
    }

    /// Decides what comes next: sends one command, or does a phase that needs none.
    pub fn proceed(&mut self, out: &mut Vec<Output>) {
        if !self.is_ready() {
            return;
        }
        if !self.began {
            self.began = true;
            self.tell(EventKind::PhaseBegan { phase: Phase::Boundary }, out);
            if let Some(slower) = EventKind::slower(&self.settings.chassis) {
                self.tell(slower, out);
            }
        }
        if let Some(why) = self.broken() {
            return self.fail(why, out);
        }
        // No command can follow from a place that is none.
        let pose = self.tracker.pose();
        if !(pose.position.x + pose.position.y + pose.heading).is_finite() {
            return self.fail(Failure::Internal, out);
        }
        if std::mem::take(&mut self.afresh) {
            self.begin_afresh();
        }
        match std::mem::replace(&mut self.task, Task::Over) {
            Task::Search(search) => self.search(search, out),
            Task::Retrace(retrace) => self.retrace(retrace, out),
            Task::Shape => self.shape(out),
            Task::Plan => {
                self.make_plan(out);
                self.tell(EventKind::PhaseEnded { phase: Phase::Plan }, out);
                self.phase = Phase::Objects;
                self.tell(EventKind::PhaseBegan { phase: Phase::Objects }, out);
                self.task =
                    Task::Tour(Box::new(Tour::new(&self.settings, &self.map, &self.survey)));
            }
            Task::Tour(tour) if self.lost.is_some() => self.begin_relocating(tour, out),
            Task::Tour(tour) => self.tour(tour, out),
            Task::Relocate(relocation, tour) => self.relocate(relocation, tour, out),
            Task::Over => {}
        }
    }
}
