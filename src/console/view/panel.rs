//! The figures: pose, switches, misclosure, shape, plan. What is unknown says so, what is old says
//! how old. What does not fit goes to the next line or is left out: no figure is ever cut.

mod objects;

use super::pen::Pen;
use super::{switches, words};
use crate::console::theme::{Role, Theme};
use crate::mapping::map::{Alike, LineStatus, Phase, ShapeClass};
use crate::mapping::settings::Strategy;
use crate::robot::DoneReason;
use crate::session::snapshot::{Known, RobotView, Snapshot};
use crate::wording;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

/// One figure: what it is, what it says, and how soon it gives way where there is no room for all; what
/// has 0 stays as long as there is a row. What it says is in parts that are never broken: a number stays
/// with its unit, and goes to the next line whole.
struct Row {
    label: String,
    label_role: Role,
    parts: Vec<String>,
    role: Role,
    spare: u8,
}

/// A figure that is one part.
fn row(label: &str, value: impl Into<String>, role: Role) -> Row {
    figures(label, vec![value.into()], role)
}

/// A figure that may be broken between `parts`.
fn figures(label: &str, parts: Vec<String>, role: Role) -> Row {
    Row { label: label.to_owned(), label_role: Role::Muted, parts, role, spare: 0 }
}

/// Words, which may be broken anywhere between them.
fn prose(label: &str, text: &str, role: Role) -> Row {
    figures(label, text.split(' ').map(str::to_owned).collect(), role)
}

impl Row {
    fn spare(self, spare: u8) -> Self {
        Self { spare, ..self }
    }

    /// What it says on a panel with so much room for it.
    fn lines(&self, room: u16) -> Vec<String> {
        words::joined(&self.parts, room)
    }
}

/// Where the values begin, columns from the left.
const VALUES: u16 = 9;

pub(super) fn draw(snapshot: &Snapshot, theme: &Theme, area: Rect, buf: &mut Buffer) {
    let mut pen = Pen::new(buf, theme, area);
    let room = area.width.saturating_sub(VALUES);
    let objects = objects::rows(snapshot, room);
    let over = snapshot.run.is_over();
    // At the end what was found matters more than how it was found.
    let kept = if over { objects.len().min(usize::from(area.height / 2)) } else { 0 };
    let mut y = area.y;
    for row in fitting(rows(snapshot, room), room, area.height - kept as u16) {
        y = draw_row(&mut pen, &row, area, y);
    }
    if !over && area.bottom().saturating_sub(y) >= 4 {
        y += 1;
        for row in &switches::rose(&snapshot.settings.chassis, heard(snapshot).as_ref()) {
            pen.pieces(area.x + VALUES, y, row);
            y += 1;
        }
    }
    // A row of air before the list, where there is one to spare.
    let left = usize::from(area.bottom().saturating_sub(y));
    y += u16::from(!over || objects.len() < left);
    for row in objects::fitting(objects, area.bottom().saturating_sub(y)) {
        y = draw_row(&mut pen, &row, area, y);
    }
}

/// Draws one figure and answers the row below it.
fn draw_row(pen: &mut Pen<'_>, row: &Row, area: Rect, mut y: u16) -> u16 {
    pen.text(area.x + 1, y, &row.label, row.label_role);
    for line in row.lines(area.width.saturating_sub(VALUES)) {
        pen.text(area.x + VALUES, y, &line, row.role);
        y += 1;
    }
    y
}

/// As many of `rows` as `height` has room for.
fn fitting(mut rows: Vec<Row>, room: u16, height: u16) -> Vec<Row> {
    let taken = |rows: &[Row]| rows.iter().map(|row| row.lines(room).len()).sum::<usize>();
    while taken(&rows) > usize::from(height) {
        let Some(least) = (0..rows.len()).max_by_key(|&k| rows[k].spare) else { break };
        rows.remove(least);
    }
    rows
}

/// What the robot says of itself now: how its switches were is nothing to go by.
fn heard(snapshot: &Snapshot) -> Option<RobotView> {
    match snapshot.robot {
        Known::Known(robot) => Some(robot),
        Known::Stale { .. } | Known::Unknown => None,
    }
}

fn rows(snapshot: &Snapshot, room: u16) -> Vec<Row> {
    let mut rows = robot_rows(snapshot, room);
    for doubted in &snapshot.map.doubted {
        rows.push(row("broken", doubted.switch.clone(), Role::Warning));
    }
    rows.extend(command_rows(snapshot));
    rows.extend(map_rows(snapshot));
    rows.extend(plan_rows(snapshot));
    rows.extend(finding_rows(snapshot));
    rows
}

/// The command in hand, or how the last one ended, and why it was chosen.
fn command_rows(snapshot: &Snapshot) -> Vec<Row> {
    let (label, role, command, why) = match (&snapshot.command, &snapshot.done) {
        (Some((command, _)), _) if matches!(snapshot.robot, Known::Stale { .. }) => {
            let what = figures("told", words::command(command), Role::Stale);
            return vec![what, prose("", "not heard of since", Role::Warning).spare(2)];
        }
        (Some((command, why)), _) => ("command", Role::Value, command, why),
        (None, Some(done)) if !snapshot.run.is_over() => {
            (ended(done.reason), Role::Text, &done.command, &done.why)
        }
        _ => return Vec::new(),
    };
    vec![figures(label, words::command(command), role), prose("", why, Role::Muted).spare(2)]
}

/// How a motion ended: one that was broken off is not done.
fn ended(reason: Option<DoneReason>) -> &'static str {
    match reason {
        Some(DoneReason::Complete | DoneReason::Guard { .. }) => "done",
        Some(DoneReason::Stopped | DoneReason::HostSilent) => "stopped",
        Some(DoneReason::Bumper) => "bumped",
        Some(DoneReason::Stalled) => "stalled",
        Some(DoneReason::TimeLimit) | None => "ended",
    }
}

/// Where the robot is believed to be: to the millimetre where there is room for that.
fn pose_parts(robot: &RobotView, room: u16) -> Vec<String> {
    let Some(pose) = robot.pose else { return vec!["not known: lost".to_owned()] };
    let (x, y) = (pose.position.x, pose.position.y);
    // No minus before a zero, nor before a half turn.
    let degrees = match pose.heading.to_degrees().round() + 0.0 {
        -180.0 => 180.0,
        degrees => degrees,
    };
    let whole = format!("{x:.3} {y:.3}  {degrees:.0}°");
    if words::shortened(vec![whole.clone()], room).is_some() {
        return vec![whole];
    }
    vec![words::hundredths(x), words::hundredths(y), format!("{degrees:.0}°")]
}

fn robot_rows(snapshot: &Snapshot, room: u16) -> Vec<Row> {
    let pose = |robot: &RobotView, role: Role| figures("pose", pose_parts(robot, room), role);
    match &snapshot.robot {
        Known::Unknown => vec![row("pose", "not heard yet", Role::Unknown)],
        Known::Stale { value, age } => {
            let age = format!("{age:.1} s old");
            vec![pose(value, Role::Stale), row("", age, Role::Warning)]
        }
        Known::Known(robot) => {
            let closed = switches::closed(&snapshot.settings.chassis, robot);
            let known = |_| wording::error(robot.position_sd);
            let sd = robot.pose.map_or_else(|| "-".to_owned(), known);
            let place = if robot.pose.is_some() { Role::Value } else { Role::Unknown };
            let role = if robot.switches.is_empty() { Role::Muted } else { Role::Active };
            let bumper =
                if robot.bumper { ("pressed,", Role::Active) } else { ("free,", Role::Muted) };
            let bumps = format!("{} so far", snapshot.bumps);
            // How the robot stands matters no more when all is driven.
            let spare = if snapshot.run.is_over() { 4 } else { 0 };
            vec![
                pose(robot, place).spare(spare / 2),
                row("± 1 sd", sd, Role::Text).spare(spare),
                prose("switch", &closed, role).spare(spare),
                figures("bumper", vec![bumper.0.to_owned(), bumps], bumper.1).spare(spare),
            ]
        }
    }
}

/// Where else the lap would have closed: what gives way last.
fn alike_row(alike: Alike) -> Row {
    row("as well", alike.where_to(), Role::Warning)
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
        let heading = format!("{}°", words::hundredths(off.heading.to_degrees()));
        let parts = vec![words::small(size), heading, ratio];
        rows.push(figures("misclos", parts, Role::Value).spare(1));
    }
    rows.extend(map.alike.map(alike_row));
    if map.laps > 1 {
        let laps = vec![format!("{},", map.laps), "averaged".to_owned()];
        rows.push(figures("laps", laps, Role::Value).spare(2));
    }
    if let Some(shape) = &map.shape {
        let parts = vec![format!("{},", shape.class), format!("{:.1} m²", shape.outline.area())];
        rows.push(figures("shape", parts, Role::Value));
        let vertices = words::count(shape.vertices.len(), "vertex", "vertices");
        let parts = words::count(shape.parts.len(), "part", "parts");
        let circle = shape.parts.first().and_then(|part| part.circle);
        let what = match (shape.class, circle) {
            (ShapeClass::Circle, Some((_, radius))) => {
                vec!["radius".to_owned(), format!("{radius:.3} m")]
            }
            _ => vec![format!("{vertices},"), parts],
        };
        rows.push(figures("", what, Role::Text).spare(4));
    }
    if let Some(accuracy) = &map.accuracy
        && let Some(median) = wording::median(&accuracy.walls)
    {
        rows.push(row("± walls", wording::error(median), Role::Text));
        if let Some((_, worst)) = accuracy.worst_corner() {
            let worst = vec![format!("± {}", wording::error(worst)), "at worst".to_owned()];
            rows.push(figures("corners", worst, Role::Text).spare(3));
        }
        if let Some(datum) = &accuracy.datum {
            let whole =
                vec![format!("{},", wording::turn_error(datum.turn)), wording::error(datum.shift)];
            rows.push(figures("± whole", whole, Role::Text).spare(3));
            rows.push(row("± among", wording::error(datum.within), Role::Text).spare(2));
        }
    }
    if let Some(squared) = &map.squared {
        let (turned, moved) = (squared.turned.to_degrees(), words::small(squared.moved));
        let walls = words::count(squared.walls, "wall", "walls");
        let parts = vec![format!("{walls},"), format!("{turned:.1}°,"), moved];
        rows.push(figures("squared", parts, Role::Value).spare(1));
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
        let parts = vec![name.to_owned(), format!("α {alpha:.2},"), format!("{length:.0} m")];
        rows.push(figures("plan", parts, Role::Value));
        let own = plan.own();
        let count = |status: LineStatus| {
            let lines = plan.lines.iter().filter(|line| line.status == status);
            lines.filter(|line| own.contains(&line.id)).count()
        };
        let whole = count(LineStatus::Driven);
        let blocked = count(LineStatus::Blocked);
        let left_out = count(LineStatus::Skipped);
        let (done, lines) = (whole + blocked + left_out, plan.figures.lines);
        let parts = match plan.added().count() {
            0 => vec![format!("{done}/{lines} done")],
            more => vec![format!("{done}/{lines} done,"), format!("{more} added")],
        };
        rows.push(figures("lines", parts, Role::Text));
        if blocked + left_out > 0 {
            let parts = vec![format!("{whole} whole,"), format!("{} not", blocked + left_out)];
            rows.push(figures("", parts, Role::Text).spare(3));
        }
        rows.push(hidden_disc("promise", plan.figures.hidden_disc, Role::Value));
    }
    if let Some(disc) = map.hidden_disc {
        let role = if map.shortfall().is_some() { Role::Warning } else { Role::Value };
        rows.push(hidden_disc("driven", disc, role));
    }
    rows
}

fn hidden_disc(label: &str, diameter: f64, role: Role) -> Row {
    figures(label, vec!["hidden disc".to_owned(), words::small(diameter)], role)
}

/// The objects, the gaps that lead to floor nobody has seen, and what may be a gap or wall.
fn finding_rows(snapshot: &Snapshot) -> Vec<Row> {
    let map = &snapshot.map;
    let mut rows: Vec<Row> = Vec::new();
    let open = map.objects.iter().filter(|object| !object.closed).count();
    if !map.objects.is_empty() {
        let found = format!("{} found", map.objects.len());
        let parts = match open {
            0 => vec![found],
            open => vec![format!("{found},"), format!("{open} open")],
        };
        rows.push(figures("objects", parts, Role::Value));
    } else if snapshot.progress[Phase::Objects as usize].done {
        rows.push(row("objects", "none found", Role::Value));
    }
    rows.extend(gap_row(snapshot, "narrow", ("gap", "gaps"), true));
    rows.extend(gap_row(snapshot, "unknown", ("stretch", "stretches"), false));
    rows
}

/// How many gaps there are and how wide the widest is: those with floor `behind` them, or those of
/// which nobody knows what they are.
fn gap_row(snapshot: &Snapshot, label: &str, names: (&str, &str), behind: bool) -> Option<Row> {
    let all = snapshot.map.unreached.iter().filter(|gap| gap.area.is_some() == behind);
    let widths: Vec<f64> = all.map(|gap| gap.width).collect();
    let most = widths.iter().copied().reduce(f64::max)?;
    let count = words::count(widths.len(), names.0, names.1);
    let parts = vec![format!("{count},"), format!("to {}", words::small(most))];
    Some(figures(label, parts, Role::Text).spare(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;

    #[test]
    fn where_there_is_no_room_for_all_what_matters_least_gives_way() {
        let rows = || {
            vec![
                row("a", "", Role::Text),
                prose("b", "two lines", Role::Text).spare(1),
                row("c", "", Role::Text).spare(4),
            ]
        };
        let labels = |height: u16| -> Vec<String> {
            fitting(rows(), 6, height).into_iter().map(|row| row.label).collect()
        };
        assert_eq!(labels(4), ["a", "b", "c"]);
        assert_eq!(labels(3), ["a", "b"]);
        assert_eq!(labels(2), ["a"]);
        assert_eq!(labels(1), ["a"]);
        assert!(labels(0).is_empty());
    }

    #[test]
    fn another_end_of_the_lap_is_told_however_little_room_there_is() {
        let rows = [
            row("misclos", "", Role::Value).spare(1),
            alike_row(Alike { longer: -2.06, drift: -3e-4 }),
        ];
        let [left] = &fitting(rows.into(), 24, 1)[..] else { panic!("no room for it") };
        assert_eq!((left.label.as_str(), left.role), ("as well", Role::Warning));
        assert_eq!(left.parts.join(" "), "2.06 m sooner");
    }

    #[test]
    fn half_a_turn_is_the_same_either_way() {
        let pose = |degrees: f64| {
            let pose = Some(Pose::new(0.0, 0.0, degrees.to_radians()));
            let (switches, bumper, moving, needs_place) = Default::default();
            pose_parts(
                &RobotView { pose, position_sd: 0.0, switches, bumper, moving, needs_place },
                9,
            )
        };
        for (degrees, told) in
            [(-179.6, "180°"), (179.6, "180°"), (-0.3, "0°"), (-179.4, "-179°"), (90.0, "90°")]
        {
            assert_eq!(pose(degrees).last().map(String::as_str), Some(told), "{degrees}");
        }
    }

    #[test]
    fn a_number_goes_to_the_next_line_with_its_unit_or_not_at_all() {
        let parts = ["24 walls,", "0.3°,", "11 mm"].map(str::to_owned).to_vec();
        let row = figures("squared", parts.clone(), Role::Value);
        for room in 9..30 {
            let told = row.lines(room);
            assert!(told.iter().all(|line| super::super::pen::width(line) <= room), "{told:?}");
            assert_eq!(told.join(" "), parts.join(" "), "{room} columns");
            assert!(told.last().is_some_and(|line| line.ends_with("11 mm")), "{told:?}");
        }
    }
}
