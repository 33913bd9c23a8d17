//! The help: every action that does anything here with its keys, from the one table; what the map shows, and the
//! words beside it.

use super::pen::{Pen, Piece};
use super::{map, words};
use crate::console::action::{ACTIONS, ActionInfo, Group};
use crate::console::canvas::Pattern;
use crate::console::command::{COMMANDS, Steered};
use crate::console::model::Model;
use crate::console::theme::{Role, Theme};
use crate::mapping::map::LineStatus;
use crate::session::Snapshot;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

/// A line of a page that lies over the screen.
pub(super) type Line = Vec<Piece>;

/// What the colours and patterns of the map mean: as it draws them.
fn legend() -> Vec<(Piece, &'static str)> {
    let line = |role: Role, pattern: Pattern| (role, pattern.sample(4));
    let of_plan = |status: LineStatus| {
        let (role, pattern) = map::look(status);
        line(role, pattern)
    };
    let sign = |role: Role, sign: &str| (role, sign.to_owned());
    vec![
        (line(Role::Wall, Pattern::Solid), "wall"),
        (
            line(Role::Untouched, map::UNTOUCHED),
            "not touched by anybody: a gap too narrow, or wall",
        ),
        (line(Role::Object, Pattern::Solid), "object that stands free, with its number"),
        (sign(Role::Contact, "⠐ ⠁⠄"), "contact: something was met there"),
        (line(Role::Cut, map::CUT), "cut between two parts of the floor"),
        (of_plan(LineStatus::Planned), "line of the plan, to be driven"),
        (of_plan(LineStatus::Driving), "line being driven"),
        (of_plan(LineStatus::Driven), "line driven from end to end"),
        (of_plan(LineStatus::Blocked), "line that something stands on, driven as far as could be"),
        (of_plan(LineStatus::Skipped), "line left out, shown with the rejected ones"),
        (of_plan(LineStatus::Rejected), "line rejected when the plan was made"),
        (line(Role::Trajectory, Pattern::Solid), "where the robot went"),
        (sign(Role::HiddenDisc, "○"), "the largest disc that may still hide somewhere"),
        (sign(Role::Robot, "○"), "the robot; a stroke to its edge shows where it heads"),
        (sign(Role::Start, "⠂"), "where the run began"),
    ]
}

/// Columns for the keys of an action.
const KEYS_WIDTH: usize = 11;

/// The words of the screen that are not plain.
const FIGURES: [(&str, &str); 23] = [
    ("× live", "how fast simulated time passes; live: a real robot, which has its own"),
    ("phase …", "how far a phase has come cannot be told"),
    ("pose", "x, y in metres and heading, anti-clockwise from east, as believed"),
    ("± 1 sd", "how well the robot's place is known: one standard deviation"),
    ("broken", "a switch that gave itself away as broken, and is not listened to any more"),
    ("command", "the motion in hand; guarded: it also ends where a switch opens or closes"),
    ("told", "a command sent to a robot that was not heard of since"),
    ("contact", "places where something was met, kept for the outline"),
    (
        "misclos",
        "by how much the lap missed where it began, before adjusting: way, heading, 1 in N",
    ),
    ("as well", "where else the lap would close as well, since its walls are alike: a tape tells"),
    ("laps", "how many times the boundary was gone round; their average is the map"),
    ("shape", "its class and area; a part is planned for itself, a vertex is a corner"),
    ("± walls", "standard error of a wall in the middle of all; corners: of the worst corner"),
    (
        "± whole",
        "of these errors, what the whole map has in common: turned, and moved as one piece",
    ),
    (
        "± among",
        "what is left among its walls, of one in the middle of all; the scale is in neither",
    ),
    ("squared", "walls made parallel to the axes; how far one was turned, and a corner moved"),
    ("lines", "of the plan, done of all; whole: from end to end, not: blocked or left out"),
    (
        "plan",
        "lean: the fewest of the paper's lines that keep the promise; paper: all; lanes: parallel; α in metres",
    ),
    ("promise", "hidden disc: the largest free-standing disc that the plan would miss"),
    ("driven", "hidden disc: the same for what was driven so far"),
    ("objects", "things that stand free; open: not seen all round"),
    ("narrow", "gaps too narrow for the robot, with floor behind them"),
    ("unknown", "stretches of the outline that nobody touched: narrow gaps, or wall"),
];

/// The lines of the help on a screen of so many columns.
fn lines(model: &Model, snapshot: &Snapshot) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    let cols = model.size.0;
    let steered = model.steered(snapshot);
    let replay = steered == Steered::Replay;
    let entry = |lines: &mut Vec<Line>, head: Line, at: u16, text: &str| {
        let mut head = head;
        for line in words::wrap(text, cols.saturating_sub(at + 3)) {
            head.push((Role::Text, line));
            lines.push(std::mem::replace(
                &mut head,
                vec![(Role::Text, " ".repeat(usize::from(at)))],
            ));
        }
    };
    for group in Group::ALL {
        let title = if replay && group == Group::Robot { "Playback" } else { group.title() };
        lines.push(vec![(Role::Title, title.to_owned())]);
        let here = |info: &&ActionInfo| info.group == group && steered.offers(info.action);
        for info in ACTIONS.iter().filter(here) {
            let keys = model.keymap.labels(info.action, KEYS_WIDTH);
            let head = vec![
                (Role::Key, format!("  {keys:<KEYS_WIDTH$} ")),
                (Role::Value, format!("{:<14}", info.name)),
            ];
            let help = if replay && !info.replay.is_empty() { info.replay } else { info.help };
            entry(&mut lines, head, 28, help);
        }
        lines.push(Vec::new());
    }
    let idle = ACTIONS.iter().filter(|info| !steered.offers(info.action));
    let idle: Vec<String> = idle.map(|info| model.keymap.label(info.action)).collect();
    if !idle.is_empty() {
        let text = format!("{} do nothing here: {}", idle.join(" "), steered.refusal());
        entry(&mut lines, vec![(Role::Text, "  ".to_owned())], 2, &text);
        lines.push(Vec::new());
    }
    lines.push(vec![(Role::Title, "Command line".to_owned())]);
    for (name, argument, help) in COMMANDS.iter().filter(|(name, ..)| steered.takes(name)) {
        let head = vec![(Role::Key, format!("  {:<20}", format!("{name}={argument}")))];
        entry(&mut lines, head, 22, help);
    }
    lines.push(Vec::new());
    lines.push(vec![(Role::Title, "On the map".to_owned())]);
    for ((role, sign), meaning) in legend() {
        let head = vec![(role, format!("  {sign:<6}"))];
        entry(&mut lines, head, 8, meaning);
    }
    lines.push(Vec::new());
    lines.push(vec![(Role::Title, "Its words".to_owned())]);
    for (label, meaning) in FIGURES {
        let head = vec![(Role::Muted, format!("  {label:<10}"))];
        entry(&mut lines, head, 12, meaning);
    }
    lines
}

/// How far the help can be scrolled.
#[must_use]
pub fn last_scroll(model: &Model, snapshot: &Snapshot) -> u16 {
    last_scroll_of(lines(model, snapshot).len(), model.size.1)
}

/// How far a page of so many lines can be scrolled on a screen of so many rows.
pub(super) fn last_scroll_of(lines: usize, rows: u16) -> u16 {
    let room = usize::from(rows.saturating_sub(5));
    u16::try_from(lines.saturating_sub(room)).unwrap_or(u16::MAX)
}

pub(super) fn draw(
    model: &Model,
    snapshot: &Snapshot,
    scroll: u16,
    theme: &Theme,
    area: Rect,
    buf: &mut Buffer,
) {
    draw_page("help", &lines(model, snapshot), scroll, theme, area, buf);
}

/// Draws `lines` over the whole screen, from the one so far down on.
pub(super) fn draw_page(
    name: &str,
    lines: &[Line],
    scroll: u16,
    theme: &Theme,
    area: Rect,
    buf: &mut Buffer,
) {
    // It was scrolled on a screen that may have been smaller, of a page that may have been longer.
    let last = last_scroll_of(lines.len(), area.height);
    let scroll = scroll.min(last);
    let frame = Rect::new(area.x, area.y + 1, area.width, area.height.saturating_sub(2));
    let mut pen = Pen::new(buf, theme, frame);
    pen.clear(frame);
    let title = format!(" {name} · arrows and pages scroll, any other key leaves ");
    pen.text(frame.x + 2, frame.y, &title, Role::Title);
    let shown = lines.iter().skip(usize::from(scroll));
    for (y, line) in (frame.y + 2..frame.bottom() - 1).zip(shown) {
        pen.pieces(frame.x + 2, y, line);
    }
    if scroll < last {
        pen.text_right(frame.right() - 2, frame.bottom() - 1, " more below ", Role::Title);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nothing is told by colour alone.
    #[test]
    fn without_colour_no_two_things_on_the_map_look_alike() {
        let mono = Theme::mono();
        let looks: Vec<_> = legend()
            .into_iter()
            .map(|((role, sign), meaning)| (sign, mono.style(role).add_modifier, meaning))
            .collect();
        for (k, one) in looks.iter().enumerate() {
            for other in &looks[k + 1..] {
                assert!((&one.0, one.1) != (&other.0, other.1), "{one:?} and {other:?}");
            }
        }
    }

    #[test]
    fn every_key_of_an_action_is_told_where_it_fits() {
        let keymap = Keymap::default();
        assert_eq!(keymap.labels(Action::PanLeft, KEYS_WIDTH), "← h");
        assert_eq!(keymap.labels(Action::Quit, KEYS_WIDTH), "q ctrl-c");
        assert_eq!(keymap.labels(Action::Quit, 4), "q");
        assert_eq!(keymap.labels(Action::Stop, KEYS_WIDTH), "space");
    }
    use crate::console::Keymap;
    use crate::console::action::Action;
    use crate::console::frame::planes;
    use crate::console::key::Key;
    use crate::console::model::Overlay;
    use crate::console::update::press;
    use crate::geometry::Pose;
    use crate::mapping::settings::Settings;

    /// Its lines are fewer on a wide screen, and more of them are in view on a high one.
    #[test]
    fn scrolled_to_its_end_on_a_small_screen_it_is_not_empty_on_a_large_one() {
        let snapshot = Snapshot::waiting(Settings::new(Pose::new(0.0, 0.0, 0.0)), "nowhere");
        let mut model = Model::new(60, 16, Keymap::default());
        let key = |model: &mut Model, name: &str| {
            let key = Key::parse(name).expect("a key");
            assert!(press(model, &snapshot, key).is_empty(), "{name} did something");
        };
        key(&mut model, "?");
        for _ in 0..100 {
            key(&mut model, "pagedown");
        }
        model.size = (160, 40);
        let seen = |model: &Model| planes(model, &snapshot).0;
        let end = seen(&model);
        let filled = end.lines().filter(|line| !line.trim().is_empty()).count();
        assert!(filled > 30, "a page of {filled} lines:\n{end}");
        assert!(end.contains("stretches of the outline") && !end.contains("more below"), "{end}");
        key(&mut model, "up");
        assert!(matches!(model.overlay, Overlay::Help(_)));
        assert_ne!(seen(&model), end, "the first key up scrolls");
    }
}
