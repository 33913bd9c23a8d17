//! A line that is gone for longer than any motion lasts, and a host that was busy meanwhile.

use super::*;
use crate::session::Known;

/// A robot under an operator's hands, under way for `seconds`.
fn under_way(seconds: f64) -> Rig {
    let mut rig = rig(Faults::default(), 1, false);
    rig.until(3.0, |_| false);
    rig.run.intent(Intent::Run, rig.now);
    rig.until(seconds, |_| false);
    rig
}

fn travelled(rig: &Rig) -> f64 {
    rig.run.session().expect("a session").mission().tracker().travelled()
}

/// The operator goes on, and so does the robot.
fn goes_on(rig: &mut Rig) {
    rig.run.intent(Intent::ClearStop, rig.now);
    rig.run.intent(Intent::Run, rig.now);
    let before = travelled(rig);
    rig.until(10.0, |_| false);
    let session = rig.run.session().expect("a session");
    let told: Vec<String> = session.events().iter().map(|event| event.kind.to_string()).collect();
    assert_eq!(
        rig.run_state(),
        RunState::Running,
        "{:?}",
        told.iter().rev().take(12).collect::<Vec<_>>()
    );
    assert!(travelled(rig) - before > 0.3, "it stands");
}

/// The deadline of a motion that ended meanwhile is long over when the line is there again.
#[test]
fn a_line_that_was_gone_for_long_is_back_once_and_for_all() {
    for later in 0..8 {
        let mut rig = under_way(20.0 + 0.17 * f64::from(later));
        rig.line = Passage::Cut;
        rig.until(10.0, |_| false);
        rig.line = Passage::Open;
        rig.until(6.0, |_| false);
        assert_eq!(rig.run.host().health(), Health::Up, "{later}");
        assert_eq!(rig.alarms("link lost"), 1, "{later}: it flaps");
        goes_on(&mut rig);
    }
}

/// A radio link that bundles what goes over it loses nothing and hides the robot all the same: it is stopped on every
/// motion. Somebody is told why it does not get on, and it does not go on for ever.
#[test]
fn a_line_that_bundles_its_reports_is_told_of_and_given_up() {
    for at_once in [true, false] {
        let mut rig = rig(Faults::default(), 1, at_once);
        rig.until(3.0, |_| false);
        rig.run.intent(Intent::Run, rig.now);
        rig.until(5.0, |_| false);
        rig.bundle = 0.45;
        let given_up = "too far apart to drive by";
        assert!(rig.until(30.0, |rig| rig.alarms(given_up) > 0), "at once: {at_once}: no word");
        assert!(rig.alarms("reports stayed away") >= 1);
        rig.until(2.0, |_| false);
        assert!(!rig.device.is_moving());
        if at_once {
            let ending = rig.run.ending().expect("an ending");
            assert!(ending.reason.contains(given_up), "{}", ending.reason);
            continue;
        }
        assert_eq!(rig.run_state(), RunState::Stopped);
        rig.bundle = 0.0;
        rig.until(2.0, |_| false);
        goes_on(&mut rig);
        assert_eq!(rig.alarms(given_up), 1, "a good line");
    }
}

/// Nobody knows whether a command began that the line took with it; no end of it ever comes.
#[test]
fn a_line_that_took_a_command_with_it_is_back_once_and_for_all() {
    let mut rig = under_way(20.0);
    rig.line = Passage::UntilACommand;
    assert!(rig.until(10.0, |rig| rig.line == Passage::Cut), "no command");
    rig.until(12.0, |_| false);
    rig.line = Passage::Open;
    rig.until(6.0, |_| false);
    assert_eq!(rig.run.host().health(), Health::Up);
    assert_eq!(rig.alarms("link lost"), 1, "it flaps");
    goes_on(&mut rig);
}

/// Nobody heard the robot stop: the stop is not cleared before somebody has.
#[test]
fn a_stop_that_nobody_answered_is_not_cleared() {
    let mut rig = under_way(20.0);
    rig.line = Passage::Cut;
    assert!(rig.until(3.0, |rig| matches!(rig.run.host().health(), Health::Lost(_))));
    rig.run.intent(Intent::ClearStop, rig.now);
    assert_eq!(rig.run_state(), RunState::Stopped);
    assert_eq!(rig.alarms("has not said yet that it stands"), 1);
    rig.line = Passage::Open;
    rig.until(6.0, |_| false);
    goes_on(&mut rig);
}

/// Set going while the line is gone, the robot does not drive off by itself when it is back.
#[test]
fn nothing_waits_for_a_line_that_is_gone() {
    let mut rig = under_way(20.0);
    rig.run.intent(Intent::Pause, rig.now);
    assert!(rig.until(20.0, |rig| !rig.device.is_moving()));
    rig.until(1.0, |_| false);
    rig.line = Passage::Cut;
    assert!(rig.until(3.0, |rig| matches!(rig.run.host().health(), Health::Lost(_))));
    rig.run.intent(Intent::ClearStop, rig.now);
    rig.run.intent(Intent::Run, rig.now);
    rig.until(30.0, |_| false);
    rig.line = Passage::Open;
    let before = travelled(&rig);
    rig.until(6.0, |_| false);
    assert_eq!(rig.run.host().health(), Health::Up);
    assert!(travelled(&rig) - before < 1e-3, "it drove off half a minute later");
    assert_eq!(rig.run_state(), RunState::Stopped);
    goes_on(&mut rig);
}

/// What came while the host was busy has not been read yet when the host looks at the time.
#[test]
fn a_host_that_was_busy_has_not_lost_its_robot() {
    let mut rig = under_way(20.0);
    for busy in [0.6, 2.0, 12.0] {
        rig.host_dead = true;
        rig.until(busy, |_| false);
        rig.host_dead = false;
        rig.run.tick(rig.now);
        rig.until(3.0, |_| false);
        assert_eq!(rig.alarms("link lost"), 0, "busy for {busy} s");
        assert_eq!(rig.run_state(), RunState::Running, "busy for {busy} s");
    }
}

/// Why nobody answers is more than the header has room for, and what there is to be done stands at its end.
#[test]
fn why_a_robot_was_never_heard_stands_in_the_log() {
    let mut rig = rig(Faults::default(), 1, false);
    for second in 0..60 {
        rig.run.tick(f64::from(second));
    }
    let snapshot = rig.run.snapshot(60.0);
    assert_eq!(snapshot.robot, Known::Unknown);
    let told: Vec<String> = snapshot.events.iter().map(|event| event.kind.to_string()).collect();
    assert!(told.len() == 1 && told[0].contains("--baud"), "{told:?}");
}

/// What is shown of a robot that is not heard says how old it is, and so does what a program shows that has failed.
#[test]
fn what_is_old_says_how_old_it_is() {
    let age = |rig: &Rig| match rig.run.snapshot(rig.now).robot {
        Known::Stale { age, .. } => Some(age),
        Known::Known(_) | Known::Unknown => None,
    };
    let mut rig = under_way(20.0);
    assert_eq!(age(&rig), None);
    rig.line = Passage::Cut;
    rig.until(4.0, |_| false);
    assert!(age(&rig).is_some_and(|age| (3.8..4.2).contains(&age)), "{:?}", age(&rig));
    let mut rig = under_way(20.0);
    rig.run.broke("the program failed".to_owned());
    assert!(age(&rig).is_some(), "shown as if it were heard");
}
