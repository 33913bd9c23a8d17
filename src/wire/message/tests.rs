//! Golden frames of the protocol, nonsense, and the longest of everything.

use super::*;
use crate::geometry::angle;

fn odometer() -> Odometer {
    Odometer { time_us: 1_234_560_000, left_ticks: -12, right_ticks: 40_021, heading: -3.25 }
}

/// The table of golden frames: what a robot written from the page sends and understands.
fn golden_to() -> Vec<(&'static str, ToRobot)> {
    let guard = Guard { rise: SwitchSet(0xFF), fall: SwitchSet(0x04) };
    let command = |id, motion, guard, time_limit| {
        ToRobot::Command(Command { id: CommandId(id), motion, guard, time_limit })
    };
    vec![
        ("H 1 0000002A", ToRobot::Hello { version: 1, session: 42 }),
        (
            "M 7 -4000 200 FF 04 2300",
            command(7, Motion::Move { distance: -0.04, speed: 0.2 }, guard, 2.3),
        ),
        (
            "T 8 1250000 2000 00 00 4500",
            command(8, Motion::Turn { angle: 1.25, rate: 2.0 }, Guard::default(), 4.5),
        ),
        ("R 9 1000", command(9, Motion::Rest, Guard::default(), 1.0)),
        ("S 10", ToRobot::Stop { seq: 10 }),
        ("P 4000000000 17", ToRobot::Ping { number: 4_000_000_000, event: 17 }),
    ]
}

fn golden_from() -> Vec<(&'static str, FromRobot)> {
    let body = Chassis { sensors: Vec::new(), bumper_half_angle: 1.5, ..Chassis::default() };
    let done = Telemetry::Done {
        id: CommandId(7),
        reason: DoneReason::Guard { sensor: 2, rising: true },
        odometer: odometer(),
        switches: SwitchSet(4),
        bumper: true,
    };
    let edge = Telemetry::Edge(Edge { sensor: 15, rising: false, odometer: odometer() });
    vec![
        (
            "h 1 00C0FFEE 0000002A 300 8 Tin Can",
            FromRobot::Hello {
                version: 1,
                boot: 0x00C0_FFEE,
                session: 42,
                watchdog: 300,
                switches: 8,
                name: "Tin Can".to_owned(),
            },
        ),
        ("c 10000 16000 500000 6000 500 200 2000 1000 1500000", FromRobot::Body(body)),
        (
            "s 1 750000 front left",
            FromRobot::Switch {
                index: 1,
                mount: SensorMount { name: "front left".to_owned(), angle: 0.75 },
            },
        ),
        ("a 7", FromRobot::Acknowledge { seq: 7 }),
        ("n 7 too fast", FromRobot::Refuse { seq: 7, why: "too fast".to_owned() }),
        ("p 3", FromRobot::Pong { number: 3 }),
        (
            "r 1234560000 -12 40021 -3250000 05 0 9 7400",
            FromRobot::Report {
                odometer: odometer(),
                switches: SwitchSet(5),
                bumper: false,
                event: 9,
                battery: Some(7.4),
            },
        ),
        ("e 10 15- 1234560000 -12 40021 -3250000", FromRobot::Event { event: 10, telemetry: edge }),
        (
            "d 11 7 g2+ 1234560000 -12 40021 -3250000 04 1",
            FromRobot::Event { event: 11, telemetry: done },
        ),
    ]
}

#[test]
fn golden_frames_are_written_and_read() {
    for (body, message) in golden_to() {
        assert_eq!(message.to_string(), body);
        assert_eq!(ToRobot::parse(body), Some(message));
    }
    for (body, message) in golden_from() {
        assert_eq!(message.to_string(), body);
        assert_eq!(FromRobot::parse(body), Some(message), "{body}");
    }
}

#[test]
fn every_reason_comes_back() {
    let mut reasons = vec![
        DoneReason::Complete,
        DoneReason::Bumper,
        DoneReason::Stalled,
        DoneReason::TimeLimit,
        DoneReason::Stopped,
        DoneReason::HostSilent,
    ];
    for sensor in 0..MOST_SWITCHES {
        reasons.extend([true, false].map(|rising| DoneReason::Guard { sensor, rising }));
    }
    for reason in reasons {
        assert_eq!(reason_of(&reason_word(reason)), Some(reason));
    }
}

#[test]
fn nonsense_is_nothing() {
    let bodies = [
        "",
        " ",
        "M",
        "M 1",
        "M 1 2 3 4 5",
        "M x 2 3 4 5 6",
        "M 1 2 3 GG 5 6",
        "MM 1 2 3 4 5 6",
        "P 1",
        "P -1 2",
        "H",
        "H 1",
        "H one 0",
        "S 99999999999",
        "Z 1 2 3",
    ];
    for body in bodies {
        assert_eq!(ToRobot::parse(body), None, "{body}");
    }
    let bodies = [
        "e 1 16+ 1 2 3 4",
        "e 1 3 1 2 3 4",
        "e 1 + 1 2 3 4",
        "e 1 é 1 2 3 4",
        "d 1 2 g 1 2 3 4 0 0",
        "d 1 2 ok 1 2 3 4 0 2",
        "h 1 0 0 300 -1 name",
        "s 16 0 name",
        "c 1 1 1 1 1 1 1 1",
        "c x 1 1 1 1 1 1 1 1",
        "r 1 2 3 4 0 0 1",
    ];
    for body in bodies {
        let parsed = FromRobot::parse(body);
        let report = matches!(parsed, Some(FromRobot::Report { battery: None, .. }));
        assert!(parsed.is_none() || report, "{body}: {parsed:?}");
    }
}

#[test]
fn the_longest_frames_fit_their_line() {
    use crate::wire::frame::{LONGEST, seal};
    let far = Odometer {
        time_us: 9_999_999_999_999,
        left_ticks: -99_999_999,
        right_ticks: -99_999_999,
        heading: -99_999.0,
    };
    let messages = [
        FromRobot::Event {
            event: u32::MAX,
            telemetry: Telemetry::Done {
                id: CommandId(u32::MAX),
                reason: DoneReason::Guard { sensor: 15, rising: true },
                odometer: far,
                switches: SwitchSet(0xFFFF),
                bumper: true,
            },
        },
        FromRobot::Hello {
            version: 1,
            boot: u32::MAX,
            session: u32::MAX,
            watchdog: u32::MAX,
            switches: 16,
            name: "x".repeat(200),
        },
        FromRobot::Refuse { seq: u32::MAX, why: "é".repeat(200) },
        FromRobot::Switch {
            index: 15,
            mount: SensorMount { name: "y".repeat(99), angle: -angle::PI },
        },
    ];
    for message in messages {
        let mut line = Vec::new();
        seal(&message, &mut line);
        assert!(!line.is_empty() && line.len() <= LONGEST, "{message}");
    }
}

proptest::proptest! {
    #[test]
    fn any_command_comes_back_as_it_was_rounded(
        id in 0_u32.., distance in -50.0..50.0_f64, speed in 0.0..2.0_f64,
        rise in 0_u16.., fall in 0_u16.., limit in 0.0..600.0_f64, turns in proptest::bool::ANY,
    ) {
        let motion = if turns {
            Motion::Turn { angle: distance, rate: speed }
        } else {
            Motion::Move { distance, speed }
        };
        let guard = Guard { rise: SwitchSet(rise), fall: SwitchSet(fall) };
        let command = Command { id: CommandId(id), motion, guard, time_limit: limit };
        let back = ToRobot::parse(&ToRobot::Command(command).to_string());
        proptest::prop_assert_eq!(back, Some(ToRobot::Command(quantised(command))));
    }

    #[test]
    fn no_text_panics(body in "\\PC{0,100}") {
        let _ = ToRobot::parse(&body);
        let _ = FromRobot::parse(&body);
    }
}

/// Random bytes, and golden lines that were bent and sealed again so that the checksum holds: nothing of
/// it may panic, and what is understood must mean the same when it is said again.
fn fuzz(inputs: u64) {
    use crate::wire::frame::{Decoder, Item, seal};
    use rand::{Rng, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
    let golden: Vec<String> = golden_to()
        .iter()
        .map(|(body, _)| (*body).to_owned())
        .chain(golden_from().iter().map(|(body, _)| (*body).to_owned()))
        .collect();
    let mut decoder = Decoder::default();
    let mut understood = 0_u64;
    for round in 0..inputs {
        let mut bytes = Vec::new();
        if round % 4 == 0 {
            bytes = (0..rng.random_range(0..40)).map(|_| rng.random::<u8>()).collect();
        } else {
            let mut body = golden[rng.random_range(0..golden.len())].clone().into_bytes();
            for _ in 0..rng.random_range(1..4) {
                let at = rng.random_range(0..body.len());
                match rng.random_range(0..3) {
                    0 => body[at] = rng.random_range(32..127),
                    1 => body.insert(at, b"0123456789-+ "[rng.random_range(0..13)]),
                    _ if body.len() > 1 => drop(body.remove(at)),
                    _ => {}
                }
            }
            seal(&String::from_utf8_lossy(&body), &mut bytes);
        }
        for item in decoder.feed(&bytes) {
            let Item::Body(body) = item else { continue };
            if let Some(message) = ToRobot::parse(&body) {
                understood += 1;
                assert_eq!(ToRobot::parse(&message.to_string()), Some(message), "{body}");
            }
            if let Some(message) = FromRobot::parse(&body) {
                understood += 1;
                assert_eq!(FromRobot::parse(&message.to_string()), Some(message), "{body}");
            }
        }
    }
    assert!(understood > inputs / 10, "{understood} of {inputs}: hardly anything was understood");
}

#[test]
fn bent_lines_with_good_checksums_mean_something_or_nothing() {
    fuzz(100_000);
}

/// `cargo test --release -- --ignored ten_million`
#[test]
#[ignore = "half a minute; the same as above over ten million inputs"]
fn ten_million_bent_lines() {
    fuzz(10_000_000);
}

#[test]
fn a_session_cut_anywhere_says_the_same() {
    use crate::wire::frame::{Decoder, Item, seal};
    let mut bytes = Vec::new();
    for body in golden_to().iter().map(|(b, _)| *b).chain(golden_from().iter().map(|(b, _)| *b)) {
        seal(body, &mut bytes);
    }
    let whole: Vec<Item> = Decoder::default().feed(&bytes).collect();
    assert_eq!(whole.len(), golden_to().len() + golden_from().len());
    for first in 0..=bytes.len() {
        for second in (first..=bytes.len()).step_by(7) {
            let mut decoder = Decoder::default();
            let mut items: Vec<Item> = decoder.feed(&bytes[..first]).collect();
            items.extend(decoder.feed(&bytes[first..second]));
            items.extend(decoder.feed(&bytes[second..]));
            assert_eq!(items, whole, "cut at {first} and {second}");
        }
    }
}
