//! Dimension lines: how wide and how high the room is, along the axes of the map.

use super::super::picture::Frame;
use super::super::strokes::{Anchor, Lettering, Style, width};
use super::pens::color;
use crate::geometry::{Point, Ring};
use std::fmt::Write;

const TEXT: Style = Style { height: 8.5, weight: 0.12, color: color::FAINT };
/// Room above and left of the drawing that the lines need, pixels.
pub(super) const ROOM: f64 = 12.0;

/// Width and height of an outline, metres; none when it has no extent.
pub(super) fn overall(ring: &Ring) -> Option<(f64, f64)> {
    let (low, high) = ring.bounds()?;
    let size = high - low;
    (size.x.is_finite() && size.y.is_finite()).then_some((size.x, size.y))
}

/// The dimension lines above and to the left of the walls `ring`.
pub(super) fn draw(ring: &Ring, frame: &Frame, letters: &mut Lettering) -> String {
    let (Some((low, high)), Some((wide, tall))) = (ring.bounds(), overall(ring)) else {
        return String::new();
    };
    let ((left, bottom), (right, top)) = (frame.at(low), frame.at(high));
    let corner = frame.corners().0;
    let (x, y) = (corner.x - ROOM / 2.0, corner.y - ROOM / 2.0);
    let across = [Point::new(left, y), Point::new(right, y)];
    let up = [Point::new(x, bottom), Point::new(x, top)];
    let mut out = String::from("<g id=\"dimensions\">");
    // From the walls' band to a little beyond the line.
    out.push_str(&line(&format!(
        "M{left:.1} {0:.1}V{1:.1}M{right:.1} {0:.1}V{1:.1}M{2:.1} {top:.1}H{3:.1}M{2:.1} {bottom:.1}H{3:.1}",
        top - 11.0,
        y - 4.0,
        left - 11.0,
        x - 4.0
    )));
    for (ends, metres) in [(across, wide), (up, tall)] {
        out.push_str(&dimension(ends, &format!("{metres:.2} m"), letters));
    }
    out.push_str("</g>\n");
    out
}

/// One line with a slash at either end and its length in the middle.
fn dimension([from, to]: [Point; 2], text: &str, letters: &mut Lettering) -> String {
    let mut data = format!("M{:.1} {:.1}L{:.1} {:.1}", from.x, from.y, to.x, to.y);
    for end in [from, to] {
        // Writing to a string cannot fail.
        let _ = write!(data, "M{:.1} {:.1}l6 -6", end.x - 3.0, end.y + 3.0);
    }
    let middle = nalgebra::center(&from, &to);
    let turn = if (to.x - from.x).abs() < (to.y - from.y).abs() { -90 } else { 0 };
    let room = width(text, TEXT.height) + 12.0;
    format!(
        "{}<g transform=\"translate({:.1} {:.1}) rotate({turn})\"><rect x=\"{:.1}\" y=\"-7\" \
         width=\"{room:.1}\" height=\"14\" fill=\"{}\"/>{}</g>",
        line(&data),
        middle.x,
        middle.y,
        -room / 2.0,
        color::PAPER,
        letters.text(text, 0.0, TEXT.height / 2.0, Anchor::Middle, TEXT).trim_end()
    )
}

fn line(data: &str) -> String {
    format!("<path d=\"{data}\" fill=\"none\" stroke=\"{}\" stroke-width=\"0.9\"/>", color::FAINT)
}
