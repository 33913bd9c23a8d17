//! The record is read back as it was written, whatever the crash left of its end.

use super::*;
use crate::geometry::Pose;
use crate::mapping::event::EventKind;
use crate::robot::{CommandId, DoneReason, Edge, Guard, Motion, Odometer, SwitchSet};
use std::path::Path;

fn header() -> Header {
    Header {
        settings: Settings::new(Pose::new(0.6, 0.6, 1.1)),
        source: "a room".to_owned(),
        noise: "calibrated".to_owned(),
        until: Some(Phase::Plan),
        robot: None,
    }
}

fn records() -> Vec<Record> {
    let odometer =
        Odometer { time_us: 20_000, left_ticks: -3, right_ticks: 41, heading: 0.1 + 0.2 };
    let command = Command {
        id: CommandId(7),
        motion: Motion::Move { distance: 0.5, speed: 0.2 },
        guard: Guard { rise: SwitchSet(3), fall: SwitchSet::EMPTY },
        time_limit: 4.5,
    };
    let event = Event { time_us: 20_000, kind: EventKind::LapCandidate { off: 1.0 / 3.0 } };
    let report = Telemetry::Report { odometer, switches: SwitchSet(129), bumper: true };
    let edge = Telemetry::Edge(Edge { sensor: 2, rising: false, odometer });
    let done = Telemetry::Done {
        id: CommandId(7),
        reason: DoneReason::Guard { sensor: 1, rising: true },
        odometer,
        switches: SwitchSet(2),
        bumper: false,
    };
    let entries = [
        Entry::Intent(Intent::SetAlpha { alpha: 0.3 }),
        Entry::Command(command),
        Entry::Telemetry(report),
        Entry::Telemetry(edge),
        Entry::Telemetry(done),
        Entry::Event(event),
        Entry::PhaseEnd(PhaseEnd { phase: Phase::Boundary, state: u64::MAX - 5 }),
        Entry::Life(Life { boot: u32::MAX, beyond: odometer }),
    ];
    let at = |(k, entry)| Record { time_us: k as u64 * 1000, entry };
    entries.into_iter().enumerate().map(at).collect()
}

fn written() -> Vec<u8> {
    let mut journal = Journal::begin(Vec::new(), &header()).expect("memory takes a header");
    for record in records() {
        journal.record(&record);
    }
    journal.finish().expect("memory takes everything")
}

fn parse(bytes: &[u8]) -> Result<Recording, JournalError> {
    reader::parse(Path::new("run/journal"), bytes)
}

#[test]
fn what_is_written_is_read_back_bit_for_bit() {
    let recording = parse(&written()).expect("a whole record");
    assert_eq!(recording.header, header());
    assert_eq!(recording.records, records());
    assert_eq!(recording.torn, None);
}

#[test]
fn a_record_cut_anywhere_after_its_header_loses_only_the_cut_line() {
    let bytes = written();
    let ends: Vec<usize> = (0..bytes.len()).filter(|&k| bytes[k] == b'\n').map(|k| k + 1).collect();
    for cut in ends[0]..bytes.len() {
        let recording = parse(&bytes[..cut]).unwrap_or_else(|e| panic!("cut at byte {cut}: {e}"));
        let whole = ends.iter().filter(|&&end| end <= cut).count() - 1;
        assert_eq!(recording.records.len(), whole, "cut at byte {cut}");
        let left = cut - ends[whole];
        assert_eq!(recording.torn.map_or(0, |torn| torn.bytes), left, "cut at byte {cut}");
    }
}

#[test]
fn damage_in_the_middle_is_refused_with_its_line() {
    let mut bytes = written();
    let third = bytes.iter().enumerate().filter(|(_, b)| **b == b'\n').nth(1).expect("lines").0;
    bytes[third + 8] ^= 1;
    let error = parse(&bytes).expect_err("a hole");
    assert!(error.to_string().starts_with("run/journal:3: "), "{error}");
    assert!(error.to_string().contains("show what is whole"), "{error}");
    let mut headless = written();
    headless[40] ^= 1;
    let error = parse(&headless).expect_err("no header").to_string();
    assert!(error.starts_with("run/journal:1: ") && !error.contains("whole"), "{error}");
}

#[test]
fn other_files_and_newer_records_say_so() {
    let error = parse(b"hello\n").expect_err("no record");
    assert!(error.to_string().contains("not a record"), "{error}");
    assert!(parse(b"").is_err(), "an empty file is no record");
    let error = parse(b"periplus-journal 99 {} 00000000\n").expect_err("newer");
    assert!(error.to_string().contains("version 99 is newer"), "{error}");
}

#[test]
fn a_full_disk_is_remembered_and_does_not_stop_the_run() {
    struct Full(usize);
    impl std::io::Write for Full {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            if self.0 == 0 {
                return Err(std::io::Error::other("no space left"));
            }
            self.0 -= 1;
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    assert!(Journal::begin(Full(0), &header()).is_err(), "a header that nobody keeps");
    let mut journal = Journal::begin(Full(1), &header()).expect("room for the header");
    for record in records() {
        journal.record(&record);
    }
    assert!(journal.error().is_some(), "the phase's end flushes, which fails");
    assert!(journal.finish().is_err(), "the loss is told at the end");
}

#[test]
fn states_that_differ_have_other_hashes() {
    assert_eq!(state_hash(&(1.5, "a")), state_hash(&(1.5, "a")));
    assert_ne!(state_hash(&(1.5, "a")), state_hash(&(1.5, "b")));
}

/// A header is held against the bounds that files and robots are held against.
#[test]
fn a_header_that_no_run_can_have_is_refused() {
    type Change = fn(&mut Settings);
    let with = |change: Change| {
        let mut header = header();
        change(&mut header.settings);
        let bytes = Journal::begin(Vec::new(), &header).expect("memory").finish().expect("memory");
        parse(&bytes).map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(with(|_| {}), Ok(()));
    let changes: [(&str, Change); 7] = [
        ("tick", |settings| settings.chassis.tick = 1e308),
        ("0 switches", |settings| settings.chassis.sensors.clear()),
        ("alpha", |settings| settings.alpha = 1e-9),
        ("start", |settings| settings.start.position.x = 1e308),
        ("start", |settings| settings.start.heading = 1e308),
        ("laps", |settings| settings.laps = 4_000_000_000),
        ("tape", |settings| {
            let from = settings.start.position;
            settings.tape = Some(crate::mapping::tape::Tape { from, to: from, length: 5.0 });
        }),
    ];
    for (word, change) in changes {
        let error = with(change).expect_err(word);
        assert!(error.contains("journal:1:") && error.contains(word), "{error}");
    }
}

#[test]
fn an_empty_record_is_told_as_such() {
    let whole = written();
    for bytes in [&b""[..], b"periplus-", &whole[..40]] {
        let error = parse(bytes).expect_err("nothing in it").to_string();
        assert!(error.contains("holds nothing") && error.contains("--out"), "{error}");
    }
}

/// A wish that no operator can have is damage, wherever it stands.
#[test]
fn a_wish_that_nobody_can_have_is_refused() {
    let far = crate::geometry::Point::new(1e308, 0.0);
    let wishes = [
        Intent::SetAlpha { alpha: 1e-9 },
        Intent::Placed { near: Some(Pose { position: far, heading: 0.0 }) },
        Intent::SetTape { from: far, to: far, length: 5.0 },
    ];
    for wish in wishes {
        let mut journal = Journal::begin(Vec::new(), &header()).expect("memory");
        journal.intent(0, &wish);
        journal.intent(1, &Intent::Run);
        let error = parse(&journal.finish().expect("memory")).expect_err("a wish").to_string();
        assert!(error.contains("journal:2:"), "{wish:?}: {error}");
    }
}

/// Whole lines that are missing in the middle are damage as well: every line that is left holds.
#[test]
fn a_record_in_which_a_line_is_missing_or_comes_twice_is_refused() {
    let bytes = written();
    let lines: Vec<&[u8]> = bytes.split_inclusive(|&byte| byte == b'\n').collect();
    let without = [&lines[..3], &lines[4..]].concat().concat();
    let twice = [&lines[..4], &lines[3..]].concat().concat();
    for (bent, line) in [(without, 4), (twice, 5)] {
        let error = parse(&bent).expect_err("a hole").to_string();
        assert!(error.starts_with(&format!("run/journal:{line}: record ")), "{error}");
    }
}

/// A run that is not handed on at all loses no more than what the writer keeps back.
#[test]
fn what_is_recorded_is_handed_on_before_it_is_much() {
    struct Counts(std::rc::Rc<std::cell::Cell<usize>>);
    impl std::io::Write for Counts {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.set(self.0.get() + bytes.len());
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let handed_on = std::rc::Rc::new(std::cell::Cell::new(0));
    let mut journal = Journal::begin(Counts(handed_on.clone()), &header()).expect("room");
    let event = Event { time_us: 0, kind: EventKind::Stopped };
    for _ in 0..10_000 {
        journal.event(0, &event);
    }
    let before = handed_on.get();
    assert!(journal.finish().is_ok());
    let whole = handed_on.get();
    assert!(whole > 200_000 && whole - before <= 64 * 1024, "{before} bytes of {whole}");
}

/// The robot may have been started again more than once: the last life is the one that it is in.
#[test]
fn the_last_life_counts() {
    let mut journal = Journal::begin(Vec::new(), &header()).expect("memory");
    for boot in [4, 5] {
        journal.life(0, &Life { boot, beyond: Odometer::default() });
    }
    let recording = parse(&journal.finish().expect("memory")).expect("a record");
    assert_eq!(recording.life().map(|life| life.boot), Some(5));
}
