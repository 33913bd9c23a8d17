//! What a run hands over: the map as GeoJSON, as a compact native file, as a picture, and a
//! report. Every export is a pure function of a [`RunRecord`]; nothing here opens a file, knows
//! the time or asks the robot. True poses from a simulator pass through [`geojson`] and are
//! written nowhere else.

pub mod body;
pub mod geojson;
pub mod native;
pub mod picture;
pub mod png;
mod positions;
pub mod reach;
pub mod report;
pub mod ros;
pub mod strokes;
pub mod svg;
pub mod truth;

use self::positions::{closed_positions, is_simple, position, rounded};
use crate::geometry::{Point, Pose, Ring};
use crate::mapping::map::{ContactKind, Phase, RoomMap};
use crate::mapping::settings::Settings;
use crate::mapping::shape::AlongWall;
use crate::session::snapshot::PhaseProgress;
use serde::Serialize;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// The goal was reached.
    Complete,
    /// The operator or a signal ended it.
    Stopped,
    /// It ended short of its goal.
    Failed,
}

/// Everything that the exports may tell of a run, borrowed from whoever ran it.
#[derive(Debug, Clone)]
pub struct RunRecord<'a> {
    /// The map.
    pub map: &'a RoomMap,
    /// What the run was started with.
    pub settings: &'a Settings,
    /// How it ended.
    pub outcome: Outcome,
    /// Why, in words.
    pub reason: &'a str,
    /// What the map is called: what the operator said, or the name of the world or of the port.
    pub world: &'a str,
    /// Name of the noise profile; empty for a real robot.
    pub noise: &'a str,
    /// The four phases in order.
    pub progress: [PhaseProgress; 4],
    /// Laps that closed, those round objects met in the search included.
    pub laps: u32,
    /// Motions that the bumper or a stall ended, as the screen counts them.
    pub bumps: u32,
    /// Travel with the body against something, metres.
    pub contact: f64,
    /// With a simulator: where the body really was at the instants of `map.path`, vertex by
    /// vertex, in the world's frame.
    pub true_path: Option<&'a [Pose]>,
    /// How long the run took on the wall clock, seconds; in the console from its opening, pauses included.
    pub wall_seconds: f64,
}

/// The phases in the order of [`RunRecord::progress`].
pub const PHASES: [Phase; 4] = [Phase::Boundary, Phase::Shape, Phase::Plan, Phase::Objects];

/// Chords of exported arcs stay within this of the arc, metres: a tenth of a millimetre, to which the
/// coordinates are rounded anyway. Chords lie within a circle, so a coarser one makes every column smaller
/// than it was measured: with 0.9 mm the leg of a chair, 40 mm thick, lost 1.1 mm of that.
const SAGITTA: f64 = 0.0001;

/// The boundary as it is known: the fitted outline, or before it is fitted the closed lap's contacts,
/// put in order along the wall and joined by straight pieces; none while the lap is open.
#[must_use]
pub fn boundary(record: &RunRecord<'_>) -> Option<Ring> {
    let map = record.map;
    if !map.closed {
        return None;
    }
    match &map.shape {
        Some(shape) => Some(shape.outline.clone()),
        None => AlongWall::of(&map.contacts, record.settings.chassis.reach()).joined().ok(),
    }
}

/// The boundary's contacts that lie on a surface, in order along the lap.
fn surface_points(map: &RoomMap) -> Vec<Point> {
    map.contacts
        .iter()
        .filter(|contact| contact.kind != ContactKind::Edge)
        .map(|contact| contact.point)
        .collect()
}

#[cfg(test)]
pub(crate) mod sample;
