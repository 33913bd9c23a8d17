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

impl Roles {
    pub(super) fn new(chassis: &Chassis, side: Side) -> Self {
        let towards =
            |degrees: f64| chassis.sensor_towards(side.sign() * degrees.to_radians(), 0.3);
        Self {
            front: towards(0.0),
            ahead: towards(45.0),
            wall: towards(90.0),
            off: towards(-45.0),
            across: towards(-90.0),
            back: towards(180.0),
        }
    }

    pub(super) fn set(switches: &[Option<usize>]) -> SwitchSet {
        switches.iter().flatten().fold(SwitchSet::EMPTY, |set, &index| set.with(index, true))
    }
}
