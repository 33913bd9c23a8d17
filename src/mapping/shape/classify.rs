//! What shape an outline has (paper III.D): circle, convex, concave or complex. Works on the
//! fitted outline; the paper's turns of 1 degree are far below what the robot's own turns show.

use super::split;
use crate::geometry::hull::deepest_bay;
use crate::geometry::{Piece, Point, Ring, angle, cross};
use crate::mapping::map::{Contact, Shape, ShapeClass};

/// A turn of the outline counts as a vertex above this, radians: the paper's 1 degree.
pub const TURN_POINT: f64 = angle::PI / 180.0;
/// A bay shallower than this does not make an outline concave, metres: the noise of a wall ...
pub(super) const SHALLOW: f64 = 0.008;
/// ... which a walking gyro bends by this share of its length.
pub(super) const BENT: f64 = 0.004;
/// An arc counts as a curve from this span on, radians: 25 degrees.
const CURVE_SPAN: f64 = 25.0 * angle::PI / 180.0 - 1e-3;

/// The class, the turn points and the parts of `outline` (counter-clockwise), which was fitted to
/// `contacts`.
#[must_use]
pub fn identify(outline: Ring, contacts: &[Contact]) -> Shape {
    let outline = from_the_first(outline, contacts);
    let vertices = turn_points(&outline);
    let class = class(&outline, &vertices);
    let parts = split::parts(&outline, class);
    Shape { class, outline, vertices, parts }
}

/// `outline` from the wall on that was met first: fitted anew, its walls keep their numbers.
fn from_the_first(mut outline: Ring, contacts: &[Contact]) -> Ring {
    let met = contacts.iter().min_by(|a, b| a.time.total_cmp(&b.time));
    let from = met.and_then(|met| outline.nearest(met.point)).map_or(0, |foot| foot.piece);
    outline.pieces.rotate_left(from);
    outline
}

/// Where the outline turns by more than 1 degree, in order along it.
#[must_use]
pub fn turn_points(outline: &Ring) -> Vec<Point> {
    let count = outline.pieces.len();
    (0..count)
        .filter_map(|k| {
            let (before, after) = (outline.pieces[(k + count - 1) % count], outline.pieces[k]);
            let (u, v) = (before.tangent(1.0), after.tangent(0.0));
            let turn = angle::atan2(cross(u, v), u.dot(&v));
            (turn.abs() > TURN_POINT).then(|| after.from())
        })
        .collect()
}

fn class(outline: &Ring, vertices: &[Point]) -> ShapeClass {
    let curved = outline.pieces.iter().any(is_curve);
    if curved && vertices.is_empty() && outline.pieces.len() == 1 {
        ShapeClass::Circle
    } else if curved {
        ShapeClass::Complex
    } else if is_convex(&outline.to_points(1e-3)) {
        ShapeClass::Convex
    } else {
        ShapeClass::Concave
    }
}

/// Whether the outline has no bay deeper than what a wall of its size may be bent by.
pub(super) fn is_convex(points: &[Point]) -> bool {
    let Some(first) = points.first() else { return true };
    let extent = points.iter().map(|p| (p - first).norm()).fold(0.0, f64::max);
    deepest_bay(points) < SHALLOW + BENT * extent
}

/// Whether the piece bends enough to be called a curve.
pub(super) fn is_curve(piece: &Piece) -> bool {
    matches!(piece, Piece::Arc { sweep, .. } if sweep.abs() >= CURVE_SPAN)
}
