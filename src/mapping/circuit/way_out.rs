//! Out of a pocket by the way that led into it. Through a gap that is seen only when the robot is in it, it comes
//! in with hardly any room, and finds no way out along the walls: what they are known to leaves less. The way
//! it came was free. It goes back by that, and the gap is closed to it from then on. Knows the robot's way and
//! what was seen of the walls; not how rounds are told.

use super::Anchor;
use crate::geometry::segment::Segment;
use crate::geometry::{Point, Pose, angle, cross};
use crate::mapping::follow::{Ask, AtRest};
use crate::mapping::retreat::Retreat;
use crate::mapping::wall::Sighting;
use crate::robot::{Guard, Motion};

/// A place of the way in is one of the pocket where a later round comes as near to it as this, metres.
const OF_ROUND: f64 = 0.1;
/// The robot goes back so far beyond the last of those, metres.
const BEYOND: f64 = 0.4;
/// So far before and behind the place where it came in the gap is looked for, metres, ...
const ALONG: f64 = 0.3;
/// ... between walls that the body passed beside, no farther off its way than this, metres.
const BESIDE: f64 = 0.2;
/// Smaller turns are not worth a motion, radians.
const FACING: f64 = 0.01;

/// The way out.
#[derive(Debug, Clone)]
pub(super) struct WayOut {
    retreat: Retreat,
    /// Where it is going to, as it stood there before.
    out: Pose,
    /// The two sides of the gap.
    gap: (Point, Point),
    /// Odometer where the way in left what was gone along before, metres.
    pub(super) entered: f64,
}

impl WayOut {
    /// The way by which the robot at the end of `trail` came into the pocket, in which it first was where it is
    /// now when it had travelled `earliest` metres; none where nothing was `seen` that makes a gap.
    pub(super) fn of<'a>(
        trail: &[Anchor],
        earliest: f64,
        seen: impl Iterator<Item = &'a Sighting>,
    ) -> Option<Self> {
        let first = trail.partition_point(|place| place.travelled < earliest);
        let (before, rounds) = trail.split_at_checked(first)?;
        // Along a straight wall the steps are long, and end elsewhere on each round.
        let steps = rounds.windows(2);
        let steps = steps.map(|two| Segment::new(two[0].pose.position, two[1].pose.position));
        let steps: Vec<Segment> = steps.collect();
        let near =
            |p: Point| steps.iter().any(|step| step.distance_squared(p) < OF_ROUND * OF_ROUND);
        let mouth = before.iter().rposition(|place| !near(place.pose.position))?;
        let out = before[..mouth]
            .iter()
            .rposition(|place| before[mouth].travelled - place.travelled > BEYOND)?;
        let way = before[out..].iter().chain(rounds.first());
        let way = way.map(|place| place.pose.position);
        let through = before[out..]
            .iter()
            .filter(|place| (place.travelled - before[mouth].travelled).abs() < ALONG);
        let through: Vec<&Anchor> = through.collect();
        let gap = narrowest(&through, seen)?;
        Some(Self {
            retreat: Retreat::by(way),
            out: before[out].pose,
            gap,
            entered: before[out].travelled,
        })
    }

    /// The next motion on the way out; none when it is at its end, or something is in the way.
    pub(super) fn next(&mut self, rest: &AtRest) -> Option<Ask> {
        self.retreat.next(rest).or_else(|| {
            let turn = angle::wrap(self.out.heading - rest.pose.heading);
            let motion = Motion::Turn { angle: turn, rate: f64::INFINITY };
            let why = "out of the pocket: facing along the wall again";
            let is_out = self.is_out(rest) && turn.abs() > FACING;
            is_out.then(|| Ask { motion, guard: Guard::default(), why })
        })
    }

    /// Whether the robot is where it was going to: something may have been in the way.
    fn is_out(&self, rest: &AtRest) -> bool {
        (rest.pose.position - self.out.position).norm() < OF_ROUND
    }

    /// The gap that is closed from now on: none while the robot is behind it.
    pub(super) fn closes(&self, rest: &AtRest) -> Option<(Point, Point)> {
        self.is_out(rest).then_some(self.gap)
    }
}

/// The narrowest place between what was `seen` on the left and on the right of a way.
fn narrowest<'a>(
    way: &[&Anchor],
    seen: impl Iterator<Item = &'a Sighting>,
) -> Option<(Point, Point)> {
    let beside = |pose: &Pose, p: Point| (p - pose.position).norm() < BESIDE;
    let near: Vec<Point> = seen
        .filter(|seen| seen.alive)
        .map(|seen| seen.point)
        .filter(|p| way.iter().any(|place| beside(&place.pose, *p)))
        .collect();
    let hand = |pose: &Pose, p: Point| cross(pose.direction(), p - pose.position);
    let pairs = way.iter().flat_map(|place| {
        let of = |left: bool| {
            let on =
                |p: &&Point| beside(&place.pose, **p) && (hand(&place.pose, **p) > 0.0) == left;
            near.iter().filter(on).copied().collect::<Vec<Point>>()
        };
        let (left, right) = (of(true), of(false));
        left.into_iter().flat_map(move |a| right.clone().into_iter().map(move |b| (a, b)))
    });
    pairs.min_by(|(a, b), (c, d)| (a - b).norm().total_cmp(&(c - d).norm()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{DoneReason, SwitchSet};

    fn place(x: f64, y: f64, heading: f64, travelled: f64) -> Anchor {
        Anchor { pose: Pose::new(x, y, heading), heading, travelled, time_us: 0 }
    }

    fn seen(x: f64, y: f64) -> Sighting {
        Sighting::at(x, y, 0.0)
    }

    /// A metre along the x axis through a gap at x = 0.7, and round and round about (1.2, 0) behind it.
    fn trail() -> Vec<Anchor> {
        let there = (0..=20).map(|k| f64::from(k) * 0.05).map(|x| place(x, 0.0, 0.0, x));
        let rounds = (0..=60).map(|k| {
            let bearing = f64::from(k) * 0.3 - angle::PI;
            let at = Point::new(1.2, 0.0) + angle::unit(bearing) * 0.2;
            place(at.x, at.y, bearing + angle::FRAC_PI_2, 1.0 + 0.06 * f64::from(k))
        });
        there.chain(rounds).collect()
    }

    #[test]
    fn it_leads_back_before_the_gap_and_says_which_that_is() {
        let walls = [seen(0.7, 0.13), seen(0.7, -0.14), seen(1.0, 0.18), seen(0.3, 0.14)];
        let mut out = WayOut::of(&trail(), 1.0, walls.iter()).expect("a way");
        let rest =
            |pose: Pose| AtRest { pose, closed: SwitchSet::EMPTY, reason: DoneReason::Complete };
        let at = |x: f64| rest(Pose::new(x, 0.0, 0.0));
        assert_eq!(out.closes(&at(0.9)), None, "it is behind it");
        let (one, other) = out.closes(&at(0.45)).expect("a gap");
        assert_eq!((one.y.max(other.y), one.y.min(other.y)), (0.13, -0.14));
        let entered = out.entered;
        assert!((0.2..0.6).contains(&entered), "{entered} m");
        let asked = |out: &mut WayOut, pose| out.next(&rest(pose)).map(|ask| ask.motion);
        let first = asked(&mut out, Pose::new(1.0, 0.0, angle::PI));
        assert!(matches!(first, Some(Motion::Move { .. })), "{first:?}");
        // There it turns as it stood when it came by, and that is all.
        let back = Pose::new(entered, 0.0, angle::PI);
        let turned = asked(&mut out, back);
        assert!(
            matches!(turned, Some(Motion::Turn { angle, .. }) if angle.abs() > 3.0),
            "{turned:?}"
        );
        assert_eq!(asked(&mut out, Pose::new(entered, 0.0, 0.0)), None);
    }

    #[test]
    fn where_nothing_was_seen_on_one_hand_there_is_no_gap_to_close() {
        let wall = [seen(0.7, 0.13), seen(0.3, 0.14)];
        assert!(WayOut::of(&trail(), 1.0, wall.iter()).is_none());
    }
}
