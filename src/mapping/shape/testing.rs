//! A disc rolled along a known wall, which gives the contacts that the robot would; and how far a
//! fitted outline is from the truth. For tests only; shares nothing with the simulator.

pub(super) mod worlds;

use crate::geometry::{Point, Ring, Vector, angle, perp};
use crate::mapping::map::{Contact, ContactKind};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Body radius plus range.
pub(super) const REACH: f64 = 0.16;
/// Distance of the centre from the wall while following.
const KEPT: f64 = 0.145;

/// How the disc is rolled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Roll {
    pub(super) sigma: f64,
    pub(super) seed: u64,
    /// Whether the ring is a solid met from outside.
    pub(super) outside: bool,
    /// Whether the wall is on the robot's left.
    pub(super) wall_left: bool,
}

impl Roll {
    pub(super) fn new(sigma: f64, seed: u64) -> Self {
        Self { sigma, seed, outside: false, wall_left: true }
    }
}

/// A place on the wall with the unit normal into the floor.
struct Spot {
    point: Point,
    normal: Vector,
}

/// Walls as closed polygons, floor on the left of the first.
struct Walls(Vec<(Point, Point)>);

impl Walls {
    fn of(ring: &Ring) -> Self {
        let points = ring.to_points(2e-5);
        let count = points.len();
        Self((0..count).map(|k| (points[k], points[(k + 1) % count])).collect())
    }

    fn clearance(&self, p: Point) -> f64 {
        let distance = |&(a, b): &(Point, Point)| {
            let along = b - a;
            let t = ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (a + along * t - p).norm_squared()
        };
        self.0.iter().map(distance).fold(f64::INFINITY, f64::min).sqrt()
    }

    /// The walls near `p`.
    fn near(&self, p: Point, reach: f64) -> Self {
        let close = |&&(a, b): &&(Point, Point)| {
            let along = b - a;
            let t = ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (a + along * t - p).norm() < reach
        };
        Self(self.0.iter().filter(close).copied().collect())
    }

    fn ray(&self, from: Point, direction: Vector) -> f64 {
        let mut nearest = f64::INFINITY;
        for &(a, b) in &self.0 {
            let along = b - a;
            let sine = crate::geometry::cross(direction, along);
            let t = crate::geometry::cross(a - from, along) / sine;
            let u = crate::geometry::cross(a - from, direction) / sine;
            if sine != 0.0 && t > 0.0 && (0.0..=1.0).contains(&u) {
                nearest = nearest.min(t);
            }
        }
        nearest
    }

    /// The spots of the wall, `step` apart, in order, outer corners with all their normals.
    fn spots(&self, step: f64) -> Vec<Spot> {
        let mut spots = Vec::new();
        for (k, &(a, b)) in self.0.iter().enumerate() {
            let direction = (b - a).normalize();
            let normal = perp(direction);
            let (c, d) = self.0[(k + self.0.len() - 1) % self.0.len()];
            let before = perp((d - c).normalize());
            let turn = angle::atan2(crate::geometry::cross(before, normal), before.dot(&normal));
            if turn < -1e-3 {
                let steps = (turn.abs() / 0.1).ceil();
                for i in 1..steps as usize {
                    let bearing = angle::of(before) + turn * i as f64 / steps;
                    spots.push(Spot { point: a, normal: angle::unit(bearing) });
                }
            }
            let count = ((b - a).norm() / step).ceil();
            for i in 0..count as usize {
                spots.push(Spot { point: a + (b - a) * ((i as f64 + 0.5) / count), normal });
            }
        }
        spots
    }

    /// Spots of the wall that a disc of `radius` can touch.
    fn touchable(&self, radius: f64, step: f64) -> Vec<Spot> {
        self.spots(step)
            .into_iter()
            .filter(|s| self.clearance(s.point + s.normal * radius) > radius - 1e-4)
            .collect()
    }
}

/// The contacts of one lap along `truth`, with some overlap.
pub(super) fn roll(truth: &Ring, how: Roll) -> Vec<Contact> {
    let mut rng = ChaCha8Rng::seed_from_u64(how.seed);
    let walls = Walls::of(&if how.outside { truth.reversed() } else { truth.clone() });
    let mut centers: Vec<Point> =
        walls.touchable(KEPT, 0.005).iter().map(|s| s.point + s.normal * KEPT).collect();
    // With the floor on the left of the way, the wall is on the right.
    if how.wall_left {
        centers.reverse();
    }
    let shift = rng.random_range(0..centers.len());
    centers.rotate_left(shift);
    let count = centers.len();
    let overlap = count + (0.6 / 0.005) as usize;
    let mut contacts = Vec::new();
    let mut travelled = 0.0;
    let mut next = 0.0;
    for k in 0..overlap {
        let (at, after) = (centers[k % count], centers[(k + 1) % count]);
        let step = (after - at).norm();
        travelled += step;
        if travelled >= next {
            next = travelled + rng.random_range(0.03..0.12);
            scan(&walls, at, &mut contacts, how.sigma, travelled, &mut rng);
        }
    }
    contacts
}

/// All edges of a beam of range d that swings round at `at`, some of them missed.
fn scan(
    walls: &Walls,
    at: Point,
    contacts: &mut Vec<Contact>,
    sigma: f64,
    travelled: f64,
    rng: &mut ChaCha8Rng,
) {
    const STEPS: usize = 720;
    let near = walls.near(at, 0.4);
    let bearing = |k: usize| angle::unit(angle::TAU * k as f64 / STEPS as f64);
    let ranges: Vec<f64> = (0..STEPS).map(|k| near.ray(at, bearing(k))).collect();
    // Pose noise is smooth along the lap.
    let drift = Vector::new(angle::sin(travelled * 0.9), angle::cos(travelled * 0.7)) * sigma;
    let mut found = Vec::new();
    for k in 0..STEPS {
        let (here, next) = (ranges[k], ranges[(k + 1) % STEPS]);
        if (here < REACH) == (next < REACH) || rng.random_bool(0.25) {
            continue;
        }
        let noise = (rng.random::<f64>() + rng.random::<f64>() + rng.random::<f64>() - 1.5) * 2.0;
        let (inner, direction) =
            if here < next { (here, bearing(k)) } else { (next, bearing((k + 1) % STEPS)) };
        let smooth = (here - next).abs() < 0.02;
        let (range, kind) = if smooth {
            let share = (REACH - here) / (next - here);
            let exact = angle::unit(angle::TAU * (k as f64 + share) / STEPS as f64);
            let range = near.ray(at, exact);
            found.push((at + exact * (range + noise * sigma) + drift, ContactKind::Range));
            continue;
        } else {
            (inner + noise * 0.01, ContactKind::Edge)
        };
        found.push((at + direction * range + drift, kind));
    }
    if rng.random_bool(0.5) {
        found.reverse();
    }
    for (point, kind) in found {
        contacts.push(Contact {
            point,
            from: at + drift,
            sensor: Some(2),
            kind,
            time: contacts.len() as f64,
        });
    }
}

/// How far a fitted outline is from the truth, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Error {
    pub(super) p95: f64,
    pub(super) worst: f64,
    /// Intersection over union, by counting a lattice.
    pub(super) iou: f64,
}

/// Compares `ring` with `truth`, both ways, where a disc of the robot's reach can touch.
pub(super) fn compare(ring: &Ring, truth: &Ring) -> Error {
    compare_with(ring, truth, REACH)
}

/// The same for a solid met from outside, where every spot counts.
pub(super) fn compare_with(ring: &Ring, truth: &Ring, radius: f64) -> Error {
    let mut errors = Vec::new();
    for (a, b) in [(ring, truth), (truth, ring)] {
        let walls = Walls::of(b);
        for spot in Walls::of(a).touchable(radius, 0.01) {
            errors.push(walls.clearance(spot.point));
        }
    }
    errors.sort_by(f64::total_cmp);
    let (low, high) = truth.bounds().unwrap();
    let step = ((high - low).norm() / 151.7).max(0.001);
    let (mut both, mut either) = (0.0, 0.0);
    let mut y = low.y - 4.71 * step;
    while y < high.y + 5.0 * step {
        let mut x = low.x - 4.37 * step;
        while x < high.x + 5.0 * step {
            let (p, q) = (ring.contains(Point::new(x, y)), truth.contains(Point::new(x, y)));
            both += f64::from(u8::from(p && q));
            either += f64::from(u8::from(p || q));
            x += step;
        }
        y += step;
    }
    Error {
        p95: errors[errors.len() * 95 / 100],
        worst: errors[errors.len() - 1],
        iou: both / either,
    }
}

/// Contacts every 5 cm along `corners`, seen from their left for `side` 1, from their right for -1.
pub(super) fn along(corners: &[(f64, f64)], side: f64) -> Vec<Contact> {
    let corners: Vec<Point> = corners.iter().map(|&(x, y)| Point::new(x, y)).collect();
    let mut contacts = Vec::new();
    for two in corners.windows(2) {
        let (way, count) = (two[1] - two[0], ((two[1] - two[0]).norm() / 0.05).round());
        let off = perp(way).normalize() * (side * KEPT);
        let begun = contacts.len() as f64;
        contacts.extend((0..count as u32).map(|k| {
            let point = two[0] + way * ((f64::from(k) + 0.5) / count);
            let (from, time) = (point + off, begun + f64::from(k));
            Contact { point, from, sensor: Some(2), kind: ContactKind::Range, time }
        }));
    }
    contacts
}
