//! What the console needs of whatever runs the robot: the embedded simulator, a real robot or a
//! recorded run. The console never looks behind it.

use crate::robot::Intent;
use crate::session::Snapshot;
use std::path::Path;

/// A run as the console sees it. No call may wait.
pub trait Driver {
    /// The state as it is now.
    fn snapshot(&self) -> Snapshot;

    /// Changes whenever [`Driver::snapshot`] would differ from before. The console draws a frame
    /// only when this has changed, or a key was pressed.
    fn version(&self) -> u64;

    /// Takes a wish of the operator, and never waits. With [`Intent::Stop`] a simulated robot is told to stop
    /// within this call; to a real one it is then on its way, before everything else.
    fn intent(&mut self, intent: Intent);

    /// Lets `seconds` of the robot's time pass. What owns no time of its own (a real robot) does
    /// here what is due; a paused simulator lets the command in hand end and then stands still.
    fn advance(&mut self, seconds: f64);

    /// The operator sees how things are, and what they press is heard. To be called again and again; what
    /// drives by itself stops when nobody calls.
    fn attended(&mut self) {}

    /// Why the run cannot go on, when what runs it has failed.
    fn failure(&self) -> Option<String> {
        None
    }

    /// Whether the robot's time is ours to stretch: a simulator or a recording.
    fn has_own_time(&self) -> bool {
        true
    }

    /// Whether nothing changes until the operator says something: no time needs to pass.
    fn is_at_rest(&self) -> bool {
        false
    }

    /// Goes to an instant of the record, robot seconds since the run began, and answers in a few words.
    ///
    /// # Errors
    /// In words, when there is no record, or not as much of it.
    fn go_to(&mut self, seconds: f64) -> Result<String, String> {
        Err(format!("no robot goes to {seconds:.0} s; a replay does"))
    }

    /// Writes the map so far to `dir` and answers, in a few words, what was written.
    ///
    /// # Errors
    /// In words for the operator.
    fn export(&mut self, dir: &Path) -> Result<String, String>;
}

/// How fast simulated time passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Speed(usize);

/// The steps, in times real time; the last is as fast as it goes.
const STEPS: [u32; 9] = [1, 2, 5, 10, 20, 50, 100, 200, 500];

impl Default for Speed {
    /// Ten times: a robot at 0.2 m/s is seen to move.
    fn default() -> Self {
        Self(3)
    }
}

impl Speed {
    /// As fast as it goes.
    pub const MAX: Self = Self(STEPS.len());

    /// Times real time; none for as fast as it goes.
    #[must_use]
    pub fn times(self) -> Option<f64> {
        STEPS.get(self.0).map(|&times| f64::from(times))
    }

    /// The step with this many times real time, if there is one.
    #[must_use]
    pub fn of(times: f64) -> Option<Self> {
        STEPS.iter().position(|&step| f64::from(step) == times).map(Self)
    }

    /// One step faster, or the same at the end.
    #[must_use]
    pub fn faster(self) -> Self {
        Self((self.0 + 1).min(STEPS.len()))
    }

    /// One step slower, or the same at the end.
    #[must_use]
    pub fn slower(self) -> Self {
        Self(self.0.saturating_sub(1))
    }

    /// Every step as it is written, for messages.
    #[must_use]
    pub fn all() -> String {
        let steps: Vec<String> = STEPS.iter().map(u32::to_string).collect();
        format!("{} or max", steps.join(", "))
    }
}

impl std::fmt::Display for Speed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match STEPS.get(self.0) {
            Some(times) => write!(f, "×{times}"),
            None => f.write_str("×max"),
        }
    }
}

/// Real time and what asks the program to end, for the loop; both live in the runtime.
pub trait Clock {
    /// Real time since this was asked last; the time that may be spent begins here.
    fn since_last(&mut self) -> std::time::Duration;

    /// Whether this much real time went by since [`Clock::since_last`].
    fn has_spent(&self, budget: std::time::Duration) -> bool;

    /// Wakes the loop this often.
    fn ticker(&self, every: std::time::Duration) -> tokio::time::Interval;

    /// Whether `pause` went by since this last said yes.
    fn frame_is_due(&mut self, pause: std::time::Duration) -> bool;

    /// The number of the signal that asked the program to end, if one did.
    fn signal(&self) -> Option<u8>;
}
