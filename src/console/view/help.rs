//! The help: every action with its keys, from the one table.

use super::pen::Pen;
use crate::console::action::{ACTIONS, Group};
use crate::console::command::COMMANDS;
use crate::console::model::Model;
use crate::console::theme::{Role, Theme};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

type Line = Vec<(Role, String)>;

fn lines(model: &Model) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for group in Group::ALL {
        lines.push(vec![(Role::Title, group.title().to_owned())]);
        for info in ACTIONS.iter().filter(|info| info.group == group) {
            let keys = model.keymap.label(info.action);
            lines.push(vec![
                (Role::Key, format!("  {keys:<14}")),
                (Role::Value, format!("{:<14}", info.name)),
                (Role::Text, info.help.to_owned()),
            ]);
        }
        lines.push(Vec::new());
    }
    lines.push(vec![(Role::Title, "command line".to_owned())]);
    for (name, argument, help) in COMMANDS {
        lines.push(vec![
            (Role::Key, format!("  {:<28}", format!("{name} {argument}"))),
            (Role::Text, (*help).to_owned()),
        ]);
    }
    lines
}

/// How far the help can be scrolled.
#[must_use]
pub fn last_scroll(model: &Model) -> u16 {
    let room = usize::from(model.size.1.saturating_sub(4));
    u16::try_from(lines(model).len().saturating_sub(room)).unwrap_or(u16::MAX)
}

pub(super) fn draw(model: &Model, scroll: u16, theme: &Theme, area: Rect, buf: &mut Buffer) {
    let frame = Rect::new(area.x, area.y + 1, area.width, area.height.saturating_sub(2));
    let mut pen = Pen::new(buf, theme, frame);
    pen.clear(frame);
    let title = " help · up and down scroll, any other key leaves ";
    pen.text(frame.x + 2, frame.y, title, Role::Title);
    let shown = lines(model).into_iter().skip(usize::from(scroll));
    for (y, line) in (frame.y + 2..frame.bottom()).zip(shown) {
        pen.pieces(frame.x + 2, y, &line);
    }
}
