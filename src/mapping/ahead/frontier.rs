//! Where the known wall ends, and how it is believed to go on: straight, or round as it came. Knows the
//! contacts and nothing of the motion that they are for.

use super::Rolling;
use crate::geometry::fit::Moments;
use crate::geometry::{Point, Pose, Vector, cross, perp, rotate};
use crate::mapping::follow::Side;
use crate::mapping::lay::Seen;
use crate::mapping::wall::Stretch;

/// The last contact along the wall, and how the wall runs there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frontier {
    /// The contact itself.
    pub at: Point,
    /// Whether what is believed rests on contacts that lie well apart.
    pub certain: bool,
    /// How far beyond the last contact it is believed, metres: in proportion to what was seen.
    pub extent: f64,
    /// Whether a look has shown that it does not go on: its beam would have been in the way.
    pub ended: bool,
    run: Run,
}

/// The contacts that end there lie on a line, or on a circle.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Run {
    /// `along` points the way the robot goes.
    Straight(Stretch),
    Round {
        center: Point,
        radius: f64,
        /// +1 where the wall is gone along counter-clockwise about the centre, else -1.
        sense: f64,
    },
}

/// A run is straight when no contact of it lies farther from its line, metres: the one contact
/// beyond a corner must not be taken for more of the wall before. Likewise for a circle.
const STRAIGHT: f64 = 0.004;
/// So many contacts may lie beside a run.
const STRAYS: usize = 3;
/// No straight run is longer, metres: two of the longest steps, so that what was seen at the last look but one
/// tells how the wall runs.
const LONGEST_RUN: f64 = 1.2;
/// Nor a round one. The longer it is the better its curvature is known.
const LONGEST_BEND: f64 = 1.2;
/// A round run is at least so many times as long as the straight one that ends it, ...
const MORE: f64 = 1.2;
/// ... no shorter than this, metres, ...
const SHORTEST_BEND: f64 = 0.3;
/// ... of no fewer contacts than this: few of two straight walls soon lie on a circle, ...
const FEWEST: usize = 7;
/// ... and none of them is farther from the next than this share of it.
const DENSE: f64 = 0.6;
/// Its contacts lie no farther from the circle than this, metres, root mean square.
const SMOOTH: f64 = 0.0025;

impl Frontier {
    /// How the wall runs at its last contact `at`, the robot at `pose` with the wall on `side`: the
    /// longest run of the contacts that came before it, newest first. In the order of time a wall is
    /// one run, whatever stands behind.
    pub(super) fn of(contacts: &[Seen], at: Point, pose: Pose, side: Side) -> Self {
        let newest = contacts.iter().rposition(|seen| seen.at == at).unwrap_or(0);
        let before: Vec<Point> = contacts[..newest].iter().map(|seen| seen.at).collect();
        let before = before.as_slice();
        let away = at - pose.position;
        // Looked at by the robot, a wall on the left goes on to the right.
        let onward = |along: Vector| -side.sign() * cross(away, along) >= 0.0;
        // Round a small thing the last contact may be one of the first, seen from its far side, and the
        // run that ended there a face that the robot is behind now.
        let towards = contacts.get(newest).map_or(-away, |seen| seen.towards);
        let faces = |run: &Stretch| cross(run.along, towards) * cross(run.along, away) < 0.0;
        let straight = straight_run(before, at).filter(|(run, _)| faces(run));
        let spread = straight.map_or(0.0, |(_, spread)| spread);
        let round = round_run(before, at, spread).map(|(center, radius, spread)| {
            let sense = if onward(perp(at - center)) { 1.0 } else { -1.0 };
            (Run::Round { center, radius, sense }, spread)
        });
        let found = round.or_else(|| {
            straight.map(|(stretch, spread)| {
                let along = if onward(stretch.along) { stretch.along } else { -stretch.along };
                (Run::Straight(Stretch { along, ..stretch }), spread)
            })
        });
        let (run, certain, extent) = if let Some((run, spread)) = found {
            (run, spread > 0.05, (2.0 * spread).max(0.06))
        } else {
            let level: Vector = perp(away) * -side.sign();
            let along = level.try_normalize(1e-9).unwrap_or_else(|| pose.direction());
            (Run::Straight(Stretch { at, along, residual: 0.0 }), false, 0.1)
        };
        Self { at, certain, extent, ended: false, run }
    }

    /// The point of the wall that is believed to lie `ahead` metres along it beyond the last contact.
    #[must_use]
    pub fn beyond(&self, ahead: f64) -> Point {
        match self.run {
            Run::Straight(stretch) => self.at + stretch.along * ahead,
            Run::Round { center, radius, sense } => {
                center + rotate(self.at - center, sense * ahead / radius)
            }
        }
    }

    /// Distance of `p` from where the wall is believed to go on, metres, unsigned.
    #[must_use]
    pub fn distance(&self, p: Point) -> f64 {
        match self.run {
            Run::Straight(stretch) => stretch.distance(p),
            Run::Round { center, radius, .. } => ((p - center).norm() - radius).abs(),
        }
    }

    /// The longest straight step of a disc that rolls along the wall and never gets farther from it than
    /// its slack, metres: a chord of the circle on which its centre goes where the wall bends towards
    /// it, a tangent where the wall bends away.
    pub(super) fn longest_chord(&self, disc: &Rolling) -> f64 {
        let Run::Round { radius, sense, .. } = self.run else { return f64::INFINITY };
        if sense == disc.side.sign() {
            (2.0 * (radius + disc.radius) * disc.slack).sqrt()
        } else {
            (8.0 * (radius - disc.radius).max(0.0) * disc.slack).sqrt()
        }
    }
}

/// The longest straight run of the contacts `before` that ends `at`, with how far it reaches. The
/// newest of them may be of something else, as those of the wall left behind in a corner are.
fn straight_run(before: &[Point], at: Point) -> Option<(Stretch, f64)> {
    let without = |others: usize| &before[..before.len().saturating_sub(others)];
    (0..=STRAYS).find_map(|others| run_through(without(others), at, STRAYS - others))
}

/// The same with the newest of `before` in it, and no more than `strays` left out.
fn run_through(before: &[Point], at: Point, mut strays: usize) -> Option<(Stretch, f64)> {
    let mut run = vec![at];
    let mut best: Option<(Stretch, f64)> = None;
    for &p in before.iter().rev() {
        let spread = (p - at).norm();
        run.push(p);
        let straight = Stretch::through(&run)
            .filter(|s| run.len() < 3 || run.iter().all(|p| s.distance(*p) < STRAIGHT));
        if straight.is_none() || spread > LONGEST_RUN {
            run.pop();
            let Some(left) = strays.checked_sub(1) else { break };
            strays = left;
        } else if let Some(stretch) = straight
            && spread > 0.008
            // Two contacts are always straight; far apart they may be of two walls.
            && (run.len() > 2 || spread < 0.1)
            && best.is_none_or(|(_, widest)| spread > widest)
        {
            best = Some((stretch, spread));
        }
    }
    best
}

/// Centre, radius and reach of the longest round run that ends `at`; none where a straight one, which
/// reaches `straight` metres, says as much.
fn round_run(before: &[Point], at: Point, straight: f64) -> Option<(Point, f64, f64)> {
    let mut moments = Moments::new(at);
    moments.add(at, 1.0);
    let mut run = vec![at];
    let mut best = None;
    for &p in before.iter().rev() {
        let spread = (p - at).norm();
        if spread > LONGEST_BEND {
            break;
        }
        run.push(p);
        moments.add(p, 1.0);
        if run.len() < FEWEST || spread < SHORTEST_BEND.max(MORE * straight) {
            continue;
        }
        let Some(fit) = moments.circle() else { continue };
        let off = |p: &Point| ((*p - fit.center).norm() - fit.radius).abs();
        if run.iter().any(|p| off(p) > STRAIGHT) {
            break;
        }
        let smooth = fit.residual < SMOOTH * SMOOTH * run.len() as f64;
        let dense = run.windows(2).all(|pair| (pair[1] - pair[0]).norm() < DENSE * spread);
        if dense && smooth {
            best = Some((fit.center, fit.radius, spread));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::angle;

    const DISC: Rolling =
        Rolling { side: Side::Left, radius: 0.145, least: 0.112, slack: 0.012, sees_far: false };

    /// The contacts as they are seen from `from`.
    fn seen(contacts: &[Point], from: Point) -> Vec<Seen> {
        contacts.iter().map(|&at| Seen { at, towards: from - at }).collect()
    }

    /// Contacts every 4 cm on a circle of 1.6 m about the origin, gone along with the sense of `sense`.
    fn round(sense: f64) -> Vec<Point> {
        (0..12).map(|k| Point::from(angle::unit(sense * f64::from(k) * 0.025) * 1.6)).collect()
    }

    #[test]
    fn a_round_wall_is_believed_to_go_on_round() {
        // Within the circle with the wall on the left: clockwise.
        let contacts = round(-1.0);
        let at = contacts[11];
        let inside = Pose { position: at - at.coords * 0.09, heading: -1.8 };
        let frontier = Frontier::of(&seen(&contacts, inside.position), at, inside, Side::Left);
        assert!(frontier.certain);
        let ahead = frontier.beyond(0.3);
        assert!((ahead.coords.norm() - 1.6).abs() < 1e-6, "{ahead}");
        assert!((angle::of(ahead.coords) + 11.0 * 0.025 + 0.3 / 1.6).abs() < 1e-6);
        assert!(frontier.distance(ahead) < 1e-6);
        assert!(frontier.distance(at + Vector::new(0.02, 0.0)) > 0.015);
        // A chord of that length leaves the circle of the disc's centre by its slack.
        let chord = frontier.longest_chord(&DISC);
        let centre = 1.6 - DISC.radius;
        let sagitta = centre - (centre * centre - chord * chord / 4.0).sqrt();
        assert!((sagitta - DISC.slack).abs() < 1e-4, "{sagitta}");
        // Round the outside of it the way is a tangent, and no longer than this.
        let contacts = round(1.0);
        let at = contacts[11];
        let outside = Pose { position: at + at.coords * 0.09, heading: 1.8 };
        let frontier = Frontier::of(&seen(&contacts, outside.position), at, outside, Side::Left);
        let tangent = frontier.longest_chord(&DISC);
        let centre = 1.6 + DISC.radius;
        let off = (centre * centre + tangent * tangent).sqrt() - centre;
        assert!((off - DISC.slack).abs() < 1e-4, "{off}");
    }

    #[test]
    fn a_straight_wall_and_a_corner_are_not_round() {
        let straight: Vec<Point> = (0..12).map(|k| Point::new(f64::from(k) * 0.05, 0.0)).collect();
        let pose = Pose::new(0.5, -0.145, 0.0);
        let frontier =
            Frontier::of(&seen(&straight, pose.position), straight[11], pose, Side::Left);
        assert!((frontier.beyond(0.4) - Point::new(0.95, 0.0)).norm() < 1e-9);
        assert!(frontier.longest_chord(&DISC).is_infinite());
        // Down one wall and along the next: the next is straight on.
        let mut corner: Vec<Point> =
            (0..8).map(|k| Point::new(0.0, 0.4 - f64::from(k) * 0.05)).collect();
        corner.extend((1..5).map(|k| Point::new(f64::from(k) * -0.05, 0.0)));
        let at = *corner.last().unwrap_or(&Point::origin());
        let pose = Pose::new(-0.2, 0.145, angle::PI);
        let frontier = Frontier::of(&seen(&corner, pose.position), at, pose, Side::Left);
        assert!((frontier.beyond(0.1) - Point::new(-0.3, 0.0)).norm() < 1e-9, "{frontier:?}");
    }

    #[test]
    fn what_was_seen_of_the_wall_behind_a_corner_does_not_hide_how_the_next_one_runs() {
        // In the order in which a robot that turned in a corner saw them: both walls in turn.
        let contacts = [(4.85, 0.0), (4.93, 0.0), (5.0, 0.2), (5.0, 0.07), (4.77, 0.0)]
            .map(|(x, y)| Point::new(x, y));
        let pose = Pose::new(4.85, 0.145, -2.3);
        let frontier = Frontier::of(&seen(&contacts, pose.position), contacts[4], pose, Side::Left);
        assert!(frontier.certain);
        assert!((frontier.beyond(0.1) - Point::new(4.67, 0.0)).norm() < 1e-6, "{frontier:?}");
    }

    #[test]
    fn the_far_face_of_a_small_thing_does_not_tell_how_the_near_one_runs() {
        // The first contacts of a lap round a box of 10 cm, wall on the right: its far side, from there.
        let far = [(0.095, 0.0), (0.1, 0.03), (0.06, 0.1)].map(|(x, y)| Point::new(x, y));
        let mut contacts = seen(&far, Point::new(0.25, 0.1));
        // The robot has come round to the near side; the last of what is ahead is the first it saw.
        let pose = Pose::new(-0.12, 0.12, 0.6);
        let frontier = Frontier::of(&contacts, far[2], pose, Side::Right);
        assert!(!frontier.certain, "{frontier:?}");
        // Seen from here they would be a wall.
        contacts = seen(&far, pose.position);
        assert!(Frontier::of(&contacts, far[2], pose, Side::Right).certain);
    }
}
