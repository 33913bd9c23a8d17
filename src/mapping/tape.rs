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
    /// nearest places of the walls; none when an end is near to neither.
    #[must_use]
    pub fn on(&self, outline: &Ring) -> Option<f64> {
        let place = |end: Point| {
            let corner = outline
                .pieces
                .iter()
                .map(Piece::from)
                .min_by(|a, b| (a - end).norm_squared().total_cmp(&(b - end).norm_squared()))
                .filter(|corner| (corner - end).norm() < CORNER);
            let wall = || {
                let foot = outline.nearest(end).filter(|foot| foot.distance < OFF)?;
                Some(outline.pieces[foot.piece].at(foot.t))
            };
            corner.or_else(wall)
        };
        let length = (place(self.to)? - place(self.from)?).norm();
        (length > 0.1).then_some(length)
    }

    /// By how much to stretch a map on which the length is `mapped`; none when the two are so far
    /// apart that the tape was held elsewhere.
    #[must_use]
    pub fn stretch(&self, mapped: f64) -> Option<f64> {
        let stretch = self.length / mapped;
        ((stretch - 1.0).abs() < MOST).then_some(stretch)
    }
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
    fn a_tape_that_was_held_elsewhere_is_not_believed() {
        let held = tape((0.0, 0.0), (5.0, 0.0), 5.0);
        assert!((held.stretch(5.05).expect("one per cent") - 5.0 / 5.05).abs() < 1e-12);
        assert_eq!(held.stretch(5.5), None);
    }
}
