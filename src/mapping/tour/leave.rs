//! Leaving what is being done: a robot that was carried off, or is astray, drives its line again; a line on
//! which nothing leads anywhere is at its end.

use super::drive::{Drive, Purpose};
use super::{Doing, Scene, Tour, finish};
use crate::mapping::map::{LineReason, LineStatus, RoomMap};
use crate::mapping::wall::Wall;

impl Tour {
    /// The robot was carried off, or is astray: what it was doing is left undone, and its line is driven again.
    pub fn interrupt(&mut self, map: &mut RoomMap) {
        self.wall = Wall::new(&self.chassis);
        self.look_next = None;
        self.to_tie = None;
        let suspended = self.suspended.take().map(|drive| *drive);
        for drive in suspended.into_iter().chain(self.in_hand()) {
            self.undo(&drive, map);
        }
    }

    /// What is being driven, taken out of hand.
    fn in_hand(&mut self) -> Option<Drive> {
        match std::mem::replace(&mut self.doing, Doing::Choosing) {
            Doing::Choosing | Doing::Feeling(_) | Doing::Tying(_) | Doing::Retreating(_) => None,
            Doing::Driving(drive) | Doing::BackingOff(drive) => Some(*drive),
            Doing::Passing(pass) => Some(pass.into_drive()),
            Doing::Rounding(round) => Some(round.into_drive()),
        }
    }

    /// A line that was begun is driven from its beginning once more.
    fn undo(&mut self, drive: &Drive, map: &mut RoomMap) {
        if drive.purpose != Purpose::Line {
            return;
        }
        self.driven -= drive.done;
        self.halves.retain(|half| half.line() != drive.id);
        self.queue.push_front((drive.id, drive.backwards));
        let line = map.plan.as_mut().and_then(|p| p.lines.iter_mut().find(|l| l.id == drive.id));
        if let Some(line) = line {
            finish(line, LineStatus::Planned, None);
        }
    }

    /// The line in hand is at an end: nothing on it leads anywhere.
    pub(super) fn give_up(&mut self, scene: &mut Scene<'_>) {
        let Some(drive) = self.in_hand() else { return };
        self.end_line(&drive, LineStatus::Blocked, Some(LineReason::ObjectOnLine), scene);
    }
}
