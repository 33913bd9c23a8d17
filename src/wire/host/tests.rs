//! What the host makes of a robot that is none, or not one that can be driven.

use super::*;
use crate::robot::Chassis;

/// How the link is lost when `said` comes over it again and again; none when it is not.
fn lost(said: &[u8]) -> Option<String> {
    let mut host = Host::new(115_200, 0x2A, 0.0);
    let mut told = Vec::new();
    for step in 0..500 {
        let now = f64::from(step) * 0.01;
        if step % 10 == 0 {
            host.receive(said, now, &mut told);
        }
        host.tick(now, &mut told);
        let _ = host.take_output();
    }
    told.into_iter().find_map(|heard| match heard {
        Heard::Health(Health::Lost(why)) => Some(why.to_string()),
        _ => None,
    })
}

/// A robot that introduces itself, with `switches` of them announced.
fn introduction(chassis: &Chassis, switches: usize) -> Vec<u8> {
    let mut out = Vec::new();
    let name = "tin".to_owned();
    let (boot, session, watchdog) = (7, 0x2A, 300);
    let hello = FromRobot::Hello { version: VERSION, boot, session, watchdog, switches, name };
    seal(&hello.to_string(), &mut out);
    seal(&FromRobot::Body(chassis.clone()).to_string(), &mut out);
    for (index, mount) in chassis.sensors.iter().enumerate() {
        let mount = mount.clone();
        seal(&FromRobot::Switch { index, mount }.to_string(), &mut out);
    }
    seal(&FromRobot::Pong { number: 1 }.to_string(), &mut out);
    out
}

#[test]
fn silence_and_another_language_are_told_apart() {
    let silent = lost(b"").expect("lost");
    assert!(silent.contains("no answer"), "{silent}");
    let modem = lost(b"AT\x1b[2J\"OK\r\nERROR\r\n").expect("lost");
    assert!(modem.contains("not in this protocol") && modem.contains("--baud"), "{modem}");
    assert!(modem.contains("AT\\x1B[2J\\x22OK\\x0D\\x0AERROR"), "{modem}");
    assert!(modem.chars().all(|c| !c.is_control()), "{modem}");
    let shy = lost(&introduction(&Chassis::default(), 9)).expect("lost");
    assert!(shy.contains("does not introduce itself"), "{shy}");
}

#[test]
fn a_robot_with_a_body_that_none_has_is_refused_in_words() {
    assert_eq!(lost(&introduction(&Chassis::default(), 8)), None);
    for count in [0, 3, 17, 200] {
        let why = lost(&introduction(&Chassis::default(), count)).expect("lost");
        assert!(why.contains(&format!("{count} switches")), "{why}");
    }
    let why = lost(&introduction(&Chassis { tick: 1.0, ..Chassis::default() }, 8)).expect("lost");
    assert!(why.contains("tick of 1 is not between"), "{why}");
}

/// Whether the host asks who is there in the next half second, while pings are answered.
fn asks(host: &mut Host, from: f64, said: &str) -> bool {
    let (mut told, mut asked) = (Vec::new(), false);
    for step in 0..50 {
        let now = from + f64::from(step) * 0.01;
        let mut line = Vec::new();
        seal(&FromRobot::Pong { number: 1 }.to_string(), &mut line);
        if step == 0 {
            seal(said, &mut line);
        }
        host.receive(&line, now, &mut told);
        host.tick(now, &mut told);
        let out = host.take_output();
        asked |= Decoder::default()
            .feed(&out)
            .any(|item| matches!(item, Item::Body(body) if body.starts_with('H')));
    }
    asked
}

/// A robot that has run out of room for its events forgets its host and says so once; so does one that was
/// started again. Reports of events that never come say it as well.
#[test]
fn a_robot_that_forgot_its_host_is_asked_who_it_is() {
    let known = || {
        let mut host = Host::new(115_200, 0x2A, 0.0);
        let mut told = Vec::new();
        host.receive(&introduction(&Chassis::default(), 8), 0.0, &mut told);
        host.tick(0.0, &mut told);
        let _ = host.take_output();
        assert!(host.is_open() && !asks(&mut host, 0.1, "p 1"), "nothing to ask");
        host
    };
    assert!(asks(&mut known(), 1.0, "h 1 8 0 300 8 tin"), "a hole that is told");
    let mut host = known();
    assert!(!asks(&mut host, 1.0, "r 20000 12 12 -1500 04 0 7 0"), "it may still come");
    assert!(asks(&mut host, 1.6, "r 20000 12 12 -1500 04 0 7 0"), "a hole that is not told");
}
