//! What a closed lap is: the two anchors that are one place, the drift that had to be taken out for them to
//! meet, and what of it was driven in a pocket. How that was found out is not known here.

use crate::geometry::Pose;
use crate::mapping::drift::Unwound;
use crate::mapping::follow::Side;
use crate::mapping::map::Alike;
use crate::mapping::odometry::Tracker;

/// So much before it begins, and beyond its end, still is of a lap, metres.
const BEFORE: f64 = 0.02;
const BEYOND: f64 = 0.1;
/// A pocket come into no farther than this after one was left is the same, metres.
const AGAIN: f64 = 2.0;

/// A place early in the lap at which it may close.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    /// Where.
    pub pose: Pose,
    /// Heading with whole turns counted, radians.
    pub heading: f64,
    /// Odometer, metres.
    pub travelled: f64,
    /// Robot time, microseconds.
    pub time_us: u64,
}

impl Anchor {
    /// Where the robot is now.
    pub(super) fn here(tracker: &Tracker) -> Self {
        Self {
            pose: tracker.pose(),
            heading: tracker.cumulative_heading(),
            travelled: tracker.travelled(),
            time_us: tracker.time_us(),
        }
    }

    /// The same with a steady drift of the gyro taken out.
    pub(super) fn unwound(&self, unwound: &Unwound) -> Self {
        Self {
            pose: unwound.pose(self.pose, self.time_us),
            heading: self.heading + unwound.turn(self.time_us),
            ..*self
        }
    }
}

/// A lap that closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closure {
    /// The place where it began.
    pub from: Anchor,
    /// The same place, a lap later.
    pub to: Anchor,
    /// On which hand the wall was.
    pub side: Side,
    /// Drift of the gyro that has to be taken out of all that was driven, radians per second: the
    /// places above are without it.
    pub drift: f64,
    /// Odometer where its last round began, metres: `from`'s, unless it closed on a later round only.
    pub last_round: f64,
    /// Odometer when the robot was back where the lap began, metres: `to`'s, or later, if adjusting told so.
    pub over: f64,
    /// What was driven round and round in a pocket on the way, if it came into one.
    pub pocket: Option<Pocket>,
    /// Where else it would have closed as well.
    pub alike: Option<Alike>,
}

/// A stretch of a lap that ended where it began, and says nothing new.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pocket {
    from: f64,
    to: f64,
}

impl Pocket {
    /// What was driven between these two readings of the odometer, metres; all since the pocket `before` where
    /// that had only just been left, and is come into again.
    pub(super) fn after(before: Option<Self>, from: f64, to: f64) -> Self {
        let again = before.filter(|before| from - before.to < AGAIN);
        Self { from: again.map_or(from, |before| before.from.min(from)), to }
    }

    /// Whether it was driven between these two readings of the odometer, metres.
    pub(super) fn lies_within(&self, from: f64, to: f64) -> bool {
        from <= self.from && self.to <= to
    }

    /// Whether what was seen after `travelled` metres was seen on it.
    #[must_use]
    pub fn holds(&self, travelled: f64) -> bool {
        (self.from..self.to).contains(&travelled)
    }
}

impl Closure {
    /// The same with a steady drift of the gyro taken out.
    #[must_use]
    pub fn unwound(&self, unwound: &Unwound) -> Self {
        Self { from: self.from.unwound(unwound), to: self.to.unwound(unwound), ..*self }
    }

    /// The same when the robot was back at its beginning when it had `travelled` so far: adjusting tells
    /// better than the crossing by odometry where that was.
    #[must_use]
    pub fn over_at(self, travelled: f64) -> Self {
        Self { over: self.over.max(travelled), ..self }
    }

    /// Length of the lap along the robot's path, metres.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.to.travelled - self.from.travelled
    }

    /// Whether what was seen after `travelled` metres was seen on the lap, in its last round, and not in a
    /// pocket.
    #[must_use]
    pub fn holds(&self, travelled: f64) -> bool {
        travelled > self.last_round - BEFORE
            && travelled <= self.over + BEYOND
            && !self.pocket.is_some_and(|pocket| pocket.holds(travelled))
    }

    /// Whether the robot went round the outside: it turned towards the wall in all.
    #[must_use]
    pub fn is_extrinsic(&self) -> bool {
        (self.to.heading - self.from.heading) * self.side.sign() > 0.0
    }
}
