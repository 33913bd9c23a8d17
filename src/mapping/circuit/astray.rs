//! Laps that go round and round without coming to an end. The robot came through a gap that is just
//! too narrow to be found again from the other side: it is in a pocket of which it knows no way out,
//! or goes round a thing that it took for wall. The lap would never close as it began.

use super::way_out::WayOut;
use super::{Anchor, Circuit, Closure, Pocket, led_off};
use crate::geometry::{Point, Ring, angle};
use crate::mapping::follow::{Ask, AtRest, Side};
use crate::mapping::odometry::Tracker;

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
/// Rounds away from the beginning after which the robot is in a pocket, and lost in it.
const ASTRAY: usize = 2;
const LOST: usize = 5;
/// Rounds after which it is lost although they come near the beginning.
const IN_VAIN: usize = 8;
/// Rounds about the outside of something, away from the beginning, after which the robot has left what it
/// followed: a room is gone round on its inside.
const ROUND_A_THING: usize = 2;
/// What led it off is a gap that it passes or not, as it comes there: no wider than the passable one by more than
/// this, metres.
const LED_OFF: f64 = 0.08;
/// Closed to it, that gap has led it back after so many rounds more, or does not.
const LED_BACK: f64 = 1.5;
/// Rounds that run like the round before, after which it is lost as well: a lap that was not known again
/// on its first round may still close on its second.
const ALIKE: usize = 2;
/// By what share rounds that are alike may differ in length.
const STRETCHED: f64 = 0.04;
/// Rounds in one pocket are no more than so many times as long as each other.
const AS_LONG: f64 = 1.5;
/// A lap begins anew no more often: where it began may be another place that it will leave.
const MOST_BEGINNINGS: u32 = 3;
/// Squeezing has not led out of it when the robot is still there after so many metres; by the way it came it
/// leaves no more often than this.
const SQUEEZED: f64 = 2.0;
const MOST_LEFT: u32 = 3;
/// It leaves where the way out is no longer than this, metres, and anywhere once it has waited for that so many
/// rounds longer.
const AT_MOUTH: f64 = 1.0;
const WAITED: usize = 2;
/// The rounds in a pocket are no longer than this, metres; away from the beginning of the lap, to which drift
/// leads back rounds of no such length, this.
const SHORT_ROUND: f64 = 2.5;
const LONG_ROUND: f64 = 8.0;
/// It is out again when it has come to a new place after as many metres.
const OUT: f64 = 0.5;
/// A lap longer than this will not close any more, metres.
const LONGEST_LAP: f64 = 2000.0;

impl Circuit {
    /// Whether the lap will not close any more. In a pocket, away from its beginning, the robot first
    /// tries to get out by squeezing through what it would not have entered; off a thing that it was led to, it
    /// is led back first.
    pub(super) fn is_endless(&mut self, tracker: &Tracker) -> bool {
        let (Some(now), Some(first)) = (self.previous, self.anchors.first().copied()) else {
            return false;
        };
        let away = |place: &Anchor| (place.pose.position - first.pose.position).norm() > BEGINNING;
        let (astray, earliest) = visits(&self.trail, away);
        let (rounds, first_time) = visits(&self.trail, |_| true);
        let round_a_thing = goes_round(&self.trail, self.follower.side(), away);
        let lost = astray >= LOST
            || rounds >= IN_VAIN
            || round_a_thing >= ROUND_A_THING
            || alike(&self.trail) >= ALIKE;
        if lost && self.is_led_back() {
            return false;
        }
        let out = |since: f64| astray == 0 && now.travelled - since > OUT;
        if self.squeezing.is_some_and(out) {
            self.squeezing = None;
            self.follower.squeeze(false);
        } else if self.squeezing.is_none() && astray >= ASTRAY {
            self.squeezing = Some(now.travelled);
            self.squeezed = self.squeezing;
            // Side by side in a maze the robot may have been in one corridor after the other, and not in any again.
            if are_as_long(&visited(&self.trail, away)) {
                // Later rounds of those that it had squeezed on before hold on to where the robot is by now: what it
                // came by on the first of them before that was seen once only.
                let before = self.pocket.filter(|rounds| self.left > 0 || !rounds.holds(earliest));
                self.pocket = Some(Pocket::after(before, earliest, now.travelled));
            }
            self.follower.squeeze(true);
        }
        if round_a_thing == 0 && self.left < MOST_LEFT {
            let since = self.in_pocket(now.travelled, (astray, earliest), (rounds, first_time));
            let seen = self.wall.log().iter();
            if let Some((since, way)) =
                since.and_then(|at| Some((at, WayOut::of(&self.trail, at, seen)?)))
            {
                // It leaves where it came in: from anywhere else the way back may lead through what is as narrow.
                let is_there = since - way.entered < AT_MOUTH || rounds.max(astray) > LOST + WAITED;
                self.leaving = is_there.then_some(way);
                return false;
            }
        }
        let too_long = now.travelled - first.travelled > LONGEST_LAP;
        if lost && self.begun_anew < MOST_BEGINNINGS {
            let begun = tracker.path().first().map_or(first.pose, |point| point.pose);
            self.begin_anew(self.within.unwrap_or(begun.position));
            return false;
        }
        lost || too_long
    }

    /// Whether a robot that goes round a thing is on its way back to what it followed: it is when the gap that led
    /// it off to that is closed to it from here on, or was within the last round.
    fn is_led_back(&mut self) -> bool {
        if goes_round(&self.trail, self.follower.side(), |_| true) < ROUND_A_THING {
            return false;
        }
        let visits: Vec<f64> =
            visited(&self.trail, |_| true).iter().map(|here| here.travelled).collect();
        let &[now, round, .., came] = visits.as_slice() else { return false };
        if let Some(closed) = self.parted.filter(|closed| *closed > came) {
            return now - closed < LED_BACK * (now - round);
        }
        // What it squeezed through meanwhile, to get out of a pocket, is more than this gap.
        if self.squeezed.is_some_and(|squeezed| squeezed > came) {
            return false;
        }
        let seen = self.wall.log().iter();
        let gap = led_off::gap(&self.trail, (came, round), seen, self.passable + LED_OFF);
        let Some((thing, other)) = gap else { return false };
        self.parted = Some(now);
        self.pocket = Some(Pocket::after(self.pocket, came, now));
        self.follower.close(thing, other);
        self.untold_gap = Some((other - thing).norm());
        true
    }

    /// Since which reading of the odometer, metres, a robot that has `travelled` so far goes round and round in a
    /// pocket that only its own way leads out of; none when it does not. It was here so many times, and when first:
    /// away from the beginning of the lap, and in `all`.
    fn in_pocket(&self, travelled: f64, away: (usize, f64), all: (usize, f64)) -> Option<f64> {
        let round =
            |(rounds, first): (usize, f64)| (travelled - first) / f64::from(rounds.max(1) as u32);
        // Longer rounds are of the whole lap, led astray by drift.
        let (here, off) = (round(all), round(away));
        let in_vain = |since: f64| travelled - since > SQUEEZED.max(off);
        let is_lost = away.0 >= LOST || (away.0 > 0 && self.squeezing.is_some_and(in_vain));
        // Near its beginning a lap may close; but not one that goes round and round a few metres.
        let whirls = all.0 >= LOST && here < SHORT_ROUND;
        whirls.then_some(all.1).or_else(|| (is_lost && off < LONG_ROUND).then_some(away.1))
    }

    /// The next motion out of a pocket by the way that led into it; none when it is not on that. Back before the
    /// gap it follows on, past that.
    pub(super) fn leave(&mut self, tracker: &Tracker, rest: &AtRest) -> Option<Ask> {
        let leaving = self.leaving.as_mut()?;
        if let Some(ask) = leaving.next(rest) {
            return Some(ask);
        }
        let way = self.leaving.take()?;
        self.left += 1;
        self.pocket = Some(Pocket::after(self.pocket, way.entered, tracker.travelled()));
        self.squeezing = None;
        self.follower.squeeze(false);
        self.follower.resume(way.closes(rest));
        // What lies between is no step along the wall.
        self.previous = None;
        None
    }

    /// The robot left what it followed and goes round something else, of which there is no way back: from
    /// here on the lap is one round that.
    fn begin_anew(&mut self, led_from: Point) {
        self.led_from.get_or_insert(led_from);
        self.begun_anew += 1;
        self.anchors.clear();
        self.passed.clear();
        self.candidates.clear();
        self.trail.clear();
        self.drifts.begin_anew();
        self.previous = None;
        self.parted = None;
        self.squeezed = None;
        self.pocket = None;
        self.squeezing = None;
        self.follower.squeeze(false);
    }

    /// Whether a lap that began anew closed round the inside of a pocket, which the robot came into from
    /// outside, and neither round a thing nor round the room that it was in before.
    pub(super) fn is_pocket(&self, closure: &Closure) -> bool {
        let Some(led_from) = self.led_from.filter(|_| !closure.is_extrinsic()) else {
            return false;
        };
        let way = self.trail.iter().filter(|place| place.travelled >= closure.from.travelled);
        let way: Vec<Point> = way.map(|place| place.pose.position).collect();
        !Ring::polygon(&way).contains(led_from)
    }
}

/// How often the robot was where it is now, facing the same way, since it last was at a place that
/// does not `count`, and the odometer at the first of those times, metres.
fn visits(trail: &[Anchor], count: impl Fn(&Anchor) -> bool) -> (usize, f64) {
    let visits = visited(trail, count);
    (visits.len().saturating_sub(1), visits.last().map_or(0.0, |first| first.travelled))
}

/// Where the robot is now and, going back, each time that it was there, facing the same way, since it
/// last was at a place that does not `count`.
fn visited(trail: &[Anchor], count: impl Fn(&Anchor) -> bool) -> Vec<&Anchor> {
    let Some((now, before)) = trail.split_last() else { return Vec::new() };
    let mut visits = vec![now];
    for place in before.iter().rev().take_while(|place| count(place)) {
        let last = visits.last().map_or(0.0, |visit| visit.travelled);
        if last - place.travelled > SHORTEST_ROUND && is_near(place, now) {
            visits.push(place);
        }
    }
    visits
}

/// Whether rounds that led from one of the `visits` to the next are about as long as each other.
fn are_as_long(visits: &[&Anchor]) -> bool {
    let rounds = visits.windows(2).map(|two| two[0].travelled - two[1].travelled);
    let (least, most) = rounds.fold((f64::INFINITY, 0.0), |(least, most), round| {
        (f64::min(least, round), f64::max(most, round))
    });
    most < AS_LONG * least
}

/// How many of the last rounds went about the outside of something, on the robot's `side`.
fn goes_round(trail: &[Anchor], side: Side, count: impl Fn(&Anchor) -> bool) -> usize {
    let about =
        |round: &&[&Anchor]| (round[0].heading - round[1].heading) * side.sign() > angle::FRAC_PI_2;
    visited(trail, count).windows(2).take_while(about).count()
}

/// How many of the rounds that led back to where the robot is now ran all along as the round before them.
fn alike(trail: &[Anchor]) -> usize {
    let at = |travelled: f64| trail.get(trail.partition_point(|p| p.travelled < travelled));
    let as_before = |round: &&[&Anchor]| {
        let [now, then, before] = [0, 1, 2].map(|k: usize| round[k].travelled);
        let (late, early) = (now - then, then - before);
        let same_way = |share: f64| {
            let (now, then) = (at(now - share * late), at(then - share * early));
            now.zip(then).is_some_and(|(now, then)| is_near(then, now))
        };
        (late - early).abs() < STRETCHED * early && (1..10).all(|k| same_way(f64::from(k) * 0.1))
    };
    visited(trail, |_| true).windows(3).take_while(as_before).count()
}

/// Whether the robot was at `then`, some way ago, where it is `now`, facing the same way.
fn is_near(then: &Anchor, now: &Anchor) -> bool {
    let near = (NEAR + DRIFT * (now.travelled - then.travelled)).min(FARTHEST);
    (then.pose.position - now.pose.position).norm() < near
        && angle::wrap(then.pose.heading - now.pose.heading).abs() < FACING
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::mapping::wall::Wall;
    use crate::robot::Chassis;

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
    fn each_round_counts_that_comes_by_no_other_place() {
        for (rounds, times) in [(0.9, 0), (1.1, 1), (3.2, 3)] {
            assert_eq!(visits(&circling(rounds, 0.0), |_| true).0, times);
        }
        let left = |place: &Anchor| place.pose.position.x < 0.9;
        assert_eq!(visits(&circling(3.2, 0.0), left).0, 0);
    }

    #[test]
    fn places_that_only_look_the_same_are_no_rounds_of_one_pocket() {
        let trail = circling(3.2, 0.0);
        assert!(are_as_long(&visited(&trail, |_| true)));
        let at = |k: usize| &trail[k];
        assert!(!are_as_long(&[at(200), at(140), at(40)]), "6 m and 10 m");
        assert!(are_as_long(&[at(200), at(140), at(60)]), "6 m and 8 m");
    }

    #[test]
    fn rounds_about_a_thing_are_told_from_rounds_of_its_inside() {
        // Counter-clockwise: with the wall on the left, about the outside of what is there.
        let trail = circling(3.2, 0.0);
        assert_eq!(goes_round(&trail, Side::Left, |_| true), 3);
        assert_eq!(goes_round(&trail, Side::Right, |_| true), 0);
    }

    #[test]
    fn a_round_is_like_the_one_before_only_when_it_runs_the_same_way_throughout() {
        let mut trail = circling(3.2, 0.0);
        assert_eq!(alike(&trail), 2);
        for place in &mut trail {
            let on_the_way = (16.0..17.0).contains(&place.travelled);
            place.pose.position.x += if on_the_way { 0.5 } else { 0.0 };
        }
        assert_eq!(alike(&trail), 0, "the last round but for its end went another way");
    }

    #[test]
    fn a_lap_that_began_anew_is_of_the_room_when_the_robot_was_within_it_before() {
        // Clockwise round the inside of a circle of 1 m, the wall on the left.
        let mut circuit =
            Circuit::new(&Chassis::default(), Side::Left, Wall::new(&Chassis::default()), 1.0);
        circuit.trail = (0..=63_u32)
            .map(|k| {
                let travelled = f64::from(k) * 0.1;
                let position = Point::origin() + angle::unit(-travelled);
                let heading = -travelled - angle::FRAC_PI_2;
                let pose = Pose { position, heading: angle::wrap(heading) };
                Anchor { pose, heading, travelled, time_us: u64::from(k) * 500_000 }
            })
            .collect();
        let (from, to) = (circuit.trail[0], circuit.trail[63]);
        let side = Side::Left;
        let (drift, last_round, over) = (0.0, 0.0, to.travelled);
        let closure =
            Closure { from, to, side, drift, last_round, over, pocket: None, alike: None };
        assert!(!circuit.is_pocket(&closure), "it never began anew");
        circuit.led_from = Some(Point::new(0.3, 0.2));
        assert!(!circuit.is_pocket(&closure), "it was led off in this room");
        circuit.led_from = Some(Point::new(1.8, 0.0));
        assert!(circuit.is_pocket(&closure), "it came in from outside");
        let outside = Closure { side: Side::Right, ..closure };
        assert!(!circuit.is_pocket(&outside), "a thing that was gone round is no pocket");
    }
}
