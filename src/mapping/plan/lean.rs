//! The fewest of the paper's own lines that leave no larger hidden disc than asked for: greedy set
//! cover, which no polynomial method beats by much (Feige 1998), then what became idle is dropped,
//! and places that the raster missed are served one by one.

use super::cover::Need;
use super::{Work, drive};
use crate::geometry::Segment;
use crate::mapping::floor::{Coverage, Unswept};
use crate::mapping::map::{LineStatus, PlanLine};
use std::collections::BinaryHeap;

/// What a further line costs besides its length: the way to it, metres.
const APPROACH: f64 = 1.0;
/// The first choice is among end points at least this far apart, metres.
const APART: f64 = 0.2;
/// On the coarse raster a place stands for its surroundings: this much is kept in hand, metres.
const COARSE_GUARD: f64 = 0.010;
/// The same on the fine raster.
const FINE_GUARD: f64 = 0.003;
/// Rounds of serving single places.
const ROUNDS: usize = 4;

/// A line that can be chosen.
struct Candidate<'a> {
    line: &'a PlanLine,
    pieces: Vec<Segment>,
    cost: f64,
}

/// The lines chosen, in the order of the plan.
pub(super) fn choose<'a>(work: &Work<'_>, lines: &'a [PlanLine]) -> Vec<&'a PlanLine> {
    let candidates = candidates(work, lines);
    let radius = work.target / 2.0;
    let lap = Unswept::new(work.floor, work.driven.segments());
    let coarse = Need::new(work.floor, &lap, (radius - COARSE_GUARD).max(0.002), 2);
    let few = thinned(&candidates, work.alpha);
    let mut chosen = greedy(coarse, &candidates, &few);
    let all: Vec<usize> = (0..candidates.len()).collect();
    let fine = Need::new(work.floor, &lap, (radius - FINE_GUARD).max(0.002), 1);
    let mut left = fine.clone();
    for &k in &chosen {
        left.serve(&candidates[k].pieces);
    }
    chosen.extend(greedy(left, &candidates, &all));
    drop_idle(&fine, &candidates, &mut chosen);
    repair(work, &candidates, &mut chosen);
    chosen.sort_unstable();
    chosen.iter().map(|&k| candidates[k].line).collect()
}

/// Lines of the whole plan that matter for what it leaves hidden: the others sweep only floor that
/// these sweep too.
pub(super) fn essential<'a>(work: &Work<'_>, lines: &'a [PlanLine]) -> Vec<&'a PlanLine> {
    let candidates = candidates(work, lines);
    let lap = Unswept::new(work.floor, work.driven.segments());
    let mut need = Need::new(work.floor, &lap, 0.0, 2);
    let mut chosen: Vec<usize> = Vec::new();
    // Far apart ones first: few of them serve nearly everything.
    let stride = (candidates.len() / 64).max(1);
    for k in (0..stride).flat_map(|first| (first..candidates.len()).step_by(stride)) {
        if need.is_empty() {
            break;
        }
        if need.gain(&candidates[k].pieces) > 0 {
            need.serve(&candidates[k].pieces);
            chosen.push(k);
        }
    }
    let mut coverage = covered(work, &candidates, &chosen);
    for _ in 0..ROUNDS {
        let before = chosen.len();
        for spot in coverage.spots(work.floor, 0.01) {
            let near = nearest(work, &candidates, &spot.at);
            if let Some((k, off)) = near
                && off < work.floor.reach + 0.4 * spot.diameter
                && !chosen.contains(&k)
            {
                chosen.push(k);
            }
        }
        if chosen.len() == before {
            break;
        }
        coverage = covered(work, &candidates, &chosen);
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
    let stride = (APART / alpha).floor().max(1.0) as usize;
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

/// Adds the nearest line to each place where too large a disc is left, as long as one helps.
fn repair(work: &Work<'_>, candidates: &[Candidate<'_>], chosen: &mut Vec<usize>) {
    for _ in 0..ROUNDS {
        let before = chosen.len();
        let coverage = covered(work, candidates, chosen);
        for spot in coverage.spots(work.floor, work.target) {
            let Some((k, off)) = nearest(work, candidates, &spot.at) else {
                continue;
            };
            let helps = off < work.floor.reach + spot.diameter / 2.0 - 0.001;
            if helps && !chosen.contains(&k) {
                chosen.push(k);
            }
        }
        if chosen.len() == before {
            return;
        }
    }
}

/// The candidate that comes nearest to a place, and how near, metres.
fn nearest(
    _work: &Work<'_>,
    candidates: &[Candidate<'_>],
    at: &crate::geometry::Point,
) -> Option<(usize, f64)> {
    let off = |c: &Candidate<'_>| {
        c.pieces
            .iter()
            .map(|piece| piece.distance_squared(*at))
            .fold(f64::INFINITY, f64::min)
    };
    candidates
        .iter()
        .enumerate()
        .map(|(k, c)| (k, off(c)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(k, square)| (k, square.sqrt()))
}

fn covered(work: &Work<'_>, candidates: &[Candidate<'_>], chosen: &[usize]) -> Coverage {
    let mut coverage = work.driven.clone();
    for &k in chosen {
        for piece in &candidates[k].pieces {
            coverage.add_line(piece.from, piece.to());
        }
    }
    coverage
}
