//! How the errors of the adjusted map divide: what all of it has in common, and what is left within it.
//!
//! The map lies in the frame of the start, and how it lies there hangs on what gyro and wheels made of the
//! first metres: later the robot sees its walls again and again, the start never. So a map whose walls fit
//! each other to millimetres may be turned as a whole. Surveyors tell the two apart by moving from the datum
//! of one point to that of all (S-transformation: Baarda 1973; Ghilani, *Adjustment Computations*, on free
//! networks): the rigid motion that fits the errors of all walls best is what they have in common.
//!
//! It refuses to know of the scale: that of both wheels together no room tells.

use super::chain::Sureness;
use super::surface::{Surfaces, UNKNOWNS};
use crate::geometry::{Point, Vector, angle, perp};
use nalgebra::{DMatrix, Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Turn and displacement of a plane figure.
const MOTION: usize = 3;
/// A motion that moves nothing across its surface is not told, as a share of one that moves all.
const OPEN: f64 = 1e-5;

/// Standard errors of the map as a whole and within itself, but for the scale.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Datum {
    /// Of the turn that all of it has in common, radians.
    pub turn: f64,
    /// Of the displacement that its middle has: root of the sum of the variances in x and y, metres.
    pub shift: f64,
    /// Of a wall among the others, across it at its middle, metres: the median of all walls.
    pub within: f64,
}

/// What the place is off by, at which a lap was begun anew: all that is mapped from there is off by it together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offset {
    /// One standard deviation of the heading, radians.
    pub turn: f64,
    /// Of the position: root of the sum of the variances in x and y, metres.
    pub shift: f64,
}

impl Offset {
    /// Both, one after the other.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let hypot = angle::hypot;
        Self { turn: hypot(self.turn, other.turn), shift: hypot(self.shift, other.shift) }
    }
}

impl Datum {
    /// What all of it is off by.
    #[must_use]
    pub fn offset(&self) -> Offset {
        Offset { turn: self.turn, shift: self.shift }
    }

    /// The same for a map that was begun at a place which was off by itself.
    #[must_use]
    pub fn begun_off(self, by: Offset) -> Self {
        let Offset { turn, shift } = self.offset().and(by);
        Self { turn, shift, ..self }
    }

    /// Of the adjusted `surfaces`, whose unknowns begin at `first` in the border, and on which `places` were
    /// seen; none where they do not tell a turn from a displacement, as on a circle and nothing else.
    pub(super) fn of(
        surfaces: &Surfaces,
        places: &[Place],
        sure: &Sureness,
        first: usize,
    ) -> Option<Self> {
        let size = first + UNKNOWNS * surfaces.all.len();
        let middle = mean(places.iter().map(|place| place.at))?;
        // The motion that fits best what all the places are off by, as shares of the unknowns.
        let mut normal = Matrix3::<f64>::zeros();
        let mut fit = DMatrix::<f64>::zeros(size, MOTION);
        for place in places {
            let by_motion = place.moved(surfaces, middle);
            normal += by_motion * by_motion.transpose();
            for (row, by) in place.follows(surfaces, first) {
                for column in 0..MOTION {
                    fit[(row, column)] += by * by_motion[column];
                }
            }
        }
        let least = normal.symmetric_eigenvalues().min();
        if least < OPEN * normal.trace() {
            return None;
        }
        let inverse = normal.try_inverse()?;
        let fit = fit * DMatrix::from_iterator(MOTION, MOTION, inverse.iter().copied());
        let motion = fit.tr_mul(&sure.times(&fit));
        // What each surface is off by beyond that, where it is on average.
        let mut beyond = DMatrix::zeros(size, surfaces.all.len());
        for surface in 0..surfaces.all.len() {
            let of_it = || places.iter().filter(move |place| place.surface == surface);
            let Some(center) = mean(of_it().map(|place| place.at)) else { continue };
            let off = |place: &&Place| (place.at - center).norm_squared();
            let here = of_it().min_by(|a, b| off(a).total_cmp(&off(b)))?;
            beyond.set_column(surface, &-(&fit * here.moved(surfaces, middle)));
            for (row, by) in here.follows(surfaces, first) {
                beyond[(row, surface)] += by;
            }
        }
        let spread = sure.times(&beyond);
        let variance = |k: usize| beyond.column(k).dot(&spread.column(k));
        let mut within: Vec<f64> =
            (0..surfaces.all.len()).map(|k| variance(k).max(0.0).sqrt()).collect();
        within.sort_by(f64::total_cmp);
        Some(Self {
            turn: motion[(2, 2)].max(0.0).sqrt(),
            shift: (motion[(0, 0)] + motion[(1, 1)]).max(0.0).sqrt(),
            within: *within.get(within.len() / 2)?,
        })
    }
}

fn mean(places: impl Iterator<Item = Point>) -> Option<Point> {
    let (sum, count) =
        places.fold((Vector::zeros(), 0.0), |(sum, n), at| (sum + at.coords, n + 1.0));
    (count > 0.0).then(|| Point::from(sum / count))
}

/// A place where a surface was seen.
pub(super) struct Place {
    pub(super) surface: usize,
    pub(super) at: Point,
}

impl Place {
    /// By how much it moves across the surface with a motion of all: along x, along y, and a turn about
    /// `middle`.
    fn moved(&self, surfaces: &Surfaces, middle: Point) -> Vector3<f64> {
        let (_, across, _) = surfaces.all[self.surface].off(self.at);
        Vector3::new(across.x, across.y, across.dot(&perp(self.at - middle)))
    }

    /// By how much it moves with each of the surface's own unknowns, and their rows in the border.
    fn follows(&self, surfaces: &Surfaces, first: usize) -> [(usize, f64); UNKNOWNS] {
        let (_, _, by) = surfaces.all[self.surface].off(self.at);
        std::array::from_fn(|k| (first + UNKNOWNS * self.surface + k, by[k]))
    }
}
