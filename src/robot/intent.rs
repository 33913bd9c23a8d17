//! What the operator may want; the only way in which a person speaks to the session.

use crate::geometry::{Point, Pose};
use serde::{Deserialize, Serialize};

/// One wish of the operator. Keys, the command line and scripts all become one of these.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "intent")]
pub enum Intent {
    /// Go on by itself until told otherwise.
    Run,
    /// Let the command in hand end, then wait.
    Pause,
    /// Send one more command, then wait.
    StepCommand,
    /// Go on until the next event, then wait.
    StepEvent,
    /// Go on until the phase ends, then wait.
    StepPhase,
    /// Stand still now and stay so (latched).
    Stop,
    /// Allow motion again after a stop; does not start any and does not change the phase.
    ClearStop,
    /// Use another α (metres); the plan is made anew if its phase was reached and none of its lines is
    /// driven yet.
    SetAlpha {
        /// Metres.
        alpha: f64,
    },
    /// One length of the room was taped: the map is stretched to it, and the plan is made anew, as long
    /// as none of its lines is driven yet.
    SetTape {
        /// About where one end was held, map frame, metres.
        from: Point,
        /// About where the other was.
        to: Point,
        /// What the tape said, metres.
        length: f64,
    },
    /// One lap more round the boundary, to be averaged in: at once when one has closed and no line of the
    /// plan is driven yet, else after the lap under way.
    LapAgain,
    /// The lap that has closed is dropped, and the boundary looked for anew, as long as no line of the plan
    /// is driven yet.
    LapAnew,
    /// Square the map that is handed over, or undo that; the robot drives by what it saw all the same.
    Square,
    /// The robot was carried, or started anew, and stands elsewhere: it has to find its place before it
    /// goes on. With no boundary closed yet there is nothing to know a place by; the lap begins anew
    /// from where it was put, or from the start.
    Placed {
        /// About where it was put, map frame; none when nobody knows.
        near: Option<Pose>,
    },
    /// The run is over: stop and keep what is known.
    Finish,
}

impl Intent {
    /// Whether the robot may move by it.
    #[must_use]
    pub fn sets_going(self) -> bool {
        matches!(self, Self::Run | Self::StepCommand | Self::StepEvent | Self::StepPhase)
    }
}
