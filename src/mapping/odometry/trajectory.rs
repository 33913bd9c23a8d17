//! What a correction of the pose says of the way there: what was driven is moved along with it.

use super::Tracker;
use crate::geometry::{Pose, angle};

/// Corrections nearer to each other than this along the way are one, metres.
const LEAST_APART: f64 = 0.3;

impl Tracker {
    /// Moves the believed pose by a correction that was measured against the map. What was driven
    /// since the last correction is moved too, in proportion to the way: that is where the error
    /// came from.
    pub fn correct(&mut self, to: Pose) {
        let turned = angle::wrap(to.heading - self.heading);
        let moved = to.position - self.pose.position;
        if self.travelled - self.fixed.at > LEAST_APART {
            self.fixed.since = self.fixed.from;
        }
        let since = self.fixed.since.min(self.path.len());
        let mut way = 0.0;
        let ways: Vec<f64> = self.path[since..]
            .windows(2)
            .map(|w| {
                way += (w[1].pose.position - w[0].pose.position).norm();
                way
            })
            .collect();
        for (point, part) in self.path[since..].iter_mut().skip(1).zip(ways) {
            let share = part / way.max(1e-9);
            point.pose.position += moved * share;
            point.pose.heading = angle::wrap(point.pose.heading + turned * share);
        }
        let begun = self.fixed.since;
        self.settle(to);
        self.fixed.since = begun;
    }

    /// All that was driven since place `since` of the trajectory was believed in a frame of its own, and
    /// `onto` takes it to the map; the robot had been carried there.
    pub fn carry(&mut self, since: usize, onto: &Pose) {
        let there = |pose: Pose| Pose {
            position: onto.to_world(pose.position),
            heading: angle::wrap(pose.heading + onto.heading),
        };
        for point in self.path.iter_mut().skip(since) {
            point.pose = there(point.pose);
        }
        if let Some(first) = self.path.get_mut(since) {
            first.carried = true;
        }
        self.settle(there(self.pose));
    }

    /// What was driven since place `since` of the trajectory was believed in a frame that nobody will ever lay on
    /// the map: the robot was put elsewhere before it had found its place.
    pub fn forget(&mut self, since: usize) {
        self.path.truncate(since);
    }

    /// The robot was not carried before place `since` of the trajectory, from which on `onto` took it to the
    /// map, but came to be where it is on its way there: what was driven after `from_us` (robot time,
    /// microseconds) is moved by a part of that, in proportion to the way.
    pub fn lead_to(&mut self, from_us: u64, since: usize, onto: &Pose) {
        let since = since.min(self.path.len());
        let first = self.path.partition_point(|point| point.time_us <= from_us).min(since);
        let mut way = 0.0;
        let mut last = self.path.get(first).map(|point| point.pose.position);
        let ways: Vec<f64> = self.path[first..since]
            .iter()
            .map(|point| {
                way += last.map_or(0.0, |last| (point.pose.position - last).norm());
                last = Some(point.pose.position);
                way
            })
            .collect();
        for (point, part) in self.path[first..since].iter_mut().zip(ways) {
            let share = part / way.max(1e-9);
            let there = onto.to_world(point.pose.position);
            point.pose.position += (there - point.pose.position) * share;
            point.pose.heading = angle::wrap(point.pose.heading + onto.heading * share);
        }
        if let Some(next) = self.path.get_mut(since) {
            next.carried = first == since;
        }
    }

    /// Begins anew at `pose`: what was driven before does not count.
    pub fn begin_anew(&mut self, pose: Pose) {
        self.path.clear();
        self.settle(pose);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::mapping::map::Phase;
    use crate::robot::{Chassis, Odometer};

    /// A metre straight on along x in a second, then another in a frame of its own.
    fn driven() -> Tracker {
        let mut tracker = Tracker::new(&Chassis::default(), Pose::new(0.0, 0.0, 0.0));
        for k in 0..=40_i64 {
            let (left_ticks, right_ticks, time_us) = (k * 100, k * 100, k as u64 * 50_000);
            let odometer = Odometer { time_us, left_ticks, right_ticks, heading: 0.0 };
            tracker.advance(&odometer, Phase::Objects);
        }
        tracker
    }

    #[test]
    fn a_way_that_led_elsewhere_is_moved_the_more_the_later_and_has_no_gap() {
        let mut tracker = driven();
        let since = 20;
        let onto = Pose::new(0.0, 0.4, 0.1);
        let before = tracker.path().to_vec();
        tracker.carry(since, &onto);
        assert!(tracker.path()[since].carried);
        tracker.lead_to(before[9].time_us, since, &onto);
        let path = tracker.path();
        assert!(path.iter().all(|point| !point.carried), "it was not carried");
        for (was, is) in before[..10].iter().zip(path) {
            assert_eq!(was.pose, is.pose, "it was sure of that");
        }
        let off = |k: usize| (path[k].pose.position - before[k].pose.position).norm();
        assert!((10..since - 1).all(|k| off(k) <= off(k + 1)));
        let end: Point = onto.to_world(before[since - 1].pose.position);
        assert!((path[since - 1].pose.position - end).norm() < 1e-9);
        let step = (path[since].pose.position - path[since - 1].pose.position).norm();
        assert!((step - 0.05).abs() < 1e-9, "{step}");
    }

    #[test]
    fn a_robot_that_was_sure_until_then_was_carried() {
        let mut tracker = driven();
        tracker.carry(20, &Pose::new(0.0, 0.4, 0.1));
        let sure = tracker.path()[19].time_us;
        tracker.lead_to(sure, 20, &Pose::new(0.0, 0.4, 0.1));
        assert!(tracker.path()[20].carried);
    }
}
