//! Whether the robot can be where it believes it is. What is met where the body has been before, or beyond
//! the room, cannot be there; nor can anything gone round hold places where the body has been, or reach
//! into what is mapped. Either something has moved or the robot is astray, and a robot that is astray maps
//! everything twice. It finds such contradictions; what follows from them is for the mission, which looks
//! for the robot's place as after it was carried.

use super::{Doing, Drive, Scene, Tour};
use crate::geometry::{Point, Ring};
use crate::mapping::follow::Side;
use crate::mapping::map::PathPoint;
use crate::mapping::shape::Thing;
use crate::mapping::wall::Wall;

/// Path and contacts err together by no more than this, metres: what lies deeper than it in where the body
/// has been is not there.
const ERRS: f64 = 0.04;
/// Nearer to a place where the robot was in doubt before it is not so again, metres: what is met there
/// has moved, or is new.
const SAME_PLACE: f64 = 0.6;
/// Doubts at most, so that a tour always ends.
const MOST_DOUBTS: usize = 24;

/// A robot that is astray beside something that it follows: on which hand, and what it saw of it.
#[derive(Debug, Clone)]
pub struct Astray {
    /// The hand.
    pub side: Side,
    /// The contacts.
    pub wall: Wall,
}

/// Whether the body, of this `radius`, has been where `p` is.
fn has_been(path: &[PathPoint], radius: f64, p: Point) -> bool {
    path.iter().any(|place| (place.pose.position - p).norm() < radius - ERRS)
}

/// Whether any of `points` lies within `ring`, and not only at its edge.
fn holds(ring: &Ring, points: impl IntoIterator<Item = Point>) -> bool {
    let deep = |p: &Point| ring.contains(*p) && ring.distance(*p) > ERRS;
    points.into_iter().any(|p| deep(&p))
}

impl Tour {
    /// Whether a thing cannot be where it was met.
    pub(super) fn cannot_be_at(&self, p: Point, scene: &Scene<'_>) -> bool {
        !self.was_doubted(p)
            && (!self.chart.outline().contains(p)
                || has_been(scene.tracker.path(), self.chassis.radius, p))
    }

    /// Whether one of the things that were gone round cannot be where they seem to be.
    pub(super) fn cannot_be(&self, found: &[Thing], scene: &Scene<'_>) -> bool {
        let corners =
            |ring: &Ring| ring.pieces.iter().map(|piece| piece.from()).collect::<Vec<_>>();
        found.iter().any(|thing| {
            let ring = &thing.outline;
            let been = scene.tracker.path().iter().map(|place| place.pose.position);
            let into = |other: &Ring| holds(ring, corners(other)) || holds(other, corners(ring));
            let outside = |p: &Point| {
                let outline = self.chart.outline();
                !outline.contains(*p) && outline.distance(*p) > ERRS
            };
            !self.was_doubted(ring.middle())
                && (holds(ring, been)
                    || self.chart.objects().any(into)
                    || corners(ring).iter().any(outside))
        })
    }

    fn was_doubted(&self, p: Point) -> bool {
        self.doubted.len() >= MOST_DOUBTS
            || self.doubted.iter().any(|place| (place - p).norm() < SAME_PLACE)
    }

    /// Leaves what it was doing: the robot is astray beside what it follows with `wall` on its `side`, since
    /// that cannot be at `p`. The line in hand is driven again.
    pub(super) fn go_astray(
        &mut self,
        p: Point,
        drive: Box<Drive>,
        (side, wall): (Side, Wall),
        scene: &mut Scene<'_>,
    ) {
        self.doubted.push(p);
        self.doing = Doing::Driving(drive);
        self.interrupt(scene.map);
        self.astray = Some(Box::new(Astray { side, wall }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::mapping::map::{Phase, Spun};

    #[test]
    fn nothing_is_where_the_body_has_been() {
        let place = |k: u64| PathPoint {
            pose: Pose::new(k as f64 * 0.01, 0.0, 0.0),
            time_us: k,
            rested_us: 0,
            spun: Spun::default(),
            phase: Phase::Objects,
            carried: false,
        };
        let path: Vec<PathPoint> = (0..100).map(place).collect();
        assert!(has_been(&path, 0.1, Point::new(0.5, 0.04)));
        assert!(!has_been(&path, 0.1, Point::new(0.5, 0.09)), "the body and its errors end here");
        assert!(!has_been(&path, 0.1, Point::new(1.2, 0.0)));
    }

    #[test]
    fn a_thing_holds_what_lies_deep_in_it() {
        let square: Vec<Point> =
            [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)].map(|(x, y)| Point::new(x, y)).into();
        let ring = Ring::polygon(&square);
        assert!(holds(&ring, [Point::new(2.0, 0.5), Point::new(0.5, 0.9)]));
        assert!(!holds(&ring, [Point::new(0.5, 0.98), Point::new(0.5, 1.2)]));
    }
}
