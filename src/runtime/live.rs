//! A session with a real robot, without the port: bytes and the time in, bytes out. What reads and
//! writes the port is [`super::line`]; the tests put a faulty line and a simulated robot in its place.

mod anew;
mod attended;
mod restart;
mod telling;
mod wishes;

use super::{Ending, keep};
use crate::export::Outcome;
use crate::geometry::Pose;
use crate::journal::{Header, Journal, Life, RobotMark};
use crate::mapping::event::{Event, EventKind};
use crate::mapping::map::{Phase, RoomMap};
use crate::mapping::settings::Settings;
use crate::robot::{Command, CommandId, DoneReason, Intent, Odometer, SwitchSet, Telemetry};
use crate::session::{Outgoing, RunState, Session};
use crate::wire::host::{Identity, Loss};
use crate::wire::{Health, Heard, Host};
use restart::Restart;
use std::io::Write;

/// What a run with a real robot is started with; the robot itself adds its body.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Settings; the chassis is replaced by the robot's own.
    pub settings: Settings,
    /// What the port is called.
    pub port: String,
    /// Phase whose end completes the run; none for all of them.
    pub until: Option<Phase>,
    /// Go on by itself as soon as the robot is there (a run without an operator).
    pub at_once: bool,
}

/// A run that was interrupted, to be gone on with.
pub struct Interrupted {
    /// As its record left it.
    pub session: Session,
    /// The robot that it was; no other can go on. In a later life it has to find its place first.
    pub robot: RobotMark,
    /// The life that it was in last, when that is not the one of its mark.
    pub life: Option<Life>,
    /// The robot was carried, about there.
    pub placed: Option<Pose>,
    /// Commands that it decided on and that its record does not have.
    pub unrecorded: Vec<Command>,
    /// Records in its record.
    pub records: u64,
}

/// Reports with the same ticks after which a robot is believed to stand still.
const STILL: u32 = 3;
/// A line over which so many motions in a row are stopped for want of reports is none to drive over.
const BLINDED: u32 = 5;
/// A robot that refuses a command because it was started again has said who it is after as long, seconds.
const INTRODUCTION: f64 = 2.0;

/// A run with a robot at the end of a line.
pub struct LiveRun<W: Write> {
    plan: Plan,
    host: Host,
    session: Option<Session>,
    /// Where the record will go, until the robot has said who it is.
    out: Option<W>,
    journal: Option<Journal<W>>,
    /// What the robot of this run is called.
    robot: Option<String>,
    heard: Vec<Heard>,
    outgoing: Vec<Outgoing>,
    /// The run to be gone on with, until its robot is there.
    interrupted: Option<Interrupted>,
    /// While a robot is waited for to stand still: the reports since its ticks changed last.
    settling: Option<u32>,
    /// What the robot counted when the run heard it last, until it is heard counting from nothing again.
    restarted: Option<Odometer>,
    restart: Option<Restart>,
    /// Once it stands still it is told that it was carried.
    carried: Option<Intent>,
    /// Why a command was refused, and when that ends the run, if nothing else is heard before.
    refused: Option<(f64, String)>,
    /// A command that waits to be recorded, and for the line to be sound.
    held: Option<Command>,
    blinded: Blinded,
    /// The run was taken up, in the same life of the robot, and has not heard from it yet.
    taken_up: bool,
    last: (Odometer, SwitchSet, bool),
    /// When the run took in last what its robot told.
    taken: f64,
    /// Why nothing of what the robot says counts now.
    disbelieved: Option<String>,
    ended: Option<Ending>,
    /// It goes on by itself once the robot is there and stands still; a stop before that takes it back.
    goes_on: bool,
    /// The record cannot be written, and that was told.
    unrecorded: bool,
    /// When an operator was there last; none when nobody has to be.
    attended: Option<f64>,
    map: RoomMap,
    version: u64,
}

/// Motions that were stopped because nothing was heard meanwhile.
#[derive(Debug, Clone, Copy, Default)]
struct Blinded {
    /// So many in a row.
    row: u32,
    /// The one in hand was.
    this: bool,
}

impl<W: Write> LiveRun<W> {
    /// A run over `host`; its record goes to `out`.
    #[must_use]
    pub fn new(plan: Plan, host: Host, out: Option<W>) -> Self {
        Self {
            goes_on: plan.at_once,
            plan,
            host,
            session: None,
            out,
            journal: None,
            robot: None,
            heard: Vec::new(),
            outgoing: Vec::new(),
            interrupted: None,
            settling: None,
            restarted: None,
            restart: None,
            carried: None,
            refused: None,
            held: None,
            blinded: Blinded::default(),
            taken_up: false,
            last: (Odometer::default(), SwitchSet::EMPTY, false),
            taken: 0.0,
            disbelieved: None,
            ended: None,
            unrecorded: false,
            attended: None,
            map: RoomMap::default(),
            version: 0,
        }
    }

    /// The same run, going on with one that was interrupted; its record is at its end.
    #[must_use]
    pub fn going_on(self, interrupted: Interrupted) -> Self {
        Self { interrupted: Some(interrupted), ..self }
    }

    /// The host's end of the line.
    #[must_use]
    pub fn host(&self) -> &Host {
        &self.host
    }

    /// The session, once the robot has said who it is.
    #[must_use]
    pub fn session(&self) -> Option<&Session> {
        self.session.as_ref()
    }

    /// What is to be written now.
    pub fn take_output(&mut self) -> Vec<u8> {
        self.host.take_output()
    }

    /// Takes what came over the line.
    pub fn receive(&mut self, bytes: &[u8], now: f64) {
        self.host.receive(bytes, now, &mut self.heard);
        self.take_heard(now);
    }

    /// Lets the time pass.
    pub fn tick(&mut self, now: f64) {
        self.host.tick(now, &mut self.heard);
        self.take_heard(now);
        self.mind_the_operator(now);
        self.send_held(now);
        if let Some((_, why)) = self.refused.take_if(|(due, _)| now >= *due) {
            self.end(Outcome::Failed, format!("the robot refused a command: {why}"));
        }
        if !self.host.is_stopping() {
            self.hand_record_on();
        }
        if let Some(error) = self.record_error() {
            self.unrecorded(&error, now);
        }
    }

    /// Hands on all that is recorded so far.
    pub fn hand_record_on(&mut self) {
        if let Some(journal) = &mut self.journal {
            journal.flush();
        }
    }

    /// What was recorded has not reached the disk: the record counts as failed from now on.
    pub fn record_lost(&mut self, error: std::io::Error) {
        if let Some(journal) = &mut self.journal {
            journal.fail(error);
        }
    }

    /// Nothing is driven that is not recorded: the stop comes back whenever it is cleared.
    fn unrecorded(&mut self, error: &str, now: f64) {
        let run = self.session.as_ref().map(Session::run_state);
        let told = run == Some(RunState::Stopped) || run.is_some_and(RunState::is_over);
        if told && self.unrecorded {
            return;
        }
        self.unrecorded = true;
        let reason = format!("the record cannot be written: {error}; the robot was stopped");
        self.stop(now);
        self.remark(reason.clone(), now);
        self.end(Outcome::Failed, reason);
    }

    /// The port is gone.
    pub fn unplugged(&mut self, now: f64) {
        self.host.unplugged(&mut self.heard);
        self.take_heard(now);
    }

    /// The port is there again.
    pub fn reopened(&mut self, now: f64) {
        self.version += 1;
        self.host.reopened(now);
    }

    fn stop(&mut self, now: f64) {
        if self.session.is_some() {
            self.intent(Intent::Stop, now);
        } else {
            self.host.stop(now);
        }
    }

    fn remark(&mut self, why: String, now: f64) {
        self.version += 1;
        if let Some(session) = &mut self.session {
            session.remark(why, &mut self.outgoing);
            self.deliver(now);
        }
    }

    /// As [`LiveRun::remark`], unless it was told just now: two hosts that quarrel over one robot would fill
    /// the log.
    fn remark_once(&mut self, why: String, now: f64) {
        let is = |event: &Event| matches!(&event.kind, EventKind::Alarm { what } if *what == why);
        let told = |session: &Session| session.events().iter().rev().take(4).any(is);
        if !self.session.as_ref().is_some_and(told) {
            self.remark(why, now);
        }
    }

    fn end(&mut self, outcome: Outcome, reason: String) {
        self.version += 1;
        self.ended.get_or_insert(Ending { outcome, reason });
    }

    fn take_heard(&mut self, now: f64) {
        for heard in std::mem::take(&mut self.heard) {
            match heard {
                Heard::Hello(identity) => {
                    self.version += 1;
                    if let Some(interrupted) = self.interrupted.take() {
                        self.take_up(interrupted, &identity, now);
                    } else if self.session.is_none() {
                        self.begin(&identity, now);
                    } else if self.stranger().is_none() {
                        self.remark_once(format!("{} is there again", identity.name), now);
                    }
                }
                Heard::Rebooted => self.out_of_hand("the robot was started again", now),
                Heard::Forgotten => self.out_of_hand(
                    "the robot counts anew: another host spoke to it, or it was started again",
                    now,
                ),
                Heard::Telemetry(telemetry) => self.told(&telemetry, now),
                Heard::Early { seconds, ended } => self.early(seconds, ended, now),
                Heard::Patient(seconds) => self.patient(seconds, now),
                Heard::Health(health) => self.health(health, now),
                Heard::Refused(id, why) => {
                    self.remark(format!("the robot refused a command: {why}"), now);
                    self.stop(now);
                    self.not_begun(id, now);
                    if self.plan.at_once {
                        self.refused.get_or_insert((now + INTRODUCTION, why));
                    }
                }
                Heard::NotBegun(id) => self.not_begun(id, now),
                Heard::Blinded => {
                    self.blinded.this = true;
                    let what = "reports stayed away while the robot moved: it was stopped";
                    self.remark_once(what.to_owned(), now);
                }
            }
        }
    }

    fn begin(&mut self, identity: &Identity, now: f64) {
        if self.unrecorded {
            return;
        }
        // Whatever kept it away so long, it is there.
        self.ended = None;
        let mut settings = self.plan.settings.clone();
        settings.chassis = identity.chassis.clone();
        let source = format!("{} on {}", identity.name, self.plan.port);
        let until = self.plan.until;
        (self.robot, self.taken) = (Some(identity.name.clone()), now);
        let robot = Some(RobotMark { name: identity.name.clone(), boot: identity.boot });
        let noise = String::new();
        let header = Header { settings, source: source.clone(), noise, until, robot };
        if let Some(out) = self.out.take() {
            match Journal::begin(out, &header) {
                Ok(journal) => self.journal = Some(journal),
                Err(error) => {
                    self.unrecorded = true;
                    let reason = format!("the record cannot be written: {error}");
                    return self.end(Outcome::Failed, reason);
                }
            }
        }
        self.session = Some(Session::new(header.settings, source, until.unwrap_or(Phase::Objects)));
        if std::mem::take(&mut self.goes_on) {
            self.wish(Intent::Run, now);
        }
    }

    fn health(&mut self, health: Health, now: f64) {
        self.version += 1;
        match health {
            Health::Lost(why) => {
                // Tell, halt, latch. That nobody answers is no news at every attempt.
                let what = format!("link lost: {why}");
                match why {
                    Loss::NoAnswer | Loss::Foreign(_) => self.remark_once(what, now),
                    _ => self.remark(what, now),
                }
                self.stop(now);
                if self.plan.at_once || self.session.is_none() {
                    self.end(Outcome::Failed, format!("link lost: {why}"));
                }
            }
            Health::Stale => self.remark("the robot told nothing for 0.5 s".to_owned(), now),
            Health::Opening | Health::Up => {}
        }
    }

    /// Counts the motions in a row that ended so because host and robot did not hear each other. Once is a hiccup; a
    /// line that does it every time is none to drive over.
    fn count_blinded(&mut self, reason: DoneReason, now: f64) {
        let Blinded { row, this } = std::mem::take(&mut self.blinded);
        self.blinded.row = match (reason, this) {
            (DoneReason::HostSilent, _) | (DoneReason::Stopped, true) => row + 1,
            (DoneReason::Stopped, false) => row,
            _ => 0,
        };
        if self.blinded.row < BLINDED {
            return;
        }
        self.blinded = Blinded::default();
        let why = format!(
            "{BLINDED} motions in a row were stopped because robot and host did not hear each other meanwhile: the \
             line hands on what they say too far apart to drive by; look at the radio link, or at what bundles its \
             bytes"
        );
        self.remark(why.clone(), now);
        self.stop(now);
        if self.plan.at_once {
            self.end(Outcome::Failed, why);
        }
    }

    /// The robot's clock went on without ours: as long as it is wrong, nothing of what it says counts, and
    /// nothing sets it going. A motion that ended then has ended.
    fn early(&mut self, seconds: f64, ended: Option<CommandId>, now: f64) {
        let why = format!(
            "the robot cannot be believed: its clock went on by {seconds:.0} s more than time did here. If \
             this computer slept, leave and go on with --resume; else look at its clock, switch it off and on{}",
            if self.can_find_its_place() { ", and it finds its place again" } else { "" }
        );
        if self.session.as_ref().is_some_and(|session| !session.is_latched()) {
            self.stop(now);
            self.remark(why.clone(), now);
        }
        self.disbelieved = Some(why.clone());
        if let Some(id) = ended {
            self.not_begun(id, now);
        }
        if self.plan.at_once {
            self.end(Outcome::Failed, why);
        }
    }

    /// A command that never began has ended where the robot stood when it was last heard.
    fn not_begun(&mut self, id: CommandId, now: f64) {
        let (odometer, switches, bumper) = self.last;
        let reason = DoneReason::Stopped;
        self.telemetry(&Telemetry::Done { id, reason, odometer, switches, bumper }, now);
    }

    /// Takes what the robot says, as the run counts it; what another one says is nothing to this run.
    fn told(&mut self, telemetry: &Telemetry, now: f64) {
        if self.stranger().is_some() {
            return;
        }
        self.disbelieved = None;
        self.counts_anew(telemetry);
        if let Some(last) = self.restarted.take() {
            self.restart = Some(Restart::between(&last, telemetry.odometer()));
        }
        let told = self.restart.map_or(*telemetry, |restart| restart.of(telemetry));
        self.telemetry(&told, now);
        if self.session.as_ref().is_some_and(|session| session.fault().is_none()) {
            self.taken = now;
        }
    }

    fn telemetry(&mut self, telemetry: &Telemetry, now: f64) {
        let Some(session) = &mut self.session else { return };
        if let (Some(count), Telemetry::Report { odometer, .. }) = (self.settling, telemetry) {
            let ticks = |o: &Odometer| (o.left_ticks, o.right_ticks);
            self.settling =
                Some(if ticks(odometer) == ticks(&self.last.0) { count + 1 } else { 0 });
        }
        if let Some(journal) = &mut self.journal {
            journal.telemetry(session.mission().tracker().time_us(), telemetry);
        }
        session.telemetry(telemetry, &mut self.outgoing);
        if let Some(fault) = session.fault() {
            self.deliver(now);
            if self.plan.at_once {
                self.end(Outcome::Failed, fault);
            }
            return;
        }
        match *telemetry {
            Telemetry::Report { odometer, switches, bumper }
            | Telemetry::Done { odometer, switches, bumper, .. } => {
                self.last = (odometer, switches, bumper);
            }
            Telemetry::Edge(edge) => {
                self.last.0 = edge.odometer;
                self.last.1 = self.last.1.with(edge.sensor, edge.rising);
            }
        }
        if let Telemetry::Done { reason, .. } = *telemetry {
            self.count_blinded(reason, now);
        }
        self.deliver(now);
        if self.settling.is_some_and(|count| count >= STILL) {
            self.settled(now);
        }
        let waits = |session: &Session| session.mission().waits_for_place();
        let settled = self.settling.is_none() && self.carried.is_none();
        if settled && self.plan.at_once && self.session.as_ref().is_some_and(waits) {
            let why =
                "the robot does not know where it is; go on with --resume DIR --placed X,Y,DEG";
            self.end(Outcome::Failed, why.to_owned());
        }
    }

    /// Takes what left the session, in its order: it is recorded, stops leave at once, and a command when
    /// it may.
    fn deliver(&mut self, now: f64) {
        let Some(session) = &self.session else { return };
        let mut overtaken = None;
        for outgoing in std::mem::take(&mut self.outgoing) {
            keep(&mut self.journal, session, &outgoing);
            match outgoing {
                Outgoing::Command(command) => self.held = Some(command),
                Outgoing::Stop => {
                    self.host.stop(now);
                    overtaken = self.held.take().or(overtaken);
                }
                Outgoing::Event(_) | Outgoing::PhaseEnded(_) => {}
            }
        }
        if self.held.is_some() {
            // Before the command leaves: what was sent is never unknown afterwards. A stop waits for no disk, and
            // what else there is, is handed on when nothing has to leave.
            self.hand_record_on();
        }
        self.send_held(now);
        if let Some(command) = overtaken {
            self.not_begun(command.id, now);
        }
    }

    /// Sends the command that waits, if it is recorded and the line is sound. A line that is gone is not
    /// waited for: nobody would expect the robot to drive off when it is back.
    fn send_held(&mut self, now: f64) {
        let Some(command) = self.held else { return };
        if let Some(error) = self.record_error() {
            self.held = None;
            // Stopped first, or the next one would be asked for at once.
            self.unrecorded(&error, now);
            self.not_begun(command.id, now);
        } else if !self.host.is_open() {
            self.held = None;
            self.remark("nothing is heard from the robot: it is told nothing".to_owned(), now);
            self.stop(now);
            self.not_begun(command.id, now);
        } else if self.host.is_sound(now) {
            self.held = None;
            self.host.send(command, now);
        }
    }

    /// Why the record cannot be written, if that is so.
    fn record_error(&self) -> Option<String> {
        self.journal.as_ref().and_then(|journal| journal.error()).map(ToString::to_string)
    }
}

#[cfg(test)]
mod tests;
