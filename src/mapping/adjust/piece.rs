//! An overlap piece by piece. While the robot drives on beyond the crossing its gyro drifts on, as it
//! did on the beginning: what is some metres long lies there as one only in the mean. Laid in short
//! pieces it says what the pose was off at each place. What the survey makes of that is not known here.

use crate::geometry::{Point, Pose, Vector, angle, rotate};
use crate::mapping::circuit::Closure;
use crate::mapping::lay::{Overlap, Seen, lay, lay_as};
use crate::mapping::map::{ContactKind, PathPoint};
use crate::mapping::survey::Survey;
use crate::mapping::wall::Sighting;
use nalgebra::{Matrix3, Vector3};
use std::ops::Range;

/// Two rounds of one wall differ in length by no more than this share.
pub(super) const STRETCHED: f64 = 0.1;
/// By how much a piece of an overlap may lie otherwise than the piece before, which it shares most of:
/// metres and radians, one standard deviation.
const ASTRAY: (f64, f64) = (0.03, 0.012);

/// How long the pieces are that an overlap is laid in, metres.
const PIECE: f64 = 0.6;
/// By how much a piece may lie otherwise than its neighbour, or than all as one: metres and radians, one
/// standard deviation.
const BEND: (f64, f64) = (0.01, 0.01);
/// Contacts that a piece rests on at least, or it grows by so many metres; the share of them that have to
/// agree; the share of what lies on the beginning that has to lie there in pieces.
const LEAST: usize = 15;
const GROWS: f64 = 0.2;
const AGREES: f64 = 0.8;
const ALL: f64 = 0.7;

/// How a piece of an overlap lay on the beginning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Led {
    /// What it turned about.
    centre: Point,
    /// By how much it was off: dx, dy, heading.
    off: Vector3<f64>,
}

impl Led {
    /// `off` (dx, dy, heading), turning about `centre`.
    pub(super) fn of(centre: Point, off: Vector3<f64>) -> Self {
        Self { centre, off }
    }

    /// What `overlap` was off, as one.
    #[must_use]
    pub fn by(overlap: &Overlap) -> Self {
        Self { centre: overlap.centre, off: overlap.found }
    }

    /// By how much it was off (dx, dy, heading), turning about `centre`.
    pub(super) fn at(self, centre: Point) -> Vector3<f64> {
        self.about(centre).off
    }

    /// Whether it places what it turned about farther than `reach` metres from where `other` does.
    pub fn is_off(self, other: Self, reach: f64) -> bool {
        (self.off - other.at(self.centre)).xy().norm() > reach
    }

    /// The same, turning about `centre`.
    fn about(self, centre: Point) -> Self {
        let arm = centre - self.centre;
        let moved = arm - rotate(arm, -self.off.z);
        let off = Vector3::new(self.off.x + moved.x, self.off.y + moved.y, self.off.z);
        Self { centre, off }
    }
}

/// Where the robot really was at a place of the overlap, as far as the beginning goes: holds whatever
/// drift is taken out of the way there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    time_us: u64,
    /// Odometer, metres.
    pub travelled: f64,
    /// Where the robot really was.
    pub pose: Pose,
}

impl Placed {
    /// Where what was `seen` last was seen from, `led` onto the beginning.
    #[must_use]
    pub fn last(seen: &[Sighting], led: Led) -> Option<Self> {
        let Sighting { pose, time_us, travelled, .. } = *seen.last()?;
        let off = led.at(pose.position);
        let position = pose.position - Vector::new(off.x, off.y);
        let heading = angle::wrap(pose.heading - off.z);
        Some(Self { time_us, travelled, pose: Pose { position, heading } })
    }

    /// What leads there what was `seen`.
    #[must_use]
    pub fn led(&self, seen: &[Sighting]) -> Option<Led> {
        let there = seen.iter().rev().find(|seen| seen.time_us == self.time_us)?.pose;
        let by = there.position - self.pose.position;
        let turn = angle::wrap(there.heading - self.pose.heading);
        Some(Led { centre: there.position, off: Vector3::new(by.x, by.y, turn) })
    }

    /// Where the robot really is when it believes itself `here`, on from there along its `path`; none where that
    /// does not reach back.
    #[must_use]
    pub fn on(&self, path: &[PathPoint], here: Pose) -> Option<Point> {
        let after = path.partition_point(|place| place.time_us < self.time_us);
        let then = path.get(after).map(|place| place.pose)?;
        Some(self.pose.to_world(then.to_local(here.position)))
    }
}

/// How what was driven more than `beyond` metres after the end of the lap lies on the beginning, about as
/// the piece before, which `led` there; and how it leads on. A gyro drifts on in a long overlap, so that
/// no more than a few metres of it lie there as one.
#[must_use]
pub fn lead_on(closure: &Closure, sightings: &[Sighting], beyond: f64, led: Led) -> (Overlap, Led) {
    let driven = driven_beyond(closure, sightings);
    let (laid, _) = lead(closure, sightings, &(beyond..driven), led, ASTRAY, None);
    let on = Led::by(&laid);
    (laid, on)
}

/// How far was driven after the end of the lap, metres, and a little more.
pub(super) fn driven_beyond(closure: &Closure, sightings: &[Sighting]) -> f64 {
    0.05 + sightings.last().map_or(0.0, |s| s.travelled) - closure.to.travelled
}

/// How what was driven `along` the overlap, metres after the end of the lap, lies on the beginning, led
/// there by what lay beside it but for `astray`; and when it was there first and last (robot time).
fn lead(
    closure: &Closure,
    sightings: &[Sighting],
    along: &Range<f64>,
    led: Led,
    astray: (f64, f64),
    doubt: Option<(f64, f64)>,
) -> (Overlap, Option<(u64, u64)>) {
    let range = |s: &&Sighting| s.alive && s.kind == ContactKind::Range;
    let around = along.start * (1.0 - STRETCHED) - 0.3..along.end * (1.0 + STRETCHED) + 0.5;
    let within = |s: &&Sighting| around.contains(&(s.travelled - closure.from.travelled));
    let of_it = |s: &&Sighting| along.contains(&(s.travelled - closure.to.travelled));
    let seen = sightings.iter().filter(range);
    let first: Vec<&Sighting> = seen.clone().filter(within).collect();
    let again: Vec<&Sighting> = seen.filter(of_it).collect();
    let early: Vec<Seen> = first.iter().map(|s| s.seen()).collect();
    let late: Vec<Seen> = again.iter().map(|s| s.seen()).collect();
    let centre = again.first().map_or(led.centre, |first| first.point);
    let Led { off, .. } = led.about(centre);
    let (way, heading) = (astray.0.powi(-2), astray.1.powi(-2));
    let prior = Matrix3::from_diagonal(&Vector3::new(way, way, heading));
    let expected = (prior, prior * off);
    let laid = match doubt {
        Some(doubt) => lay_as(&early, &late, centre, expected, &[off], doubt),
        None => lay(&early, &late, centre, expected, &[off]),
    };
    let (by, turn) = (Vector::new(laid.found.x, laid.found.y), laid.found.z);
    let placed = |at: Point| centre + rotate(at - centre, -turn) - by;
    let mut times: Vec<u64> = again
        .iter()
        .filter_map(|s| {
            let off = |early: &&&Sighting| (early.point - placed(s.point)).norm_squared();
            first.iter().min_by(|a, b| off(a).total_cmp(&off(b))).map(|early| early.time_us)
        })
        .collect();
    times.sort_unstable();
    let times = times.get(times.len() / 2).zip(again.get(again.len() / 2));
    (laid, times.map(|(early, late)| (*early, late.time_us)))
}

/// A piece of an overlap, how it lies on the beginning, and when the robot was there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    laid: Overlap,
    early_us: u64,
    late_us: u64,
}

impl Piece {
    /// Tells `survey` what was seen of the piece.
    pub(super) fn close(&self, survey: &mut Survey) {
        let knots = survey.knots();
        let (early, late) = (survey.tie(self.early_us, knots), survey.tie(self.late_us, knots));
        self.laid.close(survey, &early, &late, survey.place_of(&late));
    }
}

/// The overlap of `closure`, which lies on the beginning as `overlap` says as one, in pieces. What was
/// `seen` is believed where it was before any adjustment.
pub(super) fn pieces(closure: &Closure, seen: &[Sighting], overlap: &Overlap) -> Vec<Piece> {
    let driven = driven_beyond(closure, seen);
    let (mut pieces, mut known) = (Vec::new(), 0);
    // From where it was laid, about its first contact or the end of the lap, onward and back.
    let there = seen.iter().rev().find(|seen| (seen.point - overlap.centre).norm() < 1e-9);
    let there = there.map_or(0.0, |there| there.travelled - closure.to.travelled).max(0.0);
    for (start, back) in [(there, false), (there, true)] {
        let mut led = Led::by(overlap);
        let (mut near, mut length) = (start, PIECE);
        while if back { near > 0.0 } else { near + length < driven + GROWS } {
            let along = if back { near - length..near } else { near..near + length };
            let (laid, times) = lead(closure, seen, &along, led, BEND, Some(overlap.doubt));
            if laid.known < LEAST && (!back || along.start > 0.0) {
                length += GROWS;
                continue;
            }
            let enough = laid.known >= LEAST && laid.agreement >= AGREES;
            if let Some((early_us, late_us)) = times.filter(|_| enough) {
                led = Led::by(&laid);
                known += laid.known;
                pieces.push(Piece { laid, early_us, late_us });
            }
            near = if back { along.start } else { along.end };
            length = PIECE;
        }
    }
    // Where little of it lies in pieces it says more as one.
    if known as f64 > ALL * overlap.known as f64 { pieces } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::circuit::Anchor;
    use crate::mapping::follow::Side;

    /// How long the wall is that both looks are of, metres.
    const LENGTH: f64 = 14.0;

    /// A wall along the x axis with the face of a pillar every two metres, seen from a path beside it
    /// that begins at `travelled`; the robot believes to turn by `drift` radians a metre.
    fn look(travelled: f64, drift: f64) -> Vec<Sighting> {
        let mut believed = Pose::new(0.0, 0.15, 0.0);
        let mut seen = Vec::new();
        for k in 0..(LENGTH / 0.05) as u32 {
            let at = Point::new(f64::from(k) * 0.05, 0.15);
            let pillar = f64::from(k / 40) * 2.0 + 0.3;
            let face = (k % 40 < 4).then(|| Point::new(pillar, 0.02 * f64::from(k % 40 + 1)));
            for place in face.into_iter().chain([Point::new(at.x, 0.0)]) {
                seen.push(Sighting {
                    point: believed.position + rotate(place - at, believed.heading),
                    pose: believed,
                    beam: believed.heading - angle::FRAC_PI_2,
                    kind: ContactKind::Range,
                    sensor: Some(6),
                    rising: true,
                    swept: 0.0,
                    travelled: travelled + at.x,
                    time_us: ((travelled + at.x) * 1e6) as u64,
                    alive: true,
                    ruled_out: 0,
                });
            }
            believed.position += believed.direction() * 0.05;
            believed.heading += drift * 0.05;
        }
        seen
    }

    /// A lap of that length that ended where it began.
    fn closure(lap: f64) -> Closure {
        let anchor = |travelled: f64| {
            let pose = Pose::new(0.0, 0.15, 0.0);
            Anchor { pose, heading: 0.0, travelled, time_us: (travelled.max(0.0) * 1e6) as u64 }
        };
        let (from, to) = (anchor(-0.01), anchor(lap - 0.01));
        let (side, last_round) = (Side::Right, from.travelled);
        Closure {
            from,
            to,
            side,
            drift: 0.0,
            last_round,
            over: to.travelled,
            pocket: None,
            alike: None,
        }
    }

    #[test]
    fn a_long_overlap_with_drift_in_it_lies_on_the_beginning_in_pieces_only() {
        let (lap, drift) = (150.0, 0.003);
        let mut seen = look(0.0, 0.0);
        seen.extend(look(lap, drift));
        let closure = closure(lap);
        let begun = Led::of(closure.to.pose.position, Vector3::zeros());
        let (as_one, _) = lead_on(&closure, &seen, 0.0, begun);
        assert!(as_one.agreement < 0.8, "as one it agrees to {}", as_one.agreement);
        let mut led = begun;
        for driven in 1..LENGTH as u32 {
            let until = f64::from(driven);
            let driven_by_now = |s: &&Sighting| s.travelled < lap + until;
            let now: Vec<Sighting> = seen.iter().filter(driven_by_now).copied().collect();
            let (piece, on) = lead_on(&closure, &now, (until - 4.0).max(0.0), led);
            assert!(piece.agreement > 0.95, "to {} at {until} m", piece.agreement);
            led = on;
        }
        // The last piece is turned by what the gyro drifted until the middle of it.
        let turned = drift * (LENGTH - 3.0);
        assert!((led.off.z - turned).abs() < 0.004, "{} not {turned}", led.off.z);
    }

    #[test]
    fn the_pieces_say_by_how_much_the_pose_was_off_at_each_place() {
        let (lap, drift) = (150.0, 0.006);
        let mut seen = look(0.0, 0.0);
        seen.extend(look(lap, drift).into_iter().filter(|seen| seen.travelled < lap + 6.0));
        let closure = closure(lap);
        let begun = Led::of(closure.to.pose.position, Vector3::zeros());
        let (overlap, _) = lead_on(&closure, &seen, 0.0, begun);
        let pieces = pieces(&closure, &seen, &overlap);
        assert!(pieces.len() >= 5, "{} pieces of 6 m", pieces.len());
        for piece in &pieces {
            let there = piece.late_us as f64 * 1e-6 - lap;
            let turned = piece.laid.found.z;
            let (as_one, off) = (overlap.found.z - drift * there, turned - drift * there);
            assert!(off.abs() < 0.004 + 0.3 * as_one.abs(), "{turned} at {there} m");
            let late_by = (piece.late_us as f64 - piece.early_us as f64) * 1e-6 - lap;
            assert!(late_by.abs() < 0.3, "laid {late_by} m off where it was");
        }
    }

    #[test]
    fn where_the_robot_was_holds_whatever_drift_is_taken_out() {
        let seen = look(0.0, 0.002);
        let led = Led::of(Point::new(1.0, 0.3), Vector3::new(0.04, -0.02, 0.03));
        let placed = Placed::last(&seen, led).expect("something was seen");
        let again = placed.led(&seen).expect("it was seen").at(Point::origin());
        assert!((again - led.at(Point::origin())).norm() < 1e-9, "{again}");
        // Turned and moved as one, what was seen is led to the same place.
        let moved: Vec<Sighting> = look(0.0, 0.0);
        let last = moved.last().expect("something was seen").pose;
        let off = placed.led(&moved).expect("it was seen").at(last.position);
        let there = last.position - Vector::new(off.x, off.y);
        assert!((there - placed.pose.position).norm() < 1e-9, "{there}");
        assert!((last.heading - off.z - placed.pose.heading).abs() < 1e-9);
    }
}
