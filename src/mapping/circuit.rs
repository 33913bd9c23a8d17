//! One lap round something: follow the wall until back where it was first met (paper III.C).
//!
//! Closing takes two things at once: the robot crosses a line through a place it passed at the
//! beginning, near that place, and it faces the same way there. On a long lap the gyro's drift leads
//! far away from that; the lap is then looked at without each drift that the gyro may have, and what
//! is driven after the crossing has to lie on the beginning, corners and all. The sense of the one
//! whole turn that a closed lap makes (Hopf's theorem on turning tangents) is read from the area
//! that the driven path encloses rather than from the turns themselves: in narrow pockets the robot
//! turns about on the spot, and which way round it did so says nothing of the wall. That sense tells
//! inside from outside.

mod astray;
mod candidate;
mod closure;
mod crossing;
mod led_off;
mod way_out;

pub use closure::{Anchor, Closure, Pocket};

use super::drift::Drifts;
use super::event::Failure;
use super::follow::{Ask, AtRest, Follower, Side};
use super::lay::Overlap;
use super::odometry::Tracker;
use super::wall::Wall;
use crate::geometry::{Point, Pose, Ring, angle, cross};
use crate::robot::Chassis;
use candidate::{Candidate, Verdict};
use crossing::{Crossing, best};
use way_out::WayOut;

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
/// A lap round the outside of something encloses at least this share of the body's area, since the body
/// itself goes all round it, ...
const ROUND_SOMETHING: f64 = 0.8;
/// ... and one along the inside at least this, square metres.
const WITHIN: f64 = 0.004;
/// A round from a later place is at least this share of all that was driven since the beginning.
const ROUND_AT_LEAST: f64 = 0.3;
/// On shorter laps no drift of the gyro leads astray, metres.
const DRIFTING: f64 = 20.0;
/// Crossings that are looked into at the same time, and headings nearer to each other than this are
/// of one.
const MOST_CANDIDATES: usize = 6;
const ANOTHER: f64 = 0.05;
/// A lap under way.
#[derive(Debug, Clone)]
pub struct Circuit {
    /// Contacts of this lap.
    pub wall: Wall,
    follower: Follower,
    anchors: Vec<Anchor>,
    previous: Option<Anchor>,
    /// Places where it looked closed and was not known to be: it may close on one of these as well.
    passed: Vec<Anchor>,
    drifts: Drifts,
    candidates: Vec<Candidate>,
    overlap: f64,
    trail: Vec<Anchor>,
    /// Odometer when the robot began to squeeze through gaps that it would not enter, to get out again.
    squeezing: Option<f64>,
    /// When it last began to, whether it has got out since or not.
    squeezed: Option<f64>,
    /// The rounds that were driven in vain before that.
    pocket: Option<Pocket>,
    /// Out of the pocket by the way that led into it, and how often that was done.
    leaving: Option<WayOut>,
    left: u32,
    /// Odometer when the gap was closed to it that had led it off to a thing, metres.
    parted: Option<f64>,
    /// How wide that gap is, metres, until it is told.
    untold_gap: Option<f64>,
    /// The narrowest gap it is sent through, metres.
    passable: f64,
    /// It goes round something else than it began with, in the same room as here, or in a pocket of it.
    led_from: Option<Point>,
    /// How often the lap began anew.
    begun_anew: u32,
    /// A place in the room; none when that is where the run began.
    within: Option<Point>,
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
            passed: Vec::new(),
            drifts: Drifts::new(false),
            candidates: Vec::new(),
            overlap,
            trail: Vec::new(),
            squeezing: None,
            squeezed: None,
            pocket: None,
            leaving: None,
            left: 0,
            parted: None,
            untold_gap: None,
            passable: chassis.passable_gap(),
            led_from: None,
            begun_anew: 0,
            within: None,
        }
    }

    /// The same for a robot of whose gyro nothing is known yet.
    #[must_use]
    pub fn with_any_drift(self) -> Self {
        Self { drifts: Drifts::new(true), ..self }
    }

    /// The same in the room that holds this place; none for the one that the run began in.
    #[must_use]
    pub fn within(self, within: Option<Point>) -> Self {
        Self { within, ..self }
    }

    /// The same where what is gone round is likely to be a room: see [`Follower::along_walls`].
    #[must_use]
    pub fn along_walls(self) -> Self {
        Self { follower: self.follower.along_walls(), ..self }
    }

    /// The same where `known` things stand: a gap beside one of them is gone through as long as the body
    /// fits, or the robot would go round that thing instead of what it follows.
    #[must_use]
    pub fn beside(mut self, known: Vec<Ring>) -> Self {
        self.follower.beside(known);
        self
    }

    /// On which hand what is gone round is kept.
    #[must_use]
    pub fn side(&self) -> Side {
        self.follower.side()
    }

    /// Where the lap is judged from, once it has begun.
    #[must_use]
    pub fn first_anchor(&self) -> Option<&Anchor> {
        self.anchors.first()
    }

    /// Whether the lap looks closed, and the overlap is being driven.
    #[must_use]
    pub fn looks_closed(&self) -> bool {
        !self.candidates.is_empty()
    }

    /// The width of a gap, metres, that was closed to the robot since this was asked last.
    pub fn closed_gap(&mut self) -> Option<f64> {
        self.untold_gap.take()
    }

    /// The robot came to rest: what next?
    pub fn next(&mut self, tracker: &Tracker, rest: &AtRest) -> Leg {
        self.drifts.follow(tracker.pose(), tracker.active());
        if let Some(ask) = self.leave(tracker, rest) {
            return Leg::Go(ask);
        }
        if self.follower.is_stepping() {
            self.after_step(tracker);
        }
        for index in (0..self.candidates.len()).rev() {
            match self.look_into(index, tracker) {
                Verdict::Closed(closure, _) if self.is_pocket(&closure) => {
                    self.passed.push(self.candidates.remove(index).wound.1);
                }
                Verdict::Closed(closure, _) if self.is_contested(index, &closure, tracker) => {}
                Verdict::Closed(closure, _) if self.is_found_better(index, &closure, tracker) => {}
                Verdict::Closed(mut closure, overlap) => {
                    closure.alike = self.ends_as_well(index, tracker);
                    return Leg::Closed(closure, overlap);
                }
                Verdict::Another => self.passed.push(self.candidates.remove(index).wound.1),
                Verdict::More => {}
            }
        }
        if self.follower.is_stuck() {
            return Leg::Failed(Failure::Boxed);
        }
        if self.is_endless(tracker) {
            return Leg::Failed(Failure::LapEndless);
        }
        if let Some(ask) = self.leave(tracker, rest) {
            return Leg::Go(ask);
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
        if young && self.candidates.is_empty() {
            self.anchors.push(here);
        }
        self.trail.push(here);
        self.previous = Some(here);
    }

    /// What the path since `anchor` encloses, square metres; positive when it runs counter-clockwise.
    fn enclosed(&self, anchor: &Anchor) -> f64 {
        let since = self.trail.partition_point(|place| place.travelled < anchor.travelled);
        let path: Vec<&Anchor> = self.trail[since..]
            .iter()
            .filter(|place| !self.pocket.is_some_and(|pocket| pocket.holds(place.travelled)))
            .collect();
        let doubled: f64 = (0..path.len())
            .map(|k| {
                let (a, b) = (path[k].pose.position, path[(k + 1) % path.len()].pose.position);
                let origin = anchor.pose.position;
                cross(a - origin, b - origin)
            })
            .sum();
        doubled / 2.0
    }

    /// Whether a path that encloses so much went round something: to and fro in one place, turning
    /// all the way each time, looks like a lap too.
    fn went_round(&self, enclosed: f64) -> bool {
        let outside = enclosed * self.side().sign() > 0.0;
        let body = self.follower.body();
        let least = if outside { ROUND_SOMETHING * angle::PI * body * body } else { WITHIN };
        enclosed.abs() > least
    }

    fn after_step(&mut self, tracker: &Tracker) {
        let Some(before) = self.previous else { return };
        let now = Anchor::here(tracker);
        let Some(first) = self.anchors.first() else { return };
        let lap = now.travelled - first.travelled;
        if lap < SHORTEST_LAP || self.candidates.len() >= MOST_CANDIDATES {
            return;
        }
        let all = self.drifts.all();
        // A round from a place where it only looked closed is not much shorter than from the beginning.
        let round = |place: &&Anchor| {
            now.travelled - place.travelled > ROUND_AT_LEAST * (now.travelled - first.travelled)
        };
        let passed: Vec<Anchor> = self.passed.iter().filter(round).copied().collect();
        let found = best(&passed, all.iter().filter(|one| one.rate == 0.0), now.travelled)
            .or_else(|| {
                best(&self.anchors, all.iter().filter(|one| one.rate == 0.0), now.travelled)
            })
            .or_else(|| {
                let free = all.iter().filter(|one| lap > DRIFTING && one.rate != 0.0);
                best(&self.anchors, free, now.travelled)
            });
        let Some(Crossing { from, rate, share, .. }) = found else { return };
        let seconds = tracker.active() - self.drifts.begun();
        if self.candidates.iter().any(|c| ((c.rate - rate) * seconds).abs() < ANOTHER) {
            return;
        }
        let moved = now.pose.position - before.pose.position;
        let heading = before.heading + angle::wrap(now.heading - before.heading) * share;
        let to = Anchor {
            pose: Pose {
                position: before.pose.position + moved * share,
                heading: angle::wrap(heading),
            },
            heading,
            travelled: before.travelled + (now.travelled - before.travelled) * share,
            time_us: now.time_us,
        };
        let enclosed = self.enclosed(&from);
        if !self.went_round(enclosed) {
            return;
        }
        let (wound, sense) = ((from, to), enclosed.signum());
        self.candidates.push(Candidate {
            wound,
            sense,
            rate,
            seconds,
            overlap: self.overlap,
            looked: None,
            held: None,
            alike: false,
            unlike: None,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn to_and_fro_in_one_place_goes_round_nothing() {
        let chassis = Chassis::default();
        let circuit = Circuit::new(&chassis, Side::Left, Wall::new(&chassis), 1.0);
        // Round a post of 2 cm radius, with the wall on the left: counter-clockwise.
        let round_a_post = angle::PI * 0.165 * 0.165;
        assert!(circuit.went_round(round_a_post));
        assert!(!circuit.went_round(0.05 * 0.06));
        // Along the inside of a corridor there and back, kept off both of its walls.
        assert!(circuit.went_round(-0.05 * 1.0));
        assert!(!circuit.went_round(-0.01 * 0.06));
    }
}
