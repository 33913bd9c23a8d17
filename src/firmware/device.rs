//! The robot's end of the line: commands in, acknowledgements, events until they are confirmed, and
//! reports out. The motions themselves are [`Firmware`]'s. No I/O, no clock: it is stepped.

use super::{Firmware, WATCHDOG};
use crate::robot::{Chassis, Command, Hardware, Motion, Telemetry};
use crate::wire::{Decoder, FromRobot, Item, ToRobot, VERSION, seal};
use std::collections::VecDeque;

/// Events that are kept until they are confirmed.
const KEPT: usize = 64;
/// Events said again at a time.
const AT_ONCE: usize = 8;
/// Control steps after which an event that was not confirmed is said again: 100 ms.
const AGAIN: u32 = 5;

/// A robot's end of the line over its control program.
#[derive(Debug, Clone)]
pub struct Device {
    firmware: Firmware,
    chassis: Chassis,
    name: String,
    boot: u32,
    patience: u32,
    decoder: Decoder,
    session: Option<u32>,
    newest: Option<u32>,
    event: u32,
    unconfirmed: VecDeque<(u32, Telemetry)>,
    since_said: u32,
    /// Steps after which what is not confirmed is said again.
    again: u32,
    out: Vec<u8>,
}

impl Device {
    /// A robot called `name` that was started for the `boot`th time. Its time runs `speed` times as
    /// fast as its host's, which it waits for as much longer.
    #[must_use]
    pub fn new(chassis: &Chassis, name: &str, boot: u32, speed: f64) -> Self {
        let patience = WATCHDOG * speed.max(1.0);
        let mut device = Self {
            firmware: Firmware::new(chassis).at_speed(speed),
            chassis: chassis.clone(),
            name: name.to_owned(),
            boot,
            patience: (patience * 1e3).round() as u32,
            decoder: Decoder::default(),
            session: None,
            newest: None,
            event: 0,
            unconfirmed: VecDeque::new(),
            since_said: 0,
            // Where its time is slow its host would wait for that as well.
            again: (f64::from(AGAIN) * speed.min(1.0)).round().max(1.0) as u32,
            out: Vec::new(),
        };
        device.introduce();
        device
    }

    /// Whether a motion is under way.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.firmware.is_moving()
    }

    /// What is to be written now.
    pub fn take_output(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.out)
    }

    fn say(&mut self, message: &FromRobot) {
        seal(message, &mut self.out);
    }

    fn introduce(&mut self) {
        self.say(&FromRobot::Hello {
            version: VERSION,
            boot: self.boot,
            session: self.session.unwrap_or(0),
            watchdog: self.patience,
            switches: self.chassis.sensors.len(),
            name: self.name.clone(),
        });
        self.say(&FromRobot::Body(self.chassis.clone()));
        for (index, mount) in self.chassis.sensors.clone().into_iter().enumerate() {
            self.say(&FromRobot::Switch { index, mount });
        }
    }

    /// Takes what came over the line.
    pub fn receive(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            match self.decoder.push(byte) {
                None | Some(Item::Garbled) => {}
                Some(Item::Stop) => self.firmware.stop(),
                Some(Item::Body(body)) => {
                    if let Some(message) = ToRobot::parse(&body) {
                        self.firmware.heartbeat();
                        self.message(&message);
                    } else if let Some(seq) = sequence_of(&body) {
                        let why = "not understood".to_owned();
                        self.say(&FromRobot::Refuse { seq, why });
                    }
                }
            }
        }
    }

    fn message(&mut self, message: &ToRobot) {
        match *message {
            ToRobot::Hello { session, .. } => {
                if self.session != Some(session) {
                    self.firmware.stop();
                    self.session = Some(session);
                    self.newest = None;
                    self.firmware.count_anew();
                    self.event = 0;
                    self.unconfirmed.clear();
                }
                self.introduce();
            }
            ToRobot::Stop { seq } => {
                self.firmware.stop();
                self.say(&FromRobot::Acknowledge { seq });
            }
            ToRobot::Ping { number, event } => {
                self.unconfirmed.retain(|(number, _)| *number > event);
                self.say(&FromRobot::Pong { number });
            }
            ToRobot::Command(command) => self.command(command),
        }
    }

    fn command(&mut self, command: Command) {
        let seq = command.id.0;
        // An older one came late: it was done long ago.
        if self.newest.is_some_and(|newest| seq <= newest) {
            self.say(&FromRobot::Acknowledge { seq });
            return;
        }
        if let Some(why) = self.objection(&command) {
            let why = why.to_owned();
            self.say(&FromRobot::Refuse { seq, why });
            return;
        }
        self.newest = Some(seq);
        self.firmware.command(command);
        self.say(&FromRobot::Acknowledge { seq });
    }

    fn objection(&self, command: &Command) -> Option<&'static str> {
        let (speed, most) = match command.motion {
            Motion::Move { speed, .. } => (speed, self.chassis.speed),
            Motion::Turn { rate, .. } => (rate, self.chassis.turn_rate),
            Motion::Rest => (0.0, 0.0),
        };
        if self.session.is_none() {
            Some("say hello first")
        } else if self.firmware.is_moving() {
            Some("another motion is in hand")
        } else if speed > most * 1.001 || speed < 0.0 {
            Some("faster than this robot can go")
        } else if command.time_limit <= 0.0 {
            Some("without a time limit")
        } else {
            None
        }
    }

    /// One control step (20 ms of the robot's time). What is said is shown to `tell` as well, with
    /// the hardware as it is at that instant.
    pub fn step<H: Hardware>(&mut self, hardware: &mut H, mut tell: impl FnMut(&Telemetry, &H)) {
        let mut said = Vec::new();
        self.firmware.step(hardware, |telemetry, hardware| {
            tell(&telemetry, hardware);
            said.push(telemetry);
        });
        for telemetry in said {
            self.tell(telemetry);
        }
        self.since_said += 1;
        if self.since_said >= self.again {
            self.since_said = 0;
            let again: Vec<_> = self.unconfirmed.iter().take(AT_ONCE).copied().collect();
            for (event, telemetry) in again {
                self.say(&FromRobot::Event { event, telemetry });
            }
        }
    }

    fn tell(&mut self, telemetry: Telemetry) {
        match telemetry {
            Telemetry::Report { odometer, switches, bumper } => {
                let event = self.event;
                self.say(&FromRobot::Report { odometer, switches, bumper, event, battery: None });
            }
            Telemetry::Edge(_) | Telemetry::Done { .. } => {
                self.event += 1;
                let event = self.event;
                if self.unconfirmed.is_empty() {
                    self.since_said = 0;
                }
                if self.session.is_some() {
                    self.unconfirmed.push_back((event, telemetry));
                    if self.unconfirmed.len() > KEPT {
                        // The story has a hole: let it be known as one that begins anew, and go nowhere.
                        self.firmware.stop();
                        self.unconfirmed.clear();
                        self.boot = self.boot.wrapping_add(1);
                        self.session = None;
                        self.introduce();
                    }
                }
                self.say(&FromRobot::Event { event, telemetry });
            }
        }
    }
}

/// The sequence number of a motion that made no sense otherwise.
fn sequence_of(body: &str) -> Option<u32> {
    let mut words = body.split(' ');
    matches!(words.next(), Some("M" | "T" | "R")).then(|| words.next()?.parse().ok())?
}

#[cfg(test)]
mod tests;
