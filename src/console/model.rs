//! What the console itself remembers: where the map looks, what lies over it, what was typed.
//! Nothing of the run: that is the snapshot's.

use super::driver::Speed;
use super::keymap::Keymap;
use crate::geometry::Point;

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
    /// The command line with what was typed so far.
    Line(String),
    /// The question whether to leave although the robot moves.
    ConfirmQuit,
    /// The question whether to end the run here.
    ConfirmFinish,
}

/// Whether a layer of the map is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Layer {
    /// As long as the run goes on: it tells what is done. What is handed over at the end is a map.
    #[default]
    UnderWay,
    /// Always.
    Shown,
    /// Never.
    Hidden,
}

impl Layer {
    /// Whether it is shown, when the run is `over` or not.
    #[must_use]
    pub fn is_shown(self, over: bool) -> bool {
        self == Self::Shown || (self == Self::UnderWay && !over)
    }

    /// The other way round from how it is.
    pub fn toggle(&mut self, over: bool) {
        *self = if self.is_shown(over) { Self::Hidden } else { Self::Shown };
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
}

impl Default for Layers {
    fn default() -> Self {
        Self {
            contacts: Layer::Hidden,
            trajectory: Layer::UnderWay,
            plan: Layer::UnderWay,
            rejected: Layer::Hidden,
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
    /// How many log lines the view is scrolled back.
    pub log_back: usize,
    /// Whether the log shows routine lines.
    pub log_detail: bool,
    /// The command typed last, for the up arrow.
    pub last_line: String,
    /// The keys.
    pub keymap: Keymap,
}

impl Model {
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
            log_back: 0,
            log_detail: true,
            last_line: String::new(),
            keymap,
        }
    }
}
