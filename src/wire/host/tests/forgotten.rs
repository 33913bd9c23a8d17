//! A robot that is known, and does not know its host any more.

use super::*;

/// What is told of `Heard::Forgotten`.
fn is_forgotten(told: &[Heard]) -> bool {
    told.contains(&Heard::Forgotten)
}

/// The lines among `said` that begin with `letter`.
fn lines(said: &[u8], letter: char) -> usize {
    let is = |item: &Item| matches!(item, Item::Body(body) if body.starts_with(letter));
    Decoder::default().feed(said).filter(is).count()
}

/// A robot that introduces itself to the conversation `session`, in its life `boot`.
fn answer(boot: u32, session: u32) -> Vec<u8> {
    let text = String::from_utf8(introduction(&Chassis::default(), 8)).expect("text");
    let (_, rest) = text.split_once('\n').expect("lines");
    let rest = rest.rsplit_once("r 2").map_or(rest, |(before, _)| before);
    let mut out = Vec::new();
    seal(&format!("h 1 {boot:X} {session:X} 300 8 tin"), &mut out);
    out.extend(rest.bytes());
    out
}

/// Another host's hello is known by the answer to it, at once; a robot's own start, another life of it and what
/// is said to a host that does not know it yet are no such thing, and are asked about.
#[test]
fn an_answer_to_another_host_is_told_from_a_start_of_the_robot() {
    for (said, forgotten) in [
        ("h 1 7 BEEF 300 8 tin", true),
        ("h 1 7 0 300 8 tin", false),
        ("h 1 8 BEEF 300 8 tin", false),
    ] {
        let (mut host, mut told) = known();
        live(&mut host, (1, 100), true, &mut told);
        say(&mut host, &[said], 1.0, &mut told);
        assert_eq!(is_forgotten(&told), forgotten, "`{said}`");
        assert_eq!(host.is_open(), !forgotten, "`{said}`");
        host.tick(1.0, &mut told);
        assert_eq!(lines(&host.take_output(), 'H'), 1, "`{said}`");
    }
    let (mut host, mut told) = known();
    live(&mut host, (1, 300), false, &mut told);
    assert!(matches!(host.health(), Health::Lost(_)));
    told.clear();
    for step in 300..320 {
        say(&mut host, &["h 1 7 BEEF 300 8 tin"], f64::from(step) * 0.01, &mut told);
    }
    assert_eq!(told, [], "a robot that is gone is told to be gone once");
}

/// A robot that tells of fewer events than it had told has begun anew if it goes on with that although it
/// has answered meanwhile; an old report that comes late, or one from before its answer, is no sign of it.
#[test]
fn fewer_events_than_before_are_believed_when_the_robot_goes_on_with_them() {
    let fewer = "r 1000000 0 0 0 00 0 0 0";
    let newest = "r 1000000 0 0 0 00 0 1 0";
    let hello = "h 1 7 2A 300 8 tin";
    let cases: [(&[(f64, &str)], bool); 5] = [
        (&[(1.0, fewer), (1.1, hello), (1.2, fewer), (1.6, fewer)], true),
        (&[(1.0, fewer), (1.1, hello), (1.2, fewer), (1.45, fewer)], false),
        (&[(0.9, hello), (1.0, fewer), (1.2, fewer), (1.6, fewer)], false),
        (&[(1.0, fewer), (1.1, hello), (1.3, newest), (1.6, fewer)], false),
        (&[(1.0, newest), (1.1, hello), (1.3, newest), (1.6, newest)], false),
    ];
    for (which, (steps, forgotten)) in cases.into_iter().enumerate() {
        let (mut host, mut told) = known();
        live(&mut host, (1, 80), true, &mut told);
        say(&mut host, &["e 1 2+ 800000 0 0 0"], 0.8, &mut told);
        for &(now, said) in steps {
            say(&mut host, &[said], now, &mut told);
            assert_eq!(
                host.is_open() || now < 1.6,
                !forgotten || now < 1.6,
                "case {which} at {now} s"
            );
        }
        assert_eq!(is_forgotten(&told), forgotten, "case {which}");
    }
}

/// Nothing of the old conversation is said or concluded in the new one, and the robot is not there before it
/// has said all of who it is, to this host and in this conversation.
#[test]
fn a_conversation_that_begins_anew_has_nothing_of_the_old_one() {
    for written in [false, true] {
        let (mut host, mut told) = known();
        live(&mut host, (1, 100), true, &mut told);
        if written {
            // A stop has overtaken one of them, which may have begun or not.
            host.send(long(1), 1.0);
            host.stop(1.0);
            say(&mut host, &["a 2147483649"], 1.0, &mut told);
        }
        host.send(long(2), 1.0);
        if written {
            let _ = host.take_output();
        }
        say(&mut host, &["h 1 7 BEEF 300 8 tin"], 1.0, &mut told);
        assert!(is_forgotten(&told) && host.is_at_rest(), "written: {written}");
        let session = 0x2A_u32.wrapping_add(0x9E37_79B8);
        let mut out = live(&mut host, (101, 110), false, &mut told);
        assert_eq!(lines(&out, 'H'), 1, "written: {written}");
        let hello = format!("h 1 7 {session:X} 300 8 tin");
        let asked = format!("H 1 {session:X}");
        let is = |item: &Item| matches!(item, Item::Body(body) if body.starts_with(&asked));
        assert!(Decoder::default().feed(&out).any(|item| is(&item)), "in the old conversation");
        say(&mut host, &["h 1 7 2A 300 8 tin"], 1.1, &mut told);
        say(&mut host, &[&hello], 1.1, &mut told);
        assert!(!host.is_open(), "written: {written}: its body is taken from the old one");
        host.receive(&answer(7, session), 1.1, &mut told);
        assert!(host.is_open() && !host.is_sound(1.5), "written: {written}");
        told.clear();
        out.extend(live(&mut host, (111, 400), true, &mut told));
        assert!(host.is_sound(4.0), "written: {written}: {:?}", host.health());
        assert_eq!(lines(&out, 'M') + lines(&out, 'S'), 0, "written: {written}");
        let concluded = |heard: &Heard| matches!(heard, Heard::NotBegun(_) | Heard::Forgotten);
        assert!(!told.iter().any(concluded), "written: {written}: {told:?}");
    }
}

/// A robot that told nothing of itself until it was lost does not come back by saying who it is, again and
/// again; it does as soon as it reports.
#[test]
fn a_robot_that_is_mute_is_not_back_before_it_reports() {
    let (mut host, mut told) = known();
    live(&mut host, (1, 100), true, &mut told);
    for step in 100..600 {
        let now = f64::from(step) * 0.01;
        if step % 10 == 0 {
            say(&mut host, &["p 1"], now, &mut told);
            host.receive(&answer(7, 0x2A), now, &mut told);
        }
        host.tick(now, &mut told);
    }
    assert_eq!(host.health(), Health::Lost(Loss::Mute));
    let lost = |heard: &&Heard| matches!(heard, Heard::Health(Health::Lost(_)));
    assert_eq!(told.iter().filter(lost).count(), 1, "it flaps");
    say(&mut host, &["r 6000000 0 0 0 00 0 0 0"], 6.0, &mut told);
    host.receive(&answer(7, 0x2A), 6.1, &mut told);
    assert_eq!(host.health(), Health::Up);
}
