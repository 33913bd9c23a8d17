//! The smallest rectangle round an object, whichever way it lies: what a person would measure
//! with a folding rule. Knows points only.

use super::{Point, Ring, Vector, cross, perp};

/// Size and place of an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure {
    /// Centroid of the area (of the rectangle for an outline without area).
    pub center: Point,
    /// Shorter side of the smallest rectangle, metres.
    pub width: f64,
    /// Longer side, metres.
    pub length: f64,
    /// Area within the outline, square metres.
    pub area: f64,
}

/// Measures `ring`; none when it has no points.
#[must_use]
pub fn measure(ring: &Ring) -> Option<Measure> {
    let points = ring.to_points(0.0005);
    let hull = hull(&points);
    let first = *hull.first()?;
    let mut best = (f64::INFINITY, f64::INFINITY, first);
    for (k, &from) in hull.iter().enumerate() {
        let along = hull[(k + 1) % hull.len()] - from;
        let Some(ahead) = along.try_normalize(1e-9) else {
            continue;
        };
        let (width, length, center) = box_along(&hull, ahead);
        if width * length < best.0 * best.1 {
            best = (width, length, center);
        }
    }
    let (width, length, middle) = best;
    if !width.is_finite() {
        return Some(Measure { center: first, width: 0.0, length: 0.0, area: 0.0 });
    }
    Some(Measure {
        center: centroid(&points).unwrap_or(middle),
        width: width.min(length),
        length: width.max(length),
        area: ring.area().abs(),
    })
}

/// Extent across and along `ahead`, and the middle of that box.
fn box_along(hull: &[Point], ahead: Vector) -> (f64, f64, Point) {
    let left = perp(ahead);
    let range = |axis: Vector| {
        hull.iter()
            .map(|p| p.coords.dot(&axis))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let (a, b) = range(ahead);
    let (c, d) = range(left);
    let middle = ahead * (f64::midpoint(a, b)) + left * (f64::midpoint(c, d));
    (d - c, b - a, Point::from(middle))
}

/// Convex hull, counter-clockwise, by the monotone chain.
fn hull(points: &[Point]) -> Vec<Point> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let mut lower = chain(sorted.iter());
    let upper = chain(sorted.iter().rev());
    lower.pop();
    lower.extend(upper);
    lower.pop();
    lower
}

fn chain<'a>(points: impl Iterator<Item = &'a Point>) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for &p in points {
        while let [.., a, b] = kept[..] {
            if cross(b - a, p - b) > 0.0 {
                break;
            }
            kept.pop();
        }
        kept.push(p);
    }
    kept
}

/// Centroid of a polygon's area; none for one without area.
fn centroid(points: &[Point]) -> Option<Point> {
    let origin = *points.first()?;
    let mut sum = Vector::zeros();
    let mut twice = 0.0;
    for (k, p) in points.iter().enumerate() {
        let a = p - origin;
        let b = points[(k + 1) % points.len()] - origin;
        let area = cross(a, b);
        sum += (a + b) * (area / 3.0);
        twice += area;
    }
    (twice.abs() > 1e-9).then(|| origin + sum / twice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;

    #[test]
    fn a_tilted_box_is_measured_along_its_own_sides() {
        let tilted = Pose::new(3.0, -1.0, 0.4);
        let corner = |x: f64, y: f64| tilted.to_world(Point::new(x, y));
        let corners = [corner(0.0, 0.0), corner(0.6, 0.0), corner(0.6, 0.25), corner(0.0, 0.25)];
        let size = measure(&Ring::polygon(&corners)).expect("a box has a size");
        assert!((size.length - 0.6).abs() < 1e-9, "length {}", size.length);
        assert!((size.width - 0.25).abs() < 1e-9, "width {}", size.width);
        assert!((size.area - 0.15).abs() < 1e-9, "area {}", size.area);
        assert!((size.center - corner(0.3, 0.125)).norm() < 1e-9, "centre {}", size.center);
    }

    #[test]
    fn a_circle_is_as_wide_as_long() {
        let size = measure(&Ring::circle(Point::new(1.0, 2.0), 0.2)).expect("a circle has a size");
        assert!((size.width - 0.4).abs() < 0.002, "width {}", size.width);
        assert!((size.center - Point::new(1.0, 2.0)).norm() < 1e-6, "centre {}", size.center);
    }

    #[test]
    fn what_has_no_area_has_no_width() {
        let line = Ring::polygon(&[Point::new(0.0, 0.0), Point::new(1.0, 0.0)]);
        let size = measure(&line).expect("two points have a length");
        assert!(size.width.abs() < 1e-12 && (size.length - 1.0).abs() < 1e-12, "{size:?}");
        assert!(measure(&Ring::default()).is_none(), "nothing has no size");
    }
}
