//! A screen too small to work in: the run state, what stop and quit ask, and why nothing else is there.

use super::pen::Pen;
use super::{banner, words};
use crate::console::layout::{MIN_COLS, MIN_ROWS};
use crate::console::model::{Model, Overlay};
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
    let (label, role) = words::run_state(snapshot);
    pen.text(area.x, area.y, &label, role);
    let mut lines: Vec<(String, Role)> = Vec::new();
    let mut say = |text: &str, role: Role| {
        lines.extend(words::wrap(text, area.width).into_iter().map(|line| (line, role)));
    };
    // The question comes first: its answer moves the robot or ends the run.
    if model.overlay == Overlay::ConfirmQuit {
        banner::question(model, snapshot).iter().flatten().for_each(|line| say(line, Role::Paused));
    }
    let size = format!("terminal {}x{} is too small:", area.width, area.height);
    say(&size, Role::Warning);
    say(&format!("needs {MIN_COLS}x{MIN_ROWS}"), Role::Warning);
    say("(only stop and quit work)", Role::Warning);
    for (y, (line, role)) in (area.y + 1..area.bottom()).zip(&lines) {
        pen.text(area.x, y, line, *role);
    }
}

#[cfg(test)]
mod tests {
    use crate::console::Keymap;
    use crate::console::frame::planes;
    use crate::console::key::Key;
    use crate::console::model::{Model, Overlay};
    use crate::console::update::{Effect, press};
    use crate::geometry::Pose;
    use crate::mapping::settings::Settings;
    use crate::robot::Intent;
    use crate::session::{RunState, Snapshot};

    #[test]
    fn nothing_is_asked_unseen_and_nothing_is_done_but_stop_and_quit() {
        let mut snapshot = Snapshot::waiting(Settings::new(Pose::new(0.0, 0.0, 0.0)), "nowhere");
        snapshot.run = RunState::Running;
        let mut model = Model::new(40, 12, Keymap::default());
        let key = |model: &mut Model, name: &str| {
            press(model, &snapshot, Key::parse(name).expect("a key"))
        };
        for name in ["X", ":", "?", "r", "p", "]", "y"] {
            assert!(key(&mut model, name).is_empty(), "{name} did something");
            assert_eq!(model.overlay, Overlay::None, "{name} opened something");
        }
        // What was open before the screen became small is not answered by chance.
        model.overlay = Overlay::ConfirmFinish;
        assert!(key(&mut model, "y").is_empty(), "the run was ended unseen");
        assert!(key(&mut model, "q").is_empty());
        let shown = planes(&model, &snapshot).0;
        assert!(shown.contains("Stop it and quit?") && shown.contains("y yes"), "{shown}");
        assert_eq!(key(&mut model, "y"), [Effect::Intent(Intent::Stop), Effect::Quit]);
        assert_eq!(key(&mut model, "space"), [Effect::Intent(Intent::Stop)]);
    }
}
