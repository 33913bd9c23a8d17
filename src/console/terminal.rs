//! The terminal as a guarded thing: taken on, and given back as it was whatever ends the program.

use crossterm::event::{DisableBracketedPaste, EnableBracketedPaste};
use crossterm::terminal::{
    EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode, enable_raw_mode,
};
use crossterm::{cursor, execute};
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use rustix::process::{Signal, kill_current_process_group};
use std::io::{self, Stdout, stdout};
use std::mem::ManuallyDrop;

/// The terminal while the console has it.
pub struct Guard {
    /// What is drawn to. Never dropped: it would show the cursor once more, and where the terminal has
    /// gone, its complaint about that would be a panic.
    pub terminal: ManuallyDrop<Terminal<CrosstermBackend<Stdout>>>,
}

impl Guard {
    /// Takes the terminal on. A panic gives it back before it is reported.
    ///
    /// # Errors
    /// When the terminal refuses.
    pub fn take() -> io::Result<Self> {
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            restore();
            report(panic);
        }));
        enter()?;
        let terminal = Terminal::new(CrosstermBackend::new(stdout()))?;
        let mut guard = Self { terminal: ManuallyDrop::new(terminal) };
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
        restore();
        // The whole group, or a `cargo run` around the program would keep the terminal.
        kill_current_process_group(Signal::TSTP)?;
        enter()?;
        self.blank()
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

fn enter() -> io::Result<()> {
    enable_raw_mode()?;
    execute!(stdout(), EnterAlternateScreen, EnableBracketedPaste, cursor::Hide)
}

impl Drop for Guard {
    fn drop(&mut self) {
        restore();
    }
}

/// Gives the terminal back. Errors are of no use here: it may be gone.
fn restore() {
    let _ = execute!(stdout(), DisableBracketedPaste, LeaveAlternateScreen, cursor::Show);
    let _ = disable_raw_mode();
}
