//! Motions that lead nowhere. The phases ask again for what is not done yet; a robot whose wheel is blocked, or
//! that does not turn by as little as it is asked to, would be asked for ever. And motions that led the other way: a
//! gyro that is mounted upside down. Knows motions and what wheels and gyro read, not what they were asked for.

use crate::mapping::network::Reading;
use crate::robot::{DoneReason, Motion};

/// Less than this share of what was asked for is nothing, ...
const SHARE: f64 = 0.1;
/// ... unless it is as far as this all the same, metres and radians.
const FAR: (f64, f64) = (0.005, 0.05);
/// So many in a row are no accident.
pub(super) const MOST: u32 = 20;

/// What goes so far the wrong way, as a share of what was asked for and in metres and radians, is no accident: ...
const BACK: f64 = 0.5;
const AWAY: (f64, f64) = (0.02, 0.2);
/// ... not when it happens so often in a row.
const CONTRARY: u32 = 2;

/// Counts them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Idle {
    /// In a row so far.
    count: u32,
    /// Of those that led the other way.
    contrary: u32,
    /// What is under way, and what wheels and gyro read when it was asked for.
    asked: Option<(Motion, Reading)>,
}

impl Idle {
    /// `motion` is asked for.
    pub(super) fn asked(&mut self, motion: Motion, reading: Reading) {
        self.asked = Some((motion, reading));
    }

    /// What was asked for ended, for a `reason`. Only what the robot calls done, or took all of its time for,
    /// is expected to lead somewhere; what does is the end of the row.
    pub(super) fn ended(&mut self, reason: DoneReason, reading: Reading) {
        let Some((motion, from)) = self.asked.take() else { return };
        let (went, all, (far, away)) = match motion {
            Motion::Move { distance, .. } => {
                (reading.ahead - from.ahead, distance, (FAR.0, AWAY.0))
            }
            Motion::Turn { angle, .. } => (reading.turned - from.turned, angle, (FAR.1, AWAY.1)),
            Motion::Rest => return,
        };
        if went * all < 0.0 && went.abs() > away.max(BACK * all.abs()) {
            self.contrary += 1;
        } else if reason == DoneReason::Complete && went.abs() > away {
            self.contrary = 0;
        }
        if went.abs() >= far.min(SHARE * all.abs()) {
            self.count = 0;
        } else if matches!(reason, DoneReason::Complete | DoneReason::TimeLimit) {
            self.count += 1;
        }
    }

    /// Whether the robot counts the other way.
    pub(super) fn is_contrary(&self) -> bool {
        self.contrary >= CONTRARY
    }

    /// Whether it makes no sense to ask for more.
    pub(super) fn is_too_much(&self) -> bool {
        self.count >= MOST
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::mapping::event::Failure;
    use crate::mapping::mission::{Mission, Outcome, Output};
    use crate::mapping::settings::Settings;
    use crate::robot::{Odometer, SwitchSet, Telemetry};

    /// A robot that says of every motion that it ended, for a `reason`, and does not move: how often it is
    /// asked, and how that ends.
    fn asked(reason: DoneReason) -> (u32, Outcome) {
        let mut mission = Mission::new(Settings::new(Pose::new(0.0, 0.0, 0.0)));
        let (switches, bumper) = (SwitchSet::EMPTY, false);
        for count in 0..500 {
            let mut out = Vec::new();
            mission.proceed(&mut out);
            let command = out.into_iter().find_map(|output| match output {
                Output::Command(command, _) => Some(command),
                Output::Event(_) => None,
            });
            let Some(command) = command else { return (count, mission.outcome()) };
            let time_us = u64::from(count + 1) * 1_000_000;
            let odometer = Odometer { time_us, ..Odometer::default() };
            let done = Telemetry::Done { id: command.id, reason, odometer, switches, bumper };
            mission.telemetry(&done, &mut Vec::new());
        }
        (500, mission.outcome())
    }

    #[test]
    fn a_robot_that_does_not_move_is_not_asked_for_ever() {
        for reason in [DoneReason::Complete, DoneReason::TimeLimit] {
            let (count, outcome) = asked(reason);
            assert_eq!((count, outcome), (MOST, Outcome::Failed(Failure::Unmoved)), "{reason:?}");
        }
    }

    #[test]
    fn a_robot_that_counts_the_other_way_is_found_out_and_a_bent_motion_is_not() {
        let (turn, step) =
            (Motion::Turn { angle: -1.2, rate: 1.0 }, Motion::Move { distance: 0.25, speed: 0.2 });
        let at = |ahead: f64, turned: f64| Reading { ahead, turned, ..Reading::default() };
        for (motion, to) in [(turn, at(0.0, 1.2)), (step, at(-0.25, 0.0))] {
            let mut idle = Idle::default();
            for k in 0..CONTRARY {
                assert!(!idle.is_contrary(), "after {k}");
                idle.asked(motion, at(0.0, 0.0));
                idle.ended(DoneReason::Complete, to);
            }
            assert!(idle.is_contrary(), "{motion:?}");
        }
        // A bump turns it back, the wheels of one that stands settle by a tick, and one contrary motion is none.
        let mut idle = Idle::default();
        for _ in 0..100 {
            for (to, reason) in [
                (at(0.0, 0.15), DoneReason::Bumper),
                (at(-0.001, 0.0), DoneReason::Complete),
                (at(0.0, 1.0), DoneReason::Bumper),
                (at(0.0, -1.2), DoneReason::Complete),
            ] {
                idle.asked(turn, at(0.0, 0.0));
                idle.ended(reason, to);
                assert!(!idle.is_contrary());
            }
        }
    }

    #[test]
    fn a_robot_that_is_at_no_place_is_not_sent_anywhere() {
        let mut mission = Mission::new(Settings::new(Pose::new(0.0, f64::NAN, 0.0)));
        let mut out = Vec::new();
        mission.proceed(&mut out);
        assert!(!out.iter().any(|output| matches!(output, Output::Command(..))));
        assert_eq!(mission.outcome(), Outcome::Failed(Failure::Internal));
    }

    #[test]
    fn what_leads_somewhere_or_is_ended_by_something_is_none_of_it() {
        let turn = Motion::Turn { angle: 0.02, rate: 1.0 };
        let at = |turned: f64| Reading { turned, ..Reading::default() };
        let mut idle = Idle::default();
        for k in 0..MOST * 10 {
            idle.asked(turn, at(1.0));
            let moved = if k % MOST == MOST - 1 { 0.003 } else { 0.0 };
            idle.ended(DoneReason::Complete, at(1.0 + moved));
            assert!(!idle.is_too_much(), "after {k}");
        }
        let guard = DoneReason::Guard { sensor: 1, rising: true };
        let others = [guard, DoneReason::Bumper, DoneReason::Stalled, DoneReason::Stopped];
        for reason in others.into_iter().cycle().take(1000) {
            idle.asked(turn, at(1.0));
            idle.ended(reason, at(1.0));
        }
        assert!(!idle.is_too_much());
    }
}
