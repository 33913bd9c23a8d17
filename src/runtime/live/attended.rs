//! A robot under an operator's hands does not drive while the operator is not there: a console that hangs, or
//! whose screen is stuck, shows nothing and hears no stop.

use super::LiveRun;
use crate::export::Outcome;
use crate::session::RunState;
use std::io::Write;

/// An operator who was not there for so long is not there, seconds.
const ABSENT: f64 = 1.0;

impl<W: Write> LiveRun<W> {
    /// An operator was there at `when`, seconds of the clock of [`LiveRun::tick`]. From the first time on
    /// the robot is stopped when that is more than a second ago.
    pub fn attended(&mut self, when: f64) {
        self.attended = Some(when);
    }

    /// Stops the robot when the operator is not there.
    pub(super) fn mind_the_operator(&mut self, now: f64) {
        if self.attended.is_some_and(|when| now - when > ABSENT) && self.may_drive() {
            let why = "the console hangs, or its screen is stuck: the robot was stopped";
            self.remark(why.to_owned(), now);
            self.stop(now);
        }
    }

    /// The robot itself does not mind for `seconds` whether its host is there: a line that breaks would let it
    /// drive on for as long. The operator may have it so, and knows it then.
    pub(super) fn patient(&mut self, seconds: f64, now: f64) {
        let why = format!(
            "the robot drives on for {seconds:.0} s after its host falls silent (its watchdog), and should stop \
             by itself within 0.3 s: it was stopped"
        );
        self.remark(why.clone(), now);
        self.stop(now);
        if self.plan.at_once {
            self.end(Outcome::Failed, why);
        }
    }

    /// Whether the robot drives, or will without another word.
    fn may_drive(&self) -> bool {
        self.session.as_ref().is_some_and(|session| match session.run_state() {
            RunState::Running | RunState::Stepping(_) => true,
            RunState::Paused => session.mission().is_moving(),
            RunState::Stopped | RunState::Complete | RunState::Failed(_) => false,
        })
    }
}
