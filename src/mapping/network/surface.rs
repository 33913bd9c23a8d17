//! The surfaces of the map as unknowns, and which contact is of which.

use super::record::Glance;
use super::thin::Through;
use super::{CLOSE, Given};
use crate::geometry::{Piece, Point, Pose, Ring, Vector, angle, perp};
use crate::mapping::map::{Contact, ContactKind};
use std::collections::BTreeMap;

/// Nearer to the end of a piece than this a contact may be of the next, metres.
const CORNER: f64 = 0.015;
/// What is seen from more askance than this (cosine) is not of the surface.
const LEAST_INCIDENCE: f64 = 0.4;
/// Fewer contacts than this say nothing of a surface.
const FEWEST: usize = 3;
/// Contacts lie about their surface no closer than this, and where nobody knows no farther, metres.
const LEAST_SD: f64 = 0.0016;
const MOST_SD: f64 = 0.03;
/// What is within reach of a surface is within so many standard deviations.
const DEVIATIONS: f64 = 3.0;

/// A surface that may lie elsewhere than it is mapped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Surface {
    /// Through `at`, with its normal in the direction `normal` (radians).
    Straight {
        at: Point,
        normal: f64,
    },
    Round {
        center: Point,
        radius: f64,
    },
}

/// Unknowns of a surface: turn and way along its normal, or centre and radius.
pub(super) const UNKNOWNS: usize = 3;

impl Surface {
    fn of(piece: &Piece) -> Self {
        match *piece {
            Piece::Line { .. } => {
                Self::Straight { at: piece.at(0.5), normal: angle::of(perp(piece.tangent(0.5))) }
            }
            Piece::Arc { center, radius, .. } => Self::Round { center, radius },
        }
    }

    /// How far `p` lies off it, metres, the direction in which that grows, and by how much the surface
    /// follows with each of its unknowns.
    pub(super) fn off(&self, p: Point) -> (f64, Vector, [f64; UNKNOWNS]) {
        match *self {
            Self::Straight { at, normal } => {
                let (normal, arm) = (angle::unit(normal), p - at);
                (normal.dot(&arm), normal, [-perp(normal).dot(&arm), 1.0, 0.0])
            }
            Self::Round { center, radius } => {
                let arm = p - center;
                let normal = arm.try_normalize(1e-9).unwrap_or_else(|| angle::unit(0.0));
                (arm.norm() - radius, normal, [normal.x, normal.y, 1.0])
            }
        }
    }

    fn take(&mut self, change: &[f64]) {
        match self {
            Self::Straight { at, normal } => {
                *at += angle::unit(*normal) * change[1];
                *normal += change[0];
            }
            Self::Round { center, radius } => {
                *center += Vector::new(change[0], change[1]);
                *radius += change[2];
            }
        }
    }
}

/// All surfaces on which something was seen, and what was seen on each.
#[derive(Debug, Clone)]
pub(super) struct Surfaces {
    pub(super) all: Vec<Surface>,
    /// Standard deviation of the contacts about each of them, metres.
    pub(super) sd: Vec<f64>,
    /// Which surface each of the glances is of.
    pub(super) of: Vec<Option<usize>>,
    /// On which side of its normal the floor is (1 or -1), and the two places farthest apart that were seen of it.
    pub(super) seen: Vec<(f64, (Point, Point))>,
    /// Where two of them were found to lie through each other.
    pub(super) through: Vec<Through>,
}

impl Surfaces {
    /// The surfaces of `given.map`, and the glances on them, seen from `poses`: none is of a surface that is
    /// farther off than `given.within`.
    pub(super) fn of(given: &Given<'_>, glances: &[Glance], poses: &[Pose]) -> Self {
        let within = given.within;
        let outline = given.map.shape.as_ref().map(|shape| &shape.outline);
        let objects = given.map.objects.iter().map(|object| &object.outline);
        let rings: Vec<(&Ring, f64)> = outline
            .into_iter()
            .map(|ring| (ring, 1.0))
            .chain(objects.map(|ring| (ring, -1.0)))
            .collect();
        let mapped = mapped_contacts(given);
        let mut of_piece: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
        let bounds: Vec<Option<(Point, Point)>> =
            rings.iter().map(|(ring, _)| ring.bounds()).collect();
        for (k, (glance, pose)) in glances.iter().zip(poses).enumerate() {
            if !glance.sure {
                continue;
            }
            let seen = Seen { at: pose.position + pose.rotate(glance.arm), from: pose.position };
            let seen =
                mapped.get(&(glance.reading.time_us, glance.sensor)).copied().unwrap_or(seen);
            let found = rings
                .iter()
                .zip(&bounds)
                .enumerate()
                .filter(|(_, (_, bounds))| bounds.is_some_and(|it| seen.is_near(it, within)));
            let found = found
                .filter_map(|(k, ((ring, floor), _))| Some((k, seen.on(ring, *floor, within)?)))
                .min_by(|a, b| a.1.1.total_cmp(&b.1.1));
            if let Some((ring, (piece, _))) = found {
                of_piece.entry((ring, piece)).or_default().push(k);
            }
        }
        let mut surfaces = Self {
            all: Vec::new(),
            sd: Vec::new(),
            of: vec![None; glances.len()],
            seen: Vec::new(),
            through: Vec::new(),
        };
        for ((ring, piece), seen) in of_piece {
            if seen.len() < FEWEST {
                continue;
            }
            let (outline, floor) = rings[ring];
            let surface = Surface::of(&outline.pieces[piece]);
            let places =
                seen.iter().map(|k| poses[*k].position + poses[*k].rotate(glances[*k].arm));
            surfaces.seen.push((floor, span(&outline.pieces[piece], places)));
            let scatter = scatter(&surface, &seen, glances, &mapped);
            for k in seen {
                surfaces.of[k] = Some(surfaces.all.len());
            }
            surfaces.all.push(surface);
            // Those that are taken from afar may be off by that.
            let least = if within > CLOSE { within / DEVIATIONS } else { LEAST_SD };
            surfaces.sd.push(scatter.clamp(LEAST_SD, MOST_SD).max(least));
        }
        surfaces
    }

    pub(super) fn take(&mut self, change: &[f64]) {
        for (surface, change) in self.all.iter_mut().zip(change.chunks(UNKNOWNS)) {
            surface.take(change);
        }
    }
}

/// Something that was seen, and from where.
#[derive(Debug, Clone, Copy)]
struct Seen {
    at: Point,
    from: Point,
}

impl Seen {
    fn is_near(&self, (low, high): (Point, Point), within: f64) -> bool {
        (low.x - within..=high.x + within).contains(&self.at.x)
            && (low.y - within..=high.y + within).contains(&self.at.y)
    }

    /// On which piece of `ring` it is and how far off, if on any; the floor is to the left of it, or
    /// (-1) to the right.
    fn on(&self, ring: &Ring, floor: f64, within: f64) -> Option<(usize, f64)> {
        let towards = (self.from - self.at).try_normalize(1e-9)?;
        let faces =
            |piece: &Piece, t: f64| floor * perp(piece.tangent(t)).dot(&towards) > LEAST_INCIDENCE;
        let foot = ring.nearest_where(self.at, faces)?;
        let from_corner = foot.t.min(1.0 - foot.t) * ring.pieces[foot.piece].length();
        let round = matches!(ring.pieces[foot.piece], Piece::Arc { .. });
        let of_it = foot.distance < within && (round || from_corner > CORNER);
        of_it.then_some((foot.piece, foot.distance))
    }
}

/// The contacts that made the map, by time and switch.
fn mapped_contacts(given: &Given<'_>) -> BTreeMap<(u64, usize), Seen> {
    let objects = given.map.objects.iter().flat_map(|object| &object.contacts);
    let all = given.map.contacts.iter().chain(objects);
    let key = |contact: &Contact| Some((contact.time_us(), contact.sensor?));
    all.filter(|contact| contact.kind == ContactKind::Range)
        .filter_map(|contact| Some((key(contact)?, Seen { at: contact.point, from: contact.from })))
        .collect()
}

/// The two of `places` that lie farthest apart along `piece`.
fn span(piece: &Piece, places: impl Iterator<Item = Point>) -> (Point, Point) {
    let along = piece.tangent(0.5);
    let middle = piece.at(0.5);
    let mut span = (middle, middle);
    for place in places {
        let s = along.dot(&(place - middle));
        if s < along.dot(&(span.0 - middle)) {
            span.0 = place;
        }
        if s > along.dot(&(span.1 - middle)) {
            span.1 = place;
        }
    }
    span
}

/// How far the contacts that made a surface lie off it, root mean square, metres.
fn scatter(
    surface: &Surface,
    seen: &[usize],
    glances: &[Glance],
    mapped: &BTreeMap<(u64, usize), Seen>,
) -> f64 {
    let of = |k: &usize| mapped.get(&(glances[*k].reading.time_us, glances[*k].sensor));
    let (sum, count) = seen
        .iter()
        .filter_map(of)
        .fold((0.0, 0.0), |(sum, count), seen| (sum + surface.off(seen.at).0.powi(2), count + 1.0));
    if count > 2.0 { f64::sqrt(sum / count) } else { MOST_SD / 3.0 }
}
