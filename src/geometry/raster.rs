//! A lattice of points over a piece of the plane, and the distance from each of them to the
//! nearest of some segments. The distances are exact for the segment found, whatever the pitch.

use super::segment::Segment;
use super::{Point, Vector};

/// Square cells over a box; a cell stands for its centre.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Centre of the first cell.
    pub origin: Point,
    /// Pitch, metres.
    pub cell: f64,
    /// Cells in a row (along x).
    pub width: usize,
    /// Rows (along y).
    pub height: usize,
}

impl Grid {
    /// Cells of pitch `cell` over the box from `low` to `high`, with a margin around it.
    #[must_use]
    pub fn over(low: Point, high: Point, cell: f64, margin: f64) -> Self {
        let size = high - low;
        let count = |length: f64| ((length + 2.0 * margin) / cell).ceil().max(1.0) as usize + 1;
        Self {
            origin: low - Vector::new(margin, margin),
            cell,
            width: count(size.x),
            height: count(size.y),
        }
    }

    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.width * self.height
    }

    /// Whether there are no cells.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Centre of the cell in column `x` and row `y`.
    #[must_use]
    pub fn center(&self, x: usize, y: usize) -> Point {
        self.origin + Vector::new(x as f64, y as f64) * self.cell
    }

    /// Centre of cell `index`.
    #[must_use]
    pub fn point(&self, index: usize) -> Point {
        self.center(index % self.width, index / self.width)
    }

    /// Column and row of the cell nearest to `p`; points outside get the cell at the rim.
    #[must_use]
    pub fn locate(&self, p: Point) -> (usize, usize) {
        let at = (p - self.origin) / self.cell;
        let clamp = |v: f64, most: usize| (v.round().max(0.0) as usize).min(most - 1);
        (clamp(at.x, self.width), clamp(at.y, self.height))
    }

    /// Index of the cell nearest to `p`.
    #[must_use]
    pub fn index(&self, p: Point) -> usize {
        let (x, y) = self.locate(p);
        y * self.width + x
    }

    /// The value of a raster at `p`, blended from the four cells around it; beyond the rim, that
    /// of the rim.
    #[must_use]
    pub fn blend(&self, values: &[f32], p: Point) -> f64 {
        let at = (p - self.origin) / self.cell;
        let split = |v: f64, most: usize| {
            let v = v.clamp(0.0, most as f64 - 1.0);
            let low = (v as usize).min(most.saturating_sub(2));
            (low, v - low as f64)
        };
        let ((x, u), (y, v)) = (split(at.x, self.width), split(at.y, self.height));
        let corner = y * self.width + x;
        let read = |k: usize| f64::from(values[k.min(values.len() - 1)]);
        let below = read(corner) * (1.0 - u) + read(corner + 1) * u;
        let above = read(corner + self.width) * (1.0 - u) + read(corner + self.width + 1) * u;
        below * (1.0 - v) + above * v
    }

    /// Calls `visit(row, first, last)` with the cells whose centres lie within `radius` of
    /// `segment`: in each row they are one run of columns, because the stadium is convex.
    pub fn stadium_runs(
        &self,
        segment: &Segment,
        radius: f64,
        mut visit: impl FnMut(usize, usize, usize),
    ) {
        let (a, b) = (segment.from - self.origin, segment.to() - self.origin);
        let first = ((a.y.min(b.y) - radius) / self.cell).ceil().max(0.0);
        let last = ((a.y.max(b.y) + radius) / self.cell).floor();
        if last < first {
            return;
        }
        let last = (last as usize).min(self.height.saturating_sub(1));
        let slice = Slice::new(a, b, radius);
        for row in first as usize..=last {
            let Some((low, high)) = slice.at(row as f64 * self.cell) else {
                continue;
            };
            let low = (low / self.cell).ceil().max(0.0);
            let high = (high / self.cell).floor();
            if high >= low && low < self.width as f64 {
                visit(row, low as usize, (high as usize).min(self.width - 1));
            }
        }
    }
}

/// Horizontal slices through the stadium around a segment.
struct Slice {
    a: Vector,
    b: Vector,
    radius: f64,
    /// From the segment to its left side, `radius` long.
    side: Vector,
    slope: f64,
}

impl Slice {
    fn new(a: Vector, b: Vector, radius: f64) -> Self {
        let along = b - a;
        let side = along
            .try_normalize(1e-12)
            .map_or_else(Vector::zeros, |u| Vector::new(-u.y, u.x) * radius);
        let slope = if along.y.abs() > 1e-12 {
            along.x / along.y
        } else {
            f64::INFINITY
        };
        Self {
            a,
            b,
            radius,
            side,
            slope,
        }
    }

    fn at(&self, y: f64) -> Option<(f64, f64)> {
        let mut span: Option<(f64, f64)> = None;
        let mut add = |low: f64, high: f64| {
            span = Some(span.map_or((low, high), |(l, h)| (l.min(low), h.max(high))));
        };
        for end in [self.a, self.b] {
            let off = y - end.y;
            let square = self.radius * self.radius - off * off;
            if square >= 0.0 {
                let half = square.sqrt();
                add(end.x - half, end.x + half);
            }
        }
        if self.slope.is_finite() {
            for side in [self.side, -self.side] {
                let (p, q) = (self.a + side, self.b + side);
                if (y - p.y) * (y - q.y) <= 0.0 {
                    let x = p.x + (y - p.y) * self.slope;
                    add(x, x);
                }
            }
        }
        span
    }
}

/// For every cell of a grid the nearest of some segments.
#[derive(Debug, Clone, PartialEq)]
pub struct Nearest {
    /// Index of the nearest segment; `u32::MAX` where there is none at all.
    pub which: Vec<u32>,
    /// Squared distance to it, square metres.
    pub squared: Vec<f32>,
}

impl Nearest {
    /// The transform: cells at the segments first, the rest by handing the nearest segment on to
    /// the neighbours in two sweeps (Danielsson 1980), each with its exact distance.
    #[must_use]
    pub fn new(grid: &Grid, segments: &[Segment]) -> Self {
        let mut field = Self {
            which: vec![u32::MAX; grid.len()],
            squared: vec![f32::INFINITY; grid.len()],
        };
        field.seed(grid, segments);
        field.spread(grid, segments);
        field
    }

    fn seed(&mut self, grid: &Grid, segments: &[Segment]) {
        for (number, segment) in segments.iter().enumerate() {
            grid.stadium_runs(segment, grid.cell * 0.75, |row, first, last| {
                for x in first..=last {
                    let square = segment.distance_squared(grid.center(x, row)) as f32;
                    let cell = row * grid.width + x;
                    if square < self.squared[cell] {
                        self.squared[cell] = square;
                        self.which[cell] = number as u32;
                    }
                }
            });
        }
    }

    fn spread(&mut self, grid: &Grid, segments: &[Segment]) {
        let (width, height) = (grid.width, grid.height);
        for y in 0..height {
            if y > 0 {
                self.row_from(grid, segments, y, y - 1);
            }
            self.along(grid, segments, y);
        }
        for y in (0..height.saturating_sub(1)).rev() {
            self.row_from(grid, segments, y, y + 1);
            self.along(grid, segments, y);
        }
        debug_assert_eq!(self.which.len(), width * height);
    }

    /// Takes over what the row `other` knows, straight and diagonally.
    fn row_from(&mut self, grid: &Grid, segments: &[Segment], y: usize, other: usize) {
        for x in 0..grid.width {
            let (cell, near) = (y * grid.width + x, other * grid.width + x);
            let at = grid.center(x, y);
            self.take(segments, cell, near, at);
            if x > 0 {
                self.take(segments, cell, near - 1, at);
            }
            if x + 1 < grid.width {
                self.take(segments, cell, near + 1, at);
            }
        }
    }

    fn along(&mut self, grid: &Grid, segments: &[Segment], y: usize) {
        let row = y * grid.width;
        for x in 1..grid.width {
            self.take(segments, row + x, row + x - 1, grid.center(x, y));
        }
        for x in (0..grid.width.saturating_sub(1)).rev() {
            self.take(segments, row + x, row + x + 1, grid.center(x, y));
        }
    }

    fn take(&mut self, segments: &[Segment], cell: usize, from: usize, at: Point) {
        let offered = self.which[from];
        // Most neighbours share their nearest segment: nothing to measure then.
        if offered == self.which[cell] || offered == u32::MAX {
            return;
        }
        let square = segments[offered as usize].distance_squared(at) as f32;
        if square < self.squared[cell] {
            self.squared[cell] = square;
            self.which[cell] = offered;
        }
    }
}

/// Marks the cells whose centres lie inside the closed outlines that `segments` make (even-odd).
#[must_use]
pub fn inside(grid: &Grid, segments: &[Segment]) -> Vec<bool> {
    let mut crossings: Vec<Vec<f64>> = vec![Vec::new(); grid.height];
    for segment in segments {
        let (a, b) = (segment.from - grid.origin, segment.to() - grid.origin);
        let (low, high) = (a.y.min(b.y) / grid.cell, a.y.max(b.y) / grid.cell);
        // Half open, so that a row through a vertex counts it once.
        let first = low.ceil().max(0.0) as usize;
        let end = (high.ceil().max(0.0) as usize).min(grid.height);
        for (row, found) in crossings.iter_mut().enumerate().take(end).skip(first) {
            let t = (row as f64 * grid.cell - a.y) / (b.y - a.y);
            found.push((a.x + (b.x - a.x) * t) / grid.cell);
        }
    }
    let mut marked = vec![false; grid.len()];
    for (row, found) in crossings.iter_mut().enumerate() {
        found.sort_by(f64::total_cmp);
        for pair in found.chunks_exact(2) {
            let first = pair[0].ceil().max(0.0) as usize;
            let end = ((pair[1].floor() + 1.0).max(0.0) as usize).min(grid.width);
            if first < end {
                marked[row * grid.width + first..row * grid.width + end].fill(true);
            }
        }
    }
    marked
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ring;
    use crate::geometry::segment::chords;

    fn ell() -> Vec<Segment> {
        let at = |x: f64, y: f64| Point::new(x, y);
        chords(
            &Ring::polygon(&[
                at(0.0, 0.0),
                at(4.0, 0.3),
                at(4.0, 1.5),
                at(2.0, 1.5),
                at(2.1, 3.0),
                at(0.0, 3.0),
            ]),
            1e-3,
        )
    }

    #[test]
    fn the_transform_agrees_with_measuring_every_segment_from_every_cell() {
        let segments = ell();
        let grid = Grid::over(Point::new(0.0, 0.0), Point::new(4.0, 3.0), 0.037, 0.1);
        let field = Nearest::new(&grid, &segments);
        for cell in 0..grid.len() {
            let at = grid.point(cell);
            let want = segments
                .iter()
                .map(|s| s.distance_squared(at))
                .fold(f64::INFINITY, f64::min)
                .sqrt();
            let got = f64::from(field.squared[cell]).sqrt();
            assert!((got - want).abs() < 1e-4, "{got} instead of {want} at {at}");
        }
    }

    #[test]
    fn runs_of_a_stadium_are_the_cells_within_its_radius() {
        let grid = Grid::over(Point::new(0.0, 0.0), Point::new(4.0, 3.0), 0.05, 0.0);
        let ends = [
            ((1.0, 1.0), (3.0, 2.0)),
            ((1.0, 1.0), (3.0, 1.0)),
            ((2.0, 0.0), (2.0, 4.0)),
            ((3.0, 0.2), (-1.0, 2.9)),
            ((1.01, 1.02), (1.01, 1.02)),
        ];
        for (a, b) in ends {
            let segment = Segment::new(Point::new(a.0, a.1), Point::new(b.0, b.1));
            let mut seen = vec![false; grid.len()];
            grid.stadium_runs(&segment, 0.28, |row, first, last| {
                seen[row * grid.width + first..=row * grid.width + last].fill(true);
            });
            for (cell, &found) in seen.iter().enumerate() {
                let off = segment.distance_squared(grid.point(cell)).sqrt() - 0.28;
                if off.abs() > 1e-9 {
                    assert_eq!(found, off < 0.0, "{a:?} to {b:?}, at {}", grid.point(cell));
                }
            }
        }
    }

    #[test]
    fn cells_inside_are_those_the_ring_contains() {
        let segments = ell();
        let ring = Ring::polygon(&segments.iter().map(|s| s.from).collect::<Vec<_>>());
        let grid = Grid::over(Point::new(0.0, 0.0), Point::new(4.0, 3.0), 0.0411, 0.1);
        for (cell, &marked) in inside(&grid, &segments).iter().enumerate() {
            let at = grid.point(cell);
            if ring.distance(at) > 1e-9 {
                assert_eq!(marked, ring.contains(at), "at {at}");
            }
        }
    }
}
