//! The wall clock, read nowhere else. It times runs and paces the screen; no decision of the
//! mapping depends on it.

use std::time::Instant;

/// Measures how long something takes.
#[derive(Debug, Clone, Copy)]
pub struct Stopwatch(Instant);

impl Stopwatch {
    /// Begins now.
    #[must_use]
    #[expect(clippy::disallowed_methods, reason = "the runtime owns the clock")]
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Seconds since the beginning.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }

    /// So many seconds pass at once.
    #[cfg(test)]
    pub(super) fn skip(&mut self, seconds: f64) {
        let skipped = std::time::Duration::from_secs_f64(seconds);
        self.0 = self.0.checked_sub(skipped).expect("the machine is not that young");
    }
}
