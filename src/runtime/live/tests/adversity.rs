//! What is wrong with neither end of the line: a disk that fills up, encoders that do not tell the
//! truth, switches that are broken.

use super::liar::Fault;
use super::*;
use crate::mapping::trust::Defect;

/// However many writes the disk has room for, the robot stands still soon after the first that it has
/// not, and the operator is told; what was written before is a whole record.
#[test]
fn a_full_disk_stops_the_robot_whenever_it_comes() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let later = (0..25).map(|_| rng.random_range(30..1500)).collect::<Vec<usize>>();
    for room in (0..30).chain(later) {
        let mut rig = rig(Faults::default(), 1, true);
        rig.memory.room.set(Some(room));
        assert!(rig.until(900.0, |rig| rig.run.ending().is_some()), "room {room}: it goes on");
        let ending = rig.run.ending().expect("an ending");
        if ending.outcome == Outcome::Complete {
            assert!(room > 1000, "room {room}: nobody noticed");
            continue;
        }
        assert!(ending.reason.contains("no space left"), "room {room}: {}", ending.reason);
        let events = rig.run.snapshot(rig.now).events;
        let told = events.iter().any(|event| event.kind.to_string().contains("no space left"));
        assert!(told || rig.run.session().is_none(), "room {room}: not in the log");
        let from = rig.body.true_pose().position;
        rig.until(0.6, |_| false);
        if let Some(session) = rig.run.session() {
            assert!(!session.mission().is_moving(), "room {room}: it stands, and nobody knows");
        }
        assert!(rig.speed() < 1e-9 && !rig.device.is_moving(), "room {room}: it still moves");
        let went = (rig.body.true_pose().position - from).norm();
        assert!(went < 0.06, "room {room}: {went} m after the disk was full");
        let bytes = rig.memory.bytes.borrow();
        if !bytes.is_empty() {
            let kept = crate::journal::reader::parse(std::path::Path::new("journal"), &bytes);
            assert!(kept.is_ok_and(|kept| kept.torn.is_none()), "room {room}");
        }
    }
}

/// A run whose record could not even be begun does not begin when the robot introduces itself once more.
#[test]
fn a_run_without_a_record_does_not_begin_at_the_second_try_either() {
    let mut rig = rig(Faults::default(), 1, true);
    rig.memory.room.set(Some(0));
    assert!(rig.until(3.0, |rig| rig.run.ending().is_some()));
    rig.run.unplugged(rig.now);
    rig.until(1.0, |_| false);
    rig.run.reopened(rig.now);
    assert!(!rig.until(5.0, |rig| rig.device.is_moving()), "driven, and not recorded");
    assert!(rig.run.session().is_none());
    let why = rig.run.ending().expect("an ending").reason;
    assert!(why.contains("no space left"), "{why}");
}

/// The record has every command and all that was told of the run, each once and in order.
#[test]
fn all_that_left_the_session_is_in_the_record() {
    let mut rig = rig(Faults::default(), 1, true);
    assert!(rig.until(900.0, |rig| rig.run.ending().is_some()));
    let bytes = rig.memory.bytes.borrow().clone();
    let kept = crate::journal::reader::parse(std::path::Path::new("memory"), &bytes);
    let records = kept.expect("a record").records;
    let session = rig.run.session().expect("a session");
    let commands = records.iter().filter_map(|record| match &record.entry {
        crate::journal::Entry::Command(command) => Some(command.id.0),
        _ => None,
    });
    let sent: u32 = session.progress().iter().map(|phase| phase.commands).sum();
    assert!(commands.eq(1..=sent), "not every one of {sent} commands");
    let told = records.iter().filter_map(|record| match &record.entry {
        crate::journal::Entry::Event(event) => Some(event),
        _ => None,
    });
    assert!(told.eq(session.events()), "not all that was told");
    let ends = |record: &&crate::journal::Record| matches!(&record.entry, crate::journal::Entry::PhaseEnd(end) if end.phase == Phase::Boundary);
    assert_eq!(records.iter().filter(ends).count(), 1);
}

/// A record that was written and then did not reach the disk is no record either.
#[test]
fn a_record_that_does_not_reach_the_disk_stops_the_robot() {
    let mut rig = rig(Faults::default(), 1, true);
    rig.until(20.0, |_| false);
    rig.run.record_lost(std::io::Error::other("input/output error"));
    rig.until(1.0, |_| false);
    assert!(rig.speed() < 1e-9 && !rig.device.is_moving(), "it still moves");
    let ending = rig.run.ending().expect("an ending");
    assert!(ending.reason.contains("input/output error"), "{}", ending.reason);
    assert!(rig.run.conclude().is_err(), "called whole");
}

/// A robot that was switched on late is there all the same; and a full disk is told of afterwards as well,
/// however often the operator clears the stop.
#[test]
fn a_robot_that_came_late_is_no_failure_and_hides_none() {
    let mut rig = rig(Faults::default(), 1, false);
    rig.line = Passage::Cut;
    rig.until(5.0, |_| false);
    rig.line = Passage::Open;
    assert!(rig.until(5.0, |rig| rig.run.session().is_some()), "nobody there");
    rig.run.intent(Intent::Run, rig.now);
    rig.until(20.0, |_| false);
    assert_eq!(rig.run.ending(), None, "it goes on");
    rig.memory.room.set(Some(0));
    rig.until(5.0, |_| false);
    for times in 1..4 {
        assert_eq!(rig.run_state(), RunState::Stopped, "{times}");
        assert!(rig.speed() < 1e-9 && !rig.device.is_moving(), "{times}: it still moves");
        assert_eq!(rig.alarms("no space left"), times, "nobody was told");
        rig.run.intent(Intent::ClearStop, rig.now);
        rig.run.intent(Intent::Run, rig.now);
        rig.until(2.0, |_| false);
    }
    assert!(rig.run.ending().is_some_and(|ending| ending.reason.contains("no space left")));
}

/// More edges at once than the robot has room for: it stops, and the host knows that there is a hole.
#[test]
fn a_hole_in_what_the_robot_tells_is_known_at_once() {
    let mut rig = rig(Faults::default(), 1, false);
    rig.until(3.0, |_| false);
    rig.run.intent(Intent::Run, rig.now);
    rig.until(20.0, |_| false);
    assert!(rig.until(20.0, |rig| rig.device.is_moving()));
    rig.storm = 80;
    // What it says of it is lost as well.
    rig.line = Passage::Cut;
    rig.until(0.1, |_| false);
    rig.line = Passage::Open;
    rig.until(0.5, |_| false);
    assert!(rig.speed() < 1e-9 && !rig.device.is_moving(), "it drives on");
    rig.until(1.0, |_| false);
    assert_eq!(rig.alarms("started again"), 1, "nobody noticed");
    assert_eq!(rig.run_state(), RunState::Stopped);
}

#[test]
fn a_wheel_whose_encoder_lies_is_found_out() {
    for lie in [[1.1, 1.0], [1.0, 0.85], [0.0, 1.0], [1.0, 2.0]] {
        let mut rig = rig(Faults::default(), 1, true);
        rig.lie = lie;
        assert!(rig.until(4000.0, |rig| rig.run.ending().is_some()), "{lie:?}: it goes on");
        let ending = rig.run.ending().expect("an ending");
        assert_eq!(ending.outcome, Outcome::Failed, "{lie:?} is called complete");
        rig.until(1.0, |_| false);
        assert!(!rig.device.is_moving(), "{lie:?}");
    }
}

/// What no robot can drive is no way that it went: it is told, the robot stands, and nothing is reckoned
/// with numbers that never end.
#[test]
fn an_encoder_that_leaps_stops_the_robot_at_once() {
    for (lie, at_once) in [([1e12, 1.0], true), ([1.0, -1e12], true), ([1e12, 1e12], false)] {
        let mut rig = rig(Faults::default(), 1, at_once);
        rig.until(2.0, |_| false);
        rig.run.intent(Intent::Run, rig.now);
        rig.until(20.0, |_| false);
        let travelled =
            |rig: &Rig| rig.run.session().expect("a session").mission().tracker().travelled();
        let before = travelled(&rig);
        rig.lie = lie;
        rig.until(1.5, |_| false);
        assert!(rig.speed() < 1e-9 && !rig.device.is_moving(), "{lie:?}: it still moves");
        assert!(travelled(&rig) - before < 0.1, "{lie:?}: it was taken for a way");
        let session = rig.run.session().expect("a session");
        let told = session.events().iter().any(|event| {
            matches!(&event.kind, EventKind::Alarm { what }
                if what.contains("cannot be believed"))
        });
        assert!(told, "{lie:?}: nobody was told");
        let ending = rig.run.ending().map(|ending| ending.reason);
        assert_eq!(
            ending.is_some_and(|why| why.contains("cannot be believed")),
            at_once,
            "{lie:?}"
        );
        let is_old = |rig: &Rig| {
            matches!(rig.run.snapshot(rig.now).robot, crate::session::Known::Stale { .. })
        };
        assert!(
            is_old(&rig),
            "{lie:?}: a pose that is not believed any more is shown as one that is"
        );
        // Cleared and set going, it is stopped again.
        rig.run.intent(Intent::ClearStop, rig.now);
        rig.run.intent(Intent::Run, rig.now);
        rig.until(1.0, |_| false);
        let session = rig.run.session().expect("a session");
        assert_eq!(session.run_state(), RunState::Stopped, "{lie:?}");
        // It counts as it did before.
        rig.lie = [1.0, 1.0];
        rig.until(1.0, |_| false);
        assert!(!is_old(&rig), "{lie:?}: what is believed again is old");
    }
}

/// A clock that comes round after 32 bits, one whose upper half is one too much from some time on, and one
/// for which that is so in a single moment: the robot stands, somebody is told, and no second of it counts.
#[test]
fn a_clock_that_leaps_stops_the_robot_at_once() {
    const ROUND: u64 = 1 << 32;
    type Clock = fn(u64) -> u64;
    let clocks: [(Clock, bool); 3] = [
        (|us| (us + ROUND - 20_000_000) % ROUND, false),
        (|us| if us < 20_000_000 { us } else { us + ROUND }, false),
        (|us| if us / 130_000 == 153 { us + ROUND } else { us }, true),
    ];
    for (which, (clock, passes)) in clocks.into_iter().enumerate() {
        for at_once in [true, false] {
            let case = format!("clock {which}, at once: {at_once}");
            let mut rig = rig(Faults::default(), 1, at_once);
            rig.clock = clock;
            rig.until(2.0, |_| false);
            rig.run.intent(Intent::Run, rig.now);
            rig.until(17.0, |_| false);
            let tracker =
                |rig: &Rig| rig.run.session().expect("a session").mission().tracker().clone();
            let before = tracker(&rig).time_us();
            rig.until(3.0, |_| false);
            assert!(rig.speed() < 1e-9 && !rig.device.is_moving(), "{case}: it still moves");
            let passed = tracker(&rig).time_us().abs_diff(before);
            assert!(passed < 4_000_000, "{case}: {passed} µs are believed");
            let told = rig.run.snapshot(rig.now).events.iter().any(|event| {
                let words = event.kind.to_string();
                words.contains("cannot be believed") && words.contains("clock")
            });
            assert!(told, "{case}: nobody was told");
            let ending = rig.run.ending().map(|ending| ending.reason);
            assert_eq!(ending.is_some_and(|why| why.contains("clock")), at_once, "{case}");
            if at_once {
                continue;
            }
            // Cleared and set going it is stopped again, until its clock is right.
            rig.run.intent(Intent::ClearStop, rig.now);
            rig.run.intent(Intent::Run, rig.now);
            rig.until(2.0, |_| false);
            let state = rig.run.session().expect("a session").run_state();
            assert_eq!(state == RunState::Running, passes, "{case}: {state:?}");
            if passes {
                assert!(rig.until(900.0, |rig| rig.run.ending().is_some()), "{case}");
                assert_eq!(rig.run.ending().expect("an ending").outcome, Outcome::Complete);
            }
        }
    }
}

/// Whoever clears the stop of such a robot and sets it going sends it nowhere, not even for a moment, and sees
/// that what is shown is old.
#[test]
fn a_robot_whose_clock_leapt_is_told_nothing() {
    let mut rig = rig(Faults::default(), 1, false);
    rig.clock = |us| if us < 20_000_000 { us } else { us + (1 << 32) };
    rig.until(2.0, |_| false);
    rig.run.intent(Intent::Run, rig.now);
    rig.until(22.0, |_| false);
    assert_eq!(rig.run_state(), RunState::Stopped);
    let shown = rig.run.snapshot(rig.now).robot;
    assert!(matches!(shown, crate::session::Known::Stale { .. }), "{shown:?}");
    for wish in [Intent::Run, Intent::StepCommand] {
        rig.run.intent(Intent::ClearStop, rig.now);
        rig.run.intent(wish, rig.now);
        assert!(!rig.until(0.5, |rig| rig.device.is_moving()), "{wish:?}: it is told to move");
    }
}

#[test]
fn encoders_that_stand_still_end_the_run() {
    let mut rig = rig(Faults::default(), 1, true);
    rig.lie = [0.0, 0.0];
    assert!(rig.until(4000.0, |rig| rig.run.ending().is_some()), "it goes on");
    assert_eq!(rig.run.ending().expect("an ending").outcome, Outcome::Failed);
    rig.until(1.0, |_| false);
    assert!(!rig.device.is_moving());
}

/// Whatever is wrong with one switch: it is named, and the run comes to its end with the right map.
#[test]
fn a_broken_switch_is_named_and_the_run_goes_on_without_it() {
    let text = include_str!("../../../../sims/l_room.toml");
    let world = World::from_toml(text, "l_room", 0.1).expect("a world");
    for how in [Fault::Closed, Fault::Open, Fault::Chatter] {
        for switch in 0..8 {
            let noise = NoiseProfile::Calibrated;
            let mut rig = rig_in(&world, noise, Faults::default(), 1, (true, None));
            rig.broken = Some(Broken { switch, how });
            let ended = rig.until(3000.0, |rig| rig.run.ending().is_some());
            assert!(ended, "{how:?} {switch}: it goes on and on");
            let ending = rig.run.ending().expect("an ending");
            let case = format!("{how:?} {switch}");
            assert_eq!(ending.outcome, Outcome::Complete, "{case}: {}", ending.reason);
            let map = rig.run.session().expect("a session").mission().map();
            let outline = &map.shape.as_ref().expect("a shape").outline;
            let corners = world.boundary.pieces.iter().map(crate::geometry::Piece::from);
            let worst = corners.map(|corner| outline.distance(corner)).fold(0.0, f64::max);
            assert!(worst < 0.06, "{case}: a corner is {worst} m off");
            assert_eq!(map.objects.len(), 1, "{case}");
            let named: Vec<_> = map.doubted.iter().map(|d| (d.switch.clone(), d.defect)).collect();
            let name = crate::robot::Chassis::default().sensors[switch].name.clone();
            let defect = match how {
                Fault::Closed => Defect::StuckClosed,
                Fault::Open => Defect::NeverFires,
                Fault::Chatter => Defect::Chatters,
            };
            assert_eq!(named, [(name, defect)], "{case}");
        }
    }
}

/// Firmware that reads a whole port tells of inputs that no switch is at: they are nothing to go by, and
/// nothing breaks over them, in a record either.
#[test]
fn inputs_without_a_switch_say_nothing() {
    let mut rig = rig(Faults::default(), 1, true);
    rig.broken = Some(Broken { switch: 12, how: Fault::Closed });
    assert!(rig.until(900.0, |rig| rig.run.ending().is_some()), "it goes on and on");
    let ending = rig.run.ending().expect("an ending");
    assert_eq!(ending.outcome, Outcome::Complete, "{}", ending.reason);
    let mission = rig.run.session().expect("a session").mission();
    assert!(mission.map().closed && mission.map().doubted.is_empty());
    assert!(!mission.switches().0.has(12), "it is shown");
    let bytes = rig.memory.bytes.borrow().clone();
    let recording = crate::journal::reader::parse(std::path::Path::new("memory"), &bytes);
    let mut replay = crate::session::Replay::new(recording.expect("a record"));
    replay.finish();
    assert_eq!(replay.difference(), None);
}
