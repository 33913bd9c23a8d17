//! Parallel lanes with the same promise as the other strategies: from one side of the floor to
//! the other, each lane as far from the last as the promise allows, cut to where it is needed.

use super::cover::Need;
use super::order::{self, Order};
use super::{Work, drive};
use crate::geometry::{Piece, Point, Segment, Vector, angle, perp};
use crate::mapping::map::{LineStatus, PlanLine};

/// Kept in hand for what lies between the raster's places, metres.
const GUARD: f64 = 0.013;
/// Offsets tried for a lane, as shares of the farthest that still serves.
const OFFSETS: [f64; 9] = [0.99, 0.85, 0.7, 0.5, 0.3, 0.0, -0.3, -0.6, -0.9];

/// The lanes in driving order with their total length in metres, numbered from `first` on:
/// whichever of the two directions of the longest wall comes out shorter.
pub(super) fn plan(work: &Work<'_>, first: u32) -> (Order, f64, Vec<PlanLine>) {
    let along = longest_wall(work);
    let over = (work.target / 2.0 - GUARD).max(0.002);
    let need = Need::new(work.floor, &work.lap, over, 1);
    [along, perp(along)]
        .into_iter()
        .map(|direction| {
            let lanes = lanes(work, need.clone(), direction, first);
            let (order, length) = order::shortest(work, &lanes.iter().collect::<Vec<_>>());
            (order, length, lanes)
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or_default()
}

fn longest_wall(work: &Work<'_>) -> Vector {
    let lines = work.shape.outline.pieces.iter().filter_map(|piece| match *piece {
        Piece::Line { from, to } => Some(to - from),
        Piece::Arc { .. } => None,
    });
    lines
        .max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()))
        .and_then(|wall| wall.try_normalize(1e-9))
        .unwrap_or_else(Vector::x)
}

/// Takes the outermost place still needed and lays a lane as far in as serves it, until none is
/// left.
fn lanes(work: &Work<'_>, mut need: Need, along: Vector, first: u32) -> Vec<PlanLine> {
    let across = perp(along);
    let mut places = need.places();
    places.sort_by(|a, b| {
        let depth = |p: &Point| p.coords.dot(&across);
        depth(&a.1).total_cmp(&depth(&b.1)).then(a.0.cmp(&b.0))
    });
    let far = work.floor.reach + work.target / 2.0 - GUARD;
    let mut lanes = Vec::new();
    for (index, place) in places {
        if !need.has(index) {
            continue;
        }
        let lane = OFFSETS.into_iter().find_map(|share| {
            let at = place + across * (far * share);
            let (from, to) = drive::through(work.floor, at, along)?;
            let piece = Segment::new(from, to);
            let serves = piece.distance_squared(place) < far * far;
            if !serves || !work.floor.is_drivable(at) {
                return None;
            }
            need.trimmed(&piece)
        });
        let Some((from, to)) = lane else {
            need.drop(index);
            continue;
        };
        need.serve(&need.span(&[Segment::new(from, to)]));
        need.drop(index);
        lanes.push(line(work, first + lanes.len() as u32, from, to));
    }
    lanes
}

/// A line of its own, entered at the nearest vertex.
pub(super) fn line(work: &Work<'_>, id: u32, from: Point, to: Point) -> PlanLine {
    let pieces = &work.shape.outline.pieces;
    let off = |k: &usize| (pieces[*k].from() - from).norm_squared();
    let vertex = (0..pieces.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
    let boundary = pieces.get(vertex).map_or(0.0, |piece| angle::of(piece.tangent(0.0)));
    PlanLine {
        id,
        part: 0,
        vertex,
        start: from,
        end: to,
        angle: angle::wrap_positive(angle::of(to - from) - boundary),
        drive: Some((from, to)),
        status: LineStatus::Planned,
        reason: None,
    }
}
