//! The robot's body: size, wheels, where its switches point and how far they reach.

use crate::geometry::angle;
use serde::{Deserialize, Serialize};

/// A set of proximity switches, one bit each, numbered as in [`Chassis::sensors`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SwitchSet(pub u16);

impl SwitchSet {
    /// No switch at all.
    pub const EMPTY: Self = Self(0);

    /// The set that holds only switch `index`; nothing where no set can hold it.
    #[must_use]
    pub fn only(index: usize) -> Self {
        let bit = u32::try_from(index).ok().and_then(|index| 1_u16.checked_shl(index));
        Self(bit.unwrap_or(0))
    }

    /// Whether switch `index` is in the set.
    #[must_use]
    pub fn has(self, index: usize) -> bool {
        self.0 & Self::only(index).0 != 0
    }

    /// This set with switch `index` in it or not.
    #[must_use]
    pub fn with(self, index: usize, on: bool) -> Self {
        let bit = Self::only(index).0;
        Self(if on { self.0 | bit } else { self.0 & !bit })
    }

    /// Everything in either set.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether nothing is in the set.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Indices of the switches in the set, ascending.
    pub fn iter(self) -> impl Iterator<Item = usize> {
        (0..16).filter(move |&index| self.has(index))
    }
}

/// One infrared proximity switch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorMount {
    /// What the screen calls it: "front", "left", "front left" and so on.
    pub name: String,
    /// Direction of the beam from the robot's centre, radians counter-clockwise from ahead. The
    /// beam starts where it leaves the body.
    pub angle: f64,
}

/// From something coming into reach until the robot brakes, seconds: a firmware that looks fifty times a second sees
/// it up to a step later, and begins to brake in the next.
const REACTION: f64 = 0.03;

/// The robot's body, wheels and switches. The default is the robot of the design: a disc of
/// 0.10 m radius with eight switches of 0.06 m range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chassis {
    /// Radius of the body, metres.
    pub radius: f64,
    /// Distance between the two wheels' tracks, metres.
    pub wheel_base: f64,
    /// Travel of a wheel per encoder tick, metres.
    pub tick: f64,
    /// d: a switch closes when something is within this of the body along its beam, metres.
    pub range: f64,
    /// A closed switch opens again only at `range + hysteresis`, metres.
    pub hysteresis: f64,
    /// Speed of a move, metres per second.
    pub speed: f64,
    /// Rate of a turn, radians per second.
    pub turn_rate: f64,
    /// How fast speed may change, metres per second squared, at the wheel.
    pub acceleration: f64,
    /// The bumper covers this angle to either side of ahead, radians.
    pub bumper_half_angle: f64,
    /// The switches, in the order their bits have in a [`SwitchSet`]; at most 16.
    pub sensors: Vec<SensorMount>,
}

impl Chassis {
    /// By how much a strait is narrower than the swath, metres.
    pub const STRAIT_MARGIN: f64 = 0.02;

    /// The default robot with `count` switches evenly round the body, the first straight ahead;
    /// four or eight get their usual names.
    #[must_use]
    pub fn with_switches(count: usize) -> Self {
        const NAMES: [&str; 8] = [
            "front",
            "front left",
            "left",
            "back left",
            "back",
            "back right",
            "right",
            "front right",
        ];
        let sensors = (0..count)
            .map(|k| SensorMount {
                name: if 8 % count == 0 {
                    NAMES[k * 8 / count].to_owned()
                } else {
                    format!("switch {k}")
                },
                angle: angle::wrap(angle::TAU * k as f64 / count as f64),
            })
            .collect();
        Self {
            radius: 0.10,
            wheel_base: 0.16,
            tick: 0.0005,
            range: 0.06,
            hysteresis: 0.005,
            speed: 0.2,
            turn_rate: 2.0,
            acceleration: 1.0,
            bumper_half_angle: angle::FRAC_PI_2,
            sensors,
        }
    }

    /// Distance from the centre at which a switch closes: r + d, metres.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.radius + self.range
    }

    /// How far the robot still goes once a switch has closed, from `speed` (metres per second), until it stands:
    /// v·t + v²/2a, t the 30 ms until it brakes and a its acceleration, metres.
    #[must_use]
    pub fn stopping(&self, speed: f64) -> f64 {
        speed * REACTION + speed * speed / (2.0 * self.acceleration)
    }

    /// The speed that it is sent with: its own, or the one from which it stands within half of what its switches
    /// see, whichever is less, metres per second. A robot that stands later than that slides along the walls it
    /// meets, and what a switch tells after a slide is told of another place.
    #[must_use]
    pub fn cruise(&self) -> f64 {
        let most = self.range / 2.0;
        let brake = self.acceleration;
        // The positive root of stopping(v) = most.
        self.speed.min(brake * ((REACTION * REACTION + 2.0 * most / brake).sqrt() - REACTION))
    }

    /// Width swept by body plus sensors: 2(r + d), metres.
    #[must_use]
    pub fn swath(&self) -> f64 {
        2.0 * self.reach()
    }

    /// The narrowest gap the robot is sent through: 2(r + d) + 20 mm, metres.
    #[must_use]
    pub fn passable_gap(&self) -> f64 {
        self.swath() + 0.02
    }

    /// The map ends at anything narrower that has a room behind it: 2(r + d) less [`STRAIT_MARGIN`](Self::STRAIT_MARGIN), metres. The follower gets
    /// through some of these and not through others; from 2(r + d) + 10 mm on through all, and between the map tells
    /// what it did, since the width of a gap is known to no more than a centimetre.
    #[must_use]
    pub fn strait(&self) -> f64 {
        self.swath() - Self::STRAIT_MARGIN
    }

    /// The switch whose beam points nearest to `angle` (radians from ahead), if one is within
    /// `tolerance` of it.
    #[must_use]
    pub fn sensor_towards(&self, angle: f64, tolerance: f64) -> Option<usize> {
        let off = |mount: &SensorMount| angle::wrap(mount.angle - angle).abs();
        let index = (0..self.sensors.len())
            .min_by(|&a, &b| off(&self.sensors[a]).total_cmp(&off(&self.sensors[b])))?;
        (off(&self.sensors[index]) <= tolerance).then_some(index)
    }
}

impl Default for Chassis {
    fn default() -> Self {
        Self::with_switches(8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_its_cruise_it_stands_within_half_of_what_its_switches_see() {
        let weak = Chassis { speed: 0.3, acceleration: 0.4, ..Chassis::default() };
        let cruise = weak.cruise();
        assert!(
            cruise < 0.3 && (weak.stopping(cruise) - weak.range / 2.0).abs() < 1e-12,
            "{cruise}"
        );
        // Ours is quick to stand: it goes as fast as it can.
        let ours = Chassis::default();
        assert!(ours.stopping(ours.speed) < ours.range / 2.0);
        assert!((ours.cruise() - ours.speed).abs() < 1e-12);
    }
}
