//! What the host makes of a robot that is none, or not one that can be driven.

mod forgotten;

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
    seal(&hello, &mut out);
    seal(&FromRobot::Body(chassis.clone()).to_string(), &mut out);
    for (index, mount) in chassis.sensors.iter().enumerate() {
        let mount = mount.clone();
        seal(&FromRobot::Switch { index, mount }, &mut out);
    }
    seal(&FromRobot::Pong { number: 1 }, &mut out);
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
        seal(&FromRobot::Pong { number: 1 }, &mut line);
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
        assert_eq!(told.contains(&Heard::Forgotten), outdated, "its numbers are others");
    }
}

#[test]
fn a_robot_that_speaks_another_version_is_refused() {
    let mut out = Vec::new();
    seal(&format!("h {} 7 2A 300 8 tin", VERSION + 1), &mut out);
    out.extend(introduction(&Chassis::default(), 8));
    assert!(lost(&out).expect("refused").contains("another version"));
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

/// Says `said` to the host, sealed.
fn say(host: &mut Host, said: &[&str], now: f64, told: &mut Vec<Heard>) {
    let mut line = Vec::new();
    for body in said {
        seal(body, &mut line);
    }
    host.receive(&line, now, told);
}

/// A host whose robot has introduced itself at 0 s.
fn known() -> (Host, Vec<Heard>) {
    known_as(&Chassis::default())
}

/// The same of a robot with this body.
fn known_as(body: &Chassis) -> (Host, Vec<Heard>) {
    let (mut host, mut told) = (Host::new(115_200, 0x2A, 0.0), Vec::new());
    host.receive(&introduction(body, 8), 0.0, &mut told);
    host.tick(0.0, &mut told);
    let _ = host.take_output();
    assert!(host.is_open());
    told.clear();
    (host, told)
}

/// A motion of a minute.
fn long(id: u32) -> Command {
    let motion = crate::robot::Motion::Move { distance: 9.0, speed: 0.2 };
    Command { id: CommandId(id), motion, guard: crate::robot::Guard::default(), time_limit: 60.0 }
}

/// Lets time pass in steps of 10 ms from `from` until `until`, with a report every 100 ms if it reports; what is
/// written meanwhile.
fn live(
    host: &mut Host,
    (from, until): (u32, u32),
    reports: bool,
    told: &mut Vec<Heard>,
) -> Vec<u8> {
    let mut out = Vec::new();
    for step in from..until {
        let now = f64::from(step) * 0.01;
        if reports && step % 10 == 0 {
            say(host, &[&format!("r {} 0 0 0 00 0 0 0", step * 10_000)], now, told);
        }
        host.tick(now, told);
        out.extend(host.take_output());
    }
    out
}

/// A line that was silent for a moment is believed in again when it has been there for half a second.
#[test]
fn motions_wait_until_the_line_has_been_there_for_a_while() {
    let (mut host, mut told) = known();
    live(&mut host, (1, 40), true, &mut told);
    assert!(!host.is_sound(0.4), "it has just been opened");
    live(&mut host, (40, 100), true, &mut told);
    assert!(host.is_sound(1.0));
    live(&mut host, (100, 160), false, &mut told);
    assert!(host.health() == Health::Stale && !host.is_sound(1.6));
    live(&mut host, (160, 200), true, &mut told);
    assert!(host.health() == Health::Up && !host.is_sound(2.0), "it has just come back");
    live(&mut host, (200, 220), true, &mut told);
    assert!(host.is_sound(2.2));
}

/// A stop is said until it is acknowledged, with the byte that needs no line, and also when the link is lost
/// meanwhile; the acknowledgement of another one does not end that.
#[test]
fn a_stop_is_said_until_it_is_acknowledged() {
    let count = |out: &[u8]| out.split(|byte| *byte == STOP).count() - 1;
    let (mut host, mut told) = known();
    live(&mut host, (1, 100), true, &mut told);
    host.stop(1.0);
    assert!(!host.is_at_rest());
    host.stop(1.0);
    say(&mut host, &["a 2147483649", "a 3"], 1.0, &mut told);
    assert_eq!(host.take_output().first(), Some(&STOP));
    assert!(count(&live(&mut host, (101, 200), true, &mut told)) >= 2, "said once");
    let silent = live(&mut host, (200, 600), false, &mut told);
    assert!(matches!(host.health(), Health::Lost(_)) && !host.is_at_rest());
    assert!(count(&silent) >= 8, "not said any more: {}", count(&silent));
    say(&mut host, &["a 2147483650"], 6.0, &mut told);
    assert!(host.is_at_rest());
    assert_eq!(count(&live(&mut host, (600, 700), false, &mut told)), 0, "for ever");
}

/// What a stop overtakes is not said after it: neither what waits to be written nor what is not acknowledged.
#[test]
fn nothing_that_a_stop_overtakes_is_said_after_it() {
    for written in [false, true] {
        let (mut host, mut told) = known();
        live(&mut host, (1, 100), true, &mut told);
        host.send(long(1), 1.0);
        if written {
            let _ = host.take_output();
        }
        host.stop(1.0);
        let out = [host.take_output(), live(&mut host, (101, 300), true, &mut told)].concat();
        assert_eq!(out.first(), Some(&STOP));
        let motion = Decoder::default()
            .feed(&out)
            .any(|item| matches!(item, Item::Body(body) if body.starts_with('M')));
        assert!(!motion, "written: {written}: it is said after the stop");
    }
}

/// A motion that does not end in its time, and a command that is not acknowledged, are ended by a stop; and then
/// nothing more is believed of that robot.
#[test]
fn what_does_not_end_and_what_is_not_taken_is_stopped() {
    for (taken, why, until) in [(true, Loss::Endless, 6450), (false, Loss::Unacknowledged, 450)] {
        let (mut host, mut told) = known();
        live(&mut host, (1, 100), true, &mut told);
        host.send(long(1), 1.0);
        if taken {
            say(&mut host, &["a 1"], 1.0, &mut told);
        }
        assert!(!host.is_at_rest(), "{why}: a motion is in hand");
        let early = live(&mut host, (101, until - 300), true, &mut told);
        assert!(!early.contains(&STOP), "{why}: it had time");
        let late = live(&mut host, (until - 300, until), true, &mut told);
        assert!(late.contains(&STOP), "{why}: it goes on");
        assert!(told.contains(&Heard::Health(Health::Lost(why))), "{why}: {told:?}");
    }
}

/// A robot that reports and acknowledges no stop is not called one that is there: nobody knows whether it obeys.
#[test]
fn a_robot_that_acknowledges_no_stop_is_lost() {
    let (mut host, mut told) = known();
    live(&mut host, (1, 100), true, &mut told);
    host.stop(1.0);
    live(&mut host, (100, 395), true, &mut told);
    assert_eq!(host.health(), Health::Up, "it had time");
    live(&mut host, (395, 410), true, &mut told);
    assert_eq!(host.health(), Health::Lost(Loss::Unacknowledged));
}

/// A robot that falls silent in one motion after the other is stopped in each.
#[test]
fn a_robot_that_falls_silent_again_is_stopped_again() {
    let (mut host, mut told) = known();
    live(&mut host, (1, 100), true, &mut told);
    for id in 1..=2 {
        let begin = 100 * id;
        host.send(long(id), f64::from(begin) * 0.01);
        say(&mut host, &[&format!("a {id}")], f64::from(begin) * 0.01, &mut told);
        let out = live(&mut host, (begin, begin + 40), false, &mut told);
        assert!(out.contains(&STOP), "motion {id}");
        let stop = format!("a {}", FIRST_STOP + id);
        let done = format!("d {id} {id} stop {} 0 0 0 00 0", begin * 10_000);
        say(&mut host, &[&stop, &done], f64::from(begin + 40) * 0.01, &mut told);
        assert!(host.is_at_rest(), "motion {id}");
    }
}

/// That a command never began is concluded when its end would have come, and not while the stop may not have
/// arrived, nor while the robot may still brake.
#[test]
fn a_command_in_doubt_is_given_up_when_its_end_would_have_come() {
    let not_begun = |told: &[Heard]| told.contains(&Heard::NotBegun(CommandId(1)));
    let braking = [(1.0, 0.2), (0.05, 4.0)];
    for (acknowledged, (acceleration, stands)) in
        [true, false].into_iter().flat_map(|yes| braking.map(|braking| (yes, braking)))
    {
        let body = Chassis { speed: 0.2, turn_rate: 1.0, acceleration, ..Chassis::default() };
        let (mut host, mut told) = known_as(&body);
        // A second after it stands still.
        let over = 300 + (stands * 100.0) as u32;
        live(&mut host, (1, 200), true, &mut told);
        host.send(long(1), 2.0);
        host.stop(2.0);
        if acknowledged {
            say(&mut host, &["a 2147483649"], 2.0, &mut told);
        }
        live(&mut host, (200, 300.min(over - 5)), true, &mut told);
        if !acknowledged {
            // After that it is given up, as a robot that does not answer.
            live(&mut host, (300, 310), true, &mut told);
            assert!(!not_begun(&told) && !host.is_at_rest());
            continue;
        }
        live(&mut host, (300, over - 5), true, &mut told);
        assert!(!not_begun(&told), "{acceleration} m/s2: too early");
        live(&mut host, (over - 5, over + 10), true, &mut told);
        assert!(not_begun(&told) && host.is_at_rest(), "{acceleration} m/s2");
    }
}

/// Events are taken in their order and each once, and reports only from a robot that is known and not older than
/// the last one; all else would be a story that never was.
#[test]
fn what_is_told_is_taken_in_order_and_once() {
    let count =
        |told: &[Heard]| told.iter().filter(|heard| matches!(heard, Heard::Telemetry(_))).count();
    let [first, second] = ["e 1 2+ 500000 0 0 0", "e 2 2- 600000 0 0 0"];
    let report = |time_us: u32, event: u32| format!("r {time_us} 0 0 0 00 0 {event} 0");
    let (mut unknown, mut told) = (Host::new(115_200, 0x2A, 0.0), Vec::new());
    say(&mut unknown, &[&report(20_000, 0), first], 0.1, &mut told);
    assert_eq!(count(&told), 0, "nobody has introduced himself");
    let (mut host, mut told) = known();
    let steps = [
        (second.to_owned(), 0),
        (report(600_000, 2), 0),
        (first.to_owned(), 1),
        (first.to_owned(), 1),
        (report(610_000, 2), 1),
        (second.to_owned(), 2),
        (report(700_000, 2), 3),
        (report(650_000, 2), 3),
        (report(800_000, 2), 4),
    ];
    for (line, taken) in steps {
        say(&mut host, &[&line], 0.9, &mut told);
        assert_eq!(count(&told), taken, "`{line}`: {told:?}");
    }
}

/// What is refused is over, and the robot is asked who it is; what another motion came to is nothing to this one.
#[test]
fn a_refusal_and_an_end_are_those_of_their_own_command() {
    let (mut host, mut told) = known();
    live(&mut host, (1, 100), true, &mut told);
    host.send(long(2), 1.0);
    say(&mut host, &["n 1 late", "d 1 1 ok 900000 0 0 0 00 0"], 1.0, &mut told);
    assert!(!told.iter().any(|heard| matches!(heard, Heard::Refused(..))), "{told:?}");
    assert!(!host.is_at_rest(), "the motion in hand is forgotten");
    say(&mut host, &["n 2 too steep"], 1.0, &mut told);
    assert!(told.contains(&Heard::Refused(CommandId(2), "too steep".to_owned())));
    assert!(host.is_at_rest(), "its end is waited for");
    let out = live(&mut host, (101, 102), false, &mut told);
    let asks = Decoder::default()
        .feed(&out)
        .any(|item| matches!(item, Item::Body(body) if body.starts_with('H')));
    assert!(asks, "it may have been started again");
}
