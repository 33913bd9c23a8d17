//! Things so thin that hardly a beam meets them square on: chair legs, posts, table feet. Going round
//! one of them, the robot turns its beams past it again and again; each time a switch closes or opens,
//! the beam just grazes the post, or ends on it. A contact, placed at the end of the beam, says where
//! the post is to within its own width; the beams themselves, taken as tangents from all sides, say it
//! to a few millimetres.

use crate::geometry::{Point, Ring, Vector, angle, perp};
use crate::mapping::wall::Sighting;
use crate::robot::Chassis;
use nalgebra::{Matrix3, Vector3};

/// No post is thinner, metres ...
const LEAST_RADIUS: f64 = 0.008;
/// ... and none is thicker: that has faces for the beams to meet.
pub const MOST_RADIUS: f64 = 0.12;
/// Fewer glances than this prove nothing.
const FEWEST: usize = 8;
/// A beam that passes the post farther off than this saw something else, metres; the beginning is a
/// guess, so that more is allowed there.
const FARTHEST: f64 = 0.012;
const FARTHEST_AT_FIRST: f64 = 0.05;
/// What is left of a good fit, metres (root mean square), of this share of all glances.
const GOOD: f64 = 0.004;
const AGREEING: f64 = 0.75;
/// It was seen from directions no farther apart than this, radians.
const WIDEST_GAP: f64 = 1.6;
/// Rounds of the fit.
const ROUNDS: usize = 12;

/// A switch that closed or opened while the robot turned.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Glance {
    /// Where the robot's centre was.
    from: Point,
    /// Along the beam, of length one.
    along: Vector,
    /// On which side of the beam the post is if it grazes it: 1 on the left, -1 on the right.
    side: f64,
    /// As far as the beam reaches, metres from the centre.
    reach: f64,
}

impl Glance {
    /// How far off a post at `center` the beam is, metres, and how that changes with the centre and
    /// radius.
    fn off(&self, center: Point, radius: f64) -> (f64, Vector3<f64>) {
        let arm = center - self.from;
        let tangent = (arm.norm_squared() - radius * radius).max(0.0).sqrt();
        if tangent <= self.reach {
            let normal = perp(self.along) * self.side;
            return (normal.dot(&arm) - radius, Vector3::new(normal.x, normal.y, -1.0));
        }
        // Too far off to be grazed: the end of the beam lies on the post.
        let arm = center - (self.from + self.along * self.reach);
        let away = arm.try_normalize(1e-9).unwrap_or(self.along);
        (arm.norm() - radius, Vector3::new(away.x, away.y, -1.0))
    }
}

/// The post that was gone round, from all that the switches told on the way, placed by `place`; none
/// when that is no thin round thing.
#[must_use]
pub fn post(
    seen: &[Sighting],
    chassis: &Chassis,
    place: impl Fn(Point, u64) -> Point,
) -> Option<Ring> {
    let glances: Vec<Glance> = seen
        .iter()
        .filter(|seen| seen.sensor.is_some() && seen.swept != 0.0)
        .map(|seen| Glance {
            from: place(seen.pose.position, seen.time_us),
            along: angle::unit(seen.beam),
            side: if seen.rising { seen.swept } else { -seen.swept },
            reach: chassis.reach() + if seen.rising { 0.0 } else { chassis.hysteresis },
        })
        .collect();
    let (center, radius, agreeing) = fit(&glances)?;
    let bearings = agreeing.iter().map(|glance| angle::of(center - glance.from)).collect();
    (angle::widest_gap(bearings) < WIDEST_GAP).then(|| Ring::circle(center, radius))
}

/// Least squares over the glances, without those that are of something else: centre, radius, and the
/// glances that agree.
fn fit(glances: &[Glance]) -> Option<(Point, f64, Vec<Glance>)> {
    let count = glances.len();
    if count < FEWEST {
        return None;
    }
    let ends = glances.iter().map(|glance| glance.from.coords + glance.along * glance.reach);
    let mut center = Point::from(ends.sum::<Vector>() / count as f64);
    let mut radius = 0.03;
    let mut agreeing: Vec<Glance> = Vec::new();
    for round in 0..ROUNDS {
        let share = f64::from(u32::try_from(round).unwrap_or(0)) / (ROUNDS - 1) as f64;
        let allowed = FARTHEST_AT_FIRST + (FARTHEST - FARTHEST_AT_FIRST) * share;
        let (mut normal, mut right) = (Matrix3::identity() * 1e-9, Vector3::zeros());
        agreeing.clear();
        for glance in glances {
            let (off, row) = glance.off(center, radius);
            if off.abs() < allowed {
                normal += row * row.transpose();
                right -= row * off;
                agreeing.push(*glance);
            }
        }
        let step = normal.cholesky()?.solve(&right);
        center += Vector::new(step.x, step.y);
        radius = (radius + step.z).clamp(LEAST_RADIUS, MOST_RADIUS);
    }
    let squares: f64 = agreeing.iter().map(|glance| glance.off(center, radius).0.powi(2)).sum();
    let enough = agreeing.len() >= FEWEST && agreeing.len() as f64 > AGREEING * count as f64;
    let good = (squares / agreeing.len().max(1) as f64).sqrt() < GOOD;
    let within = radius > LEAST_RADIUS && radius < MOST_RADIUS;
    (enough && good && within).then_some((center, radius, agreeing))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Glances from a circle of 0.18 m about a thing, as the beams of a robot that turns there see
    /// it: `grazes` tells how far to the left and right of its middle it reaches, as angles.
    fn glances(radius: f64) -> Vec<Glance> {
        (0..12)
            .flat_map(|k| {
                let from =
                    Point::new(2.0, 1.0) + angle::unit(f64::from(k) * angle::TAU / 12.0) * 0.17;
                let to = angle::of(Point::new(2.0, 1.0) - from);
                let half = angle::asin(radius / 0.17);
                [1.0, -1.0].map(|side| Glance {
                    from,
                    along: angle::unit(to - side * half),
                    side,
                    reach: 0.2,
                })
            })
            .collect()
    }

    #[test]
    fn a_post_is_as_thick_as_the_beams_that_graze_it_say() {
        for radius in [0.02, 0.036, 0.06] {
            let (center, found, _) = fit(&glances(radius)).expect("a post");
            assert!((center - Point::new(2.0, 1.0)).norm() < 1e-4, "{center}");
            assert!((found - radius).abs() < 1e-4, "{found} instead of {radius}");
        }
    }

    #[test]
    fn what_its_beams_do_not_agree_on_is_no_post() {
        let mut glances = glances(0.03);
        for (k, glance) in glances.iter_mut().enumerate() {
            glance.from += angle::unit(k as f64) * 0.03;
        }
        assert!(fit(&glances).is_none());
        assert!(fit(&glances[..5]).is_none());
    }
}
