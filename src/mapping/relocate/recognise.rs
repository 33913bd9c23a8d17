//! Where on the map something was seen: contacts of a stretch of wall, laid on all that is mapped.
//!
//! Two contacts far apart fit the map only where two mapped places lie as far apart. Each such pair
//! of places is a guess; guesses on which the other contacts lie too are moved until they lie best
//! (iterative closest point, Besl and `McKay` 1992, point to line), and what is left are the places
//! that look like what was seen. One place is an answer. Several are none: the robot has to see more.

use crate::geometry::index::SegmentIndex;
use crate::geometry::{Point, Pose, Ring, Segment, Vector, angle, perp};
use nalgebra::{Matrix3, Vector3};

/// One contact: where the surface is, and where the robot was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// The place on the surface.
    pub point: Point,
    /// The robot's centre.
    pub from: Point,
    /// Metres it had travelled by then.
    pub travelled: f64,
}

/// A place of the map on which what was seen lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Takes what was seen to the map: [`Pose::to_world`] of this.
    pub onto: Pose,
    /// Root mean square distance of the contacts from the map, metres.
    pub rms: f64,
    /// Share of the contacts that lie on the map.
    pub share: f64,
    /// One standard deviation of where this puts the robot (metres) and of its heading (radians).
    pub sd: (f64, f64),
}

impl Place {
    /// Whether it is good enough to be an answer, not only a rival to one.
    #[must_use]
    pub fn is_sure(&self) -> bool {
        self.share >= SHARE
    }

    /// Where this puts `pose`.
    #[must_use]
    pub fn of(&self, pose: Pose) -> Pose {
        put(&self.onto, pose)
    }
}

/// Where `onto`, which takes the robot's frame to the map, puts `pose`.
#[must_use]
pub fn put(onto: &Pose, pose: Pose) -> Pose {
    Pose {
        position: onto.to_world(pose.position),
        heading: angle::wrap(pose.heading + onto.heading),
    }
}

/// What was seen must reach this far before it is looked for, metres.
const LEAST_REACH: f64 = 1.2;
/// Contacts nearer to each other than this say the same, metres.
const APART: f64 = 0.03;
/// No more contacts are laid on the map.
const MOST_CONTACTS: usize = 90;
/// Places on the map lie this far apart, metres; farther on long outlines, so that there are no more
/// than so many.
const PITCH: f64 = 0.03;
const MOST_SAMPLES: f64 = 4000.0;
/// A guess may leave the contacts this far off the map on average, metres; farther than so much no
/// contact counts.
const ROUGHLY: f64 = 0.05;
const FAR: f64 = 0.12;
/// So many guesses are moved to where they lie best.
const MOST_GUESSES: usize = 24;
/// Rounds of that.
const ROUNDS: u32 = 12;
/// Two answers that put the robot nearer to each other than this are one: metres, radians.
const SAME: (f64, f64) = (0.2, 0.15);
/// A contact this near the map lies on it, metres.
const ON: f64 = 0.03;
/// This share of the contacts must; of the robot's places, as many must be on open floor.
const SHARE: f64 = 0.92;
/// A rival need not be as good: this share, and so many times the rms of the best.
const RIVAL_SHARE: f64 = 0.9;
const RIVAL: f64 = 2.5;
/// What mapped walls and contacts err by at least, and by metre of what was seen, metres.
const SCATTER: f64 = 0.006;
const DRIFT: f64 = 0.002;
/// For where the robot is now, what it saw so many metres ago counts half: its odometry drifts.
const FADING: f64 = 1.5;
/// No answer that leaves the robot's place, or its heading, less sure than this: metres, radians.
const SURE: (f64, f64) = (0.03, 0.02);
/// Nor one that fewer contacts than three would hold in some direction without those about any one place, as far as
/// a leg or the end of a board with its foot on the wall reaches, metres: what they leave open, as variance of what
/// one contact leaves open.
const ONE_THING: f64 = 0.3;
const HELD: f64 = 1.0 / 3.0;

/// Everything that is mapped, to be recognised.
#[derive(Debug, Clone)]
pub struct Landmarks {
    outline: Ring,
    objects: Vec<Ring>,
    index: SegmentIndex,
    samples: Vec<Point>,
}

impl Landmarks {
    /// The room's `outline` and the `objects` in it.
    #[must_use]
    pub fn new(outline: &Ring, objects: Vec<Ring>) -> Self {
        let rings = || std::iter::once(outline).chain(&objects);
        let length: f64 = rings().map(Ring::perimeter).sum();
        let pitch = PITCH.max(length / MOST_SAMPLES);
        let mut segments = Vec::new();
        let mut samples = Vec::new();
        for ring in rings() {
            let points = ring.to_points(0.002);
            let next = points.iter().cycle().skip(1);
            segments.extend(points.iter().zip(next).map(|(a, b)| Segment::new(*a, *b)));
            for piece in &ring.pieces {
                let count = (piece.length() / pitch).ceil().max(1.0);
                samples.extend((0..count as u32).map(|k| piece.at(f64::from(k) / count)));
            }
        }
        let index = SegmentIndex::new(segments, 0.1);
        Self { outline: outline.clone(), objects, index, samples }
    }

    /// The places of the map that look like what was `seen`, best first; none as long as too little
    /// was. More than one when they cannot be told apart. Only what takes the robot's frame to the map in a
    /// way that `may_be` is looked at.
    #[must_use]
    pub fn places(&self, seen: &[Seen], may_be: impl Fn(&Pose) -> bool) -> Vec<Place> {
        let seen = thinned(seen);
        let Some((a, b)) = farthest(&seen) else { return Vec::new() };
        if (b - a).norm() < LEAST_REACH {
            return Vec::new();
        }
        let reach = (b - a).norm();
        let mut found: Vec<Place> = Vec::new();
        for guess in self.guesses(&seen, (a, b), may_be) {
            let Some(place) = self.settle(&seen, guess, |_| 1.0) else { continue };
            let last = seen[seen.len() - 1].from;
            let twin = |other: &Place| {
                let off = (other.onto.to_world(last) - place.onto.to_world(last)).norm();
                off < SAME.0 && angle::wrap(other.onto.heading - place.onto.heading).abs() < SAME.1
            };
            match found.iter_mut().find(|other| twin(other)) {
                Some(other) if place.rms < other.rms => *other = place,
                Some(_) => {}
                None => found.push(place),
            }
        }
        found.sort_by(|a, b| a.rms.total_cmp(&b.rms));
        let within = SCATTER + DRIFT * reach;
        let best = found.iter().find(|place| place.share >= SHARE && place.rms < within).copied();
        let Some(best) = best else { return Vec::new() };
        found.retain(|place| {
            place.share >= RIVAL_SHARE && place.rms < RIVAL * best.rms.max(SCATTER / 2.0)
        });
        found
    }

    /// The same place, better for the robot as it stands now than for all that it saw on its way; where what it
    /// saw last leaves a direction open, as one wall alone does, all that it saw knows better.
    #[must_use]
    pub fn sharpened(&self, place: &Place, seen: &[Seen]) -> Place {
        let seen = thinned(seen);
        let now = seen.last().map_or(0.0, |newest| newest.travelled);
        let weight = |one: &Seen| 1.0 / (1.0 + ((now - one.travelled) / FADING).powi(2));
        let sharp = self.settle(&seen, place.onto, weight).filter(Place::is_sure);
        sharp.map_or(*place, |sharp| Place {
            share: place.share,
            sd: (sharp.sd.0.max(place.sd.0), sharp.sd.1.max(place.sd.1)),
            ..sharp
        })
    }

    /// Roughly right guesses that `may_be`, best first; from `a` to `b` is as far as was seen.
    fn guesses(
        &self,
        seen: &[Seen],
        (a, b): (Point, Point),
        may_be: impl Fn(&Pose) -> bool,
    ) -> Vec<Pose> {
        let (reach, bearing) = ((b - a).norm(), angle::of(b - a));
        let slack = PITCH.max(self.pitch());
        let few: Vec<&Seen> = seen.iter().step_by((seen.len() / 24).max(1)).collect();
        let mut guesses: Vec<(f64, Pose)> = Vec::new();
        for &from in &self.samples {
            for &to in &self.samples {
                let off = to - from;
                let square = off.norm_squared();
                if (square - reach * reach).abs() > 2.0 * reach * slack {
                    continue;
                }
                let turn = angle::wrap(angle::of(off) - bearing);
                let middle = Point::from((from.coords + to.coords) / 2.0);
                let about = Point::from((a.coords + b.coords) / 2.0);
                let spun = Pose { position: Point::origin(), heading: turn };
                let onto = Pose { position: middle - spun.rotate(about.coords), heading: turn };
                if may_be(&onto)
                    && let Some(off) = self.roughly(&few, &onto)
                {
                    guesses.push((off, onto));
                }
            }
        }
        guesses.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut kept: Vec<Pose> = Vec::new();
        for (_, guess) in guesses {
            let apart = |other: &Pose| {
                (other.to_world(b) - guess.to_world(b)).norm() > SAME.0 / 2.0
                    || angle::wrap(other.heading - guess.heading).abs() > SAME.1
            };
            if kept.iter().all(apart) {
                kept.push(guess);
            }
            if kept.len() == MOST_GUESSES {
                break;
            }
        }
        kept
    }

    fn pitch(&self) -> f64 {
        let length: f64 = self.index.segments().iter().map(Segment::length).sum();
        length / self.samples.len().max(1) as f64
    }

    /// How far `seen` lies off the map on average, if that is not too far.
    fn roughly(&self, seen: &[&Seen], onto: &Pose) -> Option<f64> {
        let most = ROUGHLY * seen.len() as f64;
        let mut sum = 0.0;
        for one in seen {
            sum += self.index.distance_within(onto.to_world(one.point), FAR);
            if sum > most {
                return None;
            }
        }
        Some(sum)
    }

    /// Moves a guess to where what was seen, each by its weight, lies best; none where the robot cannot
    /// have been.
    fn settle(&self, seen: &[Seen], guess: Pose, weight: impl Fn(&Seen) -> f64) -> Option<Place> {
        let mut onto = guess;
        let mut rows: Vec<(Point, Vector3<f64>)> = Vec::new();
        let count = seen.len() as f64;
        let middle = Point::from(seen.iter().map(|s| s.point.coords).sum::<Vector>() / count);
        for round in 0..ROUNDS {
            let within = if round < 4 { FAR } else { 2.0 * ON };
            let about = onto.to_world(middle);
            let mut right = Vector3::zeros();
            rows.clear();
            for one in seen {
                let p = onto.to_world(one.point);
                let Some((off, direction)) = self.off(p) else { continue };
                if off.abs() > within {
                    continue;
                }
                let lever = perp(p - about).dot(&direction);
                let row = Vector3::new(direction.x, direction.y, lever);
                let weight = weight(one);
                rows.push((p, row * weight.sqrt()));
                right -= row * (off * weight);
            }
            let firm = information(rows.iter()) + Matrix3::identity() * 1e-6;
            let step = firm.try_inverse()? * right;
            let turned = Pose { position: Point::origin(), heading: step[2] };
            let shifted = about + turned.rotate(onto.position - about);
            onto = Pose {
                position: shifted + Vector::new(step[0], step[1]),
                heading: angle::wrap(onto.heading + step[2]),
            };
        }
        let offs: Vec<f64> =
            seen.iter().map(|s| self.index.distance_within(onto.to_world(s.point), FAR)).collect();
        let on: Vec<f64> = offs.iter().copied().filter(|off| *off < ON).collect();
        let share = on.len() as f64 / count;
        let rms = (on.iter().map(|off| off * off).sum::<f64>() / on.len().max(1) as f64).sqrt();
        let open = seen.iter().filter(|s| self.is_floor(onto.to_world(s.from))).count() as f64;
        let scatter = rms.max(SCATTER / 2.0);
        let lever = (onto.to_world(seen[seen.len() - 1].from) - onto.to_world(middle)).norm();
        let sd_by = |information: Matrix3<f64>| -> Option<(f64, f64)> {
            let covariance = information.try_inverse()? * (scatter * scatter);
            let heading = covariance[(2, 2)].max(0.0).sqrt();
            let position = (covariance[(0, 0)] + covariance[(1, 1)]).max(0.0).sqrt();
            Some((position.max(lever * heading), heading))
        };
        let is_sure = |sd: (f64, f64)| sd.0 < SURE.0 && sd.1 < SURE.1;
        let sd = sd_by(information(rows.iter()))?;
        // What one thing alone holds in its place may be beside another one that looks like it.
        let without = |p: &Point| {
            let rest = rows.iter().filter(|(other, _)| (other - p).norm() > ONE_THING);
            // Where a direction is open the inverse may be anything, even less than nothing.
            let left = information(rest).try_inverse().map(|all| all[(0, 0)] + all[(1, 1)]);
            left.is_some_and(|left| (0.0..HELD).contains(&left))
        };
        let sure = is_sure(sd) && rows.iter().all(|(p, _)| without(p));
        // What leaves a direction open slides: it is a rival to whatever else fits, but no answer.
        let share = if sure { share } else { share.min(SHARE - 0.01) };
        (open >= SHARE * count).then_some(Place { onto, rms, share, sd })
    }

    /// How far `p` lies off the nearest surface, along which direction.
    fn off(&self, p: Point) -> Option<(f64, Vector)> {
        let mut best: Option<(f64, Vector, Vector)> = None;
        self.index.near(&Segment::new(p, p), FAR, |k| {
            let segment = &self.index.segments()[k];
            let away = p - segment.nearest(p);
            if best.is_none_or(|(square, ..)| away.norm_squared() < square) {
                best = Some((away.norm_squared(), away, segment.along));
            }
        });
        let (square, away, along) = best?;
        let distance = square.sqrt();
        if distance > 1e-6 {
            return Some((distance, away / distance));
        }
        Some((0.0, perp(along).try_normalize(1e-12)?))
    }

    /// Whether a robot may have its centre at `p`.
    #[must_use]
    pub fn is_floor(&self, p: Point) -> bool {
        self.outline.contains(p) && !self.objects.iter().any(|ring| ring.contains(p))
    }
}

/// What contacts say of the place: the sum of what each of their equations does.
fn information<'a>(rows: impl Iterator<Item = &'a (Point, Vector3<f64>)>) -> Matrix3<f64> {
    rows.map(|(_, row)| row * row.transpose()).sum()
}

/// Contacts that lie apart, no more than are needed.
fn thinned(seen: &[Seen]) -> Vec<Seen> {
    let mut kept: Vec<Seen> = Vec::new();
    for one in seen {
        if kept.iter().rev().take(12).all(|other| (other.point - one.point).norm() > APART) {
            kept.push(*one);
        }
    }
    let stride = kept.len().div_ceil(MOST_CONTACTS).max(1);
    // The newest is always among them: it is where the robot is.
    let mut few: Vec<Seen> = kept.iter().rev().step_by(stride).copied().collect();
    few.reverse();
    few
}

/// The two contacts farthest from each other.
fn farthest(seen: &[Seen]) -> Option<(Point, Point)> {
    let pairs = seen.iter().enumerate().flat_map(|(k, a)| {
        seen[k + 1..].iter().map(move |b| (a.point, b.point, (b.point - a.point).norm_squared()))
    });
    pairs.max_by(|a, b| a.2.total_cmp(&b.2)).map(|(a, b, _)| (a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(corners: &[(f64, f64)]) -> Ring {
        let points: Vec<Point> = corners.iter().map(|(x, y)| Point::new(*x, *y)).collect();
        Ring::polygon(&points)
    }

    fn anywhere(_: &Pose) -> bool {
        true
    }

    /// An L, no two corners of which look alike on both sides.
    fn room() -> Ring {
        polygon(&[(0.0, 0.0), (5.0, 0.0), (5.0, 4.0), (3.0, 4.0), (3.0, 2.5), (0.0, 2.5)])
    }

    /// What a robot sees that follows `way` with the wall 0.145 m to its left, as believed by one
    /// whose frame is turned and shifted by `frame`.
    fn along(way: &[(f64, f64)], frame: &Pose) -> Vec<Seen> {
        let corners: Vec<Point> = way.iter().map(|(x, y)| Point::new(*x, *y)).collect();
        let mut seen = Vec::new();
        for pair in corners.windows(2) {
            let off = pair[1] - pair[0];
            let count = (off.norm() / 0.05) as u32;
            let inward = perp(off.normalize()) * 0.145;
            for k in 0..=count {
                let at = pair[0] + off * (f64::from(k) / f64::from(count));
                // Jitter that is the same each time.
                let jitter = perp(off.normalize()) * (0.0015 * f64::from(k % 3) - 0.0015);
                let point = frame.to_local(at + jitter);
                let travelled = 0.05 * seen.len() as f64;
                seen.push(Seen { point, from: frame.to_local(at + inward), travelled });
            }
        }
        seen
    }

    #[test]
    fn two_corners_of_an_l_tell_where_the_robot_is() {
        let marks = Landmarks::new(&room(), Vec::new());
        let frame = Pose::new(1.3, -2.0, 2.1);
        // Anti-clockwise, with the floor on the left.
        let seen = along(&[(3.0, 0.0), (5.0, 0.0), (5.0, 4.0), (4.2, 4.0)], &frame);
        let places = marks.places(&seen, anywhere);
        assert_eq!(places.len(), 1, "{places:?}");
        let off = (places[0].onto.position - frame.position).norm();
        assert!(off < 0.01, "{off}");
        assert!(angle::wrap(places[0].onto.heading - frame.heading).abs() < 0.004);
        assert!(places[0].sd.0 < 0.02 && places[0].sd.1 < 0.01, "{:?}", places[0].sd);
    }

    #[test]
    fn a_place_is_not_made_better_by_one_wall_alone() {
        // What was seen last slides along it: a robot was believed to be somewhere within 100 000 km.
        let marks = Landmarks::new(&room(), Vec::new());
        let onto = Pose::new(0.2, 0.1, 0.4);
        let seen = along(&[(0.5, 0.0), (2.5, 0.0)], &onto);
        let place = Place { onto, rms: 0.002, share: 1.0, sd: (0.01, 0.005) };
        assert_eq!(marks.sharpened(&place, &seen), place);
    }

    #[test]
    fn one_straight_wall_tells_nothing() {
        let marks = Landmarks::new(&room(), Vec::new());
        let seen = along(&[(0.5, 0.0), (2.5, 0.0)], &Pose::new(0.2, 0.1, 0.4));
        assert_ne!(marks.places(&seen, anywhere).len(), 1);
    }

    #[test]
    fn a_leg_before_a_wall_may_be_another_one() {
        // Two stand 0.4 m apart, and one of them only is on the map.
        let leg = |x: f64| Ring::circle(Point::new(x, 0.25), 0.02);
        let marks = Landmarks::new(&room(), vec![leg(2.0)]);
        let around = |x: f64| {
            (0..12).map(move |k| {
                let away = angle::unit(angle::TAU * f64::from(k) / 12.0);
                let middle = Point::new(x, 0.25);
                let travelled = 0.05 * f64::from(k);
                Seen { point: middle + away * 0.02, from: middle + away * 0.16, travelled }
            })
        };
        let upright = |onto: &Pose| angle::wrap(onto.heading).abs() < 0.7;
        let still = Pose::new(0.0, 0.0, 0.0);
        let seen: Vec<Seen> = around(2.4).chain(along(&[(2.4, 0.0), (3.9, 0.0)], &still)).collect();
        let places = marks.places(&seen, upright);
        assert!(places.iter().all(|place| !place.is_sure()), "{places:?}");
        // With the corner it knows.
        let way = [(2.4, 0.0), (5.0, 0.0), (5.0, 1.0)];
        let seen: Vec<Seen> = around(2.4).chain(along(&way, &still)).collect();
        let places = marks.places(&seen, upright);
        let [place] = &places[..] else { panic!("{places:?}") };
        assert!(place.is_sure() && place.onto.position.coords.norm() < 0.01, "{place:?}");
    }

    #[test]
    fn a_rectangle_looks_the_same_from_two_places() {
        let room = polygon(&[(0.0, 0.0), (5.0, 0.0), (5.0, 4.0), (0.0, 4.0)]);
        let marks = Landmarks::new(&room, Vec::new());
        let way = [(1.0, 0.0), (5.0, 0.0), (5.0, 4.0), (0.0, 4.0), (0.0, 0.0), (1.0, 0.0)];
        let seen = along(&way, &Pose::new(0.0, 0.0, 0.3));
        let places = marks.places(&seen, anywhere);
        assert_eq!(places.len(), 2, "{places:?}");
        // The other one is half a turn away.
        let upright = |onto: &Pose| angle::wrap(onto.heading - 0.3).abs() < 0.7;
        assert_eq!(marks.places(&seen, upright).len(), 1);
    }

    #[test]
    fn what_is_not_on_the_map_is_not_found_on_it() {
        let marks = Landmarks::new(&room(), Vec::new());
        // A box of 1.5 m, gone round on its outside.
        let way = [(0.0, 0.0), (0.0, 1.5), (1.5, 1.5), (1.5, 0.0), (0.0, 0.0)];
        assert_eq!(marks.places(&along(&way, &Pose::new(0.5, 0.5, 1.0)), anywhere), Vec::new());
    }

    #[test]
    fn an_object_is_a_landmark_too() {
        let object = polygon(&[(2.0, 1.0), (3.5, 1.0), (3.2, 1.8), (2.0, 1.6)]);
        let marks = Landmarks::new(&room(), vec![object]);
        let frame = Pose::new(-1.0, 0.7, -0.8);
        let way = [(2.6, 1.0), (2.0, 1.0), (2.0, 1.6), (3.2, 1.8), (3.5, 1.0), (2.6, 1.0)];
        let places = marks.places(&along(&way, &frame), anywhere);
        assert_eq!(places.len(), 1, "{places:?}");
        assert!((places[0].onto.position - frame.position).norm() < 0.01);
    }
}
