//! A robot that does not know this host any more although it was not started again: another host spoke to it,
//! and its numbers began anew. What is left of the old numbers would make this host deaf to it.

use super::timing::{HOLE, STALE};
use super::{Health, Heard, Host, Introduction, Loss};

/// From one conversation to the next: even, so that a number that was odd never becomes 0, which no
/// conversation has; and far, lest another host comes to the same.
const NEXT: u32 = 0x9E37_79B8;

impl Host {
    /// It introduces itself in another conversation than this: it knew this host, and does not any more.
    pub(super) fn strange(&mut self, boot: u32, session: u32, now: f64, told: &mut Vec<Heard>) {
        if !self.is_open() {
            return;
        }
        let same = self.identity.as_ref().is_some_and(|known| known.boot == boot);
        if same && session != 0 {
            self.begin_anew(now, told);
        } else {
            // It was started again, or there is a hole in what it tells: the answer will say which.
            self.ask_anew(now);
        }
    }

    /// Whether the robot, whose newest event is this one, has told for too long of fewer events than this
    /// host has, and has said meanwhile that it knows this host: they are others.
    pub(super) fn has_forgotten(&mut self, newest: u32, now: f64) -> bool {
        if newest >= self.event || !self.is_open() {
            self.fewer = None;
            return false;
        }
        let since = *self.fewer.get_or_insert(now);
        now - since > HOLE && self.answered > since
    }

    /// Which of the numbers of this conversation are which can no longer be told, and what the robot did in
    /// between is not known: another one begins.
    pub(super) fn begin_anew(&mut self, now: f64, told: &mut Vec<Heard>) {
        told.push(Heard::Forgotten);
        self.converse_anew(now, told);
    }

    /// Begins another conversation.
    pub(super) fn converse_anew(&mut self, now: f64, told: &mut Vec<Heard>) {
        self.session = self.session.wrapping_add(NEXT);
        self.introduction = Introduction::default();
        self.forget();
        (self.opened, self.clean, self.hello_due) = (now, now, now);
        self.out.clear();
        self.turn(Health::Opening, told);
    }

    /// What was asked of the robot before, and what it told, is of another life of it.
    pub(super) fn forget(&mut self) {
        (self.event, self.time_us, self.motion) = (0, 0, None);
        (self.command, self.stop, self.doubt) = (None, None, None);
        (self.fewer, self.behind) = (None, None);
    }

    /// Whether it was lost because it told nothing of itself, and still tells nothing: that it says who it is
    /// does not bring it back.
    pub(super) fn is_still_mute(&self, now: f64) -> bool {
        self.health == Health::Lost(Loss::Mute) && now - self.reported > STALE
    }
}
