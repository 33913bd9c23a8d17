//! Out of a pocket. Driving straight, the robot may slip through a gap that it would not enter along a
//! wall. The lap then closes round the inside of something, and it is not the room: the robot was
//! outside before. The way it came is known to be free, and it goes back by that.

use crate::geometry::{Point, Ring, angle, cross};
use crate::mapping::circuit::Closure;
use crate::mapping::follow::{Ask, AtRest, STRIDE};
use crate::mapping::map::PathPoint;
use crate::robot::{DoneReason, Guard, Motion};

/// Where the robot was before is outside of a lap when it lies this far outside the way round, metres: the
/// way keeps off the walls.
const OUTSIDE: f64 = 0.25;
/// The way back leaves the way there by no more than this, metres, ...
const ASTRAY: f64 = 0.01;
/// ... and a place on it is reached when it is as near as this, metres.
const REACHED: f64 = 0.02;
/// Smaller turns are not worth a motion, radians.
const FACING: f64 = 0.01;

/// The way back to where the robot was before it came into a pocket.
#[derive(Debug, Clone)]
pub(super) struct Retreat {
    /// Places to go to, the next one last.
    way: Vec<Point>,
}

impl Retreat {
    /// The way back from a lap that closed round its inside, by `path`, to where the robot was at
    /// `begun_us` (robot time); none when that is within the lap, which then is of the room.
    pub(super) fn from_pocket(
        path: &[PathPoint],
        begun_us: u64,
        closure: &Closure,
    ) -> Option<Self> {
        let between = |from: u64, to: u64| {
            let first = path.partition_point(|point| point.time_us < from);
            let end = path.partition_point(|point| point.time_us <= to);
            path[first..end.max(first)].iter().map(|point| point.pose.position)
        };
        let (from, to) = (closure.from.time_us, closure.to.time_us);
        let begun = between(begun_us, from).next()?;
        let round = Ring::polygon(&straightened(between(from, to)));
        if round.contains(begun) || round.distance(begun) < OUTSIDE {
            return None;
        }
        let mut way = straightened(between(begun_us, from));
        way.extend(straightened(between(to, u64::MAX)));
        Some(Self { way })
    }

    /// The next motion on the way back; none when it is at its end, or something is in the way.
    pub(super) fn next(&mut self, rest: &AtRest) -> Option<Ask> {
        if matches!(rest.reason, DoneReason::Bumper | DoneReason::Stalled) {
            return None;
        }
        let pose = rest.pose;
        while self.way.last().is_some_and(|place| (place - pose.position).norm() < REACHED) {
            self.way.pop();
        }
        let off = self.way.last()? - pose.position;
        let turn = angle::wrap(angle::of(off) - pose.heading);
        let motion = if turn.abs() > FACING {
            Motion::Turn { angle: turn, rate: f64::INFINITY }
        } else {
            Motion::Move { distance: off.norm().min(STRIDE), speed: f64::INFINITY }
        };
        let why = "went round a pocket: back by the way it came";
        Some(Ask { motion, guard: Guard::default(), why })
    }
}

/// A way with fewer corners: every place left out lies near the straight line past it.
fn straightened(way: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    let mut passed: Vec<Point> = Vec::new();
    for place in way {
        let Some(&last) = kept.last() else {
            kept.push(place);
            continue;
        };
        let Some(along) = (place - last).try_normalize(REACHED) else { continue };
        if passed.iter().any(|p| cross(along, p - last).abs() > ASTRAY) {
            kept.extend(passed.last());
            passed.clear();
        }
        passed.push(place);
    }
    kept.extend(passed.last());
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_keeps_its_corners_only() {
        let there = (0..=20).map(|k| Point::new(f64::from(k) * 0.05, 0.0));
        let up = (1..=20).map(|k| Point::new(1.0, f64::from(k) * 0.05));
        let way = straightened(there.chain(up));
        assert_eq!(way.len(), 3, "{way:?}");
        assert!((way[1] - Point::new(1.0, 0.0)).norm() < 0.06, "{way:?}");
        assert_eq!(way[2], Point::new(1.0, 1.0));
    }
}
