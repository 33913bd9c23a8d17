//! One thing that a switch or the bumper told: where, from where, and what has become of it since. Judges
//! nothing; the wall does.

use crate::geometry::{Point, Pose, angle};
use crate::mapping::drift::Unwound;
use crate::mapping::lay::Seen;
use crate::mapping::map::{Contact, ContactKind};

/// A contact with what is needed to judge it later.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// Where the surface is believed to be.
    pub point: Point,
    /// Where the robot was.
    pub pose: Pose,
    /// Direction of the beam in the map frame, radians.
    pub beam: f64,
    /// What kind of evidence.
    pub kind: ContactKind,
    /// Which switch; none for the bumper.
    pub sensor: Option<usize>,
    /// Whether the switch closed.
    pub rising: bool,
    /// Which way the robot turned the beam meanwhile: 1 counter-clockwise, -1 clockwise, 0 not at all.
    pub swept: f64,
    /// Odometer when it was seen, metres driven.
    pub travelled: f64,
    /// Robot time, microseconds.
    pub time_us: u64,
    /// False when later evidence contradicts it.
    pub alive: bool,
    /// How many places of the rim were ruled out before this one; of a touch, whose place the bumper
    /// does not tell.
    pub ruled_out: u8,
}

/// Whether the robot turned when something was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turning {
    /// On the spot: 1 counter-clockwise, -1 clockwise.
    By(f64),
    /// No: it moved.
    No,
    /// Nobody knows: no motion of its own was under way.
    Unknown,
}

impl Sighting {
    /// The same with a steady drift of the gyro taken out.
    #[must_use]
    pub fn unwound(&self, unwound: &Unwound) -> Self {
        Self {
            point: unwound.point(self.point, self.time_us),
            pose: unwound.pose(self.pose, self.time_us),
            beam: self.beam + unwound.turn(self.time_us),
            ..*self
        }
    }

    /// The same when what was believed to be `from` turned out to be `to`.
    #[must_use]
    pub fn moved(&self, from: &Pose, to: &Pose) -> Self {
        let turn = to.heading - from.heading;
        let place = |p: Point| to.to_world(from.to_local(p));
        Self {
            point: place(self.point),
            pose: Pose {
                position: place(self.pose.position),
                heading: angle::wrap(self.pose.heading + turn),
            },
            beam: self.beam + turn,
            ..*self
        }
    }

    /// The place that was seen, and from where.
    #[must_use]
    pub fn seen(&self) -> Seen {
        Seen { at: self.point, towards: self.pose.position - self.point }
    }

    /// The contact as it goes into the map.
    #[must_use]
    pub fn contact(&self) -> Contact {
        Contact {
            point: self.point,
            from: self.pose.position,
            sensor: self.sensor,
            kind: self.kind,
            time: self.time_us as f64 * 1e-6,
        }
    }
}

#[cfg(test)]
impl Sighting {
    /// For tests: a surface at (`x`, `y`) that a switch closed on, from there, after `travelled` metres.
    pub(in crate::mapping) fn at(x: f64, y: f64, travelled: f64) -> Self {
        Self {
            point: Point::new(x, y),
            pose: Pose::new(x, y, 0.0),
            beam: 0.0,
            kind: ContactKind::Range,
            sensor: Some(2),
            rising: true,
            swept: 0.0,
            travelled,
            time_us: 0,
            alive: true,
            ruled_out: 0,
        }
    }
}
