//! The figures: pose, switches, misclosure, shape, plan. What is unknown says so, what is old says
//! how old.

use super::pen::Pen;
use super::{switches, words};
use crate::console::theme::{Role, Theme};
use crate::mapping::map::{LineStatus, Phase, ShapeClass};
use crate::mapping::settings::Strategy;
use crate::session::snapshot::{Known, RobotView, Snapshot};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

/// One figure: what it is, what it says, and how soon it gives way where there is no room for all; what
/// has 0 stays as long as there is a row.
struct Row {
    label: &'static str,
    value: String,
    role: Role,
    spare: u8,
}

fn row(label: &'static str, value: impl Into<String>, role: Role) -> Row {
    Row { label, value: value.into(), role, spare: 0 }
}

impl Row {
    fn spare(self, spare: u8) -> Self {
        Self { spare, ..self }
    }
}

/// Where the values begin, columns from the left.
const VALUES: u16 = 9;

pub(super) fn draw(snapshot: &Snapshot, theme: &Theme, area: Rect, buf: &mut Buffer) {
    let mut pen = Pen::new(buf, theme, area);
    let mut y = area.y;
    for row in fitting(rows(snapshot, area.width.saturating_sub(VALUES)), area.height) {
        pen.text(area.x + 1, y, row.label, Role::Muted);
        pen.text(area.x + VALUES, y, &row.value, row.role);
        y += 1;
    }
    let over = snapshot.run.is_over();
    if !over && area.bottom().saturating_sub(y) >= 4 {
        y += 1;
        for row in &switches::rose(&snapshot.settings.chassis, view(snapshot).as_ref()) {
            pen.pieces(area.x + VALUES, y, row);
            y += 1;
        }
    }
    draw_objects(
        &mut pen,
        snapshot,
        Rect { y: y + 1, height: area.bottom().saturating_sub(y + 1), ..area },
    );
}

/// As many of `rows` as there is room for.
fn fitting(mut rows: Vec<Row>, room: u16) -> Vec<Row> {
    while rows.len() > usize::from(room) {
        let least = (0..rows.len()).max_by_key(|&k| rows[k].spare).unwrap_or(0);
        rows.remove(least);
    }
    rows
}

/// The objects with their sizes, as many as there is room for; where not all fit, how many more there are.
fn draw_objects(pen: &mut Pen<'_>, snapshot: &Snapshot, area: Rect) {
    let objects = &snapshot.map.objects;
    if objects.is_empty() || area.height < 2 {
        return;
    }
    let room = usize::from(area.height);
    let shown = if objects.len() <= room { objects.len() } else { room - 1 };
    let errors = snapshot.map.accuracy.as_ref().map(|accuracy| &accuracy.objects);
    for (k, y) in (0..shown).zip(area.y..) {
        let object = &objects[k];
        let error = errors.and_then(|errors| errors.get(k));
        let known = error.map_or_else(String::new, |error| format!("  ± {}", words::small(*error)));
        let size = object.size().unwrap_or_default();
        pen.text(area.x + 1, y, &format!("O{}", object.id), Role::Object);
        pen.text(area.x + VALUES, y, &format!("{} {size}{known}", object.class), Role::Text);
    }
    if shown < objects.len() {
        let more = format!("and {} more", objects.len() - shown);
        pen.text(area.x + VALUES, area.y + shown as u16, &more, Role::Muted);
    }
}

fn view(snapshot: &Snapshot) -> Option<RobotView> {
    match snapshot.robot {
        Known::Known(robot) | Known::Stale { value: robot, .. } => Some(robot),
        Known::Unknown => None,
    }
}

fn rows(snapshot: &Snapshot, width: u16) -> Vec<Row> {
    let mut rows = robot_rows(snapshot);
    for doubted in &snapshot.map.doubted {
        rows.push(row("broken", doubted.switch.clone(), Role::Warning));
    }
    rows.extend(command_rows(snapshot, width));
    rows.extend(map_rows(snapshot));
    rows.extend(plan_rows(snapshot));
    rows.extend(finding_rows(snapshot));
    rows
}

/// The command in hand, or the one that was done last, and why it was chosen.
fn command_rows(snapshot: &Snapshot, width: u16) -> Vec<Row> {
    let (label, role, command) = match (&snapshot.command, &snapshot.done) {
        (Some(command), _) => ("command", Role::Value, command),
        (None, Some(done)) if !snapshot.run.is_over() => ("done", Role::Text, done),
        _ => return Vec::new(),
    };
    let (command, why) = command;
    let mut rows = vec![row(label, words::command(command), role)];
    for (n, line) in (0..).zip(words::wrap(why, width)) {
        rows.push(row("", line, Role::Muted).spare(if n == 0 { 0 } else { 3 }));
    }
    rows
}

fn robot_rows(snapshot: &Snapshot) -> Vec<Row> {
    let pose = |robot: &RobotView| {
        let Some(pose) = robot.pose else { return "not known: lost".to_owned() };
        // No minus before a zero.
        let degrees = pose.heading.to_degrees().round() + 0.0;
        format!("{:.3} {:.3}  {degrees:.0}°", pose.position.x, pose.position.y)
    };
    match &snapshot.robot {
        Known::Unknown => vec![row("pose", "not heard yet", Role::Unknown)],
        Known::Stale { value, age } => {
            let age = format!("{age:.1} s old");
            vec![row("pose", pose(value), Role::Stale), row("", age, Role::Warning)]
        }
        Known::Known(robot) => {
            let closed = switches::closed(&snapshot.settings.chassis, robot);
            let known = |_| words::small(robot.position_sd);
            let sd = robot.pose.map_or_else(|| "-".to_owned(), known);
            let role_of = |robot: &RobotView| {
                if robot.pose.is_some() { Role::Value } else { Role::Unknown }
            };
            let role = if robot.switches.is_empty() { Role::Muted } else { Role::Active };
            let bumper =
                if robot.bumper { ("pressed", Role::Active) } else { ("free", Role::Muted) };
            let bumps = format!("{}, {} so far", bumper.0, snapshot.bumps);
            let spare = u8::from(snapshot.run.is_over());
            vec![
                row("pose", pose(robot), role_of(robot)),
                row("± 1 sd", sd, Role::Text).spare(spare),
                row("switch", closed, role).spare(spare),
                row("bumper", bumps, bumper.1),
            ]
        }
    }
}

/// What the lap has come to: how well it closed, and the shape of what it went round.
fn map_rows(snapshot: &Snapshot) -> Vec<Row> {
    let map = &snapshot.map;
    let mut rows: Vec<Row> = Vec::new();
    if map.shape.is_none() {
        rows.push(row("contact", format!("{} kept", map.contacts.len()), Role::Text));
    }
    if let Some(off) = map.misclosure {
        let size = crate::geometry::angle::hypot(off.dx, off.dy);
        let ratio = if off.ratio() > 99_999.0 {
            "none".to_owned()
        } else {
            format!("1:{:.0}", off.ratio())
        };
        let text = format!(
            "{} {}° {ratio}",
            words::small(size),
            words::hundredths(off.heading.to_degrees())
        );
        rows.push(row("misclos", text, Role::Value).spare(1));
    }
    if map.laps > 1 {
        rows.push(row("laps", format!("{}, averaged", map.laps), Role::Value).spare(2));
    }
    if let Some(shape) = &map.shape {
        let area = format!("{}, {:.1} m²", shape.class, shape.outline.area());
        rows.push(row("shape", area, Role::Value));
        let vertices = words::count(shape.vertices.len(), "vertex", "vertices");
        let parts = words::count(shape.parts.len(), "part", "parts");
        let circle = shape.parts.first().and_then(|part| part.circle);
        let what = match (shape.class, circle) {
            (ShapeClass::Circle, Some((_, radius))) => format!("radius {radius:.3} m"),
            _ => format!("{vertices}, {parts}"),
        };
        rows.push(row("", what, Role::Text).spare(4));
    }
    if let Some(accuracy) = &map.accuracy
        && let Some((_, worst)) = accuracy.worst_corner()
    {
        let mut walls = accuracy.walls.clone();
        walls.sort_by(f64::total_cmp);
        let median = walls.get(walls.len() / 2).copied().unwrap_or(worst);
        rows.push(row("± walls", words::small(median), Role::Text));
        let worst = format!("± {} at worst", words::small(worst));
        rows.push(row("corners", worst, Role::Text).spare(3));
    }
    if let Some(squared) = &map.squared {
        let (turned, moved) = (squared.turned.to_degrees(), words::small(squared.moved));
        let walls = words::count(squared.walls, "wall", "walls");
        rows.push(row("squared", format!("{walls}, {turned:.1}°, {moved}"), Role::Value).spare(1));
    }
    rows
}

/// The plan, how much of it is done, and what may still hide.
fn plan_rows(snapshot: &Snapshot) -> Vec<Row> {
    let map = &snapshot.map;
    let mut rows: Vec<Row> = Vec::new();
    if let Some(plan) = &map.plan {
        let name = match plan.figures.strategy {
            Strategy::Paper => "paper",
            Strategy::Lean => "lean",
            Strategy::Lanes => "lanes",
        };
        let (alpha, length) = (plan.alpha, plan.figures.length);
        rows.push(row("plan", format!("{name} α {alpha:.2}, {length:.0} m"), Role::Value));
        let count = |status: LineStatus, of_plan: bool| {
            let lines = plan.lines.iter().filter(|line| line.status == status);
            lines.filter(|line| plan.is_own(line.id) == of_plan).count()
        };
        let whole = count(LineStatus::Driven, true);
        let blocked = count(LineStatus::Blocked, true);
        let left_out = count(LineStatus::Skipped, true);
        let more = match count(LineStatus::Driven, false) {
            0 => String::new(),
            more => format!(", {more} added"),
        };
        let (done, lines) = (whole + blocked + left_out, plan.figures.lines);
        rows.push(row("lines", format!("{done}/{lines} done{more}"), Role::Text));
        if blocked + left_out > 0 {
            let short = format!("{whole} whole, {} not", blocked + left_out);
            rows.push(row("", short, Role::Text).spare(3));
        }
        let hidden = words::small(plan.figures.hidden_disc);
        rows.push(row("promise", format!("hidden disc {hidden}"), Role::Value));
    }
    if let Some(disc) = map.hidden_disc {
        let role = if map.shortfall().is_some() { Role::Warning } else { Role::Value };
        rows.push(row("driven", format!("hidden disc {}", words::small(disc)), role));
    }
    rows
}

/// The objects, and the gaps that lead to floor nobody has seen.
fn finding_rows(snapshot: &Snapshot) -> Vec<Row> {
    let map = &snapshot.map;
    let mut rows: Vec<Row> = Vec::new();
    let open = map.objects.iter().filter(|object| !object.closed).count();
    if !map.objects.is_empty() {
        let objects = words::count(map.objects.len(), "object", "objects");
        let note = if open > 0 { format!(", {open} open") } else { String::new() };
        rows.push(row("objects", format!("{objects}{note}"), Role::Value));
    } else if snapshot.progress[Phase::Objects as usize].done {
        rows.push(row("objects", "none found", Role::Value));
    }
    if !map.unreached.is_empty() {
        let most = map.unreached.iter().map(|gap| gap.width).fold(0.0, f64::max);
        let gaps = words::count(map.unreached.len(), "gap", "gaps");
        rows.push(row("narrow", format!("{gaps}, to {}", words::small(most)), Role::Text).spare(1));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_there_is_no_room_for_all_what_matters_least_gives_way() {
        let rows = || {
            vec![
                row("a", "", Role::Text),
                row("b", "", Role::Text).spare(1),
                row("c", "", Role::Text).spare(4),
            ]
        };
        let labels = |room: u16| -> Vec<&str> {
            fitting(rows(), room).iter().map(|row| row.label).collect()
        };
        assert_eq!(labels(5), ["a", "b", "c"]);
        assert_eq!(labels(2), ["a", "b"]);
        assert_eq!(labels(1), ["a"]);
        assert!(labels(0).is_empty());
    }
}
