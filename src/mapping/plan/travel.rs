//! How far it is from one place to another for the robot, by a quick estimate: steps over a coarse
//! raster, counted with buckets (Dial 1969). Good to a few per cent; the router finds the ways.

use crate::geometry::Point;
use crate::geometry::raster::Grid;
use crate::mapping::floor::Floor;

/// Pitch of the coarse raster, metres, about.
const PITCH: f64 = 0.15;
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

/// Steps from one place to all others.
pub(super) struct From {
    at: Point,
    steps: Vec<u32>,
}

impl Travel {
    pub(super) fn new(floor: &Floor) -> Self {
        let fine = &floor.grid;
        let block = (PITCH / fine.cell).round().max(1.0) as usize;
        let middle = (block as f64 - 1.0) / 2.0 * fine.cell;
        let grid = Grid {
            origin: fine.origin + crate::geometry::Vector::new(middle, middle),
            cell: fine.cell * block as f64,
            width: fine.width.div_ceil(block),
            height: fine.height.div_ceil(block),
        };
        let mut open = vec![false; grid.len()];
        for (cell, &drivable) in floor.drivable.iter().enumerate() {
            let (x, y) = (cell % fine.width / block, cell / fine.width / block);
            open[y * grid.width + x] |= drivable;
        }
        Self { grid, open }
    }

    /// Steps from `at` to everywhere.
    pub(super) fn from(&self, at: Point) -> From {
        let mut steps = vec![u32::MAX; self.grid.len()];
        let mut buckets: [Vec<u32>; 8] = std::array::from_fn(|_| Vec::new());
        let start = self.grid.index(at);
        steps[start] = 0;
        buckets[0].push(start as u32);
        let (mut now, mut waiting) = (0_u32, 1_usize);
        while waiting > 0 {
            let mut due = std::mem::take(&mut buckets[now as usize % 8]);
            while let Some(cell) = due.pop() {
                waiting -= 1;
                if steps[cell as usize] == now {
                    waiting += self.relax(cell as usize, now, &mut steps, &mut buckets);
                }
            }
            now += 1;
        }
        From { at, steps }
    }

    fn relax(
        &self,
        cell: usize,
        now: u32,
        steps: &mut [u32],
        buckets: &mut [Vec<u32>; 8],
    ) -> usize {
        let (x, y) = (cell % self.grid.width, cell / self.grid.width);
        let mut pushed = 0;
        for ny in y.saturating_sub(1)..(y + 2).min(self.grid.height) {
            for nx in x.saturating_sub(1)..(x + 2).min(self.grid.width) {
                let near = ny * self.grid.width + nx;
                let cost = if nx != x && ny != y {
                    DIAGONAL
                } else {
                    STRAIGHT
                };
                if self.open[near] && now + cost < steps[near] {
                    steps[near] = now + cost;
                    buckets[(now + cost) as usize % 8].push(near as u32);
                    pushed += 1;
                }
            }
        }
        pushed
    }

    /// Estimated way from there to `to`, metres; infinite when none leads there.
    pub(super) fn length(&self, from: &From, to: Point) -> f64 {
        let straight = (to - from.at).norm();
        match from.steps[self.grid.index(to)] {
            u32::MAX => f64::INFINITY,
            steps => {
                let round = f64::from(steps) / f64::from(STRAIGHT) * self.grid.cell;
                straight.max(round * ROUNDABOUT - self.grid.cell)
            }
        }
    }
}
