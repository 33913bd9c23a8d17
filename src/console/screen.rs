//! What is written to the terminal, by a thread of its own. A terminal that takes nothing more (a
//! connection that stalls, output that was halted) holds up that thread and nothing else: keys and
//! signals are heard all the same. Knows bytes, not what they show.

use std::fs::File;
use std::io::{self, Write};
use std::os::fd::AsFd;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Bytes that are written at a time; each of these pieces that the terminal takes is a sign of life. At
/// 9600 baud it is one of a quarter of a second.
const PIECE: usize = 256;

/// What is on its way to the terminal.
#[derive(Debug, Default)]
struct Way {
    waiting: Vec<u8>,
    /// A piece is being written.
    busy: bool,
    /// Pieces that the terminal took.
    taken: u64,
    failed: Option<io::Error>,
    closed: bool,
}

#[derive(Debug, Default)]
struct Shared {
    way: Mutex<Way>,
    changed: Condvar,
}

impl Shared {
    fn way(&self) -> MutexGuard<'_, Way> {
        self.way.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes what comes, piece by piece, until it is closed or the terminal fails.
    fn serve(&self, terminal: &mut impl Write) {
        let mut way = self.way();
        loop {
            if way.closed || way.failed.is_some() {
                return;
            }
            if way.waiting.is_empty() {
                way = self.changed.wait(way).unwrap_or_else(PoisonError::into_inner);
                continue;
            }
            let count = way.waiting.len().min(PIECE);
            let piece: Vec<u8> = way.waiting.drain(..count).collect();
            way.busy = true;
            drop(way);
            let written = terminal.write_all(&piece).and_then(|()| terminal.flush());
            way = self.way();
            way.busy = false;
            way.taken += 1;
            way.failed = written.err();
            self.changed.notify_all();
        }
    }
}

/// The way to the terminal.
#[derive(Debug)]
pub struct Screen {
    shared: Arc<Shared>,
    /// Pieces that were taken when somebody asked last.
    seen: u64,
}

impl Screen {
    /// The way to standard output.
    ///
    /// # Errors
    /// When the system refuses the thread.
    pub fn open() -> io::Result<Self> {
        // Not through `stdout()`: its lock would be held as long as the terminal takes nothing.
        Self::over(File::from(io::stdout().as_fd().try_clone_to_owned()?))
    }

    /// The way to standard error.
    ///
    /// # Errors
    /// When the system refuses the thread.
    pub fn of_errors() -> io::Result<Self> {
        Self::over(File::from(io::stderr().as_fd().try_clone_to_owned()?))
    }

    /// The way to `terminal`.
    ///
    /// # Errors
    /// When the system refuses the thread.
    pub fn over(mut terminal: impl Write + Send + 'static) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let served = shared.clone();
        let body = move || served.serve(&mut terminal);
        std::thread::Builder::new().name("screen".to_owned()).spawn(body)?;
        Ok(Self { shared, seen: 0 })
    }

    /// Something to write on; what is written leaves when it is flushed, and nobody waits for it.
    #[must_use]
    pub fn sheet(&self) -> Sheet {
        Sheet { shared: self.shared.clone(), text: Vec::new() }
    }

    /// Whether the terminal has taken all that was written.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        let way = self.shared.way();
        !way.busy && way.waiting.is_empty()
    }

    /// Whether the terminal has nothing to take, or took some of it since this was asked last: who looks
    /// at it sees how things are.
    pub fn keeps_up(&mut self) -> bool {
        let taken = self.shared.way().taken;
        let went_on = std::mem::replace(&mut self.seen, taken) != taken;
        went_on || self.is_idle()
    }

    /// Why the terminal cannot be written to any more, told once.
    ///
    /// # Errors
    /// That of the write that failed.
    pub fn check(&self) -> io::Result<()> {
        self.shared.way().failed.take().map_or(Ok(()), Err)
    }

    /// Waits until the terminal has taken all, but no longer than `most`; says whether it has.
    pub fn settle(&self, most: Duration) -> bool {
        let open = |way: &mut Way| (way.busy || !way.waiting.is_empty()) && way.failed.is_none();
        let waited = self.shared.changed.wait_timeout_while(self.shared.way(), most, open);
        !waited.unwrap_or_else(PoisonError::into_inner).1.timed_out()
    }
}

impl Drop for Screen {
    /// The thread ends, unless the terminal holds it up: then it ends with the program.
    fn drop(&mut self) {
        self.shared.way().closed = true;
        self.shared.changed.notify_all();
    }
}

/// What a frame is written on.
#[derive(Debug)]
pub struct Sheet {
    shared: Arc<Shared>,
    text: Vec<u8>,
}

impl Write for Sheet {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.text.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.shared.way().waiting.append(&mut self.text);
        self.shared.changed.notify_all();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::{Receiver, Sender, channel};

    /// A terminal that takes a piece only when it is let.
    struct Slow {
        let_go: Receiver<io::Result<()>>,
        took: Sender<Vec<u8>>,
    }

    impl Write for Slow {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.let_go.recv().unwrap_or(Ok(()))?;
            let _ = self.took.send(bytes.to_vec());
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_terminal_that_takes_nothing_holds_up_nobody() {
        let ((key, let_go), (took, taken)) = (channel(), channel());
        let mut screen = Screen::over(Slow { let_go, took }).expect("a thread");
        assert!(screen.keeps_up(), "there is nothing to take");
        let mut sheet = screen.sheet();
        sheet.write_all(&[7; PIECE + 3]).expect("it is only noted");
        assert!(screen.is_idle(), "nothing leaves before it is flushed");
        sheet.flush().expect("it is only handed over");
        assert!(!screen.is_idle() && !screen.keeps_up(), "stuck");
        assert!(!screen.settle(Duration::ZERO), "stuck");
        key.send(Ok(())).expect("it waits");
        assert_eq!(taken.recv().expect("a piece").len(), PIECE);
        key.send(Ok(())).expect("it waits");
        assert_eq!(taken.recv().expect("the rest").len(), 3);
        assert!(screen.settle(Duration::from_secs(60)));
        assert!(screen.keeps_up() && screen.check().is_ok());
        sheet.write_all(b"more").expect("it is only noted");
        sheet.flush().expect("it is only handed over");
        key.send(Err(io::Error::other("gone"))).expect("it waits");
        assert!(screen.settle(Duration::from_secs(60)), "nobody waits for a terminal that is gone");
        assert!(screen.check().is_err(), "its failure is told");
    }
}
