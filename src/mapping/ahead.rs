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
/// A chain is looked at over this much, metres.
const LONGEST_CHAIN: f64 = 0.3;
/// A contact lies on a line when it is no farther from it, metres.
const STRAIGHT: f64 = 0.004;
/// A direction is not read off contacts nearer than this, metres.
const LEAST_SPREAD: f64 = 0.008;
/// So many contacts on one line are a wall: two always are on one, three may be by chance.
const SURE: usize = 4;
/// What lies farther back says nothing of how the wall runs here, metres.
const LONGEST_RUN: f64 = 0.6;
/// A wall of which so much was not seen in one piece may be two, metres.
const LONGEST_GAP: f64 = 0.45;

/// The contacts on the line from `at` through `p`, nearest to `at` first, without a long gap.
fn run(contacts: &[Point], at: Point, p: Point) -> Vec<Point> {
    let Some(along) = (p - at).try_normalize(1e-9) else { return vec![at] };
    let mut on_line: Vec<(f64, Point)> = contacts
        .iter()
        .map(|q| (along.dot(&(q - at)), *q))
        .filter(|(far, q)| {
            (0.0..LONGEST_RUN).contains(far) && cross(along, q - at).abs() < STRAIGHT
        })
        .collect();
    on_line.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut seen = 0.0;
    on_line
        .into_iter()
        .take_while(|(far, _)| {
            let joined = far - seen < LONGEST_GAP;
            seen = *far;
            joined
        })
        .map(|(_, q)| q)
        .collect()
}

impl Rolling {
    /// The first direction, counted from the nearest contact away from the wall, in which a
    /// straight step of `step` metres keeps the disc clear of all `contacts`; where the wall is not
    /// known to have `ended`, it is taken to go on straight beyond the last of them. None when
    /// every direction is blocked. Without contacts: straight ahead.
    #[must_use]
    pub fn direction(
        &self,
        contacts: &[Point],
        pose: Pose,
        step: f64,
        ended: bool,
    ) -> Option<Direction> {
        let Some(chain) = self.chain(contacts, pose.position) else {
            return Some(Direction { heading: pose.heading, frontier: None });
        };
        let frontier = self.frontier(contacts, &chain, pose);
        let mut obstacles = contacts.to_vec();
        if !ended {
            let ahead = (step + self.radius).min(frontier.extent) / 0.02;
            obstacles.extend(
                (1..=ahead as i32)
                    .map(|k| frontier.at + frontier.stretch.along * (f64::from(k) * 0.02)),
            );
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

    /// How the wall runs at the last contact of `chain`: as the chain does, or, when the chain is
    /// that contact alone, as the wall already passed does if it leads straight to it.
    fn frontier(&self, contacts: &[Point], chain: &[Point], pose: Pose) -> Frontier {
        let at = chain[chain.len() - 1];
        let mut best: Option<(Stretch, f64)> = None;
        for count in 2..=chain.len().min(12) {
            let points = &chain[chain.len() - count..];
            let spread = (points[0] - at).norm();
            if spread > LONGEST_CHAIN {
                break;
            }
            if let Some(stretch) = Stretch::through(points)
                && spread > LEAST_SPREAD
                && stretch.residual < 0.003
                && best.is_none_or(|(_, widest)| spread > widest)
            {
                best = Some((stretch, spread));
            }
        }
        let best = best.or_else(|| {
            let run = contacts
                .iter()
                .filter(|p| (LEAST_SPREAD..LONGEST_RUN).contains(&(*p - at).norm()))
                .map(|p| run(contacts, at, *p))
                .max_by_key(Vec::len)
                .filter(|run| run.len() >= SURE)?;
            let spread = run.last().map_or(0.0, |p| (p - at).norm());
            Stretch::through(&run).map(|stretch| (stretch, spread))
        });
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
        Frontier { at, stretch: Stretch { along, ..stretch }, certain, extent }
    }
}
