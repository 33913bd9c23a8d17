//! The Boundary phase (paper III.C): pick a direction, drive until something is met, go round it;
//! if that was an object, pick another direction, until it was the boundary.

mod lap;

pub use lap::{lap_contacts, lap_strokes, lap_things, straight_contacts, whole_lap};

use super::adjust::Adjustment;
use super::circuit::{Circuit, Closure, Leg};
use super::drift::Unwound;
use super::event::{EventKind, Failure};
use super::follow::{Ask, AtRest, STRIDE, Side};
use super::lay::Overlap;
use super::map::{Contact, MappedObject, RoomMap};
use super::odometry::Tracker;
use super::passing::{Passing, Way};
use super::retreat::Retreat;
use super::settings::Settings;
use super::shape::is_mapped;
use super::wall::Wall;
use crate::geometry::{Point, Pose, Ring, angle};
use crate::robot::{Chassis, DoneReason, Guard, Motion, SwitchSet};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Directions that are tried before the search is given up.
const MOST_TRIES: usize = 40;
/// A robot that so many turns in a row did not turn is held.
const MOST_HELD: usize = 20;
/// How often one pocket is left again. What is met once more then is the room: the robot began in a niche of it.
const MOST_POCKETS: usize = 2;
/// Ways back out of a pocket that may be blocked.
const MOST_BLOCKED: usize = 3;
/// A lap that began this near to the way round a pocket is of that pocket, metres: bodies on two sides of a wall
/// are farther apart.
const SAME_POCKET: f64 = 0.1;
/// Metres driven again after a lap has closed, for the misclosure.
const OVERLAP: f64 = 1.0;
/// A contact this near a known object belongs to it, metres.
const SAME_OBJECT: f64 = 0.08;

/// What the search is doing.
#[derive(Debug, Clone)]
enum Doing {
    /// Turning into the next direction.
    Turning,
    /// Driving in it.
    Driving,
    /// Going round something unknown.
    Lapping(Box<Circuit>),
    /// Going round a known object, back to the line.
    Passing(Box<Passing>),
    /// On the way back out of a pocket.
    Leaving(Retreat),
}

/// What comes next.
#[derive(Debug, Clone, PartialEq)]
pub enum Next {
    /// A motion.
    Go(Ask),
    /// The boundary is found: this lap, with its misclosure.
    Found(Closure, Box<Overlap>),
    /// It was not.
    Failed(Failure),
}

/// What is met within this of straight ahead can be gone round either way, radians.
const AHEAD: f64 = 1.0;

/// The search for the boundary.
#[derive(Debug, Clone)]
pub struct Search {
    chassis: Chassis,
    doing: Doing,
    /// The line driven: where it began and its direction.
    line: Pose,
    /// When it was begun, robot time, microseconds.
    line_begun_us: u64,
    tried: usize,
    /// Turns in a row that something ended.
    held: usize,
    /// The ways round the pockets that it came back out of.
    pockets: Vec<Ring>,
    /// It is in a pocket: how often the way back out was blocked.
    blocked: Option<usize>,
    rng: ChaCha8Rng,
    wall: Wall,
    laps: u32,
    /// The laps that went round something extrinsic, with what was seen on them.
    earlier: Vec<(Closure, Wall)>,
    /// Whether a lap may be looked at without each drift that the gyro may have.
    any_drift: bool,
    /// A place in the room, if that is not where the run began: in a frame of its own the robot knows no
    /// other than where this frame begins.
    within: Option<Point>,
    /// How it was turned when it met something first, whole turns counted, radians.
    facing: Option<f64>,
}

impl Search {
    /// Begins at the pose `from`, in the direction the robot faces.
    #[must_use]
    pub fn new(settings: &Settings, from: Pose) -> Self {
        Self {
            chassis: settings.chassis.clone(),
            doing: Doing::Turning,
            line: from,
            line_begun_us: 0,
            tried: 0,
            held: 0,
            pockets: Vec::new(),
            blocked: None,
            rng: ChaCha8Rng::seed_from_u64(settings.seed),
            wall: Wall::new(&settings.chassis),
            laps: 0,
            earlier: Vec::new(),
            any_drift: true,
            within: None,
            facing: None,
        }
    }

    /// The same by a robot that has mapped the room: what its gyro's drift is, is known by then.
    #[must_use]
    pub fn relocating(settings: &Settings, from: Pose) -> Self {
        Self { any_drift: false, within: Some(from.position), ..Self::new(settings, from) }
    }

    /// The same by a robot that since `begun_us` (robot time, microseconds) is beside something, with what
    /// it saw of that.
    #[must_use]
    pub fn relocating_beside(
        settings: &Settings,
        (from, begun_us): (Pose, u64),
        (side, wall): (Side, Wall),
    ) -> Self {
        let search = Self::relocating(settings, from);
        let circuit = search.circuit_round(side, wall);
        Self { doing: Doing::Lapping(Box::new(circuit)), line_begun_us: begun_us, ..search }
    }

    fn circuit_round(&self, side: Side, wall: Wall) -> Circuit {
        let circuit = Circuit::new(&self.chassis, side, wall, OVERLAP);
        let circuit = circuit.along_walls().within(self.within);
        if self.any_drift { circuit.with_any_drift() } else { circuit }
    }

    /// Laps closed so far.
    #[must_use]
    pub fn laps(&self) -> u32 {
        self.laps
    }

    /// The laps round extrinsic objects, with what was seen on each.
    #[must_use]
    pub fn earlier(&self) -> &[(Closure, Wall)] {
        &self.earlier
    }

    /// The contacts that are being collected.
    pub fn wall_mut(&mut self) -> &mut Wall {
        match &mut self.doing {
            Doing::Lapping(circuit) => &mut circuit.wall,
            Doing::Passing(passing) => &mut passing.wall,
            Doing::Turning | Doing::Driving | Doing::Leaving(_) => &mut self.wall,
        }
    }

    /// The same, to look at.
    #[must_use]
    pub fn wall(&self) -> &Wall {
        match &self.doing {
            Doing::Lapping(circuit) => &circuit.wall,
            Doing::Passing(passing) => &passing.wall,
            Doing::Turning | Doing::Driving | Doing::Leaving(_) => &self.wall,
        }
    }

    /// The lap under way, if one is.
    #[must_use]
    pub fn circuit(&self) -> Option<&Circuit> {
        match &self.doing {
            Doing::Lapping(circuit) => Some(circuit),
            _ => None,
        }
    }

    /// The robot came to rest: what next? Objects that turn out to be extrinsic go into `map`.
    pub fn next(
        &mut self,
        tracker: &mut Tracker,
        rest: &AtRest,
        map: &mut RoomMap,
        tell: &mut Vec<EventKind>,
    ) -> Next {
        loop {
            match std::mem::replace(&mut self.doing, Doing::Turning) {
                Doing::Turning => {
                    let held = matches!(rest.reason, DoneReason::Bumper | DoneReason::Stalled);
                    self.held = if held { self.held + 1 } else { 0 };
                    if self.held > MOST_HELD {
                        return Next::Failed(Failure::Boxed);
                    }
                    // From within a pocket it still has to come back to where it went into it from.
                    if self.blocked.is_none() {
                        self.line_begun_us = tracker.time_us();
                    }
                    return self.set_out(rest, tell);
                }
                Doing::Driving => {
                    if let Some(next) = self.arrived(tracker, rest, map, tell) {
                        return next;
                    }
                }
                Doing::Passing(mut passing) => match passing.next(tracker, rest) {
                    Way::Leg(Leg::Go(ask)) => {
                        self.doing = Doing::Passing(passing);
                        return Next::Go(ask);
                    }
                    Way::Back => {
                        self.doing = Doing::Driving;
                        self.wall = Wall::new(&self.chassis);
                        return self.drive(rest);
                    }
                    Way::Leg(_) => self.turn_elsewhere(rest, tell),
                },
                Doing::Leaving(mut retreat) => {
                    if let Some(ask) = retreat.next(rest) {
                        self.doing = Doing::Leaving(retreat);
                        return Next::Go(ask);
                    }
                    self.wall = Wall::new(&self.chassis);
                    if retreat.is_back() {
                        self.blocked = None;
                    } else {
                        self.pockets.pop();
                        let blocked = self.blocked.map_or(1, |times| times + 1);
                        if blocked == MOST_BLOCKED {
                            return Next::Failed(Failure::Pocketed);
                        }
                        self.blocked = Some(blocked);
                    }
                    self.turn_elsewhere(rest, tell);
                }
                Doing::Lapping(mut circuit) => match circuit.next(tracker, rest) {
                    Leg::Go(ask) => {
                        tell.extend(circuit.closed_gap().map(|width| EventKind::LedBack { width }));
                        self.doing = Doing::Lapping(circuit);
                        return Next::Go(ask);
                    }
                    Leg::Closed(closure, overlap) => {
                        let lap = (closure, overlap);
                        if let Some(found) = self.lapped(*circuit, lap, tracker, rest, map, tell) {
                            return found;
                        }
                    }
                    Leg::Failed(why) => {
                        tell.push(EventKind::LapFailed { why });
                        // What it touched is known all the same.
                        self.doing = Doing::Lapping(circuit);
                        return Next::Failed(why);
                    }
                },
            }
        }
    }

    /// The `circuit` closed: it was the boundary, or what the robot leaves for another direction.
    fn lapped(
        &mut self,
        circuit: Circuit,
        (closure, overlap): (Closure, Box<Overlap>),
        tracker: &mut Tracker,
        rest: &AtRest,
        map: &mut RoomMap,
        tell: &mut Vec<EventKind>,
    ) -> Option<Next> {
        let (length, extrinsic) = (closure.length(), closure.is_extrinsic());
        self.wall = circuit.wall;
        self.unwind(closure.drift, tracker, map);
        if !extrinsic && let Some(retreat) = self.way_out(tracker, &closure) {
            tell.push(EventKind::Pocket { length });
            self.doing = Doing::Leaving(retreat);
            return None;
        }
        self.laps += 1;
        tell.push(EventKind::LapClosed { length, extrinsic });
        tell.extend(closure.alike.map(|alike| EventKind::LapAlike { alike }));
        if !extrinsic {
            return Some(Next::Found(closure, overlap));
        }
        self.record(tracker, &closure, &overlap, map, tell);
        self.earlier.push((closure, self.wall.clone()));
        self.turn_elsewhere(&AtRest { pose: tracker.pose(), ..*rest }, tell);
        None
    }

    /// The way out of the pocket that a lap closed in, if it was one.
    fn way_out(&mut self, tracker: &Tracker, closure: &Closure) -> Option<Retreat> {
        let begun = closure.from.pose.position;
        let is_here = |round: &&Ring| round.contains(begun) || round.distance(begun) < SAME_POCKET;
        if self.pockets.iter().filter(is_here).count() == MOST_POCKETS {
            return None;
        }
        let lap = (closure.from.time_us, closure.to.time_us);
        let (retreat, round) = Retreat::from_pocket(tracker.path(), self.line_begun_us, lap)?;
        self.pockets.push(round);
        Some(retreat)
    }

    /// Takes the drift that a lap has shown out of all that was driven and seen.
    fn unwind(&mut self, drift: f64, tracker: &mut Tracker, map: &mut RoomMap) {
        if drift == 0.0 {
            return;
        }
        let unwound = Unwound::new(tracker.path(), drift);
        tracker.unwind(&unwound);
        self.wall.unwind(&unwound);
        for (lap, wall) in &mut self.earlier {
            *lap = lap.unwound(&unwound);
            wall.unwind(&unwound);
        }
        for object in &mut map.objects {
            let seen = object.contacts.first().map_or(0, Contact::time_us);
            object.displace(|p| unwound.point(p, seen) - p);
        }
    }

    fn turn_elsewhere(&mut self, rest: &AtRest, tell: &mut Vec<EventKind>) {
        self.tried += 1;
        let away = self.wall.near().next_back().map(|seen| seen.beam + angle::PI);
        let spread = if away.is_some() { angle::PI * 0.8 } else { angle::TAU };
        let heading = away.unwrap_or(0.0) + (self.rng.random::<f64>() - 0.5) * spread;
        self.line = Pose { position: rest.pose.position, heading: angle::wrap(heading) };
        tell.push(EventKind::Heading { heading: self.line.heading, tried: self.tried });
        self.wall = Wall::new(&self.chassis);
        self.doing = Doing::Turning;
    }

    fn set_out(&mut self, rest: &AtRest, tell: &mut Vec<EventKind>) -> Next {
        if self.tried > MOST_TRIES {
            return Next::Failed(Failure::NoBoundary);
        }
        if self.tried == 0 {
            tell.push(EventKind::Heading { heading: rest.pose.heading, tried: 0 });
        }
        let turn = angle::wrap(self.line.heading - rest.pose.heading);
        if turn.abs() > 0.01 {
            self.doing = Doing::Turning;
            return Next::Go(Ask {
                motion: Motion::Turn { angle: turn, rate: f64::INFINITY },
                guard: Guard::default(),
                why: "turning into a new direction",
            });
        }
        self.doing = Doing::Driving;
        self.drive(rest)
    }

    fn drive(&mut self, rest: &AtRest) -> Next {
        let turn = angle::wrap(self.line.heading - rest.pose.heading);
        if turn.abs() > 0.01 {
            self.doing = Doing::Turning;
            return self.set_out(rest, &mut Vec::new());
        }
        let all =
            (0..self.chassis.sensors.len()).fold(SwitchSet::EMPTY, |set, k| set.with(k, true));
        Next::Go(Ask {
            motion: Motion::Move { distance: STRIDE, speed: f64::INFINITY },
            guard: Guard { rise: all, fall: SwitchSet::EMPTY },
            why: "driving until something is met",
        })
    }

    fn arrived(
        &mut self,
        tracker: &Tracker,
        rest: &AtRest,
        map: &RoomMap,
        tell: &mut Vec<EventKind>,
    ) -> Option<Next> {
        let heading = tracker.cumulative_heading();
        let turned = heading - *self.facing.get_or_insert(heading);
        let (by, side) = match rest.reason {
            DoneReason::Guard { sensor, .. } => {
                let sensor = &self.chassis.sensors[sensor];
                (sensor.name.clone(), side_of(sensor.angle, turned))
            }
            DoneReason::Bumper | DoneReason::Stalled => ("bumper".to_owned(), side_of(0.0, turned)),
            _ => {
                self.doing = Doing::Driving;
                return Some(self.drive(rest));
            }
        };
        let known = self.wall.near().next_back().and_then(|seen| {
            let near = |object: &&MappedObject| object.outline.distance(seen.point) < SAME_OBJECT;
            map.objects.iter().find(near).map(|object| object.id)
        });
        let wall = std::mem::replace(&mut self.wall, Wall::new(&self.chassis));
        self.doing = if let Some(id) = known {
            tell.push(EventKind::Detour { id });
            let passing = Passing::new(&self.chassis, side, wall, self.line, tracker);
            Doing::Passing(Box::new(passing))
        } else {
            tell.push(EventKind::ContactGained { by });
            let known = map.objects.iter().map(|object| object.outline.clone()).collect();
            Doing::Lapping(Box::new(self.circuit_round(side, wall).beside(known)))
        };
        None
    }

    fn record(
        &self,
        tracker: &Tracker,
        closure: &Closure,
        overlap: &Overlap,
        map: &mut RoomMap,
        tell: &mut Vec<EventKind>,
    ) {
        let since = closure.from.time_us;
        let adjustment = Adjustment::new(tracker, closure, overlap, since);
        let closure = &whole_lap(&self.wall, closure, &adjustment);
        let contacts = lap_contacts(&self.wall, closure, &adjustment);
        if is_mapped(&contacts, &map.objects.iter().map(|object| &object.outline)) {
            // It was met from another side, or led the robot off what it followed once more.
            let off = |object: &&MappedObject| -> f64 {
                contacts.iter().map(|contact| object.outline.distance(contact.point)).sum()
            };
            let nearest = map.objects.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
            tell.extend(nearest.map(|object| EventKind::ObjectKnown { id: object.id }));
            return;
        }
        let found = lap_things(&self.wall, closure, &adjustment, contacts, &self.chassis);
        for (n, thing) in found.into_iter().enumerate() {
            let object = thing.numbered(map.next_id());
            let id = object.id;
            map.objects.push(object);
            tell.push(EventKind::gone_round(id, n == 0));
        }
    }
}

/// On which hand to keep what was met at `bearing`, radians from ahead: right only when it is on the right. Round
/// what is ahead either way is as good, and by a robot that has `turned` (radians) more than once round it is gone
/// the way that turns it back: what the scale of a gyro is off by grows with every turn the same way.
fn side_of(bearing: f64, turned: f64) -> Side {
    let is_ahead = bearing.abs() < AHEAD;
    if is_ahead && turned.abs() > angle::TAU {
        return if turned > 0.0 { Side::Right } else { Side::Left };
    }
    if bearing < -0.5 && bearing > 0.1 - angle::PI { Side::Right } else { Side::Left }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_that_cannot_turn_is_not_asked_for_ever() {
        let from = Pose::new(0.0, 0.0, 0.0);
        let settings = Settings::new(from);
        let mut search = Search::new(&settings, from);
        search.line.heading = 1.0;
        let mut tracker = Tracker::new(&settings.chassis, from);
        let rest = AtRest { pose: from, closed: SwitchSet::EMPTY, reason: DoneReason::Stalled };
        let (mut map, mut told) = (RoomMap::default(), Vec::new());
        let mut asked = 0;
        while let Next::Go(_) = search.next(&mut tracker, &rest, &mut map, &mut told) {
            asked += 1;
            assert!(asked <= MOST_HELD, "asked once more");
        }
        assert_eq!(asked, MOST_HELD);
    }

    #[test]
    fn a_robot_that_has_turned_round_and_round_goes_back_the_other_way() {
        let (ahead, left, right) = (0.0, 1.57, -1.57);
        for turned in [-7.0, -3.0, 0.0, 3.0, 7.0] {
            assert_eq!(side_of(left, turned), Side::Left);
            assert_eq!(side_of(right, turned), Side::Right);
        }
        // With the wall on the right it goes clockwise about a thing.
        let sides = [-7.0, -3.0, 3.0, 7.0].map(|turned| side_of(ahead, turned));
        assert_eq!(sides, [Side::Left, Side::Left, Side::Left, Side::Right]);
        assert_eq!(side_of(-0.78, -7.0), Side::Left);
    }
}
