//! The figures: pose, switches, misclosure, shape, plan. What is unknown says so, what is old says
//! how old.

use super::pen::Pen;
use super::{switches, words};
use crate::console::theme::{Role, Theme};
use crate::mapping::map::LineStatus;
use crate::mapping::settings::Strategy;
use crate::session::snapshot::{Known, RobotView, Snapshot};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

type Row = (&'static str, String, Role);

pub(super) fn draw(snapshot: &Snapshot, theme: &Theme, area: Rect, buf: &mut Buffer) {
    let mut pen = Pen::new(buf, theme, area);
    let mut y = area.y;
    for (label, value, role) in rows(snapshot) {
        if y >= area.bottom() {
            break;
        }
        pen.text(area.x + 1, y, label, Role::Muted);
        pen.text(area.x + 9, y, &value, role);
        y += 1;
    }
    let rose = switches::rose(&snapshot.settings.chassis, view(snapshot).as_ref());
    if area.bottom().saturating_sub(y) >= 4 {
        y += 1;
        for row in &rose {
            pen.pieces(area.x + 9, y, row);
            y += 1;
        }
    }
}

fn view(snapshot: &Snapshot) -> Option<RobotView> {
    match snapshot.robot {
        Known::Known(robot) | Known::Stale { value: robot, .. } => Some(robot),
        Known::Unknown => None,
    }
}

fn rows(snapshot: &Snapshot) -> Vec<Row> {
    let mut rows = robot_rows(snapshot);
    for doubted in &snapshot.map.doubted {
        rows.push(("broken", doubted.switch.clone(), Role::Warning));
    }
    rows.push(match &snapshot.command {
        Some((command, _)) => ("command", words::command(command), Role::Value),
        None => ("command", "none".to_owned(), Role::Muted),
    });
    if let Some((_, why)) = &snapshot.command {
        rows.push(("", why.clone(), Role::Muted));
    }
    rows.extend(map_rows(snapshot));
    rows
}

fn robot_rows(snapshot: &Snapshot) -> Vec<Row> {
    let pose = |robot: &RobotView| {
        let Some(pose) = robot.pose else { return "not known: lost".to_owned() };
        let degrees = pose.heading.to_degrees();
        format!("{:.3} {:.3}  {degrees:.0}°", pose.position.x, pose.position.y)
    };
    match &snapshot.robot {
        Known::Unknown => vec![("pose", "not heard yet".to_owned(), Role::Unknown)],
        Known::Stale { value, age } => {
            vec![("pose", pose(value), Role::Stale), ("", format!("{age:.1} s old"), Role::Warning)]
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
            vec![
                ("pose", pose(robot), role_of(robot)),
                ("± 1 sd", sd, Role::Text),
                ("switch", closed, role),
                ("bumper", format!("{}, {} so far", bumper.0, snapshot.bumps), bumper.1),
            ]
        }
    }
}

fn map_rows(snapshot: &Snapshot) -> Vec<Row> {
    let map = &snapshot.map;
    let mut rows: Vec<Row> = vec![("contact", format!("{} kept", map.contacts.len()), Role::Text)];
    if let Some(off) = map.misclosure {
        let size = crate::geometry::angle::hypot(off.dx, off.dy);
        let ratio = if off.ratio() > 99_999.0 {
            "none".to_owned()
        } else {
            format!("1:{:.0}", off.ratio())
        };
        let text = format!("{} {:.2}° {ratio}", words::small(size), off.heading.to_degrees());
        rows.push(("misclos", text, Role::Value));
    }
    if map.laps > 1 {
        rows.push(("laps", format!("{}, averaged", map.laps), Role::Value));
    }
    if let Some(shape) = &map.shape {
        let vertices = words::count(shape.vertices.len(), "vertex", "vertices");
        rows.push(("shape", format!("{}, {vertices}", shape.class), Role::Value));
        let parts = words::count(shape.parts.len(), "part", "parts");
        rows.push(("", format!("{parts}, {:.1} m²", shape.outline.area()), Role::Text));
    }
    if let Some(accuracy) = &map.accuracy
        && let Some((_, worst)) = accuracy.worst_corner()
    {
        let mut walls = accuracy.walls.clone();
        walls.sort_by(f64::total_cmp);
        let median = words::small(walls.get(walls.len() / 2).copied().unwrap_or(worst));
        rows.push(("± walls", format!("{median}, to {}", words::small(worst)), Role::Text));
    }
    if let Some(squared) = &map.squared {
        let (turned, moved) = (squared.turned.to_degrees(), words::small(squared.moved));
        let walls = words::count(squared.walls, "wall", "walls");
        rows.push(("squared", format!("{walls}, {turned:.1}°, {moved}"), Role::Value));
    }
    if let Some(plan) = &map.plan {
        let name = match plan.figures.strategy {
            Strategy::Paper => "paper",
            Strategy::Lean => "lean",
            Strategy::Lanes => "lanes",
        };
        // What the plan's own lines could not sweep is driven by lines that came later.
        let own = |id: u32| plan.order.iter().any(|(of_plan, _)| *of_plan == id);
        let driven = plan.lines.iter().filter(|line| line.status == LineStatus::Driven);
        let (done, more): (Vec<_>, Vec<_>) = driven.partition(|line| own(line.id));
        let more = if more.is_empty() { String::new() } else { format!(", +{}", more.len()) };
        let (alpha, length) = (plan.alpha, plan.figures.length);
        rows.push(("plan", format!("{name} α {alpha:.2}, {length:.0} m"), Role::Value));
        let lines = plan.figures.lines;
        rows.push(("", format!("{} of {lines} driven{more}", done.len()), Role::Text));
        let hidden = words::small(plan.figures.hidden_disc);
        rows.push(("promise", format!("hidden disc {hidden}"), Role::Value));
    }
    if let Some(disc) = map.hidden_disc {
        let role = if map.shortfall().is_some() { Role::Warning } else { Role::Value };
        rows.push(("as drvn", format!("hidden disc {}", words::small(disc)), role));
    }
    let open = map.objects.iter().filter(|object| !object.closed).count();
    if !map.objects.is_empty() {
        let objects = words::count(map.objects.len(), "object", "objects");
        let note = if open > 0 { format!(", {open} open") } else { String::new() };
        rows.push(("objects", format!("{objects}{note}"), Role::Value));
    }
    if !map.unreached.is_empty() {
        let most = map.unreached.iter().map(|gap| gap.width).fold(0.0, f64::max);
        let gaps = words::count(map.unreached.len(), "gap", "gaps");
        rows.push(("narrow", format!("{gaps}, to {}", words::small(most)), Role::Text));
    }
    rows
}
