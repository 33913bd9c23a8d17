//! The log: what happened, when, how serious it is and why; newest at the bottom.

use super::pen::Pen;
use super::words;
use crate::console::model::Model;
use crate::console::theme::{Role, Theme};
use crate::mapping::event::{Event, Severity};
use crate::session::Snapshot;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

pub(super) fn draw(
    model: &Model,
    snapshot: &Snapshot,
    theme: &Theme,
    area: Rect,
    buf: &mut Buffer,
) {
    let shown = |event: &&Event| model.log_detail || event.kind.severity() > Severity::Detail;
    let mut pen = Pen::new(buf, theme, area);
    let mut events = snapshot.events.iter().rev().filter(shown).skip(model.log_back).peekable();
    if events.peek().is_none() {
        pen.text(area.x + 1, area.y, "nothing has happened yet", Role::Muted);
        return;
    }
    let mut bottom = area.bottom();
    for event in events {
        let lines = words::wrap(&event.kind.to_string(), area.width.saturating_sub(13));
        for (index, line) in lines.iter().enumerate().rev() {
            if bottom == area.top() {
                return;
            }
            bottom -= 1;
            draw_line(&mut pen, event, line, index == 0, area.x, bottom);
        }
    }
}

fn draw_line(pen: &mut Pen<'_>, event: &Event, line: &str, first: bool, x: u16, y: u16) {
    let (mark, role, text_role) = match event.kind.severity() {
        Severity::Detail => ("·", Role::Muted, Role::Muted),
        Severity::Notice => ("•", Role::Notice, Role::Text),
        Severity::Warning => ("▲", Role::Warning, Role::Warning),
        Severity::Fault => ("✗", Role::Fault, Role::Fault),
    };
    if first {
        pen.text(x + 1, y, &words::clock(event.time_us as f64 / 1e6), Role::Muted);
        pen.text(x + 9, y, mark, role);
    }
    pen.text(x + 11, y, line, text_role);
}
