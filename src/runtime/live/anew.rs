//! A robot that was started again, and a run that is taken up again: what both have to find out before the
//! robot moves.

use super::restart::Restart;
use super::{Interrupted, LiveRun};
use crate::export::Outcome;
use crate::journal::Journal;
use crate::robot::{Chassis, Intent, Telemetry};
use crate::session::{RunState, Session};
use crate::wire::host::Identity;
use std::io::Write;

impl<W: Write> LiveRun<W> {
    /// The robot was out of this host's hand, as `why` says: it stands still, and where it is, is no longer
    /// known. The operator decides when it goes to find its place; without one the run ends here, to be gone
    /// on with.
    pub(super) fn out_of_hand(&mut self, why: &str, now: f64) {
        // Another life has another clock.
        self.disbelieved = None;
        let stranger = self.stranger();
        let known = stranger.is_none();
        if self.session.is_none() {
            // It was nowhere yet.
            self.stop(now);
            return self.end(Outcome::Failed, why.to_owned());
        }
        let why = stranger.unwrap_or_else(|| format!("{why}: where it is, is no longer known"));
        self.remark_once(why.clone(), now);
        self.stop(now);
        let Some(session) = &self.session else { return };
        if self.plan.at_once {
            let then = match self.can_find_its_place() {
                _ if !known => "",
                true => "; --resume finds its place again",
                false => {
                    "; --resume DIR --placed X,Y,DEG begins the lap anew, with the place where it stands"
                }
            };
            return self.end(Outcome::Failed, format!("{why}{then}"));
        }
        let tracker = session.mission().tracker();
        self.restarted = tracker.last();
        self.settling = Some(0);
        self.carried = Some(Intent::Placed { near: None });
    }

    /// Why the robot that is there does not go on with the run that another began; none when it is the one.
    pub(super) fn stranger(&self) -> Option<String> {
        let was = &self.session.as_ref()?.mission().settings().chassis;
        let why = differs(self.robot.as_ref()?, was, self.host.identity()?)?;
        Some(format!("{why}: it does not go on with the run; put the right one back, or leave"))
    }

    /// Goes on with a run, if this is its robot; in another life of it, or carried, it has to find its
    /// place first. For a robot that is not its own the run waits on, and its record is not touched.
    pub(super) fn take_up(&mut self, interrupted: Interrupted, identity: &Identity, now: f64) {
        let was = &interrupted.session.mission().settings().chassis;
        if let Some(why) = differs(&interrupted.robot.name, was, identity) {
            self.interrupted = Some(interrupted);
            // Whatever kept it away before, this does now.
            self.ended = None;
            return self.end(Outcome::Failed, why);
        }
        let Interrupted { session, robot, life, unrecorded, records, placed } = interrupted;
        (self.robot, self.taken) = (Some(robot.name), now);
        self.journal = self.out.take().map(|out| Journal::go_on(out, records));
        let time_us = session.mission().tracker().time_us();
        for command in &unrecorded {
            if let Some(journal) = &mut self.journal {
                journal.command(time_us, command);
            }
        }
        let again = life.map_or(robot.boot, |life| life.boot) != identity.boot;
        if again {
            self.restarted = session.mission().tracker().last();
        } else {
            self.restart = life.as_ref().map(Restart::recorded);
            self.taken_up = true;
        }
        // A run that ended since it did not find its place where it was said to be looks everywhere.
        let anywhere = again || session.mission().waits_for_place();
        self.carried = (anywhere || placed.is_some()).then_some(Intent::Placed { near: placed });
        self.ended = None;
        self.session = Some(session);
        self.wish(Intent::Pause, now);
        self.settling = Some(0);
    }

    /// A robot that says it is in the life that it was in, and counts from before what the run heard of it last,
    /// was started again all the same: its board has no number for that.
    pub(super) fn counts_anew(&mut self, telemetry: &Telemetry) {
        if !std::mem::take(&mut self.taken_up) {
            return;
        }
        let last = self.session.as_ref().and_then(|session| session.mission().tracker().last());
        let told = self.restart.map_or(*telemetry, |restart| restart.of(telemetry));
        if let Some(last) = last.filter(|last| told.odometer().time_us < last.time_us) {
            self.restarted = Some(last);
            self.carried.get_or_insert(Intent::Placed { near: None });
        }
    }

    /// Whether a robot of which nobody knows where it is can find out: by the walls of a boundary that is closed.
    pub(super) fn can_find_its_place(&self) -> bool {
        self.session.as_ref().is_some_and(|session| session.mission().map().closed)
    }

    /// The robot stands still after an interruption: what it was doing then is over.
    pub(super) fn settled(&mut self, now: f64) {
        self.settling = None;
        let run = self.session.as_ref().map(Session::run_state);
        if matches!(run, Some(RunState::Running | RunState::Stepping(_))) {
            // Nothing begins between the end of that and the word that the robot is somewhere else.
            self.wish(Intent::Pause, now);
        }
        if let Some(id) = self.session.as_ref().and_then(|session| session.mission().awaited()) {
            self.not_begun(id, now);
        }
        if let Some(carried) = self.carried {
            if self.session.as_ref().is_some_and(cannot_be_told) {
                self.settling = Some(0);
                return;
            }
            self.carried = None;
            self.wish(carried, now);
            self.record_life();
        }
        if std::mem::take(&mut self.goes_on) {
            self.wish(Intent::ClearStop, now);
            self.wish(Intent::Run, now);
        }
    }

    /// From here on the run is that of the robot in this life: it has been told that it was carried.
    fn record_life(&mut self) {
        if let (Some(journal), Some(session)) = (&mut self.journal, &self.session)
            && let (Some(restart), Some(identity)) = (&self.restart, self.host.identity())
        {
            let time_us = session.mission().tracker().time_us();
            journal.life(time_us, &restart.life(identity.boot));
        }
    }
}

/// Whether the run cannot be told yet that its robot was carried: the end of its motion was not believed.
fn cannot_be_told(session: &Session) -> bool {
    session.mission().is_moving() && !session.run_state().is_over()
}

/// Why the robot that is there is not the one called `name` with the body `was`; none when it is.
fn differs(name: &str, was: &Chassis, identity: &Identity) -> Option<String> {
    if name != identity.name {
        Some(format!("the run was made with {name}, and this is {}", identity.name))
    } else if *was != identity.chassis {
        Some("the robot has another body or other switches than in the run".to_owned())
    } else {
        None
    }
}
