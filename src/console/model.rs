//! What the console itself remembers: where the map looks, what lies over it, what was typed.
//! Nothing of the run: that is the snapshot's.

use super::command::Steered;
use super::driver::Speed;
use super::keymap::Keymap;
use super::prompt::{Past, Prompt};
use crate::geometry::Point;
use crate::session::snapshot::{Known, RunState, Snapshot};

/// Where the map looks.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Camera {
    /// At everything known.
    #[default]
    Fit,
    /// At the robot; at `around` while nobody knows where it is.
    Follow {
        /// Metres per dot.
        scale: f64,
        /// Where to look without a robot.
        around: Point,
    },
    /// At one place.
    Free {
        /// Metres per dot.
        scale: f64,
        /// The place.
        center: Point,
    },
}

/// What lies over the screen and takes the keys.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Overlay {
    /// Nothing.
    #[default]
    None,
    /// The help, scrolled down by so many lines.
    Help(u16),
    /// The list of what was found, scrolled down by so many lines.
    List(u16),
    /// The command line with what was typed so far.
    Line(Prompt),
    /// The question whether to leave although the robot moves.
    ConfirmQuit,
    /// The question whether to end the run here.
    ConfirmFinish,
    /// The question whether to drop the laps that are closed.
    ConfirmAnew,
}

/// Whether a layer of the map is shown. While the run goes on it tells what is done; what is handed over
/// at the end is a map. So what was toggled before the end has no say after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layer {
    /// As long as the run goes on.
    pub under_way: bool,
    /// When it is over.
    pub over: bool,
}

impl Layer {
    const HIDDEN: Self = Self { under_way: false, over: false };
    const UNDER_WAY: Self = Self { under_way: true, over: false };

    /// Whether it is shown, when the run is `over` or not.
    #[must_use]
    pub fn is_shown(self, over: bool) -> bool {
        if over { self.over } else { self.under_way }
    }

    /// The other way round from how it is.
    pub fn toggle(&mut self, over: bool) {
        let shown = if over { &mut self.over } else { &mut self.under_way };
        *shown = !*shown;
    }
}

/// What the map shows besides the walls, the objects and the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layers {
    /// Contacts, where the outline is known already.
    pub contacts: Layer,
    /// Where the robot went.
    pub trajectory: Layer,
    /// The lines of the plan.
    pub plan: Layer,
    /// The lines rejected from it.
    pub rejected: Layer,
    /// The numbers of the walls.
    pub walls: Layer,
}

impl Default for Layers {
    fn default() -> Self {
        Self {
            contacts: Layer::HIDDEN,
            trajectory: Layer::UNDER_WAY,
            plan: Layer::UNDER_WAY,
            rejected: Layer::HIDDEN,
            walls: Layer::HIDDEN,
        }
    }
}

/// A short remark in the footer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hint {
    /// What it says.
    pub text: String,
    /// Whether something was refused.
    pub refusal: bool,
    /// How things stand while it is true; none where it stays true.
    pub while_so: Option<Standing>,
}

/// How things stand with the run: what a remark may be about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Standing {
    /// Whether the robot may move.
    pub run: RunState,
    /// Whether a stop holds.
    pub latched: bool,
    /// Whether the robot is heard.
    pub heard: bool,
}

impl Standing {
    /// How things stand in `snapshot`.
    #[must_use]
    pub fn of(snapshot: &Snapshot) -> Self {
        let heard = matches!(snapshot.robot, Known::Known(_));
        Self { run: snapshot.run, latched: snapshot.latched, heard }
    }
}

/// A value that was asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asked {
    /// What it was.
    pub from: f64,
    /// What it is to be.
    pub to: f64,
}

/// How far the log is scrolled back. Events are counted from the first of the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LogView {
    /// The first event that is no longer shown.
    pub end: u64,
    /// As many events there were when the operator scrolled: an alarm after that brings the newest back.
    pub known: u64,
}

/// What the console remembers.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Width and height of the terminal in cells.
    pub size: (u16, u16),
    /// Where the map looks.
    pub camera: Camera,
    /// What lies over it.
    pub overlay: Overlay,
    /// The remark of the last key.
    pub hint: Option<Hint>,
    /// How fast simulated time passes; none where time is not ours.
    pub speed: Option<Speed>,
    /// What the map shows.
    pub layers: Layers,
    /// The α that was asked for last, and what it was when it was: until the run has heard of it, another
    /// step goes on from there.
    pub asked_alpha: Option<Asked>,
    /// Where the log looks, if not at what happened last.
    pub log: Option<LogView>,
    /// Whether the log shows routine lines.
    pub log_detail: bool,
    /// The commands typed before, for the up arrow.
    pub past: Past,
    /// The keys.
    pub keymap: Keymap,
}

impl Model {
    /// The remark of the last key, if it is still true.
    #[must_use]
    pub fn remark(&self, snapshot: &Snapshot) -> Option<&Hint> {
        let so = |hint: &&Hint| hint.while_so.is_none_or(|then| then == Standing::of(snapshot));
        self.hint.as_ref().filter(so)
    }

    /// What commands are for.
    #[must_use]
    pub fn steered(&self, snapshot: &Snapshot) -> Steered {
        match self.speed {
            _ if snapshot.recorded => Steered::Replay,
            Some(_) => Steered::Simulator,
            None => Steered::Robot,
        }
    }

    /// Whether the robot at the other end of the line was never heard: what it is told is lost.
    #[must_use]
    pub fn is_alone(&self, snapshot: &Snapshot) -> bool {
        self.steered(snapshot) == Steered::Robot && matches!(snapshot.robot, Known::Unknown)
    }

    /// A fresh console of `cols` by `rows` cells.
    #[must_use]
    pub fn new(cols: u16, rows: u16, keymap: Keymap) -> Self {
        Self {
            size: (cols, rows),
            camera: Camera::default(),
            overlay: Overlay::default(),
            hint: None,
            speed: Some(Speed::default()),
            layers: Layers::default(),
            asked_alpha: None,
            log: None,
            log_detail: true,
            past: Past::default(),
            keymap,
        }
    }
}
