//! How values are written: the same words, units and digits everywhere on the screen.

use super::pen::width;
use crate::console::theme::Role;
use crate::mapping::event::Failure;
use crate::mapping::map::Phase;
use crate::robot::{Command, command::Motion};
use crate::session::snapshot::{RunState, Snapshot, Step};
pub(super) use crate::wording::{clock, count};

/// A small length: millimetres below 10 m, metres from there.
pub(super) fn small(metres: f64) -> String {
    if metres.abs() < 10.0 { format!("{:.0} mm", metres * 1e3) } else { format!("{metres:.1} m") }
}

/// Two digits after the point, and no minus before a zero.
pub(super) fn hundredths(value: f64) -> String {
    format!("{:.2}", (value * 100.0).round() / 100.0 + 0.0)
}

/// The run state with its symbol, and what it looks like.
pub(super) fn run_state(snapshot: &Snapshot) -> (String, Role) {
    let (text, role) = match snapshot.run {
        RunState::Paused if snapshot.record_end.is_some() => ("‖ RECORD ENDS", Role::Paused),
        RunState::Paused => ("‖ PAUSED", Role::Paused),
        RunState::Running => ("▶ RUNNING", Role::Running),
        RunState::Stepping(Step::Command) => ("▷ ONE COMMAND", Role::Running),
        RunState::Stepping(Step::Event) => ("▷ TO EVENT", Role::Running),
        RunState::Stepping(Step::Phase) => ("▷ TO PHASE END", Role::Running),
        // Told to, it has not yet said that it did.
        RunState::Stopped if snapshot.is_moving() => ("■ STOPPING", Role::Stopped),
        RunState::Stopped => ("■ STOPPED", Role::Stopped),
        // Over it is, but a map that does not keep its promise is none to be glad of.
        RunState::Complete if snapshot.map.shortfall().is_some() => {
            ("! NOT ALL SEEN", Role::Paused)
        }
        RunState::Complete if !snapshot.progress[Phase::Objects as usize].done => {
            ("✓ AS FAR AS ASKED", Role::Complete)
        }
        RunState::Complete => ("✓ COMPLETE", Role::Complete),
        RunState::Failed(Failure::Ended) => ("■ ENDED", Role::Paused),
        RunState::Failed(_) => ("✗ FAILED", Role::Failed),
    };
    (format!(" {text} "), role)
}

/// `text` broken between words into lines of at most `room` columns; a longer word is left long.
pub(super) fn wrap(text: &str, room: u16) -> Vec<String> {
    let words: Vec<String> = text.split(' ').map(str::to_owned).collect();
    joined(&words, room)
}

/// `parts` one after the other on lines of at most `room` columns. None is broken; one that is wider
/// has a line to itself.
pub(super) fn joined(parts: &[String], room: u16) -> Vec<String> {
    let mut lines = vec![String::new()];
    for part in parts {
        let Some(line) = lines.last_mut() else { break };
        if line.is_empty() {
            line.push_str(part);
        } else if width(line) + 1 + width(part) <= room {
            line.push(' ');
            line.push_str(part);
        } else {
            lines.push(part.clone());
        }
    }
    lines
}

/// The first of `forms`, the longest first, that has room.
pub(super) fn shortened(forms: Vec<String>, room: u16) -> Option<String> {
    forms.into_iter().find(|form| width(form) <= room)
}

/// A command in a few words, in parts that belong together.
pub(super) fn command(command: &Command) -> Vec<String> {
    let what = match command.motion {
        Motion::Move { distance, .. } if distance < 0.0 => format!("back {}", small(-distance)),
        Motion::Move { distance, .. } => format!("move {}", small(distance)),
        Motion::Turn { angle, .. } if angle < 0.0 => {
            format!("turn right {:.0}°", -angle.to_degrees())
        }
        Motion::Turn { angle, .. } => format!("turn left {:.0}°", angle.to_degrees()),
        Motion::Rest => "rest".to_owned(),
    };
    if command.guard.rise.union(command.guard.fall).is_empty() {
        vec![what]
    } else {
        vec![format!("{what},"), "guarded".to_owned()]
    }
}
