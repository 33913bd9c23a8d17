//! Places as the files of a map tell them: in metres, rounded to a tenth of a millimetre, and rings of them closed and
//! simple as GeoJSON wants them. Knows outlines, not what they are of.

use super::SAGITTA;
use crate::geometry::simple::crossings;
use crate::geometry::{Point, Ring};

/// `value` rounded to `decimals` decimals, with no negative zero.
pub(super) fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    let near = (value * scale).round() / scale;
    if near == 0.0 { 0.0 } else { near }
}

/// A point as exported: x and y in metres, to a tenth of a millimetre.
pub(super) fn position(point: Point) -> [f64; 2] {
    [rounded(point.x, 4), rounded(point.y, 4)]
}

/// The outline as an exported ring of positions, closed by repeating the first; none when fewer
/// than three positions differ.
pub(super) fn closed_positions(ring: &Ring) -> Option<Vec<[f64; 2]>> {
    let coarse = ring.to_points(SAGITTA);
    // A circle hardly larger than the sagitta is cut into two chords, which enclose nothing.
    let points = if coarse.len() < 8 && ring.pieces.len() < 3 {
        ring.to_points(SAGITTA / 10.0)
    } else {
        coarse
    };
    let positions = without_retraces(points.into_iter().map(position).collect());
    let first = *positions.first()?;
    (positions.len() >= 3).then(|| positions.into_iter().chain([first]).collect())
}

/// Whether a closed ring of positions, the last of which repeats the first, nowhere crosses or touches itself.
pub(super) fn is_simple(ring: &[[f64; 2]]) -> bool {
    let corners: Vec<Point> = ring.iter().skip(1).map(|&[x, y]| Point::new(x, y)).collect();
    crossings(&corners).is_empty()
}

/// The closed `positions` without one that repeats its neighbour, and without one at which the way turns back to where
/// it came from: rounding and the offset of an outline leave such, and a polygon with them is no valid one.
fn without_retraces(mut positions: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let mut k = 0;
    // How many have been looked at since something was left out.
    let mut kept = 0;
    while positions.len() > 1 && kept < positions.len() {
        let count = positions.len();
        k %= count;
        let (before, next) = (positions[(k + count - 1) % count], positions[(k + 1) % count]);
        if positions[k] == next || before == next {
            positions.remove(k);
            (k, kept) = (k + count - 2, 0);
        } else {
            (k, kept) = (k + 1, kept + 1);
        }
    }
    positions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_that_turns_back_on_itself_is_told_without_that() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let told = |corners: &[[f64; 2]]| without_retraces(corners.to_vec());
        assert_eq!(told(&square), square);
        // Out and back in two steps, and twice the same place.
        let [a, b, c, d] = square;
        let (out, farther) = ([1.2, 0.0], [1.3, 0.0]);
        assert_eq!(told(&[a, b, out, farther, out, b, c, c, d]), square);
        // The same where the ring begins in the middle of it.
        let begun = told(&[farther, out, b, c, d, a, b, out]);
        assert_eq!(begun.len(), 4, "{begun:?}");
        assert!(square.iter().all(|corner| begun.contains(corner)), "{begun:?}");
        assert!(is_simple(&[a, b, c, d, a]) && !is_simple(&[a, b, d, c, a]));
        assert!(told(&[a, b, a, b]).len() < 3, "a line encloses nothing");
    }
}
