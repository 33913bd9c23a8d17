//! The embedded simulator behind the same vocabulary as a robot on a line: firmware and body in
//! one, stepped in virtual time.

use crate::firmware::{Firmware, STEP};
use crate::geometry::Pose;
use crate::robot::{Chassis, Command, Hardware, Telemetry};
use crate::simulator::{Body, NoiseProfile, World};

/// A simulated robot in a world.
#[derive(Debug, Clone)]
pub struct SimulatedLink {
    firmware: Firmware,
    body: Body,
    truth: Vec<(u64, Pose)>,
}

impl SimulatedLink {
    /// A robot with `chassis` at the start of `world`.
    #[must_use]
    pub fn new(world: &World, chassis: &Chassis, noise: NoiseProfile, seed: u64) -> Self {
        Self {
            firmware: Firmware::new(chassis),
            body: Body::new(world, chassis, noise, seed),
            truth: vec![(0, world.start)],
        }
    }

    /// Sends a command.
    pub fn send(&mut self, command: Command) {
        self.body.begin_motion();
        self.firmware.command(command, &self.body);
    }

    /// Stops at once, past everything else.
    pub fn stop(&mut self) {
        self.firmware.stop();
    }

    /// Whether a motion is under way.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.firmware.is_moving()
    }

    /// The state before anything has moved.
    #[must_use]
    pub fn greeting(&self) -> Telemetry {
        Telemetry::Report {
            odometer: self.body.odometer(),
            switches: self.body.switches(),
            bumper: self.body.bumper(),
        }
    }

    /// Lets one control step (20 ms) pass and appends what the robot says. The call itself is the
    /// host's heartbeat.
    pub fn advance(&mut self, out: &mut Vec<Telemetry>) {
        self.firmware.heartbeat();
        let truth = &mut self.truth;
        self.firmware.step(&mut self.body, |telemetry, body| {
            let (time_us, pose) = match &telemetry {
                Telemetry::Edge(edge) => (edge.odometer.time_us, body.truth_of_edge()),
                Telemetry::Report { odometer, .. } | Telemetry::Done { odometer, .. } => {
                    (odometer.time_us, body.true_pose())
                }
            };
            truth.push((time_us, pose));
            out.push(telemetry);
        });
        self.body.step(STEP);
    }

    /// Where the body really was at each message so far: robot time in microseconds and pose. The
    /// only simulator truth that leaves the simulator; it goes to the exports alone.
    #[must_use]
    pub fn truth(&self) -> &[(u64, Pose)] {
        &self.truth
    }

    /// How often the bumper was pressed.
    #[must_use]
    pub fn bumps(&self) -> u32 {
        self.body.bumps()
    }

    /// Metres travelled with the body against something.
    #[must_use]
    pub fn contact(&self) -> f64 {
        self.body.contact()
    }
}

#[cfg(test)]
mod tests;
