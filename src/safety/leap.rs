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
/// Messages are stamped where something happens and not where it is told: so much may one be older than
/// the one before it, seconds.
const BACK: f64 = 1.0;
/// Beyond this, numbers are no longer counted one by one: 2^53.
const COUNTABLE: f64 = 9_007_199_254_740_992.0;

/// Counters of so many values come round: those of 32 and of 16 bits.
const ROUNDS: [i64; 2] = [1 << 32, 1 << 16];

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
    /// The robot's clock went back.
    #[error(
        "the robot's clock went back by {seconds:.0} s; it must be 64 bits wide, and never begin anew"
    )]
    Back {
        /// Seconds of robot time.
        seconds: f64,
    },
    /// A number that is none.
    #[error("the robot counted so far that single ticks are lost")]
    Uncountable,
}

impl Leap {
    /// Seconds of robot time in which a robot that cannot be believed may have driven.
    fn seconds(&self) -> f64 {
        match self {
            Self::Wheel { seconds, .. } | Self::Gyro { seconds, .. } => *seconds,
            Self::Clock { .. } | Self::Back { .. } | Self::Uncountable => 0.0,
        }
    }
}

/// Holds every message against the last one that was believed.
#[derive(Debug, Clone)]
pub struct Watch {
    tick: f64,
    wheel: f64,
    turn: f64,
    /// What the last message that was believed counted.
    last: Option<Odometer>,
    /// Seconds of robot time from then to the first one that was not; none while all are believed. A robot
    /// that is not believed is stopped: no patience makes a way of what it counted.
    doubted: Option<f64>,
    /// After so many values the encoders' counters begin anew, once they have been seen to.
    round: Option<i64>,
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
            doubted: None,
            round: None,
        }
    }

    /// Takes a message into account, if the robot can have got there from the last one that was; gives it
    /// back with the wheels counted on where their counters came round. After one that was not, the robot
    /// must count on from where it was believed to be, however long that takes.
    ///
    /// # Errors
    /// What it cannot have done.
    pub fn admit(&mut self, told: &Telemetry) -> Result<Telemetry, Leap> {
        let believed = self.counted(*told);
        self.doubted = match &believed {
            Ok(_) => None,
            Err(leap) => self.doubted.or(Some(leap.seconds())),
        };
        believed
    }

    fn counted(&mut self, mut told: Telemetry) -> Result<Telemetry, Leap> {
        let odometer = match &mut told {
            Telemetry::Report { odometer, .. } | Telemetry::Done { odometer, .. } => odometer,
            Telemetry::Edge(edge) => &mut edge.odometer,
        };
        countable(odometer)?;
        if let Some(round) = self.round {
            *odometer = self.counted_on(odometer, round);
        }
        if let Err(leap) = self.judge(odometer) {
            let came_round = |round: &i64| self.judge(&self.counted_on(odometer, *round)).is_ok();
            let near = |round: &i64| self.farthest(odometer) < round + round / 4;
            let round = ROUNDS.into_iter().filter(near).find(came_round).ok_or(leap)?;
            *odometer = self.counted_on(odometer, round);
            self.round = Some(round);
        }
        self.last = Some(*odometer);
        Ok(told)
    }

    /// Ticks that the wheel which went farther has counted since the last message.
    fn farthest(&self, to: &Odometer) -> i64 {
        self.last.map_or(0, |last| {
            let (left, right) =
                (to.left_ticks - last.left_ticks, to.right_ticks - last.right_ticks);
            left.abs().max(right.abs())
        })
    }

    /// The same reading of wheels whose counters begin anew after `round` values.
    fn counted_on(&self, to: &Odometer, round: i64) -> Odometer {
        let Some(last) = self.last else { return *to };
        let on = |last: i64, to: i64| last + (to - last + round / 2).rem_euclid(round) - round / 2;
        Odometer {
            left_ticks: on(last.left_ticks, to.left_ticks),
            right_ticks: on(last.right_ticks, to.right_ticks),
            ..*to
        }
    }

    fn judge(&self, to: &Odometer) -> Result<(), Leap> {
        let Some(last) = &self.last else { return Ok(()) };
        let back = last.time_us.saturating_sub(to.time_us) as f64 * 1e-6;
        if back > BACK {
            return Err(Leap::Back { seconds: back });
        }
        let seconds = to.time_us.saturating_sub(last.time_us) as f64 * 1e-6;
        if seconds > YEAR {
            return Err(Leap::Clock { seconds });
        }
        let seconds = self.doubted.unwrap_or(seconds);
        let metres = self.farthest(to) as f64 * self.tick;
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

/// Whether all numbers are some, and small enough to be counted with.
fn countable(to: &Odometer) -> Result<(), Leap> {
    let counts = [to.time_us as f64, to.left_ticks as f64, to.right_ticks as f64, to.heading * 1e6];
    let countable = counts.iter().all(|count| count.abs() < COUNTABLE);
    if countable { Ok(()) } else { Err(Leap::Uncountable) }
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
        assert_eq!(
            watch.admit(&report(1_000_000, far, -far, 5e4)),
            Ok(report(1_000_000, far, -far, 5e4))
        );
        // Full speed for a second, a turn on the spot, and a rest of an hour.
        assert_eq!(
            watch.admit(&report(2_000_000, far + 400, 400 - far, 5e4)),
            Ok(report(2_000_000, far + 400, 400 - far, 5e4))
        );
        assert_eq!(
            watch.admit(&report(3_000_000, far, 800 - far, 5e4 + 2.0)),
            Ok(report(3_000_000, far, 800 - far, 5e4 + 2.0))
        );
        assert_eq!(
            watch.admit(&report(3_603_000_000, far, 800 - far, 5e4 + 2.0)),
            Ok(report(3_603_000_000, far, 800 - far, 5e4 + 2.0))
        );
    }

    #[test]
    fn what_no_robot_can_drive_is_a_fault_and_what_comes_after_it_is_not() {
        let mut watch = Watch::new(&Chassis::default());
        assert_eq!(watch.admit(&report(0, 0, 0, 0.0)), Ok(report(0, 0, 0, 0.0)));
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
        assert_eq!(watch.admit(&report(200_000, 40, 40, 0.0)), Ok(report(200_000, 40, 40, 0.0)));
    }

    #[test]
    fn a_clock_that_goes_back_is_a_fault_until_it_has_made_up_for_it() {
        let mut watch = Watch::new(&Chassis::default());
        let round = 1 << 32;
        assert!(watch.admit(&report(round - 100_000, 0, 0, 0.0)).is_ok());
        for time in [0, 100_000, 3_600_000_000] {
            let told = watch.admit(&report(time, 0, 0, 0.0));
            assert!(matches!(told, Err(Leap::Back { .. })), "{time}: {told:?}");
        }
        // An edge that is told after a report that was made a little later.
        assert!(watch.admit(&report(round - 120_000, 0, 0, 0.0)).is_ok());
        assert!(watch.admit(&report(round, 0, 0, 0.0)).is_ok());
    }

    /// Full speed ahead with counters of 16 and of 32 bits, with a sign and without one.
    #[test]
    fn a_counter_that_comes_round_is_counted_on() {
        type Cut = fn(i64) -> i64;
        let cuts: [Cut; 4] = [
            |ticks| i64::from(ticks as i16),
            |ticks| i64::from(ticks as u16),
            |ticks| i64::from(ticks as i32),
            |ticks| i64::from(ticks as u32),
        ];
        for cut in cuts {
            for from in [0, 32_000, 65_000, 2_147_483_000, 4_294_967_000] {
                let mut watch = Watch::new(&Chassis::default());
                let mut first = None;
                for k in 0..5000 {
                    let (left, right) = (from + 40 * k, from - 40 * k);
                    let raw = report(k as u64 * 100_000, cut(left), cut(right), 0.0);
                    let told = watch.admit(&raw).expect("no leap");
                    let Telemetry::Report { odometer, .. } = told else { panic!("a report") };
                    let counted = (odometer.left_ticks, odometer.right_ticks);
                    let first = first.get_or_insert(counted);
                    assert_eq!(counted, (first.0 + 40 * k, first.1 - 40 * k), "{from}, {k}");
                }
            }
        }
    }
}
