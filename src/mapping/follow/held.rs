//! What holds a follower where it is: bumps in one place, a gap found too narrow, no way made, round and
//! round on the spot. Counts, and remembers where the robot came from; what is done about it, the follower
//! decides.

use super::{Ask, AtRest};
use crate::geometry::segment::Segment;
use crate::geometry::{Point, angle};
use crate::robot::{DoneReason, Motion};
use std::collections::VecDeque;

/// A gap found too narrow nearer than this is the same, metres ...
const SAME_GAP: f64 = 0.3;
/// ... and no more than this often, ...
const MOST_REFUSALS: u32 = 2;
/// ... unless the robot was so far from there meanwhile, metres.
const AWAY: f64 = 1.0;
/// Bumps nearer to each other than this are in one place, metres; so many of them hold the robot there.
const SAME_PLACE: f64 = 0.04;
const MOST_BUMPS: u32 = 3;
/// After this way, metres, odometry does not tell any longer whether a place is the same.
const KEPT: f64 = 20.0;
/// Held, it leaves towards a place that it came from no nearer than this, metres.
const WAY_OUT: f64 = 0.06;
/// Nearer than this to its way it has been at a place, metres.
const SAME_WAY: f64 = 0.08;
/// It went through a gap if it was on both sides of it within so much of its way, metres.
const THROUGH: f64 = 0.6;
/// From what lies no farther back on its way it came just now, metres.
const LATELY: f64 = 1.0;
/// Shares of the width of a gap at which it is barred.
const BARS: [f64; 5] = [0.2, 0.35, 0.5, 0.65, 0.8];
/// So far it must get, metres, before it has turned so many times round: more it needs in no dead end.
const SPOT: f64 = 0.15;
const MOST_TURNS: f64 = 1.5;
/// Less than this is no way, metres; so many times without any, and it is stuck.
const PROGRESS: f64 = 0.02;
const STUCK: u32 = 40;

/// How a robot has come on, or not.
#[derive(Debug, Clone, Default)]
pub(super) struct Held {
    /// How often it came to rest where it was before.
    still: u32,
    last: Option<Point>,
    /// How far it has come, metres, and by which places, the latest last.
    way: f64,
    trail: VecDeque<(Point, f64)>,
    /// What keeps it out of the gaps that it refused.
    bars: VecDeque<(Point, f64)>,
    /// Where it was bumped last, and how often thereabouts.
    bumped: Option<(Point, u32)>,
    /// Where a gap was last found too narrow, and how often thereabouts.
    refused: Option<(Point, u32)>,
    whirl: Option<Whirl>,
    /// The turn that is under way, radians, and the heading when it began.
    turning: (Option<f64>, f64),
}

/// A robot that has not got far for a while.
#[derive(Debug, Clone, Copy)]
struct Whirl {
    at: Point,
    /// How much of the wall had been seen when it came there.
    seen: usize,
    /// How far it has turned there, radians.
    turned: f64,
}

/// One more of what happened at `before` if that is within `reach` of `here`, else the first of another.
fn again(before: Option<(Point, u32)>, here: Point, reach: f64) -> (Point, u32) {
    let same = before.filter(|(at, _)| (at - here).norm() < reach);
    same.map_or((here, 1), |(at, times)| (at, times + 1))
}

impl Held {
    /// It has come to rest, and so many contacts have been `seen`. Once it has turned round and round
    /// on the spot: how many it had seen when it came there.
    pub(super) fn rests(&mut self, rest: &AtRest, seen: usize) -> Option<usize> {
        self.moves_on(rest.pose.position);
        let (asked, from) = std::mem::replace(&mut self.turning, (None, rest.pose.heading));
        let turned = match asked {
            // More than half a turn is not told by the headings.
            Some(whole) if rest.reason == DoneReason::Complete => whole,
            _ => angle::wrap(rest.pose.heading - from),
        };
        let here = rest.pose.position;
        let there = self.whirl.filter(|whirl| (whirl.at - here).norm() < SPOT);
        let whirl = there.unwrap_or(Whirl { at: here, seen, turned: 0.0 });
        let turned = whirl.turned + turned;
        let round = turned.abs() > MOST_TURNS * angle::TAU;
        self.whirl = (!round).then_some(Whirl { turned, ..whirl });
        round.then_some(whirl.seen)
    }

    /// It is asked for a motion.
    pub(super) fn asks(&mut self, ask: &Ask) {
        if let Motion::Turn { angle, .. } = ask.motion {
            self.turning.0 = Some(angle);
        }
    }

    fn moves_on(&mut self, here: Point) {
        if self.last.is_some_and(|last| (last - here).norm() <= PROGRESS) {
            self.still += 1;
            return;
        }
        self.still = 0;
        self.way += self.last.map_or(0.0, |last| (last - here).norm());
        self.last = Some(here);
        self.trail.push_back((here, self.way));
        for kept in [&mut self.trail, &mut self.bars] {
            while kept.front().is_some_and(|(_, then)| self.way - then > KEPT) {
                kept.pop_front();
            }
        }
        self.refused = self.refused.filter(|(at, _)| (at - here).norm() < AWAY);
    }

    /// Whether it has gone nowhere for long.
    pub(super) fn is_stuck(&self) -> bool {
        self.still > STUCK
    }

    /// It was bumped at `here`; where it came from, once it has been bumped there again and again.
    pub(super) fn bump(&mut self, here: Point) -> Option<Point> {
        let (at, times) = again(self.bumped, here, SAME_PLACE);
        self.bumped = Some((at, times));
        if times < MOST_BUMPS {
            return None;
        }
        let (from, _) = self.trail.iter().rev().find(|(p, _)| (p - here).norm() > WAY_OUT)?;
        self.bumped = None;
        Some(*from)
    }

    /// At which points of its way it came by `place`, as far as it remembers.
    fn by(&self, place: Point) -> impl Iterator<Item = f64> {
        let legs = self.trail.iter().zip(self.trail.iter().skip(1));
        let near = move |((from, _), (to, _)): &(&(Point, f64), &(Point, f64))| {
            Segment::new(*from, *to).distance_squared(place) < SAME_WAY * SAME_WAY
        };
        legs.filter(near).map(|(_, (_, way))| *way)
    }

    /// Whether it came from `place` just now.
    pub(super) fn comes_from(&self, place: Point) -> bool {
        self.by(place).any(|then| self.way - then < LATELY)
    }

    /// Whether it went from `one` to `other`, or back, not long ago, as through a gap. To have been at
    /// either is not enough: it may have turned back between.
    pub(super) fn went_through(&self, one: Point, other: Point) -> bool {
        self.by(one).any(|then| self.by(other).any(|when| (when - then).abs() < THROUGH))
    }

    /// The gap between `here` and `there` is closed to it.
    pub(super) fn bar(&mut self, here: Point, there: Point) {
        let way = self.way;
        self.bars.extend(BARS.map(|share| (here + (there - here) * share, way)));
    }

    /// What keeps it out of the gaps that it refused, as if something stood there.
    pub(super) fn bars(&self) -> impl Iterator<Item = Point> {
        self.bars.iter().map(|(bar, _)| *bar)
    }

    /// It found a gap too narrow at `here`; whether to go by that. A robot that stands between has to
    /// go on somewhere.
    pub(super) fn refuses(&mut self, here: Point) -> bool {
        // The latest place counts: a gap is long.
        let (_, times) = again(self.refused, here, SAME_GAP);
        self.refused = Some((here, times));
        times <= MOST_REFUSALS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::robot::{Guard, SwitchSet};

    #[test]
    fn bumped_three_times_in_one_place_it_leaves_the_way_it_came() {
        let mut held = Held::default();
        for x in [0.0, 0.05, 0.1, 0.15] {
            held.moves_on(Point::new(x, 0.0));
        }
        let here = Point::new(0.15, 0.01);
        assert_eq!(held.bump(here), None);
        assert_eq!(held.bump(here), None);
        assert_eq!(
            held.bump(here),
            Some(Point::new(0.05, 0.0)),
            "the nearest place far enough off"
        );
        assert_eq!(held.bump(here), None, "counted anew");
    }

    #[test]
    fn a_bump_elsewhere_is_another() {
        let mut held = Held::default();
        held.moves_on(Point::new(1.0, 0.0));
        for x in [0.0, 0.1, 0.2, 0.3] {
            assert_eq!(held.bump(Point::new(x, 0.0)), None);
        }
    }

    #[test]
    fn a_gap_is_refused_twice_and_then_gone_through() {
        let mut held = Held::default();
        assert!(held.refuses(Point::new(0.0, 0.0)));
        assert!(held.refuses(Point::new(0.1, 0.0)));
        assert!(!held.refuses(Point::new(0.2, 0.0)));
        assert!(held.refuses(Point::new(2.0, 0.0)), "another gap");
    }

    #[test]
    fn on_one_spot_for_long_it_is_stuck() {
        let mut held = Held::default();
        for _ in 0..=STUCK {
            held.moves_on(Point::new(0.0, 0.0));
        }
        assert!(!held.is_stuck());
        held.moves_on(Point::new(0.01, 0.0));
        assert!(held.is_stuck());
        held.moves_on(Point::new(0.1, 0.0));
        assert!(!held.is_stuck());
    }

    #[test]
    fn round_and_round_on_the_spot_is_noticed_and_round_a_post_is_not() {
        // A step of `way` metres and then two turns of `by` radians, again and again.
        let seen_at = |way: f64, by: f64| {
            let (mut held, mut pose) = (Held::default(), Pose::new(0.0, 0.0, 0.0));
            let reason = DoneReason::Complete;
            for k in 0..60 {
                if k % 3 == 0 {
                    pose.position += pose.direction() * way;
                } else {
                    let motion = Motion::Turn { angle: by, rate: f64::INFINITY };
                    held.asks(&Ask { motion, guard: Guard::default(), why: "" });
                    pose.heading = angle::wrap(pose.heading + by);
                }
                let rest = AtRest { pose, closed: SwitchSet::EMPTY, reason };
                if let Some(seen) = held.rests(&rest, 100 + k) {
                    return Some(seen);
                }
            }
            None
        };
        // Into a pocket and out again, each time by a whole turn and not by half a one and back.
        assert_eq!(seen_at(0.06, 0.5 * (angle::PI + 0.1)), Some(100));
        // Round a post of 20 mm, its middle 0.165 m from the robot's: a turn of 0.35 for 0.06 m.
        assert_eq!(seen_at(0.06, 0.175), None);
    }

    #[test]
    fn the_way_it_came_is_remembered_for_a_while() {
        let mut held = Held::default();
        held.bar(Point::new(0.0, 0.1), Point::new(0.0, 0.4));
        for k in 0..300 {
            held.moves_on(Point::new(0.05 * f64::from(k), 0.0));
        }
        let by = |x: f64, y: f64| Point::new(x, y);
        assert!(held.went_through(by(4.0, 0.05), by(4.3, 0.05)));
        assert!(!held.went_through(by(4.0, 0.05), by(4.3, 0.2)));
        assert!(held.comes_from(by(14.5, 0.0)) && !held.comes_from(by(4.0, 0.0)));
        assert!(held.bars().any(|bar| (bar - Point::new(0.0, 0.25)).norm() < 1e-9));
        for k in 300..500 {
            held.moves_on(Point::new(0.05 * f64::from(k), 0.0));
        }
        assert!(!held.went_through(by(4.0, 0.0), by(4.3, 0.0)), "long ago");
        assert!(held.bars().next().is_none(), "long ago");
    }

    #[test]
    fn a_robot_that_turned_back_in_a_gap_did_not_go_through() {
        let mut held = Held::default();
        // Down into the gap at the origin, and out again the way it came.
        for y in [0.4, 0.3, 0.2, 0.1, 0.02, 0.1, 0.2, 0.3, 0.4] {
            held.moves_on(Point::new(0.0, y));
        }
        let (above, below) = (Point::new(0.0, 0.12), Point::new(0.0, -0.12));
        assert!(held.comes_from(above), "out of the gap it is let");
        assert!(!held.went_through(below, above));
        for y in [0.2, 0.0, -0.2] {
            held.moves_on(Point::new(0.0, y));
        }
        assert!(held.went_through(below, above));
    }
}
