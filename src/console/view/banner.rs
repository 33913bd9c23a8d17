//! What must not be missed: a stop, a failure, the end, and the question before leaving. Lies over the
//! map, on the side away from the robot.

use super::pen::{Pen, width};
use super::words;
use crate::console::action::Action;
use crate::console::canvas::viewport::Viewport;
use crate::console::model::{Model, Overlay};
use crate::console::theme::{Role, Theme};
use crate::mapping::event::Failure;
use crate::session::snapshot::{Known, RunState, Snapshot};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

/// A map of fewer rows than this has none to spare for air around what is said.
const AIRY: u16 = 20;

pub(super) fn draw(
    model: &Model,
    snapshot: &Snapshot,
    shown: Viewport,
    theme: &Theme,
    map: Rect,
    buf: &mut Buffer,
) {
    let mut pen = Pen::new(buf, theme, map);
    let robot = super::map::placed(snapshot).and_then(|pose| shown.to_cell(pose.position));
    let below = robot.is_some_and(|(_, row)| row < map.height / 2);
    if let Some(lines) = question(model, snapshot) {
        draw_box(&mut pen, map, below, &lines, Role::Paused);
        return;
    }
    match snapshot.run {
        RunState::Stopped => {
            let clear = model.keymap.way(Action::ClearStop);
            let how = if snapshot.recorded {
                "the robot of the run was stopped here".to_owned()
            } else {
                format!("{clear} clears the stop; phase and map are kept")
            };
            // Told to, it has not yet said that it did.
            let what = if snapshot.is_moving() { "S T O P P I N G" } else { "S T O P P E D" };
            let lines = [format!("■ ■ ■   {what}   ■ ■ ■"), how];
            draw_box(&mut pen, map, below, &lines, Role::Stopped);
        }
        // Who ended it knows, and wants to see what there is of the map.
        RunState::Failed(Failure::Ended) => {}
        RunState::Failed(why) => {
            let lines = ["✗  the run has ended".to_owned(), why.to_string()];
            draw_box(&mut pen, map, below, &lines, Role::Failed);
        }
        _ if matches!(snapshot.robot, Known::Unknown) => {
            let row = map.y + map.height / 2;
            // A record that ends before it leaves nothing to wait for.
            let text = if snapshot.recorded {
                "no report of the robot in the record up to here"
            } else {
                "waiting for the robot's first report"
            };
            let x = map.x + map.width.saturating_sub(width(text)) / 2;
            pen.text(x, row, text, Role::Unknown);
        }
        _ => {}
    }
}

/// What is asked before something that cannot be taken back.
pub(super) fn question(model: &Model, snapshot: &Snapshot) -> Option<[String; 2]> {
    let lines = match model.overlay {
        Overlay::ConfirmQuit if matches!(snapshot.robot, Known::Stale { .. }) => {
            ["The robot is not heard; it stops by itself.", "Quit?   y yes   any other key no"]
        }
        Overlay::ConfirmQuit => {
            ["The robot is moving.", "Stop it and quit?   y yes   any other key no"]
        }
        Overlay::ConfirmFinish => [
            "The run ends here for good; what is mapped is kept.",
            "End it?   y yes   any other key no",
        ],
        Overlay::ConfirmAnew => {
            let laps = match snapshot.map.laps {
                0 | 1 => "The lap is dropped".to_owned(),
                laps => format!("All {laps} laps are dropped"),
            };
            return Some([
                format!("{laps}; the boundary is looked for anew."),
                "Drop?   y yes   any other key no".to_owned(),
            ]);
        }
        Overlay::None | Overlay::Help(_) | Overlay::List(_) | Overlay::Line(_) => return None,
    };
    Some(lines.map(str::to_owned))
}

/// A filled band across the map with centred lines, at its top or `below`.
fn draw_box(pen: &mut Pen<'_>, map: Rect, below: bool, lines: &[String], role: Role) {
    let room = map.width.saturating_sub(2);
    let lines: Vec<String> = lines.iter().flat_map(|line| words::wrap(line, room)).collect();
    let air = u16::from(map.height >= AIRY);
    let height = lines.len() as u16 + 2 * air;
    let top = if below { map.bottom().saturating_sub(height) } else { map.y };
    pen.fill(Rect::new(map.x, top, map.width, height), role);
    for (row, line) in (air..).zip(&lines) {
        let x = map.x + map.width.saturating_sub(width(line)) / 2;
        pen.text(x, top + row, line, role);
    }
}
