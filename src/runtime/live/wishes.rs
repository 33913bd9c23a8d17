//! What the operator wishes of a run over a line, and what is not followed at once.

use super::LiveRun;
use crate::robot::Intent;
use std::io::Write;

impl<W: Write> LiveRun<W> {
    /// Takes a wish of the operator. A stop leaves with the next bytes, before everything else.
    pub fn intent(&mut self, intent: Intent, now: f64) {
        self.goes_on &= intent != Intent::Stop;
        if self.session.is_none() {
            if intent == Intent::Stop {
                self.host.stop(now);
            }
        } else if self.settling.is_some() && matches!(intent, Intent::Placed { .. }) {
            // The run is told as soon as it can be; the operator knows more than what it would be told.
            self.carried = Some(intent);
        } else if let Some(why) = self.objection(intent) {
            self.remark(why, now);
        } else {
            self.wish(intent, now);
        }
    }

    /// The robot is told to stop, ahead of wishes that were given before the one to stop and take their time.
    pub fn stop_ahead(&mut self, now: f64) {
        self.host.stop(now);
    }

    /// Follows a wish, the operator's or one of this program's own.
    pub(super) fn wish(&mut self, intent: Intent, now: f64) {
        let Some(session) = &mut self.session else { return };
        if let Some(journal) = &mut self.journal {
            journal.intent(session.mission().tracker().time_us(), &intent);
        }
        session.intent(intent, &mut self.outgoing);
        self.deliver(now);
    }

    /// Why a wish that would set the robot going is not followed now; none when it is.
    fn objection(&self, intent: Intent) -> Option<String> {
        let sets_going = intent == Intent::ClearStop || intent.sets_going();
        if let Some(why) = self.stranger().or_else(|| self.disbelieved.clone())
            && sets_going
        {
            return Some(why);
        }
        // Until then `STOPPING` stands on the screen, and so it should.
        let moves = self.session.as_ref().is_some_and(|session| session.mission().is_moving());
        if intent == Intent::ClearStop && moves && !self.host.is_at_rest() {
            return Some(
                "the robot has not said yet that it stands: clear the stop then".to_owned(),
            );
        }
        // Set going before, it would go on from where it was, and nobody would tell it any more that it is
        // somewhere else.
        let waits = self.settling.is_some() || self.carried.is_some();
        (sets_going && waits).then(|| {
            "not before the robot is heard and stands still: say it again in a second".to_owned()
        })
    }
}
