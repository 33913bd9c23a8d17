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

/// A robot that introduces itself, with `switches` of them announced, and reports.
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
    seal("r 20000 0 0 0 00 0 0 0", &mut out);
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

/// A robot that answers every ping and acknowledges what it is asked tells nothing by that of where it is: with a
/// motion in hand it is stopped as soon as one that is silent, and it is lost as soon.
#[test]
fn a_robot_that_answers_but_does_not_report_is_not_driven_blind() {
    for outdated in [false, true] {
        let mut host = Host::new(115_200, 0x2A, 0.0);
        let mut told = Vec::new();
        let say = |host: &mut Host, said: &[&str], now: f64, told: &mut Vec<Heard>| {
            let mut line = Vec::new();
            for body in said {
                seal(body, &mut line);
            }
            host.receive(&line, now, told);
        };
        host.receive(&introduction(&Chassis::default(), 8), 0.0, &mut told);
        let (mut stopped, mut lost) = (None, None);
        for step in 0..400 {
            let now = f64::from(step) * 0.01;
            if step % 10 == 0 {
                say(&mut host, &["p 1"], now, &mut told);
            }
            if step % 10 == 0 && step <= 100 {
                let report = format!("r {} 12 12 0 00 0 0 0", step * 10_000);
                say(&mut host, &[&report], now, &mut told);
            }
            if step % 10 == 0 && step > 100 && outdated {
                say(&mut host, &["r 1000000 12 12 0 00 0 9 0"], now, &mut told);
            }
            if step == 100 {
                let motion = crate::robot::Motion::Move { distance: 9.0, speed: 0.2 };
                let guard = crate::robot::Guard::default();
                let id = CommandId(1);
                host.send(Command { id, motion, guard, time_limit: 60.0 }, now);
                say(&mut host, &["a 1"], now, &mut told);
            }
            host.tick(now, &mut told);
            let out = host.take_output();
            if out.contains(&STOP) {
                stopped.get_or_insert(now - 1.0);
                say(&mut host, &["a 2147483649"], now, &mut told);
            }
            if !host.is_open() {
                lost.get_or_insert(now - 1.0);
            }
        }
        assert!(stopped.is_some_and(|after| after < 0.35), "outdated: {outdated}: {stopped:?}");
        assert!(lost.is_some_and(|after| after < 1.6), "outdated: {outdated}: {lost:?}");
        assert!(host.silence(4.0) > 2.9, "what is shown is {} s old", host.silence(4.0));
        let lost = |h: &&Heard| matches!(h, Heard::Health(Health::Lost(_)) | Heard::Forgotten);
        assert_eq!(told.iter().filter(lost).count(), 1, "outdated: {outdated}: it flaps");
    }
}

#[test]
fn a_robot_that_would_drive_on_for_an_hour_is_refused() {
    let said = |watchdog: u32| {
        let text = String::from_utf8(introduction(&Chassis::default(), 8)).expect("text");
        let (_, rest) = text.split_once('\n').expect("lines");
        let mut out = Vec::new();
        seal(&format!("h 1 7 2A {watchdog} 8 tin"), &mut out);
        out.extend(rest.bytes());
        lost(&out)
    };
    assert_eq!(said(300), None);
    assert_eq!(said(300_000), None);
    let why = said(3_600_000).expect("refused");
    assert!(why.contains("drives on for 3600 s"), "{why}");
}
