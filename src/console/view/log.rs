//! The log: what happened, when, how serious it is and why; newest at the bottom. Scrolled back it stands
//! still and says so; what is serious brings the newest back by itself.

use super::pen::{Pen, width};
use super::words;
use crate::console::action::Action;
use crate::console::model::{LogView, Model};
use crate::console::theme::{Role, Theme};
use crate::mapping::event::{Event, Severity};
use crate::session::{RunState, Snapshot};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

/// Where the text of an entry begins, columns from the left.
const TEXT: u16 = 11;

/// The events that the log lists, and the number of each in the run.
fn listed<'a>(model: &Model, snapshot: &'a Snapshot) -> Vec<(u64, &'a Event)> {
    let shown = |event: &&Event| model.log_detail || event.kind.severity() > Severity::Detail;
    let numbered = (snapshot.forgotten..).zip(&snapshot.events);
    numbered.filter(|(_, event)| shown(event)).collect()
}

/// The lines of an entry in a log so wide.
fn lines(event: &Event, cols: u16) -> Vec<String> {
    words::wrap(&event.kind.to_string(), cols.saturating_sub(TEXT + 2))
}

/// How many of `events` are older than what is shown last; all of them where the newest is.
fn end(model: &Model, snapshot: &Snapshot, events: &[(u64, &Event)]) -> usize {
    let alarmed = |view: &LogView| {
        let seen = usize::try_from(view.known.saturating_sub(snapshot.forgotten));
        let since = snapshot.events.iter().skip(seen.unwrap_or(usize::MAX));
        since.map(|event| event.kind.severity()).any(|severity| severity >= Severity::Warning)
    };
    match model.log.filter(|view| !alarmed(view)) {
        Some(view) => events.partition_point(|(number, _)| *number < view.end),
        None => events.len(),
    }
}

/// Where the log looks when it is scrolled by so many entries, back for negative ones; none at what
/// happened last. It is not scrolled further than to a whole page of the oldest.
#[must_use]
pub fn scrolled(model: &Model, snapshot: &Snapshot, page: Rect, by: isize) -> Option<LogView> {
    let events = listed(model, snapshot);
    let mut taken = 0;
    let fills = |(_, event): &(u64, &Event)| {
        taken += lines(event, page.width).len();
        taken >= usize::from(page.height)
    };
    let first = events.iter().position(fills).map_or(events.len(), |k| k + 1);
    let end = end(model, snapshot, &events).saturating_add_signed(by).max(first);
    let (next, _) = events.get(end)?;
    let known = snapshot.forgotten + snapshot.events.len() as u64;
    Some(LogView { end: *next, known })
}

/// What the rule above the log says: how much is not shown.
pub(super) fn title(model: &Model, snapshot: &Snapshot) -> String {
    let events = listed(model, snapshot);
    match events.len() - end(model, snapshot, &events) {
        0 => " log ".to_owned(),
        newer => format!(" log · scrolled back, {newer} newer "),
    }
}

pub(super) fn draw(
    model: &Model,
    snapshot: &Snapshot,
    theme: &Theme,
    area: Rect,
    buf: &mut Buffer,
) {
    let mut pen = Pen::new(buf, theme, area);
    let events = listed(model, snapshot);
    if events.is_empty() {
        let begins = how_it_begins(model, snapshot);
        for (y, line) in (area.y..).zip(words::wrap(&begins, area.width.saturating_sub(2))) {
            pen.text(area.x + 1, y, &line, Role::Muted);
        }
        return;
    }
    let mut bottom = area.bottom();
    for (_, event) in events[..end(model, snapshot, &events)].iter().rev() {
        let mut lines = lines(event, area.width);
        let room = usize::from(bottom - area.top());
        if room == 0 {
            return;
        }
        if lines.len() > room {
            // Time, mark and beginning stay: the rest without them would say nothing.
            lines.truncate(room);
            if let Some(last) = lines.last_mut() {
                *last = continued(last.clone(), area.width - TEXT);
            }
        }
        bottom -= lines.len() as u16;
        draw_entry(&mut pen, event, &lines, area.x, bottom);
    }
}

/// What the log says before there is anything to say: that nothing goes on before somebody says so.
fn how_it_begins(model: &Model, snapshot: &Snapshot) -> String {
    let way = |action| model.keymap.way(action);
    let (run, phase) = (way(Action::RunPause), way(Action::StepPhase));
    match snapshot.run {
        _ if model.is_alone(snapshot) => "the robot has not answered yet".to_owned(),
        _ if snapshot.record_end.is_some() => "nothing happened before the record ends".to_owned(),
        RunState::Paused if snapshot.recorded => {
            format!("nothing has happened yet: {run} plays, {phase} goes to the next phase")
        }
        RunState::Paused => {
            let command = way(Action::StepCommand);
            format!(
                "{run} begins; {phase} goes on to the end of the phase, {command} by one command"
            )
        }
        _ => "nothing has happened yet".to_owned(),
    }
}

/// A line that goes on where nobody sees it.
fn continued(mut line: String, room: u16) -> String {
    while width(&line) + 2 > room && line.pop().is_some() {}
    line + " …"
}

fn draw_entry(pen: &mut Pen<'_>, event: &Event, lines: &[String], x: u16, y: u16) {
    let (mark, role, text_role) = match event.kind.severity() {
        Severity::Detail => ("·", Role::Muted, Role::Muted),
        Severity::Notice => ("•", Role::Notice, Role::Text),
        Severity::Warning => ("▲", Role::Warning, Role::Warning),
        Severity::Fault => ("✗", Role::Fault, Role::Fault),
    };
    pen.text(x + 1, y, &words::clock(event.time_us as f64 / 1e6), Role::Muted);
    pen.text(x + 9, y, mark, role);
    for (y, line) in (y..).zip(lines) {
        pen.text(x + TEXT, y, line, text_role);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::Keymap;
    use crate::console::frame::planes;
    use crate::console::update::perform;
    use crate::geometry::Pose;
    use crate::mapping::event::EventKind;
    use crate::mapping::settings::Settings;

    fn happens(snapshot: &mut Snapshot, kind: EventKind) {
        let time_us = (snapshot.forgotten + snapshot.events.len() as u64) * 1_000_000;
        snapshot.events.push(Event { time_us, kind });
    }

    fn routine(snapshot: &mut Snapshot, times: usize) {
        for _ in 0..times {
            happens(snapshot, EventKind::Corner { angle: 1.0 });
        }
    }

    fn some() -> (Model, Snapshot) {
        let mut snapshot = Snapshot::waiting(Settings::new(Pose::new(0.0, 0.0, 0.0)), "nowhere");
        routine(&mut snapshot, 40);
        (Model::new(80, 24, Keymap::default()), snapshot)
    }

    /// Title and entries of the log on a screen of 80 by 24.
    fn seen(model: &Model, snapshot: &Snapshot) -> (String, Vec<String>) {
        let (symbols, _) = planes(model, snapshot);
        let rows: Vec<&str> = symbols.lines().collect();
        (rows[17].to_owned(), rows[18..23].iter().map(|row| (*row).to_owned()).collect())
    }

    #[test]
    fn scrolled_back_the_log_stands_still_and_says_so_until_an_alarm() {
        let (mut model, mut snapshot) = some();
        perform(&mut model, &snapshot, Action::LogUp);
        perform(&mut model, &snapshot, Action::LogUp);
        let (title, entries) = seen(&model, &snapshot);
        assert!(title.contains("scrolled back, 6 newer"), "{title}");
        assert!(entries[4].starts_with(" 0:00:33"), "{entries:?}");
        routine(&mut snapshot, 4);
        let (title, later) = seen(&model, &snapshot);
        assert!(title.contains("scrolled back, 10 newer"), "{title}");
        assert_eq!(later, entries, "it does not slide away under who reads it");
        // What is no longer kept changes nothing of that.
        snapshot.events.drain(..5);
        snapshot.forgotten += 5;
        assert_eq!(seen(&model, &snapshot), (title, later));
        happens(&mut snapshot, EventKind::Stopped);
        let (title, entries) = seen(&model, &snapshot);
        assert!(!title.contains("scrolled"), "{title}");
        assert!(entries[4].contains("stopped"), "{entries:?}");
        // Who has seen it may scroll back again.
        perform(&mut model, &snapshot, Action::LogUp);
        assert!(seen(&model, &snapshot).0.contains("scrolled back, 3 newer"));
        perform(&mut model, &snapshot, Action::LogDown);
        assert_eq!(model.log, None, "back at the newest");
    }

    #[test]
    fn the_log_is_not_scrolled_beyond_its_beginning() {
        let (mut model, snapshot) = some();
        for _ in 0..400 {
            perform(&mut model, &snapshot, Action::LogUp);
        }
        let (title, entries) = seen(&model, &snapshot);
        assert!(title.contains("35 newer"), "{title}");
        assert!(entries[0].starts_with(" 0:00:00") && entries[4].starts_with(" 0:00:04"));
        perform(&mut model, &snapshot, Action::LogDown);
        assert!(seen(&model, &snapshot).1[4].starts_with(" 0:00:07"), "one key, one step");
    }

    #[test]
    fn no_entry_shows_without_its_beginning() {
        let (model, mut snapshot) = some();
        let what = "one word after the other, ".repeat(8);
        happens(&mut snapshot, EventKind::Alarm { what });
        routine(&mut snapshot, 3);
        let (_, entries) = seen(&model, &snapshot);
        assert!(entries[0].starts_with(" 0:00:40 ▲ one word"), "{entries:?}");
        assert!(entries[1].ends_with(" …"), "{entries:?}");
        assert!(entries[2].starts_with(" 0:00:41"), "{entries:?}");
    }

    /// It opens paused: whoever waits for it to begin is told how.
    #[test]
    fn before_anything_has_happened_the_log_says_how_it_begins() {
        let (model, mut snapshot) = some();
        snapshot.events.clear();
        let (_, entries) = seen(&model, &snapshot);
        assert_eq!(entries[0], " r begins; p goes on to the end of the phase, n by one command");
        snapshot.run = RunState::Running;
        assert_eq!(seen(&model, &snapshot).1[0], " nothing has happened yet");
        (snapshot.run, snapshot.recorded) = (RunState::Paused, true);
        assert_eq!(
            seen(&model, &snapshot).1[0],
            " nothing has happened yet: r plays, p goes to the next phase"
        );
    }
}
