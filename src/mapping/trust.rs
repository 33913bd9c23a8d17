//! Which switches can be believed. A switch that does not work gives itself away by contradictions: it
//! says that something is there wherever the robot goes, it never says so where the others do, or it
//! changes its mind while nothing moves. It is named to the operator, and not listened to any more. Where all of them
//! say that something is there, or the bumper does, however far the robot goes, there is no going on.

use super::event::Failure;
use crate::geometry::Point;
use crate::robot::{Chassis, SwitchSet};
use serde::{Deserialize, Serialize};

/// What is wrong with a switch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Defect {
    /// It stays closed wherever the robot goes.
    StuckClosed,
    /// It stays open where others see something.
    NeverFires,
    /// It opens and closes for no reason.
    Chatters,
}

/// A switch that is no longer listened to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Doubted {
    /// What it is called.
    pub switch: String,
    /// What is wrong with it.
    pub defect: Defect,
}

/// A switch that stays closed through so many turns in a row, each of so many radians, over so many
/// metres, is stuck: a turn takes a beam off what it sees, on every wall and in almost every corner.
const TURNS: u32 = 6;
const LARGE: f64 = 0.8;
const WAY: f64 = 0.5;
/// A switch that has not fired once, and was open where others had seen something so often, is dead.
/// In 138 runs of 23 rooms a sound one missed four at most before it first fired, at the worst noise; none was
/// taken for dead in 344 runs of 43 rooms.
const MISSED: u32 = 6;
/// While the robot goes no farther than so many metres and radians, no switch changes as often, thin
/// things included.
const CHATTER: u32 = 12;
const SPOT: (f64, f64) = (0.05, 0.6);

/// Nothing is near on all sides of two places so far apart and all the way between them, metres: who is held on all
/// sides gets nowhere.
const SHUT: f64 = 0.3;
/// Whoever drove so far with the bumper pressed all the way, metres, backing off among it, presses against nothing.
const PRESSED: f64 = 1.0;
/// With fewer switches no wall is followed.
const FEWEST: usize = 2;

/// What is known of one switch.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Record {
    closed: bool,
    /// Metres travelled when it was open last, and large turns since then.
    open_at: f64,
    turns: u32,
    fired: u32,
    missed: u32,
    /// How often it changed on the spot where the robot is, and where that spot began.
    changes: u32,
    spot: (f64, f64),
}

/// The watch over all of them.
#[derive(Debug, Clone)]
pub struct Trust {
    records: Vec<Record>,
    out: SwitchSet,
    /// Whether the turn under way is a large one already.
    large: bool,
    /// Metres travelled when one switch at least was open last, and where the robot was then.
    open: (f64, Point),
    /// Metres travelled when the bumper was free last, and robot time then, microseconds.
    free: (f64, u64),
    /// The bumper was free since it ended a motion last.
    released: bool,
}

/// What the robot has done when its switches are heard.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Going {
    /// Metres travelled in all.
    pub travelled: f64,
    /// Radians turned in all, either way.
    pub wound: f64,
    /// Radians of the turn under way.
    pub turn: f64,
    /// Where it is believed to be.
    pub at: Point,
}

impl Trust {
    /// Every switch of `chassis` is believed until it gives itself away; the robot is at `start`.
    #[must_use]
    pub fn new(chassis: &Chassis, start: Point) -> Self {
        let records = vec![Record::default(); chassis.sensors.len()];
        Self {
            records,
            out: SwitchSet::EMPTY,
            large: false,
            open: (0.0, start),
            free: (0.0, 0),
            released: true,
        }
    }

    /// The switches that are no longer listened to.
    #[must_use]
    pub fn out(&self) -> SwitchSet {
        self.out
    }

    /// `closed` without those.
    #[must_use]
    pub fn believed(&self, closed: SwitchSet) -> SwitchSet {
        self.out.iter().fold(closed, |set, index| set.with(index, false))
    }

    /// The switches say `closed`.
    pub fn hear(&mut self, closed: SwitchSet, going: &Going) {
        let way = (going.travelled, going.wound);
        let turned = going.turn.abs() > LARGE && !self.large;
        self.large = going.turn.abs() > LARGE;
        if !(0..self.records.len()).all(|index| closed.has(index)) {
            self.open = (going.travelled, going.at);
        }
        for (index, record) in self.records.iter_mut().enumerate() {
            if way.0 - record.spot.0 > SPOT.0 || way.1 - record.spot.1 > SPOT.1 {
                (record.spot, record.changes) = (way, 0);
            }
            let now = closed.has(index);
            if now != record.closed {
                record.closed = now;
                record.fired += u32::from(now);
                record.changes += 1;
            }
            record.turns += u32::from(turned);
            if !now {
                (record.open_at, record.turns) = (going.travelled, 0);
            }
        }
    }

    /// The bumper says whether it is `pressed`, `travelled` metres on the way, at `time_us`.
    pub fn hear_bumper(&mut self, pressed: bool, travelled: f64, time_us: u64) {
        if !pressed {
            (self.free, self.released) = ((travelled, time_us), true);
        }
    }

    /// The bumper ended a motion: whether it felt something then, or was pressed all the time.
    pub fn is_touch(&mut self) -> bool {
        std::mem::replace(&mut self.released, false)
    }

    /// When the bumper was free last, robot time in microseconds.
    #[must_use]
    pub fn free_us(&self) -> u64 {
        self.free.1
    }

    /// Why no wall can be followed with what these switches and the bumper say of a robot that has come so far, if
    /// that is so.
    #[must_use]
    pub fn ends(&self, going: &Going) -> Option<Failure> {
        // Carried off it is elsewhere without a way, held fast it has gone a way and got nowhere.
        let (went, got) = (going.travelled - self.open.0, (going.at - self.open.1).norm());
        if went.min(got) > SHUT {
            Some(Failure::AllShut)
        } else if going.travelled - self.free.0 > PRESSED {
            Some(Failure::BumperStuck)
        } else if self.records.len() - self.out.iter().count() < FEWEST {
            Some(Failure::SwitchesOut)
        } else {
            None
        }
    }

    /// Switch `index` was open where another had seen something.
    pub fn missed(&mut self, index: usize) {
        if let Some(record) = self.records.get_mut(index) {
            record.missed += 1;
        }
    }

    /// The next switch that has given itself away by now: it is out.
    pub fn next_defect(&mut self, going: &Going) -> Option<(usize, Defect)> {
        let defect = |record: &Record| {
            let far = going.travelled - record.open_at > WAY;
            if record.changes >= CHATTER {
                Some(Defect::Chatters)
            } else if record.closed && far && record.turns >= TURNS {
                Some(Defect::StuckClosed)
            } else if record.fired == 0 && record.missed >= MISSED {
                Some(Defect::NeverFires)
            } else {
                None
            }
        };
        let mut believed =
            self.records.iter().enumerate().filter(|(index, _)| !self.out.has(*index));
        let (index, defect) = believed.find_map(|(k, r)| defect(r).map(|d| (k, d)))?;
        self.out = self.out.with(index, true);
        Some((index, defect))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn closed(indices: &[usize]) -> SwitchSet {
        indices.iter().fold(SwitchSet::EMPTY, |set, &index| set.with(index, true))
    }

    #[test]
    fn a_switch_that_stays_closed_through_every_turn_is_stuck() {
        let mut trust = Trust::new(&Chassis::default(), Point::origin());
        let mut going = Going::default();
        for _ in 0..TURNS {
            assert_eq!(trust.next_defect(&going), None);
            // A wall on the left, looked at every half metre; the back says something all along.
            going.travelled += 0.5;
            going.turn = 0.0;
            trust.hear(closed(&[2, 4]), &going);
            going.turn = -0.4;
            trust.hear(closed(&[4]), &going);
            going.turn = -0.9;
            trust.hear(closed(&[4]), &going);
            going.turn = -1.0;
            trust.hear(closed(&[4]), &going);
        }
        assert_eq!(trust.next_defect(&going), Some((4, Defect::StuckClosed)));
        assert_eq!(trust.next_defect(&going), None);
        assert_eq!(trust.believed(closed(&[2, 4])), closed(&[2]));
    }

    #[test]
    fn a_switch_along_a_curved_wall_may_stay_closed_for_ever() {
        let mut trust = Trust::new(&Chassis::default(), Point::origin());
        for step in 0..2000 {
            let travelled = f64::from(step) * 0.05;
            let turn = if step % 2 == 0 { 0.3 } else { -0.2 };
            let going = Going { travelled, wound: travelled * 5.0, turn, ..Going::default() };
            trust.hear(closed(&[2]), &going);
            assert_eq!(trust.next_defect(&going), None);
        }
    }

    #[test]
    fn a_switch_that_misses_is_dead_unless_it_ever_fired() {
        let (mut trust, going) =
            (Trust::new(&Chassis::default(), Point::origin()), Going::default());
        trust.hear(closed(&[1]), &going);
        for _ in 0..MISSED {
            trust.missed(1);
            trust.missed(2);
        }
        assert_eq!(trust.next_defect(&going), Some((2, Defect::NeverFires)));
        assert_eq!(trust.next_defect(&going), None);
    }

    #[test]
    fn a_switch_that_changes_all_the_time_chatters() {
        let (mut trust, going) =
            (Trust::new(&Chassis::default(), Point::origin()), Going::default());
        for k in 0..CHATTER {
            assert_eq!(trust.next_defect(&going), None, "after {k}");
            trust.hear(if k % 2 == 0 { closed(&[6]) } else { closed(&[]) }, &going);
        }
        assert_eq!(trust.next_defect(&going), Some((6, Defect::Chatters)));
    }
}
