//! The sheet of paper under a picture of the map: which part of the world is shown at which
//! scale, and the SVG path data of outlines and lines on it. Knows geometry, not maps.

use crate::geometry::{Piece, Point, Ring, thin};
use std::fmt::Write;

/// Largest extent of the drawing itself, pixels.
const WIDEST: f64 = 1040.0;
const HIGHEST: f64 = 780.0;
/// Largest scale, pixels a metre: a tiny room is not blown up without end.
const LARGEST_SCALE: f64 = 400.0;
/// What lies no farther than this off a line, pixels, is not seen beside it: data are written to a tenth.
const UNSEEN: f64 = 0.1;

/// Where world points are on the sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Pixels a metre.
    pub scale: f64,
    /// Width of the drawing, pixels.
    pub width: f64,
    /// Height of the drawing, pixels.
    pub height: f64,
    /// World point at the upper left corner of the drawing.
    corner: Point,
    /// Pixels from the sheet's upper left corner to the drawing's.
    offset: (f64, f64),
}

impl Frame {
    /// Shows the box from `low` to `high` (metres) as large as the sheet allows, with the
    /// drawing's upper left corner at `offset` pixels.
    #[must_use]
    pub fn around(low: Point, high: Point, offset: (f64, f64)) -> Self {
        let size = (high - low).map(|extent| extent.max(0.1));
        let scale = (WIDEST / size.x).min(HIGHEST / size.y).min(LARGEST_SCALE);
        Self {
            scale,
            width: size.x * scale,
            height: size.y * scale,
            corner: Point::new(low.x, low.y + size.y),
            offset,
        }
    }

    /// The same drawing with its upper left corner elsewhere, pixels.
    #[must_use]
    pub fn moved(self, offset: (f64, f64)) -> Self {
        Self { offset, ..self }
    }

    /// A world point in pixels; y grows downwards on the sheet.
    #[must_use]
    pub fn at(&self, point: Point) -> (f64, f64) {
        let from = point - self.corner;
        (self.offset.0 + from.x * self.scale, self.offset.1 - from.y * self.scale)
    }

    /// The drawing's upper left and lower right corner, pixels.
    #[must_use]
    pub fn corners(&self) -> (Point, Point) {
        let (x, y) = self.offset;
        (Point::new(x, y), Point::new(x + self.width, y + self.height))
    }

    /// Path data of a closed outline; arcs stay arcs.
    #[must_use]
    pub fn ring(&self, ring: &Ring) -> String {
        let Some(first) = ring.pieces.first() else {
            return String::new();
        };
        let mut out = self.start(first.from());
        for piece in &ring.pieces {
            out.push_str(&self.piece(piece));
        }
        out.push('Z');
        out
    }

    /// Path data of one piece.
    #[must_use]
    pub fn single(&self, piece: &Piece) -> String {
        self.start(piece.from()) + &self.piece(piece)
    }

    /// Path data of a line through points; those that no eye misses from it are left out.
    #[must_use]
    pub fn line(&self, points: impl IntoIterator<Item = Point>) -> String {
        let on_sheet = |point| {
            let (x, y) = self.at(point);
            Point::new(x, y)
        };
        let points: Vec<Point> = points.into_iter().map(on_sheet).collect();
        let Some(first) = points.first() else { return String::new() };
        let mut out = format!("M{:.1} {:.1}", first.x, first.y);
        if points.len() > 1 {
            let at = |k: usize| points[k];
            for k in thin::kept(&at, (0, points.len() - 1), UNSEEN) {
                // Writing to a string cannot fail.
                let _ = write!(out, "L{:.1} {:.1}", points[k].x, points[k].y);
            }
        }
        out
    }

    fn start(&self, point: Point) -> String {
        let (x, y) = self.at(point);
        format!("M{x:.1} {y:.1}")
    }

    fn piece(&self, piece: &Piece) -> String {
        match *piece {
            Piece::Line { to, .. } => {
                let (x, y) = self.at(to);
                format!("L{x:.1} {y:.1}")
            }
            // Two halves: one arc cannot be a full circle, nor say which way it goes at a half.
            Piece::Arc { radius, sweep, .. } => {
                let pixels = radius * self.scale;
                let clockwise = u8::from(sweep < 0.0);
                [0.5, 1.0]
                    .map(|t| {
                        let (x, y) = self.at(piece.at(t));
                        format!("A{pixels:.2} {pixels:.2} 0 0 {clockwise} {x:.1} {y:.1}")
                    })
                    .concat()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_in_the_world_is_up_on_the_sheet() {
        let frame = Frame::around(Point::new(0.0, 0.0), Point::new(4.0, 3.0), (10.0, 20.0));
        assert_eq!(frame.at(Point::new(0.0, 3.0)), (10.0, 20.0));
        let (x, y) = frame.at(Point::new(4.0, 0.0));
        assert!((x - 10.0 - frame.width).abs() < 1e-9 && (y - 20.0 - frame.height).abs() < 1e-9);
    }

    #[test]
    fn of_a_line_only_what_can_be_seen_is_drawn() {
        let frame = Frame::around(Point::new(0.0, 0.0), Point::new(4.0, 3.0), (0.0, 0.0));
        let along = |k: u32| f64::from(k) / 100.0;
        // A straight way, a corner of five millimetres (a pixel and more) and one of a tenth of that.
        let points = (0..=400).map(|k| {
            let off = if k == 100 {
                0.005
            } else if k == 300 {
                0.0003
            } else {
                0.0
            };
            Point::new(along(k), off)
        });
        let data = frame.line(points);
        let drawn: Vec<&str> = data.split(['M', 'L']).skip(1).collect();
        let straight = ["0.0 780.0", "257.4 780.0", "260.0 778.7", "262.6 780.0", "1040.0 780.0"];
        assert_eq!(drawn, straight);
        assert_eq!(frame.line([]), "");
        assert_eq!(frame.line([Point::new(1.0, 1.0)]), "M260.0 520.0");
        // Back along itself: the far end stays.
        let there_and_back = (0..=100).chain((0..100).rev()).map(|k| Point::new(along(k), 0.0));
        assert_eq!(frame.line(there_and_back), "M0.0 780.0L260.0 780.0L0.0 780.0");
    }

    #[test]
    fn a_counter_clockwise_arc_bulges_to_its_right() {
        let frame = Frame::around(Point::new(-1.0, -1.0), Point::new(1.0, 1.0), (0.0, 0.0));
        let arc = Piece::with_bulge(Point::new(-1.0, 0.0), Point::new(1.0, 0.0), 1.0);
        // Counter-clockwise from left to right passes below; on the sheet that is larger y.
        let (_, middle) = frame.at(arc.at(0.5));
        let data = frame.single(&arc);
        assert!(data.contains(&format!(" 0 0 0 390.0 {middle:.1}")), "{data}");
        assert!(middle > 700.0, "the arc's middle lies at the bottom: {middle}");
    }
}
