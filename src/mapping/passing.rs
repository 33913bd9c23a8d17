//! Driving round something known, back to the line that it stands on (paper III.F).
//!
//! The robot follows the outline on one hand until it crosses its line beyond the place where it
//! left it; a way that leads all round the thing, or farther than any, it gives up. Used for known objects
//! in the search for the boundary and for the two-pass contour. What comes of a way is for those to say.

use super::circuit::Leg;
use super::event::Failure;
use super::follow::{AtRest, Follower, Side};
use super::odometry::Tracker;
use super::wall::Wall;
use crate::geometry::{Point, Pose, angle};
use crate::robot::Chassis;

/// The robot must be this far beyond where it left the line to join it again, metres.
const BEYOND: f64 = 0.10;
/// Longer ways round are given up, metres, ...
const LONGEST: f64 = 30.0;
/// ... and those on which the robot has turned so far, radians: it has been all the way round a thing so small that
/// it is never that far beyond.
const ALL_ROUND: f64 = 1.25 * angle::TAU;

/// A way round under way.
#[derive(Debug, Clone)]
pub struct Passing {
    /// Contacts of the way round.
    pub wall: Wall,
    follower: Follower,
    line: Pose,
    left_at: f64,
    begun: f64,
    /// Heading when it began, radians, whole turns counted.
    faced: f64,
    previous: Option<Point>,
}

/// What comes next on the way round.
#[derive(Debug, Clone, PartialEq)]
pub enum Way {
    /// As on a lap: another motion, or it cannot go on.
    Leg(Leg),
    /// The robot is back on its line.
    Back,
}

impl Passing {
    /// Leaves `line` (a point on it and its direction) where the robot stands.
    #[must_use]
    pub fn new(chassis: &Chassis, side: Side, wall: Wall, line: Pose, tracker: &Tracker) -> Self {
        Self {
            wall,
            follower: Follower::new(chassis, side),
            line,
            left_at: line.to_local(tracker.pose().position).x,
            begun: tracker.travelled(),
            faced: tracker.cumulative_heading(),
            previous: None,
        }
    }

    /// On which hand the thing is.
    #[must_use]
    pub fn side(&self) -> Side {
        self.follower.side()
    }

    /// The robot came to rest: what next?
    pub fn next(&mut self, tracker: &Tracker, rest: &AtRest) -> Way {
        let here = self.line.to_local(rest.pose.position);
        if self.follower.is_stepping()
            && let Some(before) = self.previous
        {
            let crossed = before.y * here.y <= 0.0 && before.y != here.y;
            if crossed && here.x > self.left_at + BEYOND {
                return Way::Back;
            }
        }
        let way = tracker.travelled() - self.begun;
        let came_round = way > 0.8
            && here.x < self.left_at - 0.03
            && self.previous.is_some_and(|before| before.y * here.y < 0.0);
        let all_round = (tracker.cumulative_heading() - self.faced).abs() > ALL_ROUND;
        if self.follower.is_stuck() || way > LONGEST || came_round || all_round {
            return Way::Leg(Leg::Failed(Failure::WallLost));
        }
        match self.follower.next(&mut self.wall, rest) {
            Some(ask) => {
                if self.follower.is_stepping() {
                    self.previous = Some(here);
                }
                Way::Leg(Leg::Go(ask))
            }
            None => Way::Leg(Leg::Failed(Failure::Boxed)),
        }
    }
}
