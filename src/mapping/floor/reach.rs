//! Where the robot's centre can be: the piece of the floor, worn down by the body, that hangs
//! together with where the robot stands.

use super::pocket::Narrow;
use super::{Floor, inside};
use crate::geometry::raster::{Grid, squared_distances};
use crate::geometry::{Point, Segment};
use std::ops::Range;

/// The centre keeps this much more than the radius from everything, metres.
pub(in crate::mapping) const SPARE: f64 = 0.02;

/// Rooms behind straits at most.
const MOST_STRAITS: usize = 50;

/// Puts objects into the raster of distances.
pub(super) fn stand_on(grid: &Grid, outlines: &[Vec<Segment>], free: &mut [f32]) {
    let all: Vec<Segment> = outlines.iter().flatten().copied().collect();
    if all.is_empty() {
        return;
    }
    for (value, square) in free.iter_mut().zip(squared_distances(grid, &all)) {
        *value = value.abs().min(square.sqrt()).copysign(*value);
    }
    for outline in outlines {
        for (value, within) in free.iter_mut().zip(inside(grid, outline)) {
            if within {
                *value = -value.abs();
            }
        }
    }
}

impl Floor {
    /// Finds out where the centre can be, from where the robot stands.
    pub(super) fn flood(&mut self, from: Point) {
        let body = self.radius as f32;
        let fits: Vec<bool> = self.wall.iter().map(|&d| d >= body).collect();
        self.touchable = component(&self.grid, &fits, from);
        let most = (self.half_gap - 0.3 * self.grid.cell) as f32;
        let wide: Vec<bool> = self.free.iter().map(|&d| d >= most).collect();
        self.drivable = self.with_rim(component(&self.grid, &wide, from));
        for _ in 0..MOST_STRAITS {
            let Some(inner) = self.behind_a_strait(&wide) else { break };
            let more = self.with_rim(component(&self.grid, &wide, inner));
            for (sent, more) in self.drivable.iter_mut().zip(more) {
                *sent |= more;
            }
        }
    }

    /// A place that is not drivable yet, behind a narrow place between walls: the map does not end there, so the robot
    /// has gone through that, however narrow it came out on the map. Past an object as near as that nobody has been.
    fn behind_a_strait(&self, wide: &[bool]) -> Option<Point> {
        self.pockets().into_iter().find_map(|pocket| {
            let Narrow { at, between_walls, .. } = pocket.narrow;
            let off = |&cell: &usize| (self.grid.point(cell) - at).norm_squared();
            let inner = pocket.cells.iter().copied().filter(|&cell| wide[cell]);
            let nearest = inner.min_by(|a, b| off(a).total_cmp(&off(b)))?;
            between_walls.then(|| self.grid.point(nearest))
        })
    }

    /// The part `wide` that a body as wide as the passable gap can get to, with the cells at its rim that have room
    /// for the body.
    fn with_rim(&self, wide: Vec<bool>) -> Vec<bool> {
        let mut sent = wide;
        let body = (self.radius + SPARE) as f32;
        let around = |cell: usize| self.grid.neighbours(cell).into_iter().flatten();
        // A corner that the wide body leaves out is deeper than it is wide; beyond twice the
        // difference there is a gap.
        let steps = (2.0 * (self.half_gap - self.radius) / self.grid.cell).ceil() as usize;
        // Beside what is wide there is less than of it.
        let left = sent.iter().zip(&self.free).map(|(&sent, &free)| !sent && free >= body);
        let left = left.enumerate().filter_map(|(k, is_left)| is_left.then_some(k));
        let mut rim: Vec<usize> = left.filter(|&k| around(k).any(|near| sent[near])).collect();
        for _ in 0..steps {
            for &k in &rim {
                sent[k] = true;
            }
            let fits = |near: &usize| !sent[*near] && self.free[*near] >= body;
            let mut next: Vec<usize> = rim.iter().flat_map(|&k| around(k).filter(fits)).collect();
            next.sort_unstable();
            next.dedup();
            rim = next;
        }
        sent
    }
}

/// The part of `open` that hangs together with the open cell nearest to `from`.
fn component(grid: &Grid, open: &[bool], from: Point) -> Vec<bool> {
    let mut found = vec![false; open.len()];
    if let Some(seed) = nearest_open(grid, open, from) {
        fill(grid, open, seed, &mut found);
    }
    found
}

/// Marks in `found` what of `open` hangs together with the cell `seed`; returns it in runs of cells that follow
/// each other in one row.
pub(super) fn fill(
    grid: &Grid,
    open: &[bool],
    seed: usize,
    found: &mut [bool],
) -> Vec<Range<usize>> {
    let (mut stack, mut runs) = (vec![seed], Vec::new());
    while let Some(cell) = stack.pop() {
        if !found[cell] {
            runs.push(fill_run(grid, open, cell, found, &mut stack));
        }
    }
    runs
}

/// Fills the run of open cells in the row of `cell`, stacks one cell of each run beside it, and returns it.
fn fill_run(
    grid: &Grid,
    open: &[bool],
    cell: usize,
    found: &mut [bool],
    stack: &mut Vec<usize>,
) -> Range<usize> {
    let row = cell / grid.width * grid.width;
    let (mut first, mut end) = (cell, cell + 1);
    first -= open[row..first].iter().rev().take_while(|&&open| open).count();
    end += open[end..row + grid.width].iter().take_while(|&&open| open).count();
    found[first..end].fill(true);
    let below = row.checked_sub(grid.width);
    let above = (row + grid.width < open.len()).then_some(row + grid.width);
    for other in [below, above].into_iter().flatten() {
        let beside = other + (first - row)..other + (end - row);
        let mut inside = false;
        let cells = open[beside.clone()].iter().zip(&found[beside.clone()]);
        for (k, (&open, &found)) in beside.zip(cells) {
            let fresh = open && !found;
            if fresh && !inside {
                stack.push(k);
            }
            inside = fresh;
        }
    }
    first..end
}

fn nearest_open(grid: &Grid, open: &[bool], from: Point) -> Option<usize> {
    let here = grid.index(from);
    if open[here] {
        return Some(here);
    }
    (0..open.len()).filter(|&k| open[k]).min_by(|&a, &b| {
        let off = |k: usize| (grid.point(k) - from).norm_squared();
        off(a).total_cmp(&off(b))
    })
}

#[cfg(test)]
mod tests {
    use super::super::rooms;
    use crate::geometry::Point;

    #[test]
    fn a_gap_below_the_passable_one_beside_an_object_closes_off_what_lies_behind() {
        let room = rooms::rectangle(5.0, 2.0);
        for (gap, open) in [(0.29, false), (0.32, false), (0.36, true)] {
            let board = rooms::boxed(2.0, gap, 2.1, 1.99);
            let floor = rooms::floor(&room, &[&board]);
            assert!(floor.is_drivable(Point::new(0.5, 1.0)));
            assert_eq!(floor.is_drivable(Point::new(3.5, 1.0)), open, "behind a gap of {gap} m");
        }
    }

    #[test]
    fn what_is_on_the_map_behind_a_gap_between_walls_was_driven_round() {
        for gap in [0.27, 0.31, 0.36] {
            let floor = rooms::floor(&rooms::two_rooms(gap), &[]);
            assert!(floor.is_drivable(Point::new(3.5, 1.0)), "behind a gap of {gap} m");
        }
    }

    #[test]
    fn objects_take_floor_away_and_the_distances_are_exact() {
        let boxed = rooms::boxed(2.0, 1.0, 2.5, 1.5);
        let floor = rooms::floor(&rooms::rectangle(5.0, 4.0), &[&boxed]);
        for cell in 0..floor.grid.len() {
            let at = floor.grid.point(cell);
            let want = floor.clearance(at);
            let got = f64::from(floor.free[cell]);
            assert!((got - want).abs() < 1e-3, "{got} instead of {want} at {at}");
        }
        assert!(!floor.is_drivable(Point::new(2.2, 1.2)));
        assert!(!floor.is_drivable(Point::new(1.92, 1.2)));
        assert!(floor.is_drivable(Point::new(1.85, 1.2)));
    }
}
