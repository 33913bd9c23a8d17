//! A lattice of points over a piece of the plane, and the distance from each of them to the
//! nearest of some segments. The distances are exact for the segment found, whatever the pitch.

use super::segment::Segment;
use super::{Point, Vector, cross};
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
        // Rounded by cutting; what is below zero comes to the cell at the rim either way.
        let clamp = |v: f64, most: usize| ((v + 0.5).max(0.0) as usize).min(most - 1);
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
            let low = (v as u32 as usize).min(most.saturating_sub(2));
            (low, v - low as f64)
        };
        let ((x, u), (y, v)) = (split(at.x, self.width), split(at.y, self.height));
        let corner = y * self.width + x;
        let pair = |at: usize| {
            let next = values.get(at + 1).unwrap_or(&values[at]);
            f64::from(values[at]) * (1.0 - u) + f64::from(*next) * u
        };
        let below = pair(corner);
        // A raster of one row has nothing above it.
        let above = if self.height > 1 { pair(corner + self.width) } else { below };
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
    radius: f64,
    /// The lower end and the upper one, from the grid's origin.
    ends: [Vector; 2],
    left: Flank,
    right: Flank,
    /// The rows that it may cut.
    rows: Range<usize>,
}

/// One of a stadium's straight sides, and between which heights it lies: below, the lower end's
/// cap is the rim, and above, the upper end's.
struct Flank {
    low: f64,
    high: f64,
    /// Where it begins, at the height `low`.
    x: f64,
    slope: f64,
}

impl Flank {
    fn new([lower, upper]: [Vector; 2], side: Vector) -> Self {
        let along = upper - lower;
        let slope = if along.y > 0.0 { along.x / along.y } else { 0.0 };
        Self { low: lower.y + side.y, high: upper.y + side.y, x: lower.x + side.x, slope }
    }
}

impl<'a> Slice<'a> {
    fn new(grid: &'a Grid, segment: &Segment, radius: f64) -> Self {
        let (a, b) = (segment.from - grid.origin, segment.to() - grid.origin);
        let ends = if a.y <= b.y { [a, b] } else { [b, a] };
        let first = ceil((ends[0].y - radius) / grid.cell);
        let end = floor((ends[1].y + radius) / grid.cell) + 1;
        let along = (ends[1] - ends[0]).try_normalize(1e-12).unwrap_or_else(Vector::x);
        let left = Vector::new(-along.y, along.x) * radius;
        Self {
            grid,
            radius,
            ends,
            left: Flank::new(ends, left),
            right: Flank::new(ends, -left),
            rows: first.max(0) as usize..(end.max(0) as usize).min(grid.height),
        }
    }

    /// First and last cell in `row`, if there is one.
    fn run(&self, row: usize) -> Option<(usize, usize)> {
        let y = self.rows.contains(&row).then_some(row as f64 * self.grid.cell)?;
        let low = ceil(self.rim(&self.left, -1.0, y) / self.grid.cell).max(0);
        let high = floor(self.rim(&self.right, 1.0, y) / self.grid.cell);
        let any = high >= low && (low as usize) < self.grid.width;
        any.then(|| (low as usize, (high as usize).min(self.grid.width - 1)))
    }

    /// Where the rim is at the height `y`, on the side towards `sign` along x.
    fn rim(&self, flank: &Flank, sign: f64, y: f64) -> f64 {
        let cap = |end: Vector| {
            let off = y - end.y;
            end.x + sign * (self.radius * self.radius - off * off).max(0.0).sqrt()
        };
        if y < flank.low {
            cap(self.ends[0])
        } else if y > flank.high {
            cap(self.ends[1])
        } else {
            flank.x + (y - flank.low) * flank.slope
        }
    }
}

/// Like `f64::ceil`, without the call that it is on machines without an instruction for it.
fn ceil(x: f64) -> i64 {
    let cut = x as i64;
    cut + i64::from(x > cut as f64)
}

fn floor(x: f64) -> i64 {
    let cut = x as i64;
    cut - i64::from(x < cut as f64)
}

/// Measures rows of cells from one segment. In single precision, good for a few parts in ten
/// million of the distance and of the row's length: a machine does several cells at a time.
pub struct Ruler<'a> {
    grid: &'a Grid,
    from: Point,
    along: Vector,
    length: f32,
    /// How much further ahead and to the left of the segment each next cell is.
    step: (f32, f32),
}

impl<'a> Ruler<'a> {
    /// For the cells of `grid`.
    #[must_use]
    pub fn new(grid: &'a Grid, segment: &Segment) -> Self {
        let length = segment.length();
        let along = if length > 0.0 { segment.along / length } else { Vector::x() };
        let step = ((along.x * grid.cell) as f32, (-along.y * grid.cell) as f32);
        Self { grid, from: segment.from, along, length: length as f32, step }
    }

    /// Calls `each` with the value of every one of `cells`, which lie side by side from column
    /// `first` of row `row` on, and its squared distance from the segment, square metres.
    #[inline]
    pub fn measure(
        &self,
        (first, row): (usize, usize),
        cells: &mut [f32],
        mut each: impl FnMut(&mut f32, f32),
    ) {
        let from = self.grid.center(first, row) - self.from;
        let (ahead, aside) = (from.dot(&self.along) as f32, cross(self.along, from) as f32);
        for (k, value) in cells.iter_mut().enumerate() {
            let k = k as u32 as f32;
            let (ahead, aside) = (ahead + k * self.step.0, aside + k * self.step.1);
            let beyond = (ahead - self.length).max(-ahead).max(0.0);
            each(value, aside * aside + beyond * beyond);
        }
    }
}

/// Squared distance from every cell of `grid` to the nearest of `segments`, square metres, to the
/// precision of [`Ruler`]; infinite where there are none.
///
/// By halving blocks: of the segments that may be nearest somewhere in a block, only those no
/// further from its middle than the nearest one plus the block's diagonal can be nearest in it.
/// What is left in a small block is measured from every cell.
#[must_use]
pub fn squared_distances(grid: &Grid, segments: &[Segment]) -> Vec<f32> {
    let mut field = Nearest { grid, segments, squared: vec![f32::INFINITY; grid.len()] };
    let mut stack: Vec<u32> = (0..segments.len() as u32).collect();
    if !stack.is_empty() {
        let whole = Block { x: 0, y: 0, width: grid.width, height: grid.height };
        field.fill(&whole, &mut stack, 0);
    }
    field.squared
}

/// [`squared_distances`] in the making.
struct Nearest<'a> {
    grid: &'a Grid,
    segments: &'a [Segment],
    squared: Vec<f32>,
}

/// Blocks of at most this many cells a side are filled cell by cell.
const LEAF: usize = 16;

impl Nearest<'_> {
    /// Fills `block` from the candidates on `stack` from `base` on; leaves the stack as it was.
    fn fill(&mut self, block: &Block, stack: &mut Vec<u32>, base: usize) {
        let (segments, top) = (self.segments, stack.len());
        let (middle, half) = block.middle(self.grid);
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
            self.measure(block, &stack[top..]);
        } else {
            for part in block.halves().into_iter().flatten() {
                self.fill(&part, stack, top);
            }
        }
        stack.truncate(top);
    }

    fn measure(&mut self, block: &Block, candidates: &[u32]) {
        for &number in candidates {
            let ruler = Ruler::new(self.grid, &self.segments[number as usize]);
            for y in block.y..block.y + block.height {
                let begin = y * self.grid.width + block.x;
                let cells = &mut self.squared[begin..begin + block.width];
                ruler.measure((block.x, y), cells, |value, square| *value = value.min(square));
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
