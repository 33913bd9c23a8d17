//! Plane geometry that the whole crate shares.
//!
//! Conventions, stated once: lengths in metres, angles in radians counter-clockwise from +x,
//! headings wrapped to (-π, π]. Closed outlines of free floor run counter-clockwise (floor on
//! the left); outlines of solid objects run counter-clockwise too (the solid on the left).
//! Transcendental functions go through [`angle`] (libm), so that the same input gives the same
//! bits on every machine. Nothing here knows what a robot is.

pub mod angle;
pub mod fit;
pub mod hull;
pub mod index;
pub mod measure;
pub mod piece;
pub mod pose;
pub mod raster;
pub mod ring;
pub mod segment;
pub mod simple;
pub mod thin;
pub mod visibility;

pub use piece::Piece;
pub use pose::Pose;
pub use ring::Ring;
pub use segment::Segment;

/// A position in metres.
pub type Point = nalgebra::Point2<f64>;
/// A displacement in metres.
pub type Vector = nalgebra::Vector2<f64>;

/// The z component of the cross product `a × b`; positive when `b` lies counter-clockwise of `a`.
#[must_use]
pub fn cross(a: Vector, b: Vector) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Where two straight lines meet: `from` plus so many times `along`, on the line through `other` along `onward`. Without
/// meaning where the two run side by side; how near to that is too near, who asks must say.
#[must_use]
pub fn meeting(from: Point, along: Vector, other: Point, onward: Vector) -> f64 {
    cross(other - from, onward) / cross(along, onward)
}

/// `v` turned counter-clockwise by `by` radians.
#[must_use]
pub fn rotate(v: Vector, by: f64) -> Vector {
    let (sine, cosine) = (angle::sin(by), angle::cos(by));
    Vector::new(cosine * v.x - sine * v.y, sine * v.x + cosine * v.y)
}

/// `v` turned a quarter counter-clockwise.
#[must_use]
pub fn perp(v: Vector) -> Vector {
    Vector::new(-v.y, v.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_lines_meet_so_many_times_along_the_first_of_them() {
        let (from, along) = (Point::new(1.0, 1.0), Vector::new(2.0, 0.0));
        let (other, onward) = (Point::new(4.0, 3.0), Vector::new(0.0, -0.5));
        assert!((meeting(from, along, other, onward) - 1.5).abs() < 1e-12);
        assert!((meeting(from, -along, other, onward) + 1.5).abs() < 1e-12);
        assert!((meeting(other, onward, from, along) - 4.0).abs() < 1e-12);
        // However long the direction of the other is, and which way it runs.
        assert!((meeting(from, along, other, onward * -3.0) - 1.5).abs() < 1e-12);
        assert!(!meeting(from, along, other, along).is_finite());
    }
}
