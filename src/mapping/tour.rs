//! The Objects phase (paper III.F): drive the plan, go round whatever is met.
//!
//! A line is driven in the pieces that the known objects leave free, with ways round between them.
//! What is met is one of three things: near the boundary, and the robot carries on; a known
//! object, and it goes round to the line again; an unknown one, which is gone round and recorded.
//! What cannot be where it is met makes the robot doubt its own place instead (`doubt`).
//! Every touch of something mapped corrects the pose, but for a turn about the middle of a round room (`round_room`).
//! When all lines are driven, what they could not sweep is looked for and visited, until the hidden disc is down to α
//! or nothing more helps. Then come the ties: objects that are not known well enough are measured from what they
//! stand beside. Last, what is twice on the map is taken away, and the floor that it stood on is driven.

mod bearings;
mod doubt;
mod drive;
mod extra;
mod leave;
mod line;
mod no_passage;
mod passes;
mod recognise;
mod round_room;
mod rounds;
mod sureness;
#[cfg(test)]
mod testing;
mod ties;

use super::chart::Chart;
use super::event::EventKind;
use super::floor::{Coverage, Floor};
use super::follow::{Ask, AtRest};
use super::map::{LineReason, LineStatus, PlanLine, RoomMap};
use super::odometry::Tracker;
use super::retreat::Retreat;
use super::settings::{Contour, Settings};
use super::survey::Survey;
use super::wall::{Sighting, Wall};
use crate::geometry::{Point, Pose, Ring, Vector, angle};
use crate::robot::{Chassis, SwitchSet};
use bearings::Feeling;
pub use doubt::Astray;
use doubt::Doubt;
use drive::Drive;
use line::Stops;
use passes::{Half, Pass};
use rounds::Round;
use std::collections::{BTreeMap, VecDeque};
use sureness::Sureness;
use ties::Shuttle;

/// The centre keeps this beyond the body's radius from everything on a way, metres.
const ROOM: f64 = 0.03;
/// A way point counts as reached within this, metres.
const REACHED: f64 = 0.008;
/// Bumps on one line before it is given up.
const MOST_BUMPS: u32 = 3;
/// A line on which this many decisions in a row lead to no motion is given up.
const MOST_UNDECIDED: u32 = 200;
/// A line on which so many rounds stayed open is given up.
const MOST_LEFT_OPEN: u32 = 2;
/// Where the robot was shut in before, metres around, it is not led out once more.
const LED_OUT: f64 = 0.1;

#[derive(Debug, Clone)]
enum Doing {
    Choosing,
    Driving(Box<Drive>),
    BackingOff(Box<Drive>),
    Rounding(Round),
    Feeling(Feeling),
    Tying(Shuttle),
    Retreating(Retreat),
    Passing(Pass),
}

/// What a decision of the tour looks at and writes to.
#[derive(Debug)]
pub struct Scene<'a> {
    /// Where the robot believes it is.
    pub tracker: &'a mut Tracker,
    /// How the walls lie to each other.
    pub survey: &'a mut Survey,
    /// How the robot came to rest.
    pub rest: AtRest,
    /// The map so far.
    pub map: &'a mut RoomMap,
    /// What is told of it.
    pub tell: &'a mut Vec<EventKind>,
}

/// The tour of the plan.
#[derive(Debug, Clone)]
pub struct Tour {
    chassis: Chassis,
    alpha: f64,
    contour: Contour,
    floor: Option<Floor>,
    chart: Chart,
    doing: Doing,
    queue: VecDeque<(u32, bool)>,
    /// The line that was left to go round something, to be gone on with.
    suspended: Option<Box<Drive>>,
    total: f64,
    driven: f64,
    wall: Wall,
    covered: usize,
    coverage: Coverage,
    given_up: Vec<Point>,
    /// Objects that were passed on one side only.
    halves: Vec<Half>,
    extra: usize,
    begun: bool,
    /// Metres driven when bearings were taken last.
    bearings_at: f64,
    /// Where the second look of the bearings is taken, and the direction of the wall there.
    look_next: Option<(Point, Vector)>,
    /// Directions of the walls to feel for.
    feel_for: Vec<Vector>,
    /// What is to be measured when the robot is there, and what was: place and direction.
    to_tie: Option<Shuttle>,
    tied: Vec<(Point, Vector)>,
    /// Numbers of the objects that were felt for there, and whether they were met.
    felt: Vec<(u32, bool)>,
    /// Switches that are not believed.
    out: SwitchSet,
    /// Where what is mapped left the robot no way out.
    shut_in: Vec<Point>,
    /// Where lines were given up because what is mapped stopped the robot.
    stops: Stops,
    /// When the contact was made that corrected the pose last, microseconds of robot time.
    fixed_by: Option<u64>,
    /// Since when the robot's place is not sure beyond doubt, and what was done since.
    sure: Sureness,
    /// Where something was met that could not be there.
    doubts: Vec<Doubt>,
    /// When the last of these turned out to be right, microseconds of robot time.
    settled_us: u64,
    /// What it was beside when it doubted its place last, until that is handed out.
    astray: Option<Box<Astray>>,
    /// Metres travelled when all was adjusted last, and whether that is to be done now.
    adjusted_at: Option<f64>,
    to_adjust: bool,
}

/// What comes next.
#[derive(Debug)]
pub enum Turn {
    /// A motion.
    Go(Ask),
    /// The robot is not where it believes it is.
    Astray(Box<Astray>),
    /// First all that was read is to be adjusted at once.
    Adjust,
    /// The tour is over.
    Over,
}

impl Tour {
    /// The tour of `map.plan`.
    #[must_use]
    pub fn new(settings: &Settings, map: &RoomMap, survey: &Survey) -> Self {
        let plan = map.plan.as_ref();
        let lengths: BTreeMap<u32, f64> = plan
            .iter()
            .flat_map(|plan| &plan.lines)
            .filter_map(|line| line.drive.map(|(a, b)| (line.id, (b - a).norm())))
            .collect();
        let queue: VecDeque<(u32, bool)> =
            plan.map(|plan| plan.order.clone()).unwrap_or_default().into();
        Self {
            chassis: settings.chassis.clone(),
            alpha: settings.alpha,
            contour: settings.contour,
            floor: None,
            chart: Chart::new(map, survey),
            doing: Doing::Choosing,
            total: queue.iter().filter_map(|(id, _)| lengths.get(id)).sum(),
            queue,
            suspended: None,
            driven: 0.0,
            wall: Wall::new(&settings.chassis),
            covered: 0,
            coverage: Coverage::new(),
            given_up: Vec::new(),
            halves: Vec::new(),
            extra: 0,
            begun: false,
            bearings_at: f64::NEG_INFINITY,
            look_next: None,
            feel_for: Vec::new(),
            to_tie: None,
            tied: Vec::new(),
            felt: Vec::new(),
            out: SwitchSet::EMPTY,
            shut_in: Vec::new(),
            stops: Stops::default(),
            fixed_by: None,
            sure: Sureness::default(),
            doubts: Vec::new(),
            settled_us: 0,
            astray: None,
            adjusted_at: None,
            to_adjust: false,
        }
    }

    /// What is left when the lines of the plan were driven: what is still hidden is driven through. What this
    /// tour measured from what it stands beside is not measured again; and where it doubted its place, and since when
    /// that is sure, stays known.
    #[must_use]
    pub fn of_the_rest(&self, settings: &Settings, map: &RoomMap, survey: &Survey) -> Self {
        let whole = Self::new(settings, map, survey);
        Self {
            queue: VecDeque::new(),
            driven: whole.total,
            begun: true,
            tied: self.tied.clone(),
            felt: self.felt.clone(),
            out: self.out,
            sure: self.sure.clone(),
            doubts: self.doubts.clone(),
            settled_us: self.settled_us,
            ..whole
        }
    }

    /// The switches that are `out` are not believed: nothing is done that only they would end.
    pub fn distrust(&mut self, out: SwitchSet) {
        self.out = out;
    }

    /// Whether a line was begun.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        self.begun
    }

    /// Share of the plan's metres that are done with, 0 to 1.
    #[must_use]
    pub fn share(&self) -> f64 {
        if self.total > 0.0 { (self.driven / self.total).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// The contacts that are being collected.
    #[must_use]
    pub fn wall(&self) -> &Wall {
        match &self.doing {
            Doing::Rounding(round) => &round.circuit.wall,
            Doing::Passing(pass) => pass.wall(),
            _ => &self.wall,
        }
    }

    /// The same, to add to.
    pub fn wall_mut(&mut self) -> &mut Wall {
        match &mut self.doing {
            Doing::Rounding(round) => &mut round.circuit.wall,
            Doing::Passing(pass) => pass.wall_mut(),
            _ => &mut self.wall,
        }
    }

    /// The pose corrected by a contact with something mapped; none when it is nothing mapped.
    pub fn fix(&mut self, survey: &mut Survey, pose: Pose, seen: &Sighting) -> Option<Pose> {
        // What is being gone round has a misclosure of its own, measured at its end.
        if self.goes_round() {
            return None;
        }
        let (off, whose) = self.chart.distance(seen.point);
        let fixed = self.chart.fix(survey, pose, seen)?;
        // An object may have been mapped by a robot that was astray already.
        if let (None, Some(foot)) = (whose, self.chart.outline().nearest(seen.point)) {
            let along = angle::of(self.chart.outline().pieces[foot.piece].tangent(foot.t));
            self.sure.touched(along, off, seen.time_us);
        }
        self.fixed_by = Some(seen.time_us);
        Some(fixed)
    }

    /// Whether something is being gone round, whose contacts must hang together.
    #[must_use]
    pub fn goes_round(&self) -> bool {
        matches!(self.doing, Doing::Rounding(_) | Doing::Passing(_))
    }

    /// The mapped surfaces and what they hang on.
    #[must_use]
    pub fn chart(&self) -> &Chart {
        &self.chart
    }

    /// Writes the map as the survey now has it.
    pub fn publish(&mut self, survey: &Survey, map: &mut RoomMap) {
        self.chart.refresh(survey);
        self.chart.publish(survey, map);
    }

    fn floor(&mut self, from: Point) -> &Floor {
        let objects: Vec<&Ring> = self.chart.objects().collect();
        let outline = self.chart.outline();
        self.floor.get_or_insert_with(|| Floor::new(outline, &objects, &self.chassis, from))
    }

    /// The robot came to rest: what next?
    pub fn next(&mut self, scene: &mut Scene<'_>) -> Turn {
        match self.decide(scene) {
            Some(ask) => Turn::Go(ask),
            None if std::mem::take(&mut self.to_adjust) => Turn::Adjust,
            None => self.astray.take().map_or(Turn::Over, Turn::Astray),
        }
    }

    /// The next motion; none when the tour is over, the robot astray, or all to be adjusted first.
    fn decide(&mut self, scene: &mut Scene<'_>) -> Option<Ask> {
        let mut reason = Some(scene.rest.reason);
        let mut undecided = 0;
        loop {
            // What is believed may have been corrected since the robot came to rest.
            scene.rest.pose = scene.tracker.pose();
            if self.astray.is_some() {
                return None;
            }
            undecided += 1;
            if undecided > MOST_UNDECIDED {
                self.give_up(scene);
            }
            match std::mem::replace(&mut self.doing, Doing::Choosing) {
                Doing::Choosing => {
                    self.follow_survey(scene.survey, scene.map);
                    if self.is_to_be_adjusted(scene) {
                        self.to_adjust = true;
                        return None;
                    }
                    if let Some(retreat) = self.way_out(scene) {
                        self.doing = Doing::Retreating(retreat);
                        continue;
                    }
                    let Some(drive) = self.choose(scene) else {
                        self.leave_open(scene);
                        // The floor that it stood on may have to be driven yet.
                        if self.take_away_impossible(scene) {
                            continue;
                        }
                        return None;
                    };
                    undecided = 0;
                    self.doing = Doing::Driving(Box::new(drive));
                    reason = None;
                }
                Doing::Retreating(mut retreat) => {
                    if let Some(ask) = retreat.next(&scene.rest) {
                        self.doing = Doing::Retreating(retreat);
                        return Some(ask);
                    }
                    reason = None;
                }
                Doing::BackingOff(mut drive) => {
                    drive.way.clear();
                    self.doing = Doing::Driving(drive);
                    reason = None;
                }
                Doing::Driving(drive) => {
                    if let Some(ask) = self.drive(drive, reason.take(), scene) {
                        return Some(ask);
                    }
                }
                Doing::Feeling(feeling) => {
                    if let Some(ask) = self.feel(feeling, scene) {
                        return Some(ask);
                    }
                }
                Doing::Tying(shuttle) => {
                    if let Some(ask) = self.shuttle(shuttle, reason.take(), scene) {
                        return Some(ask);
                    }
                }
                Doing::Rounding(round) => {
                    if let Some(ask) = self.round(round, scene) {
                        return Some(ask);
                    }
                    reason = None;
                }
                Doing::Passing(pass) => {
                    if let Some(ask) = self.pass(pass, scene) {
                        return Some(ask);
                    }
                    reason = None;
                }
            }
        }
    }

    /// The way back to where lines can be driven from, when what is mapped leaves none from here: something
    /// was mapped nearer than it is, for the robot stands where it stands.
    fn way_out(&mut self, scene: &Scene<'_>) -> Option<Retreat> {
        let here = scene.rest.pose.position;
        let clearance = self.chassis.radius + ROOM - 0.01;
        let floor = self.floor(here);
        if floor.is_way_out(here, clearance) {
            return None;
        }
        let path = scene.tracker.path();
        let retreat = Retreat::to_free(path, |place| floor.is_way_out(place, clearance))?;
        if self.shut_in.iter().any(|place| (place - here).norm() < LED_OUT) {
            return None;
        }
        self.shut_in.push(here);
        Some(retreat)
    }

    fn choose(&mut self, scene: &mut Scene<'_>) -> Option<Drive> {
        if self.begun
            && let Some(drive) = self.bearings(scene)
        {
            return Some(drive);
        }
        if !self.begun {
            self.sure.at(scene.tracker.time_us());
        }
        self.begun = true;
        if let Some(drive) = self.suspended.take() {
            return Some(*drive);
        }
        while let Some((id, backwards)) = self.queue.pop_front() {
            let line = scene.map.plan.as_mut()?.lines.iter_mut().find(|line| line.id == id)?;
            let Some((a, b)) = line.drive else {
                finish(line, LineStatus::Skipped, Some(LineReason::NoClearance));
                continue;
            };
            let (from, to) = if backwards { (b, a) } else { (a, b) };
            line.status = LineStatus::Driving;
            scene.tell.push(EventKind::LineBegan { id, backwards });
            return Some(Drive { backwards, ..Drive::new(id, from, to) });
        }
        self.extra_line(scene).or_else(|| self.tie(scene))
    }
}

fn finish(line: &mut PlanLine, status: LineStatus, reason: Option<LineReason>) {
    line.status = status;
    line.reason = reason;
}
