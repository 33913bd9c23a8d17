//! How one look at a wall lies on another: contacts that came late, laid on those that came first, or
//! on an outline, as closely as they will go (iterated closest points, point to line). What does not
//! fit is by how much the pose was off between the two. It refuses to know of laps, and of when what was
//! seen; what a contact lies on is `look`'s.

mod look;

pub use look::Seen;

use super::map::Misclosure;
use super::survey::{Survey, Tie};
use crate::geometry::{Point, Vector, perp, rotate};
use look::{CONTACT_SD, Look, scatter, variance};
use nalgebra::{Matrix3, Vector3};

/// A direction (metres, radians) is seen when it moves a contact off its wall by at least this
/// share of itself, root mean square: above what tangents through few contacts scatter by.
const LEAST_SLOPE: f64 = 0.05;

/// Distance of the starts in a direction that the overlap leaves open, metres.
const OPEN_STEP: f64 = 0.04;
/// Starts to either side at most.
const MOST_STEPS: f64 = 25.0;

/// A contact this near to the stretch it lies on is of it, metres; more when they scatter.
const ON_IT: f64 = 0.008;
/// How well a contact holds on to another beside it where there is no stretch to lie on, metres.
const HOLD: f64 = 0.02;

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
    pub(super) centre: Point,
    normal: Matrix3<f64>,
    right: Vector3<f64>,
    /// By how much it was found to be off: dx, dy, heading, turning about `centre`.
    pub(super) found: Vector3<f64>,
    /// How far contacts scatter about their walls, metres, and the variance that one of them has among its
    /// neighbours, square metres.
    pub(super) doubt: (f64, f64),
    /// Standard deviations of the misclosure in its worse direction (metres) and heading (radians).
    pub sd: (f64, f64),
    /// The same without what wheels and gyro lead to expect.
    pub alone: (f64, f64),
}

impl Overlap {
    /// Tells `survey` that knot `late`, at `at`, lies on the place of knot `early`, a lap before, but
    /// for what the overlap measured.
    pub fn close(&self, survey: &mut Survey, early: &Tie, late: &Tie, at: Point) {
        let (normal, right) = about((self.normal, self.right), self.centre, at);
        survey.close(early, late, &normal, &right);
    }
}

/// What is known of (dx, dy, heading), information and right-hand side, where the heading turns about
/// `centre`: the same where it turns about `at`.
#[must_use]
pub fn about(
    (information, right): (Matrix3<f64>, Vector3<f64>),
    centre: Point,
    at: Point,
) -> (Matrix3<f64>, Vector3<f64>) {
    let arm = perp(centre - at);
    let mut moved = Matrix3::identity();
    moved[(0, 2)] = arm.x;
    moved[(1, 2)] = arm.y;
    let about = moved.transpose();
    (about * information * moved, about * right)
}

/// How contacts that came `late` lie on a wall known by `early` points: by how much they are off it,
/// turning about `centre`; what they leave open is left to `prior`, an information matrix with its
/// right-hand side. The best that is found from `starts` counts.
#[must_use]
pub fn lay(
    early: &[Seen],
    late: &[Seen],
    centre: Point,
    prior: (Matrix3<f64>, Vector3<f64>),
    starts: &[Vector3<f64>],
) -> Overlap {
    let scatter = scatter(early).max(scatter(late));
    lay_as(early, late, centre, prior, starts, (scatter, variance(late, scatter)))
}

/// The same for contacts of which it is known how far they `scatter` about their walls, metres, and how
/// much one of them says: the variance it has among its neighbours, square metres.
#[must_use]
pub fn lay_as(
    early: &[Seen],
    late: &[Seen],
    centre: Point,
    prior: (Matrix3<f64>, Vector3<f64>),
    starts: &[Vector3<f64>],
    doubt: (f64, f64),
) -> Overlap {
    let (scatter, variance) = doubt;
    let early = Look { seen: early, scatter };
    let laid = Laid { early, late, centre, prior: prior.0, expected: prior.1, variance };
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
    laid.told(&best, doubt)
}

/// The same from each of `starts` by itself: the places where it lies, good or bad.
#[must_use]
pub fn lay_from_each(
    early: &[Seen],
    late: &[Seen],
    centre: Point,
    prior: (Matrix3<f64>, Vector3<f64>),
    starts: &[Vector3<f64>],
    doubt: (f64, f64),
) -> Vec<Overlap> {
    let (scatter, variance) = doubt;
    let early = Look { seen: early, scatter };
    let laid = Laid { early, late, centre, prior: prior.0, expected: prior.1, variance };
    starts.iter().map(|start| laid.told(&laid.closest(*start), doubt)).collect()
}

/// Less than this says nothing, per square metre: a standard deviation of ten metres.
const LEAST_INFORMATION: f64 = 0.01;

/// Standard deviations of the position in its worse direction (metres) and of the heading (radians)
/// of what is known with this information.
fn deviations(information: Matrix3<f64>) -> (f64, f64) {
    // As good as nothing in some direction is nothing, whatever its inverse comes to.
    let least = information.symmetric_eigenvalues().min();
    let Some(spread) = information.try_inverse().filter(|_| least > LEAST_INFORMATION) else {
        return (f64::INFINITY, f64::INFINITY);
    };
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
    early: Look<'a>,
    late: &'a [Seen],
    centre: Point,
    prior: Matrix3<f64>,
    expected: Vector3<f64>,
    /// What one of them says, among its neighbours: its variance, square metres.
    variance: f64,
}

impl Laid<'_> {
    /// What a fit says.
    fn told(&self, fit: &Fit, doubt: (f64, f64)) -> Overlap {
        let Fit { found, agreeing, known, normal, right } = *fit;
        let count = self.late.len();
        Overlap {
            misclosure: Misclosure { dx: found.x, dy: found.y, heading: found.z, lap: 0.0 },
            agreement: agreeing as f64 / known.max(count.div_ceil(2)).max(1) as f64,
            share: agreeing as f64 / count.max(1) as f64,
            known,
            centre: self.centre,
            normal,
            right,
            found,
            doubt,
            sd: deviations(normal + self.prior),
            alone: deviations(normal),
        }
    }

    /// Starts to either side of a fit in the direction that it left open: a corner farther off than
    /// the search for closest points reaches is found from one of them.
    fn along_the_open(&self, fit: &Fit) -> Vec<Vector3<f64>> {
        let Some(spread) = (fit.normal + self.prior).try_inverse() else { return Vec::new() };
        let eigen = spread.fixed_view::<2, 2>(0, 0).into_owned().symmetric_eigen();
        let worst = eigen.eigenvalues.imax();
        let sd = eigen.eigenvalues[worst].max(0.0).sqrt();
        let direction = eigen.eigenvectors.column(worst).into_owned();
        let steps = (2.5 * sd / OPEN_STEP).min(MOST_STEPS) as i32;
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
            for seen in self.late {
                let arm = rotate(seen.at - self.centre, -found.z);
                let placed = self.centre + arm - Vector::new(found.x, found.y);
                let placed = Seen { at: placed, ..*seen };
                let around = self.early.around(&placed);
                let beside = around.beside();
                let Some(wall) = around.stretch() else {
                    // Ragged wall has no stretch to lie on; a contact where one was agrees too, and
                    // holds on to it where they are close together.
                    let agrees = beside.is_some() || around.is_between();
                    agreeing += usize::from(agrees);
                    known += usize::from(agrees);
                    let Some(beside) = beside else { continue };
                    if !around.is_ragged() {
                        continue;
                    }
                    let off = placed.at - beside;
                    let [by_x, by_y] = [Vector::x(), Vector::y()]
                        .map(|axis| Vector3::new(axis.x, axis.y, axis.dot(&perp(arm))));
                    let weight = HOLD.powi(-2);
                    normal += (by_x * by_x.transpose() + by_y * by_y.transpose()) * weight;
                    right += by_x * ((off.x + by_x.dot(&found)) * weight);
                    right += by_y * ((off.y + by_y.dot(&found)) * weight);
                    continue;
                };
                known += 1;
                let across = perp(wall.along);
                let row = Vector3::new(across.x, across.y, across.dot(&perp(arm)));
                let off = across.dot(&(placed.at - wall.at));
                agreeing += usize::from(
                    beside.is_some() || off.abs() < ON_IT.max(2.5 * self.early.scatter),
                );
                // Huber's weight: a contact that belongs to another wall must not pull.
                let weight = (2.0 / (off / CONTACT_SD).abs().max(2.0)) / self.variance;
                normal += row * row.transpose() * weight;
                right += row * ((off + row.dot(&found)) * weight);
            }
            (normal, right) = well_seen(&normal, &right, known as f64 / self.variance);
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

/// The same equations without the directions that contacts of so much `information` (inverse square metres)
/// hardly speak of. Along a straight wall, or about the centre of an arc, nothing but the scatter of the
/// tangents is left, and that must not outvote what the gyro and the wheels are known to keep to.
fn well_seen(
    normal: &Matrix3<f64>,
    right: &Vector3<f64>,
    information: f64,
) -> (Matrix3<f64>, Vector3<f64>) {
    let least = LEAST_SLOPE.powi(2) * information;
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A board from x = 0 to 1 m and from y = 0 to `thick`, with the face of a wall across at its end, as
    /// seen from the side `from_y`, moved by `moved`.
    fn seen(y: f64, from_y: f64, moved: Vector) -> Vec<Seen> {
        let face = (0..=20).map(|k| Point::new(f64::from(k) * 0.05, y));
        let across = (1..=8).map(|k| Point::new(1.2, f64::from(k) * 0.05 * from_y.signum()));
        let on_face = face.map(|at| Seen { at: at + moved, towards: Vector::new(0.0, from_y) });
        let on_wall = across.map(|at| Seen { at: at + moved, towards: Vector::new(-1.0, 0.0) });
        on_face.chain(on_wall).collect()
    }

    fn laid(early: &[Seen], late: &[Seen]) -> Overlap {
        let prior = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 1.0));
        lay(early, late, Point::origin(), (prior, Vector3::zeros()), &[])
    }

    #[test]
    fn what_was_seen_twice_tells_by_how_much_it_is_off() {
        let off = Vector::new(0.01, -0.015);
        let overlap = laid(&seen(0.0, -1.0, Vector::zeros()), &seen(0.0, -1.0, off));
        let found = overlap.misclosure;
        assert!((found.dx - off.x).abs() < 1e-3 && (found.dy - off.y).abs() < 1e-3, "{found:?}");
        assert!(overlap.agreement > 0.95);
    }

    #[test]
    fn the_two_faces_of_a_thin_board_are_not_laid_on_each_other() {
        // Seen from below first, then from below and above: the upper face is 20 mm off the lower one.
        let mut early = seen(0.0, -1.0, Vector::zeros());
        early.extend(seen(0.02, 1.0, Vector::zeros()));
        let late = seen(0.02, 1.0, Vector::zeros());
        let both = laid(&early, &late).misclosure;
        assert!(both.dy.abs() < 1e-4, "each face lies on itself: {both:?}");
        // With the lower face alone there is nothing for the upper one to lie on.
        let lower: Vec<Seen> = seen(0.0, -1.0, Vector::zeros());
        let upper: Vec<Seen> = late.iter().take(21).copied().collect();
        let alone = laid(&lower, &upper);
        assert_eq!(alone.known, 0, "{alone:?}");
        assert!(alone.misclosure.dy.abs() < 1e-9, "{:?}", alone.misclosure);
    }

    #[test]
    fn a_bump_too_small_for_a_stretch_tells_where_along_a_wall_the_robot_is() {
        // A wedge of 5 cm on a straight wall; the second look saw it at other places.
        let wall = |step: f64, by: Vector| -> Vec<Seen> {
            let flat = (0..60).map(|k| f64::from(k) * 0.05).filter(|x| (x - 1.5).abs() > 0.06);
            let bump = (0..30).map(|k| 1.44 + f64::from(k) * step).take_while(|x| *x < 1.56);
            flat.chain(bump)
                .map(|x| {
                    let y = (0.05 - (x - 1.5).abs()).max(0.0);
                    Seen { at: Point::new(x, y) + by, towards: Vector::y() }
                })
                .collect()
        };
        let off = Vector::new(0.11, 0.004);
        let (early, late) = (wall(0.011, Vector::zeros()), wall(0.008, off));
        let prior = (Matrix3::identity(), Vector3::zeros());
        let starts: Vec<Vector3<f64>> =
            (1..5).map(|k| Vector3::x() * f64::from(k) * 0.05).collect();
        let overlap = lay(&early, &late, Point::origin(), prior, &starts);
        let found = overlap.misclosure;
        assert!((found.dx - off.x).abs() < 0.01 && (found.dy - off.y).abs() < 2e-3, "{found:?}");
        assert!(overlap.share > 0.95, "{}", overlap.share);
    }

    #[test]
    fn contacts_between_those_of_a_corner_agree() {
        // The end of a board: faces shorter than any stretch, met at other places the second time.
        let corner = |shift: f64| -> Vec<Seen> {
            let along = (0..4).map(|k| Point::new(0.0, f64::from(k) * 0.02 + shift));
            let across = (0..4).map(|k| Point::new(f64::from(k) * 0.02 + shift, 0.08));
            let towards = Vector::new(-1.0, 1.0);
            along.chain(across).map(|at| Seen { at, towards }).collect()
        };
        let overlap = laid(&corner(0.0), &corner(0.01));
        assert!(overlap.share > 0.85, "{}", overlap.share);
    }
}
