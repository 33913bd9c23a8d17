//! The outline when no fit of lines and arcs makes a simple one: the contacts themselves, joined in
//! order, untangled and thinned. Nothing is drawn that was not touched.

use crate::geometry::segment::Segment;
use crate::geometry::simple::crossings;
use crate::geometry::{Point, Ring, thin};
use crate::mapping::map::{Contact, ContactKind};
use std::collections::BTreeSet;

/// Contacts nearer than this to the line between their neighbours are left out, metres.
pub(super) const TOLERANCE: f64 = 0.004;
/// Rounds of untangling at most.
const ROUNDS: usize = 400;

/// A simple polygon through contacts `ordered` along the wall; none when there are too few or they cannot be
/// untangled.
pub(super) fn outline(ordered: &[Contact]) -> Option<Ring> {
    let mut points: Vec<Point> = ordered
        .iter()
        .filter(|contact| contact.kind != ContactKind::Edge)
        .map(|contact| contact.point)
        .collect();
    points.dedup_by(|a, b| (*a - *b).norm() < 0.002);
    if points.len() < 4 || !untangle(&mut points) {
        return None;
    }
    let thin = thinned(&points, TOLERANCE);
    (thin.len() >= 3).then(|| Ring::polygon(&thin))
}

/// Reverses the piece between two crossing sides until none cross (2-opt): each reversal makes the
/// outline shorter, so it ends. Contacts that came in the wrong order fall into place.
fn untangle(points: &mut [Point]) -> bool {
    let count = points.len();
    for _ in 0..ROUNDS {
        let Some((i, j)) = first_crossing(points) else {
            return true;
        };
        let inner = j - i;
        if inner <= count / 2 {
            points[i + 1..=j].reverse();
        } else {
            // The shorter way round is the one through the end of the list.
            points.rotate_left(j + 1);
            let turned = count - j - 1 + i;
            points[..=turned].reverse();
        }
    }
    first_crossing(points).is_none()
}

fn first_crossing(points: &[Point]) -> Option<(usize, usize)> {
    let count = points.len();
    let side = |k: usize| Segment::new(points[k], points[(k + 1) % count]);
    let mut order: Vec<usize> = (0..count).collect();
    let low = |k: usize| points[k].x.min(points[(k + 1) % count].x);
    let high = |k: usize| points[k].x.max(points[(k + 1) % count].x);
    order.sort_by(|&a, &b| low(a).total_cmp(&low(b)));
    let mut active: Vec<usize> = Vec::new();
    for &k in &order {
        active.retain(|&j| high(j) >= low(k));
        for &j in &active {
            let (a, b) = (j.min(k), j.max(k));
            let neighbours = b - a <= 1 || (a == 0 && b == count - 1);
            if !neighbours && side(a).crosses(&side(b)) {
                return Some((a, b));
            }
        }
        active.push(k);
    }
    None
}

/// Thinned by Douglas and Peucker's rule to within `tolerance` (metres), from two corners far apart,
/// of a simple polygon; where that would make it cross itself, more of its corners stay.
pub(super) fn thinned(points: &[Point], tolerance: f64) -> Vec<Point> {
    let count = points.len();
    let far = (0..count)
        .max_by(|&a, &b| (points[a] - points[0]).norm().total_cmp(&(points[b] - points[0]).norm()))
        .unwrap_or(0);
    let at = |k: usize| points[k % count];
    let sides =
        [(0, far), (far, count)].into_iter().flat_map(|side| thin::kept(&at, side, tolerance));
    let mut kept: Vec<usize> = std::iter::once(0).chain(sides).collect();
    kept.pop();
    loop {
        let ring: Vec<Point> = kept.iter().map(|k| points[*k]).collect();
        let crossing = crossings(&ring);
        let sides = crossing.iter().flat_map(|(i, k)| [*i, *k]);
        let restored: BTreeSet<usize> = sides
            .filter_map(|side| {
                let (from, to) = (kept[side], kept.get(side + 1).copied().unwrap_or(count));
                thin::farthest(&at, (from, to)).map(|(k, _)| k)
            })
            .collect();
        if restored.is_empty() {
            return ring;
        }
        kept.extend(restored);
        kept.sort_unstable();
        kept.dedup();
    }
}
