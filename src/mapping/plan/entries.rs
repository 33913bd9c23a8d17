//! The plan's entries as they are made: numbers them, finds the piece of each that can be driven,
//! and says why not where there is none.

use super::drive;
use crate::geometry::{Point, Segment};
use crate::mapping::floor::Floor;
use crate::mapping::map::{LineReason, LineStatus, PlanLine};

/// Lines that leave the area, and duplicates, are kept for the record up to this many each: real
/// flats have half a million of them, and nobody reads those.
const MOST_REJECTED: usize = 4000;
/// Ends nearer than this are one and the same, metres.
const SAME: f64 = 1e-6;

/// The entries so far.
pub(super) struct Entries<'a> {
    pub(super) floor: &'a Floor,
    lines: Vec<PlanLine>,
    /// Cuts that bound a polygonal part, which has a line along each.
    cuts: Vec<Segment>,
    /// Ends of lines along cuts: the part on the other side has the same line.
    along_cuts: Vec<(Point, Point)>,
    leaving: usize,
    duplicate: usize,
}

/// A line about to be entered.
pub(super) struct Entry {
    pub(super) part: usize,
    pub(super) vertex: usize,
    pub(super) start: Point,
    pub(super) end: Point,
    pub(super) angle: f64,
    pub(super) reason: Option<LineReason>,
}

impl<'a> Entries<'a> {
    /// None yet; `cuts` are those that bound polygonal parts.
    pub(super) fn new(floor: &'a Floor, cuts: Vec<Segment>) -> Self {
        Self { floor, lines: Vec::new(), cuts, along_cuts: Vec::new(), leaving: 0, duplicate: 0 }
    }

    pub(super) fn into_lines(self) -> Vec<PlanLine> {
        self.lines
    }

    /// Enters a line; a sound one whose body fits nowhere is rejected for that.
    pub(super) fn enter(&mut self, entry: &Entry) {
        let common = match entry.reason {
            Some(LineReason::LeavesArea) => Some(&mut self.leaving),
            Some(LineReason::Duplicate) => Some(&mut self.duplicate),
            _ => None,
        };
        if let Some(count) = common {
            *count += 1;
            if *count > MOST_REJECTED {
                return;
            }
        }
        let drive = if entry.reason.is_none() {
            drive::piece(self.floor, entry.start, entry.end)
        } else {
            None
        };
        let reason = match (entry.reason, drive) {
            (None, None) => Some(self.why_not(entry.start, entry.end)),
            (reason, _) => reason,
        };
        self.lines.push(PlanLine {
            id: self.lines.len() as u32 + 1,
            part: entry.part,
            vertex: entry.vertex,
            start: entry.start,
            end: entry.end,
            angle: entry.angle,
            drive,
            status: match reason {
                None => LineStatus::Planned,
                Some(LineReason::CoveredByObjects) => LineStatus::Skipped,
                Some(_) => LineStatus::Rejected,
            },
            reason,
        });
    }

    fn why_not(&self, start: Point, end: Point) -> LineReason {
        let middle = nalgebra::center(&start, &end);
        if self.floor.object_clearance(middle) < self.floor.radius {
            LineReason::CoveredByObjects
        } else {
            LineReason::NoClearance
        }
    }

    /// Whether a polygonal part has a line along the cut on which all of these `places` lie, within `off` metres.
    pub(super) fn polygon_has(&self, places: &[Point], off: f64) -> bool {
        let on = |cut: &Segment| places.iter().all(|&p| cut.distance_squared(p) < off * off);
        self.cuts.iter().any(on)
    }

    /// Whether the line along a cut was entered from the other side; remembers it if not.
    pub(super) fn crossed_before(&mut self, start: Point, end: Point) -> bool {
        let same = |a: Point, b: Point| (a - b).norm() < SAME;
        let known = self
            .along_cuts
            .iter()
            .any(|&(a, b)| (same(a, start) && same(b, end)) || (same(a, end) && same(b, start)));
        if !known {
            self.along_cuts.push((start, end));
        }
        known
    }
}
