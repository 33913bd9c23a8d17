//! The fewest of the paper's own lines that leave no larger hidden disc than asked for: greedy set
//! cover, which no polynomial method beats by much (Feige 1998), then what became idle is dropped,
//! and places that the raster missed are served one by one.

use super::cover::{Need, Span};
use super::{Work, drive};
use crate::geometry::{Point, Segment};
use crate::mapping::floor::Unswept;
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
const SAMPLE: usize = 40;

/// A line that can be chosen.
struct Candidate<'a> {
    line: &'a PlanLine,
    pieces: Vec<Segment>,
    cost: f64,
}

impl Candidate<'_> {
    /// Squared distance from a place, square metres.
    fn off_squared(&self, at: Point) -> f64 {
        let squares = self.pieces.iter().map(|piece| piece.distance_squared(at));
        squares.fold(f64::INFINITY, f64::min)
    }
}

/// The lines chosen, in the order of the plan, and what they leave.
pub(super) fn choose<'a, 'f>(
    work: &Work<'f>,
    lines: &'a [PlanLine],
) -> (Vec<&'a PlanLine>, Unswept<'f>) {
    let candidates = candidates(work, lines);
    let over = (work.target / 2.0 - COARSE_GUARD).max(0.002);
    let need = Need::new(work.floor, &work.lap, over, 2);
    let mut chosen = greedy(need.clone(), &candidates, &thinned(&candidates, work.alpha));
    drop_idle(&need, &candidates, &mut chosen);
    let left = repair(work, &candidates, &mut chosen);
    chosen.sort_unstable();
    (chosen.iter().map(|&k| candidates[k].line).collect(), left)
}

/// What the whole plan leaves. Of very many lines those count that matter: the others sweep only
/// floor that these sweep too.
pub(super) fn left_by_all<'f>(work: &Work<'f>, lines: &[PlanLine]) -> Unswept<'f> {
    let candidates = candidates(work, lines);
    if candidates.len() <= 256 {
        let all: Vec<usize> = (0..candidates.len()).collect();
        return work.lap.and(&pieces_of(&candidates, &all));
    }
    let mut need = Need::new(work.floor, &work.lap, 0.0, 2);
    // A few hundred lines far apart sweep nearly everything; the rest is looked for in places.
    let stride = (candidates.len() / 512).max(1);
    let mut chosen: Vec<usize> = (0..candidates.len())
        .step_by(stride)
        .filter(|&k| need.serve(&need.span(&candidates[k].pieces)))
        .collect();
    let mut left = work.lap.and(&pieces_of(&candidates, &chosen));
    for _ in 0..ROUNDS {
        let before = chosen.len();
        for spot in left.spots(SLIVER, usize::MAX) {
            let near = nearest(&candidates, spot.at);
            if let Some((k, off)) = near
                && off < work.floor.reach + 0.4 * spot.diameter
                && !chosen.contains(&k)
            {
                chosen.push(k);
            }
        }
        left = left.and(&pieces_of(&candidates, &chosen[before..]));
        if chosen.len() < before + 3 {
            break;
        }
    }
    left
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
    let spans: Vec<Span> = among.iter().map(|&k| need.span(&candidates[k].pieces)).collect();
    let worth = |need: &Need, n: usize| {
        (need.gain(&spans[n]) as f64 / candidates[among[n]].cost * 1024.0) as u64
    };
    let mut heap: BinaryHeap<(u64, std::cmp::Reverse<usize>)> = (0..among.len())
        .map(|n| (worth(&need, n), std::cmp::Reverse(n)))
        .filter(|&(worth, _)| worth > 0)
        .collect();
    while let Some((stale, std::cmp::Reverse(n))) = heap.pop() {
        let fresh = worth(&need, n);
        if fresh == 0 {
            continue;
        }
        let behind = heap.peek().is_some_and(|&(next, _)| next > fresh);
        if fresh < stale && behind {
            heap.push((fresh, std::cmp::Reverse(n)));
            continue;
        }
        need.serve(&spans[n]);
        chosen.push(among[n]);
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
        need.served(&need.span(&candidates[k].pieces), |place| count[place] += 1);
    }
    let mut dearest = chosen.clone();
    dearest.sort_by(|&a, &b| {
        let cost = candidates[b].cost.total_cmp(&candidates[a].cost);
        cost.then(a.cmp(&b))
    });
    for k in dearest {
        let mut idle = true;
        let span = need.span(&candidates[k].pieces);
        need.served(&span, |place| idle &= count[place] > 1);
        if idle {
            need.served(&span, |place| count[place] -= 1);
            chosen.retain(|&other| other != k);
        }
    }
}

/// Serves each place where too large a disc is left, as long as a line helps; what is left then.
fn repair<'f>(
    work: &Work<'f>,
    candidates: &[Candidate<'_>],
    chosen: &mut Vec<usize>,
) -> Unswept<'f> {
    let mut unswept = work.lap.and(&pieces_of(candidates, chosen));
    for _ in 0..ROUNDS {
        let before = chosen.len();
        let spots = unswept.spots(work.target, usize::MAX);
        if spots.is_empty() {
            break;
        }
        let over = (work.target / 2.0 - FINE_GUARD).max(0.002);
        let mut need = Need::new(work.floor, &unswept, over, 1);
        for spot in spots {
            let within = work.floor.reach + spot.diameter / 2.0 - 0.002;
            let helps = |k: usize| candidates[k].off_squared(spot.at) < within * within;
            if !chosen[before..].iter().any(|&k| helps(k)) {
                chosen.extend(best_of(&need, candidates, helps));
                if let Some(&k) = chosen.last() {
                    need.serve(&need.span(&candidates[k].pieces));
                }
            }
        }
        if chosen.len() == before {
            break;
        }
        unswept = unswept.and(&pieces_of(candidates, &chosen[before..]));
    }
    unswept
}

/// Of the lines that help, the one that serves most for its cost; of very many, among a sample.
fn best_of(
    need: &Need,
    candidates: &[Candidate<'_>],
    helps: impl Fn(usize) -> bool,
) -> Option<usize> {
    let able: Vec<usize> = (0..candidates.len()).filter(|&k| helps(k)).collect();
    let stride = able.len().div_ceil(SAMPLE).max(1);
    let worth = |k: usize| need.gain(&need.span(&candidates[k].pieces)) as f64 / candidates[k].cost;
    able.into_iter().step_by(stride).max_by(|&a, &b| worth(a).total_cmp(&worth(b)).then(b.cmp(&a)))
}

/// The candidate that comes nearest to a place, and how near, metres.
fn nearest(candidates: &[Candidate<'_>], at: Point) -> Option<(usize, f64)> {
    candidates
        .iter()
        .enumerate()
        .map(|(k, candidate)| (k, candidate.off_squared(at)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(k, square)| (k, square.sqrt()))
}

fn pieces_of(candidates: &[Candidate<'_>], chosen: &[usize]) -> Vec<Segment> {
    let pieces = chosen.iter().flat_map(|&k| candidates[k].pieces.iter());
    pieces.copied().collect()
}
