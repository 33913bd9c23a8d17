//! The rooms and objects that the tests go round.

use crate::geometry::{Piece, Point, Ring, angle};

/// A ragged hall of a real flat. From Valetudo (<https://github.com/Hypfer/Valetudo>), commit
/// b41e048, roborock test map `S5_FW2008`, Apache-2.0, Copyright Sören Beye; traced to a polygon.
const HALL: [(f64, f64); 58] = [
    (1.269, 0.5793),
    (1.269, 0.0),
    (2.1, 0.0),
    (2.1, 0.2483),
    (2.725, 0.2483),
    (2.775, 0.2793),
    (2.825, 0.2293),
    (3.3048, 0.2293),
    (3.3048, 1.3793),
    (2.8, 1.3793),
    (2.8, 2.0543),
    (2.8625, 2.1043),
    (2.8625, 2.3043),
    (2.975, 2.3793),
    (3.075, 2.2793),
    (3.125, 2.3293),
    (3.275, 2.3293),
    (3.325, 2.2793),
    (3.4, 2.4043),
    (3.4, 2.6043),
    (3.35, 2.7043),
    (3.4, 2.8043),
    (3.35, 2.8543),
    (3.4, 2.9043),
    (3.4, 3.6043),
    (3.325, 3.7293),
    (3.225, 3.6793),
    (2.925, 3.6793),
    (2.85, 3.7543),
    (2.85, 4.4793),
    (3.0, 4.4793),
    (3.0, 4.6543),
    (2.9, 4.7543),
    (2.9, 4.9043),
    (2.95, 4.9543),
    (2.875, 5.0293),
    (2.825, 4.9793),
    (2.775, 5.0293),
    (2.075, 5.0293),
    (2.0095, 4.9543),
    (2.0095, 1.8543),
    (1.9, 1.8043),
    (1.9, 1.4793),
    (2.125, 1.4793),
    (2.15, 1.3793),
    (0.975, 1.3793),
    (0.775, 1.4706),
    (0.0, 1.4706),
    (0.0, 1.2793),
    (0.2715, 1.2793),
    (0.2715, 0.7293),
    (0.675, 0.7293),
    (0.725, 0.6293),
    (0.825, 0.6293),
    (0.875, 0.6793),
    (0.975, 0.5793),
    (1.075, 0.6293),
    (1.125, 0.5793),
];

/// A polygon; vertices may carry the bulge of the piece that leaves them.
fn bulged(vertices: &[(f64, f64, f64)]) -> Ring {
    let count = vertices.len();
    let pieces = (0..count)
        .map(|k| {
            let (x0, y0, bulge) = vertices[k];
            let (x1, y1, _) = vertices[(k + 1) % count];
            Piece::with_bulge(Point::new(x0, y0), Point::new(x1, y1), bulge)
        })
        .collect();
    Ring { pieces }
}

/// A polygon of straight walls.
pub(in crate::mapping::shape) fn polygon(vertices: &[(f64, f64)]) -> Ring {
    let points: Vec<Point> = vertices.iter().map(|&(x, y)| Point::new(x, y)).collect();
    Ring::polygon(&points)
}

pub(in crate::mapping::shape) fn rectangle(width: f64, height: f64) -> Ring {
    polygon(&[(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)])
}

pub(in crate::mapping::shape) fn regular(sides: usize, radius: f64) -> Ring {
    let points: Vec<Point> = (0..sides)
        .map(|k| {
            let bearing = 0.3 + angle::TAU * k as f64 / sides as f64;
            Point::new(3.0, 2.0) + angle::unit(bearing) * radius
        })
        .collect();
    Ring::polygon(&points)
}

pub(in crate::mapping::shape) fn l_room() -> Ring {
    polygon(&[(0.0, 0.0), (5.0, 0.0), (5.0, 2.0), (2.5, 2.0), (2.5, 4.0), (0.0, 4.0)])
}

pub(in crate::mapping::shape) fn u_room() -> Ring {
    polygon(&[
        (0.0, 0.0),
        (5.0, 0.0),
        (5.0, 4.0),
        (3.5, 4.0),
        (3.5, 1.5),
        (1.5, 1.5),
        (1.5, 4.0),
        (0.0, 4.0),
    ])
}

/// A room with a thin wall of 2 cm that reaches into it.
pub(in crate::mapping::shape) fn thin_wall() -> Ring {
    polygon(&[
        (0.0, 0.0),
        (4.0, 0.0),
        (4.0, 3.0),
        (2.02, 3.0),
        (2.02, 1.2),
        (2.0, 1.2),
        (2.0, 3.0),
        (0.0, 3.0),
    ])
}

/// A flat with twelve corners.
pub(in crate::mapping::shape) fn flat() -> Ring {
    polygon(&[
        (0.0, 0.0),
        (4.0, 0.0),
        (4.0, 0.8),
        (7.0, 0.8),
        (7.0, 4.0),
        (5.0, 4.0),
        (5.0, 6.0),
        (2.5, 6.0),
        (2.5, 4.5),
        (1.0, 4.5),
        (1.0, 3.0),
        (0.0, 3.0),
    ])
}

/// A room with thick teeth.
pub(in crate::mapping::shape) fn comb() -> Ring {
    let mut vertices = vec![(0.0, 0.0), (6.0, 0.0), (6.0, 3.0)];
    for tooth in 0..4 {
        let right = 5.3 - 1.3 * f64::from(tooth);
        vertices.extend([(right, 3.0), (right, 1.4), (right - 0.5, 1.4), (right - 0.5, 3.0)]);
    }
    vertices.push((0.0, 3.0));
    polygon(&vertices)
}

pub(in crate::mapping::shape) fn stadium() -> Ring {
    bulged(&[(0.0, 0.0, 0.0), (4.0, 0.0, 1.0), (4.0, 2.0, 0.0), (0.0, 2.0, 1.0)])
}

/// A rectangle with a semicircle on one side.
pub(in crate::mapping::shape) fn d_room() -> Ring {
    bulged(&[(0.0, 0.0, 0.0), (2.0, 0.0, 1.0), (2.0, 3.0, 0.0), (0.0, 3.0, 0.0)])
}

pub(in crate::mapping::shape) fn semicircle() -> Ring {
    bulged(&[(-2.0, 0.0, 0.0), (2.0, 0.0, 1.0)])
}

/// A pie slice of 100 degrees.
pub(in crate::mapping::shape) fn sector() -> Ring {
    let far = angle::unit(100.0 * angle::PI / 180.0) * 3.0;
    let bulge = angle::tan(25.0 * angle::PI / 180.0);
    bulged(&[(0.0, 0.0, 0.0), (3.0, 0.0, bulge), (far.x, far.y, 0.0)])
}

/// A circle with a corridor.
pub(in crate::mapping::shape) fn keyhole() -> Ring {
    let half = 0.5;
    let radius: f64 = 1.5;
    let mouth = (radius * radius - half * half).sqrt();
    let sweep = angle::TAU - 2.0 * angle::asin(half / radius);
    bulged(&[
        (half, -mouth, angle::tan(sweep / 4.0)),
        (-half, -mouth, 0.0),
        (-half, -4.0, 0.0),
        (half, -4.0, 0.0),
    ])
}

/// A rectangle with a round niche in one wall.
pub(in crate::mapping::shape) fn niche() -> Ring {
    bulged(&[
        (0.0, 0.0, 0.0),
        (4.0, 0.0, 0.0),
        (4.0, 1.0, 1.0),
        (4.0, 2.4, 0.0),
        (4.0, 3.0, 0.0),
        (0.0, 3.0, 0.0),
    ])
}

/// A rectangle with half a column in one wall.
pub(in crate::mapping::shape) fn column() -> Ring {
    bulged(&[
        (0.0, 0.0, 0.0),
        (4.0, 0.0, 0.0),
        (4.0, 1.0, -1.0),
        (4.0, 2.0, 0.0),
        (4.0, 3.0, 0.0),
        (0.0, 3.0, 0.0),
    ])
}

pub(in crate::mapping::shape) fn hall() -> Ring {
    polygon(&HALL)
}
