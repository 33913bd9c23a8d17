//! Splits a complex outline into polygonal and circular parts (paper III.D), which tile it:
//! every arc with the floor inside it is cut off along its chord.

use super::classify::SHALLOW;
use crate::geometry::hull::deepest_bay;
use crate::geometry::simple::{crossings, segments_meet};
use crate::geometry::{Piece, Point, Ring, angle};
use crate::mapping::map::{Part, PartClass, ShapeClass};

/// Flatter arcs than this are left in their polygonal part, metres: the robot's reach covers them.
const LEAST_SAGITTA: f64 = 0.16;
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
    let class = if deepest_bay(&ring.to_points(SAGITTA)) < SHALLOW {
        PartClass::Convex
    } else {
        PartClass::Concave
    };
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

/// The ring as one circular part: an arc with its chord, or with two radii.
fn circular(pieces: &[Piece], cut: &[bool]) -> Option<Part> {
    let at = pieces.iter().position(|p| matches!(p, Piece::Arc { sweep, .. } if *sweep > 0.0))?;
    let Piece::Arc { center, radius, sweep, .. } = pieces[at] else {
        return None;
    };
    let straight = |p: &Piece| matches!(p, Piece::Line { .. });
    if pieces.iter().filter(|p| straight(p)).count() + 1 != pieces.len() {
        return None;
    }
    let class = match pieces.len() {
        2 => arc_class(sweep),
        3 => {
            let apex = pieces[(at + 1) % 3].to();
            if (apex - center).norm() > 0.04 * radius + 0.01 {
                return None;
            }
            if (sweep - angle::PI).abs() <= HALF_TOLERANCE {
                PartClass::Semicircle
            } else {
                PartClass::Sector
            }
        }
        _ => return None,
    };
    Some(Part {
        class,
        ring: Ring { pieces: pieces.to_vec() },
        cut: cut.to_vec(),
        circle: Some((center, radius)),
    })
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
