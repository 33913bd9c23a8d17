//! Led off what it follows to a thing beside it. The robot met the thing in a gap that it would have passed
//! another time, and passes the gap as it comes back along the thing: so it goes round that for ever, and never
//! back to the wall. The gap is hardly wide enough to be one; closed to the robot from then on, it leads over to
//! the wall again. Knows the robot's way and what was seen; not how rounds are told.

use super::Anchor;
use crate::geometry::Point;
use crate::geometry::segment::Segment;
use crate::mapping::wall::Sighting;

/// What lies farther off the robot's way than this is on no side of a gap that it passed, in widths of it.
const BESIDE: f64 = 0.75;

/// Where a robot that goes round a thing passes between that and what was seen before it came there, and that is
/// narrowest: a place on the thing, and one on the other side. None where it is wider than `width`, metres.
///
/// `trail` ends with a whole round, since it had travelled `round` metres; it came to the thing when it had
/// travelled `came`.
pub(super) fn gap<'a>(
    trail: &[Anchor],
    (came, round): (f64, f64),
    seen: impl Iterator<Item = &'a Sighting> + Clone,
    width: f64,
) -> Option<(Point, Point)> {
    let first = trail.partition_point(|place| place.travelled < round);
    let steps = trail[first..].windows(2);
    let steps: Vec<Segment> =
        steps.map(|two| Segment::new(two[0].pose.position, two[1].pose.position)).collect();
    let off = BESIDE * width;
    let beside = |p: &Point| steps.iter().any(|step| step.distance_squared(*p) < off * off);
    let seen = seen.filter(|seen| seen.alive);
    let of = |wanted: &dyn Fn(f64) -> bool| -> Vec<Point> {
        let wanted = seen.clone().filter(|seen| wanted(seen.travelled));
        wanted.map(|seen| seen.point).filter(beside).collect()
    };
    let (thing, others) = (of(&|travelled| travelled > round), of(&|travelled| travelled < came));
    let pairs = thing.iter().flat_map(|a| others.iter().map(move |b| Segment::new(*a, *b)));
    let between = pairs
        .filter(|across| across.length() < width)
        .filter(|across| steps.iter().any(|step| step.crosses(across)));
    let narrowest = between.min_by(|a, b| a.length().total_cmp(&b.length()))?;
    Some((narrowest.from, narrowest.to()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Pose, angle};

    /// Two rounds about a column of 0.2 m radius at the origin, 0.35 m from its middle, after 5 m along a wall.
    fn trail() -> Vec<Anchor> {
        let place = |k: u32| {
            let bearing = f64::from(k) * angle::TAU / 40.0;
            let position = Point::origin() + angle::unit(bearing) * 0.35;
            let pose = Pose { position, heading: angle::wrap(bearing + angle::FRAC_PI_2) };
            let travelled = 5.0 + 0.35 * bearing;
            Anchor { pose, heading: bearing, travelled, time_us: 0 }
        };
        (0..=80).map(place).collect()
    }

    #[test]
    fn the_gap_is_where_the_round_comes_by_what_was_there_before() {
        let round = 5.0 + 0.35 * angle::TAU;
        let column = (0..40).map(|k| angle::unit(f64::from(k) * angle::TAU / 40.0) * 0.2);
        let column = column.map(|at| Sighting::at(at.x, at.y, round + 0.1));
        let wall = (0..9).map(|k| Sighting::at(0.4 - 0.1 * f64::from(k), -0.53, 1.0));
        let all: Vec<Sighting> = column.chain(wall).collect();
        let (one, other) = gap(&trail(), (5.0, round), all.iter(), 0.4).expect("a gap");
        assert!((one - Point::new(0.0, -0.2)).norm() < 1e-9, "{one}");
        assert!((other - Point::new(0.0, -0.53)).norm() < 1e-9, "{other}");
        assert_eq!(gap(&trail(), (5.0, round), all.iter(), 0.3), None, "it is 0.33 m wide");
    }

    #[test]
    fn what_the_robot_did_not_come_between_is_no_gap() {
        let round = 5.0 + 0.35 * angle::TAU;
        // Both are on the column; the earlier one was seen before the robot first came round it.
        let all = [Sighting::at(0.0, -0.2, round + 0.1), Sighting::at(0.05, -0.19, 1.0)];
        assert_eq!(gap(&trail(), (5.0, round), all.iter(), 0.4), None);
    }
}
