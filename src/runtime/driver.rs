//! The console's driver over a simulated run, and the console's clock.

use super::simulated::SimulatedRun;
use super::{OutputFolder, Signals, Stopwatch, folder};
use crate::console::driver::{Clock, Driver};
use crate::firmware::STEP;
use crate::robot::Intent;
use crate::session::Snapshot;
use std::io::Write;
use std::path::Path;
use std::time::Duration;

/// A simulated run under an operator's hands.
pub struct SimulatedDriver<W: Write> {
    run: SimulatedRun<W>,
    /// Robot time that is owed, seconds: less than a step.
    owed: f64,
    watch: Stopwatch,
    folder: Option<OutputFolder>,
    /// Which state of the run the results that were written are of.
    written: Option<u64>,
}

impl<W: Write> SimulatedDriver<W> {
    /// Hands `run` to the operator; from now on its time on the wall clock is taken.
    #[must_use]
    pub fn new(run: SimulatedRun<W>) -> Self {
        Self { run, owed: 0.0, watch: Stopwatch::start(), folder: None, written: None }
    }

    /// The same run, whose results go to `folder` as soon as it has ended: whatever becomes of the
    /// console after that, they are there.
    #[must_use]
    pub fn writing_to(self, folder: OutputFolder) -> Self {
        Self { folder: Some(folder), ..self }
    }

    /// Writes the results of a run that has ended and stands still, and again when the operator changed
    /// something after that.
    fn write_ended(&mut self) {
        let version = self.run.session().version();
        let Some(folder) = &self.folder else { return };
        if self.written == Some(version) || self.run.is_under_way() || self.run.ending().is_none() {
            return;
        }
        self.run.write_results(folder, self.watch.seconds());
        self.written = Some(self.run.session().version());
    }

    /// How long the operator has had the run, seconds.
    #[must_use]
    pub fn wall_seconds(&self) -> f64 {
        self.watch.seconds()
    }

    /// The run, when the operator has left.
    #[must_use]
    pub fn into_run(self) -> SimulatedRun<W> {
        self.run
    }
}

impl<W: Write> Driver for SimulatedDriver<W> {
    fn snapshot(&self) -> Snapshot {
        self.run.snapshot()
    }

    fn version(&self) -> u64 {
        self.run.session().version()
    }

    fn intent(&mut self, intent: Intent) {
        self.run.intent(intent);
    }

    fn advance(&mut self, seconds: f64) {
        self.write_ended();
        self.owed += seconds;
        while self.owed >= STEP {
            self.owed -= STEP;
            // While nothing is under way simulated time stands still.
            if !self.run.is_under_way() {
                self.owed = 0.0;
                return;
            }
            self.run.advance();
        }
    }

    fn is_at_rest(&self) -> bool {
        !self.run.is_under_way()
    }

    fn export(&mut self, dir: &Path) -> Result<String, String> {
        self.run.export(&folder::named(dir)?, self.watch.seconds())
    }
}

/// Real time and signals for the console's loop.
pub struct RealClock {
    watch: Stopwatch,
    signals: Signals,
    last: f64,
    frame: f64,
}

impl RealClock {
    /// Starts now.
    #[must_use]
    pub fn start(signals: Signals) -> Self {
        Self { watch: Stopwatch::start(), signals, last: 0.0, frame: -1.0 }
    }
}

impl Clock for RealClock {
    fn since_last(&mut self) -> Duration {
        let now = self.watch.seconds();
        let passed = now - self.last;
        self.last = now;
        Duration::from_secs_f64(passed.max(0.0))
    }

    fn has_spent(&self, budget: Duration) -> bool {
        self.watch.seconds() - self.last > budget.as_secs_f64()
    }

    fn ticker(&self, every: Duration) -> tokio::time::Interval {
        tokio::time::interval(every)
    }

    fn frame_is_due(&mut self, pause: Duration) -> bool {
        let now = self.watch.seconds();
        let due = now - self.frame >= pause.as_secs_f64() * 0.9;
        if due {
            self.frame = now;
        }
        due
    }

    fn signal(&self) -> Option<u8> {
        self.signals.received().map(super::Signal::number)
    }
}
