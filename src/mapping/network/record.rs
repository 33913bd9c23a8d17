//! What wheels, gyro and switches told, as they told it: nothing is believed here.

use crate::geometry::{Pose, Vector, angle};

/// Wheels and gyro at one instant, counted since the beginning.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reading {
    /// Robot time, microseconds.
    pub time_us: u64,
    /// Time in which the robot was not known to stand still, microseconds: whole, so that it makes no
    /// difference when the counting began.
    pub active_us: u64,
    /// By how far the wheels went ahead, metres in the robot's own measure.
    pub ahead: f64,
    /// By how much the wheels turned the robot by their own account, radians.
    pub against: f64,
    /// By how much the gyro turned while the robot was not known to stand still, radians.
    pub turned: f64,
}

/// What lies between two readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Motion {
    pub(super) active: f64,
    pub(super) ahead: f64,
    pub(super) against: f64,
    pub(super) turned: f64,
}

/// A motion that turns by less than this goes straight, radians.
const STRAIGHT: f64 = 0.02;
/// A way shorter than this is told by the time, metres.
const SHORT: f64 = 0.002;

impl Motion {
    pub(super) fn is_straight(&self) -> bool {
        is_straight(self.turned)
    }
}

fn is_straight(turned: f64) -> bool {
    turned.abs() < STRAIGHT
}

impl Reading {
    pub(super) fn since(&self, before: &Self) -> Motion {
        Motion {
            active: self.active_us.saturating_sub(before.active_us) as f64 * 1e-6,
            ahead: self.ahead - before.ahead,
            against: self.against - before.against,
            turned: self.turned - before.turned,
        }
    }

    /// Between which of `rests` it was taken; none where the robot had not come to rest since.
    pub(super) fn share(&self, rests: &[Rest]) -> Option<Share> {
        let after = rests.partition_point(|rest| rest.reading.time_us < self.time_us);
        let (from, next) = (after.checked_sub(1)?, rests.get(after)?);
        let before = &rests[from].reading;
        let (part, all) = (self.since(before), next.reading.since(before));
        let time = if all.active > 0.0 { (part.active / all.active).clamp(0.0, 1.0) } else { 1.0 };
        let way =
            if all.ahead.abs() > SHORT { (part.ahead / all.ahead).clamp(0.0, 1.0) } else { time };
        Some(Share { from, way, time, turned: (part.turned, all.turned) })
    }
}

/// The robot at rest, after a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// What it read.
    pub reading: Reading,
    /// Something stood in the way of the motion that ended here: the wheels may have slipped.
    pub held_up: bool,
}

/// A switch that closed or opened on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glance {
    /// What wheels and gyro read at that instant.
    pub reading: Reading,
    /// Which switch.
    pub sensor: usize,
    /// Where the surface was, in the robot's frame, metres.
    pub arm: Vector,
    /// Whether that is the surface: a beam that slid off something says nothing of where that is.
    pub sure: bool,
}

/// At which share of the motion between two rests something was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Share {
    /// The rest before it; the one after it is the next.
    pub(super) from: usize,
    /// Of the way.
    pub(super) way: f64,
    /// Of the time.
    pub(super) time: f64,
    /// By how much the gyro had turned since the rest before, and did in all until the next, radians.
    turned: (f64, f64),
}

impl Glance {
    /// Unit vector along the beam, in the robot's frame.
    pub(super) fn towards(&self) -> Vector {
        self.arm.try_normalize(1e-9).unwrap_or_else(Vector::zeros)
    }
}

impl Share {
    /// Whether the motion goes straight.
    pub(super) fn is_straight(&self) -> bool {
        is_straight(self.turned.1)
    }

    /// Where the robot was if it was at `poses` when it rested.
    pub(super) fn among(&self, poses: &[Pose]) -> Pose {
        self.pose(&poses[self.from], &poses[self.from + 1])
    }

    /// Where the robot was that went from `a` to `b`.
    fn pose(&self, a: &Pose, b: &Pose) -> Pose {
        let (part, all) = self.turned;
        let rest = angle::wrap(b.heading - a.heading - all);
        Pose {
            position: a.position + (b.position - a.position) * self.way,
            heading: angle::wrap(a.heading + part + rest * self.time),
        }
    }
}
