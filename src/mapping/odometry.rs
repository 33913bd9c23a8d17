//! Where the robot believes it is: encoders and gyro turned into a pose in the map frame.
//!
//! While the wheels stand still the robot does not turn, whatever the gyro says: the heading is held,
//! and what the gyro tells then is its drift (paper III.B: the gyro is zeroed at rest).
//!
//! Position is integrated with the middle heading of each step, which is exact for the straight
//! moves and turns in place that the command set consists of. Knows nothing of walls; corrections
//! come from outside, through [`Tracker::correct`] and [`Tracker::nudge`].

mod trajectory;

use super::drift::Unwound;
use super::map::{PathPoint, Phase, Spun};
use super::network::Reading;
use crate::geometry::{Point, Pose, angle};
use crate::robot::{Chassis, Odometer};

/// The wheels must have stood still for this long before the heading is held, microseconds: the body
/// is at rest only a little after its wheels.
const SETTLING: u64 = 300_000;

/// Where a turn of this much goes by without a tick, wheels that do not tick say nothing of whether the robot turns,
/// radians.
const UNFELT: f64 = 0.02;

/// Rests are gathered until they are this long before the gyro's drift is told from them, seconds.
const LEAST_REST: f64 = 2.0;

/// A rest before the first motion must be this long to count, seconds: a shorter one says less of the
/// drift than is known beforehand, and would make the map hang on the operator's patience.
const FIRST_REST: f64 = 60.0;

/// The turn between two readings of the gyro, which counts in microradians, without what is rounded when
/// large numbers are taken from each other: it is the same wherever the gyro began.
fn whole(turned: f64) -> f64 {
    (turned * 1e6).round() / 1e6
}

/// The believed pose and the trajectory so far.
#[derive(Debug, Clone)]
pub struct Tracker {
    tick: f64,
    /// Real over believed travel of the wheels.
    stretch: f64,
    pose: Pose,
    /// Heading, not wrapped, so that whole turns can be counted, radians.
    heading: f64,
    last: Option<Odometer>,
    /// Robot time of the first reading, microseconds.
    first_us: u64,
    travelled: f64,
    spun: Spun,
    /// The turn under way, radians.
    turn: f64,
    /// The straight drive under way, metres, backwards negative.
    stride: f64,
    wheel_base: f64,
    bias: f64,
    /// When the wheels turned last, microseconds; none before they ever did.
    rolled: Option<u64>,
    /// A turn is under way that the wheels may say nothing of.
    turns_unfelt: bool,
    /// How long the heading was held in all, microseconds, and what the gyro told meanwhile beyond
    /// the believed drift, radians.
    rested_us: u64,
    drift: (f64, f64),
    path: Vec<PathPoint>,
    fixed: Fixed,
    /// What wheels and gyro read, nothing taken out.
    read: Reading,
    /// How long the heading was held, seconds, and what the gyro turned meanwhile, radians.
    held: (f64, f64),
}

/// When the pose was corrected last.
#[derive(Debug, Clone, Copy, Default)]
struct Fixed {
    /// Metres travelled, and places of the trajectory, at the last correction.
    at: f64,
    from: usize,
    /// Places of the trajectory at the last of the corrections before these.
    since: usize,
}

impl Tracker {
    /// A robot with `chassis` that stands at `start`.
    #[must_use]
    pub fn new(chassis: &Chassis, start: Pose) -> Self {
        Self {
            tick: chassis.tick,
            stretch: 1.0,
            pose: start,
            heading: start.heading,
            last: None,
            first_us: 0,
            travelled: 0.0,
            spun: Spun::default(),
            turn: 0.0,
            stride: 0.0,
            wheel_base: chassis.wheel_base,
            bias: 0.0,
            rolled: None,
            turns_unfelt: false,
            rested_us: 0,
            drift: (0.0, 0.0),
            path: Vec::new(),
            fixed: Fixed::default(),
            read: Reading::default(),
            held: (0.0, 0.0),
        }
    }

    /// Whether the robot `turns` on the spot, as it was told to. Encoders that tick seldom may not show it, and the
    /// heading is not held meanwhile.
    pub fn is_to_turn(&mut self, turns: bool) {
        let a_tick = 2.0 * self.tick / self.wheel_base;
        self.turns_unfelt = turns && a_tick > UNFELT;
    }

    /// Takes the next reading and returns the pose at its instant.
    pub fn advance(&mut self, to: &Odometer, phase: Phase) -> Pose {
        if let Some(last) = self.last {
            let ticks = (to.left_ticks - last.left_ticks) + (to.right_ticks - last.right_ticks);
            let distance = ticks as f64 * self.tick * self.stretch / 2.0;
            let passed = to.time_us.saturating_sub(last.time_us);
            let seconds = passed as f64 * 1e-6;
            let told = whole(to.heading - last.heading);
            let mut turned = told - self.bias * seconds;
            self.read.turned += told;
            let ticked = (to.left_ticks, to.right_ticks) != (last.left_ticks, last.right_ticks);
            if ticked || self.turns_unfelt {
                if self.rolled.is_none() && self.drift.0 < FIRST_REST {
                    self.drift = (0.0, 0.0);
                    self.held = (0.0, 0.0);
                }
                self.rolled = Some(to.time_us);
            } else if self.rolled.is_none_or(|rolled| last.time_us >= rolled + SETTLING) {
                self.rested_us += passed;
                self.drift = (self.drift.0 + seconds, self.drift.1 + turned);
                self.held = (self.held.0 + seconds, self.held.1 + told);
                self.read.turned -= told;
                turned = 0.0;
            }
            let against = (to.right_ticks - last.right_ticks) - (to.left_ticks - last.left_ticks);
            self.spun.wheels += against as f64 * self.tick / self.wheel_base;
            self.read.ahead += ticks as f64 * self.tick / 2.0;
            self.spun.gyro += turned;
            self.spun.wound += turned.abs();
            // A turn lasts until the robot turns the other way.
            let turn = if turned * self.turn < 0.0 { turned } else { self.turn + turned };
            self.spun.squares += turned * (2.0 * turn - turned);
            self.turn = turn;
            // A drive lasts until the robot stands, turns on the spot, or goes the other way.
            let on = distance * self.stride > 0.0;
            self.stride = if on { self.stride + distance } else { distance };
            self.spun.strides += distance * (2.0 * self.stride - distance);
            let middle = self.heading + turned / 2.0;
            self.heading += turned;
            self.pose.position += angle::unit(middle) * distance;
            self.pose.heading = angle::wrap(self.heading);
            self.travelled += distance.abs();
        }
        if self.last.is_none() {
            self.first_us = to.time_us;
        }
        self.last = Some(*to);
        self.read.time_us = to.time_us;
        self.read.active_us = self.active_us();
        self.read.against = self.spun.wheels;
        self.record(to.time_us, phase);
        self.pose
    }

    fn record(&mut self, time_us: u64, phase: Phase) {
        // However long the operator lets it stand at first, the trajectory begins when the robot does.
        if let (None, [start]) = (self.rolled, &mut self.path[..]) {
            (start.time_us, start.rested_us) = (time_us, self.rested_us);
        }
        let moved = self.path.last().is_none_or(|p| {
            (p.pose.position - self.pose.position).norm() > 5e-4 || p.phase != phase
        });
        if moved {
            let rested_us = self.rested_us;
            let (pose, spun) = (self.pose, self.spun);
            self.path.push(PathPoint { pose, time_us, rested_us, spun, phase, carried: false });
        }
    }

    /// Moves the believed pose by what wheels and gyro, weighed against each other, say of it. No more
    /// than the gyro errs by in a few metres: the trajectory stays where it is.
    pub fn nudge(&mut self, to: Pose) {
        self.heading += angle::wrap(to.heading - self.heading);
        self.pose = Pose { position: to.position, heading: angle::wrap(self.heading) };
    }

    /// Goes on from `to`, to which all that was driven leads by now.
    pub fn settle(&mut self, to: Pose) {
        self.nudge(to);
        self.fixed = Fixed { at: self.travelled, from: self.path.len(), since: self.path.len() };
    }

    /// Takes a steady drift of the gyro out of all that was driven, and out of what comes.
    pub fn unwind(&mut self, unwound: &Unwound) {
        let now = self.time_us();
        let turn = unwound.turn(now);
        self.pose = unwound.pose(self.pose, now);
        self.heading += turn;
        self.spun.gyro += turn;
        self.bias += unwound.rate();
        self.path = unwound.path().to_vec();
    }

    /// Seconds, since its beginning, that the robot was not at rest.
    #[must_use]
    pub fn active(&self) -> f64 {
        self.active_us() as f64 * 1e-6
    }

    fn active_us(&self) -> u64 {
        self.time_us().saturating_sub(self.first_us + self.rested_us)
    }

    /// The wheels carry the robot `stretch` times as far as was believed: all that was driven, and all
    /// that will be, is that much longer, `about` staying where it is.
    pub fn stretch(&mut self, stretch: f64, about: Point) {
        let onto = |at: Point| about + (at - about) * stretch;
        for point in &mut self.path {
            point.pose.position = onto(point.pose.position);
        }
        self.pose.position = onto(self.pose.position);
        self.stretch *= stretch;
        self.travelled *= stretch;
        self.fixed.at *= stretch;
    }

    /// Real over believed travel of the wheels.
    #[must_use]
    pub fn stretched(&self) -> f64 {
        self.stretch
    }

    /// By how much one tick of one wheel turns the robot, radians.
    #[must_use]
    pub fn resolution(&self) -> f64 {
        self.tick / self.wheel_base
    }

    /// Radians of the turn under way: it lasts until the robot turns the other way.
    #[must_use]
    pub fn turn(&self) -> f64 {
        self.turn
    }

    /// How far gyro and wheels turned in all.
    #[must_use]
    pub fn spun(&self) -> Spun {
        self.spun
    }

    /// What wheels and gyro read, nothing taken out.
    #[must_use]
    pub fn reading(&self) -> Reading {
        self.read
    }

    /// For how many seconds the heading was held, and what the gyro turned meanwhile, radians.
    #[must_use]
    pub fn held(&self) -> (f64, f64) {
        self.held
    }

    /// How long the heading was held in all, microseconds of robot time.
    #[must_use]
    pub fn rested_us(&self) -> u64 {
        self.rested_us
    }

    /// What the gyro drifted while the robot stood still, since this was asked last: over how many
    /// seconds, and by how many radians a second beyond the believed drift; none for short rests.
    pub fn take_drift(&mut self) -> Option<(f64, f64)> {
        let (seconds, angle) = self.drift;
        if seconds < LEAST_REST || self.rolled.is_none() {
            return None;
        }
        self.drift = (0.0, 0.0);
        Some((seconds, angle / seconds))
    }

    /// Radians per second that the gyro is believed to drift; taken out of later readings.
    pub fn set_bias(&mut self, bias: f64) {
        self.bias = bias;
    }

    /// The believed drift of the gyro, radians per second.
    #[must_use]
    pub fn bias(&self) -> f64 {
        self.bias
    }

    /// Where the robot is believed to be.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Heading with whole turns counted, radians.
    #[must_use]
    pub fn cumulative_heading(&self) -> f64 {
        self.heading
    }

    /// Metres driven in all, backwards counted too.
    #[must_use]
    pub fn travelled(&self) -> f64 {
        self.travelled
    }

    /// The last reading; none before the first.
    #[must_use]
    pub fn last(&self) -> Option<Odometer> {
        self.last
    }

    /// Robot time of the last reading, microseconds.
    #[must_use]
    pub fn time_us(&self) -> u64 {
        self.last.map_or(0, |last| last.time_us)
    }

    /// Robot time of the first reading, microseconds: a real robot counts from when it was switched on. 0
    /// before there is one.
    #[must_use]
    pub fn began_us(&self) -> u64 {
        self.first_us
    }

    /// Robot time from the first reading to the last, microseconds: how long the run has gone on.
    #[must_use]
    pub fn passed_us(&self) -> u64 {
        self.time_us().saturating_sub(self.first_us)
    }

    /// The same in seconds.
    #[must_use]
    pub fn passed(&self) -> f64 {
        self.passed_us() as f64 * 1e-6
    }

    /// The trajectory: one point for each reading at which the robot had moved.
    #[must_use]
    pub fn path(&self) -> &[PathPoint] {
        &self.path
    }

    /// The same, to be adjusted in place when a lap closes.
    pub fn path_mut(&mut self) -> &mut Vec<PathPoint> {
        &mut self.path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(time_us: u64, ticks: i64, heading: f64) -> Odometer {
        Odometer { time_us, left_ticks: ticks, right_ticks: ticks, heading }
    }

    #[test]
    fn a_turn_that_coarse_encoders_do_not_show_is_a_turn() {
        let coarse = Chassis { tick: 0.01, ..Chassis::default() };
        for (chassis, turns, turned) in
            [(&coarse, true, 0.1), (&coarse, false, 0.0), (&Chassis::default(), true, 0.0)]
        {
            let mut tracker = Tracker::new(chassis, Pose::new(0.0, 0.0, 0.0));
            tracker.advance(&reading(0, 0, 0.0), Phase::Boundary);
            tracker.advance(&reading(100_000, 4, 0.0), Phase::Boundary);
            tracker.advance(&reading(2_000_000, 4, 0.0), Phase::Boundary);
            tracker.is_to_turn(turns);
            for k in 1..=10 {
                let heading = 0.01 * k as f64;
                tracker.advance(&reading(2_000_000 + k * 100_000, 4, heading), Phase::Boundary);
            }
            assert!((tracker.pose().heading - turned).abs() < 1e-9, "{turns} {}", chassis.tick);
        }
    }

    #[test]
    fn a_rest_before_the_first_motion_counts_from_a_minute_on() {
        for (rest, counts) in [(30, false), (90, true)] {
            let mut tracker = Tracker::new(&Chassis::default(), Pose::new(0.0, 0.0, 0.5));
            for k in 0..=rest {
                tracker.advance(&reading(k * 1_000_000, 0, 1e-4 * k as f64), Phase::Boundary);
            }
            assert_eq!(tracker.take_drift(), None, "it stands yet");
            let time = rest * 1_000_000 + 100_000;
            tracker.advance(&reading(time, 40, 1e-4 * rest as f64), Phase::Boundary);
            assert_eq!(tracker.take_drift().is_some(), counts, "{rest} s");
        }
    }

    #[test]
    fn a_gyro_that_drifts_does_not_turn_a_robot_that_stands() {
        let mut tracker = Tracker::new(&Chassis::default(), Pose::new(0.0, 0.0, 0.5));
        let drift = 1e-4;
        tracker.advance(&reading(0, 0, 0.0), Phase::Boundary);
        tracker.advance(&reading(100_000, 40, drift * 0.1), Phase::Boundary);
        for k in 2..=600 {
            let time = k * 100_000;
            tracker.advance(&reading(time, 40, drift * time as f64 * 1e-6), Phase::Boundary);
        }
        // Only the time until it was known to stand counts.
        let turned = tracker.pose().heading - 0.5;
        assert!(turned.abs() < drift * 0.51, "{turned}");
        let (seconds, rate) = tracker.take_drift().expect("a long rest");
        assert!((seconds - 59.6).abs() < 0.21, "{seconds}");
        assert!((rate - drift).abs() < 1e-9, "{rate}");
        assert_eq!(tracker.take_drift(), None);
        // Driving on, the heading goes on from where it was held.
        tracker.advance(&reading(60_100_000, 60, drift * 60.1 + 0.2), Phase::Boundary);
        assert!((tracker.pose().heading - 0.7 - turned).abs() < 1e-4);
    }
}
