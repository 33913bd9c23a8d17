//! Whether the robot can be where it believes it is. What is met where the body has been before, or beyond
//! the room, cannot be there; nor can anything gone round hold places where the body has been, or reach
//! into what is mapped, nor what is mapped stop the robot again and again where the map leaves it a way; and what
//! it did not get round, and stands nowhere off the wall, is the wall, and what was felt for in vain is not there.
//! Either something has moved or the robot is astray, and a robot that is astray maps everything twice. It finds such
//! contradictions and takes off the map what they show to be wrong; the robot's place is looked for by the
//! mission, as after it was carried.

use super::{Scene, Tour, finish};
use crate::geometry::{Point, Ring};
use crate::mapping::event::EventKind;
use crate::mapping::floor::Coverage;
use crate::mapping::follow::Side;
use crate::mapping::map::{Contact, LineStatus, MappedObject, ObjectClass, PathPoint, RoomMap};
use crate::mapping::shape::Thing;
use crate::mapping::wall::Wall;

/// Path and contacts err together by no more than this, metres, where the pose is known well: what lies
/// deeper than it in where the body has been is not there.
const ERRS: f64 = 0.04;
/// Elsewhere they err by so many standard deviations of the pose.
const DEVIATIONS: f64 = 2.5;
/// The far side of something gone round errs by so much more of the way round it.
const LED_ROUND: f64 = 0.004;
/// Outlines are looked at every so often, metres.
const STEP: f64 = 0.05;
/// Nearer to a place where the robot was in doubt before it is not so again, metres: what is met there
/// has moved, or is new.
const SAME_PLACE: f64 = 0.6;
/// So many contacts may lie anywhere.
const STRAYS: usize = 3;
/// Of things that are one this share of either's edge, at least, lies deep in the other, ...
const MOSTLY: f64 = 0.3;
/// ... or this share no farther off the other than so many metres.
const ALL: f64 = 0.9;
const SAME_EDGE: f64 = 0.08;
/// Of a thing that stands at a wall no more than this share lies beyond that.
const SOME: f64 = 0.15;
/// Doubts at most, so that a tour always ends.
const MOST_DOUBTS: usize = 24;

/// A robot that is astray: on which hand it follows what, with what it saw of that; none when it is beside
/// nothing.
#[derive(Debug, Clone)]
pub struct Astray {
    /// The hand, and the contacts.
    pub beside: Option<(Side, Wall)>,
}

/// A place where something was met that cannot be there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Doubt {
    at: Point,
    /// The robot has found out where it is since.
    settled: bool,
}

/// Whether `p` is nearer than `radius` to one of the places where the body has been.
fn has_been(mut path: impl Iterator<Item = Point>, radius: f64, p: Point) -> bool {
    path.any(|place| (place - p).norm() < radius)
}

/// Whether any of `points` lies within `ring`, deeper than `depth`.
fn holds(ring: &Ring, depth: f64, points: impl IntoIterator<Item = Point>) -> bool {
    let deep = |p: &Point| ring.contains(*p) && ring.distance(*p) > depth;
    points.into_iter().any(|p| deep(&p))
}

/// Places on a ring, no farther apart than the step.
fn edge(ring: &Ring) -> impl Iterator<Item = Point> {
    ring.pieces.iter().flat_map(|piece| {
        let count = (piece.length() / STEP).ceil().max(1.0);
        (0..count as u32).map(move |k| piece.at(f64::from(k) / count))
    })
}

/// Which share of `points` is `so`, 0 to 1.
fn share(points: impl Iterator<Item = Point>, so: impl Fn(Point) -> bool) -> f64 {
    let (of, all) =
        points.fold((0.0_f64, 0.0_f64), |(of, all), p| (of + f64::from(so(p)), all + 1.0));
    of / all.max(1.0)
}

/// Whether what is `one` is where the `other` is, or part of it.
fn is_in(one: &Ring, other: &Ring) -> bool {
    let on = |p: Point| other.contains(p) || other.distance(p) < SAME_EDGE;
    share(edge(one), |p| holds(other, ERRS, [p])) > MOSTLY || share(edge(one), on) > ALL
}

/// Whether a ring lies beyond the `outline` of the room.
fn lies_beyond(outline: &Ring, ring: &Ring) -> bool {
    let beyond = |p: Point| !outline.contains(p) && outline.distance(p) > ERRS;
    share(edge(ring), beyond) > SOME
}

/// Whether what was not gone round was touched nowhere off the `outline` of the room: it is the wall, followed by a
/// robot that was astray. (What only joins the touches, across a bay of the wall, says nothing.)
fn is_wall(outline: &Ring, object: &MappedObject) -> bool {
    let on_it = |contact: &Contact| outline.distance(contact.point) < SAME_EDGE;
    !object.closed && !object.contacts.is_empty() && object.contacts.iter().all(on_it)
}

/// Which of the `rings`, closed or not, are `wrong`, or stand where another does: of two it is the one that was
/// not gone round to the end, or is part of the other, or came later.
fn or_twice(rings: &[(&Ring, bool)], mut wrong: Vec<bool>) -> Vec<bool> {
    for (k, (late, late_closed)) in rings.iter().enumerate() {
        for (j, (early, early_closed)) in rings[..k].iter().enumerate() {
            let (in_early, in_late) = (is_in(late, early), is_in(early, late));
            if wrong[j] || wrong[k] || !(in_early || in_late) {
                continue;
            }
            let early_goes = if late_closed == early_closed { !in_early } else { *late_closed };
            wrong[if early_goes { j } else { k }] = true;
        }
    }
    wrong
}

/// Whether two rings share more than an edge of this `depth`.
fn overlap(a: &Ring, b: &Ring, depth: f64) -> bool {
    holds(a, depth, edge(b)) || holds(b, depth, edge(a))
}

impl Tour {
    /// By how much path and contacts may be off each other at `p`, metres.
    fn errs_by(&self, p: Point, scene: &Scene<'_>) -> f64 {
        ERRS.max(DEVIATIONS * self.chart.looseness(scene.survey, p))
    }

    /// Where the body has been for sure.
    fn been<'a>(&'a self, scene: &'a Scene<'_>) -> impl Iterator<Item = Point> + 'a {
        let sure = |place: &&PathPoint| !self.sure.was_astray(place.time_us);
        scene.tracker.path().iter().filter(sure).map(|place| place.pose.position)
    }

    /// Whether a thing cannot be where it was met.
    pub(super) fn cannot_be_at(&self, p: Point, scene: &Scene<'_>) -> bool {
        if !self.may_doubt(p) {
            return false;
        }
        let (errs, outline) = (self.errs_by(p, scene), self.chart.outline());
        (!outline.contains(p) && outline.distance(p) > errs)
            || has_been(self.been(scene), self.chassis.radius - errs, p)
    }

    /// The middle of one of the things that were gone round which cannot be where it seems to be.
    pub(super) fn cannot_be(&self, found: &[Thing], scene: &Scene<'_>) -> Option<Point> {
        let outline = self.chart.outline();
        let is_wrong = |ring: &&Ring| {
            let errs = self.errs_by(ring.middle(), scene) + LED_ROUND * ring.perimeter();
            let outside = |p: Point| !outline.contains(p) && outline.distance(p) > errs;
            self.may_doubt(ring.middle())
                && (holds(ring, errs, self.been(scene))
                    || self.chart.objects().any(|other| overlap(ring, other, errs))
                    || edge(ring).any(outside))
        };
        found.iter().map(|thing| &thing.outline).find(is_wrong).map(Ring::middle)
    }

    /// The robot has found its place at `now_us`, robot time in microseconds: its last doubt is settled. What it
    /// left open since the doubt before, and since its place was last sure, leaves the map, for a robot that is
    /// astray takes a wall for something that it cannot go round; what is there is met again.
    pub fn settle_doubt(&mut self, now_us: u64, map: &mut RoomMap, tell: &mut Vec<EventKind>) {
        if let Some(doubt) = self.doubts.last_mut() {
            doubt.settled = true;
        }
        let since = std::mem::replace(&mut self.settled_us, now_us).max(self.sure_us());
        let open =
            |object: &MappedObject| object.class == ObjectClass::Open && object.seen_us().0 > since;
        let wrong: Vec<bool> = map.objects.iter().map(open).collect();
        self.take_away(&wrong, map, tell);
    }

    /// When the robot's place was last sure beyond doubt, microseconds of robot time.
    #[must_use]
    pub fn sure_us(&self) -> u64 {
        self.sure.since_us()
    }

    /// The robot's place is sure at `now_us`, microseconds of robot time.
    pub fn be_sure(&mut self, now_us: u64) {
        self.sure.at(now_us);
    }

    /// Takes back all that was done since the robot's place was last sure, since it was somewhere else by
    /// then: objects leave the map, lines are driven again, and where it was is not known to be swept.
    /// `until_us`, robot time in microseconds, is when it began to look for its place.
    pub fn take_back(&mut self, until_us: u64, map: &mut RoomMap, tell: &mut Vec<EventKind>) {
        let since = |object: &MappedObject| object.seen_us().1 > self.sure_us();
        let wrong: Vec<bool> = map.objects.iter().map(since).collect();
        self.take_away(&wrong, map, tell);
        self.sure.was_not_until(until_us);
        let ended = self.sure.take_ended();
        let lines = ended.len();
        for (id, backwards) in ended.into_iter().rev() {
            let lines = map.plan.iter_mut().flat_map(|plan| &mut plan.lines);
            for line in lines.filter(|line| line.id == id) {
                self.driven -= line.drive.map_or(0.0, |(a, b)| (b - a).norm());
                finish(line, LineStatus::Planned, None);
            }
            self.halves.retain(|half| half.line() != id);
            self.queue.push_front((id, backwards));
        }
        (self.covered, self.coverage) = (0, Coverage::new());
        self.given_up.clear();
        tell.push(EventKind::TakenBack { lines });
    }

    /// Takes away again what was mapped while the robot was astray. Things that were doubted before, and gone
    /// round once more `since` (robot time, microseconds) from a place that was found anew, are where they are:
    /// what reaches into them, or stands where the robot went round them, is not.
    pub(super) fn refute(&mut self, found: &[Thing], since: u64, scene: &mut Scene<'_>) {
        let settled = |p: Point| {
            self.doubts.iter().any(|doubt| doubt.settled && (doubt.at - p).norm() < SAME_PLACE)
        };
        if !found.iter().any(|thing| settled(thing.outline.middle())) {
            return;
        }
        let path = scene.tracker.path();
        let round = &path[path.partition_point(|place| place.time_us < since)..];
        let refuted = |ring: &Ring| {
            holds(ring, ERRS, round.iter().map(|place| place.pose.position))
                || found.iter().any(|thing| overlap(ring, &thing.outline, ERRS))
        };
        let wrong: Vec<bool> = self.chart.objects().map(refuted).collect();
        self.take_away(&wrong, scene.map, scene.tell);
    }

    /// Takes away what is twice on the map, what lies beyond the room, what is its wall, and what was felt for in
    /// vain, now that all lines are driven; whether there was anything.
    pub(super) fn take_away_impossible(&mut self, scene: &mut Scene<'_>) -> bool {
        let (outline, objects) = (self.chart.outline(), &scene.map.objects);
        let rings: Vec<(&Ring, bool)> =
            self.chart.objects().zip(objects.iter().map(|object| object.closed)).collect();
        let is_wrong = |(&(ring, _), object): (&(&Ring, bool), &MappedObject)| {
            lies_beyond(outline, ring) || is_wall(outline, object)
        };
        let mut wrong = or_twice(&rings, rings.iter().zip(objects).map(is_wrong).collect());
        for (wrong, object) in wrong.iter_mut().zip(objects) {
            *wrong |= self.is_missing(object.id);
        }
        self.take_away(&wrong, scene.map, scene.tell);
        wrong.contains(&true)
    }

    /// Takes away what turns out to be twice on the `map`, or its wall, now that all of it was adjusted.
    pub fn take_away_twice(&mut self, map: &mut RoomMap, tell: &mut Vec<EventKind>) {
        let rings: Vec<(&Ring, bool)> =
            map.objects.iter().map(|object| (&object.outline, object.closed)).collect();
        let outline = map.shape.as_ref().map(|shape| &shape.outline);
        let is_walls = |object| outline.is_some_and(|outline| is_wall(outline, object));
        let wrong = or_twice(&rings, map.objects.iter().map(is_walls).collect());
        self.take_away(&wrong, map, tell);
    }

    /// Takes the objects away that are `wrong`.
    fn take_away(&mut self, wrong: &[bool], map: &mut RoomMap, tell: &mut Vec<EventKind>) {
        for index in (0..wrong.len()).rev().filter(|index| wrong[*index]) {
            self.chart.remove(index);
            let id = map.objects.remove(index).id;
            map.taken_away = map.taken_away.max(id);
            tell.push(EventKind::ObjectRefuted { id });
            self.floor = None;
        }
    }

    /// Where one of the contacts lies of something that cannot be there, if it is more than a few that cannot.
    pub(super) fn cannot_be_there(&self, seen: &[Contact], scene: &Scene<'_>) -> Option<Point> {
        let mut impossible =
            seen.iter().map(|contact| contact.point).filter(|p| self.cannot_be_at(*p, scene));
        impossible.nth(STRAYS)
    }

    fn was_doubted(&self, p: Point) -> bool {
        self.doubts.iter().any(|doubt| (doubt.at - p).norm() < SAME_PLACE)
    }

    pub(super) fn may_doubt(&self, p: Point) -> bool {
        self.may_doubt_again() && !self.was_doubted(p)
    }

    /// Whether there may be one more doubt, wherever that is.
    pub(super) fn may_doubt_again(&self) -> bool {
        self.doubts.len() < MOST_DOUBTS
    }

    /// Leaves what it was doing: the robot is astray, since what it is `beside`, or has come from, cannot be
    /// at `p`, or is not there. The line in hand is driven again.
    pub(super) fn go_astray(
        &mut self,
        p: Point,
        beside: Option<(Side, Wall)>,
        scene: &mut Scene<'_>,
    ) {
        self.doubts.push(Doubt { at: p, settled: false });
        self.interrupt(scene.map);
        self.astray = Some(Box::new(Astray { beside }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;
    use crate::mapping::map::ContactKind;

    #[test]
    fn nothing_is_where_the_body_has_been() {
        let path = || (0..100).map(|k| Point::new(f64::from(k) * 0.01, 0.0));
        assert!(has_been(path(), 0.06, Point::new(0.5, 0.04)));
        assert!(!has_been(path(), 0.06, Point::new(0.5, 0.09)));
        assert!(!has_been(path(), 0.06, Point::new(1.2, 0.0)));
    }

    fn square(x: f64, y: f64, side: f64) -> Ring {
        let corners = [(0.0, 0.0), (0.0, side), (side, side), (side, 0.0)];
        Ring::polygon(&corners.map(|(dx, dy)| Point::new(x + dx, y + dy)))
    }

    #[test]
    fn two_things_in_one_place_are_one_and_neighbours_are_two() {
        let crate_ = square(1.0, 1.0, 1.0);
        for (x, y) in [(1.0, 1.0), (1.03, 0.98), (1.3, 1.2)] {
            assert!(is_in(&square(x, y, 1.0), &crate_), "{x} {y}");
        }
        assert!(is_in(&square(1.4, 1.4, 0.2), &crate_), "within it");
        assert!(!is_in(&square(1.95, 1.0, 1.0), &crate_), "beside it, 5 cm wrong");
        assert!(!is_in(&square(2.03, 1.4, 0.2), &crate_), "a small one beside it");
    }

    #[test]
    fn of_two_things_in_one_place_the_whole_one_stays() {
        let table = square(2.0, 2.0, 1.0);
        // What was seen of its long side when it could not be gone round, and one of its corners.
        let side = [(2.0, 2.0), (3.0, 2.0), (3.0, 2.01), (2.0, 2.01)];
        let side = Ring::polygon(&side.map(|(x, y)| Point::new(x, y)));
        let corner = square(2.0, 2.0, 0.2);
        let again = square(2.05, 1.97, 1.0);
        let beyond = square(5.9, 2.0, 0.5);
        let judged = |rings: &[(&Ring, bool)]| or_twice(rings, vec![false; rings.len()]);
        assert_eq!(judged(&[(&side, false), (&table, true)]), [true, false]);
        assert_eq!(judged(&[(&table, true), (&side, false)]), [false, true]);
        assert_eq!(judged(&[(&corner, true), (&table, true)]), [true, false]);
        assert_eq!(judged(&[(&table, true), (&again, true)]), [false, true], "the later one");
        let rings = [(&beyond, true), (&table, true), (&again, true)];
        assert_eq!(judged(&rings), [false, false, true], "twice, and no more");
        let known = or_twice(&[(&table, true), (&again, true)], vec![true, false]);
        assert_eq!(known, [true, false], "where the one is wrong the other stands there alone");
    }

    #[test]
    fn a_thing_at_the_wall_is_within_the_room() {
        let room = square(0.0, 0.0, 4.0);
        assert!(!lies_beyond(&room, &square(-0.03, 1.0, 0.5)));
        assert!(lies_beyond(&room, &square(-0.2, 1.0, 0.3)));
        assert!(lies_beyond(&room, &square(3.9, 2.0, 0.5)));
    }

    #[test]
    fn what_was_not_gone_round_and_stands_nowhere_off_the_wall_is_the_wall() {
        let room = square(0.0, 0.0, 4.0);
        let touched = |p: Point| Contact {
            point: p,
            from: p + Vector::new(0.0, 0.16),
            sensor: None,
            kind: ContactKind::Range,
            time: 0.0,
        };
        let seen = |points: &[(f64, f64)], closed: bool| {
            let points: Vec<Point> = points.iter().map(|&(x, y)| Point::new(x, y)).collect();
            let contacts = points.iter().copied().map(touched).collect();
            let outline = Ring::polygon(&points);
            MappedObject { id: 1, class: ObjectClass::Open, outline, closed, contacts }
        };
        let along =
            |off: f64, thick: f64| [(1.0, off), (1.0, off + thick), (3.5, off + thick), (3.5, off)];
        let judged = |points: &[(f64, f64)], closed: bool| is_wall(&room, &seen(points, closed));
        assert!(judged(&along(0.03, 0.02), false));
        assert!(judged(&along(-0.02, 0.03), false));
        assert!(!judged(&along(0.03, 0.02), true), "the robot went round it");
        assert!(!judged(&along(0.03, 0.2), false), "a cupboard");
        assert!(!judged(&along(0.12, 0.02), false), "a board before the wall");
        // Two walls and their corner: what joins their ends runs across the room.
        assert!(judged(&[(0.02, 1.5), (0.02, 0.0), (0.5, 0.02), (1.5, 0.02)], false));
    }

    #[test]
    fn a_thing_holds_what_lies_deep_in_it() {
        let square: Vec<Point> =
            [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)].map(|(x, y)| Point::new(x, y)).into();
        let ring = Ring::polygon(&square);
        assert!(holds(&ring, 0.04, [Point::new(2.0, 0.5), Point::new(0.5, 0.9)]));
        assert!(!holds(&ring, 0.04, [Point::new(0.5, 0.98), Point::new(0.5, 1.2)]));
    }
}
