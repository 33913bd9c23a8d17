//! What was seen of a wall in one look, and what a contact of another look lies on there: a stretch of
//! it, straight or bent; between two of its contacts, where it has corners; beside one of them, where it
//! is ragged. It refuses to know why the two looks differ.

use crate::geometry::fit::Moments;
use crate::geometry::{Point, Vector, cross, perp};
use crate::mapping::wall::Stretch;

/// Believed spread of a contact about its wall, metres. Neighbours err together: more than jitter.
pub(super) const CONTACT_SD: f64 = 0.005;
/// Contacts that lie this close about a line or circle are one wall, metres; more when they scatter.
const STRAIGHT: f64 = 0.0015;
/// A contact this near to another is of the same place, metres; more when they scatter.
const BESIDE: f64 = 0.012;
/// Contacts of one wall scatter no more than this about it, metres: what does is ragged.
const MOST_SCATTER: f64 = 0.006;
/// Contacts of a ragged wall err together this far, metres, by so much of what they scatter.
const TOGETHER: f64 = 0.075;
const RAGGED: f64 = 1.0;
/// How far around a contact its wall is looked for, metres: sparse on long straight walls.
const NEIGHBOURS: [f64; 4] = [0.1, 0.25, 0.5, 1.0];
/// Contacts that a stretch of wall rests on at least.
const A_STRETCH: usize = 4;

/// A place of a surface, and from which side it was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Where it is.
    pub at: Point,
    /// Towards the floor from which it was seen; of any length.
    pub towards: Vector,
}

impl Seen {
    /// What `other` saw may be the same surface: the two faces of a thin wall are not.
    fn faces_as(&self, other: &Self) -> bool {
        self.towards.dot(&other.towards) > 0.0
    }
}

/// One look, of contacts of which it is known how they scatter.
#[derive(Clone, Copy)]
pub(super) struct Look<'a> {
    pub(super) seen: &'a [Seen],
    /// Spread of contacts about the wall they are of, metres.
    pub(super) scatter: f64,
}

impl Look<'_> {
    /// How close contacts are that lie beside each other, metres.
    fn near(&self) -> f64 {
        BESIDE.max(3.0 * self.scatter)
    }

    /// How close contacts lie about a straight stretch, metres.
    fn straight(&self) -> f64 {
        STRAIGHT.max(1.6 * self.scatter)
    }

    /// What was seen in it around `seen`, which came later.
    pub(super) fn around<'s>(&self, seen: &'s Seen) -> Around<'s> {
        let [.., reach] = NEIGHBOURS;
        let close = |early: &&Seen| (early.at.x - seen.at.x).abs() < reach && early.faces_as(seen);
        let away = |early: &Seen| ((early.at - seen.at).norm(), early.at);
        let facing = self.seen.iter().filter(close).map(away).filter(|(away, _)| *away < reach);
        Around { seen, facing: facing.collect(), near: self.near(), straight: self.straight() }
    }
}

/// A contact among those of an earlier look.
pub(super) struct Around<'s> {
    seen: &'s Seen,
    /// Contacts that may be of the same surface, and how far away they are, metres.
    facing: Vec<(f64, Point)>,
    near: f64,
    straight: f64,
}

impl Around<'_> {
    /// Those no farther than `reach`, metres.
    fn within(&self, reach: f64) -> Vec<Point> {
        self.facing.iter().filter(|(away, _)| *away < reach).map(|(_, at)| *at).collect()
    }

    /// The contact nearest to it, when one lies beside it.
    pub(super) fn beside(&self) -> Option<Point> {
        let beside = self.facing.iter().filter(|(away, _)| *away < self.near);
        beside.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, at)| *at)
    }

    /// Whether it lies between two contacts next to each other: where a wall has corners its contacts lie on
    /// no line, and a later one comes between them.
    pub(super) fn is_between(&self) -> bool {
        let close = self.within(NEIGHBOURS[0]);
        close.iter().enumerate().any(|(k, a)| {
            close[k + 1..].iter().any(|b| {
                let along = b - a;
                let length = along.norm();
                if !(1e-6..NEIGHBOURS[0]).contains(&length) {
                    return false;
                }
                let off = self.seen.at - a;
                let share = along.dot(&off) / length;
                (0.0..=length).contains(&share) && (cross(along, off) / length).abs() < self.near
            })
        })
    }

    /// Whether the contacts close about it lie on no line: they tell where along the wall it is.
    pub(super) fn is_ragged(&self) -> bool {
        let close = self.within(NEIGHBOURS[0]);
        close.len() >= A_STRETCH
            && Stretch::through(&close).is_some_and(|line| line.residual >= self.straight)
    }

    /// The straight stretch of wall on which it lies: through its neighbours, as near as there are enough of
    /// them.
    pub(super) fn stretch(&self) -> Option<Stretch> {
        let (point, tolerance) = (self.seen.at, self.straight);
        NEIGHBOURS.iter().find_map(|reach| {
            let near = self.within(*reach);
            if near.len() < A_STRETCH {
                return None;
            }
            let straight = Stretch::through(&near)?;
            let local = if straight.residual < tolerance {
                straight
            } else {
                bent(&near, point, tolerance)?
            };
            let along = |p: Point| local.along.dot(&(p - local.at));
            let (low, high) =
                near.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &p| {
                    (low.min(along(p)), high.max(along(p)))
                });
            // Beyond what was seen the wall may do anything.
            let within = (low - 0.015..=high + 0.015).contains(&along(point));
            (within && high - low > 0.05).then_some(local)
        })
    }
}

/// How far contacts scatter about their walls, metres: the lower quartile of what short stretches do,
/// since corners and ragged walls are no scatter.
pub(super) fn scatter(seen: &[Seen]) -> f64 {
    const STRETCH: usize = 6;
    let points: Vec<Point> = seen.iter().map(|seen| seen.at).collect();
    let stretches = points.windows(STRETCH).filter_map(Stretch::through);
    let mut residuals: Vec<f64> = stretches.map(|stretch| stretch.residual).collect();
    residuals.sort_by(f64::total_cmp);
    residuals.get(residuals.len() / 4).map_or(0.0, |residual| residual.min(MOST_SCATTER))
}

/// The variance of one of the contacts that were `seen` where they `scatter` about their walls: what a
/// ragged wall is off its stretches by, a switch finds again with every beam that passes there.
pub(super) fn variance(seen: &[Seen], scatter: f64) -> f64 {
    let near = |a: &Seen| seen.iter().filter(|b| (b.at - a.at).norm() < TOGETHER).count();
    let neighbours = seen.iter().map(near).sum::<usize>() as f64 / seen.len().max(1) as f64;
    CONTACT_SD.powi(2) + neighbours * (RAGGED * scatter).powi(2)
}

/// The tangent, nearest to `point`, of the circle through `near`; none when they lie on none.
fn bent(near: &[Point], point: Point, tolerance: f64) -> Option<Stretch> {
    let circle = Moments::of(near).circle()?;
    let off = |p: &Point| (p - circle.center).norm() - circle.radius;
    let count = near.len() as f64;
    let residual = (near.iter().map(|p| off(p).powi(2)).sum::<f64>() / count).sqrt();
    let outward = (point - circle.center).try_normalize(1e-9)?;
    let on_circle = near.len() >= 5 && residual < tolerance && circle.radius > 0.3;
    on_circle.then(|| Stretch {
        at: circle.center + outward * circle.radius,
        along: perp(outward),
        residual,
    })
}
