//! Another robot at the end of the line, and another host.

use super::carried::l_room;
use super::*;

/// A robot of another make and name.
fn lead(boot: u32) -> Device {
    let usual = crate::robot::Chassis::default();
    let chassis = crate::robot::Chassis { tick: 0.001, wheel_base: 0.2, ..usual };
    Device::new(&chassis, "lead", boot, 1.0)
}

/// The cable is pulled out, and put into `device`.
fn replug(rig: &mut Rig, device: Device) {
    rig.run.unplugged(rig.now);
    rig.until(1.0, |_| false);
    rig.device = device;
    Hardware::drive(&mut rig.body, 0.0, 0.0);
    rig.up.clear();
    rig.run.reopened(rig.now);
}

/// A robot under an operator's hands in the L-shaped room, on its tour.
fn touring() -> Rig {
    let mut rig = rig_in(&l_room(), NoiseProfile::None, Faults::default(), 1, (false, None));
    assert!(rig.until(5.0, |rig| rig.run.session().is_some()));
    rig.run.intent(Intent::Run, rig.now);
    assert!(rig.until(2000.0, carried::is_touring));
    rig
}

/// What the record holds, played back.
fn replayed(rig: &Rig) -> crate::session::Replay {
    let bytes = rig.memory.bytes.borrow().clone();
    let recording = crate::journal::reader::parse(std::path::Path::new("memory"), &bytes);
    let mut replay = crate::session::Replay::new(recording.expect("a record"));
    replay.finish();
    assert_eq!(replay.difference(), None);
    replay
}

/// The operator has the wrong robot plugged in first, and twice: the record stays as it is, and the run goes
/// on when its own robot is there.
#[test]
fn a_run_that_is_taken_up_waits_for_its_own_robot() {
    let mut rig = touring();
    rig.host_dead = true;
    rig.until(2.0, |_| false);
    let own = rig.device.clone();
    resurrect(&mut rig, 9, None);
    (rig.run.plan.at_once, rig.run.goes_on) = (false, false);
    let before = rig.memory.bytes.borrow().clone();
    for boot in [70, 71] {
        replug(&mut rig, lead(boot));
        rig.until(5.0, |_| false);
        assert!(rig.run.session().is_none(), "another run was begun");
        let why = rig.run.ending().expect("an ending").reason;
        assert!(why.contains("tin") && why.contains("lead"), "{why}");
        assert!(*rig.memory.bytes.borrow() == before, "the record was written to");
    }
    replug(&mut rig, own);
    assert!(rig.until(5.0, |rig| rig.run.session().is_some()), "not known");
    rig.until(2.0, |_| false);
    assert_eq!(rig.run.ending(), None, "it is there");
    rig.run.intent(Intent::ClearStop, rig.now);
    rig.run.intent(Intent::Run, rig.now);
    assert!(rig.until(3000.0, |rig| rig.run.ending().is_some()));
    assert_eq!(rig.run.ending().expect("an ending").outcome, Outcome::Complete);
    assert!(replayed(&rig).is_complete());
}

/// Another host says hello to the robot, and this one's line is open meanwhile, or it is gone.
fn another_speaks(rig: &mut Rig, open: bool) {
    let mut hello = Vec::new();
    crate::wire::seal("H 1 00ABCDEF", &mut hello);
    if open {
        rig.device.receive(&hello);
        return;
    }
    rig.run.unplugged(rig.now);
    rig.line = Passage::Cut;
    rig.until(4.0, |_| false);
    rig.device.receive(&hello);
    rig.until(1.0, |_| false);
    rig.line = Passage::Open;
    rig.up.clear();
    rig.run.reopened(rig.now);
}

/// In the same life, and yet its numbers begin anew: what it says is not thrown away as old for ever.
#[test]
fn a_robot_that_another_host_spoke_to_is_not_driven_blind() {
    for open in [false, true] {
        let mut rig = touring();
        another_speaks(&mut rig, open);
        rig.until(5.0, |_| false);
        assert_eq!(rig.run.host().health(), Health::Up, "open: {open}");
        assert_eq!(rig.run_state(), RunState::Stopped, "open: {open}");
        assert!(rig.speed() < 1e-9 && !rig.device.is_moving(), "open: {open}: it moves");
        assert_eq!(rig.alarms("another host"), 1, "open: {open}: nobody was told");
        let time = |rig: &Rig| rig.run.session().expect("a session").mission().tracker().time_us();
        let before = time(&rig);
        rig.until(1.0, |_| false);
        let heard = time(&rig) - before;
        assert!(heard > 800_000, "open: {open}: {heard} µs of a second are heard");
        let lost = |rig: &Rig| rig.run.session().is_some_and(|s| s.mission().is_lost());
        assert!(lost(&rig), "open: {open}: it is believed to know its place");
        rig.run.intent(Intent::ClearStop, rig.now);
        rig.run.intent(Intent::Run, rig.now);
        assert!(rig.until(1000.0, |rig| !lost(rig)), "open: {open}: not found");
        assert!(rig.until(3000.0, |rig| rig.run.ending().is_some()), "open: {open}");
        let ending = rig.run.ending().expect("an ending");
        assert_eq!(ending.outcome, Outcome::Complete, "open: {open}: {}", ending.reason);
        assert!(carried::off(&rig) < 0.03, "open: {open}");
        replayed(&rig);
    }
}

/// Without an operator the run ends there, to be gone on with.
#[test]
fn a_run_without_an_operator_ends_when_another_host_speaks() {
    for open in [false, true] {
        let mut rig = rig(Faults::default(), 1, true);
        rig.until(20.0, |_| false);
        another_speaks(&mut rig, open);
        assert!(rig.until(3.0, |rig| rig.run.ending().is_some()), "open: {open}: it goes on");
        rig.until(1.0, |_| false);
        assert!(rig.speed() < 1e-9 && !rig.device.is_moving(), "open: {open}: it moves");
    }
}

/// Whatever the operator says, another robot does not go on with the run: its wheels count other lengths. Not
/// even one that was started as often.
#[test]
fn another_robot_at_the_port_does_not_go_on_with_the_run() {
    for (boot, pulled) in [(70, false), (3, true)] {
        let mut rig = touring();
        let own = rig.device.clone();
        if pulled {
            replug(&mut rig, lead(boot));
        } else {
            rig.device = lead(boot);
            Hardware::drive(&mut rig.body, 0.0, 0.0);
        }
        let from = rig.body.true_pose().position;
        rig.until(5.0, |_| false);
        let believed = |rig: &Rig| {
            let tracker = rig.run.session().expect("a session").mission().tracker();
            (tracker.time_us(), tracker.travelled())
        };
        let before = believed(&rig);
        for wish in [Intent::ClearStop, Intent::Run, Intent::StepCommand] {
            rig.run.intent(wish, rig.now);
            rig.until(3.0, |_| false);
            assert_eq!(rig.run_state(), RunState::Stopped, "{boot}: {wish:?}");
        }
        let went = (rig.body.true_pose().position - from).norm();
        assert!(went < 1e-3, "{boot}: it went {went} m");
        assert_eq!(believed(&rig), before, "{boot}: it is taken for the other");
        let told = rig.run.snapshot(rig.now);
        assert!(matches!(told.robot, crate::session::Known::Stale { age, .. } if age > 5.0));
        let both = |what: &str| what.contains("tin") && what.contains("lead");
        assert!(told.events.iter().any(|event| both(&event.kind.to_string())), "{boot}");
        // Its own robot comes back: it was out of hand, and finds its place.
        replug(&mut rig, own);
        rig.until(5.0, |_| false);
        rig.run.intent(Intent::ClearStop, rig.now);
        rig.run.intent(Intent::Run, rig.now);
        let ended = rig.until(4000.0, |rig| rig.run.ending().is_some());
        let said = rig.run.snapshot(rig.now).events;
        let said: Vec<_> = said.iter().rev().take(20).map(|e| e.kind.to_string()).collect();
        assert!(ended, "{boot}: {:?} {said:#?}", rig.run_state());
        assert_eq!(rig.run.ending().expect("an ending").outcome, Outcome::Complete, "{boot}");
        assert!(carried::off(&rig) < 0.03, "{boot}");
        replayed(&rig);
    }
}

/// A robot that only has the name of the run's own counts other lengths all the same.
#[test]
fn a_robot_of_the_same_name_with_another_body_does_not_go_on_with_the_run() {
    let mut rig = rig(Faults::default(), 1, false);
    rig.until(3.0, |_| false);
    rig.run.intent(Intent::Run, rig.now);
    rig.until(20.0, |_| false);
    let usual = crate::robot::Chassis::default();
    let other = crate::robot::Chassis { tick: 0.001, ..usual };
    replug(&mut rig, Device::new(&other, "tin", 70, 1.0));
    rig.until(5.0, |_| false);
    rig.run.intent(Intent::ClearStop, rig.now);
    rig.run.intent(Intent::Run, rig.now);
    assert!(!rig.until(3.0, |rig| rig.device.is_moving()), "it is taken for the other");
    assert!(rig.alarms("another body") > 0, "nobody was told");
}
