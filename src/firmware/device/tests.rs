//! The robot's end of the line as a host sees it: what is answered, what is done, what is refused.

use super::*;
use crate::firmware::STEP;
use crate::robot::{CommandId, Guard};
use crate::simulator::{Body, NoiseProfile, World};

struct Bench {
    device: Device,
    body: Body,
}

fn bench() -> Bench {
    slowed(1.0)
}

/// A robot whose time runs `speed` times as fast as its host's.
fn slowed(speed: f64) -> Bench {
    let text = include_str!("../../../sims/rectangle.toml");
    let world = World::from_toml(text, "rectangle", 0.1).expect("a world");
    let chassis = Chassis::default();
    let mut device = Device::new(&chassis, "tin", 1, speed);
    let _ = device.take_output();
    Bench { device, body: Body::new(&world, &chassis, NoiseProfile::None, 1) }
}

impl Bench {
    /// Says something to the robot and gives its answers.
    fn say(&mut self, message: &ToRobot) -> Vec<String> {
        let mut line = Vec::new();
        seal(&message, &mut line);
        self.device.receive(&line);
        self.answers()
    }

    fn answers(&mut self) -> Vec<String> {
        let bytes = self.device.take_output();
        let items: Vec<Item> = Decoder::default().feed(&bytes).collect();
        items
            .into_iter()
            .filter_map(|item| match item {
                Item::Body(body) => Some(body),
                _ => None,
            })
            .collect()
    }

    fn live(&mut self, seconds: f64) -> Vec<String> {
        for _ in 0..(seconds / STEP).round() as u32 {
            self.device.step(&mut self.body, |_, _| {});
            self.body.step(STEP);
        }
        self.answers()
    }
}

fn ahead(seq: u32, distance: f64) -> ToRobot {
    let motion = Motion::Move { distance, speed: 0.2 };
    let id = CommandId(seq);
    ToRobot::Command(Command { id, motion, guard: Guard::default(), time_limit: 9.0 })
}

const HELLO: ToRobot = ToRobot::Hello { version: VERSION, session: 5 };

#[test]
fn nothing_moves_before_a_hello() {
    let mut bench = bench();
    assert_eq!(bench.say(&ahead(1, 0.1)), ["n 1 say hello first"]);
    let said = bench.say(&HELLO);
    assert!(said[0].starts_with("h 1 ") && said[1].starts_with("c "), "{said:?}");
    assert_eq!(said.len(), 10, "eight switches");
    assert_eq!(bench.say(&ahead(1, 0.1)), ["a 1"]);
}

#[test]
fn a_command_said_twice_is_done_once() {
    let mut bench = bench();
    bench.say(&HELLO);
    let from = bench.body.true_pose().position;
    assert_eq!(bench.say(&ahead(1, 0.02)), ["a 1"]);
    let done = bench.live(0.28);
    bench.say(&ToRobot::Ping { number: 1, event: 0 });
    let done = [done, bench.live(0.28)].concat();
    assert!(done.iter().any(|line| line.starts_with("d 1 1 ok")), "{done:?}");
    assert_eq!(bench.say(&ahead(1, 0.02)), ["a 1"]);
    bench.live(0.2);
    let went = (bench.body.true_pose().position - from).norm();
    assert!((went - 0.02).abs() < 0.001, "{went}");
}

#[test]
fn an_event_is_said_until_it_is_confirmed() {
    let mut bench = bench();
    bench.say(&HELLO);
    bench.say(&ahead(1, 0.01));
    let said = bench.live(0.28);
    let again = bench.live(0.4);
    let count = |lines: &[String]| lines.iter().filter(|line| line.starts_with("d 1 1 ")).count();
    assert!(count(&said) >= 1 && count(&again) >= 3, "{said:?} {again:?}");
    assert_eq!(bench.say(&ToRobot::Ping { number: 1, event: 1 }), ["p 1"]);
    assert_eq!(count(&bench.live(0.4)), 0);
}

#[test]
fn the_stop_byte_needs_no_line() {
    let mut bench = bench();
    bench.say(&HELLO);
    bench.say(&ahead(1, 2.0));
    bench.live(0.2);
    bench.device.receive(&[b'P', b' ', crate::wire::STOP]);
    let said = bench.live(0.24);
    assert!(said.iter().any(|line| line.starts_with("d 1 1 stop")), "{said:?}");
}

#[test]
fn what_cannot_be_done_is_refused() {
    let mut bench = bench();
    bench.say(&HELLO);
    let motion = Motion::Move { distance: 1.0, speed: 3.0 };
    let fast = Command { id: CommandId(1), motion, guard: Guard::default(), time_limit: 9.0 };
    assert_eq!(bench.say(&ToRobot::Command(fast)), ["n 1 faster than this robot can go"]);
    bench.say(&ahead(1, 1.0));
    assert_eq!(bench.say(&ahead(2, 1.0)), ["n 2 another motion is in hand"]);
    let mut line = Vec::new();
    seal("M 3 what", &mut line);
    bench.device.receive(&line);
    assert_eq!(bench.answers(), ["n 3 not understood"]);
}

/// Every host numbers its commands from 1: what the one before asked for last is not what this one asks for.
#[test]
fn the_first_command_of_another_host_is_done_as_well() {
    let mut bench = bench();
    for session in [5, 6] {
        bench.say(&ToRobot::Hello { version: VERSION, session });
        let from = bench.body.true_pose().position;
        assert_eq!(bench.say(&ahead(1, 0.02)), ["a 1"]);
        let done = bench.live(0.28);
        bench.say(&ToRobot::Ping { number: 1, event: 0 });
        let done = [done, bench.live(0.28)].concat();
        assert!(done.iter().any(|line| line.starts_with("d 1 1 ok")), "{session}: {done:?}");
        let went = (bench.body.true_pose().position - from).norm();
        assert!((went - 0.02).abs() < 0.001, "{session}: {went} m");
    }
}

#[test]
fn an_event_is_said_again_as_often_by_its_hosts_clock_however_slow_its_own_is() {
    for (speed, seconds) in [(1.0, 1.0), (0.2, 0.2)] {
        let mut bench = slowed(speed);
        bench.say(&HELLO);
        bench.say(&ahead(1, 0.02));
        // It has driven that by then, and nobody confirms that it has.
        bench.live(2.0);
        let lines = bench.live(seconds);
        let said = lines.iter().filter(|line| line.starts_with("d ")).count();
        assert!((8..=12).contains(&said), "{said} times in a second at {speed}: {lines:?}");
    }
}

/// What a robot under way says in the next quarter of a second, after `said` came over the line.
fn under_way(said: &ToRobot) -> (Vec<String>, Bench) {
    let mut bench = bench();
    bench.say(&HELLO);
    bench.say(&ahead(1, 2.0));
    bench.live(0.2);
    let mut lines = bench.say(said);
    lines.extend(bench.live(0.24));
    (lines, bench)
}

/// A stop in a line stops as its byte does, and another host's hello stops what the one before asked for; the
/// same host's does not, nor does a command that it may have said before.
#[test]
fn a_stop_line_and_another_host_stop_it_and_the_same_one_does_not() {
    let stopped = |lines: &[String]| lines.iter().any(|line| line.starts_with("d 1 1 stop"));
    let (lines, bench) = under_way(&ToRobot::Stop { seq: 9 });
    assert!(lines[0] == "a 9" && stopped(&lines) && !bench.device.is_moving(), "{lines:?}");
    let (_, bench) = under_way(&ToRobot::Hello { version: VERSION, session: 6 });
    assert!(!bench.device.is_moving(), "another host is there, and it drives on");
    let (lines, bench) = under_way(&HELLO);
    assert!(bench.device.is_moving(), "the same host asks who it is: {lines:?}");
    let (lines, bench) = under_way(&ahead(1, 2.0));
    assert!(lines[0] == "a 1" && bench.device.is_moving(), "{lines:?}");
}

/// A command from before the newest was done long ago, and none is taken without a limit or backwards in speed.
#[test]
fn a_late_command_and_a_senseless_one_move_nothing() {
    let mut bench = bench();
    bench.say(&HELLO);
    bench.say(&ahead(2, 0.02));
    bench.live(0.28);
    bench.say(&ToRobot::Ping { number: 1, event: 0 });
    bench.live(0.28);
    assert_eq!(bench.say(&ahead(1, 0.5)), ["a 1"]);
    assert!(!bench.device.is_moving(), "it is driven again");
    let of = |speed: f64, time_limit: f64| {
        let motion = Motion::Move { distance: 1.0, speed };
        let id = CommandId(3);
        ToRobot::Command(Command { id, motion, guard: Guard::default(), time_limit })
    };
    assert_eq!(bench.say(&of(-0.2, 9.0)), ["n 3 faster than this robot can go"]);
    assert_eq!(bench.say(&of(0.2, 0.0)), ["n 3 without a time limit"]);
    assert!(!bench.device.is_moving());
}

/// A host that confirms nothing is told of a hole once there is no room left, by another life; the robot stands
/// then, and takes nothing before the next hello.
#[test]
fn a_robot_that_has_no_room_for_its_events_stands_and_says_so() {
    let (_, mut bench) = under_way(&ToRobot::Ping { number: 1, event: 0 });
    assert!(bench.device.is_moving());
    let odometer = bench.body.odometer();
    for k in 0..=KEPT {
        let edge = crate::robot::Edge { sensor: 0, rising: k % 2 == 0, odometer };
        bench.device.tell(Telemetry::Edge(edge));
    }
    let said = bench.answers();
    assert!(said.iter().any(|line| line.starts_with("h 1 00000002 00000000 ")), "{said:?}");
    bench.say(&ToRobot::Ping { number: 2, event: 0 });
    bench.live(0.24);
    assert!(!bench.device.is_moving(), "it drives on, and nobody knows where");
    assert_eq!(bench.say(&ahead(2, 0.1)), ["n 2 say hello first"]);
}
