//! Checks of one outline: numbers, size, simplicity.

use super::{MOST_VERTICES, SAGITTA, WorldError};
use crate::geometry::ring::chord_count;
use crate::geometry::{Piece, Point, Ring, cross};

/// A corner as written: x, y and the bulge of the arc to the next corner.
pub(super) type Corner = (f64, f64, f64);

/// Nothing lies farther from the origin in x or y, metres.
const FAR: f64 = 1e5;
const TOO_FAR: &str = "lies more than 100 km from the origin; lengths are metres";

/// Corners that no more than this of an outline parts, metres, are one: other programs write it twice, each time
/// with the rounding of its own sums, and so short a piece would be met by those on either side of it.
const ROUNDING: f64 = 1e-6;

/// The ring through `corners`, checked and counter-clockwise.
pub(super) fn ring(corners: &[Corner], place: &str) -> Result<Ring, WorldError> {
    let error = |what: String| Err(WorldError::new(place, what));
    if corners.len() > MOST_VERTICES {
        return error(format!(
            "{} vertices are more than the {MOST_VERTICES} that are allowed; simplify it",
            corners.len()
        ));
    }
    if let Some(k) =
        corners.iter().position(|c| !(c.0.is_finite() && c.1.is_finite() && c.2.is_finite()))
    {
        return error(format!("{} is not a number", vertex(k)));
    }
    if corners.iter().any(|c| c.0.abs() > FAR || c.1.abs() > FAR) {
        return error(TOO_FAR.to_owned());
    }
    let mut kept: Vec<Corner> = Vec::with_capacity(corners.len());
    for &c in corners {
        match kept.last_mut() {
            // What leads on from a corner that is written twice is what is written last.
            Some(last) if is_same(*last, c) => last.2 = c.2,
            _ => kept.push(c),
        }
    }
    while kept.len() > 1 && is_same(kept[kept.len() - 1], kept[0]) {
        kept.pop();
    }
    let bulged = kept.iter().any(|c| c.2 != 0.0);
    if kept.len() < if bulged { 2 } else { 3 } {
        return error("an outline needs three different vertices".to_owned());
    }
    let count = kept.len();
    let pieces = (0..count).map(|k| piece(kept[k], kept[(k + 1) % count])).collect();
    let ring = Ring { pieces };
    // A bulge can throw an arc far beyond its ends.
    let points = ring.bounds().map_or([0.0; 4], |(low, high)| [low.x, low.y, high.x, high.y]);
    if !points.iter().all(|value| value.abs() <= FAR) {
        return error(TOO_FAR.to_owned());
    }
    if let Some((a, b)) = first_crossing(&ring) {
        let side = |k: usize| {
            let (from, to) = (ring.pieces[k].from(), ring.pieces[k].to());
            format!("({}, {}) to ({}, {})", from.x, from.y, to.x, to.y)
        };
        let (one, other) = (side(a), side(b));
        return error(format!(
            "the outline crosses itself: what leads from {one} meets what leads from {other}"
        ));
    }
    if ring.area().abs() < 1e-6 {
        return error("the outline encloses no area".to_owned());
    }
    Ok(ring.counter_clockwise())
}

/// What a message calls the vertex at index `k` of an outline.
pub(super) fn vertex(k: usize) -> String {
    format!("vertex {k} (counted from 0)")
}

/// What leads from a corner to the next one.
fn piece(from: Corner, to: Corner) -> Piece {
    Piece::with_bulge(Point::new(from.0, from.1), Point::new(to.0, to.1), from.2)
}

/// Whether nothing but rounding parts a corner from the next one.
fn is_same(corner: Corner, next: Corner) -> bool {
    piece(corner, next).length() <= ROUNDING
}

/// A full circle, checked.
pub(super) fn circle(center: [f64; 2], radius: f64, place: &str) -> Result<Ring, WorldError> {
    if !(center[0].is_finite() && center[1].is_finite() && radius.is_finite()) {
        return Err(WorldError::new(place, "the circle is not a number"));
    }
    if radius <= 0.0 {
        return Err(WorldError::new(place, format!("radius {radius} must be above 0")));
    }
    if center.iter().any(|value| value.abs() + radius > FAR) {
        return Err(WorldError::new(place, TOO_FAR));
    }
    Ok(Ring::circle(Point::new(center[0], center[1]), radius))
}

/// Letters of the longest name: it has to fit on a screen and in a picture.
const LONGEST_NAME: usize = 200;

/// A name, checked: what a map can be called, a world and what stands in it can. One without letters, as other programs
/// write it for what has none, is none.
pub(super) fn name(name: &str, place: &str) -> Result<Option<String>, WorldError> {
    let name = name.trim();
    if name.is_empty() {
        return Ok(None);
    }
    if name.chars().any(char::is_control) {
        return Err(WorldError::new(place, "has control characters in it"));
    }
    let letters = name.chars().count();
    if letters > LONGEST_NAME {
        let what = format!("has {letters} letters; {LONGEST_NAME} are the most");
        return Err(WorldError::new(place, what));
    }
    Ok(Some(name.to_owned()))
}

/// The first two pieces that cross or touch without being neighbours. Sweeps over x, so that long
/// outlines take time in proportion to what overlaps.
fn first_crossing(ring: &Ring) -> Option<(usize, usize)> {
    let mut chords: Vec<(Point, Point, usize)> = Vec::new();
    for (index, piece) in ring.pieces.iter().enumerate() {
        // The chords that the body will meet.
        let steps = match *piece {
            Piece::Line { .. } => 1,
            Piece::Arc { radius, sweep, .. } => chord_count(radius, sweep, SAGITTA),
        };
        for k in 0..steps {
            let at = |k: u32| piece.at(f64::from(k) / f64::from(steps));
            chords.push((at(k), at(k + 1), index));
        }
    }
    let count = chords.len();
    let mut order: Vec<usize> = (0..count).collect();
    let low = |k: usize| chords[k].0.x.min(chords[k].1.x);
    let high = |k: usize| chords[k].0.x.max(chords[k].1.x);
    order.sort_by(|&a, &b| low(a).total_cmp(&low(b)));
    let mut active: Vec<usize> = Vec::new();
    for &k in &order {
        active.retain(|&j| high(j) >= low(k));
        for &j in &active {
            let apart = k.abs_diff(j);
            if apart > 1 && apart < count - 1 && meet(&chords[j], &chords[k]) {
                let (a, b) = (chords[j].2, chords[k].2);
                return Some((a.min(b), a.max(b)));
            }
        }
        active.push(k);
    }
    None
}

/// Twice the areas that the ends of `a` make with `b`, and those of `b` with `a`, by their sides.
fn sides(a: (Point, Point), b: (Point, Point)) -> [f64; 4] {
    let side = |p: Point, q: Point, r: Point| cross(q - p, r - p);
    [side(b.0, b.1, a.0), side(b.0, b.1, a.1), side(a.0, a.1, b.0), side(a.0, a.1, b.1)]
}

fn meet(a: &(Point, Point, usize), b: &(Point, Point, usize)) -> bool {
    let [d1, d2, d3, d4] = sides((a.0, a.1), (b.0, b.1));
    if d1 * d2 < 0.0 && d3 * d4 < 0.0 {
        return true;
    }
    let on = |p: Point, q: Point, r: Point| {
        r.x >= p.x.min(q.x) && r.x <= p.x.max(q.x) && r.y >= p.y.min(q.y) && r.y <= p.y.max(q.y)
    };
    (d1 == 0.0 && on(b.0, b.1, a.0))
        || (d2 == 0.0 && on(b.0, b.1, a.1))
        || (d3 == 0.0 && on(a.0, a.1, b.0))
        || (d4 == 0.0 && on(a.0, a.1, b.1))
}

/// How far a chord may stray from an arc where it is asked what lies in a room, metres.
const ROUGHLY: f64 = 0.01;

/// Whether some of the outline of `surface` lies inside `room`: a corner, the middle of a side, or a side that
/// goes through its wall.
pub(super) fn comes_into(surface: &Ring, room: &Ring) -> bool {
    let chords = |ring: &Ring| {
        let points = ring.to_points(ROUGHLY);
        let next = points.clone().into_iter().cycle().skip(1);
        points.into_iter().zip(next).collect::<Vec<_>>()
    };
    let ours = chords(surface);
    if ours.iter().any(|(a, b)| room.contains(*a) || room.contains(nalgebra::center(a, b))) {
        return true;
    }
    let Some((low, high)) = surface.bounds() else { return false };
    let near = |(a, b): &(Point, Point)| {
        let (least, most) = (a.inf(b), a.sup(b));
        least.x <= high.x && least.y <= high.y && most.x >= low.x && most.y >= low.y
    };
    let walls: Vec<(Point, Point)> = chords(room).into_iter().filter(near).collect();
    let through = |a: (Point, Point), b: (Point, Point)| {
        let [d1, d2, d3, d4] = sides(a, b);
        d1 * d2 < 0.0 && d3 * d4 < 0.0
    };
    ours.iter().any(|side| walls.iter().any(|wall| through(*side, *wall)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::angle;

    fn told(corners: &[Corner]) -> Result<f64, String> {
        ring(corners, "here").map(|ring| ring.area()).map_err(|error| error.to_string())
    }

    /// A corner that is written twice is one; the arc from it to the next is that of the last.
    #[test]
    fn a_corner_written_twice_keeps_the_arc_that_follows() {
        let once = [(0.0, 0.0, 0.0), (4.0, 0.0, 1.0), (4.0, 2.0, 0.0), (0.0, 2.0, 0.0)];
        let area = told(&once).expect("a room");
        assert!((area - 8.0 - std::f64::consts::FRAC_PI_2).abs() < 1e-9, "{area}");
        let mut twice = once.to_vec();
        twice.insert(1, (4.0, 0.0, 0.0));
        assert_eq!(told(&twice), Ok(area));
        let mut straight = once.to_vec();
        straight.insert(2, (4.0, 0.0, 0.0));
        let area = told(&straight).expect("a room");
        assert!((area - 8.0).abs() < 1e-9, "the way from the corner to itself has no arc: {area}");
    }

    /// Sums in another order end in another last digit.
    #[test]
    fn corners_that_differ_by_rounding_are_one() {
        let once = [(0.0, 0.0, 0.0), (4.0, 0.0, 1.0), (4.0, 2.0, 0.0), (0.0, 2.0, 0.0)];
        let area = told(&once).expect("a room");
        for off in [1e-15, -1e-15, 3e-10, -5e-7] {
            for k in 0..once.len() {
                // The arc that follows is that of the corner that is written last.
                let mut twice = once.to_vec();
                twice[k] = (once[k].0 + off, once[k].1 - off / 3.0, 0.5);
                twice.insert(k + 1, once[k]);
                let now = told(&twice).unwrap_or_else(|why| panic!("{off} at {k}: {why}"));
                assert!((now - area).abs() < 1e-5, "{off} at {k}: {now} of {area}");
            }
            // Closed by hand, as GeoJSON asks for.
            let mut closed = once.to_vec();
            closed.push((off, off / 2.0, 0.7));
            let now = told(&closed).unwrap_or_else(|why| panic!("{off}, closed: {why}"));
            assert!((now - area).abs() < 1e-5, "{off}, closed: {now} of {area}");
        }
        // A wall of a millimetre is one, and an arc that comes back to where it began as well.
        let step =
            [(0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (4.0, 2.0, 0.0), (3.999, 2.0, 0.0), (0.0, 3.0, 0.0)];
        assert_eq!(ring(&step, "here").expect("a room").pieces.len(), 5);
        let loops = [(0.0, 0.0, 0.0), (4.0, 0.0, 1e8), (4.0, 1e-8, 0.0), (0.0, 2.0, 0.0)];
        assert_eq!(ring(&loops, "here").expect("a room").pieces.len(), 4);
    }

    /// A hall between a half circle of 20 m and the straight wall at x = `back`, on either side of it, with a
    /// partition from there to `tip` metres from the circle's centre, half way between two of 32 equal parts.
    fn hall(back: f64, tip: f64) -> Result<f64, String> {
        let end = Point::origin() + angle::unit(angle::PI / 64.0) * tip;
        told(&[
            (0.0, -20.0, 1.0),
            (0.0, 20.0, 0.0),
            (back, 20.0, 0.0),
            (back, 1.5, 0.0),
            (end.x, end.y, 0.0),
            (back, 0.5, 0.0),
            (back, -20.0, 0.0),
        ])
    }

    #[test]
    fn a_wall_that_ends_short_of_an_arc_does_not_cross_it_and_one_beyond_it_does() {
        for (back, side) in [(-5.0, -1.0), (45.0, 1.0)] {
            for short in [1.0, 0.01, 0.001] {
                assert!(hall(back, 20.0 + side * short).is_ok(), "from {back}: {short} m short");
                let crossed = hall(back, 20.0 - side * short).expect_err("it goes through");
                assert!(crossed.contains("crosses itself"), "from {back}: {short} m: {crossed}");
            }
        }
    }
}
