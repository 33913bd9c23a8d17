//! The firmware over the simulated body: what each command does, and all that ends it.

use super::*;
use crate::geometry::{Pose, angle};
use crate::robot::{Guard, SwitchSet};
use crate::simulator::{Body, NoiseProfile, World};

/// A robot in an empty room of 6 x 4 m.
struct Robot {
    firmware: Firmware,
    body: Body,
    said: Vec<Telemetry>,
    number: u32,
}

impl Robot {
    fn at(x: f64, y: f64, heading: f64) -> Self {
        Self::with(&Chassis::default(), x, y, heading)
    }

    fn with(chassis: &Chassis, x: f64, y: f64, heading: f64) -> Self {
        let text = "start = { x = 3.0, y = 2.0 }\n[boundary]\nvertices = [[0, 0], [6, 0], [6, 4], [0, 4]]\n";
        let world = World::from_toml(text, "test", 0.1)
            .and_then(|world| world.with_start(Pose::new(x, y, heading), "start", 0.1))
            .expect("a good world");
        Self {
            firmware: Firmware::new(chassis),
            body: Body::new(&world, chassis, NoiseProfile::None, 1),
            said: Vec::new(),
            number: 0,
        }
    }

    fn send(&mut self, motion: Motion, guard: Guard, time_limit: f64) {
        self.number += 1;
        let id = CommandId(self.number);
        let command = Command { id, motion, guard, time_limit };
        self.firmware.command(command);
    }

    /// One control step, with the host there or not.
    fn step(&mut self, host: bool) {
        if host {
            self.firmware.heartbeat();
        }
        let said = &mut self.said;
        self.firmware.step(&mut self.body, |telemetry, _| said.push(telemetry));
        self.body.step(STEP);
    }

    /// Why the motion ended, and after how many seconds.
    fn until_done(&mut self, host: bool) -> (DoneReason, f64) {
        for k in 0..3000 {
            self.step(host);
            let done = self.said.iter().find_map(|telemetry| match telemetry {
                Telemetry::Done { id, reason, .. } if *id == CommandId(self.number) => {
                    Some(*reason)
                }
                _ => None,
            });
            if let Some(reason) = done {
                return (reason, f64::from(k) * STEP);
            }
        }
        panic!("command {} never ended", self.number);
    }

    fn x(&self) -> f64 {
        self.body.true_pose().position.x
    }
}

fn ahead(distance: f64) -> Motion {
    Motion::Move { distance, speed: 0.2 }
}

fn turn(angle: f64) -> Motion {
    Motion::Turn { angle, rate: 2.0 }
}

const FREE: Guard = Guard { rise: SwitchSet::EMPTY, fall: SwitchSet::EMPTY };

#[test]
fn a_move_covers_its_distance_to_the_tick() {
    for distance in [0.002, 0.01, 0.05, 0.3, 1.0, 2.0, -0.01, -0.5] {
        let mut robot = Robot::at(3.0, 2.0, 0.0);
        robot.send(ahead(distance), FREE, 30.0);
        assert_eq!(robot.until_done(true).0, DoneReason::Complete, "{distance}");
        let off = robot.x() - 3.0 - distance;
        assert!(off.abs() <= 5e-4, "a move of {distance} was off by {off}");
        assert!(!robot.firmware.is_moving());
    }
}

#[test]
fn a_turn_covers_its_angle() {
    for angle in [0.01, 0.1, 1.0, angle::PI, 5.0, -0.05, -angle::FRAC_PI_2] {
        let mut robot = Robot::at(3.0, 2.0, 0.0);
        robot.send(turn(angle), FREE, 30.0);
        assert_eq!(robot.until_done(true).0, DoneReason::Complete, "{angle}");
        let off = angle::wrap(robot.body.true_pose().heading - angle);
        assert!(off.abs() < 2e-4, "a turn of {angle} was off by {off}");
        assert!((robot.x() - 3.0).abs() < 1e-12, "a turn is in place");
    }
}

#[test]
fn speed_and_acceleration_stay_within_the_chassis() {
    let mut robot = Robot::at(1.0, 2.0, 0.0);
    let hasty = Motion::Move { distance: 2.0, speed: 9.0 };
    robot.send(hasty, FREE, 30.0);
    let (mut x, mut speed) = (robot.x(), 0.0);
    for _ in 0..200 {
        robot.step(true);
        let now = (robot.x() - x) / STEP;
        assert!(now <= 0.2 + 1e-9, "{now} m/s");
        assert!(now - speed <= 1.0 * STEP + 1e-9, "from {speed} to {now} m/s");
        (x, speed) = (robot.x(), now);
    }
    assert!(x > 1.5, "it did move: {x}");
}

#[test]
fn a_guard_ends_the_move_within_its_braking_distance() {
    let mut robot = Robot::at(4.0, 2.0, 0.0);
    let guard = Guard { rise: SwitchSet::only(0), fall: SwitchSet::EMPTY };
    robot.send(ahead(3.0), guard, 30.0);
    let expected = DoneReason::Guard { sensor: 0, rising: true };
    assert_eq!(robot.until_done(true).0, expected);
    let over = robot.x() - (6.0 - 0.16);
    assert!(over > 0.0 && over < 0.03, "stopped {over} m after the edge");
    assert_eq!(robot.body.bumps(), 0, "stopped before the wall");
}

#[test]
fn a_guard_that_is_already_closed_waits_for_a_new_edge() {
    let mut robot = Robot::at(5.86, 2.0, 0.0);
    let guard = Guard { rise: SwitchSet::only(0), fall: SwitchSet::EMPTY };
    robot.send(turn(angle::TAU - 0.8), guard, 30.0);
    let (reason, _) = robot.until_done(true);
    assert_eq!(reason, DoneReason::Complete);
    robot.send(turn(0.8), guard, 30.0);
    let (reason, _) = robot.until_done(true);
    assert!(matches!(reason, DoneReason::Guard { rising: true, .. }), "{reason:?}");
}

#[test]
fn a_falling_guard_ends_a_turn() {
    let mut robot = Robot::at(5.86, 2.0, 0.0);
    let guard = Guard { rise: SwitchSet::EMPTY, fall: SwitchSet::only(0) };
    robot.send(turn(3.0), guard, 30.0);
    let expected = DoneReason::Guard { sensor: 0, rising: false };
    assert_eq!(robot.until_done(true).0, expected);
}

#[test]
fn the_bumper_ends_moves_ahead_but_lets_the_robot_back_off() {
    let mut robot = Robot::at(5.6, 2.0, 0.0);
    robot.send(ahead(1.0), FREE, 30.0);
    assert_eq!(robot.until_done(true).0, DoneReason::Bumper);
    let pressed = robot.x();
    robot.send(ahead(1.0), FREE, 30.0);
    let (reason, seconds) = robot.until_done(true);
    assert_eq!(reason, DoneReason::Bumper);
    assert!(seconds < 0.05 + f64::from(SETTLING) * STEP, "still ahead for {seconds} s");
    assert!((robot.x() - pressed).abs() < 1e-6, "pushed on");
    robot.send(ahead(-0.2), FREE, 30.0);
    assert_eq!(robot.until_done(true).0, DoneReason::Complete);
    assert!((robot.x() - pressed + 0.2).abs() < 1e-3, "{}", robot.x());
}

#[test]
fn what_the_bumper_meets_while_a_guard_brakes_is_not_pushed() {
    let weak = Chassis { acceleration: 0.2, ..Chassis::default() };
    let mut robot = Robot::with(&weak, 4.0, 2.0, 0.0);
    let guard = Guard { rise: SwitchSet::only(0), fall: SwitchSet::EMPTY };
    robot.send(ahead(3.0), guard, 30.0);
    while !robot.body.bumper() {
        robot.step(true);
    }
    robot.step(true);
    robot.step(true);
    assert!(!robot.firmware.is_moving(), "drives on against the wall");
    let expected = DoneReason::Guard { sensor: 0, rising: true };
    assert_eq!(robot.until_done(true).0, expected);
}

#[test]
fn backing_into_a_wall_stalls() {
    let mut robot = Robot::at(0.3, 2.0, 0.0);
    robot.send(ahead(-1.0), FREE, 30.0);
    assert_eq!(robot.until_done(true).0, DoneReason::Stalled);
}

/// A wheel of few ticks is still for longer from one to the next.
#[test]
fn wheels_that_tick_seldom_have_not_stalled() {
    for (tick, speed) in [(0.02, 0.06), (0.02, 0.09), (0.01, 0.051), (0.005, 0.2)] {
        let chassis = Chassis { tick, ..Chassis::default() };
        let mut robot = Robot::with(&chassis, 1.0, 2.0, 0.0);
        robot.send(Motion::Move { distance: 0.5, speed }, FREE, 30.0);
        let (reason, _) = robot.until_done(true);
        assert_eq!(reason, DoneReason::Complete, "{tick} m a tick at {speed} m/s");
        robot.send(ahead(-3.0), FREE, 60.0);
        let (reason, _) = robot.until_done(true);
        assert_eq!(reason, DoneReason::Stalled, "{tick} m a tick into the wall");
    }
}

/// A robot that goes no faster than 5 cm a second pushes as hard as any.
#[test]
fn slow_robots_stall_as_well() {
    for speed in [0.01, 0.03, 0.05] {
        let chassis = Chassis { speed, ..Chassis::default() };
        let mut robot = Robot::with(&chassis, 0.13, 2.0, 0.0);
        robot.send(Motion::Move { distance: -1.0, speed }, FREE, 30.0);
        let (reason, _) = robot.until_done(true);
        assert_eq!(reason, DoneReason::Stalled, "{speed} m/s");
    }
}

#[test]
fn the_time_limit_ends_a_motion() {
    let mut robot = Robot::at(1.0, 2.0, 0.0);
    robot.send(ahead(4.0), FREE, 1.0);
    let (reason, seconds) = robot.until_done(true);
    assert_eq!(reason, DoneReason::TimeLimit);
    assert!(seconds > 1.0 && seconds < 1.3, "stopped after {seconds} s");
}

#[test]
fn rest_stands_still_for_its_time() {
    let mut robot = Robot::at(1.0, 2.0, 0.0);
    robot.send(Motion::Rest, FREE, 0.5);
    let (reason, seconds) = robot.until_done(true);
    assert_eq!(reason, DoneReason::Complete);
    assert!(seconds > 0.48 && seconds < 0.56, "rested {seconds} s");
    assert_eq!(robot.x(), 1.0);
}

#[test]
fn a_silent_host_stops_the_robot_within_300_ms_and_the_braking() {
    let mut robot = Robot::at(1.0, 2.0, 0.0);
    robot.send(ahead(4.0), FREE, 30.0);
    for _ in 0..50 {
        robot.step(true);
    }
    assert!(robot.firmware.is_moving(), "the host was there");
    let heard = robot.x();
    let (reason, seconds) = robot.until_done(false);
    assert_eq!(reason, DoneReason::HostSilent);
    let braking = 0.2 / Chassis::default().acceleration;
    assert!(seconds <= WATCHDOG + braking + 3.0 * STEP, "it took {seconds} s");
    assert!(robot.x() - heard < 0.2 * (WATCHDOG + braking), "ran on");
    let stands = robot.x();
    for _ in 0..20 {
        robot.step(true);
    }
    assert_eq!(robot.x(), stands, "a host that is back starts nothing");
}

#[test]
fn stop_brakes_at_once_and_wins_over_the_rest() {
    let mut robot = Robot::at(1.0, 2.0, 0.0);
    robot.send(ahead(4.0), FREE, 30.0);
    for _ in 0..50 {
        robot.step(true);
    }
    robot.firmware.stop();
    let (reason, seconds) = robot.until_done(true);
    assert_eq!(reason, DoneReason::Stopped);
    assert!(seconds <= 0.1 + 2.0 * STEP, "braked for {seconds} s");
}

/// As the page promises it, whatever the robot's acceleration, ahead and in a turn.
#[test]
fn a_stop_takes_half_as_long_as_the_acceleration_would() {
    for acceleration in [0.1, 0.5, 1.0, 4.0, 20.0] {
        let chassis = Chassis { acceleration, ..Chassis::default() };
        let wheels = [chassis.speed, chassis.turn_rate * chassis.wheel_base / 2.0];
        for (motion, speed) in [ahead(9.0), turn(99.0)].into_iter().zip(wheels) {
            let mut robot = Robot::with(&chassis, 0.5, 2.0, 0.0);
            robot.send(motion, FREE, 30.0);
            for _ in 0..120 {
                robot.step(true);
            }
            robot.firmware.stop();
            let (reason, seconds) = robot.until_done(true);
            assert_eq!(reason, DoneReason::Stopped);
            let promised = speed / (2.0 * acceleration);
            assert!(
                seconds <= promised + 1e-9,
                "{seconds} s of {promised} s at {acceleration} m/s²"
            );
        }
    }
}

/// The first reason is the one that is told, and a stop brakes hard all the same.
#[test]
fn a_stop_brakes_hard_what_is_braking_already() {
    let mut steps = Vec::new();
    for stopped in [false, true] {
        let mut robot = Robot::at(1.0, 2.0, 0.0);
        robot.send(ahead(4.0), FREE, 1.0);
        while robot.firmware.running.is_none_or(|running| running.ending.is_none()) {
            robot.step(true);
        }
        if stopped {
            robot.firmware.stop();
        }
        let (reason, seconds) = robot.until_done(true);
        assert_eq!(reason, DoneReason::TimeLimit);
        steps.push((seconds / STEP).round());
    }
    assert!(steps[1] <= steps[0] / 2.0 + 1.0, "{steps:?} steps without and with a stop");
}

#[test]
fn a_command_that_comes_twice_is_one_command() {
    let mut robot = Robot::at(1.0, 2.0, 0.0);
    robot.send(ahead(0.1), FREE, 30.0);
    robot.until_done(true);
    robot.number -= 1;
    robot.send(ahead(0.1), FREE, 30.0);
    for _ in 0..100 {
        robot.step(true);
    }
    assert!((robot.x() - 1.1).abs() <= 5e-4, "moved twice: {}", robot.x());
}

#[test]
fn a_report_comes_every_tenth_of_a_second() {
    let mut robot = Robot::at(1.0, 2.0, 0.0);
    for _ in 0..100 {
        robot.step(true);
    }
    let reports = robot.said.iter();
    let reports = reports.filter(|t| matches!(t, Telemetry::Report { .. }));
    assert_eq!(reports.count(), 20, "reports in two seconds");
}

#[test]
fn a_motion_waits_until_the_body_is_at_rest_and_is_stopped_before_it_begins() {
    let mut robot = Robot::at(1.0, 2.0, 0.0);
    robot.send(ahead(0.1), FREE, 30.0);
    robot.until_done(true);
    robot.send(ahead(0.1), FREE, 30.0);
    let there = robot.x();
    for _ in 0..SETTLING {
        assert!(robot.firmware.is_moving(), "it is in hand");
        robot.step(true);
        assert!((robot.x() - there).abs() < 1e-12, "it does not move yet");
    }
    assert_eq!(robot.until_done(true).0, DoneReason::Complete);
    robot.send(ahead(0.1), FREE, 30.0);
    let there = robot.x();
    robot.firmware.stop();
    assert_eq!(robot.until_done(true).0, DoneReason::Stopped);
    assert!((robot.x() - there).abs() < 1e-12, "it moved in spite of the stop");
}

#[test]
fn a_motion_brakes_in_equal_steps_and_does_not_pass_its_end() {
    for angle in [0.05, 0.3, 0.48, 0.96, 3.0] {
        let mut robot = Robot::at(3.0, 2.0, 0.0);
        robot.send(turn(angle), FREE, 10.0);
        let mut farthest = 0.0_f64;
        let mut steps = 0;
        while !robot.said.iter().any(|told| matches!(told, Telemetry::Done { .. })) {
            robot.step(true);
            steps += 1;
            farthest = farthest.max(robot.body.true_pose().heading);
        }
        assert!(farthest < angle + 2e-4, "{angle}: it went to {farthest}");
        // As fast as wheels can: the rates rise and fall evenly, 10 rad/s^2, to 2 rad/s at most.
        let ideal = if angle > 0.4 { angle / 2.0 + 0.2 } else { 2.0 * (angle / 10.0_f64).sqrt() };
        assert!(f64::from(steps) * STEP < ideal + 0.08, "{angle}: {steps} steps, ideal {ideal} s");
    }
}
