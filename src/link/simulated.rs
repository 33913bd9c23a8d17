//! The embedded simulator as a robot on a line that takes no time: body, control program and both
//! ends of the wire, stepped in virtual time. Every command and every message goes through the same
//! codec as those of a robot on a cable.

use crate::firmware::{Device, STEP};
use crate::geometry::Pose;
use crate::robot::{Chassis, Command, Hardware, Telemetry};
use crate::simulator::{Body, NoiseProfile, World};
use crate::wire::{FromRobot, Heard, Host};

/// A simulated robot in a world.
#[derive(Debug, Clone)]
pub struct SimulatedLink {
    device: Device,
    body: Body,
    host: Host,
    steps: u64,
    heard: Vec<Heard>,
    truth: Vec<(u64, Pose)>,
}

impl SimulatedLink {
    /// A robot with `chassis` at the start of `world`.
    #[must_use]
    pub fn new(world: &World, chassis: &Chassis, noise: NoiseProfile, seed: u64) -> Self {
        let mut link = Self {
            device: Device::new(chassis, &world.name, 1, 1.0),
            body: Body::new(world, chassis, noise, seed),
            host: Host::new(0, 1, 0.0),
            steps: 0,
            heard: Vec::new(),
            truth: vec![(0, world.start)],
        };
        // Who the robot is takes a question and an answer.
        for _ in 0..2 {
            link.host.tick(0.0, &mut link.heard);
            link.exchange();
        }
        link.heard.clear();
        link
    }

    /// Seconds since the link was opened: whole control steps.
    fn now(&self) -> f64 {
        self.steps as f64 * STEP
    }

    /// What either end has written reaches the other.
    fn exchange(&mut self) {
        let down = self.host.take_output();
        if !down.is_empty() {
            self.device.receive(&down);
        }
        let up = self.device.take_output();
        if !up.is_empty() {
            let now = self.now();
            self.host.receive(&up, now, &mut self.heard);
        }
    }

    /// Sends a command.
    pub fn send(&mut self, command: Command) {
        let now = self.now();
        self.host.send(command, now);
        self.exchange();
    }

    /// Stops at once, past everything else.
    pub fn stop(&mut self) {
        let now = self.now();
        self.host.stop(now);
        self.exchange();
    }

    /// Whether a motion is under way.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.device.is_moving()
    }

    /// The state before anything has moved, as the wire tells it.
    #[must_use]
    pub fn greeting(&self) -> Telemetry {
        let (switches, bumper) = (self.body.switches(), self.body.bumper());
        let odometer = self.body.odometer();
        let report = FromRobot::Report { odometer, switches, bumper, event: 0, battery: None };
        let odometer = match FromRobot::parse(&report.to_string()) {
            Some(FromRobot::Report { odometer, .. }) => odometer,
            _ => odometer,
        };
        Telemetry::Report { odometer, switches, bumper }
    }

    /// Lets one control step (20 ms) pass and appends what the robot says. The call itself is the
    /// host's heartbeat.
    pub fn advance(&mut self, out: &mut Vec<Telemetry>) {
        self.steps += 1;
        let now = self.now();
        self.host.tick(now, &mut self.heard);
        self.exchange();
        let truth = &mut self.truth;
        self.device.step(&mut self.body, |telemetry, body| {
            let (time_us, pose) = match telemetry {
                Telemetry::Edge(edge) => (edge.odometer.time_us, body.truth_of_edge()),
                Telemetry::Report { odometer, .. } | Telemetry::Done { odometer, .. } => {
                    (odometer.time_us, body.true_pose())
                }
            };
            truth.push((time_us, pose));
        });
        self.exchange();
        out.extend(self.heard.drain(..).filter_map(|heard| match heard {
            Heard::Telemetry(telemetry) => Some(telemetry),
            _ => None,
        }));
        self.body.step(STEP);
    }

    /// Where the body really was at each message so far: robot time in microseconds and pose. The
    /// only simulator truth that leaves the simulator; it goes to the exports alone.
    #[must_use]
    pub fn truth(&self) -> &[(u64, Pose)] {
        &self.truth
    }

    /// Metres travelled with the body against something.
    #[must_use]
    pub fn contact(&self) -> f64 {
        self.body.contact()
    }
}

#[cfg(test)]
mod tests;
