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
