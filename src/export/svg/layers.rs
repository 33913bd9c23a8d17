//! The layers of the map, from the floor up: walls, cuts, plan, trajectory, objects, start.

use super::super::picture::Frame;
use super::super::strokes::{Anchor, Lettering, Style};
use super::super::{RunRecord, boundary, rectangle, surface_points};
use super::{Options, color};
use crate::geometry::{Point, Pose};
use crate::mapping::map::{LineReason, LineStatus, MappedObject, ObjectClass, PlanLine, stretches};
use std::fmt::Write;

const LABEL: Style = Style { height: 9.0, weight: 0.14, color: color::OBJECT_EDGE };

/// How a line of the plan is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pen {
    /// What the legend calls it.
    pub(super) name: &'static str,
    /// Colour.
    pub(super) color: &'static str,
    /// Width, pixels.
    pub(super) width: f64,
    /// Dashes, as SVG writes them; empty for none.
    pub(super) dashes: &'static str,
}

const PLANNED: Pen = Pen { name: "planned", color: color::PLANNED, width: 1.0, dashes: "" };
const DRIVEN: Pen = Pen { name: "driven", color: color::DRIVEN, width: 1.2, dashes: "" };
const BLOCKED: Pen = Pen { name: "blocked", color: color::BLOCKED, width: 1.4, dashes: "" };
const SKIPPED: Pen = Pen { name: "skipped", color: color::SKIPPED, width: 1.0, dashes: "5 4" };
const REJECTED: Pen = Pen { name: "rejected", color: color::REJECTED, width: 0.8, dashes: "3 4" };

/// The pen for a line, or none when the picture leaves it out.
pub(super) fn pen(line: &PlanLine, options: &Options) -> Option<Pen> {
    if options.vertex.is_some_and(|vertex| vertex != line.vertex) {
        return None;
    }
    // What a shorter plan does without would cover everything else.
    if line.reason == Some(LineReason::Redundant) && line.status != LineStatus::Planned {
        return None;
    }
    match line.status {
        LineStatus::Planned | LineStatus::Driving => Some(PLANNED),
        LineStatus::Driven => Some(DRIVEN),
        LineStatus::Blocked => Some(BLOCKED),
        LineStatus::Skipped => Some(SKIPPED),
        LineStatus::Rejected => options.rejected.then_some(REJECTED),
    }
}

/// All layers.
pub(super) fn draw(
    record: &RunRecord<'_>,
    options: &Options,
    frame: &Frame,
    letters: &mut Lettering,
) -> String {
    let mut out = walls(record, frame);
    out.push_str(&cuts(record, frame));
    out.push_str(&plan(record, options, frame));
    if options.trajectory {
        out.push_str(&trajectory(record, frame));
    }
    for object in &record.map.objects {
        out.push_str(&solid(object, frame, letters));
    }
    out.push_str(&start(record.settings.start, frame));
    out
}

fn walls(record: &RunRecord<'_>, frame: &Frame) -> String {
    let Some(ring) = boundary(record) else {
        let known = frame.line(surface_points(record.map));
        return stroke("boundary", &known, color::WALL, 2.2, "1 4");
    };
    let data = frame.ring(&ring);
    // A broad band under the floor's white leaves half of itself outside: the wall.
    format!(
        "<g id=\"boundary\" stroke-linejoin=\"round\"><path d=\"{data}\" fill=\"none\" stroke=\"{}\" \
         stroke-width=\"15\"/><path d=\"{data}\" fill=\"{}\" stroke=\"{}\" \
         stroke-width=\"2.2\"/></g>\n",
        color::SOLID,
        color::FLOOR,
        color::WALL
    )
}

fn cuts(record: &RunRecord<'_>, frame: &Frame) -> String {
    let parts = record.map.shape.iter().flat_map(|shape| &shape.parts);
    let pieces = parts.flat_map(|part| part.ring.pieces.iter().zip(&part.cut));
    let data: String =
        pieces.filter(|&(_, &cut)| cut).map(|(piece, _)| frame.single(piece)).collect();
    stroke("cuts", &data, color::FAINT, 1.0, "7 5")
}

fn plan(record: &RunRecord<'_>, options: &Options, frame: &Frame) -> String {
    let lines = record.map.plan.iter().flat_map(|plan| &plan.lines);
    let mut drawn = [
        (REJECTED, String::new()),
        (SKIPPED, String::new()),
        (PLANNED, String::new()),
        (DRIVEN, String::new()),
        (BLOCKED, String::new()),
    ];
    for line in lines {
        let Some(pen) = pen(line, options) else {
            continue;
        };
        let (from, to) = line.drive.unwrap_or((line.start, line.end));
        if let Some((_, data)) = drawn.iter_mut().find(|(other, _)| *other == pen) {
            data.push_str(&frame.line([from, to]));
        }
    }
    let layers = drawn.iter().map(|(pen, data)| {
        let id = format!("plan-{}", pen.name);
        stroke(&id, data, pen.color, pen.width, pen.dashes)
    });
    layers.collect()
}

fn trajectory(record: &RunRecord<'_>, frame: &Frame) -> String {
    let data: String = stretches(&record.map.path)
        .map(|stretch| frame.line(stretch.iter().map(|point| point.pose.position)))
        .collect();
    format!(
        "<g opacity=\".6\">{}</g>\n",
        stroke("trajectory", &data, color::TRAIL, 0.9, "").trim_end()
    )
}

fn solid(object: &MappedObject, frame: &Frame, letters: &mut Lettering) -> String {
    if object.class == ObjectClass::Open {
        let points = object.outline.to_points(0.001);
        return stroke("object-open", &frame.line(points), color::OBJECT_EDGE, 1.8, "4 3");
    }
    let data = frame.ring(&object.outline);
    // Its back, where it was not gone round, is a guess.
    let dashes = if object.closed { "" } else { " stroke-dasharray=\"4 3\"" };
    let mut out = format!(
        "<path d=\"{data}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"1.8\"{dashes} \
         stroke-linejoin=\"round\"/>\n",
        color::OBJECT,
        color::OBJECT_EDGE
    );
    if let Some(size) = rectangle::measure(&object.outline) {
        out.push_str(&label(object.id, &size, frame, letters));
    }
    out
}

/// The object's number: within it where it fits, else beside it.
fn label(id: u32, size: &rectangle::Measure, frame: &Frame, letters: &mut Lettering) -> String {
    let text = format!("O{id}");
    let (x, y) = frame.at(size.center);
    let needed = super::super::strokes::width(&text, LABEL.height);
    if size.width * frame.scale > needed + 6.0 {
        return letters.text(&text, x, y + LABEL.height / 2.0, Anchor::Middle, LABEL);
    }
    let beside = x + size.length * frame.scale / 2.0 + 5.0;
    letters.text(&text, beside, y - 4.0, Anchor::Start, LABEL)
}

/// A disc with an arrow in the direction of the start.
pub(super) fn start(pose: Pose, frame: &Frame) -> String {
    let (x, y) = frame.at(pose.position);
    let tip = |ahead: f64, left: f64| {
        let reach = |pixels: f64| pixels / frame.scale;
        let (px, py) = frame.at(pose.to_world(Point::new(reach(ahead), reach(left))));
        format!("{px:.1} {py:.1}")
    };
    format!(
        "<g id=\"start\" fill=\"{0}\"><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\"/>\
         <path d=\"M{1}L{2}L{3}L{4}Z\"/></g>\n",
        color::START,
        tip(19.0, 0.0),
        tip(8.0, 5.0),
        tip(10.5, 0.0),
        tip(8.0, -5.0)
    )
}

/// A stroked path, or nothing when there is nothing to draw.
fn stroke(id: &str, data: &str, color: &str, width: f64, dashes: &str) -> String {
    if data.is_empty() {
        return String::new();
    }
    let mut out = format!(
        "<path id=\"{id}\" d=\"{data}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\""
    );
    if !dashes.is_empty() {
        // Writing to a string cannot fail.
        let _ = write!(out, " stroke-dasharray=\"{dashes}\"");
    }
    out.push_str(" stroke-linejoin=\"round\"/>\n");
    out
}
