//! How far the cells are from segments: from one along rows, and from the nearest of many everywhere.

use super::Grid;
use crate::geometry::segment::Segment;
use crate::geometry::{Point, Vector, cross};

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
            let beyond = larger(larger(ahead - self.length, -ahead), 0.0);
            each(value, aside * aside + beyond * beyond);
        }
    }
}

/// The larger of two numbers, one instruction where `f32::max`, which minds what is no number, takes three.
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Squared distance from every cell of `grid` to the nearest of `segments`, square metres, to the
/// precision of [`Ruler`]; infinite where there are none.
///
/// By halving blocks: of the segments that may be nearest somewhere in a block, only those no
/// further from its middle than the nearest one plus the block's diagonal can be nearest in it.
/// What is left in a small block is measured from every cell.
#[must_use]
pub fn squared_distances(grid: &Grid, segments: &[Segment]) -> Vec<f32> {
    let rulers = segments.iter().map(|segment| Ruler::new(grid, segment)).collect();
    let mut field = Nearest { grid, segments, rulers, squared: vec![f32::INFINITY; grid.len()] };
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
    rulers: Vec<Ruler<'a>>,
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
            let ruler = &self.rulers[number as usize];
            for y in block.y..block.y + block.height {
                let begin = y * self.grid.width + block.x;
                let cells = &mut self.squared[begin..begin + block.width];
                ruler.measure((block.x, y), cells, |value, square| {
                    *value = if square < *value { square } else { *value };
                });
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
