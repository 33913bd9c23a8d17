//! The whole run as one state machine: telemetry in, one command at a time and events out.
//!
//! [`Mission::telemetry`] takes what the robot says and only learns from it; [`Mission::proceed`]
//! decides what comes next, and is called when the robot is at rest and the session allows it. The
//! phases follow one another as the paper's section III does; Shape and Plan need no motion, so
//! one call each is all of them. No clock, no I/O, no error: odd input becomes an event.

use super::adjust::{Adjustment, Overlap};
use super::circuit::Closure;
use super::event::{Event, EventKind, Failure};
use super::follow::{Ask, AtRest};
use super::map::{Contact, MappedObject, Phase, RoomMap};
use super::odometry::Tracker;
use super::plan::{self, PlanRequest};
use super::search::{Next, Search, lap_contacts};
use super::settings::Settings;
use super::shape;
use super::smooth::smooth;
use super::survey::{Step, Survey};
use super::tour::{Scene, Tour};
use super::wall::Wall;
use crate::geometry::{Point, Pose, Ring};
use crate::robot::{Command, CommandId, DoneReason, Motion, Odometer, SwitchSet, Telemetry};

/// What the wheels add on the tour, where one move may be metres long, metres per root metre.
const WHEEL_SD: f64 = 0.008;

/// Wheels that turn by more than this where the gyro goes straight do not tell the truth, radians per
/// metre: wheels 5 % apart on the default chassis. Worn ones are within half of that.
const LOPSIDED: f64 = 0.31;

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
    Shape,
    Plan,
    Tour(Box<Tour>),
    Over,
}

/// A motion that was sent and has not ended.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Awaited {
    id: CommandId,
    turning: bool,
}

/// A run.
#[derive(Debug, Clone)]
pub struct Mission {
    settings: Settings,
    tracker: Tracker,
    survey: Survey,
    map: RoomMap,
    phase: Phase,
    task: Task,
    outcome: Outcome,
    rest: AtRest,
    closed: SwitchSet,
    bumper: bool,
    bumps: u32,
    next_id: u32,
    awaited: Option<Awaited>,
    began: bool,
    laps: u32,
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
            tracker,
            map: RoomMap::default(),
            phase: Phase::Boundary,
            task: Task::Search(Box::new(Search::new(&settings))),
            outcome: Outcome::Going,
            rest,
            closed: SwitchSet::EMPTY,
            bumper: false,
            bumps: 0,
            next_id: 0,
            awaited: None,
            began: false,
            laps: 0,
            settings,
        }
    }

    /// Whether the robot is at rest and [`Mission::proceed`] may be called.
    #[must_use]
    pub fn is_ready(&self) -> bool {
        self.awaited.is_none() && self.outcome == Outcome::Going
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
        match self.phase {
            Phase::Objects => self.survey.position_sd(),
            _ => 0.005 + 0.004 * self.tracker.travelled(),
        }
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

    /// Bumper contacts so far.
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
        map.path = self.tracker.path().to_vec();
        if !map.closed {
            map.contacts = self.live_contacts();
        }
        map
    }

    /// The contacts of the lap or round that is under way, as they were seen.
    #[must_use]
    pub fn live_contacts(&self) -> Vec<Contact> {
        let wall = match &self.task {
            Task::Search(search) => Some(search.wall()),
            Task::Tour(tour) => Some(tour.wall()),
            Task::Shape | Task::Plan | Task::Over => None,
        };
        wall.map_or_else(Vec::new, |wall| {
            wall.log()
                .iter()
                .filter(|seen| seen.alive)
                .map(super::wall::Sighting::contact)
                .collect()
        })
    }

    /// How much of the phase is done, 0 to 1, where it can be told.
    #[must_use]
    pub fn share(&self) -> Option<f64> {
        match &self.task {
            Task::Search(search) => {
                search.circuit().and_then(super::circuit::Circuit::closure).map(|_| 0.95)
            }
            Task::Tour(tour) => Some(tour.share()),
            Task::Shape | Task::Plan => Some(0.0),
            Task::Over => Some(1.0),
        }
    }

    /// Uses another α. The plan is made anew if there is one and none of it is driven yet; with
    /// lines driven it stays as it is, and false comes back.
    pub fn set_alpha(&mut self, alpha: f64, out: &mut Vec<Output>) -> bool {
        let begun = matches!(&self.task, Task::Tour(tour) if tour.has_begun());
        if begun || self.outcome != Outcome::Going {
            return false;
        }
        self.settings.alpha = alpha;
        self.tell(EventKind::AlphaSet { alpha }, out);
        if self.map.plan.is_some() {
            self.make_plan(out);
            self.task = Task::Tour(Box::new(Tour::new(&self.settings, &self.map, &self.survey)));
        }
        true
    }

    /// The operator ends the run.
    pub fn finish(&mut self, out: &mut Vec<Output>) {
        if self.outcome == Outcome::Going {
            self.fail(Failure::Ended, out);
        }
    }

    fn wall_mut(&mut self) -> Option<&mut Wall> {
        match &mut self.task {
            Task::Search(search) => Some(search.wall_mut()),
            Task::Tour(tour) => Some(tour.wall_mut()),
            Task::Shape | Task::Plan | Task::Over => None,
        }
    }

    /// Takes one message of the robot.
    pub fn telemetry(&mut self, input: &Telemetry, out: &mut Vec<Output>) {
        match input {
            Telemetry::Report { odometer, switches, bumper } => {
                self.odometer(odometer);
                self.closed = *switches;
                self.bumper = *bumper;
            }
            Telemetry::Edge(edge) => {
                let pose = self.odometer(&edge.odometer);
                let turning = self.awaited.is_none_or(|awaited| awaited.turning);
                let travelled = self.tracker.travelled();
                let seen = self.wall_mut().map(|wall| wall.observe(edge, pose, turning, travelled));
                self.closed = self.closed.with(edge.sensor, edge.rising);
                if let (Task::Tour(tour), Some(seen)) = (&mut self.task, seen)
                    && let Some(fixed) = tour.fix(&mut self.survey, pose, &seen)
                {
                    self.tracker.correct(fixed);
                }
            }
            Telemetry::Done { id, reason, odometer, switches, bumper } => {
                let pose = self.odometer(odometer);
                self.closed = *switches;
                self.bumper = *bumper;
                if self.awaited.is_some_and(|awaited| awaited.id == *id) {
                    self.awaited = None;
                    self.came_to_rest(pose, *reason, odometer.time_us, out);
                }
            }
        }
    }

    fn came_to_rest(
        &mut self,
        pose: Pose,
        reason: DoneReason,
        time_us: u64,
        out: &mut Vec<Output>,
    ) {
        self.rest = AtRest { pose, closed: self.closed, reason };
        match reason {
            DoneReason::Bumper | DoneReason::Stalled => {
                self.bumps += 1;
                let travelled = self.tracker.travelled();
                if let Some(wall) = self.wall_mut() {
                    wall.touch(pose, 0.0, travelled, time_us);
                }
                self.tell(EventKind::Bumped, out);
            }
            DoneReason::TimeLimit | DoneReason::HostSilent => {
                self.tell(EventKind::Odd { reason }, out);
            }
            DoneReason::Complete | DoneReason::Guard { .. } | DoneReason::Stopped => {}
        }
    }

    fn odometer(&mut self, odometer: &Odometer) -> Pose {
        let (before, time) = (self.tracker.pose(), self.tracker.time_us());
        let rested = self.tracker.rested_us();
        let spun = self.tracker.spun();
        let pose = self.tracker.advance(odometer, self.phase);
        let rested = self.tracker.rested_us() - rested;
        if let Some((seconds, rate)) = self.tracker.take_drift() {
            self.survey.rest(seconds, rate);
            self.tracker.set_bias(self.tracker.bias() - self.survey.take_bias());
        }
        if self.phase == Phase::Objects {
            let passed = odometer.time_us.saturating_sub(time).saturating_sub(rested);
            let step = Step {
                from: before,
                to: pose,
                seconds: passed as f64 * 1e-6,
                spun: (spun, self.tracker.spun()),
            };
            self.survey.predict(&step, WHEEL_SD);
        }
        let (travelled, closed) = (self.tracker.travelled(), self.closed);
        if let Some(wall) = self.wall_mut() {
            wall.carve(pose, closed, travelled);
        }
        pose
    }

    fn tell(&mut self, kind: EventKind, out: &mut Vec<Output>) {
        out.push(Output::Event(Event { time_us: self.tracker.time_us(), kind }));
    }

    fn fail(&mut self, why: Failure, out: &mut Vec<Output>) {
        self.outcome = Outcome::Failed(why);
        self.tell(EventKind::Failed { why }, out);
    }

    fn order(&mut self, ask: &Ask, out: &mut Vec<Output>) {
        let chassis = &self.settings.chassis;
        let (motion, seconds) = match ask.motion {
            Motion::Move { distance, speed } => {
                let speed = speed.min(chassis.speed);
                (Motion::Move { distance, speed }, distance.abs() / speed)
            }
            Motion::Turn { angle, rate } => {
                let rate = rate.min(chassis.turn_rate);
                (Motion::Turn { angle, rate }, angle.abs() / rate)
            }
            Motion::Rest => (Motion::Rest, 1.0),
        };
        self.next_id += 1;
        let command = Command {
            id: CommandId(self.next_id),
            motion,
            guard: ask.guard,
            time_limit: seconds * 1.5 + 2.0,
        };
        let turning = matches!(motion, Motion::Turn { .. });
        self.awaited = Some(Awaited { id: command.id, turning });
        out.push(Output::Command(command, ask.why));
    }

    /// Decides what comes next: sends one command, or does a phase that needs none.
    pub fn proceed(&mut self, out: &mut Vec<Output>) {
        if !self.is_ready() {
            return;
        }
        if !self.began {
            self.began = true;
            self.tell(EventKind::PhaseBegan { phase: Phase::Boundary }, out);
        }
        match std::mem::replace(&mut self.task, Task::Over) {
            Task::Search(search) => self.search(search, out),
            Task::Shape => self.shape(out),
            Task::Plan => {
                self.make_plan(out);
                self.tell(EventKind::PhaseEnded { phase: Phase::Plan }, out);
                self.phase = Phase::Objects;
                self.tell(EventKind::PhaseBegan { phase: Phase::Objects }, out);
                self.task =
                    Task::Tour(Box::new(Tour::new(&self.settings, &self.map, &self.survey)));
            }
            Task::Tour(tour) => self.tour(tour, out),
            Task::Over => {}
        }
    }

    fn search(&mut self, mut search: Box<Search>, out: &mut Vec<Output>) {
        let mut told = Vec::new();
        let next = search.next(&self.tracker, &self.rest, &mut self.map, &mut told);
        self.laps = search.laps();
        for kind in told {
            self.tell(kind, out);
        }
        match next {
            Next::Go(ask) => {
                self.task = Task::Search(search);
                self.order(&ask, out);
            }
            Next::Found(closure, overlap) => {
                self.close_boundary(search.wall(), &closure, &overlap);
                if self.survey.lopsided().abs() > LOPSIDED {
                    return self.fail(Failure::WheelsLie, out);
                }
                self.tell(EventKind::PhaseEnded { phase: Phase::Boundary }, out);
                self.phase = Phase::Shape;
                self.tell(EventKind::PhaseBegan { phase: Phase::Shape }, out);
                self.task = Task::Shape;
            }
            Next::Failed(why) => {
                self.map.contacts = search
                    .wall()
                    .log()
                    .iter()
                    .filter(|seen| seen.alive)
                    .map(super::wall::Sighting::contact)
                    .collect();
                self.fail(why, out);
            }
        }
    }

    /// Takes the misclosure out of the lap, its contacts, the trajectory and the pose, and learns
    /// the gyro's drift from it.
    fn close_boundary(&mut self, wall: &Wall, closure: &Closure, overlap: &Overlap) {
        let adjustment = Adjustment::new(&self.tracker, closure, overlap, 0);
        self.map.contacts = lap_contacts(wall, closure, &adjustment);
        self.map.closed = true;
        self.map.misclosure = Some(overlap.misclosure);
        self.survey = adjustment.into_survey();
        self.settle();
    }

    /// Moves what was mapped before, the trajectory and the pose to where the survey believes them,
    /// and goes on from there.
    fn settle(&mut self) {
        let survey = &mut self.survey;
        let knots = survey.knots();
        for object in &mut self.map.objects {
            let begin = object.contacts.first().map_or(0, Contact::time_us);
            let tie = survey.tie(begin, knots);
            object.displace(|p| survey.displacement(p, &tie));
        }
        for point in self.tracker.path_mut() {
            let tie = survey.tie(point.time_us, knots);
            point.pose = survey.place(point.pose, &tie);
        }
        let now = survey.take_pose(self.tracker.pose());
        self.tracker.settle(now);
        self.rest.pose = now;
        self.tracker.set_bias(self.tracker.bias() - survey.take_bias());
        survey.rebase();
    }

    /// Lets the smooth walls of `outline` straighten the lap; true when there are any.
    fn straighten(&mut self, outline: &Ring) -> bool {
        let knots = self.survey.knots();
        if !smooth(&mut self.survey, knots, outline, &self.map.contacts) {
            return false;
        }
        for contact in &mut self.map.contacts {
            let tie = self.survey.tie(contact.time_us(), knots);
            contact.point += self.survey.displacement(contact.point, &tie);
            contact.from += self.survey.displacement(contact.from, &tie);
        }
        self.settle();
        true
    }

    fn shape(&mut self, out: &mut Vec<Output>) {
        let reach = self.settings.chassis.reach();
        let fitted = shape::outline(&self.map.contacts, reach).and_then(|outline| {
            if self.straighten(&outline) {
                shape::outline(&self.map.contacts, reach)
            } else {
                Ok(outline)
            }
        });
        let outline = match fitted {
            Ok(outline) => outline,
            Err(why) => return self.fail(why, out),
        };
        let outline = self.set_apart(outline, out);
        let shape = shape::identify(outline, &self.map.contacts);
        let (class, vertices, parts) = (shape.class, shape.vertices.len(), shape.parts.len());
        self.map.shape = Some(shape);
        self.tell(EventKind::ShapeFound { class, vertices, parts }, out);
        self.tell(EventKind::PhaseEnded { phase: Phase::Shape }, out);
        self.phase = Phase::Plan;
        self.tell(EventKind::PhaseBegan { phase: Phase::Plan }, out);
        self.task = Task::Plan;
    }

    /// Makes objects of what only gaps too narrow to pass join to the outline; what remains of it.
    fn set_apart(&mut self, outline: Ring, out: &mut Vec<Output>) -> Ring {
        let gap = self.settings.chassis.passable_gap();
        let (rest, islands) = shape::islands(outline, &self.map.contacts, gap);
        for ring in islands {
            let id = self.map.objects.len() as u32 + 1;
            let all = std::mem::take(&mut self.map.contacts);
            let (contacts, walls) =
                all.into_iter().partition(|c| ring.distance(c.point) < rest.distance(c.point));
            self.map.contacts = walls;
            let class = shape::class_of(&ring);
            let object = MappedObject { id, class, outline: ring, closed: true, contacts };
            self.map.objects.push(object);
            self.tell(EventKind::ObjectApart { id }, out);
        }
        rest
    }

    fn make_plan(&mut self, out: &mut Vec<Output>) {
        let Some(shape) = &self.map.shape else { return };
        let driven: Vec<Point> = self.tracker.path().iter().map(|p| p.pose.position).collect();
        let plan = plan::make(&PlanRequest {
            shape,
            objects: &self.map.objects,
            driven: &driven,
            from: self.tracker.pose().position,
            settings: &self.settings,
        });
        let figures = plan.figures;
        self.map.plan = Some(plan);
        let (lines, length, hidden_disc) = (figures.lines, figures.length, figures.hidden_disc);
        self.tell(EventKind::PlanMade { lines, length, hidden_disc }, out);
    }

    fn tour(&mut self, mut tour: Box<Tour>, out: &mut Vec<Output>) {
        let mut told = Vec::new();
        let next = tour.next(&mut Scene {
            tracker: &mut self.tracker,
            survey: &mut self.survey,
            rest: self.rest,
            map: &mut self.map,
            tell: &mut told,
        });
        for kind in told {
            self.tell(kind, out);
        }
        if let Some(ask) = next {
            self.task = Task::Tour(tour);
            self.order(&ask, out);
        } else {
            tour.publish(&self.survey, &mut self.map);
            self.refine();
            self.tell(EventKind::PhaseEnded { phase: Phase::Objects }, out);
            self.outcome = Outcome::Complete;
            self.tell(EventKind::Complete, out);
        }
    }

    /// Fits the outline once more, to contacts that all the touches of the tour have put right. What
    /// that makes more ragged than it was is left as it was, only moved.
    fn refine(&mut self) {
        let reach = self.settings.chassis.reach();
        let pieces = self.map.shape.as_ref().map_or(0, |shape| shape.outline.pieces.len());
        if let Ok(outline) = shape::outline(&self.map.contacts, reach)
            && outline.pieces.len() <= pieces
        {
            self.map.shape = Some(shape::identify(outline, &self.map.contacts));
        }
    }
}
