//! The progress bar of a run without a console: one line on standard error, and only when that
//! is a terminal.

use super::Progress;
use crate::console::screen::{Screen, Sheet};
use crate::export::PHASES;
use crate::wording::clock;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle, TermLike};
use std::io::{self, IsTerminal, Write};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Positions of the bar for each phase.
const PER_PHASE: u64 = 1000;

/// How long the terminal is given to take the last of it.
const FAREWELL: Duration = Duration::from_millis(300);

/// The bar. A terminal that takes nothing holds up nobody: whoever shows the bar hears signals as well.
#[derive(Debug)]
pub struct Bar {
    drawn: Option<(ProgressBar, Screen)>,
}

impl Bar {
    /// A bar on standard error, or none at all where nobody would see it move.
    #[must_use]
    pub fn new() -> Self {
        let screen = io::stderr().is_terminal().then(Screen::of_errors);
        screen.and_then(Result::ok).map_or(Self { drawn: None }, Self::on)
    }

    fn on(screen: Screen) -> Self {
        let length = PER_PHASE * PHASES.len() as u64;
        let terminal = Box::new(Terminal(Mutex::new(screen.sheet())));
        let target = ProgressDrawTarget::term_like_with_hz(terminal, 10);
        let bar = ProgressBar::with_draw_target(Some(length), target);
        if let Ok(style) = ProgressStyle::with_template("{bar:12} {wide_msg}") {
            bar.set_style(style.progress_chars("━╸─"));
        }
        Self { drawn: Some((bar, screen)) }
    }

    /// Shows how far the run has come after `wall` seconds, unless the terminal has not taken yet what was
    /// shown before.
    pub fn show(&mut self, progress: &Progress, wall: f64) {
        let Some((bar, screen)) = &self.drawn else { return };
        if !screen.is_idle() {
            return;
        }
        let index = PHASES.iter().position(|&phase| phase == progress.phase).unwrap_or(0);
        let within = progress.share.unwrap_or(0.0).clamp(0.0, 1.0) * PER_PHASE as f64;
        bar.set_position(index as u64 * PER_PHASE + within as u64);
        let share =
            progress.share.map_or(String::new(), |share| format!(" {:.0} %", share * 100.0));
        bar.set_message(message(progress, &share, wall));
    }

    /// Takes the bar off the screen; says whether the terminal, if there is one, takes what it is given.
    pub fn clear(&mut self) -> bool {
        let Some((bar, screen)) = self.drawn.take() else { return true };
        bar.finish_and_clear();
        screen.settle(FAREWELL)
    }
}

/// What the bar is drawn on.
#[derive(Debug)]
struct Terminal(Mutex<Sheet>);

impl Terminal {
    fn write(&self, text: &str) -> io::Result<()> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write_all(text.as_bytes())
    }
}

impl TermLike for Terminal {
    fn width(&self) -> u16 {
        let size = rustix::termios::tcgetwinsize(io::stderr());
        size.ok().map(|size| size.ws_col).filter(|columns| *columns > 0).unwrap_or(80)
    }

    fn move_cursor_up(&self, n: usize) -> io::Result<()> {
        if n > 0 { self.write(&format!("\x1b[{n}A")) } else { Ok(()) }
    }

    fn move_cursor_down(&self, n: usize) -> io::Result<()> {
        if n > 0 { self.write(&format!("\x1b[{n}B")) } else { Ok(()) }
    }

    fn move_cursor_right(&self, n: usize) -> io::Result<()> {
        if n > 0 { self.write(&format!("\x1b[{n}C")) } else { Ok(()) }
    }

    fn move_cursor_left(&self, n: usize) -> io::Result<()> {
        if n > 0 { self.write(&format!("\x1b[{n}D")) } else { Ok(()) }
    }

    fn write_line(&self, s: &str) -> io::Result<()> {
        self.write(&format!("{s}\n"))
    }

    fn write_str(&self, s: &str) -> io::Result<()> {
        self.write(s)
    }

    fn clear_line(&self) -> io::Result<()> {
        self.write("\r\x1b[2K")
    }

    fn flush(&self) -> io::Result<()> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).flush()
    }
}

/// What stands beside the bar: 80 columns hold both.
fn message(progress: &Progress, share: &str, wall: f64) -> String {
    let (time, wall) = (clock(progress.time), clock(wall));
    format!("{}{share} · robot {time}, {:.1} m · took {wall}", progress.phase, progress.travel)
}

impl Default for Bar {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::map::Phase;
    use std::sync::mpsc::{Receiver, Sender, channel};

    /// A terminal that takes nothing before it is let.
    struct Stuck {
        let_go: Receiver<()>,
        took: Sender<usize>,
    }

    impl Write for Stuck {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            // Let go for good when nobody holds it any more.
            let _ = self.let_go.recv();
            let _ = self.took.send(bytes.len());
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    /// A bar that was shown for as long as ten frames take, on a terminal that is stuck; what lets it go, and what
    /// it took.
    fn stuck() -> (Bar, Sender<()>, Receiver<usize>) {
        let ((key, let_go), (took, taken)) = (channel(), channel());
        let mut bar = Bar::on(Screen::over(Stuck { let_go, took }).expect("a thread"));
        let watch = crate::runtime::Stopwatch::start();
        while watch.seconds() < 1.0 {
            let (time, share) = (watch.seconds() * 100.0, Some(watch.seconds()));
            bar.show(&Progress { phase: Phase::Boundary, share, time, travel: time }, time);
        }
        (bar, key, taken)
    }

    #[test]
    fn a_terminal_that_takes_nothing_holds_up_nobody_and_is_given_no_more() {
        let (mut bar, key, taken) = stuck();
        drop(key);
        assert!(bar.clear(), "it is free again");
        drop(bar);
        let bytes: usize = taken.try_iter().sum();
        // The first frame, of which position and words are two, and what takes the bar away.
        assert!((1..600).contains(&bytes), "{bytes} bytes waited");
        let (mut bar, _key, _taken) = stuck();
        assert!(!bar.clear(), "it is stuck");
        assert!(Bar { drawn: None }.clear(), "where there is no terminal none is stuck");
    }

    #[test]
    fn bar_and_message_of_a_long_run_take_one_row_of_80_columns() {
        let progress =
            Progress { phase: Phase::Boundary, share: None, time: 35_999.0, travel: 4_999.9 };
        let told = message(&progress, " 100 %", 7_199.0);
        assert_eq!(told, "boundary 100 % · robot 9:59:59, 4999.9 m · took 1:59:59");
        assert!(12 + 1 + told.chars().count() <= 80, "{told}");
    }
}
