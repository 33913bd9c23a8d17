//! The mapped surfaces, held so that the survey can move them.
//!
//! Walls and objects are fitted once, from contacts in the frame of that day. Later touches correct
//! the survey, and with it every contact: the chart moves outlines and contacts along, and says
//! which surface a new contact lies on and what that surface hangs on.

use super::accuracy::Judge;
use super::map::{Contact, ContactKind, MappedObject, RoomMap};
use super::shape::KNOWN;
use super::survey::{Hung, Surface, Survey, Tie, worse};
use super::wall::Sighting;
use crate::geometry::{Piece, Point, Pose, Ring, perp};
use nalgebra::Matrix2;

/// Contacts this near to a place tell how ragged its surface is, metres.
const NEIGHBOURHOOD: f64 = 0.12;
/// A piece that fewer contacts than this lie on, to within so many metres, was drawn from one corner to the
/// next, across a gap it may be: what stands between them is anybody's guess.
const LEAST_HELD: usize = 3;
const HOLDS: f64 = 0.02;
/// Where nobody knows how ragged a surface is, it is so by this, root mean square, metres.
const UNTOLD: f64 = 0.03;
/// Nearer to the end of a piece than this its normal says nothing, metres.
const CORNER: f64 = 0.04;
/// No farther behind the nearest surface than this is the one that was seen, metres: both are faces of
/// something thin.
const THIN: f64 = 0.04;
/// With a pose that is not sure a contact may be this many standard deviations of it off, but no more
/// metres than that.
const DEVIATIONS: f64 = 2.5;
const MOST_KNOWN: f64 = 0.5;
/// What is seen from more askance than this (cosine) is not of the surface.
const LEAST_INCIDENCE: f64 = 0.5;

/// How far from `place`, which hangs on `tie`, a contact may be and still be of it, metres.
fn tolerance(survey: &Survey, place: Point, tie: &Tie) -> f64 {
    (DEVIATIONS * survey.looseness(place, tie)).clamp(KNOWN, MOST_KNOWN)
}

/// One ring as it was fitted, what it hangs on, and where it is now.
#[derive(Debug, Clone)]
struct Charted {
    nominal: Ring,
    contacts: Vec<Contact>,
    /// How many contacts lie on each piece of it.
    held: Vec<usize>,
    /// What it hangs on.
    hung: Hung,
    shown: Ring,
}

impl Charted {
    fn new(outline: &Ring, contacts: &[Contact], hung: Hung) -> Self {
        let mut held = vec![0; outline.pieces.len()];
        for foot in contacts.iter().filter_map(|contact| outline.nearest(contact.point)) {
            held[foot.piece] += usize::from(foot.distance < HOLDS);
        }
        let (nominal, shown) = (outline.clone(), outline.clone());
        Self { nominal, contacts: contacts.to_vec(), held, hung, shown }
    }

    /// What the place `nominal` hangs on.
    fn tie(&self, survey: &Survey, nominal: Point) -> Tie {
        self.hung.beside(survey, &self.contacts, nominal)
    }

    /// Root mean square distance from the ring of the contacts near `nominal`, a place on its piece
    /// `piece`, metres.
    fn raggedness(&self, nominal: Point, piece: usize) -> f64 {
        if self.held[piece] < LEAST_HELD {
            return UNTOLD;
        }
        let near = self.contacts.iter().filter(|c| (c.point - nominal).norm() < NEIGHBOURHOOD);
        let (sum, count) = near.fold((0.0, 0.0), |(sum, count), c| {
            (sum + self.nominal.distance(c.point).powi(2), count + 1.0)
        });
        if count > 0.0 { f64::sqrt(sum / count) } else { UNTOLD }
    }
}

/// The chart.
#[derive(Debug, Clone)]
pub struct Chart {
    rings: Vec<Charted>,
}

impl Chart {
    /// The chart of what `map` holds now: its boundary hangs on all knots of `survey`, its objects
    /// on the knot nearest in time.
    #[must_use]
    pub fn new(map: &RoomMap, survey: &Survey) -> Self {
        let lap_knots = survey.knots();
        let outline = map.shape.as_ref().map(|shape| shape.outline.clone()).unwrap_or_default();
        let boundary = Charted::new(&outline, &map.contacts, Hung::Along(0..lap_knots));
        let mut chart = Self { rings: vec![boundary] };
        for object in &map.objects {
            chart.add(object, Hung::Once(survey.tie(object.seen_us().0, lap_knots)));
        }
        chart
    }

    /// Adds an object and what it hangs on.
    pub fn add(&mut self, object: &MappedObject, hung: Hung) {
        self.rings.push(Charted::new(&object.outline, &object.contacts, hung));
    }

    /// Takes the object at place `index` of the map away again.
    pub fn remove(&mut self, index: usize) {
        self.rings.remove(index + 1);
    }

    /// The wall line as believed now.
    #[must_use]
    pub fn outline(&self) -> &Ring {
        &self.rings[0].shown
    }

    /// The objects as believed now, in the order of the map.
    pub fn objects(&self) -> impl Iterator<Item = &Ring> + Clone {
        self.rings[1..].iter().map(|charted| &charted.shown)
    }

    /// How far `point` is from the nearest mapped surface, and whose it is: none for the boundary,
    /// else the object's place in the map. Inside an object the distance is 0.
    #[must_use]
    pub fn distance(&self, point: Point) -> (f64, Option<usize>) {
        let mut best = (self.outline().distance(point), None);
        for (index, ring) in self.objects().enumerate() {
            let distance = if ring.contains(point) { 0.0 } else { ring.distance(point) };
            if distance < best.0 {
                best = (distance, Some(index));
            }
        }
        best
    }

    /// How far from what is charted nearest to `p`, on the boundary or on object `whose`, a contact may be
    /// and still be of it, metres: the less is known of the pose beside it, the farther.
    #[must_use]
    pub fn tolerance(&self, survey: &Survey, p: Point, whose: Option<usize>) -> f64 {
        let charted = &self.rings[whose.map_or(0, |index| index + 1)];
        tolerance(survey, p, &charted.tie(survey, p))
    }

    /// One standard deviation of the robot's position beside the boundary nearest to `p`, metres.
    #[must_use]
    pub fn looseness(&self, survey: &Survey, p: Point) -> f64 {
        worse(&self.spread(survey, p))
    }

    /// Covariance of the robot's position beside the boundary nearest to `p`, x and y, square metres.
    #[must_use]
    pub fn spread(&self, survey: &Survey, p: Point) -> Matrix2<f64> {
        let spread = survey.spread_beside(p, &self.rings[0].tie(survey, p));
        spread.fixed_view::<2, 2>(0, 0).into_owned()
    }

    /// What the charted surface nearest to `p` hangs on; none without surfaces.
    #[must_use]
    pub fn tie_at(&self, survey: &Survey, p: Point) -> Option<Tie> {
        let nearest =
            self.rings.iter().min_by(|a, b| a.shown.distance(p).total_cmp(&b.shown.distance(p)))?;
        (survey.knots() > 0).then(|| nearest.tie(survey, p))
    }

    /// What is charted, boundary first, as it was before the survey moved it: outline, and what its
    /// place nearest to `p` hangs on.
    pub fn nominal<'a>(
        &'a self,
        survey: &'a Survey,
        p: Point,
    ) -> impl Iterator<Item = (&'a Ring, Tie)> {
        self.rings.iter().map(move |charted| (&charted.nominal, charted.tie(survey, p)))
    }

    /// The mapped surface, no more than `within` metres away, on which a contact lies: away from
    /// corners and facing the robot at `from`.
    #[must_use]
    pub fn surface_at(
        &self,
        survey: &Survey,
        contact: Point,
        from: Point,
        within: f64,
    ) -> Option<Surface> {
        let towards = (from - contact).try_normalize(1e-9)?;
        // The floor is on the left of the boundary and on the right of an object: the far face of a
        // thin wall may be the nearer one, but it was not seen.
        let faces = |charted: &Charted, piece: &Piece, t: f64| {
            let floor = if std::ptr::eq(charted, &raw const self.rings[0]) { 1.0 } else { -1.0 };
            floor * perp(piece.tangent(t)).dot(&towards) > LEAST_INCIDENCE
        };
        let (charted, foot) = self
            .rings
            .iter()
            .filter_map(|charted| {
                let foot =
                    charted.shown.nearest_where(contact, |piece, t| faces(charted, piece, t))?;
                Some((charted, foot))
            })
            .min_by(|a, b| a.1.distance.total_cmp(&b.1.distance))?;
        let piece = charted.shown.pieces[foot.piece];
        // A circle has no corner.
        let from_corner = if charted.shown.is_circle() {
            f64::INFINITY
        } else {
            foot.t.min(1.0 - foot.t) * piece.length()
        };
        let off = |charted: &Charted| charted.shown.distance(contact);
        let nearest = self.rings.iter().map(off).fold(f64::INFINITY, f64::min);
        if foot.distance > within || foot.distance > nearest + THIN || from_corner < CORNER {
            return None;
        }
        let normal = perp(piece.tangent(foot.t));
        let nominal = charted.nominal.pieces[foot.piece].at(foot.t);
        let tie = charted.tie(survey, nominal);
        let at = nominal + survey.displacement(nominal, &tie);
        Some(Surface { at, normal, tie, sd: charted.raggedness(nominal, foot.piece), within })
    }

    /// `pose` corrected by what was `seen` from it, and `survey` with it; none when that is nothing
    /// charted.
    #[must_use]
    pub fn fix(&self, survey: &mut Survey, pose: Pose, seen: &Sighting) -> Option<Pose> {
        if seen.kind != ContactKind::Range {
            return None;
        }
        let surface = self.surface_at(survey, seen.point, seen.pose.position, MOST_KNOWN)?;
        let within = tolerance(survey, surface.at, &surface.tie);
        let near = (seen.point - surface.at).norm() < within;
        near.then(|| survey.touch(pose, seen.point, &Surface { within, ..surface }))?
    }

    /// Moves the rings to where the survey now believes them; returns the largest move of any
    /// corner since the last time, metres.
    pub fn refresh(&mut self, survey: &Survey) -> f64 {
        let mut largest = 0.0_f64;
        let moved: Vec<Ring> = self
            .rings
            .iter()
            .map(|charted| {
                charted.nominal.deformed(|p| survey.displacement(p, &charted.tie(survey, p)))
            })
            .collect();
        for (charted, ring) in self.rings.iter_mut().zip(moved) {
            for (old, new) in charted.shown.pieces.iter().zip(&ring.pieces) {
                largest = largest.max((new.from() - old.from()).norm());
            }
            charted.shown = ring;
        }
        largest
    }

    /// Writes what is believed now into `map`: contacts, outline, objects.
    pub fn publish(&self, survey: &Survey, map: &mut RoomMap) {
        let placed = |charted: &Charted| -> Vec<Contact> {
            charted
                .contacts
                .iter()
                .map(|contact| {
                    let tie = charted.hung.tie(survey, contact.time_us());
                    Contact {
                        point: contact.point + survey.displacement(contact.point, &tie),
                        from: contact.from + survey.displacement(contact.from, &tie),
                        ..*contact
                    }
                })
                .collect()
        };
        map.contacts = placed(&self.rings[0]);
        if let Some(shape) = &mut map.shape {
            shape.outline = self.outline().clone();
        }
        for (object, charted) in map.objects.iter_mut().zip(&self.rings[1..]) {
            object.contacts = placed(charted);
            object.outline = charted.shown.clone();
        }
    }

    /// Writes into `map`, which began at `start`, how well it is known.
    pub fn state_errors(&self, survey: &Survey, start: Point, map: &mut RoomMap) {
        let of = |charted: &Charted| charted.tie(survey, charted.nominal.middle());
        let ties: Vec<Tie> = self.rings[1..].iter().map(of).collect();
        let judge = Judge { survey, lap: &self.rings[0].hung, start, objects: &ties };
        map.accuracy = judge.judge(map);
    }
}

#[cfg(test)]
mod tests;
