//! What no robot can have done between two messages: an encoder, a clock or a line at fault, told before
//! the mapping core takes it for a way that was driven. The bounds are wide: wheels may slip, and a robot
//! may be pushed; they keep out what would never end to be reckoned with.

use crate::robot::{Chassis, Odometer, Telemetry};

/// A robot is believed to go so many times as fast as its chassis says.
const GENEROUS: f64 = 5.0;
/// Metres and radians beyond that, whatever the time.
const METRES: f64 = 1.0;
const RADIANS: f64 = 20.0;
/// A silent robot stops by itself; what happens in a longer silence is no longer driving, seconds.
const LONGEST: f64 = 60.0;
/// A robot that is silent for longer than a year was another one, seconds.
const YEAR: f64 = 3.2e7;
/// Beyond this, numbers are no longer counted one by one: 2^53.
const COUNTABLE: f64 = 9_007_199_254_740_992.0;

/// What no robot can have done.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Leap {
    /// A wheel came too far.
    #[error("a wheel counted {metres:.0} m in {seconds:.2} s, which no robot can drive")]
    Wheel {
        /// Metres that it went.
        metres: f64,
        /// In so many seconds of robot time.
        seconds: f64,
    },
    /// The gyro came too far.
    #[error("the gyro counted {radians:.0} radians in {seconds:.2} s, which no robot can turn")]
    Gyro {
        /// Radians that it turned.
        radians: f64,
        /// In so many seconds of robot time.
        seconds: f64,
    },
    /// The robot's clock cannot be right.
    #[error("the robot's clock went on by {seconds:.0} s from one message to the next")]
    Clock {
        /// Seconds of robot time.
        seconds: f64,
    },
    /// A number that is none.
    #[error("the robot counted so far that single ticks are lost")]
    Uncountable,
}

/// Holds every message against the one before it.
#[derive(Debug, Clone)]
pub struct Watch {
    tick: f64,
    wheel: f64,
    turn: f64,
    last: Option<Odometer>,
}

impl Watch {
    /// Over a robot with `chassis`.
    #[must_use]
    pub fn new(chassis: &Chassis) -> Self {
        Self {
            tick: chassis.tick,
            wheel: GENEROUS * (chassis.speed + chassis.turn_rate * chassis.wheel_base / 2.0),
            turn: GENEROUS * chassis.turn_rate,
            last: None,
        }
    }

    /// Takes a message into account, if the robot can have got there from the last one that was.
    ///
    /// # Errors
    /// What it cannot have done.
    pub fn admit(&mut self, told: &Telemetry) -> Result<(), Leap> {
        let odometer = match told {
            Telemetry::Report { odometer, .. } | Telemetry::Done { odometer, .. } => *odometer,
            Telemetry::Edge(edge) => edge.odometer,
        };
        self.judge(&odometer)?;
        self.last = Some(odometer);
        Ok(())
    }

    fn judge(&self, to: &Odometer) -> Result<(), Leap> {
        let counts = [to.time_us as f64, to.left_ticks as f64, to.right_ticks as f64];
        // The other way round what is no number would pass.
        let countable = counts.iter().all(|count| count.abs() < COUNTABLE)
            && to.heading.abs() * 1e6 < COUNTABLE;
        if !countable {
            return Err(Leap::Uncountable);
        }
        let Some(last) = &self.last else { return Ok(()) };
        let seconds = to.time_us.saturating_sub(last.time_us) as f64 * 1e-6;
        if seconds > YEAR {
            return Err(Leap::Clock { seconds });
        }
        let ticks = (to.left_ticks - last.left_ticks).abs();
        let metres = ticks.max((to.right_ticks - last.right_ticks).abs()) as f64 * self.tick;
        let radians = (to.heading - last.heading).abs();
        if metres > METRES + self.wheel * seconds.min(LONGEST) {
            return Err(Leap::Wheel { metres, seconds });
        }
        if radians > RADIANS + self.turn * seconds.min(LONGEST) {
            return Err(Leap::Gyro { radians, seconds });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::SwitchSet;

    fn report(time_us: u64, left_ticks: i64, right_ticks: i64, heading: f64) -> Telemetry {
        let odometer = Odometer { time_us, left_ticks, right_ticks, heading };
        Telemetry::Report { odometer, switches: SwitchSet::EMPTY, bumper: false }
    }

    #[test]
    fn what_a_robot_can_drive_passes_wherever_it_counts_from() {
        let mut watch = Watch::new(&Chassis::default());
        let far = 4_294_967_295;
        assert_eq!(watch.admit(&report(1_000_000, far, -far, 5e4)), Ok(()));
        // Full speed for a second, a turn on the spot, and a rest of an hour.
        assert_eq!(watch.admit(&report(2_000_000, far + 400, 400 - far, 5e4)), Ok(()));
        assert_eq!(watch.admit(&report(3_000_000, far, 800 - far, 5e4 + 2.0)), Ok(()));
        assert_eq!(watch.admit(&report(3_603_000_000, far, 800 - far, 5e4 + 2.0)), Ok(()));
    }

    #[test]
    fn what_no_robot_can_drive_is_a_fault_and_what_comes_after_it_is_not() {
        let mut watch = Watch::new(&Chassis::default());
        assert_eq!(watch.admit(&report(0, 0, 0, 0.0)), Ok(()));
        for far in [900_000_000_000_000, -900_000_000_000_000, 40_000] {
            let told = watch.admit(&report(100_000, far, 0, 0.0));
            assert!(matches!(told, Err(Leap::Wheel { .. })), "{far}: {told:?}");
        }
        for wild in [i64::MIN, i64::MAX] {
            assert_eq!(watch.admit(&report(100_000, 0, wild, 0.0)), Err(Leap::Uncountable));
        }
        let told = watch.admit(&report(100_000, 0, 0, 1e6));
        assert!(matches!(told, Err(Leap::Gyro { .. })), "{told:?}");
        assert_eq!(watch.admit(&report(100_000, 0, 0, f64::NAN)), Err(Leap::Uncountable));
        let told = watch.admit(&report(1 << 52, 0, 0, 0.0));
        assert!(matches!(told, Err(Leap::Clock { .. })), "{told:?}");
        // A long silence is no excuse.
        let told = watch.admit(&report(3_600_000_000, 1_000_000, 1_000_000, 0.0));
        assert!(matches!(told, Err(Leap::Wheel { .. })), "{told:?}");
        assert_eq!(watch.admit(&report(200_000, 40, 40, 0.0)), Ok(()));
    }
}
