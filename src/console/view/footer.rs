//! The bottom row: the command line while one is typed, else a remark, else the keys that matter
//! now. Keys and words come from the action table.

use super::pen::{Pen, width};
use super::words;
use crate::console::action::{ACTIONS, Action, ActionInfo, Group};
use crate::console::command::Command;
use crate::console::model::{Hint, Model, Overlay};
use crate::console::prompt::Prompt;
use crate::console::sanitize::clean;
use crate::console::theme::{Role, Theme};
use crate::session::snapshot::{RunState, Snapshot};
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
    if let Overlay::Line(prompt) = &model.overlay {
        draw_prompt(&mut pen, model, snapshot, prompt, area);
        return;
    }
    let Some(hint) = model.remark(snapshot) else {
        draw_keys(&mut pen, model, snapshot, area.x + 1, area);
        return;
    };
    let role = if hint.refusal { Role::Warning } else { Role::Hint };
    let mark = if hint.refusal { "▲ " } else { "› " };
    pen.clear(area);
    pen.text(area.x + 1, area.y, mark, role);
    let mut x = area.x + REMARK;
    for (y, line) in (area.y..area.bottom()).zip(&lines(hint, area)) {
        x = pen.text(area.x + REMARK, y, line, role);
    }
    let last = Rect { y: area.bottom() - 1, height: 1, ..area };
    draw_keys(&mut pen, model, snapshot, x + 3, last);
}

/// Where the text of a remark begins, columns from the left.
const REMARK: u16 = 3;

fn lines(hint: &Hint, area: Rect) -> Vec<String> {
    words::wrap(&hint.text, area.width.saturating_sub(REMARK + 1))
}

/// How many rows more than its own the footer needs for the remark.
pub(super) fn extra_rows(model: &Model, snapshot: &Snapshot, area: Rect) -> u16 {
    let remark = model.remark(snapshot).filter(|_| !matches!(model.overlay, Overlay::Line(_)));
    remark.map_or(0, |hint| lines(hint, area).len() as u16 - 1)
}

fn draw_prompt(pen: &mut Pen<'_>, model: &Model, snapshot: &Snapshot, prompt: &Prompt, area: Rect) {
    let x = pen.text(area.x + 1, area.y, ":", Role::Key);
    let (before, under, after) = prompt.around_cursor();
    // The cursor stays in view, and as much of what is before it as there is room for.
    let (before, left) = fitting(before.chars().rev(), area.width / 2);
    let before: String = before.into_iter().rev().collect();
    let after: String = fitting(after.chars(), left).0.into_iter().collect();
    let x = pen.text(x, area.y, &before, Role::Value);
    let x = if under.is_empty() {
        pen.text(x, area.y, "▏", Role::Key)
    } else {
        let x = pen.text(x, area.y, &under, Role::Cursor);
        pen.text(x, area.y, &after, Role::Value)
    };
    let help = if snapshot.may_move() && model.keymap.label(Action::Stop) == "space" {
        "space stops the robot; write alpha=0.3".to_owned()
    } else {
        let steered = model.steered(snapshot);
        Command::candidates(prompt.text(), steered).take(6).collect::<Vec<_>>().join("  ")
    };
    pen.text(x + 2, area.y, &help, Role::Muted);
}

/// As many of `letters` as `room` has columns for, some are two wide, and the columns that are left.
fn fitting(letters: impl Iterator<Item = char>, room: u16) -> (Vec<char>, u16) {
    let mut left = room;
    let fits = |letter: &char| {
        let wide = width(&clean(letter.encode_utf8(&mut [0; 4])));
        wide <= left && {
            left -= wide;
            true
        }
    };
    let fitting = letters.take_while(fits).collect();
    (fitting, left)
}

fn draw_keys(pen: &mut Pen<'_>, model: &Model, snapshot: &Snapshot, mut x: u16, area: Rect) {
    let mut entries = entries(model, snapshot);
    let quit = entries.pop_if(|(_, word)| *word == "quit");
    let help = entries.pop_if(|(_, word)| *word == "help");
    let ends: Vec<_> = [help, quit].into_iter().flatten().collect();
    let ends_width: u16 = ends.iter().map(entry_width).sum();
    // Help and quit keep their place at the right; of the rest, as many as fit.
    let right = area.right().saturating_sub(ends_width);
    for entry in &entries {
        if x + entry_width(entry) > right {
            break;
        }
        x = draw_entry(pen, entry, x, area.y);
    }
    if x <= right {
        ends.iter().fold(right, |x, entry| draw_entry(pen, entry, x, area.y));
    }
}

type Entry = (String, &'static str);

fn entry_width((keys, word): &Entry) -> u16 {
    width(keys) + width(word) + 3
}

fn draw_entry(pen: &mut Pen<'_>, (keys, word): &Entry, x: u16, y: u16) -> u16 {
    let x = pen.text(x, y, keys, Role::Key);
    pen.text(x + 1, y, word, Role::Text) + 2
}

/// Keys and words in the order of the table; neighbours with the same word become one.
fn entries(model: &Model, snapshot: &Snapshot) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    let mut infos: Vec<_> = ACTIONS.iter().filter(|info| matters(info, model, snapshot)).collect();
    // Over a page every key but these only leaves it.
    let over_page = matches!(model.overlay, Overlay::Help(_) | Overlay::List(_));
    infos.retain(|info| !over_page || info.action == Action::Stop);
    if snapshot.recorded {
        // To go to an instant is what a replay is for.
        infos.sort_by_key(|info| match info.action {
            Action::CommandLine => 1,
            _ if info.group == Group::Robot => 0,
            _ => 2,
        });
    }
    if snapshot.map.plan.is_some() {
        // Where one of the two has room only, the plan is what the operator looks at.
        infos.sort_by_key(|info| match info.action {
            _ if info.group == Group::Robot => 0,
            Action::AlphaDown | Action::AlphaUp => 1,
            Action::LapAgain | Action::LapAnew => 2,
            _ => 3,
        });
    }
    for info in infos {
        let key = model.keymap.label(info.action);
        let word = word(info, model, snapshot);
        match entries.last_mut() {
            _ if key.is_empty() => {}
            Some((keys, last)) if *last == word => {
                keys.push(' ');
                keys.push_str(&key);
            }
            _ => entries.push((key, word)),
        }
    }
    if over_page {
        entries.extend([("↑ ↓".to_owned(), "scroll"), ("esc".to_owned(), "leave")]);
    }
    entries
}

/// What the footer calls it now: at the end a command line is of use for one thing above all.
fn word(info: &ActionInfo, model: &Model, snapshot: &Snapshot) -> &'static str {
    match info.action {
        Action::CommandLine if snapshot.recorded => "at=SECONDS",
        // What a real robot's run leaves is written on leaving.
        Action::CommandLine if snapshot.run.is_over() && model.speed.is_some() => "export=DIR",
        Action::RunPause if snapshot.recorded => "play/pause",
        _ => info.footer,
    }
}

fn matters(info: &ActionInfo, model: &Model, snapshot: &Snapshot) -> bool {
    let stopped = snapshot.latched;
    let over = snapshot.run.is_over();
    let useless = !model.steered(snapshot).offers(info.action)
        || model.is_alone(snapshot) && info.action.is_told_to_the_run();
    !(info.footer.is_empty() || useless)
        && match info.action {
            Action::Stop => !stopped && !over && !snapshot.recorded,
            Action::ClearStop => stopped,
            Action::RunPause | Action::StepCommand | Action::StepEvent | Action::StepPhase => {
                let goes_on = !stopped && !over || snapshot.recorded;
                goes_on && snapshot.record_end.is_none()
            }
            // A lap has closed, and nothing was made of it yet that driving would spoil.
            Action::LapAgain | Action::LapAnew => {
                snapshot.run == RunState::Paused && snapshot.laps_are_open
            }
            Action::AlphaDown | Action::AlphaUp => snapshot.alpha_is_open,
            Action::SlowDown | Action::SpeedUp => !over && model.speed.is_some(),
            Action::List => snapshot.map.shape.is_some(),
            // What the map at the end leaves out.
            Action::ToggleTrajectory => snapshot.is_handed_over(),
            Action::TogglePlan => snapshot.is_handed_over() && snapshot.map.plan.is_some(),
            Action::Square => over && snapshot.map.shape.is_some(),
            _ => true,
        }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::Keymap;
    use crate::console::frame::planes;
    use crate::geometry::Pose;
    use crate::mapping::settings::Settings;

    fn some(cols: u16, rows: u16) -> (Model, Snapshot) {
        let snapshot = Snapshot::waiting(Settings::new(Pose::new(0.0, 0.0, 0.0)), "nowhere");
        (Model::new(cols, rows, Keymap::default()), snapshot)
    }

    /// Over a page a key of the map would only leave it.
    #[test]
    fn over_a_page_no_key_is_offered_that_only_leaves_it() {
        let (mut model, snapshot) = some(120, 40);
        let footer = |model: &Model| {
            let (symbols, _) = planes(model, &snapshot);
            symbols.lines().last().map(|line| line.trim().to_owned()).unwrap_or_default()
        };
        assert!(footer(&model).contains("q quit"), "{}", footer(&model));
        for page in [Overlay::Help(0), Overlay::List(0)] {
            model.overlay = page;
            assert_eq!(footer(&model), "space stop  ↑ ↓ scroll  esc leave");
        }
    }

    /// A folder may be named in letters that are two columns wide each.
    #[test]
    fn the_cursor_stays_in_view_however_wide_the_letters_are() {
        let (mut model, snapshot) = some(80, 24);
        for letter in ['x', '室', '\u{200b}'] {
            for count in 0..120 {
                let line = format!("export={}", letter.to_string().repeat(count));
                model.overlay = Overlay::Line(line.as_str().into());
                let (symbols, _) = planes(&model, &snapshot);
                let prompt = symbols.lines().last().expect("the footer");
                assert!(prompt.contains('▏'), "{count} times {letter:?}: {prompt}");
            }
        }
    }
}
