//! Which switches can be believed. A switch that does not work gives itself away by contradictions: it
//! says that something is there wherever the robot goes, it never says so where the others do, or it
//! changes its mind while nothing moves. It is named to the operator, and not listened to any more.

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

/// A switch that closes and never opens over so many metres and radians (every look at the wall opens
/// those that see it, and no robot is let into a lane that it fills) is stuck.
const STUCK: (f64, f64) = (1.0, 12.0);
/// A switch that has not fired once, and was open where others had seen something so often, is dead.
const MISSED: u32 = 12;
/// While the robot goes no farther than so many metres and radians, no switch changes as often, thin
/// things included.
const CHATTER: u32 = 12;
const SPOT: (f64, f64) = (0.05, 0.6);

/// What is known of one switch.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Record {
    closed: bool,
    /// Metres travelled and radians wound when it was open last.
    open_at: (f64, f64),
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
}

impl Trust {
    /// Every switch of `chassis` is believed until it gives itself away.
    #[must_use]
    pub fn new(chassis: &Chassis) -> Self {
        Self { records: vec![Record::default(); chassis.sensors.len()], out: SwitchSet::EMPTY }
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

    /// The switches say `closed` when the robot has travelled and wound `way` (metres, radians).
    pub fn hear(&mut self, closed: SwitchSet, way: (f64, f64)) {
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
            if !now {
                record.open_at = way;
            }
        }
    }

    /// Switch `index` was open where another had seen something.
    pub fn missed(&mut self, index: usize) {
        if let Some(record) = self.records.get_mut(index) {
            record.missed += 1;
        }
    }

    /// The next switch that has given itself away by now, the robot having come `way`: it is out.
    pub fn next_defect(&mut self, way: (f64, f64)) -> Option<(usize, Defect)> {
        let defect = |record: &Record| {
            let since = (way.0 - record.open_at.0, way.1 - record.open_at.1);
            if record.changes >= CHATTER {
                Some(Defect::Chatters)
            } else if record.closed && since.0 > STUCK.0 && since.1 > STUCK.1 {
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
    fn a_switch_that_never_opens_is_stuck_and_one_at_a_long_wall_is_not() {
        let mut trust = Trust::new(&Chassis::default());
        for step in 0..40 {
            // A wall on the left, looked at every half metre; the back says something all along.
            let way = (f64::from(step) * 0.5, f64::from(step) * 2.0);
            trust.hear(closed(&[2, 4]), way);
            trust.hear(closed(&[4]), (way.0 + 0.4, way.1 + 1.0));
        }
        let way = (20.0, 80.0);
        assert_eq!(trust.next_defect(way), Some((4, Defect::StuckClosed)));
        assert_eq!(trust.next_defect(way), None);
        assert_eq!(trust.believed(closed(&[2, 4])), closed(&[2]));
    }

    #[test]
    fn a_switch_that_misses_is_dead_unless_it_ever_fired() {
        let mut trust = Trust::new(&Chassis::default());
        trust.hear(closed(&[1]), (0.0, 0.0));
        for _ in 0..MISSED {
            trust.missed(1);
            trust.missed(2);
        }
        assert_eq!(trust.next_defect((1.0, 1.0)), Some((2, Defect::NeverFires)));
        assert_eq!(trust.next_defect((1.0, 1.0)), None);
    }

    #[test]
    fn a_switch_that_changes_all_the_time_chatters() {
        let mut trust = Trust::new(&Chassis::default());
        for k in 0..CHATTER {
            assert_eq!(trust.next_defect((0.0, 0.0)), None, "after {k}");
            trust.hear(if k % 2 == 0 { closed(&[6]) } else { closed(&[]) }, (0.0, 0.0));
        }
        assert_eq!(trust.next_defect((0.0, 0.0)), Some((6, Defect::Chatters)));
    }
}
