//! The Shape phase (paper III.D): from contacts to a fitted outline, its class and its parts.
//! Works on contacts alone: it knows neither the robot's commands nor the plan.

mod assemble;
mod chain;
mod chord;
mod circle;
mod classify;
mod corner;
mod divide;
mod gap;
mod island;
mod neck;
mod needle;
mod object;
mod order;
mod plain;
mod pocket;
pub mod post;
mod rectangle;
mod round;
mod segment;
mod split;
mod spur;
mod strait;
mod stray;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod through;
mod untangle;
mod whole;

pub use assemble::Loops;
pub use chord::mouths;
pub use classify::{TURN_POINT, identify, turn_points};
pub use island::{ALL_AROUND, BUT_FOR_ITS_BACK, Enclosed, enclosed, lost, unmapped};
pub use neck::{is_apart, islands, shared_out, tip};
pub use needle::{Needle, needles};
pub use object::{
    KNOWN, Thing, class_of, closer, is_mapped, is_seen_from_within, lies_on, object_outline, things,
};
pub use spur::without_spurs;
pub use strait::cut_at_straits;
pub use through::{Through, faces_through_each_other};

use self::chord::{Floor, SHORTEST, is_chord};
use self::corner::Judge;
use super::event::Failure;
use super::map::{Contact, ContactKind};
use crate::geometry::segment::Segment;
use crate::geometry::{Piece, Point, Ring};

/// Bumper touches are good to this, metres.
const TOUCH_SIGMA: f64 = 0.004;
/// No noise is believed to be below this, metres: encoder ticks alone make as much.
const LEAST_SIGMA: f64 = 0.0004;
/// No noise is believed to be above this, metres.
const MOST_SIGMA: f64 = 0.004;
/// This share of the contacts was made from within the outline, at least.
const WITHIN: f64 = 0.95;
/// A chord across a gap that the robot does not pass is no longer than so many times its reach.
const WIDEST_MOUTH: f64 = 3.0;
/// Neighbours nearer than this are one contact, metres.
const TOGETHER: f64 = 0.002;

/// One contact as the fit sees it.
#[derive(Debug, Clone)]
pub(crate) struct Sample {
    /// Where the surface is.
    point: Point,
    /// Where it was seen from.
    from: Point,
    /// Weight in the fit: one for a switch, less for the bumper.
    weight: f64,
    /// Edge contacts between this contact and the next.
    edges: Vec<Point>,
}

/// The contacts of a closed lap as they were made, and in order along the wall.
pub struct AlongWall {
    /// In time order.
    made: Vec<Contact>,
    ordered: Vec<Contact>,
    reach: f64,
}

impl AlongWall {
    /// Of `contacts` in time order, of which the last adjoins the first (some wall seen twice does no harm);
    /// `reach` is body radius plus range of the switches, metres.
    #[must_use]
    pub fn of(contacts: &[Contact], reach: f64) -> Self {
        let way: Vec<Segment> = legs(contacts).collect();
        let ordered = spur::on_this_side(&order::along_wall(contacts, reach), &way, reach);
        Self { made: contacts.to_vec(), ordered, reach }
    }

    /// The wall line through them: closed, simple, counter-clockwise, of lines and arcs. A round room may be
    /// bent by `give` metres: so far the gyro may have led the lap astray. A fit that crosses itself is freed of
    /// such `loops`. None when the contacts are too few or make no simple closed outline in which they can have
    /// been made.
    #[must_use]
    pub fn fit(&self, give: f64, loops: Loops) -> Option<Ring> {
        let ring = fitted(&self.ordered, self.reach, give, loops).map(Ring::counter_clockwise);
        ring.filter(|ring| self.holds(ring))
    }

    /// The same, or the contacts joined where no fit can be made of them.
    ///
    /// # Errors
    /// [`Failure::OutlineBroken`] when not even that makes a simple closed outline.
    pub fn outline(&self, give: f64, loops: Loops) -> Result<Ring, Failure> {
        self.fit(give, loops).map_or_else(|| self.joined(), Ok)
    }

    /// The same without a fit: the contacts themselves, joined in order and untangled.
    ///
    /// # Errors
    /// [`Failure::OutlineBroken`] when the contacts are too few or make no simple closed outline.
    pub fn joined(&self) -> Result<Ring, Failure> {
        let ring = chain::outline(&self.ordered).map(Ring::counter_clockwise);
        ring.filter(|ring| self.holds(ring)).ok_or(Failure::OutlineBroken)
    }

    /// Whether the robot was within `ring` when it made the contacts, but for those in pockets that the outline
    /// leaves out, and those in the mouths of gaps too narrow to pass, across which it runs, and out of which the
    /// robot came again: a lap that has laid two walls through each other can be untangled into a simple outline of
    /// another room.
    fn holds(&self, ring: &Ring) -> bool {
        let touched: Vec<(Point, Point)> = self.ordered.iter().map(|c| (c.point, c.from)).collect();
        let gaps = SHORTEST..WIDEST_MOUTH * self.reach;
        let way: Vec<Segment> = legs(&self.made).collect();
        let came_out = |piece: &Piece| {
            let across = Segment::new(piece.from(), piece.to());
            way.iter().filter(|leg| across.crosses(leg)).count() % 2 == 0
        };
        let in_mouth = |p: Point| {
            ring.nearest(p).is_some_and(|foot| {
                let piece = &ring.pieces[foot.piece];
                foot.distance < self.reach
                    && is_chord(piece, Floor::Inside, &touched, &gaps)
                    && came_out(piece)
            })
        };
        let held = |contact: &&Contact| ring.contains(contact.from) || in_mouth(contact.from);
        self.ordered.iter().filter(held).count() as f64 >= WITHIN * self.ordered.len() as f64
    }
}

/// The way between the places from which `contacts`, in time order, were made.
fn legs(contacts: &[Contact]) -> impl Iterator<Item = Segment> + use<'_> {
    contacts.windows(2).map(|two| Segment::new(two[0].from, two[1].from))
}

/// `outline` without the crossings that corrections of its corners may have made.
#[must_use]
pub fn mended(outline: Ring) -> Ring {
    uncrossed(&outline).or_else(|| assemble::with_faces_parted(&outline)).unwrap_or(outline)
}

/// The same; none where it crosses itself by more than small loops.
#[must_use]
pub fn uncrossed(outline: &Ring) -> Option<Ring> {
    assemble::simple(outline)
}

/// The outline with the floor on the left, of contacts `ordered` along the wall; none when there is no simple one.
fn fitted(ordered: &[Contact], reach: f64, give: f64, loops: Loops) -> Option<Ring> {
    let mut samples = samples(ordered, LEAST_SIGMA);
    if samples.len() < 4 {
        return None;
    }
    let sigma = noise(&samples);
    for sample in &mut samples {
        if sample.weight < 1.0 {
            sample.weight = (sigma / TOUCH_SIGMA).powi(2).min(1.0);
        }
    }
    if let Some(circle) = circle::whole(&samples, sigma, give) {
        return Some(circle);
    }
    let runs = segment::runs(&mut samples, sigma);
    let judge = Judge { samples: &samples, sigma, reach };
    assemble::ring(&judge, &runs, loops).map(|ring| whole::closed(ring, &judge))
}

/// The surface contacts, near doubles taken together, each with the edges that follow it.
fn samples(ordered: &[Contact], sigma: f64) -> Vec<Sample> {
    let mut samples: Vec<Sample> = Vec::new();
    for contact in ordered {
        match (contact.kind, samples.last_mut()) {
            (ContactKind::Edge, Some(last)) => last.edges.push(contact.point),
            (ContactKind::Edge, None) => {}
            (ContactKind::Range, Some(last))
                if last.weight == 1.0
                    && (last.point - contact.point).norm() < TOGETHER.max(sigma) =>
            {
                last.point = nalgebra::center(&last.point, &contact.point);
            }
            (kind, _) => samples.push(Sample {
                point: contact.point,
                from: contact.from,
                weight: if kind == ContactKind::Range { 1.0 } else { 0.5 },
                edges: Vec::new(),
            }),
        }
    }
    samples
}

/// The noise of the contacts of something that was gone round, metres.
fn scatter(contacts: &[Contact], reach: f64) -> f64 {
    noise(&samples(&order::along_wall(contacts, reach), LEAST_SIGMA))
}

/// The noise of a contact, metres: what short stretches leave after a parabola, judged by the
/// smoother ones among them, since a ragged wall is not noise.
fn noise(samples: &[Sample]) -> f64 {
    const STRETCH: usize = 6;
    let mut residuals: Vec<f64> = samples
        .windows(STRETCH)
        .filter_map(|stretch| {
            let first = stretch.first()?.point;
            let chord = stretch.last()?.point - first;
            let along = chord.try_normalize(0.02)?;
            let row = |s: &Sample| {
                let v = s.point - first;
                let x = v.dot(&along);
                (x, crate::geometry::cross(along, v))
            };
            let design = nalgebra::SMatrix::<f64, STRETCH, 3>::from_fn(|i, k| {
                row(&stretch[i]).0.powi(i32::try_from(k).unwrap_or(0))
            });
            let value = nalgebra::SVector::<f64, STRETCH>::from_fn(|i, _| row(&stretch[i]).1);
            let normal = design.transpose() * design;
            let solution = normal.try_inverse()? * (design.transpose() * value);
            Some((value - design * solution).norm_squared())
        })
        .collect();
    residuals.sort_by(f64::total_cmp);
    // The lower fifth of a chi-square with three degrees of freedom lies at 1.005.
    let low = residuals.get(residuals.len() / 5).copied().unwrap_or(0.0);
    low.sqrt().clamp(LEAST_SIGMA, MOST_SIGMA)
}
