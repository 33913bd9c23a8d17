//! How far it is from one place to another for the robot, by a quick estimate: steps over a coarse
//! raster, counted with buckets (Dial 1969). Good to a few per cent; the router finds the ways.

use crate::geometry::Point;
use crate::geometry::raster::Grid;
use crate::mapping::floor::Floor;

/// Pitch of the coarse raster, metres, about.
const PITCH: f64 = 0.18;
/// Costs of a straight and a diagonal step: 7 / 5 is near enough to the root of two.
const STRAIGHT: u32 = 5;
const DIAGONAL: u32 = 7;
/// A way over eight directions is this much longer than the true one on the average.
const ROUNDABOUT: f64 = 0.95;

/// The coarse raster of one floor.
pub(super) struct Travel {
    grid: Grid,
    open: Vec<bool>,
}

/// Steps from one cell to all others.
pub(super) struct Steps(Vec<u32>);

impl Travel {
    pub(super) fn new(floor: &Floor) -> Self {
        let fine = &floor.grid;
        let block = (PITCH / fine.cell).round().max(1.0) as usize;
        let middle = (block as f64 - 1.0) / 2.0 * fine.cell;
        let cell = fine.cell * block as f64;
        // A rim of closed cells all round: no step needs to ask whether it leaves the raster.
        let shift = crate::geometry::Vector::new(middle - cell, middle - cell);
        let grid = Grid {
            origin: fine.origin + shift,
            cell,
            width: fine.width.div_ceil(block) + 2,
            height: fine.height.div_ceil(block) + 2,
        };
        let mut open = vec![false; grid.len()];
        for (row, cells) in floor.drivable.chunks(fine.width).enumerate() {
            let base = (row / block + 1) * grid.width + 1;
            for (x, &drivable) in cells.iter().enumerate() {
                open[base + x / block] |= drivable;
            }
        }
        Self { grid, open }
    }

    /// The cell that `at` lies in, or the nearest within the rim.
    pub(super) fn cell(&self, at: Point) -> usize {
        let (x, y) = self.grid.locate(at);
        let inner = |v: usize, most: usize| v.clamp(1, most.saturating_sub(2).max(1));
        inner(y, self.grid.height) * self.grid.width + inner(x, self.grid.width)
    }

    /// Steps from the cell `start` to everywhere.
    pub(super) fn from(&self, start: usize) -> Steps {
        let width = self.grid.width;
        // What is added to an index modulo 2^64: steps to the eight cells around.
        let around = [
            (1, STRAIGHT),
            (width, STRAIGHT),
            (1_usize.wrapping_neg(), STRAIGHT),
            (width.wrapping_neg(), STRAIGHT),
            (width + 1, DIAGONAL),
            (width - 1, DIAGONAL),
            ((width + 1).wrapping_neg(), DIAGONAL),
            ((width - 1).wrapping_neg(), DIAGONAL),
        ];
        // Closed cells count as reached at once, so that one comparison tells both.
        let mut steps: Vec<u32> = self.open.iter().map(|&o| if o { u32::MAX } else { 0 }).collect();
        let mut buckets: [Vec<u32>; 8] = std::array::from_fn(|_| Vec::new());
        steps[start] = 1;
        buckets[1].push(start as u32);
        let (mut now, mut waiting) = (1_u32, 1_usize);
        let mut due: Vec<u32> = Vec::new();
        while waiting > 0 {
            due.clear();
            std::mem::swap(&mut due, &mut buckets[now as usize % 8]);
            waiting -= due.len();
            for &cell in &due {
                if steps[cell as usize] != now {
                    continue;
                }
                for (offset, cost) in around {
                    let near = (cell as usize).wrapping_add(offset);
                    if now + cost < steps[near] {
                        steps[near] = now + cost;
                        buckets[(now + cost) as usize % 8].push(near as u32);
                        waiting += 1;
                    }
                }
            }
            now += 1;
        }
        Steps(steps)
    }

    /// Estimated way from `at`, in the cell that the steps were counted from, to `to`, metres;
    /// infinite when none leads there.
    pub(super) fn length(&self, steps: &Steps, at: Point, to: Point) -> f64 {
        let straight = (to - at).norm();
        match steps.0[self.grid.index(to)] {
            0 | u32::MAX => f64::INFINITY,
            steps => {
                let round = f64::from(steps - 1) / f64::from(STRAIGHT) * self.grid.cell;
                straight.max(round * ROUNDABOUT - self.grid.cell)
            }
        }
    }
}
