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
