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
        RunState::Paused => ("‖ PAUSED", Role::Paused),
        RunState::Running => ("▶ RUNNING", Role::Running),
        RunState::Stepping(Step::Command) => ("▷ ONE COMMAND", Role::Running),
        RunState::Stepping(Step::Event) => ("▷ TO EVENT", Role::Running),
        RunState::Stepping(Step::Phase) => ("▷ TO PHASE END", Role::Running),
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

/// `text` broken between words into lines of at most `room` columns; a longer word is left long
/// and clipped.
pub(super) fn wrap(text: &str, room: u16) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let Some(line) = lines.last_mut() else { break };
        if line.is_empty() {
            line.push_str(word);
        } else if width(line) + 1 + width(word) <= room {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

/// A command in a few words.
pub(super) fn command(command: &Command) -> String {
    let guarded = command.guard.rise.union(command.guard.fall);
    let guard = if guarded.is_empty() { "" } else { ", guarded" };
    match command.motion {
        Motion::Move { distance, .. } if distance < 0.0 => {
            format!("back {}{guard}", small(-distance))
        }
        Motion::Move { distance, .. } => format!("move {}{guard}", small(distance)),
        Motion::Turn { angle, .. } if angle < 0.0 => {
            format!("turn right {:.0}°{guard}", -angle.to_degrees())
        }
        Motion::Turn { angle, .. } => format!("turn left {:.0}°{guard}", angle.to_degrees()),
        Motion::Rest => "rest".to_owned(),
    }
}
