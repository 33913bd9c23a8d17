//! Needles of an outline: corners that it runs to and comes back from through a gap in which nobody has touched
//! anything. Where a lap goes round a post by the wall, the contacts behind it cross each other, and a needle that
//! ends at its back may be all that the outline keeps of it: it is given up where the post stands apart, and drawn
//! round it where the two are one obstacle. Knows outlines; what has been lost of them, and which of the two it is,
//! is for others to say.

use super::chord::Floor;
use super::gap::TOUCHING;
use super::neck::{NECK, SLANT, Touched};
use crate::geometry::hull::jarvis;
use crate::geometry::simple::crossings;
use crate::geometry::{Piece, Point, Ring};
use crate::mapping::map::{Contact, ContactKind};
use crate::mapping::wall::Stroke;
use crate::robot::Chassis;

/// Chords stand for arcs within this, metres.
const SAGITTA: f64 = 0.001;
/// A thing that is joined to the wall is drawn to this, metres.
const DRAWN: f64 = 0.004;
/// So many sides a needle has.
const SIDES: [usize; 2] = [2, 3];

/// A needle of an outline.
#[derive(Debug, Clone, PartialEq)]
pub struct Needle {
    /// Where it ends.
    pub tip: Point,
    /// The outline without it: its first piece leads straight from where the needle begins to where it is back.
    pub bare: Ring,
}

impl Needle {
    /// The outline with `thing` in place of the needle: the two sides lead on to it, and it round that, as a string
    /// that is drawn tight. None where they would not lead past it on either hand.
    #[must_use]
    pub fn about(&self, thing: &Ring) -> Option<Ring> {
        let side = self.bare.pieces[0];
        let mut points = thing.to_points(DRAWN);
        points.extend([side.from(), side.to()]);
        let (to, from) = (points.len() - 1, points.len() - 2);
        // Counter-clockwise, and what stands is on the right hand of an outline: it is followed the other way.
        let mut hull = jarvis(&points);
        hull.reverse();
        let first = hull.iter().position(|&k| k == from)?;
        hull.rotate_left(first);
        if hull.last() != Some(&to) || hull.len() < 3 {
            return None;
        }
        let corners = hull.windows(2);
        let string = corners.map(|pair| Piece::with_bulge(points[pair[0]], points[pair[1]], 0.0));
        let mut pieces = self.bare.pieces.clone();
        pieces.splice(..1, string);
        let whole = Ring { pieces };
        crossings(&whole.to_points(SAGITTA)).is_empty().then_some(whole)
    }
}

/// The needles of `outline`, on which `contacts` were made on the way of `strokes`. Where the body touched something
/// is a guess, and parts no gap.
#[must_use]
pub fn needles(
    outline: &Ring,
    contacts: &[Contact],
    strokes: &[Stroke],
    chassis: &Chassis,
) -> Vec<Needle> {
    let count = outline.pieces.len();
    let longest = SLANT * chassis.passable_gap();
    let needle = |(k, sides): (usize, usize)| {
        let side = |n: usize| outline.pieces[(k + n) % count];
        let base = Piece::with_bulge(side(0).from(), side(sides - 1).to(), 0.0);
        let corners = (1..sides).map(|n| side(n).from());
        let tip = corners.max_by(|a, b| base.distance(*a).total_cmp(&base.distance(*b)))?;
        let is_pointed = base.length() < NECK
            && base.distance(tip) > TOUCHING
            && (0..sides).all(|n| side(n).length() < longest);
        is_pointed.then_some((k, sides, base, tip))
    };
    // Where the body touched something in the gap there may be a corner.
    let runs = (0..count).flat_map(|k| SIDES.map(|sides| (k, sides)));
    let pointed: Vec<_> = runs.filter(|(_, sides)| count > sides + 1).filter_map(needle).collect();
    if pointed.is_empty() {
        return Vec::new();
    }
    let ranged: Vec<Contact> =
        contacts.iter().filter(|contact| contact.kind == ContactKind::Range).copied().collect();
    let seen = Touched::on(&ranged, strokes, chassis);
    let crosses = |piece: &Piece| seen.is_crossed_by(piece, Floor::Inside, &(0.0..longest));
    let blunted = |(k, sides, base, tip): (usize, usize, Piece, Point)| {
        let mut pieces = outline.pieces.clone();
        pieces.rotate_left(k);
        if !pieces[..sides].iter().all(crosses) {
            return None;
        }
        pieces.splice(..sides, [base]);
        let bare = Ring { pieces };
        let is_simple = crossings(&bare.to_points(SAGITTA)).is_empty();
        is_simple.then_some(Needle { tip, bare })
    };
    pointed.into_iter().filter_map(blunted).collect()
}
