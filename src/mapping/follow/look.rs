//! The follower's look: a swing towards the wall until the switch that looks ahead closes, and what it
//! tells of where the wall goes on. Where to go then, the follower decides.

use super::roles::Roles;
use super::{Ask, AtRest, Doing, Follower, LONGEST_STRIDE, SHORTEST_STRIDE, Sweep, Wall};
use crate::geometry::{Point, Vector, angle};
use crate::robot::{DoneReason, Guard};

/// What is seen beyond a tip lies this far past it at least, metres.
const PAST_TIP: f64 = 0.02;
/// A wall that a look finds where it was believed to go on, within this, metres, ...
const AS_BELIEVED: f64 = 0.008;
/// ... is followed by a step so many times as long as the one before, round a thing.
pub(super) const GROWTH: f64 = 1.8;

/// A look ends with its beam so far to the wall's hand of where the robot went, radians: ten degrees past abeam.
/// Farther back it would find the wall that the robot came along, and take it for one that goes on.
const LOOKED_TO: f64 = angle::FRAC_PI_4 + 0.96;

impl Follower {
    pub(super) fn look(&mut self) -> Ask {
        let guard = Guard { rise: Roles::set(&[self.roles.ahead]), ..Guard::default() };
        let bearing =
            self.ahead.map_or(angle::FRAC_PI_4, |(bearing, _)| bearing * self.side.sign());
        let turn = LOOKED_TO - angle::wrap(bearing);
        self.turn(turn, guard, Doing::Looking, "looking where the wall goes on")
    }

    pub(super) fn judge_look(&mut self, wall: &mut Wall, rest: &AtRest) {
        self.swept = self.ahead.map(|(bearing, reach)| Sweep {
            at: rest.pose.position,
            from: self.looked_from + bearing,
            by: angle::wrap(rest.pose.heading - self.looked_from),
            reach,
        });
        let seen = wall.near().next_back();
        // Of a wall that ends here the look may see the side it came along once more.
        let tip = self.tip.take();
        let behind = |(tip, onward): (Point, Vector)| {
            seen.is_some_and(|seen| (seen.point - tip).dot(&onward) < PAST_TIP)
        };
        let found = matches!(rest.reason, DoneReason::Guard { .. });
        if !found || tip.is_some_and(behind) {
            self.ended = true;
            self.stride = SHORTEST_STRIDE;
            return;
        }
        self.ended = false;
        let surprise = seen.zip(self.frontier).map(|(seen, frontier)| {
            if frontier.certain { frontier.distance(seen.point) } else { 1.0 }
        });
        self.stride = match surprise {
            Some(off) if off < AS_BELIEVED => (self.stride * self.growth).min(LONGEST_STRIDE),
            _ => SHORTEST_STRIDE,
        };
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::angle;
    use crate::mapping::follow::{Follower, Side};
    use crate::robot::{Chassis, Motion};

    #[test]
    fn a_look_ends_ten_degrees_past_abeam_whatever_switch_looks() {
        for (count, side, turn) in [
            (8, Side::Left, 55.0),
            (8, Side::Right, -55.0),
            (6, Side::Left, 40.0),
            (6, Side::Right, -40.0),
        ] {
            let mut follower = Follower::new(&Chassis::with_switches(count), side);
            let Motion::Turn { angle, .. } = follower.look().motion else { panic!("a turn") };
            assert!((angle - f64::to_radians(turn)).abs() < 1e-3, "{count} switches: {angle}");
            assert!(angle.abs() < angle::FRAC_PI_2);
        }
    }
}
