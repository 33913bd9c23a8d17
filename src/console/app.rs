//! The console's loop: keys in, intents out, time on, frames when something changed. It never
//! waits for the robot nor for the terminal, and draws at most thirty frames a second.

use super::driver::Clock;
use super::driver::Driver;
use super::key::Key;
use super::keymap::Keymap;
use super::model::Model;
use super::terminal::Guard;
use super::theme::Theme;
use super::update::{Effect, paste, press};
use super::view;
use crate::robot::Intent;
use crossterm::event::{Event, EventStream, KeyEventKind};
use futures::StreamExt;
use std::io;
use std::time::Duration;

/// A frame at most this often.
const FRAME: Duration = Duration::from_millis(33);

/// A stop takes no longer than this, the line and the brakes together.
const REST: Duration = Duration::from_millis(200);

/// How the console is set up.
pub struct Options {
    /// The keys.
    pub keymap: Keymap,
    /// The colours.
    pub theme: Theme,
}

/// How the console ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// The operator left.
    Quit,
    /// A signal with this number ended it.
    Signal(u8),
}

/// Why the console could not go on.
#[derive(Debug, thiserror::Error)]
pub enum ConsoleError {
    /// The terminal failed.
    #[error("the terminal cannot be used: {0}")]
    Terminal(#[from] io::Error),
    /// What runs the robot failed.
    #[error("{0}")]
    Run(String),
}

/// Runs the console over `driver` until it is left.
///
/// # Errors
/// When the terminal fails, or what runs the robot; the robot was told to stop.
pub async fn run(
    driver: &mut dyn Driver,
    options: Options,
    clock: &mut dyn Clock,
) -> Result<Ending, ConsoleError> {
    let mut guard = Guard::take()?;
    let mut result = turn(driver, options, clock, &mut guard).await;
    // A terminal that hangs up cannot be used either: what it was told by comes first.
    if let (Err(ConsoleError::Terminal(_)), Some(signal)) = (&result, clock.signal()) {
        result = Ok(Ending::Signal(signal));
    }
    // Whatever ended it: nothing moves without an operator.
    driver.intent(Intent::Stop);
    driver.advance(0.5);
    drop(guard);
    result
}

async fn turn(
    driver: &mut dyn Driver,
    options: Options,
    clock: &mut dyn Clock,
    guard: &mut Guard,
) -> Result<Ending, ConsoleError> {
    let size = guard.terminal.size()?;
    let mut model = Model::new(size.width, size.height, options.keymap);
    if !driver.has_own_time() {
        model.speed = None;
    }
    let theme = options.theme;
    let mut keys = EventStream::new();
    let mut tick = clock.ticker(FRAME);
    tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Skip);
    let mut drawn: Option<(u64, Model)> = None;
    let (mut known, mut snapshot) = (driver.version(), driver.snapshot());
    loop {
        tokio::select! {
            biased;
            event = keys.next() => {
                let Some(event) = event else { return Ok(Ending::Signal(1)) };
                // A key acts on how things are, not on the last frame: that may be an old one, where the terminal
                // is slow, or of before another key of the same batch.
                if std::mem::replace(&mut known, driver.version()) != known || snapshot.asked {
                    snapshot = driver.snapshot();
                }
                let effects = take(&mut model, &snapshot, event?);
                for effect in effects {
                    match effect {
                        Effect::Intent(intent) => {
                            driver.intent(intent);
                            snapshot = driver.snapshot();
                        }
                        Effect::Quit => return Ok(Ending::Quit),
                        Effect::Redraw => { guard.blank()?; drawn = None; }
                        Effect::Suspend => {
                            // The robot is at rest before nobody is there to hear it.
                            driver.advance(0.5);
                            let mut rest = clock.ticker(REST);
                            rest.tick().await;
                            rest.tick().await;
                            guard.lend()?;
                            clock.since_last();
                            drawn = None;
                        }
                        Effect::Export(dir) => {
                            let written = driver.export(std::path::Path::new(&dir));
                            answer(&mut model, written);
                        }
                        Effect::GoTo(seconds) => {
                            answer(&mut model, driver.go_to(seconds));
                            snapshot = driver.snapshot();
                        }
                    }
                }
            }
            _ = tick.tick() => {}
        }
        if let Some(signal) = clock.signal() {
            return Ok(Ending::Signal(signal));
        }
        guard.screen.check()?;
        if guard.screen.keeps_up() {
            driver.attended();
        }
        pass_time(driver, &model, clock);
        if let Some(why) = driver.failure() {
            return Err(ConsoleError::Run(why));
        }
        let version = driver.version();
        let fresh = drawn.as_ref().is_none_or(|(v, m)| *v != version || *m != model);
        if fresh && guard.screen.is_idle() && clock.frame_is_due(FRAME) {
            snapshot = driver.snapshot();
            guard.terminal.draw(|frame| {
                view::draw(&model, &snapshot, &theme, frame.area(), frame.buffer_mut());
            })?;
            drawn = Some((version, model.clone()));
        }
    }
}

/// Lets the robot's time pass as fast as was asked for, but never longer than half a frame of ours.
fn pass_time(driver: &mut dyn Driver, model: &Model, clock: &mut dyn Clock) {
    let real = clock.since_last();
    let times = model.speed.map_or(Some(1.0), super::driver::Speed::times);
    let mut left = times.map_or(f64::INFINITY, |times| real.as_secs_f64().min(0.1) * times);
    while left > 0.0 && !clock.has_spent(FRAME / 2) {
        let slice = left.min(0.4);
        driver.advance(slice);
        left -= slice;
        if driver.is_at_rest() {
            break;
        }
    }
}

fn take(model: &mut Model, snapshot: &crate::session::Snapshot, event: Event) -> Vec<Effect> {
    match event {
        Event::Key(key) if key.kind != KeyEventKind::Release => {
            press(model, snapshot, Key::from_event(&key))
        }
        Event::Resize(cols, rows) => {
            model.size = (cols, rows);
            vec![Effect::Redraw]
        }
        Event::Paste(text) => {
            paste(model, &text);
            Vec::new()
        }
        _ => Vec::new(),
    }
}

fn answer(model: &mut Model, answer: Result<String, String>) {
    let (text, refusal) = match answer {
        Ok(text) => (text, false),
        Err(text) => (text, true),
    };
    model.hint = Some(super::model::Hint { text, refusal, while_so: None });
}
