//! What a robot's body can be. Whoever says so, a file, a robot or a record: it is held against the same
//! bounds, so that a robot that can be driven has a record that can be played back.

use super::Chassis;
use crate::geometry::angle;
use std::ops::RangeInclusive;

/// How many switches a robot may have.
pub const SWITCHES: RangeInclusive<usize> = 4..=16;

/// Letters of the longest name of a switch.
const LONGEST_NAME: usize = 100;

/// Whole units of the wire protocol may lie this share outside of the bounds.
const ROUNDING: f64 = 0.03;

/// One measure of a body, as a chassis file writes it, and between which limits it makes sense there:
/// metres and seconds, degrees for angles.
#[derive(Debug, Clone, Copy)]
pub struct Measure {
    /// Its key.
    pub name: &'static str,
    /// The least that it may be.
    pub low: f64,
    /// The most.
    pub high: f64,
    /// What it counts, for complaints.
    pub unit: &'static str,
    /// Whether the file counts it in degrees, and the chassis in radians.
    pub degrees: bool,
    /// Where it belongs.
    pub of: fn(&mut Chassis) -> &mut f64,
}

const fn plain(
    name: &'static str,
    (low, high, unit): (f64, f64, &'static str),
    of: fn(&mut Chassis) -> &mut f64,
) -> Measure {
    Measure { name, low, high, unit, degrees: false, of }
}

const fn degrees(
    name: &'static str,
    (low, high, unit): (f64, f64, &'static str),
    of: fn(&mut Chassis) -> &mut f64,
) -> Measure {
    Measure { name, low, high, unit, degrees: true, of }
}

/// The measures of a body. No robot turns as slowly as a file says that means radians a second.
pub const MEASURES: [Measure; 9] = [
    plain("radius", (0.01, 1.0, "metres"), |chassis| &mut chassis.radius),
    plain("wheel_base", (0.01, 2.0, "metres"), |chassis| &mut chassis.wheel_base),
    plain("tick", (1e-6, 0.02, "metres"), |chassis| &mut chassis.tick),
    plain("range", (0.005, 1.0, "metres"), |chassis| &mut chassis.range),
    plain("hysteresis", (0.0, 0.1, "metres"), |chassis| &mut chassis.hysteresis),
    plain("speed", (0.01, 2.0, "metres a second"), |chassis| &mut chassis.speed),
    degrees("turn_rate", (10.0, 720.0, "degrees a second"), |chassis| &mut chassis.turn_rate),
    plain("acceleration", (0.05, 20.0, "metres a second squared"), |chassis| {
        &mut chassis.acceleration
    }),
    degrees("bumper_half_angle", (0.0, 180.0, "degrees"), |chassis| &mut chassis.bumper_half_angle),
];

/// What no robot's body can be.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// A measure beyond its limits, in the units of a chassis file.
    #[error("{name} of {} is not between {low} and {high} {unit}", rounded(*.value))]
    Measure {
        /// Its key.
        name: &'static str,
        /// What it was said to be.
        value: f64,
        /// The least that it may be.
        low: f64,
        /// The most.
        high: f64,
        /// What all three count.
        unit: &'static str,
    },
    /// Too few switches to follow a wall with, or more than a set can hold.
    #[error("{count} switches, and a robot has from {} to {}", SWITCHES.start(), SWITCHES.end())]
    Switches {
        /// How many were announced.
        count: usize,
    },
    /// A switch that would never open again near where it closed.
    #[error("hysteresis of {hysteresis} m is larger than the range of {range} m")]
    Hysteresis {
        /// Metres.
        hysteresis: f64,
        /// Metres.
        range: f64,
    },
    /// A switch that points nowhere, or whose name fits on no screen.
    #[error(
        "switch {index} has no angle within a turn, or a name of more than {LONGEST_NAME} letters"
    )]
    Switch {
        /// Which one.
        index: usize,
    },
}

/// What radians make of a round number of degrees is told as that.
fn rounded(value: f64) -> f64 {
    let near = (value * 1e6).round() / 1e6;
    if (near - value).abs() < 1e-9 { near } else { value }
}

impl Chassis {
    /// Whether a robot can have this body.
    ///
    /// # Errors
    /// Says what it cannot have.
    pub fn check(&self) -> Result<(), Unfit> {
        self.check_measures()?;
        let count = self.sensors.len();
        if !SWITCHES.contains(&count) {
            return Err(Unfit::Switches { count });
        }
        let unfit = self.sensors.iter().position(|mount| {
            let within = mount.angle.abs() <= angle::TAU;
            !within || mount.name.chars().count() > LONGEST_NAME
        });
        unfit.map_or(Ok(()), |index| Err(Unfit::Switch { index }))
    }

    /// The same for everything but the switches, which a robot tells one by one.
    ///
    /// # Errors
    /// As [`Chassis::check`].
    pub fn check_measures(&self) -> Result<(), Unfit> {
        let mut body = Self { sensors: Vec::new(), ..*self };
        for Measure { name, low, high, unit, degrees, of } in MEASURES {
            let value = *of(&mut body);
            let value = if degrees { value.to_degrees() } else { value };
            let limits = low - low * ROUNDING..=high + high * ROUNDING;
            if !limits.contains(&value) {
                return Err(Unfit::Measure { name, value, low, high, unit });
            }
        }
        let (hysteresis, range) = (self.hysteresis, self.range);
        if hysteresis > range * (1.0 + ROUNDING) {
            return Err(Unfit::Hysteresis { hysteresis, range });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_robots_are_within_the_bounds() {
        for count in SWITCHES {
            assert_eq!(Chassis::with_switches(count).check(), Ok(()), "{count} switches");
        }
        for count in [0, 3, 17] {
            let sensors = vec![Chassis::default().sensors[0].clone(); count];
            let chassis = Chassis { sensors, ..Chassis::default() };
            assert_eq!(chassis.check(), Err(Unfit::Switches { count }));
        }
    }

    /// Whoever thinks in radians is not left with a robot that turns for a minute.
    #[test]
    fn a_bound_is_told_with_its_unit() {
        let slow = Chassis { turn_rate: 1.5_f64.to_radians(), ..Chassis::default() };
        let told = slow.check().expect_err("1.5 degrees a second").to_string();
        assert_eq!(told, "turn_rate of 1.5 is not between 10 and 720 degrees a second");
        let wide = Chassis { radius: 3.0, ..Chassis::default() };
        let told = wide.check().expect_err("3 m").to_string();
        assert_eq!(told, "radius of 3 is not between 0.01 and 1 metres");
    }

    #[test]
    fn a_body_that_no_robot_has_is_refused() {
        let usual = Chassis::default;
        let bodies = [
            Chassis { tick: 1e308, ..usual() },
            Chassis { tick: 0.0, ..usual() },
            Chassis { radius: -1.0, ..usual() },
            Chassis { speed: f64::NAN, ..usual() },
            Chassis { hysteresis: 0.08, ..usual() },
        ];
        for body in bodies {
            assert!(body.check().is_err(), "{body:?}");
        }
        let mut astray = usual();
        astray.sensors[2].angle = 1e300;
        assert_eq!(astray.check(), Err(Unfit::Switch { index: 2 }));
    }
}
