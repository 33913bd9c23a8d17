//! What the screen may know: a copy of the state at one instant, with what is unknown or old
//! marked as such. The view is a pure function of this.

use crate::geometry::{Point, Pose};
use crate::mapping::event::{Event, Failure};
use crate::mapping::map::{Phase, RoomMap};
use crate::mapping::settings::Settings;
use crate::robot::{Command, DoneReason, SwitchSet};

/// Whether the robot may move, and on whose word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunState {
    /// Waiting for the operator.
    Paused,
    /// Going on by itself.
    Running,
    /// Going on until the next command, event or phase has ended.
    Stepping(Step),
    /// Stopped and latched until cleared.
    Stopped,
    /// Everything that was asked for is done. Where that was not all of the four phases, the last are not
    /// done in [`Snapshot::progress`].
    Complete,
    /// Ended short of its goal.
    Failed(Failure),
}

impl RunState {
    /// Whether nothing more will be driven.
    #[must_use]
    pub fn is_over(self) -> bool {
        matches!(self, Self::Complete | Self::Failed(_))
    }

    /// How it ended, for who wants it to go on; none where it can.
    #[must_use]
    pub fn told_over(self) -> Option<String> {
        match self {
            Self::Complete => Some("the run is complete".to_owned()),
            Self::Failed(Failure::Ended) => Some("the run was ended by the operator".to_owned()),
            Self::Failed(why) => Some(format!("the run has ended: {why}")),
            Self::Paused | Self::Running | Self::Stepping(_) | Self::Stopped => None,
        }
    }
}

/// How far a step goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// One command.
    Command,
    /// Until something happens.
    Event,
    /// Until the phase ends.
    Phase,
}

/// A value that may never have arrived or may be old.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Known<T> {
    /// It never arrived.
    #[default]
    Unknown,
    /// It arrived, but too long ago to act on.
    Stale {
        /// The last value.
        value: T,
        /// How old it is, seconds.
        age: f64,
    },
    /// It is current.
    Known(T),
}

/// What the robot last said of itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotView {
    /// Believed pose in the map frame; none while the robot looks for its place.
    pub pose: Option<Pose>,
    /// One standard deviation of the position, metres, as the core believes.
    pub position_sd: f64,
    /// Which switches are closed.
    pub switches: SwitchSet,
    /// Whether the bumper is pressed.
    pub bumper: bool,
    /// Whether a motion is under way.
    pub moving: bool,
    /// Whether it does nothing before somebody says where it is.
    pub needs_place: bool,
}

/// A command that is no longer in hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Ended {
    /// What was commanded.
    pub command: Command,
    /// In words why it was chosen.
    pub why: String,
    /// How it ended; none where nobody said so.
    pub reason: Option<DoneReason>,
}

/// How far one phase has come.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PhaseProgress {
    /// 0 to 1 where it can be told (Boundary: by turning and closeness to the first contact; Objects: by
    /// metres of plan driven), none where it cannot.
    pub share: Option<f64>,
    /// Robot time spent in it, seconds.
    pub seconds: f64,
    /// Metres travelled in it.
    pub travel: f64,
    /// Commands sent in it.
    pub commands: u32,
    /// Whether it is over.
    pub done: bool,
}

/// One instant of a run.
#[expect(
    clippy::struct_excessive_bools,
    reason = "each answers a question of its own, that the screen asks"
)]
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Robot time since the first report of the run, seconds.
    pub time: f64,
    /// Which phase the run is in.
    pub phase: Phase,
    /// The four phases in order.
    pub progress: [PhaseProgress; 4],
    /// Whether the robot may move.
    pub run: RunState,
    /// A stop holds until it is cleared; after the end of a run too.
    pub latched: bool,
    /// What the robot last said.
    pub robot: Known<RobotView>,
    /// The command in hand, and in words why it was chosen.
    pub command: Option<(Command, String)>,
    /// The one before, once that has ended.
    pub done: Option<Ended>,
    /// Whether α may still be changed: no line of the plan is driven yet.
    pub alpha_is_open: bool,
    /// Whether the laps so far may be dropped, and another one driven: one has closed, no line of the plan is
    /// driven, and the robot stands where it knows.
    pub laps_are_open: bool,
    /// The map so far. While a lap is under way `map.contacts` holds its raw contacts.
    pub map: RoomMap,
    /// With the lap closed, what was met since that is no part of the map yet: of an object that is being
    /// gone round, say.
    pub felt: Vec<Point>,
    /// What the run was started with (α as it is now).
    pub settings: Settings,
    /// The newest events, oldest first; as many as the log can show. Their time counts, as [`Snapshot::time`]
    /// does, from the first report of the run.
    pub events: Vec<Event>,
    /// Events before those.
    pub forgotten: u64,
    /// Motions so far that the bumper or a stall ended.
    pub bumps: u32,
    /// What the map or else the robot is called: the world's name, or the port.
    pub source: String,
    /// Played back from a record: what happened is looked at and not changed.
    pub recorded: bool,
    /// In words why the playback goes no further, and what to do; none before it stands at the end of the record,
    /// and where the run was over there.
    pub record_end: Option<String>,
    /// The robot was told to go on, and that is not in this picture yet.
    pub asked: bool,
}

impl Snapshot {
    /// Whether a motion is under way, as far as was heard: after a stop, until the robot said that it ended.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        match self.robot {
            Known::Known(robot) | Known::Stale { value: robot, .. } => robot.moving,
            Known::Unknown => false,
        }
    }

    /// Whether the robot moves, or will without another word. In a replay there is none.
    #[must_use]
    pub fn may_move(&self) -> bool {
        let goes_on = matches!(self.run, RunState::Running | RunState::Stepping(_));
        !self.recorded && (self.asked || goes_on || self.is_moving())
    }

    /// Whether the map is as it is handed over, without what it came from: nothing more will be driven, and the
    /// plan was not all that was asked for.
    #[must_use]
    pub fn is_handed_over(&self) -> bool {
        let [.., plan, objects] = &self.progress;
        let plan_is_the_end = self.run == RunState::Complete && plan.done && !objects.done;
        self.run.is_over() && !plan_is_the_end
    }

    /// A run that has not begun: nothing was heard and nothing is known.
    #[must_use]
    pub fn waiting(settings: Settings, source: impl Into<String>) -> Self {
        Self {
            time: 0.0,
            phase: Phase::Boundary,
            progress: [PhaseProgress::default(); 4],
            run: RunState::Paused,
            latched: false,
            robot: Known::Unknown,
            command: None,
            done: None,
            alpha_is_open: true,
            laps_are_open: false,
            map: RoomMap::default(),
            felt: Vec::new(),
            settings,
            events: Vec::new(),
            forgotten: 0,
            bumps: 0,
            source: source.into(),
            recorded: false,
            record_end: None,
            asked: false,
        }
    }
}
