//! What the session decides by itself: whom it believes, what ends it, what a replay makes of it.

use super::*;
use crate::geometry::Pose;
use crate::journal::{Entry, Header, Record, Recording};
use crate::robot::{DoneReason, Odometer, SwitchSet};

fn settings() -> Settings {
    Settings::new(Pose::new(0.0, 0.0, 0.0))
}

fn header() -> Header {
    Header {
        settings: settings(),
        source: "test".to_owned(),
        noise: String::new(),
        until: None,
        robot: None,
    }
}

/// A robot that stands where its wheels have counted `ticks` each, at `seconds`.
fn odometer(seconds: f64, ticks: i64) -> Odometer {
    let time_us = (seconds * 1e6).round() as u64;
    Odometer { time_us, left_ticks: ticks, right_ticks: ticks, heading: 0.0 }
}

fn report(seconds: f64, ticks: i64) -> Telemetry {
    let odometer = odometer(seconds, ticks);
    Telemetry::Report { odometer, switches: SwitchSet::EMPTY, bumper: false }
}

fn done(command: &Command, seconds: f64, ticks: i64) -> Telemetry {
    let (id, reason, odometer) = (command.id, DoneReason::Complete, odometer(seconds, ticks));
    Telemetry::Done { id, reason, odometer, switches: SwitchSet::EMPTY, bumper: false }
}

fn command(out: &[Outgoing]) -> Option<Command> {
    out.iter().find_map(|outgoing| match outgoing {
        Outgoing::Command(command) => Some(*command),
        _ => None,
    })
}

/// What of it was told the operator, as it is recorded.
fn events(out: &[Outgoing]) -> Vec<Entry> {
    let told = out.iter().filter_map(|outgoing| match outgoing {
        Outgoing::Event(event) => Some(Entry::Event(event.clone())),
        _ => None,
    });
    told.collect()
}

/// A session that was heard from once and told `intent`, with what left it then.
fn begun(settings: Settings, until: Phase, intent: Intent) -> (Session, Vec<Outgoing>) {
    let mut session = Session::new(settings, "test".to_owned(), until);
    session.telemetry(&report(1.0, 0), &mut Vec::new());
    let mut out = Vec::new();
    session.intent(intent, &mut out);
    (session, out)
}

/// Where nothing goes on without a word of the operator, the screen knows it.
#[test]
fn a_robot_that_needs_its_place_is_shown_so_until_it_is_told() {
    let needs = |session: &Session| match session.snapshot().robot {
        Known::Known(robot) => robot.needs_place,
        other => panic!("{other:?}"),
    };
    let (mut session, _) = begun(settings(), Phase::Objects, Intent::Placed { near: None });
    assert!(needs(&session));
    let near = Some(Pose::new(1.0, 1.0, 0.0));
    session.intent(Intent::Placed { near }, &mut Vec::new());
    assert!(!needs(&session));
}

/// Ten metres at once, and from there on quietly counted on: however long that lasts, and whatever the
/// operator does, it is no way that was driven; nor is it after the record was played back.
#[test]
fn a_wheel_that_has_leapt_is_not_believed_later_either() {
    let mut records = vec![Entry::Telemetry(report(1.0, 0)), Entry::Intent(Intent::Run)];
    let (mut session, out) = begun(settings(), Phase::Objects, Intent::Run);
    records.extend(command(&out).map(Entry::Command));
    for k in 1..3000_u32 {
        let told = report(1.0 + 0.1 * f64::from(k), 20_000);
        let mut out = Vec::new();
        records.push(Entry::Telemetry(told));
        session.telemetry(&told, &mut out);
        records.extend(events(&out));
        for wish in [Intent::ClearStop, Intent::Run] {
            assert!(session.fault().is_some(), "believed after {k} reports");
            assert_eq!(command(&out), None, "a command leaves meanwhile");
            records.push(Entry::Intent(wish));
            session.intent(wish, &mut out);
        }
        assert_eq!(command(&out), None, "a command leaves meanwhile");
    }
    assert!(session.mission().tracker().travelled() < 1e-9);
    let records = records.into_iter().map(|entry| Record { time_us: 0, entry }).collect();
    let mut replay = Replay::new(Recording { header: header(), records, torn: None, sound: 0 });
    replay.finish();
    assert_eq!(replay.difference(), None);
    let once = replay.session().events() == session.events();
    assert!(once, "what the session raises by itself is told as often as it was");
    let (mut session, _) = replay.into_session();
    session.telemetry(&report(9000.0, 20_000), &mut Vec::new());
    assert!(session.fault().is_some(), "believed when the run is taken up again");
    // Where it was, it is believed again.
    session.telemetry(&report(9000.1, 0), &mut Vec::new());
    assert!(session.fault().is_none());
}

/// The end of a motion that was not believed is an end all the same: the run is not left waiting for it.
#[test]
fn a_motion_whose_end_was_not_believed_has_ended() {
    let (mut session, out) = begun(settings(), Phase::Objects, Intent::Run);
    let first = command(&out).expect("a command");
    session.telemetry(&done(&first, 2.0, 1_000_000), &mut Vec::new());
    assert_eq!(session.run_state(), RunState::Stopped);
    assert_eq!(session.mission().awaited(), Some(first.id), "not ended where nobody knows");
    session.telemetry(&report(2.1, 100), &mut Vec::new());
    assert_eq!(session.mission().awaited(), None);
    let mut out = Vec::new();
    session.intent(Intent::ClearStop, &mut out);
    session.intent(Intent::Run, &mut out);
    assert!(command(&out).is_some(), "the operator cannot go on");
}

/// A command that the gate does not let through is a mistake in the program: the robot is stopped, and the
/// run is over rather than waiting for the end of a motion that never began.
#[test]
fn a_refused_command_ends_the_run() {
    let mut wrong = settings();
    // It stands at once from any speed, or it would be sent slower.
    (wrong.chassis.speed, wrong.chassis.acceleration) = (f64::INFINITY, f64::INFINITY);
    let (session, out) = begun(wrong, Phase::Objects, Intent::Run);
    assert_eq!(command(&out), None);
    assert!(out.contains(&Outgoing::Stop), "{out:?}");
    assert!(session.is_latched());
    let RunState::Failed(why) = session.run_state() else { panic!("{:?}", session.run_state()) };
    assert!(why.to_string().contains("mistake in the program"), "{why}");
}

/// What is told of the link is no step of the run: the replay tells it again, and goes on as the run did.
#[test]
fn a_remark_leaves_the_run_as_it_is() {
    let (mut session, out) = begun(settings(), Phase::Objects, Intent::StepEvent);
    // What happened at the beginning ended the step: the next one is at nothing but motions.
    let mut first = command(&out);
    let mut records = vec![Entry::Telemetry(report(1.0, 0)), Entry::Intent(Intent::StepEvent)];
    records.extend(first.map(Entry::Command));
    for k in 0..3 {
        let mut out = Vec::new();
        if session.run_state() == RunState::Paused {
            records.push(Entry::Intent(Intent::StepEvent));
            session.intent(Intent::StepEvent, &mut out);
            let next = command(&out);
            records.extend(next.map(Entry::Command));
            first = first.or(next);
        }
        let mut out = Vec::new();
        session.remark("nothing heard from the robot for 0.5 s".to_owned(), &mut out);
        records.extend(events(&out));
        assert_eq!(session.run_state(), RunState::Stepping(Step::Event));
        let told = done(&first.expect("a command"), 2.0 + f64::from(k), 500 * i64::from(k + 1));
        let mut out = Vec::new();
        session.telemetry(&told, &mut out);
        first = command(&out);
        records.push(Entry::Telemetry(told));
        records.extend(first.map(Entry::Command));
    }
    let records = records.into_iter().map(|entry| Record { time_us: 0, entry }).collect();
    let mut replay = Replay::new(Recording { header: header(), records, torn: None, sound: 0 });
    replay.finish();
    assert_eq!(replay.difference(), None);
    assert_eq!(replay.session().run_state(), session.run_state());
    assert_eq!(replay.session().events(), session.events(), "the log of the run");
    assert_eq!(replay.into_session().1, [], "the replay went on where the run stood");
}

/// After the end of what was asked for, the robot is placed nowhere any more.
#[test]
fn nothing_is_placed_after_the_run() {
    let (mut session, _) = begun(settings(), Phase::Boundary, Intent::Pause);
    session.progress[Phase::Boundary as usize].done = true;
    session.judge(&mut Vec::new());
    assert_eq!(session.run_state(), RunState::Complete);
    let mut out = Vec::new();
    session.intent(Intent::Placed { near: Some(Pose::new(3.0, 2.0, 1.0)) }, &mut out);
    assert_eq!(session.mission().tracker().pose(), Pose::new(0.0, 0.0, 0.0));
    let told = out.iter().any(|outgoing| {
        matches!(outgoing, Outgoing::Event(event) if event.kind.to_string().contains("the run is over"))
    });
    assert!(told, "{out:?}");
}

/// A run that has ended did not come to the end of the phase that it was in.
#[test]
fn a_phase_in_which_the_run_ended_is_not_said_to_have_come_to_its_end() {
    let (mut session, mut out) = begun(settings(), Phase::Objects, Intent::Run);
    // Wherever it is told to go, it is held.
    for second in 2..1000_u32 {
        let Some(told) = command(&out) else { break };
        out.clear();
        let (id, reason, switches) = (told.id, DoneReason::Bumper, SwitchSet::EMPTY);
        let odometer = odometer(f64::from(second), 0);
        let done = Telemetry::Done { id, reason, odometer, switches, bumper: true };
        session.telemetry(&done, &mut out);
    }
    let snapshot = session.snapshot();
    assert_eq!(snapshot.run, RunState::Failed(Failure::Boxed));
    assert_eq!(snapshot.phase, Phase::Boundary);
    assert_eq!(snapshot.progress.map(|phase| phase.share), [None; 4]);
}

/// All wishes that set a robot going.
const GOING: [Intent; 4] = [Intent::Run, Intent::StepCommand, Intent::StepEvent, Intent::StepPhase];

/// A stop, the operator's or one for a fault, holds whatever is wished and whatever is heard, until it is
/// cleared; to clear it sets nothing going yet.
#[test]
fn a_stop_holds_until_it_is_cleared_and_that_alone_starts_nothing() {
    for fault in [false, true] {
        let (mut session, out) = begun(settings(), Phase::Objects, Intent::Run);
        let first = command(&out).expect("a command");
        let mut out = Vec::new();
        if fault {
            session.telemetry(&report(1.5, 1_000_000), &mut out);
        } else {
            session.intent(Intent::Stop, &mut out);
        }
        assert_eq!(out.first(), Some(&Outgoing::Stop), "fault: {fault}: before everything else");
        out.clear();
        session.telemetry(&done(&first, 2.0, 100), &mut out);
        for wish in GOING {
            session.intent(wish, &mut out);
            assert!(session.is_latched() && session.snapshot().latched, "{fault} {wish:?}");
            assert_eq!(session.run_state(), RunState::Stopped, "fault: {fault}: {wish:?}");
        }
        session.intent(Intent::Pause, &mut out);
        assert_eq!(session.run_state(), RunState::Stopped, "fault: {fault}");
        session.intent(Intent::ClearStop, &mut out);
        session.telemetry(&report(2.1, 100), &mut out);
        assert_eq!(session.run_state(), RunState::Paused, "fault: {fault}");
        assert_eq!(command(&out), None, "fault: {fault}: it goes on by itself");
        session.intent(Intent::Run, &mut out);
        assert!(command(&out).is_some(), "fault: {fault}: it does not go on");
    }
}

/// Whoever presses stop again does not believe that the first one came through: it is sent, and not told anew.
#[test]
fn every_stop_is_sent_and_one_that_holds_already_is_no_news() {
    let (mut session, _) = begun(settings(), Phase::Objects, Intent::Run);
    let mut out = Vec::new();
    session.intent(Intent::Stop, &mut out);
    assert!(matches!(out[..], [Outgoing::Stop, Outgoing::Event(_)]), "{out:?}");
    out.clear();
    session.intent(Intent::Stop, &mut out);
    assert_eq!(out, [Outgoing::Stop]);
}

/// After its end a run stays as it ended, whatever is pressed and heard: what it came to is not lost. A stop is
/// sent all the same, and holds.
#[test]
fn a_run_that_is_over_stays_over_and_is_stopped_all_the_same() {
    let (mut session, out) = begun(settings(), Phase::Objects, Intent::Run);
    let first = command(&out).expect("a command");
    let mut out = Vec::new();
    session.intent(Intent::Finish, &mut out);
    assert!(out.contains(&Outgoing::Stop), "ended under way: {out:?}");
    let over = session.run_state();
    assert!(over.is_over(), "{over:?}");
    session.telemetry(&done(&first, 2.0, 100), &mut Vec::new());
    out.clear();
    session.intent(Intent::Stop, &mut out);
    assert_eq!(out.first(), Some(&Outgoing::Stop));
    assert!(session.is_latched() && session.run_state() == over);
    session.intent(Intent::ClearStop, &mut out);
    assert!(!session.is_latched() && session.run_state() == over);
    for wish in GOING.into_iter().chain([Intent::Pause, Intent::LapAgain, Intent::LapAnew]) {
        session.intent(wish, &mut out);
        assert_eq!(session.run_state(), over, "{wish:?}");
    }
    session.telemetry(&report(3.0, 1_000_000), &mut out);
    assert!(session.is_latched() && session.run_state() == over, "a fault after the end");
    assert_eq!(command(&out), None, "it drives");
}

/// A pause, and the end of a step, let nothing follow the motion in hand.
#[test]
fn nothing_follows_the_command_that_is_the_last() {
    for (begins, then) in [(Intent::StepCommand, None), (Intent::Run, Some(Intent::Pause))] {
        let (mut session, out) = begun(settings(), Phase::Objects, begins);
        let first = command(&out).expect("a command");
        let mut out = Vec::new();
        if let Some(wish) = then {
            session.intent(wish, &mut out);
        }
        session.telemetry(&done(&first, 2.0, 100), &mut out);
        session.telemetry(&report(2.1, 100), &mut out);
        assert_eq!(session.run_state(), RunState::Paused, "{begins:?}");
        assert_eq!(command(&out), None, "{begins:?}");
    }
}

/// Of a robot that was never heard nothing is shown, and it is told nothing.
#[test]
fn a_robot_that_was_never_heard_is_told_nothing() {
    let mut session = Session::new(settings(), "test".to_owned(), Phase::Objects);
    let mut out = Vec::new();
    session.intent(Intent::Run, &mut out);
    assert_eq!(command(&out), None);
    assert_eq!(session.snapshot().robot, Known::Unknown);
}

/// A mission that would decide on and on is at fault: the robot is stopped, whatever was decided last, and the
/// run is over. One that has decided as often as it may and then waits for its robot is none.
#[test]
fn a_mission_that_decides_for_ever_is_given_up() {
    for (most, given_up) in [(1, true), (2, false), (MOST_DECISIONS, false)] {
        let (mut session, _) = begun(settings(), Phase::Objects, Intent::Pause);
        session.run = RunState::Running;
        let mut out = Vec::new();
        session.decide(most, &mut out);
        let asked = command(&out).expect("a motion");
        assert_eq!(session.is_latched(), given_up, "{most}");
        assert_eq!(session.run_state() != RunState::Running, given_up, "{most}");
        if !given_up {
            assert!(!out.contains(&Outgoing::Stop), "{most}: {out:?}");
            continue;
        }
        let last = |what: fn(&Outgoing) -> bool| out.iter().rposition(what).expect("said");
        let stopped = last(|outgoing| matches!(outgoing, Outgoing::Stop));
        assert!(stopped > last(|outgoing| matches!(outgoing, Outgoing::Command(_))));
        assert_eq!(session.run_state(), RunState::Failed(Failure::Internal));
        let told = |outgoing: &Outgoing| matches!(outgoing, Outgoing::Event(event) if event.kind.to_string().contains("on and on"));
        assert!(out.iter().any(told), "{out:?}");
        let mut later = Vec::new();
        session.intent(Intent::ClearStop, &mut later);
        session.intent(Intent::Run, &mut later);
        session.telemetry(&done(&asked, 2.0, 500), &mut later);
        assert_eq!(command(&later), None, "it goes on");
    }
}

/// Cleared and set going, a robot whose last word cannot be is told nothing before it is believed again.
#[test]
fn nothing_is_decided_on_what_cannot_be() {
    let (mut session, _) = begun(settings(), Phase::Objects, Intent::Pause);
    session.telemetry(&report(1.1, 1_000_000), &mut Vec::new());
    assert!(session.fault().is_some(), "a leap of 500 m is believed");
    let mut out = Vec::new();
    session.intent(Intent::ClearStop, &mut out);
    session.intent(Intent::Run, &mut out);
    assert_eq!(command(&out), None, "{out:?}");
}
