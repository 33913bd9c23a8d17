//! Where neighbouring runs meet: in the corner where their lines or circles intersect, if the
//! contacts allow it, else by a straight link from the last contact of one to the first of the
//! next. Knows nothing of how the runs were found.

use super::Sample;
use super::segment::{Model, Run};
use crate::geometry::segment::Segment;
use crate::geometry::simple::segments_meet;
use crate::geometry::{Point, Vector, angle, cross, meeting};

/// Farthest an outer corner may lie beyond the contacts next to it, metres.
const OUTER_REACH: f64 = 0.25;
/// Farthest an inner corner may lie beyond what the body's roundness explains, metres.
const INNER_SLACK: f64 = 0.25;
/// Farthest a line and an arc that touch may do so beyond the contacts next to it, or a wall may meet another
/// where that begins, metres: along a wall that goes on the robot looks every half metre.
const SMOOTH_REACH: f64 = 0.65;
/// A round run meets its neighbour in no sharper corner, radians of turn: a column beside a face would
/// be drawn out through the gap between them to where it touches the line of that face.
const SHARPEST: f64 = 150.0 * angle::PI / 180.0;
/// How far off an extended run may be at its corner for want of direction, metres.
const UNCERTAIN: f64 = 0.008;

/// How far a straight run may be drawn out to a corner, as a share of its length: what is less than
/// this of wall says little of the rest.
const OF_LENGTH: f64 = 0.8;
/// The same to an inner corner that its neighbour ends no farther from than this, metres.
const TO_A_WALL: f64 = 1.3;
const TO_THE_END: f64 = 0.1;
/// An inner corner that may not be drawn to its end is drawn out by this share of the way.
const SHORT: f64 = 0.8;

/// A piece longer than this cuts off no corner, metres.
const MOST_CUT: f64 = 0.2;
/// Walls at a corner that was cut off are at least this long, metres, ...
const LEAST_WALL: f64 = 0.3;
/// ... and meet at no flatter angle than this (sine).
const FLATTEST: f64 = 0.15;
/// At a flatter angle than this (sine) a contact on the piece may be of either wall.
const SQUARE_ENOUGH: f64 = 0.5;
/// A contact nearer than this to an end of a piece is of the wall there, metres.
const ENDS: f64 = 0.02;

/// Where one run ends and the next begins; the same point for a corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Joint {
    pub(super) end: Point,
    pub(super) start: Point,
}

/// What joints are judged by.
pub(super) struct Judge<'a> {
    pub(super) samples: &'a [Sample],
    /// Noise of a contact, metres.
    pub(super) sigma: f64,
    /// Body radius plus range of the switches, metres.
    pub(super) reach: f64,
}

impl Judge<'_> {
    /// A piece that no contact is farther from than this explains them all, metres.
    pub(super) fn tolerance(&self) -> f64 {
        3.0 * self.sigma + 0.003
    }

    /// The joint from run `a` to run `b`, which follows it.
    pub(super) fn joint(&self, a: &Run, b: &Run) -> Joint {
        let (end, start) = (self.foot(a, a.last), self.foot(b, b.first));
        match self.corner(a, b, end, start) {
            Some(corner) => Joint { end: corner, start: corner },
            None => self.thin_end(a, b).unwrap_or_else(|| self.link(a, b)),
        }
    }

    /// The joint from run `a` to run `b`, an inner corner cut off shortly before it.
    pub(super) fn short_joint(&self, a: &Run, b: &Run) -> Joint {
        let Joint { end, start } = self.joint(a, b);
        let short = |run: &Run, last: usize| {
            let foot = self.foot(run, last);
            foot + (end - foot) * SHORT
        };
        let (short_end, short_start) = (short(a, a.last), short(b, b.first));
        let is_inner = cross(end - short_end, short_start - start) > 0.0;
        if end != start || !is_inner {
            return Joint { end, start };
        }
        Joint { end: short_end, start: short_start }
    }

    /// The joint that invents nothing: from the last contact straight to the first.
    pub(super) fn link(&self, a: &Run, b: &Run) -> Joint {
        let (end, start) = (self.foot(a, a.last), self.foot(b, b.first));
        if (end - start).norm() < 0.003 {
            let middle = nalgebra::center(&end, &start);
            return Joint { end: middle, start: middle };
        }
        Joint { end, start }
    }

    /// Contact `k` moved onto the run.
    fn foot(&self, run: &Run, k: usize) -> Point {
        let p = self.samples[k].point;
        match run.model {
            Model::Lone(at) => at,
            Model::Line { center, direction } => center + direction * (p - center).dot(&direction),
            Model::Arc { center, radius, .. } => {
                let out = (p - center).try_normalize(1e-9).unwrap_or_else(Vector::x);
                center + out * radius
            }
        }
    }

    fn corner(&self, a: &Run, b: &Run, end: Point, start: Point) -> Option<Point> {
        let middle = nalgebra::center(&end, &start);
        let candidates = intersections(&a.model, &b.model, self.noise());
        let corner = candidates
            .into_iter()
            .flatten()
            .min_by(|p, q| (p - middle).norm().total_cmp(&(q - middle).norm()))?;
        let (u, v) = (heading(&a.model, corner)?, heading(&b.model, corner)?);
        let turn = angle::atan2(cross(u, v), u.dot(&v));
        let is_round = |run: &Run| matches!(run.model, Model::Arc { .. });
        if (is_round(a) || is_round(b)) && turn.abs() > SHARPEST {
            return None;
        }
        let beyond_a = (corner - end).dot(&u);
        let beyond_b = (start - corner).dot(&v);
        // Contacts behind a corner are cut off by it: only as far as noise explains.
        let back = self.noise() / angle::sin(turn.abs().min(1.57)).max(0.01);
        let smooth = turn.abs() < 0.1;
        let behind = if smooth { 0.35 } else { back.min(0.06) };
        // A joint that leaves nothing of a run would turn it round.
        let behind = |run: &Run| behind.min(self.span(run));
        if beyond_a < -behind(a) || beyond_b < -behind(b) {
            return None;
        }
        let limit = if smooth {
            SMOOTH_REACH
        } else if turn > 0.0 {
            // The body touches both walls of an inner corner this far from it.
            let interior = (angle::PI - turn).max(0.1);
            self.reach / angle::tan(interior / 2.0).max(0.05) + INNER_SLACK
        } else {
            OUTER_REACH
        };
        // A wall that leads to where its neighbour ends is believed to go that far.
        let fits = |run: &Run, beyond: f64, other: f64| {
            let (share, limit) = if turn > 0.0 && other < TO_THE_END {
                (TO_A_WALL, limit.max(SMOOTH_REACH))
            } else {
                (OF_LENGTH, limit)
            };
            beyond < limit.min(self.trusted(run, share))
        };
        if !fits(a, beyond_a, beyond_b) || !fits(b, beyond_b, beyond_a) {
            return None;
        }
        (smooth || !self.seen_through(a, b, end, corner, start)).then_some(corner)
    }

    /// From the first contact of the run to its last, metres.
    fn span(&self, run: &Run) -> f64 {
        (self.foot(run, run.last) - self.foot(run, run.first)).norm()
    }

    /// Farther than this off its wall a contact is not by noise alone, metres.
    fn noise(&self) -> f64 {
        3.0 * self.sigma + 0.002
    }

    /// How far the direction of a run can be trusted beyond its contacts, metres: a straight one of more than
    /// two contacts by no more than `share` of its length.
    fn trusted(&self, run: &Run, share: f64) -> f64 {
        let count = (run.last - run.first + 1) as f64;
        let length = (self.samples[run.last].point - self.samples[run.first].point).norm();
        match run.model {
            Model::Lone(_) => 0.0,
            Model::Arc { radius, .. } => radius,
            Model::Line { .. } if count < 3.0 => {
                (length + 0.01).min(UNCERTAIN * length / (1.5 * self.sigma))
            }
            Model::Line { .. } => (UNCERTAIN * length / (3.5 * self.sigma / count.sqrt()))
                .min(self.reach.max(share * length)),
        }
    }

    /// Whether a beam that ended on a wall near by passed through the two extensions.
    fn seen_through(&self, a: &Run, b: &Run, end: Point, corner: Point, start: Point) -> bool {
        let low = a.last.saturating_sub(8).max(a.first);
        let near = |run: &Run, from_end: bool| {
            let range =
                if from_end { low..=run.last } else { run.first..=run.last.min(run.first + 8) };
            self.samples[range].iter()
        };
        near(a, true).chain(near(b, false)).any(|s| {
            let beam = s.point - s.from;
            let length = beam.norm();
            let stop = s.from + beam * ((length - 0.012 - 3.0 * self.sigma) / length).max(0.0);
            segments_meet(s.from, stop, end, corner) || segments_meet(s.from, stop, corner, start)
        })
    }

    /// The inner corner that the piece from `b` to `c` cuts off the walls `a`-`b` and `c`-`d`; none where
    /// that is not how it is: where the piece was touched, the walls do not meet there, or a beam went
    /// through where they would.
    pub(super) fn cut_off(&self, [a, b, c, d]: [Point; 4]) -> Option<Point> {
        let (wall, cut, other) = (b - a, c - b, d - c);
        let (length, across) = (wall.norm(), cut.norm());
        let shortest = length.min(other.norm());
        if across > MOST_CUT || shortest < LEAST_WALL.max(3.0 * across) {
            return None;
        }
        let sine = cross(wall, other) / (length * other.norm());
        if sine < FLATTEST {
            return None;
        }
        let corner = a + wall * meeting(a, wall, c, other);
        let beyond = (corner - b).dot(&wall) / length;
        let before = (c - corner).dot(&other) / other.norm();
        if !(0.0..self.reach).contains(&beyond) || !(0.0..self.reach).contains(&before) {
            return None;
        }
        let near = |s: &&Sample| (s.point - corner).norm() < 2.0 * self.reach;
        let spoken_for = self.samples.iter().filter(near).any(|s| {
            let along = (s.point - b).dot(&cut) / across;
            let walls = [Segment::new(b, corner), Segment::new(corner, c)];
            let off = |wall: &Segment| wall.distance_squared(s.point).sqrt();
            let of_the_cut = if sine < SQUARE_ENOUGH {
                walls.iter().all(|wall| off(wall) > self.noise())
            } else {
                cross(cut, s.point - b).abs() / across < ENDS / 2.0
            };
            let touched = (ENDS..across - ENDS).contains(&along) && of_the_cut;
            let beam = s.point - s.from;
            let stop = s.from + beam * (1.0 - (0.012 + 3.0 * self.sigma) / beam.norm()).max(0.0);
            touched
                || segments_meet(s.from, stop, b, corner)
                || segments_meet(s.from, stop, corner, c)
        });
        (!spoken_for).then_some(corner)
    }

    /// The end of a thin wall, whose end face gave no contacts: both faces are drawn out to where
    /// the beams that slid off say that it ends.
    fn thin_end(&self, a: &Run, b: &Run) -> Option<Joint> {
        let (Model::Line { direction: u, .. }, Model::Line { direction: v, .. }) =
            (a.model, b.model)
        else {
            return None;
        };
        let (end, start) = (self.foot(a, a.last), self.foot(b, b.first));
        if u.dot(&v) > -0.8 || (end - start).norm() > 0.25 {
            return None;
        }
        let along = |p: Point| (p - end).dot(&u);
        let tip = self.samples[a.last]
            .edges
            .iter()
            .map(|&p| along(p))
            .filter(|&s| s < 0.12)
            .fold(along(start).max(0.0), f64::max);
        Some(Joint {
            end: end + u * tip,
            start: start - v * (tip + (start - end).dot(&v)).max(0.0),
        })
    }
}

/// Unit direction of travel along the run's line or circle at `p`.
pub(super) fn heading(model: &Model, p: Point) -> Option<Vector> {
    match *model {
        Model::Lone(_) => None,
        Model::Line { direction, .. } => Some(direction),
        Model::Arc { center, hollow, .. } => {
            let out = (p - center).try_normalize(1e-9)?;
            let forward = crate::geometry::perp(out);
            Some(if hollow { forward } else { -forward })
        }
    }
}

/// Where two models meet; a near miss of at most `slack` counts as touching.
fn intersections(a: &Model, b: &Model, slack: f64) -> [Option<Point>; 2] {
    match (*a, *b) {
        (Model::Lone(_), _) | (_, Model::Lone(_)) => [None, None],
        (Model::Line { center, direction }, Model::Line { center: other, direction: along }) => {
            if cross(direction, along).abs() < 0.01 {
                return [None, None];
            }
            [Some(center + direction * meeting(center, direction, other, along)), None]
        }
        (Model::Line { center, direction }, Model::Arc { center: hub, radius, .. })
        | (Model::Arc { center: hub, radius, .. }, Model::Line { center, direction }) => {
            let foot = center + direction * (hub - center).dot(&direction);
            chord(foot, direction, radius * radius - (hub - foot).norm_squared(), radius, slack)
        }
        (Model::Arc { center: p, radius: r, .. }, Model::Arc { center: q, radius: s, .. }) => {
            let between = q - p;
            let gap = between.norm();
            if gap < 1e-6 {
                return [None, None];
            }
            let along = (gap * gap + r * r - s * s) / (2.0 * gap);
            let foot = p + between * (along / gap);
            let across = crate::geometry::perp(between) / gap;
            chord(foot, across, r * r - along * along, r.min(s), slack)
        }
    }
}

/// The two points `square.sqrt()` either side of `foot`; `foot` itself where they touch within
/// `slack`.
fn chord(
    foot: Point,
    direction: Vector,
    square: f64,
    radius: f64,
    slack: f64,
) -> [Option<Point>; 2] {
    let touching = 2.0 * radius * slack;
    if square < -touching {
        [None, None]
    } else if square < touching {
        [Some(foot), None]
    } else {
        let half = direction * square.sqrt();
        [Some(foot - half), Some(foot + half)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A contact at (`x`, `y`), seen from the middle of the floor beside the corner at the origin.
    fn seen(x: f64, y: f64, from: Point) -> Sample {
        Sample { point: Point::new(x, y), from, weight: 1.0, edges: Vec::new() }
    }

    /// The corner of a room at the origin, floor in x > 0 and y > 0, walls seen up to 70 mm from it, and
    /// what else was seen there.
    fn cut(more: &[Sample]) -> Option<Point> {
        let from = Point::new(0.15, 0.15);
        let along = |k: i32| 0.07 + f64::from(k) * 0.05;
        let mut samples: Vec<Sample> = (0..8).map(|k| seen(0.0, along(7 - k), from)).collect();
        samples.extend((0..8).map(|k| seen(along(k), 0.0, from)));
        samples.extend_from_slice(more);
        let judge = Judge { samples: &samples, sigma: 0.0015, reach: 0.16 };
        let at = Point::new;
        judge.cut_off([at(0.0, 2.0), at(0.0, 0.07), at(0.07, 0.0), at(2.0, 0.0)])
    }

    #[test]
    fn a_corner_that_nobody_saw_is_where_the_walls_meet() {
        let corner = cut(&[]).expect("a corner");
        assert!((corner - Point::origin()).norm() < 1e-9);
    }

    #[test]
    fn a_corner_that_was_touched_across_stays_cut_off() {
        assert_eq!(cut(&[seen(0.035, 0.035, Point::new(0.15, 0.15))]), None);
    }

    #[test]
    fn a_corner_that_a_beam_went_through_stays_cut_off() {
        assert_eq!(cut(&[seen(-0.1, 0.02, Point::new(0.15, 0.04))]), None);
    }

    /// What cuts off the corner of two walls that meet at 30 degrees, floor above them, with a contact so
    /// far below the cut.
    fn cut_flat(below: f64) -> Option<Point> {
        let (u, v) = (Vector::x(), angle::unit(0.52));
        let corner = Point::origin();
        let (b, c) = (corner - u * 0.04, corner + v * 0.04);
        let outward = -crate::geometry::perp((c - b).normalize());
        let touch = nalgebra::center(&b, &c) + outward * below;
        let samples = [seen(touch.x, touch.y, Point::new(-0.05, 0.16))];
        let judge = Judge { samples: &samples, sigma: 0.0008, reach: 0.16 };
        judge.cut_off([corner - u, b, c, corner + v])
    }

    #[test]
    fn where_walls_meet_at_a_flat_angle_a_contact_on_the_cut_may_be_of_either() {
        // The corner lies 10 mm off the cut. What is within noise of the walls says nothing.
        let corner = cut_flat(0.008).expect("a corner");
        assert!(corner.coords.norm() < 1e-9);
        assert_eq!(cut_flat(0.0), None, "touched on the cut");
    }

    #[test]
    fn a_wall_is_drawn_out_farther_to_where_its_neighbour_ends() {
        // Two walls of a room that meet at the origin: the first seen to 40 mm of it or 150, the second,
        // 0.32 m of it, from 0.28 m on.
        let corner = |first: f64| {
            let v = angle::unit(0.65);
            let from = Point::new(0.0, 0.4);
            let on = |p: Point| seen(p.x, p.y, from);
            let one = (0..9).map(|k| on(Point::new(-first - 0.07 * f64::from(8 - k), 0.0)));
            let other = (0..7).map(|k| on(Point::origin() + v * (0.28 + 0.0533 * f64::from(k))));
            let samples: Vec<Sample> = one.chain(other).collect();
            let line = |first: usize, last: usize, direction: Vector| {
                let model = Model::Line { center: samples[first].point, direction };
                Run { first, last, model }
            };
            let judge = Judge { samples: &samples, sigma: 0.0005, reach: 0.16 };
            judge.joint(&line(0, 8, Vector::x()), &line(9, 15, v))
        };
        let joint = corner(0.04);
        assert!(joint.end == joint.start && joint.end.coords.norm() < 1e-6, "{joint:?}");
        let joint = corner(0.15);
        assert!(joint.end != joint.start, "from contact to contact: {joint:?}");
    }

    #[test]
    fn a_wall_of_which_a_stride_was_not_looked_at_goes_on_to_where_the_next_begins() {
        // A regular 12-gon: one wall seen to `unseen` of the corner at the origin, the next from 65 mm behind it on.
        let corner = |unseen: f64| {
            let v = angle::unit(angle::TAU / 12.0);
            let off = |p: Point, along: Vector| p + crate::geometry::perp(along) * 0.145;
            let one = (0..10).map(|k| Point::new(-unseen - 0.09 * f64::from(9 - k), 0.0));
            let other = (0..10).map(|k| Point::origin() + v * (0.065 + 0.09 * f64::from(k)));
            let one = one.map(|p| seen(p.x, p.y, off(p, Vector::x())));
            let other = other.map(|p| seen(p.x, p.y, off(p, v)));
            let samples: Vec<Sample> = one.chain(other).collect();
            let line = |first: usize, direction: Vector| {
                let model = Model::Line { center: samples[first].point, direction };
                Run { first, last: first + 9, model }
            };
            let judge = Judge { samples: &samples, sigma: 0.0008, reach: 0.16 };
            judge.joint(&line(0, Vector::x()), &line(10, v))
        };
        let joint = corner(0.4);
        assert!(joint.end == joint.start && joint.end.coords.norm() < 1e-9, "{joint:?}");
        let joint = corner(0.7);
        assert!(joint.end != joint.start, "farther than a stride and a look: {joint:?}");
    }

    #[test]
    fn a_column_beside_a_face_is_not_drawn_out_through_the_gap_to_touch_its_line() {
        // Round a column of 0.15 m that stands 1 mm above the line of the face, and on along that from 0.2 m
        // beside it. Gone round clockwise, the column turns towards the line again on its far side.
        let (center, radius) = (Point::new(0.0, 0.151), 0.15);
        let round = (0..9).map(|k| {
            let away = angle::unit(4.4 - 0.56 * f64::from(k));
            let (at, from) = (center + away * radius, center + away * 0.3);
            seen(at.x, at.y, from)
        });
        let face = (0..8).map(|k| f64::from(k) * 0.1 + 0.2);
        let face = face.map(|x| seen(x, 0.0, Point::new(x, 0.15)));
        let samples: Vec<Sample> = round.chain(face).collect();
        let judge = Judge { samples: &samples, sigma: 0.0005, reach: 0.16 };
        let column = Run { first: 0, last: 8, model: Model::Arc { center, radius, hollow: false } };
        let line = Model::Line { center: samples[12].point, direction: Vector::x() };
        let joint = judge.joint(&column, &Run { first: 9, last: 16, model: line });
        let linked = Joint { end: samples[8].point, start: samples[9].point };
        assert!(
            (joint.end - linked.end).norm() + (joint.start - linked.start).norm() < 1e-6,
            "{joint:?}"
        );
    }

    #[test]
    fn a_corner_that_would_leave_nothing_of_a_wall_is_none() {
        // 45 mm of the end of a board, and on along a face at 5 degrees to it, whose line meets that of the end
        // 0.2 m before its beginning: all of the end would lie behind the corner, and be drawn backwards.
        let u = angle::unit(0.09);
        let end = (0..4).map(|k| Point::origin() + u * (0.2 + 0.015 * f64::from(k)));
        let face = (0..8).map(|k| Point::new(0.25 + 0.05 * f64::from(k), 0.0));
        let samples: Vec<Sample> =
            end.chain(face).map(|p| seen(p.x, p.y, p + Vector::y() * 0.15)).collect();
        let judge = Judge { samples: &samples, sigma: 0.0015, reach: 0.16 };
        let line = |first: usize, last: usize, direction: Vector| {
            let model = Model::Line { center: samples[first].point, direction };
            Run { first, last, model }
        };
        let joint = judge.joint(&line(0, 3, u), &line(4, 11, Vector::x()));
        assert!((joint.end - samples[3].point).norm() < 1e-6, "{joint:?}");
    }

    #[test]
    fn walls_that_are_short_or_meet_at_a_flat_angle_do_not_tell() {
        let judge = Judge { samples: &[], sigma: 0.0015, reach: 0.16 };
        let at = Point::new;
        assert_eq!(judge.cut_off([at(0.0, 0.3), at(0.0, 0.07), at(0.07, 0.0), at(2.0, 0.0)]), None);
        assert_eq!(judge.cut_off([at(-2.0, 0.1), at(0.0, 0.0), at(0.1, 0.0), at(2.0, 0.1)]), None);
    }
}
