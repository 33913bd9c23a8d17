//! The host's end of the line as a state machine: who the robot is, whether it is there, commands
//! until they are acknowledged, events in order and each once. It is told the time and given bytes;
//! it says what to write and what was heard. No I/O, no clock.

mod clock;
mod forgotten;
mod pending;
mod timing;
mod told;
mod watch;

pub use timing::LOST;
pub use told::{Health, Heard, Identity, Loss, Sample};

use super::frame::{Decoder, Item, STOP, seal};
use super::message::{FromRobot, ToRobot, VERSION};
use crate::robot::{Command, CommandId, SWITCHES, Telemetry, Unfit};
use clock::Clock;
use pending::Pending;
use timing::{ANSWER, CLEAN, EXCHANGE, FIRST_STOP, HOLE, OVERDUE, OVERTAKEN_US, PATIENCE};
use told::Introduction;

/// The host's end.
#[derive(Debug, Clone)]
pub struct Host {
    session: u32,
    byte_time: f64,
    decoder: Decoder,
    introduction: Introduction,
    identity: Option<Identity>,
    health: Health,
    opened: f64,
    /// When the time was looked at last.
    ticked: f64,
    /// When a good line came last.
    heard: f64,
    /// When it last told what this host could take: only that says where it is.
    news: f64,
    /// When it last told anything of itself, whether it could be taken or not.
    reported: f64,
    /// When it last answered who it is, to this host.
    answered: f64,
    /// Since when it tells of fewer events than this host has.
    fewer: Option<f64>,
    clean: f64,
    hello_due: f64,
    ping_due: f64,
    pings: u32,
    pinged: Option<(u32, f64)>,
    latency: f64,
    command: Option<Pending>,
    stop: Option<Pending>,
    stops: u32,
    /// The motion that the robot is believed to be in, and when it must be over.
    motion: Option<(CommandId, f64)>,
    halted: bool,
    /// A command that a stop overtook before it was acknowledged: nobody knows whether it began.
    doubt: Option<CommandId>,
    /// When the last stop was acknowledged.
    quiet: f64,
    event: u32,
    /// Since when, and from which event on, the robot tells of later ones and not of the next.
    behind: Option<(f64, u32)>,
    /// What it says is not what one would say who knows this host: it is asked until it does.
    estranged: bool,
    /// Robot time of the last report, microseconds.
    time_us: u64,
    clock: Clock,
    garbled: u64,
    /// What was heard first since the port was opened, and whether any of it was in this protocol.
    sample: Sample,
    understood: bool,
    urgent: Vec<u8>,
    out: Vec<u8>,
}

impl Host {
    /// A line at `baud` (0 for what is no serial line and takes no time), opened at `now` (seconds of
    /// any clock that never goes back). `session` tells this conversation from earlier ones.
    #[must_use]
    pub fn new(baud: u32, session: u32, now: f64) -> Self {
        Self {
            session,
            byte_time: if baud == 0 { 0.0 } else { 10.0 / f64::from(baud) },
            decoder: Decoder::default(),
            introduction: Introduction::default(),
            identity: None,
            health: Health::Opening,
            opened: now,
            ticked: now,
            heard: now,
            news: now,
            reported: now,
            answered: now,
            fewer: None,
            clean: now,
            hello_due: now,
            ping_due: now,
            pings: 0,
            pinged: None,
            latency: 0.0,
            command: None,
            stop: None,
            stops: FIRST_STOP,
            motion: None,
            halted: false,
            doubt: None,
            quiet: now,
            event: 0,
            behind: None,
            estranged: false,
            time_us: 0,
            clock: Clock::new(0),
            garbled: 0,
            sample: Sample::default(),
            understood: false,
            urgent: Vec::new(),
            out: Vec::new(),
        }
    }

    /// The port was opened anew; what the robot said before still counts.
    pub fn reopened(&mut self, now: f64) {
        self.decoder = Decoder::default();
        self.introduction = Introduction::default();
        (self.sample, self.understood) = (Sample::default(), false);
        self.put_in_doubt();
        self.pinged = None;
        (self.opened, self.clean) = (now, now);
        (self.hello_due, self.ping_due) = (now, now);
        self.out.clear();
        self.urgent.clear();
        self.health = Health::Opening;
    }

    /// Whether the robot is there.
    #[must_use]
    pub fn health(&self) -> Health {
        self.health
    }

    /// Who the robot is, once it has said so.
    #[must_use]
    pub fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// Whether motions may be sent: the line has been there for a while, and no stop is on its way.
    #[must_use]
    pub fn is_sound(&self, now: f64) -> bool {
        self.health == Health::Up && now - self.clean >= CLEAN && self.stop.is_none()
    }

    /// Whether a stop waits to be written.
    #[must_use]
    pub fn is_stopping(&self) -> bool {
        !self.urgent.is_empty()
    }

    /// Whether every stop was acknowledged and no motion is in hand.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.stop.is_none() && self.motion.is_none() && self.urgent.is_empty()
    }

    /// Seconds since the robot told anything of itself that could be taken.
    #[must_use]
    pub fn silence(&self, now: f64) -> f64 {
        now - self.news
    }

    /// Seconds that an answer takes, as measured.
    #[must_use]
    pub fn latency(&self) -> f64 {
        self.latency
    }

    /// Lines that could not be read so far.
    #[must_use]
    pub fn garbled(&self) -> u64 {
        self.garbled
    }

    /// What is to be written now, stops before everything else.
    pub fn take_output(&mut self) -> Vec<u8> {
        let mut bytes = std::mem::take(&mut self.urgent);
        bytes.append(&mut self.out);
        bytes
    }

    /// Sends a motion, until it is acknowledged.
    pub fn send(&mut self, command: Command, now: f64) {
        let wait = self.answer_time();
        let mut line = Vec::new();
        seal(&ToRobot::Command(command), &mut line);
        self.out.extend_from_slice(&line);
        self.halted = false;
        self.motion = Some((command.id, now + command.time_limit + OVERDUE));
        self.command = Some(Pending::new(command.id.0, line, now, wait));
    }

    /// Stops the robot: the byte that stops before everything else, and a stop that is answered.
    pub fn stop(&mut self, now: f64) {
        self.stops = self.stops.wrapping_add(1).max(FIRST_STOP);
        let seq = self.stops;
        let wait = self.answer_time();
        // What was not acknowledged yet must not begin after the stop.
        self.put_in_doubt();
        let mut line = vec![STOP];
        seal(&ToRobot::Stop { seq }, &mut line);
        self.out.clear();
        self.urgent.extend_from_slice(&line);
        self.stop = Some(Pending::new(seq, line, now, wait));
    }

    /// How long an answer may take: more than the slowest exchange on this line does.
    fn answer_time(&self) -> f64 {
        ANSWER + 3.0 * EXCHANGE * self.byte_time + 2.0 * self.latency
    }

    /// The port is gone.
    pub fn unplugged(&mut self, told: &mut Vec<Heard>) {
        self.lose(Loss::Unplugged, told);
    }

    fn lose(&mut self, why: Loss, told: &mut Vec<Heard>) {
        if !matches!(self.health, Health::Lost(_)) {
            self.put_in_doubt();
            self.out.clear();
            self.turn(Health::Lost(why), told);
        }
    }

    fn put_in_doubt(&mut self) {
        if let Some(pending) = self.command.take() {
            self.doubt = Some(CommandId(pending.seq));
        }
    }

    fn turn(&mut self, health: Health, told: &mut Vec<Heard>) {
        if self.health != health {
            self.health = health;
            told.push(Heard::Health(health));
        }
    }

    /// Takes what came over the line.
    pub fn receive(&mut self, bytes: &[u8], now: f64, told: &mut Vec<Heard>) {
        self.sample.add(bytes);
        for &byte in bytes {
            match self.decoder.push(byte) {
                None | Some(Item::Stop) => {}
                Some(Item::Garbled) => self.garbled += 1,
                Some(Item::Body(body)) => {
                    if let Some(message) = FromRobot::parse(&body) {
                        (self.heard, self.understood) = (now, true);
                        self.message(message, now, told);
                    }
                }
            }
        }
    }

    fn message(&mut self, message: FromRobot, now: f64, told: &mut Vec<Heard>) {
        match message {
            FromRobot::Hello { version, boot, session, watchdog, switches, name } => {
                if version != VERSION {
                    return self.lose(Loss::Version, told);
                }
                // What it says of itself before it has heard this host is not the answer yet: with its
                // own start, or with another host's words, its numbers are others.
                if session != self.session {
                    return self.strange(boot, session, now, told);
                }
                (self.estranged, self.answered) = (false, now);
                if !SWITCHES.contains(&switches) {
                    return self.unfit(Unfit::Switches { count: switches }, told);
                }
                if watchdog > PATIENCE {
                    return self.lose(Loss::Patient(watchdog), told);
                }
                let hello = Some((boot, switches, name));
                // What another robot said of its body is not this one's.
                if self.introduction.hello != hello {
                    self.introduction = Introduction { hello, ..Introduction::default() };
                }
                self.introduction.watchdog = watchdog;
                self.introduced(now, told);
            }
            FromRobot::Body(chassis) => {
                if let Err(why) = chassis.check_measures() {
                    return self.unfit(why, told);
                }
                self.introduction.body = Some(chassis);
                self.introduced(now, told);
            }
            FromRobot::Switch { index, mount } => {
                let switches = &mut self.introduction.switches;
                switches.resize(switches.len().max(index + 1), None);
                switches[index] = Some(mount);
                self.introduced(now, told);
            }
            FromRobot::Acknowledge { seq } => {
                let is = |pending: &Option<Pending>| pending.as_ref().is_some_and(|p| p.seq == seq);
                if is(&self.command) {
                    self.command = None;
                } else if is(&self.stop) {
                    self.stop = None;
                    self.quiet = now;
                }
            }
            FromRobot::Refuse { seq, why } => {
                if self.command.as_ref().is_some_and(|pending| pending.seq == seq) {
                    self.command = None;
                    self.motion = None;
                    // It may have been started again, and not know who speaks.
                    self.ask_anew(now);
                    told.push(Heard::Refused(CommandId(seq), why));
                }
            }
            FromRobot::Pong { number } => {
                if let Some((_, sent)) = self.pinged.take_if(|(sent, _)| *sent == number) {
                    self.latency += 0.2 * ((now - sent).min(2.0) - self.latency);
                }
            }
            FromRobot::Report { odometer, switches, bumper, event, .. } => {
                self.reported = now;
                if self.has_forgotten(event, now) {
                    return self.begin_anew(now, told);
                }
                // One from before a restart, or one from after it: who is there?
                if event < self.event || self.misses(event, now) {
                    self.ask_anew(now);
                }
                if event == self.event && self.is_open() {
                    let report = Telemetry::Report { odometer, switches, bumper };
                    self.reported(report, now, told);
                }
            }
            FromRobot::Event { event, telemetry } => {
                self.reported = now;
                if event == self.event.wrapping_add(1) && self.is_open() {
                    self.event = event;
                    self.happened(telemetry, now, told);
                }
            }
        }
    }

    /// Takes a report that is in step with the events.
    fn reported(&mut self, report: Telemetry, now: f64, told: &mut Vec<Heard>) {
        let time_us = report.odometer().time_us;
        // One that another has overtaken is of no use. A clock that went back is none of that.
        let overtaken = (1..OVERTAKEN_US).contains(&self.time_us.saturating_sub(time_us));
        if overtaken {
            return;
        }
        self.news = now;
        if self.is_in_time(time_us, None, now, told) {
            self.time_us = time_us;
            told.extend(self.clock.take_patience(time_us, now).map(Heard::Patient));
            told.push(Heard::Telemetry(report));
        }
    }

    /// Takes the next event.
    fn happened(&mut self, event: Telemetry, now: f64, told: &mut Vec<Heard>) {
        self.news = now;
        let mut ended = None;
        if let Telemetry::Done { id, .. } = event {
            ended = Some(id);
            self.motion.take_if(|(motion, _)| *motion == id);
            // It ended, so it was taken, whatever became of the acknowledgement.
            self.command.take_if(|pending| pending.seq == id.0);
            self.doubt.take_if(|doubted| *doubted == id);
        }
        if self.is_in_time(event.odometer().time_us, ended, now, told) {
            told.push(Heard::Telemetry(event));
        }
    }

    /// Whether what was made at `time_us`, and `ended` a motion if it did, can have been made by now; tells
    /// it when not.
    fn is_in_time(
        &mut self,
        time_us: u64,
        ended: Option<CommandId>,
        now: f64,
        told: &mut Vec<Heard>,
    ) -> bool {
        let made = self.clock.admit(time_us, now);
        told.extend(made.err().map(|seconds| Heard::Early { seconds, ended }));
        made.is_ok()
    }

    /// Whether the robot, whose newest event is this one, has not told the next for too long: it says again
    /// what it has.
    fn misses(&mut self, newest: u32, now: f64) -> bool {
        let since = match self.behind {
            Some((since, event)) if event == self.event => since,
            _ => now,
        };
        self.behind = (newest > self.event).then_some((since, self.event));
        self.behind.is_some() && now - since > HOLE
    }

    /// Asks who is there, until the answer is for this host.
    fn ask_anew(&mut self, now: f64) {
        self.estranged = true;
        self.hello_due = self.hello_due.min(now);
    }

    /// It says that it is what no robot can be. One that is known already is believed more than that.
    fn unfit(&mut self, why: Unfit, told: &mut Vec<Heard>) {
        if !self.is_open() {
            self.lose(Loss::Unfit(why), told);
        }
    }

    /// Whether telemetry means something: the robot is known, and was heard a moment ago.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.identity.is_some() && matches!(self.health, Health::Up | Health::Stale)
    }

    fn introduced(&mut self, now: f64, told: &mut Vec<Heard>) {
        let Some(identity) = self.introduction.complete() else { return };
        if let Err(why) = identity.chassis.check() {
            return self.unfit(why, told);
        }
        // Two robots may have been started as often as each other.
        let same = self.identity.as_ref() == Some(&identity);
        if same && self.is_open() {
            return;
        }
        if self.is_still_mute(now) {
            return;
        }
        if self.identity.is_some() && !same {
            self.identity = Some(identity);
            self.clock = Clock::new(self.introduction.watchdog);
            told.push(Heard::Rebooted);
            // The one that was there before may come back, and must not go on with the old numbers.
            return self.converse_anew(now, told);
        }
        self.wait_anew(now);
        self.identity = Some(identity.clone());
        // In the same life its clock goes on: what waited at the robot while the line was gone is late, and
        // nothing to hold later messages against.
        if !same {
            self.clock = Clock::new(self.introduction.watchdog);
        }
        (self.clean, self.news, self.fewer) = (now, now, None);
        self.ping_due = now;
        told.push(Heard::Hello(Box::new(identity)));
        self.turn(Health::Up, told);
    }
}

#[cfg(test)]
mod tests;
