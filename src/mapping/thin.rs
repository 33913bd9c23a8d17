//! What thin walls say of the lap: their two faces do not lie through each other.
//!
//! A board of two centimetres is followed on one face and, half a lap later, on the other. By then the robot may be
//! off by more than the board is thick, and its faces have changed places on paper: the beams that ended on the
//! one go through the other. That cannot be, and by how much it is so is a measurement of what the
//! robot was off by between the two. Each such beam is put into the survey as an observation that the faces
//! lie a little apart. What does not contradict itself is left alone: how thick a wall is, nobody knows.
//! What outline is made of the contacts is not known here.

use super::shape::{AlongWall, Through, faces_through_each_other};
use super::survey::{Surface, Survey};
use crate::geometry::{Point, Vector};
use std::collections::BTreeMap;

/// How thick a wall is whose faces changed places, metres: it is thinner than what the robot is off by.
pub const THICKNESS: f64 = 0.008;
/// How well that is known, metres.
pub const THICKNESS_SD: f64 = 0.006;

/// Faces are parted at most so often; each time others may turn out to lie through each other.
pub const PARTINGS: u32 = 4;

/// What was seen between one and the same knots, added up.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    count: f64,
    deep: f64,
    near: Vector,
    far: Vector,
    normal: Vector,
    times_us: (u64, u64),
}

impl Sum {
    fn add(&mut self, through: &Through) {
        self.count += 1.0;
        self.deep += through.deep;
        self.near += through.tip.coords;
        self.far += through.at.coords;
        self.normal += through.normal;
        self.times_us = through.times_us;
    }

    fn mean(&self, of: Vector) -> Point {
        Point::from(of / self.count)
    }
}

/// Tells `survey` that no two faces lie through each other, of which the contacts of the `lap` say that they do;
/// its first `knots` knots are those of the lap. True when there were any.
pub fn part(survey: &mut Survey, knots: usize, lap: &AlongWall) -> bool {
    let mut sums: BTreeMap<[usize; 4], Sum> = BTreeMap::new();
    for through in faces_through_each_other(lap) {
        let (seen, crossed) = through.times_us;
        let key = [survey.tie(seen, knots).knots(), survey.tie(crossed, knots).knots()].concat();
        if let Ok(key) = <[usize; 4]>::try_from(key) {
            sums.entry(key).or_default().add(&through);
        }
    }
    for sum in sums.values() {
        let Some(normal) = sum.normal.try_normalize(1e-9) else { continue };
        let (seen, crossed) = sum.times_us;
        let surface = |at: Point, time_us: u64| Surface {
            at,
            normal,
            tie: survey.tie(time_us, knots),
            sd: THICKNESS_SD,
            within: f64::INFINITY,
        };
        let (near, far) = (surface(sum.mean(sum.near), seen), surface(sum.mean(sum.far), crossed));
        survey.part(&near, &far, sum.deep / sum.count + THICKNESS);
    }
    !sums.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Pose, angle};
    use crate::mapping::map::{Contact, ContactKind, Spun};
    use crate::mapping::survey::Step;

    const REACH: f64 = 0.16;

    /// A robot goes along one face of a board of 3 m by 20 mm, and back along the other: 3 m along y, round the
    /// end, and 3 m back. Its gyro has drifted: the second face lies 15 mm through the first.
    fn gone_round() -> (Survey, Vec<Contact>) {
        let mut survey = Survey::new(0.0005 / 0.16);
        let mut contacts = Vec::new();
        let mut before: Option<Pose> = None;
        for k in 0..=60_u32 {
            let there = k <= 30;
            let along = if there { f64::from(k) * 0.1 } else { f64::from(60 - k) * 0.1 + 0.03 };
            // The far face is at x = 0.02, and believed to be at -0.015.
            let (x, heading) =
                if there { (-0.145, angle::FRAC_PI_2) } else { (0.13, -angle::FRAC_PI_2) };
            let pose = Pose::new(x, along, heading);
            if let Some(from) = before {
                let step =
                    Step { from, to: pose, seconds: 1.0, spun: (Spun::default(), Spun::default()) };
                survey.predict(&step);
            }
            before = Some(pose);
            let time_us = u64::from(k) * 1_000_000;
            if k % 5 == 0 {
                survey.mark(pose.position, time_us);
            }
            let across = if there { 0.145 } else { -0.145 };
            contacts.push(Contact {
                point: pose.position + Vector::new(across, 0.0),
                from: pose.position,
                sensor: Some(6),
                kind: ContactKind::Range,
                time: f64::from(k),
            });
        }
        (survey, contacts)
    }

    /// How thick the board is 1.5 m from its foot, metres.
    fn thickness(contacts: &[Contact]) -> f64 {
        contacts[45].point.x - contacts[15].point.x
    }

    #[test]
    fn faces_that_lie_through_each_other_are_parted_and_then_left_alone() {
        let (mut survey, mut contacts) = gone_round();
        assert!(thickness(&contacts) < -0.01);
        let knots = survey.knots();
        for _ in 0..3 {
            if !part(&mut survey, knots, &AlongWall::of(&contacts, REACH)) {
                break;
            }
            for contact in &mut contacts {
                let tie = survey.tie(contact.time_us(), knots);
                contact.point += survey.displacement(contact.point, &tie);
                contact.from += survey.displacement(contact.from, &tie);
            }
            survey.rebase();
        }
        let thick = thickness(&contacts);
        assert!((0.0..0.02).contains(&thick), "{thick} m");
        let before = survey.clone();
        assert!(!part(&mut survey, knots, &AlongWall::of(&contacts, REACH)), "once more");
        assert_eq!(survey, before);
    }
}
