//! Which cells lie within so much of a segment: a stadium is convex, so in each row they are one run of
//! columns, and a rim around another stadium two at most.

use super::Grid;
use crate::geometry::Vector;
use crate::geometry::segment::Segment;
use std::ops::Range;

impl Grid {
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

/// Like `f64::floor`, likewise.
fn floor(x: f64) -> i64 {
    let cut = x as i64;
    cut - i64::from(x < cut as f64)
}
