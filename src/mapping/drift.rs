//! A gyro that drifts steadily winds up all that is driven: after half an hour at 20 degrees an hour a
//! lap that closed ends 10 degrees and metres away from where it began. Taken out as an angle first,
//! place by place (as surveyors balance the angles of a traverse before its lengths), what is left is
//! small enough for least squares.

use super::map::PathPoint;
use crate::geometry::{Point, Pose, angle, rotate};

/// A gyro may drift by this much either way before anything is known of it, radians per second (75
/// degrees an hour).
const WORST: f64 = 3.6e-4;
/// Drifts that are tried lie this far apart, radians per second.
const STEP: f64 = 9.0e-6;

/// Seconds that the robot was not at rest from `begin` until `point`.
fn active(begin: &PathPoint, point: &PathPoint) -> f64 {
    let until = |point: &PathPoint| point.time_us.saturating_sub(point.rested_us);
    until(point).saturating_sub(until(begin)) as f64 * 1e-6
}

/// The way of the robot with a steady drift of its gyro taken out, from its beginning on.
#[derive(Debug, Clone)]
pub struct Unwound {
    rate: f64,
    wound: Vec<PathPoint>,
    path: Vec<PathPoint>,
}

impl Unwound {
    /// `path` without `rate` radians per second.
    #[must_use]
    pub fn new(path: &[PathPoint], rate: f64) -> Self {
        let since = |point: &PathPoint| path.first().map_or(0.0, |begin| active(begin, point));
        let mut unwound: Vec<PathPoint> = Vec::with_capacity(path.len());
        for (k, point) in path.iter().enumerate() {
            let turn = -rate * since(point);
            let position = match (k.checked_sub(1).map(|j| path[j]), unwound.last()) {
                (Some(before), Some(last)) => {
                    let middle = -rate * f64::midpoint(since(&before), since(point));
                    last.pose.position + rotate(point.pose.position - before.pose.position, middle)
                }
                _ => point.pose.position,
            };
            let pose = Pose { position, heading: angle::wrap(point.pose.heading + turn) };
            let mut spun = point.spun;
            spun.gyro += turn;
            unwound.push(PathPoint { pose, spun, ..*point });
        }
        Self { rate, wound: path.to_vec(), path: unwound }
    }

    /// Radians per second that were taken out.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// The way without the drift.
    #[must_use]
    pub fn path(&self) -> &[PathPoint] {
        &self.path
    }

    /// By how much the heading at `time_us` (robot time) is corrected, radians.
    #[must_use]
    pub fn turn(&self, time_us: u64) -> f64 {
        self.at(time_us).map_or(0.0, |(wound, unwound)| unwound.spun.gyro - wound.spun.gyro)
    }

    fn at(&self, time_us: u64) -> Option<(&PathPoint, &PathPoint)> {
        let after = self.wound.partition_point(|point| point.time_us <= time_us);
        let index = after.saturating_sub(1);
        Some((self.wound.get(index)?, self.path.get(index)?))
    }

    /// Where a point is that was tied to the way at `time_us`.
    #[must_use]
    pub fn point(&self, point: Point, time_us: u64) -> Point {
        self.at(time_us).map_or(point, |(wound, unwound)| {
            let arm = rotate(point - wound.pose.position, unwound.spun.gyro - wound.spun.gyro);
            unwound.pose.position + arm
        })
    }

    /// Where a pose is that was tied to the way at `time_us`.
    #[must_use]
    pub fn pose(&self, pose: Pose, time_us: u64) -> Pose {
        Pose {
            position: self.point(pose.position, time_us),
            heading: angle::wrap(pose.heading + self.turn(time_us)),
        }
    }
}

/// Where the robot would be now, for each drift that its gyro may have.
#[derive(Debug, Clone)]
pub struct Drifts {
    begun: Option<f64>,
    last: Pose,
    seen: f64,
    all: Vec<Drifting>,
}

/// Where it was and is, for one of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drifting {
    /// Radians per second.
    pub rate: f64,
    /// Where it was when this was looked at before.
    pub before: Pose,
    /// Where it is.
    pub now: Pose,
}

impl Drifts {
    /// None but that which is taken out already, or all that there may be.
    #[must_use]
    pub fn new(any: bool) -> Self {
        let steps = if any { (WORST / STEP) as i32 } else { 0 };
        let nowhere = Pose::new(0.0, 0.0, 0.0);
        let all = (-steps..=steps)
            .map(|k| Drifting { rate: f64::from(k) * STEP, before: nowhere, now: nowhere })
            .collect();
        Self { begun: None, last: nowhere, seen: 0.0, all }
    }

    /// What it is from here on, as if nothing had been driven before.
    pub fn begin_anew(&mut self) {
        self.begun = None;
    }

    /// The robot is at `pose`, having moved for `active` seconds since its beginning.
    pub fn follow(&mut self, pose: Pose, active: f64) {
        let Some(begun) = self.begun else {
            self.begun = Some(active);
            (self.last, self.seen) = (pose, active);
            for one in &mut self.all {
                (one.before, one.now) = (pose, pose);
            }
            return;
        };
        let moved = pose.position - self.last.position;
        let middle = f64::midpoint(active, self.seen) - begun;
        for one in &mut self.all {
            one.before = one.now;
            one.now = Pose {
                position: one.now.position + rotate(moved, -one.rate * middle),
                heading: angle::wrap(pose.heading - one.rate * (active - begun)),
            };
        }
        (self.last, self.seen) = (pose, active);
    }

    /// Whether a drift may be found that was not taken out before.
    #[must_use]
    pub fn any(&self) -> bool {
        self.all.len() > 1
    }

    /// Seconds of motion at which this began to be looked at.
    #[must_use]
    pub fn begun(&self) -> f64 {
        self.begun.unwrap_or(0.0)
    }

    /// Each of them, the one that is taken out already among them.
    #[must_use]
    pub fn all(&self) -> &[Drifting] {
        &self.all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;
    use crate::mapping::map::{Phase, Spun};

    /// A square of 10 m a side at 0.1 m/s, driven by a robot whose gyro drifts by `rate`.
    fn wound(rate: f64) -> Vec<PathPoint> {
        let (mut position, mut path) = (Point::new(1.0, 2.0), Vec::new());
        for k in 0..400_u64 {
            let seconds = k as f64;
            let heading = (k / 100) as f64 * angle::FRAC_PI_2 + rate * seconds;
            let spun = Spun { gyro: heading, ..Spun::default() };
            let pose = Pose { position, heading: angle::wrap(heading) };
            let time_us = k * 1_000_000;
            path.push(PathPoint {
                pose,
                time_us,
                rested_us: 0,
                spun,
                phase: Phase::Boundary,
                carried: false,
            });
            position += angle::unit(heading + rate / 2.0) * 0.1;
        }
        path
    }

    #[test]
    fn a_square_wound_up_by_a_drifting_gyro_is_a_square_again() {
        let rate = 3.0e-4;
        let (true_path, path) = (wound(0.0), wound(rate));
        let off = |a: &PathPoint, b: &PathPoint| (a.pose.position - b.pose.position).norm();
        assert!(off(&path[399], &true_path[399]) > 0.5, "it is wound up");
        let unwound = Unwound::new(&path, rate);
        for (a, b) in unwound.path().iter().zip(&true_path) {
            assert!(off(a, b) < 1e-3, "{} at {}", off(a, b), a.time_us);
            assert!(angle::wrap(a.pose.heading - b.pose.heading).abs() < 1e-9);
        }
        // What was seen half a metre ahead is half a metre ahead.
        let seen = path[350].pose.position + path[350].pose.direction() * 0.5;
        let want = true_path[350].pose.position + true_path[350].pose.direction() * 0.5;
        assert!((unwound.point(seen, 350_000_000) - want).norm() < 1e-3);
    }

    #[test]
    fn of_all_drifts_the_right_one_leads_back_to_the_beginning() {
        let path = wound(27.0 * STEP);
        let mut drifts = Drifts::new(true);
        for point in &path {
            drifts.follow(point.pose, point.time_us as f64 * 1e-6);
        }
        let goal = path[0].pose.position + Vector::new(0.0, 0.1);
        let off = |one: &&Drifting| (one.now.position - goal).norm();
        let best = drifts.all().iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("some");
        assert!((best.rate / STEP - 27.0).abs() < 1.5, "{}", best.rate / STEP);
        assert!(off(&best) < 0.02, "{}", off(&best));
        assert_eq!(Drifts::new(false).all().len(), 1);
    }
}
