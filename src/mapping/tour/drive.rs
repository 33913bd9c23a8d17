//! The pieces of one line that the known objects leave free and why the others are left out, and the
//! straight drives that a hidden disc calls for. Geometry alone: it decides nothing of the tour.

use crate::geometry::{Point, angle};
use crate::mapping::floor::Floor;
use crate::mapping::map::LineReason;
use std::collections::VecDeque;

/// A line is looked at in steps of this, metres.
const STEP: f64 = 0.01;
/// Less of a line than this is not missed where a wall leaves no room for it, metres: the walls are known a
/// little better by then than when it was planned, and it may run along one.
const NOT_MISSED: f64 = 0.15;

/// What is shorter than this is one place, metres.
const SPOT: f64 = 0.02;

/// What of a line was not driven, and why.
#[derive(Debug, Clone, Default)]
pub(super) struct LeftOut {
    /// Metres for which a wall leaves no room.
    by_wall: f64,
    /// Something stands on it.
    by_object: bool,
    /// No way leads to a piece of it.
    cut_off: bool,
}

impl LeftOut {
    /// A piece to which no way leads.
    pub(super) fn cut_off(&mut self) {
        self.cut_off = true;
    }

    /// Whether there is anything of it.
    pub(super) fn is_some(&self) -> bool {
        self.cut_off || self.by_object || self.by_wall > 0.0
    }

    /// Why the line was not driven from end to end; none when what is left out is not missed.
    pub(super) fn reason(&self) -> Option<LineReason> {
        if self.by_object {
            Some(LineReason::ObjectOnLine)
        } else if self.cut_off {
            Some(LineReason::Unreachable)
        } else {
            (self.by_wall > NOT_MISSED).then_some(LineReason::NoClearance)
        }
    }
}

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
    pub(super) left_out: LeftOut,
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
            left_out: LeftOut::default(),
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

    /// Whether it is on its line, and on no way to anywhere.
    pub(super) fn is_on_line(&self) -> bool {
        self.purpose == Purpose::Line && self.aim == Aim::Line
    }

    /// The robot is at `place` on the piece of the line in hand: what lies before it is done with, and how many
    /// metres of it were not yet.
    pub(super) fn come_to(&mut self, place: Point) -> f64 {
        let length = (self.to - self.from).norm();
        if self.aim != Aim::Line || length < 1e-9 {
            return 0.0;
        }
        let along = (self.to - self.from).dot(&(place - self.from)) / length;
        let before = self.done;
        self.done = along.min(self.piece_end).max(before);
        self.done - before
    }

    /// Notes that the stretch from `begin` to `end`, metres along, is left out, for the body has no
    /// `clearance` there.
    pub(super) fn leave_out(&mut self, begin: f64, end: f64, floor: &Floor, clearance: f64) {
        let steps = ((end - begin) / STEP).ceil().max(1.0);
        let narrow = |k: u32| {
            let p = self.at(begin + (end - begin) * f64::from(k) / steps);
            floor.object_clearance(p) < clearance
        };
        if (0..=steps as u32).any(narrow) {
            self.left_out.by_object = true;
        } else {
            self.left_out.by_wall += end - begin;
        }
    }

    /// The one place that it leads to, if it is no line.
    fn spot(&self) -> Option<Point> {
        ((self.to - self.from).norm() < SPOT).then_some(self.from)
    }

    /// Whether no piece of it was in hand yet.
    fn is_fresh(&self) -> bool {
        self.done <= 0.0 && self.piece_end <= 0.0
    }

    /// Whether the one place that it leads to was not reached: what was met on the way leaves it no room.
    pub(super) fn has_lost_its_spot(&self) -> bool {
        self.spot().is_some() && self.is_fresh()
    }

    /// The next stretch, from what is done on, in which the body has `clearance`: metres along.
    pub(super) fn free_piece(&self, floor: &Floor, clearance: f64) -> Option<(f64, f64)> {
        if let Some(spot) = self.spot() {
            let is_free = floor.keeps(spot, clearance);
            return (self.is_fresh() && is_free).then_some((0.0, 0.001));
        }
        let length = (self.to - self.from).norm();
        let steps = (length / STEP).ceil();
        let mut piece: Option<(f64, f64)> = None;
        for k in 0..=steps as u32 {
            let along = length * f64::from(k) / steps;
            if along + 1e-9 < self.done {
                continue;
            }
            if floor.keeps(self.at(along), clearance) {
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
                .take_while(|p| floor.is_drivable(*p) && floor.keeps(*p, clearance))
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
            .find(|p| floor.is_drivable(*p) && floor.keeps(*p, clearance))
            .map(|p| (p, p))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ring;
    use crate::robot::Chassis;

    const CLEARANCE: f64 = 0.11;

    fn block(low: (f64, f64), high: (f64, f64)) -> Ring {
        let corners = [low, (high.0, low.1), high, (low.0, high.1)];
        Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)))
    }

    /// Why a line along y = 1 of a room 4 m by 2 m, with a box on the floor beyond x = 3, is not driven
    /// between the two places.
    fn reason(begin: f64, end: f64) -> Option<LineReason> {
        let (room, thing) = (block((0.0, 0.0), (4.0, 2.0)), block((3.0, 0.8), (3.3, 1.2)));
        let floor = Floor::new(&room, &[&thing], &Chassis::default(), Point::new(1.0, 1.0));
        let mut drive = Drive::new(1, Point::new(0.0, 1.0), Point::new(3.5, 1.0));
        drive.leave_out(begin, end, &floor, CLEARANCE);
        assert!(drive.left_out.is_some());
        drive.left_out.reason()
    }

    #[test]
    fn what_is_left_out_of_a_line_says_what_is_in_its_way() {
        assert_eq!(reason(2.8, 3.4), Some(LineReason::ObjectOnLine));
        assert_eq!(reason(0.0, 0.4), Some(LineReason::NoClearance));
        // The line was planned to end where the wall is by now known to be a little nearer.
        assert_eq!(reason(0.0, 0.08), None);
    }

    #[test]
    fn what_was_driven_of_a_line_is_done_with_wherever_the_robot_leaves_it() {
        let mut drive = Drive::new(1, Point::new(0.0, 1.0), Point::new(3.5, 1.0));
        (drive.done, drive.piece_end) = (0.5, 3.0);
        let at = |x: f64| Point::new(x, 1.01);
        assert!(!drive.is_on_line() && drive.come_to(at(2.0)) <= 0.0, "on its way to the line");
        drive.aim = Aim::Line;
        assert!(drive.is_on_line() && (drive.come_to(at(2.0)) - 1.5).abs() < 1e-9);
        assert!(drive.come_to(at(1.9)) <= 0.0 && (drive.done - 2.0).abs() < 1e-9, "led back");
        drive.come_to(at(3.2));
        assert!((drive.done - 3.0).abs() < 1e-9, "beyond the piece another one may be free or not");
    }

    #[test]
    fn a_piece_that_no_way_leads_to_is_cut_off() {
        let mut left_out = LeftOut::default();
        assert!(!left_out.is_some());
        left_out.cut_off();
        assert_eq!(left_out.reason(), Some(LineReason::Unreachable));
    }

    #[test]
    fn a_place_that_has_no_room_any_more_is_not_reached() {
        let (room, thing) = (block((0.0, 0.0), (4.0, 2.0)), block((3.0, 0.8), (3.3, 1.2)));
        let floor = Floor::new(&room, &[&thing], &Chassis::default(), Point::new(1.0, 1.0));
        let to = |x: f64| Drive::new(0, Point::new(x, 1.0), Point::new(x, 1.0));
        let (mut free, beside) = (to(2.0), to(2.95));
        assert!(free.free_piece(&floor, CLEARANCE).is_some());
        free.piece_end = 0.001;
        assert!(free.free_piece(&floor, CLEARANCE).is_none() && !free.has_lost_its_spot());
        assert!(beside.free_piece(&floor, CLEARANCE).is_none() && beside.has_lost_its_spot());
    }
}
