//! The robot's own side: what turns a command into motion, and what stops it.
//!
//! Runs every 20 ms over a [`Hardware`]. Stops by itself on the guards of the command, on the
//! bumper, on the time limit, when it is stalled, and when the host has been silent for 300 ms.
//! Knows nothing of maps; decides nothing but when to stop.

pub mod device;

pub use device::Device;

use crate::geometry::angle;
use crate::robot::{
    Chassis, Command, CommandId, DoneReason, Hardware, Motion, Odometer, Telemetry,
};

/// Length of a control step, seconds.
pub const STEP: f64 = 0.02;
/// Silence of the host after which the robot stops, seconds.
pub const WATCHDOG: f64 = 0.3;
/// A stop brakes so many times as hard as the end of a motion.
const HARD: f64 = 2.0;
/// What is left of a motion that is complete, metres or radians: no whole number of what either is
/// counted in, lest the last bit decides.
const CLOSE: f64 = 1.004e-4;
/// A complete motion is no faster than what a control step can brake, and this little more: likewise.
const SLOW: f64 = 1.004;
/// Steps between two reports.
const REPORT_STEPS: u32 = 5;
/// Steps that the body is given to come to rest after a motion before the next one begins: the heading
/// that a move holds is that of a body at rest. A command that comes sooner waits as long, so that what a
/// robot does does not hang on how soon within them its host answers.
const SETTLING: u32 = 2;

/// Wheels that are driven faster than this, or than a quarter of the robot's speed if that is less, should
/// turn, metres per second.
const PUSHES: f64 = 0.05;
/// A stall is more steps than this without a tick, and a way for which more ticks than this were due: a
/// coarse encoder is still for long from one tick to the next.
const STALL_STEPS: u32 = 10;
const STALL_TICKS: f64 = 2.0;

#[derive(Debug, Clone, Copy)]
struct Running {
    command: Command,
    begin: Odometer,
    speed: f64,
    ending: Option<DoneReason>,
    /// A stop came, whatever it is that ends the motion.
    stopped: bool,
    /// The bumper was pressed, or the wheels stood still, likewise.
    struck: bool,
    /// Steps in which the wheels were driven and did not tick.
    still: u32,
    /// How far they were driven in them, metres.
    driven: f64,
    last: Odometer,
}

/// The robot's control program.
#[derive(Debug, Clone)]
pub struct Firmware {
    chassis: Chassis,
    running: Option<Running>,
    /// Taken, and begun as soon as the body is at rest; with why it is to end at once, if it is.
    waiting: Option<(Command, Option<DoneReason>)>,
    /// Steps since the last motion ended.
    stood: u32,
    last_id: Option<CommandId>,
    silent: f64,
    patience: f64,
    steps: u32,
    /// Steps between two reports.
    every: u32,
}

impl Firmware {
    /// For a robot with `chassis`.
    #[must_use]
    pub fn new(chassis: &Chassis) -> Self {
        Self {
            chassis: chassis.clone(),
            running: None,
            waiting: None,
            stood: SETTLING,
            last_id: None,
            silent: 0.0,
            patience: WATCHDOG,
            steps: 0,
            every: REPORT_STEPS,
        }
    }

    /// The same for a robot whose time runs `speed` times as fast as its host's: it waits as much longer for a
    /// host that is silent, and one that is slower than life reports as often by its host's time.
    #[must_use]
    pub fn at_speed(self, speed: f64) -> Self {
        let every = (f64::from(REPORT_STEPS) * speed.min(1.0)).round().max(1.0);
        Self { patience: WATCHDOG * speed.max(1.0), every: every as u32, ..self }
    }

    /// Takes a motion, which begins once the body is at rest. A repeated id is the same command and
    /// changes nothing.
    pub fn command(&mut self, command: Command) {
        self.silent = 0.0;
        if self.last_id == Some(command.id) {
            return;
        }
        self.last_id = Some(command.id);
        self.waiting = Some((command, None));
    }

    fn begin(&mut self, command: Command, ending: Option<DoneReason>, hardware: &impl Hardware) {
        // Reports keep step with the motion, the first of it now: two runs of one plan are told at the
        // same places of it, whatever the waits before.
        self.steps = self.every - 1;
        let begin = hardware.odometer();
        self.running = Some(Running {
            command,
            begin,
            speed: 0.0,
            ending,
            stopped: false,
            struck: false,
            still: 0,
            driven: 0.0,
            last: begin,
        });
    }

    /// A host begins to count its commands anew: a number that was there before is no repetition.
    pub fn count_anew(&mut self) {
        self.last_id = None;
    }

    /// The host is there.
    pub fn heartbeat(&mut self) {
        self.silent = 0.0;
    }

    /// Brakes at once, and harder than whatever is braking already.
    pub fn stop(&mut self) {
        if let Some(running) = &mut self.running {
            running.stopped = true;
        }
        self.end(DoneReason::Stopped);
    }

    /// Whether a motion is under way, or about to be.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.running.is_some() || self.waiting.is_some()
    }

    fn end(&mut self, reason: DoneReason) {
        if let Some(running) = &mut self.running {
            running.ending = running.ending.or(Some(reason));
        }
        if let Some((_, ending)) = &mut self.waiting {
            *ending = ending.or(Some(reason));
        }
    }

    /// One control step: reads the hardware, sets the drive, says what happened to `tell`, which is
    /// also given the hardware as it was at that instant.
    pub fn step<H: Hardware>(&mut self, hardware: &mut H, mut tell: impl FnMut(Telemetry, &H)) {
        self.silent += STEP;
        if self.stood >= SETTLING
            && let Some((command, ending)) = self.waiting.take()
        {
            self.begin(command, ending, hardware);
        }
        self.stood = self.stood.saturating_add(1);
        self.steps += 1;
        while let Some(edge) = hardware.take_edge() {
            tell(Telemetry::Edge(edge), hardware);
            if let Some(running) = &mut self.running {
                let guard = running.command.guard;
                let watched = if edge.rising { guard.rise } else { guard.fall };
                if watched.has(edge.sensor) {
                    let reason = DoneReason::Guard { sensor: edge.sensor, rising: edge.rising };
                    running.ending = running.ending.or(Some(reason));
                }
            }
        }
        if self.silent > self.patience {
            self.end(DoneReason::HostSilent);
        }
        if let Some(done) = self.control(hardware) {
            tell(done, hardware);
        } else if self.steps.is_multiple_of(self.every) {
            let (odometer, switches) = (hardware.odometer(), hardware.switches());
            tell(Telemetry::Report { odometer, switches, bumper: hardware.bumper() }, hardware);
        }
    }

    fn control(&mut self, hardware: &mut impl Hardware) -> Option<Telemetry> {
        let mut running = self.running?;
        let now = hardware.odometer();
        let elapsed = now.time_us.saturating_sub(running.begin.time_us) as f64 * 1e-6;
        let (left, most, acceleration) = self.remaining(&running, &now);
        self.watch(&mut running, hardware, elapsed);
        let rest = matches!(running.command.motion, Motion::Rest);
        let complete =
            !rest && left.abs() < CLOSE && running.speed.abs() <= SLOW * acceleration * STEP;
        let target = if running.ending.is_some() || rest {
            0.0
        } else {
            most.min(braking(left.abs(), acceleration)).min(left.abs() / STEP) * left.signum()
        };
        let change = acceleration * STEP;
        running.speed = if running.struck {
            0.0
        } else if running.ending.is_some() {
            let brake = if running.stopped { HARD * change } else { change };
            running.speed - running.speed.clamp(-brake, brake)
        } else {
            target.clamp(running.speed - change * 1.5, running.speed + change)
        };
        let ended = running.ending.or(complete.then_some(DoneReason::Complete));
        if let Some(reason) = ended
            && (running.speed.abs() < 1e-9 || complete || rest)
        {
            hardware.drive(0.0, 0.0);
            self.running = None;
            self.stood = 0;
            return Some(Telemetry::Done {
                id: running.command.id,
                reason,
                odometer: now,
                switches: hardware.switches(),
                bumper: hardware.bumper(),
            });
        }
        match running.command.motion {
            // The gyro holds the heading: half of what it is off is taken out in every step.
            Motion::Move { .. } => {
                let off = angle::wrap(running.begin.heading - now.heading);
                hardware.drive(running.speed, (off * 0.5 / STEP).clamp(-0.5, 0.5));
            }
            Motion::Turn { .. } => hardware.drive(0.0, running.speed),
            Motion::Rest => hardware.drive(0.0, 0.0),
        }
        running.last = now;
        self.running = Some(running);
        None
    }

    /// What remains of the motion, its highest speed and its acceleration, in its own unit (metres
    /// or radians).
    fn remaining(&self, running: &Running, now: &Odometer) -> (f64, f64, f64) {
        match running.command.motion {
            Motion::Move { distance, speed } => {
                let ticks = now.left_ticks + now.right_ticks
                    - running.begin.left_ticks
                    - running.begin.right_ticks;
                let done = ticks as f64 * self.chassis.tick / 2.0;
                // Nearer than half a tick cannot be told; a little more, lest it hunts to and fro
                // between two ticks equally far off.
                let left = distance - done;
                let left = if left.abs() < self.chassis.tick * 0.55 { 0.0 } else { left };
                (left, speed.min(self.chassis.speed), self.chassis.acceleration)
            }
            Motion::Turn { angle, rate } => {
                let left = angle - (now.heading - running.begin.heading);
                let acceleration = self.chassis.acceleration * 2.0 / self.chassis.wheel_base;
                (left, rate.min(self.chassis.turn_rate), acceleration)
            }
            Motion::Rest => (0.0, 0.0, 1.0),
        }
    }

    fn watch(&self, running: &mut Running, hardware: &impl Hardware, elapsed: f64) {
        let ahead =
            matches!(running.command.motion, Motion::Move { distance, .. } if distance > 0.0);
        let moves = matches!(running.command.motion, Motion::Move { .. });
        if ahead && hardware.bumper() {
            running.struck = true;
            running.ending = running.ending.or(Some(DoneReason::Bumper));
        }
        let now = hardware.odometer();
        let stands = now.left_ticks == running.last.left_ticks
            && now.right_ticks == running.last.right_ticks;
        let pushes = running.speed.abs() > PUSHES.min(self.chassis.speed / 4.0);
        (running.still, running.driven) = if moves && stands && pushes {
            (running.still + 1, running.driven + running.speed.abs() * STEP)
        } else {
            (0, 0.0)
        };
        if running.still > STALL_STEPS && running.driven > STALL_TICKS * self.chassis.tick {
            running.struck = true;
            running.ending = running.ending.or(Some(DoneReason::Stalled));
        }
        if elapsed > running.command.time_limit {
            let reason = match running.command.motion {
                Motion::Rest => DoneReason::Complete,
                _ => DoneReason::TimeLimit,
            };
            running.ending = running.ending.or(Some(reason));
        }
    }
}

/// The highest speed of the coming control step after which `left` is still enough to brake in, by
/// equal steps: what is run in this step and in those of the braking, `v STEP + (v^2 / 2a - v STEP / 2)`,
/// is `left`. The continuous `sqrt(2 a left)` would shoot past and come back.
fn braking(left: f64, acceleration: f64) -> f64 {
    let half = STEP / 2.0;
    acceleration * ((half * half + 2.0 * left / acceleration).sqrt() - half)
}

#[cfg(test)]
mod tests;
