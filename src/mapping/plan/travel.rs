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
    /// For each cell a bit for each of the eight steps that lead out of it, in the order of [`around`], and [`OPEN`]
    /// where there is floor at all.
    ways: Vec<u16>,
}

/// There is floor in the cell.
const OPEN: u16 = 1 << 8;
/// The steps to the right and upwards, and those back, as bits.
const RIGHT: u16 = 1;
const UP: u16 = 1 << 1;
const LEFT: u16 = 1 << 2;
const DOWN: u16 = 1 << 3;

/// What is added to an index modulo 2^64, and what that costs: steps to the eight cells around.
fn around(width: usize) -> [(usize, u32); 8] {
    [
        (1, STRAIGHT),
        (width, STRAIGHT),
        (1_usize.wrapping_neg(), STRAIGHT),
        (width.wrapping_neg(), STRAIGHT),
        (width + 1, DIAGONAL),
        (width - 1, DIAGONAL),
        ((width - 1).wrapping_neg(), DIAGONAL),
        ((width + 1).wrapping_neg(), DIAGONAL),
    ]
}

/// The diagonal steps of [`around`], each as the two straight ones that it is made of.
const CORNERS: [(u16, u16); 4] = [(RIGHT, UP), (LEFT, UP), (RIGHT, DOWN), (LEFT, DOWN)];

/// The ways out of each coarse cell of `grid`, `block` cells of the floor wide. Two of them are neighbours where floor
/// leads across their border: there is floor on both sides of a thin wall, and no step leads through that.
fn ways(floor: &Floor, grid: &Grid, block: usize) -> Vec<u16> {
    let width = floor.grid.width;
    let mut ways = vec![0; grid.len()];
    let coarse = |x: usize, row: usize| (row / block + 1) * grid.width + 1 + x / block;
    for (row, cells) in floor.drivable.chunks(width).enumerate() {
        for (x, _) in cells.iter().enumerate().filter(|(_, drivable)| **drivable) {
            let here = coarse(x, row);
            ways[here] |= OPEN;
            let beside = [(x + 1, row, RIGHT, LEFT), (x, row + 1, UP, DOWN)];
            for (x, row, there, back) in beside {
                let next = coarse(x, row);
                let drivable = x < width && floor.drivable.get(row * width + x) == Some(&true);
                if next != here && drivable {
                    ways[here] |= there;
                    ways[next] |= back;
                }
            }
        }
    }
    let around = around(grid.width);
    let leads = |from: usize, by: u16| {
        let (offset, _) = around[by.trailing_zeros() as usize];
        (ways[from] & by != 0).then(|| from.wrapping_add(offset))
    };
    let diagonal = |cell: usize| {
        let bits = CORNERS.iter().zip(4..).filter(|((a, b), _)| {
            let round = |one, other| leads(cell, one).is_some_and(|next| ways[next] & other != 0);
            round(*a, *b) || round(*b, *a)
        });
        bits.fold(0, |all, (_, bit)| all | 1 << bit)
    };
    let diagonals: Vec<u16> = (0..ways.len()).map(diagonal).collect();
    ways.iter().zip(diagonals).map(|(straight, diagonal)| straight | diagonal).collect()
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
        let ways = ways(floor, &grid, block);
        Self { grid, ways }
    }

    /// The cell that `at` lies in, or the nearest within the rim.
    pub(super) fn cell(&self, at: Point) -> usize {
        let (x, y) = self.grid.locate(at);
        let inner = |v: usize, most: usize| v.clamp(1, most.saturating_sub(2).max(1));
        inner(y, self.grid.height) * self.grid.width + inner(x, self.grid.width)
    }

    /// Steps from the cell `start` to everywhere.
    pub(super) fn from(&self, start: usize) -> Steps {
        let around = around(self.grid.width);
        // Closed cells count as reached at once.
        let mut steps: Vec<u32> =
            self.ways.iter().map(|ways| if ways & OPEN != 0 { u32::MAX } else { 0 }).collect();
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
                // Only the first may have no floor: it is left whatever way there is.
                let ways = self.ways[cell as usize];
                let mut ways = if ways & OPEN == 0 { 0xff } else { ways & !OPEN };
                while ways != 0 {
                    let (offset, cost) = around[ways.trailing_zeros() as usize];
                    ways &= ways - 1;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::floor::rooms;

    /// Whatever cells a wall lies in, and however thin it is: the way leads round it.
    #[test]
    fn no_way_leads_through_a_thin_wall() {
        for thick in [0.02, 0.05, 0.1, 0.15] {
            for k in 0..12 {
                let x = 2.0 + 0.015 * f64::from(k);
                let bent = [
                    (0.0, 0.0),
                    (4.0, 0.0),
                    (4.0, 3.0),
                    (x + thick, 3.0),
                    (x + thick, 0.6137),
                    (x, 0.6137),
                    (x, 3.0),
                    (0.0, 3.0),
                ];
                let floor = rooms::floor(&rooms::polygon(&bent), &[]);
                let travel = Travel::new(&floor);
                let (a, b) = (Point::new(x - 0.3, 2.7), Point::new(x + thick + 0.3, 2.7));
                let told = travel.length(&travel.from(travel.cell(a)), a, b);
                let real = floor.route_length(a, b, 0.12).expect("a way");
                assert!((0.8..1.2).contains(&(told / real)), "{thick} m at {x}: {told} for {real}");
            }
        }
    }
}
