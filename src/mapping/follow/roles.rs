//! Which switch does what for a wall on one hand.

use super::Side;
use crate::robot::{Chassis, SwitchSet};

/// The roles that switches play for a wall on one hand.
#[derive(Debug, Clone, Copy)]
pub(super) struct Roles {
    pub(super) front: Option<usize>,
    pub(super) ahead: Option<usize>,
    pub(super) wall: Option<usize>,
    pub(super) off: Option<usize>,
    pub(super) across: Option<usize>,
    pub(super) back: Option<usize>,
}

/// A switch plays a role when it points no farther off than this, radians: of ten switches the one abeam of the
/// wall is 18 degrees off, and a robot without any at its sides takes gaps that it cannot see for passable.
const TOLERANCE: f64 = 0.35;
/// Of two that are equally far off, abeam of the wall the one farther back is taken, which sees it end when the
/// robot is past it, and elsewhere the one farther ahead, degrees.
const LEANING: f64 = 1.0;

impl Roles {
    pub(super) fn new(chassis: &Chassis, side: Side) -> Self {
        let towards =
            |degrees: f64| chassis.sensor_towards(side.sign() * degrees.to_radians(), TOLERANCE);
        Self {
            front: towards(0.0),
            ahead: towards(45.0 - LEANING),
            wall: towards(90.0 + LEANING),
            off: towards(-45.0 + LEANING),
            across: towards(-90.0 + LEANING),
            back: towards(180.0),
        }
    }

    pub(super) fn set(switches: &[Option<usize>]) -> SwitchSet {
        switches.iter().flatten().fold(SwitchSet::EMPTY, |set, &index| set.with(index, true))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the switches of the roles ahead, wall, off and across point, degrees towards the wall, of a robot
    /// with so many, the wall on `side`.
    fn pointing(count: usize, side: Side) -> [Option<i32>; 4] {
        let chassis = Chassis::with_switches(count);
        let roles = Roles::new(&chassis, side);
        [roles.ahead, roles.wall, roles.off, roles.across].map(|role| {
            role.map(|index| {
                (chassis.sensors[index].angle.to_degrees() * side.sign()).round() as i32
            })
        })
    }

    #[test]
    fn robots_with_other_switches_than_ours_play_the_same_roles_on_either_hand() {
        for side in [Side::Left, Side::Right] {
            for count in [8, 16] {
                assert_eq!(pointing(count, side), [45, 90, -45, -90].map(Some), "{count}");
            }
            assert_eq!(pointing(10, side), [36, 108, -36, -72].map(Some));
            assert_eq!(pointing(12, side), [30, 90, -30, -90].map(Some));
            assert_eq!(pointing(6, side), [Some(60), None, Some(-60), None]);
            assert_eq!(pointing(4, side), [None, Some(90), None, Some(-90)]);
        }
    }
}
