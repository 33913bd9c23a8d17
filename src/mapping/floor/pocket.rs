//! Pockets: pieces of the floor where the body would fit and to which it is not sent, because only narrow places
//! lead there; and how wide those are. The raster does not tell that to a centimetre; the outlines do.

use super::reach::fill;
use super::{Floor, SPARE};
use crate::geometry::{Point, Vector};
use std::collections::BinaryHeap;

/// Less floor than this is no place to get to, square metres.
const LEAST_FLOOR: f64 = 0.02;
/// The middle of a narrow place is looked for at this pace, metres.
const PACE: f64 = 0.002;
/// An object is this much farther off than the walls of a narrow place between walls, metres.
const ALONE: f64 = 0.02;

/// A piece of floor to which the robot is not sent.
#[derive(Debug, Clone)]
pub(in crate::mapping) struct Pocket {
    /// Its cells.
    pub(super) cells: Vec<usize>,
    /// Where the centre of the body could stand in it, square metres.
    pub(in crate::mapping) area: f64,
    /// The narrowest place of the widest way there.
    pub(in crate::mapping) narrow: Narrow,
}

/// A narrow place.
#[derive(Debug, Clone, Copy)]
pub(in crate::mapping) struct Narrow {
    /// Its middle.
    pub(in crate::mapping) at: Point,
    /// How wide it is, metres.
    pub(in crate::mapping) width: f64,
    /// Whether both of its sides are of the boundary.
    pub(super) between_walls: bool,
}

impl Floor {
    /// The pieces of floor where the body would fit and that a way leads to, but no wide one.
    pub(in crate::mapping) fn pockets(&self) -> Vec<Pocket> {
        let least = (self.radius + SPARE) as f32;
        let cells = self.free.iter().zip(&self.drivable);
        let left: Vec<bool> = cells.map(|(&free, sent)| free >= least && !sent).collect();
        let mut known = vec![false; left.len()];
        let mut found = Vec::new();
        for seed in 0..left.len() {
            if known[seed] || !left[seed] {
                continue;
            }
            let mut runs = fill(&self.grid, &left, seed, &mut known);
            let count: usize = runs.iter().map(ExactSizeIterator::len).sum();
            let area = count as f64 * self.grid.cell * self.grid.cell;
            if area < LEAST_FLOOR {
                continue;
            }
            runs.sort_unstable_by_key(|run| run.start);
            let cells: Vec<usize> = runs.into_iter().flatten().collect();
            if let Some(narrow) = self.narrowest(&cells) {
                found.push(Pocket { cells, area, narrow });
            }
        }
        found
    }

    /// The narrowest place of the widest way from `cells` to where the robot is sent; none when no way leads there
    /// at all. On the way the floor is taken up widest first (as by Dijkstra's method, with the narrowest place in
    /// place of the length).
    fn narrowest(&self, cells: &[usize]) -> Option<Narrow> {
        let mut narrow: Vec<f32> = vec![0.0; self.grid.len()];
        let mut at: Vec<usize> = (0..self.grid.len()).collect();
        // Clearances on a way are positive, and the bits of positive floats order as they do.
        let mut heap = BinaryHeap::new();
        for &cell in cells {
            narrow[cell] = self.free[cell];
            heap.push((self.free[cell].to_bits(), cell));
        }
        while let Some((bits, cell)) = heap.pop() {
            let free = f32::from_bits(bits);
            if free < narrow[cell] {
                continue;
            }
            if self.drivable[cell] {
                return Some(self.measured(self.grid.point(at[cell])));
            }
            for near in self.grid.neighbours(cell).into_iter().flatten() {
                let through = free.min(self.free[near]);
                if through > narrow[near] {
                    narrow[near] = through;
                    at[near] = if self.free[near] < free { near } else { at[cell] };
                    heap.push((through.to_bits(), near));
                }
            }
        }
        None
    }

    /// The narrow place that one of its cells lies in, `at` or off its middle.
    fn measured(&self, at: Point) -> Narrow {
        let across = self.away_from_nearest(at);
        let reach = (2.0 * self.grid.cell / PACE).ceil() as i32;
        let places = (-reach..=reach).map(|k| at + across * (f64::from(k) * PACE));
        let middles = places.map(|p| (p, self.clearance(p)));
        let (at, clearance) =
            middles.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_else(|| (at, self.clearance(at)));
        let between_walls = self.object_clearance(at) > clearance + ALONE;
        Narrow { at, width: 2.0 * clearance, between_walls }
    }

    /// The direction in which `p` lies off what is nearest to it.
    fn away_from_nearest(&self, p: Point) -> Vector {
        let all = self.walls.segments().iter().chain(self.objects.segments());
        let feet = all.map(|segment| p - segment.nearest(p));
        let nearest = feet.min_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
        nearest.and_then(|off| off.try_normalize(1e-9)).unwrap_or_else(Vector::x)
    }
}
