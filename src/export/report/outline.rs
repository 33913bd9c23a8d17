//! What the report says of the boundary: its size, what the lap was off, how well it is known, and what
//! squaring and a tape made of it. Shape and plan are not its business.

use crate::export::{RunRecord, boundary, rounded};
use crate::geometry::Piece;
use crate::mapping::accuracy::Accuracy;
use crate::mapping::map::Misclosure;
use crate::wording::median;
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct Boundary {
    perimeter_m: f64,
    area_m2: f64,
    /// Laps that closed in the search for the boundary, those round objects included.
    laps: u32,
    /// How many laps the boundary is the mean of.
    averaged_laps: u32,
    misclosure: Option<MisclosureFigures>,
    /// Another end that the lap fits as well; there only where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    closes_as_well: Option<AlikeFigures>,
    /// Null until there is an outline.
    standard_error: Option<ErrorFigures>,
    #[serde(skip_serializing_if = "Option::is_none")]
    squared: Option<SquaredFigures>,
    #[serde(skip_serializing_if = "Option::is_none")]
    taped: Option<TapedFigures>,
    /// Why a taped length was not used, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    not_taped: Option<String>,
}

/// What squaring changed; what was mapped is in `map.geojson`.
#[derive(Serialize)]
struct SquaredFigures {
    walls: usize,
    left: usize,
    turned_deg: f64,
    moved_m: f64,
}

/// Standard errors in the map frame, metres.
#[derive(Serialize)]
struct ErrorFigures {
    walls: Spread,
    /// None of a circle.
    corners: Option<Spread>,
    /// What all of the map has in common of them, and what is left within it.
    #[serde(skip_serializing_if = "Option::is_none")]
    whole_map: Option<DatumFigures>,
}

/// How the map lies in the frame of the start, and how well its walls lie to each other; the scale, which no
/// room tells, is not in it.
#[derive(Serialize)]
struct DatumFigures {
    turn_deg: f64,
    shift_m: f64,
    within_median_m: f64,
}

#[derive(Serialize)]
struct Spread {
    median_m: f64,
    worst_m: f64,
}

/// What a taped length made of the map.
#[derive(Serialize)]
struct TapedFigures {
    mapped_m: f64,
    taped_m: f64,
    /// Real over believed travel of the wheels.
    stretch: f64,
}

#[derive(Serialize)]
struct MisclosureFigures {
    dx_m: f64,
    dy_m: f64,
    heading_deg: f64,
    /// N of 1:N; null when nothing was off.
    ratio: Option<f64>,
}

/// By how much the lap is longer at its other end, by odometer, and what the gyro drifts then.
#[derive(Serialize)]
struct AlikeFigures {
    longer_m: f64,
    drift_deg_h: f64,
}

impl Boundary {
    pub(super) fn of(record: &RunRecord<'_>) -> Option<Self> {
        let ring = boundary(record)?;
        Some(Self {
            perimeter_m: rounded(ring.perimeter(), 4),
            area_m2: rounded(ring.area().abs(), 4),
            laps: record.laps,
            averaged_laps: record.map.laps,
            misclosure: record.map.misclosure.as_ref().map(misclosure),
            closes_as_well: record.map.alike.map(|alike| AlikeFigures {
                longer_m: rounded(alike.longer, 4),
                drift_deg_h: rounded(alike.drift.to_degrees() * 3600.0, 2),
            }),
            standard_error: record.map.accuracy.as_ref().and_then(errors),
            squared: squared(record),
            taped: record.map.taped.map(|taped| TapedFigures {
                mapped_m: rounded(taped.mapped, 4),
                taped_m: taped.taped,
                stretch: rounded(taped.stretch, 6),
            }),
            not_taped: record.map.untaped.map(|why| why.to_string()),
        })
    }
}

/// What squaring changed, where it was asked for: nothing, where no walls are nearly at right angles.
fn squared(record: &RunRecord<'_>) -> Option<SquaredFigures> {
    let shape = record.map.shape.as_ref()?;
    if let Some(squared) = &record.map.squared {
        return Some(SquaredFigures {
            walls: squared.walls,
            left: squared.left,
            turned_deg: rounded(squared.turned.to_degrees(), 3),
            moved_m: rounded(squared.moved, 4),
        });
    }
    let straight = shape.outline.pieces.iter().filter(|piece| matches!(piece, Piece::Line { .. }));
    let none = SquaredFigures { walls: 0, left: straight.count(), turned_deg: 0.0, moved_m: 0.0 };
    record.settings.square.then_some(none)
}

fn errors(accuracy: &Accuracy) -> Option<ErrorFigures> {
    let of = |all: &[f64]| {
        let (median, worst) = (median(all)?, all.iter().copied().fold(0.0, f64::max));
        Some(Spread { median_m: rounded(median, 4), worst_m: rounded(worst, 4) })
    };
    let whole_map = accuracy.datum.map(|datum| DatumFigures {
        turn_deg: rounded(datum.turn.to_degrees(), 3),
        shift_m: rounded(datum.shift, 4),
        within_median_m: rounded(datum.within, 4),
    });
    Some(ErrorFigures { walls: of(&accuracy.walls)?, corners: of(&accuracy.corners), whole_map })
}

fn misclosure(off: &Misclosure) -> MisclosureFigures {
    let ratio = off.ratio();
    MisclosureFigures {
        dx_m: rounded(off.dx, 5),
        dy_m: rounded(off.dy, 5),
        heading_deg: rounded(off.heading.to_degrees(), 4),
        ratio: ratio.is_finite().then(|| rounded(ratio, 0)),
    }
}
