//! What is left of commands and of a chassis when they have gone over the line: numbers in whole units
//! of the protocol page.

use super::{FromRobot, LENGTH, MICRO, MILLI, scaled};
use crate::robot::{Chassis, Command, Motion, SensorMount};

/// `command` as the robot will understand it.
#[must_use]
pub fn quantised(command: Command) -> Command {
    let to = |value: f64, unit: f64| scaled(value, unit) as f64 / unit;
    let motion = match command.motion {
        Motion::Move { distance, speed } => {
            Motion::Move { distance: to(distance, LENGTH), speed: to(speed, MILLI) }
        }
        Motion::Turn { angle, rate } => {
            Motion::Turn { angle: to(angle, MICRO), rate: to(rate, MILLI) }
        }
        Motion::Rest => Motion::Rest,
    };
    Command { motion, time_limit: to(command.time_limit, MILLI), ..command }
}

/// `chassis` as a host will understand it.
#[must_use]
pub fn told(chassis: &Chassis) -> Chassis {
    let heard = |message: &FromRobot| FromRobot::parse(&message.to_string());
    let switch = |(index, mount): (usize, &SensorMount)| {
        let message = FromRobot::Switch { index, mount: mount.clone() };
        match heard(&message) {
            Some(FromRobot::Switch { mount, .. }) => mount,
            _ => mount.clone(),
        }
    };
    let sensors = chassis.sensors.iter().enumerate().map(switch).collect();
    match heard(&FromRobot::Body(chassis.clone())) {
        Some(FromRobot::Body(body)) => Chassis { sensors, ..body },
        _ => Chassis { sensors, ..chassis.clone() },
    }
}
