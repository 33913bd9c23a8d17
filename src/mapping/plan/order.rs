//! In which order lines are driven, and from which end. The paper's own order for the paper's
//! plan (III.F); the shortest found for the others: nearest line first, then improved by turning
//! round pieces of the tour (2-opt) and moving single lines until nothing gets shorter.

use super::travel::Travel;
use super::{Work, circle};
use crate::geometry::Point;
use crate::mapping::map::{LineStatus, PlanLine};
use std::collections::BTreeMap;

/// Lines in driving order, each with whether it is driven from its end.
pub(super) type Order = Vec<(u32, bool)>;

/// A line that no way leads to counts as this far away, metres, and comes last.
const FAR: f64 = 1e4;
/// Rounds of improvement at most; a few are enough.
const ROUNDS: usize = 40;

/// The paper's order: the nearest vertex first, its lines by rising angle, every other one from
/// the far end back; then the nearest vertex with lines left. The radii of a part, which come
/// together at its middle, are one such fan, from whichever of its ends is nearer. Also its length
/// in metres.
pub(super) fn by_vertex(work: &Work<'_>, lines: &[PlanLine]) -> (Order, f64) {
    let mut fans = fans(work, lines);
    let travel = Travel::new(work.floor);
    let (mut order, mut length, mut at) = (Vec::new(), 0.0, work.from);
    while !fans.is_empty() {
        let off = |line: &&PlanLine| (line.start - at).norm_squared();
        let near = |fan: &Vec<&PlanLine>| {
            let ends = [fan.first(), fan.last()].into_iter().flatten().map(off);
            ends.fold(f64::INFINITY, f64::min)
        };
        let next = fans.iter().min_by(|a, b| near(a.1).total_cmp(&near(b.1))).map(|(&key, _)| key);
        let Some(mut fan) = next.and_then(|key| fans.remove(&key)) else {
            break;
        };
        if fan.first().map(off) > fan.last().map(off) {
            fan.reverse();
        }
        for (k, line) in fan.iter().enumerate() {
            let Some((from, to)) = line.drive else {
                continue;
            };
            let back = k % 2 == 1;
            let (begin, end) = if back { (to, from) } else { (from, to) };
            length += (to - from).norm();
            // Within a fan the far ends lie side by side; only the way to it goes round walls.
            length +=
                if k == 0 { connection(work, &travel, at, begin) } else { (begin - at).norm() };
            order.push((line.id, back));
            at = end;
        }
    }
    (order, length)
}

/// The lines to be driven, by part and vertex, each fan by rising angle.
fn fans<'a>(work: &Work<'_>, lines: &'a [PlanLine]) -> BTreeMap<(usize, usize), Vec<&'a PlanLine>> {
    let mut fans: BTreeMap<_, Vec<&PlanLine>> = BTreeMap::new();
    for line in lines {
        if line.status == LineStatus::Planned && line.drive.is_some() {
            let radius = work.shape.parts.get(line.part).is_some_and(circle::has_radii);
            let vertex = if radius { 0 } else { line.vertex };
            fans.entry((line.part, vertex)).or_default().push(line);
        }
    }
    for fan in fans.values_mut() {
        fan.sort_by(|a, b| a.angle.total_cmp(&b.angle).then(a.id.cmp(&b.id)));
    }
    fans
}

fn connection(work: &Work<'_>, travel: &Travel, at: Point, to: Point) -> f64 {
    let straight = (to - at).norm();
    if work.floor.is_clear(at, to, work.floor.radius) {
        return straight;
    }
    let round = travel.length(&travel.from(travel.cell(at)), at, to);
    if round.is_finite() { round } else { straight }
}

/// A short tour over `lines` from where the robot stands, and its length in metres.
pub(super) fn shortest(work: &Work<'_>, lines: &[&PlanLine]) -> (Order, f64) {
    let drives: Vec<(u32, Point, Point)> =
        lines.iter().filter_map(|line| line.drive.map(|(a, b)| (line.id, a, b))).collect();
    let mut tour = Tour::new(work, &drives);
    tour.nearest_first();
    for _ in 0..ROUNDS {
        let turned = tour.turn_round();
        if !(tour.move_single() || turned) {
            break;
        }
    }
    let driven: f64 = drives.iter().map(|(_, a, b)| (b - a).norm()).sum();
    let order = tour.stops.iter().map(|stop| (drives[stop.line].0, stop.back)).collect();
    (order, driven + tour.ways())
}

#[derive(Debug, Clone, Copy)]
struct Stop {
    line: usize,
    back: bool,
}

impl Stop {
    /// Number of the end where driving it begins, in the table of distances.
    fn entry(self) -> usize {
        2 * self.line + usize::from(self.back)
    }

    fn exit(self) -> usize {
        2 * self.line + usize::from(!self.back)
    }

    fn turned(self) -> Self {
        Self { line: self.line, back: !self.back }
    }
}

/// A tour over lines; the table holds the ways between all ends, the robot's place last.
struct Tour {
    count: usize,
    ways: Vec<f32>,
    stops: Vec<Stop>,
}

impl Tour {
    fn new(work: &Work<'_>, drives: &[(u32, Point, Point)]) -> Self {
        let travel = Travel::new(work.floor);
        let mut ends: Vec<Point> = drives.iter().flat_map(|&(_, a, b)| [a, b]).collect();
        ends.push(work.from);
        let size = ends.len();
        let mut ways = vec![0.0; size * size];
        // Lines that begin at one vertex have their ends close together: one look serves them all.
        let mut by_cell: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (i, &end) in ends.iter().enumerate() {
            by_cell.entry(travel.cell(end)).or_default().push(i);
        }
        for (cell, here) in by_cell {
            let steps = travel.from(cell);
            for i in here {
                for (j, &to) in ends.iter().enumerate().skip(i + 1) {
                    let way = travel.length(&steps, ends[i], to).min(FAR) as f32;
                    ways[i * size + j] = way;
                    ways[j * size + i] = way;
                }
            }
        }
        Self { count: drives.len(), ways, stops: Vec::new() }
    }

    fn way(&self, a: usize, b: usize) -> f32 {
        self.ways[a * (2 * self.count + 1) + b]
    }

    /// The end that the robot comes from before stop `k`.
    fn before(&self, k: usize) -> usize {
        if k == 0 { 2 * self.count } else { self.stops[k - 1].exit() }
    }

    /// Way into the stop after `k` from `from`; nothing after the last.
    fn onward(&self, from: usize, k: usize) -> f32 {
        self.stops.get(k + 1).map_or(0.0, |next| self.way(from, next.entry()))
    }

    fn ways(&self) -> f64 {
        (0..self.stops.len())
            .map(|k| f64::from(self.way(self.before(k), self.stops[k].entry())))
            .filter(|&way| way < FAR)
            .sum()
    }

    fn nearest_first(&mut self) {
        let mut left: Vec<usize> = (0..self.count).collect();
        let mut at = 2 * self.count;
        while !left.is_empty() {
            let ends = left
                .iter()
                .enumerate()
                .flat_map(|(slot, &line)| [false, true].map(|back| (slot, Stop { line, back })));
            let nearest =
                ends.min_by(|a, b| self.way(at, a.1.entry()).total_cmp(&self.way(at, b.1.entry())));
            let Some((slot, stop)) = nearest else { break };
            left.swap_remove(slot);
            at = stop.exit();
            self.stops.push(stop);
        }
    }

    /// Turns pieces of the tour round where that shortens it; whether any did.
    fn turn_round(&mut self) -> bool {
        let mut better = false;
        for i in 0..self.stops.len() {
            for j in i..self.stops.len() {
                let (first, last) = (self.stops[i], self.stops[j]);
                let before = self.before(i);
                let old = self.way(before, first.entry()) + self.onward(last.exit(), j);
                let new = self.way(before, last.exit()) + self.onward(first.entry(), j);
                if new < old - 1e-4 {
                    self.stops[i..=j].reverse();
                    for stop in &mut self.stops[i..=j] {
                        *stop = stop.turned();
                    }
                    better = true;
                }
            }
        }
        better
    }

    /// Moves single lines elsewhere where that shortens the tour; whether any did.
    fn move_single(&mut self) -> bool {
        let mut better = false;
        for i in 0..self.stops.len() {
            let stop = self.stops[i];
            let before = self.before(i);
            let out = self.way(before, stop.entry()) + self.onward(stop.exit(), i)
                - self.onward(before, i);
            self.stops.remove(i);
            let (mut place, mut best, mut as_is) = (i, out - 1e-4, stop);
            for k in 0..=self.stops.len() {
                let from = self.before(k);
                let skipped = self.stops.get(k).map_or(0.0, |next| self.way(from, next.entry()));
                for way in [stop, stop.turned()] {
                    let on =
                        self.stops.get(k).map_or(0.0, |next| self.way(way.exit(), next.entry()));
                    let cost = self.way(from, way.entry()) + on - skipped;
                    if cost < best {
                        (place, best, as_is) = (k, cost, way);
                        better = true;
                    }
                }
            }
            self.stops.insert(place, as_is);
        }
        better
    }
}
