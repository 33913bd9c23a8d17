//! What a run over a line tells: the state for the screen, how it ended, the results.

use super::LiveRun;
use crate::export::{Outcome, RunRecord};
use crate::mapping::event::{Event, EventKind};
use crate::runtime::{Ending, Progress};
use crate::session::{Known, Session, Snapshot};
use crate::wire::Health;
use std::io::Write;

impl<W: Write> LiveRun<W> {
    /// Changes whenever the snapshot would differ, the age of what is old included.
    #[must_use]
    pub fn version(&self, now: f64) -> u64 {
        let tenths = self.age(now).map_or(0, |age| (age * 10.0) as u64 + 1);
        let changes = self.version + self.session.as_ref().map_or(0, Session::version);
        changes.wrapping_mul(1 << 24).wrapping_add(tenths)
    }

    /// The state for the screen; what is old says so.
    #[must_use]
    pub fn snapshot(&self, now: f64) -> Snapshot {
        let Some(session) = &self.session else {
            let mut waiting = Snapshot::waiting(self.plan.settings.clone(), self.plan.port.clone());
            if let Some(ending) = &self.ended {
                waiting.source = format!("{}: {}", self.plan.port, ending.reason);
                // The header has no room for all of it.
                let kind = EventKind::Alarm { what: ending.reason.clone() };
                waiting.events.push(Event { time_us: 0, kind });
            }
            return waiting;
        };
        let mut snapshot = session.snapshot();
        if let Some(age) = self.age(now)
            && let Known::Known(value) = snapshot.robot
        {
            snapshot.robot = Known::Stale { value, age };
        }
        snapshot
    }

    /// How old it is what the run knows of its robot, seconds; none when it is current.
    fn age(&self, now: f64) -> Option<f64> {
        let up = self.host.health() == Health::Up && self.disbelieved.is_none();
        let fault = self.session.as_ref().is_some_and(|session| session.fault().is_some());
        let old = !up || fault || self.stranger().is_some();
        old.then_some(now - self.taken)
    }

    /// How far the run has come; none before the robot is there.
    #[must_use]
    pub fn progress(&self) -> Option<Progress> {
        let session = self.session.as_ref()?;
        let mission = session.mission();
        Some(Progress {
            phase: mission.phase(),
            share: mission.share(),
            time: mission.tracker().passed(),
            travel: session.progress().iter().map(|phase| phase.travel).sum(),
        })
    }

    /// The program failed with `why`: what is shown from now on is old.
    pub fn broke(&mut self, why: String) {
        self.host.unplugged(&mut Vec::new());
        self.end(Outcome::Failed, why);
    }

    /// How the run ended; none while there is more to do.
    #[must_use]
    pub fn ending(&self) -> Option<Ending> {
        self.session.as_ref().and_then(Ending::of).or_else(|| self.ended.clone())
    }

    /// Whether there is a run that has not come to its end, whatever ended it here: its record can be gone on with.
    #[must_use]
    pub fn can_go_on(&self) -> bool {
        self.session.as_ref().is_some_and(|session| Ending::of(session).is_none())
    }

    /// Whether the record could not be written, from its beginning or from some time on.
    #[must_use]
    pub fn is_unrecorded(&self) -> bool {
        self.unrecorded
    }

    /// Fixes the map for [`LiveRun::record`] and ends the record of the run.
    ///
    /// # Errors
    /// When part of the record could not be written.
    pub fn conclude(&mut self) -> std::io::Result<()> {
        if let Some(session) = &self.session {
            self.map = session.mission().map_now();
        }
        self.journal.take().map_or(Ok(()), |journal| journal.finish().map(|_| ()))
    }

    /// What there is to tell; none when the robot never said who it is.
    #[must_use]
    pub fn record<'a>(&'a self, ending: &'a Ending, wall_seconds: f64) -> Option<RunRecord<'a>> {
        let session = self.session.as_ref()?;
        let mission = session.mission();
        Some(RunRecord {
            map: &self.map,
            settings: mission.settings(),
            outcome: ending.outcome,
            reason: &ending.reason,
            world: session.source(),
            noise: "",
            progress: *session.progress(),
            laps: mission.laps(),
            bumps: mission.bumps(),
            contact: 0.0,
            true_path: None,
            wall_seconds,
        })
    }
}
