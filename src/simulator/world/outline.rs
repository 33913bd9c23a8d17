//! Checks of one outline: numbers, size, simplicity.

use super::{MOST_VERTICES, WorldError};
use crate::geometry::{Piece, Point, Ring, cross};

/// A corner as written: x, y and the bulge of the arc to the next corner.
pub(super) type Corner = (f64, f64, f64);

/// Nothing lies farther from the origin in x or y, metres.
const FAR: f64 = 1e5;
const TOO_FAR: &str = "lies more than 100 km from the origin; lengths are metres";

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
        return error(format!("vertex {k} is not a number"));
    }
    if corners.iter().any(|c| c.0.abs() > FAR || c.1.abs() > FAR) {
        return error(TOO_FAR.to_owned());
    }
    let mut kept: Vec<Corner> = Vec::with_capacity(corners.len());
    for &c in corners {
        if kept.last().is_none_or(|last| last.0 != c.0 || last.1 != c.1) {
            kept.push(c);
        }
    }
    while kept.len() > 1
        && kept[0].0 == kept[kept.len() - 1].0
        && kept[0].1 == kept[kept.len() - 1].1
    {
        kept.pop();
    }
    let bulged = kept.iter().any(|c| c.2 != 0.0);
    if kept.len() < if bulged { 2 } else { 3 } {
        return error("an outline needs three different vertices".to_owned());
    }
    let count = kept.len();
    let pieces = (0..count)
        .map(|k| {
            let (from, to) = (kept[k], kept[(k + 1) % count]);
            Piece::with_bulge(Point::new(from.0, from.1), Point::new(to.0, to.1), from.2)
        })
        .collect();
    let ring = Ring { pieces };
    // A bulge can throw an arc far beyond its ends.
    let points = ring.bounds().map_or([0.0; 4], |(low, high)| [low.x, low.y, high.x, high.y]);
    if !points.iter().all(|value| value.abs() <= FAR) {
        return error(TOO_FAR.to_owned());
    }
    if let Some((a, b)) = first_crossing(&ring) {
        return error(format!("the outline crosses itself: piece {a} meets piece {b}"));
    }
    if ring.area().abs() < 1e-6 {
        return error("the outline encloses no area".to_owned());
    }
    Ok(ring.counter_clockwise())
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
        let steps = match piece {
            Piece::Line { .. } => 1,
            Piece::Arc { .. } => 32,
        };
        for k in 0..steps {
            let at = |k: i32| piece.at(f64::from(k) / f64::from(steps));
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

fn meet(a: &(Point, Point, usize), b: &(Point, Point, usize)) -> bool {
    let side = |p: Point, q: Point, r: Point| cross(q - p, r - p);
    let (d1, d2) = (side(b.0, b.1, a.0), side(b.0, b.1, a.1));
    let (d3, d4) = (side(a.0, a.1, b.0), side(a.0, a.1, b.1));
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
