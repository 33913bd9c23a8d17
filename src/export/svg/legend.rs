//! Below the map: a scale bar, and what the lines and fills mean. Only what is in the picture is
//! explained.

use super::super::RunRecord;
use super::super::picture::Frame;
use super::super::strokes::{Anchor, Lettering, Style, width};
use super::layers::{Pen, pen};
use super::{FIGURES, MARGIN, Options, color};
use std::fmt::Write;

const TEXT: Style = Style { height: 8.5, weight: 0.11, color: color::INK };
/// Length of a sample line, pixels.
const SAMPLE: f64 = 24.0;

/// Scale bar and legend on a sheet of the given width, from the given y; and the sheet's height.
pub(super) fn draw(
    record: &RunRecord<'_>,
    options: &Options,
    frame: &Frame,
    (sheet, top): (f64, f64),
    letters: &mut Lettering,
) -> (String, f64) {
    let (mut out, bar) = scale_bar(frame, top, letters);
    let left = MARGIN + bar + 44.0;
    let (mut x, mut y) = (left, top);
    for (name, symbol) in items(record, options) {
        let needed = SAMPLE + 8.0 + width(name, TEXT.height);
        if x + needed > sheet - MARGIN && x > left {
            (x, y) = (left, y + 22.0);
        }
        // Writing to a string cannot fail.
        let _ = writeln!(out, "<g transform=\"translate({x:.1} {y:.1})\">{symbol}</g>");
        let text = letters.text(name, x + SAMPLE + 8.0, y + 4.0, Anchor::Start, TEXT);
        out.push_str(&text);
        x += needed + 24.0;
    }
    (out, y + MARGIN)
}

/// A bar of a round length, about an eighth of the drawing; and its width in pixels.
fn scale_bar(frame: &Frame, y: f64, letters: &mut Lettering) -> (String, f64) {
    let lengths = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0];
    let wanted = 130.0 / frame.scale;
    let length = lengths.into_iter().rfind(|&length| length <= wanted).unwrap_or(lengths[0]);
    let pixels = length * frame.scale;
    let mut out = format!(
        "<path id=\"scale\" d=\"M{MARGIN:.1} {0:.1}v7h{pixels:.1}v-7\" fill=\"none\" stroke=\"{1}\" \
         stroke-width=\"1.4\"/>\n",
        y - 3.0,
        color::INK
    );
    let text = format!("{length} m");
    let end = MARGIN + pixels + 6.0;
    out.push_str(&letters.text(&text, end, y + 4.0, Anchor::Start, FIGURES));
    (out, pixels + 6.0 + width(&text, FIGURES.height))
}

/// Names and samples of everything that the picture holds.
fn items(record: &RunRecord<'_>, options: &Options) -> Vec<(&'static str, String)> {
    let line = |color: &str, width: f64, dashes: &str| {
        format!(
            "<path d=\"M0 0H{SAMPLE}\" stroke=\"{color}\" stroke-width=\"{width}\" \
             stroke-dasharray=\"{}\" fill=\"none\"/>",
            if dashes.is_empty() { "none" } else { dashes }
        )
    };
    let map = record.map;
    let mut all = vec![("wall", line(color::WALL, 2.2, if map.closed { "" } else { "1 4" }))];
    if map.objects.iter().any(|object| object.closed) {
        let sample = format!(
            "<rect y=\"-6\" width=\"{SAMPLE}\" height=\"12\" rx=\"2\" fill=\"{}\" stroke=\"{}\" \
             stroke-width=\"1.6\"/>",
            color::OBJECT,
            color::OBJECT_EDGE
        );
        all.push(("object", sample));
    }
    if map.objects.iter().any(|object| !object.closed) {
        all.push(("object, half seen", line(color::OBJECT_EDGE, 1.8, "4 3")));
    }
    let mut pens: Vec<Pen> = Vec::new();
    for pen in map.plan.iter().flat_map(|plan| &plan.lines).filter_map(|line| pen(line, options)) {
        if !pens.contains(&pen) {
            pens.push(pen);
        }
    }
    all.extend(pens.iter().map(|pen| (pen.name, line(pen.color, pen.width + 0.4, pen.dashes))));
    if map.shape.iter().flat_map(|shape| &shape.parts).any(|part| part.cut.contains(&true)) {
        all.push(("cut between parts", line(color::FAINT, 1.0, "7 5")));
    }
    if options.trajectory && map.path.len() > 1 {
        all.push(("trajectory", line(color::TRAIL, 1.2, "")));
    }
    let start = format!(
        "<g fill=\"{}\"><circle cx=\"5\" r=\"4.5\"/><path d=\"M24 0L13 -5L15.5 0L13 5Z\"/></g>",
        color::START
    );
    all.push(("start", start));
    all
}
