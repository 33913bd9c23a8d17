//! `map.svg`: the picture one would show. Title and figures above, the map with its dimensions in the
//! middle, scale bar and legend below, and a table of the objects where the map has no room for their
//! sizes. All labels are strokes, see [`super::strokes`].

mod background;
mod dimensions;
mod figures;
mod gaps;
mod labels;
mod layers;
mod legend;
mod pens;
mod placement;
mod table;

use super::picture::Frame;
use super::strokes::{Anchor, Lettering, Style, escaped};
use super::{RunRecord, boundary};
use crate::geometry::{Point, Ring, Vector, ring};
use background::Background;
use pens::color;
use std::fmt::Write;

/// What the picture shows besides walls and objects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// The trajectory.
    pub trajectory: bool,
    /// The rejected lines of the plan, dashed (figure 8 of the paper).
    pub rejected: bool,
    /// Only the lines from this vertex (figures 6 and 8); none for all.
    pub vertex: Option<usize>,
}

impl Default for Options {
    fn default() -> Self {
        Self { trajectory: true, rejected: false, vertex: None }
    }
}

impl Options {
    /// The plan as the paper's figures draw it: no trajectory, rejected lines dashed.
    #[must_use]
    pub fn plan_drawing() -> Self {
        Self { trajectory: false, rejected: true, vertex: None }
    }
}

const TITLE: Style = Style { height: 17.0, weight: 0.13, color: color::INK };
const FIGURES: Style = Style { height: 9.0, weight: 0.11, color: color::FAINT };
/// Margin of the sheet, pixels.
const MARGIN: f64 = 34.0;
/// Least width of the sheet, pixels: the figures need it.
const NARROWEST: f64 = 760.0;

/// What is drawn, and where on the sheet.
struct Scene<'a> {
    record: &'a RunRecord<'a>,
    options: &'a Options,
    frame: Frame,
    /// The boundary as far as it is known, once the lap is closed.
    wall: Option<Ring>,
    background: Background,
}

/// The record as the text of an SVG file.
#[must_use]
pub fn write(record: &RunRecord<'_>, options: &Options) -> String {
    let mut letters = Lettering::default();
    let wall = boundary(record);
    let (low, high) = extent(record, wall.as_ref());
    let frame = Frame::around(low, high, (0.0, 0.0));
    let width = (frame.width + 2.0 * MARGIN).max(NARROWEST);
    let (head, below_head) = heading(record, wall.as_ref(), width, &mut letters);
    let top = below_head + dimensions::ROOM;
    let frame = frame.moved(((width - frame.width) / 2.0, top));
    let background = Background::of(record, options, &frame, wall.as_ref());
    let scene = Scene { record, options, frame, wall, background };

    let labels = labels::place(&scene);
    let mut map = layers::draw(&scene, &labels, &mut letters);
    if let Some(ring) = &scene.wall {
        map.push_str(&dimensions::draw(ring, &frame, &mut letters));
    }
    let below_map = top + frame.height + 26.0;
    let (mut foot, mut below) = legend::draw(&scene, (width, below_map), &mut letters);
    if labels.listed {
        let (table, end) = table::draw(record, (width, below + 20.0), &mut letters);
        foot.push_str(&table);
        below = end;
    }
    let height = below + MARGIN - 10.0;

    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.0} {height:.0}\">\n<title>{}</title>\n",
        escaped(record.world)
    );
    out.push_str(&letters.definitions());
    // Writing to a string cannot fail.
    let _ = writeln!(out, "<rect width=\"100%\" height=\"100%\" fill=\"{}\"/>", color::PAPER);
    out.push_str(&head);
    out.push_str(&map);
    out.push_str(&foot);
    out.push_str("</svg>\n");
    out
}

/// The lowest and highest corner of everything that is drawn, with room for the walls, metres.
fn extent(record: &RunRecord<'_>, wall: Option<&Ring>) -> (Point, Point) {
    let mut points: Vec<Point> = vec![record.settings.start.position];
    points.extend(record.map.path.iter().map(|point| point.pose.position));
    let beyond = record.map.beyond.iter().flat_map(|beyond| &beyond.contacts);
    points.extend(record.map.contacts.iter().chain(beyond).map(|contact| contact.point));
    for ring in wall.into_iter().chain(record.map.objects.iter().map(|o| &o.outline)) {
        points.extend(ring.bounds().map_or(vec![], |(low, high)| vec![low, high]));
    }
    points.retain(|point| point.iter().all(|value| value.is_finite()));
    let (low, high) = ring::bounds(&points).unwrap_or_default();
    let room = Vector::repeat(0.02 * (high - low).amax().max(1.0));
    (low - room, high + room)
}

/// Title and figures, and the y below them.
fn heading(
    record: &RunRecord<'_>,
    wall: Option<&Ring>,
    width: f64,
    letters: &mut Lettering,
) -> (String, f64) {
    let title = shortened(record.world, width - 2.0 * MARGIN, TITLE.height);
    let mut out = letters.text(&title, MARGIN, MARGIN + 14.0, Anchor::Start, TITLE);
    let mut y = MARGIN + 36.0;
    let lines = figures::lines(record, wall);
    for line in lines.iter().flat_map(|line| wrapped(line, width - 2.0 * MARGIN, FIGURES.height)) {
        out.push_str(&letters.text(&line, MARGIN, y, Anchor::Start, FIGURES));
        y += 17.0;
    }
    (out, y + 4.0)
}

/// `text` in as many lines as it takes, each at most `widest` pixels wide. A number stays with its unit: a phrase
/// goes on in the next line only where it is wider than a line itself.
fn wrapped(text: &str, widest: f64, height: f64) -> Vec<String> {
    let fits = |line: &str| super::strokes::width(line, height) <= widest;
    let mut phrases: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match phrases.last_mut() {
            Some(phrase) if !phrase.ends_with([',', ';', ':', '·']) => {
                phrase.push(' ');
                phrase.push_str(word);
            }
            _ => phrases.push(word.to_owned()),
        }
    }
    let parts = phrases.iter().flat_map(|phrase| {
        if fits(phrase) { vec![phrase.as_str()] } else { phrase.split(' ').collect() }
    });
    let mut lines: Vec<String> = Vec::new();
    for part in parts {
        let longer = lines.last().map(|line| format!("{line} {part}"));
        match (longer, lines.last_mut()) {
            (Some(longer), Some(line)) if fits(&longer) => *line = longer,
            _ => lines.push(shortened(part, widest, height)),
        }
    }
    lines
}

/// `text` cut so that it is at most `widest` pixels wide.
fn shortened(text: &str, widest: f64, height: f64) -> String {
    let mut kept = text.to_owned();
    while super::strokes::width(&kept, height) > widest && kept.pop().is_some() {}
    if kept.len() < text.len() {
        // Room for the dots that show that something is missing.
        for _ in 0..4 {
            kept.pop();
        }
        kept.push_str("...");
    }
    kept
}

#[cfg(test)]
mod tests;
