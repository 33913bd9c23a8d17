//! Round the boundary once more, the other way: every contact is a touch of the wall that the lap before
//! mapped, and what wheels and gyro say of the way between two of them is averaged in by the survey. Going
//! the other way round, what errs with the sense of the turns (the gyro's scale, the track of the wheels)
//! errs the other way, and is told from what errs with time (after Borenstein and Feng 1996).
//!
//! Moves no wall itself: the survey does, and the chart follows.

use super::chart::Chart;
use super::follow::{Ask, AtRest, Follower, Side};
use super::odometry::Tracker;
use super::survey::Survey;
use super::wall::{Sighting, Wall};
use crate::geometry::{Point, Pose};
use crate::robot::Chassis;

/// From this share of the lap on the robot may be back where it began, ...
const ROUND: f64 = 0.85;
/// ... when it is as near to that, metres.
const BACK: f64 = 0.3;
/// Longer than this share of the lap it has missed its beginning.
const LONGEST: f64 = 1.15;

/// What the robot has beside it, and how it got there: from here a lap can be driven again.
#[derive(Debug, Clone)]
pub struct Beside {
    /// On which hand the wall is.
    pub side: Side,
    /// What was seen of it last.
    pub near: Vec<Sighting>,
    /// Length of the lap, metres.
    pub length: f64,
}

impl Beside {
    /// What is beside a robot that has driven a lap of `length` metres with `wall` on `side`.
    #[must_use]
    pub fn new(side: Side, wall: &Wall, length: f64) -> Self {
        Self { side, near: wall.near().copied().collect(), length }
    }

    /// The same when what was believed to be `from` turned out to be `to`.
    #[must_use]
    pub fn moved(self, from: &Pose, to: &Pose) -> Self {
        let near = self.near.iter().map(|seen| seen.moved(from, to)).collect();
        Self { near, ..self }
    }

    /// The same when the lap turned out to be `stretch` times as long.
    #[must_use]
    pub fn stretched(self, stretch: f64) -> Self {
        Self { length: self.length * stretch, ..self }
    }
}

/// What comes next on the lap.
#[derive(Debug, Clone, PartialEq)]
pub enum Along {
    /// Another motion.
    Go(Ask),
    /// Back at the beginning.
    Round,
    /// It goes no further.
    Held,
}

/// A lap that is driven again.
#[derive(Debug, Clone)]
pub struct Retrace {
    /// What is seen on it.
    pub wall: Wall,
    chart: Chart,
    follower: Follower,
    length: f64,
    from: Point,
    begun: f64,
    begun_us: u64,
    touches: usize,
}

impl Retrace {
    /// The lap that led to where the robot stands, the other way round, past the walls of `chart`.
    #[must_use]
    pub fn new(chassis: &Chassis, beside: &Beside, chart: Chart, tracker: &Tracker) -> Self {
        let mut follower = Follower::new(chassis, beside.side.other());
        follower.beside(chart.objects().cloned().collect());
        Self {
            wall: Wall::of(chassis, beside.near.iter().copied()),
            chart,
            follower,
            length: beside.length,
            from: tracker.pose().position,
            begun: tracker.travelled(),
            begun_us: tracker.time_us(),
            touches: 0,
        }
    }

    /// The robot came to rest: what next?
    pub fn next(&mut self, tracker: &Tracker, rest: &AtRest) -> Along {
        let driven = tracker.travelled() - self.begun;
        let back = (rest.pose.position - self.from).norm() < BACK;
        if (driven > ROUND * self.length && back) || driven > LONGEST * self.length {
            return Along::Round;
        }
        if self.follower.is_stuck() {
            return Along::Held;
        }
        self.follower.next(&mut self.wall, rest).map_or(Along::Held, Along::Go)
    }

    /// The pose corrected by a contact with the wall; none when it is nothing of it.
    pub fn fix(&mut self, survey: &mut Survey, pose: Pose, seen: &Sighting) -> Option<Pose> {
        let fixed = self.chart.fix(survey, pose, seen)?;
        self.touches += 1;
        Some(fixed)
    }

    /// The farthest that a corner was moved by what was touched, metres.
    pub fn moved(&mut self, survey: &Survey) -> f64 {
        self.chart.refresh(survey)
    }

    /// What is beside the robot now.
    #[must_use]
    pub fn beside(&self) -> Beside {
        Beside::new(self.follower.side(), &self.wall, self.length)
    }

    /// How much of it is driven, 0 to 1.
    #[must_use]
    pub fn share(&self, tracker: &Tracker) -> f64 {
        ((tracker.travelled() - self.begun) / self.length).clamp(0.0, 1.0)
    }

    /// How many contacts were touches of the wall.
    #[must_use]
    pub fn touches(&self) -> usize {
        self.touches
    }

    /// When it began, microseconds of robot time: what was driven before hangs on the lap before.
    #[must_use]
    pub fn begun_us(&self) -> u64 {
        self.begun_us
    }
}
