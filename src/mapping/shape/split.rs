//! Splits a complex outline into polygonal and circular parts (paper III.D), which tile it:
//! every arc with the floor inside it is cut off along its chord.

use super::classify::{BENT, SHALLOW, is_convex};
use crate::geometry::simple::{crossings, segments_meet};
use crate::geometry::{Piece, Point, Ring, angle, cross, meeting};
use crate::mapping::map::{Part, PartClass, ShapeClass};

/// Flatter arcs than this are left in their polygonal part, metres: the robot's reach covers them.
const LEAST_SAGITTA: f64 = 0.16;
/// What is shorter may cut off a corner, metres: body radius and range of the usual robot, which does not touch the
/// walls in a corner, and somewhat more where that is sharp.
const CORNER: f64 = 0.2;
/// Walls that meet in an angle with a smaller sine are one after the other.
const FLATTEST: f64 = 0.1;
/// Half a circle within this, radians.
const HALF_TOLERANCE: f64 = 10.0 * angle::PI / 180.0;
/// From this span on an arc with its mouth closed is a circle, radians.
const CIRCLE_SPAN: f64 = 240.0 * angle::PI / 180.0;
/// Chords stand for arcs within this, metres.
const SAGITTA: f64 = 0.001;

/// The parts of `outline`: one for everything that is not complex.
pub(super) fn parts(outline: &Ring, class: ShapeClass) -> Vec<Part> {
    let whole = |class, circle| {
        vec![Part { class, ring: outline.clone(), cut: vec![false; outline.pieces.len()], circle }]
    };
    match class {
        ShapeClass::Circle => {
            let circle = match outline.pieces.first() {
                Some(&Piece::Arc { center, radius, .. }) => Some((center, radius)),
                _ => None,
            };
            whole(PartClass::Circle, circle)
        }
        ShapeClass::Convex => whole(PartClass::Convex, None),
        ShapeClass::Concave => whole(PartClass::Concave, None),
        ShapeClass::Complex => divide(outline),
    }
}

fn divide(outline: &Ring) -> Vec<Part> {
    let mut rest = outline.pieces.clone();
    let mut cut = vec![false; rest.len()];
    let mut parts = Vec::new();
    loop {
        if let Some(part) = circular(&rest, &cut) {
            parts.push(part);
            return parts;
        }
        let Some(k) = (0..rest.len()).find(|&k| can_cut(&rest, k)) else {
            break;
        };
        let arc = rest[k];
        let chord = Piece::Line { from: arc.from(), to: arc.to() };
        if let Piece::Arc { center, radius, sweep, .. } = arc {
            parts.push(Part {
                class: arc_class(sweep),
                ring: Ring { pieces: vec![arc, chord.reversed()] },
                cut: vec![false, true],
                circle: Some((center, radius)),
            });
        }
        rest[k] = chord;
        cut[k] = true;
    }
    let ring = Ring { pieces: rest };
    let convex = is_convex(&ring.to_points(SAGITTA));
    let class = if convex { PartClass::Convex } else { PartClass::Concave };
    parts.push(Part { class, ring, cut, circle: None });
    parts
}

fn arc_class(sweep: f64) -> PartClass {
    if (sweep - angle::PI).abs() <= HALF_TOLERANCE {
        PartClass::Semicircle
    } else if sweep >= CIRCLE_SPAN {
        PartClass::Circle
    } else {
        PartClass::Sector
    }
}

/// The ring as one circular part: an arc with its chord, or with two radii. What cuts off the corners at the ends of
/// the arc may be shorter than the robot's reach: nobody can touch those corners, and contacts near them mislead.
fn circular(pieces: &[Piece], cut: &[bool]) -> Option<Part> {
    let at = pieces.iter().position(|p| matches!(p, Piece::Arc { sweep, .. } if *sweep > 0.0))?;
    let Piece::Arc { center, radius, sweep, .. } = pieces[at] else {
        return None;
    };
    let others: Vec<Piece> = pieces[at + 1..].iter().chain(&pieces[..at]).copied().collect();
    if !others.iter().all(|piece| matches!(piece, Piece::Line { .. })) {
        return None;
    }
    let class = if is_chord(&others) {
        arc_class(sweep)
    } else {
        let off = (apex(&others)? - center).norm();
        if off > 0.04 * radius + 0.01 {
            return None;
        }
        if (sweep - angle::PI).abs() <= HALF_TOLERANCE {
            PartClass::Semicircle
        } else {
            PartClass::Sector
        }
    };
    Some(Part {
        class,
        ring: Ring { pieces: pieces.to_vec() },
        cut: cut.to_vec(),
        circle: Some((center, radius)),
    })
}

/// Whether the straight pieces from the end of an arc to its beginning are one, but for what drift bends a wall and
/// what cuts off the corners at its ends.
fn is_chord(mut straight: &[Piece]) -> bool {
    if let [first, rest @ ..] = straight
        && first.length() < CORNER
        && !rest.is_empty()
    {
        straight = rest;
    }
    if let [rest @ .., last] = straight
        && last.length() < CORNER
        && !rest.is_empty()
    {
        straight = rest;
    }
    let (Some(first), Some(last)) = (straight.first(), straight.last()) else { return false };
    let chord = Piece::Line { from: first.from(), to: last.to() };
    let allowed = SHALLOW + BENT * chord.length();
    straight[1..].iter().all(|piece| chord.distance(piece.from()) < allowed)
}

/// Where the two of these straight pieces meet that are more than what cuts off a corner; none where there are not
/// two.
fn apex(straight: &[Piece]) -> Option<Point> {
    let mut long = straight.iter().filter(|piece| piece.length() >= CORNER);
    let (Some(one), Some(other), None) = (long.next(), long.next(), long.next()) else {
        return None;
    };
    let (u, v) = (one.tangent(0.5), other.tangent(0.5));
    if cross(u, v).abs() < FLATTEST {
        // Both radii of half a disc.
        return Some(one.to());
    }
    Some(one.to() + u * meeting(one.to(), u, other.from(), v))
}

/// Whether piece `k` is an arc with floor inside, deep enough to be a part, whose chord runs over
/// open floor.
fn can_cut(pieces: &[Piece], k: usize) -> bool {
    let Piece::Arc { radius, sweep, .. } = pieces[k] else {
        return false;
    };
    let sagitta = radius * (1.0 - angle::cos(sweep / 2.0));
    if sweep <= 0.0 || sagitta < LEAST_SAGITTA {
        return false;
    }
    let (from, to) = (pieces[k].from(), pieces[k].to());
    let mut others = pieces.to_vec();
    others[k] = Piece::Line { from, to };
    let remaining = Ring { pieces: others };
    if remaining.area() < 1e-3 || !crossings(&remaining.to_points(SAGITTA)).is_empty() {
        return false;
    }
    // The arc itself must not cross what remains either: the chord has to lie inside the floor.
    let inside = Ring { pieces: vec![pieces[k]] }.to_points(SAGITTA);
    !pieces.iter().enumerate().any(|(n, piece)| {
        let near = n == k || n + 1 == k || k + 1 == n || n.abs_diff(k) + 1 == pieces.len();
        !near && enters(piece, &inside, from, to)
    })
}

/// Whether `piece` reaches into the circular segment that `arc` (as points) makes with its chord.
fn enters(piece: &Piece, arc: &[Point], from: Point, to: Point) -> bool {
    let points = Ring { pieces: vec![*piece] }.to_points(SAGITTA);
    points.iter().zip(points.iter().skip(1).chain(std::iter::once(&piece.to()))).any(|(&a, &b)| {
        segments_meet(a, b, from, to)
            || arc.windows(2).any(|pair| segments_meet(a, b, pair[0], pair[1]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(radius: f64, bearing: f64) -> Point {
        Point::origin() + angle::unit(bearing) * radius
    }

    /// The classes of the parts of an arc of 2 m about the origin from the east on, and of the straight way from its
    /// end back to its beginning over `corners`.
    fn classes(span: f64, corners: &[Point]) -> Vec<PartClass> {
        let arc = Piece::Arc { center: Point::origin(), radius: 2.0, start: 0.0, sweep: span };
        let way: Vec<Point> =
            [arc.to()].into_iter().chain(corners.iter().copied()).chain([arc.from()]).collect();
        let straight = way.windows(2).map(|two| Piece::Line { from: two[0], to: two[1] });
        let outline = Ring { pieces: [arc].into_iter().chain(straight).collect() };
        parts(&outline, ShapeClass::Complex).iter().map(|part| part.class).collect()
    }

    #[test]
    fn a_corner_that_was_cut_off_makes_no_part() {
        let third = angle::TAU / 6.0;
        let apex = Point::origin();
        assert_eq!(classes(third, &[apex]), [PartClass::Sector]);
        // At the end of the arc, at its beginning, and at the apex.
        let at_end = on(1.9, third) + angle::unit(third - 1.0) * 0.02;
        assert_eq!(classes(third, &[at_end, apex]), [PartClass::Sector]);
        assert_eq!(classes(third, &[apex, on(1.88, 0.01)]), [PartClass::Sector]);
        assert_eq!(classes(third, &[on(0.15, third), on(0.15, 0.0)]), [PartClass::Sector]);
        // A corner that is no corner of a sector.
        let wide = classes(third, &[on(0.8, third), on(0.8, 0.0)]);
        assert!(wide.len() > 1, "{wide:?}");
    }

    #[test]
    fn the_straight_side_of_half_a_disc_may_be_bent_a_little() {
        let half = angle::PI;
        assert_eq!(classes(half, &[]), [PartClass::Semicircle]);
        assert_eq!(classes(half, &[Point::new(-0.8, 0.012)]), [PartClass::Semicircle]);
        assert_eq!(
            classes(half, &[Point::new(-1.95, -0.08), Point::new(-0.5, -0.06)]),
            [PartClass::Semicircle]
        );
        let bay = classes(half, &[Point::new(0.0, -1.0)]);
        assert!(bay.len() > 1, "{bay:?}");
    }
}
