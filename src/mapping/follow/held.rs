//! What holds a follower where it is: bumps in one place, a gap found too narrow, no way made. Counts, and
//! remembers where the robot came from; what is done about it, the follower decides.

use crate::geometry::Point;
use std::collections::VecDeque;

/// A gap found too narrow nearer than this is the same, metres ...
const SAME_GAP: f64 = 0.3;
/// ... and no more than this often.
const MOST_REFUSALS: u32 = 2;
/// Bumps nearer to each other than this are in one place, metres; so many of them hold the robot there.
const SAME_PLACE: f64 = 0.04;
const MOST_BUMPS: u32 = 3;
/// So many places that the robot came from are kept, and it leaves towards one no nearer than this,
/// metres.
const TRAIL: usize = 16;
const WAY_OUT: f64 = 0.06;
/// Less than this is no way, metres; so many times without any, and it is stuck.
const PROGRESS: f64 = 0.02;
const STUCK: u32 = 40;

/// How a robot has come on, or not.
#[derive(Debug, Clone, Default)]
pub(super) struct Held {
    /// How often it came to rest where it was before.
    still: u32,
    last: Option<Point>,
    /// Where it came from, the latest last.
    trail: VecDeque<Point>,
    /// Where it was bumped last, and how often thereabouts.
    bumped: Option<(Point, u32)>,
    /// Where a gap was last found too narrow, and how often thereabouts.
    refused: Option<(Point, u32)>,
}

/// One more of what happened at `before` if that is within `reach` of `here`, else the first of another.
fn again(before: Option<(Point, u32)>, here: Point, reach: f64) -> (Point, u32) {
    let same = before.filter(|(at, _)| (at - here).norm() < reach);
    same.map_or((here, 1), |(at, times)| (at, times + 1))
}

impl Held {
    /// It has come to rest at `here`.
    pub(super) fn rests(&mut self, here: Point) {
        if self.last.is_some_and(|last| (last - here).norm() <= PROGRESS) {
            self.still += 1;
            return;
        }
        self.still = 0;
        self.last = Some(here);
        self.trail.push_back(here);
        if self.trail.len() > TRAIL {
            self.trail.pop_front();
        }
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
        let from = self.trail.iter().rev().find(|p| (*p - here).norm() > WAY_OUT)?;
        self.bumped = None;
        Some(*from)
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

    #[test]
    fn bumped_three_times_in_one_place_it_leaves_the_way_it_came() {
        let mut held = Held::default();
        for x in [0.0, 0.05, 0.1, 0.15] {
            held.rests(Point::new(x, 0.0));
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
        held.rests(Point::new(1.0, 0.0));
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
            held.rests(Point::new(0.0, 0.0));
        }
        assert!(!held.is_stuck());
        held.rests(Point::new(0.01, 0.0));
        assert!(held.is_stuck());
        held.rests(Point::new(0.1, 0.0));
        assert!(!held.is_stuck());
    }
}
