//! Where to roll next: the geometry of the follower's step.
//!
//! Pure functions of the contacts near the robot. See [`super::follow`] for the idea.

use super::follow::Side;
use super::wall::Stretch;
use crate::geometry::{Point, Pose, Vector, angle, cross};

/// The last contact along the wall, and how the wall runs there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frontier {
    /// The contact itself.
    pub at: Point,
    /// The straight stretch that ends there; `along` points the way the robot goes.
    pub stretch: Stretch,
    /// Whether the stretch rests on contacts that lie well apart.
    pub certain: bool,
    /// How far beyond the last contact it is believed, metres: in proportion to what was seen.
    pub extent: f64,
    /// Whether a look has shown that it does not go on: its beam would have been in the way.
    pub ended: bool,
}

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

/// A surface this much nearer than the reach, metres, and this far from either end of a sweep,
/// radians, would have been seen.
const SURE: f64 = 0.010;
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
}

/// Two contacts farther apart than the disc is wide do not belong to one wall.
const CHAIN: f64 = 0.29;
/// A run is straight when no contact of it lies farther from its line, metres: the one contact
/// beyond a corner must not be taken for more of the wall before.
const STRAIGHT: f64 = 0.004;
/// No run is longer, metres.
const LONGEST_RUN: f64 = 0.6;

impl Rolling {
    /// The first direction, counted from the nearest contact away from the wall, in which a
    /// straight step of `step` metres keeps the disc clear of all `contacts`; where the wall is not
    /// known to have `ended`, it is taken to go on straight beyond the last of them, but not through
    /// what was `swept`. None when every direction is blocked. Without contacts: straight ahead.
    #[must_use]
    pub fn direction(
        &self,
        contacts: &[Point],
        pose: Pose,
        step: f64,
        ended: bool,
        swept: Option<&Sweep>,
    ) -> Option<Direction> {
        let Some(chain) = self.chain(contacts, pose.position) else {
            return Some(Direction { heading: pose.heading, frontier: None });
        };
        let mut frontier = self.frontier(contacts, chain[chain.len() - 1], pose);
        let mut obstacles = contacts.to_vec();
        if !ended {
            let count = ((step + self.radius).min(frontier.extent) / 0.02) as i32;
            let beyond = |k: i32| frontier.at + frontier.stretch.along * (f64::from(k) * 0.02);
            let seen_through = |p: &Point| swept.is_some_and(|sweep| sweep.rules_out(*p));
            obstacles.extend((1..=count).map(beyond).take_while(|p| !seen_through(p)));
            frontier.ended = (1..=count).any(|k| seen_through(&beyond(k)));
        }
        let toward = angle::of(chain[0] - pose.position);
        let heading = self
            .first_free(&obstacles, pose.position, toward, step, self.radius)
            .or_else(|| self.first_free(&obstacles, pose.position, toward, step, self.least))
            .or_else(|| self.first_free(contacts, pose.position, toward, step / 3.0, self.least))?;
        Some(Direction { heading, frontier: Some(frontier) })
    }

    fn first_free(
        &self,
        obstacles: &[Point],
        from: Point,
        toward: f64,
        step: f64,
        radius: f64,
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
                closest >= radius.min(now) - 0.0015
                    && at_end >= radius.min(now + 0.3 * step) - 0.002
            });
            clear.then_some(angle::wrap(heading))
        })
    }

    /// The contacts in rolling order from the one nearest to the robot on; none without contacts.
    fn chain(&self, contacts: &[Point], center: Point) -> Option<Vec<Point>> {
        let nearest = contacts
            .iter()
            .copied()
            .min_by(|a, b| (a - center).norm().total_cmp(&(b - center).norm()))?;
        let toward = angle::of(nearest - center);
        let turned = |p: &Point| {
            angle::wrap_positive(self.side.sign() * (toward - angle::of(p - center)) + 0.02)
        };
        let mut ahead: Vec<Point> =
            contacts.iter().copied().filter(|p| turned(p) < 4.0 && *p != nearest).collect();
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

    /// How the wall runs at its last contact `at`: the longest straight run of the contacts that
    /// came before it, newest first. In the order of time a wall is one run, whatever stands behind.
    fn frontier(&self, contacts: &[Point], at: Point, pose: Pose) -> Frontier {
        let newest = contacts.iter().rposition(|p| *p == at).unwrap_or(0);
        let mut run = vec![at];
        let mut best: Option<(Stretch, f64)> = None;
        let mut strays = 0;
        for &p in contacts[..newest].iter().rev() {
            let spread = (p - at).norm();
            run.push(p);
            let straight = Stretch::through(&run)
                .filter(|s| run.len() < 3 || run.iter().all(|p| s.distance(*p) < STRAIGHT));
            if straight.is_none() || spread > LONGEST_RUN {
                run.pop();
                strays += 1;
                if strays > 2 {
                    break;
                }
            } else if let Some(stretch) = straight
                && spread > 0.008
                // Two contacts are always straight; far apart they may be of two walls.
                && (run.len() > 2 || spread < 0.1)
                && best.is_none_or(|(_, widest)| spread > widest)
            {
                best = Some((stretch, spread));
            }
        }
        let away = at - pose.position;
        let level: Vector = crate::geometry::perp(away) * -self.side.sign();
        let (stretch, certain, extent) = if let Some((stretch, spread)) = best {
            (stretch, spread > 0.05, (2.0 * spread).max(0.06))
        } else {
            let along = level.try_normalize(1e-9).unwrap_or_else(|| pose.direction());
            (Stretch { at, along, residual: 0.0 }, false, 0.1)
        };
        let onward = -self.side.sign() * cross(away, stretch.along);
        let along = if onward < 0.0 { -stretch.along } else { stretch.along };
        Frontier { at, stretch: Stretch { along, ..stretch }, certain, extent, ended: false }
    }
}
