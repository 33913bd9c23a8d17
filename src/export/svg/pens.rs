//! The pens of a picture: one colour for each meaning, and how the lines of the plan are drawn.
//!
//! Walls and objects are the map; what was planned and driven is its background, in pale and opaque
//! colours, so that lines on top of each other still look as the legend says.

use super::Options;
use crate::mapping::map::{LineReason, LineStatus, Plan, PlanLine};

/// Colours, one for each meaning.
pub(super) mod color {
    pub(in super::super) const PAPER: &str = "#f7f5f0";
    pub(in super::super) const FLOOR: &str = "#ffffff";
    pub(in super::super) const WALL: &str = "#22303c";
    pub(in super::super) const SOLID: &str = "#cdd2d6";
    pub(in super::super) const INK: &str = "#22303c";
    pub(in super::super) const FAINT: &str = "#6b7782";
    pub(in super::super) const OBJECT: &str = "#f0d9b0";
    pub(in super::super) const OBJECT_EDGE: &str = "#9a6412";
    pub(in super::super) const LABEL: &str = "#7d4e08";
    pub(in super::super) const UNTOUCHED: &str = "#c2185b";
    pub(in super::super) const CUT: &str = "#9aa4ad";
    pub(in super::super) const PLANNED: &str = "#9cc0ea";
    pub(in super::super) const DRIVEN: &str = "#a3dcc4";
    pub(in super::super) const BLOCKED: &str = "#f5c6ab";
    pub(in super::super) const SKIPPED: &str = "#cbd1d6";
    pub(in super::super) const REJECTED: &str = "#e6a9b5";
    pub(in super::super) const TRAIL: &str = "#d8d0e8";
    pub(in super::super) const START: &str = "#1f7a4d";
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pen {
    /// What its layer is called.
    pub(super) id: &'static str,
    /// What the legend calls it.
    pub(super) name: &'static str,
    /// Colour.
    pub(super) color: &'static str,
    /// Width, pixels.
    pub(super) width: f64,
    /// Dashes, as SVG writes them; empty for none.
    pub(super) dashes: &'static str,
}

impl Pen {
    const fn of_plan(
        id: &'static str,
        name: &'static str,
        color: &'static str,
        dashes: &'static str,
    ) -> Self {
        Self { id, name, color, width: 1.1, dashes }
    }

    /// The attributes of an edge drawn with this pen.
    pub(super) fn edge(&self) -> String {
        let dashes = if self.dashes.is_empty() {
            String::new()
        } else {
            format!(" stroke-dasharray=\"{}\"", self.dashes)
        };
        let (color, width) = (self.color, self.width);
        format!("stroke=\"{color}\" stroke-width=\"{width}\"{dashes} stroke-linejoin=\"round\"")
    }

    /// The attributes of a line drawn with this pen.
    pub(super) fn attributes(&self) -> String {
        format!("fill=\"none\" {}", self.edge())
    }

    /// The same pen with a share of its width.
    pub(super) fn thinned(&self, share: f64) -> Self {
        Self { width: (self.width * share * 100.0).round() / 100.0, ..*self }
    }

    /// The same pen, broader: a short sample of a thin pale line would hardly be seen.
    pub(super) fn broader(self) -> Self {
        Self { width: self.width + 0.7, ..self }
    }

    /// A path drawn with this pen, or nothing when there is nothing to draw.
    pub(super) fn stroke(&self, data: &str) -> String {
        if data.is_empty() {
            return String::new();
        }
        format!("<path id=\"{}\" d=\"{data}\" {}/>\n", self.id, self.attributes())
    }
}

const fn pen(
    id: &'static str,
    name: &'static str,
    color: &'static str,
    width: f64,
    dashes: &'static str,
) -> Pen {
    Pen { id, name, color, width, dashes }
}

pub(super) const WALL: Pen = pen("boundary", "wall", color::WALL, 2.2, "");
/// The wall while its lap is open, in the legend: contacts.
pub(super) const TOUCHED: &str = "contact, lap not closed";
/// What was felt behind straits, in the legend.
pub(super) const BEYOND: &str = "felt, not mapped";
pub(super) const OBJECT: Pen = pen("object", "object", color::OBJECT_EDGE, 1.8, "");
pub(super) const HALF_SEEN: Pen =
    pen("object-open", "object, half seen", color::OBJECT_EDGE, 1.8, "4 3");
pub(super) const UNTOUCHED: Pen =
    pen("untouched", "not touched: gap or short wall", color::UNTOUCHED, 2.2, "3 2");
pub(super) const NARROW: Pen = pen("narrow", "gap too narrow", color::UNTOUCHED, 2.2, "");
pub(super) const HIDDEN: Pen =
    pen("hidden", "not seen, larger than α", color::UNTOUCHED, 1.2, "2 3");
pub(super) const CUT: Pen = pen("cuts", "cut between parts", color::CUT, 1.0, "7 5");
pub(super) const TRAJECTORY: Pen = pen("trajectory", "trajectory", color::TRAIL, 0.9, "");

const PLANNED: Pen = Pen::of_plan("plan-planned", "line planned", color::PLANNED, "");
const DRIVEN: Pen = Pen::of_plan("plan-driven", "line driven", color::DRIVEN, "");
const ADDED: Pen = Pen::of_plan("plan-added", "line added", color::DRIVEN, "4 2");
const BLOCKED: Pen = Pen::of_plan("plan-blocked", "line blocked", color::BLOCKED, "");
const SKIPPED: Pen = Pen::of_plan("plan-skipped", "line skipped", color::SKIPPED, "5 4");
const REJECTED: Pen = Pen::of_plan("plan-rejected", "line rejected", color::REJECTED, "3 4");

/// The pens of the plan in the order of the legend.
pub(super) const OF_PLAN: [Pen; 6] = [PLANNED, DRIVEN, ADDED, BLOCKED, SKIPPED, REJECTED];

/// The lines of `plan` that the picture shows, each with its pen.
pub(super) fn of_lines<'a>(
    plan: &'a Plan,
    options: &'a Options,
) -> impl Iterator<Item = (&'a PlanLine, Pen)> {
    let own = plan.own();
    let pen =
        move |line: &'a PlanLine| Some((line, of_line(line, own.contains(&line.id), options)?));
    plan.lines.iter().filter_map(pen)
}

/// The pen of one line, which the plan was made of (`own`) or was added later.
fn of_line(line: &PlanLine, own: bool, options: &Options) -> Option<Pen> {
    if options.vertex.is_some_and(|vertex| vertex != line.vertex) {
        return None;
    }
    // What a shorter plan does without would cover everything else.
    if line.reason == Some(LineReason::Redundant) && line.status != LineStatus::Planned {
        return None;
    }
    match line.status {
        LineStatus::Planned | LineStatus::Driving => Some(PLANNED),
        LineStatus::Driven => Some(if own { DRIVEN } else { ADDED }),
        LineStatus::Blocked => Some(BLOCKED),
        LineStatus::Skipped => Some(SKIPPED),
        LineStatus::Rejected => options.rejected.then_some(REJECTED),
    }
}
