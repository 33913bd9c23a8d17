//! A stop is the last word, whatever else goes wrong.

use super::*;

/// A command that waits for the line is not sent after a stop, though the record has failed meanwhile.
#[test]
fn a_command_that_waits_does_not_outlive_a_stop() {
    let mut rig = rig(Faults::default(), 1, false);
    rig.until(3.0, |_| false);
    rig.run.intent(Intent::Run, rig.now);
    rig.until(20.0, |_| false);
    rig.run.intent(Intent::Pause, rig.now);
    assert!(rig.until(20.0, |rig| !rig.device.is_moving()));
    rig.until(1.0, |_| false);
    rig.line = Passage::Cut;
    assert!(rig.until(3.0, |rig| rig.run.host().health() == Health::Stale));
    rig.run.intent(Intent::Run, rig.now);
    rig.memory.room.set(Some(0));
    rig.run.intent(Intent::Stop, rig.now);
    rig.line = Passage::Open;
    assert!(!rig.until(4.0, |rig| rig.device.is_moving()), "it moves after the stop");
    assert_eq!(rig.run.host().health(), Health::Up);
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
