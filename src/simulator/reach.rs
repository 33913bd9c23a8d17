//! The reach grid: for each cell, the wall segments that anything in the cell could touch or sense.
//!
//! A query near walls looks at a handful of segments, one in the open at none, however many walls
//! the world has (DESIGN 6.13). Its answers are those of parry's ray casts and point projections,
//! which the tests hold it to.

use super::World;
use super::world::SAGITTA;
use crate::geometry::{Point, Vector, cross, ring::bounds};

/// A straight piece of wall; arcs are cut into these.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// One end.
    pub from: Point,
    /// To the other.
    pub along: Vector,
    inverse_square: f64,
}

impl Segment {
    fn new(from: Point, to: Point) -> Self {
        let along = to - from;
        Self { from, along, inverse_square: 1.0 / along.norm_squared().max(1e-18) }
    }

    /// The point of the segment nearest to `p`.
    #[must_use]
    pub fn nearest(&self, p: Point) -> Point {
        let t = (p - self.from).dot(&self.along) * self.inverse_square;
        self.from + self.along * t.clamp(0.0, 1.0)
    }
}

/// Segments by cell.
#[derive(Debug, Clone)]
pub struct ReachGrid {
    low: Point,
    pitch: f64,
    columns: usize,
    rows: usize,
    first: Vec<u32>,
    listed: Vec<Segment>,
}

impl ReachGrid {
    /// A grid over `world` for queries up to `reach` metres from a point.
    #[must_use]
    pub fn new(world: &World, reach: f64) -> Self {
        let mut segments = Vec::new();
        for ring in std::iter::once(&world.boundary).chain(world.objects.iter().map(|o| &o.ring)) {
            let points = ring.to_points(SAGITTA);
            for (k, &from) in points.iter().enumerate() {
                segments.push(Segment::new(from, points[(k + 1) % points.len()]));
            }
        }
        Self::of(&segments, reach)
    }

    /// A grid over `segments`.
    #[must_use]
    pub fn of(segments: &[Segment], reach: f64) -> Self {
        let ends: Vec<Point> = segments.iter().flat_map(|s| [s.from, s.from + s.along]).collect();
        let (low, high) = bounds(&ends).unwrap_or((Point::origin(), Point::origin()));
        let low = low - Vector::repeat(reach);
        let size = high + Vector::repeat(reach) - low;
        // Small cells make short lists; the cap keeps huge worlds within memory.
        let pitch = (size.x * size.y / 250_000.0).sqrt().max(0.05);
        let columns = (size.x / pitch) as usize + 1;
        let rows = (size.y / pitch) as usize + 1;
        let mut cells: Vec<Vec<u32>> = vec![Vec::new(); columns * rows];
        let near = reach + pitch * std::f64::consts::FRAC_1_SQRT_2;
        for (index, segment) in segments.iter().enumerate() {
            let to = segment.from + segment.along;
            let (a, b) = (segment.from.inf(&to) - low, segment.from.sup(&to) - low);
            let cell = |v: f64, most: usize| ((v / pitch).max(0.0) as usize).min(most - 1);
            for row in cell(a.y - near, rows)..=cell(b.y + near, rows) {
                for column in cell(a.x - near, columns)..=cell(b.x + near, columns) {
                    let middle = low
                        + Vector::new((column as f64 + 0.5) * pitch, (row as f64 + 0.5) * pitch);
                    if (segment.nearest(middle) - middle).norm() <= near {
                        cells[row * columns + column].push(index as u32);
                    }
                }
            }
        }
        let mut first = Vec::with_capacity(cells.len() + 1);
        let mut listed = Vec::new();
        for cell in &cells {
            first.push(listed.len() as u32);
            listed.extend(cell.iter().map(|&index| segments[index as usize]));
        }
        first.push(listed.len() as u32);
        Self { low, pitch, columns, rows, first, listed }
    }

    /// Every segment within reach of `p`, and perhaps some a little farther.
    #[must_use]
    pub fn near(&self, p: Point) -> &[Segment] {
        let off = (p - self.low) / self.pitch;
        if !(off.x >= 0.0 && off.y >= 0.0) {
            return &[];
        }
        let (column, row) = (off.x as usize, off.y as usize);
        if column >= self.columns || row >= self.rows {
            return &[];
        }
        let cell = row * self.columns + column;
        &self.listed[self.first[cell] as usize..self.first[cell + 1] as usize]
    }
}

/// The nearest point of `segments` to `p` and its distance; none without segments.
#[must_use]
pub fn nearest(segments: &[Segment], p: Point) -> Option<(Point, f64)> {
    let mut best: Option<(Point, f64)> = None;
    for segment in segments {
        let q = segment.nearest(p);
        let square = (q - p).norm_squared();
        if best.is_none_or(|(_, least)| square < least) {
            best = Some((q, square));
        }
    }
    best.map(|(q, square)| (q, square.sqrt()))
}

/// Distance along the ray from `from` in the unit direction `ray` to the first of `segments`;
/// infinite when it meets none.
#[must_use]
pub fn cast(segments: &[Segment], from: Point, ray: Vector) -> f64 {
    let mut best = f64::INFINITY;
    for segment in segments {
        let off = segment.from - from;
        let slope = cross(ray, segment.along);
        let along = cross(off, segment.along);
        let share = cross(off, ray);
        let (along, share, slope) =
            if slope < 0.0 { (-along, -share, -slope) } else { (along, share, slope) };
        if slope > 1e-14 && along >= 0.0 && share >= 0.0 && share <= slope && along < best * slope {
            best = along / slope;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::angle;
    use parry2d::math::Vector as ParryVector;
    use parry2d::query::{PointQuery, Ray, RayCast};
    use parry2d::shape::Polyline;

    #[test]
    fn answers_are_those_of_parry() {
        let text = "start = { x = 0.5, y = 0.5 }\n[boundary]\nvertices = [[0,0],[5,0],[5,4],[3,4,0.4142],[0,4]]\n[[objects]]\ncircle = { center = [2, 2], radius = 0.3 }\n";
        let world = World::from_toml(text, "test", 0.1).expect("a good world");
        let grid = ReachGrid::new(&world, 0.3);
        let lines: Vec<Polyline> = std::iter::once(&world.boundary)
            .chain(world.objects.iter().map(|o| &o.ring))
            .map(|ring| {
                let mut points: Vec<ParryVector> =
                    ring.to_points(SAGITTA).iter().map(|p| ParryVector::new(p.x, p.y)).collect();
                points.push(points[0]);
                Polyline::new(points, None)
            })
            .collect();
        let mut met = 0;
        for k in 0..4000 {
            let k = f64::from(k);
            let p = Point::new((k * 0.618_034).fract() * 5.0, (k * 0.414_214).fract() * 4.0);
            let direction = angle::unit(k * 0.7);
            let here = ParryVector::new(p.x, p.y);
            let ray = Ray::new(here, ParryVector::new(direction.x, direction.y));
            let theirs = lines
                .iter()
                .filter_map(|line| line.cast_local_ray(&ray, 0.3, false))
                .fold(f64::INFINITY, f64::min);
            let ours = cast(grid.near(p), p, direction);
            if theirs.is_finite() {
                met += 1;
                assert!((theirs - ours).abs() < 1e-9, "ray from {p}: parry {theirs}, grid {ours}");
            } else {
                assert!(ours > 0.3 - 1e-9, "ray from {p}: parry none, grid {ours}");
            }
            let far = lines
                .iter()
                .map(|line| line.distance_to_local_point(here, false))
                .fold(f64::INFINITY, f64::min);
            if far < 0.3 {
                let (_, ours) = nearest(grid.near(p), p).expect("a wall within reach");
                assert!((far - ours).abs() < 1e-9, "at {p}: parry {far}, grid {ours}");
            }
        }
        assert!(met > 100, "only {met} rays met anything");
    }
}
