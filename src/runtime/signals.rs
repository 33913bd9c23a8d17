//! Ctrl-C and its like, as a flag that the running loop looks at. A thread of its own waits for
//! them, so that nothing has to be asynchronous because of a signal.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use tokio::signal::unix::{SignalKind, signal};

/// A signal that asks the program to end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// Ctrl-C.
    Interrupt,
    /// A polite kill.
    Terminate,
    /// The terminal is gone.
    HangUp,
    /// A less polite kill, that asks for a core dump: none is left, but what is known is.
    Quit,
}

impl Signal {
    /// Its number.
    #[must_use]
    pub fn number(self) -> u8 {
        match self {
            Self::Interrupt => 2,
            Self::Terminate => 15,
            Self::HangUp => 1,
            Self::Quit => 3,
        }
    }

    /// The signal with this number, if it is one of these.
    #[must_use]
    pub fn numbered(number: u8) -> Option<Self> {
        let mut all = [Self::Interrupt, Self::Terminate, Self::HangUp, Self::Quit].into_iter();
        all.find(|signal| signal.number() == number)
    }

    /// The exit status that tells of it: 128 and the signal's number.
    #[must_use]
    pub fn status(self) -> u8 {
        128 + self.number()
    }

    /// What it is called in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Interrupt => "interrupt (Ctrl-C)",
            Self::Terminate => "the termination signal",
            Self::HangUp => "the terminal hanging up",
            Self::Quit => "the quit signal",
        }
    }
}

/// The signals received so far.
#[derive(Debug, Clone)]
pub struct Signals(Arc<AtomicU8>);

impl Signals {
    /// Signals that nobody listens for; [`Signals::raise`] still works.
    #[must_use]
    pub fn none() -> Self {
        Self(Arc::new(AtomicU8::new(0)))
    }

    /// Listens from now on. The first signal only sets the flag; a second one ends the program at
    /// once, in case writing the results hangs. A terminal that goes may say so twice, as its shell does
    /// as well: that ends nothing at once.
    ///
    /// # Errors
    /// When the system refuses to hand over signals.
    pub fn listen() -> io::Result<Self> {
        let signals = Self::none();
        let heard = signals.clone();
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build()?;
        let guard = runtime.enter();
        let mut interrupt = signal(SignalKind::interrupt())?;
        let mut terminate = signal(SignalKind::terminate())?;
        let mut hang_up = signal(SignalKind::hangup())?;
        let mut quit = signal(SignalKind::quit())?;
        drop(guard);
        std::thread::Builder::new().name("signals".to_owned()).spawn(move || {
            runtime.block_on(async {
                loop {
                    let signal = tokio::select! {
                        _ = interrupt.recv() => Signal::Interrupt,
                        _ = terminate.recv() => Signal::Terminate,
                        _ = hang_up.recv() => Signal::HangUp,
                        _ = quit.recv() => Signal::Quit,
                    };
                    if heard.received().is_some() && signal != Signal::HangUp {
                        std::process::exit(i32::from(signal.status()));
                    }
                    heard.raise(signal);
                }
            });
        })?;
        Ok(signals)
    }

    /// From now on a write beyond the limit that the shell sets to files (`ulimit -f`) fails as one on a
    /// full disk does. Without this the system would end the program there, with the robot under way.
    ///
    /// # Errors
    /// When the system refuses to hand over signals.
    pub fn outlive_long_files() -> io::Result<()> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build()?;
        let _guard = runtime.enter();
        // Once asked for, it is never again left to the system; nobody needs to hear of it.
        signal(SignalKind::from_raw(rustix::process::Signal::XFSZ.as_raw())).map(drop)
    }

    /// The first signal received, if any.
    #[must_use]
    pub fn received(&self) -> Option<Signal> {
        Signal::numbered(self.0.load(Ordering::Relaxed))
    }

    /// Acts as if `signal` had been received.
    pub fn raise(&self, signal: Signal) {
        // The first one counts: it names the reason in the report.
        let _ = self.0.compare_exchange(0, signal.number(), Ordering::Relaxed, Ordering::Relaxed);
    }
}
