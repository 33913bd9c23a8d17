//! Whether what lies between two things is floor, when the robot does not pass between them: if the
//! body, led by the follower from either side and a little deeper, sweeps a place of the gap from
//! both, nothing joins the two there. Two corners near each other are told from two walls side by
//! side like that. Where the body fits between, nothing joins them anywhere. Knows two outlines and the
//! body, not where the robot drove.

use crate::geometry::raster::Grid;
use crate::geometry::{Piece, Point, Ring, perp};
use crate::mapping::follow;
use crate::robot::Chassis;

/// How finely the floor about the gap is looked at, metres.
const CELL: f64 = 0.005;
/// The narrowest place is looked for along the outline at this pace, metres.
const PACE: f64 = 0.005;
/// Places across the gap that are looked at.
const ACROSS: u32 = 8;
/// Things nearer than this are as good as joined, metres: nothing tells them from one.
pub(super) const TOUCHING: f64 = 0.12;
/// Outlines are this well known where nothing touched them, metres.
const UNSURE: f64 = 0.01;
/// The body comes this much deeper into a gap than the disc that passes, as a share of what that is
/// wider.
const DEEPER: f64 = 1.5;

/// The narrowest place between two things.
#[derive(Debug, Clone)]
pub(super) struct Gap {
    from: Point,
    to: Point,
    near: Vec<Piece>,
}

impl Gap {
    /// Where `one` and `other` come nearest to each other; none where one of them is empty.
    pub(super) fn between(one: &Ring, other: &Ring) -> Option<Self> {
        let steps = |piece: &Piece| (piece.length() / PACE).ceil().max(1.0) as u32;
        let places = other.pieces.iter().flat_map(|piece| {
            let count = steps(piece);
            (0..count).map(move |k| piece.at(f64::from(k) / f64::from(count)))
        });
        let (to, foot) = places
            .filter_map(|p| Some((p, one.nearest(p)?)))
            .min_by(|a, b| a.1.distance.total_cmp(&b.1.distance))?;
        let near = one.pieces.iter().chain(&other.pieces).copied().collect();
        Some(Self { from: foot.point, to, near })
    }

    /// Whether there is as good as no gap.
    pub(super) fn is_closed(&self) -> bool {
        (self.to - self.from).norm() < TOUCHING
    }

    /// Whether the robot passes through it.
    pub(super) fn is_passed(&self, chassis: &Chassis) -> bool {
        (self.to - self.from).norm() > chassis.passable_gap()
    }

    /// Whether nothing can join the two: the robot passes between, or its body sweeps what is there. `free` tells
    /// floor from things.
    pub(super) fn parts(&self, free: impl Fn(Point) -> bool, chassis: &Chassis) -> bool {
        self.is_passed(chassis) || self.is_swept(free, chassis)
    }

    /// Whether the body sweeps a place of the gap from both sides, when it goes where the follower's
    /// disc goes, and a little deeper. `free` tells floor from things.
    pub(super) fn is_swept(&self, free: impl Fn(Point) -> bool, chassis: &Chassis) -> bool {
        let (body, wide) = (chassis.radius, follow::clearance(chassis));
        let across = self.to - self.from;
        let middle = nalgebra::center(&self.from, &self.to);
        let width = across.norm();
        if self.is_closed() || self.is_passed(chassis) {
            return false;
        }
        if width > 2.0 * body + UNSURE {
            return true;
        }
        let deep = DEEPER * (wide - body);
        let far = body + width / 2.0 + deep;
        let near: Vec<&Piece> =
            self.near.iter().filter(|piece| piece.distance(middle) < far + wide).collect();
        let grid = Grid::over(middle, middle, CELL, far);
        let cells: Vec<(Point, f64)> = (0..grid.len())
            .map(|k| grid.point(k))
            .map(|p| (p, near.iter().map(|n| n.distance(p)).fold(f64::INFINITY, f64::min)))
            .filter(|(p, clearance)| *clearance >= body && free(*p))
            .collect();
        let passed: Vec<Point> =
            cells.iter().filter(|(_, clearance)| *clearance >= wide).map(|(p, _)| *p).collect();
        let beside = perp(across);
        let reached = cells.iter().map(|(p, _)| *p).filter(|p| {
            (p - middle).norm() < body + width / 2.0 && passed.iter().any(|q| (q - p).norm() < deep)
        });
        let (left, right): (Vec<Point>, Vec<Point>) =
            reached.partition(|p| beside.dot(&(p - middle)) > 0.0);
        (0..=ACROSS).any(|k| {
            let place = self.from + across * (f64::from(k) / f64::from(ACROSS));
            let covers = |p: &Point| (p - place).norm() < body + UNSURE;
            left.iter().any(covers) && right.iter().any(covers)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(corners: &[(f64, f64)]) -> Ring {
        let points: Vec<Point> = corners.iter().map(|&(x, y)| Point::new(x, y)).collect();
        Ring::polygon(&points)
    }

    fn is_swept(one: &Ring, other: &Ring) -> bool {
        let free = |p: Point| !one.contains(p) && !other.contains(p);
        Gap::between(one, other).is_some_and(|gap| gap.is_swept(free, &Chassis::default()))
    }

    /// A square that stands on its corner `gap` above the line y = 0.
    fn on_its_corner(gap: f64) -> Ring {
        ring(&[(0.0, gap), (0.3, gap + 0.3), (0.0, gap + 0.6), (-0.3, gap + 0.3)])
    }

    fn slab() -> Ring {
        ring(&[(-2.0, -0.5), (2.0, -0.5), (2.0, 0.0), (-2.0, 0.0)])
    }

    #[test]
    fn a_corner_off_a_wall_is_swept_behind() {
        assert!(is_swept(&slab(), &on_its_corner(0.25)));
    }

    #[test]
    fn a_corner_that_touches_a_wall_is_not() {
        assert!(!is_swept(&slab(), &on_its_corner(0.0)));
        assert!(!is_swept(&slab(), &on_its_corner(0.05)));
    }

    #[test]
    fn two_sides_beside_each_other_hide_what_is_between() {
        let box_beside = ring(&[(-0.2, 0.15), (0.2, 0.15), (0.2, 0.5), (-0.2, 0.5)]);
        assert!(!is_swept(&slab(), &box_beside));
    }

    #[test]
    fn a_gap_that_the_robot_passes_is_none() {
        assert!(!is_swept(&slab(), &on_its_corner(0.4)));
    }
}
