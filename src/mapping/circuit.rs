//! One lap round something: follow the wall until back where it was first met (paper III.C).
//!
//! Closing takes two things at once: the robot crosses a line through a place it passed at the
//! beginning, near that place, and it faces the same way there. The sense of the one whole turn
//! that a closed lap makes (Hopf's theorem on turning tangents) is read from the area that the
//! driven path encloses rather than from the turns themselves: in narrow pockets the robot turns
//! about on the spot, and which way round it did so says nothing of the wall. That sense tells
//! inside from outside.

use super::adjust::{Overlap, Traverse, measure};
use super::event::Failure;
use super::follow::{Ask, AtRest, Follower, Side};
use super::odometry::Tracker;
use super::wall::Wall;
use crate::geometry::{Point, Pose, angle, cross};
use crate::robot::Chassis;

/// A place early in the lap at which it may close.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    /// Where.
    pub pose: Pose,
    /// Heading with whole turns counted, radians.
    pub heading: f64,
    /// Odometer, metres.
    pub travelled: f64,
    /// Robot time, microseconds.
    pub time_us: u64,
}

impl Anchor {
    fn here(tracker: &Tracker) -> Self {
        Self {
            pose: tracker.pose(),
            heading: tracker.cumulative_heading(),
            travelled: tracker.travelled(),
            time_us: tracker.time_us(),
        }
    }
}

/// A lap that closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closure {
    /// The place where it began.
    pub from: Anchor,
    /// The same place, a lap later.
    pub to: Anchor,
    /// On which hand the wall was.
    pub side: Side,
}

impl Closure {
    /// Length of the lap along the robot's path, metres.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.to.travelled - self.from.travelled
    }

    /// Whether the robot went round the outside: it turned towards the wall in all.
    #[must_use]
    pub fn is_extrinsic(&self) -> bool {
        (self.to.heading - self.from.heading) * self.side.sign() > 0.0
    }
}

/// What comes next on a lap.
#[derive(Debug, Clone, PartialEq)]
pub enum Leg {
    /// Another motion.
    Go(Ask),
    /// The lap closed, and some of it was driven again for the misclosure.
    Closed(Closure, Box<Overlap>),
    /// It cannot go on.
    Failed(Failure),
}

/// Anchors are set over this much of the beginning, metres.
const BEGINNING: f64 = 1.2;
/// No lap is shorter, metres.
const SHORTEST_LAP: f64 = 0.5;
/// A lap longer than this will not close any more, metres.
const LONGEST_LAP: f64 = 2000.0;

/// Share of the overlap that must lie on the walls seen first.
const AGREEMENT: f64 = 0.55;
/// Contacts of the overlap that must have something to lie on before that is judged.
const EVIDENCE: usize = 4;
/// The overlap is driven on until the misclosure is known to this (metres, radians), ...
const POSITION_ENOUGH: f64 = 0.005;
const HEADING_ENOUGH: f64 = 0.003;
/// ... but not further than this, metres.
const MOST_OVERLAP: f64 = 4.0;

/// A lap under way.
#[derive(Debug, Clone)]
pub struct Circuit {
    /// Contacts of this lap.
    pub wall: Wall,
    follower: Follower,
    anchors: Vec<Anchor>,
    previous: Option<Anchor>,
    closure: Option<Closure>,
    overlap: f64,
    trail: Vec<(f64, Point)>,
}

impl Circuit {
    /// Begins where the robot has just met something; `overlap` metres are driven again after the
    /// lap has closed.
    #[must_use]
    pub fn new(chassis: &Chassis, side: Side, wall: Wall, overlap: f64) -> Self {
        Self {
            wall,
            follower: Follower::new(chassis, side),
            anchors: Vec::new(),
            previous: None,
            closure: None,
            overlap,
            trail: Vec::new(),
        }
    }

    /// Where the lap is judged from, once it has begun.
    #[must_use]
    pub fn first_anchor(&self) -> Option<&Anchor> {
        self.anchors.first()
    }

    /// The lap as closed, while the overlap is being driven.
    #[must_use]
    pub fn closure(&self) -> Option<&Closure> {
        self.closure.as_ref()
    }

    /// The robot came to rest: what next?
    pub fn next(&mut self, tracker: &Tracker, rest: &AtRest) -> Leg {
        if self.follower.is_stepping() {
            self.after_step(tracker);
        }
        if let Some(closure) = self.closure
            && tracker.travelled() > closure.to.travelled + self.overlap
        {
            let since = closure.from.time_us;
            let traverse = Traverse::new(tracker, &closure, since);
            let overlap = measure(&closure, self.wall.log(), &traverse);
            let driven = tracker.travelled() - closure.to.travelled;
            let enough = overlap.sd.0 < POSITION_ENOUGH && overlap.sd.1 < HEADING_ENOUGH;
            let all = driven > MOST_OVERLAP.min(0.3 * closure.length());
            if overlap.known < EVIDENCE && !all {
                // On a straight wall contacts are far between: nothing is known yet, either way.
                self.overlap = driven + 0.2;
            } else if overlap.agreement < AGREEMENT {
                // It only looked near: this is another place, and the lap goes on.
                self.closure = None;
            } else if enough || all {
                return Leg::Closed(closure, Box::new(overlap));
            } else {
                self.overlap = driven + 0.2;
            }
        }
        if self.follower.is_stuck() {
            return Leg::Failed(Failure::Boxed);
        }
        if self.previous.is_some_and(|now| {
            self.anchors.first().is_some_and(|a| now.travelled - a.travelled > LONGEST_LAP)
        }) {
            return Leg::Failed(Failure::LapEndless);
        }
        match self.follower.next(&mut self.wall, rest) {
            Some(ask) => {
                if self.follower.is_stepping() {
                    self.before_step(tracker);
                }
                Leg::Go(ask)
            }
            None => Leg::Failed(Failure::Boxed),
        }
    }

    fn before_step(&mut self, tracker: &Tracker) {
        let here = Anchor::here(tracker);
        let young = self.anchors.first().is_none_or(|a| here.travelled - a.travelled < BEGINNING);
        if young && self.closure.is_none() {
            self.anchors.push(here);
        }
        self.trail.push((here.travelled, here.pose.position));
        self.previous = Some(here);
    }

    /// +1 when the path since `anchor` runs counter-clockwise round what it encloses, else -1.
    fn sense(&self, anchor: &Anchor) -> f64 {
        let since = self.trail.partition_point(|(travelled, _)| *travelled < anchor.travelled);
        let path = &self.trail[since..];
        let doubled: f64 = (0..path.len())
            .map(|k| {
                let (a, b) = (path[k].1, path[(k + 1) % path.len()].1);
                cross(a - anchor.pose.position, b - anchor.pose.position)
            })
            .sum();
        if doubled < 0.0 { -1.0 } else { 1.0 }
    }

    fn after_step(&mut self, tracker: &Tracker) {
        if self.closure.is_some() {
            return;
        }
        let Some(before) = self.previous else { return };
        let now = Anchor::here(tracker);
        let side = self.follower.side();
        let crossed = self.anchors.iter().find_map(|anchor| crossing(anchor, &before, &now));
        self.closure = crossed.map(|(from, mut to)| {
            let turned = angle::wrap(to.pose.heading - from.pose.heading);
            to.heading = from.heading + turned + angle::TAU * self.sense(&from);
            Closure { from, to, side }
        });
    }
}

/// Whether the step from `before` to `now` closes a lap that began at `anchor`; with the place of
/// the crossing.
fn crossing(anchor: &Anchor, before: &Anchor, now: &Anchor) -> Option<(Anchor, Anchor)> {
    let lap = now.travelled - anchor.travelled;
    if lap < SHORTEST_LAP {
        return None;
    }
    let behind = anchor.pose.to_local(before.pose.position);
    let past = anchor.pose.to_local(now.pose.position);
    if behind.x >= 0.0 || past.x < 0.0 {
        return None;
    }
    let share = behind.x / (behind.x - past.x);
    let lateral = behind.y + (past.y - behind.y) * share;
    let heading = before.heading + angle::wrap(now.heading - before.heading) * share;
    let turned = angle::wrap(heading - anchor.heading);
    // Wide enough for the drift of a long lap; whether it is the same place the overlap decides.
    let near = lateral.abs() < (0.05 + 0.004 * lap).min(0.4);
    let whole = turned.abs() < (25.0 + 0.1 * lap).min(40.0).to_radians();
    (near && whole).then(|| {
        let to = Anchor {
            pose: Pose {
                position: before.pose.position + (now.pose.position - before.pose.position) * share,
                heading: angle::wrap(heading),
            },
            heading,
            travelled: before.travelled + (now.travelled - before.travelled) * share,
            time_us: now.time_us,
        };
        (*anchor, to)
    })
}
