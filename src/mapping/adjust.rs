//! Taking the misclosure of a lap out of it, as surveyors do with a closed traverse.
//!
//! The stretch that was driven twice is laid on itself: contacts of the overlap against the walls
//! made by the first contacts, as one to know the place, then piece by piece (see `piece`). What does
//! not fit is the misclosure. It is spread over the lap by least squares: heading errs by drift and
//! random walk with time, position with distance and with the heading before it (see `survey`); measured
//! better than angles first and Bowditch after. Whether it is a lap at all is not known here.

mod piece;

pub use piece::{Led, Placed, lead_on};

use super::circuit::Closure;
use super::lay::{Overlap, Seen, about, lay, lay_from_each};
use super::map::{Contact, ContactKind, Misclosure, PathPoint};
use super::odometry::Tracker;
use super::shape::AlongWall;
use super::smooth::smooth;
use super::survey::{Step, Survey, Tie, worse};
use super::thin::{PARTINGS, part};
use super::wall::{Sighting, Stretch, Wall};
use crate::geometry::{Point, Pose, Ring, angle, cross};
use nalgebra::{Matrix3, Vector3};
use piece::{STRETCHED, driven_beyond, pieces};

/// An overlap of which less than this share agrees, by a length of no more metres, is looked at all along
/// the wall, in steps of so many metres to either side.
const DOUBTFUL: f64 = 0.9;
const FEATURES: f64 = 7.0;
const NOTCH: f64 = 0.05;
const MOST_NOTCHES: i32 = 14;

/// Places of an overlap that are farther apart than this are two, metres; they are looked for in such steps,
/// as far as so many standard deviations to either side.
const APART: f64 = 0.25;
const STEP: f64 = 0.1;
const DEVIATIONS: f64 = 3.0;
const FARTHEST: f64 = 4.0;
/// Where an overlap lies nearly as well as this share less, it lies as well.
const AS_WELL: f64 = 0.05;
/// So many contacts of an overlap tell whether it lies at a place.
const ENOUGH: usize = 60;
/// An overlap known to this by itself is held by something, metres: along a plain wall it lies anywhere.
const HELD: f64 = 0.02;
/// The way along a wall with bays is so many times as long as the wall.
const WINDING: f64 = 3.0;

/// A piece of an overlap beyond others is looked for among what came by so much sooner or later, metres,
/// beside the share by which rounds differ.
const OFF_ALONG: f64 = 1.0;

/// What is known of an overlap from looking at the beginning of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Before {
    /// How it lay.
    pub led: Led,
    /// What was driven up to so many metres beyond the end of the lap has been looked at enough.
    pub beyond: f64,
}

/// How much the pose at the end of the lap is off from the pose at its beginning, measured on the
/// overlap: the contacts after `closure.to` laid on the walls after `closure.from` (iterated closest
/// points, point to line). What the overlap leaves open (a straight wall says nothing of the way
/// along it, an arc nothing of a turn about its centre) is left to what `traverse` expects. Some of it may
/// have been looked at `before`: then only what lies beyond that is laid.
#[must_use]
pub fn measure(
    closure: &Closure,
    sightings: &[Sighting],
    traverse: &Traverse,
    before: Option<Before>,
) -> Overlap {
    let range = |s: &&Sighting| s.alive && s.kind == ContactKind::Range;
    let overlap = driven_beyond(closure, sightings);
    let beyond = before.map_or(0.0, |before| before.beyond);
    // What lies far beyond the end of the lap may have been come by sooner or later.
    let sooner = if beyond > 0.0 { STRETCHED * beyond + OFF_ALONG } else { 0.0 };
    let around = beyond - 0.3 - sooner..overlap + 0.5 + sooner;
    let within = |s: &&Sighting| around.contains(&(s.travelled - closure.from.travelled));
    let seen = sightings.iter().filter(range);
    let early: Vec<Seen> = seen.clone().filter(within).map(Sighting::seen).collect();
    let end = closure.to.pose;
    let after = |s: &&Sighting| s.travelled > closure.to.travelled + beyond;
    let late: Vec<Seen> = seen.filter(after).map(Sighting::seen).collect();
    let far = late.first().filter(|_| beyond > 0.0);
    let centre = far.map_or(end.position, |first| first.at);
    let (prior, expected) = about(traverse.prior(), end.position, centre);
    let shift = end.position - closure.from.pose.position;
    let turn = angle::wrap(end.heading - closure.from.pose.heading);
    // The robot follows the same wall at about the same gap and heading, so where it is now is one
    // guess of the misclosure; that there is none is the other. The one that fits better counts.
    // How it lay before some more was driven is another.
    let before = before.map(|before| before.led);
    let guess = |turn: f64| Led::of(end.position, Vector3::new(shift.x, shift.y, turn));
    let starts = [guess(0.0), guess(turn)].into_iter().chain(before);
    let starts: Vec<Vector3<f64>> = starts.map(|start| start.at(centre)).collect();
    let mut laid = lay(&early, &late, centre, (prior, expected), &starts);
    if laid.share < DOUBTFUL && overlap < FEATURES {
        // A ragged wall holds on to the wrong notch, the far side of a pillar to its near one: others are
        // tried, along the wall.
        let along = end.direction();
        let sd = prior.try_inverse().map_or(0.0, |spread| {
            let position = spread.fixed_view::<2, 2>(0, 0).into_owned();
            along.dot(&(position * along)).max(0.0).sqrt()
        });
        let most = ((2.0 * sd / NOTCH) as i32).min(MOST_NOTCHES);
        let from = before.map_or(laid.found, |led| led.at(centre));
        let others: Vec<Vector3<f64>> = (-most..=most)
            .map(|k| along * (f64::from(k) * NOTCH))
            .map(|by| from + Vector3::new(by.x, by.y, 0.0))
            .collect();
        let other = lay(&early, &late, centre, (prior, expected), &others);
        if other.share > laid.share {
            laid = other;
        }
    }
    at_the_end_of(closure, laid)
}

/// `laid`, with the misclosure as it is at the end of the lap.
fn at_the_end_of(closure: &Closure, mut laid: Overlap) -> Overlap {
    let off = Led::by(&laid).at(closure.to.pose.position);
    let lap = closure.length();
    laid.misclosure = Misclosure { dx: off.x, dy: off.y, heading: off.z, lap };
    laid
}

/// Whether what was driven more than `beyond` metres after the end of `closure`, and lies on the beginning
/// as `laid` says, lies elsewhere as well: pillars, doors and bays repeat themselves, and a lap may be off
/// by one of them, as far as `traverse` lets it be. Where it lies better, `laid` says that from then on.
#[must_use]
pub fn lies_elsewhere(
    closure: &Closure,
    sightings: &[Sighting],
    traverse: &Traverse,
    beyond: f64,
    laid: &mut Overlap,
) -> bool {
    let centre = laid.centre;
    let (prior, expected) = about(traverse.prior(), closure.to.pose.position, centre);
    // The heading is known from the overlap wherever that lies, and with it much of the rest.
    let heading = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, laid.alone.1.powi(-2)));
    let Some(spread) = (prior + heading).try_inverse() else { return false };
    let middle = spread * (expected + heading * laid.found);
    let along = closure.to.pose.direction();
    let position = spread.fixed_view::<2, 2>(0, 0).into_owned();
    let reach = (DEVIATIONS * along.dot(&(position * along)).max(0.0).sqrt()).min(FARTHEST);
    if reach < APART || laid.alone.0 > HELD {
        return false;
    }
    let range = |s: &&Sighting| s.alive && s.kind == ContactKind::Range;
    let sooner = STRETCHED * beyond + OFF_ALONG + WINDING * reach;
    let around = beyond - 0.3 - sooner..driven_beyond(closure, sightings) + 0.5 + sooner;
    let within = |s: &&Sighting| around.contains(&(s.travelled - closure.from.travelled));
    let after = |s: &&Sighting| s.travelled > closure.to.travelled + beyond;
    let seen = sightings.iter().filter(range);
    let early: Vec<Seen> = seen.clone().filter(within).map(Sighting::seen).collect();
    let late: Vec<Seen> = seen.filter(after).map(Sighting::seen).collect();
    let late: Vec<Seen> = late.iter().step_by(1 + late.len() / ENOUGH).copied().collect();
    let steps = (reach / STEP) as i32;
    let starts: Vec<Vector3<f64>> = (-steps..=steps)
        .map(|k| along * (f64::from(k) * STEP))
        .map(|by| middle + Vector3::new(by.x, by.y, 0.0))
        .collect();
    let all = lay_from_each(&early, &late, centre, (prior, expected), &starts, laid.doubt);
    for other in &all {
        if other.share > laid.share + AS_WELL {
            *laid = at_the_end_of(closure, *other);
        }
    }
    let apart = |other: &Overlap| (other.found - laid.found).xy().norm() > APART;
    let as_well = |other: &Overlap| {
        other.share > laid.share - AS_WELL && other.agreement > laid.agreement - AS_WELL
    };
    all.iter().any(|other| apart(other) && as_well(other))
}

/// Knots of a lap at most.
const MOST_KNOTS: f64 = 90.0;
/// No knots are nearer to each other along the path, metres.
const LEAST_SPACING: f64 = 0.25;

/// What of `path` was driven since `since_us` (robot time).
fn since(path: &[PathPoint], since_us: u64) -> &[PathPoint] {
    let begin = path.partition_point(|point| point.time_us < since_us).saturating_sub(1);
    &path[begin.min(path.len())..]
}

/// The lap as an open traverse: its errors as they are to be expected before it is closed.
#[derive(Debug, Clone)]
pub struct Traverse {
    survey: Survey,
    /// Beginning and end of each lap on it.
    ends: Vec<Option<(Tie, Tie)>>,
}

impl Traverse {
    /// The lap `closure` of a `path` driven on wheels of which one tick turns the robot by `resolution`
    /// radians: its ends alone.
    #[must_use]
    pub fn between(path: &[PathPoint], resolution: f64, closure: &Closure) -> Self {
        let path = since(path, closure.from.time_us);
        Self::over(Survey::new(resolution), path, &[*closure], f64::INFINITY).again(
            path,
            &[*closure],
            f64::INFINITY,
        )
    }

    /// All of `path` since `since_us` (robot time), from when on errors count, with `laps` on it and with
    /// knots along the way.
    fn along(path: &[PathPoint], resolution: f64, laps: &[Closure], since_us: u64) -> Self {
        let path = since(path, since_us);
        let length: f64 =
            path.windows(2).map(|w| (w[1].pose.position - w[0].pose.position).norm()).sum();
        let spacing = (length / MOST_KNOTS).max(LEAST_SPACING);
        Self::over(Survey::new(resolution), path, laps, f64::INFINITY).again(path, laps, spacing)
    }

    /// The same once more: now that it is known how the wheels hold the floor, the first metres are
    /// weighed again.
    fn again(&self, path: &[PathPoint], laps: &[Closure], spacing: f64) -> Self {
        Self::over(self.survey.blank_on_this_floor(), path, laps, spacing)
    }

    /// `path` with knots at the ends of `laps`, and every `spacing` metres.
    fn over(mut survey: Survey, path: &[PathPoint], laps: &[Closure], spacing: f64) -> Self {
        // Whatever drift a lap has shown was taken out of all that was driven.
        survey.unwound(laps.last().map_or(0.0, |lap| lap.drift));
        let mut since_knot = f64::INFINITY;
        let mut ends: Vec<(Option<Tie>, Option<Tie>)> = vec![(None, None); laps.len()];
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
                survey.predict(&step);
                since_knot += (point.pose.position - before.pose.position).norm();
            }
            let begins = |lap: &Closure| point.time_us >= lap.from.time_us;
            let closes = |lap: &Closure| point.time_us >= lap.to.time_us;
            let is_end = laps.iter().zip(&ends).any(|(lap, (from, to))| {
                (from.is_none() && begins(lap)) || (to.is_none() && closes(lap))
            });
            if is_end || since_knot > spacing {
                let tie = survey.mark(point.pose.position, point.time_us);
                since_knot = 0.0;
                for (lap, (from, to)) in laps.iter().zip(&mut ends) {
                    *from = from.or(begins(lap).then_some(tie));
                    *to = to.or(closes(lap).then_some(tie));
                }
            }
        }
        Self { survey, ends: ends.into_iter().map(|(from, to)| from.zip(to)).collect() }
    }

    /// One standard deviation of where the lap's end lies beside its beginning before any overlap, in its
    /// worse direction, metres.
    #[must_use]
    pub fn looseness(&self) -> f64 {
        let Some(Some((from, to))) = self.ends.last() else { return f64::INFINITY };
        worse(&self.survey.relative(from, to).fixed_view::<2, 2>(0, 0).into_owned())
    }

    /// Information (inverse covariance) on the misclosure (dx, dy, heading) before any overlap, and
    /// that times the misclosure that is expected.
    fn prior(&self) -> (Matrix3<f64>, Vector3<f64>) {
        let Some(Some((from, to))) = self.ends.last().copied() else {
            return (Matrix3::zeros(), Vector3::zeros());
        };
        let floor = Matrix3::from_diagonal(&Vector3::new(1e-6, 1e-6, 1e-6));
        let spread = self.survey.relative(&from, &to) + floor;
        let information = spread.try_inverse().unwrap_or_else(Matrix3::zeros);
        (information, information * self.survey.misclosure(&from, &to))
    }
}

/// A lap, what its overlap says as one, and what was seen, where that is to be laid piece by piece.
type Lap<'a> = (Closure, &'a Overlap, &'a [Sighting]);

/// How the trajectory moves when the misclosure is taken out.
#[derive(Debug, Clone)]
pub struct Adjustment {
    survey: Survey,
    /// The survey as it was each time that its corrections were taken for the new beginning: what is placed goes
    /// through all of them.
    before: Vec<Survey>,
}

impl Adjustment {
    /// Takes what `overlap` measured out of the lap `closure` of what `tracker` drove; the part since
    /// `since_us` (robot time) is adjusted. What lies before that stays, what lies after the lap
    /// moves with its end.
    #[must_use]
    pub fn new(tracker: &Tracker, closure: &Closure, overlap: &Overlap, since_us: u64) -> Self {
        Self::of(tracker, &[(*closure, overlap, &[])], since_us)
    }

    /// The same for the lap round the room, which closes on the way that led there as well: the
    /// things that were gone round `earlier` close each by itself, and what the gyro lost on them
    /// does not turn the room.
    #[must_use]
    pub fn after(
        tracker: &Tracker,
        earlier: &[(Closure, Wall)],
        closure: &Closure,
        overlap: &Overlap,
        wall: &Wall,
    ) -> Self {
        let measured: Vec<(Closure, Overlap)> = earlier
            .iter()
            .map(|(lap, wall)| {
                let traverse = Traverse::between(tracker.path(), tracker.resolution(), lap);
                (*lap, measure(lap, wall.log(), &traverse, None))
            })
            .collect();
        let mut laps: Vec<Lap<'_>> =
            measured.iter().map(|(lap, overlap)| (*lap, overlap, [].as_slice())).collect();
        laps.push((*closure, overlap, wall.log()));
        Self::of(tracker, &laps, 0)
    }

    fn of(tracker: &Tracker, laps: &[Lap<'_>], since_us: u64) -> Self {
        let closures: Vec<Closure> = laps.iter().map(|(lap, ..)| *lap).collect();
        let traverse = Traverse::along(tracker.path(), tracker.resolution(), &closures, since_us);
        let Traverse { mut survey, ends } = traverse;
        for ((lap, overlap, seen), ends) in laps.iter().zip(ends) {
            let pieces = pieces(lap, seen, overlap);
            for piece in &pieces {
                piece.close(&mut survey);
            }
            if let Some((from, to)) = ends.filter(|_| pieces.is_empty()) {
                overlap.close(&mut survey, &from, &to, lap.to.pose.position);
            }
        }
        Self { survey, before: Vec::new() }
    }

    /// Lets the faces of thin walls that lie through each other part the way: `contacts` are those of the
    /// adjusted lap and move along, `reach` is body radius plus range of the switches, metres (see `thin`).
    pub fn part(&mut self, contacts: &mut [Contact], reach: f64) {
        self.rebase();
        for _ in 0..PARTINGS {
            let knots = self.survey.knots();
            if !part(&mut self.survey, knots, &AlongWall::of(contacts, reach)) {
                return;
            }
            self.carry(contacts);
            self.rebase();
        }
    }

    /// Lets the smooth faces of what was gone round straighten the way: `contacts` are those of the
    /// adjusted lap and move along, `outlines` what was fitted to them. What lies on straight faces
    /// bends with every turn that was none, and that is told from the bend (see `smooth`).
    pub fn straighten<'a>(
        &mut self,
        contacts: &mut [Contact],
        outlines: impl IntoIterator<Item = &'a Ring>,
    ) {
        self.rebase();
        let knots = self.survey.knots();
        for outline in outlines {
            smooth(&mut self.survey, knots, outline, contacts);
        }
        self.carry(contacts);
    }

    fn rebase(&mut self) {
        self.before.push(self.survey.clone());
        self.survey.rebase();
    }

    /// Moves `contacts` by what was learnt since the last beginning.
    fn carry(&self, contacts: &mut [Contact]) {
        for contact in contacts {
            let tie = self.survey.tie(contact.time_us(), self.survey.knots());
            contact.point += self.survey.displacement(contact.point, &tie);
            contact.from += self.survey.displacement(contact.from, &tie);
        }
    }

    /// The survey after the adjustment; its knots are the lap's.
    #[must_use]
    pub fn into_survey(self) -> Survey {
        self.survey
    }

    fn surveys(&self) -> impl Iterator<Item = &Survey> {
        self.before.iter().chain(std::iter::once(&self.survey))
    }

    /// Where a point goes that was tied to the raw trajectory at `time_us`.
    #[must_use]
    pub fn place(&self, point: Point, time_us: u64) -> Point {
        self.surveys().fold(point, |at, survey| {
            at + survey.displacement(at, &survey.tie(time_us, survey.knots()))
        })
    }

    /// Where a pose goes that was tied to the raw trajectory at `time_us`.
    #[must_use]
    pub fn pose(&self, pose: Pose, time_us: u64) -> Pose {
        self.surveys()
            .fold(pose, |at, survey| survey.place(at, &survey.tie(time_us, survey.knots())))
    }
}

/// Signed distance of `point` from the line of `wall`, positive to its left.
#[must_use]
pub fn offset(wall: &Stretch, point: Point) -> f64 {
    cross(wall.along, point - wall.at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::map::Spun;

    #[test]
    fn what_was_taken_out_of_a_lap_stays_out_when_its_faces_are_looked_at() {
        // Four metres along x that were off at their end.
        let mut survey = Survey::new(0.0005 / 0.16);
        let early = survey.mark(Point::origin(), 0);
        let (from, to) = (Pose::new(0.0, 0.0, 0.0), Pose::new(4.0, 0.0, 0.0));
        survey.predict(&Step { from, to, seconds: 20.0, spun: (Spun::default(), Spun::default()) });
        let late = survey.mark(to.position, 20_000_000);
        let sure = Matrix3::from_diagonal(&Vector3::new(1e8, 1e8, 1e8));
        survey.close(&early, &late, &sure, &(sure * Vector3::new(0.02, -0.05, 0.01)));
        let mut adjustment = Adjustment { survey, before: Vec::new() };
        let placed = |adjustment: &Adjustment| {
            let pose = adjustment.pose(to, 20_000_000);
            (adjustment.place(to.position, 20_000_000), pose.position, pose.heading)
        };
        let closed = placed(&adjustment);
        assert!((closed.0 - to.position).norm() > 0.01, "{closed:?}");
        adjustment.part(&mut [], 0.16);
        assert_eq!(placed(&adjustment), closed, "nothing lay through anything");
        adjustment.straighten(&mut [], &[]);
        assert_eq!(placed(&adjustment), closed, "and nothing was smooth");
    }
}
