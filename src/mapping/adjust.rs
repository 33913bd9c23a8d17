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

/// What the overlap says of a lap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// How far odometry is off.
    pub misclosure: Misclosure,
    /// Share of the overlap's contacts that fall on walls seen at the beginning once the
    /// misclosure is taken out, 0 to 1. Low when this is another place that only looks near.
    pub agreement: f64,
}

/// How much the pose at the end of the lap is off from the pose at its beginning, measured on the
/// overlap: the contacts after `closure.to` laid on the walls after `closure.from` (iterated closest
/// points, point to line, with odometry's own spread as the prior).
#[must_use]
pub fn measure(closure: &Closure, sightings: &[Sighting]) -> Overlap {
    let range = |s: &&Sighting| s.alive && s.kind == ContactKind::Range;
    let overlap = 0.05 + sightings.last().map_or(0.0, |s| s.travelled) - closure.to.travelled;
    let since = |s: &Sighting| s.travelled - closure.from.travelled;
    let early: Vec<Point> = sightings
        .iter()
        .filter(range)
        .filter(|s| (-0.3..overlap + 0.5).contains(&since(s)))
        .map(|s| s.point)
        .collect();
    let late: Vec<Point> = sightings
        .iter()
        .filter(range)
        .filter(|s| s.travelled > closure.to.travelled)
        .map(|s| s.point)
        .collect();
    let lap = closure.length();
    let centre = closure.to.pose.position;
    let position_weight = 1.0 / (0.02 + POSITION_SD_PER_METRE * lap).powi(2);
    let prior = Vector3::new(position_weight, position_weight, 1.0 / HEADING_SD.powi(2));
    let shift = closure.to.pose.position - closure.from.pose.position;
    let turn = angle::wrap(closure.to.pose.heading - closure.from.pose.heading);
    // The robot follows the same wall at about the same gap and heading, so where it is now is one
    // guess of the misclosure; that there is none is the other. The one that fits better counts.
    let starts = [
        Vector3::zeros(),
        Vector3::new(shift.x, shift.y, 0.0),
        Vector3::new(shift.x, shift.y, turn),
    ];
    let laid = Laid { early: &early, late: &late, centre, prior };
    let (mut found, mut agreeing) = laid.closest(starts[0]);
    for start in &starts[1..] {
        let (other, agree) = laid.closest(*start);
        if agree > agreeing + late.len() / 20 {
            (found, agreeing) = (other, agree);
        }
    }
    let misclosure = Misclosure { dx: found.x, dy: found.y, heading: found.z, lap };
    Overlap { misclosure, agreement: agreeing as f64 / late.len().max(1) as f64 }
}

/// Two looks at the same wall.
struct Laid<'a> {
    early: &'a [Point],
    late: &'a [Point],
    centre: Point,
    prior: Vector3<f64>,
}

impl Laid<'_> {
    /// The misclosure nearest to `start` that lays the late contacts on the early walls, and how
    /// many of them then agree.
    fn closest(&self, start: Vector3<f64>) -> (Vector3<f64>, usize) {
        let mut found = start;
        let mut agreeing = 0;
        for _ in 0..15 {
            let mut normal = Matrix3::from_diagonal(&self.prior);
            let mut right = Vector3::zeros();
            agreeing = 0;
            for &point in self.late {
                let arm = rotate(point - self.centre, -found.z);
                let placed = self.centre + arm - Vector::new(found.x, found.y);
                let beside = self.early.iter().any(|p| (p - placed).norm() < 0.012);
                let Some(wall) = stretch_beside(self.early, placed) else {
                    // Ragged wall has no stretch to lie on; a contact where one was agrees too.
                    agreeing += usize::from(beside);
                    continue;
                };
                let across = perp(wall.along);
                let row = Vector3::new(across.x, across.y, across.dot(&perp(arm)));
                let off = across.dot(&(placed - wall.at));
                agreeing += usize::from(beside || off.abs() < 0.008);
                // Huber's weight: a contact that belongs to another wall must not pull.
                let weight = (2.0 / (off / CONTACT_SD).abs().max(2.0)) / CONTACT_SD.powi(2);
                normal += row * row.transpose() * weight;
                right += row * ((off + row.dot(&found)) * weight);
            }
            let Some(solution) = normal.lu().solve(&right) else {
                break;
            };
            let change = (solution - found).norm();
            found = solution;
            if change < 1e-5 {
                break;
            }
        }
        (found, agreeing)
    }
}

fn stretch_beside(walls: &[Point], point: Point) -> Option<Stretch> {
    let near: Vec<Point> = walls.iter().copied().filter(|p| (p - point).norm() < 0.1).collect();
    if near.len() < 4 {
        return None;
    }
    let stretch = Stretch::through(&near)?;
    let along = |p: Point| stretch.along.dot(&(p - stretch.at));
    let (low, high) = near.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &p| {
        (low.min(along(p)), high.max(along(p)))
    });
    // Beyond what was seen the wall may do anything.
    let within = (low - 0.015..=high + 0.015).contains(&along(point));
    (within && stretch.residual < 0.003 && high - low > 0.05).then_some(stretch)
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
        let mut half = Self { raw: path.to_vec(), adjusted: turned };
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
        let turn = self.pair(time_us).map_or(0.0, |(raw, adjusted)| adjusted.heading - raw.heading);
        Pose {
            position: self.place(pose.position, time_us),
            heading: angle::wrap(pose.heading + turn),
        }
    }

    fn pair(&self, time_us: u64) -> Option<(Pose, Pose)> {
        let after = self.raw.partition_point(|point| point.time_us <= time_us);
        let index = after.saturating_sub(1);
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
