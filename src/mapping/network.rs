//! The whole survey adjusted at once: everything the robot read on its way, put together by least squares.
//!
//! The filter (see [`super::survey`]) takes what is learnt as it comes, and has to: the robot drives by it.
//! Looking back more can be said. Where a wall runs that was met first of all is known best by what was
//! driven along it an hour later; how uneven the wheels are, which nobody knew on the first metres, says
//! afterwards how far the robot had turned there. Surveyors measure first and adjust the network of all
//! their observations when they are home; this is that adjustment (adjustment by observation equations:
//! Ghilani, *Adjustment Computations*; in robotics full smoothing, Dellaert and Kaess 2006).
//!
//! Unknown are the pose at each rest, the robot's own errors, and the surfaces. Observed are, for each
//! motion, the turn by the gyro and by the wheels and the way by the wheels; and for each contact, that it
//! lies on its surface. What surface that is, is taken from the map: at first from farther off, for where the
//! robot had doubted its place everything it saw was off together, then closer, as it fits better ([`WITHIN`];
//! iterative closest point, Chen and Medioni 1992, from coarse to fine). `record` keeps the observations,
//! `dither` says how much those on the way tell, `surface` keeps the unknown surfaces, `thin` keeps the faces of
//! thin walls apart, `equation` writes the equations, `chain` solves them, `datum` says what errors all of it has
//! in common.
//!
//! It refuses to know what becomes of the map: it says where the robot was, and how a contact follows.

mod chain;
mod datum;
mod dither;
mod equation;
mod record;
mod surface;
mod thin;

pub use datum::{Datum, Offset};
pub use record::{Glance, Reading, Rest};

use super::map::{Contact, PathPoint, RoomMap};
use super::survey::SystematicErrors;
use crate::geometry::{Point, Pose, Vector, angle, rotate};
use dither::weighed;
use equation::{Read, Robot, Unknowns};
use std::collections::BTreeMap;
use surface::Surfaces;

/// A contact is of a surface that is no farther off than this, metres: one adjustment after the other.
pub const WITHIN: [f64; 4] = [0.12, 0.06, CLOSE, CLOSE];
/// The same in a round room, where a robot that has turned about the middle without knowing it is off across the wall
/// wherever it comes to it askance: who leaves out what is far off believes all the more of the rest.
pub const WITHIN_ROUND: [f64; 3] = [0.12, 0.12, 0.06];
/// The same when the lap alone is driven: its contacts made the outline, and are not far off it.
pub const WITHIN_LAP: [f64; 2] = [0.06, CLOSE];
/// What lies on a surface is no farther off than this, metres.
const CLOSE: f64 = 0.03;
/// Readings on the way are so far apart that each is rounded to ticks by itself, metres.
const APART: f64 = 0.005;
/// Least squares are repeated so often: the equations are linear but for small turns. From afar, where what
/// comes after puts it right, ...
const ROUNDS_FROM_AFAR: usize = 2;
/// ... and close by.
const ROUNDS: usize = 3;
/// With fewer contacts on mapped surfaces nothing is adjusted.
const FEWEST: usize = 20;
/// Contacts that lie on their surfaces worse than this, in standard deviations (root mean square), are on
/// other surfaces than was thought, and nothing of it is believed.
const WORST_FIT: f64 = 2.0;
/// The same where they are taken from afar, of standard deviations that are as large: runs that had lost their
/// place have 0.3 at most, and 0.8 those on which somebody pushed the robot.
const WORST_FROM_AFAR: f64 = 0.5;
/// Nor is any of it believed where fewer than this share of the contacts lies on its surface at all: a robot
/// that was pushed aside was elsewhere from then on.
const LEAST_SHARE: f64 = 0.9;
/// Nor where the worst stretch of the way strains what gyro and wheels told of it more than this, in variances. In
/// 327 adjustments it was 0.95 at most; where somebody had pushed the robot by 0.35 m it was 1.2 to 15.
const MOST_STRAIN: f64 = 1.2;
/// Nor is a pose that moves by more than this, metres.
const FARTHEST: f64 = 1.0;
/// The same in a round room, where a turn that nothing told moves all that was driven since.
const FARTHEST_ROUND: f64 = 4.0;

/// All that the robot read since it stood at `start`.
#[derive(Debug, Clone)]
pub struct Network {
    start: Pose,
    rests: Vec<Rest>,
    /// What wheels and gyro read on the way from one rest to the next.
    passed: Vec<Reading>,
    glances: Vec<Glance>,
    /// The robot was carried off: that does not hang together.
    broken: bool,
}

/// What is known besides the observations.
#[derive(Debug, Clone, Copy)]
pub struct Given<'a> {
    /// Where the robot is believed to have been.
    pub path: &'a [PathPoint],
    /// What it mapped.
    pub map: &'a RoomMap,
    /// Bearings of the switches, radians from ahead.
    pub beams: &'a [f64],
    /// Real over believed travel of the wheels.
    pub stretch: f64,
    /// Travel of a wheel for one of its ticks, metres.
    pub tick: f64,
    /// Turn of the wheels for one tick of one of them, radians.
    pub resolution: f64,
    /// Variance of the wheels' heading, square radians per metre, and that of the gyro's walk as a share
    /// of what its datasheet says.
    pub grip: (f64, f64),
    /// What the gyro drifts, as believed, radians per second.
    pub bias: f64,
    /// For how many seconds the robot stood still, and what the gyro turned meanwhile, radians.
    pub held: (f64, f64),
    /// How far from a surface what was seen of it may seem to be, metres: one of [`WITHIN`] or
    /// [`WITHIN_LAP`].
    pub within: f64,
    /// Whether it is asked as well what the errors of all of it have in common.
    pub datum: bool,
}

/// Where the robot was at one rest.
#[derive(Debug, Clone, Copy)]
struct Moved {
    time_us: u64,
    /// For how long it was under way there, microseconds: however long it stood before, it set out that long
    /// ago.
    way_us: u64,
    before: Pose,
    after: Pose,
}

/// The adjusted survey.
#[derive(Debug, Clone)]
pub struct Adjusted {
    rests: Vec<Moved>,
    /// Where the robot was at each contact, by its time and switch.
    glances: BTreeMap<(u64, usize), Pose>,
    beams: Vec<f64>,
    /// Contacts that lie on mapped surfaces.
    pub used: usize,
    /// What the robot itself does wrong.
    pub errors: SystematicErrors,
    /// What the errors of all of it have in common; none where it was not asked for, or nothing tells.
    pub datum: Option<Datum>,
}

impl Network {
    /// Nothing read yet by a robot at `start`.
    #[must_use]
    pub fn new(start: Pose) -> Self {
        let (passed, glances) = (Vec::new(), Vec::new());
        Self { start, rests: Vec::new(), passed, glances, broken: false }
    }

    /// What is read from here on does not hang together with what was read before.
    pub fn break_off(&mut self) {
        self.broken = true;
    }

    /// The robot came to rest, or stands there for the first time.
    pub fn rest(&mut self, rest: Rest) {
        if self.rests.last().is_none_or(|last| last.reading.time_us < rest.reading.time_us) {
            self.rests.push(rest);
        }
    }

    /// The robot is on its way. What it reads where it has gone no farther says nothing more.
    pub fn pass(&mut self, reading: Reading) {
        let last = self.passed.last().or(self.rests.last().map(|rest| &rest.reading));
        if last.is_some_and(|last| (reading.ahead - last.ahead).abs() > APART) {
            self.passed.push(reading);
        }
    }

    /// Whether it has read nothing yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rests.is_empty()
    }

    /// A switch saw something.
    pub fn glance(&mut self, glance: Glance) {
        self.glances.push(glance);
    }

    /// All of it adjusted; none where too little was seen, where the robot was carried, or where the
    /// observations do not agree with each other.
    #[must_use]
    pub fn adjust(&self, given: &Given<'_>) -> Option<Adjusted> {
        if self.broken || self.rests.len() < 3 {
            return None;
        }
        let rests = self.rests.as_slice();
        let before = self.believed(given);
        // What was seen on a motion that has not ended hangs on nothing yet.
        let placed = |glance: &Glance| Some((*glance, glance.reading.share(rests)?.among(&before)));
        let (glances, poses): (Vec<Glance>, Vec<Pose>) =
            self.glances.iter().filter_map(placed).unzip();
        let passed = weighed(&self.passed, rests, given.tick);
        let read = Read { rests, passed: &passed, glances: &glances };
        let robot = Robot::new(given, self.start);
        let mut surfaces = Surfaces::of(given, &glances, &poses);
        let mut unknowns = Unknowns::new(rests, &before, given.bias, given.beams.len());
        let afar = given.within > CLOSE;
        for round in 0..if afar { ROUNDS_FROM_AFAR } else { ROUNDS } {
            let rough = round == 0;
            surfaces.look_through();
            let (change, border) = robot.equations(&read, &unknowns, &surfaces, rough).solve()?;
            unknowns.take(&change, &border);
            surfaces.take(&border.as_slice()[robot.surfaces()..]);
        }
        let (used, misfit) = unknowns.misfit(&read, &surfaces);
        let seen = surfaces.of.iter().flatten().count();
        let datum = given.datum.then(|| robot.datum(&read, &unknowns, &surfaces)).flatten();
        let (errors, strain) = (unknowns.errors(), robot.strain(&read, &unknowns));
        let after = unknowns.poses;
        let moved = |(a, b): (&Pose, &Pose)| (a.position - b.position).norm();
        let farthest = if given.map.is_round() { FARTHEST_ROUND } else { FARTHEST };
        let sane = before.iter().zip(&after).map(moved).all(|moved| moved < farthest);
        let agreed = used as f64 >= LEAST_SHARE * seen as f64;
        let worst = if afar { WORST_FROM_AFAR } else { WORST_FIT };
        if used < FEWEST || !agreed || misfit > worst || strain > MOST_STRAIN || !sane {
            return None;
        }
        let at = |glance: &Glance| {
            let pose = glance.reading.share(rests)?.among(&after);
            Some(((glance.reading.time_us, glance.sensor), pose))
        };
        let moved = |k: usize| Moved {
            time_us: rests[k].reading.time_us,
            way_us: k.checked_sub(1).map_or(0, |last| {
                rests[k].reading.active_us.saturating_sub(rests[last].reading.active_us)
            }),
            before: before[k],
            after: after[k],
        };
        Some(Adjusted {
            rests: (0..rests.len()).map(moved).collect(),
            glances: glances.iter().filter_map(at).collect(),
            beams: given.beams.to_vec(),
            used,
            errors,
            datum,
        })
    }

    /// Where the robot is believed to have been at each rest: on the trajectory, with the heading of the
    /// last straight drive and what the gyro turned since.
    fn believed(&self, given: &Given<'_>) -> Vec<Pose> {
        let mut poses: Vec<Pose> = Vec::with_capacity(self.rests.len());
        for (k, rest) in self.rests.iter().enumerate() {
            let Some(before) = k.checked_sub(1).map(|j| self.rests[j]) else {
                poses.push(self.start);
                continue;
            };
            let until = |time_us: u64| given.path.partition_point(|p| p.time_us <= time_us);
            let (from, to) = (until(before.reading.time_us), until(rest.reading.time_us));
            let last = poses[k - 1];
            let place = to.checked_sub(1).map_or(last, |j| given.path[j].pose);
            let motion = rest.reading.since(&before.reading);
            let heading = if from < to && motion.is_straight() {
                place.heading
            } else {
                last.heading + motion.turned - given.bias * motion.active
            };
            poses.push(Pose { position: place.position, heading });
        }
        poses
    }
}

impl Adjusted {
    /// By how much the robot was elsewhere at `time_us` than was believed: where it was believed to be
    /// then, displacement and turn.
    fn correction(&self, time_us: u64) -> (Vector, f64) {
        let of = |at: &Moved| {
            let turn = angle::wrap(at.after.heading - at.before.heading);
            (at.after.position - at.before.position, turn)
        };
        let after = self.rests.partition_point(|at| at.time_us <= time_us);
        let (first, second) = (after.saturating_sub(1), after.min(self.rests.len() - 1));
        let (a, b) = (&self.rests[first], &self.rests[second]);
        let begun_us = b.time_us.saturating_sub(b.way_us);
        let share = if b.way_us > 0 {
            (time_us.saturating_sub(begun_us) as f64 / b.way_us as f64).min(1.0)
        } else {
            0.0
        };
        let ((by, turn), (other, turned)) = (of(a), of(b));
        (by + (other - by) * share, turn + (turned - turn) * share)
    }

    /// Where a place of the trajectory is, that was believed to be `pose` at `time_us`.
    #[must_use]
    pub fn pose(&self, pose: Pose, time_us: u64) -> Pose {
        let (by, turn) = self.correction(time_us);
        Pose { position: pose.position + by, heading: angle::wrap(pose.heading + turn) }
    }

    /// Where a contact is, as it was seen from where the robot was. What its switch may reach too far is left
    /// in it: on a wall that one switch has seen nothing tells that from the place of the wall.
    #[must_use]
    pub fn contact(&self, contact: &Contact) -> Contact {
        let time_us = contact.time_us();
        let arm = contact.point - contact.from;
        let seen = contact.sensor.and_then(|sensor| {
            Some((self.glances.get(&(time_us, sensor))?, self.beams.get(sensor)?))
        });
        if let Some((pose, beam)) = seen {
            let towards = angle::unit(pose.heading + beam);
            let point = pose.position + towards * arm.norm();
            return Contact { point, from: pose.position, ..*contact };
        }
        let (by, turn) = self.correction(time_us);
        let from = contact.from + by;
        Contact { point: from + rotate(arm, turn), from, ..*contact }
    }

    /// How far the robot was from where it was believed to be, root mean square over its rests, metres.
    #[must_use]
    pub fn moved(&self) -> f64 {
        let of = |at: &Moved| (at.after.position - at.before.position).norm_squared();
        (self.rests.iter().map(of).sum::<f64>() / self.rests.len() as f64).sqrt()
    }
}

/// How far a place on a ring of `contacts` moves, which are where they are `now`: as the nearest of
/// them does.
#[must_use]
pub fn displacement(contacts: &[Contact], now: &[Contact], place: Point) -> Vector {
    let off = |pair: &(&Contact, &Contact)| (pair.0.point - place).norm_squared();
    let nearest = contacts.iter().zip(now).min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.map_or_else(Vector::zeros, |(before, after)| {
        let (old, new) = (before.point - before.from, after.point - after.from);
        let turn = angle::wrap(angle::of(new) - angle::of(old));
        after.point - place + rotate(place - before.point, turn)
    })
}

#[cfg(test)]
mod tests;
