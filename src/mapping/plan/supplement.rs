//! What a driven plan still owes: objects cut lines short and odometry bends them, so places may
//! be left where too large a disc could hide. The paper's own lines serve them first; where none
//! passes, a straight line through the place along its longest free direction.

use super::cover::Need;
use super::{MARGIN, Work, drive, lanes};
use crate::geometry::{Point, Segment, angle};
use crate::mapping::floor::{Coverage, Floor, HiddenDisc, Unswept};
use crate::mapping::map::{PlanLine, Shape};

/// Rounds of looking at what is left.
const ROUNDS: usize = 6;
/// Lines at most in one answer.
const MOST: usize = 60;
/// Directions tried through a place, over half a turn.
const DIRECTIONS: u32 = 12;

/// Further lines to drive, so that no disc of α less a margin stays hidden on `floor` after
/// `coverage`; empty when there is no such place left or nothing can serve it. `lines` are all of
/// the plan's; those taken again keep their id, new ones are numbered after the last.
#[must_use]
pub fn supplement(
    floor: &Floor,
    shape: &Shape,
    coverage: &Coverage,
    lines: &[PlanLine],
    alpha: f64,
) -> Vec<PlanLine> {
    let work = Work {
        floor,
        shape,
        lap: Unswept::new(floor, coverage.segments()),
        from: Point::origin(),
        target: (alpha - MARGIN).max(0.0),
        alpha,
    };
    let mut next = lines.iter().map(|line| line.id).max().unwrap_or(0) + 1;
    let mut added: Vec<PlanLine> = Vec::new();
    let mut covered = coverage.clone();
    for _ in 0..ROUNDS {
        let unswept = Unswept::new(floor, covered.segments());
        let spots = unswept.spots(work.target, usize::MAX);
        if spots.is_empty() || added.len() >= MOST {
            break;
        }
        let before = added.len();
        let mut need = Need::new(floor, &unswept, (work.target / 2.0 - 0.003).max(0.002), 1);
        for spot in spots {
            let near = |l: &PlanLine| l.drive.is_some_and(|(a, b)| serves(&work, &spot, a, b));
            if added[before..].iter().any(near) || added.len() >= MOST {
                continue;
            }
            let Some((from, to, old)) = serving(&work, &need, lines, &spot) else {
                continue;
            };
            need.serve(&need.span(&[Segment::new(from, to)]));
            covered.add_line(from, to);
            let id = old.filter(|id| !added.iter().any(|l| l.id == *id)).unwrap_or_else(|| {
                next += 1;
                next - 1
            });
            added.push(lanes::line(&work, id, from, to));
        }
        if added.len() == before {
            break;
        }
    }
    added
}

/// Whether driving from `a` to `b` makes the disc smaller.
fn serves(work: &Work<'_>, spot: &HiddenDisc, a: Point, b: Point) -> bool {
    let off = Segment::new(a, b).distance_squared(spot.at).sqrt();
    off < work.floor.reach + spot.diameter / 2.0 - 0.005
}

/// The stretch that serves a place: of a line of the plan (then with its id), else through it.
fn serving(
    work: &Work<'_>,
    need: &Need,
    lines: &[PlanLine],
    spot: &HiddenDisc,
) -> Option<(Point, Point, Option<u32>)> {
    let mut choice = Choice { work, need, spot, best: None };
    // Walking along a line for its free pieces is dear: only those that pass here at all.
    let passes = |line: &&PlanLine| line.drive.is_some_and(|(a, b)| serves(work, spot, a, b));
    for line in lines.iter().filter(passes) {
        for (from, to) in drive::free_pieces(work.floor, line) {
            choice.offer(from, to, Some(line.id));
        }
    }
    if choice.best.is_none() {
        let at = drivable_near(work.floor, spot)?;
        for k in 0..DIRECTIONS {
            let direction = angle::unit(angle::PI * f64::from(k) / f64::from(DIRECTIONS));
            if let Some((from, to)) = drive::through(work.floor, at, direction) {
                choice.offer(from, to, None);
            }
        }
    }
    choice.best.map(|(_, from, to, id)| (from, to, id))
}

/// The best stretch so far for one place.
struct Choice<'a> {
    work: &'a Work<'a>,
    need: &'a Need,
    spot: &'a HiddenDisc,
    /// What it is worth, its ends, and the line of the plan it is a part of.
    best: Option<(f64, Point, Point, Option<u32>)>,
}

impl Choice<'_> {
    fn offer(&mut self, from: Point, to: Point, id: Option<u32>) {
        let piece = Segment::new(from, to);
        let middle = nalgebra::center(&from, &to);
        if !serves(self.work, self.spot, from, to) || !self.work.floor.is_drivable(middle) {
            return;
        }
        let Some(stretch) = self.need.trimmed(&piece) else {
            return;
        };
        let (a, b) = stretched(stretch, &piece);
        let gain = self.need.gain(&self.need.span(&[Segment::new(a, b)])) as f64;
        let worth = gain / ((b - a).norm() + 1.0);
        let better = self.best.is_none_or(|(most, ..)| worth > most);
        if better && serves(self.work, self.spot, a, b) {
            self.best = Some((worth, a, b, id));
        }
    }
}

/// A stretch of no length is driven a little way, so that there is something to drive.
fn stretched((a, b): (Point, Point), piece: &Segment) -> (Point, Point) {
    let length = piece.length();
    if (b - a).norm() >= 0.1 || length <= 0.1 {
        return if length <= 0.1 { (piece.from, piece.to()) } else { (a, b) };
    }
    let along = piece.along / length;
    let at = (a - piece.from).dot(&along).clamp(0.05, length - 0.05);
    (piece.from + along * (at - 0.05), piece.from + along * (at + 0.05))
}

/// The drivable place nearest to the middle of the disc, if it is near enough to serve it.
fn drivable_near(floor: &Floor, spot: &HiddenDisc) -> Option<Point> {
    let reach = floor.reach + spot.diameter / 2.0 - 0.01;
    let mut best: Option<(f64, Point)> = None;
    let around = Segment::new(spot.at, spot.at);
    floor.grid.stadium_runs(&around, reach, |row, first, last| {
        for x in first..=last {
            let cell = row * floor.grid.width + x;
            let at = floor.grid.point(cell);
            let off = (at - spot.at).norm();
            if floor.drivable[cell] && best.is_none_or(|(least, _)| off < least) {
                best = Some((off, at));
            }
        }
    });
    best.map(|(_, at)| at)
}
