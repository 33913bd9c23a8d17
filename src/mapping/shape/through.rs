//! Faces of one wall that noise has laid through each other: what the beams that ended on the one say of the
//! other. Knows contacts, not what moves them.

use super::AlongWall;
use crate::geometry::index::SegmentIndex;
use crate::geometry::segment::Segment;
use crate::geometry::{Point, Vector, cross, perp};
use crate::mapping::map::{Contact, ContactKind};

/// Two contacts that follow each other along a wall are of one face up to this far apart, metres: along a wall
/// that goes on the robot looks every half metre.
const FACE: f64 = 0.65;
/// What is of one face was seen along the same way (cosine), and across it (sine).
const ALIKE: f64 = 0.9;
const ACROSS: f64 = 0.8;
/// Less than this is the jitter of a switch, metres.
const DEEP: f64 = 0.002;
/// Round the end of a wall nothing has gone wrong yet: what was seen so far apart along the way, metres, may have.
const LATER: f64 = 2.0;
/// Buckets for the search, metres.
const PITCH: f64 = 0.25;

/// A beam that ended behind a face which the robot saw from the other side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Through {
    /// Where the beam ended.
    pub tip: Point,
    /// Where it went through the face.
    pub at: Point,
    /// Unit normal of the face, along the beam.
    pub normal: Vector,
    /// How far behind the face it ended, metres.
    pub deep: f64,
    /// When its end was seen, and when the face (robot time).
    pub times_us: (u64, u64),
}

/// All beams among the contacts of a lap that ended behind a face seen from the other side.
#[must_use]
pub fn faces_through_each_other(lap: &AlongWall) -> Vec<Through> {
    let is_beam = |contact: &&Contact| contact.kind == ContactKind::Range;
    let ordered: Vec<&Contact> = lap.ordered.iter().filter(is_beam).collect();
    let mut driven = 0.0;
    let mut along = vec![0.0];
    for two in ordered.windows(2) {
        driven += (two[1].from - two[0].from).norm();
        along.push(driven);
    }
    let is_later = |k: usize, other: usize| {
        let apart = (along[k] - along[other]).abs();
        apart.min(driven - apart) > LATER
    };
    let faces: Vec<usize> =
        (1..ordered.len()).filter(|&k| is_face(ordered[k - 1], ordered[k])).collect();
    if faces.is_empty() {
        return Vec::new();
    }
    let segments =
        faces.iter().map(|&k| Segment::new(ordered[k - 1].point, ordered[k].point)).collect();
    let index = SegmentIndex::new(segments, PITCH);
    let mut found = Vec::new();
    for (place, contact) in ordered.iter().enumerate() {
        let beam = Segment::new(contact.from, contact.point);
        let mut crossed: Vec<usize> = Vec::new();
        index.near(&beam, 0.0, |k| crossed.push(k));
        crossed.sort_unstable();
        crossed.dedup();
        let later = crossed.into_iter().map(|k| faces[k]).filter(|&k| is_later(place, k));
        let through =
            later.filter_map(|k| went_through(contact, &beam, ordered[k - 1], ordered[k]));
        found.extend(through.max_by(|a, b| a.deep.total_cmp(&b.deep)));
    }
    found
}

/// Whether two contacts that follow each other are of one straight bit of wall.
fn is_face(a: &Contact, b: &Contact) -> bool {
    let step = b.point - a.point;
    let towards = |contact: &Contact| (contact.from - contact.point).try_normalize(1e-9);
    let (Some(along), Some(u), Some(v)) = (step.try_normalize(1e-6), towards(a), towards(b)) else {
        return false;
    };
    let across = |beam: Vector| cross(along, beam) > ACROSS;
    step.norm() < FACE && u.dot(&v) > ALIKE && across(u) && across(v)
}

/// How `beam`, which ended at `contact`, went through the face from `a` to `b`, if it did.
fn went_through(contact: &Contact, beam: &Segment, a: &Contact, b: &Contact) -> Option<Through> {
    let face = Segment::new(a.point, b.point);
    // The floor that the face was seen from is on its left; the beam came from its right.
    let normal = perp(face.along).try_normalize(1e-9)?;
    let deep = normal.dot(&(contact.point - a.point));
    if deep < DEEP || !face.crosses(beam) {
        return None;
    }
    let before = normal.dot(&(a.point - beam.from));
    let at = beam.from + beam.along * (before / (before + deep));
    let nearer = if (at - a.point).norm() < (at - b.point).norm() { a } else { b };
    let times_us = (contact.time_us(), nearer.time_us());
    Some(Through { tip: contact.point, at, normal, deep, times_us })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::shape::testing::along;

    fn through(contacts: &[Contact]) -> Vec<Through> {
        faces_through_each_other(&AlongWall::of(contacts, 0.16))
    }

    /// A room of 4 x 3 m with a board of 2 m on its lower wall, by so many metres thick at its foot and its end.
    fn with_board(foot: f64, end: f64) -> Vec<Contact> {
        let (left, right) = (2.0 - foot / 2.0, 2.0 + foot / 2.0);
        let corners = [
            (0.0, 3.0),
            (0.0, 0.0),
            (left, 0.0),
            (2.0 - end / 2.0, 2.0),
            (2.0 + end / 2.0, 2.0),
            (right, 0.0),
            (4.0, 0.0),
            (4.0, 3.0),
            (0.0, 3.0),
        ];
        along(&corners, 1.0)
    }

    #[test]
    fn beams_that_ended_behind_the_other_face_of_a_board_are_found_with_how_far() {
        let found = through(&with_board(-0.04, 0.02));
        // For two thirds of its length the board is less than nothing thick.
        assert!(found.len() > 30, "{} beams", found.len());
        for through in &found {
            let thick = -0.04 + 0.06 * through.at.y / 2.0;
            assert!((through.deep + thick).abs() < 0.002, "{through:?} is {thick} thick");
            assert!(through.tip.y < 1.4 && through.normal.x.abs() > 0.99, "{through:?}");
            let (seen, crossed) = through.times_us;
            assert!(seen.abs_diff(crossed) > 2_000_000, "{through:?}");
        }
    }

    #[test]
    fn a_board_that_is_one_and_a_corridor_are_left_alone() {
        assert_eq!(through(&with_board(0.02, 0.02)), []);
        let corridor = [(0.0, 0.0), (5.0, 0.0), (5.0, 0.3), (0.0, 0.3), (0.0, 0.0)];
        assert_eq!(through(&along(&corridor, 1.0)), []);
        assert_eq!(through(&[]), []);
    }

    #[test]
    fn round_the_end_of_a_wall_nothing_has_gone_wrong_yet() {
        // The last 0.6 m of the board are less than nothing thick: the robot has driven less than two metres
        // from one face to the other.
        let found = through(&with_board(0.06, -0.026));
        let far = found.iter().filter(|through| through.at.y > 1.3).count();
        assert_eq!(far, 0, "{found:?}");
    }
}
