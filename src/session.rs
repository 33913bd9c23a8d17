//! One step of the whole: mapping core, gate and records behind one door.
//!
//! Telemetry and intents go in; commands, stops and events come out. The session decides *whether*
//! the robot may go on (run, pause, step, stop); the mission decides *how*.

pub mod replay;
pub mod snapshot;

pub use replay::Replay;
pub use snapshot::{Ended, Known, PhaseProgress, RobotView, RunState, Snapshot, Step};

use crate::mapping::event::{Event, EventKind, Failure, Severity};
use crate::mapping::map::Phase;
use crate::mapping::mission::{Mission, Outcome, Output};
use crate::mapping::settings::{MOST_LAPS, Settings};
use crate::mapping::tape::Tape;
use crate::robot::{Command, CommandId, DoneReason, Intent, Telemetry};
use crate::safety::{Gate, Leap, Watch};
use std::collections::VecDeque;

/// What leaves the session.
#[derive(Debug, Clone, PartialEq)]
pub enum Outgoing {
    /// To the robot.
    Command(Command),
    /// To the robot, past everything else.
    Stop,
    /// To the record.
    Event(Event),
    /// A phase ended: the record is worth keeping safe now.
    PhaseEnded(Phase),
}

/// Events that are kept for the screen.
const KEPT_EVENTS: usize = 500;

/// A mission decides so often at most without a motion: one that does more is at fault.
const MOST_DECISIONS: usize = 1000;

/// A run, as the operator sees it.
#[derive(Debug, Clone)]
pub struct Session {
    mission: Mission,
    gate: Gate,
    watch: Watch,
    /// What the robot said last cannot be.
    fault: Option<Leap>,
    /// The motion whose end was told by a message that cannot be.
    unended: Option<CommandId>,
    run: RunState,
    until: Phase,
    progress: [PhaseProgress; 4],
    command: Option<(Command, &'static str)>,
    done: Option<(Command, &'static str, Option<DoneReason>)>,
    events: VecDeque<Event>,
    /// Events before those.
    forgotten: u64,
    source: String,
    heard: bool,
    version: u64,
}

impl Session {
    /// A run that ends with the phase `until`; `source` is what the screen calls the robot, unless the map
    /// has a name. It waits for the operator.
    #[must_use]
    pub fn new(settings: Settings, source: String, until: Phase) -> Self {
        let source = settings.name.clone().unwrap_or(source);
        Self {
            gate: Gate::new(&settings.chassis),
            watch: Watch::new(&settings.chassis),
            fault: None,
            unended: None,
            mission: Mission::new(settings),
            run: RunState::Paused,
            until,
            progress: [PhaseProgress::default(); 4],
            command: None,
            done: None,
            events: VecDeque::new(),
            forgotten: 0,
            source,
            heard: false,
            version: 0,
        }
    }

    /// The mapping core.
    #[must_use]
    pub fn mission(&self) -> &Mission {
        &self.mission
    }

    /// Whether the robot may move, and on whose word.
    #[must_use]
    pub fn run_state(&self) -> RunState {
        self.run
    }

    /// Whether a stop is latched: nothing moves before the operator clears it.
    #[must_use]
    pub fn is_latched(&self) -> bool {
        self.gate.is_latched()
    }

    /// The phase that was to end the run and has, short of a complete map; none otherwise.
    #[must_use]
    pub fn ended_with(&self) -> Option<Phase> {
        let short = self.run == RunState::Complete && self.mission.outcome() == Outcome::Going;
        short.then_some(self.until)
    }

    /// The four phases so far.
    #[must_use]
    pub fn progress(&self) -> &[PhaseProgress; 4] {
        &self.progress
    }

    /// What happened last, oldest first.
    #[must_use]
    pub fn events(&self) -> &VecDeque<Event> {
        &self.events
    }

    /// What the map or else the robot is called.
    #[must_use]
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Counts up whenever anything that a snapshot shows has changed.
    #[must_use]
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Why the last message of the robot was not believed; none when it was.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        self.fault.map(|leap| format!("the robot cannot be believed: {leap}"))
    }

    /// A message that cannot be true stops the robot and is not taken for a way that it went. Until the
    /// robot counts on from where it was believed to be, the stop comes back whenever it is cleared.
    fn disbelieve(&mut self, leap: Leap, out: &mut Vec<Outgoing>) {
        self.version += 1;
        self.fault = Some(leap);
        if self.gate.is_latched() {
            return;
        }
        out.push(Outgoing::Stop);
        self.gate.latch();
        if !matches!(self.run, RunState::Complete | RunState::Failed(_)) {
            self.run = RunState::Stopped;
        }
        // Without a boundary there is nothing to find its place by.
        let found = if self.mission.map().closed { ", and it finds its place again" } else { "" };
        let what = format!(
            "the robot cannot be believed: {leap}. Look at its encoders, its clock and the line; switch it off \
             and on{found}"
        );
        self.note(EventKind::Alarm { what }, out);
    }

    /// A motion whose end could not be believed has ended where the robot is next believed to stand.
    fn ended_with_it(&mut self, believed: Telemetry) -> Telemetry {
        match (believed, self.unended) {
            (Telemetry::Report { odometer, switches, bumper }, Some(id)) => {
                self.unended = None;
                Telemetry::Done { id, reason: DoneReason::Stopped, odometer, switches, bumper }
            }
            (Telemetry::Done { .. }, _) => {
                self.unended = None;
                believed
            }
            _ => believed,
        }
    }

    /// Takes one message of the robot and goes on if that is allowed.
    pub fn telemetry(&mut self, input: &Telemetry, out: &mut Vec<Outgoing>) {
        let input = match self.watch.admit(input) {
            Ok(believed) => self.ended_with_it(believed),
            Err(leap) => {
                if let Telemetry::Done { id, .. } = input {
                    self.unended = Some(*id);
                }
                return self.disbelieve(leap, out);
            }
        };
        self.fault = None;
        let phase = self.mission.phase() as usize;
        let tracker = self.mission.tracker();
        let (passed_us, travelled) = (tracker.passed_us(), tracker.travelled());
        let mut outputs = Vec::new();
        self.mission.telemetry(&input, &mut outputs);
        let tracker = self.mission.tracker();
        self.progress[phase].seconds += tracker.passed_us().saturating_sub(passed_us) as f64 * 1e-6;
        self.progress[phase].travel += tracker.travelled() - travelled;
        self.heard = true;
        self.version += 1;
        if !self.mission.is_moving()
            && let Some((command, why)) = self.command.take()
        {
            let reason = match input {
                Telemetry::Done { reason, .. } => Some(reason),
                Telemetry::Report { .. } | Telemetry::Edge(_) => None,
            };
            self.done = Some((command, why, reason));
        }
        self.pass_on(outputs, out);
        self.go_on(out);
    }

    /// Takes one wish of the operator.
    pub fn intent(&mut self, intent: Intent, out: &mut Vec<Outgoing>) {
        self.version += 1;
        let over = matches!(self.run, RunState::Complete | RunState::Failed(_));
        let (no_lap, no_lap_dropped) = (self.no_lap(), self.no_lap_dropped());
        match intent {
            Intent::Stop => {
                out.push(Outgoing::Stop);
                // A stop that holds already is no news, and would push what is out of the log.
                let holds = self.gate.is_latched();
                self.gate.latch();
                if !over {
                    self.run = RunState::Stopped;
                }
                if !holds {
                    self.note(EventKind::Stopped, out);
                }
            }
            Intent::ClearStop if self.gate.is_latched() => {
                self.gate.clear();
                if !over {
                    self.run = RunState::Paused;
                }
                self.note(EventKind::StopCleared, out);
            }
            Intent::ClearStop => {}
            Intent::SetAlpha { alpha } => self.wish(
                |mission, told| mission.set_alpha(alpha, told),
                "α stays: lines of this plan are driven already",
                out,
            ),
            Intent::SetTape { from, to, length } => self.wish(
                |mission, told| mission.set_tape(Tape { from, to, length }, told),
                "tape not used: lines of the plan are driven already",
                out,
            ),
            Intent::LapAgain => {
                self.wish(|mission, told| !over && mission.lap_again(told), no_lap, out);
            }
            Intent::LapAnew => {
                self.wish(|mission, told| !over && mission.lap_anew(told), no_lap_dropped, out);
            }
            Intent::Square => self.wish(
                |mission, told| {
                    mission.toggle_square(told);
                    true
                },
                "",
                out,
            ),
            Intent::Placed { near } => self.wish(
                |mission, told| !over && mission.placed(near, told),
                if over {
                    "the run is over: where the robot stands matters no more"
                } else {
                    "not while the robot moves: stop it first"
                },
                out,
            ),
            Intent::Finish => {
                out.push(Outgoing::Stop);
                let mut outputs = Vec::new();
                self.mission.finish(&mut outputs);
                self.pass_on(outputs, out);
                self.judge(out);
            }
            _ if over || self.gate.is_latched() => {}
            Intent::Run => self.run = RunState::Running,
            Intent::Pause => self.run = RunState::Paused,
            Intent::StepCommand => self.run = RunState::Stepping(Step::Command),
            Intent::StepEvent => self.run = RunState::Stepping(Step::Event),
            Intent::StepPhase => self.run = RunState::Stepping(Step::Phase),
        }
        self.go_on(out);
    }

    /// Whether all that keeps the operator from another lap is that nobody knows where the robot is.
    fn has_to_find_its_place(&self) -> bool {
        self.mission.is_lost() && self.mission.plan_is_open()
    }

    /// Why no other lap can be driven, where none can.
    fn no_lap(&self) -> &'static str {
        if self.run.is_over() {
            "no lap now: the run is over"
        } else if self.has_to_find_its_place() {
            "no lap now: the robot has to find its place first"
        } else if self.mission.settings().laps >= MOST_LAPS {
            "no lap more: as many are wanted as may be driven"
        } else {
            "no lap now: lines of the plan are driven already"
        }
    }

    /// Why no lap can be dropped, where none can.
    fn no_lap_dropped(&self) -> &'static str {
        if self.run.is_over() {
            return "no lap is dropped: the run is over";
        }
        if self.has_to_find_its_place() {
            return "no lap is dropped: the robot has to find its place first";
        }
        let again = self.mission.phase() == Phase::Boundary && self.mission.map().closed;
        if again && self.mission.is_moving() {
            "no lap is dropped while the robot moves: stop it first"
        } else {
            "no lap is dropped: none has closed, or lines of the plan are driven already"
        }
    }

    /// Passes a wish on to the mission; tells why when it is `refused`.
    fn wish(
        &mut self,
        wish: impl FnOnce(&mut Mission, &mut Vec<Output>) -> bool,
        refused: &str,
        out: &mut Vec<Outgoing>,
    ) {
        let mut outputs = Vec::new();
        let taken = wish(&mut self.mission, &mut outputs);
        self.pass_on(outputs, out);
        if !taken {
            self.note(EventKind::Refused { why: refused.to_owned() }, out);
        }
    }

    /// Tells the operator something that is no business of the mission: of the link, of the record. No report
    /// of the robot brings it back, so it leaves the run as it is.
    pub fn remark(&mut self, what: String, out: &mut Vec<Outgoing>) {
        self.version += 1;
        let time_us = self.mission.tracker().time_us();
        self.keep(Event { time_us, kind: EventKind::Alarm { what } }, out);
    }

    /// What was remarked when the run was driven, from its record.
    pub(super) fn remarked(&mut self, event: Event) {
        self.version += 1;
        self.keep(event, &mut Vec::new());
    }

    /// The program itself is at fault, as `what` says: the robot is stopped, and the run is over.
    fn give_up(&mut self, what: String, out: &mut Vec<Outgoing>) {
        out.push(Outgoing::Stop);
        self.gate.latch();
        self.run = RunState::Failed(Failure::Internal);
        self.note(EventKind::Alarm { what }, out);
        self.note(EventKind::Failed { why: Failure::Internal }, out);
    }

    /// Lets the mission decide as long as it is ready and allowed to.
    fn go_on(&mut self, out: &mut Vec<Outgoing>) {
        self.decide(MOST_DECISIONS, out);
    }

    /// The same, so often at `most`; whoever would go on after that is given up.
    fn decide(&mut self, most: usize, out: &mut Vec<Outgoing>) {
        for _ in 0..most {
            let may = matches!(self.run, RunState::Running | RunState::Stepping(_));
            if may && self.mission.waits_for_place() {
                // Nothing can be done before the operator says where the robot is.
                self.run = RunState::Paused;
                return;
            }
            if !may || !self.heard || self.fault.is_some() || !self.mission.is_ready() {
                return;
            }
            let mut outputs = Vec::new();
            self.mission.proceed(&mut outputs);
            self.version += 1;
            self.pass_on(outputs, out);
            if self.run == RunState::Stepping(Step::Command) {
                self.run = RunState::Paused;
            }
            self.judge(out);
        }
        self.give_up("nothing moves although it is decided on and on".to_owned(), out);
    }

    fn judge(&mut self, out: &mut Vec<Outgoing>) {
        if matches!(self.run, RunState::Failed(_)) {
            return;
        }
        match self.mission.outcome() {
            Outcome::Going => {}
            Outcome::Complete => self.run = RunState::Complete,
            Outcome::Failed(why) => self.run = RunState::Failed(why),
        }
        if self.progress[self.until as usize].done && self.mission.outcome() == Outcome::Going {
            self.run = RunState::Complete;
            self.note(EventKind::AsFarAsAsked { phase: self.until }, out);
        }
    }

    fn pass_on(&mut self, outputs: Vec<Output>, out: &mut Vec<Outgoing>) {
        for output in outputs {
            match output {
                Output::Command(command, why) => match self.gate.admit(command) {
                    Ok(command) => {
                        self.progress[self.mission.phase() as usize].commands += 1;
                        self.command = Some((command, why));
                        out.push(Outgoing::Command(command));
                    }
                    Err(refusal) => self.give_up(format!("command refused: {refusal}"), out),
                },
                Output::Event(event) => self.happened(event, out),
            }
        }
    }

    fn note(&mut self, kind: EventKind, out: &mut Vec<Outgoing>) {
        let time_us = self.mission.tracker().time_us();
        self.happened(Event { time_us, kind }, out);
    }

    fn happened(&mut self, event: Event, out: &mut Vec<Outgoing>) {
        if let EventKind::PhaseBegan { phase } = event.kind {
            if phase > self.until && self.progress[self.until as usize].done {
                // The run ends before it.
                return;
            }
            // After another lap the later phases come again.
            for progress in &mut self.progress[phase as usize..] {
                progress.done = false;
            }
        }
        if let EventKind::PhaseEnded { phase } = event.kind {
            self.progress[phase as usize].done = true;
            out.push(Outgoing::PhaseEnded(phase));
            if self.run == RunState::Stepping(Step::Phase) {
                self.run = RunState::Paused;
            }
        }
        let stands_out = event.kind.severity() >= Severity::Notice;
        if stands_out && self.run == RunState::Stepping(Step::Event) {
            self.run = RunState::Paused;
        }
        self.keep(event, out);
    }

    /// To the screen and to the record.
    fn keep(&mut self, event: Event, out: &mut Vec<Outgoing>) {
        if self.events.len() == KEPT_EVENTS {
            self.events.pop_front();
            self.forgotten += 1;
        }
        self.events.push_back(event.clone());
        out.push(Outgoing::Event(event));
    }

    /// The state at this instant, for the screen.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        let tracker = self.mission.tracker();
        let (switches, bumper) = self.mission.switches();
        let view = RobotView {
            pose: (!self.mission.is_lost()).then(|| tracker.pose()),
            position_sd: self.mission.position_sd(),
            switches,
            bumper,
            moving: self.mission.is_moving(),
            needs_place: self.mission.waits_for_place(),
        };
        let mut progress = self.progress;
        let current = self.mission.phase() as usize;
        for (index, phase) in progress.iter_mut().enumerate() {
            phase.share = if phase.done {
                Some(1.0)
            } else if index == current {
                self.mission.share()
            } else {
                None
            };
        }
        let map = self.mission.map_now();
        let felt = if map.closed { self.mission.live_contacts() } else { Vec::new() };
        let began_us = tracker.began_us();
        let since_it_began = |event: &Event| Event {
            // What was told before the first report has no time of the robot's.
            time_us: event.time_us.saturating_sub(began_us),
            kind: event.kind.clone(),
        };
        Snapshot {
            time: tracker.passed(),
            phase: self.mission.phase(),
            progress,
            run: self.run,
            latched: self.gate.is_latched(),
            robot: if self.heard { Known::Known(view) } else { Known::Unknown },
            command: self.command.map(|(command, why)| (command, why.to_owned())),
            done: self.done.map(|(command, why, reason)| Ended {
                command,
                why: why.to_owned(),
                reason,
            }),
            alpha_is_open: self.mission.plan_is_open() && !self.run.is_over(),
            laps_are_open: self.mission.laps_are_open() && !self.run.is_over(),
            map,
            felt: felt.iter().map(|contact| contact.point).collect(),
            settings: self.mission.settings().clone(),
            events: self.events.iter().map(since_it_began).collect(),
            forgotten: self.forgotten,
            bumps: self.mission.bumps(),
            source: self.source.clone(),
            recorded: false,
            record_end: None,
            asked: false,
        }
    }
}

#[cfg(test)]
mod tests;
