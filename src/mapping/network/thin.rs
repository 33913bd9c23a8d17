//! Faces of thin walls that the adjustment has laid through each other. Each surface is free to lie where the
//! readings have it, and the two faces of a board were met far apart in time: what they are off by may be more than
//! the board is thick. That no wall is thinner than nothing is known without any reading (see
//! `mapping::thin` for the same on the lap). Knows the surfaces, not the readings that they come from.

use super::chain::Equation;
use super::surface::{Surface, Surfaces, UNKNOWNS};
use crate::geometry::{Point, Vector, angle, perp};
use crate::mapping::thin::{THICKNESS, THICKNESS_SD};

/// Faces of one wall are parallel to this (cosine), ...
const PARALLEL: f64 = 0.97;
/// ... were seen on both sides of at least so much of it, metres, ...
const OVERLAP: f64 = 0.1;
/// ... and lie through each other by no more than this, metres: wider apart, and the floor between them is what
/// the robot was on.
const DEEPEST: f64 = 0.1;

/// A place at which two surfaces lie through each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Through {
    near: usize,
    far: usize,
    at: Point,
}

/// A straight surface, as far as it was seen.
#[derive(Debug, Clone, Copy)]
struct Face {
    surface: usize,
    at: Point,
    /// Unit normal, into the wall.
    inward: Vector,
    /// First and last place along it, metres from `at` to the left of `inward`.
    span: (f64, f64),
}

impl Face {
    /// How far `other` lies behind this one beside the place `s` metres along it.
    fn behind(&self, s: f64, other: &Self) -> (Point, f64) {
        let place = self.at + perp(self.inward) * s;
        let across = other.inward.dot(&self.inward);
        (place, other.inward.dot(&(other.at - place)) / across)
    }
}

impl Surfaces {
    /// Looks for faces that lie through each other, beside those that were found before.
    pub(super) fn look_through(&mut self) {
        let faces: Vec<Face> = (0..self.all.len()).filter_map(|k| self.face(k)).collect();
        for (k, near) in faces.iter().enumerate() {
            for far in &faces[k + 1..] {
                if near.inward.dot(&far.inward) > -PARALLEL {
                    continue;
                }
                let along = perp(near.inward);
                let of = |s: f64| along.dot(&(far.at + perp(far.inward) * s - near.at));
                let (a, b) = (of(far.span.0), of(far.span.1));
                let span = (near.span.0.max(a.min(b)), near.span.1.min(a.max(b)));
                if span.1 - span.0 < OVERLAP {
                    continue;
                }
                for s in [span.0, span.1] {
                    let (at, behind) = near.behind(s, far);
                    let through = Through { near: near.surface, far: far.surface, at };
                    let is_known = |it: &Through| {
                        it.near == through.near
                            && it.far == through.far
                            && (it.at - at).norm() < OVERLAP / 2.0
                    };
                    if (-DEEPEST..0.0).contains(&behind) && !self.through.iter().any(is_known) {
                        self.through.push(through);
                    }
                }
            }
        }
    }

    fn face(&self, surface: usize) -> Option<Face> {
        let Surface::Straight { at, normal } = self.all[surface] else { return None };
        let (floor, seen) = self.seen[surface];
        let inward = angle::unit(normal) * -floor;
        let along = perp(inward);
        let (a, b) = (along.dot(&(seen.0 - at)), along.dot(&(seen.1 - at)));
        Some(Face { surface, at, inward, span: (a.min(b), a.max(b)) })
    }

    /// What is known of faces that lay through each other: the unknowns of the surfaces begin at `first` in the
    /// border.
    pub(super) fn apart(&self, first: usize) -> impl Iterator<Item = Equation> + use<'_> {
        self.through.iter().filter_map(move |through| {
            let (near, far) = (self.face(through.near)?, self.face(through.far)?);
            let beside = perp(near.inward).dot(&(through.at - near.at));
            let (place, behind) = near.behind(beside, &far);
            let mut equation = Equation::of(behind - THICKNESS, THICKNESS_SD * THICKNESS_SD);
            for (surface, sign) in [(through.near, -1.0), (through.far, 1.0)] {
                let (_, across, follows) = self.all[surface].off(place);
                let sign = sign * across.dot(&near.inward).signum();
                for (k, by) in follows.into_iter().enumerate() {
                    equation = equation.border(first + UNKNOWNS * surface + k, sign * by);
                }
            }
            Some(equation)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::network::chain::Normal;

    /// The two faces of a board along x, so far apart (metres), seen for a metre, and the wall that faces the
    /// upper one from 0.4 m away.
    fn board(thick: f64) -> Surfaces {
        let face = |y: f64, up: f64| Surface::Straight {
            at: Point::new(0.5, y),
            normal: up * angle::FRAC_PI_2,
        };
        let seen = |y: f64| (1.0, (Point::new(0.0, y), Point::new(1.0, y)));
        Surfaces {
            all: vec![face(0.0, -1.0), face(thick, 1.0), face(0.4, -1.0)],
            sd: vec![0.002; 3],
            of: Vec::new(),
            seen: vec![seen(0.0), seen(thick), seen(0.4)],
            through: Vec::new(),
        }
    }

    #[test]
    fn only_faces_that_lie_through_each_other_are_kept_apart() {
        for (thick, count) in [(0.02, 0), (-0.012, 2)] {
            let mut surfaces = board(thick);
            surfaces.look_through();
            surfaces.look_through();
            assert_eq!(surfaces.through.len(), count, "{:?} of {thick}", surfaces.through);
        }
    }

    #[test]
    fn the_equations_move_them_as_far_apart_as_a_thin_wall_is_thick() {
        let mut surfaces = board(-0.012);
        surfaces.look_through();
        let unknowns = UNKNOWNS * surfaces.all.len();
        let mut normal = Normal::new(0, unknowns);
        for row in 0..unknowns {
            normal.add(&Equation::of(0.0, 1.0).border(row, 1.0));
        }
        for apart in surfaces.apart(0) {
            normal.add(&apart);
        }
        let (_, change) = normal.solve().expect("nothing is open");
        surfaces.take(change.as_slice());
        let Surface::Straight { at: lower, .. } = surfaces.all[0] else { panic!("a face") };
        let Surface::Straight { at: upper, .. } = surfaces.all[1] else { panic!("a face") };
        let thick = upper.y - lower.y;
        assert!((thick - THICKNESS).abs() < 1e-4, "{thick}");
        // Half of it each, and the wall stays.
        assert!((lower.y + upper.y + 0.012).abs() < 1e-4, "{lower} {upper}");
        let Surface::Straight { at: wall, .. } = surfaces.all[2] else { panic!("a wall") };
        assert!((wall.y - 0.4).abs() < 1e-9);
    }
}
