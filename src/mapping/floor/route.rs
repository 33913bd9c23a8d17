//! The shortest way for the robot's centre that keeps a clearance: A* over the raster (Hart,
//! Nilsson and Raphael 1968), then pulled tight into few straight legs, each of which is checked
//! against the outlines themselves.

use super::Floor;
use crate::geometry::Point;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// How far below the clearance asked for a leg may fall, metres: less than the raster resolves.
const SLACK: f64 = 0.003;

impl Floor {
    /// The shortest way from `from` to `to`, both included, whose legs keep `clearance` metres
    /// from walls and objects; half the passable gap where there is such a way, so that narrow
    /// gaps are used only when nothing else leads there. At either end, what lies nearer to a wall
    /// is left by the way on which the clearance grows. None when no way keeps it.
    #[must_use]
    pub fn route(&self, from: Point, to: Point, clearance: f64) -> Option<Vec<Point>> {
        let wide = self.half_gap.max(clearance);
        let between = f64::midpoint(wide, clearance);
        [wide, between, clearance].into_iter().find_map(|keep| self.way(from, to, keep, clearance))
    }

    /// Whether a way that keeps `clearance` may begin at `from`. None begins beyond the wall: where the clearance grows
    /// from there is through that.
    #[must_use]
    pub fn is_way_out(&self, from: Point, clearance: f64) -> bool {
        self.wall_clearance(from) > 0.0 && self.leave(from, clearance, clearance).is_some()
    }

    /// Length of [`Floor::route`], metres.
    #[must_use]
    pub fn route_length(&self, from: Point, to: Point, clearance: f64) -> Option<f64> {
        self.route(from, to, clearance).map(|way| length(&way))
    }

    fn way(&self, from: Point, to: Point, keep: f64, least: f64) -> Option<Vec<Point>> {
        let off = self.leave(from, keep, least)?;
        let on = self.leave(to, keep, least)?;
        let mut way = vec![from];
        let tight = keep - SLACK;
        let inner = if self.is_clear(off, on, tight) {
            vec![off, on]
        } else {
            self.pull(&self.search(off, on, keep)?, tight, least - SLACK)?
        };
        way.extend(inner);
        way.push(to);
        way.dedup_by(|a, b| (*a - *b).norm() < 1e-6);
        if way.len() == 1 {
            way.push(to);
        }
        self.drop_idle(&mut way, tight);
        Some(way)
    }

    /// Where the clearance `keep` is first had, going from `from` uphill; `from` itself when it
    /// has it. The top of the hill counts when it has at least `least`.
    fn leave(&self, from: Point, keep: f64, least: f64) -> Option<Point> {
        let mut at = from;
        let mut here = self.clearance(at);
        if here >= keep - SLACK {
            return Some(at);
        }
        let mut step = self.grid.cell;
        while step > 1e-3 {
            match self.uphill(at, here, step) {
                Some((next, clearance)) => {
                    (at, here) = (next, clearance);
                    if here >= keep {
                        return Some(at);
                    }
                }
                None => step /= 2.0,
            }
        }
        (here >= least - SLACK).then_some(at)
    }

    /// The best of sixteen places a `step` away, if it is better by a tenth of the step.
    pub(super) fn uphill(&self, at: Point, here: f64, step: f64) -> Option<(Point, f64)> {
        let mut best: Option<(Point, f64)> = None;
        for direction in super::hidden::DIRECTIONS {
            let next = at + direction * step;
            let least = best.map_or(here + 0.1 * step, |(_, most)| most);
            if self.bounds(next).1 > least {
                let clearance = self.clearance(next);
                if clearance > least {
                    best = Some((next, clearance));
                }
            }
        }
        best
    }

    /// A* from cell to cell.
    fn search(&self, from: Point, to: Point, keep: f64) -> Option<Vec<Point>> {
        let grid = &self.grid;
        // A passage just as wide as asked for may lie between two cells' centres.
        let most = (keep - 0.5 * grid.cell) as f32;
        let (start, goal) = (grid.index(from), grid.index(to));
        let goal_at = grid.point(goal);
        let mut cost = vec![f32::INFINITY; grid.len()];
        let mut came = vec![u32::MAX; grid.len()];
        let mut open = BinaryHeap::new();
        cost[start] = 0.0;
        open.push(entry(self.to_go(start, goal_at), start));
        while let Some(Reverse(key)) = open.pop() {
            let (total, cell) = (f32::from_bits((key >> 32) as u32), key as u32 as usize);
            if cell == goal {
                return Some(self.trace(&came, start, goal, from, to));
            }
            if total > cost[cell] + self.to_go(cell, goal_at) + 1e-4 {
                continue;
            }
            for (k, near) in grid.neighbours(cell).into_iter().enumerate() {
                let Some(near) = near else { continue };
                if self.free[near] < most && near != goal {
                    continue;
                }
                let step = if k < 4 { 1.0 } else { std::f32::consts::SQRT_2 };
                let next = cost[cell] + step * grid.cell as f32;
                if next < cost[near] {
                    cost[near] = next;
                    came[near] = cell as u32;
                    open.push(entry(next + self.to_go(near, goal_at), near));
                }
            }
        }
        None
    }

    fn to_go(&self, cell: usize, goal: Point) -> f32 {
        (self.grid.point(cell) - goal).norm() as f32
    }

    fn trace(&self, came: &[u32], start: usize, goal: usize, from: Point, to: Point) -> Vec<Point> {
        let mut way = vec![to];
        let mut cell = goal;
        while cell != start {
            cell = came[cell] as usize;
            way.push(self.grid.point(cell));
        }
        way.push(from);
        way.reverse();
        way
    }

    /// Straightens a way of many cells into few legs. A leg that cannot keep `tight` is accepted
    /// between neighbouring cells when it keeps `least`.
    fn pull(&self, way: &[Point], tight: f64, least: f64) -> Option<Vec<Point>> {
        let nodes: Vec<Point> = way.iter().map(|&p| self.nudged(p, tight)).collect();
        let mut pulled = vec![nodes[0]];
        let mut at = 0;
        while at + 1 < nodes.len() {
            let next = self.furthest(&nodes, at, tight);
            if next == at + 1 && !self.is_clear(nodes[at], nodes[next], least) {
                return None;
            }
            pulled.push(nodes[next]);
            at = next;
        }
        Some(pulled)
    }

    /// The last node that can be seen from node `at`, found by galloping and then halving.
    fn furthest(&self, nodes: &[Point], at: usize, tight: f64) -> usize {
        let last = nodes.len() - 1;
        let sees = |k: usize| self.is_clear(nodes[at], nodes[k], tight);
        if sees(last) {
            return last;
        }
        let (mut good, mut stride) = (at + 1, 2);
        while at + stride < last && sees(at + stride) {
            good = at + stride;
            stride *= 2;
        }
        let mut bad = (at + stride).min(last);
        while bad > good + 1 {
            let middle = usize::midpoint(good, bad);
            if sees(middle) {
                good = middle;
            } else {
                bad = middle;
            }
        }
        good
    }

    /// A cell's centre that lacks a little clearance, moved to where it has it.
    fn nudged(&self, p: Point, keep: f64) -> Point {
        let (mut at, mut here) = (p, self.clearance(p));
        for _ in 0..8 {
            if here >= keep {
                break;
            }
            match self.uphill(at, here, 0.25 * self.grid.cell) {
                Some(next) => (at, here) = next,
                None => break,
            }
        }
        at
    }

    /// Leaves out places between two that see each other.
    fn drop_idle(&self, way: &mut Vec<Point>, tight: f64) {
        let mut k = 1;
        while k + 1 < way.len() {
            if self.is_clear(way[k - 1], way[k + 1], tight) {
                way.remove(k);
                k = k.saturating_sub(1).max(1);
            } else {
                k += 1;
            }
        }
    }
}

/// Length of a way, metres.
#[must_use]
pub(crate) fn length(way: &[Point]) -> f64 {
    way.windows(2).map(|leg| (leg[1] - leg[0]).norm()).sum()
}

/// A cell on the open list with the least that a way through it costs, metres: the cheapest compares greatest,
/// ties by index so that the way never depends on chance.
fn entry(total: f32, cell: usize) -> Reverse<u64> {
    // The bits of positive floats order as they do.
    Reverse(u64::from(total.to_bits()) << 32 | cell as u64)
}

#[cfg(test)]
mod tests {
    use super::super::rooms;
    use super::*;

    #[test]
    fn a_way_in_the_open_is_one_straight_leg() {
        let floor = rooms::floor(&rooms::rectangle(5.0, 4.0), &[]);
        let (a, b) = (Point::new(0.5, 0.5), Point::new(4.2, 3.1));
        assert_eq!(floor.route(a, b, 0.16), Some(vec![a, b]));
    }

    #[test]
    fn a_way_round_a_corner_is_short_and_keeps_its_clearance() {
        let floor = rooms::floor(&rooms::ell(), &[]);
        let (a, b) = (Point::new(1.0, 2.7), Point::new(3.7, 0.8));
        let way = floor.route(a, b, 0.16).unwrap();
        let corner = Point::new(2.0, 1.5);
        let least = (corner - a).norm() + (b - corner).norm();
        assert!(length(&way) < least + 0.15, "{} m, {least} at least", length(&way));
        assert!(way.len() <= 5, "{way:?}");
        for leg in way.windows(2) {
            let clearance = floor.segment_clearance(leg[0], leg[1]);
            assert!(clearance >= 0.155, "{clearance} on {leg:?}");
        }
    }

    #[test]
    fn objects_are_gone_round() {
        let column = crate::geometry::Ring::circle(Point::new(2.5, 2.0), 0.4);
        let floor = rooms::floor(&rooms::rectangle(5.0, 4.0), &[&column]);
        let way = floor.route(Point::new(0.5, 2.0), Point::new(4.5, 2.0), 0.16).unwrap();
        assert!(way.len() > 2 && length(&way) < 4.4, "{way:?}");
        for leg in way.windows(2) {
            assert!(floor.segment_clearance(leg[0], leg[1]) >= 0.165, "{leg:?}");
        }
    }

    #[test]
    fn no_way_begins_beyond_the_wall() {
        let floor = rooms::floor(&rooms::rectangle(5.0, 4.0), &[]);
        assert!(floor.is_way_out(Point::new(0.03, 2.0), 0.11), "off the wall");
        for beyond in [0.02, 0.1, 0.3] {
            assert!(!floor.is_way_out(Point::new(-beyond, 2.0), 0.11), "through the wall");
        }
    }

    #[test]
    fn a_way_from_beside_the_wall_leaves_it_first() {
        let floor = rooms::floor(&rooms::ell(), &[]);
        let (a, b) = (Point::new(0.11, 0.105), Point::new(3.89, 1.38));
        let way = floor.route(a, b, 0.16).unwrap();
        assert_eq!((way[0], way[way.len() - 1]), (a, b));
        for leg in way.windows(2) {
            assert!(floor.segment_clearance(leg[0], leg[1]) >= 0.104, "{leg:?}");
        }
    }

    #[test]
    fn a_gap_too_narrow_for_the_clearance_is_no_way() {
        let (a, b) = (Point::new(0.5, 1.0), Point::new(3.5, 1.0));
        for (gap, clearance, open) in [(0.30, 0.16, false), (0.30, 0.14, true), (0.36, 0.16, true)]
        {
            let floor = rooms::floor(&rooms::two_rooms(gap), &[]);
            let way = floor.route(a, b, clearance);
            assert_eq!(way.is_some(), open, "gap {gap}, clearance {clearance}: {way:?}");
        }
    }
}
