//! The top row: what is driven, the run state, the speed and the time.

use super::pen::{Pen, width};
use super::words;
use crate::console::model::Model;
use crate::console::theme::{Role, Theme};
use crate::session::Snapshot;
use crate::session::snapshot::Known;
use crate::wire::host::LOST;
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
    let (speed, speed_role) = speed(model, snapshot);
    let time = words::clock(snapshot.time);
    let right = pen.text_right(area.right() - 1, area.y, &time, Role::Value);
    let right = pen.text_right(right - 2, area.y, &speed, speed_role);
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

/// How fast time passes; where that is not ours, whether the robot is there.
fn speed(model: &Model, snapshot: &Snapshot) -> (String, Role) {
    match (&snapshot.robot, model.speed) {
        (Known::Stale { age, .. }, _) if *age > LOST => {
            (format!(" LINK LOST {} ", words::clock(*age)), Role::Failed)
        }
        (Known::Stale { .. }, _) => (" NOT HEARD ".to_owned(), Role::Paused),
        (_, Some(speed)) => (speed.to_string(), Role::Muted),
        (_, None) if snapshot.recorded => ("recorded".to_owned(), Role::Muted),
        (Known::Known(_), None) => ("live".to_owned(), Role::Muted),
        (Known::Unknown, None) => ("not heard yet".to_owned(), Role::Unknown),
    }
}
