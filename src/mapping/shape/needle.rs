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

/// The needles of `outline`, on which `contacts` were made on the way of `strokes`, the deepest first: where one has a
/// corner on its way, before what is left of it without that. Where the body touched something is a guess, and parts
/// no gap.
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
    let runs = runs.filter(|(_, sides)| count > sides + 1);
    let mut pointed: Vec<(usize, usize, Piece, Point)> = runs.filter_map(needle).collect();
    if pointed.is_empty() {
        return Vec::new();
    }
    let deep = |(.., base, tip): &(usize, usize, Piece, Point)| base.distance(*tip);
    pointed.sort_by(|one, other| deep(other).total_cmp(&deep(one)));
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A room of 4 x 3 m with a needle of `through`, corners of it, that stands on its lower wall.
    fn room(through: &[(f64, f64)]) -> Ring {
        let ends = [[(0.0, 0.0), (1.9, 0.0)], [(2.1, 0.0), (4.0, 0.0)]];
        let corners =
            ends[0].iter().chain(through).chain(&ends[1]).chain(&[(4.0, 3.0), (0.0, 3.0)]);
        Ring::polygon(&corners.map(|&(x, y)| Point::new(x, y)).collect::<Vec<_>>())
    }

    fn contact(x: f64, y: f64, kind: ContactKind) -> Contact {
        let from = Point::new(x - 0.1, y + 0.1);
        Contact { point: Point::new(x, y), from, sensor: Some(0), kind, time: 0.0 }
    }

    fn found(outline: &Ring, contacts: &[Contact]) -> Vec<Needle> {
        needles(outline, contacts, &[], &Chassis::default())
    }

    #[test]
    fn a_needle_is_what_nobody_touched_but_by_a_guess() {
        let straight = room(&[(2.0, 0.25)]);
        let [needle] = &found(&straight, &[])[..] else { panic!("one") };
        assert_eq!(needle.tip, Point::new(2.0, 0.25));
        assert!((needle.bare.area() - 12.0).abs() < 1e-9, "{}", needle.bare.area());
        assert_eq!(found(&straight, &[contact(1.95, 0.125, ContactKind::Touch)]).len(), 1);
        assert!(found(&straight, &[contact(1.95, 0.125, ContactKind::Range)]).is_empty());
        // Such a guess may be a corner of it.
        let bent = room(&[(1.95, 0.13), (2.0, 0.25)]);
        let tips: Vec<Point> = found(&bent, &[]).iter().map(|needle| needle.tip).collect();
        assert_eq!(tips, [Point::new(2.0, 0.25); 2]);
        assert!((found(&bent, &[])[0].bare.area() - 12.0).abs() < 1e-9);
        // What is short, or as broad as a thing, is none.
        assert!(found(&room(&[(2.0, 0.1)]), &[]).is_empty());
        assert!(found(&room(&[(1.7, 0.25), (2.3, 0.25)]), &[]).is_empty());
    }

    #[test]
    fn about_a_thing_the_outline_leads_to_it_and_round_it() {
        let outline = room(&[(2.0, 0.25)]);
        let [needle] = &found(&outline, &[])[..] else { panic!("one") };
        let post = Ring::circle(Point::new(2.0, 0.3), 0.04);
        let whole = needle.about(&post).expect("an outline");
        assert!(!whole.contains(Point::new(2.0, 0.3)) && whole.contains(Point::new(2.0, 0.35)));
        assert!(post.to_points(DRAWN).iter().all(|p| whole.distance(*p) < 0.2));
        // The trapezium between wall and post, and the far half of the post.
        let solid = 12.0 - whole.area();
        assert!((0.035..0.055).contains(&solid), "{solid}");
        assert!(whole.area() > 0.0 && whole.contains(Point::new(1.0, 1.0)));
        // What reaches over the wall on both sides hides the needle.
        let [a, b] = [Point::new(1.5, -0.2), Point::new(2.5, 0.3)];
        let board = Ring::polygon(&[a, Point::new(b.x, a.y), b, Point::new(a.x, b.y)]);
        assert_eq!(needle.about(&board), None);
    }
}
