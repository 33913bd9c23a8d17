//! A record played back into the session that it came from. The core is deterministic, so the same
//! telemetry and the same wishes must give the same commands and, at the end of every phase, the
//! same state; where they do not, the replay says so and is no longer to be believed.

use super::{Outgoing, RunState, Session};
use crate::journal::{Entry, Header, PhaseEnd, Record, Recording, Torn, state_hash};
use crate::mapping::event::{Event, EventKind, Severity};
use crate::mapping::map::Phase;
use crate::robot::Command;
use std::collections::VecDeque;

/// Where a replay and its record part.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Difference {
    /// The record has a command that the session did not give, or another one.
    #[error("record {record}: the run sent command {recorded}, the replay {replayed}")]
    Command {
        /// Number of the record.
        record: usize,
        /// What the run sent.
        recorded: u32,
        /// What the session gave, or "none".
        replayed: String,
    },
    /// The state at the end of a phase is another one.
    #[error("record {record}: the {phase} phase ended with another state than in the run")]
    State {
        /// Number of the record.
        record: usize,
        /// Which phase.
        phase: Phase,
    },
}

/// What a record came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Landmark {
    /// A command went out.
    Command,
    /// Something worth a stop happened.
    Event,
    /// A phase ended.
    PhaseEnd,
    /// Neither.
    Nothing,
}

/// A record on its way through a session.
#[derive(Debug, Clone)]
pub struct Replay {
    session: Session,
    /// Robot time of the first report, microseconds.
    began_us: u64,
    records: Vec<Record>,
    next: usize,
    given: VecDeque<Command>,
    outgoing: Vec<Outgoing>,
    ends: Vec<PhaseEnd>,
    /// Alarms that the session raised by itself and the record has not come to yet.
    alarms: VecDeque<Event>,
    difference: Option<Difference>,
    /// Whether a real robot made it.
    of_a_robot: bool,
    torn: Option<Torn>,
}

impl Replay {
    /// At the beginning of `recording`.
    #[must_use]
    pub fn new(recording: Recording) -> Self {
        let Header { settings, source, until, robot, .. } = recording.header;
        let session = Session::new(settings, source, until.unwrap_or(Phase::Objects));
        Self {
            began_us: began_us(session.clone(), &recording.records),
            session,
            records: recording.records,
            next: 0,
            given: VecDeque::new(),
            outgoing: Vec::new(),
            ends: Vec::new(),
            alarms: VecDeque::new(),
            difference: None,
            of_a_robot: robot.is_some(),
            torn: recording.torn,
        }
    }

    /// The session as it was at this place of the record.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The session, to go on with, and the commands that it gave and the record does not have: it
    /// was cut off between a cause and its effect.
    #[must_use]
    pub fn into_session(self) -> (Session, Vec<Command>) {
        (self.session, self.given.into())
    }

    /// Where replay and record parted first, if they did.
    #[must_use]
    pub fn difference(&self) -> Option<&Difference> {
        self.difference.as_ref()
    }

    /// The ends of phases passed so far, with the state found in this replay.
    #[must_use]
    pub fn ends(&self) -> &[PhaseEnd] {
        &self.ends
    }

    /// Whether it is the record of a real robot, with which the run may go on.
    #[must_use]
    pub fn is_of_a_robot(&self) -> bool {
        self.of_a_robot
    }

    /// What was cut off the end of the record.
    #[must_use]
    pub fn torn(&self) -> Option<Torn> {
        self.torn
    }

    /// Whether the record is over.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.next >= self.records.len()
    }

    /// Robot time of the next record, seconds since the run began; none at the end.
    #[must_use]
    pub fn next_time(&self) -> Option<f64> {
        self.records.get(self.next).map(|record| self.since_it_began(record))
    }

    /// Robot time of the last record, seconds since the run began.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.records.last().map_or(0.0, |record| self.since_it_began(record))
    }

    fn since_it_began(&self, record: &Record) -> f64 {
        record.time_us.saturating_sub(self.began_us) as f64 * 1e-6
    }

    /// Takes the next record.
    pub fn step(&mut self) -> Landmark {
        let Some(record) = self.records.get(self.next).cloned() else {
            return Landmark::Nothing;
        };
        let number = self.next;
        self.next += 1;
        match record.entry {
            Entry::Telemetry(telemetry) => {
                self.session.telemetry(&telemetry, &mut self.outgoing);
                self.collect();
                Landmark::Nothing
            }
            Entry::Intent(intent) => {
                self.session.intent(intent, &mut self.outgoing);
                self.collect();
                Landmark::Nothing
            }
            Entry::Command(recorded) => {
                let given = self.given.pop_front();
                if given != Some(recorded) {
                    let replayed =
                        given.map_or_else(|| "none".to_owned(), |command| command.id.0.to_string());
                    let recorded = recorded.id.0;
                    self.differ(Difference::Command { record: number, recorded, replayed });
                }
                Landmark::Command
            }
            Entry::PhaseEnd(end) => {
                if !self.ends.contains(&end) {
                    self.differ(Difference::State { record: number, phase: end.phase });
                }
                Landmark::PhaseEnd
            }
            Entry::Event(event) => {
                let is_worth_it = event.kind.severity() >= Severity::Notice;
                self.remarked(event);
                if is_worth_it { Landmark::Event } else { Landmark::Nothing }
            }
            Entry::Life(_) => Landmark::Nothing,
        }
    }

    /// What was remarked of the link comes from no report: without the record nobody would hear of it again.
    fn remarked(&mut self, event: Event) {
        if !matches!(event.kind, EventKind::Alarm { .. }) {
            return;
        }
        if let Some(own) = self.alarms.iter().position(|own| *own == event) {
            self.alarms.remove(own);
        } else {
            self.session.remarked(event);
        }
    }

    /// Takes every record up to robot time `seconds` since the run began.
    pub fn advance_to(&mut self, seconds: f64) {
        while self.next_time().is_some_and(|time| time <= seconds) {
            self.step();
        }
    }

    /// Takes records until one of the kind `until`, or the end.
    pub fn advance_until(&mut self, until: Landmark) {
        while !self.is_over() && self.step() != until {}
    }

    /// Takes every record that is left.
    pub fn finish(&mut self) {
        while !self.is_over() {
            self.step();
        }
    }

    fn collect(&mut self) {
        for outgoing in self.outgoing.drain(..) {
            match outgoing {
                Outgoing::Command(command) => self.given.push_back(command),
                Outgoing::PhaseEnded(phase) => {
                    let state = state_hash(self.session.mission().map());
                    self.ends.push(PhaseEnd { phase, state });
                }
                Outgoing::Event(event) if matches!(event.kind, EventKind::Alarm { .. }) => {
                    self.alarms.push_back(event);
                }
                Outgoing::Stop | Outgoing::Event(_) => {}
            }
        }
    }

    fn differ(&mut self, difference: Difference) {
        self.difference.get_or_insert(difference);
    }

    /// Whether the record ends with its run at an end.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        matches!(self.session.run_state(), RunState::Complete | RunState::Failed(_))
    }
}

/// Robot time, microseconds, of the first report that a `session` at its beginning believes: a real robot counts
/// from when it was switched on, and the run from there.
fn began_us(mut session: Session, records: &[Record]) -> u64 {
    let first = records.iter().find_map(|record| {
        let Entry::Telemetry(telemetry) = &record.entry else { return None };
        session.telemetry(telemetry, &mut Vec::new());
        session.mission().tracker().last()
    });
    first.map_or(0, |first| first.time_us)
}
