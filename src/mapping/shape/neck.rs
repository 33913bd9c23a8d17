//! Things that stand so near to the wall that the robot could not pass between: it went round them as
//! part of the wall, and the outline joins them to it by two chords across the gap, which nobody has
//! touched. Such a thing is an object of its own; that the gap is too narrow to pass does not make
//! it wall. Where the two stand side by side for longer than a corner takes, they are one obstacle.

use crate::geometry::simple::crossings;
use crate::geometry::{Piece, Point, Ring};
use crate::mapping::map::{Contact, ContactKind};

/// A contact this near to a chord speaks for it, metres ...
const SUPPORT: f64 = 0.015;
/// ... unless it is this near to its end, metres.
const END: f64 = 0.03;
/// A chord across a gap is at least this long, metres: behind a narrower gap the thing is wall for
/// every purpose of the robot's.
const SHORTEST: f64 = 0.22;
/// Corners next to the chords that may be left out to make an outline simple.
const TRIMMED: usize = 3;
/// The two chords of a neck begin, and end, no farther apart than this, metres.
const NECK: f64 = 0.1;
/// What runs along the wall, too near to pass, for longer than this stays part of it, metres.
const LONGEST_NECK: f64 = 0.2;
/// The gap counts as too near to pass when it is narrower than the narrowest passable one by this,
/// metres.
const SURE: f64 = 0.04;
/// Nothing smaller than this is cut off, square metres.
const SMALLEST: f64 = 8e-4;
/// What is thinner than this is no thing, metres.
const THINNEST: f64 = 0.006;
/// Nothing larger than this share of the room is cut off.
const LARGEST: f64 = 0.25;
/// Cuts at most.
const MOST_CUTS: u32 = 20;
/// Islands of more pieces than this are not searched for rounds.
const MOST_PIECES: usize = 120;
/// Chords stand for arcs within this, metres.
const SAGITTA: f64 = 0.001;

/// The outline without the things that only untouched chords join to it, and the outlines of those,
/// counter-clockwise; `widest` is the widest gap that the robot does not pass, metres.
#[must_use]
pub fn islands(outline: Ring, contacts: &[Contact], widest: f64) -> (Ring, Vec<Ring>) {
    let touched: Vec<Point> =
        contacts.iter().filter(|c| c.kind != ContactKind::Edge).map(|c| c.point).collect();
    let mut outline = outline;
    let mut found = Vec::new();
    let mut cuts = 0;
    while cuts < MOST_CUTS
        && let Some((rest, island)) = cut(&outline, &touched, widest)
    {
        outline = rest;
        cuts += 1;
        // What is thinner than that is a corner that was touched unevenly, and nothing standing there.
        if 2.0 * island.area().abs() > THINNEST * island.perimeter() {
            found.push(island);
        }
    }
    (outline, found)
}

/// Whether the piece crosses a gap: straight, not long, and touched nowhere between its ends.
fn is_chord(piece: &Piece, touched: &[Point], widest: f64) -> bool {
    let length = piece.length();
    if !matches!(piece, Piece::Line { .. }) || !(SHORTEST..widest).contains(&length) {
        return false;
    }
    let (from, to) = (piece.from(), piece.to());
    let along = (to - from) / length;
    let end = END.min(length / 4.0);
    !touched.iter().any(|p| {
        let s = along.dot(&(p - from));
        (end..length - end).contains(&s) && piece.distance(*p) < SUPPORT
    })
}

fn cut(outline: &Ring, touched: &[Point], widest: f64) -> Option<(Ring, Ring)> {
    let pieces = &outline.pieces;
    let chords: Vec<usize> =
        (0..pieces.len()).filter(|&k| is_chord(&pieces[k], touched, widest)).collect();
    let mut pairs = chords
        .iter()
        .enumerate()
        .flat_map(|(n, &i)| chords[n + 1..].iter().flat_map(move |&k| [(i, k), (k, i)]));
    pairs.find_map(|(i, k)| {
        split(outline, i, k)
            .filter(|(rest, island)| beside(island, rest, widest - SURE) < LONGEST_NECK)
    })
}

/// Metres of `island` that lie nearer to `rest` than `gap`.
fn beside(island: &Ring, rest: &Ring, gap: f64) -> f64 {
    let pace = 0.005;
    let near = |piece: &Piece| {
        let steps = (piece.length() / pace).ceil().max(1.0);
        let share = piece.length() / steps;
        (0..steps as u32)
            .map(|k| piece.at((f64::from(k) + 0.5) / steps))
            .filter(|p| rest.distance(*p) < gap)
            .count() as f64
            * share
    };
    island.pieces.iter().map(near).sum()
}

/// The outline cut at the chords `i` and `k`: what lies between them on the way from `i` to `k` is the
/// island.
fn split(outline: &Ring, i: usize, k: usize) -> Option<(Ring, Ring)> {
    let pieces = &outline.pieces;
    let count = pieces.len();
    let (to_island, from_island) = (pieces[i], pieces[k]);
    let (a, b) = (to_island.from(), to_island.to());
    let (c, d) = (from_island.from(), from_island.to());
    if (a - d).norm() > NECK || (b - c).norm() > NECK {
        return None;
    }
    let between = |from: usize, to: usize| -> Vec<Piece> {
        let steps = (to + count - from - 1) % count;
        (1..=steps).map(|n| pieces[(from + n) % count]).collect()
    };
    let closed = |mut ring: Vec<Piece>| -> Option<Ring> {
        let (first, last) = (ring.first()?.from(), ring.last()?.to());
        if (first - last).norm() > 1e-4 {
            ring.push(Piece::with_bulge(last, first, 0.0));
        }
        let ring = Ring { pieces: ring };
        crossings(&ring.to_points(SAGITTA)).is_empty().then_some(ring)
    };
    let trimmed = |whole: &[Piece]| {
        let trims = (0..=2 * TRIMMED).flat_map(|sum| (0..=sum).map(move |m| (m, sum - m)));
        trims
            .filter(|(m, n)| *m <= TRIMMED && *n <= TRIMMED && m + n + 3 <= whole.len())
            .find_map(|(m, n)| closed(whole[m..whole.len() - n].to_vec()))
    };
    let rest = trimmed(&between(k, i))?;
    let whole = between(i, k);
    let island = trimmed(&whole).or_else(|| one_round(&whole).and_then(closed))?;
    let area = island.area();
    if island.pieces.len() < 3
        || rest.pieces.len() < 3
        || -area < SMALLEST
        || -area > LARGEST * rest.area()
    {
        return None;
    }
    let points = island.to_points(SAGITTA);
    let inside = points.iter().all(|p| rest.contains(*p) || rest.distance(*p) < 1e-3);
    inside.then(|| (rest, island.counter_clockwise()))
}

/// One round of what was gone round more than once: of the stretches of `pieces` that come back to
/// where they began without crossing themselves, the one that encloses most.
fn one_round(pieces: &[Piece]) -> Option<Vec<Piece>> {
    let count = pieces.len();
    if count > MOST_PIECES {
        return None;
    }
    let mut rounds: Vec<(f64, usize, usize)> = (0..count)
        .flat_map(|m| (m + 3..=count).map(move |n| (m, n)))
        .filter(|&(m, n)| (pieces[m].from() - pieces[n - 1].to()).norm() < NECK)
        .map(|(m, n)| {
            let mut ring = pieces[m..n].to_vec();
            ring.push(Piece::with_bulge(pieces[n - 1].to(), pieces[m].from(), 0.0));
            (Ring { pieces: ring }.area(), m, n)
        })
        .collect();
    // Gone round with the floor on the left, its area counts as negative.
    rounds.sort_by(|a, b| a.0.total_cmp(&b.0));
    rounds.into_iter().map(|(_, m, n)| pieces[m..n].to_vec()).find(|stretch| {
        let mut points = Ring { pieces: stretch.clone() }.to_points(SAGITTA);
        points.push(stretch[stretch.len() - 1].to());
        crossings(&points).is_empty()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contact(x: f64, y: f64) -> Contact {
        Contact {
            point: Point::new(x, y),
            from: Point::new(x, y),
            sensor: Some(0),
            kind: ContactKind::Range,
            time: 0.0,
        }
    }

    /// A room of 4 x 3 m with a box of 0.4 m that stands on its corner 0.28 m off the lower wall,
    /// joined to it at x = 2.0 by a neck 0.04 m wide.
    fn room() -> Ring {
        joined(&[(1.74, 0.54), (2.02, 0.82), (2.3, 0.54)], 0.28)
    }

    /// The same room with another thing that the neck, `gap` metres long, leads to.
    fn joined(thing: &[(f64, f64)], gap: f64) -> Ring {
        let mut corners = vec![(0.0, 0.0), (2.0, 0.0), (2.0, gap)];
        corners.extend(thing);
        corners.extend([(2.04, gap), (2.04, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)]);
        let points: Vec<Point> = corners.into_iter().map(|(x, y)| Point::new(x, y)).collect();
        Ring::polygon(&points)
    }

    #[test]
    fn a_box_behind_a_gap_is_cut_off() {
        let (rest, found) = islands(room(), &[contact(1.0, 0.0), contact(1.74, 0.54)], 0.34);
        assert_eq!(found.len(), 1);
        assert!((found[0].area() - 0.1564).abs() < 1e-9, "{}", found[0].area());
        assert!((rest.area() - 12.0).abs() < 1e-9, "{}", rest.area());
    }

    #[test]
    fn a_box_whose_side_runs_along_the_wall_is_one_obstacle_with_it() {
        let side_on = joined(&[(1.8, 0.28), (1.8, 0.68), (2.2, 0.68), (2.2, 0.28)], 0.28);
        let (rest, found) = islands(side_on.clone(), &[contact(1.0, 0.0)], 0.34);
        assert!(found.is_empty());
        assert_eq!(rest, side_on);
    }

    #[test]
    fn a_box_gone_round_twice_is_cut_off_once() {
        let again = [(1.74, 0.54), (2.02, 0.82), (2.3, 0.54), (2.03, 0.29)];
        let once = [(1.75, 0.54), (2.02, 0.81), (2.29, 0.54)];
        let twice: Vec<(f64, f64)> = again.into_iter().chain(once).collect();
        let (rest, found) = islands(joined(&twice, 0.28), &[contact(1.0, 0.0)], 0.34);
        assert_eq!(found.len(), 1);
        assert!((found[0].area() - 0.15).abs() < 0.01, "{}", found[0].area());
        assert!((rest.area() - 12.0).abs() < 1e-9, "{}", rest.area());
    }

    #[test]
    fn a_neck_that_was_touched_is_wall() {
        let (rest, found) = islands(room(), &[contact(2.0, 0.1), contact(2.04, 0.1)], 0.34);
        assert!(found.is_empty());
        assert_eq!(rest, room());
    }

    #[test]
    fn a_gap_that_could_be_passed_is_no_neck() {
        let (_, found) = islands(room(), &[], 0.15);
        assert!(found.is_empty());
    }
}
