//! A robot that does not tell the truth: encoders that lie, a switch that is stuck, dead or chatters.

use crate::robot::{Edge, Hardware, Odometer, SwitchSet};
use crate::simulator::Body;

/// A body whose encoders, or one of whose switches, do not tell the truth.
pub(super) struct Liar<'a> {
    pub(super) body: &'a mut Body,
    pub(super) lie: [f64; 2],
    /// What its clock says at a time, both in microseconds.
    pub(super) clock: fn(u64) -> u64,
    pub(super) broken: Option<Broken>,
    /// What a switch that chatters said last.
    pub(super) chattered: &'a mut bool,
    /// Edges of the last switch that are still to come at once.
    pub(super) storm: &'a mut u32,
}

/// What is wrong with a switch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Broken {
    pub(super) switch: usize,
    pub(super) how: Fault,
}

/// How.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fault {
    /// It says all the time that something is there.
    Closed,
    /// It never fires.
    Open,
    /// It opens and closes whatever is there, every 60 ms.
    Chatter,
}

impl Liar<'_> {
    fn chatters(&self) -> bool {
        (self.body.odometer().time_us / 60_000).is_multiple_of(2)
    }

    fn bend(&self, told: Odometer) -> Odometer {
        let [left, right] = self.lie;
        Odometer {
            time_us: (self.clock)(told.time_us),
            left_ticks: (told.left_ticks as f64 * left).round() as i64,
            right_ticks: (told.right_ticks as f64 * right).round() as i64,
            ..told
        }
    }
}

impl Hardware for Liar<'_> {
    fn drive(&mut self, speed: f64, rate: f64) {
        self.body.drive(speed, rate);
    }

    fn odometer(&self) -> Odometer {
        self.bend(self.body.odometer())
    }

    fn switches(&self) -> SwitchSet {
        let all = self.body.switches();
        match self.broken {
            Some(Broken { switch, how: Fault::Closed }) => all.with(switch, true),
            Some(Broken { switch, how: Fault::Open }) => all.with(switch, false),
            Some(Broken { switch, how: Fault::Chatter }) => all.with(switch, self.chatters()),
            None => all,
        }
    }

    fn bumper(&self) -> bool {
        self.body.bumper()
    }

    fn take_edge(&mut self) -> Option<Edge> {
        if let Some(left) = self.storm.checked_sub(1) {
            *self.storm = left;
            let rising = left % 2 == 1;
            return Some(Edge { sensor: 7, rising, odometer: self.odometer() });
        }
        let broken = self.broken.map(|broken| broken.switch);
        if let Some(Broken { switch: sensor, how: Fault::Chatter }) = self.broken
            && *self.chattered != self.chatters()
        {
            *self.chattered = self.chatters();
            return Some(Edge { sensor, rising: *self.chattered, odometer: self.odometer() });
        }
        let edge =
            std::iter::from_fn(|| self.body.take_edge()).find(|e| Some(e.sensor) != broken)?;
        Some(Edge { odometer: self.bend(edge.odometer), ..edge })
    }
}
