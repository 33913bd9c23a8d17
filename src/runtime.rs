//! Running things in real time: the only clock, the signals, and the files that are written.
//! It decides nothing about mapping; what it drives is a [`Runner`].

pub mod clock;
pub mod driver;
pub mod folder;
pub mod line;
pub mod live;
pub mod progress;
pub mod recorded;
pub mod robot;
pub mod signals;
pub mod simulated;

pub use clock::Stopwatch;
pub use folder::{FolderError, OutputFolder};
pub use signals::{Signal, Signals};

use crate::export::{Outcome, RunRecord};
use crate::journal::{Journal, PhaseEnd, state_hash};
use crate::mapping::event::Failure;
use crate::mapping::map::Phase;
use crate::session::{Outgoing, RunState, Session};
use progress::Bar;
use std::io::Write;

/// A run that can be driven step by step without waiting: a session over a simulated robot.
pub trait Runner {
    /// Goes on by one control step. After [`Step::Ended`] it is not called again.
    fn step(&mut self) -> Step;

    /// Stops the robot at once, by the way that waits for nothing.
    fn stop(&mut self);

    /// How far the run has come.
    fn progress(&self) -> Progress;

    /// What there is to tell, now that the run has ended this way; `wall_seconds` is how long it
    /// took.
    fn record<'a>(&'a self, ending: &'a Ending, wall_seconds: f64) -> RunRecord<'a>;

    /// Ends the record of the run: what is in memory is written.
    ///
    /// # Errors
    /// When part of the record could not be written.
    fn finish_journal(&mut self) -> std::io::Result<()>;
}

/// What one step came to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// There is more to do.
    Going,
    /// The run is over.
    Ended(Ending),
}

/// How a run ended and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ending {
    /// How.
    pub outcome: Outcome,
    /// Why, in words.
    pub reason: String,
}

impl Ending {
    /// How a session ended; none while there is more to do.
    #[must_use]
    pub fn of(session: &Session) -> Option<Self> {
        let (outcome, reason) = match session.run_state() {
            RunState::Complete => {
                let map = session.mission().map();
                let tape = map.untaped.map_or_else(String::new, |why| format!("; {why}"));
                if let Some(phase) = session.ended_with() {
                    let reason = format!("{phase} phase done, no further was asked for{tape}");
                    return Some(Self { outcome: Outcome::Complete, reason });
                }
                let owed = map.shortfall();
                let but = owed.map_or_else(String::new, |owed| format!(", but {owed}"));
                (Outcome::Complete, format!("all four phases done{but}{tape}"))
            }
            RunState::Failed(Failure::Ended) => (Outcome::Stopped, Failure::Ended.to_string()),
            RunState::Failed(why) => (Outcome::Failed, why.to_string()),
            _ => return None,
        };
        Some(Self { outcome, reason })
    }
}

/// Records what leaves a session; a command goes to the robot only after this.
fn keep<W: Write>(journal: &mut Option<Journal<W>>, session: &Session, outgoing: &Outgoing) {
    let Some(journal) = journal else { return };
    let time_us = session.mission().tracker().time_us();
    match outgoing {
        Outgoing::Command(command) => journal.command(time_us, command),
        Outgoing::Event(event) => journal.event(time_us, event),
        Outgoing::PhaseEnded(phase) => {
            let state = state_hash(session.mission().map());
            journal.phase_end(time_us, &PhaseEnd { phase: *phase, state });
        }
        // The wish that led to it is in the record already.
        Outgoing::Stop => {}
    }
}

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// The phase it is in.
    pub phase: Phase,
    /// Share of that phase that is done, 0 to 1, where it can be told.
    pub share: Option<f64>,
    /// Robot time since the first report of the run, seconds.
    pub time: f64,
    /// Metres travelled so far.
    pub travel: f64,
}

/// A run that was driven to its end.
#[derive(Debug, Clone, PartialEq)]
pub struct Driven {
    /// How it ended.
    pub ending: Ending,
    /// The signal that ended it, if one did.
    pub signal: Option<Signal>,
    /// How long it took, seconds.
    pub wall_seconds: f64,
}

impl Driven {
    /// Exit status: 0 complete, 1 short of the goal, 129, 130 or 143 after a signal.
    #[must_use]
    pub fn status(&self) -> u8 {
        match (self.signal, self.ending.outcome) {
            (Some(signal), _) => signal.status(),
            (None, Outcome::Complete) => 0,
            (None, _) => 1,
        }
    }
}

/// Steps between two looks at the clock: often enough for a smooth bar, seldom enough to cost
/// nothing.
const STEPS_PER_LOOK: u32 = 512;

/// Drives `runner` to its end, or until a signal asks to stop.
pub fn drive(runner: &mut dyn Runner, signals: &Signals) -> Driven {
    let watch = Stopwatch::start();
    let mut bar = Bar::new();
    let (ending, signal) = 'run: loop {
        for _ in 0..STEPS_PER_LOOK {
            if let Some(signal) = signals.received() {
                runner.stop();
                let reason = format!("stopped by {}", signal.name());
                break 'run (Ending { outcome: Outcome::Stopped, reason }, Some(signal));
            }
            if let Step::Ended(ending) = runner.step() {
                break 'run (ending, None);
            }
        }
        bar.show(&runner.progress(), watch.seconds());
    };
    bar.clear();
    Driven { ending, signal, wall_seconds: watch.seconds() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::sample;

    /// A run of a given number of steps.
    struct Counting {
        left: u32,
        stopped: bool,
        sample: sample::Sample,
    }

    impl Runner for Counting {
        fn step(&mut self) -> Step {
            assert!(!self.stopped, "a stopped run was stepped");
            match self.left.checked_sub(1) {
                Some(left) => {
                    self.left = left;
                    Step::Going
                }
                None => Step::Ended(Ending {
                    outcome: Outcome::Complete,
                    reason: "map complete".to_owned(),
                }),
            }
        }

        fn stop(&mut self) {
            self.stopped = true;
        }

        fn progress(&self) -> Progress {
            Progress { phase: Phase::Boundary, share: None, time: 0.0, travel: 0.0 }
        }

        fn record<'a>(&'a self, ending: &'a Ending, wall_seconds: f64) -> RunRecord<'a> {
            RunRecord {
                outcome: ending.outcome,
                reason: &ending.reason,
                wall_seconds,
                ..self.sample.record()
            }
        }

        fn finish_journal(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    fn counting(left: u32) -> Counting {
        Counting { left, stopped: false, sample: sample::room() }
    }

    #[test]
    fn a_run_is_driven_to_its_end() {
        let mut run = counting(2000);
        let driven = drive(&mut run, &Signals::none());
        assert_eq!(driven.ending.outcome, Outcome::Complete);
        assert_eq!(driven.status(), 0);
        assert_eq!(run.left, 0, "every step was taken");
        let record = run.record(&driven.ending, driven.wall_seconds);
        assert_eq!(record.reason, "map complete");
    }

    #[test]
    fn a_signal_stops_the_robot_and_gives_its_status() {
        for (signal, status) in [(Signal::Interrupt, 130), (Signal::Terminate, 143)] {
            let signals = Signals::none();
            signals.raise(signal);
            let mut run = counting(2000);
            let driven = drive(&mut run, &signals);
            assert!(run.stopped, "{signal:?} must stop the robot");
            assert_eq!(driven.ending.outcome, Outcome::Stopped);
            assert_eq!(driven.status(), status);
        }
    }
}
