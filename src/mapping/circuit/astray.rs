//! Laps that go round and round away from where they began. The robot came through a gap that is
//! just too narrow to be found again from the other side, and is in a pocket of which it knows no
//! way out; the lap would never close.

use super::Anchor;
use crate::geometry::{Point, angle};

/// The same place again: nearer than this, metres ...
const NEAR: f64 = 0.08;
/// ... and a share of what was driven since, up to this, metres, for what odometry loses ...
const DRIFT: f64 = 0.01;
const FARTHEST: f64 = 0.3;
/// ... and facing the same way within this, radians.
const FACING: f64 = 0.3;
/// No round is shorter, metres.
const SHORTEST_ROUND: f64 = 1.0;
/// A round that comes this near to the beginning may still close there, metres.
const BEGINNING: f64 = 0.6;

/// How often the robot was where it is now, facing the same way, since it last passed `beginning`, and
/// the odometer at the first of those times, metres.
pub(super) fn visits(trail: &[Anchor], beginning: Point) -> (usize, f64) {
    let Some((now, before)) = trail.split_last() else { return (0, 0.0) };
    let mut last = now.travelled;
    let mut count = 0;
    let away = |place: &&Anchor| (place.pose.position - beginning).norm() > BEGINNING;
    for place in before.iter().rev().take_while(away) {
        let since = now.travelled - place.travelled;
        let near = (NEAR + DRIFT * since).min(FARTHEST);
        let again = last - place.travelled > SHORTEST_ROUND
            && (place.pose.position - now.pose.position).norm() < near
            && angle::wrap(place.pose.heading - now.pose.heading).abs() < FACING;
        if again {
            count += 1;
            last = place.travelled;
        }
    }
    (count, last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;

    /// `rounds` counter-clockwise rounds of a circle of radius 1 m about (`x`, 0), a step every 0.1 m.
    fn circling(rounds: f64, x: f64) -> Vec<Anchor> {
        let steps = (rounds * 62.83) as u32;
        (0..=steps)
            .map(|k| {
                let travelled = f64::from(k) * 0.1;
                let position = Point::new(x, 0.0) + angle::unit(travelled);
                let heading = travelled + angle::FRAC_PI_2;
                let pose = Pose { position, heading: angle::wrap(heading) };
                Anchor { pose, heading, travelled, time_us: u64::from(k) * 500_000 }
            })
            .collect()
    }

    #[test]
    fn each_round_away_from_the_beginning_counts() {
        let beginning = Point::new(5.0, 0.0);
        assert_eq!(visits(&circling(0.9, 0.0), beginning).0, 0);
        assert_eq!(visits(&circling(1.1, 0.0), beginning).0, 1);
        assert_eq!(visits(&circling(3.2, 0.0), beginning).0, 3);
    }

    #[test]
    fn rounds_past_the_beginning_do_not() {
        assert_eq!(visits(&circling(3.2, 0.0), Point::new(1.0, 0.0)).0, 0);
    }
}
