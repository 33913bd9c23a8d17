//! Taking the misclosure of a lap out of it, as surveyors do with a closed traverse.
//!
//! The stretch that was driven twice is laid on itself: contacts of the overlap against the walls
//! made by the first contacts. What does not fit is the misclosure. It is spread over the lap by
//! least squares: heading errs by drift and random walk with time, position with distance and with
//! the heading before it (see `survey`); measured better than angles first and Bowditch after.

use super::circuit::Closure;
use super::map::{Misclosure, PathPoint};
use super::odometry::Tracker;
use super::survey::{Step, Survey, Tie};
use super::wall::{Sighting, Stretch};
use crate::geometry::fit::Moments;
use crate::geometry::{Point, Pose, Vector, angle, cross, perp, rotate};
use crate::mapping::map::ContactKind;
use nalgebra::{Matrix3, Vector3};

/// Believed spread of a contact about its wall, metres. Neighbours err together: more than jitter.
const CONTACT_SD: f64 = 0.005;

/// A direction (metres, radians) is seen when it moves a contact off its wall by at least this
/// share of itself, root mean square: above what tangents through few contacts scatter by.
const LEAST_SLOPE: f64 = 0.05;

/// Distance of the starts in a direction that the overlap leaves open, metres.
const OPEN_STEP: f64 = 0.04;

/// What the overlap says of a lap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// How far odometry is off.
    pub misclosure: Misclosure,
    /// Share of the overlap's contacts that fall on walls seen at the beginning once the
    /// misclosure is taken out, 0 to 1, of those (at least half of all) beside which walls were
    /// seen. Low when this is another place that only looks near.
    pub agreement: f64,
    /// Share of all of the overlap's contacts that fall on walls seen at the beginning: what is new
    /// there counts against it.
    pub share: f64,
    /// Contacts of the overlap beside which walls were seen at the beginning: what `agreement` rests
    /// on.
    pub known: usize,
    /// What the overlap alone says: normal matrix and right-hand side of (dx, dy, heading), the
    /// heading turning about `centre`.
    centre: Point,
    normal: Matrix3<f64>,
    right: Vector3<f64>,
    /// Standard deviations of the misclosure in its worse direction (metres) and heading (radians).
    pub sd: (f64, f64),
    /// The same without what wheels and gyro lead to expect.
    pub alone: (f64, f64),
}

impl Overlap {
    /// Tells `survey` that knot `late`, at `at`, lies on the place of knot `early`, a lap before, but
    /// for what the overlap measured.
    pub fn close(&self, survey: &mut Survey, early: &Tie, late: &Tie, at: Point) {
        let arm = perp(self.centre - at);
        let mut moved = Matrix3::identity();
        moved[(0, 2)] = arm.x;
        moved[(1, 2)] = arm.y;
        let about = moved.transpose();
        survey.close(early, late, &(about * self.normal * moved), &(about * self.right));
    }
}

/// How much the pose at the end of the lap is off from the pose at its beginning, measured on the
/// overlap: the contacts after `closure.to` laid on the walls after `closure.from` (iterated closest
/// points, point to line). What the overlap leaves open (a straight wall says nothing of the way
/// along it, an arc nothing of a turn about its centre) is left to what `traverse` expects.
#[must_use]
pub fn measure(closure: &Closure, sightings: &[Sighting], traverse: &Traverse) -> Overlap {
    let range = |s: &&Sighting| s.alive && s.kind == ContactKind::Range;
    let overlap = 0.05 + sightings.last().map_or(0.0, |s| s.travelled) - closure.to.travelled;
    let since = |s: &Sighting| s.travelled - closure.from.travelled;
    let early: Vec<Point> = sightings
        .iter()
        .filter(range)
        .filter(|s| (-0.3..overlap + 0.5).contains(&since(s)))
        .map(|s| s.point)
        .collect();
    let late: Vec<Point> = sightings
        .iter()
        .filter(range)
        .filter(|s| s.travelled > closure.to.travelled)
        .map(|s| s.point)
        .collect();
    let lap = closure.length();
    let centre = closure.to.pose.position;
    let (prior, expected) = traverse.prior();
    let shift = closure.to.pose.position - closure.from.pose.position;
    let turn = angle::wrap(closure.to.pose.heading - closure.from.pose.heading);
    // The robot follows the same wall at about the same gap and heading, so where it is now is one
    // guess of the misclosure; that there is none is the other. The one that fits better counts.
    let starts = [Vector3::new(shift.x, shift.y, 0.0), Vector3::new(shift.x, shift.y, turn)];
    let laid = lay(&early, &late, centre, (prior, expected), &starts);
    Overlap { misclosure: Misclosure { lap, ..laid.misclosure }, ..laid }
}

/// How contacts that came `late` lie on a wall known by `early` points: by how much they are off it,
/// turning about `centre`; what they leave open is left to `prior`, an information matrix with its
/// right-hand side. The best that is found from `starts` counts.
#[must_use]
pub fn lay(
    early: &[Point],
    late: &[Point],
    centre: Point,
    prior: (Matrix3<f64>, Vector3<f64>),
    starts: &[Vector3<f64>],
) -> Overlap {
    let scatter = scatter(early).max(scatter(late));
    let laid = Laid { early, late, centre, prior: prior.0, expected: prior.1, scatter };
    let mut best = laid.closest(Vector3::zeros());
    for start in starts {
        let other = laid.closest(*start);
        if other.agreeing > best.agreeing + late.len() / 20 {
            best = other;
        }
    }
    for start in laid.along_the_open(&best) {
        let other = laid.closest(start);
        if other.agreeing > best.agreeing + late.len() / 20 {
            best = other;
        }
    }
    let Fit { found, agreeing, known, normal, right } = best;
    let misclosure = Misclosure { dx: found.x, dy: found.y, heading: found.z, lap: 0.0 };
    let (sd, alone) = (deviations(normal + prior.0), deviations(normal));
    let judged = known.max(late.len().div_ceil(2)).max(1);
    let agreement = agreeing as f64 / judged as f64;
    let share = agreeing as f64 / late.len().max(1) as f64;
    Overlap { misclosure, agreement, share, known, centre, normal, right, sd, alone }
}

/// Standard deviations of the position in its worse direction (metres) and of the heading (radians)
/// of what is known with this information.
fn deviations(information: Matrix3<f64>) -> (f64, f64) {
    let Some(spread) = information.try_inverse() else { return (f64::INFINITY, f64::INFINITY) };
    let position = spread.fixed_view::<2, 2>(0, 0).symmetric_eigenvalues().max();
    (position.max(0.0).sqrt(), spread[(2, 2)].max(0.0).sqrt())
}

/// How one look was laid on the other.
struct Fit {
    found: Vector3<f64>,
    agreeing: usize,
    /// Contacts beside which there was something to lie on.
    known: usize,
    normal: Matrix3<f64>,
    right: Vector3<f64>,
}

/// Two looks at the same wall.
struct Laid<'a> {
    early: &'a [Point],
    late: &'a [Point],
    centre: Point,
    prior: Matrix3<f64>,
    expected: Vector3<f64>,
    /// Spread of contacts about the wall they are of, metres.
    scatter: f64,
}

impl Laid<'_> {
    /// Starts to either side of a fit in the direction that it left open: a corner farther off than
    /// the search for closest points reaches is found from one of them.
    fn along_the_open(&self, fit: &Fit) -> Vec<Vector3<f64>> {
        let Some(spread) = (fit.normal + self.prior).try_inverse() else { return Vec::new() };
        let eigen = spread.fixed_view::<2, 2>(0, 0).into_owned().symmetric_eigen();
        let worst = eigen.eigenvalues.imax();
        let sd = eigen.eigenvalues[worst].max(0.0).sqrt();
        let direction = eigen.eigenvectors.column(worst).into_owned();
        let steps = (2.5 * sd / OPEN_STEP).min(12.0) as i32;
        (-steps..=steps)
            .filter(|k| *k != 0)
            .map(|k| {
                let by = direction * (f64::from(k) * OPEN_STEP);
                fit.found + Vector3::new(by.x, by.y, 0.0)
            })
            .collect()
    }

    /// The misclosure nearest to `start` that lays the late contacts on the early walls, and how
    /// many of them then agree.
    fn closest(&self, start: Vector3<f64>) -> Fit {
        let mut fit = Fit {
            found: start,
            agreeing: 0,
            known: 0,
            normal: Matrix3::zeros(),
            right: Vector3::zeros(),
        };
        for _ in 0..15 {
            let found = fit.found;
            let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
            let (mut agreeing, mut known) = (0, 0);
            for &point in self.late {
                let arm = rotate(point - self.centre, -found.z);
                let placed = self.centre + arm - Vector::new(found.x, found.y);
                let near = BESIDE.max(3.0 * self.scatter);
                let beside = self.early.iter().any(|p| (p - placed).norm() < near);
                let straight = STRAIGHT.max(1.6 * self.scatter);
                let Some(wall) = stretch_beside(self.early, placed, straight) else {
                    // Ragged wall has no stretch to lie on; a contact where one was agrees too.
                    agreeing += usize::from(beside);
                    known += usize::from(beside);
                    continue;
                };
                known += 1;
                let across = perp(wall.along);
                let row = Vector3::new(across.x, across.y, across.dot(&perp(arm)));
                let off = across.dot(&(placed - wall.at));
                agreeing += usize::from(beside || off.abs() < ON_IT.max(2.5 * self.scatter));
                // Huber's weight: a contact that belongs to another wall must not pull.
                let weight = (2.0 / (off / CONTACT_SD).abs().max(2.0)) / CONTACT_SD.powi(2);
                normal += row * row.transpose() * weight;
                right += row * ((off + row.dot(&found)) * weight);
            }
            (normal, right) = well_seen(&normal, &right, known);
            (fit.normal, fit.right) = (normal, right);
            (fit.agreeing, fit.known) = (agreeing, known);
            let Some(solution) = (normal + self.prior).lu().solve(&(right + self.expected)) else {
                break;
            };
            let change = (solution - found).norm();
            fit.found = solution;
            if change < 1e-5 {
                break;
            }
        }
        fit
    }
}

/// The same equations without the directions that `count` contacts hardly speak of. Along a straight
/// wall, or about the centre of an arc, nothing but the scatter of the tangents is left, and that
/// must not outvote what the gyro and the wheels are known to keep to.
fn well_seen(
    normal: &Matrix3<f64>,
    right: &Vector3<f64>,
    count: usize,
) -> (Matrix3<f64>, Vector3<f64>) {
    let least = LEAST_SLOPE.powi(2) * count as f64 / CONTACT_SD.powi(2);
    let eigen = normal.symmetric_eigen();
    let (mut seen, mut told) = (Matrix3::zeros(), Vector3::zeros());
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > least {
            seen += vector * vector.transpose() * *value;
            told += vector * vector.dot(right);
        }
    }
    (seen, told)
}

/// How far contacts scatter about their walls, metres: the lower quartile of what short stretches do,
/// since corners and ragged walls are no scatter.
fn scatter(points: &[Point]) -> f64 {
    const STRETCH: usize = 6;
    let stretches = points.windows(STRETCH).filter_map(Stretch::through);
    let mut residuals: Vec<f64> = stretches.map(|stretch| stretch.residual).collect();
    residuals.sort_by(f64::total_cmp);
    residuals.get(residuals.len() / 4).map_or(0.0, |residual| residual.min(MOST_SCATTER))
}

/// The straight stretch of early wall on which `point` lies: through its neighbours, as near as
/// there are enough of them.
fn stretch_beside(walls: &[Point], point: Point, tolerance: f64) -> Option<Stretch> {
    NEIGHBOURS.iter().find_map(|reach| {
        let near: Vec<Point> =
            walls.iter().copied().filter(|p| (p - point).norm() < *reach).collect();
        if near.len() < 4 {
            return None;
        }
        let straight = Stretch::through(&near)?;
        let local =
            if straight.residual < tolerance { straight } else { bent(&near, point, tolerance)? };
        let along = |p: Point| local.along.dot(&(p - local.at));
        let (low, high) =
            near.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &p| {
                (low.min(along(p)), high.max(along(p)))
            });
        // Beyond what was seen the wall may do anything.
        let within = (low - 0.015..=high + 0.015).contains(&along(point));
        (within && high - low > 0.05).then_some(local)
    })
}

/// The tangent, nearest to `point`, of the circle through `near`; none when they lie on none.
fn bent(near: &[Point], point: Point, tolerance: f64) -> Option<Stretch> {
    let circle = Moments::of(near).circle()?;
    let off = |p: &Point| (p - circle.center).norm() - circle.radius;
    let count = near.len() as f64;
    let residual = (near.iter().map(|p| off(p).powi(2)).sum::<f64>() / count).sqrt();
    let outward = (point - circle.center).try_normalize(1e-9)?;
    let on_circle = near.len() >= 5 && residual < tolerance && circle.radius > 0.3;
    on_circle.then(|| Stretch {
        at: circle.center + outward * circle.radius,
        along: perp(outward),
        residual,
    })
}

/// Contacts that lie this close about a line or circle are one wall, metres; more when they scatter.
const STRAIGHT: f64 = 0.003;
/// A contact this near to another, or to a wall, is of it, metres; likewise.
const BESIDE: f64 = 0.012;
const ON_IT: f64 = 0.008;
/// Contacts of one wall scatter no more than this about it, metres: what does is ragged.
const MOST_SCATTER: f64 = 0.006;
/// How far around a contact its wall is looked for, metres: sparse on long straight walls.
const NEIGHBOURS: [f64; 4] = [0.1, 0.25, 0.5, 1.0];

/// What the wheels add on a lap of many short moves, metres per root metre.
const WHEEL_SD: f64 = 0.003;
/// Knots of a lap at most.
const MOST_KNOTS: f64 = 90.0;
/// No knots are nearer to each other along the path, metres.
const LEAST_SPACING: f64 = 0.25;

/// The lap as an open traverse: its errors as they are to be expected before it is closed.
#[derive(Debug, Clone)]
pub struct Traverse {
    survey: Survey,
    ends: Option<(Tie, Tie)>,
}

impl Traverse {
    /// The lap `closure` of what `tracker` drove; errors count from `since_us` (robot time) on.
    #[must_use]
    pub fn new(tracker: &Tracker, closure: &Closure, since_us: u64) -> Self {
        Self::along(tracker.path(), tracker.resolution(), closure, since_us)
    }

    /// The same of a `path` driven on wheels of which one tick turns the robot by `resolution`
    /// radians.
    #[must_use]
    pub fn along(path: &[PathPoint], resolution: f64, closure: &Closure, since_us: u64) -> Self {
        let blank = Survey::new(resolution);
        let once = Self::over(blank.clone(), path, closure, since_us);
        // Now that it is known how the wheels hold the floor, the first metres are weighed again.
        Self::over(blank.on_the_floor_of(&once.survey), path, closure, since_us)
    }

    fn over(mut survey: Survey, path: &[PathPoint], closure: &Closure, since_us: u64) -> Self {
        survey.unwound(closure.drift);
        let begin = path.partition_point(|point| point.time_us < since_us).saturating_sub(1);
        let path = &path[begin.min(path.len())..];
        let length: f64 =
            path.windows(2).map(|w| (w[1].pose.position - w[0].pose.position).norm()).sum();
        let spacing = (length / MOST_KNOTS).max(LEAST_SPACING);
        let (mut since_knot, mut from, mut to) = (f64::INFINITY, None, None);
        for (k, point) in path.iter().enumerate() {
            if let Some(before) = k.checked_sub(1).map(|j| path[j]) {
                let rested = point.rested_us.saturating_sub(before.rested_us);
                let passed = point.time_us.saturating_sub(before.time_us);
                let seconds = passed.saturating_sub(rested) as f64 * 1e-6;
                let step = Step {
                    from: before.pose,
                    to: point.pose,
                    seconds,
                    spun: (before.spun, point.spun),
                };
                survey.predict(&step, WHEEL_SD);
                since_knot += (point.pose.position - before.pose.position).norm();
            }
            let is_from = from.is_none() && point.time_us >= closure.from.time_us;
            let is_to = to.is_none() && point.time_us >= closure.to.time_us;
            if is_from || is_to || since_knot > spacing {
                let tie = survey.mark(point.pose.position, point.time_us);
                since_knot = 0.0;
                from = from.or(is_from.then_some(tie));
                to = to.or(is_to.then_some(tie));
            }
        }
        Self { survey, ends: from.zip(to) }
    }

    /// Information (inverse covariance) on the misclosure (dx, dy, heading) before any overlap, and
    /// that times the misclosure that is expected.
    fn prior(&self) -> (Matrix3<f64>, Vector3<f64>) {
        let Some((from, to)) = self.ends else { return (Matrix3::zeros(), Vector3::zeros()) };
        let floor = Matrix3::from_diagonal(&Vector3::new(1e-6, 1e-6, 1e-6));
        let spread = self.survey.relative(&from, &to) + floor;
        let information = spread.try_inverse().unwrap_or_else(Matrix3::zeros);
        (information, information * self.survey.misclosure(&from, &to))
    }
}

/// How the trajectory moves when the misclosure is taken out.
#[derive(Debug, Clone)]
pub struct Adjustment {
    survey: Survey,
}

impl Adjustment {
    /// Takes what `overlap` measured out of the lap `closure` of what `tracker` drove; the part since
    /// `since_us` (robot time) is adjusted. What lies before that stays, what lies after the lap
    /// moves with its end.
    #[must_use]
    pub fn new(tracker: &Tracker, closure: &Closure, overlap: &Overlap, since_us: u64) -> Self {
        let Traverse { mut survey, ends } = Traverse::new(tracker, closure, since_us);
        if let Some((from, to)) = ends {
            overlap.close(&mut survey, &from, &to, closure.to.pose.position);
        }
        Self { survey }
    }

    /// The survey after the adjustment; its knots are the lap's.
    #[must_use]
    pub fn into_survey(self) -> Survey {
        self.survey
    }

    fn tie(&self, time_us: u64) -> Tie {
        self.survey.tie(time_us, self.survey.knots())
    }

    /// Where a point goes that was tied to the raw trajectory at `time_us`.
    #[must_use]
    pub fn place(&self, point: Point, time_us: u64) -> Point {
        point + self.survey.displacement(point, &self.tie(time_us))
    }

    /// Where a pose goes that was tied to the raw trajectory at `time_us`.
    #[must_use]
    pub fn pose(&self, pose: Pose, time_us: u64) -> Pose {
        self.survey.place(pose, &self.tie(time_us))
    }
}

/// Signed distance of `point` from the line of `wall`, positive to its left.
#[must_use]
pub fn offset(wall: &Stretch, point: Point) -> f64 {
    cross(wall.along, point - wall.at)
}
