//! Where the robot has been, and which of its beams were open on the way, the floor that it knows to be
//! free, and which were closed. Records; what that says of the things beside it, others judge.

use super::Wall;
use crate::geometry::raster::Grid;
use crate::geometry::{Point, Pose, Ring, Segment, angle};
use crate::mapping::drift::Unwound;
use crate::robot::{Chassis, SwitchSet};

/// A beam is held to be free only so far short of its reach, metres: contacts are not exact.
const SURE: f64 = 0.010;
/// The body is held to have covered no more than this much less than its radius, metres, likewise.
const RIM: f64 = 0.005;
/// Strokes that go on as they did are one, as far as this, metres.
const LONGEST: f64 = 0.1;
/// Less than this is no way, metres, and no turn, radians.
const STILL: f64 = 1e-3;

/// A stroke as near as this to a gate leads through it, metres.
const NEAR: f64 = 0.1;
/// A beam across the way is one whose direction has at least this share of that across.
const ACROSS: f64 = 0.7;

/// A stretch of the way: on, or round on the spot, with the same switches closed all the while.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    from: Pose,
    to: Pose,
    /// Positive counter-clockwise, radians.
    turned: f64,
    closed: SwitchSet,
    /// Odometer at its end, metres driven.
    pub travelled: f64,
    /// Robot time at its end, microseconds.
    pub time_us: u64,
}

impl Stroke {
    /// How far the robot drove on it, metres; hardly at all where it turned on the spot.
    #[must_use]
    pub fn length(&self) -> f64 {
        (self.to.position - self.from.position).norm()
    }

    /// The way of the robot's centre.
    #[must_use]
    pub fn way(&self) -> Segment {
        Segment::new(self.from.position, self.to.position)
    }

    /// Half way along.
    #[must_use]
    pub fn middle(&self) -> Point {
        nalgebra::center(&self.from.position, &self.to.position)
    }

    /// Whether `next` goes on as this does.
    fn is_one_with(&self, next: &Self) -> bool {
        let on_spot = |stroke: &Self| stroke.length() < STILL;
        let straight = |stroke: &Self| stroke.turned.abs() < STILL;
        let turns = on_spot(self) && on_spot(next) && self.turned * next.turned >= 0.0;
        let drives = straight(self) && straight(next) && self.length() < LONGEST;
        self.closed == next.closed && (turns || drives)
    }

    /// The same where `place` puts what was somewhere at a robot time. Headings stay: what they are off by moves
    /// the end of a beam by a millimetre or two.
    #[must_use]
    pub fn placed(&self, place: impl Fn(Point, u64) -> Point) -> Self {
        let there = |pose: Pose| Pose { position: place(pose.position, self.time_us), ..pose };
        Self { from: there(self.from), to: there(self.to), ..*self }
    }

    /// The same with a steady drift of the gyro taken out.
    fn unwound(&self, unwound: &Unwound) -> Self {
        let there = |pose: Pose| unwound.pose(pose, self.time_us);
        Self { from: there(self.from), to: there(self.to), ..*self }
    }

    /// Where the robot was on the way, no farther apart than `pace` at the end of a beam, metres.
    fn poses(&self, pace: f64, reach: f64) -> impl Iterator<Item = Pose> {
        let way = self.to.position - self.from.position;
        let steps = ((way.norm() + self.turned.abs() * reach) / pace).ceil().max(1.0) as u32;
        let (from, turned) = (self.from, self.turned);
        (0..=steps).map(move |k| {
            let share = f64::from(k) / f64::from(steps);
            Pose { position: from.position + way * share, heading: from.heading + turned * share }
        })
    }
}

impl Wall {
    /// The way so far.
    #[must_use]
    pub fn strokes(&self) -> &[Stroke] {
        &self.strokes
    }

    pub(super) fn record(
        &mut self,
        (from, to): (Pose, Pose),
        closed: SwitchSet,
        travelled: f64,
        time_us: u64,
    ) {
        let turned = angle::wrap(to.heading - from.heading);
        let stroke = Stroke { from, to, turned, closed, travelled, time_us };
        match self.strokes.last_mut() {
            Some(last) if last.is_one_with(&stroke) => {
                let turned = last.turned + turned;
                *last = Stroke { from: last.from, turned, ..stroke };
            }
            _ => self.strokes.push(stroke),
        }
    }

    pub(super) fn unwind_strokes(&mut self, unwound: &Unwound) {
        for stroke in &mut self.strokes {
            *stroke = stroke.unwound(unwound);
        }
    }
}

/// How much of the way of `strokes` lies within `outline`, and how long all of it is, metres.
#[must_use]
pub fn length_within(strokes: &[Stroke], outline: &Ring) -> (f64, f64) {
    strokes.iter().fold((0.0, 0.0), |(inside, all), stroke| {
        let length = stroke.length();
        let more = if outline.contains(stroke.middle()) { length } else { 0.0 };
        (inside + more, all + length)
    })
}

/// Whether on the way of `strokes`, where that leads through `gate`, switches were closed on both hands at once,
/// towards either end of it: it is not much wider then than body and reach on both sides.
#[must_use]
pub fn is_felt_on_both_hands(strokes: &[Stroke], chassis: &Chassis, gate: &Segment) -> bool {
    let along = gate.along.normalize();
    let through =
        strokes.iter().filter(|stroke| gate.distance_squared(stroke.middle()) < NEAR * NEAR);
    through.flat_map(|stroke| stroke.poses(LONGEST, 0.0).map(|pose| (stroke.closed, pose))).any(
        |(closed, pose)| {
            let beam = |k: usize| angle::unit(pose.heading + chassis.sensors[k].angle).dot(&along);
            let towards = |sign: f64| closed.iter().any(|k| sign * beam(k) > ACROSS);
            towards(1.0) && towards(-1.0)
        },
    )
}

/// Which cells of `grid` lie where the body of a robot with `chassis` has been on the way of `strokes`, or its
/// open beams on more than one of them: a switch may miss what is in front of it, and seldom twice.
#[must_use]
pub fn swept(strokes: &[Stroke], chassis: &Chassis, grid: &Grid) -> Vec<bool> {
    let mut free = vec![false; grid.len()];
    // Which stroke has looked at a cell, when it was one.
    let mut looked = vec![None; grid.len()];
    let low = grid.origin;
    let high = grid.point(grid.len() - 1);
    let (reach, pace) = (chassis.reach(), 0.8 * grid.cell);
    let near = |p: Point| {
        (low.x - reach..=high.x + reach).contains(&p.x)
            && (low.y - reach..=high.y + reach).contains(&p.y)
    };
    let within = |p: Point| (low.x..=high.x).contains(&p.x) && (low.y..=high.y).contains(&p.y);
    let body = chassis.radius - RIM;
    let shells = ((reach - SURE - body) / pace).ceil().max(1.0) as u32;
    let strokes = strokes.iter().enumerate().filter(|(_, stroke)| near(stroke.to.position));
    for (index, stroke) in strokes {
        let mut last: Option<Point> = None;
        for pose in stroke.poses(pace, reach) {
            if last.is_none_or(|last| (pose.position - last).norm() > 2.0 * pace) {
                cover(&mut free, grid, pose.position, body);
                last = Some(pose.position);
            }
            for (sensor, mount) in chassis.sensors.iter().enumerate() {
                if stroke.closed.has(sensor) {
                    continue;
                }
                let ray = angle::unit(pose.heading + mount.angle);
                for k in 0..=shells {
                    let far = body + (reach - SURE - body) * f64::from(k) / f64::from(shells);
                    let p = pose.position + ray * far;
                    if within(p) {
                        let cell = grid.index(p);
                        let before = *looked[cell].get_or_insert(index);
                        free[cell] |= before != index;
                    }
                }
            }
        }
        cover(&mut free, grid, stroke.to.position, body);
    }
    free
}

/// The beams of switches that were closed on the way of `strokes`, every `pace` metres of it, from the rim of
/// the body to as far as they see: something stands on each of them.
#[must_use]
pub fn closed_beams(strokes: &[Stroke], chassis: &Chassis, pace: f64) -> Vec<(Point, Point)> {
    let reach = chassis.reach();
    let beams = |stroke: &Stroke, pose: Pose| {
        let closed = stroke.closed;
        let sensors = chassis.sensors.iter().enumerate().filter(move |(k, _)| closed.has(*k));
        sensors.map(move |(_, mount)| {
            let ray = angle::unit(pose.heading + mount.angle);
            (pose.position + ray * chassis.radius, pose.position + ray * reach)
        })
    };
    let poses = |stroke: &Stroke| stroke.poses(pace, reach).collect::<Vec<Pose>>();
    strokes
        .iter()
        .filter(|stroke| stroke.closed != SwitchSet::EMPTY)
        .flat_map(|stroke| poses(stroke).into_iter().flat_map(move |pose| beams(stroke, pose)))
        .collect()
}

/// Marks the cells within `radius` of `middle`.
fn cover(free: &mut [bool], grid: &Grid, middle: Point, radius: f64) {
    let (x0, y0) = grid.locate(middle - crate::geometry::Vector::new(radius, radius));
    let (x1, y1) = grid.locate(middle + crate::geometry::Vector::new(radius, radius));
    for y in y0..=y1 {
        for x in x0..=x1 {
            if (grid.center(x, y) - middle).norm_squared() < radius * radius {
                free[y * grid.width + x] = true;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A robot that stands still and turns by 0.6 rad so many `times`, there and back, all switches open but
    /// those in `closed`: whether it knows the floor to be free in so many places.
    fn knows(times: u32, closed: SwitchSet, at: &[Point]) -> Vec<bool> {
        let chassis = Chassis::default();
        let mut wall = Wall::new(&chassis);
        let mut heading = 0.0;
        wall.carve(Pose::new(0.0, 0.0, heading), closed, 0.0, 0);
        for k in 0..times {
            let by = if k % 2 == 0 { 0.1 } else { -0.1 };
            for _ in 0..6 {
                heading += by;
                wall.carve(Pose::new(0.0, 0.0, heading), closed, 0.0, 0);
            }
        }
        let grid = Grid::over(Point::new(-0.2, -0.2), Point::new(0.2, 0.2), 0.005, 0.0);
        let free = swept(wall.strokes(), &chassis, &grid);
        at.iter().map(|p| free[grid.index(*p)]).collect()
    }

    #[test]
    fn where_the_body_is_and_where_a_beam_has_looked_twice_the_floor_is_free() {
        let ray = |bearing: f64, far: f64| Point::from(angle::unit(bearing) * far);
        // Within the body; in what the front beam swept; short of its reach; between two beams' sweeps.
        let at = [ray(0.3, 0.08), ray(0.3, 0.13), ray(0.3, 0.157), ray(0.7, 0.13)];
        assert_eq!(knows(2, SwitchSet::EMPTY, &at), [true, true, false, false]);
        assert_eq!(knows(1, SwitchSet::EMPTY, &at), [true, false, false, false], "looked once");
        assert_eq!(knows(2, SwitchSet::only(0), &at), [true, false, false, false], "closed");
    }

    #[test]
    fn a_turn_is_one_stroke_as_long_as_no_switch_changes() {
        let mut wall = Wall::new(&Chassis::default());
        for k in 0..8 {
            let closed = if k < 5 { SwitchSet::EMPTY } else { SwitchSet::only(1) };
            wall.carve(Pose::new(0.0, 0.0, 0.1 * f64::from(k)), closed, 0.0, 0);
        }
        assert_eq!(wall.strokes().len(), 2, "{:?}", wall.strokes());
        assert!((wall.strokes()[0].turned - 0.4).abs() < 1e-12);
    }

    #[test]
    fn a_gate_is_felt_where_switches_are_closed_towards_both_of_its_ends() {
        let chassis = Chassis::default();
        let across = |sign: f64| {
            let off = |angle: f64| (angle - sign * angle::FRAC_PI_2).abs();
            chassis.sensors.iter().position(|mount| off(mount.angle) < 0.01).expect("a switch")
        };
        let (left, right) = (SwitchSet::only(across(1.0)), across(-1.0));
        let felt = |closed: SwitchSet, x: f64| {
            let mut wall = Wall::new(&chassis);
            for k in 0..40 {
                wall.carve(Pose::new(f64::from(k) * 0.02, 0.0, 0.0), closed, 0.0, 0);
            }
            let gate = Segment::new(Point::new(x, -0.14), Point::new(x, 0.14));
            is_felt_on_both_hands(wall.strokes(), &chassis, &gate)
        };
        assert!(felt(left.with(right, true), 0.4));
        assert!(!felt(left, 0.4) && !felt(SwitchSet::EMPTY, 0.4), "on one hand at most");
        assert!(!felt(left.with(right, true), 1.5), "it was not there");
    }
}
