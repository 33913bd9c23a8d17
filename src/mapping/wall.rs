//! What the switches have said of the surfaces near the robot: contacts, kept honest.
//!
//! A switch that changes gives one point of a surface at a known distance, unless its beam slid
//! off the end of something nearer (a silhouette: the tip of an outer corner). The two look the
//! same to the robot; here they are told apart by what the wall seen so far predicts, by crossing
//! the same ray in both directions (a surface opens 5 mm later than it closes, a silhouette does
//! not), and by beams that later pass through a point without seeing it. The way itself is kept too (`swept`):
//! it tells where nothing was.

mod carve;
mod sighting;
mod stretch;
mod swept;

pub use sighting::{Sighting, Turning};
pub use stretch::Stretch;
pub use swept::{Stroke, closed_beams, is_felt_on_both_hands, length_within, swept};

use self::carve::Trail;
use super::drift::Unwound;
use super::map::{Contact, ContactKind};
use crate::geometry::{Point, Pose, Vector, angle, cross};
use crate::robot::{Chassis, Edge};

/// How far back along the drive contacts are trusted to fit together, metres.
const MEMORY: f64 = 2.0;
/// What was seen through a gap lies no farther than this from a robot that turns back in it, metres.
const NEIGHBOURHOOD: f64 = 0.6;
/// What lies farther ahead than this lies beyond where the robot turned back, metres.
const BEYOND: f64 = 0.02;
/// Edges of one switch nearer than this while turning are two crossings of one silhouette.
const SILHOUETTE: f64 = 0.014;

/// Which contacts tell how the wall runs at a place: metres driven since, metres from it; how far
/// they must lie apart, and how near to a line.
struct Around {
    travelled: f64,
    distance: f64,
    spread: f64,
    residual: f64,
}

const CLOSE_BY: [Around; 2] = [
    Around { travelled: 0.5, distance: 0.22, spread: 0.012, residual: 0.006 },
    Around { travelled: 1.1, distance: 0.6, spread: 0.05, residual: 0.003 },
];

/// All sightings of one lap, with the near ones at hand.
#[derive(Debug, Clone)]
pub struct Wall {
    reach: f64,
    radius: f64,
    hysteresis: f64,
    beams: Vec<f64>,
    /// The same as directions.
    rays: Vec<Vector>,
    log: Vec<Sighting>,
    near: Vec<usize>,
    last_pose: Option<Pose>,
    trail: Trail,
    strokes: Vec<Stroke>,
    /// Switches that were open where another had seen something.
    missed: Vec<usize>,
}

impl Wall {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(chassis: &Chassis) -> Self {
        Self {
            reach: chassis.reach(),
            radius: chassis.radius,
            hysteresis: chassis.hysteresis,
            beams: chassis.sensors.iter().map(|mount| mount.angle).collect(),
            rays: chassis.sensors.iter().map(|mount| angle::unit(mount.angle)).collect(),
            log: Vec::new(),
            near: Vec::new(),
            last_pose: None,
            trail: Trail::default(),
            strokes: Vec::new(),
            missed: Vec::new(),
        }
    }

    /// The switches that were open where another had seen something, since this was asked last.
    pub fn take_missed(&mut self) -> Vec<usize> {
        std::mem::take(&mut self.missed)
    }

    /// Every sighting, in the order in which it came.
    #[must_use]
    pub fn log(&self) -> &[Sighting] {
        &self.log
    }

    /// What of it still holds, as it goes into the map.
    #[must_use]
    pub fn contacts(&self) -> Vec<Contact> {
        self.surfaces().map(Sighting::contact).collect()
    }

    /// The living sightings that place a surface: what [`Wall::pull_in`] put somewhere keeps the robot
    /// off, and is no part of a map.
    pub fn surfaces(&self) -> impl Iterator<Item = &Sighting> {
        let guessed = |seen: &Sighting| seen.kind == ContactKind::Touch && seen.sensor.is_some();
        self.log.iter().filter(move |seen| seen.alive && !guessed(seen))
    }

    /// Takes a steady drift of the gyro out of all that was seen.
    pub fn unwind(&mut self, unwound: &Unwound) {
        for seen in &mut self.log {
            *seen = seen.unwound(unwound);
        }
        self.unwind_strokes(unwound);
        self.trail.clear();
        if let (Some(pose), Some(last)) = (&mut self.last_pose, unwound.path().last()) {
            *pose = unwound.pose(*pose, last.time_us);
        }
    }

    /// Forgets everything, for a new lap.
    pub fn clear(&mut self) {
        self.log.clear();
        self.near.clear();
        self.trail.clear();
        self.strokes.clear();
    }

    /// The living sightings near the robot, oldest first.
    pub fn near(&self) -> impl DoubleEndedIterator<Item = &Sighting> {
        self.near.iter().map(|&index| &self.log[index]).filter(|seen| seen.alive)
    }

    /// What was seen before there were `count` sightings is not near any longer: the robot turned round and
    /// round among it, so it is not where it is believed to be. It stays in the log.
    pub fn doubt_before(&mut self, count: usize) {
        self.near.retain(|&index| index >= count);
    }

    /// Takes one edge, seen from `pose`; `turning` tells which motion was under way. Returns it as
    /// it was judged.
    pub fn observe(
        &mut self,
        edge: &Edge,
        pose: Pose,
        turning: Turning,
        travelled: f64,
    ) -> Sighting {
        let beam = pose.heading + self.beams.get(edge.sensor).copied().unwrap_or(0.0);
        let distance = if edge.rising { self.reach } else { self.reach + self.hysteresis };
        let mut seen = Sighting {
            point: pose.position + angle::unit(beam) * distance,
            pose,
            beam,
            kind: ContactKind::Range,
            sensor: Some(edge.sensor),
            rising: edge.rising,
            swept: if let Turning::By(sense) = turning { sense } else { 0.0 },
            travelled,
            time_us: edge.odometer.time_us,
            alive: true,
            ruled_out: 0,
        };
        if turning != Turning::No {
            self.judge_by_crossing(&mut seen);
        } else if !edge.rising {
            self.judge_by_prediction(&mut seen);
        }
        self.push(seen);
        seen
    }

    /// Takes a bump: the rim touched something, ahead of `pose` as long as no beam says otherwise.
    pub fn touch(&mut self, pose: Pose, travelled: f64, time_us: u64) -> Sighting {
        let beam = pose.heading;
        let seen = Sighting {
            point: pose.position + angle::unit(beam) * self.radius,
            pose,
            beam,
            kind: ContactKind::Touch,
            sensor: None,
            rising: true,
            swept: 0.0,
            travelled,
            time_us,
            alive: true,
            ruled_out: 0,
        };
        self.push(seen);
        seen
    }

    /// What the bumper was said to touch after `since_us`, robot time in microseconds, was nothing.
    pub fn untouch(&mut self, since_us: u64) {
        let felt = |seen: &&mut Sighting| seen.kind == ContactKind::Touch && seen.sensor.is_none();
        for seen in self.log.iter_mut().filter(felt).filter(|seen| seen.time_us > since_us) {
            seen.alive = false;
        }
    }

    /// One of which `seen` is known already.
    #[must_use]
    pub fn of(chassis: &Chassis, seen: impl IntoIterator<Item = Sighting>) -> Self {
        let mut wall = Self::new(chassis);
        seen.into_iter().for_each(|seen| wall.push(seen));
        wall
    }

    fn push(&mut self, seen: Sighting) {
        self.near.push(self.log.len());
        self.log.push(seen);
    }

    /// Two crossings of one ray while turning on the spot: a silhouette if they coincide.
    fn judge_by_crossing(&mut self, seen: &mut Sighting) {
        let twin = self.near.iter().rev().copied().find(|&index| {
            let other = &self.log[index];
            other.sensor == seen.sensor
                && other.rising != seen.rising
                && (other.pose.position - seen.pose.position).norm() < 0.003
                && angle::wrap(other.beam - seen.beam).abs() < 0.5
        });
        let Some(twin) = twin else { return };
        if angle::wrap(self.log[twin].beam - seen.beam).abs() < SILHOUETTE {
            let tip = self.silhouette(seen);
            self.log[twin].kind = ContactKind::Edge;
            seen.kind = ContactKind::Edge;
            if let Some(point) = tip {
                self.log[twin].point = point;
                seen.point = point;
            } else {
                self.log[twin].alive = false;
                seen.alive = false;
            }
        }
    }

    /// A switch that opened on the move although the wall seen so far would have kept it closed:
    /// the wall ends here.
    fn judge_by_prediction(&mut self, seen: &mut Sighting) {
        let Some(stretch) = self.stretch_near(seen) else {
            return;
        };
        let direction = angle::unit(seen.beam);
        if let Some(distance) = stretch.meets(seen.pose.position, direction)
            && distance < self.reach - 0.005
            && distance > self.radius - 0.01
        {
            seen.kind = ContactKind::Edge;
            seen.point = seen.pose.position + direction * distance;
        }
    }

    /// Where on the ray of `seen` the surface ends, from the wall near it or from another
    /// silhouette of the same tip.
    fn silhouette(&self, seen: &Sighting) -> Option<Point> {
        let direction = angle::unit(seen.beam);
        let fits = |distance: f64| {
            distance > self.radius - 0.01 && distance < self.reach + self.hysteresis
        };
        let known_tip = self.near().rev().find_map(|other| {
            if other.kind != ContactKind::Edge {
                return None;
            }
            let along = (other.point - seen.pose.position).dot(&direction);
            let off = cross(direction, other.point - seen.pose.position).abs();
            (off < 0.012 && fits(along)).then(|| seen.pose.position + direction * along)
        });
        known_tip.or_else(|| {
            let distance = self.stretch_near(seen)?.meets(seen.pose.position, direction)?;
            fits(distance).then(|| seen.pose.position + direction * distance)
        })
    }

    /// The straight stretch that the wall makes near the end of the beam of `seen`, from what was seen
    /// close by, or else since the step before the last one.
    fn stretch_near(&self, seen: &Sighting) -> Option<Stretch> {
        CLOSE_BY.iter().find_map(|around| self.stretch_within(seen, around))
    }

    fn stretch_within(&self, seen: &Sighting, around: &Around) -> Option<Stretch> {
        let direction = angle::unit(seen.beam);
        let middle = seen.pose.position + direction * (self.reach - 0.02);
        let points: Vec<Point> = self
            .near()
            .filter(|other| other.kind == ContactKind::Range)
            .filter(|other| other.travelled > seen.travelled - around.travelled)
            .map(|other| other.point)
            .filter(|point| (point - middle).norm() < around.distance)
            .collect();
        let stretch = Stretch::through(&points)?;
        let spread =
            points.iter().map(|p| stretch.along.dot(&(p - stretch.at)).abs()).fold(0.0, f64::max);
        (spread > around.spread && stretch.residual < around.residual).then_some(stretch)
    }

    /// The robot, at `pose`, goes no farther into a gap: what it saw beyond keeps it off, but is no part
    /// of the floor's outline. From the other side of the gap the same may be seen again, and an
    /// outline through both would cross itself. What it saw when it was on the other side itself stays.
    pub fn leave_beyond(&mut self, pose: Pose) {
        let ahead = pose.direction();
        let is_beyond = |p: Point| (p - pose.position).dot(&ahead) > BEYOND;
        for &index in &self.near {
            let seen = &mut self.log[index];
            let near = (seen.point - pose.position).norm() < NEIGHBOURHOOD;
            let from_here = is_beyond(seen.point) && !is_beyond(seen.pose.position);
            if near && from_here && seen.sensor.is_some() {
                seen.kind = ContactKind::Touch;
            }
        }
    }

    /// Takes what `sensor` saw last for a thing `distance` metres from the robot's centre: a beam that
    /// slid on to it from the side has not measured how near it is.
    pub fn pull_in(&mut self, sensor: usize, distance: f64) {
        if let Some(seen) = self.log.iter_mut().rev().find(|seen| seen.sensor == Some(sensor)) {
            seen.kind = ContactKind::Touch;
            seen.point = seen.pose.position + angle::unit(seen.beam) * distance;
            seen.alive = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Odometer;

    #[test]
    fn a_switch_that_opens_a_long_step_after_the_last_contacts_tells_where_the_wall_ends() {
        let chassis = Chassis::default();
        let left = chassis.sensor_towards(angle::FRAC_PI_2, 0.1).expect("a switch on the left");
        let mut wall = Wall::new(&chassis);
        let odometer = Odometer { time_us: 0, left_ticks: 0, right_ticks: 0, heading: 0.0 };
        let edge = |rising: bool| Edge { sensor: left, rising, odometer };
        // Contacts of a wall along y = 0.16, half a metre and more behind.
        for k in 0..3 {
            let pose = Pose::new(f64::from(k) * 0.1, 0.0, 0.0);
            wall.observe(&edge(true), pose, Turning::By(1.0), f64::from(k) * 0.1);
        }
        let pose = Pose::new(0.55, 0.02, 0.0);
        let seen = wall.observe(&edge(false), pose, Turning::No, 0.55);
        assert_eq!(seen.kind, ContactKind::Edge);
        assert!((seen.point - Point::new(0.55, 0.16)).norm() < 1e-9, "{}", seen.point);
    }

    #[test]
    fn where_the_robot_turns_back_it_leaves_what_it_saw_ahead_and_not_what_it_saw_from_there() {
        let chassis = Chassis::default();
        let front = chassis.sensor_towards(0.0, 0.1).expect("a switch ahead");
        let mut wall = Wall::new(&chassis);
        let odometer = Odometer { time_us: 0, left_ticks: 0, right_ticks: 0, heading: 0.0 };
        let edge = Edge { sensor: front, rising: true, odometer };
        // From beyond the gap; on the way into it, to the side; and where it turns back.
        let from = [(0.6, angle::PI), (-0.1, angle::FRAC_PI_2), (0.1, 0.6)];
        for (k, (x, heading)) in from.into_iter().enumerate() {
            wall.observe(&edge, Pose::new(x, 0.0, heading), Turning::No, 0.3 * k as f64);
        }
        wall.leave_beyond(Pose::new(0.1, 0.0, 0.0));
        let kinds: Vec<ContactKind> = wall.log().iter().map(|seen| seen.kind).collect();
        assert_eq!(kinds, [ContactKind::Range, ContactKind::Range, ContactKind::Touch]);
    }
}
