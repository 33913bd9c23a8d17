//! How well each wall, corner and object is known: its standard error in the map frame, whose origin
//! and direction are those of the start.
//!
//! Three things make it up: what the survey believes of the places from which it was seen (gyro and
//! wheels, after all adjustment; see `survey`), how well its contacts agree on it, and the common
//! scale of the wheels, which no closure sees and only a tape can tell. Errors are propagated to first
//! order, as in any adjustment computation (Ghilani, ch. 6).

use super::map::{Contact, RoomMap};
use super::network::Datum;
use super::survey::{Hung, Survey, Tie};
use crate::geometry::{Piece, Point, cross, perp};
use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

/// What was off in 80 runs in 8 rooms was this much more than the survey believed (standard
/// deviation): it knows of no slips. As the variance of unit weight in an adjustment.
const UNIT_WEIGHT: f64 = 1.12;
/// Wheels whose size nobody has checked with a tape are off by this share together.
const UNTAPED: f64 = 1.5e-3;
/// What all contacts of one wall may be off by together, metres: range of the switch that saw it.
const RANGE: f64 = 0.0015;
/// A contact scatters at least this much about its wall, metres.
const LEAST_SCATTER: f64 = 0.0015;
/// Contacts this near to a wall are of it, metres.
const OF_IT: f64 = 0.03;
/// A wall that nothing was seen of but that it must be there is known to this, metres.
const UNSEEN: f64 = 0.03;
/// A straight wall and a round one that meet at less than this (sine of the angle) touch each other, and the end
/// of the arc says where.
const TOUCHING: f64 = 0.1;
/// Two straight walls that meet at less than this (a degree) would have been taken for one.
const LEAST_ANGLE: f64 = 0.0175;

/// Standard errors of the map, metres.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Accuracy {
    /// Of each piece of the outline, across it at its middle.
    pub walls: Vec<f64>,
    /// Of the corner at which each piece begins: root of the sum of the variances in x and y. None of a circle.
    pub corners: Vec<f64>,
    /// Of each object's place, likewise.
    pub objects: Vec<f64>,
    /// What of them all of the map has in common, and what is left within it; none before the whole survey
    /// is adjusted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub datum: Option<Datum>,
}

impl Accuracy {
    /// The largest standard error of a corner, with the corner's place in the outline.
    #[must_use]
    pub fn worst_corner(&self) -> Option<(usize, f64)> {
        self.corners.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// What is needed to say how well a place is known.
pub(super) struct Judge<'a> {
    pub(super) survey: &'a Survey,
    /// What the outline hangs on.
    pub(super) lap: &'a Hung,
    /// Where the map begins: it is known exactly there.
    pub(super) start: Point,
    /// One for each object of the map.
    pub(super) objects: &'a [Tie],
}

impl Judge<'_> {
    /// The standard errors of `map`, whose contacts are where the survey believes them.
    pub(super) fn judge(&self, map: &RoomMap) -> Option<Accuracy> {
        let outline = &map.shape.as_ref()?.outline;
        let scale = map.taped.map_or(UNTAPED, |taped| taped.doubt());
        let at = |p: Point, tie: &Tie| {
            let arm = (p - self.start) * scale;
            self.survey.spread_at(p, tie) * (UNIT_WEIGHT * UNIT_WEIGHT) + arm * arm.transpose()
        };
        let of_lap = |p: Point| at(p, &self.lap.beside(self.survey, &map.contacts, p));
        let fits: Vec<Fit> = outline.pieces.iter().map(|piece| fit(piece, &map.contacts)).collect();
        let walls = outline.pieces.iter().zip(&fits).map(|(piece, fit)| {
            let across = perp(piece.tangent(0.5));
            (across.dot(&(of_lap(piece.at(0.5)) * across)) + fit.middle).max(0.0).sqrt()
        });
        // A whole circle begins at no corner.
        let count = if outline.is_circle() { 0 } else { outline.pieces.len() };
        let corners = (0..count).map(|k| {
            let before = (k + count - 1) % count;
            let (a, b) = (&outline.pieces[before], &outline.pieces[k]);
            let met = meeting(a, b, fits[before].end, fits[k].end);
            (of_lap(b.from()) + met).trace().max(0.0).sqrt()
        });
        let objects = map.objects.iter().zip(self.objects).map(|(object, tie)| {
            let middle = object.outline.middle();
            let seen = object.contacts.len().max(1) as f64;
            let fit = RANGE.powi(2) + LEAST_SCATTER.powi(2) / seen;
            (at(middle, tie).trace() + 2.0 * fit).max(0.0).sqrt()
        });
        Some(Accuracy {
            walls: walls.collect(),
            corners: corners.collect(),
            objects: objects.collect(),
            datum: None,
        })
    }
}

/// Variances of a wall across itself from its contacts alone, square metres.
struct Fit {
    middle: f64,
    /// Where its direction counts as well: four times as much for contacts evenly spread.
    end: f64,
}

fn fit(piece: &Piece, contacts: &[Contact]) -> Fit {
    let off = contacts.iter().map(|contact| piece.distance(contact.point)).filter(|d| *d < OF_IT);
    let (squares, count) = off.fold((0.0, 0.0), |(sum, count), d| (sum + d * d, count + 1.0));
    if count < 1.0 {
        return Fit { middle: UNSEEN * UNSEEN, end: UNSEEN * UNSEEN };
    }
    let of_mean = (squares / count).max(LEAST_SCATTER * LEAST_SCATTER) / count;
    Fit { middle: of_mean + RANGE * RANGE, end: 4.0 * of_mean + RANGE * RANGE }
}

/// Covariance of the point where two walls meet, each off by its own variance across itself.
fn meeting(a: &Piece, b: &Piece, var_a: f64, var_b: f64) -> Matrix2<f64> {
    let (along_a, along_b) = (a.tangent(1.0), b.tangent(0.0));
    let sine = cross(along_a, along_b);
    let straight = matches!((a, b), (Piece::Line { .. }, Piece::Line { .. }));
    if !straight && sine.abs() < TOUCHING {
        return Matrix2::identity() * var_a.max(var_b);
    }
    // The flatter the corner, the less they say of where along them it is.
    let sine = sine.abs().max(LEAST_ANGLE).copysign(sine);
    // A wall that moves across itself by one moves the meeting point along the other.
    let (by_a, by_b): (Vector2<f64>, Vector2<f64>) = (along_b / sine, along_a / sine);
    by_a * by_a.transpose() * var_a + by_b * by_b.transpose() * var_b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_walls_at_right_angles_meet_as_well_as_each_is_known() {
        let wall = |x0: f64, y0: f64, x1: f64, y1: f64| Piece::Line {
            from: Point::new(x0, y0),
            to: Point::new(x1, y1),
        };
        // The first runs along x and is off in y, the second along y and off in x.
        let met = meeting(&wall(0.0, 0.0, 2.0, 0.0), &wall(2.0, 0.0, 2.0, 1.0), 4.0, 9.0);
        assert!((met[(1, 1)] - 4.0).abs() < 1e-12 && (met[(0, 0)] - 9.0).abs() < 1e-12, "{met}");
        assert!(met[(0, 1)].abs() < 1e-12, "{met}");
        // At 30 degrees what one is off by counts double along the other.
        let slope = meeting(&wall(0.0, 0.0, 2.0, 0.0), &wall(2.0, 0.0, 0.268, 1.0), 1.0, 0.0);
        assert!((slope.trace() - 4.0).abs() < 0.01, "{slope}");
        // At 2 degrees, what both are off by twenty-nine times; and no less where they go on straight.
        for (turn, times) in [(2.0_f64, 28.65), (0.0, 57.14)] {
            let end = Point::new(2.0, 0.0) + crate::geometry::angle::unit(turn.to_radians());
            let flat = meeting(&wall(0.0, 0.0, 2.0, 0.0), &wall(2.0, 0.0, end.x, end.y), 1.0, 1.0);
            let along = flat[(0, 0)].sqrt() / 2.0_f64.sqrt();
            assert!((along - times).abs() < 0.1, "{turn}: {along}");
        }
    }

    #[test]
    fn many_contacts_that_agree_make_a_wall_better_known_than_its_range_never() {
        let piece = Piece::Line { from: Point::origin(), to: Point::new(2.0, 0.0) };
        let contact = |k: u32, off: f64| Contact {
            point: Point::new(f64::from(k) * 0.1, off),
            from: Point::new(f64::from(k) * 0.1, 0.15),
            sensor: Some(0),
            kind: crate::mapping::map::ContactKind::Range,
            time: 0.0,
        };
        let seen = |count: u32, off: f64| {
            let sign = |k: u32| if k.is_multiple_of(2) { off } else { -off };
            let contacts: Vec<Contact> = (0..count).map(|k| contact(k, sign(k))).collect();
            fit(&piece, &contacts).middle.sqrt()
        };
        assert!((seen(0, 0.0) - UNSEEN).abs() < 1e-12);
        assert!((seen(16, 0.008) - (0.002_f64.powi(2) + RANGE * RANGE).sqrt()).abs() < 1e-9);
        assert!(seen(16, 0.0001) > RANGE && seen(16, 0.0001) < seen(4, 0.0001));
    }
}
