//! A console that hangs while the robot drives.

use super::*;

/// Lets `seconds` pass; the console turns meanwhile, or hangs.
fn pass(rig: &mut Rig, seconds: f64, turns: bool) {
    let end = rig.now + seconds;
    while rig.now < end {
        if turns {
            rig.run.attended(rig.now);
        }
        rig.step();
    }
}

#[test]
fn a_console_that_hangs_stops_the_robot_and_one_that_turns_does_not() {
    let mut rig = rig(Faults::default(), 1, false);
    pass(&mut rig, 3.0, true);
    rig.run.intent(Intent::Run, rig.now);
    pass(&mut rig, 20.0, true);
    assert_eq!(rig.run_state(), RunState::Running);
    // A long look at something else is no hanging.
    pass(&mut rig, 0.9, false);
    pass(&mut rig, 5.0, true);
    assert_eq!(rig.alarms("console hangs"), 0);
    let from = rig.body.true_pose().position;
    pass(&mut rig, 6.0, false);
    assert_eq!(rig.run_state(), RunState::Stopped);
    let went = (rig.body.true_pose().position - from).norm();
    assert!(went < 0.2 * 1.1 + 0.02, "{went} m with nobody there");
    assert!(rig.speed() < 1e-9 && !rig.device.is_moving());
    assert_eq!(rig.alarms("console hangs"), 1, "said once");
    // It turns again: the operator clears the stop and goes on.
    pass(&mut rig, 1.0, true);
    rig.run.intent(Intent::ClearStop, rig.now);
    rig.run.intent(Intent::Run, rig.now);
    pass(&mut rig, 5.0, true);
    assert_eq!(rig.run_state(), RunState::Running);
}

/// A single step goes on by itself as well, and what is paused still drives its last motion to the end, whenever
/// the operator is gone.
#[test]
fn a_console_that_hangs_stops_a_step_and_a_last_motion() {
    for paused in [false, true] {
        let mut stopped = 0;
        for later in 0..40 {
            let mut rig = rig(Faults::default(), 1, false);
            pass(&mut rig, 3.0, true);
            rig.run.intent(Intent::StepPhase, rig.now);
            pass(&mut rig, 0.5 * f64::from(later), true);
            if paused {
                rig.run.intent(Intent::Pause, rig.now);
            }
            pass(&mut rig, 1.4, false);
            assert!(rig.speed() < 1e-9 && !rig.device.is_moving(), "{paused}: {later}");
            stopped += usize::from(rig.run_state() == RunState::Stopped);
        }
        assert!(stopped > 0 && (paused || stopped == 40), "{paused}: {stopped}");
    }
}

#[test]
fn a_run_without_an_operator_needs_none() {
    let mut rig = rig(Faults::default(), 1, true);
    pass(&mut rig, 30.0, false);
    assert_eq!(rig.run_state(), RunState::Running);
}

/// A robot that would drive on for a minute after its host has fallen silent is stopped, and the operator is told;
/// a simulated one whose time goes as much faster is none.
#[test]
fn a_robot_that_does_not_mind_its_host_is_stopped() {
    for at_once in [true, false] {
        let mut rig = rig(Faults::default(), 1, at_once);
        // It waits 200 times as long, and its time goes as fast as life.
        rig.device = Device::new(&crate::robot::Chassis::default(), "tin", 3, 200.0);
        rig.until(2.0, |_| false);
        rig.run.intent(Intent::Run, rig.now);
        rig.until(4.0, |_| false);
        assert_eq!(rig.run_state(), RunState::Stopped, "at once: {at_once}");
        assert!(rig.speed() < 1e-9 && !rig.device.is_moving(), "at once: {at_once}");
        assert_eq!(rig.alarms("drives on for 60 s"), 1, "at once: {at_once}");
        assert_eq!(rig.run.ending().is_some(), at_once);
    }
}
