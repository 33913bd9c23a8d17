//! Circular parts: diameters of a full circle, radii of a piece of one (paper III.E, figure 10).

use super::paper::{Entries, Entry};
use crate::geometry::{Piece, Point, angle};
use crate::mapping::map::{LineReason, Part, PartClass};
use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The random stream of the first diameter; other uses of the seed take others.
const STREAM: u64 = 0x0111_000E;
/// A radius nearer than this to a wall of the part runs along it, metres.
const ALONG: f64 = 0.002;

/// Enters the lines of one circular part.
pub(super) fn lines(entries: &mut Entries<'_>, index: usize, part: &Part, alpha: f64, seed: u64) {
    let Some((center, radius)) = part.circle else {
        return;
    };
    if part.class == PartClass::Circle {
        diameters(entries, index, center, radius, alpha, seed);
    } else {
        radii(entries, index, part, center, alpha);
    }
}

/// Diameters from a random point on, clockwise by arcs of α, until a point comes again.
fn diameters(
    entries: &mut Entries<'_>,
    index: usize,
    center: Point,
    radius: f64,
    alpha: f64,
    seed: u64,
) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(STREAM);
    let first = random.random::<f64>() * angle::TAU;
    let step = alpha / radius;
    let count = (angle::TAU / step - 1e-9).ceil().max(1.0) as usize;
    let turns: Vec<f64> = (0..count).map(|k| k as f64 * step).collect();
    for (vertex, &turn) in turns.iter().enumerate() {
        let away = angle::unit(first - turn) * radius;
        // The far end of an earlier diameter: the same line run the other way.
        let again = turn >= angle::PI - 1e-9
            && turns
                .iter()
                .any(|other| (turn - angle::PI - other).abs() < 1e-9);
        entries.enter(Entry {
            part: index,
            vertex,
            start: center + away,
            end: center - away,
            angle: angle::FRAC_PI_2,
            reason: again.then_some(LineReason::Duplicate),
        });
    }
}

/// Radii from every arc of the part to the centre, clockwise, both ends of the arc included.
fn radii(entries: &mut Entries<'_>, index: usize, part: &Part, center: Point, alpha: f64) {
    let mut vertex = 0;
    for piece in &part.ring.pieces {
        let Piece::Arc {
            center: own,
            radius,
            start,
            sweep,
        } = *piece
        else {
            continue;
        };
        // Arcs of other circles bound the part, but its lines lead to its own centre.
        if (own - center).norm() > 0.1 * radius {
            continue;
        }
        let size = sweep.abs();
        let step = alpha / radius;
        let count = (size / step - 1e-9).ceil().max(1.0) as usize;
        let last = if sweep > 0.0 { start + sweep } else { start };
        for k in 0..=count {
            let from = own + angle::unit(last - (k as f64 * step).min(size)) * radius;
            entries.enter(Entry {
                part: index,
                vertex,
                start: from,
                end: center,
                angle: angle::FRAC_PI_2,
                reason: reason(entries, part, from, center),
            });
            vertex += 1;
        }
    }
}

fn reason(entries: &Entries<'_>, part: &Part, from: Point, center: Point) -> Option<LineReason> {
    let places = [0.25, 0.5, 0.75].map(|t| from + (center - from) * t);
    let along = part.ring.pieces.iter().zip(&part.cut).any(|(piece, &cut)| {
        let wall = matches!(piece, Piece::Line { .. }) && !cut;
        wall && places.iter().all(|&p| piece.distance(p) < ALONG)
    });
    if along {
        return Some(LineReason::AlongBoundary);
    }
    // The centre of less than half a circle lies beyond the part's chord; with a wall there the
    // radius would leave the area.
    let inner = from + (center - from) * 0.02;
    let room = entries.floor.wall_clearance(center) > -ALONG;
    let clear = entries
        .floor
        .is_clear(inner, from + (center - from) * 0.98, 1e-3);
    (!(room && clear)).then_some(LineReason::LeavesArea)
}
