//! What the robot did not get to, as the picture shows it: stretches of the outline that nobody touched,
//! and gaps too narrow for the body.

use super::super::RunRecord;
use super::Scene;
use super::pens::{HIDDEN, NARROW, UNTOUCHED, color};
use crate::geometry::{Piece, Point, Ring, Vector, perp};
use crate::mapping::unreached::{Beyond, Unreached};

/// The marks for everything unreached, and for what may hide something larger than α.
pub(super) fn draw(scene: &Scene<'_>) -> String {
    let (record, frame) = (scene.record, &scene.frame);
    let map = record.map;
    let ring = scene.wall.clone().unwrap_or_default();
    let (mut untouched, mut narrow, mut floor) = (String::new(), String::new(), String::new());
    for gap in &map.unreached {
        match gap.area {
            None => untouched.push_str(&frame.single(&stretch(gap, &ring))),
            Some(_) => narrow.push_str(&frame.single(&across(gap, record, &ring))),
        }
    }
    // A strait has its bar already, and no wall across it.
    for mouth in map.beyond.iter().filter_map(Beyond::mouth) {
        floor.push_str(&frame.single(&stretch(&mouth, &ring)));
    }
    // The wall under it is taken away first: nobody knows that there is one.
    let below = super::pens::Pen {
        id: "untouched-floor",
        color: color::FLOOR,
        width: 3.2,
        dashes: "",
        ..UNTOUCHED
    };
    floor.push_str(&untouched);
    let mut out = below.stroke(&floor);
    out.push_str(&UNTOUCHED.stroke(&untouched));
    out.push_str(&NARROW.stroke(&narrow));
    if let (Some(owed), Some(at)) = (map.shortfall(), map.hidden_at) {
        out.push_str(&HIDDEN.stroke(&frame.ring(&Ring::circle(at, owed.hidden / 2.0))));
    }
    out
}

/// The stretch of the outline that `gap` tells of.
fn stretch(gap: &Unreached, ring: &Ring) -> Piece {
    let piece = gap.piece_of(ring).and_then(|k| ring.pieces.get(k));
    piece.copied().unwrap_or_else(|| {
        let foot = ring.nearest(gap.at);
        let along = foot.and_then(|f| Some(ring.pieces.get(f.piece)?.tangent(f.t)));
        bar(gap, along.unwrap_or_else(Vector::x))
    })
}

/// The narrowest place, from one side to the other.
fn across(gap: &Unreached, record: &RunRecord<'_>, ring: &Ring) -> Piece {
    let mut straits = record.map.beyond.iter().filter_map(Beyond::mouth);
    if let Some(mouth) = straits.find(|mouth| mouth.at == gap.at) {
        return stretch(&mouth, ring);
    }
    let rings = record.map.objects.iter().map(|object| &object.outline).chain([ring]);
    let nearest = rings
        .filter_map(|ring| ring.nearest(gap.at))
        .min_by(|a, b| a.distance.total_cmp(&b.distance));
    let toward = nearest.and_then(|foot| (foot.point - gap.at).try_normalize(1e-6));
    bar(gap, toward.unwrap_or_else(|| perp(Vector::x())))
}

/// A bar as wide as the gap, `along` a direction.
fn bar(gap: &Unreached, along: Vector) -> Piece {
    let half = along * (gap.width / 2.0);
    let (from, to): (Point, Point) = (gap.at - half, gap.at + half);
    Piece::Line { from, to }
}
