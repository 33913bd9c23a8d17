//! A stop is the last word, whatever else goes wrong.

use super::*;

/// A robot under an operator's hands that stands, and over whose line nothing has been told for a moment.
fn stale() -> Rig {
    let mut rig = rig(Faults::default(), 1, false);
    rig.until(3.0, |_| false);
    rig.run.intent(Intent::Run, rig.now);
    rig.until(20.0, |_| false);
    rig.run.intent(Intent::Pause, rig.now);
    assert!(rig.until(20.0, |rig| !rig.device.is_moving()));
    rig.until(1.0, |_| false);
    rig.line = Passage::Cut;
    assert!(rig.until(3.0, |rig| rig.run.host().health() == Health::Stale));
    rig
}

/// A disk may take its time; a stop leaves before it is written down, and is written down all the same.
#[test]
fn a_stop_waits_for_no_disk() {
    let mut rig = rig(Faults::default(), 1, false);
    rig.until(3.0, |_| false);
    rig.run.intent(Intent::Run, rig.now);
    assert!(rig.until(20.0, |rig| rig.device.is_moving()));
    let written = rig.memory.bytes.borrow().len();
    rig.run.intent(Intent::Stop, rig.now);
    assert_eq!(rig.run.take_output().first(), Some(&crate::wire::STOP));
    assert_eq!(rig.memory.bytes.borrow().len(), written, "the disk was waited for");
    rig.run.tick(rig.now);
    let record = String::from_utf8_lossy(&rig.memory.bytes.borrow()[written..]).into_owned();
    assert!(record.to_lowercase().contains("stop"), "{record}");
}

/// A command that waits for the line is not sent after a stop, whether the record has failed meanwhile or not;
/// nor does the run wait for its end.
#[test]
fn a_command_that_waits_does_not_outlive_a_stop() {
    for full in [true, false] {
        let mut rig = stale();
        rig.run.intent(Intent::Run, rig.now);
        assert!(!orders(&rig.run.take_output()), "sent over a line on which nothing is heard");
        if full {
            rig.memory.room.set(Some(0));
        }
        rig.run.intent(Intent::Stop, rig.now);
        rig.line = Passage::Open;
        assert!(!rig.until(4.0, |rig| rig.device.is_moving()), "full: {full}: it moves");
        assert_eq!(rig.run.host().health(), Health::Up);
        rig.run.intent(Intent::ClearStop, rig.now);
        rig.run.intent(Intent::Run, rig.now);
        let goes_on = rig.until(4.0, |rig| rig.device.is_moving());
        assert_eq!(goes_on, !full, "full: {full}: after the stop was cleared");
    }
}

/// A robot that refuses what it is told is stopped, and no end of that motion is waited for; without an operator
/// the run ends.
#[test]
fn a_robot_that_refuses_a_command_is_stopped() {
    for at_once in [true, false] {
        let mut rig = rig(Faults::default(), 1, at_once);
        rig.until(3.0, |_| false);
        rig.run.intent(Intent::Run, rig.now);
        rig.until(20.0, |_| false);
        rig.line = Passage::UntilACommand;
        assert!(rig.until(20.0, |rig| rig.line == Passage::Cut), "no command");
        rig.line = Passage::Open;
        let awaited = rig.run.session().and_then(|session| session.mission().awaited());
        let id = awaited.expect("a motion").0;
        let mut refusal = Vec::new();
        crate::wire::seal(&format!("n {id} too steep"), &mut refusal);
        rig.run.receive(&refusal, rig.now);
        assert!(rig.run.take_output().contains(&crate::wire::STOP), "at once: {at_once}");
        assert_eq!(rig.run_state(), RunState::Stopped, "at once: {at_once}");
        assert_eq!(rig.alarms("too steep"), 1, "at once: {at_once}");
        rig.until(3.0, |_| false);
        assert!(!rig.device.is_moving(), "at once: {at_once}");
        let ending = rig.run.ending().map(|ending| ending.reason);
        assert_eq!(ending.is_some_and(|why| why.contains("too steep")), at_once);
        if !at_once {
            rig.run.intent(Intent::ClearStop, rig.now);
            rig.run.intent(Intent::Run, rig.now);
            assert!(rig.until(4.0, |rig| rig.device.is_moving()), "it waits for ever");
        }
    }
}

/// Whatever is at the other end may be driving: before it has said who it is it is told to stop as well, when
/// nothing sensible is heard of it and when the operator says so.
#[test]
fn a_robot_that_never_said_who_it_is_is_told_to_stop() {
    for asked in [true, false] {
        let mut rig = rig(Faults { drop: 1.0, ..Faults::default() }, 1, false);
        let mut told = Vec::new();
        for step in 0..500 {
            let now = f64::from(step) * 0.01;
            rig.run.tick(now);
            if asked && step == 20 {
                rig.run.intent(Intent::Stop, now);
            }
            told.extend(rig.run.take_output());
            let soon = told.contains(&crate::wire::STOP);
            assert!(!soon || asked || step > 300, "it was given no time to answer");
            assert!(soon || !asked || step < 21, "the operator is not heard");
        }
        let times = told.split(|byte| *byte == crate::wire::STOP).count() - 1;
        assert!(times > 2, "asked: {asked}: said {times} times");
        let shown = rig.run.snapshot(5.0).source;
        assert!(shown.contains("switched on"), "asked: {asked}: {shown}");
    }
}

/// A run that is taken up waits for the robot to stand still, and then goes on by itself; not after a stop.
#[test]
fn a_stop_before_a_run_goes_on_is_not_cleared() {
    for early in [true, false] {
        let mut rig = rig(Faults::default(), 1, true);
        rig.until(20.0, |_| false);
        rig.host_dead = true;
        rig.until(2.0, |_| false);
        rig.up.clear();
        resurrect(&mut rig, 9, None);
        if !early {
            assert!(rig.until(5.0, |rig| rig.run.session().is_some()));
        }
        rig.run.intent(Intent::Stop, rig.now);
        let from = rig.body.true_pose().position;
        rig.until(5.0, |_| false);
        let went = (rig.body.true_pose().position - from).norm();
        assert!(went < 1e-3, "early: {early}: it went {went} m after the stop");
    }
}

/// A robot that rolls on after its host died is not taken to stand by the first that is heard of it.
#[test]
fn what_still_rolls_does_not_stand() {
    let mut rig = rig(Faults::default(), 1, false);
    rig.until(3.0, |_| false);
    rig.run.settling = Some(0);
    let mut report = |ticks: i64| {
        let mut odometer = rig.run.last.0;
        odometer.time_us += 100_000;
        odometer.left_ticks += ticks;
        let told = Telemetry::Report { odometer, switches: SwitchSet::EMPTY, bumper: false };
        rig.run.telemetry(&told, rig.now);
        rig.run.settling.is_none()
    };
    for _ in 0..10 {
        assert!(!report(2), "it rolls");
    }
    assert!(!report(0) && !report(0), "too early to tell");
    assert!(report(0));
}
