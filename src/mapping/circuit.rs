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
mod closure;
mod crossing;

pub use closure::{Anchor, Closure, Pocket};

use super::adjust::{Led, Traverse, lead_on, measure};
use super::drift::{Drifts, Unwound};
use super::event::Failure;
use super::follow::{Ask, AtRest, Follower, Side};
use super::lay::Overlap;
use super::odometry::Tracker;
use super::wall::{Sighting, Wall};
use crate::geometry::{Point, Pose, Ring, angle, cross};
use crate::robot::Chassis;
use crossing::{Crossing, best};
use std::borrow::Cow;

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
/// Rounds of one lap are alike in length to this share.
const ROUNDS_ALIKE: f64 = 0.03;
/// ... and at the same places, to this share of a round.
const SAME_ROUND: f64 = 0.1;
/// No lap has as many rounds.
const MOST_ROUNDS: f64 = 5.0;
/// On shorter laps no drift of the gyro leads astray, metres.
const DRIFTING: f64 = 20.0;
/// Share of the overlap that must lie on the walls seen first; more when the gyro's drift was free.
const AGREEMENT: f64 = 0.55;
const FREE_AGREEMENT: f64 = 0.85;
const FREE_SHARE: f64 = 0.6;
/// Contacts of the overlap that must have something to lie on before that is judged.
const EVIDENCE: usize = 4;
/// ... and where there are none after so many metres, it is another place.
const NOTHING_KNOWN: f64 = 5.0;
/// The overlap is driven on until the misclosure is known to this (metres, radians), ...
const POSITION_ENOUGH: f64 = 0.005;
const HEADING_ENOUGH: f64 = 0.003;
/// ... but not further than this, metres; further when the gyro's drift was free, since then only
/// corners tell the place from others like it, known to this.
const MOST_OVERLAP: f64 = 4.0;
const MOST_FREE_OVERLAP: f64 = 25.0;
/// ... and this share of the lap has to be driven again: mazes look alike for long. Meanwhile the gyro
/// drifts on, so that no more than this of it, metres, is laid on the beginning as one.
const FREE_OVERLAP: f64 = 0.1;
const AS_ONE: f64 = 4.0;
const AGREEMENT_BEYOND: f64 = 0.8;
const FREE_POSITION: f64 = 0.02;
/// Crossings that are looked into at the same time, and headings nearer to each other than this are
/// of one.
const MOST_CANDIDATES: usize = 6;
const ANOTHER: f64 = 0.05;
/// A lap that ends turned by more than this is looked at without that drift, radians: least squares
/// takes small angles only.
const SMALL: f64 = 0.02;

/// How far the robot drives beyond the end of a `lap` (metres) that it found without a drift, metres.
fn free_overlap(lap: f64) -> f64 {
    (FREE_OVERLAP * lap).clamp(MOST_OVERLAP, MOST_FREE_OVERLAP)
}

/// A crossing that may be the end of the lap, until the overlap has told.
#[derive(Debug, Clone)]
struct Candidate {
    /// With the drift still in it.
    wound: (Anchor, Anchor),
    /// +1 for a lap run counter-clockwise.
    sense: f64,
    rate: f64,
    /// Seconds of motion since the lap began.
    seconds: f64,
    /// Metres to drive beyond it before it is looked at.
    overlap: f64,
    /// What was measured there, as soon as that said where it is; what follows has to lie on the
    /// beginning too.
    held: Option<Box<Held>>,
}

/// A candidate that is sure of its place, but not yet that no other looks like it.
#[derive(Debug, Clone)]
struct Held {
    closure: Closure,
    overlap: Overlap,
    /// How what was driven last lay on the beginning.
    led: Led,
}

/// What looking at a candidate says.
enum Verdict {
    Closed(Closure, Box<Overlap>),
    /// It only looked near.
    Another,
    More,
}

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
    /// The rounds that were driven in vain before that.
    pocket: Option<Pocket>,
    /// It goes round something else than it began with, in the same room as here, or in a pocket of it.
    led_from: Option<Point>,
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
            pocket: None,
            led_from: None,
        }
    }

    /// The same for a robot of whose gyro nothing is known yet.
    #[must_use]
    pub fn with_any_drift(self) -> Self {
        Self { drifts: Drifts::new(true), ..self }
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

    /// The robot came to rest: what next?
    pub fn next(&mut self, tracker: &Tracker, rest: &AtRest) -> Leg {
        self.drifts.follow(tracker.pose(), tracker.active());
        if self.follower.is_stepping() {
            self.after_step(tracker);
        }
        for index in (0..self.candidates.len()).rev() {
            match self.look_into(index, tracker) {
                Verdict::Closed(closure, _) if self.is_pocket(&closure) => {
                    self.passed.push(self.candidates.remove(index).wound.1);
                }
                Verdict::Closed(closure, overlap) => return Leg::Closed(closure, overlap),
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
            held: None,
        });
    }

    /// Lays what was driven since the crossing on the beginning.
    fn look_into(&mut self, index: usize, tracker: &Tracker) -> Verdict {
        let candidate = &self.candidates[index];
        let to = candidate.wound.1;
        let driven = tracker.travelled() - to.travelled;
        if driven <= candidate.overlap {
            return Verdict::More;
        }
        let free = candidate.rate != 0.0;
        if candidate.held.is_some() {
            return self.look_on(index, driven, tracker);
        }
        let (mut closure, mut overlap) = self.laid(candidate, candidate.rate, tracker);
        let lap = closure.length();
        let most = if free { MOST_FREE_OVERLAP } else { MOST_OVERLAP };
        let all = driven > most.min(0.3 * lap);
        let (least, position) =
            if free { (FREE_AGREEMENT, FREE_POSITION) } else { (AGREEMENT, POSITION_ENOUGH) };
        let known = if free { overlap.alone } else { overlap.sd };
        let enough = known.0 < position && known.1 < HEADING_ENOUGH;
        if overlap.known < EVIDENCE && driven > NOTHING_KNOWN {
            return Verdict::Another;
        }
        if overlap.known < EVIDENCE && !all {
            // On a straight wall contacts are far between: nothing is known yet, either way.
            self.candidates[index].overlap = driven + 0.2;
            return Verdict::More;
        }
        let unlike = free && (overlap.share < FREE_SHARE || (all && !enough));
        if overlap.agreement < least || unlike {
            return Verdict::Another;
        }
        let far = !free || driven > free_overlap(lap);
        if !(enough || all) {
            self.candidates[index].overlap = driven + 0.2;
            return Verdict::More;
        }
        let left = overlap.misclosure.heading;
        if left.abs() > SMALL && candidate.seconds > 0.0 {
            let rate = candidate.rate + left / candidate.seconds;
            (closure, overlap) = self.laid(candidate, rate, tracker);
        }
        let led = Led::by(&closure, &overlap);
        overlap.misclosure = overlap.misclosure.with(&candidate.wound, &closure);
        if far || all {
            return Verdict::Closed(closure, Box::new(overlap));
        }
        let held = Held { closure, overlap, led };
        let candidate = &mut self.candidates[index];
        candidate.rate = closure.drift;
        candidate.overlap = driven + 0.2;
        candidate.held = Some(Box::new(held));
        Verdict::More
    }

    /// Whether what was driven since the candidate was sure of its place, piece by piece, lies on the
    /// beginning as well, `driven` metres beyond the crossing by now.
    fn look_on(&mut self, index: usize, driven: f64, tracker: &Tracker) -> Verdict {
        let candidate = &self.candidates[index];
        let Some(held) = &candidate.held else { return Verdict::More };
        let (closure, beyond) = (held.closure, (driven - AS_ONE).max(0.0));
        let (overlap, led) =
            lead_on(&closure, &self.unwound(candidate.rate, tracker).1, beyond, held.led);
        let far = driven > free_overlap(closure.length());
        let candidate = &mut self.candidates[index];
        candidate.overlap = driven + 0.2;
        let Some(held) = &mut candidate.held else { return Verdict::More };
        if overlap.known >= EVIDENCE {
            if overlap.agreement < AGREEMENT_BEYOND || overlap.share < FREE_SHARE {
                return Verdict::Another;
            }
            held.led = led;
        }
        if far {
            return Verdict::Closed(held.closure, Box::new(held.overlap));
        }
        Verdict::More
    }

    /// Where the last round of a lap began, when it closed on a later round only: all along that and
    /// the round before, the robot came by the same places.
    fn last_round(&self, from: &Anchor, to: &Anchor) -> f64 {
        let lap = to.travelled - from.travelled;
        let alike = |travelled: f64| {
            let round = to.travelled - travelled;
            // Round a post every place is near every other.
            let near = (0.25 + 0.004 * lap).min(SAME_ROUND * round);
            let rounds = lap / round.max(lap / MOST_ROUNDS);
            let count = rounds.round();
            let whole = (2.0..MOST_ROUNDS).contains(&count)
                && (rounds - count).abs() < ROUNDS_ALIKE * count;
            whole
                && [0.0, 0.2, 0.4, 0.6, 0.8].iter().all(|share| {
                    let (now, then) = (to.travelled - share * round, travelled - share * round);
                    self.place(now)
                        .zip(self.place(then))
                        .is_some_and(|(a, b)| (a - b).norm() < near)
                })
        };
        let places = self.trail.iter().map(|place| place.travelled).filter(|at| alike(*at));
        places.fold(from.travelled, f64::max)
    }

    /// Where the robot was when it had travelled that far.
    fn place(&self, travelled: f64) -> Option<Point> {
        let after = self.trail.partition_point(|place| place.travelled < travelled);
        let (late, early) = (self.trail.get(after)?, self.trail.get(after.checked_sub(1)?)?);
        let share = (travelled - early.travelled) / (late.travelled - early.travelled).max(1e-9);
        let (here, there) = (early.pose.position, late.pose.position);
        Some(here + (there - here) * share)
    }

    /// The lap without a drift of `rate`, and its end laid on its beginning.
    fn laid(&self, candidate: &Candidate, rate: f64, tracker: &Tracker) -> (Closure, Overlap) {
        let (unwound, seen) = self.unwound(rate, tracker);
        let (mut from, mut to) = candidate.wound;
        let mut path = tracker.path();
        if let Some(unwound) = &unwound {
            (from, to) = (from.unwound(unwound), to.unwound(unwound));
            path = unwound.path();
        }
        let turned = angle::wrap(to.pose.heading - from.pose.heading);
        to.heading = from.heading + turned + angle::TAU * candidate.sense;
        let last_round = self.last_round(&from, &to);
        let side = self.follower.side();
        let pocket = self.pocket;
        let closure = Closure { from, to, side, drift: rate, last_round, pocket };
        let traverse = Traverse::between(path, tracker.resolution(), &closure);
        let overlap = measure(&closure, &seen, &traverse);
        (closure, overlap)
    }

    /// The way of the robot, if there is any drift of `rate` to take out of it, and what it saw without
    /// that.
    fn unwound(&self, rate: f64, tracker: &Tracker) -> (Option<Unwound>, Cow<'_, [Sighting]>) {
        let unwound = (rate != 0.0).then(|| Unwound::new(tracker.path(), rate));
        let log = self.wall.log();
        let seen = unwound.as_ref().map_or(Cow::Borrowed(log), |unwound| {
            log.iter().map(|seen| seen.unwound(unwound)).collect()
        });
        (unwound, seen)
    }
}
