//! Whether a closed polygon crosses itself, and where. Arcs are judged by their chords.

use super::{Point, cross};

/// Pairs (i, k), i < k, of edges of the closed polygon `points` that cross or touch although they
/// are not neighbours; edge i runs from point i to the next.
#[must_use]
pub fn crossings(points: &[Point]) -> Vec<(usize, usize)> {
    let count = points.len();
    // Edges ordered by their left end: only those that overlap in x are compared.
    let mut order: Vec<(f64, f64, usize)> = (0..count)
        .map(|k| {
            let (a, b) = (points[k], points[(k + 1) % count]);
            (a.x.min(b.x), a.x.max(b.x), k)
        })
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
    let mut found = Vec::new();
    for (rank, &(_, right, i)) in order.iter().enumerate() {
        for &(left, _, k) in &order[rank + 1..] {
            if left > right {
                break;
            }
            let (low, high) = (i.min(k), i.max(k));
            let adjacent = high - low == 1 || (low == 0 && high == count - 1);
            if !adjacent && edges_meet(points, low, high) {
                found.push((low, high));
            }
        }
    }
    found.sort_unstable();
    found
}

fn edges_meet(points: &[Point], i: usize, k: usize) -> bool {
    let next = |n: usize| points[(n + 1) % points.len()];
    segments_meet(points[i], next(i), points[k], next(k))
}

/// Whether the straight pieces a-b and c-d have a point in common.
#[must_use]
pub fn segments_meet(a: Point, b: Point, c: Point, d: Point) -> bool {
    let boxes_apart = a.x.max(b.x) < c.x.min(d.x)
        || c.x.max(d.x) < a.x.min(b.x)
        || a.y.max(b.y) < c.y.min(d.y)
        || c.y.max(d.y) < a.y.min(b.y);
    if boxes_apart {
        return false;
    }
    let (c_side, d_side) = (cross(b - a, c - a), cross(b - a, d - a));
    let (a_side, b_side) = (cross(d - c, a - c), cross(d - c, b - c));
    c_side * d_side <= 0.0 && a_side * b_side <= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bow_tie_crosses_once_and_a_square_never() {
        let square =
            [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point::new(x, y));
        assert!(crossings(&square).is_empty());
        let bow = [square[0], square[2], square[1], square[3]];
        assert_eq!(crossings(&bow), [(0, 2)]);
    }
}
