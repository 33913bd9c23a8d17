//! What the robot says, taken in: pose, contacts, how a motion ended. Nothing is decided here.

use super::{AtRest, Mission, Output, Task};
use crate::geometry::{Pose, rotate};
use crate::mapping::event::EventKind;
use crate::mapping::map::ContactKind;
use crate::mapping::network::{Glance, Rest};
use crate::mapping::survey::Step;
use crate::mapping::trust::{Defect, Doubted, Going};
use crate::mapping::wall::{Sighting, Turning};
use crate::robot::{DoneReason, Odometer, SwitchSet, Telemetry};

/// A switch looks straight ahead within this, radians.
const AHEAD: f64 = 0.05;

impl Mission {
    /// Takes one message of the robot.
    pub fn telemetry(&mut self, input: &Telemetry, out: &mut Vec<Output>) {
        match input {
            Telemetry::Report { odometer, switches, bumper } => {
                self.odometer(odometer);
                self.network.pass(self.tracker.reading());
                self.hear(*switches, out);
                self.press(*bumper);
            }
            Telemetry::Edge(edge) => {
                let pose = self.odometer(&edge.odometer);
                if !self.has_switch(edge.sensor) {
                    return;
                }
                self.hear(self.raw.with(edge.sensor, edge.rising), out);
                if self.trust.out().has(edge.sensor) {
                    return;
                }
                let turning = self.awaited.map_or(Turning::Unknown, |awaited| awaited.turning);
                let travelled = self.tracker.travelled();
                let seen = self.wall_mut().map(|wall| wall.observe(edge, pose, turning, travelled));
                self.network_sees(seen.as_ref());
                // Lost, its pose is no place of the map.
                let seen = seen.filter(|_| self.lost.is_none());
                let fixed = seen.and_then(|seen| match &mut self.task {
                    Task::Tour(tour) => tour.fix(&mut self.survey, pose, &seen),
                    Task::Retrace(retrace) => retrace.fix(&mut self.survey, pose, &seen),
                    _ => None,
                });
                if let Some(fixed) = fixed {
                    self.tracker.correct(fixed);
                }
            }
            Telemetry::Done { id, reason, odometer, switches, bumper } => {
                let pose = self.odometer(odometer);
                let held_up = matches!(reason, DoneReason::Bumper | DoneReason::Stalled);
                self.network.rest(Rest { reading: self.tracker.reading(), held_up });
                self.hear(*switches, out);
                self.press(*bumper);
                if self.awaited.is_some_and(|awaited| awaited.id == *id) {
                    self.awaited = None;
                    self.idle.ended(*reason, self.tracker.reading());
                    let reason = match *reason {
                        DoneReason::Guard { sensor, .. } if !self.has_switch(sensor) => {
                            DoneReason::Stopped
                        }
                        reason => reason,
                    };
                    self.came_to_rest(pose, reason, odometer.time_us, out);
                }
            }
        }
    }

    /// Keeps what was `seen` for when all of it is adjusted.
    fn network_sees(&mut self, seen: Option<&Sighting>) {
        if let Some(seen) = seen
            && let Some(sensor) = seen.sensor
        {
            self.network.glance(Glance {
                reading: self.tracker.reading(),
                sensor,
                arm: rotate(seen.point - seen.pose.position, -seen.pose.heading),
                sure: seen.kind == ContactKind::Range,
            });
        }
    }

    /// Whether the robot has a switch of this number: one that names another says nothing by it.
    fn has_switch(&self, sensor: usize) -> bool {
        sensor < self.settings.chassis.sensors.len()
    }

    /// Takes what the switches say, and listens no longer to one that gives itself away by it. What comes of
    /// inputs that no switch is at is nothing.
    fn hear(&mut self, told: SwitchSet, out: &mut Vec<Output>) {
        let own = |set: SwitchSet, index| set.with(index, told.has(index));
        let switches = (0..self.settings.chassis.sensors.len()).fold(SwitchSet::EMPTY, own);
        self.raw = switches;
        let going = self.going();
        self.trust.hear(switches, &going);
        if let Some(wall) = self.wall_mut() {
            for index in wall.take_missed() {
                self.trust.missed(index);
            }
        }
        while let Some((index, defect)) = self.trust.next_defect(&going) {
            let switch = self.settings.chassis.sensors[index].name.clone();
            self.afresh |= defect == Defect::Chatters;
            self.map.doubted.push(Doubted { switch: switch.clone(), defect });
            self.tell(EventKind::SwitchDoubted { switch, defect }, out);
        }
        self.closed = self.trust.believed(switches);
    }

    /// What the robot has done by now.
    pub(super) fn going(&self) -> Going {
        Going {
            travelled: self.tracker.travelled(),
            wound: self.tracker.spun().wound,
            turn: self.tracker.turn(),
            at: self.tracker.pose().position,
        }
    }

    /// Takes what the bumper says.
    fn press(&mut self, bumper: bool) {
        self.bumper = bumper;
        self.trust.hear_bumper(bumper, self.tracker.travelled(), self.tracker.time_us());
    }

    fn came_to_rest(
        &mut self,
        pose: Pose,
        reason: DoneReason,
        time_us: u64,
        out: &mut Vec<Output>,
    ) {
        self.rest = AtRest { pose, closed: self.closed, reason };
        match reason {
            DoneReason::Bumper | DoneReason::Stalled => {
                self.bumps += 1;
                if reason == DoneReason::Stalled || self.trust.is_touch() {
                    self.miss_ahead(reason);
                }
                let travelled = self.tracker.travelled();
                if let Some(wall) = self.wall_mut() {
                    wall.touch(pose, travelled, time_us);
                }
                self.tell(EventKind::Bumped, out);
            }
            DoneReason::TimeLimit | DoneReason::HostSilent => {
                self.tell(EventKind::Odd { reason }, out);
            }
            DoneReason::Complete | DoneReason::Guard { .. } | DoneReason::Stopped => {}
        }
    }

    /// The bumper felt something and the switch that looks ahead had not closed: once or twice that is
    /// something thin beside its beam.
    fn miss_ahead(&mut self, reason: DoneReason) {
        let ahead = self.settings.chassis.sensor_towards(0.0, AHEAD);
        if let Some(ahead) =
            ahead.filter(|index| reason == DoneReason::Bumper && !self.raw.has(*index))
        {
            self.trust.missed(ahead);
        }
    }

    fn odometer(&mut self, odometer: &Odometer) -> Pose {
        let (before, time) = (self.tracker.pose(), self.tracker.time_us());
        let rested = self.tracker.rested_us();
        let spun = self.tracker.spun();
        let turning = self.awaited.as_ref().map(|awaited| awaited.turning);
        self.tracker.is_to_turn(matches!(turning, Some(Turning::By(_))));
        let mut pose = self.tracker.advance(odometer, self.phase);
        let rested = self.tracker.rested_us() - rested;
        if self.network.is_empty() {
            self.network.rest(Rest { reading: self.tracker.reading(), held_up: false });
        }
        if let Some((seconds, rate)) = self.tracker.take_drift() {
            self.survey.rest(seconds, rate);
            self.tracker.set_bias(self.tracker.bias() - self.survey.take_bias());
        }
        if self.is_surveying() {
            let passed = odometer.time_us.saturating_sub(time).saturating_sub(rested);
            let step = Step {
                from: before,
                to: pose,
                seconds: passed as f64 * 1e-6,
                spun: (spun, self.tracker.spun()),
            };
            self.survey.predict(&step);
            let goes_round = matches!(&self.task, Task::Tour(tour) if tour.goes_round());
            if !goes_round {
                pose = self.survey.take_pose(pose);
                self.tracker.nudge(pose);
            }
        }
        // Who is not listened to proves nothing by being open either.
        let closed = self.closed.union(self.trust.out());
        let travelled = self.tracker.travelled();
        if let Some(wall) = self.wall_mut() {
            wall.carve(pose, closed, travelled, odometer.time_us);
        }
        pose
    }
}
