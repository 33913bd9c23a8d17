//! What happened and why: the words that the screen, the journal and the tests share.

use super::map::{LineReason, Phase, ShapeClass};
use crate::geometry::Point;
use crate::robot::DoneReason;
use serde::{Deserialize, Serialize};
use std::fmt;

/// One thing worth telling, with the robot's time at which it happened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Robot time, microseconds.
    pub time_us: u64,
    /// What happened.
    pub kind: EventKind,
}

/// How much an event should stand out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Routine detail: why a motion was chosen.
    Detail,
    /// Progress.
    Notice,
    /// Something did not go as it should.
    Warning,
    /// The run cannot go on by itself.
    Fault,
}

/// What happened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "event")]
pub enum EventKind {
    /// A phase began.
    PhaseBegan {
        /// Which.
        phase: Phase,
    },
    /// A phase ended as it should.
    PhaseEnded {
        /// Which.
        phase: Phase,
    },
    /// A new direction to search in, radians.
    Heading {
        /// Direction of the search.
        heading: f64,
        /// How many directions were tried before.
        tried: usize,
    },
    /// The first contact of a lap.
    ContactGained {
        /// Name of the switch, or "bumper".
        by: String,
    },
    /// The wall was lost and is being looked for.
    ContactLost,
    /// A corner was met; positive angles turn left.
    Corner {
        /// Turn of the wall, radians.
        angle: f64,
    },
    /// Position and turning say that a lap may have closed.
    LapCandidate {
        /// Distance from the first contact, metres.
        off: f64,
    },
    /// A lap closed.
    LapClosed {
        /// Length, metres.
        length: f64,
        /// Whether the robot is outside of what it went round.
        extrinsic: bool,
    },
    /// A lap was given up.
    LapFailed {
        /// Why.
        why: Failure,
    },
    /// The shape is known.
    ShapeFound {
        /// Its class.
        class: ShapeClass,
        /// How many vertices.
        vertices: usize,
        /// How many parts.
        parts: usize,
    },
    /// The path plan is made.
    PlanMade {
        /// Lines to drive.
        lines: usize,
        /// Metres to drive.
        length: f64,
        /// Hidden disc, metres.
        hidden_disc: f64,
    },
    /// A line is begun.
    LineBegan {
        /// Its id.
        id: u32,
        /// Whether it is driven from its end to its vertex.
        backwards: bool,
    },
    /// A line ended as it should.
    LineDriven {
        /// Its id.
        id: u32,
    },
    /// A line ended before its end.
    LineEnded {
        /// Its id.
        id: u32,
        /// Why.
        reason: LineReason,
    },
    /// An unknown object was met.
    ObjectFound {
        /// Its id.
        id: u32,
        /// Name of the switch, or "bumper".
        by: String,
    },
    /// An object is closed.
    ObjectClosed {
        /// Its id.
        id: u32,
    },
    /// One side of an object was passed; the other follows on the way back (two-pass contour).
    ObjectHalf {
        /// The number it will have.
        id: u32,
    },
    /// Something was gone round as part of the wall, but only a gap joins it to that.
    ObjectApart {
        /// Its id.
        id: u32,
    },
    /// What was gone round is on the map already: the pose was off.
    ObjectKnown {
        /// The number it would have had.
        id: u32,
    },
    /// An object could not be closed.
    ObjectOpen {
        /// Its id.
        id: u32,
        /// Why.
        why: Failure,
    },
    /// A known object was met and is gone round.
    Detour {
        /// Its id.
        id: u32,
    },
    /// A contact near the boundary was passed over (III.F, first case).
    NearBoundary,
    /// The pose was corrected by a touch of a mapped wall.
    Fixed {
        /// By how much, metres.
        by: f64,
    },
    /// The pose had become uncertain: the robot goes to a corner to see where it is.
    Bearings {
        /// One standard deviation of its position beside the walls there, metres.
        sd: f64,
    },
    /// The tour is over, and more than α may still hide somewhere.
    StillHidden {
        /// Diameter of the largest disc, metres.
        diameter: f64,
        /// Its centre.
        at: Point,
    },
    /// Why the next motion was chosen.
    Reason {
        /// In words.
        why: String,
    },
    /// The bumper was pressed or the robot stalled.
    Bumped,
    /// Something is wrong with the link or the record.
    Alarm {
        /// What, in words.
        what: String,
    },
    /// A motion ended in a way that was not expected.
    Odd {
        /// How it ended.
        reason: DoneReason,
    },
    /// The operator stopped the robot.
    Stopped,
    /// The operator cleared the stop.
    StopCleared,
    /// α was changed, metres.
    AlphaSet {
        /// Metres.
        alpha: f64,
    },
    /// Everything is done.
    Complete,
    /// The run ended short of its goal.
    Failed {
        /// Why.
        why: Failure,
    },
}

/// Why something could not be done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Failure {
    /// The wall could not be found again.
    WallLost,
    /// The lap went on far longer than any room allows without closing.
    LapEndless,
    /// No boundary was met in any direction.
    NoBoundary,
    /// The robot cannot move: it is held on all sides.
    Boxed,
    /// The contacts make no simple closed outline.
    OutlineBroken,
    /// Too many bumps in one place.
    TooManyBumps,
    /// The two wheels and the gyro contradict each other.
    WheelsLie,
    /// The operator ended the run.
    Ended,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::WallLost => "the wall could not be found again",
            Self::LapEndless => "the lap goes on without closing",
            Self::NoBoundary => "no boundary was met in any direction",
            Self::Boxed => "the robot is held on all sides",
            Self::OutlineBroken => "the contacts make no simple closed outline",
            Self::TooManyBumps => "too many bumps in one place",
            Self::WheelsLie => {
                "by its wheels the robot goes in curves where by its gyro it goes straight: see to \
                 the encoders, and to the wheel base of the chassis"
            }
            Self::Ended => "ended by the operator",
        })
    }
}

impl fmt::Display for LineReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AlongBoundary => "runs along the boundary",
            Self::LeavesArea => "leaves the reachable area",
            Self::Duplicate => "is in the plan already",
            Self::NoClearance => "too narrow for the robot",
            Self::Redundant => "a shorter plan does without it",
            Self::CoveredByObjects => "covered by known objects",
            Self::EndOccupied => "an object stands on its end",
            Self::ObjectOnLine => "an object blocks it",
            Self::Unreachable => "no way leads there",
        })
    }
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Boundary => "boundary",
            Self::Shape => "shape",
            Self::Plan => "plan",
            Self::Objects => "objects",
        })
    }
}

impl fmt::Display for ShapeClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Circle => "circle",
            Self::Convex => "convex",
            Self::Concave => "concave",
            Self::Complex => "complex",
        })
    }
}

impl fmt::Display for EventKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PhaseBegan { phase } => write!(f, "{phase} phase begins"),
            Self::PhaseEnded { phase } => write!(f, "{phase} phase done"),
            Self::Heading { heading, tried } => {
                write!(
                    f,
                    "looking for a wall towards {:.0}° (try {})",
                    heading.to_degrees(),
                    tried + 1
                )
            }
            Self::ContactGained { by } => write!(f, "contact: {by}"),
            Self::ContactLost => f.write_str("wall lost, looking for it"),
            Self::Corner { angle } => write!(f, "corner of {:.0}°", angle.to_degrees()),
            Self::LapCandidate { off } => write!(f, "lap may be closed, {:.0} mm off", off * 1e3),
            Self::LapClosed { length, extrinsic: false } => {
                write!(f, "lap closed after {length:.2} m: inside, this is the boundary")
            }
            Self::LapClosed { length, extrinsic: true } => {
                write!(f, "lap closed after {length:.2} m: outside, this is an object")
            }
            Self::LapFailed { why } => write!(f, "lap given up: {why}"),
            Self::ShapeFound { class, vertices, parts } => {
                write!(f, "shape: {class}, {vertices} vertices, {parts} part(s)")
            }
            Self::PlanMade { lines, length, hidden_disc } => write!(
                f,
                "plan: {lines} lines, {length:.1} m, hidden disc {:.0} mm",
                hidden_disc * 1e3
            ),
            Self::LineBegan { id, backwards: false } => write!(f, "line L{id} begins"),
            Self::LineBegan { id, backwards: true } => write!(f, "line L{id} begins, from its end"),
            Self::LineDriven { id } => write!(f, "line L{id} driven"),
            Self::LineEnded { id, reason } => write!(f, "line L{id} ended: {reason}"),
            Self::ObjectFound { id, by } => write!(f, "unknown object O{id} met ({by})"),
            Self::ObjectClosed { id } => write!(f, "object O{id} closed"),
            Self::ObjectHalf { id } => {
                write!(f, "object O{id} passed on one side; the other follows on the way back")
            }
            Self::ObjectKnown { id } => {
                write!(f, "object O{id} is one known already: the pose was put right by it")
            }
            Self::ObjectApart { id } => {
                write!(f, "object O{id} stands apart: the gap to the wall is too narrow to pass")
            }
            Self::ObjectOpen { id, why } => write!(f, "object O{id} left open: {why}"),
            Self::Detour { id } => write!(f, "known object O{id}: going round it"),
            Self::NearBoundary => f.write_str("contact near the boundary: carrying on"),
            Self::Fixed { by } => write!(f, "pose corrected by {:.0} mm", by * 1e3),
            Self::Bearings { sd } => {
                write!(f, "position sure to {:.0} mm only: taking bearings in a corner", sd * 1e3)
            }
            Self::StillHidden { diameter, at } => write!(
                f,
                "the promise is not kept: {:.0} mm may still hide around ({:.2}, {:.2})",
                diameter * 1e3,
                at.x,
                at.y
            ),
            Self::Reason { why } => f.write_str(why),
            Self::Alarm { what } => f.write_str(what),
            Self::Bumped => f.write_str("bumper"),
            Self::Odd { reason } => write!(f, "motion ended early: {reason}"),
            Self::Stopped => f.write_str("stopped: nothing moves until the stop is cleared"),
            Self::StopCleared => f.write_str("stop cleared"),
            Self::AlphaSet { alpha } => write!(f, "α set to {alpha:.2} m"),
            Self::Complete => f.write_str("map complete"),
            Self::Failed { why } => write!(f, "run ended: {why}"),
        }
    }
}

impl EventKind {
    /// How much the event should stand out.
    #[must_use]
    pub fn severity(&self) -> Severity {
        match self {
            Self::Reason { .. } | Self::Fixed { .. } | Self::NearBoundary | Self::Corner { .. } => {
                Severity::Detail
            }
            Self::LapFailed { .. }
            | Self::ContactLost
            | Self::LineEnded { .. }
            | Self::ObjectOpen { .. }
            | Self::ObjectKnown { .. }
            | Self::StillHidden { .. }
            | Self::Bumped
            | Self::Odd { .. }
            | Self::Alarm { .. }
            | Self::Stopped => Severity::Warning,
            Self::Failed { .. } => Severity::Fault,
            _ => Severity::Notice,
        }
    }
}
