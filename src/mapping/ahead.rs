//! Where to roll next: the geometry of the follower's step.
//!
//! Pure functions of the contacts near the robot. See [`super::follow`] for the idea.

mod frontier;

pub use frontier::Frontier;

use super::follow::Side;
use super::lay::Seen;
use crate::geometry::{Point, Pose, angle};

/// What one beam swept over, open all the while, as the robot turned on the spot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sweep {
    /// Where the robot stood.
    pub at: Point,
    /// Direction of the beam at the beginning, in the map frame, radians.
    pub from: f64,
    /// By how much it turned, positive counter-clockwise, radians.
    pub by: f64,
    /// How far it would have seen, from the robot's centre, metres.
    pub reach: f64,
}

/// A surface this much nearer than the reach, metres, ...
const SURE: f64 = 0.010;
/// ... and this far from either end of a sweep, radians, would have been seen.
const INSIDE: f64 = 0.05;

impl Sweep {
    /// Whether nothing can be at `p`.
    fn rules_out(&self, p: Point) -> bool {
        let off = p - self.at;
        let turned = angle::wrap(angle::of(off) - self.from) * self.by.signum();
        off.norm() < self.reach - SURE && (INSIDE..self.by.abs() - INSIDE).contains(&turned)
    }
}

/// A direction to step in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction {
    /// In the map frame, radians.
    pub heading: f64,
    /// How far to go, metres: where the wall bends no farther than its switch keeps seeing it.
    pub step: f64,
    /// What it was based on.
    pub frontier: Option<Frontier>,
}

/// The disc that rolls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rolling {
    /// On which hand the wall is.
    pub side: Side,
    /// Body and gap together, metres.
    pub radius: f64,
    /// Where the gap cannot be had, this much room will do, metres.
    pub least: f64,
    /// The wall may get this much farther off before its switch opens, metres.
    pub slack: f64,
    /// Whether the robot sees so far that the far side of a thin wall must be told from the near one.
    pub sees_far: bool,
}

/// Two contacts farther apart than the disc is wide do not belong to one wall.
const CHAIN: f64 = 0.29;
/// Half way along a step round a corner the disc may get this much nearer to it than at its ends, metres:
/// a chord of the circle about the corner keeps it in sight, a tangent of the same length would not.
const DIP: f64 = 0.004;
/// A contact so much farther off than its switch sees is still at hand, metres: contacts are not exact.
const UNSURE: f64 = 0.02;
/// What is no farther to the other hand of straight ahead is the wall too, radians: it may bend there.
const OFF_AHEAD: f64 = 0.3;

impl Rolling {
    /// The first direction, counted from the nearest contact of the wall away from it, in which a
    /// straight step of `step` metres, or less, keeps the disc clear of all `contacts`; where the wall
    /// is not known to have `ended`, it is taken to go on beyond the last of them as it ran there, but
    /// not through what was `swept`. Of the wall is what lies to its hand of the heading `along` (radians)
    /// in which the robot came: in a pocket the other side may be nearer. None when every direction is
    /// blocked. Without contacts: straight ahead.
    #[must_use]
    pub fn direction(
        &self,
        contacts: &[Seen],
        pose: Pose,
        step: f64,
        ended: bool,
        swept: Option<&Sweep>,
        along: f64,
    ) -> Option<Direction> {
        let points: Vec<Point> = contacts.iter().map(|seen| seen.at).collect();
        let Some(chain) = self.chain(contacts, pose.position, along) else {
            return Some(Direction { heading: pose.heading, step, frontier: None });
        };
        let mut frontier = Frontier::of(contacts, chain[chain.len() - 1], pose, self.side);
        let mut obstacles = points.clone();
        let step = if ended { step } else { step.min(frontier.longest_chord(self)) };
        if !ended {
            let count = ((step + self.radius).min(frontier.extent) / 0.02) as i32;
            let beyond = |k: i32| frontier.beyond(f64::from(k) * 0.02);
            let seen_through = |p: &Point| swept.is_some_and(|sweep| sweep.rules_out(*p));
            obstacles.extend((1..=count).map(beyond).take_while(|p| !seen_through(p)));
            frontier.ended = (1..=count).any(|k| seen_through(&beyond(k)));
        }
        let toward = angle::of(chain[0] - pose.position);
        let dip = if ended { DIP } else { 0.0 };
        let heading = self
            .first_free(&obstacles, pose.position, toward, step, self.radius, dip)
            .or_else(|| self.first_free(&obstacles, pose.position, toward, step, self.least, 0.0))
            .or_else(|| {
                self.first_free(&points, pose.position, toward, step / 3.0, self.least, 0.0)
            })?;
        Some(Direction { heading, step, frontier: Some(frontier) })
    }

    fn first_free(
        &self,
        obstacles: &[Point],
        from: Point,
        toward: f64,
        step: f64,
        radius: f64,
        dip: f64,
    ) -> Option<f64> {
        (0..340).find_map(|degrees| {
            let heading = toward - self.side.sign() * f64::from(degrees).to_radians();
            let direction = angle::unit(heading);
            let clear = obstacles.iter().all(|p| {
                let off = p - from;
                let now = off.norm();
                let along = off.dot(&direction).clamp(0.0, step);
                let closest = (off - direction * along).norm();
                let at_end = (off - direction * step).norm();
                closest >= (radius - dip).min(now) - 0.0015
                    && at_end >= radius.min(now + 0.3 * step) - 0.002
            });
            clear.then_some(angle::wrap(heading))
        })
    }

    /// The nearest contact at the hand of a robot at `center` that goes `along`, within reach of its
    /// switches; the nearest of all where there is none.
    fn at_hand(&self, contacts: &[Seen], center: Point, along: f64) -> Option<Point> {
        let points = || contacts.iter().map(|seen| seen.at);
        let beside = |p: &Point| {
            let off = p - center;
            let towards = self.side.sign() * angle::wrap(angle::of(off) - along);
            off.norm() < self.radius + self.slack + UNSURE && towards > -OFF_AHEAD
        };
        let nearer = |a: &Point, b: &Point| (a - center).norm().total_cmp(&(b - center).norm());
        points().filter(beside).min_by(nearer).or_else(|| points().min_by(nearer))
    }

    /// The contacts in rolling order from the one at hand on; none without contacts.
    fn chain(&self, contacts: &[Seen], center: Point, along: f64) -> Option<Vec<Point>> {
        let nearest = self.at_hand(contacts, center, along)?;
        let toward = angle::of(nearest - center);
        let turned = |p: &Point| {
            angle::wrap_positive(self.side.sign() * (toward - angle::of(p - center)) + 0.02)
        };
        // The far side of a thin wall is no way on, near as it may be: what was seen from where the robot is now by
        // more than a right angle.
        let faces = |seen: &&Seen| !self.sees_far || seen.towards.dot(&(center - seen.at)) > 0.0;
        let mut ahead: Vec<Point> = contacts
            .iter()
            .filter(faces)
            .map(|seen| seen.at)
            .filter(|p| turned(p) < 4.0 && *p != nearest)
            .collect();
        ahead.sort_by(|a, b| turned(a).total_cmp(&turned(b)));
        let mut chain = vec![nearest];
        for p in ahead {
            let joined = chain.iter().rev().take(4).any(|q| (p - q).norm() < CHAIN);
            if joined && (p - center).norm() < self.radius + 0.25 {
                chain.push(p);
            }
        }
        Some(chain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;

    #[test]
    fn out_of_a_pocket_the_wall_at_hand_leads_on_though_the_other_side_is_nearer() {
        let rolling = Rolling {
            side: Side::Right,
            radius: 0.145,
            least: 0.112,
            slack: 0.012,
            sees_far: false,
        };
        // A pocket behind the robot, which stands in its mouth and looks out along +x. The wall on the left
        // goes on, the one on the right ends here.
        let row =
            |from: f64, y: f64| (0..9).map(move |k| Point::new(from + 0.04 * f64::from(k), y));
        let seen = |at: Point| Seen { at, towards: -Vector::new(at.x, at.y) };
        let contacts: Vec<Seen> = row(-0.32, -0.165).chain(row(0.0, 0.11)).map(seen).collect();
        let pose = Pose::new(0.0, 0.0, 0.0);
        let way = |along: f64| {
            let found = rolling.direction(&contacts, pose, 0.06, true, None, along);
            found.expect("a way").heading
        };
        assert!((-1.3..0.3).contains(&way(0.0)), "round the end on the right: {}", way(0.0));
        // Had it come out backwards, the wall on its right would be the other one.
        assert!(way(angle::PI).abs() > 2.0, "in again: {}", way(angle::PI));
    }
}
