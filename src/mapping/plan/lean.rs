//! The fewest of the paper's own lines that leave no larger hidden disc than asked for: greedy set
//! cover, which no polynomial method beats by much (Feige 1998), then what became idle is dropped,
//! and places that the raster missed are served one by one.

use super::cover::Need;
use super::{Work, drive};
use crate::geometry::{Point, Segment};
use crate::mapping::map::{LineStatus, PlanLine};
use std::collections::BinaryHeap;

/// What a further line costs besides its length: the way to it, metres.
const APPROACH: f64 = 1.0;
/// The first choice is among end points at least this far apart, metres.
const APART: f64 = 0.2;
/// The first choice is among this many lines at most.
const MOST: usize = 6000;
/// On the coarse raster a place stands for its surroundings: this much is kept in hand, metres.
const COARSE_GUARD: f64 = 0.010;
/// The same on the fine raster.
const FINE_GUARD: f64 = 0.003;
/// Discs below this left by the whole plan are not looked into further, metres: corners leave them.
const SLIVER: f64 = 0.03;
/// Rounds of serving single places.
const ROUNDS: usize = 4;
/// Lines weighed for one place.
const SAMPLE: usize = 80;

/// A line that can be chosen.
struct Candidate<'a> {
    line: &'a PlanLine,
    pieces: Vec<Segment>,
    cost: f64,
}

impl Candidate<'_> {
    /// Distance from a place, metres.
    fn off(&self, at: Point) -> f64 {
        let squares = self.pieces.iter().map(|piece| piece.distance_squared(at));
        squares.fold(f64::INFINITY, f64::min).sqrt()
    }
}

/// The lines chosen, in the order of the plan.
pub(super) fn choose<'a>(work: &Work<'_>, lines: &'a [PlanLine]) -> Vec<&'a PlanLine> {
    let candidates = candidates(work, lines);
    let over = (work.target / 2.0 - COARSE_GUARD).max(0.002);
    let need = Need::new(work.floor, &work.lap, over, 2);
    let mut chosen = greedy(need.clone(), &candidates, &thinned(&candidates, work.alpha));
    drop_idle(&need, &candidates, &mut chosen);
    repair(work, &candidates, &mut chosen);
    chosen.sort_unstable();
    chosen.iter().map(|&k| candidates[k].line).collect()
}

/// Lines of the whole plan that matter for what it leaves hidden: the others sweep only floor that
/// these sweep too.
pub(super) fn essential<'a>(work: &Work<'_>, lines: &'a [PlanLine]) -> Vec<&'a PlanLine> {
    let candidates = candidates(work, lines);
    if candidates.len() <= 256 {
        return candidates.iter().map(|candidate| candidate.line).collect();
    }
    let mut need = Need::new(work.floor, &work.lap, 0.0, 2);
    // A few hundred lines far apart sweep nearly everything; the rest is looked for in places.
    let stride = (candidates.len() / 512).max(1);
    let mut chosen: Vec<usize> = (0..candidates.len())
        .step_by(stride)
        .filter(|&k| need.serve(&candidates[k].pieces))
        .collect();
    for _ in 0..ROUNDS {
        let before = chosen.len();
        for spot in work.lap.and(&pieces_of(&candidates, &chosen)).spots(SLIVER, usize::MAX) {
            let near = nearest(&candidates, spot.at);
            if let Some((k, off)) = near
                && off < work.floor.reach + 0.4 * spot.diameter
                && !chosen.contains(&k)
            {
                chosen.push(k);
            }
        }
        if chosen.len() < before + 3 {
            break;
        }
    }
    chosen.iter().map(|&k| candidates[k].line).collect()
}

fn candidates<'a>(work: &Work<'_>, lines: &'a [PlanLine]) -> Vec<Candidate<'a>> {
    let objects = work.floor.has_objects();
    lines
        .iter()
        .filter(|line| line.status == LineStatus::Planned)
        .filter_map(|line| {
            let (from, to) = line.drive?;
            let pieces: Vec<Segment> = if objects {
                let free = drive::free_pieces(work.floor, line);
                free.iter().map(|&(a, b)| Segment::new(a, b)).collect()
            } else {
                vec![Segment::new(from, to)]
            };
            let cost = (to - from).norm() + APPROACH;
            (!pieces.is_empty()).then_some(Candidate { line, pieces, cost })
        })
        .collect()
}

/// Every few end points of each vertex, when α puts them closer together than a choice needs.
fn thinned(candidates: &[Candidate<'_>], alpha: f64) -> Vec<usize> {
    let near = (APART / alpha).floor().max(1.0) as usize;
    let stride = near.max(candidates.len().div_ceil(MOST));
    (0..candidates.len()).filter(|k| k % stride == 0).collect()
}

/// Takes the line that serves most for its cost, again and again. Gains only shrink, so a gain
/// that is out of date still bounds what a line can offer (Minoux 1978).
fn greedy(mut need: Need, candidates: &[Candidate<'_>], among: &[usize]) -> Vec<usize> {
    let mut chosen = Vec::new();
    if need.is_empty() {
        return chosen;
    }
    // Gains per metre in whole numbers, so that the heap's order is total.
    let worth = |need: &Need, k: usize| {
        (need.gain(&candidates[k].pieces) as f64 / candidates[k].cost * 1024.0) as u64
    };
    let mut heap: BinaryHeap<(u64, std::cmp::Reverse<usize>)> = among
        .iter()
        .map(|&k| (worth(&need, k), std::cmp::Reverse(k)))
        .filter(|&(worth, _)| worth > 0)
        .collect();
    while let Some((stale, std::cmp::Reverse(k))) = heap.pop() {
        let fresh = worth(&need, k);
        if fresh == 0 {
            continue;
        }
        let behind = heap.peek().is_some_and(|&(next, _)| next > fresh);
        if fresh < stale && behind {
            heap.push((fresh, std::cmp::Reverse(k)));
            continue;
        }
        need.serve(&candidates[k].pieces);
        chosen.push(k);
        if need.is_empty() {
            break;
        }
    }
    chosen
}

/// Drops lines, dearest first, all of whose places others serve too.
fn drop_idle(need: &Need, candidates: &[Candidate<'_>], chosen: &mut Vec<usize>) {
    let mut count = vec![0_u16; need.len()];
    for &k in chosen.iter() {
        need.served(&candidates[k].pieces, |place| count[place] += 1);
    }
    let mut dearest = chosen.clone();
    dearest.sort_by(|&a, &b| {
        let cost = candidates[b].cost.total_cmp(&candidates[a].cost);
        cost.then(a.cmp(&b))
    });
    for k in dearest {
        let mut idle = true;
        need.served(&candidates[k].pieces, |place| idle &= count[place] > 1);
        if idle {
            need.served(&candidates[k].pieces, |place| count[place] -= 1);
            chosen.retain(|&other| other != k);
        }
    }
}

/// Serves each place where too large a disc is left, as long as a line helps.
fn repair(work: &Work<'_>, candidates: &[Candidate<'_>], chosen: &mut Vec<usize>) {
    for _ in 0..ROUNDS {
        let before = chosen.len();
        let unswept = work.lap.and(&pieces_of(candidates, chosen));
        let spots = unswept.spots(work.target, usize::MAX);
        if spots.is_empty() {
            return;
        }
        let over = (work.target / 2.0 - FINE_GUARD).max(0.002);
        let mut need = Need::new(work.floor, &unswept, over, 1);
        for spot in spots {
            let within = work.floor.reach + spot.diameter / 2.0 - 0.002;
            let helps = |k: usize| candidates[k].off(spot.at) < within;
            if !chosen[before..].iter().any(|&k| helps(k)) {
                chosen.extend(best_of(&need, candidates, helps));
                if let Some(&k) = chosen.last() {
                    need.serve(&candidates[k].pieces);
                }
            }
        }
        if chosen.len() == before {
            return;
        }
    }
}

/// Of the lines that help, the one that serves most for its cost; of very many, among a sample.
fn best_of(
    need: &Need,
    candidates: &[Candidate<'_>],
    helps: impl Fn(usize) -> bool,
) -> Option<usize> {
    let able: Vec<usize> = (0..candidates.len()).filter(|&k| helps(k)).collect();
    let stride = able.len().div_ceil(SAMPLE).max(1);
    let worth = |k: usize| need.gain(&candidates[k].pieces) as f64 / candidates[k].cost;
    able.into_iter().step_by(stride).max_by(|&a, &b| worth(a).total_cmp(&worth(b)).then(b.cmp(&a)))
}

/// The candidate that comes nearest to a place, and how near, metres.
fn nearest(candidates: &[Candidate<'_>], at: Point) -> Option<(usize, f64)> {
    candidates
        .iter()
        .enumerate()
        .map(|(k, candidate)| (k, candidate.off(at)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

fn pieces_of(candidates: &[Candidate<'_>], chosen: &[usize]) -> Vec<Segment> {
    let pieces = chosen.iter().flat_map(|&k| candidates[k].pieces.iter());
    pieces.copied().collect()
}
