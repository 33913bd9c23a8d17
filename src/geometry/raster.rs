//! A lattice of points over a piece of the plane, and the distance from each of them to the
//! nearest of some segments. The distances are exact for the segment found, whatever the pitch.

use super::segment::Segment;
use super::{Point, Vector};
use std::ops::Range;

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

    /// The eight cells around a cell, straight ones first, as far as they exist.
    #[must_use]
    pub fn neighbours(&self, cell: usize) -> [Option<usize>; 8] {
        let (x, y) = (cell % self.width, cell / self.width);
        let (w, e) = (x > 0, x + 1 < self.width);
        let (s, n) = (y > 0, y + 1 < self.height);
        let up = cell + self.width;
        let at = |there: bool, index: usize| there.then_some(index);
        [
            at(e, cell + 1),
            at(n, up),
            at(w, cell.wrapping_sub(1)),
            at(s, cell.wrapping_sub(self.width)),
            at(e && n, up + 1),
            at(w && n, up.wrapping_sub(1)),
            at(w && s, cell.wrapping_sub(self.width + 1)),
            at(e && s, cell.wrapping_sub(self.width).wrapping_add(1)),
        ]
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
        let slice = Slice::new(self, segment, radius);
        for row in slice.rows.clone() {
            if let Some((first, last)) = slice.run(row) {
                visit(row, first, last);
            }
        }
    }

    /// The same without the cells that [`Grid::stadium_runs`] visits for the radius `inner`, if that is
    /// more than nothing: up to two runs in each row.
    pub fn rim_runs(
        &self,
        segment: &Segment,
        (inner, outer): (f64, f64),
        mut visit: impl FnMut(usize, usize, usize),
    ) {
        let hole = (inner > 0.0).then(|| Slice::new(self, segment, inner));
        let slice = Slice::new(self, segment, outer);
        for row in slice.rows.clone() {
            let Some((first, last)) = slice.run(row) else { continue };
            match hole.as_ref().and_then(|hole| hole.run(row)) {
                None => visit(row, first, last),
                Some((from, to)) => {
                    if first < from {
                        visit(row, first, from - 1);
                    }
                    if to < last {
                        visit(row, to + 1, last);
                    }
                }
            }
        }
    }
}

/// Horizontal slices through the stadium around a segment, as runs of a grid's cells.
struct Slice<'a> {
    grid: &'a Grid,
    a: Vector,
    b: Vector,
    radius: f64,
    /// From the segment to its left side, `radius` long.
    side: Vector,
    slope: f64,
    /// The rows that it may cut.
    rows: Range<usize>,
}

impl<'a> Slice<'a> {
    fn new(grid: &'a Grid, segment: &Segment, radius: f64) -> Self {
        let (a, b) = (segment.from - grid.origin, segment.to() - grid.origin);
        let first = ((a.y.min(b.y) - radius) / grid.cell).ceil().max(0.0);
        let end = ((a.y.max(b.y) + radius) / grid.cell).floor() + 1.0;
        let rows = first as usize..(end.max(0.0) as usize).min(grid.height);
        let along = b - a;
        let side = along
            .try_normalize(1e-12)
            .map_or_else(Vector::zeros, |u| Vector::new(-u.y, u.x) * radius);
        let slope = if along.y.abs() > 1e-12 { along.x / along.y } else { f64::INFINITY };
        Self { grid, a, b, radius, side, slope, rows }
    }

    /// First and last cell in `row`, if there is one.
    fn run(&self, row: usize) -> Option<(usize, usize)> {
        let y = self.rows.contains(&row).then_some(row as f64 * self.grid.cell)?;
        let (low, high) = self.at(y)?;
        let low = (low / self.grid.cell).ceil().max(0.0);
        let high = (high / self.grid.cell).floor();
        let any = high >= low && low < self.grid.width as f64;
        any.then(|| (low as usize, (high as usize).min(self.grid.width - 1)))
    }

    /// From where to where the row at height `y` is cut.
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

/// Blocks of at most this many cells a side are filled cell by cell.
const LEAF: usize = 8;

impl Nearest {
    /// The transform, by halving blocks: of the segments that may be nearest somewhere in a block,
    /// only those no further from its middle than the nearest one plus the block's diagonal can be
    /// nearest in it. What is left in a small block is measured from every cell.
    #[must_use]
    pub fn new(grid: &Grid, segments: &[Segment]) -> Self {
        let mut field =
            Self { which: vec![u32::MAX; grid.len()], squared: vec![f32::INFINITY; grid.len()] };
        let mut stack: Vec<u32> = (0..segments.len() as u32).collect();
        if !stack.is_empty() {
            let whole = Block { x: 0, y: 0, width: grid.width, height: grid.height };
            field.fill(grid, segments, &whole, &mut stack, 0);
        }
        field
    }

    /// Fills `block` from the candidates on `stack` from `base` on; leaves the stack as it was.
    fn fill(
        &mut self,
        grid: &Grid,
        segments: &[Segment],
        block: &Block,
        stack: &mut Vec<u32>,
        base: usize,
    ) {
        let top = stack.len();
        let (middle, half) = block.middle(grid);
        if top - base > 1 {
            let mut least = f64::INFINITY;
            let mut squares: [f64; 64] = [0.0; 64];
            for (k, &number) in stack[base..top].iter().enumerate() {
                let square = segments[number as usize].distance_squared(middle);
                squares[k % 64] = square;
                least = least.min(square);
            }
            let most = least.sqrt() + 2.0 * half;
            let most = most * most;
            let few = top - base <= 64;
            for k in 0..top - base {
                let number = stack[base + k];
                let square = if few {
                    squares[k]
                } else {
                    segments[number as usize].distance_squared(middle)
                };
                if square <= most {
                    stack.push(number);
                }
            }
        } else {
            stack.push(stack[base]);
        }
        if block.width <= LEAF && block.height <= LEAF {
            self.measure(grid, segments, block, &stack[top..]);
        } else {
            for part in block.halves().into_iter().flatten() {
                self.fill(grid, segments, &part, stack, top);
            }
        }
        stack.truncate(top);
    }

    fn measure(&mut self, grid: &Grid, segments: &[Segment], block: &Block, candidates: &[u32]) {
        for y in block.y..block.y + block.height {
            for x in block.x..block.x + block.width {
                let at = grid.center(x, y);
                let (mut best, mut which) = (f64::INFINITY, u32::MAX);
                for &number in candidates {
                    let square = segments[number as usize].distance_squared(at);
                    if square < best {
                        (best, which) = (square, number);
                    }
                }
                let cell = y * grid.width + x;
                self.squared[cell] = best as f32;
                self.which[cell] = which;
            }
        }
    }
}

/// A rectangle of cells.
struct Block {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
}

impl Block {
    /// Its middle, and the distance from there to the centre of a corner cell, metres.
    fn middle(&self, grid: &Grid) -> (Point, f64) {
        let size = Vector::new(self.width as f64 - 1.0, self.height as f64 - 1.0) * grid.cell;
        (grid.center(self.x, self.y) + size / 2.0, size.norm() / 2.0)
    }

    /// The block cut in two across its longer side.
    fn halves(&self) -> [Option<Self>; 2] {
        let cut = |length: usize| (length / 2).max(1);
        let (near, far) = if self.width >= self.height {
            let w = cut(self.width);
            let near = Self { width: w, ..*self };
            let far = Self { x: self.x + w, width: self.width - w, ..*self };
            (near, far)
        } else {
            let h = cut(self.height);
            let near = Self { height: h, ..*self };
            let far = Self { y: self.y + h, height: self.height - h, ..*self };
            (near, far)
        };
        [near, far].map(|b| (b.width > 0 && b.height > 0).then_some(b))
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
mod tests;
