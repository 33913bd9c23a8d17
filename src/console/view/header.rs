//! The top row: what is driven, the run state, the speed and the time.

use super::pen::{Pen, width};
use super::words;
use crate::console::model::Model;
use crate::console::theme::{Role, Theme};
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
    let mut pen = Pen::new(buf, theme, area);
    let (state, role) = words::run_state(snapshot);
    let speed = model.speed.map_or_else(|| "live".to_owned(), |speed| speed.to_string());
    let time = words::clock(snapshot.time);
    let right = pen.text_right(area.right() - 1, area.y, &time, Role::Value);
    let right = pen.text_right(right - 2, area.y, &speed, Role::Muted);
    let right = pen.text_right(right - 2, area.y, &state, role);
    let x = pen.text(area.x + 1, area.y, "PERIPLUS", Role::Title);
    let room = right.saturating_sub(x + 3);
    if width(&snapshot.source) <= room {
        pen.text(x + 2, area.y, &snapshot.source, Role::Text);
    } else {
        let short: String =
            snapshot.source.chars().take(usize::from(room.saturating_sub(1))).collect();
        let mut pen = Pen::new(buf, theme, Rect { width: right.saturating_sub(1), ..area });
        pen.text(x + 2, area.y, &format!("{short}…"), Role::Text);
    }
}
