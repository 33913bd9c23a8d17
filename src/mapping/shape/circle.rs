//! Whether a room is round. A gyro that wanders bends the lap round it slowly: into an oval, or a shape
//! with three or four soft corners, never into a polygon of many. What such a bend of no more than the
//! survey's own doubt explains is a circle all the same.

use super::Sample;
use crate::geometry::fit::Moments;
use crate::geometry::{Ring, angle};
use nalgebra::{SMatrix, SVector};

/// Fewer contacts prove nothing.
const FEWEST: usize = 8;
/// Nowhere are there fewer contacts than this apart, radians.
const WIDEST_GAP: f64 = 0.9;
/// The doubt of the survey counts this many times over.
const SIGMAS: f64 = 3.0;
/// No bend is larger than this share of the radius: a polygon of five sides is bent by more.
const MOST_BENT: f64 = 0.012;
/// A bend is made of waves with two, three and four crests round the room.
const WAVES: [f64; 3] = [2.0, 3.0, 4.0];
/// A cosine and a sine for each wave, and the radius.
const UNKNOWNS: usize = 7;

/// The circle on which all of the contacts lie, all the way round, bent by `give` metres (standard
/// deviation) at most; none when there is no such.
pub(super) fn whole(samples: &[Sample], sigma: f64, give: f64) -> Option<Ring> {
    let mut moments = Moments::new(samples.first()?.point);
    for sample in samples {
        moments.add(sample.point, sample.weight);
    }
    let circle = moments.circle()?;
    let polar: Vec<(f64, f64, f64)> = samples
        .iter()
        .map(|s| {
            let arm = s.point - circle.center;
            (angle::of(arm), arm.norm() - circle.radius, s.weight)
        })
        .collect();
    let mut bearings: Vec<f64> = polar.iter().map(|p| p.0).collect();
    bearings.sort_by(f64::total_cmp);
    let around = bearings.first()? + angle::TAU - bearings.last()?;
    let gap = bearings.windows(2).map(|p| p[1] - p[0]).fold(around, f64::max);
    if samples.len() < FEWEST || gap > WIDEST_GAP {
        return None;
    }
    let found = || Ring::circle(circle.center, circle.radius);
    if is_noise(polar.iter().map(|&(_, off, weight)| (off, weight)), sigma) {
        return Some(found());
    }
    let bend = bend(&polar)?;
    let waves = bend.fixed_rows::<6>(1);
    let straightened =
        polar.iter().map(|&(bearing, off, weight)| (off - row(bearing).dot(&bend), weight));
    let allowed = (SIGMAS * give).min(MOST_BENT * circle.radius);
    (waves.norm() < allowed && is_noise(straightened, sigma)).then(found)
}

/// Whether contacts that lie `off` their circle (metres, with their weights) scatter as contacts of
/// noise `sigma` do. A polygon's corners stray from its circle by more.
fn is_noise(off: impl Iterator<Item = (f64, f64)>, sigma: f64) -> bool {
    let (worst, squares, count) =
        off.fold((0.0_f64, 0.0, 0.0), |(worst, squares, count), (off, weight)| {
            (worst.max(off.abs() * weight.sqrt()), squares + weight * off * off, count + 1.0)
        });
    let rms = (squares / f64::max(count, 1.0)).sqrt();
    worst < 3.5 * sigma + 0.002 && rms < 1.6 * sigma + 0.0005
}

/// The radius and the waves at a bearing.
fn row(bearing: f64) -> SVector<f64, UNKNOWNS> {
    let mut row = SVector::zeros();
    row[0] = 1.0;
    for (k, crests) in WAVES.iter().enumerate() {
        row[1 + 2 * k] = angle::cos(crests * bearing);
        row[2 + 2 * k] = angle::sin(crests * bearing);
    }
    row
}

/// The bend that fits best, by least squares.
fn bend(polar: &[(f64, f64, f64)]) -> Option<SVector<f64, UNKNOWNS>> {
    let mut normal = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros();
    let mut right = SVector::<f64, UNKNOWNS>::zeros();
    for &(bearing, off, weight) in polar {
        let row = row(bearing);
        normal += row * row.transpose() * weight;
        right += row * (off * weight);
    }
    normal.cholesky().map(|normal| normal.solve(&right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;

    fn samples(radius: impl Fn(f64) -> f64) -> Vec<Sample> {
        (0..120)
            .map(|k| {
                let bearing = f64::from(k) / 120.0 * angle::TAU;
                let at = Point::origin() + angle::unit(bearing) * radius(bearing);
                Sample { point: at, from: Point::origin(), weight: 1.0, edges: Vec::new() }
            })
            .collect()
    }

    #[test]
    fn an_oval_within_the_surveys_doubt_is_a_circle() {
        let oval = samples(|bearing| 3.0 + 0.02 * angle::cos(2.0 * bearing + 0.3));
        assert!(whole(&oval, 0.0015, 0.0).is_none());
        assert!(whole(&oval, 0.0015, 0.01).is_some());
        let flat = samples(|bearing| 3.0 + 0.2 * angle::cos(2.0 * bearing));
        assert!(whole(&flat, 0.0015, 0.1).is_none());
    }

    #[test]
    fn a_polygon_of_sixteen_sides_is_none_whatever_the_doubt() {
        let side = angle::TAU / 16.0;
        let polygon = samples(|bearing| 2.0 / angle::cos(bearing.rem_euclid(side) - side / 2.0));
        assert!(whole(&polygon, 0.0015, 0.05).is_none());
    }
}
