//! Rooms that the tests of floor and plan share.

use super::Floor;
use crate::geometry::{Piece, Point, Ring, angle};
use crate::mapping::map::{Part, PartClass, Shape, ShapeClass};
use crate::robot::Chassis;

pub(crate) fn polygon(vertices: &[(f64, f64)]) -> Ring {
    let points: Vec<Point> = vertices.iter().map(|&(x, y)| Point::new(x, y)).collect();
    Ring::polygon(&points)
}

/// A room of straight and circular pieces: where each begins, and over how many degrees it is bent outwards.
pub(crate) fn bent(pieces: &[(f64, f64, f64)]) -> Ring {
    let next = pieces.iter().cycle().skip(1);
    let piece = |(&(x, y, degrees), &(to_x, to_y, _)): (&(f64, f64, f64), &(f64, f64, f64))| {
        let bulge = angle::tan(degrees.to_radians() / 4.0);
        Piece::with_bulge(Point::new(x, y), Point::new(to_x, to_y), bulge)
    };
    Ring { pieces: pieces.iter().zip(next).map(piece).collect() }
}

pub(crate) fn boxed(x0: f64, y0: f64, x1: f64, y1: f64) -> Ring {
    polygon(&[(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
}

pub(crate) fn rectangle(width: f64, height: f64) -> Ring {
    boxed(0.0, 0.0, width, height)
}

pub(crate) fn ell() -> Ring {
    polygon(&[(0.0, 0.0), (4.0, 0.0), (4.0, 1.5), (2.0, 1.5), (2.0, 3.0), (0.0, 3.0)])
}

/// Two rooms of 1.9 x 2 m joined by a gap in a wall 0.2 m thick.
pub(crate) fn two_rooms(gap: f64) -> Ring {
    let (low, high) = (1.0 - gap / 2.0, 1.0 + gap / 2.0);
    polygon(&[
        (0.0, 0.0),
        (1.9, 0.0),
        (1.9, low),
        (2.1, low),
        (2.1, 0.0),
        (4.0, 0.0),
        (4.0, 2.0),
        (2.1, 2.0),
        (2.1, high),
        (1.9, high),
        (1.9, 2.0),
        (0.0, 2.0),
    ])
}

/// A wedge of `degrees` at the origin with sides of 3 m.
pub(crate) fn wedge(degrees: f64) -> Ring {
    let far = angle::unit(degrees.to_radians()) * 3.0;
    polygon(&[(0.0, 0.0), (3.0, 0.0), (far.x, far.y)])
}

/// A flat of twelve corners with two doors, 10 x 7 m.
pub(crate) fn flat() -> Ring {
    polygon(&[
        (0.0, 0.0),
        (4.0, 0.0),
        (4.0, 2.5),
        (4.1, 2.5),
        (4.1, 0.0),
        (10.0, 0.0),
        (10.0, 3.0),
        (7.0, 3.0),
        (7.0, 3.1),
        (10.0, 3.1),
        (10.0, 7.0),
        (5.0, 7.0),
        (5.0, 4.0),
        (4.9, 4.0),
        (4.9, 7.0),
        (0.0, 7.0),
        (0.0, 4.0),
        (3.0, 4.0),
        (3.0, 3.9),
        (0.0, 3.9),
    ])
}

pub(crate) fn floor(boundary: &Ring, objects: &[&Ring]) -> Floor {
    Floor::new(boundary, objects, &Chassis::default(), Point::new(0.5, 0.5))
}

/// The lap of the centre along the wall at `gap` metres, as a closed polyline: the outline moved
/// inwards piece by piece, corners mitred, outer corners rounded off.
pub(crate) fn lap(boundary: &Ring, gap: f64) -> Vec<Point> {
    let corners = boundary.to_points(1e-3);
    let count = corners.len();
    let mut path = Vec::new();
    for k in 0..count {
        let (a, b, c) = (corners[(k + count - 1) % count], corners[k], corners[(k + 1) % count]);
        let (u, v) = ((b - a).normalize(), (c - b).normalize());
        let (m, n) = (crate::geometry::perp(u), crate::geometry::perp(v));
        let turn = crate::geometry::cross(u, v);
        if turn >= 0.0 {
            path.push(b + (m + n) * (gap / (1.0 + m.dot(&n))));
        } else {
            let sweep = angle::atan2(turn, u.dot(&v));
            for step in 0..=8 {
                let off = angle::of(m) + sweep * f64::from(step) / 8.0;
                path.push(b + angle::unit(off) * gap);
            }
        }
    }
    path.push(path[0]);
    path
}

/// The shape of a polygonal room, as one part.
pub(crate) fn shape(boundary: &Ring) -> Shape {
    let part = Part {
        class: PartClass::Concave,
        ring: boundary.clone(),
        cut: vec![false; boundary.pieces.len()],
        circle: None,
    };
    Shape {
        class: ShapeClass::Concave,
        outline: boundary.clone(),
        vertices: boundary.pieces.iter().map(Piece::from).collect(),
        parts: vec![part],
    }
}
