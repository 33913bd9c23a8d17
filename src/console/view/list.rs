//! The list of all that was found, each with its figures: every wall with its corner, every object, every
//! gap, every line that was not driven whole. Lies over the screen like the help; how far it is scrolled is the
//! model's.

use super::help::Line;
use super::words;
use crate::console::model::Model;
use crate::console::theme::{Role, Theme};
use crate::geometry::measure::measure;
use crate::geometry::{Piece, Point};
use crate::mapping::map::{LineReason, LineStatus, MappedObject, PlanLine, RoomMap};
use crate::mapping::unreached::Beyond;
use crate::session::Snapshot;
use crate::wording;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

/// What the wall is called that is so many pieces after the first of the outline.
#[must_use]
pub fn wall_name(piece: usize) -> String {
    format!("W{}", piece + 1)
}

/// A place, in metres.
fn place(at: Point) -> String {
    format!("{:>7} {:>7}", words::hundredths(at.x), words::hundredths(at.y))
}

/// A standard error, where one is known.
fn give_or_take(error: Option<f64>) -> String {
    error.map_or_else(|| "±    ?".to_owned(), |error| format!("± {}", wording::error(error)))
}

fn heading(text: &str) -> Line {
    vec![(Role::Title, text.to_owned())]
}

/// The lines of the list on a screen of so many columns.
fn lines(snapshot: &Snapshot, cols: u16) -> Vec<Line> {
    let map = &snapshot.map;
    let mut lines = walls(map);
    lines.extend(objects(map));
    lines.extend(gaps(map));
    lines.extend(lines_left(map, cols));
    if lines.is_empty() {
        let nothing = if snapshot.run.is_over() {
            "nothing: the run ended before a lap had closed and was fitted"
        } else {
            "nothing yet: the outline is known when the lap has closed and was fitted"
        };
        let wrapped = words::wrap(nothing, cols.saturating_sub(5));
        lines.extend(wrapped.into_iter().map(|line| vec![(Role::Unknown, line)]));
    }
    lines
}

/// One line for each piece of the outline and the corner at which it begins.
fn walls(map: &RoomMap) -> Vec<Line> {
    let Some(shape) = &map.shape else { return Vec::new() };
    let outline = &shape.outline;
    let straits = map.beyond.iter().filter_map(Beyond::mouth);
    let untouched: Vec<usize> = map
        .unreached
        .iter()
        .filter(|gap| gap.is_untouched())
        .copied()
        .chain(straits)
        .filter_map(|gap| gap.piece_of(outline))
        .collect();
    let errors = map.accuracy.as_ref();
    let mut lines = vec![heading("Walls      length  across it   begins at")];
    for (k, piece) in outline.pieces.iter().enumerate() {
        let is_gap = untouched.contains(&k);
        let role = if is_gap { Role::Untouched } else { Role::Wall };
        let across = errors.and_then(|errors| errors.walls.get(k)).copied();
        let corner = errors.and_then(|errors| errors.corners.get(k)).copied();
        let what = match piece {
            _ if is_gap => "untouched".to_owned(),
            Piece::Line { .. } => String::new(),
            Piece::Arc { radius, .. } => format!("r {radius:.2} m"),
        };
        let (length, from) = (piece.length(), place(piece.from()));
        lines.push(vec![
            (role, format!("  {:<5}", wall_name(k))),
            (Role::Value, format!("{length:>7.3} m  ")),
            (Role::Text, format!("{:<8}", give_or_take(across))),
            (Role::Value, from),
            (Role::Text, format!(" {:<8}", give_or_take(corner))),
            (role, what),
        ]);
    }
    if let Some(datum) = errors.and_then(|errors| errors.datum) {
        let turn = wording::turn_error(datum.turn);
        let (shift, within) = (wording::error(datum.shift), wording::error(datum.within));
        let whole = format!("  all as one piece: turned ± {turn}, moved ± {shift}");
        lines.push(vec![(Role::Text, whole)]);
        lines.push(vec![(Role::Text, format!("  among each other: ± {within}"))]);
    }
    lines.push(Vec::new());
    lines
}

fn objects(map: &RoomMap) -> Vec<Line> {
    if map.objects.is_empty() {
        return Vec::new();
    }
    let errors = map.accuracy.as_ref().map(|accuracy| &accuracy.objects);
    let line = |(k, object): (usize, &MappedObject)| {
        let error = errors.and_then(|errors| errors.get(k)).copied();
        let size = object.size().unwrap_or_default().replace(" × ", "×");
        let what = format!("{:<10}{size:<13}", object.class.to_string());
        let middle = measure(&object.outline).map(|measure| measure.center);
        vec![
            (Role::Object, format!("  {:<5}", format!("O{}", object.id))),
            (Role::Value, what),
            (Role::Value, middle.map_or_else(String::new, place)),
            (Role::Text, format!(" {}", give_or_take(error))),
        ]
    };
    let mut lines = vec![heading("Objects          size         middle at")];
    lines.extend(map.objects.iter().enumerate().map(line));
    lines.push(Vec::new());
    lines
}

/// The gaps that are too narrow for the robot.
fn gaps(map: &RoomMap) -> Vec<Line> {
    if map.unreached.is_empty() {
        return Vec::new();
    }
    let mut lines = vec![heading("Not reached    width           at")];
    for gap in &map.unreached {
        let behind =
            gap.area.map_or_else(|| " gap, or wall".to_owned(), |a| format!(" {a:.1} m² behind"));
        lines.push(vec![
            (Role::Untouched, format!("  {:<14}", "gap")),
            (Role::Value, format!("{:<8}", words::small(gap.width))),
            (Role::Value, place(gap.at)),
            (Role::Text, behind),
        ]);
    }
    lines.push(Vec::new());
    lines
}

/// The lines of the plan that were not driven from end to end, and why.
fn lines_left(map: &RoomMap, cols: u16) -> Vec<Line> {
    let Some(plan) = &map.plan else { return Vec::new() };
    // What the plan never meant to drive is no line of it.
    let left = |line: &&PlanLine| {
        matches!(line.status, LineStatus::Blocked | LineStatus::Skipped)
            && line.reason != Some(LineReason::Redundant)
    };
    let mut lines: Vec<Line> = Vec::new();
    for line in plan.lines.iter().filter(left) {
        if lines.is_empty() {
            lines.push(heading("Lines not driven whole"));
        }
        let why = line.reason.map_or_else(String::new, |reason| reason.to_string());
        let mut name = format!("L{}", line.id);
        for text in words::wrap(&why, cols.saturating_sub(13)) {
            lines.push(vec![
                (Role::LineBlocked, format!("  {:<7}", std::mem::take(&mut name))),
                (Role::Text, text),
            ]);
        }
    }
    lines
}

/// How far the list can be scrolled.
#[must_use]
pub fn last_scroll(model: &Model, snapshot: &Snapshot) -> u16 {
    super::help::last_scroll_of(lines(snapshot, model.size.0).len(), model.size.1)
}

pub(super) fn draw(
    model: &Model,
    snapshot: &Snapshot,
    scroll: u16,
    theme: &Theme,
    area: Rect,
    buf: &mut Buffer,
) {
    let lines = lines(snapshot, model.size.0);
    super::help::draw_page("list", &lines, scroll, theme, area, buf);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::view::pen::width;
    use crate::geometry::{Pose, Ring};
    use crate::mapping::map::{Shape, ShapeClass};
    use crate::mapping::settings::Settings;

    /// A waiting run whose room has an outline of so many corners.
    fn room(corners: usize) -> Snapshot {
        let mut snapshot = Snapshot::waiting(Settings::new(Pose::new(0.0, 0.0, 0.0)), "nowhere");
        let turn = std::f64::consts::TAU / corners as f64;
        let corner = |k: usize| Point::from(crate::geometry::angle::unit(turn * k as f64) * 12.0);
        let outline = Ring::polygon(&(0..corners).map(corner).collect::<Vec<_>>());
        let shape =
            Shape { class: ShapeClass::Convex, outline, vertices: Vec::new(), parts: Vec::new() };
        snapshot.map.shape = Some(shape);
        snapshot
    }

    #[test]
    fn every_wall_stands_on_the_list_and_fits_the_narrowest_screen() {
        let snapshot = room(40);
        let lines = lines(&snapshot, crate::console::layout::MIN_COLS);
        let text = |line: &Line| line.iter().map(|(_, text)| text.as_str()).collect::<String>();
        for k in 0..40 {
            let named =
                lines.iter().filter(|line| text(line).trim().starts_with(&format!("W{} ", k + 1)));
            assert_eq!(named.count(), 1, "wall {k}");
        }
        for line in &lines {
            let wide = width(&text(line));
            assert!(wide + 4 <= crate::console::layout::MIN_COLS, "{wide}: {}", text(line));
        }
    }
}
