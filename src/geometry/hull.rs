//! Convex hull by Jarvis's march (gift wrapping), the paper's choice for telling convex outlines
//! from concave ones (III.D).

use super::{Point, cross};

/// Indices of the corners of the convex hull of `points`, counter-clockwise from the lowest of
/// the leftmost; points on an edge of the hull are left out. O(n h) for h corners.
#[must_use]
pub fn jarvis(points: &[Point]) -> Vec<usize> {
    let Some(first) = (0..points.len()).min_by(|&a, &b| {
        let (a, b) = (points[a], points[b]);
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
    }) else {
        return Vec::new();
    };
    let mut hull = vec![first];
    let mut at = first;
    while hull.len() <= points.len() {
        let mut next = at;
        for k in 0..points.len() {
            if points[k] == points[at] {
                continue;
            }
            if next == at {
                next = k;
                continue;
            }
            let (best, this) = (points[next] - points[at], points[k] - points[at]);
            let side = cross(best, this);
            // The march keeps everything on its left; of collinear points the farthest is taken.
            if side < 0.0 || (side == 0.0 && this.norm_squared() > best.norm_squared()) {
                next = k;
            }
        }
        if next == at || points[next] == points[first] {
            break;
        }
        hull.push(next);
        at = next;
    }
    hull
}

/// How far the outline `points` falls back behind its convex hull at most, metres; zero for a
/// convex one.
#[must_use]
pub fn deepest_bay(points: &[Point]) -> f64 {
    let hull = jarvis(points);
    let mut deepest: f64 = 0.0;
    for &p in points {
        let mut depth = f64::INFINITY;
        for (k, &a) in hull.iter().enumerate() {
            let b = points[hull[(k + 1) % hull.len()]];
            let along = b - points[a];
            let length = along.norm();
            if length > 0.0 {
                depth = depth.min(cross(along, p - points[a]) / length);
            }
        }
        if depth.is_finite() {
            deepest = deepest.max(depth);
        }
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_march_wraps_a_square_with_things_inside_and_on_its_edges() {
        let points: Vec<Point> =
            [(1.0, 1.0), (0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 0.0)]
                .iter()
                .map(|&(x, y)| Point::new(x, y))
                .collect();
        let hull = jarvis(&points);
        let corners: Vec<Point> = hull.iter().map(|&k| points[k]).collect();
        assert_eq!(
            corners,
            [
                Point::new(0.0, 0.0),
                Point::new(2.0, 0.0),
                Point::new(2.0, 2.0),
                Point::new(0.0, 2.0)
            ]
        );
        assert!((deepest_bay(&points) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn few_points_do_no_harm() {
        assert!(jarvis(&[]).is_empty());
        assert_eq!(jarvis(&[Point::new(1.0, 2.0)]), [0]);
        assert_eq!(deepest_bay(&[Point::new(1.0, 2.0), Point::new(3.0, 1.0)]), 0.0);
    }
}
