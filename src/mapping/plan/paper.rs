//! The paper's plan to the letter: every vertex to every opposite edge, an end point every α.

use super::{circle, drive};
use crate::geometry::visibility::Sight;
use crate::geometry::{Piece, Point, angle, ring};
use crate::mapping::floor::Floor;
use crate::mapping::map::{LineReason, LineStatus, Part, PartClass, PlanLine, Shape};

/// Arcs of polygonal parts are judged by chords within this, metres.
const SAGITTA: f64 = 0.001;
/// Lines that leave the area are kept for the record up to this many; real flats have half a
/// million of them, and nobody reads those.
const MOST_REJECTED: usize = 4000;
/// Places nearer than this are one and the same, metres.
const SAME: f64 = 1e-9;

/// All entries of the plan for every part of `shape`, the rejected ones with their reason, numbered
/// from 1. `seed` picks the first diameter of a circle.
#[must_use]
pub fn lines(floor: &Floor, shape: &Shape, alpha: f64, seed: u64) -> Vec<PlanLine> {
    let mut entries = Entries {
        floor,
        lines: Vec::new(),
        along_cuts: Vec::new(),
        left: 0,
    };
    for (index, part) in shape.parts.iter().enumerate() {
        match (part.class, part.circle) {
            (PartClass::Circle | PartClass::Semicircle | PartClass::Sector, Some(_)) => {
                circle::lines(&mut entries, index, part, alpha, seed);
            }
            _ => Fan::new(index, part, alpha).lines(&mut entries),
        }
    }
    entries.lines
}

/// The entries so far.
pub(super) struct Entries<'a> {
    pub(super) floor: &'a Floor,
    lines: Vec<PlanLine>,
    /// Ends of lines along cuts: the part on the other side has the same line.
    along_cuts: Vec<(Point, Point)>,
    left: usize,
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

impl Entries<'_> {
    /// Enters a line; a sound one whose body fits nowhere is rejected for that.
    pub(super) fn enter(&mut self, entry: Entry) {
        if entry.reason == Some(LineReason::LeavesArea) {
            self.left += 1;
            if self.left > MOST_REJECTED {
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

    /// Whether the line along a cut was entered from the other side; remembers it if not.
    fn crossed_before(&mut self, start: Point, end: Point) -> bool {
        let same = |a: Point, b: Point| (a - b).norm() < 1e3 * SAME;
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

/// The plan of one polygonal part.
struct Fan<'a> {
    part: usize,
    pieces: &'a [Piece],
    cut: &'a [bool],
    alpha: f64,
    sight: Sight,
    corners: Vec<Point>,
    /// For every piece, the first of its corners in `corners`.
    first: Vec<usize>,
    /// Which pairs of vertices have their line.
    joined: Vec<bool>,
}

impl<'a> Fan<'a> {
    fn new(index: usize, part: &'a Part, alpha: f64) -> Self {
        let pieces = &part.ring.pieces;
        let (mut corners, mut first) = (Vec::new(), Vec::new());
        for piece in pieces {
            first.push(corners.len());
            let chords = chords_of(piece);
            corners.extend((0..chords).map(|k| piece.at(f64::from(k) / f64::from(chords))));
        }
        Self {
            part: index,
            pieces,
            cut: &part.cut,
            alpha,
            sight: Sight::new(corners.clone()),
            corners,
            first,
            joined: vec![false; pieces.len() * pieces.len()],
        }
    }

    fn lines(mut self, entries: &mut Entries<'_>) {
        let count = self.pieces.len();
        for vertex in 0..count {
            // In boundary order from the vertex on, which is the order of rising angle.
            for step in 1..count.saturating_sub(1) {
                self.fan(entries, vertex, (vertex + step) % count);
            }
        }
    }

    /// Lines from `vertex` to places α apart on the opposite `edge`, both its ends included.
    fn fan(&mut self, entries: &mut Entries<'_>, vertex: usize, edge: usize) {
        let count = self.pieces.len();
        let after = (edge + 1) % count;
        let length = self.pieces[edge].length();
        self.to_vertex(entries, vertex, edge);
        let steps = (length / self.alpha - SAME).ceil().max(1.0) as u32;
        for k in 1..steps {
            let share = f64::from(k) * self.alpha / length;
            let end = self.pieces[edge].at(share);
            let chords = f64::from(chords_of(&self.pieces[edge]));
            let chord = self.first[edge] + ((share * chords) as usize).min(chords as usize - 1);
            let inside = self.sight.corner_to_edge(self.first[vertex], chord, end);
            let reason = match self.along(vertex, end) {
                Some(true) => Some(LineReason::AlongBoundary),
                _ if !inside => Some(LineReason::LeavesArea),
                _ => None,
            };
            self.enter(entries, vertex, end, reason);
        }
        self.to_vertex(entries, vertex, after);
    }

    fn to_vertex(&mut self, entries: &mut Entries<'_>, vertex: usize, other: usize) {
        let (from, to) = (self.first[vertex], self.first[other]);
        let end = self.corners[to];
        let (low, high) = (vertex.min(other), vertex.max(other));
        let pair = low * self.pieces.len() + high;
        let along = self.along(vertex, end);
        let reason = if along == Some(true) {
            Some(LineReason::AlongBoundary)
        } else if !self.sight.corner_to_corner(from, to) {
            Some(LineReason::LeavesArea)
        } else if self.joined[pair]
            || (along.is_some() && entries.crossed_before(self.corners[from], end))
        {
            Some(LineReason::Duplicate)
        } else {
            self.joined[pair] = true;
            None
        };
        self.enter(entries, vertex, end, reason);
    }

    fn enter(
        &self,
        entries: &mut Entries<'_>,
        vertex: usize,
        end: Point,
        reason: Option<LineReason>,
    ) {
        let start = self.corners[self.first[vertex]];
        let boundary = angle::of(self.pieces[vertex].tangent(0.0));
        entries.enter(Entry {
            part: self.part,
            vertex,
            start,
            end,
            angle: angle::wrap_positive(angle::of(end - start) - boundary),
            reason,
        });
    }

    /// Whether the line from `vertex` to `end` coincides with the outline: `Some(true)` where that
    /// is wall all along, `Some(false)` where some of it is a cut that nobody drove along.
    fn along(&self, vertex: usize, end: Point) -> Option<bool> {
        let count = self.pieces.len();
        let forwards = (0..count).map(|k| {
            let piece = (vertex + k) % count;
            (piece, self.pieces[piece].to())
        });
        let backwards = (1..=count).map(|k| {
            let piece = (vertex + count - k) % count;
            (piece, self.pieces[piece].from())
        });
        self.runs(vertex, end, forwards)
            .or_else(|| self.runs(vertex, end, backwards))
    }

    fn runs(
        &self,
        vertex: usize,
        end: Point,
        walk: impl Iterator<Item = (usize, Point)>,
    ) -> Option<bool> {
        let start = self.corners[self.first[vertex]];
        let way = end - start;
        let length = way.norm();
        let mut walls = true;
        for (piece, next) in walk {
            let gone = next - start;
            let straight = matches!(self.pieces[piece], Piece::Line { .. })
                && crate::geometry::cross(way, gone).abs() <= SAME * length
                && gone.dot(&way) > 0.0;
            if !straight {
                return None;
            }
            walls &= !self.cut.get(piece).copied().unwrap_or(false);
            if gone.norm() >= length - SAME {
                return Some(walls);
            }
        }
        None
    }
}

fn chords_of(piece: &Piece) -> u32 {
    match *piece {
        Piece::Line { .. } => 1,
        Piece::Arc { radius, sweep, .. } => ring::chord_count(radius, sweep, SAGITTA),
    }
}
