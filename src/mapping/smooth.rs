//! What the walls say of the lap: a wall that the fit found straight, or round, is so.
//!
//! Closing the lap takes out what was off between its two ends and spreads it by expectation. What
//! happened between is told by the walls themselves: while the robot follows a straight wall, every
//! turn of its heading that was not real bends the wall on paper. Each piece of the fitted outline
//! is therefore put into the survey as an unknown surface, free to lie anywhere, and the contacts on
//! it must lie on it. This ties headings along a wall to each other, so that the direction of the
//! first wall is known from its first metre, where the gyro had no time to wander, and not from its
//! mean (adjustment of a traverse by least squares over the fitted walls).

use super::map::{Contact, ContactKind};
use super::survey::{Look, Survey};
use crate::geometry::{Piece, Point, Ring, Vector, angle, perp};

/// Shorter pieces say nothing of headings, metres.
const LEAST_LENGTH: f64 = 0.4;
/// An arc of less sweep than this has a radius that is hardly known, radians.
const LEAST_SWEEP: f64 = 0.6;
/// Contacts farther than this from their piece are of something else, metres.
const FARTHEST: f64 = 0.03;
/// A piece about which its contacts scatter by more than this is no smooth surface, metres.
const ROUGHEST: f64 = 0.008;
/// A contact about its surface, metres: jitter of the switch.
const CONTACT_SD: f64 = 0.002;
/// What neighbouring contacts err by together, metres: real walls, and knots apart.
const SHARED_SD: f64 = 0.001;

/// Tells `survey` that the contacts on every smooth piece of `outline` lie on one surface. Only its
/// first `knots` knots are those of the lap. True when there was such a piece.
pub fn smooth(survey: &mut Survey, knots: usize, outline: &Ring, contacts: &[Contact]) -> bool {
    let mut of_piece: Vec<Vec<&Contact>> = vec![Vec::new(); outline.pieces.len()];
    for contact in contacts.iter().filter(|c| c.kind == ContactKind::Range) {
        if let Some(foot) = outline.nearest(contact.point)
            && foot.distance < FARTHEST
        {
            of_piece[foot.piece].push(contact);
        }
    }
    let mut any = false;
    for (piece, contacts) in outline.pieces.iter().zip(of_piece) {
        let round = match piece {
            Piece::Line { .. } => true,
            Piece::Arc { sweep, .. } => sweep.abs() > LEAST_SWEEP,
        };
        if !round || piece.length() < LEAST_LENGTH || contacts.len() < 6 {
            continue;
        }
        let count = contacts.len() as f64;
        let scatter = contacts.iter().map(|c| off(piece, c.point).0.powi(2)).sum::<f64>() / count;
        if scatter.sqrt() > ROUGHEST {
            continue;
        }
        let sd = scatter.sqrt().max(CONTACT_SD);
        survey.lay(&looks(survey, knots, piece, &contacts, sd));
        any = true;
    }
    any
}

/// How far `p` lies off the line or circle of `piece`, metres; its normal there; and by how much the
/// surface moves off with each of its three unknowns.
fn off(piece: &Piece, p: Point) -> (f64, Vector, [f64; 3]) {
    match *piece {
        Piece::Line { from, to } => {
            let half = (to - from) / 2.0;
            let along = piece.tangent(0.5);
            let normal = perp(along);
            let at = p - (from + half);
            (normal.dot(&at), normal, [1.0, along.dot(&at) / half.norm(), 0.0])
        }
        Piece::Arc { center, radius, .. } => {
            let arm = p - center;
            let normal = arm.try_normalize(1e-9).unwrap_or_else(|| angle::unit(0.0));
            (arm.norm() - radius, normal, [normal.x, normal.y, 1.0])
        }
    }
}

/// One look for all contacts between the same two knots: they err together.
fn looks(
    survey: &Survey,
    knots: usize,
    piece: &Piece,
    contacts: &[&Contact],
    sd: f64,
) -> Vec<Look> {
    let mut looks: Vec<(Look, f64)> = Vec::new();
    for contact in contacts {
        let tie = survey.tie(contact.time_us(), knots);
        let (off, normal, surface) = off(piece, contact.point);
        let look = survey.look(contact.point, normal, &tie, off, surface);
        match looks.last_mut() {
            Some((last, count)) if last.is_of(&look) => {
                last.add(&look);
                *count += 1.0;
            }
            _ => looks.push((look, 1.0)),
        }
    }
    let mean =
        |(look, count): (Look, f64)| look.mean_of(count, sd * sd / count + SHARED_SD * SHARED_SD);
    looks.into_iter().map(mean).collect()
}
