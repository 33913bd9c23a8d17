//! The observation equations: what each reading says of the unknowns, and how surely.

use super::Given;
use super::chain::{Equation, Normal, STATE};
use super::datum::{Datum, Place};
use super::dither::Passed;
use super::record::{Glance, Motion, Rest};
use super::surface::{Surfaces, UNKNOWNS};
use crate::geometry::{Pose, Vector, angle, perp};
use crate::mapping::survey::{
    ALONG, ASIDE, HEADING_WALK, SCALE_SD, STRIDE_SHARE, SystematicErrors, TRACK_SD, TURN_SHARE,
};
use nalgebra::{DVector, SVector};

/// Unknowns of the robot itself: the gyro's drift (radians per second) and the share by which it turns too
/// far, what the wheels turn where it goes straight (radians per metre), and the share by which they do
/// in a turn.
pub(super) const OWN: usize = 4;
const BIAS: usize = 0;
const SCALE: usize = 1;
const WHEELS: usize = 2;
const TRACK: usize = 3;

/// Before anything is read: a worn gyro drifts by 60 degrees an hour.
const BIAS_SD: f64 = 3.0e-4;
/// Wheels 5 % apart.
const WHEELS_SD: f64 = 0.3;
/// What a switch may reach farther or less far than it should, metres: worn ones are off by a tenth. What all
/// of them are off by together no room tells, and stays at nothing.
const REACH_SD: f64 = 0.004;
/// How surely the start is known, metres and radians: it is where the map begins.
const START_SD: f64 = 1e-6;
/// A turn on the spot may move the robot by this, metres, ...
const ON_THE_SPOT: f64 = 3e-4;
/// ... something that it runs into by this, metres and radians.
const HELD_UP: (f64, f64) = (0.01, 0.01);
/// So many motions in a row are a stretch of the way.
const STRETCH: usize = 10;
/// No reading of gyro or wheels is better than this, radians.
const FINEST: f64 = 2e-5;
/// A surface may lie anywhere, metres and radians: what is not touched must not make the equations
/// unsolvable.
const SURFACE_SD: f64 = 0.5;
/// A contact that is off its surface by more than this counts for less, in standard deviations (Huber),
/// and by more than this not at all.
const DOUBTED: f64 = 2.0;
const REFUSED: f64 = 5.0;

type State = SVector<f64, STATE>;

/// What the wheels turned, of the unknowns of a rest: its place, its heading, and that.
const WHEELS_TURN: State = State::new(0.0, 0.0, 0.0, 1.0);

/// What is to be found.
pub(super) struct Unknowns {
    pub(super) poses: Vec<Pose>,
    /// What the wheels turned until each rest, without the rounding to ticks, radians.
    wheels: Vec<f64>,
    own: [f64; OWN],
    /// By how much each switch reaches farther than it should, metres.
    reach: Vec<f64>,
}

impl Unknowns {
    /// The unknowns as they are believed: at `poses` when the robot rested.
    pub(super) fn new(rests: &[Rest], poses: &[Pose], bias: f64, switches: usize) -> Self {
        let wheels = rests.iter().map(|rest| rest.reading.against).collect();
        Self {
            poses: poses.to_vec(),
            wheels,
            own: [bias, 0.0, 0.0, 0.0],
            reach: vec![0.0; switches],
        }
    }

    pub(super) fn take(&mut self, change: &[State], border: &DVector<f64>) {
        for ((pose, wheels), by) in self.poses.iter_mut().zip(&mut self.wheels).zip(change) {
            pose.position += Vector::new(by[0], by[1]);
            pose.heading += by[2];
            *wheels += by[3];
        }
        for (own, by) in self.own.iter_mut().chain(&mut self.reach).zip(border.iter()) {
            *own += by;
        }
    }

    /// By how much the robot turned on the motion after rest `k`, which read `motion`, radians.
    fn turned(&self, k: usize, motion: &Motion) -> f64 {
        let told = motion.turned;
        told + angle::wrap(self.poses[k + 1].heading - self.poses[k].heading - told)
    }

    /// What the robot itself does wrong.
    pub(super) fn errors(&self) -> SystematicErrors {
        let [drift, scale, wheels, track] = self.own;
        SystematicErrors { drift, scale, wheels, track }
    }

    /// How many contacts lie on their surfaces, and how well, in standard deviations, root mean square.
    pub(super) fn misfit(&self, read: &Read<'_>, surfaces: &Surfaces) -> (usize, f64) {
        let (mut count, mut sum) = (0, 0.0);
        for (glance, surface) in read.glances.iter().zip(&surfaces.of) {
            let Some(surface) = *surface else { continue };
            let Some(share) = glance.reading.share(read.rests) else { continue };
            let pose = share.among(&self.poses);
            let arm = glance.arm + glance.towards() * self.reach[glance.sensor];
            let point = pose.position + pose.rotate(arm);
            let doubt = surfaces.all[surface].off(point).0 / surfaces.sd[surface];
            if doubt.abs() < REFUSED {
                count += 1;
                sum += doubt * doubt;
            }
        }
        (count, (sum / f64::from(count.max(1) as u32)).sqrt())
    }
}

/// By how much the way of one motion is off in one direction.
struct Way {
    /// Unit vector.
    axis: Vector,
    /// How that grows with the headings before and after, metres a radian.
    lever: f64,
    /// Metres, and square metres.
    off: f64,
    variance: f64,
}

/// What the robot read.
pub(super) struct Read<'a> {
    pub(super) rests: &'a [Rest],
    /// What was read between rests.
    pub(super) passed: &'a [Passed],
    pub(super) glances: &'a [Glance],
}

/// How surely the readings of this robot are to be taken.
pub(super) struct Robot {
    start: Pose,
    switches: usize,
    stretch: f64,
    /// Variance of the wheels' turn by rounding to ticks, square radians.
    rounding: f64,
    wander: f64,
    walk: f64,
    /// The drift that a robot at rest has seen, and its variance.
    rested: Option<(f64, f64)>,
}

impl Robot {
    pub(super) fn new(given: &Given<'_>, start: Pose) -> Self {
        let (wander, share) = given.grip;
        let walk = HEADING_WALK * HEADING_WALK * share;
        let (seconds, crept) = given.held;
        Self {
            start,
            switches: given.beams.len(),
            stretch: given.stretch,
            rounding: given.resolution * given.resolution / 6.0,
            wander,
            walk,
            rested: (seconds > 1.0).then(|| (crept / seconds, walk / seconds)),
        }
    }

    /// Where the unknowns of the surfaces begin in the border: after the robot's own and its switches'.
    pub(super) fn surfaces(&self) -> usize {
        OWN + self.switches
    }

    /// The normal equations about `at`. In the first round, when `rough`, no contact is refused.
    pub(super) fn equations(
        &self,
        read: &Read<'_>,
        at: &Unknowns,
        surfaces: &Surfaces,
        rough: bool,
    ) -> Normal {
        let Read { rests, passed, glances } = *read;
        let mut normal = Normal::new(rests.len(), self.surfaces() + UNKNOWNS * surfaces.all.len());
        self.priors(at, surfaces, &mut normal);
        for (k, pair) in rests.windows(2).enumerate() {
            let motion = pair[1].reading.since(&pair[0].reading);
            self.turned(k, &motion, at, &mut normal);
            self.went(k, &motion, pair[1].held_up, at, &mut normal);
            let read = Equation::of(at.wheels[k + 1] - pair[1].reading.against, self.rounding);
            normal.add(&read.node(k + 1, WHEELS_TURN));
        }
        for apart in surfaces.apart(self.surfaces()) {
            normal.add(&apart);
        }
        for it in passed {
            normal.add(&self.passed(it, rests, at));
        }
        for (glance, surface) in glances.iter().zip(&surfaces.of) {
            let Some(surface) = *surface else { continue };
            if let Some(seen) = self.seen(glance, surface, rests, at, surfaces, rough) {
                normal.add(&seen);
            }
        }
        normal
    }

    /// What the errors of all that was adjusted have in common.
    pub(super) fn datum(
        &self,
        read: &Read<'_>,
        at: &Unknowns,
        surfaces: &Surfaces,
    ) -> Option<Datum> {
        let sure = self.equations(read, at, surfaces, false).sureness()?;
        let place = |(glance, surface): (&Glance, &Option<usize>)| {
            let pose = glance.reading.share(read.rests)?.among(&at.poses);
            Some(Place { surface: (*surface)?, at: pose.position + pose.rotate(glance.arm) })
        };
        let places: Vec<Place> = read.glances.iter().zip(&surfaces.of).filter_map(place).collect();
        Datum::of(surfaces, &places, &sure, self.surfaces())
    }

    fn priors(&self, at: &Unknowns, surfaces: &Surfaces, normal: &mut Normal) {
        let (here, variance) = (at.poses[0], START_SD * START_SD);
        let off = here.position - self.start.position;
        let turn = angle::wrap(here.heading - self.start.heading);
        for (row, off) in [off.x, off.y, turn].into_iter().enumerate() {
            let mut unit = State::zeros();
            unit[row] = 1.0;
            normal.add(&Equation::of(off, variance).node(0, unit));
        }
        normal.add(&Equation::of(0.0, self.rounding).node(0, WHEELS_TURN));
        let own = [(BIAS, BIAS_SD), (SCALE, SCALE_SD), (WHEELS, WHEELS_SD), (TRACK, TRACK_SD)];
        for (row, sd) in own {
            normal.add(&Equation::of(at.own[row], sd * sd).border(row, 1.0));
        }
        for (switch, reach) in at.reach.iter().enumerate() {
            normal.add(&Equation::of(*reach, REACH_SD * REACH_SD).border(OWN + switch, 1.0));
        }
        if let Some((drift, variance)) = self.rested {
            normal.add(&Equation::of(at.own[BIAS] - drift, variance).border(BIAS, 1.0));
        }
        for row in self.surfaces()..self.surfaces() + UNKNOWNS * surfaces.all.len() {
            normal.add(&Equation::of(0.0, SURFACE_SD * SURFACE_SD).border(row, 1.0));
        }
    }

    /// How much worse than it should the worst stretch of the way agrees with what gyro and wheels told of it: mean
    /// square, in variances, of so many motions in a row. About a half where the robot drove all of it, and several
    /// where somebody pushed it: what neither told is laid on the motions about that.
    pub(super) fn strain(&self, read: &Read<'_>, at: &Unknowns) -> f64 {
        let motions = read.rests.windows(2).enumerate().map(|(k, pair)| {
            let motion = pair[1].reading.since(&pair[0].reading);
            let gyro = self.gyro(&motion, at.turned(k, &motion), at);
            let ways =
                self.ways(k, &motion, pair[1].held_up, at).map(|way| (way.off, way.variance));
            let squares =
                [gyro].into_iter().chain(ways).map(|(off, variance)| off * off / variance);
            squares.sum::<f64>() / 3.0
        });
        let squares: Vec<f64> = motions.collect();
        let mean = |stretch: &[f64]| stretch.iter().sum::<f64>() / stretch.len() as f64;
        squares.windows(STRETCH.min(squares.len().max(1))).map(mean).fold(0.0, f64::max)
    }

    /// By how much the gyro is off where the robot turned by `real`, and the variance of that: real = told - drift -
    /// scale.
    fn gyro(&self, motion: &Motion, real: f64, at: &Unknowns) -> (f64, f64) {
        let [bias, scale, ..] = at.own;
        let off = real * (1.0 + scale) + bias * motion.active - motion.turned;
        (off, self.walk * motion.active + FINEST * FINEST)
    }

    /// What gyro and wheels say of a turn.
    fn turned(&self, k: usize, motion: &Motion, at: &Unknowns, normal: &mut Normal) {
        let [_, scale, wheels, track] = at.own;
        let real = at.turned(k, motion);
        let ahead = motion.ahead * self.stretch;
        let heading = State::new(0.0, 0.0, 1.0, 0.0);
        let (off, variance) = self.gyro(motion, real, at);
        normal.add(
            &Equation::of(off, variance)
                .node(k, heading * -(1.0 + scale))
                .node(k + 1, heading * (1.0 + scale))
                .border(BIAS, motion.active)
                .border(SCALE, real),
        );
        // By the wheels.
        let off = at.wheels[k + 1] - at.wheels[k] - real * (1.0 + track) - wheels * ahead;
        let scrub = TURN_SHARE * real;
        let variance = self.wander * ahead.abs() + scrub * scrub + FINEST * FINEST;
        let turn = State::new(0.0, 0.0, 1.0 + track, -1.0);
        normal.add(
            &Equation::of(off, variance)
                .node(k, turn)
                .node(k + 1, -turn)
                .border(WHEELS, -ahead)
                .border(TRACK, -real),
        );
    }

    /// What the wheels read on a straight drive, where what they turn grows with the way. At its ends alone
    /// they tell the turn no better than to a tick; each reading on the way is rounded by itself, so that
    /// what they had turned at the ends is known better by many.
    fn passed(&self, it: &Passed, rests: &[Rest], at: &Unknowns) -> Equation {
        let Passed { reading, share, weight } = it;
        let (from, to) = (share.from, share.from + 1);
        let motion = rests[to].reading.since(&rests[from].reading);
        let (before, after) = (1.0 - share.way, share.way);
        let told = before * at.wheels[from] + after * at.wheels[to];
        // The heading is held by the gyro and wanders with it.
        let wander = self.walk * motion.active * before * after;
        let read = Equation::of(told - reading.against, self.rounding / weight + wander);
        read.node(from, WHEELS_TURN * before).node(to, WHEELS_TURN * after)
    }

    /// By how much the way is off what the wheels told of it: along and across.
    fn ways(&self, k: usize, motion: &Motion, held_up: bool, at: &Unknowns) -> [Way; 2] {
        let (a, b) = (&at.poses[k], &at.poses[k + 1]);
        let ahead = motion.ahead * self.stretch;
        let along = angle::unit(a.heading + at.turned(k, motion) / 2.0);
        let (across, moved) = (perp(along), b.position - a.position);
        let least = ON_THE_SPOT * ON_THE_SPOT;
        let bumped = if held_up { HELD_UP.0 * HELD_UP.0 } else { 0.0 };
        let length = ahead.abs();
        let stride = STRIDE_SHARE * ahead;
        [
            (along, along.dot(&moved) - ahead, stride * stride + ALONG * ALONG * length),
            (across, across.dot(&moved), ASIDE * ASIDE * length),
        ]
        .map(|(axis, off, share)| {
            // The way turns with the heading in its middle.
            let lever = perp(axis).dot(&moved) / 2.0;
            Way { axis, lever, off, variance: share + least + bumped }
        })
    }

    /// What the wheels say of the way.
    fn went(&self, k: usize, motion: &Motion, held_up: bool, at: &Unknowns, normal: &mut Normal) {
        for Way { axis, lever, off, variance } in self.ways(k, motion, held_up, at) {
            let of = |sign: f64| State::new(sign * axis.x, sign * axis.y, lever, 0.0);
            let equation = Equation::of(off, variance);
            normal.add(&equation.node(k, of(-1.0)).node(k + 1, of(1.0)));
        }
    }

    /// What a contact says; nothing when it cannot be of that surface.
    fn seen(
        &self,
        glance: &Glance,
        surface: usize,
        rests: &[Rest],
        at: &Unknowns,
        surfaces: &Surfaces,
        rough: bool,
    ) -> Option<Equation> {
        let share = glance.reading.share(rests)?;
        let (from, to) = (share.from, share.from + 1);
        let pose = share.among(&at.poses);
        let towards = pose.rotate(glance.towards());
        let arm = pose.rotate(glance.arm) + towards * at.reach[glance.sensor];
        let (off, across, follows) = surfaces.all[surface].off(pose.position + arm);
        let sd = surfaces.sd[surface];
        let doubt = off.abs() / sd;
        if !rough && doubt > REFUSED {
            return None;
        }
        let lever = across.dot(&perp(arm));
        let of =
            |way: f64, time: f64| State::new(way * across.x, way * across.y, time * lever, 0.0);
        let variance = sd * sd * (doubt / DOUBTED).max(1.0);
        let mut equation = Equation::of(off, variance)
            .node(from, of(1.0 - share.way, 1.0 - share.time))
            .node(to, of(share.way, share.time))
            .border(OWN + glance.sensor, across.dot(&towards));
        for (k, by) in follows.into_iter().enumerate() {
            equation = equation.border(self.surfaces() + UNKNOWNS * surface + k, -by);
        }
        Some(equation)
    }
}
