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
    /// When the record was handed on last, on the wall clock, seconds.
    handed_on: f64,
}

/// A program that is killed loses no more than so much of its record, wall seconds: a simulated run is made
/// again by its seed, but the keys of its operator are not.
const LOST_AT_MOST: f64 = 1.0;

impl<W: Write> SimulatedDriver<W> {
    /// Hands `run` to the operator; from now on its time on the wall clock is taken.
    #[must_use]
    pub fn new(run: SimulatedRun<W>) -> Self {
        Self {
            run,
            owed: 0.0,
            watch: Stopwatch::start(),
            folder: None,
            written: None,
            handed_on: 0.0,
        }
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
        while self.owed >= STEP && self.run.is_under_way() {
            self.owed -= STEP;
            self.run.advance();
        }
        let now = self.watch.seconds();
        // While nothing is under way simulated time stands still.
        if !self.run.is_under_way() {
            self.owed = 0.0;
            self.run.hand_record_on();
        } else if now - self.handed_on > LOST_AT_MOST {
            self.handed_on = now;
            self.run.hand_record_on();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::reader::parse;
    use crate::journal::{Header, Journal};
    use crate::mapping::settings::Settings;
    use crate::simulator::{NoiseProfile, World};
    use std::cell::RefCell;
    use std::io;
    use std::rc::Rc;

    /// A file that others read while it is written.
    #[derive(Clone, Default)]
    struct Shared(Rc<RefCell<Vec<u8>>>);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.borrow_mut().extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_console_that_is_killed_between_two_commands_has_recorded_the_first() {
        let text = include_str!("../../sims/rectangle.toml");
        let world = World::from_toml(text, "rectangle", 0.1).expect("a world");
        let header = Header {
            settings: Settings::new(world.start),
            source: "rectangle".to_owned(),
            noise: String::new(),
            until: None,
            robot: None,
        };
        let file = Shared::default();
        let journal = Journal::begin(file.clone(), &header).expect("memory");
        let run = SimulatedRun::new(&world, header, NoiseProfile::None, Some(journal));
        let mut driver = SimulatedDriver::new(run);
        driver.intent(Intent::StepCommand);
        for _ in 0..1000 {
            driver.advance(0.1);
            if driver.is_at_rest() {
                break;
            }
        }
        let recording = parse(Path::new("journal"), &file.0.borrow()).expect("a record");
        assert!(recording.torn.is_none());
        let mut replay = crate::session::Replay::new(recording);
        replay.finish();
        let time = |session: &crate::session::Session| session.mission().tracker().time_us();
        assert_eq!(time(replay.session()), time(driver.run.session()));
        assert!(time(replay.session()) > 1_000_000, "it drove");
    }
}
