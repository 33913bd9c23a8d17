//! The help: every action with its keys, from the one table; what the map shows, and the words beside it.

use super::pen::Pen;
use super::words;
use crate::console::action::{ACTIONS, Group};
use crate::console::command::COMMANDS;
use crate::console::model::Model;
use crate::console::theme::{Role, Theme};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

type Line = Vec<(Role, String)>;

/// What the colours and patterns of the map mean.
const LEGEND: [(Role, &str, &str); 12] = [
    (Role::Wall, "━━", "wall"),
    (Role::Object, "━━", "object that stands free, with its number"),
    (Role::Contact, "··", "contact: something was met there"),
    (Role::Cut, "╍╍", "cut between two parts of the floor"),
    (Role::LinePlanned, "··", "line of the plan, to be driven"),
    (Role::LineDriving, "━━", "line being driven"),
    (Role::LineDriven, "··", "line driven from end to end"),
    (Role::LineBlocked, "╍╍", "line that something stands on, driven as far as could be"),
    (Role::Trajectory, "━━", "where the robot went"),
    (Role::HiddenDisc, "○", "the largest disc that may still hide somewhere"),
    (Role::Robot, "○", "the robot; a stroke to its edge shows where it heads"),
    (Role::Start, "·", "where the run began"),
];

/// The words of the figures beside the map that are not plain.
const FIGURES: [(&str, &str); 6] = [
    ("± 1 sd", "how well the robot's place is known: one standard deviation"),
    (
        "misclos",
        "by how much the lap missed where it began, before adjusting: way, heading, 1 in N",
    ),
    ("± walls", "standard error of a wall, of the worst corner"),
    ("promise", "the largest free-standing disc that the plan would miss"),
    ("driven", "the same for what was driven so far"),
    ("narrow", "gaps too narrow for the robot, with floor behind them"),
];

/// The lines of the help on a screen of so many columns.
fn lines(model: &Model) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    let cols = model.size.0;
    let entry = |lines: &mut Vec<Line>, head: Line, at: u16, text: &str| {
        let mut head = head;
        for line in words::wrap(text, cols.saturating_sub(at + 3)) {
            head.push((Role::Text, line));
            lines.push(std::mem::replace(
                &mut head,
                vec![(Role::Text, " ".repeat(usize::from(at)))],
            ));
        }
    };
    for group in Group::ALL {
        lines.push(vec![(Role::Title, group.title().to_owned())]);
        for info in ACTIONS.iter().filter(|info| info.group == group) {
            let keys = model.keymap.label(info.action);
            let head = vec![
                (Role::Key, format!("  {keys:<12}")),
                (Role::Value, format!("{:<14}", info.name)),
            ];
            entry(&mut lines, head, 28, info.help);
        }
        lines.push(Vec::new());
    }
    lines.push(vec![(Role::Title, "Command line".to_owned())]);
    for (name, argument, help) in COMMANDS {
        let head = vec![(Role::Key, format!("  {:<20}", format!("{name}={argument}")))];
        entry(&mut lines, head, 22, help);
    }
    lines.push(Vec::new());
    lines.push(vec![(Role::Title, "On the map".to_owned())]);
    for (role, sign, meaning) in LEGEND {
        let head = vec![(role, format!("  {sign:<6}"))];
        entry(&mut lines, head, 8, meaning);
    }
    lines.push(Vec::new());
    lines.push(vec![(Role::Title, "Beside it".to_owned())]);
    for (label, meaning) in FIGURES {
        let head = vec![(Role::Muted, format!("  {label:<10}"))];
        entry(&mut lines, head, 12, meaning);
    }
    lines
}

/// How far the help can be scrolled.
#[must_use]
pub fn last_scroll(model: &Model) -> u16 {
    let room = usize::from(model.size.1.saturating_sub(5));
    u16::try_from(lines(model).len().saturating_sub(room)).unwrap_or(u16::MAX)
}

pub(super) fn draw(model: &Model, scroll: u16, theme: &Theme, area: Rect, buf: &mut Buffer) {
    let frame = Rect::new(area.x, area.y + 1, area.width, area.height.saturating_sub(2));
    let mut pen = Pen::new(buf, theme, frame);
    pen.clear(frame);
    let title = " help · up and down scroll, any other key leaves ";
    pen.text(frame.x + 2, frame.y, title, Role::Title);
    if scroll < last_scroll(model) {
        pen.text_right(frame.right() - 2, frame.bottom() - 1, " more below ", Role::Title);
    }
    let shown = lines(model).into_iter().skip(usize::from(scroll));
    for (y, line) in (frame.y + 2..frame.bottom() - 1).zip(shown) {
        pen.pieces(frame.x + 2, y, &line);
    }
}
