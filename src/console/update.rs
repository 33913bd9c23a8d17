//! What a key does: model and snapshot in, changed model and effects out. Touches neither the
//! terminal nor the robot; the loop carries out the effects. What a typed line does is `line`.

mod line;

use super::action::Action;
use super::command::Steered;
use super::driver::Speed;
use super::key::Key;
use super::layout::Regions;
use super::model::{Asked, Camera, Hint, Model, Overlay, Standing};
use super::prompt::Prompt;
use super::view::log::scrolled;
use super::view::map::viewport;
use crate::geometry::Vector;
use crate::mapping::settings::ALPHA;
use crate::robot::Intent;
use crate::session::snapshot::{Known, RunState, Snapshot};
use crossterm::event::KeyCode;

/// Something the loop must do.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// Tell the driver.
    Intent(Intent),
    /// Write the map to this folder.
    Export(String),
    /// Go to this instant of the record, seconds.
    GoTo(f64),
    /// Draw everything anew.
    Redraw,
    /// Give the shell its turn, with the robot at rest.
    Suspend,
    /// Leave.
    Quit,
}

/// How much α changes at one key, metres.
const ALPHA_STEP: f64 = 0.05;
/// How much closer one key brings the map.
const ZOOM: f64 = 1.25;
/// How many times as far as where all is in view one can go.
const FARTHEST: f64 = 8.0;
/// The share of the view that one key pans.
const PAN: f64 = 0.125;

/// How many entries of the log one key scrolls by.
const LOG_STEP: isize = 3;

/// A key was pressed.
pub fn press(model: &mut Model, snapshot: &Snapshot, key: Key) -> Vec<Effect> {
    model.hint = None;
    let action = model.keymap.action(key);
    let typing = matches!(model.overlay, Overlay::Line(_));
    // Stop comes before everything else. Only while a command is typed and nothing can move is
    // its key a letter like others. Ctrl-C stops what may move, whatever else the keymap has made of it.
    let stops = action == Some(Action::Stop) || (key.is_ctrl_c() && snapshot.may_move());
    if stops && (!typing || key.typed().is_none() || snapshot.may_move()) {
        close_unless_typing(model, key);
        return perform(model, snapshot, Action::Stop);
    }
    // Whoever leaves for the shell means it, whatever is open: the robot stops for that.
    if action == Some(Action::Suspend) && (!typing || key.typed().is_none()) {
        close_unless_typing(model, key);
        return perform(model, snapshot, Action::Suspend);
    }
    let overlay = std::mem::take(&mut model.overlay);
    if Regions::of(model.size.0, model.size.1).is_none() && overlay != Overlay::ConfirmQuit {
        // Whoever does not see what a key does shall not do it unawares.
        return match action {
            Some(Action::Quit | Action::Redraw) => {
                action.map_or_else(Vec::new, |action| perform(model, snapshot, action))
            }
            _ => Vec::new(),
        };
    }
    match overlay {
        Overlay::None => {
            if let Some(action) = action {
                perform(model, snapshot, action)
            } else {
                let help = model.keymap.way(Action::Help);
                refuse(model, format!("{key} does nothing here; {help} shows the keys"))
            }
        }
        Overlay::Help(scroll) => {
            let end = super::view::help::last_scroll(model, snapshot);
            model.overlay = paged(key, action, scroll, end).map_or(Overlay::None, Overlay::Help);
            Vec::new()
        }
        Overlay::List(scroll) => {
            let end = super::view::list::last_scroll(model, snapshot);
            model.overlay = paged(key, action, scroll, end).map_or(Overlay::None, Overlay::List);
            Vec::new()
        }
        Overlay::Line(prompt) => line::press(model, snapshot, key, prompt),
        Overlay::ConfirmQuit => {
            if key.typed() == Some('y') {
                return vec![Effect::Intent(Intent::Stop), Effect::Quit];
            }
            tell(model, "staying".to_owned())
        }
        Overlay::ConfirmFinish => {
            if key.typed() == Some('y') {
                return vec![Effect::Intent(Intent::Finish)];
            }
            tell(model, "the run is not ended".to_owned())
        }
        Overlay::ConfirmAnew => {
            if key.typed() == Some('y') {
                return vec![Effect::Intent(Intent::LapAnew)];
            }
            tell(model, "nothing is dropped".to_owned())
        }
    }
}

/// Closes what lies over the map; a line that is typed stays, with what `key` types.
fn close_unless_typing(model: &mut Model, key: Key) {
    if let Overlay::Line(line) = &mut model.overlay {
        line.insert(&key.typed().map(String::from).unwrap_or_default());
    } else {
        model.overlay = Overlay::None;
    }
}

/// Text was pasted: into the command line, or nowhere.
pub fn paste(model: &mut Model, text: &str) {
    if let Overlay::Line(line) = &mut model.overlay {
        line.insert(text.lines().next().unwrap_or(""));
    } else {
        let line = model.keymap.label(Action::CommandLine);
        let how = if line.is_empty() {
            "no key opens the command line".to_owned()
        } else {
            format!("{line} opens the command line")
        };
        refuse(model, format!("pasted text is ignored here; {how}"));
    }
}

/// Does what the action says.
pub fn perform(model: &mut Model, snapshot: &Snapshot, action: Action) -> Vec<Effect> {
    match action {
        _ if snapshot.recorded && action.changes_the_run() => return only_looked_at(model),
        _ if model.is_alone(snapshot) && action.is_told_to_the_run() => {
            return not_answered(model, snapshot);
        }
        Action::Stop => return vec![Effect::Intent(Intent::Stop)],
        Action::ClearStop if snapshot.latched => {
            return clear_stop(model, snapshot);
        }
        Action::ClearStop => {
            return refuse_now(model, snapshot, "the robot is not stopped".to_owned());
        }
        Action::RunPause | Action::StepCommand | Action::StepEvent | Action::StepPhase => {
            return go(model, snapshot, action);
        }
        Action::AlphaDown => {
            return set_alpha(model, snapshot, alpha_now(model, snapshot) - ALPHA_STEP);
        }
        Action::AlphaUp => {
            return set_alpha(model, snapshot, alpha_now(model, snapshot) + ALPHA_STEP);
        }
        Action::SlowDown => return set_speed(model, snapshot, Speed::slower),
        Action::SpeedUp => return set_speed(model, snapshot, Speed::faster),
        Action::LapAgain => return vec![Effect::Intent(Intent::LapAgain)],
        // What was driven for minutes is gone then.
        Action::LapAnew if snapshot.laps_are_open => model.overlay = Overlay::ConfirmAnew,
        // The run says why not.
        Action::LapAnew => return vec![Effect::Intent(Intent::LapAnew)],
        Action::Square if snapshot.run.is_over() && snapshot.map.shape.is_none() => {
            let text = "no outline was found: there is nothing to square";
            return refuse(model, text.to_owned());
        }
        Action::Square => return vec![Effect::Intent(Intent::Square)],
        Action::Finish if snapshot.run.is_over() => {
            return refuse(model, "the run is over already".to_owned());
        }
        Action::Finish => model.overlay = Overlay::ConfirmFinish,
        Action::ZoomIn | Action::ZoomOut | Action::Follow | Action::Fit => {
            look(model, snapshot, action);
        }
        Action::PanLeft => pan(model, snapshot, Vector::new(-1.0, 0.0)),
        Action::PanRight => pan(model, snapshot, Vector::new(1.0, 0.0)),
        Action::PanUp => pan(model, snapshot, Vector::new(0.0, 1.0)),
        Action::PanDown => pan(model, snapshot, Vector::new(0.0, -1.0)),
        Action::ToggleContacts
        | Action::ToggleTrajectory
        | Action::TogglePlan
        | Action::ToggleRejected
        | Action::ToggleWalls
        | Action::ToggleDetail => toggle(model, snapshot, action),
        Action::LogUp => scroll(model, snapshot, -LOG_STEP),
        Action::LogDown => scroll(model, snapshot, LOG_STEP),
        Action::Help => model.overlay = Overlay::Help(0),
        Action::List => model.overlay = Overlay::List(0),
        Action::CommandLine => model.overlay = Overlay::Line(Prompt::default()),
        Action::Redraw => return vec![Effect::Redraw],
        Action::Suspend => return vec![Effect::Intent(Intent::Stop), Effect::Suspend],
        Action::Quit if snapshot.may_move() => model.overlay = Overlay::ConfirmQuit,
        Action::Quit => return vec![Effect::Quit],
    }
    Vec::new()
}

fn tell(model: &mut Model, text: String) -> Vec<Effect> {
    model.hint = Some(Hint { text, refusal: false, while_so: None });
    Vec::new()
}

fn refuse(model: &mut Model, text: String) -> Vec<Effect> {
    model.hint = Some(Hint { text, refusal: true, while_so: None });
    Vec::new()
}

/// Refuses for a reason that lies in how things stand: when that changes, it is no longer said.
fn refuse_now(model: &mut Model, snapshot: &Snapshot, text: String) -> Vec<Effect> {
    model.hint = Some(Hint { text, refusal: true, while_so: Some(Standing::of(snapshot)) });
    Vec::new()
}

fn only_looked_at(model: &mut Model) -> Vec<Effect> {
    refuse(model, Steered::Replay.refusal().to_owned())
}

fn not_answered(model: &mut Model, snapshot: &Snapshot) -> Vec<Effect> {
    let text = "the robot has not answered yet: it can be told nothing";
    refuse_now(model, snapshot, text.to_owned())
}

fn scroll(model: &mut Model, snapshot: &Snapshot, by: isize) {
    if let Some(regions) = Regions::of(model.size.0, model.size.1) {
        model.log = scrolled(model, snapshot, regions.log, by);
    }
}

/// What has to be said before a robot drives of which nobody knows where it is. With a boundary it can look
/// for its place by itself, though what it was told last led nowhere.
fn say_where(model: &Model, snapshot: &Snapshot) -> String {
    let line = model.keymap.label(Action::CommandLine);
    let alone = if snapshot.map.closed {
        format!(", or {line}placed alone to look everywhere")
    } else {
        String::new()
    };
    format!("its place is not known: type {line}placed=X,Y,DEG{alone}")
}

/// Whether the robot does nothing until it is told where it is: it was lost before there was a boundary to find
/// its place by, or did not find it.
fn is_nowhere(snapshot: &Snapshot) -> bool {
    let (Known::Known(robot) | Known::Stale { value: robot, .. }) = &snapshot.robot else {
        return false;
    };
    robot.needs_place
}

/// What is said of a robot that is not there to be told anything.
const NOT_HEARD: &str = "the robot is not heard: see to the link, or quit and --resume";

fn clear_stop(model: &mut Model, snapshot: &Snapshot) -> Vec<Effect> {
    let mut standing = Standing { latched: false, ..Standing::of(snapshot) };
    let text = if snapshot.run == RunState::Stopped {
        standing.run = RunState::Paused;
        if is_nowhere(snapshot) {
            format!("stop cleared; {}", say_where(model, snapshot))
        } else if matches!(snapshot.robot, Known::Stale { .. }) {
            format!("stop cleared; {NOT_HEARD}")
        } else {
            format!("stop cleared; {} runs on", model.keymap.way(Action::RunPause))
        }
    } else {
        "stop cleared".to_owned()
    };
    model.hint = Some(Hint { text, refusal: false, while_so: Some(standing) });
    vec![Effect::Intent(Intent::ClearStop)]
}

fn go(model: &mut Model, snapshot: &Snapshot, action: Action) -> Vec<Effect> {
    if let Some(how) = &snapshot.record_end {
        return refuse(model, how.clone());
    }
    // A stop, or a robot that asks where it is, was for the operator of then: the playback goes over it, and on
    // after the end of the run to that of the record.
    if !snapshot.recorded {
        if snapshot.run == RunState::Stopped {
            let clear = model.keymap.way(Action::ClearStop);
            return refuse_now(model, snapshot, format!("stopped: {clear} clears the stop first"));
        }
        if let Some(how) = snapshot.run.told_over() {
            return refuse(model, how);
        }
    }
    let intent = match action {
        Action::StepCommand => Intent::StepCommand,
        Action::StepEvent => Intent::StepEvent,
        Action::StepPhase => Intent::StepPhase,
        // Once the run is over the picture does not tell whether the record plays on.
        _ if snapshot.recorded && snapshot.run.is_over() => Intent::Run,
        // Asked a second time before the first was done, it is not to go on.
        _ if snapshot.run == RunState::Paused && !snapshot.asked => Intent::Run,
        _ => Intent::Pause,
    };
    if is_nowhere(snapshot) && !snapshot.recorded && intent != Intent::Pause {
        return refuse_now(model, snapshot, say_where(model, snapshot));
    }
    // A robot that is not there is not told to drive; that it is to pause can do no harm.
    if matches!(snapshot.robot, Known::Stale { .. }) && intent != Intent::Pause {
        return refuse_now(model, snapshot, NOT_HEARD.to_owned());
    }
    vec![Effect::Intent(intent)]
}

/// What α is, or will be as soon as the run hears of the last key: keys may come faster than frames.
fn alpha_now(model: &Model, snapshot: &Snapshot) -> f64 {
    let alpha = snapshot.settings.alpha;
    model.asked_alpha.filter(|asked| asked.from == alpha).map_or(alpha, |asked| asked.to)
}

fn set_alpha(model: &mut Model, snapshot: &Snapshot, alpha: f64) -> Vec<Effect> {
    if !snapshot.alpha_is_open {
        let text = "α stays as it is: no plan can follow it any longer";
        return refuse(model, text.to_owned());
    }
    // Whole micrometres, so that steps up and down meet again.
    let alpha = ((alpha * 1e6).round() / 1e6).clamp(ALPHA.0, ALPHA.1);
    tell(model, format!("α {alpha:.2} m: {}", alpha_means(alpha)));
    let changes = alpha != alpha_now(model, snapshot);
    model.asked_alpha = Some(Asked { from: snapshot.settings.alpha, to: alpha });
    changes.then_some(Effect::Intent(Intent::SetAlpha { alpha })).into_iter().collect()
}

fn alpha_means(alpha: f64) -> &'static str {
    if alpha <= ALPHA.0 {
        "the finest there is"
    } else if alpha >= ALPHA.1 {
        "the coarsest there is"
    } else {
        "the plan follows until its first line is driven"
    }
}

fn set_speed(
    model: &mut Model,
    snapshot: &Snapshot,
    change: impl Fn(Speed) -> Speed,
) -> Vec<Effect> {
    let what = if snapshot.recorded { "playback" } else { "simulated time" };
    match model.speed.map(change) {
        Some(speed) => {
            model.speed = Some(speed);
            tell(model, format!("{what} {speed}"))
        }
        None => refuse(model, Steered::Robot.refusal().to_owned()),
    }
}

fn toggle(model: &mut Model, snapshot: &Snapshot, action: Action) {
    let (layers, over) = (&mut model.layers, snapshot.is_handed_over());
    let layer = match action {
        Action::ToggleContacts => Some(&mut layers.contacts),
        Action::ToggleTrajectory => Some(&mut layers.trajectory),
        Action::TogglePlan => Some(&mut layers.plan),
        Action::ToggleRejected => Some(&mut layers.rejected),
        Action::ToggleWalls => Some(&mut layers.walls),
        _ => None,
    };
    let shown = if let Some(layer) = layer {
        layer.toggle(over);
        layer.is_shown(over)
    } else {
        model.log_detail = !model.log_detail;
        model.log_detail
    };
    let with_plan = model.layers.plan.is_shown(over);
    let state = seen(snapshot, action, shown, with_plan);
    tell(model, format!("{}: {state}", action.info().name));
}

/// What comes of it that a layer is to be `shown` or not: what there is not yet cannot be seen yet, without
/// an outline the contacts are the map, and without the plan nobody sees what was rejected of it.
fn seen(snapshot: &Snapshot, action: Action, shown: bool, with_plan: bool) -> &'static str {
    let Snapshot { map, run, .. } = snapshot;
    match action {
        Action::ToggleContacts if map.shape.is_none() && run.is_over() => {
            "shown, since there is no outline"
        }
        Action::ToggleContacts if map.shape.is_none() && shown => {
            "shown, and still when there is an outline"
        }
        Action::ToggleContacts if map.shape.is_none() => {
            "shown as long as there is no outline, then hidden"
        }
        _ if !shown => "hidden",
        Action::ToggleWalls if map.shape.is_none() && run.is_over() => "there is no outline",
        Action::ToggleWalls if map.shape.is_none() => "shown as soon as there is an outline",
        Action::TogglePlan | Action::ToggleRejected if map.plan.is_none() && run.is_over() => {
            "there is no plan"
        }
        Action::TogglePlan | Action::ToggleRejected if map.plan.is_none() => {
            "shown as soon as there is a plan"
        }
        Action::ToggleRejected if !with_plan => "shown with the plan, which is hidden",
        _ => "shown",
    }
}

fn look(model: &mut Model, snapshot: &Snapshot, action: Action) {
    let (cols, rows) = model.size;
    let Some(regions) = Regions::of(cols, rows) else {
        return;
    };
    let view = viewport(&model.camera, snapshot, regions.map);
    let center = view.center;
    // Further away than this the map is a speck, and then nothing.
    let farthest = viewport(&Camera::Fit, snapshot, regions.map).scale * FARTHEST;
    let zoomed = |factor: f64| {
        let wanted = (view.scale * factor).min(farthest.max(view.scale));
        let scale =
            wanted.clamp(super::canvas::viewport::FINEST, super::canvas::viewport::COARSEST);
        match model.camera {
            Camera::Follow { .. } => Camera::Follow { scale, around: center },
            Camera::Fit | Camera::Free { .. } => Camera::Free { scale, center },
        }
    };
    model.camera = match action {
        Action::ZoomIn => zoomed(1.0 / ZOOM),
        Action::ZoomOut => zoomed(ZOOM),
        Action::Follow => Camera::Follow { scale: view.scale, around: center },
        _ => Camera::Fit,
    };
}

fn pan(model: &mut Model, snapshot: &Snapshot, direction: Vector) {
    let (cols, rows) = model.size;
    if let Some(regions) = Regions::of(cols, rows) {
        let view = viewport(&model.camera, snapshot, regions.map);
        let step = Vector::new(view.x_range() * PAN, view.y_range() * PAN);
        let center = view.center + direction.component_mul(&step);
        model.camera = Camera::Free { scale: view.scale, center };
    }
}

/// How far a page that lies over the screen is scrolled after a key; none when the key leaves it.
fn paged(key: Key, action: Option<Action>, scroll: u16, end: u16) -> Option<u16> {
    let scroll = scroll.min(end);
    let scroll = match action {
        Some(Action::PanDown) => scroll.saturating_add(1),
        Some(Action::PanUp) => scroll.saturating_sub(1),
        Some(Action::LogDown) => scroll.saturating_add(8),
        Some(Action::LogUp) => scroll.saturating_sub(8),
        _ if key.is(KeyCode::Down) => scroll.saturating_add(1),
        _ if key.is(KeyCode::Up) => scroll.saturating_sub(1),
        _ => return None,
    };
    Some(scroll.min(end))
}

#[cfg(test)]
mod tests;
