//! Taking bearings: when the pose has become uncertain, the robot goes to a corner of the room and
//! turns there. Its switches then see two walls, and these say where it stands and how it heads;
//! one wall alone leaves the way along it open.

use super::{Drive, ROOM, Scene, Tour};
use crate::geometry::{Piece, Point, Ring, angle, perp};
use crate::mapping::event::EventKind;
use crate::mapping::floor::Floor;
use crate::mapping::follow::Ask;
use crate::robot::{Guard, Motion};

/// A position less sure than this (one standard deviation, metres) is worth a stop.
const LOOSE: f64 = 0.025;
/// The body stays this far from either wall, metres: within the range of every switch.
const GAP: f64 = 0.04;
/// Shorter walls are not trusted with it, metres.
const LEAST_WALL: f64 = 0.3;
/// How far the way to a corner may be, metres, and how much is driven at least between two stops.
const FARTHEST: f64 = 8.0;
const BETWEEN: f64 = 6.0;
/// How many of the nearest corners are tried.
const TRIED: usize = 3;

/// Where two straight walls of `outline` (counter-clockwise) meet so that the robot, at a gap from
/// both, sees both.
fn corners(outline: &Ring, floor: &Floor, radius: f64) -> Vec<Point> {
    let count = outline.pieces.len();
    (0..count)
        .filter_map(|k| {
            let (before, after) = (outline.pieces[k], outline.pieces[(k + 1) % count]);
            let straight = |p: &Piece| matches!(p, Piece::Line { .. }) && p.length() > LEAST_WALL;
            let (first, second) = (before.tangent(1.0), after.tangent(0.0));
            let turn = angle::wrap(angle::of(second) - angle::of(first)).to_degrees();
            if !straight(&before) || !straight(&after) || !(50.0..120.0).contains(&turn) {
                return None;
            }
            let (n, m) = (perp(first), perp(second));
            let at = after.from() + (n + m) * ((radius + GAP) / (1.0 + n.dot(&m)));
            let free = floor.is_drivable(at) && floor.clearance(at) > radius + GAP - 0.01;
            free.then_some(at)
        })
        .collect()
}

impl Tour {
    /// A drive to a corner near the robot, when the pose has become too uncertain to go on.
    pub(super) fn bearings(&mut self, scene: &mut Scene<'_>) -> Option<Drive> {
        let at = scene.rest.pose.position;
        let driven = scene.tracker.travelled() - self.bearings_at;
        if driven < BETWEEN {
            return None;
        }
        let sd = scene.survey.looseness(scene.tracker.pose().position);
        if sd < LOOSE {
            return None;
        }
        let radius = self.chassis.radius;
        let outline = self.chart.outline().clone();
        let floor = self.floor(at);
        let mut spots = corners(&outline, floor, radius);
        spots.sort_by(|a, b| (a - at).norm().total_cmp(&(b - at).norm()));
        let (_, spot) = spots
            .into_iter()
            .take(TRIED)
            .filter_map(|spot| Some((floor.route_length(at, spot, radius + ROOM)?, spot)))
            .filter(|(length, _)| *length < FARTHEST)
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        scene.tell.push(EventKind::Bearings { sd });
        self.bearings_at = scene.tracker.travelled();
        Some(Drive { bearings: true, ..Drive::new(0, spot, spot) })
    }

    /// At the corner: a turn that leads every wall past at least two switches.
    pub(super) fn look_round(&self) -> Ask {
        let between = angle::TAU / self.chassis.sensors.len().max(1) as f64;
        Ask {
            motion: Motion::Turn { angle: 2.0 * between + 0.4, rate: f64::INFINITY },
            guard: Guard::default(),
            why: "taking bearings of two walls",
        }
    }
}
