//! Where the robot believes it is: encoders and gyro turned into a pose in the map frame.
//!
//! Position is integrated with the middle heading of each step, which is exact for the straight
//! moves and turns in place that the command set consists of. Knows nothing of walls; corrections
//! come from outside through [`Tracker::correct`].

use super::map::{PathPoint, Phase};
use crate::geometry::{Pose, angle};
use crate::robot::{Chassis, Odometer};

/// The believed pose and the trajectory so far.
#[derive(Debug, Clone)]
pub struct Tracker {
    tick: f64,
    pose: Pose,
    /// Heading, not wrapped, so that whole turns can be counted, radians.
    heading: f64,
    last: Option<Odometer>,
    travelled: f64,
    bias: f64,
    path: Vec<PathPoint>,
}

impl Tracker {
    /// A robot with `chassis` that stands at `start`.
    #[must_use]
    pub fn new(chassis: &Chassis, start: Pose) -> Self {
        Self {
            tick: chassis.tick,
            pose: start,
            heading: start.heading,
            last: None,
            travelled: 0.0,
            bias: 0.0,
            path: Vec::new(),
        }
    }

    /// Takes the next reading and returns the pose at its instant.
    pub fn advance(&mut self, to: &Odometer, phase: Phase) -> Pose {
        if let Some(last) = self.last {
            let ticks = (to.left_ticks - last.left_ticks) + (to.right_ticks - last.right_ticks);
            let distance = ticks as f64 * self.tick / 2.0;
            let seconds = to.time_us.saturating_sub(last.time_us) as f64 * 1e-6;
            let turned = to.heading - last.heading - self.bias * seconds;
            let middle = self.heading + turned / 2.0;
            self.heading += turned;
            self.pose.position += angle::unit(middle) * distance;
            self.pose.heading = angle::wrap(self.heading);
            self.travelled += distance.abs();
        }
        self.last = Some(*to);
        self.record(to.time_us, phase);
        self.pose
    }

    fn record(&mut self, time_us: u64, phase: Phase) {
        let moved = self.path.last().is_none_or(|p| {
            (p.pose.position - self.pose.position).norm() > 5e-4 || p.phase != phase
        });
        if moved {
            self.path.push(PathPoint { pose: self.pose, time_us, phase });
        }
    }

    /// Moves the believed pose by a correction that was measured against the map.
    pub fn correct(&mut self, to: Pose) {
        self.heading += angle::wrap(to.heading - self.heading);
        self.pose = Pose { position: to.position, heading: angle::wrap(self.heading) };
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

    /// Robot time of the last reading, microseconds.
    #[must_use]
    pub fn time_us(&self) -> u64 {
        self.last.map_or(0, |last| last.time_us)
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
