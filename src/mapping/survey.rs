//! What is believed of the errors of the whole survey: the robot's pose, the lap, the objects.
//!
//! A traverse of a room by wheels and gyro is off everywhere, and off together: where one wall is
//! wrong its neighbours are wrong with it. This filter keeps the errors of the pose and of places
//! along the way (knots) in one covariance. Driving makes the pose less certain; marking a knot
//! copies its error; laying the end of a lap on its beginning ties the two; a touch of a mapped
//! surface ties the pose to the knots that this surface was seen from, and corrects both. So every
//! line that is driven across the room sharpens the walls at its ends, and drift does not grow.
//!
//! It is the extended Kalman filter for simultaneous localisation and mapping (Smith, Self,
//! Cheeseman 1990) with past poses as landmarks (stochastic cloning, Roumeliotis and Burdick 2002),
//! on small corrections to a nominal survey: linear but for the residuals.

mod balance;
mod covariance;
mod knots;
mod motion;
mod sight;
mod sureness;
#[cfg(test)]
mod tests;

pub use balance::{Step, TURN_SHARE};
pub use knots::Hung;
pub use motion::{ALONG, ASIDE, HEADING_WALK, STRIDE_SHARE};
pub use sight::{Look, Surface};
pub use sureness::worse;

use super::calibration::Measured;
use crate::geometry::{Point, Pose, Vector, angle, perp};
use balance::{Balance, Grip};
use covariance::Covariance;
use nalgebra::{DVector, Matrix3, SMatrix, Vector3};

/// What the gyro's drift may be before anything is known of it, radians per second (30 degrees an
/// hour).
const BIAS_SD: f64 = 1.5e-4;
/// What the gyro's scale may be off by: within half a percent, out of the box.
pub const SCALE_SD: f64 = 3.0e-3;
/// How far from a surface a contact may lie and still be of it, in standard deviations.
const GATE: f64 = 3.5;

/// What the wheels may turn by where the robot goes straight, before anything is known of them, radians
/// per metre: even one that stands still is to be found out.
const WHEELS_SD: f64 = 10.0;

/// What a turn by the wheels may be off by, as a share of it: wheel base, size of the wheels.
pub const TRACK_SD: f64 = 0.01;

/// Rows of the pose, of the gyro's drift and scale, of what the wheels turn by when they should go
/// straight (per metre), of the share by which they turn too much, and of what all these, and
/// chance, made the wheels turn more than the gyro since the beginning.
const POSE: usize = 0;
const BIAS: usize = 3;
const SCALE: usize = 4;
const WHEELS: usize = 5;
const TRACK: usize = 6;
const AGAINST: usize = 7;
const FIRST_KNOT: usize = 8;

/// A matrix of the rows before the knots'.
type Head = SMatrix<f64, FIRST_KNOT, FIRST_KNOT>;

/// A place of the survey whose error is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot {
    /// Where it was believed to be when it was marked.
    at: Point,
    time_us: u64,
}

/// What a mapped point hangs on: one knot, or two with the second's share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tie {
    first: usize,
    second: usize,
    share: f64,
}

impl Tie {
    /// The knots that it hangs on.
    #[must_use]
    pub fn knots(&self) -> [usize; 2] {
        [self.first, self.second]
    }
}

/// What the robot itself does wrong: what has to be taken off what gyro and wheels say. Figures, or [`Measured`]
/// ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SystematicErrors<T = f64> {
    /// What the gyro drifts, radians per second, beyond what was taken out already.
    pub drift: T,
    /// By which share of each turn that it tells the gyro tells too much.
    pub scale: T,
    /// What the wheels turn by their own account where the robot goes straight, radians per metre.
    pub wheels: T,
    /// By which share of each turn that they tell the wheels tell too much.
    pub track: T,
}

/// The filter.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    knots: Vec<Knot>,
    /// Corrections to the nominal survey: of the pose only what was not yet handed out.
    mean: DVector<f64>,
    covariance: Covariance,
    balance: Balance,
    /// It was told that smooth walls are smooth.
    smoothed: bool,
    /// Learnt on straight drives alone: in turns it is the turns that wheels and gyro differ by, and what that
    /// should come to is known too little to say anything of the gyro.
    grip: Grip,
    /// Turn of the wheels for one tick of one of them, radians.
    resolution: f64,
}

impl Survey {
    /// Nothing surveyed yet by a robot that the wheels turn by `resolution` radians for one tick of
    /// one of them.
    #[must_use]
    pub fn new(resolution: f64) -> Self {
        let mut variances = [0.0; FIRST_KNOT];
        variances[BIAS] = BIAS_SD * BIAS_SD;
        variances[SCALE] = SCALE_SD * SCALE_SD;
        variances[WHEELS] = WHEELS_SD * WHEELS_SD;
        variances[TRACK] = TRACK_SD * TRACK_SD;
        Self {
            knots: Vec::new(),
            mean: DVector::zeros(FIRST_KNOT),
            covariance: Covariance::new(&variances),
            balance: Balance::default(),
            smoothed: false,
            grip: Grip::default(),
            resolution,
        }
    }

    /// Nothing surveyed yet by the same robot, on a floor of which this one has learnt how the wheels hold
    /// it.
    #[must_use]
    pub fn blank_on_this_floor(&self) -> Self {
        Self { grip: self.grip, ..Self::new(self.resolution) }
    }

    /// The way was put right by a drift of `rate` (radians per second) that is only a guess: as likely
    /// as before is that the gyro does not drift at all.
    pub fn unwound(&mut self, rate: f64) {
        self.mean[BIAS] = rate;
    }

    /// All lengths are `stretch` times what they were believed to be, `about` staying where it is.
    /// What is known of the errors is as good as it was: a taped length corrects what no closure sees.
    pub fn stretch(&mut self, stretch: f64, about: Point) {
        for knot in &mut self.knots {
            knot.at = about + (knot.at - about) * stretch;
        }
        self.mean[WHEELS] /= stretch;
    }

    /// By how much the wheels turn, by their own account, where the gyro goes straight: radians per
    /// metre.
    #[must_use]
    pub fn lopsided(&self) -> f64 {
        self.mean[WHEELS]
    }

    /// The robot errs as came out when all was adjusted at once, its drift apart: that is known from what the filter
    /// learnt too, and from all that it could not go back to. It is no surer of it than it was.
    pub fn errs(&mut self, errors: &SystematicErrors) {
        // The filter knows what has to be added.
        for (row, fault) in [(SCALE, errors.scale), (WHEELS, errors.wheels), (TRACK, errors.track)]
        {
            self.mean[row] = -fault;
        }
        self.mean[BIAS] = 0.0;
    }

    /// What it believes of the robot itself.
    #[must_use]
    pub fn of_the_robot(&self) -> SystematicErrors<Measured> {
        // The filter knows what has to be added.
        let of = |row: usize| Measured {
            value: -self.mean[row],
            sd: self.covariance.of(row, row).max(0.0).sqrt(),
        };
        SystematicErrors { drift: of(BIAS), scale: of(SCALE), wheels: of(WHEELS), track: of(TRACK) }
    }

    /// How the wheels hold this floor and how still the gyro is, by the straight drives: variance of the
    /// wheels' heading, square radians per metre, and that of the gyro's walk as a share of what its
    /// datasheet says.
    #[must_use]
    pub fn grip(&self) -> (f64, f64) {
        (self.grip.wander(), self.grip.walk())
    }

    /// Whether it was told already that smooth walls are smooth.
    #[must_use]
    pub fn is_smoothed(&self) -> bool {
        self.smoothed
    }

    /// It was told that now.
    pub fn smoothed(&mut self) {
        self.smoothed = true;
    }

    /// Rows of (x, y, heading) of what knot `late` is off from where knot `early` puts it.
    fn relation(&self, early: &Tie, late: &Tie) -> [Vec<(usize, f64)>; 3] {
        let (a, b) = (FIRST_KNOT + 3 * early.first, FIRST_KNOT + 3 * late.first);
        let lever = perp(self.knots[late.first].at - self.knots[early.first].at);
        [
            vec![(b, 1.0), (a, -1.0), (a + 2, -lever.x)],
            vec![(b + 1, 1.0), (a + 1, -1.0), (a + 2, -lever.y)],
            vec![(b + 2, 1.0), (a + 2, -1.0)],
        ]
    }

    /// Covariance of the error of knot `late` relative to knot `early`: x, y in metres, heading in
    /// radians.
    #[must_use]
    pub fn relative(&self, early: &Tie, late: &Tie) -> Matrix3<f64> {
        let rows = self.relation(early, late);
        Matrix3::from_fn(|i, j| {
            let terms = rows[i].iter().flat_map(|(k, v)| {
                rows[j].iter().map(move |(l, w)| self.covariance.of(*k, *l) * v * w)
            });
            terms.sum()
        })
    }

    /// The misclosure (dx, dy, heading) between two knots that what is known so far leads to expect.
    #[must_use]
    pub fn misclosure(&self, early: &Tie, late: &Tie) -> Vector3<f64> {
        let rows = self.relation(early, late);
        Vector3::from_fn(|k, _| -self.expected(&rows[k]))
    }

    /// Hands out the correction of the pose that has come together.
    pub fn take_pose(&mut self, pose: Pose) -> Pose {
        let change = Vector::new(self.mean[0], self.mean[1]);
        let corrected = Pose {
            position: pose.position + change,
            heading: angle::wrap(pose.heading + self.mean[2]),
        };
        for row in 0..3 {
            self.mean[row] = 0.0;
        }
        corrected
    }

    /// The gyro's drift, radians per second, beyond what was taken out before; hands it out.
    pub fn take_bias(&mut self) -> f64 {
        std::mem::replace(&mut self.mean[BIAS], 0.0)
    }

    /// The robot's gyro was started anew: its drift may be another one now.
    pub fn started_anew(&mut self) {
        *self.covariance.head(BIAS, BIAS) += BIAS_SD * BIAS_SD;
    }

    /// The robot was lost and is found at `at`, beside what hangs on `tie`: its pose errs with that,
    /// and by `sd` more (metres, radians), whatever it was off by before.
    pub fn found(&mut self, at: Point, tie: &Tie, sd: (f64, f64)) {
        self.covariance.take_place(&self.hanging(at, tie));
        for (k, sd) in [sd.0, sd.0, sd.1].into_iter().enumerate() {
            *self.covariance.head(POSE + k, POSE + k) += sd * sd;
            self.mean[POSE + k] = 0.0;
        }
    }

    /// What the corrections so far make of a row.
    fn expected(&self, row: &[(usize, f64)]) -> f64 {
        row.iter().map(|(i, w)| self.mean[*i] * w).sum()
    }

    /// The sum `row` of errors was measured, `innovation` off what was expected, with `variance`.
    fn update(&mut self, row: &[(usize, f64)], innovation: f64, variance: f64) {
        self.covariance.settle();
        let common = self.covariance.with(row);
        let spread = row.iter().map(|(i, w)| common[*i] * w).sum::<f64>() + variance;
        self.mean.axpy(innovation / spread, &common, 1.0);
        self.covariance.measured(&common, spread);
    }
}
