//! The simulated body: a disc on two wheels that walls hold up, with its switches, encoders, gyro
//! and bumper. Stepped in virtual time; edges are located within a step by bisection.

use super::World;
use super::noise::{Noise, NoiseProfile};
use super::reach::{ReachGrid, Segment, cast, nearest};
use crate::geometry::{Point, Pose, Vector, angle};
use crate::robot::{Chassis, Edge, Hardware, Odometer, SwitchSet};
use std::collections::VecDeque;

/// What the gyro counts in, and the wheels turn the body by, radians.
const GYRO: f64 = 1e-6;

/// In counts of the gyro.
fn whole(angle: f64) -> i64 {
    nearest_count(angle / GYRO)
}

/// Halves, which a move that holds its heading by whole counts makes all the time, go up whatever the
/// last bit says.
fn nearest_count(counts: f64) -> i64 {
    (counts + 1e-6).round() as i64
}

/// The body in its world, the truth included.
#[derive(Debug, Clone)]
pub struct Body {
    chassis: Chassis,
    grid: ReachGrid,
    noise: Noise,
    pose: Pose,
    speed: f64,
    rate: f64,
    scale: [f64; 2],
    time_us: u64,
    wheels: [f64; 2],
    /// What the gyro has told, whole microradians: what it tells of a motion does not hang on what it
    /// told before.
    gyro: i64,
    switches: SwitchSet,
    /// Distance from the centre at which each switch changes next.
    limits: Vec<f64>,
    beams: Vec<Vector>,
    bumper: bool,
    edges: VecDeque<(Edge, Pose)>,
    truth: Pose,
    contact: f64,
    bumps: u32,
}

impl Body {
    /// A robot with `chassis` at `world.start`.
    #[must_use]
    pub fn new(world: &World, chassis: &Chassis, profile: NoiseProfile, seed: u64) -> Self {
        let count = chassis.sensors.len();
        let mut noise = Noise::new(profile, seed, count);
        let limits = (0..count).map(|k| chassis.radius + noise.range(k, chassis.range)).collect();
        let slack = 0.03 + chassis.hysteresis + 0.15 * chassis.range;
        let mut body = Self {
            grid: ReachGrid::new(world, chassis.reach() + slack),
            scale: noise.travel_scale(),
            noise,
            pose: world.start,
            speed: 0.0,
            rate: 0.0,
            time_us: 0,
            wheels: [0.0; 2],
            gyro: whole(world.start.heading),
            switches: SwitchSet::EMPTY,
            limits,
            beams: chassis.sensors.iter().map(|mount| angle::unit(mount.angle)).collect(),
            bumper: false,
            edges: VecDeque::new(),
            truth: world.start,
            contact: 0.0,
            bumps: 0,
            chassis: chassis.clone(),
        };
        body.switches = body.sense(world.start);
        body
    }

    /// Where the body really is. Goes to exports and tests, never to the mapping core.
    #[must_use]
    pub fn true_pose(&self) -> Pose {
        self.pose
    }

    /// Where the body really was at the edge taken last, or now.
    #[must_use]
    pub fn truth_of_edge(&self) -> Pose {
        self.truth
    }

    /// Metres travelled with the body against something.
    #[must_use]
    pub fn contact(&self) -> f64 {
        self.contact
    }

    /// How often the bumper was pressed, touches that ended no motion included. For tests
    /// alone: what a run tells of is what the robot told its host.
    #[must_use]
    pub fn bumps(&self) -> u32 {
        self.bumps
    }

    /// Somebody pushes the robot to `pose`: neither wheels nor gyro tell of it.
    #[cfg(test)]
    pub(crate) fn push(&mut self, pose: Pose) {
        self.pose = pose;
    }

    /// Lets `seconds` of virtual time pass at the speed that was set, in parts so short that the body does
    /// not leap over what would hold it up.
    pub fn step(&mut self, seconds: f64) {
        let leap = self.speed.abs() * seconds / (self.chassis.radius / 2.0);
        let parts = (leap.ceil() as u32).max(1);
        for _ in 0..parts {
            self.pass(seconds / f64::from(parts));
        }
    }

    fn pass(&mut self, seconds: f64) {
        let micros = (seconds * 1e6).round() as u64;
        if self.speed == 0.0 && self.rate == 0.0 {
            self.time_us += micros;
            self.gyro += whole(self.noise.gyro_error(seconds, false));
            return;
        }
        let before = (self.pose, self.wheels, self.gyro, self.time_us);
        let turned = whole(self.rate * seconds) as f64 * GYRO;
        let mut next = Pose {
            position: self.pose.position
                + angle::unit(self.pose.heading + turned / 2.0) * (self.speed * seconds),
            heading: angle::wrap(self.pose.heading + turned),
        };
        let pressed = self.hold_up(&mut next);
        let ahead = (next.position - self.pose.position).dot(&self.pose.direction());
        let half = turned * self.chassis.wheel_base / 2.0;
        self.wheels[0] += (ahead - half) * self.scale[0];
        self.wheels[1] += (ahead + half) * self.scale[1];
        // A wheel that slips turns farther than the body goes, whichever way.
        let slip = self.noise.slip(ahead.abs()) * ahead.signum();
        self.wheels[0] += slip;
        self.wheels[1] += slip;
        self.gyro += whole(turned * self.noise.gyro_scale + self.noise.gyro_error(seconds, true));
        self.time_us += micros;
        self.pose = next;
        if pressed && !self.bumper {
            self.bumps += 1;
        }
        self.bumper = pressed;
        self.find_edges(&before);
    }

    /// Pushes the body out of walls it would overlap; it slides along them, or stays where it was
    /// when it cannot. Returns whether the bumper is pressed, by whichever of them.
    fn hold_up(&mut self, next: &mut Pose) -> bool {
        let radius = self.chassis.radius;
        let from = self.pose.position;
        let mut met: Option<Point> = None;
        let mut pressed = false;
        for _ in 0..4 {
            let Some((at, distance)) = nearest(self.grid.near(next.position), next.position) else {
                return pressed;
            };
            if distance >= radius {
                if distance < radius + 0.001 {
                    self.contact += (next.position - from).norm();
                    if met.is_none() && distance < radius + 2e-4 {
                        pressed = self.covers(next, at);
                    }
                }
                return pressed;
            }
            let away =
                (next.position - at).try_normalize(1e-12).unwrap_or_else(|| -next.direction());
            next.position = at + away * (radius + 1e-7);
            met = Some(at);
            pressed |= self.covers(next, at);
        }
        next.position = from;
        pressed || met.is_some_and(|at| self.covers(next, at))
    }

    fn covers(&self, pose: &Pose, at: Point) -> bool {
        let bearing = angle::wrap(angle::of(at - pose.position) - pose.heading);
        bearing.abs() <= self.chassis.bumper_half_angle
    }

    fn closed(&self, near: &[Segment], pose: Pose, index: usize) -> bool {
        let ray = pose.rotate(self.beams[index]);
        cast(near, pose.position, ray) <= self.limits[index]
    }

    fn sense(&self, pose: Pose) -> SwitchSet {
        let near = self.grid.near(pose.position);
        if near.is_empty() {
            return SwitchSet::EMPTY;
        }
        let direction = pose.direction();
        let mut set = SwitchSet::EMPTY;
        for (index, beam) in self.beams.iter().enumerate() {
            let ray = direction * beam.x + crate::geometry::perp(direction) * beam.y;
            set = set.with(index, cast(near, pose.position, ray) <= self.limits[index]);
        }
        set
    }

    fn find_edges(&mut self, before: &(Pose, [f64; 2], i64, u64)) {
        let now = self.sense(self.pose);
        if now == self.switches {
            return;
        }
        let turned = angle::wrap(self.pose.heading - before.0.heading);
        let moved = self.pose.position - before.0.position;
        let at = |share: f64| Pose {
            position: before.0.position + moved * share,
            heading: angle::wrap(before.0.heading + turned * share),
        };
        let mut found: Vec<(f64, usize)> = Vec::new();
        for index in 0..self.beams.len() {
            if now.has(index) == self.switches.has(index) {
                continue;
            }
            if now.has(index) && self.noise.misses() {
                continue;
            }
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..10 {
                let middle = f64::midpoint(low, high);
                let pose = at(middle);
                let closed = self.closed(self.grid.near(pose.position), pose, index);
                if closed == now.has(index) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            found.push((high, index));
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (share, index) in found {
            let rising = now.has(index);
            self.switches = self.switches.with(index, rising);
            let range = self.chassis.range + if rising { self.chassis.hysteresis } else { 0.0 };
            self.limits[index] = self.chassis.radius + self.noise.range(index, range);
            let between = |a: f64, b: f64| a + (b - a) * share;
            let odometer = Odometer {
                time_us: before.3 + ((self.time_us - before.3) as f64 * share) as u64,
                left_ticks: self.ticks(between(before.1[0], self.wheels[0])),
                right_ticks: self.ticks(between(before.1[1], self.wheels[1])),
                heading: nearest_count(between(before.2 as f64, self.gyro as f64)) as f64 * GYRO,
            };
            self.edges.push_back((Edge { sensor: index, rising, odometer }, at(share)));
        }
    }

    fn ticks(&self, travel: f64) -> i64 {
        (travel / self.chassis.tick).round() as i64
    }
}

impl Hardware for Body {
    fn drive(&mut self, speed: f64, rate: f64) {
        let stands = |speed: f64, rate: f64| speed == 0.0 && rate == 0.0;
        if stands(self.speed, self.rate) && !stands(speed, rate) {
            // A motion begins, with errors of its own.
            self.noise.begin_motion();
            self.scale = self.noise.travel_scale();
        }
        self.speed = speed;
        self.rate = rate;
    }

    fn odometer(&self) -> Odometer {
        Odometer {
            time_us: self.time_us,
            left_ticks: self.ticks(self.wheels[0]),
            right_ticks: self.ticks(self.wheels[1]),
            heading: self.gyro as f64 * GYRO,
        }
    }

    fn switches(&self) -> SwitchSet {
        self.switches
    }

    fn bumper(&self) -> bool {
        self.bumper
    }

    fn take_edge(&mut self) -> Option<Edge> {
        let (edge, pose) = self.edges.pop_front()?;
        self.truth = pose;
        Some(edge)
    }
}

#[cfg(test)]
mod tests;
