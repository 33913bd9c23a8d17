//! Boxes, cupboards and free-standing walls: the rectangle on which the contacts of an object lie.
//!
//! A round of a thin wall gives two sides only millimetres farther apart than the contacts scatter
//! at its ends, so that a chain of contacts knots there; that it is a rectangle is known from the
//! whole. A contact belongs to a side that faces the robot that saw it.

use crate::geometry::hull::jarvis;
use crate::geometry::{Point, Ring, Vector, angle, perp};
use crate::mapping::map::{Contact, ContactKind};

/// A contact is explained when its side passes within this, metres.
const NEAR: f64 = 0.008;
/// Share of the contacts that must be explained.
const SHARE: f64 = 0.85;
/// No contact may lie farther off than this, metres.
const FAR: f64 = 0.02;
/// Rounds of assigning contacts to sides and fitting the sides to them.
const ROUNDS: usize = 8;
/// Fewest contacts that can prove a rectangle.
const LEAST: usize = 8;

/// A rectangle in the making: the directions of its sides and how far out each lies.
struct Sides {
    origin: Point,
    along: Vector,
    /// Offsets of the sides whose outward normals are along, across, against along, against across.
    out: [f64; 4],
}

impl Sides {
    fn normal(&self, side: usize) -> Vector {
        let across = perp(self.along);
        [self.along, across, -self.along, -across][side]
    }

    fn off(&self, side: usize, p: Point) -> f64 {
        self.normal(side).dot(&(p - self.origin)) - self.out[side]
    }

    /// The side that `contact` was seen on: the nearest of those that face the robot.
    fn side_of(&self, contact: &Contact) -> Option<usize> {
        let faces = |side: &usize| self.normal(*side).dot(&(contact.from - contact.point)) > 0.0;
        (0..4).filter(faces).min_by(|a, b| {
            let off = |side: usize| self.off(side, contact.point).abs();
            off(*a).total_cmp(&off(*b))
        })
    }

    fn ring(&self) -> Ring {
        let corner = |a: usize, b: usize| {
            self.origin + self.normal(a) * self.out[a] + self.normal(b) * self.out[b]
        };
        Ring::polygon(&[corner(0, 1), corner(1, 2), corner(2, 3), corner(3, 0)]).counter_clockwise()
    }
}

/// The rectangle on which `contacts` lie; none when they do not lie on one, or do not show it.
pub(super) fn rectangle(contacts: &[Contact]) -> Option<Ring> {
    let contacts: Vec<Contact> =
        contacts.iter().filter(|c| c.kind != ContactKind::Edge).copied().collect();
    if contacts.len() < LEAST {
        return None;
    }
    let mut sides = smallest_around(&contacts)?;
    for _ in 0..ROUNDS {
        refine(&mut sides, &contacts);
    }
    let size = [sides.out[0] + sides.out[2], sides.out[1] + sides.out[3]];
    if size.iter().any(|metres| *metres < 0.004) {
        return None;
    }
    let mut seen = [0_usize; 4];
    let mut near = 0_usize;
    for contact in &contacts {
        let side = sides.side_of(contact)?;
        let off = distance(&sides, contact.point);
        if off > FAR {
            return None;
        }
        if off < NEAR {
            near += 1;
            seen[side] += 1;
        }
    }
    let shown = seen.iter().all(|count| *count >= 1);
    (shown && near as f64 >= SHARE * contacts.len() as f64).then(|| sides.ring())
}

/// Distance from the outline, metres.
fn distance(sides: &Sides, p: Point) -> f64 {
    let off: Vec<f64> = (0..4).map(|side| sides.off(side, p)).collect();
    let (x, y) = (off[0].max(off[2]), off[1].max(off[3]));
    if x > 0.0 && y > 0.0 { angle::hypot(x, y) } else { x.max(y).abs() }
}

/// The smallest rectangle round the contacts: one of its sides lies along the convex hull.
fn smallest_around(contacts: &[Contact]) -> Option<Sides> {
    let points: Vec<Point> = contacts.iter().map(|c| c.point).collect();
    let hull = jarvis(&points);
    let mut best: Option<(f64, Sides)> = None;
    for k in 0..hull.len() {
        let (a, b) = (points[hull[k]], points[hull[(k + 1) % hull.len()]]);
        let Some(along) = (b - a).try_normalize(1e-9) else { continue };
        let mut sides = Sides { origin: a, along, out: [0.0; 4] };
        for side in 0..4 {
            let normal = sides.normal(side);
            sides.out[side] =
                points.iter().map(|p| normal.dot(&(p - a))).fold(f64::NEG_INFINITY, f64::max);
        }
        let area = (sides.out[0] + sides.out[2]) * (sides.out[1] + sides.out[3]);
        if best.as_ref().is_none_or(|(least, _)| area < *least) {
            best = Some((area, sides));
        }
    }
    best.map(|(_, sides)| sides)
}

/// Lays each side through the middle one of its contacts, and turns all of them to fit the contacts
/// of all.
fn refine(sides: &mut Sides, contacts: &[Contact]) {
    let mut of_side: [Vec<Point>; 4] = Default::default();
    for contact in contacts {
        if let Some(side) = sides.side_of(contact) {
            of_side[side].push(contact.point);
        }
    }
    let (mut lever, mut square) = (0.0, 0.0);
    for (side, points) in of_side.iter().enumerate() {
        let normal = sides.normal(side);
        let mut offs: Vec<f64> = points.iter().map(|p| normal.dot(&(p - sides.origin))).collect();
        if offs.is_empty() {
            continue;
        }
        offs.sort_by(f64::total_cmp);
        sides.out[side] = offs[offs.len() / 2];
        let tangent = perp(normal);
        let middle = points.iter().map(|p| tangent.dot(&(p - sides.origin))).sum::<f64>()
            / points.len() as f64;
        for p in points {
            let off = sides.off(side, *p);
            // Those at the ends may be of the corner: they do not pull.
            if off.abs() < FAR {
                let arm = tangent.dot(&(p - sides.origin)) - middle;
                lever += arm * off;
                square += arm * arm;
            }
        }
    }
    if square > 1e-9 {
        let turn = (lever / square).clamp(-0.05, 0.05);
        sides.along = angle::unit(angle::of(sides.along) - turn);
    }
}
