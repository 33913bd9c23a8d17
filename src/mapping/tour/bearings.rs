//! Taking bearings: when the pose has become uncertain, the robot goes to a corner of the room and
//! turns there. Its switches then see two walls, and these say where it stands; one wall alone
//! leaves the way along it open. Then it goes along the longer of them for a metre and turns again:
//! two looks at one wall, far apart, say how it heads, which one look says badly. Where no corner is
//! near, a straight wall has to do.

use super::drive::Purpose;
use super::{Drive, ROOM, Scene, Tour};
use crate::geometry::{Piece, Point, Ring, angle, perp};
use crate::mapping::event::EventKind;
use crate::mapping::floor::Floor;
use crate::mapping::follow::Ask;
use crate::robot::{Guard, Motion};

/// A position less sure than this (one standard deviation, metres) is worth a stop.
const LOOSE: f64 = 0.025;
/// ... and in the middle of a line, one less sure than this: rounds of what stands on it may have taken
/// long.
const LOOSE_ON_LINE: f64 = 0.05;
/// The body stays this far from either wall, metres: within the range of every switch.
const GAP: f64 = 0.04;
/// Shorter walls are not trusted with it, metres.
const LEAST_WALL: f64 = 0.3;
/// How far the way to a corner may be, metres, and how much is driven at least between two stops.
const FARTHEST: f64 = 8.0;
const BETWEEN: f64 = 6.0;
/// A pose that is less sure is worth a longer way: metres for a metre of standard deviation.
const WORTH: f64 = 120.0;
/// How far apart the two looks at one wall are, metres, and how much of the wall is left beyond.
const APART: f64 = 1.2;
const BEYOND: f64 = 0.35;
/// Looks nearer to each other than this are not worth it, metres.
const LEAST_APART: f64 = 0.4;
/// How many of the nearest corners are tried.
const TRIED: usize = 3;

/// A place in a corner, or beside a wall, and one along the longer of its walls.
#[derive(Debug, Clone, Copy)]
struct Spot {
    at: Point,
    along: Option<Point>,
}

/// Where two straight walls of `outline` (counter-clockwise) meet so that the robot, at a gap from
/// both, sees both.
fn corners(outline: &Ring, floor: &Floor, radius: f64) -> Vec<Spot> {
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
            let room = radius + GAP - 0.01;
            if !floor.is_drivable(at) || floor.clearance(at) < room {
                return None;
            }
            let (way, length) = if after.length() > before.length() {
                (second, after.length())
            } else {
                (-first, before.length())
            };
            let apart = APART.min(length - radius - GAP - BEYOND);
            let along = at + way * apart;
            let clear = apart > LEAST_APART && floor.is_clear(at, along, room);
            Some(Spot { at, along: clear.then_some(along) })
        })
        .collect()
}

/// Where the robot, at a gap from a straight wall of `outline`, can go along it for long enough that
/// two looks at it say how it heads: beside each, as near to `near` as may be.
fn beside_walls(outline: &Ring, floor: &Floor, radius: f64, near: Point) -> Vec<Spot> {
    let room = radius + GAP - 0.01;
    let straight = outline.pieces.iter().filter(|piece| matches!(piece, Piece::Line { .. }));
    straight
        .filter_map(|wall| {
            let (along, length) = (wall.tangent(0.5), wall.length());
            let last = length - radius - BEYOND - APART;
            let first = radius + BEYOND;
            if last < first {
                return None;
            }
            let share = (near - wall.from()).dot(&along).clamp(first, last);
            let at = wall.from() + along * share + perp(along) * (radius + GAP);
            let end = at + along * APART;
            let clear = floor.is_drivable(at) && floor.is_clear(at, end, room);
            clear.then_some(Spot { at, along: Some(end) })
        })
        .collect()
}

impl Tour {
    /// A drive to a corner near the robot, when the pose has become too uncertain to go on.
    pub(super) fn bearings(&mut self, scene: &mut Scene<'_>) -> Option<Drive> {
        if let Some(along) = self.look_next.take() {
            return Some(Drive { purpose: Purpose::Bearings, ..Drive::new(0, along, along) });
        }
        let at = scene.rest.pose.position;
        let driven = scene.tracker.travelled() - self.bearings_at;
        if driven < BETWEEN {
            return None;
        }
        let sd = self.chart.looseness(scene.survey, scene.tracker.pose().position);
        if sd < if self.suspended.is_some() { LOOSE_ON_LINE } else { LOOSE } {
            return None;
        }
        let radius = self.chassis.radius;
        let outline = self.chart.outline().clone();
        let floor = self.floor(at);
        let mut spots = corners(&outline, floor, radius);
        spots.sort_by(|a, b| (a.at - at).norm().total_cmp(&(b.at - at).norm()));
        let mut walls = beside_walls(&outline, floor, radius, at);
        walls.sort_by(|a, b| (a.at - at).norm().total_cmp(&(b.at - at).norm()));
        let nearest = |spots: Vec<Spot>, farthest: f64| {
            spots
                .into_iter()
                .take(TRIED)
                .filter_map(|spot| Some((floor.route_length(at, spot.at, radius + ROOM)?, spot)))
                .filter(|(length, _)| *length < farthest)
                .min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let (_, spot) =
            nearest(spots, FARTHEST).or_else(|| nearest(walls, FARTHEST.max(sd * WORTH)))?;
        scene.tell.push(EventKind::Bearings { sd });
        self.bearings_at = scene.tracker.travelled();
        self.look_next = spot.along;
        Some(Drive { purpose: Purpose::Bearings, ..Drive::new(0, spot.at, spot.at) })
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
