//! The map: walls, objects, plan, trajectory and robot in braille. A pure function of snapshot and
//! camera; the one place that decides what is drawn over what.

mod labels;

use super::pen::Pen;
use super::words;
use crate::console::action::Action;
use crate::console::canvas::viewport::{DOTS_Y, Viewport};
use crate::console::canvas::{Canvas, Pattern};
use crate::console::layout::Regions;
use crate::console::model::{Camera, Layers, Model};
use crate::console::theme::{Role, Theme};
use crate::geometry::ring::bounds;
use crate::geometry::{Point, Pose, Ring, Vector, angle};
use crate::mapping::map::{LineStatus, Part, PlanLine, RoomMap, stretches};
use crate::mapping::unreached::{Beyond, Unreached};
use crate::session::snapshot::{Known, RobotView, Snapshot};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

/// Points of the trajectory are about as far from each other, metres.
const SPACING: f64 = 0.015;

/// What the camera shows in `area`.
#[must_use]
pub fn viewport(camera: &Camera, snapshot: &Snapshot, area: Rect) -> Viewport {
    match *camera {
        Camera::Free { scale, center } => Viewport::new(center, scale, area.width, area.height),
        Camera::Follow { scale, around } => {
            let center = placed(snapshot).map_or(around, |pose| pose.position);
            Viewport::new(center, scale, area.width, area.height)
        }
        Camera::Fit => {
            let (low, high) = extent(snapshot);
            // The lowest row is the scale's.
            let view = Viewport::fit(low, high, area.width, area.height.saturating_sub(1).max(1));
            let down = Vector::new(0.0, f64::from(DOTS_Y) / 2.0 * view.scale);
            Viewport::new(view.center - down, view.scale, area.width, area.height)
        }
    }
}

/// The box around everything known, at least 2 m wide.
fn extent(snapshot: &Snapshot) -> (Point, Point) {
    let map = &snapshot.map;
    let mut points: Vec<Point> = vec![snapshot.settings.start.position];
    match &map.shape {
        Some(shape) => points.extend(shape.outline.to_points(0.01)),
        None => points.extend(map.contacts.iter().map(|contact| contact.point)),
    }
    points.extend(map.beyond.iter().flat_map(|one| &one.contacts).map(|contact| contact.point));
    points.extend(map.path.iter().step_by(8).map(|point| point.pose.position));
    points.extend(placed(snapshot).map(|pose| pose.position));
    let (low, high) = bounds(&points).unwrap_or((Point::origin(), Point::origin()));
    let missing = (Vector::repeat(2.0) - (high - low)).sup(&Vector::repeat(0.2)) / 2.0;
    (low - missing, high + missing)
}

fn robot(snapshot: &Snapshot) -> Option<(RobotView, bool)> {
    match snapshot.robot {
        Known::Known(robot) => Some((robot, true)),
        Known::Stale { value, .. } => Some((value, false)),
        Known::Unknown => None,
    }
}

/// Where the robot is believed to be, if anybody knows.
pub(super) fn placed(snapshot: &Snapshot) -> Option<Pose> {
    robot(snapshot).and_then(|(robot, _)| robot.pose)
}

/// Draws the map as `shown` into `area`.
pub fn draw(
    model: &Model,
    snapshot: &Snapshot,
    shown: Viewport,
    theme: &Theme,
    area: Rect,
    buf: &mut Buffer,
) {
    let mut canvas = Canvas::new(shown);
    draw_floor(&mut canvas, snapshot, model.layers);
    draw_robot(&mut canvas, snapshot);
    canvas.blit(theme, area, buf);
    let with_walls = model.layers.walls.is_shown(snapshot.is_handed_over());
    labels::draw(&canvas, snapshot, with_walls, theme, area, buf);
    draw_scale(&canvas, theme, area, buf);
}

fn draw_floor(canvas: &mut Canvas, snapshot: &Snapshot, layers: Layers) {
    let map = &snapshot.map;
    let over = snapshot.is_handed_over();
    if layers.trajectory.is_shown(over) {
        // Of points that are nearer to each other than a dot is wide, not all are needed.
        let stride = (canvas.view().scale / SPACING).clamp(1.0, 16.0) as usize;
        for stretch in stretches(&map.path) {
            let way = stretch.iter().step_by(stride).chain(stretch.last());
            canvas.polyline(way.map(|point| point.pose.position), Role::Trajectory);
        }
    }
    let with_plan = layers.plan.is_shown(over);
    if with_plan && let Some(plan) = &map.plan {
        for line in &plan.lines {
            draw_line(canvas, line, layers.rejected.is_shown(over));
        }
    }
    canvas.point(snapshot.settings.start.position, Role::Start);
    if let Some(shape) = &map.shape {
        for part in &shape.parts {
            draw_cuts(canvas, part);
        }
        draw_wall(canvas, &shape.outline, map);
    }
    if map.shape.is_none() || layers.contacts.is_shown(over) {
        for contact in &map.contacts {
            canvas.point(contact.point, Role::Contact);
        }
    }
    // No part of the map, and none of the layers either: what is not mapped is not to be missed.
    for contact in map.beyond.iter().flat_map(|beyond| &beyond.contacts) {
        canvas.point(contact.point, Role::Contact);
    }
    for point in &snapshot.felt {
        canvas.point(*point, Role::Contact);
    }
    for object in &map.objects {
        canvas.ring(&object.outline, Role::Object);
    }
    // At the end it is of interest only if the promise was not kept.
    if let (Some(at), Some(diameter)) = (map.hidden_at, map.hidden_disc)
        && (with_plan || map.shortfall().is_some())
    {
        canvas.circle(at, diameter / 2.0, Role::HiddenDisc, Pattern::Sparse(2));
    }
}

/// A stretch of the outline that nobody touched.
pub(super) const UNTOUCHED: Pattern = Pattern::Dash { on: 2, of: 4 };
/// A cut between two parts of the floor.
pub(super) const CUT: Pattern = Pattern::Dash { on: 4, of: 8 };

/// What a line of the plan looks like.
pub(super) fn look(status: LineStatus) -> (Role, Pattern) {
    match status {
        LineStatus::Planned => (Role::LinePlanned, Pattern::Sparse(3)),
        // A wall is bold as well, and has no gaps.
        LineStatus::Driving => (Role::LineDriving, Pattern::Dash { on: 6, of: 8 }),
        LineStatus::Driven => (Role::LineDriven, Pattern::Sparse(2)),
        LineStatus::Blocked => (Role::LineBlocked, Pattern::Dash { on: 3, of: 5 }),
        LineStatus::Skipped => (Role::LineSkipped, Pattern::Sparse(6)),
        LineStatus::Rejected => (Role::LineRejected, Pattern::Sparse(8)),
    }
}

fn draw_line(canvas: &mut Canvas, line: &PlanLine, rejected: bool) {
    if matches!(line.status, LineStatus::Skipped | LineStatus::Rejected) && !rejected {
        return;
    }
    let (role, pattern) = look(line.status);
    let (from, to) = line.drive.unwrap_or((line.start, line.end));
    canvas.line(from, to, role, pattern);
}

/// The wall line, and otherwise than wall what nobody touched of it.
fn draw_wall(canvas: &mut Canvas, outline: &Ring, map: &RoomMap) {
    let straits = map.beyond.iter().filter_map(Beyond::mouth);
    let mouths = map.unreached.iter().filter(|gap| gap.is_untouched()).copied();
    let untouched: Vec<Unreached> = mouths.chain(straits).collect();
    if untouched.is_empty() {
        return canvas.ring(outline, Role::Wall);
    }
    let stretches: Vec<usize> = untouched.iter().filter_map(|gap| gap.piece_of(outline)).collect();
    for (k, piece) in outline.pieces.iter().enumerate() {
        if stretches.contains(&k) {
            canvas.line(piece.from(), piece.to(), Role::Untouched, UNTOUCHED);
        } else {
            let points = Ring { pieces: vec![*piece] }.to_points(canvas.sagitta());
            canvas.polyline(points.into_iter().chain([piece.to()]), Role::Wall);
        }
    }
    for gap in untouched.iter().filter(|gap| gap.piece_of(outline).is_none()) {
        canvas.clear_disc(gap.at, gap.width / 2.0);
    }
}

fn draw_cuts(canvas: &mut Canvas, part: &Part) {
    for (piece, cut) in part.ring.pieces.iter().zip(&part.cut) {
        if *cut {
            canvas.line(piece.from(), piece.to(), Role::Cut, CUT);
        }
    }
}

fn draw_robot(canvas: &mut Canvas, snapshot: &Snapshot) {
    let Some((robot, current)) = robot(snapshot) else {
        return;
    };
    // What is not known is not drawn; the panel says so.
    let Some(pose) = robot.pose else { return };
    let chassis = &snapshot.settings.chassis;
    let (center, radius) = (pose.position, chassis.radius);
    let role = if current { Role::Robot } else { Role::RobotStale };
    // The rejected lines are dense: among them the robot would not be seen.
    canvas.clear_background(center, radius + 4.0 * canvas.view().scale, Role::Trajectory);
    canvas.clear_disc(center, radius);
    canvas.circle(center, radius, role, Pattern::Solid);
    let nose = center + pose.direction() * radius;
    canvas.line(center, nose, role, Pattern::Solid);
    // How the switches were when it was heard last is nothing to go by.
    for index in robot.switches.iter().filter(|_| current) {
        let Some(mount) = chassis.sensors.get(index) else {
            continue;
        };
        let beam = angle::unit(pose.heading + mount.angle);
        let (rim, end) = (center + beam * radius, center + beam * chassis.reach());
        canvas.line(rim, end, Role::Beam, Pattern::Solid);
    }
}

/// A bar of a round length at the lower left.
fn draw_scale(canvas: &Canvas, theme: &Theme, area: Rect, buf: &mut Buffer) {
    let view = canvas.view();
    let cell = view.scale * 2.0;
    let most = f64::from(area.width) * cell / 4.0;
    let lengths = [
        2000.0, 1000.0, 500.0, 200.0, 100.0, 50.0, 20.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05,
        0.02, 0.01,
    ];
    let Some(length) = lengths.into_iter().find(|length| *length <= most) else {
        return;
    };
    // To half a cell, which is as fine as this symbol goes.
    let halves = (length / cell * 2.0).round().max(1.0) as usize;
    let text =
        if length < 1.0 { format!("{:.0} cm", length * 100.0) } else { format!("{length:.0} m") };
    let mut pen = Pen::new(buf, theme, area);
    let row = area.bottom().saturating_sub(1);
    let bar: String = "━".repeat(halves / 2) + if halves % 2 == 1 { "╸" } else { "" };
    let x = pen.text(area.x + 1, row, &bar, Role::Muted);
    pen.text(x + 1, row, &text, Role::Muted);
}

/// Writes the map's title into the rule above it: how large the room is, or how much floor is shown.
pub fn draw_title(
    model: &Model,
    snapshot: &Snapshot,
    view: Viewport,
    theme: &Theme,
    regions: &Regions,
    buf: &mut Buffer,
) {
    let (width, height) = (view.x_range(), view.y_range());
    // Near by, tenths of a metre say nothing.
    let shown = if width.min(height) < 0.5 {
        format!("{:.1} × {:.1} cm shown", width * 100.0, height * 100.0)
    } else {
        format!("{width:.1} × {height:.1} m shown")
    };
    let room = snapshot.map.shape.as_ref().and_then(|shape| shape.outline.bounds());
    // The longest that has room: beside it is the title of the panel.
    let what = match (model.camera, room) {
        (Camera::Fit, Some((low, high))) => {
            vec![format!("room {:.2} × {:.2} m", high.x - low.x, high.y - low.y)]
        }
        (Camera::Fit, None) => vec![shown],
        (Camera::Follow { .. }, _) => vec![format!("{shown} · following"), shown],
        (Camera::Free { .. }, _) => {
            let fit = model.keymap.way(Action::Fit);
            vec![format!("{shown} · free view, {fit} fits"), format!("{shown}, {fit} fits"), shown]
        }
    };
    let titles = what.into_iter().map(|what| format!(" map · {what} ")).collect();
    let rule = Rect { width: regions.map.width, ..regions.top_rule };
    let mut pen = Pen::new(buf, theme, rule);
    if let Some(title) = words::shortened(titles, rule.width.saturating_sub(3)) {
        pen.text(rule.x + 2, rule.y, &title, Role::Title);
    }
}
