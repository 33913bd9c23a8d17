//! The pieces of one line that the known objects leave free, and the straight drives that a hidden
//! disc calls for. Geometry alone: it decides nothing of the tour.

use crate::geometry::{Point, angle};
use crate::mapping::floor::Floor;
use std::collections::VecDeque;

/// What the way points in hand lead to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Aim {
    /// The end of a piece of the line.
    Line,
    /// The beginning of the next piece.
    Way,
}

/// What a drive is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// A line of the plan.
    Line,
    /// No line at all, but the way to a place where bearings are taken.
    Bearings,
    /// Likewise, to a place where an object is measured from what it stands beside.
    Tie,
}

/// The piece of a line that is being driven.
#[derive(Debug, Clone)]
pub(super) struct Drive {
    pub(super) id: u32,
    pub(super) from: Point,
    pub(super) to: Point,
    /// Metres along from `from` that are done with.
    pub(super) done: f64,
    pub(super) aim: Aim,
    /// Where the piece in hand ends, metres along.
    pub(super) piece_end: f64,
    pub(super) bumps: u32,
    /// Rounds on this line that could not be closed.
    pub(super) left_open: u32,
    /// How often bearings were taken in the middle of it.
    pub(super) stops: u32,
    pub(super) skipped: bool,
    pub(super) way: VecDeque<Point>,
    /// The same line again from the other end: an object was met (two-pass contour).
    pub(super) again: bool,
    /// Driven from its end.
    pub(super) backwards: bool,
    pub(super) purpose: Purpose,
}

impl Drive {
    pub(super) fn new(id: u32, from: Point, to: Point) -> Self {
        Self {
            id,
            from,
            to,
            done: 0.0,
            aim: Aim::Way,
            piece_end: 0.0,
            bumps: 0,
            left_open: 0,
            stops: 0,
            skipped: false,
            way: VecDeque::new(),
            again: false,
            backwards: false,
            purpose: Purpose::Line,
        }
    }

    /// The place `along` metres along the line.
    pub(super) fn at(&self, along: f64) -> Point {
        let length = (self.to - self.from).norm();
        if length < 1e-9 { self.from } else { self.from + (self.to - self.from) * (along / length) }
    }

    /// The next stretch, from what is done on, in which the body has `clearance`: metres along.
    pub(super) fn free_piece(&self, floor: &Floor, clearance: f64) -> Option<(f64, f64)> {
        let length = (self.to - self.from).norm();
        if length < 0.02 {
            let fresh = self.done <= 0.0 && self.piece_end <= 0.0;
            return (fresh && floor.clearance(self.from) >= clearance).then_some((0.0, 0.001));
        }
        let steps = (length / 0.01).ceil();
        let mut piece: Option<(f64, f64)> = None;
        for k in 0..=steps as u32 {
            let along = length * f64::from(k) / steps;
            if along + 1e-9 < self.done {
                continue;
            }
            if floor.clearance(self.at(along)) >= clearance {
                piece = Some((piece.map_or(along, |(begin, _)| begin), along));
            } else if piece.is_some_and(|(begin, end)| end - begin > 0.03) {
                return piece;
            } else {
                piece = None;
            }
        }
        piece.filter(|(begin, end)| end - begin > 0.015)
    }
}

/// The longest straight drive through the middle of a hidden disc, or past it, of a few directions.
pub(super) fn best_chord(
    floor: &Floor,
    at: Point,
    diameter: f64,
    clearance: f64,
) -> Option<(Point, Point)> {
    let mut best: Option<(Point, Point)> = None;
    for k in 0..12 {
        let direction = angle::unit(f64::from(k) * angle::PI / 12.0);
        let reach = |sign: f64| {
            let most = (diameter * 30.0) as i32;
            (0..=most)
                .map(|step| at + direction * (sign * f64::from(step) * 0.02))
                .take_while(|p| floor.is_drivable(*p) && floor.clearance(*p) >= clearance)
                .last()
        };
        if let (Some(a), Some(b)) = (reach(-1.0), reach(1.0))
            && best.is_none_or(|(p, q)| (b - a).norm() > (q - p).norm())
        {
            best = Some((a, b));
        }
    }
    best.or_else(|| {
        // The middle itself is out of reach: the nearest place that is not.
        let ring = (1..=16).flat_map(|ring| {
            (0..24).map(move |k| at + angle::unit(f64::from(k) * 0.2618) * (f64::from(ring) * 0.01))
        });
        ring.into_iter()
            .find(|p| floor.is_drivable(*p) && floor.clearance(*p) >= clearance)
            .map(|p| (p, p))
    })
}
