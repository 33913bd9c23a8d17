//! What must not be missed: a stop, a failure, the end, and the question before leaving. Lies
//! over the map.

use super::pen::{Pen, width};
use crate::console::action::Action;
use crate::console::model::{Model, Overlay};
use crate::console::theme::{Role, Theme};
use crate::mapping::event::Failure;
use crate::session::snapshot::{Known, RunState, Snapshot};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

pub(super) fn draw(model: &Model, snapshot: &Snapshot, theme: &Theme, map: Rect, buf: &mut Buffer) {
    let mut pen = Pen::new(buf, theme, map);
    let question = match model.overlay {
        Overlay::ConfirmQuit if matches!(snapshot.robot, Known::Stale { .. }) => Some([
            "The robot is not heard; it stops by itself.",
            "Quit?   y yes   any other key no",
        ]),
        Overlay::ConfirmQuit => {
            Some(["The robot is moving.", "Stop it and quit?   y yes   any other key no"])
        }
        Overlay::ConfirmFinish => Some([
            "The run ends here for good; what is mapped is kept.",
            "End it?   y yes   any other key no",
        ]),
        Overlay::None | Overlay::Help(_) | Overlay::Line(_) => None,
    };
    if let Some(lines) = question {
        draw_box(&mut pen, map, map.y + map.height / 3, &lines, Role::Paused);
        return;
    }
    match snapshot.run {
        RunState::Stopped => {
            let clear = model.keymap.label(Action::ClearStop);
            let how = format!("{clear} clears the stop; phase and map are kept");
            draw_box(&mut pen, map, map.y, &["■ ■ ■   S T O P P E D   ■ ■ ■", &how], Role::Stopped);
        }
        RunState::Failed(Failure::Ended) => {
            let lines = ["■  ended by the operator", "what was mapped is kept"];
            draw_box(&mut pen, map, map.y, &lines, Role::Paused);
        }
        RunState::Failed(why) => {
            let why = why.to_string();
            draw_box(&mut pen, map, map.y, &["✗  the run has ended", &why], Role::Failed);
        }
        _ if matches!(snapshot.robot, Known::Unknown) => {
            let row = map.y + map.height / 2;
            let text = "waiting for the robot's first report";
            let x = map.x + map.width.saturating_sub(width(text)) / 2;
            pen.text(x, row, text, Role::Unknown);
        }
        _ => {}
    }
}

/// A filled band across the map with centred lines and a row of air above and below.
fn draw_box(pen: &mut Pen<'_>, map: Rect, top: u16, lines: &[&str], role: Role) {
    let height = lines.len() as u16 + 2;
    pen.fill(Rect::new(map.x, top, map.width, height), role);
    for (row, line) in (1..).zip(lines) {
        let x = map.x + map.width.saturating_sub(width(line)) / 2;
        pen.text(x, top + row, line, role);
    }
}
