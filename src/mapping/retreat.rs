//! Back by the way it came, which is known to be free. Driving straight, the robot may slip through a gap
//! that it would not enter along a wall: the lap then closes round the inside of a pocket, and that is
//! not the room, since the robot was outside before. Or the lap came into a pocket and finds no way out along
//! its walls; or what is mapped leaves it no way out of where it stands, and it stands there all the same. Knows
//! the way, and nothing of what is about it.

use crate::geometry::{Point, Pose, Ring, Vector, angle, cross};
use crate::mapping::follow::{Ask, AtRest, STRIDE};
use crate::mapping::map::PathPoint;
use crate::robot::{DoneReason, Guard, Motion};

/// Where the robot was before is outside of a lap when it lies this far outside the way round, metres: the
/// way keeps off the walls.
const OUTSIDE: f64 = 0.25;
/// The way back leaves the way there by no more than this, metres, ...
const ASTRAY: f64 = 0.01;
/// ... and a place on it is reached when it is as near as this, metres.
const REACHED: f64 = 0.02;
/// Smaller turns are not worth a motion, radians.
const FACING: f64 = 0.01;
/// What it hits, it backs off from by this, metres, ...
const BACK_OFF: f64 = 0.08;
/// ... and passes so far to the left of the way, metres: it hit a jamb, and which of the two its bumper does not say.
const BESIDE: [f64; 6] = [0.015, -0.015, 0.03, -0.03, 0.045, -0.045];
/// It gets beside the way so far before what it hit, metres; ...
const BEFORE: f64 = 0.04;
/// ... and what it hits no farther than this from there is the same, metres.
const SAME_HIT: f64 = 0.12;
/// After this many metres beside the way it goes on as it was.
const PAST: f64 = 0.2;
/// A place of the way there is of the way round when it is as near to it as this, metres.
const OF_ROUND: f64 = 0.05;
/// What it drove last before that, metres, is the line in which it came in; it gets in that line so many metres
/// behind the gap, as far as it can.
const RUN_UP: f64 = 0.2;
const IN_LINE: [f64; 3] = [0.4, 0.3, 0.2];
/// Farther along the way than this, metres, ...
const ROUND: f64 = 0.4;
/// ... it came back to a place when it was as near to it as this, metres.
const BACK: f64 = 0.04;

/// A way back.
#[derive(Debug, Clone)]
pub(super) struct Retreat {
    /// Places to go to, the next one last.
    way: Vec<Point>,
    /// Why, for the operator.
    why: &'static str,
    /// A motion of it was asked for: what ended the one before says nothing of the way.
    begun: bool,
    /// It backs off from what it hit.
    backs_off: bool,
    /// Where it hit that first, looking along the way, and how often.
    hit: Option<Pose>,
    hits: usize,
    /// How many places of the way lie beyond that.
    beyond: usize,
}

impl Retreat {
    /// The way back from a lap that closed round its inside, by `path`, to where the robot was at
    /// `begun_us` (robot time), and the way round; none when that is within the lap, which then is of the room. The
    /// lap was driven between the two times of `lap_us`.
    pub(super) fn from_pocket(
        path: &[PathPoint],
        begun_us: u64,
        lap_us: (u64, u64),
    ) -> Option<(Self, Ring)> {
        let (from, to) = lap_us;
        let begun = between(path, begun_us, from).next()?;
        let round = Ring::polygon(&straightened(between(path, from, to)));
        if round.contains(begun) || round.distance(begun) < OUTSIDE {
            return None;
        }
        let there = between(path, begun_us, from).chain(between(path, to, u64::MAX));
        let way = without_rounds(there);
        let way = in_line(&way, &round).unwrap_or_else(|| straightened(way.into_iter()));
        Some((Self::along(way, "went round a pocket: back by the way it came"), round))
    }

    fn along(way: Vec<Point>, why: &'static str) -> Self {
        Self { way, why, begun: false, backs_off: false, hit: None, hits: 0, beyond: 0 }
    }

    /// The way back by `way`, which led from its first place into a pocket.
    pub(super) fn by(way: impl Iterator<Item = Point>) -> Self {
        Self::along(straightened(way), "round and round in a pocket: back by the way it came")
    }

    /// The way back by `path` to the last place that `is_free`; none when the robot came by none, or was
    /// carried since.
    pub(super) fn to_free(path: &[PathPoint], is_free: impl Fn(Point) -> bool) -> Option<Self> {
        let begun = path.iter().rposition(|point| point.carried).unwrap_or(0);
        let since = path[begun..].iter().rposition(|point| is_free(point.pose.position))?;
        let way = straightened(path[begun + since..].iter().map(|point| point.pose.position));
        Some(Self::along(way, "shut in by what is mapped: back by the way it came"))
    }

    /// Whether it came to the end of the way.
    pub(super) fn is_back(&self) -> bool {
        self.way.is_empty()
    }

    /// The next motion on the way back; none when it is at its end, or something is in the way.
    pub(super) fn next(&mut self, rest: &AtRest) -> Option<Ask> {
        let begun = std::mem::replace(&mut self.begun, true);
        let pose = rest.pose;
        if begun && matches!(rest.reason, DoneReason::Bumper | DoneReason::Stalled) {
            if self.hits == BESIDE.len() || self.backs_off {
                return None;
            }
            let is_it = |first: &Pose| (first.position - pose.position).norm() < SAME_HIT;
            if self.hit.as_ref().is_some_and(is_it) {
                // The places beside the way that it was to pass it by.
                self.way.truncate(self.beyond);
            } else {
                self.hit = Some(pose);
            }
            self.backs_off = true;
            let motion = Motion::Move { distance: -BACK_OFF, speed: f64::INFINITY };
            return Some(Ask { motion, guard: Guard::default(), why: self.why });
        }
        if std::mem::take(&mut self.backs_off)
            && let Some(hit) = self.hit
        {
            self.pass_beside(hit);
        }
        while self.way.last().is_some_and(|place| (place - pose.position).norm() < REACHED) {
            self.way.pop();
        }
        let off = self.way.last()? - pose.position;
        let turn = angle::wrap(angle::of(off) - pose.heading);
        let motion = if turn.abs() > FACING {
            Motion::Turn { angle: turn, rate: f64::INFINITY }
        } else {
            Motion::Move { distance: off.norm().min(STRIDE), speed: f64::INFINITY }
        };
        Some(Ask { motion, guard: Guard::default(), why: self.why })
    }

    /// Past what it `hit`, beside the way.
    fn pass_beside(&mut self, hit: Pose) {
        let Some(last) = self.way.last() else { return };
        let past = (last - hit.position).norm().min(PAST);
        let beside = hit.position + hit.rotate(Vector::new(0.0, BESIDE[self.hits]));
        self.hits += 1;
        self.beyond = self.way.len();
        self.way.push(beside + hit.direction() * past);
        self.way.push(beside - hit.direction() * BEFORE);
    }
}

/// Where the robot was between two robot times.
fn between(path: &[PathPoint], from: u64, to: u64) -> impl Iterator<Item = Point> {
    let first = path.partition_point(|point| point.time_us < from);
    let end = path.partition_point(|point| point.time_us <= to);
    path[first..end.max(first)].iter().map(|point| point.pose.position)
}

/// The `way` out of a pocket, with the way round it, so that it goes through the gap in the line in which it came in:
/// along the walls of the pocket it would cut the corner of a jamb. None where it cannot get in line.
fn in_line(way: &[Point], round: &Ring) -> Option<Vec<Point>> {
    let is_in = |p: &Point| round.contains(*p) || round.distance(*p) < OF_ROUND;
    let entered = way.iter().position(is_in)?;
    let (gap, here) = (way[entered], *way.last()?);
    let before = way[..entered].iter().rfind(|p| (gap - **p).norm() > RUN_UP)?;
    let along = (gap - before).normalize();
    let is_free = |ahead: f64| {
        let place = gap + along * ahead;
        let line = |p: Point, q: Point, k: u32| p + (q - p) * (f64::from(k) / 10.0);
        let inside = |p: Point| round.contains(p) || round.distance(p) < REACHED;
        (0..10).all(|k| inside(line(place, here, k)))
            && (0..10).all(|k| inside(line(place, gap, k)))
    };
    let ahead = IN_LINE.into_iter().find(|ahead| is_free(*ahead))?;
    let mut out = straightened(way[..=entered].iter().copied());
    out.push(gap + along * ahead);
    Some(out)
}

/// A way without what only led back to where it had been.
fn without_rounds(way: impl Iterator<Item = Point>) -> Vec<Point> {
    // With how far along it is.
    let mut kept: Vec<(Point, f64)> = Vec::new();
    for place in way {
        let along = kept.last().map_or(0.0, |(last, along)| along + (place - last).norm());
        let is_there = |(p, at): &(Point, f64)| along - at > ROUND && (place - p).norm() < BACK;
        if let Some(back) = kept.iter().position(is_there) {
            kept.truncate(back + 1);
        } else {
            kept.push((place, along));
        }
    }
    kept.into_iter().map(|(place, _)| place).collect()
}

/// A way with fewer corners: every place left out lies near the straight line past it.
fn straightened(way: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    let mut passed: Vec<Point> = Vec::new();
    for place in way {
        let Some(&last) = kept.last() else {
            kept.push(place);
            continue;
        };
        let Some(along) = (place - last).try_normalize(REACHED) else { continue };
        if passed.iter().any(|p| cross(along, p - last).abs() > ASTRAY) {
            kept.extend(passed.last());
            passed.clear();
        }
        passed.push(place);
    }
    kept.extend(passed.last());
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::mapping::map::{Phase, Spun};
    use crate::robot::SwitchSet;

    #[test]
    fn the_way_back_ends_where_it_is_free() {
        // Two metres along the x axis, free for the first of them.
        let point = |k: u32| PathPoint {
            pose: Pose::new(f64::from(k) * 0.1, 0.0, 0.0),
            time_us: u64::from(k) * 500_000,
            rested_us: 0,
            spun: Spun::default(),
            phase: Phase::Objects,
            carried: false,
        };
        let mut path: Vec<PathPoint> = (0..=20).map(point).collect();
        let free = |p: Point| p.x < 1.05;
        let mut back = Retreat::to_free(&path, free).expect("a way");
        let rest = |x: f64, heading: f64, reason: DoneReason| {
            let pose = Pose::new(x, 0.0, heading);
            AtRest { pose, closed: SwitchSet::EMPTY, reason }
        };
        let ask = |back: &mut Retreat, rest| back.next(&rest).map(|ask| ask.motion);
        // A bump before it says nothing of the way back.
        let turned = ask(&mut back, rest(2.0, 0.0, DoneReason::Bumper));
        assert!(matches!(turned, Some(Motion::Turn { .. })), "{turned:?}");
        let moved = ask(&mut back, rest(2.0, angle::PI, DoneReason::Complete));
        assert!(matches!(moved, Some(Motion::Move { distance, .. }) if distance == STRIDE));
        assert_eq!(ask(&mut back.clone(), rest(1.0, angle::PI, DoneReason::Complete)), None);
        // Something is in the way: off it, and past it on either side, not for ever.
        for times in 0..BESIDE.len() {
            let off = ask(&mut back, rest(1.6, angle::PI, DoneReason::Bumper));
            assert!(
                matches!(off, Some(Motion::Move { distance, .. }) if distance < 0.0),
                "{times}"
            );
            let aside = ask(&mut back, rest(1.68, angle::PI, DoneReason::Complete));
            let turned = if times % 2 == 0 { 1.0 } else { -1.0 };
            let is_aside =
                matches!(aside, Some(Motion::Turn { angle, .. }) if angle * turned > 0.1);
            assert!(is_aside, "{times} {aside:?}");
        }
        assert_eq!(ask(&mut back, rest(1.6, angle::PI, DoneReason::Bumper)), None);
        assert!(!back.is_back());
        path[15].carried = true;
        assert!(Retreat::to_free(&path, free).is_none(), "it did not drive there");
    }

    #[test]
    fn out_of_a_pocket_it_goes_in_the_line_in_which_it_came() {
        // In along the x axis to a gap at x = 1, and round a pocket of a metre from there, to beside the gap.
        let there = (0..=20).map(|k| Point::new(f64::from(k) * 0.05, 0.0));
        let corners = [(1.0, 0.0), (1.0, -0.5), (2.0, -0.5), (2.0, 0.5), (1.0, 0.5)];
        let round = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        let way: Vec<Point> = there.chain([Point::new(1.0, -0.3), Point::new(1.1, -0.4)]).collect();
        let out = in_line(&way, &round).expect("a line");
        assert!(out.last().is_some_and(|p| (1.3..1.45).contains(&p.x)), "{out:?}");
        assert!(out.iter().all(|p| p.y == 0.0) && out[0] == Point::origin(), "{out:?}");
        // Where it cannot get there, it goes as it came.
        let behind: Vec<Point> = way.iter().copied().chain([Point::new(1.0, 2.0)]).collect();
        assert_eq!(in_line(&behind, &round), None);
    }

    #[test]
    fn a_way_leaves_out_what_led_round() {
        let there = (0..=20).map(|k| Point::new(f64::from(k) * 0.05, 0.0));
        let round = (0..=40).map(|k| {
            let bearing = f64::from(k) * angle::TAU / 40.0 - angle::FRAC_PI_2;
            Point::new(1.0, 0.5) + angle::unit(bearing) * 0.5
        });
        let on = (1..=20).map(|k| Point::new(1.0 + f64::from(k) * 0.05, 0.0));
        let way = without_rounds(there.chain(round).chain(on));
        assert!(way.iter().all(|p| p.y.abs() < 0.1), "{way:?}");
        assert_eq!(way.last(), Some(&Point::new(2.0, 0.0)));
    }

    #[test]
    fn a_way_keeps_its_corners_only() {
        let there = (0..=20).map(|k| Point::new(f64::from(k) * 0.05, 0.0));
        let up = (1..=20).map(|k| Point::new(1.0, f64::from(k) * 0.05));
        let way = straightened(there.chain(up));
        assert_eq!(way.len(), 3, "{way:?}");
        assert!((way[1] - Point::new(1.0, 0.0)).norm() < 0.06, "{way:?}");
        assert_eq!(way[2], Point::new(1.0, 1.0));
    }
}
