//! What is wrong with neither end of the line: a disk that fills up, encoders that do not tell the
//! truth.

use super::*;

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
        let from = rig.body.true_pose().position;
        rig.until(0.6, |_| false);
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

#[test]
fn encoders_that_stand_still_end_the_run() {
    let mut rig = rig(Faults::default(), 1, true);
    rig.lie = [0.0, 0.0];
    assert!(rig.until(4000.0, |rig| rig.run.ending().is_some()), "it goes on");
    assert_eq!(rig.run.ending().expect("an ending").outcome, Outcome::Failed);
    rig.until(1.0, |_| false);
    assert!(!rig.device.is_moving());
}
