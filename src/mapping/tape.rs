//! One length measured by tape. Closing a lap says nothing of a scale that both wheels share: the
//! whole map may be a per cent too large and still close. One taped length tells.
//!
//! What it stretches is the way the robot went. What the switches saw lies off that way by their
//! range, which no wheel has measured, so the outline is fitted anew after each correction.

use crate::geometry::{Piece, Point, Ring};
use serde::{Deserialize, Serialize};
use std::str::FromStr;
use thiserror::Error;

/// An end this near to a corner of the outline is that corner, metres.
const CORNER: f64 = 0.35;
/// An end farther than this from the outline is no place of it, metres.
const OFF: f64 = 1.0;
/// How well a person says where a tape was held, metres.
const PLACE_SD: f64 = 0.15;
/// What the common scale of both wheels is out of the box, as a share of one.
const SCALE_SD: f64 = 0.01;
/// A tape across a wall makes an angle with it whose cosine is below this.
const ACROSS: f64 = 0.5;
/// A tape that disagrees with the map by more than this share was held elsewhere.
const MOST: f64 = 0.06;

/// A length between two places of the outline, as measured in the room.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Tape {
    /// About where one end was held, map frame, metres.
    pub from: Point,
    /// About where the other was.
    pub to: Point,
    /// What the tape said, metres.
    pub length: f64,
}

/// What a taped length made of the map.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Taped {
    /// The length on the map before, metres.
    pub mapped: f64,
    /// What the tape said, metres.
    pub taped: f64,
    /// By how much the robot's way was stretched: real over believed travel of the wheels.
    pub stretch: f64,
}

/// What is wrong with a written tape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum TapeError {
    /// Not of that form.
    #[error(
        "a taped length is X,Y:X,Y=M: two corners or walls, and the metres between them, such as 0,0:5,0=5.02"
    )]
    Form,
    /// Too short to say anything.
    #[error("a taped length is 0.2 m at least")]
    Short,
}

impl FromStr for Tape {
    type Err = TapeError;

    fn from_str(text: &str) -> Result<Self, TapeError> {
        let number = |text: &str| -> Result<f64, TapeError> {
            let value = text.trim().trim_end_matches('m').trim_end().parse();
            value.ok().filter(|value: &f64| value.is_finite()).ok_or(TapeError::Form)
        };
        let point = |text: &str| {
            let (x, y) = text.split_once(',').ok_or(TapeError::Form)?;
            Ok(Point::new(number(x)?, number(y)?))
        };
        let (ends, length) = text.split_once('=').ok_or(TapeError::Form)?;
        let (from, to) = ends.split_once(':').ok_or(TapeError::Form)?;
        match number(length)? {
            length if length < 0.2 => Err(TapeError::Short),
            length => Ok(Self { from: point(from)?, to: point(to)?, length }),
        }
    }
}

impl Tape {
    /// The length on a map with `outline`: between the corners that its ends are near to, or the
    /// nearest places of the walls; none when an end is near to neither. Of several such pairs that
    /// one which is likeliest: near to where the ends were said to be, and about as long as the tape.
    #[must_use]
    pub fn on(&self, outline: &Ring) -> Option<f64> {
        let (from, to) = (places(outline, self.from, self.to), places(outline, self.to, self.from));
        let unlikely = |from: Point, to: Point, length: f64| {
            let off = (from - self.from).norm_squared() + (to - self.to).norm_squared();
            let scale = (self.length / length - 1.0) / SCALE_SD;
            off / PLACE_SD.powi(2) + scale * scale
        };
        from.iter()
            .flat_map(|&from| to.iter().map(move |&to| (from, to, (to - from).norm())))
            .filter(|&(.., length)| length > 0.1)
            .map(|(from, to, length)| (unlikely(from, to, length), length))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, length)| length)
    }

    /// By how much to stretch a map on which the length is `mapped`; none when the two are so far
    /// apart that the tape was held elsewhere.
    #[must_use]
    pub fn stretch(&self, mapped: f64) -> Option<f64> {
        let stretch = self.length / mapped;
        ((stretch - 1.0).abs() < MOST).then_some(stretch)
    }
}

/// What of `outline` a tape that goes to `other` may have been held to when its end was said to be
/// at `end`: the corners near by, and the wall. A tape that runs along the wall ends at a corner.
fn places(outline: &Ring, end: Point, other: Point) -> Vec<Point> {
    let corners = outline.pieces.iter().map(Piece::from);
    let mut places: Vec<Point> = corners.filter(|corner| (corner - end).norm() < CORNER).collect();
    if let Some(foot) = outline.nearest(end).filter(|foot| foot.distance < OFF) {
        let piece = &outline.pieces[foot.piece];
        let along = piece.tangent(foot.t).dot(&(other - end)).abs();
        if places.is_empty() || along < ACROSS * (other - end).norm() {
            places.push(piece.at(foot.t));
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tape(from: (f64, f64), to: (f64, f64), length: f64) -> Tape {
        Tape { from: Point::new(from.0, from.1), to: Point::new(to.0, to.1), length }
    }

    #[test]
    fn an_end_is_a_corner_near_by_or_else_the_wall() {
        let corners = [(0.0, 0.0), (5.1, 0.0), (5.1, 4.0), (0.0, 4.0)];
        let outline = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        let along = tape((0.0, 0.0), (5.0, 0.0), 5.0).on(&outline).expect("two corners");
        assert!((along - 5.1).abs() < 1e-9, "{along}");
        let across = tape((-0.02, 2.0), (5.0, 2.0), 5.0).on(&outline).expect("two walls");
        assert!((across - 5.1).abs() < 1e-9, "{across}");
        assert_eq!(tape((0.0, 0.0), (9.0, 0.0), 9.0).on(&outline), None, "no wall there");
        assert_eq!(tape((0.0, 0.0), (0.1, 0.0), 0.1).on(&outline), None, "no length at all");
    }

    #[test]
    fn of_two_corners_near_an_end_the_tape_tells_which() {
        // A step of 20 cm by 10 cm in the corner at 5, 0.
        let corners = [(0.0, 0.0), (4.8, 0.0), (4.8, 0.1), (5.0, 0.1), (5.0, 4.0), (0.0, 4.0)];
        let outline = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        for (length, mapped) in [(4.82, 4.8), (5.02, 5.0), (4.99, 5.0)] {
            let on = tape((0.0, 0.0), (4.9, 0.1), length).on(&outline).expect("two places");
            assert!((on - mapped).abs() < 2e-3, "{length}: {on}");
        }
    }

    #[test]
    fn a_tape_that_was_held_elsewhere_is_not_believed() {
        let held = tape((0.0, 0.0), (5.0, 0.0), 5.0);
        assert!((held.stretch(5.05).expect("one per cent") - 5.0 / 5.05).abs() < 1e-12);
        assert_eq!(held.stretch(5.5), None);
    }
}
