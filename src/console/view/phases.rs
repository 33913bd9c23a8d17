//! The strip of the four phases: which are done, which is under way and how far, what each cost.

use super::pen::Pen;
use super::words;
use crate::console::theme::{Role, Theme};
use crate::mapping::map::Phase;
use crate::session::snapshot::{PhaseProgress, RunState, Snapshot};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

const PHASES: [Phase; 4] = [Phase::Boundary, Phase::Shape, Phase::Plan, Phase::Objects];

pub(super) fn draw(snapshot: &Snapshot, theme: &Theme, area: Rect, buf: &mut Buffer) {
    for (index, phase) in (0u16..).zip(PHASES) {
        let left = area.x + area.width * index / 4;
        let right = area.x + area.width * (index + 1) / 4;
        let cell = Rect::new(left, area.y, right - left, area.height);
        let mut pen = Pen::new(buf, theme, cell);
        draw_phase(&mut pen, snapshot, phase, cell);
    }
}

fn draw_phase(pen: &mut Pen<'_>, snapshot: &Snapshot, phase: Phase, cell: Rect) {
    let progress = &snapshot.progress[phase as usize];
    let current = snapshot.phase == phase && !progress.done && snapshot.run != RunState::Complete;
    let failed = current && matches!(snapshot.run, RunState::Failed(_));
    let (mark, role) = match (progress.done, failed, current) {
        (true, ..) => ("✓", Role::Good),
        (_, true, _) => ("✗", Role::Fault),
        (_, _, true) => ("▸", Role::Title),
        _ => ("·", Role::Muted),
    };
    let x = pen.text(cell.x + 1, cell.y, mark, role);
    let name = phase.to_string();
    let x = pen.text(x + 1, cell.y, &name, if progress.done { Role::Text } else { role });
    if cell.height > 1 {
        let right = cell.right() - 2;
        // Where there is no room for all, the name is what tells them apart.
        let room = usize::from(right.saturating_sub(x + 1));
        if let Some(cost) = costs(progress).into_iter().find(|it| it.chars().count() <= room) {
            pen.text_right(right, cell.y, &cost, Role::Muted);
        }
        draw_bar(pen, cell.x + 1, cell.y + 1, cell.width - 3, progress, current);
    } else if current {
        let room = cell.right().saturating_sub(x + 2);
        draw_bar(pen, x + 1, cell.y, room, progress, current);
    } else if progress.done {
        // Where there is no room for both, the name is what tells them apart.
        let room = usize::from(cell.right().saturating_sub(x + 2));
        if let Some(time) = costs(progress).pop().filter(|time| time.len() <= room) {
            pen.text_right(cell.right() - 1, cell.y, &time, Role::Muted);
        }
    }
}

/// What a phase has cost so far, at length and in short; nothing for one in which the robot did nothing.
fn costs(progress: &PhaseProgress) -> Vec<String> {
    let time = words::clock(progress.seconds);
    if progress.travel > 0.0 {
        vec![format!("{time}  {:.1} m", progress.travel), time]
    } else if progress.seconds >= 1.0 {
        vec![time]
    } else {
        Vec::new()
    }
}

/// A bar with the share in figures; without a share, a bar that claims nothing.
fn draw_bar(pen: &mut Pen<'_>, x: u16, y: u16, room: u16, progress: &PhaseProgress, current: bool) {
    let share =
        if progress.done { Some(1.0) } else { progress.share.filter(|share| share.is_finite()) };
    let figure = match share {
        Some(share) if current => format!("{:3.0} %", (share * 100.0).clamp(0.0, 100.0).floor()),
        _ if current => "  … ".to_owned(),
        _ => String::new(),
    };
    // Part of a figure would be another figure.
    let fits = |figure: &&str| figure.chars().count() < usize::from(room);
    let figure = [figure.as_str(), figure.trim()].into_iter().find(fits).unwrap_or_default();
    let figure_room = if current { 6 } else { 0 };
    let length = room.saturating_sub(figure_room);
    let halves = (share.unwrap_or(0.0).clamp(0.0, 1.0) * f64::from(length) * 2.0) as u16;
    for step in 0..length {
        let (symbol, role) = match halves.saturating_sub(step * 2) {
            0 => ("─", Role::BarRest),
            1 => ("╸", Role::BarDone),
            _ => ("━", Role::BarDone),
        };
        pen.text(x + step, y, symbol, role);
    }
    pen.text(x + length + 1, y, figure, Role::Value);
}

#[cfg(test)]
mod tests {
    use crate::console::Keymap;
    use crate::console::frame::planes;
    use crate::console::model::Model;
    use crate::geometry::Pose;
    use crate::mapping::settings::Settings;
    use crate::session::Snapshot;

    #[test]
    fn no_share_is_cut_however_narrow_the_screen_is() {
        let mut snapshot = Snapshot::waiting(Settings::new(Pose::new(0.0, 0.0, 0.0)), "nowhere");
        let mut told = 0;
        for phase in super::PHASES {
            for share in [0.04, 0.49, 1.0] {
                snapshot.phase = phase;
                snapshot.progress[phase as usize].share = Some(share);
                for columns in 60..=120 {
                    let model = Model::new(columns, 16, Keymap::default());
                    let symbols = planes(&model, &snapshot).0;
                    let strip = symbols.lines().nth(1).expect("the strip of the phases");
                    assert!(!strip.contains('…'), "{columns}: {strip}");
                    let figure = format!(" {:.0} %", share * 100.0);
                    let digits = strip.chars().any(|letter| letter.is_ascii_digit());
                    assert_eq!(digits, strip.contains(&figure), "{columns}: {strip}");
                    told += usize::from(digits);
                }
            }
        }
        assert!(told > 600, "the share was told {told} times only");
    }
}
