//! One arc where noise drew several pieces: two arcs that meet, an arc whose last contacts make a straight piece
//! of their own, two with a stretch between that nobody looked at. Knows the ring that was drawn and the contacts.

use super::Sample;
use super::assemble::Vertex;
use super::corner::Judge;
use super::segment::WIDEST_ON_ARC;
use crate::geometry::fit::Moments;
use crate::geometry::{Piece, Point, Ring, angle, cross};

/// As many pieces are looked at together: two arcs, and what two short runs and the gaps beside them leave.
const MOST_PIECES: usize = 8;
/// The straight ones among them are no longer than this share of the arcs.
const STRAIGHT: f64 = 0.25;
/// A round wall so long is bent by the drift of the heading as much again as its contacts scatter, metres.
const BENT_OVER: f64 = 8.0;
/// So many arcs are tried between the flattest and the roundest through one of the places that it should pass.
const TRIALS: u32 = 32;
/// An arc of more than this is all but round, radians: 330 degrees.
const ALL_BUT_ROUND: f64 = 330.0 * angle::PI / 180.0;
/// A contact is of a straight piece that it lies no farther from than this, metres, and the tolerance.
const OF_THE_PIECE: f64 = 0.02;

/// With one arc for pieces of it, where it explains them and their contacts.
pub(super) fn with_whole_arcs(mut vertices: Vec<Vertex>, judge: &Judge<'_>) -> Vec<Vertex> {
    let tolerance = judge.tolerance();
    let mut k = 0;
    while k < vertices.len() {
        let count = vertices.len();
        // What is left is a ring of two at least.
        let found = (2..=MOST_PIECES.min(count.saturating_sub(1))).rev().find_map(|pieces| {
            let stretch: Vec<Vertex> = (0..=pieces).map(|n| vertices[(k + n) % count]).collect();
            Some((pieces, one_arc(&stretch, judge, tolerance)?))
        });
        let Some((pieces, bulge)) = found else {
            k += 1;
            continue;
        };
        vertices[k].bulge = bulge;
        vertices.rotate_left(k + 1);
        vertices.drain(..pieces - 1);
        k = 0;
    }
    vertices
}

/// The circle for a `ring` that is all but one: an arc, and where the lap was joined a straight piece; the same ring
/// where it is none. The contacts lie on the circle as well as a lap so long lets them.
pub(super) fn closed(ring: Ring, judge: &Judge<'_>) -> Ring {
    let [one, other] = ring.pieces[..] else { return ring };
    let arc = if one.length() > other.length() { one } else { other };
    let Piece::Arc { sweep, .. } = arc else { return ring };
    let Some(first) = judge.samples.first() else { return ring };
    let mut moments = Moments::new(first.point);
    for sample in judge.samples {
        moments.add(sample.point, sample.weight);
    }
    let Some(circle) = moments.circle() else { return ring };
    let off = |s: &Sample| ((s.point - circle.center).norm() - circle.radius).abs();
    let worst = judge.samples.iter().map(off).fold(0.0, f64::max);
    let bent = 1.0 + angle::TAU * circle.radius / BENT_OVER;
    if sweep > ALL_BUT_ROUND && worst < judge.tolerance() * bent {
        Ring::circle(circle.center, circle.radius)
    } else {
        ring
    }
}

/// The bulge of the arc from the first of the vertices to the last that explains all between them; none where
/// there is none.
fn one_arc(vertices: &[Vertex], judge: &Judge<'_>, tolerance: f64) -> Option<f64> {
    let (from, to) = (vertices[0].at, vertices[vertices.len() - 1].at);
    let drawn = |pair: &[Vertex]| Piece::with_bulge(pair[0].at, pair[1].at, pair[0].bulge);
    let pieces: Vec<Piece> = vertices.windows(2).map(drawn).collect();
    let is_arc = |piece: &Piece| matches!(piece, Piece::Arc { .. });
    let bulges = || vertices[..pieces.len()].iter().map(|vertex| vertex.bulge);
    let alike = bulges().all(|bulge| bulge >= 0.0) || bulges().all(|bulge| bulge <= 0.0);
    // What is straight at either end may be a part of it, or its neighbour.
    let ends = is_arc(&pieces[0]) || is_arc(&pieces[pieces.len() - 1]);
    let length = |arcs: bool| -> f64 {
        pieces.iter().filter(|piece| is_arc(piece) == arcs).map(Piece::length).sum()
    };
    let (round, straight) = (length(true), length(false));
    if !alike || !ends || straight >= STRAIGHT * round {
        return None;
    }
    let mut on_it: Vec<Point> = Vec::new();
    for (piece, pair) in pieces.iter().zip(vertices.windows(2)) {
        if is_arc(piece) {
            on_it.extend([pair[0].at, piece.at(0.5), pair[1].at]);
        } else {
            on_it.extend(contacts_of(piece, judge, tolerance));
        }
    }
    let worst = |bulge: f64| {
        let arc = Piece::with_bulge(from, to, bulge);
        on_it.iter().map(|p| arc.distance(*p)).fold(0.0, f64::max)
    };
    // Of much of a circle, a place near one end of the arc tells little of the rest.
    let inner = |p: &&Point| (**p - from).norm() > tolerance && (**p - to).norm() > tolerance;
    let through = on_it.iter().filter(inner).map(|p| Piece::bulge_through(from, *p, to));
    let (least, most) =
        through.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(t), b.max(t)));
    let between = (0..=TRIALS).map(|k| least + (most - least) * f64::from(k) / f64::from(TRIALS));
    let best = between.min_by(|a, b| worst(*a).total_cmp(&worst(*b)))?;
    let Piece::Arc { radius, .. } = Piece::with_bulge(from, to, best) else { return None };
    // What nobody has looked at for longer may be anything.
    let widest = pieces.iter().filter(|p| !is_arc(p)).map(Piece::length).fold(0.0, f64::max);
    let fits = widest <= WIDEST_ON_ARC * radius
        && worst(best) < tolerance * (1.0 + (round + straight) / BENT_OVER);
    fits.then_some(best)
}

/// The contacts of a straight piece: beside it, and seen from its side.
fn contacts_of(piece: &Piece, judge: &Judge<'_>, tolerance: f64) -> Vec<Point> {
    let (from, along, length) = (piece.from(), piece.tangent(0.5), piece.length());
    let is_of = |p: Point| {
        let off = p - from;
        (0.0..=length).contains(&off.dot(&along))
            && cross(along, off).abs() < tolerance + OF_THE_PIECE
    };
    let samples = judge.samples.iter();
    let of_it = samples.filter(|s| is_of(s.point) && cross(along, s.from - from) > 0.0);
    of_it.map(|sample| sample.point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertices(corners: &[(Point, f64)]) -> Vec<Vertex> {
        corners.iter().map(|&(at, bulge)| Vertex { at, bulge, run: 0 }).collect()
    }

    /// The bulge of an arc about the origin between two bearings, radians.
    fn arc(from: f64, to: f64) -> f64 {
        angle::tan((to - from) / 4.0)
    }

    fn on(radius: f64, bearing: f64) -> Point {
        Point::origin() + angle::unit(bearing) * radius
    }

    /// What is left of `corners` when the robot has seen `seen` from the middle.
    fn left(corners: &[(Point, f64)], seen: &[Point]) -> Vec<Vertex> {
        let seen: Vec<Sample> = seen.iter().map(|p| sample(*p)).collect();
        let judge = Judge { samples: &seen, sigma: 0.001, reach: 0.16 };
        with_whole_arcs(vertices(corners), &judge)
    }

    fn sample(point: Point) -> Sample {
        Sample {
            point,
            from: point + (Point::new(0.0, 0.5) - point) * 0.1,
            weight: 1.0,
            edges: Vec::new(),
        }
    }

    /// Half a disc of 4 m in two arcs, with a stretch between them of so many radians.
    fn half_disc(between: f64) -> [(Point, f64); 4] {
        let (before, after) = (1.5 - between / 2.0, 1.5 + between / 2.0);
        [
            (on(4.0, 0.0), arc(0.0, before)),
            (on(4.0, before), 0.0),
            (on(4.0, after), arc(after, angle::PI)),
            (on(4.0, angle::PI), 0.0),
        ]
    }

    #[test]
    fn a_stretch_of_a_round_wall_that_nobody_looked_at_is_round() {
        for between in [0.001, 0.2] {
            let left = left(&half_disc(between), &[]);
            assert_eq!(left.len(), 2, "{between}: {left:?}");
            assert!(left.iter().any(|vertex| (vertex.bulge - 1.0).abs() < 1e-3), "{left:?}");
        }
    }

    #[test]
    fn a_flat_wall_between_two_round_ones_stays_flat() {
        let corners = half_disc(0.3);
        let seen = [0.2, 0.5, 0.8].map(|t| {
            nalgebra::center(&corners[1].0, &corners[2].0)
                + (corners[2].0 - corners[1].0) * (t - 0.5)
        });
        assert_eq!(left(&corners, &seen).len(), 4);
        // What nobody looked at for longer than half the radius may be anything.
        assert_eq!(left(&half_disc(0.55), &[]).len(), 4);
    }

    #[test]
    fn a_long_round_wall_is_bent_by_more_than_a_short_one() {
        // In two arcs that meet 30 mm outside their circle.
        let bent = |radius: f64| {
            let joint = on(radius + 0.03, 1.0);
            let corners = [
                (on(radius, 0.0), arc(0.0, 1.0)),
                (joint, arc(1.0, angle::PI)),
                (on(radius, angle::PI), 0.0),
            ];
            left(&corners, &[]).len()
        };
        assert_eq!((bent(4.0), bent(0.5)), (2, 3));
    }

    #[test]
    fn a_ring_that_is_all_but_a_circle_is_one() {
        let seen = |off: f64| -> Vec<Sample> {
            (0..60)
                .map(|k| {
                    sample(on(
                        if k == 7 { 2.0 + off } else { 2.0 },
                        f64::from(k) * angle::TAU / 60.0,
                    ))
                })
                .collect()
        };
        let ring = Ring {
            pieces: vec![
                Piece::Arc {
                    center: Point::origin(),
                    radius: 2.0,
                    start: 0.0,
                    sweep: angle::TAU - 0.06,
                },
                Piece::Line { from: on(2.0, -0.06), to: on(2.0, 0.0) },
            ],
        };
        for (off, pieces) in [(0.008, 1), (0.1, 2)] {
            let seen = seen(off);
            let judge = Judge { samples: &seen, sigma: 0.001, reach: 0.16 };
            assert_eq!(closed(ring.clone(), &judge).pieces.len(), pieces, "{off} m");
        }
    }
}
