//! What the robot's way says of contacts that were made before: nothing is where the body has been, nor
//! where an open beam swept past.

use super::{MEMORY, Wall};
use crate::geometry::{Point, Pose, Vector, angle, cross};
use crate::mapping::map::ContactKind;
use crate::robot::SwitchSet;

/// Where on the rim a touch may have been, in the order in which it is believed, as bearings towards
/// the side on which something was seen last, radians.
const RIM: [f64; 9] = [0.0, 0.39, 0.79, 1.18, -0.39, -0.79, -1.18, 1.5, -1.5];
/// A touch that the body has come over by more than this was elsewhere, metres. So much a bumper gives.
const UNDER: f64 = 0.04;

/// What lies farther off than this, metres, tells no longer how the wall runs: it holds the contacts of the last
/// two looks of a robot that steps as far as it ever does.
const AROUND: f64 = 1.1;
/// Places where the body has been are kept this far apart, metres.
const TRAIL: f64 = 0.02;
/// The way is gone through in steps that turn by no more than this, radians, ...
const TURN: f64 = 0.2;
/// ... and lead no farther than this, metres.
const PACE: f64 = 0.02;

/// Where the body has been of late.
#[derive(Debug, Clone, Default)]
pub(super) struct Trail {
    /// Centre, and odometer then, metres driven.
    places: Vec<(Point, f64)>,
}

impl Trail {
    fn push(&mut self, place: Point, travelled: f64) {
        if self.places.last().is_none_or(|(last, _)| (place - last).norm() > TRAIL) {
            self.places.retain(|(_, then)| travelled - then < MEMORY);
            self.places.push((place, travelled));
        }
    }

    /// Whether the body came over `p`, farther than a bumper gives.
    fn covers(&self, p: Point, radius: f64) -> bool {
        self.places.iter().any(|(place, _)| radius - (p - place).norm() > UNDER)
    }

    pub(super) fn clear(&mut self) {
        self.places.clear();
    }
}

impl Wall {
    /// The robot moved to `pose` with the switches in `closed` all the while: what an open beam or
    /// the body passed through is not there.
    pub fn carve(&mut self, pose: Pose, closed: SwitchSet, travelled: f64, time_us: u64) {
        let from = self.last_pose.replace(pose).unwrap_or(pose);
        self.record((from, pose), closed, travelled, time_us);
        self.trail.push(pose.position, travelled);
        self.near.retain(|&index| {
            let seen = &self.log[index];
            seen.alive
                && travelled - seen.travelled < MEMORY
                && (seen.point - pose.position).norm() < AROUND
        });
        let turned = angle::wrap(pose.heading - from.heading);
        let moved = pose.position - from.position;
        let steps = ((turned.abs() / TURN).ceil().max((moved.norm() / PACE).ceil()) as u32).max(1);
        let mut previous = from;
        for k in 1..=steps {
            let share = f64::from(k) / f64::from(steps);
            let next = Pose {
                position: from.position + moved * share,
                heading: from.heading + turned * share,
            };
            self.carve_step(previous, next, closed);
            previous = next;
        }
    }

    fn carve_step(&mut self, from: Pose, to: Pose, closed: SwitchSet) {
        let far = self.reach - 0.008;
        let facing = (from.direction(), to.direction());
        let local = |at: Point, facing: Vector, p: Point| {
            Vector::new(facing.dot(&(p - at)), cross(facing, p - at))
        };
        let mut moved = Vec::new();
        for &index in &self.near {
            let seen = &mut self.log[index];
            let touch = seen.kind == ContactKind::Touch;
            // What was pulled in beside a gap is no touch of the bumper, and stays.
            if !seen.alive || (touch && seen.sensor.is_some()) {
                continue;
            }
            let under = self.radius - (seen.point - to.position).norm();
            if touch && under > UNDER {
                moved.push(index);
                continue;
            }
            if !touch && under > 0.006 {
                seen.alive = false;
                continue;
            }
            let near_rim = self.radius - 0.002;
            let before = local(from.position, facing.0, seen.point);
            // From one side of a beam to the other a step takes nothing that lies farther off than this.
            if before.norm() > far + PACE + 2.0 * TURN * self.reach {
                continue;
            }
            let after = local(to.position, facing.1, seen.point);
            for (sensor, &ray) in self.rays.iter().enumerate() {
                if closed.has(sensor) {
                    continue;
                }
                let (side0, side1) = (cross(ray, before), cross(ray, after));
                let (along0, along1) = (ray.dot(&before), ray.dot(&after));
                let swept = side0 * side1 < 0.0 && side0.abs().min(side1.abs()) > 0.0015;
                let within = along0.min(along1) > near_rim && along0.max(along1) < far;
                if swept && within {
                    if touch {
                        moved.push(index);
                        break;
                    }
                    if seen.alive && seen.sensor.is_some_and(|other| other != sensor) {
                        self.missed.push(sensor);
                    }
                    seen.alive = false;
                }
            }
        }
        for index in moved {
            self.move_along_rim(index);
        }
    }

    /// A touch that was not where it was believed to be: the next place of the rim, or none is left.
    fn move_along_rim(&mut self, index: usize) {
        let seen = self.log[index];
        let before = self.log[..index].iter().rev().find(|other| other.sensor.is_some());
        let side = before.map_or(1.0, |other| {
            let bearing = angle::of(other.point - seen.pose.position) - seen.pose.heading;
            angle::wrap(bearing).signum()
        });
        let touch = &mut self.log[index];
        for bearing in &RIM[usize::from(touch.ruled_out).min(RIM.len() - 1) + 1..] {
            touch.ruled_out += 1;
            touch.beam = touch.pose.heading + side * bearing;
            touch.point = touch.pose.position + angle::unit(touch.beam) * self.radius;
            if !self.trail.covers(touch.point, self.radius) {
                return;
            }
        }
        touch.alive = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::wall::Sighting;
    use crate::robot::Chassis;

    /// The robot touches something and then turns on the spot by `angle`, all switches open.
    fn turned_after_a_touch(angle: f64) -> (Wall, Sighting) {
        let mut wall = Wall::new(&Chassis::default());
        let at = Pose::new(0.0, 0.0, 0.0);
        let touch = wall.touch(at, 0.0, 0);
        // Backing off brings the place of the touch within the beams.
        let back = Pose::new(-0.03, 0.0, 0.0);
        wall.carve(back, SwitchSet::EMPTY, 0.03, 0);
        wall.carve(Pose::new(-0.03, 0.0, angle), SwitchSet::EMPTY, 0.03, 0);
        (wall, touch)
    }

    #[test]
    fn a_touch_that_the_body_came_over_was_elsewhere() {
        let mut wall = Wall::new(&Chassis::default());
        let touch = wall.touch(Pose::new(0.0, 0.0, 0.0), 0.0, 0);
        wall.carve(Pose::new(-0.03, 0.0, 0.0), SwitchSet::EMPTY, 0.03, 0);
        assert_eq!(wall.log()[0].point, touch.point);
        // On past the place a little to the left, where the body covers it; no beam says anything.
        let closed = (0..8).fold(SwitchSet::EMPTY, |set, k| set.with(k, true));
        wall.carve(Pose::new(-0.03, 0.0, 0.9), closed, 0.03, 0);
        let there = Pose::new(0.08, 0.04, 0.9);
        for _ in 0..7 {
            wall.carve(there, closed, 0.16, 0);
        }
        let moved = wall.log()[0];
        assert!(!moved.alive || (moved.point - there.position).norm() > 0.06, "{moved:?}");
    }

    #[test]
    fn a_touch_is_moved_to_no_place_that_the_body_has_been_at_since() {
        let mut wall = Wall::new(&Chassis::default());
        wall.touch(Pose::new(0.0, 0.0, 0.0), 0.0, 0);
        let closed = (0..8).fold(SwitchSet::EMPTY, |set, k| set.with(k, true));
        // All round to the left of it first, where the touch is not believed to be yet.
        for (x, y, travelled) in [(-0.1, 0.0, 0.1), (0.0, 0.1, 0.25), (0.07, 0.12, 0.33)] {
            wall.carve(Pose::new(x, y, 1.5), closed, travelled, 0);
        }
        // Then over the place ahead.
        wall.carve(Pose::new(0.12, 0.01, -1.5), closed, 0.45, 0);
        let moved = wall.log()[0];
        assert!(!moved.alive || moved.point.y < 0.0, "{moved:?}");
    }

    #[test]
    fn a_touch_is_taken_to_be_ahead() {
        let (wall, touch) = turned_after_a_touch(0.0);
        assert!((touch.point - Point::new(0.1, 0.0)).norm() < 1e-12);
        assert_eq!(wall.near().next(), Some(&touch));
    }

    #[test]
    fn a_touch_that_a_beam_passes_was_elsewhere_on_the_rim() {
        let (wall, touch) = turned_after_a_touch(-1.0);
        let moved = wall.near().next().expect("still a touch");
        assert_ne!(moved.point, touch.point);
        assert!((moved.point.coords.norm() - 0.1).abs() < 1e-9, "not on the rim: {moved:?}");
        assert_eq!(moved.kind, ContactKind::Touch);
    }

    #[test]
    fn a_touch_that_was_nowhere_on_the_rim_is_forgotten() {
        let (mut wall, _) = turned_after_a_touch(0.0);
        for turn in 1..=24 {
            let heading = f64::from(turn) * 0.5;
            wall.carve(Pose::new(-0.03, 0.0, heading), SwitchSet::EMPTY, 0.03, 0);
        }
        assert_eq!(wall.near().count(), 0);
    }
}
