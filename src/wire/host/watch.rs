//! What the host does as time passes: what is not answered is said again, and who is silent is noticed.

use super::timing::{BLIND, BOOT, HELLO, LOST, OVERDUE, PING, STALE, UNANSWERED, UNDOUBTED};
use super::{Health, Heard, Host, Loss};
use crate::wire::frame::seal;
use crate::wire::message::{ToRobot, VERSION};

impl Host {
    /// Lets the time pass: what is due is said again, and who is silent is noticed. To be called
    /// every few milliseconds, from the loop that decides: a host that hangs falls silent.
    ///
    /// What is overdue is judged as of the call before, since which everything that was there has been
    /// taken in: whoever was busy for seconds with a plan or a disk has not read yet what came meanwhile.
    pub fn tick(&mut self, now: f64, told: &mut Vec<Heard>) {
        let judged = std::mem::replace(&mut self.ticked, now);
        if self.health == Health::Lost(Loss::Unplugged) {
            return;
        }
        if now >= self.hello_due {
            let hello = ToRobot::Hello { version: VERSION, session: self.session };
            seal(&hello, &mut self.out);
            self.hello_due = now + HELLO;
        }
        if self.is_open() && !self.estranged && self.hello_due.is_finite() {
            self.hello_due = f64::INFINITY;
        } else if !self.is_open() && self.hello_due.is_infinite() {
            self.hello_due = now;
        }
        match self.health {
            Health::Opening => {
                if judged - self.opened > BOOT {
                    let why = match (self.understood, self.sample.is_empty()) {
                        (true, _) => Loss::Unintroduced,
                        (false, false) => Loss::Foreign(self.sample),
                        (false, true) => Loss::NoAnswer,
                    };
                    self.lose(why, told);
                }
            }
            Health::Up | Health::Stale => self.watch(judged, now, told),
            Health::Lost(_) => {}
        }
        self.resend_stop(now);
    }

    fn watch(&mut self, judged: f64, now: f64, told: &mut Vec<Heard>) {
        // Answers to pings tell nothing of where it is.
        let silence = judged - self.news;
        if silence > LOST {
            if judged - self.reported <= STALE {
                // It tells, and nothing that this host could take: their numbers are not the same.
                return self.begin_anew(now, told);
            }
            let silent = judged - self.heard > STALE;
            return self.lose(if silent { Loss::Silent } else { Loss::Mute }, told);
        }
        self.turn(if silence > STALE { Health::Stale } else { Health::Up }, told);
        if silence > STALE {
            self.clean = now;
        }
        if now >= self.ping_due {
            self.pings = self.pings.wrapping_add(1);
            let ping = ToRobot::Ping { number: self.pings, event: self.event };
            seal(&ping, &mut self.out);
            self.pinged = self.pinged.or(Some((self.pings, now)));
            if self.pinged.is_some_and(|(_, sent)| now - sent > 1.0) {
                self.pinged = None;
            }
            self.ping_due = now + PING;
        }
        if self.stop.is_none()
            && judged - self.quiet > UNDOUBTED + self.braking()
            && silence < PING * 3.0
        {
            // Its end would have come by now.
            if let Some(id) = self.doubt.take() {
                self.motion = None;
                told.push(Heard::NotBegun(id));
            }
        }
        if let Some((_, over)) = self.motion {
            if silence > BLIND && !self.halted {
                self.halted = true;
                self.stop(now);
                told.push(Heard::Blinded);
            }
            // No end comes of what never began; that is found out after the stop that is under way.
            if judged > over && self.doubt.is_none() {
                self.stop(now);
                return self.lose(Loss::Endless, told);
            }
        }
        if self.stop.as_ref().is_some_and(|stop| judged - stop.since > self.unanswered()) {
            return self.lose(Loss::Unacknowledged, told);
        }
        let unanswered = self.unanswered();
        if let Some(pending) = &mut self.command
            && now >= pending.due
        {
            if judged - pending.since > unanswered {
                self.stop(now);
                return self.lose(Loss::Unacknowledged, told);
            }
            pending.again(now);
            self.out.extend_from_slice(&pending.line);
        }
    }

    /// How long the robot takes to stand still from what it drives and turns at most, seconds: a stop brakes as hard
    /// as it speeds up, at least.
    fn braking(&self) -> f64 {
        self.identity().map_or(0.0, |identity| {
            let body = &identity.chassis;
            body.speed.max(body.turn_rate * body.wheel_base / 2.0) / body.acceleration
        })
    }

    /// How long an acknowledgement is waited for, seconds.
    fn unanswered(&self) -> f64 {
        UNANSWERED + 10.0 * self.latency
    }

    /// The robot is there again: what was waited for while it was not is waited for anew.
    pub(super) fn wait_anew(&mut self, now: f64) {
        if let Some((_, over)) = &mut self.motion {
            *over = now + OVERDUE;
        }
        if let Some(stop) = &mut self.stop {
            stop.since = now;
        }
    }

    /// A stop is repeated until it is acknowledged or the port is gone.
    fn resend_stop(&mut self, now: f64) {
        if let Some(pending) = &mut self.stop
            && now >= pending.due
        {
            pending.again(now);
            self.urgent.extend_from_slice(&pending.line);
        }
    }
}
