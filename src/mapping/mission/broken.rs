//! A robot with which it makes no sense to go on: its motions lead nowhere or the other way, its switches or its bumper
//! cannot be believed at all. `idle` and `trust` watch for that; here the run asks both. Knows no phase.

use super::Mission;
use crate::mapping::event::Failure;

impl Mission {
    /// What is wrong with the robot itself so that it makes no sense to go on; what it was said to have touched
    /// by a bumper that stays pressed was nothing.
    pub(super) fn broken(&mut self) -> Option<Failure> {
        if self.idle.is_too_much() {
            return Some(Failure::Unmoved);
        }
        if self.idle.is_contrary() {
            return Some(Failure::Contrary);
        }
        let why = self.trust.ends(&self.going())?;
        if why == Failure::BumperStuck {
            let since = self.trust.free_us();
            if let Some(wall) = self.wall_mut() {
                wall.untouch(since);
            }
        }
        Some(why)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::mapping::mission::{Outcome, Output};
    use crate::mapping::settings::Settings;
    use crate::robot::{DoneReason, Motion, Odometer, SwitchSet, Telemetry};

    /// A robot on an endless floor that does what it is told; what it says of that, `wrong` bends.
    fn driven(wrong: impl Fn(&Motion, &mut Telemetry)) -> (Mission, u32) {
        let mut mission = Mission::new(Settings::new(Pose::new(0.0, 0.0, 0.0)));
        let tick = mission.settings().chassis.tick;
        let mut odometer = Odometer::default();
        for count in 0..2000 {
            let mut out = Vec::new();
            mission.proceed(&mut out);
            let command = out.into_iter().find_map(|output| match output {
                Output::Command(command, _) => Some(command),
                Output::Event(_) => None,
            });
            let Some(command) = command else { return (mission, count) };
            odometer.time_us += 1_000_000;
            let base = mission.settings().chassis.wheel_base;
            let mut after = odometer;
            match command.motion {
                Motion::Move { distance, .. } => {
                    let ticks = (distance / tick).round() as i64;
                    (after.left_ticks, after.right_ticks) =
                        (after.left_ticks + ticks, after.right_ticks + ticks);
                }
                Motion::Turn { angle, .. } => {
                    let ticks = (angle * base / 2.0 / tick).round() as i64;
                    (after.left_ticks, after.right_ticks) =
                        (after.left_ticks - ticks, after.right_ticks + ticks);
                    after.heading += angle;
                }
                Motion::Rest => {}
            }
            let (id, reason) = (command.id, DoneReason::Complete);
            let (switches, bumper) = (SwitchSet::EMPTY, false);
            let mut done = Telemetry::Done { id, reason, odometer: after, switches, bumper };
            wrong(&command.motion, &mut done);
            if let Telemetry::Done { odometer: told, .. } = done {
                odometer = told;
            }
            mission.telemetry(&done, &mut Vec::new());
        }
        (mission, 2000)
    }

    #[test]
    fn switches_that_all_say_closed_on_a_free_floor_end_the_run() {
        let (mission, count) = driven(|_, told| {
            let Telemetry::Done { switches, .. } = told else { return };
            *switches = SwitchSet(0xff);
        });
        assert_eq!(mission.outcome(), Outcome::Failed(Failure::AllShut), "after {count}");
        assert!(count < 10, "after {count} motions");
    }

    #[test]
    fn a_bumper_that_stays_pressed_ends_the_run_and_has_touched_nothing() {
        let (mission, count) = driven(|motion, told| {
            let Telemetry::Done { reason, bumper, odometer, .. } = told else { return };
            *bumper = true;
            if matches!(motion, Motion::Move { distance, .. } if *distance > 0.0) {
                *reason = DoneReason::Bumper;
                // It comes as far as a guard lets it.
                (odometer.left_ticks, odometer.right_ticks) =
                    (odometer.left_ticks - 10, odometer.right_ticks - 10);
            }
        });
        assert_eq!(mission.outcome(), Outcome::Failed(Failure::BumperStuck), "after {count}");
        assert!(count < 300, "after {count} motions");
        assert_eq!(mission.map_now().contacts, [], "touches of nothing are on the map");
        assert_eq!(mission.trust.out(), SwitchSet::EMPTY, "no switch is to blame for it");
    }

    #[test]
    fn a_gyro_that_is_upside_down_ends_the_run() {
        let (mission, count) = driven(|motion, told| {
            let Telemetry::Done { odometer, switches, reason, .. } = told else { return };
            if let Motion::Turn { angle, .. } = motion {
                odometer.heading -= 2.0 * angle;
            } else {
                // There is a wall ahead, or nothing would ever be turned.
                *switches = SwitchSet::only(0);
                *reason = DoneReason::Guard { sensor: 0, rising: true };
            }
        });
        assert_eq!(mission.outcome(), Outcome::Failed(Failure::Contrary), "after {count}");
        assert!(count < 10, "after {count} motions");
    }
}
