//! A line through many points with few of them: the rule of Douglas and Peucker (1973). Keeps the ends, and knows
//! neither what the points stand for nor whether the line crosses itself.

use super::Point;

/// The points between the ends of `stretch` that a line from its first to its last point has to pass, so that
/// none of those left out lies farther off than `tolerance`; in order, with the last point and without the
/// first. `at` tells where each point is.
pub fn kept(
    at: &impl Fn(usize) -> Point,
    stretch: (usize, usize),
    tolerance: f64,
) -> impl Iterator<Item = usize> {
    let mut open = vec![stretch];
    std::iter::from_fn(move || {
        // What comes first lies on top. No recursion: a long way may halve badly.
        while let Some(stretch) = open.pop() {
            match farthest(at, stretch) {
                Some((k, off)) if off > tolerance => open.extend([(k, stretch.1), (stretch.0, k)]),
                _ => return Some(stretch.1),
            }
        }
        None
    })
}

/// The point between the ends of `stretch` that lies farthest off the line between them, with how far.
pub fn farthest(at: &impl Fn(usize) -> Point, stretch: (usize, usize)) -> Option<(usize, f64)> {
    let (first, along) = (at(stretch.0), at(stretch.1) - at(stretch.0));
    let off = |p: Point| {
        let t = ((p - first).dot(&along) / along.norm_squared().max(1e-18)).clamp(0.0, 1.0);
        (first + along * t - p).norm()
    };
    (stretch.0 + 1..stretch.1).map(|k| (k, off(at(k)))).max_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Segment;

    #[test]
    fn what_is_left_out_lies_on_the_line_and_what_stays_is_needed() {
        let corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (1.0, 2.0), (1.0, 2.0)];
        let points: Vec<Point> = corners
            .windows(2)
            .flat_map(|two| {
                let (from, to) =
                    (Point::from(<[f64; 2]>::from(two[0])), Point::from(<[f64; 2]>::from(two[1])));
                (0..20).map(move |k| from + (to - from) * f64::from(k) / 20.0)
            })
            .collect();
        let at = |k: usize| points[k];
        let last = points.len() - 1;
        let line: Vec<usize> = kept(&at, (0, last), 0.001).collect();
        assert_eq!(line, [20, 40, last]);
        // Within half a metre the shorter corner cannot be told from a straight line.
        let coarse: Vec<usize> = kept(&at, (0, last), 1.5).collect();
        let ends: Vec<usize> = std::iter::once(0).chain(coarse).collect();
        for two in ends.windows(2) {
            let side = Segment::new(at(two[0]), at(two[1]));
            assert!((two[0]..two[1]).all(|k| side.distance_squared(at(k)) <= 1.5 * 1.5));
        }
        assert!(ends.len() < 4, "{ends:?}");
    }

    #[test]
    fn a_stretch_of_two_points_and_one_that_ends_where_it_began_have_a_line() {
        let points = [Point::origin(), Point::new(1.0, 0.0), Point::origin()];
        let at = |k: usize| points[k];
        assert_eq!(kept(&at, (0, 1), 0.1).collect::<Vec<_>>(), [1]);
        assert_eq!(kept(&at, (0, 2), 0.1).collect::<Vec<_>>(), [1, 2]);
    }
}
