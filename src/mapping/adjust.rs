//! Taking the misclosure of a lap out of it, as surveyors do with a closed traverse.
//!
//! The stretch that was driven twice is laid on itself: contacts of the overlap against the walls
//! made by the first contacts. What does not fit is the misclosure. Its angle is spread over the
//! lap in proportion to time (the gyro drifts with time), what then remains of its displacement in
//! proportion to distance (Bowditch's rule: encoders err with distance).

use super::circuit::Closure;
use super::map::{Misclosure, PathPoint};
use super::wall::{Sighting, Stretch};
use crate::geometry::{Point, Pose, Vector, angle, cross, perp};
use crate::mapping::map::ContactKind;
use nalgebra::{Matrix3, Vector3};

/// Believed spread of a contact about its wall, metres.
const CONTACT_SD: f64 = 0.003;
/// How far off a lap may be before anything was measured: position per metre, and heading.
const POSITION_SD_PER_METRE: f64 = 0.006;
const HEADING_SD: f64 = 0.05;

/// How much the pose at the end of the lap is off from the pose at its beginning, measured on the
/// overlap: the contacts after `closure.to` against the walls after `closure.from`.
#[must_use]
pub fn measure(closure: &Closure, sightings: &[Sighting]) -> Misclosure {
    let range = |s: &&Sighting| s.alive && s.kind == ContactKind::Range;
    let overlap = 0.05 + sightings.last().map_or(0.0, |s| s.travelled) - closure.to.travelled;
    let early: Vec<Point> = sightings
        .iter()
        .filter(range)
        .filter(|s| {
            let since = s.travelled - closure.from.travelled;
            (-0.3..overlap + 0.5).contains(&since)
        })
        .map(|s| s.point)
        .collect();
    let late = sightings
        .iter()
        .filter(range)
        .filter(|s| s.travelled > closure.to.travelled);
    let lap = closure.length();
    let centre = closure.to.pose.position;
    let position_weight = 1.0 / (0.01 + POSITION_SD_PER_METRE * lap).powi(2);
    let prior = Vector3::new(position_weight, position_weight, 1.0 / HEADING_SD.powi(2));
    let walls: Vec<(Point, Stretch)> = late
        .filter_map(|s| stretch_beside(&early, s.point).map(|w| (s.point, w)))
        .collect();
    let mut found = Vector3::zeros();
    for _ in 0..6 {
        let mut normal = Matrix3::from_diagonal(&prior);
        let mut right = Vector3::zeros();
        for (point, wall) in &walls {
            let arm = point - centre;
            let across = perp(wall.along);
            let row = Vector3::new(across.x, across.y, across.dot(&perp(arm)));
            let off = across.dot(&(point - wall.at));
            let rest = (off - row.dot(&found)) / CONTACT_SD;
            // Huber's weight: a contact that belongs to another wall must not pull.
            let weight = (2.0 / rest.abs().max(2.0)) / CONTACT_SD.powi(2);
            normal += row * row.transpose() * weight;
            right += row * (off * weight);
        }
        let Some(solution) = normal.lu().solve(&right) else {
            break;
        };
        found = solution;
    }
    Misclosure {
        dx: found.x,
        dy: found.y,
        heading: found.z,
        lap,
    }
}

fn stretch_beside(walls: &[Point], point: Point) -> Option<Stretch> {
    let near: Vec<Point> = walls
        .iter()
        .copied()
        .filter(|p| (p - point).norm() < 0.11)
        .collect();
    if near.len() < 3 {
        return None;
    }
    let stretch = Stretch::through(&near)?;
    let spread = near
        .iter()
        .map(|p| stretch.along.dot(&(p - stretch.at)).abs())
        .fold(0.0, f64::max);
    (stretch.residual < 0.004 && spread > 0.03).then_some(stretch)
}

/// How the trajectory moves when the misclosure is taken out.
#[derive(Debug, Clone)]
pub struct Adjustment {
    raw: Vec<PathPoint>,
    adjusted: Vec<PathPoint>,
}

impl Adjustment {
    /// Spreads `misclosure` over the lap `closure`; `path` is the whole trajectory, in order. What
    /// lies before the lap stays, what lies after it moves with its end.
    #[must_use]
    pub fn new(path: &[PathPoint], closure: &Closure, misclosure: &Misclosure) -> Self {
        let (begin, end) = (closure.from.time_us, closure.to.time_us);
        let seconds = (end.saturating_sub(begin)).max(1) as f64;
        let share = |time_us: u64| (time_us.saturating_sub(begin) as f64 / seconds).clamp(0.0, 1.0);
        let turn = |time_us: u64| -misclosure.heading * share(time_us);
        let mut turned: Vec<PathPoint> = Vec::with_capacity(path.len());
        let mut lengths: Vec<f64> = Vec::with_capacity(path.len());
        for (k, point) in path.iter().enumerate() {
            let mut pose = point.pose;
            let mut length = 0.0;
            if let (Some(before), Some(placed)) = (k.checked_sub(1).map(|j| path[j]), turned.last())
            {
                let leg = point.pose.position - before.pose.position;
                let by = turn(before.time_us).midpoint(turn(point.time_us));
                pose.position = placed.pose.position + rotate(leg, by);
                if point.time_us > begin && point.time_us <= end {
                    length = leg.norm();
                }
            }
            pose.heading = angle::wrap(pose.heading + turn(point.time_us));
            lengths.push(lengths.last().copied().unwrap_or(0.0) + length);
            turned.push(PathPoint { pose, ..*point });
        }
        let total = lengths.last().copied().unwrap_or(0.0).max(1e-9);
        let mut half = Self {
            raw: path.to_vec(),
            adjusted: turned,
        };
        let measured = closure.to.pose.position - Vector::new(misclosure.dx, misclosure.dy);
        let rest = measured - half.place(closure.to.pose.position, end);
        for (point, length) in half.adjusted.iter_mut().zip(&lengths) {
            point.pose.position += rest * (length / total);
        }
        half
    }

    /// The trajectory with the misclosure taken out.
    #[must_use]
    pub fn path(&self) -> &[PathPoint] {
        &self.adjusted
    }

    /// Where a point goes that was tied to the raw trajectory at `time_us`.
    #[must_use]
    pub fn place(&self, point: Point, time_us: u64) -> Point {
        self.pair(time_us).map_or(point, |(raw, adjusted)| {
            adjusted.position + rotate(point - raw.position, adjusted.heading - raw.heading)
        })
    }

    /// Where a pose goes that was tied to the raw trajectory at `time_us`.
    #[must_use]
    pub fn pose(&self, pose: Pose, time_us: u64) -> Pose {
        let turn = self
            .pair(time_us)
            .map_or(0.0, |(raw, adjusted)| adjusted.heading - raw.heading);
        Pose {
            position: self.place(pose.position, time_us),
            heading: angle::wrap(pose.heading + turn),
        }
    }

    fn pair(&self, time_us: u64) -> Option<(Pose, Pose)> {
        let after = self.raw.partition_point(|point| point.time_us <= time_us);
        let index = after.checked_sub(1).unwrap_or(0);
        Some((self.raw.get(index)?.pose, self.adjusted.get(index)?.pose))
    }
}

fn rotate(v: Vector, by: f64) -> Vector {
    let (sine, cosine) = (angle::sin(by), angle::cos(by));
    Vector::new(cosine * v.x - sine * v.y, sine * v.x + cosine * v.y)
}

/// Signed distance of `point` from the line of `wall`, positive to its left.
#[must_use]
pub fn offset(wall: &Stretch, point: Point) -> f64 {
    cross(wall.along, point - wall.at)
}
