//! A drawn ring without what noise put on it: steps in a straight wall, breaks in a round one, inner
//! corners that were cut off. Knows nothing of the runs that the ring was drawn from.

use super::assemble::Vertex;
use super::corner::Judge;
use super::whole::with_whole_arcs;
use crate::geometry::Point;

/// `vertices` as plain as the noise of the contacts that `judge` knows allows.
pub(super) fn plain(vertices: Vec<Vertex>, judge: &Judge<'_>) -> Vec<Vertex> {
    with_corners(with_whole_arcs(without_jogs(vertices, judge.tolerance()), judge), judge)
}

/// No ring has fewer corners than this: one with an arc may have two.
fn least(vertices: &[Vertex]) -> usize {
    if vertices.iter().all(|vertex| vertex.bulge == 0.0) { 3 } else { 2 }
}

/// Without the corners between straight pieces that a straight piece past them explains within
/// `tolerance` (metres): steps in a wall that are no larger than the noise.
fn without_jogs(mut vertices: Vec<Vertex>, tolerance: f64) -> Vec<Vertex> {
    // What was left out between each vertex and the next.
    let mut passed: Vec<Vec<Point>> = vec![Vec::new(); vertices.len()];
    let off = |p: Point, a: Point, b: Point| {
        let along = b - a;
        let t = ((p - a).dot(&along) / along.norm_squared().max(1e-18)).clamp(0.0, 1.0);
        (a + along * t - p).norm()
    };
    while vertices.len() > least(&vertices) {
        let count = vertices.len();
        let straight = |k: usize| vertices[k].bulge == 0.0;
        let least = (0..count)
            .filter(|&k| straight(k) && straight((k + count - 1) % count))
            .map(|k| {
                let before = (k + count - 1) % count;
                let (a, b) = (vertices[before].at, vertices[(k + 1) % count].at);
                let points = passed[before].iter().chain(&passed[k]);
                let worst = points.map(|p| off(*p, a, b)).fold(off(vertices[k].at, a, b), f64::max);
                (k, worst)
            })
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((k, _)) = least.filter(|(_, worst)| *worst < tolerance) else {
            break;
        };
        let mut more = passed.remove(k);
        let gone = vertices.remove(k);
        more.push(gone.at);
        let before = (k + count - 1) % count;
        let before = if before > k { before - 1 } else { before };
        passed[before].append(&mut more);
    }
    vertices
}

/// With the inner corners that were cut off where the last contacts of two walls gave runs too short to be
/// drawn out, while the walls as a whole are long enough to tell where they meet.
fn with_corners(mut vertices: Vec<Vertex>, judge: &Judge<'_>) -> Vec<Vertex> {
    let mut k = 0;
    while vertices.len() > 4 && k < vertices.len() {
        let count = vertices.len();
        let at = |n: usize| vertices[(k + count + n - 1) % count];
        // The cut leads from the second of these to the third.
        let four = [at(0), at(1), at(2), at(3)];
        let straight = four[..3].iter().all(|vertex| vertex.bulge == 0.0);
        let corner = judge.cut_off(four.map(|vertex| vertex.at)).filter(|_| straight);
        if let Some(corner) = corner {
            // The later one leaves along its own wall.
            let next = (k + 1) % count;
            vertices[next].at = corner;
            vertices.remove(k);
        }
        k += 1;
    }
    vertices
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::angle;
    use crate::mapping::shape::Sample;

    fn plain_of(corners: &[(f64, f64, f64)]) -> Vec<Vertex> {
        let of = |&(x, y, bulge): &(f64, f64, f64)| Vertex { at: Point::new(x, y), bulge, run: 0 };
        let samples: [Sample; 0] = [];
        let judge = Judge { samples: &samples, sigma: 0.001, reach: 0.16 };
        plain(corners.iter().map(of).collect(), &judge)
    }

    #[test]
    fn half_a_disc_keeps_one_arc_and_one_wall() {
        // The wall steps by 3 mm, and the arc of 1 m, drawn in two, is 4 mm off at their joint.
        let quarter = angle::tan(angle::PI / 8.0);
        let left = plain_of(&[
            (-1.0, 0.0, 0.0),
            (0.4, 0.003, 0.0),
            (1.0, 0.0, quarter),
            (0.0, 1.004, quarter),
        ]);
        assert_eq!(left.len(), 2);
        assert!((left[1].bulge - 1.0).abs() < 0.01, "{}", left[1].bulge);
        assert_eq!(left[0].bulge, 0.0);
    }

    #[test]
    fn an_arc_is_drawn_out_over_its_straight_end_on_either_side() {
        // Half a disc of 2.4 m whose last 14 cm before a corner make a straight piece, 3 mm off.
        let up = (2.4 * (1.0 - (0.14_f64 / 2.4).powi(2)).sqrt() + 0.003, 0.14);
        let bulge = angle::tan((angle::PI - angle::atan2(up.1, up.0)) / 4.0);
        let left = plain_of(&[(-2.4, 0.0, 0.0), (2.4, 0.0, 0.0), (up.0, up.1, bulge)]);
        assert_eq!(left.len(), 2, "{left:?}");
        assert!((left[1].bulge - 1.0).abs() < 0.01, "{}", left[1].bulge);
        let left = plain_of(&[(-up.0, up.1, 0.0), (-2.4, 0.0, 0.0), (2.4, 0.0, bulge)]);
        assert_eq!(left.len(), 2, "{left:?}");
        // A wall of that length on which the arc ends is a wall.
        let niche = plain_of(&[(-2.4, 0.0, 0.0), (2.6, 0.0, 0.0), (2.4, 0.1, 0.95)]);
        assert_eq!(niche.len(), 3, "{niche:?}");
    }

    #[test]
    fn of_a_round_room_with_a_passage_two_arcs_are_one() {
        // Five sixths of a circle of 1 m above a passage, drawn in two, 4 mm off at their joint.
        let joint = angle::unit(1.2) * 1.004;
        let (right, left) = (angle::unit(-angle::PI / 3.0), angle::unit(-angle::PI / 1.5));
        let arc = |from: f64, to: f64| angle::tan((to - from) / 4.0);
        let left = plain_of(&[
            (left.x, left.y, 0.0),
            (left.x, -2.0, 0.0),
            (right.x, -2.0, 0.0),
            (right.x, right.y, arc(-angle::PI / 3.0, 1.2)),
            (joint.x, joint.y, arc(1.2, 4.0 * angle::PI / 3.0)),
        ]);
        assert_eq!(left.len(), 4, "{left:?}");
        assert!((left[3].bulge - arc(0.0, 5.0 * angle::PI / 3.0)).abs() < 0.05, "{left:?}");
    }

    #[test]
    fn arcs_of_two_radii_stay_two() {
        let left = plain_of(&[(0.0, 0.0, 0.0), (2.0, 0.0, 0.5), (2.0, 1.0, 0.2)]);
        assert_eq!(left.len(), 3);
    }
}
