//! A lattice of points over a piece of the plane: which of them lie inside outlines, which near to a segment
//! (`stadium`), and how far each is from the nearest of many (`nearest`), to single precision whatever the
//! pitch. Knows nothing of what the cells stand for.

mod nearest;
mod stadium;

pub use nearest::{Ruler, squared_distances};

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
            // By way of 32 bits, which machines convert in one instruction.
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
