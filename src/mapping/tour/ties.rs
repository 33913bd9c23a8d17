//! Tying objects to the walls: when the plan is driven, what is not yet known well enough to lie where
//! it lies is measured from what it stands beside.
//!
//! Between two faces that look at each other, straight or askance, the robot goes to and fro, forwards
//! until the switch in front closes and backwards until the one behind does. Each way measures the
//! distance between them anew, and since what the wheels are off by differs from one motion to the
//! next, a few short ways say what one long line across the room cannot. Surveyors tie detail points to
//! their control points in the same way. Which faces are measured is chosen by what the survey
//! believes: where most is learnt for the metres it costs. An object that is felt for in vain where it has to
//! be, again and again, is not there.

use super::drive::{Drive, Purpose};
use super::{Doing, ROOM, Scene, Tour};
use crate::geometry::{Point, Vector, angle, perp};
use crate::mapping::chart::Chart;
use crate::mapping::event::EventKind;
use crate::mapping::floor::Floor;
use crate::mapping::follow::{Ask, STRIDE};
use crate::mapping::survey::{STRIDE_SHARE, Survey};
use crate::robot::{DoneReason, Guard, Motion, SwitchSet};

/// A face that is known to this beside what it looks at (one standard deviation across it, metres) is
/// known well enough: a contact is hardly better.
const SURE: f64 = 0.003;
/// Ways between two faces, each of which measures their distance.
const WAYS: u32 = 4;
/// Faces farther apart than this are not measured from each other, metres.
const FARTHEST: f64 = 2.5;
/// One place on a face for so many metres of it.
const EVERY: f64 = 0.3;
/// Nearer to its end a face is not measured, metres.
const MARGIN: f64 = 0.05;
/// What looks at a face does so within this cosine: what runs askance of it is felt, too.
const FACING: f64 = 0.75;
/// Ways along each other within this cosine are the same.
const SAME_WAY: f64 = 0.94;
/// What is done besides driving there costs as much time as so many metres.
const OVERHEAD: f64 = 1.5;
/// Places nearer to each other than this are the same, metres.
const SAME_PLACE: f64 = 0.15;
/// So many of the most promising places have their way looked for.
const TRIED: usize = 6;
/// Ties at most, for each object.
const MOST_FOR_EACH: usize = 4;
/// A switch looks straight ahead, or back, within this, radians.
const STRAIGHT: f64 = 0.05;
/// How far beyond where a face should be the robot goes in search of it, metres.
const BEYOND: f64 = 0.05;
/// An object is not there that was felt for in vain at so many places, and met at none.
const IN_VAIN: usize = 2;

/// Two faces that look at each other, and the way between.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    /// Index of the object.
    of: usize,
    /// Where the robot's centre is when its back is at the object.
    at: Point,
    /// Unit vector from the object to what looks at it.
    along: Vector,
    /// From `at` to where its front is at the other, metres.
    length: f64,
    /// Variance of the distance between the faces, square metres.
    spread: f64,
}

/// Going to and fro on a span.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shuttle {
    span: Span,
    /// Number of the object, which stays when others before it are taken off the map.
    of: u32,
    /// Ways that are left.
    left: u32,
    forwards: bool,
    /// Where the way in hand began.
    from: Point,
    moves: u32,
}

impl Span {
    /// What going to and fro leaves of the variance of the distance, square metres.
    fn after(&self) -> f64 {
        // Strides that are off each by itself, and a contact at either end.
        let strides = (self.length / STRIDE).max(0.5);
        let way = (STRIDE_SHARE * STRIDE).powi(2) * strides + SURE * SURE;
        let measured = way / f64::from(WAYS - 1);
        self.spread * measured / (self.spread + measured)
    }
}

/// The spans between the objects' faces and what they look at.
fn spans(chart: &Chart, floor: &Floor, survey: &Survey, radius: f64) -> Vec<Span> {
    let mut found = Vec::new();
    for (of, ring) in chart.objects().enumerate() {
        for piece in &ring.pieces {
            let room = piece.length() - 2.0 * MARGIN;
            if room < 0.0 {
                continue;
            }
            let places = (room / EVERY).ceil().max(1.0);
            for k in 0..places as u32 {
                let t = (MARGIN + room * (f64::from(k) + 0.5) / places) / piece.length();
                let (foot, along) = (piece.at(t), -perp(piece.tangent(t)));
                found.extend(span(chart, floor, survey, radius, of, (foot, along)));
            }
        }
    }
    found
}

/// The span that begins at a place on a face of the object `of` and leads straight away from it.
fn span(
    chart: &Chart,
    floor: &Floor,
    survey: &Survey,
    radius: f64,
    of: usize,
    (foot, along): (Point, Vector),
) -> Option<Span> {
    let gap = radius + ROOM + 0.01;
    let at = foot + along * gap;
    let most = (FARTHEST / 0.02) as u32;
    let length = (0..most)
        .map(|k| f64::from(k) * 0.02)
        .take_while(|s| floor.keeps(at + along * *s, radius + ROOM - 0.005))
        .last()?;
    let end = at + along * length;
    if !floor.is_drivable(at) || !floor.is_drivable(end) {
        return None;
    }
    let ahead = end + along * floor.clearance(end + along * 0.01);
    let near = chart.surface_at(survey, foot, at, 0.01)?;
    let far = chart.surface_at(survey, ahead, end, 0.04)?;
    if far.normal.dot(&along).abs() < FACING || far.tie == near.tie {
        return None;
    }
    Some(Span { of, at, along, length, spread: survey.between(&near, &far) })
}

impl Tour {
    /// The switches that look straight ahead and straight back, if there are both and they are believed: behind
    /// there is no bumper.
    fn front_and_back(&self) -> Option<(usize, usize)> {
        let towards = |bearing: f64| {
            self.chassis.sensor_towards(bearing, STRAIGHT).filter(|index| !self.out.has(*index))
        };
        towards(0.0).zip(towards(angle::PI))
    }

    /// A drive to where an object is to be measured from what it stands beside; none when all of them
    /// are known well enough, or cannot be measured better.
    pub(super) fn tie(&mut self, scene: &mut Scene<'_>) -> Option<Drive> {
        self.front_and_back()?;
        let objects = self.chart.objects().count();
        if self.tied.len() >= MOST_FOR_EACH * objects {
            return None;
        }
        let (at, radius) = (scene.rest.pose.position, self.chassis.radius);
        self.floor(at);
        let floor = self.floor.as_ref()?;
        let mut spans = spans(&self.chart, floor, scene.survey, radius);
        spans.retain(|span| {
            let done = |(place, along): &(Point, Vector)| {
                (place - span.at).norm() < SAME_PLACE && along.dot(&span.along) > SAME_WAY
            };
            let is_there = scene.map.objects.get(span.of).is_some_and(|o| !self.is_missing(o.id));
            is_there && span.spread > SURE * SURE && !self.tied.iter().any(done)
        });
        let worth = |span: &Span, way: f64| {
            let gain = span.spread - span.after();
            gain / (OVERHEAD + way + f64::from(WAYS) * span.length)
        };
        let straight = |span: &Span| worth(span, (span.at - at).norm());
        spans.sort_by(|a, b| straight(b).total_cmp(&straight(a)));
        let (_, span) = spans
            .into_iter()
            .take(TRIED)
            .filter_map(|span| {
                let way = floor.route_length(at, span.at, radius + ROOM)?;
                Some((worth(&span, way), span))
            })
            .max_by(|a, b| a.0.total_cmp(&b.0))?;
        self.tied.push((span.at, span.along));
        let id = scene.map.objects.get(span.of).map_or(0, |object| object.id);
        let (left, from) = (WAYS, span.at);
        self.to_tie = Some(Shuttle { span, of: id, left, forwards: true, from, moves: 0 });
        scene.tell.push(EventKind::Tying { id, sd: span.spread.sqrt() });
        Some(Drive { purpose: Purpose::Tie, ..Drive::new(0, span.at, span.at) })
    }

    /// At the object: to and fro from here.
    pub(super) fn begin_shuttle(&mut self) {
        self.doing = self.to_tie.take().map_or(Doing::Choosing, Doing::Tying);
    }

    /// Whether the object `id` was felt for in vain again and again, and never met. That says nothing as long as the
    /// switch has met nothing since: it may be dead.
    pub(super) fn is_missing(&self, id: u32) -> bool {
        let of_it = |(of, _): &&(u32, bool)| *of == id;
        let met = |(_, met): &(u32, bool)| *met;
        let missed = self.felt.iter().enumerate().filter(|(_, felt)| of_it(felt) && !met(felt));
        let told = missed.map(|(k, _)| k).nth(IN_VAIN - 1);
        !self.felt.iter().filter(of_it).any(met)
            && told.is_some_and(|told| self.felt[told..].iter().any(met))
    }

    /// The next motion between the two faces; none when it is over.
    pub(super) fn shuttle(
        &mut self,
        mut shuttle: Shuttle,
        reason: Option<DoneReason>,
        scene: &mut Scene<'_>,
    ) -> Option<Ask> {
        let pose = scene.rest.pose;
        let (front, back) = self.front_and_back()?;
        let ahead = if shuttle.forwards { front } else { back };
        match reason {
            Some(DoneReason::Guard { sensor, rising: true }) => {
                let seen = self.wall.log().iter().rev().find(|s| s.sensor == Some(sensor)).copied();
                if self.fixed_by.is_none() || self.fixed_by != seen.map(|seen| seen.time_us) {
                    // Not what was to be measured: this leads nowhere.
                    return None;
                }
                if sensor == ahead {
                    if !shuttle.forwards {
                        self.felt.push((shuttle.of, true));
                    }
                    shuttle.left -= 1;
                    shuttle.forwards = !shuttle.forwards;
                    shuttle.from = pose.position;
                }
            }
            Some(DoneReason::Complete) | None => {}
            Some(_) => return None,
        }
        let most = shuttle.span.length + BEYOND;
        let gone = (pose.position - shuttle.from).norm();
        shuttle.moves += 1;
        if gone > most && !shuttle.forwards {
            // What looks at it was met, and so the robot is where it believes it is.
            self.felt.push((shuttle.of, false));
        }
        if shuttle.left == 0 || gone > most || shuttle.moves > 8 * WAYS {
            return None;
        }
        let ahead = if shuttle.forwards { front } else { back };
        let turn = angle::wrap(angle::of(shuttle.span.along) - pose.heading);
        let motion = if turn.abs() > 0.02 {
            Motion::Turn { angle: turn, rate: f64::INFINITY }
        } else {
            let sign = if shuttle.forwards { 1.0 } else { -1.0 };
            let distance = sign * (most - gone + 0.01).min(STRIDE);
            Motion::Move { distance, speed: f64::INFINITY }
        };
        let turning = matches!(motion, Motion::Turn { .. });
        let rise = if turning { SwitchSet::EMPTY } else { SwitchSet::only(ahead) };
        self.doing = Doing::Tying(shuttle);
        Some(Ask {
            motion,
            guard: Guard { rise, fall: SwitchSet::EMPTY },
            why: "measuring an object from what it stands beside",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::room_gone_along;
    use super::*;
    use crate::geometry::{Pose, Ring};
    use crate::mapping::follow::AtRest;
    use crate::mapping::map::{MappedObject, ObjectClass, RoomMap};
    use crate::mapping::shape;
    use crate::mapping::survey::Hung;
    use crate::robot::Chassis;

    /// From which places on a box what stands above it is felt for: a wall that rises by `slope` from left to
    /// right, at least 1.5 m off it, in a room of 4 m.
    fn felt_above(slope: f64) -> Vec<Span> {
        let height = |x: f64| 2.0 + slope * x;
        let ring =
            |corners: [(f64, f64); 4]| Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        let room = ring([(0.0, 0.0), (4.0, 0.0), (4.0, height(4.0)), (0.0, height(0.0))]);
        let thing = ring([(0.4, 0.4), (1.0, 0.4), (1.0, 0.8), (0.4, 0.8)]);
        let chassis = Chassis::default();
        let mut survey = Survey::new(0.003);
        survey.mark(Point::origin(), 0);
        let shape = shape::identify(room.clone(), &[]);
        let mut chart = Chart::new(&RoomMap { shape: Some(shape), ..RoomMap::default() }, &survey);
        let tie = survey.mark(Point::new(0.7, 0.2), 1);
        let (class, outline, contacts) = (ObjectClass::Rectangle, thing.clone(), Vec::new());
        let object = MappedObject { id: 1, class, outline, closed: true, contacts };
        chart.add(&object, Hung::Once(tie));
        let floor = Floor::new(&room, &[&thing], &chassis, Point::new(2.0, 1.0));
        let found = spans(&chart, &floor, &survey, chassis.radius);
        found.into_iter().filter(|span| span.along.y > 0.9).collect()
    }

    #[test]
    fn nothing_is_measured_with_a_switch_that_is_not_believed() {
        let (settings, map, _) = room_gone_along(0.16);
        let mut tour = Tour::new(&settings, &map, &Survey::new(0.003));
        assert_eq!(tour.front_and_back(), Some((0, 4)));
        for (out, still) in [(4, false), (0, false), (2, true)] {
            tour.distrust(SwitchSet::only(out));
            assert_eq!(tour.front_and_back().is_some(), still, "without switch {out}");
        }
    }

    #[test]
    fn walls_that_run_askance_are_felt_for_and_those_that_run_away_are_not() {
        let (level, askance, away) = (felt_above(0.0), felt_above(0.6), felt_above(1.2));
        assert_eq!((level.len(), askance.len(), away.len()), (2, 2, 0));
        for (flat, steep) in level.iter().zip(&askance) {
            assert!((flat.at - steep.at).norm() < 1e-9);
            assert!(flat.length < 1.2 && steep.length > flat.length + 0.1, "{steep:?}");
        }
    }

    #[test]
    fn what_is_felt_for_in_vain_twice_is_not_there() {
        let (settings, mut map, mut tracker) = room_gone_along(0.16);
        let mut survey = Survey::new(0.003);
        survey.mark(settings.start.position, 0);
        let corners =
            [(1.0, 0.6), (1.6, 0.6), (1.6, 0.8), (1.0, 0.8)].map(|(x, y)| Point::new(x, y));
        let outline = Ring::polygon(&corners);
        let (class, contacts) = (ObjectClass::Rectangle, Vec::new());
        map.objects.push(MappedObject { id: 4, class, outline, closed: false, contacts });
        let mut tour = Tour::new(&settings, &map, &survey);
        // Below it, its back to it, and the wall of the room 0.32 m before it.
        let mut told = Vec::new();
        for (x, still_there) in [(1.2, true), (1.4, false)] {
            let at = Point::new(x, 0.46);
            let span = Span { of: 0, at, along: -Vector::y(), length: 0.32, spread: 1e-4 };
            let from = at - Vector::y() * 0.32;
            // Backwards, and farther than it can be.
            let pose = Pose { position: at + Vector::y() * 0.06, heading: -angle::FRAC_PI_2 };
            let rest = AtRest { pose, closed: SwitchSet::EMPTY, reason: DoneReason::Complete };
            let mut scene = Scene {
                tracker: &mut tracker,
                survey: &mut survey,
                rest,
                map: &mut map,
                tell: &mut told,
            };
            let shuttle = Shuttle { span, of: 4, left: 3, forwards: false, from, moves: 2 };
            let over = tour.shuttle(shuttle, Some(DoneReason::Complete), &mut scene);
            assert_eq!(over, None, "at {x} m");
            assert!(!tour.take_away_impossible(&mut scene), "the switch may be dead");
            tour.felt.push((1, true));
            assert_eq!(tour.take_away_impossible(&mut scene), !still_there, "at {x} m");
        }
        assert_eq!(told, [EventKind::ObjectRefuted { id: 4 }]);
        assert!(map.objects.is_empty());
        // Met once, it is there, wherever else it is not.
        tour.felt = vec![(5, false), (5, true), (5, false)];
        assert!(!tour.is_missing(5));
    }
}
