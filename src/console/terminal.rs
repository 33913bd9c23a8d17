//! The terminal as a guarded thing: taken on, and given back as it was whatever ends the program.

use super::screen::{Screen, Sheet};
use crossterm::event::{DisableBracketedPaste, EnableBracketedPaste};
use crossterm::terminal::{
    EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode, enable_raw_mode,
};
use crossterm::{cursor, execute};
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use rustix::process::{Signal, kill_current_process_group};
use std::io::{self, Write, stdout};
use std::mem::ManuallyDrop;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A terminal that takes nothing for this long is left as it is.
const PATIENCE: Duration = Duration::from_secs(1);

/// The terminal while the console has it.
pub struct Guard {
    /// What is drawn to. Never dropped: it would show the cursor once more, and where the terminal has
    /// gone, its complaint about that would be a panic.
    pub terminal: ManuallyDrop<Terminal<CrosstermBackend<Sheet>>>,
    /// The way there.
    pub screen: Screen,
}

impl Guard {
    /// Takes the terminal on. A panic gives it back before it is reported.
    ///
    /// # Errors
    /// When the terminal refuses.
    pub fn take() -> io::Result<Self> {
        restore_before_reports();
        let screen = Screen::open()?;
        TAKEN.store(true, Ordering::Release);
        enter(&mut screen.sheet())?;
        let terminal = Terminal::new(CrosstermBackend::new(screen.sheet()))?;
        let mut guard = Self { terminal: ManuallyDrop::new(terminal), screen };
        // A program that was killed may have left its screen behind.
        guard.blank()?;
        Ok(guard)
    }

    /// Gives the terminal to the shell, as Ctrl-Z does, and takes it on again when the shell gives it
    /// back (`fg`).
    ///
    /// # Errors
    /// When the terminal refuses.
    pub fn lend(&mut self) -> io::Result<()> {
        self.give_back();
        // The whole group, or a `cargo run` around the program would keep the terminal.
        kill_current_process_group(Signal::TSTP)?;
        enter(&mut self.screen.sheet())?;
        self.blank()
    }

    fn give_back(&self) {
        restore(&mut self.screen.sheet());
        self.screen.settle(PATIENCE);
    }

    /// Empties the screen, so that all of it is drawn anew. The terminal is asked nothing, as ratatui's
    /// own `clear` asks for the cursor: over a slow line the answer may take too long.
    ///
    /// # Errors
    /// When the terminal refuses.
    pub fn blank(&mut self) -> io::Result<()> {
        let size = self.terminal.size()?;
        self.terminal.resize(size.into())
    }
}

/// Whether a console has the terminal.
static TAKEN: AtomicBool = AtomicBool::new(false);

/// From now on a panic gives the terminal back before it is reported, if a console has it. That is a write,
/// for which a terminal may let wait: who has something more urgent to do then asks for this first, and
/// for its own turn afterwards.
pub fn restore_before_reports() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if TAKEN.load(Ordering::Acquire) {
                restore(&mut stdout());
            }
            report(panic);
        }));
    });
}

fn enter(terminal: &mut impl Write) -> io::Result<()> {
    enable_raw_mode()?;
    execute!(terminal, EnterAlternateScreen, EnableBracketedPaste, cursor::Hide)
}

impl Drop for Guard {
    fn drop(&mut self) {
        TAKEN.store(false, Ordering::Release);
        self.give_back();
    }
}

/// Gives the terminal back. Errors are of no use here: it may be gone.
fn restore(terminal: &mut impl Write) {
    let _ = execute!(terminal, DisableBracketedPaste, LeaveAlternateScreen, cursor::Show);
    let _ = disable_raw_mode();
}
