//! The paper's plan to the letter: every vertex to every opposite edge, an end point every α.

use super::circle::Disc;
use super::entries::{Entries, Entry};
use crate::geometry::visibility::Sight;
use crate::geometry::{Piece, Point, Segment, angle, cross, ring};
use crate::mapping::floor::Floor;
use crate::mapping::map::{LineReason, Part, PlanLine, Shape};
use crate::mapping::shape::TURN_POINT;

/// Arcs of polygonal parts are judged by chords within this, metres.
const SAGITTA: f64 = 0.001;
/// The last line of a fan is left out when it ends within this of the one before, metres: less than
/// walls are known to.
const LAST: f64 = 0.005;
/// Places nearer than this are one and the same, metres.
const SAME: f64 = 1e-9;

/// All entries of the plan for every part of `shape`, the rejected ones with their reason, numbered
/// from 1. `seed` picks the first diameter of a circle.
#[must_use]
pub fn lines(floor: &Floor, shape: &Shape, alpha: f64, seed: u64) -> Vec<PlanLine> {
    let discs: Vec<Option<Disc<'_>>> =
        shape.parts.iter().enumerate().map(|(index, part)| Disc::new(index, part, alpha)).collect();
    let polygons = shape.parts.iter().zip(&discs).filter(|(_, disc)| disc.is_none());
    let cuts = polygons.flat_map(|(part, _)| part.ring.pieces.iter().zip(&part.cut));
    let cuts = cuts.filter(|(_, cut)| **cut).map(|(p, _)| Segment::new(p.from(), p.to())).collect();
    let mut entries = Entries::new(floor, cuts);
    for (index, (part, disc)) in shape.parts.iter().zip(&discs).enumerate() {
        match disc {
            Some(disc) => disc.lines(&mut entries, seed),
            None => Fan::new(index, part, alpha).lines(&mut entries),
        }
    }
    entries.into_lines()
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
    /// The pieces that begin at a vertex. An edge is what lies between two of these.
    vertices: Vec<usize>,
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
            vertices: vertices(part),
            joined: vec![false; pieces.len() * pieces.len()],
        }
    }

    fn lines(mut self, entries: &mut Entries<'_>) {
        let count = self.vertices.len();
        for vertex in 0..count {
            // In boundary order from the vertex on, which is the order of rising angle.
            for step in 1..count.saturating_sub(1) {
                self.fan(entries, self.vertices[vertex], (vertex + step) % count);
            }
        }
    }

    /// Lines from `vertex` to places α apart on the opposite `edge`, both its ends included.
    fn fan(&mut self, entries: &mut Entries<'_>, vertex: usize, edge: usize) {
        let count = self.pieces.len();
        let (begin, after) = (self.vertices[edge], self.vertices[(edge + 1) % self.vertices.len()]);
        self.fan_to_vertex(entries, vertex, begin);
        let (mut piece, mut before) = (begin, 0.0);
        let parts = (after + count - begin - 1) % count + 1;
        let length: f64 = (0..parts).map(|k| self.pieces[(begin + k) % count].length()).sum();
        // A wall measured a millimetre too long does not get a line more.
        let steps = (length / self.alpha - LAST.min(0.1 * self.alpha) / self.alpha).ceil();
        let steps = steps.max(1.0) as u32;
        for k in 1..steps {
            let gone = f64::from(k) * self.alpha;
            while (piece + 1) % count != after
                && gone - before >= self.pieces[piece].length() - SAME
            {
                before += self.pieces[piece].length();
                piece = (piece + 1) % count;
            }
            self.fan_to_place(entries, vertex, piece, gone - before);
        }
        self.fan_to_vertex(entries, vertex, after);
    }

    /// The line from `vertex` to the place that lies `gone` metres along a piece.
    fn fan_to_place(&self, entries: &mut Entries<'_>, vertex: usize, piece: usize, gone: f64) {
        let (from, to) = (self.first[vertex], self.first[piece]);
        let share = gone / self.pieces[piece].length();
        let end = self.pieces[piece].at(share);
        let chords = f64::from(chords_of(&self.pieces[piece]));
        let chord = to + ((share * chords) as usize).min(chords as usize - 1);
        let inside = if gone < SAME {
            self.sight.corner_to_corner(from, to)
        } else {
            self.sight.corner_to_edge(from, chord, end)
        };
        let reason = match self.along(vertex, end) {
            Some(true) => Some(LineReason::AlongBoundary),
            _ if !inside => Some(LineReason::LeavesArea),
            _ => None,
        };
        self.enter(entries, vertex, end, reason);
    }

    fn fan_to_vertex(&mut self, entries: &mut Entries<'_>, vertex: usize, other: usize) {
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
        entries.enter(&Entry {
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
        self.runs(vertex, end, forwards).or_else(|| self.runs(vertex, end, backwards))
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
                && cross(way, gone).abs() <= SAME * length
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

/// The pieces of a part that begin at a vertex. Where a straight piece goes on in the direction of the one before
/// there is none (III.D): lines from there would look at what those of the true vertices look at. Where a cut goes
/// on as a wall, the outline of the room does turn.
fn vertices(part: &Part) -> Vec<usize> {
    let pieces = &part.ring.pieces;
    let count = pieces.len();
    let is_cut = |k: usize| part.cut.get(k).copied().unwrap_or(false);
    let turns = |from: usize, to: usize| match (pieces[from], pieces[to]) {
        (Piece::Line { .. }, Piece::Line { .. }) if is_cut(from) == is_cut(to) => {
            let (u, v) = (pieces[from].tangent(1.0), pieces[to].tangent(0.0));
            angle::atan2(cross(u, v), u.dot(&v)).abs() > TURN_POINT
        }
        _ => true,
    };
    let Some(start) = (0..count).find(|&k| turns((k + count - 1) % count, k)) else {
        return (0..count).collect();
    };
    let mut vertices = vec![start];
    for k in (start + 1..start + count).map(|k| k % count) {
        // Small turns one after the other make a large one.
        if vertices.last().is_some_and(|&side| turns(side, k)) {
            vertices.push(k);
        }
    }
    vertices.sort_unstable();
    if vertices.len() < 3 { (0..count).collect() } else { vertices }
}

fn chords_of(piece: &Piece) -> u32 {
    match *piece {
        Piece::Line { .. } => 1,
        Piece::Arc { radius, sweep, .. } => ring::chord_count(radius, sweep, SAGITTA),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ring;
    use crate::mapping::floor::rooms;
    use crate::mapping::map::LineStatus;

    fn planned(room: &Ring, alpha: f64) -> Vec<PlanLine> {
        let floor = rooms::floor(room, &[]);
        lines(&floor, &rooms::shape(room), alpha, 1)
    }

    fn count(lines: &[PlanLine], reason: Option<LineReason>) -> usize {
        lines.iter().filter(|line| line.reason == reason).count()
    }

    #[test]
    fn a_square_at_half_its_side_has_the_lines_counted_by_hand() {
        // Each of 4 vertices has 2 opposite edges with 3 end points: 24 entries. Per vertex two
        // lie along walls, two go to middles, two go to the far corner. Kept: 8 middles and the 2
        // diagonals; of the 8 entries for diagonals 6 are duplicates.
        let lines = planned(&rooms::rectangle(1.0, 1.0), 0.5);
        assert_eq!(lines.len(), 24);
        assert_eq!(count(&lines, None), 10);
        assert_eq!(count(&lines, Some(LineReason::AlongBoundary)), 8);
        assert_eq!(count(&lines, Some(LineReason::Duplicate)), 6);
        assert!(lines.iter().zip(1..).all(|(line, id)| line.id == id));
    }

    #[test]
    fn a_room_measured_a_little_too_large_has_the_lines_of_the_room() {
        // 5 m by 4 m at α = 1: from each vertex 4 to the edge of 5 m and 3 to that of 4 m, and the two
        // diagonals: 4 * 7 + 2.
        for excess in [0.0, 0.0004, 0.003] {
            let lines = planned(&rooms::rectangle(5.0 + excess, 4.0 + excess), 1.0);
            assert_eq!(count(&lines, None), 30, "{excess}");
        }
    }

    #[test]
    fn where_a_wall_does_not_turn_there_is_no_vertex() {
        let whole = planned(&rooms::rectangle(4.0, 3.0), 0.5);
        // In the middle, off the places that lines lead to, and bent as little as a fit bends a wall.
        for (x, y) in [(2.0, 0.0), (1.3, 0.0), (1.3, 0.01), (1.3, -0.01)] {
            let corners = [(0.0, 0.0), (x, y), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)];
            let lines = planned(&rooms::polygon(&corners), 0.5);
            assert_eq!(count(&lines, None), count(&whole, None), "{x}, {y}");
            let ends = |lines: &[PlanLine]| -> Vec<Point> {
                let kept = lines.iter().filter(|line| line.reason.is_none());
                kept.map(|line| line.end).collect()
            };
            for (a, b) in ends(&lines).iter().zip(ends(&whole)) {
                assert!((a - b).norm() < 0.02, "{a} instead of {b} by {x}, {y}");
            }
        }
        assert_eq!(count(&whole, None), 50);
    }

    #[test]
    fn a_turn_is_a_vertex_however_many_small_ones_make_it() {
        // A wall of three pieces, bent by 0.8 degrees at a time.
        let bend = |k: f64| (0.8 * k).to_radians();
        let (b, c) = (Point::new(1.5, 0.0), Point::new(3.0, 1.5 * angle::tan(bend(1.0))));
        let d = c + angle::unit(bend(2.0)) * 1.5;
        let corners = [(0.0, 0.0), (b.x, b.y), (c.x, c.y), (d.x, d.y), (d.x, 3.0), (0.0, 3.0)];
        let lines = planned(&rooms::polygon(&corners), 0.5);
        let mut vertices: Vec<usize> = lines.iter().map(|line| line.vertex).collect();
        vertices.dedup();
        assert_eq!(vertices, [0, 2, 3, 4, 5]);
    }

    #[test]
    fn a_triangle_has_one_opposite_edge_a_vertex_and_its_last_line_is_short() {
        // Sides 3, 4 and 5 at α = 0.7: 4, 5 and 7 end points between the ends of the edges
        // opposite, and both ends, which lie along walls.
        let triangle = rooms::polygon(&[(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)]);
        let lines = planned(&triangle, 0.7);
        let narrow = count(&lines, Some(LineReason::NoClearance));
        assert_eq!(count(&lines, None) + narrow, 4 + 5 + 7);
        assert_eq!(narrow, 1, "beside the wall of 3 m, 80 mm off at its end");
        assert_eq!(count(&lines, Some(LineReason::AlongBoundary)), 6);
        let fan: Vec<&PlanLine> = lines.iter().filter(|line| line.vertex == 0).collect();
        let last = fan.windows(2).map(|w| (w[1].end - w[0].end).norm()).next_back().unwrap();
        assert!((last - (5.0 - 7.0 * 0.7)).abs() < 1e-9, "the last step is {last} m");
    }

    #[test]
    fn the_angle_is_anti_clockwise_from_the_outgoing_edge_and_rises_within_a_fan() {
        let lines = planned(&rooms::rectangle(5.0, 4.0), 0.5);
        for line in &lines {
            let inner = angle::FRAC_PI_2;
            assert!(line.angle <= inner + 1e-9, "{line:?}");
        }
        let middle = lines.iter().find(|l| l.vertex == 0 && l.end == Point::new(5.0, 0.5));
        let want = angle::atan2(0.5, 5.0);
        assert!((middle.unwrap().angle - want).abs() < 1e-12);
        for fan in lines.chunk_by(|a, b| a.vertex == b.vertex) {
            assert!(fan.windows(2).all(|w| w[0].angle <= w[1].angle + 1e-9));
        }
    }

    #[test]
    fn in_an_ell_the_lines_across_the_notch_leave_the_area() {
        let lines = planned(&rooms::ell(), 0.5);
        let (a, b) = (Point::new(4.0, 1.5), Point::new(2.0, 3.0));
        let across = lines.iter().find(|l| l.start == a && l.end == b).unwrap();
        assert_eq!(across.reason, Some(LineReason::LeavesArea));
        assert_eq!(across.status, LineStatus::Rejected);
        // From (0, 1.5) to (4, 1.5) a line would just touch the notch's wall: it stays. From the
        // vertex (4, 1.5) along that wall and on across the room it is no boundary line either.
        let grazing = lines.iter().find(|l| l.start == a && l.end == Point::new(0.0, 1.5));
        assert_eq!(grazing.unwrap().reason, None);
    }

    #[test]
    fn lines_along_a_cut_stay_once() {
        let (left, right) = (rooms::boxed(0.0, 0.0, 2.0, 2.0), rooms::boxed(2.0, 0.0, 4.0, 2.0));
        let mut shape = rooms::shape(&rooms::rectangle(4.0, 2.0));
        let mut part = shape.parts.remove(0);
        part.ring = left;
        part.cut = vec![false, true, false, false];
        shape.parts.push(part.clone());
        part.ring = right;
        part.cut = vec![false, false, false, true];
        shape.parts.push(part);
        let floor = rooms::floor(&shape.outline, &[]);
        let lines = lines(&floor, &shape, 0.5, 1);
        let along = |line: &&PlanLine| line.start.x == 2.0 && line.end.x == 2.0;
        let kept = lines.iter().filter(along).filter(|line| line.reason.is_none()).count();
        assert_eq!(kept, 1, "the cut is driven along once");
        assert!(lines.iter().filter(along).count() >= 4);
    }

    #[test]
    fn end_points_lie_no_further_than_alpha_apart_on_every_opposite_edge() {
        let lines = planned(&rooms::flat(), 0.3);
        let mut steps = 0;
        for pair in lines.windows(2) {
            let same_edge = pair[0].vertex == pair[1].vertex;
            let step = (pair[1].end - pair[0].end).norm();
            if same_edge && step > 1e-9 {
                assert!(step <= 0.3 + 1e-9, "{step} m between {} and {}", pair[0].end, pair[1].end);
                steps += 1;
            }
        }
        assert!(steps > 1000, "{steps} steps looked at");
    }
}
