//! One length measured by tape. Closing a lap says nothing of a scale that both wheels share: the
//! whole map may be a per cent too large and still close. One taped length tells.
//!
//! It tells as much as its ends are known: a corner between two long walls is where they meet, one of a
//! ragged wall may be any of those about. So it is weighed against what wheels are off by at all.
//!
//! What it stretches is the way the robot went. What the switches saw lies off that way by their
//! range, which no wheel has measured, so the outline is fitted anew after each correction.

use crate::geometry::{Piece, Point, Ring, angle};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// A tape shorter than this says nothing, metres.
const SHORTEST: f64 = 0.2;
/// An end this near to a corner of the outline is that corner, metres.
const CORNER: f64 = 0.35;
/// An end farther than this from the outline is no place of it, metres.
const OFF: f64 = 0.45;
/// How well a person says where a tape was held, metres.
const PLACE_SD: f64 = 0.15;
/// What the common scale of both wheels is off by out of the box, as a share: within one per cent.
const SCALE_SD: f64 = 0.006;
/// How well an end is known on the map, metres: on a wall or between two that are no shorter than so many
/// metres, and else.
const SURE_END: f64 = 0.006;
const LONG_WALL: f64 = 0.3;
const RAGGED_END: f64 = 0.03;
/// A tape across a wall makes an angle with it whose cosine is below this.
const ACROSS: f64 = 0.5;
/// A tape that disagrees with the map by more than this share was held elsewhere.
const MOST: f64 = 0.06;
/// A tape whose ends are known to no better than this share of it says nothing of wheels that are off by a third of that.
const VAGUE: f64 = 3.0 * SCALE_SD;

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
    /// How well that is known, as a share: one standard deviation, by how well the ends are known on the map.
    #[serde(default)]
    pub sd: f64,
}

/// A tape is read to this, metres.
const READ: f64 = 0.002;

impl Taped {
    /// How well the scale of the map is known now, and with it the travel of a wheel, as a share: one standard
    /// deviation, the reading of the tape included.
    #[must_use]
    pub fn doubt(&self) -> f64 {
        angle::hypot(self.sd, READ / self.taped)
    }
}

/// Why a taped length made nothing of the map.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Untaped {
    /// There is no wall near its ends.
    Nowhere,
    /// Where its ends were is known so badly that it says nothing, as along one and the same wall.
    Vague,
    /// It is off by more than wheels can be.
    Refused {
        /// The length on the map, metres.
        mapped: f64,
        /// What the tape said, metres.
        taped: f64,
    },
}

impl fmt::Display for Untaped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nowhere => f.write_str("taped length not used: no wall near its ends"),
            Self::Vague => f.write_str(
                "taped length not used: along a wall nobody knows where it was held; tape from corner to corner, or \
                 from wall to wall",
            ),
            Self::Refused { mapped, taped } => write!(
                f,
                "taped length not used: {taped:.3} m, but {mapped:.3} m on the map (was it held here?)"
            ),
        }
    }
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
    /// Both ends in one place.
    #[error("both ends of the tape are in one place; name two corners or walls")]
    OnePlace,
    /// Nowhere in the room.
    #[error("an end of the tape, or its length, is more than 100 km; lengths are metres")]
    Far,
}

/// Nothing is farther from the origin, metres.
const FAR: f64 = 1e5;

impl FromStr for Tape {
    type Err = TapeError;

    fn from_str(text: &str) -> Result<Self, TapeError> {
        let number = |text: &str| -> Result<f64, TapeError> {
            let value = text.trim();
            let value = value.strip_suffix('m').unwrap_or(value).trim_end().parse();
            value.ok().filter(|value: &f64| value.is_finite()).ok_or(TapeError::Form)
        };
        let point = |text: &str| {
            let (x, y) = text.split_once(',').ok_or(TapeError::Form)?;
            Ok(Point::new(number(x)?, number(y)?))
        };
        let (ends, length) = text.split_once('=').ok_or(TapeError::Form)?;
        let (from, to) = ends.split_once(':').ok_or(TapeError::Form)?;
        Self { from: point(from)?, to: point(to)?, length: number(length)? }.checked()
    }
}

impl Tape {
    /// The same tape, if one can have been held so.
    ///
    /// # Errors
    /// Says why not.
    pub fn checked(self) -> Result<Self, TapeError> {
        let Self { from, to, length } = self;
        let near = [from.x, from.y, to.x, to.y, length].iter().all(|value| value.abs() <= FAR);
        if !near {
            Err(TapeError::Far)
        } else if length < SHORTEST {
            Err(TapeError::Short)
        } else if (to - from).norm() < SHORTEST / 2.0 {
            Err(TapeError::OnePlace)
        } else {
            Ok(self)
        }
    }

    /// The length on a map with `outline`: between the corners that its ends are near to, or the
    /// nearest places of the walls; none when an end is near to neither. Of several such pairs that
    /// one which is likeliest: near to where the ends were said to be, and about as long as the tape.
    #[must_use]
    pub fn on(&self, outline: &Ring) -> Option<Length> {
        let (from, to) = (places(outline, self.from, self.to), places(outline, self.to, self.from));
        let pairs: Vec<(f64, Length)> = from
            .iter()
            .flat_map(|from| to.iter().map(move |to| (from, to)))
            .map(|(from, to)| {
                let mapped = (to.at - from.at).norm();
                let off = (from.at - self.from).norm_squared() + (to.at - self.to).norm_squared();
                let scale = (self.length / mapped - 1.0) / SCALE_SD;
                let unlikely = off / PLACE_SD.powi(2) + scale * scale;
                (unlikely, Length { mapped, sd: angle::hypot(from.sd, to.sd) })
            })
            .filter(|(_, length)| length.mapped > 0.1)
            .collect();
        let (least, best) = *pairs.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        // The others it may have been held to, as likely as they are.
        let (mut sum, mut weights) = (0.0, 0.0);
        for (unlikely, other) in &pairs {
            let weight = libm::exp((least - unlikely) / 2.0);
            sum += weight * (other.mapped - best.mapped).powi(2);
            weights += weight;
        }
        Some(Length { sd: (best.sd.powi(2) + sum / weights).sqrt(), ..best })
    }

    /// By how much to stretch a map that is `stretched` already and on which the length is `mapped` now;
    /// none when the two are so far apart that the tape was held elsewhere. The whole stretch is what the
    /// tape says, drawn towards none the more, the worse its ends are known.
    #[must_use]
    pub fn stretch(&self, mapped: Length, stretched: f64) -> Option<f64> {
        let ratio = self.length / mapped.mapped;
        if (ratio - 1.0).abs() >= MOST {
            return None;
        }
        let trust = SCALE_SD.powi(2) / (SCALE_SD.powi(2) + mapped.share().powi(2));
        Some((1.0 + trust * (ratio * stretched - 1.0)) / stretched)
    }
}

/// A length on the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Length {
    /// Metres.
    pub mapped: f64,
    /// One standard deviation, metres: of where its ends are.
    pub sd: f64,
}

impl Length {
    /// The standard deviation as a share of the length.
    fn share(&self) -> f64 {
        self.sd / self.mapped
    }

    /// Whether its ends are known so badly that a tape between them says nothing.
    #[must_use]
    pub fn is_vague(&self) -> bool {
        self.share() > VAGUE
    }

    /// How well the scale is known once this was taped, as a share: one standard deviation of the mean of what the
    /// tape says and what wheels are.
    #[must_use]
    pub fn doubt(&self) -> f64 {
        SCALE_SD * self.share() / angle::hypot(SCALE_SD, self.share())
    }
}

/// What one end of a tape may have been held to.
struct Place {
    at: Point,
    /// One standard deviation, metres.
    sd: f64,
}

/// What of `outline` a tape that goes to `other` may have been held to when its end was said to be
/// at `end`: the corners near by, and the wall. A tape that runs along the wall ends at a corner. On a wall it
/// was held about where it was said to be: as far as it slants to the wall, the length is other elsewhere, and so
/// it is round a bend.
fn places(outline: &Ring, end: Point, other: Point) -> Vec<Place> {
    let count = outline.pieces.len();
    let corner = |k: usize| {
        let (before, after) = (&outline.pieces[(k + count - 1) % count], &outline.pieces[k]);
        let long = before.length().min(after.length()) > LONG_WALL;
        Place { at: after.from(), sd: if long { SURE_END } else { RAGGED_END } }
    };
    let near = |place: &Place| (place.at - end).norm() < CORNER;
    let mut places: Vec<Place> = (0..count).map(corner).filter(near).collect();
    if let Some(foot) = outline.nearest(end).filter(|foot| foot.distance < OFF) {
        let piece = &outline.pieces[foot.piece];
        let along = piece.tangent(foot.t).dot(&(other - end)).abs();
        let length = (other - end).norm();
        if places.is_empty() || along < ACROSS * length {
            let sd = if piece.length() > LONG_WALL { SURE_END } else { RAGGED_END };
            let bend = match *piece {
                Piece::Arc { radius, .. } => PLACE_SD.powi(2) / (2.0 * radius),
                Piece::Line { .. } => 0.0,
            };
            let elsewhere = angle::hypot(along / length * PLACE_SD, bend);
            places.push(Place { at: piece.at(foot.t), sd: angle::hypot(sd, elsewhere) });
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
        let along = tape((0.0, 0.0), (5.0, 0.0), 5.0).on(&outline).expect("two corners").mapped;
        assert!((along - 5.1).abs() < 1e-9, "{along}");
        let across = tape((-0.02, 2.0), (5.0, 2.0), 5.0).on(&outline).expect("two walls").mapped;
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
            let on = tape((0.0, 0.0), (4.9, 0.1), length).on(&outline).expect("two places").mapped;
            assert!((on - mapped).abs() < 2e-3, "{length}: {on}");
        }
    }

    #[test]
    fn a_tape_that_slants_to_a_wall_says_little() {
        let corners = [(0.0, 0.0), (5.0, 0.0), (5.0, 4.5), (0.0, 4.5)];
        let outline = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        let stretch = |tape: Tape| {
            let length = tape.on(&outline).expect("a corner and a wall");
            (tape.stretch(length, 1.0).expect("near") - 1.0).abs()
        };
        // Held at (1.2, 4.5), said to be 15 cm from there: 4 cm less, and nothing is wrong with the map.
        let slanting = stretch(tape((0.0, 0.0), (1.35, 4.5), 4.657));
        assert!(slanting < 0.004, "{slanting}");
        let across = stretch(tape((2.5, 0.0), (2.5, 4.5), 4.455));
        assert!(across > 0.008, "{across}");
        let doubt = |tape: Tape| tape.on(&outline).expect("walls").doubt();
        let (slanting, across) =
            (doubt(tape((0.0, 0.0), (1.35, 4.5), 4.7)), doubt(tape((2.5, 0.0), (2.5, 4.5), 4.5)));
        assert!(across < 0.002 && (0.004..SCALE_SD).contains(&slanting), "{across} {slanting}");
    }

    /// Along a wall every place is as far from the next as the tape says.
    #[test]
    fn a_tape_that_was_held_along_a_wall_says_nothing_but_from_corner_to_corner() {
        let corners = [(0.0, 0.0), (5.0, 0.0), (5.0, 4.5), (0.0, 4.5)];
        let outline = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        let is_vague =
            |from, to, length: f64| tape(from, to, length).on(&outline).expect("walls").is_vague();
        assert!(is_vague((1.0, 0.0), (4.0, 0.0), 3.0));
        assert!(is_vague((0.0, 0.0), (4.0, 0.0), 4.0), "only one of its ends is a corner");
        assert!(!is_vague((0.0, 0.0), (5.0, 0.0), 5.02));
        assert!(!is_vague((2.5, 0.0), (2.5, 4.5), 4.5) && !is_vague((0.0, 0.0), (1.35, 4.5), 4.7));
    }

    #[test]
    fn no_wall_is_half_a_metre_from_where_the_tape_was_held() {
        let corners = [(-0.7, -0.7), (4.3, -0.7), (4.3, 3.3), (-0.7, 3.3)];
        let outline = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        assert_eq!(tape((0.0, 0.0), (5.0, 0.0), 5.02).on(&outline), None);
    }

    #[test]
    fn a_tape_that_was_held_elsewhere_is_not_believed() {
        let held = tape((0.0, 0.0), (5.0, 0.0), 5.0);
        let mapped = |mapped: f64| Length { mapped, sd: 0.0 };
        assert!(
            (held.stretch(mapped(5.05), 1.0).expect("one per cent") - 5.0 / 5.05).abs() < 1e-12
        );
        assert_eq!(held.stretch(mapped(5.5), 1.0), None);
    }

    #[test]
    fn a_tape_between_ragged_ends_says_little() {
        // A wall of 3 m that ends in steps of 6 cm, 2 % longer on the map than by the tape.
        let steps =
            |x: f64, by: f64| (0..5).map(move |k| (x + by * f64::from(k % 2), 0.06 * f64::from(k)));
        let ragged: Vec<Point> = steps(3.06, 0.05)
            .chain([(3.06, 2.0), (0.0, 2.0)])
            .chain(steps(0.0, -0.05).collect::<Vec<_>>().into_iter().rev())
            .map(|(x, y)| Point::new(x, y))
            .collect();
        let plain =
            [(0.0, 0.0), (3.06, 0.0), (3.06, 2.0), (0.0, 2.0)].map(|(x, y)| Point::new(x, y));
        let held = tape((0.0, 0.0), (3.0, 0.0), 3.0);
        let stretch = |corners: &[Point]| {
            let length = held.on(&Ring::polygon(corners)).expect("two corners");
            1.0 - held.stretch(length, 1.0).expect("two per cent")
        };
        assert!(stretch(&plain) > 0.015, "{}", stretch(&plain));
        assert!(stretch(&ragged) < 0.006, "{}", stretch(&ragged));
        // What was stretched already is not stretched again.
        let length = |mapped: f64| Length { mapped, sd: 0.018 };
        let first = held.stretch(length(3.03), 1.0).expect("one per cent");
        let again = held.stretch(length(3.03 * first), first).expect("less");
        assert!((again - 1.0).abs() < 1e-4, "{again}");
    }
}
