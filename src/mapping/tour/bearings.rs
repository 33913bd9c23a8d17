//! Taking bearings: when the pose has become uncertain, the robot goes to a corner of the room, feels for
//! its walls, since they may be farther off than it believes, and turns there. Its switches then see
//! both, and these say where it stands; one wall alone leaves the way along it open. Then it goes along
//! the longer of them for a metre and turns again: two looks at one wall, far apart, say how it heads,
//! which one look says badly. Where no corner is near, a straight wall has to do. Walls that are where they
//! have to be make the robot's place sure; one that is not makes it doubt that. It decides where the robot
//! looks; what a touch says of the pose is for chart and survey.

use super::drive::Purpose;
use super::{Doing, Drive, ROOM, Scene, Tour};
use crate::geometry::{Piece, Point, Ring, Vector, angle, cross, perp};
use crate::mapping::event::EventKind;
use crate::mapping::floor::Floor;
use crate::mapping::follow::{Ask, AtRest, STRIDE};
use crate::mapping::map::Contact;
use crate::mapping::survey::worse;
use crate::robot::{DoneReason, Guard, Motion, SwitchSet};
use nalgebra::Matrix2;
use std::collections::VecDeque;

/// A position less sure than this (one standard deviation, metres) is worth a stop.
const LOOSE: f64 = 0.025;
/// ... and in the middle of a line, one less sure than this: rounds of what stands on it may have taken
/// long.
const LOOSE_ON_LINE: f64 = 0.05;
/// ... and between two strides, one less sure than this: round something large, or across a hall, the way
/// is long and what is met at its end has to be told from what is mapped.
const LOOSE_UNDER_WAY: f64 = 0.10;
/// The body stays this far from either wall, metres: within the range of every switch.
const GAP: f64 = 0.04;
/// Shorter walls are not trusted with it, metres.
const LEAST_WALL: f64 = 0.3;
/// A wall was touched at least so often, as near as this to where it runs and farther from its ends, metres:
/// what nobody has touched closes a gap, and behind it is floor.
const TOUCHES: usize = 2;
const TOUCHED: f64 = 0.03;
/// How far the way to a corner may be, metres, and how much is driven at least between two stops.
const FARTHEST: f64 = 8.0;
const BETWEEN: f64 = 6.0;
/// So much of that is driven after a stop at least, metres.
const AFTERWARDS: f64 = 2.0;
/// A pose that is less sure is worth a longer way, and so is a place that makes it surer: metres for a
/// metre of standard deviation.
const WORTH: f64 = 120.0;
/// How far apart the two looks at one wall are, metres, and how much of the wall is left beyond.
const APART: f64 = 1.2;
const BEYOND: f64 = 0.35;
/// Looks nearer to each other than this are not worth it, metres.
const LEAST_APART: f64 = 0.4;
/// So many of the most promising places have their way looked for.
const TRIED: usize = 6;

/// A wall may be this many standard deviations of the pose, and so many metres, farther off than it is
/// believed to be.
const DEVIATIONS: f64 = 3.0;
const FARTHER: f64 = 0.04;
/// The robot faces a wall within this, radians.
const FACING: f64 = 0.03;
/// What a beam meets that runs towards a wall, by the cosine between them, may be that wall.
const ALONG: f64 = 0.7;

/// A place in a corner, or beside a wall, and one along the longer of its walls.
#[derive(Debug, Clone)]
struct Spot {
    at: Point,
    /// Unit vectors towards the walls, the one that `along` goes beside first.
    walls: Vec<Vector>,
    along: Option<Point>,
}

impl Spot {
    /// What is left of the standard deviation of a position, in its worse direction, when the distance
    /// from these walls is known, metres. A wall alone leaves the way along it open.
    fn leaves(&self, spread: &Matrix2<f64>) -> f64 {
        let left = self.walls.iter().fold(*spread, |left, wall| {
            let across = left * wall;
            left - across * across.transpose() / (wall.dot(&across) + 1e-6)
        });
        worse(&left)
    }
}

/// Feeling for the walls of a place.
#[derive(Debug, Clone)]
pub(super) struct Feeling {
    /// Unit vectors towards all of them.
    asked: Vec<Vector>,
    /// Unit vectors towards those that were not met yet.
    walls: VecDeque<Vector>,
    /// Metres to go at most, towards the first of them; none before it was faced.
    left: Option<f64>,
    most: f64,
    /// Unit vectors towards those that were not where they have to be.
    missed: Vec<Vector>,
    /// Robot time when it began, microseconds.
    begun_us: u64,
    /// The turn is asked for.
    turned: bool,
}

impl Feeling {
    fn new(walls: Vec<Vector>, most: f64, begun_us: u64) -> Self {
        let (asked, walls) = (walls.clone(), walls.into());
        Self { asked, walls, left: None, most, missed: Vec::new(), begun_us, turned: false }
    }

    /// The next motion of a robot with switch `front` ahead; none when there is no wall left to feel for.
    fn next(&mut self, rest: &AtRest, front: usize) -> Option<Ask> {
        let turn = |wall: &Vector| angle::wrap(angle::of(*wall) - rest.pose.heading);
        let faced = |wall: &Vector| turn(wall).abs() < FACING;
        // Whatever it ran into, it goes no farther that way.
        let stopped = !matches!(rest.reason, DoneReason::Complete | DoneReason::Guard { .. });
        let closed = rest.closed.has(front);
        let seen = closed && self.walls.front().is_some_and(faced);
        if seen || stopped || self.left.is_some_and(|left| closed || left <= 0.0) {
            let wall = self.walls.pop_front();
            self.missed.extend(wall.filter(|_| !closed && !stopped));
            self.left = None;
        }
        let wall = self.walls.front()?;
        let (motion, rise) = if self.left.is_none() && !faced(wall) {
            (Motion::Turn { angle: turn(wall), rate: f64::INFINITY }, SwitchSet::EMPTY)
        } else {
            let left = self.left.unwrap_or(self.most);
            let distance = left.min(STRIDE);
            self.left = Some(left - distance);
            (Motion::Move { distance, speed: f64::INFINITY }, SwitchSet::only(front))
        };
        let guard = Guard { rise, fall: SwitchSet::EMPTY };
        Some(Ask { motion, guard, why: "feeling for the wall" })
    }
}

/// Whether `piece` is a straight wall, long enough to be trusted, that `contacts` were made on.
fn is_wall(piece: &Piece, contacts: &[Contact]) -> bool {
    let (from, along) = (piece.from(), piece.tangent(0.5));
    let between = TOUCHED..piece.length() - TOUCHED;
    let on_it = |contact: &&Contact| {
        between.contains(&along.dot(&(contact.point - from)))
            && piece.distance(contact.point) < TOUCHED
    };
    matches!(piece, Piece::Line { .. })
        && piece.length() > LEAST_WALL
        && contacts.iter().filter(on_it).take(TOUCHES).count() == TOUCHES
}

/// Where two straight walls of `outline` (counter-clockwise), on which `contacts` were made, meet so that the
/// robot, at a gap from both, sees both.
fn corners(outline: &Ring, contacts: &[Contact], floor: &Floor, radius: f64) -> Vec<Spot> {
    let count = outline.pieces.len();
    (0..count)
        .filter_map(|k| {
            let (before, after) = (outline.pieces[k], outline.pieces[(k + 1) % count]);
            let (first, second) = (before.tangent(1.0), after.tangent(0.0));
            let turn = angle::wrap(angle::of(second) - angle::of(first)).to_degrees();
            let walls = || is_wall(&before, contacts) && is_wall(&after, contacts);
            if !(50.0..120.0).contains(&turn) || !walls() {
                return None;
            }
            let (n, m) = (perp(first), perp(second));
            let at = after.from() + (n + m) * ((radius + GAP) / (1.0 + n.dot(&m)));
            let room = radius + GAP - 0.01;
            if !floor.is_drivable(at) || !floor.keeps(at, room) {
                return None;
            }
            let (way, length, walls) = if after.length() > before.length() {
                (second, after.length(), vec![-m, -n])
            } else {
                (-first, before.length(), vec![-n, -m])
            };
            let apart = APART.min(length - radius - GAP - BEYOND);
            let along = at + way * apart;
            let clear = apart > LEAST_APART && floor.is_clear(at, along, room);
            Some(Spot { at, walls, along: clear.then_some(along) })
        })
        .collect()
}

/// Where the robot, at a gap from a straight wall of `outline`, on which `contacts` were made, can go along it
/// for long enough that two looks at it say how it heads: beside each, as near to `near` as may be.
fn beside_walls(
    outline: &Ring,
    contacts: &[Contact],
    floor: &Floor,
    radius: f64,
    near: Point,
) -> Vec<Spot> {
    let room = radius + GAP - 0.01;
    let walls = outline.pieces.iter().filter(|piece| is_wall(piece, contacts));
    walls
        .filter_map(|wall| {
            let (along, length) = (wall.tangent(0.5), wall.length());
            let last = length - radius - BEYOND - APART;
            let first = radius + BEYOND;
            if last < first {
                return None;
            }
            let share = (near - wall.from()).dot(&along).clamp(first, last);
            let at = wall.from() + along * share + perp(along) * (radius + GAP);
            let end = at + along * APART;
            let clear = floor.is_drivable(at) && floor.is_clear(at, end, room);
            clear.then_some(Spot { at, walls: vec![-perp(along)], along: Some(end) })
        })
        .collect()
}

impl Tour {
    /// A drive to a corner near the robot, when the pose has become too uncertain to go on.
    pub(super) fn bearings(&mut self, scene: &mut Scene<'_>) -> Option<Drive> {
        if let Some((along, wall)) = self.look_next.take() {
            self.feel_for = vec![wall];
            return Some(Drive { purpose: Purpose::Bearings, ..Drive::new(0, along, along) });
        }
        let loose = if self.suspended.is_some() { LOOSE_ON_LINE } else { LOOSE };
        self.bearings_if(loose, scene)
    }

    /// The same in the middle of a way on which that was done `stops` times. Each time asks for more: where
    /// the way back from the walls is what makes the robot unsure, it would do nothing else.
    pub(super) fn bearings_under_way(
        &mut self,
        stops: u32,
        scene: &mut Scene<'_>,
    ) -> Option<Drive> {
        self.bearings_if(LOOSE_UNDER_WAY * f64::from(stops + 1), scene)
    }

    /// A drive to where bearings are taken, when the position is less sure than `loose`.
    fn bearings_if(&mut self, loose: f64, scene: &mut Scene<'_>) -> Option<Drive> {
        let at = scene.rest.pose.position;
        let driven = scene.tracker.travelled() - self.bearings_at;
        if driven < BETWEEN {
            return None;
        }
        let spread = self.chart.spread(scene.survey, scene.tracker.pose().position);
        let sd = worse(&spread);
        if sd < loose {
            return None;
        }
        let radius = self.chassis.radius;
        let outline = self.chart.outline().clone();
        let floor = self.floor(at);
        let contacts = &scene.map.contacts;
        let mut spots = corners(&outline, contacts, floor, radius);
        spots.extend(beside_walls(&outline, contacts, floor, radius, at));
        let cost = |spot: &Spot, way: f64| way + WORTH * spot.leaves(&spread);
        let straight = |spot: &Spot| cost(spot, (spot.at - at).norm());
        spots.sort_by(|a, b| straight(a).total_cmp(&straight(b)));
        let farthest = FARTHEST.max(sd * WORTH);
        let (_, spot) = spots
            .into_iter()
            .take(TRIED)
            .filter_map(|spot| Some((floor.route_length(at, spot.at, radius + ROOM)?, spot)))
            .filter(|(way, _)| *way < farthest)
            .min_by(|a, b| cost(&a.1, a.0).total_cmp(&cost(&b.1, b.0)))?;
        scene.tell.push(EventKind::Bearings { sd });
        self.bearings_at = scene.tracker.travelled();
        self.look_next = spot.along.zip(spot.walls.first().copied());
        self.feel_for = spot.walls;
        Some(Drive { purpose: Purpose::Bearings, ..Drive::new(0, spot.at, spot.at) })
    }

    /// There: feels for the walls first. However long the way there was, some of the next lines are driven
    /// before bearings are taken again, or it would do nothing else.
    pub(super) fn begin_to_feel(&mut self, scene: &Scene<'_>) {
        let at = scene.rest.pose.position;
        let again = scene.tracker.travelled() + AFTERWARDS - BETWEEN;
        self.bearings_at = self.bearings_at.max(again);
        let most = DEVIATIONS * self.chart.looseness(scene.survey, at) + FARTHER;
        let walls = std::mem::take(&mut self.feel_for);
        self.doing = Doing::Feeling(Feeling::new(walls, most, scene.tracker.time_us()));
    }

    /// The next motion towards the walls, and then the turn; none when that is done. A wall that neither has
    /// met, and that has to be there, makes the robot doubt its place.
    pub(super) fn feel(&mut self, mut feeling: Feeling, scene: &mut Scene<'_>) -> Option<Ask> {
        let front = self.chassis.sensor_towards(0.0, FACING).filter(|_| !feeling.turned);
        let mut ask = front.and_then(|front| feeling.next(&scene.rest, front));
        if ask.is_none() && !feeling.turned {
            feeling.turned = true;
            ask = Some(self.look_round());
        }
        if ask.is_some() {
            self.doing = Doing::Feeling(feeling);
            return ask;
        }
        // One switch may have missed it.
        let met = |wall: &Vector| {
            let since = self.wall.log().iter().filter(|seen| seen.time_us >= feeling.begun_us);
            since.filter(|seen| seen.alive).any(|seen| angle::unit(seen.beam).dot(wall) > ALONG)
        };
        let here = scene.rest.pose.position;
        if !feeling.missed.iter().all(met) {
            if self.may_doubt(here) {
                self.go_astray(here, None, scene);
            }
            return None;
        }
        // A wall alone leaves the way along it open.
        let found: Vec<&Vector> = feeling.asked.iter().filter(|wall| met(wall)).collect();
        if found.iter().any(|one| found.iter().any(|other| cross(**one, **other).abs() > ALONG)) {
            self.sure.at(scene.tracker.time_us());
        }
        None
    }

    /// At the corner: a turn that leads every wall past at least two switches.
    pub(super) fn look_round(&self) -> Ask {
        let between = angle::TAU / self.chassis.sensors.len().max(1) as f64;
        Ask {
            motion: Motion::Turn { angle: 2.0 * between + 0.4, rate: f64::INFINITY },
            guard: Guard::default(),
            why: "taking bearings of two walls",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::mapping::map::ContactKind;

    const FRONT: usize = 0;

    #[test]
    fn what_nobody_has_touched_is_no_wall_to_take_bearings_of() {
        let wall = Piece::with_bulge(Point::new(0.0, 0.0), Point::new(1.0, 0.0), 0.0);
        let contact = |x: f64, y: f64| Contact {
            point: Point::new(x, y),
            from: Point::new(x, 0.15),
            sensor: Some(FRONT),
            kind: ContactKind::Range,
            time: 0.0,
        };
        assert!(is_wall(&wall, &[contact(0.2, 0.002), contact(0.7, -0.002)]));
        // Corners of what stands beside a gap.
        assert!(!is_wall(&wall, &[contact(0.0, 0.0), contact(0.01, 0.0), contact(0.99, 0.01)]));
        assert!(!is_wall(&wall, &[contact(0.2, 0.1), contact(0.7, -0.1)]));
        let short = Piece::with_bulge(Point::new(0.0, 0.0), Point::new(0.2, 0.0), 0.0);
        assert!(!is_wall(&short, &[contact(0.08, 0.0), contact(0.12, 0.0)]));
    }

    fn rest(heading: f64, closed: bool, reason: DoneReason) -> AtRest {
        let closed = if closed { SwitchSet::only(FRONT) } else { SwitchSet::EMPTY };
        AtRest { pose: Pose::new(1.0, 1.0, heading), closed, reason }
    }

    fn moves(ask: Option<Ask>) -> (f64, bool) {
        let ask = ask.expect("a motion");
        let Motion::Move { distance, .. } = ask.motion else { panic!("no move: {ask:?}") };
        (distance, ask.guard.rise.has(FRONT))
    }

    #[test]
    fn a_wall_that_is_farther_off_than_believed_is_gone_to_until_it_is_seen() {
        let mut feeling = Feeling::new(vec![Vector::x(), Vector::y()], 0.2, 0);
        let turned = feeling.next(&rest(1.0, false, DoneReason::Complete), FRONT).expect("a turn");
        assert!(matches!(turned.motion, Motion::Turn { angle, .. } if (angle + 1.0).abs() < 1e-9));
        let (most, guarded) = moves(feeling.next(&rest(0.0, false, DoneReason::Complete), FRONT));
        assert!(guarded && (most - 0.2).abs() < 1e-9, "{most}");
        // It closes on the way: on to the next wall.
        let seen = DoneReason::Guard { sensor: FRONT, rising: true };
        let next = feeling.next(&rest(0.0, true, seen), FRONT).expect("a turn");
        assert!(matches!(next.motion, Motion::Turn { angle, .. } if angle > 1.5));
        // That one is not there at all.
        let up = angle::PI / 2.0;
        moves(feeling.next(&rest(up, false, DoneReason::Complete), FRONT));
        assert!(feeling.next(&rest(up, false, DoneReason::Complete), FRONT).is_none());
        assert_eq!(feeling.missed, [Vector::y()]);
    }

    #[test]
    fn a_wall_that_is_seen_already_is_not_driven_into() {
        let mut feeling = Feeling::new(vec![Vector::x()], 1.0, 0);
        assert!(feeling.next(&rest(0.0, true, DoneReason::Complete), FRONT).is_none());
    }

    #[test]
    fn what_the_bumper_meets_is_not_pushed() {
        let mut feeling = Feeling::new(vec![Vector::x()], 1.0, 0);
        moves(feeling.next(&rest(0.0, false, DoneReason::Complete), FRONT));
        assert!(feeling.next(&rest(0.0, false, DoneReason::Bumper), FRONT).is_none());
        // Nor is a turn that something holds up tried for ever.
        let mut feeling = Feeling::new(vec![Vector::x()], 1.0, 0);
        assert!(feeling.next(&rest(1.0, false, DoneReason::Complete), FRONT).is_some());
        assert!(feeling.next(&rest(0.9, false, DoneReason::Stalled), FRONT).is_none());
    }

    #[test]
    fn a_wall_leaves_the_way_along_it_open_and_a_corner_nothing() {
        let spread = Matrix2::new(0.04, 0.0, 0.0, 0.01);
        let spot = |walls: Vec<Vector>| Spot { at: Point::origin(), walls, along: None };
        assert!((spot(vec![Vector::x()]).leaves(&spread) - 0.1).abs() < 1e-3);
        assert!((spot(vec![Vector::y()]).leaves(&spread) - 0.2).abs() < 1e-3);
        assert!(spot(vec![Vector::x(), Vector::y()]).leaves(&spread) < 2e-3);
    }
}
