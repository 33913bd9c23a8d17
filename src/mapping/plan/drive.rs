//! The piece of a plan's line that the robot's centre can drive. Ends stop where the front switch
//! sees the wall well within its range; walls passed at the side need to leave the body room.

use crate::geometry::{Point, Vector};
use crate::mapping::floor::Floor;
use crate::mapping::map::PlanLine;

/// The body keeps this much from walls at its side, metres.
const SIDE: f64 = 0.022;
/// An end lies this far from the wall ahead, beyond the body's radius, metres: the front switch
/// (d = 0.06) has closed by then.
const HEAD: f64 = 0.045;
/// Where the side's room is only just missing, the line is probed in steps of this, metres.
const PROBE: f64 = 0.02;
/// Shorter pieces are not worth a line, metres.
const SHORTEST: f64 = 0.05;

/// The piece of the way from `start` to `end` (both on the wall line or on a cut) that the centre
/// can drive as far as the boundary goes, its ends clear of known objects; none when the body does
/// not fit anywhere. Of several pieces, the longest.
pub(super) fn piece(floor: &Floor, start: Point, end: Point) -> Option<(Point, Point)> {
    let way = Way::new(start, end)?;
    let head = floor.radius + HEAD;
    let back = |p: Point| {
        // The end on a cut has no wall ahead of it.
        if floor.wall_clearance_near(p) > head { 0.0 } else { head }
    };
    let (first, last) = (back(start), way.length - back(end));
    let side = floor.radius + SIDE;
    let clear = |p: Point| floor.wall_clearance_near(p) - side;
    let sent = |&(a, b): &(f64, f64)| {
        let middle = way.at(f64::midpoint(a, b));
        // Whether an object there can be passed is for the drive to find out.
        let sent = || floor.is_drivable(middle) || floor.object_clearance(middle) < side;
        b - a >= SHORTEST && sent()
    };
    let longest = way
        .pieces(first, last, clear)
        .into_iter()
        .filter(sent)
        .max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)))?;
    if !floor.has_objects() {
        return Some((way.at(longest.0), way.at(longest.1)));
    }
    let free = way.pieces(longest.0, longest.1, |p| floor.clearance_near(p) - side);
    let begin = free.first()?.0;
    let finish = free.last()?.1;
    (finish - begin >= SHORTEST).then(|| (way.at(begin), way.at(finish)))
}

/// The pieces of a line's drive that known objects leave free.
pub(super) fn free_pieces(floor: &Floor, line: &PlanLine) -> Vec<(Point, Point)> {
    let Some((from, to)) = line.drive else {
        return Vec::new();
    };
    let Some(way) = Way::new(from, to) else {
        return Vec::new();
    };
    let side = floor.radius + SIDE - 0.005;
    way.pieces(0.0, way.length, |p| floor.clearance_near(p) - side)
        .into_iter()
        .map(|(a, b)| (way.at(a), way.at(b)))
        .collect()
}

/// The longest free piece of the endless line through `p` along `direction`, as far as the body
/// fits; none where it does not fit at `p` itself.
pub(super) fn through(floor: &Floor, p: Point, direction: Vector) -> Option<(Point, Point)> {
    let side = floor.radius + SIDE;
    let size = floor.grid.cell * (floor.grid.width + floor.grid.height) as f64;
    let run = |direction: Vector| {
        let far = Way::new(p, p + direction * size)?;
        let pieces = far.pieces(0.0, size, |q| floor.clearance_near(q) - side);
        let (from, to) = *pieces.first()?;
        (from < PROBE).then(|| far.at(to))
    };
    Some((run(-direction)?, run(direction)?))
}

struct Way {
    start: Point,
    along: Vector,
    length: f64,
}

impl Way {
    fn new(start: Point, end: Point) -> Option<Self> {
        let way = end - start;
        let length = way.norm();
        (length > 1e-9).then(|| Self { start, along: way / length, length })
    }

    fn at(&self, t: f64) -> Point {
        self.start + self.along * t
    }

    /// The stretches between `first` and `last` where `room` is not negative. Room changes by no
    /// more than the way gone, so one can go ahead by the room there is.
    fn pieces(&self, first: f64, last: f64, room: impl Fn(Point) -> f64) -> Vec<(f64, f64)> {
        let mut pieces = Vec::new();
        let (mut t, mut before, mut open) = (first, first, None);
        while t < last {
            let here = room(self.at(t));
            if here >= 0.0 && open.is_none() {
                open = Some(self.threshold(before, t, &room));
            } else if here < 0.0 && open.is_some() {
                pieces.extend(open.take().map(|from| (from, self.threshold(t, before, &room))));
            }
            before = t;
            t += here.abs().max(PROBE);
        }
        if let Some(from) = open {
            let ends = room(self.at(last)) >= 0.0;
            let to = if ends { last } else { self.threshold(last, before, &room) };
            pieces.push((from, to));
        }
        pieces.retain(|&(from, to)| to > from);
        pieces
    }

    /// A place with room, near where room begins on the way from `without` to `with`.
    fn threshold(&self, without: f64, with: f64, room: &impl Fn(Point) -> f64) -> f64 {
        let (mut without, mut with) = (without, with);
        for _ in 0..3 {
            let middle = f64::midpoint(without, with);
            if room(self.at(middle)) >= 0.0 {
                with = middle;
            } else {
                without = middle;
            }
        }
        with
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::floor::rooms;

    #[test]
    fn ends_stop_before_the_wall_ahead() {
        let floor = rooms::floor(&rooms::rectangle(5.0, 4.0), &[]);
        let (a, b) = piece(&floor, Point::new(2.0, 0.0), Point::new(2.0, 4.0)).unwrap();
        assert!((a.y - 0.145).abs() < 1e-3 && (b.y - 3.855).abs() < 1e-3, "{a} to {b}");
    }

    #[test]
    fn a_line_from_a_corner_begins_where_the_body_fits() {
        let floor = rooms::floor(&rooms::rectangle(5.0, 4.0), &[]);
        let (a, _) = piece(&floor, Point::new(0.0, 0.0), Point::new(5.0, 1.0)).unwrap();
        assert!((a.y - 0.122).abs() < 0.012 && a.y >= 0.120, "{a}");
    }

    #[test]
    fn a_line_through_a_closed_gap_keeps_its_longer_side() {
        let floor = rooms::floor(&rooms::two_rooms(0.2), &[]);
        let (a, b) = piece(&floor, Point::new(0.0, 0.9), Point::new(4.0, 1.1)).unwrap();
        assert!(b.x < 1.9 && a.x < 0.2, "{a} to {b}");
    }

    #[test]
    fn a_corridor_narrower_than_the_body_is_no_drive() {
        let floor = rooms::floor(&rooms::two_rooms(0.2), &[]);
        assert_eq!(piece(&floor, Point::new(1.9, 1.05), Point::new(2.1, 0.95)), None);
    }
}
