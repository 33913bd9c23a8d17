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
use crate::geometry::{Piece, Point, Ring, Vector, angle, cross, perp};

/// Shorter pieces say nothing of headings, metres.
const LEAST_LENGTH: f64 = 0.4;
/// An arc of less sweep than this has a radius that is hardly known, radians.
const LEAST_SWEEP: f64 = 0.6;
/// Contacts farther than this from their piece are of something else, metres.
const FARTHEST: f64 = 0.03;
/// A piece about which its contacts scatter by more than this is no smooth surface, metres.
const ROUGHEST: f64 = 0.012;
/// A contact about its surface, metres: jitter of the switch.
const CONTACT_SD: f64 = 0.002;
/// What neighbouring contacts err by together, metres: real walls, and knots apart.
const SHARED_SD: f64 = 0.001;

/// Tells `survey` that the contacts on every smooth piece of `outline` lie on one surface. Only its
/// first `knots` knots are those of the lap. True when there was such a piece; that it is smooth is told
/// once.
pub fn smooth(survey: &mut Survey, knots: usize, outline: &Ring, contacts: &[Contact]) -> bool {
    if survey.is_smoothed() {
        return false;
    }
    // On which side of the outline, gone along as it is listed, the robot was.
    let within = contacts.iter().filter(|contact| outline.contains(contact.from)).count();
    let floor = outline.area() * if 2 * within > contacts.len() { 1.0 } else { -1.0 };
    let mut of_piece: Vec<Vec<&Contact>> = vec![Vec::new(); outline.pieces.len()];
    for contact in contacts.iter().filter(|c| c.kind == ContactKind::Range) {
        // The other face of a thin wall may be the nearer one.
        let towards = contact.from - contact.point;
        let faces = |piece: &Piece, t: f64| floor * cross(piece.tangent(t), towards) > 0.0;
        if let Some(foot) = outline.nearest_where(contact.point, faces)
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
    if any {
        survey.smoothed();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::mapping::map::Spun;
    use crate::mapping::survey::Step;

    /// A robot follows a straight wall of 6 m along +x at 0.145 m, but its gyro wanders: for the first
    /// two metres not at all, then by 3 mrad a metre. Contacts and trajectory as believed.
    fn bent() -> (Survey, Vec<Contact>) {
        let mut survey = Survey::new(0.0005 / 0.16);
        let (mut pose, mut contacts, mut spun) =
            (Pose::new(0.0, 0.0, 0.0), Vec::new(), Spun::default());
        for k in 0..=240_u32 {
            let time_us = u64::from(k) * 200_000;
            if k % 10 == 0 {
                survey.mark(pose.position, time_us);
            }
            contacts.push(Contact {
                point: pose.position + perp(angle::unit(pose.heading)) * 0.145,
                from: pose.position,
                sensor: Some(2),
                kind: ContactKind::Range,
                time: time_us as f64 * 1e-6,
            });
            let bend = if k < 80 { 0.0 } else { 0.003 * 0.025 };
            // A swing towards the wall and back, as the follower does: no leg for the wheels.
            let (wound, squares) = (spun.wound + 0.9, spun.squares + 0.27);
            let next = Spun { gyro: spun.gyro + bend, wound, squares, ..spun };
            let to = Pose {
                position: pose.position + angle::unit(pose.heading) * 0.025,
                heading: pose.heading + bend,
            };
            let step = Step { from: pose, to, seconds: 0.2, spun: (spun, next) };
            survey.predict(&step);
            (pose, spun) = (to, next);
        }
        (survey, contacts)
    }

    #[test]
    fn a_wall_that_the_gyro_bent_is_straight_again_and_lies_as_its_beginning_did() {
        let (mut survey, contacts) = bent();
        let (first, last) = (contacts[0].point, contacts[240].point);
        let fitted = Piece::Line { from: first, to: last };
        let outline = Ring::polygon(&[first, last, Point::new(3.0, -4.0)]);
        let worst = contacts.iter().map(|c| fitted.distance(c.point)).fold(0.0, f64::max);
        assert!(worst > 0.005, "{worst}");
        let knots = survey.knots();
        // It is bent by more than the jitter, yet by less than would make it something else.
        assert!(smooth(&mut survey, knots, &outline, &contacts));
        let placed: Vec<Point> = contacts
            .iter()
            .map(|c| c.point + survey.displacement(c.point, &survey.tie(c.time_us(), knots)))
            .collect();
        let rise = (placed[240].y - placed[0].y) / (placed[240].x - placed[0].x);
        let before = (last.y - first.y) / (last.x - first.x);
        assert!(rise.abs() < 0.5 * before.abs(), "{rise} of {before}");
        let line = Piece::Line { from: placed[0], to: placed[240] };
        let left = placed.iter().map(|p| line.distance(*p)).fold(0.0, f64::max);
        assert!(left < 0.5 * worst, "{left} of {worst}");
    }

    #[test]
    fn a_ragged_wall_says_nothing() {
        let (mut survey, mut contacts) = bent();
        for (k, contact) in contacts.iter_mut().enumerate() {
            contact.point.y = if k % 3 == 0 { 0.172 } else { 0.132 };
        }
        let outline =
            Ring::polygon(&[Point::new(0.0, 0.145), Point::new(6.0, 0.145), Point::new(3.0, -4.0)]);
        let (before, knots) = (survey.clone(), survey.knots());
        assert!(!smooth(&mut survey, knots, &outline, &contacts));
        assert_eq!(survey, before);
    }
}
