//! Below the map: a scale bar, and what the lines and fills mean. Only what is in the picture is
//! explained.

use super::super::picture::Frame;
use super::super::strokes::{Anchor, Lettering, Style, width};
use super::pens::{self, Pen, color};
use super::{FIGURES, MARGIN, Scene};
use std::fmt::Write;

pub(super) const TEXT: Style = Style { height: 8.5, weight: 0.11, color: color::INK };
/// Length of a sample line, pixels.
const SAMPLE: f64 = 24.0;

/// Scale bar and legend on a sheet of the given width, from the given y; and the y below them.
pub(super) fn draw(
    scene: &Scene<'_>,
    (sheet, top): (f64, f64),
    letters: &mut Lettering,
) -> (String, f64) {
    let (mut out, bar) = scale_bar(&scene.frame, top, letters);
    let left = MARGIN + bar + 44.0;
    let (mut x, mut y) = (left, top);
    for (name, symbol) in items(scene) {
        let needed = SAMPLE + 8.0 + width(name, TEXT.height);
        if x + needed > sheet - MARGIN && x > left {
            (x, y) = (left, y + 22.0);
        }
        // Writing to a string cannot fail.
        let _ = writeln!(out, "<g transform=\"translate({x:.1} {y:.1})\">{symbol}</g>");
        let text = letters.text(name, x + SAMPLE + 8.0, y + 4.0, Anchor::Start, TEXT);
        out.push_str(&text);
        x += needed + 20.0;
    }
    (out, y + 10.0)
}

/// A bar of a round length, about a seventh of the drawing; and its width in pixels.
fn scale_bar(frame: &Frame, y: f64, letters: &mut Lettering) -> (String, f64) {
    let lengths = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0];
    let wanted = 170.0 / frame.scale;
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

/// Names and samples of everything that the picture holds, in the same order in every picture.
pub(super) fn items(scene: &Scene<'_>) -> Vec<(&'static str, String)> {
    let (map, options) = (scene.record.map, scene.options);
    let object = |pen: &Pen| {
        let (fill, edge) = (color::OBJECT, pen.edge());
        format!("<rect y=\"-6\" width=\"{SAMPLE}\" height=\"12\" rx=\"2\" fill=\"{fill}\" {edge}/>")
    };
    let line = |pen: &Pen| format!("<path d=\"M0 0H{SAMPLE}\" {}/>", pen.attributes());
    let of_lines = map.plan.iter().flat_map(|plan| pens::of_lines(plan, options));
    let drawn: Vec<Pen> = of_lines.map(|(_, pen)| pen).collect();
    let cut = map.shape.iter().flat_map(|shape| &shape.parts).any(|part| part.cut.contains(&true));
    let seen = |half: bool| map.objects.iter().any(|object| object.closed != half);
    let gap = |known: bool| map.unreached.iter().any(|gap| gap.area.is_some() == known);
    let hidden = map.shortfall().is_some() && map.hidden_at.is_some();

    let dots: String = [4, 12, 20].map(|x| format!("<circle cx=\"{x}\" r=\"1.6\"/>")).concat();
    let dots = format!("<g fill=\"{}\">{dots}</g>", color::WALL);
    let mut all = vec![(map.closed, pens::WALL.name, line(&pens::WALL))];
    all.push((!map.closed, pens::TOUCHED, dots.clone()));
    all.push((!map.beyond.is_empty(), pens::BEYOND, dots));
    all.push((seen(false), pens::OBJECT.name, object(&pens::OBJECT)));
    all.push((seen(true), pens::HALF_SEEN.name, object(&pens::HALF_SEEN)));
    all.push((gap(false), pens::UNTOUCHED.name, line(&pens::UNTOUCHED)));
    all.push((gap(true), pens::NARROW.name, line(&pens::NARROW)));
    all.push((hidden, pens::HIDDEN.name, line(&pens::HIDDEN)));
    all.push((cut, pens::CUT.name, line(&pens::CUT)));
    all.extend(
        pens::OF_PLAN.map(|pen| {
            (drawn.contains(&pen), pen.name, line(&scene.background.plan(&pen).broader()))
        }),
    );
    let trajectory = options.trajectory && map.path.len() > 1;
    all.push((trajectory, pens::TRAJECTORY.name, line(&scene.background.trajectory().broader())));
    let start = format!(
        "<g fill=\"{}\"><circle cx=\"5\" r=\"4.5\"/><path d=\"M24 0L13 -5L15.5 0L13 5Z\"/></g>",
        color::START
    );
    all.push((true, "start", start));
    all.into_iter().filter(|item| item.0).map(|(_, name, sample)| (name, sample)).collect()
}
