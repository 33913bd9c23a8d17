//! The one gate through which every command passes on its way to the robot.
//!
//! It knows the limits of the chassis and whether a stop is latched; it refuses what breaks them.
//! It decides nothing else. [`leap`] is its counterpart for what the robot says.

pub mod leap;

pub use leap::{Leap, Watch};

use crate::robot::{Chassis, Command, Motion};

/// Why a command was not let through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// The operator stopped the robot and has not cleared the stop.
    #[error("stopped: clear the stop first")]
    Latched,
    /// A number in it is not finite, or the time limit is missing.
    #[error("the command has a number that makes no sense")]
    Senseless,
    /// It is faster than the chassis allows.
    #[error("faster than the chassis allows")]
    TooFast,
}

/// The gate.
#[derive(Debug, Clone)]
pub struct Gate {
    latched: bool,
    speed: f64,
    turn_rate: f64,
}

impl Gate {
    /// For a robot with `chassis`.
    #[must_use]
    pub fn new(chassis: &Chassis) -> Self {
        Self { latched: false, speed: chassis.speed, turn_rate: chassis.turn_rate }
    }

    /// Nothing passes any more until [`Gate::clear`].
    pub fn latch(&mut self) {
        self.latched = true;
    }

    /// Commands pass again.
    pub fn clear(&mut self) {
        self.latched = false;
    }

    /// Whether a stop is latched.
    #[must_use]
    pub fn is_latched(&self) -> bool {
        self.latched
    }

    /// The command, if it may go to the robot.
    ///
    /// # Errors
    /// Why it may not.
    pub fn admit(&self, command: Command) -> Result<Command, Refusal> {
        if self.latched {
            return Err(Refusal::Latched);
        }
        let (size, speed, most) = match command.motion {
            Motion::Move { distance, speed } => (distance, speed, self.speed),
            Motion::Turn { angle, rate } => (angle, rate, self.turn_rate),
            Motion::Rest => (0.0, 0.0, 0.0),
        };
        let limited = command.time_limit.is_finite() && command.time_limit > 0.0;
        if !(size.is_finite() && speed.is_finite() && speed >= 0.0 && limited) {
            return Err(Refusal::Senseless);
        }
        if speed > most {
            return Err(Refusal::TooFast);
        }
        Ok(command)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{CommandId, Guard};

    fn drive(distance: f64, speed: f64, time_limit: f64) -> Command {
        let motion = Motion::Move { distance, speed };
        Command { id: CommandId(1), motion, guard: Guard::default(), time_limit }
    }

    #[test]
    fn only_sound_commands_pass_and_none_while_latched() {
        let mut gate = Gate::new(&Chassis::default());
        assert!(gate.admit(drive(1.0, 0.2, 9.0)).is_ok());
        assert_eq!(gate.admit(drive(1.0, 0.3, 9.0)), Err(Refusal::TooFast));
        assert_eq!(gate.admit(drive(f64::NAN, 0.2, 9.0)), Err(Refusal::Senseless));
        assert_eq!(gate.admit(drive(1.0, 0.2, f64::INFINITY)), Err(Refusal::Senseless));
        assert_eq!(gate.admit(drive(1.0, f64::NAN, 9.0)), Err(Refusal::Senseless));
        assert_eq!(gate.admit(drive(1.0, -0.2, 9.0)), Err(Refusal::Senseless));
        assert_eq!(gate.admit(drive(1.0, 0.2, 0.0)), Err(Refusal::Senseless));
        let motion = Motion::Turn { angle: 1.0, rate: 2.1 };
        let turn = Command { motion, ..drive(0.0, 0.0, 9.0) };
        assert_eq!(gate.admit(turn), Err(Refusal::TooFast));
        gate.latch();
        assert_eq!(gate.admit(drive(1.0, 0.2, 9.0)), Err(Refusal::Latched));
        gate.clear();
        assert!(gate.admit(drive(1.0, 0.2, 9.0)).is_ok());
    }
}
