//! Whether a crossing is the end of the lap: what is driven beyond it is laid on the beginning. It judges
//! crossings that were found; it refuses to know how, and where the robot goes.

use super::{Anchor, Circuit, Closure};
use crate::geometry::{Point, angle};
use crate::mapping::adjust::{Before, Led, Placed, Traverse, lead_on, lies_elsewhere, measure};
use crate::mapping::drift::Unwound;
use crate::mapping::lay::Overlap;
use crate::mapping::map::Alike;
use crate::mapping::odometry::Tracker;
use crate::mapping::wall::Sighting;
use std::borrow::Cow;

/// Rounds of one lap are alike in length to this share.
const ROUNDS_ALIKE: f64 = 0.03;
/// ... and at the same places, to this share of a round.
const SAME_ROUND: f64 = 0.1;
/// No lap has as many rounds.
const MOST_ROUNDS: f64 = 5.0;
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
/// A lap that ends turned by more than this is looked at without that drift, radians: least squares
/// takes small angles only.
const SMALL: f64 = 0.02;

/// A lap that may end this far from where it began for all that wheels and gyro know of it (one standard
/// deviation, metres) is no better known than one whose drift is free: walls with pillars look alike
/// every few metres.
const LOOSE: f64 = 0.5;

/// Where the drift was free, a crossing is another place when what is driven beyond it does not lie on the
/// beginning for so many metres: a slip of the wheels is over sooner.
const UNLIKE_FOR: f64 = 0.6;

/// An overlap that does not tell yet is looked at again after so much more of it, metres.
const ON: f64 = 0.2;
/// Where an overlap lies elsewhere as well, it is looked at again after so much more of it, metres.
const ALIKE: f64 = 1.0;

/// Candidates that take the robot to be farther apart on the beginning than this, metres, along the lap or straight
/// across, are of different places; what faces another way there than the robot does, radians, is not where it is.
const ANOTHER_PLACE: f64 = 0.9;
const SAME_WAY: f64 = 1.0;

/// A candidate that lies by more than this otherwise than it was held to lie, metres, was held in the wrong
/// notch of a ragged wall.
const SLID: f64 = 0.1;

/// How far the robot drives beyond the end of a `lap` (metres) that it found without a drift, metres.
fn free_overlap(lap: f64) -> f64 {
    (FREE_OVERLAP * lap).clamp(MOST_OVERLAP, MOST_FREE_OVERLAP)
}

/// A crossing that may be the end of the lap, until the overlap has told.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    /// With the drift still in it.
    pub(super) wound: (Anchor, Anchor),
    /// +1 for a lap run counter-clockwise.
    pub(super) sense: f64,
    pub(super) rate: f64,
    /// Seconds of motion since the lap began.
    pub(super) seconds: f64,
    /// What was looked at so far lies elsewhere on the beginning as well.
    pub(super) alike: bool,
    /// How many metres beyond it the robot was when what is driven there ceased to lie on the beginning.
    pub(super) unlike: Option<f64>,
    /// Metres to drive beyond it before it is looked at.
    pub(super) overlap: f64,
    /// Where what was looked at so far says that the robot was then.
    pub(super) looked: Option<Placed>,
    /// What was measured there, as soon as that said where it is; what follows has to lie on the
    /// beginning too.
    pub(super) held: Option<Box<Held>>,
}

impl Candidate {
    /// Whether it takes the robot to be elsewhere now than the `other` does, whatever of the beginning is nearest to
    /// that: one that has slid by a bay takes it to be beyond the end of a wall, where nothing was driven. Each was
    /// looked at when it was time, some metres ago for one.
    fn is_apart(&self, other: &Self, tracker: &Tracker) -> bool {
        let now = |one: &Self| one.looked.and_then(|at| at.on(tracker.path(), tracker.pose()));
        now(self).zip(now(other)).is_some_and(|(one, other)| (one - other).norm() > ANOTHER_PLACE)
    }

    /// What is driven does not lie on the beginning, `driven` metres beyond the crossing.
    fn lies_badly(&mut self, driven: f64) -> Verdict {
        let since = *self.unlike.get_or_insert(driven);
        self.overlap = driven + ON;
        if driven - since > UNLIKE_FOR { Verdict::Another } else { Verdict::More }
    }
}

/// A candidate that is sure of its place, but not yet that no other looks like it.
#[derive(Debug, Clone)]
pub(super) struct Held {
    closure: Closure,
    overlap: Overlap,
    /// How what was driven last lay on the beginning.
    led: Led,
}

/// A candidate's end laid on its beginning.
struct Laid {
    closure: Closure,
    overlap: Overlap,
    /// Where the robot was then.
    looked: Option<Placed>,
    /// Where it ends is anybody's guess but for the overlap: a drift was found only with it, or the lap
    /// was long.
    free: bool,
    /// The overlap lies elsewhere as well.
    alike: bool,
}

impl Laid {
    /// Whether the misclosure is known as well as it has to be.
    fn is_known(&self) -> bool {
        let (known, position) = if self.free {
            (self.overlap.alone, FREE_POSITION)
        } else {
            (self.overlap.sd, POSITION_ENOUGH)
        };
        known.0 < position && known.1 < HEADING_ENOUGH
    }
}

/// What looking at a candidate says.
pub(super) enum Verdict {
    Closed(Closure, Box<Overlap>),
    /// It only looked near.
    Another,
    More,
}

impl Circuit {
    /// Lays what was driven since the crossing on the beginning.
    pub(super) fn look_into(&mut self, index: usize, tracker: &Tracker) -> Verdict {
        let candidate = &self.candidates[index];
        let to = candidate.wound.1;
        let driven = tracker.travelled() - to.travelled;
        if driven <= candidate.overlap {
            return Verdict::More;
        }
        if candidate.held.is_some() {
            return self.look_on(index, driven, tracker);
        }
        let laid = self.laid(candidate, candidate.rate, tracker);
        let known = laid.is_known();
        let Laid { mut closure, mut overlap, mut looked, free, alike } = laid;
        let lap = closure.length();
        let most = if free { MOST_FREE_OVERLAP } else { MOST_OVERLAP };
        // Where walls repeat themselves, only their ends tell.
        let alike = alike && driven < lap;
        let all = driven > most.min(0.3 * lap) && !alike;
        let least = if free { FREE_AGREEMENT } else { AGREEMENT };
        let enough = known && !alike;
        if overlap.known < EVIDENCE && driven > NOTHING_KNOWN {
            return Verdict::Another;
        }
        if overlap.known < EVIDENCE && !all {
            // On a straight wall contacts are far between: nothing is known yet, either way.
            self.candidates[index].overlap = driven + ON;
            return Verdict::More;
        }
        if free && all && !enough {
            return Verdict::Another;
        }
        if overlap.agreement < least || (free && overlap.share < FREE_SHARE) {
            let candidate = &mut self.candidates[index];
            return if free { candidate.lies_badly(driven) } else { Verdict::Another };
        }
        self.candidates[index].unlike = None;
        let candidate = &self.candidates[index];
        let far = !free || driven > free_overlap(lap);
        if !(enough || all) {
            // A straight wall tells the heading long before a corner tells the place: what is driven meanwhile
            // would lie ever worse on the beginning with the drift as it was guessed.
            let is_told = free && overlap.sd.1 < HEADING_ENOUGH;
            let rate = self.without_heading(candidate, &overlap).filter(|_| is_told);
            let candidate = &mut self.candidates[index];
            candidate.alike |= alike;
            candidate.overlap = driven + if alike { ALIKE } else { ON };
            candidate.looked = looked;
            candidate.rate = rate.unwrap_or(candidate.rate);
            return Verdict::More;
        }
        if let Some(rate) = self.without_heading(candidate, &overlap) {
            Laid { closure, overlap, looked, .. } = self.laid(candidate, rate, tracker);
        }
        let led = Led::by(&overlap);
        overlap.misclosure = overlap.misclosure.with(&candidate.wound, &closure);
        if far || all {
            return Verdict::Closed(closure, Box::new(overlap));
        }
        let held = Held { closure, overlap, led };
        let candidate = &mut self.candidates[index];
        candidate.rate = closure.drift;
        candidate.overlap = driven + ON;
        candidate.looked = looked;
        candidate.held = Some(Box::new(held));
        Verdict::More
    }

    /// The drift with which the candidate's end, laid as `overlap` says, is not turned against its beginning;
    /// none where it hardly is. In the middle of a mapped room nobody takes a drift out of all that was driven.
    fn without_heading(&self, candidate: &Candidate, overlap: &Overlap) -> Option<f64> {
        let left = overlap.misclosure.heading;
        let is_turned = self.drifts.any() && left.abs() > SMALL && candidate.seconds > 0.0;
        is_turned.then(|| candidate.rate + left / candidate.seconds)
    }

    /// Whether what was driven since the candidate was sure of its place, piece by piece, lies on the
    /// beginning as well, `driven` metres beyond the crossing by now.
    fn look_on(&mut self, index: usize, driven: f64, tracker: &Tracker) -> Verdict {
        let candidate = &self.candidates[index];
        let Some(held) = &candidate.held else { return Verdict::More };
        let (closure, beyond) = (held.closure, (driven - AS_ONE).max(0.0));
        let (_, seen) = self.unwound(candidate.rate, tracker);
        let (overlap, led) = lead_on(&closure, &seen, beyond, held.led);
        let looked = Placed::last(&seen, led);
        drop(seen);
        let far = driven > free_overlap(closure.length());
        let candidate = &mut self.candidates[index];
        candidate.overlap = driven + ON;
        candidate.looked = looked;
        let Some(held) = &mut candidate.held else { return Verdict::More };
        if overlap.known >= EVIDENCE {
            if overlap.agreement < AGREEMENT_BEYOND || overlap.share < FREE_SHARE {
                return candidate.lies_badly(driven);
            }
            candidate.unlike = None;
            if led.is_off(held.led, SLID) {
                // It is measured anew from where it lies now.
                candidate.held = None;
                return Verdict::More;
            }
            held.led = led;
        }
        if far {
            return Verdict::Closed(held.closure, Box::new(held.overlap));
        }
        Verdict::More
    }

    /// Whether another candidate, with another drift, is as sure of another place than the one that would end
    /// the lap as `closure`: what is driven on tells which. Until then one that takes less drift out of the gyro
    /// and has not lain badly yet is worth waiting for.
    pub(super) fn is_contested(&self, index: usize, closure: &Closure, tracker: &Tracker) -> bool {
        let one = &self.candidates[index];
        let driven = tracker.travelled() - closure.to.travelled;
        let has_told = driven > MOST_FREE_OVERLAP;
        let other = self.apart_from(index, tracker, |other| {
            let (is_held, drifts_less) = (other.held.is_some(), other.rate.abs() < one.rate.abs());
            // A ring of bays that are all alike never tells: then the gyro is believed as far as may be.
            let may_be = drifts_less && other.unlike.is_none();
            if has_told { is_held && drifts_less } else { is_held || other.alike || may_be }
        });
        other.is_some()
    }

    /// Whether the candidate lies where it was not crossed, a bay on, and another that is as sure of the same place
    /// was crossed where it lies: the lap is as long as that one says. That is waited for as long as for what tells
    /// of two places.
    pub(super) fn is_found_better(
        &self,
        index: usize,
        closure: &Closure,
        tracker: &Tracker,
    ) -> bool {
        let one = (&self.candidates[index], self.lap_of(&self.candidates[index], tracker));
        let is_beside = |(one, lap): (&Candidate, f64)| {
            (lap - (one.wound.1.travelled - one.wound.0.travelled)).abs() > ANOTHER_PLACE
        };
        let is_better = |other: &Candidate| {
            other.held.is_some()
                && !is_beside((other, self.lap_of(other, tracker)))
                && !self.is_elsewhere(one, other, tracker)
        };
        let waits = tracker.travelled() - closure.to.travelled <= MOST_FREE_OVERLAP;
        waits && is_beside(one) && self.candidates.iter().any(is_better)
    }

    /// Where else the lap would end as well as by this candidate, for all that was driven beyond it.
    pub(super) fn ends_as_well(&self, index: usize, tracker: &Tracker) -> Option<Alike> {
        let other = self.apart_from(index, tracker, |other| other.held.is_some())?;
        let lap = |of: &Candidate| self.lap_of(of, tracker);
        Some(Alike { longer: lap(other) - lap(&self.candidates[index]), drift: other.rate })
    }

    /// One of the `wanted` candidates that is of another place than this one.
    fn apart_from(
        &self,
        index: usize,
        tracker: &Tracker,
        wanted: impl Fn(&Candidate) -> bool,
    ) -> Option<&Candidate> {
        let others = self.candidates.iter().enumerate().filter(|(k, _)| *k != index);
        let mut wanted = others.map(|(_, other)| other).filter(|other| wanted(other)).peekable();
        wanted.peek()?;
        let one = (&self.candidates[index], self.lap_of(&self.candidates[index], tracker));
        wanted.find(|other| self.is_elsewhere(one, other, tracker))
    }

    /// Whether the `other` candidate is of another place than this one, by where they take the robot to be or by how
    /// long the lap (this one's is `lap` metres) is then: each is blind where the other sees.
    fn is_elsewhere(
        &self,
        (one, lap): (&Candidate, f64),
        other: &Candidate,
        tracker: &Tracker,
    ) -> bool {
        one.is_apart(other, tracker) || (self.lap_of(other, tracker) - lap).abs() > ANOTHER_PLACE
    }

    /// How long the lap is, metres by odometer, if the robot is where the candidate takes it to be: the same for
    /// two that found one place at different crossings and with different drifts.
    fn lap_of(&self, candidate: &Candidate, tracker: &Tracker) -> f64 {
        let (from, to) = &candidate.wound;
        let by_crossing = to.travelled - from.travelled;
        let Some(looked) = candidate.looked else { return by_crossing };
        let trail = self.trail.iter().filter(|place| place.travelled < to.travelled);
        let unwound = (candidate.rate != 0.0).then(|| Unwound::new(tracker.path(), candidate.rate));
        let first = trail.map(|place| unwound.as_ref().map_or(*place, |by| place.unwound(by)));
        let there = looked.pose;
        let is_there =
            |place: &Anchor| angle::wrap(place.pose.heading - there.heading).abs() < SAME_WAY;
        let off = |place: &Anchor| (place.pose.position - there.position).norm();
        let nearest = first.filter(is_there).min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.map_or(by_crossing, |place| looked.travelled - place.travelled)
    }

    /// Where the last round of a lap began, when it closed on a later round only: on all of them the robot came by
    /// the same places, as its way is without the drift. Twice round a room behind a strait, after once round the
    /// room before that, is one lap of both.
    fn last_round(&self, from: &Anchor, to: &Anchor, unwound: Option<&Unwound>) -> f64 {
        let trail = unwound.map_or(Cow::Borrowed(&self.trail), |unwound| {
            Cow::Owned(self.trail.iter().map(|place| place.unwound(unwound)).collect())
        });
        let lap = to.travelled - from.travelled;
        let alike = |travelled: f64| {
            let round = to.travelled - travelled;
            // Round a post every place is near every other.
            let near = (0.25 + 0.004 * lap).min(SAME_ROUND * round);
            let rounds = lap / round.max(lap / MOST_ROUNDS);
            let count = rounds.round();
            let whole = (2.0..MOST_ROUNDS).contains(&count)
                && (rounds - count).abs() < ROUNDS_ALIKE * count;
            let is_as_before = |ago: f64| {
                let (now, then) = (to.travelled - ago * round, travelled - ago * round);
                let both = passed(&trail, now).zip(passed(&trail, then));
                both.is_some_and(|(a, b)| (a - b).norm() < near)
            };
            let fifths = 5 * (count as u32).saturating_sub(1);
            whole && (0..fifths).all(|fifth| is_as_before(f64::from(fifth) / 5.0))
        };
        let places = trail.iter().map(|place| place.travelled).filter(|at| alike(*at));
        places.fold(from.travelled, f64::max)
    }

    /// The lap without a drift of `rate`, its end laid on its beginning, and where the robot was then.
    fn laid(&self, candidate: &Candidate, rate: f64, tracker: &Tracker) -> Laid {
        let (unwound, seen) = self.unwound(rate, tracker);
        let (mut from, mut to) = candidate.wound;
        let mut path = tracker.path();
        if let Some(unwound) = &unwound {
            (from, to) = (from.unwound(unwound), to.unwound(unwound));
            path = unwound.path();
        }
        let turned = angle::wrap(to.pose.heading - from.pose.heading);
        to.heading = from.heading + turned + angle::TAU * candidate.sense;
        let last_round = self.last_round(&from, &to, unwound.as_ref());
        let side = self.follower.side();
        // Rounds of the whole lap, led astray by drift, look like those of a pocket meanwhile.
        let pocket = self.pocket.filter(|pocket| pocket.lies_within(last_round, to.travelled));
        let over = to.travelled;
        let closure =
            Closure { from, to, side, drift: rate, last_round, over, pocket, alike: None };
        let traverse = Traverse::between(path, tracker.resolution(), &closure);
        // Where any drift may be, what is driven on bends with it.
        let driven = tracker.travelled() - to.travelled;
        let free = candidate.rate != 0.0 || candidate.alike || traverse.looseness() > LOOSE;
        let beyond = if free { (driven - AS_ONE).max(0.0) } else { 0.0 };
        let led = candidate.looked.and_then(|looked| looked.led(&seen));
        let before = led.map(|led| Before { led, beyond });
        let overlap = measure(&closure, &seen, &traverse, before);
        let mut laid = Laid { closure, overlap, looked: None, free, alike: false };
        if candidate.alike || laid.is_known() {
            laid.alike = lies_elsewhere(&closure, &seen, &traverse, beyond, &mut laid.overlap);
        }
        laid.looked = Placed::last(&seen, Led::by(&laid.overlap));
        laid
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

/// Where the robot was on `trail` when it had travelled that far.
fn passed(trail: &[Anchor], travelled: f64) -> Option<Point> {
    let after = trail.partition_point(|place| place.travelled < travelled);
    let (late, early) = (trail.get(after)?, trail.get(after.checked_sub(1)?)?);
    let share = (travelled - early.travelled) / (late.travelled - early.travelled).max(1e-9);
    let (here, there) = (early.pose.position, late.pose.position);
    Some(here + (there - here) * share)
}
