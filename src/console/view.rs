//! The whole screen as a pure function of model and snapshot: shared references only, nothing is
//! remembered between frames. One file a region:
//!
//! ```text
//! header   PERIPLUS  L-shaped room · α 0.25 m              ▶ RUNNING  ×10  0:12:34
//! phases   ✓ boundary 18.0 m   ▸ shape ━━━╸─── 45 %   · plan   · objects
//!          ─ map · 5.0 × 4.0 m ─────────────────────────┬─ robot ────────────────
//! map      ⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀                               │ pose    x 1.234 y 0.567   panel
//!          ⡇           ⢸                                │ switch  ○ ○ ○
//!          ─ log ───────────────────────────────────────┴────────────────────────
//! log      0:12:31 • corner of -90°
//! footer   space stop  r run/pause  n command  e event  p phase  ? help  q quit
//! ```
//!
//! On wide screens the log stands below the panel. Banner, help, list and prompt lie over that.

mod banner;
mod footer;
mod header;
pub mod help;
pub mod list;
pub mod log;
pub mod map;
mod panel;
mod pen;
mod phases;
mod switches;
mod too_small;
mod words;

use super::layout::Regions;
use super::model::{Model, Overlay};
use super::theme::{Role, Theme};
use crate::session::Snapshot;
use pen::Pen;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

/// Draws everything. `area` is the whole screen, its upper left corner at the origin.
pub fn draw(model: &Model, snapshot: &Snapshot, theme: &Theme, area: Rect, buf: &mut Buffer) {
    let Some(regions) = Regions::of(area.width, area.height) else {
        return too_small::draw(model, snapshot, theme, area, buf);
    };
    header::draw(model, snapshot, theme, regions.header, buf);
    phases::draw(snapshot, theme, regions.phases, buf);
    draw_rules(model, &regions, snapshot, theme, buf);
    let shown = map::viewport(&model.camera, snapshot, regions.map);
    map::draw(model, snapshot, shown, theme, regions.map, buf);
    map::draw_title(model, snapshot, shown, theme, &regions, buf);
    panel::draw(snapshot, theme, regions.panel, buf);
    // A long remark takes its room from the log, where the oldest lines give way.
    let taken = footer::extra_rows(model, snapshot, regions.footer).min(regions.log.height - 1);
    let log = Rect { height: regions.log.height - taken, ..regions.log };
    log::draw(model, snapshot, theme, log, buf);
    banner::draw(model, snapshot, shown, theme, regions.map, buf);
    let top = regions.footer.y - taken;
    let footer = Rect { y: top, height: taken + regions.footer.height, ..regions.footer };
    footer::draw(model, snapshot, theme, footer, buf);
    match model.overlay {
        Overlay::Help(scroll) => help::draw(model, snapshot, scroll, theme, area, buf),
        Overlay::List(scroll) => list::draw(model, snapshot, scroll, theme, area, buf),
        _ => {}
    }
}

/// The frame between the regions. It is doubled while the robot is stopped, so that the state
/// shows wherever one looks.
fn draw_rules(
    model: &Model,
    regions: &Regions,
    snapshot: &Snapshot,
    theme: &Theme,
    buf: &mut Buffer,
) {
    let stopped = snapshot.run == crate::session::RunState::Stopped;
    let [flat, tee_down, tee_up, upright, branch] = if stopped {
        ["═", "╤", "╧", "│", "╞"]
    } else {
        ["─", "┬", "┴", "│", "├"]
    };
    let mut pen = Pen::new(buf, theme, Rect::new(0, 0, regions.header.width, u16::MAX));
    for rule in [regions.top_rule, regions.log_rule] {
        for x in rule.left()..rule.right() {
            pen.text(x, rule.y, flat, Role::Rule);
        }
    }
    let side = regions.side_rule;
    for y in side.top()..side.bottom() {
        pen.text(side.x, y, upright, Role::Rule);
    }
    pen.text(side.x, regions.top_rule.y, tee_down, Role::Rule);
    let joint = if regions.log_at_side { branch } else { tee_up };
    pen.text(side.x, regions.log_rule.y, joint, Role::Rule);
    pen.text(side.x + 2, regions.top_rule.y, " robot ", Role::Title);
    let log = log::title(model, snapshot);
    pen.text(regions.log_rule.x + 2, regions.log_rule.y, &log, Role::Title);
}
