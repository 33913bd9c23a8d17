//! The outline when no fit of lines and arcs makes a simple one: the contacts themselves, joined in
//! order, untangled and thinned. Nothing is drawn that was not touched.

use super::order;
use crate::geometry::{Point, Ring, cross};
use crate::mapping::map::{Contact, ContactKind};

/// Contacts nearer than this to the line between their neighbours are left out, metres.
const TOLERANCE: f64 = 0.003;
/// Rounds of untangling at most.
const ROUNDS: usize = 400;

/// A simple polygon through the contacts; none when there are too few or they cannot be untangled.
pub(super) fn outline(contacts: &[Contact]) -> Option<Ring> {
    let mut points: Vec<Point> = order::along_wall(contacts)
        .iter()
        .filter(|contact| contact.kind != ContactKind::Edge)
        .map(|contact| contact.point)
        .collect();
    points.dedup_by(|a, b| (*a - *b).norm() < 0.002);
    if points.len() < 4 || !untangle(&mut points) {
        return None;
    }
    let thin = thinned(&points);
    let kept = if first_crossing(&thin).is_none() && thin.len() >= 3 { thin } else { points };
    Some(Ring::polygon(&kept))
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
    let side = |k: usize| (points[k], points[(k + 1) % count]);
    let mut order: Vec<usize> = (0..count).collect();
    let low = |k: usize| side(k).0.x.min(side(k).1.x);
    let high = |k: usize| side(k).0.x.max(side(k).1.x);
    order.sort_by(|&a, &b| low(a).total_cmp(&low(b)));
    let mut active: Vec<usize> = Vec::new();
    for &k in &order {
        active.retain(|&j| high(j) >= low(k));
        for &j in &active {
            let (a, b) = (j.min(k), j.max(k));
            let neighbours = b - a <= 1 || (a == 0 && b == count - 1);
            if !neighbours && cross_each_other(side(a), side(b)) {
                return Some((a, b));
            }
        }
        active.push(k);
    }
    None
}

fn cross_each_other(p: (Point, Point), q: (Point, Point)) -> bool {
    let left = |a: Point, b: Point, c: Point| cross(b - a, c - a);
    left(q.0, q.1, p.0) * left(q.0, q.1, p.1) < 0.0
        && left(p.0, p.1, q.0) * left(p.0, p.1, q.1) < 0.0
}

/// Douglas and Peucker's thinning, from two contacts far apart.
fn thinned(points: &[Point]) -> Vec<Point> {
    let far = (0..points.len())
        .max_by(|&a, &b| (points[a] - points[0]).norm().total_cmp(&(points[b] - points[0]).norm()))
        .unwrap_or(0);
    let mut closed = points.to_vec();
    closed.push(points[0]);
    let mut kept = vec![points[0]];
    thin(&closed[..=far], &mut kept);
    thin(&closed[far..], &mut kept);
    kept.pop();
    kept
}

fn thin(points: &[Point], kept: &mut Vec<Point>) {
    let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
        return;
    };
    let along = last - first;
    let off = |p: &Point| {
        let t = ((p - first).dot(&along) / along.norm_squared().max(1e-18)).clamp(0.0, 1.0);
        (first + along * t - p).norm()
    };
    let farthest = (1..points.len().saturating_sub(1))
        .max_by(|&a, &b| off(&points[a]).total_cmp(&off(&points[b])));
    match farthest {
        Some(k) if off(&points[k]) > TOLERANCE => {
            thin(&points[..=k], kept);
            thin(&points[k..], kept);
        }
        _ => kept.push(last),
    }
}
