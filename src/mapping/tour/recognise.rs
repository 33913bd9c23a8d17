//! Far from walls the pose becomes uncertain, and what is met seems to be something new although it
//! is on the map, only elsewhere. While the robot goes round it, its contacts are laid on each mapped
//! surface that it could be; where they fit, corners and all that was seen, the pose is known again.
//! It decides only whether that is so; what follows from it is for the round.

use super::rounds::Round;
use super::{Scene, Tour};
use crate::geometry::{Point, Ring, angle, perp};
use crate::mapping::event::EventKind;
use crate::mapping::lay::{Overlap, Seen, lay};
use crate::mapping::map::ContactKind;
use crate::mapping::survey::Tie;
use crate::mapping::wall::Sighting;
use nalgebra::{Matrix3, Vector3};

/// A pose known better than this beside the map (one standard deviation, metres) is believed.
const SURE: f64 = 0.03;
/// Contacts are compared again after each of these, metres driven.
const AGAIN: f64 = 0.5;
/// So many contacts over so many metres say what it is, ...
const LEAST_CONTACTS: usize = 12;
const LEAST_EXTENT: f64 = 1.2;
/// ... no more than so many of them are looked at, ...
const MOST_CONTACTS: usize = 80;
/// ... and this share of them has to fit.
const FITTING: f64 = 0.85;
/// Surfaces farther off than this many standard deviations, or metres, are something else.
const DEVIATIONS: f64 = 3.5;
const FARTHEST: f64 = 1.0;
/// Pitch at which an outline is laid out as points, metres.
const PITCH: f64 = 0.03;

impl Tour {
    /// Whether what `round` goes round is on the map already, with the pose corrected if so.
    pub(super) fn recognise(&mut self, round: &mut Round, scene: &mut Scene<'_>) -> bool {
        let Some((begun, at)) = round.begun else { return false };
        let travelled = scene.tracker.travelled();
        if travelled < round.compared + AGAIN {
            return false;
        }
        round.compared = travelled;
        let loose = self.chart.looseness(scene.survey, at);
        if loose < SURE {
            return false;
        }
        let log = round.circuit.wall.log();
        let seen = log.iter().filter(|s| s.alive && s.kind == ContactKind::Range);
        let late: Vec<Seen> = seen.map(Sighting::seen).take(MOST_CONTACTS).collect();
        if late.len() < LEAST_CONTACTS || extent(&late) < LEAST_EXTENT {
            return false;
        }
        let within = (DEVIATIONS * loose).min(FARTHEST);
        let Some(first) = late.first().map(|seen| seen.at) else { return false };
        let mut best: Option<(usize, Tie, Overlap)> = None;
        for (index, (ring, tie)) in self.chart.nominal(scene.survey, first).enumerate() {
            if ring.distance(first) > within {
                continue;
            }
            let early = laid_out(ring, index == 0, &late, within);
            let floor = Matrix3::from_diagonal(&Vector3::new(1e-5, 1e-5, 1e-6));
            let spread = scene.survey.relative(&tie, &begun) + floor;
            let Some(prior) = spread.try_inverse() else { continue };
            let expected = scene.survey.misclosure(&tie, &begun);
            let laid = lay(&early, &late, at, (prior, prior * expected), &[expected]);
            let off = Vector3::new(laid.misclosure.dx, laid.misclosure.dy, laid.misclosure.heading)
                - expected;
            let unlikely = off.dot(&(prior * off)) > DEVIATIONS * DEVIATIONS;
            let known = laid.known * 10 >= late.len() * 8;
            if unlikely || !known || laid.agreement < FITTING {
                continue;
            }
            if laid.agreement > best.as_ref().map_or(0.0, |(_, _, other)| other.agreement) {
                best = Some((index, tie, laid));
            }
        }
        let Some((index, tie, laid)) = best else { return false };
        laid.close(scene.survey, &tie, &begun, at);
        scene.tracker.correct(scene.survey.take_pose(scene.tracker.pose()));
        let off = angle::hypot(laid.misclosure.dx, laid.misclosure.dy);
        let object =
            index.checked_sub(1).and_then(|k| scene.map.objects.get(k)).map(|known| known.id);
        scene.tell.push(EventKind::Recognised { object, off });
        true
    }
}

fn extent(seen: &[Seen]) -> f64 {
    let from = seen.first().map_or_else(Point::origin, |first| first.at);
    seen.iter().map(|seen| (seen.at - from).norm()).fold(0.0, f64::max)
}

/// The parts of `ring` within reach of `late`, as points; the floor lies inside the boundary, and
/// outside everything else.
fn laid_out(ring: &Ring, is_boundary: bool, late: &[Seen], within: f64) -> Vec<Seen> {
    let side = if is_boundary { 1.0 } else { -1.0 };
    let reach = within + 0.3;
    ring.pieces
        .iter()
        .flat_map(|piece| {
            let count = (piece.length() / PITCH).ceil().max(1.0) as u32;
            (0..count).map(move |k| {
                let t = (f64::from(k) + 0.5) / f64::from(count);
                Seen { at: piece.at(t), towards: perp(piece.tangent(t)) * side }
            })
        })
        .filter(|p| late.iter().any(|q| (p.at - q.at).norm() < reach))
        .collect()
}
