//! A line that waits for its acknowledgement, and is sent again until it has it.

/// The wait for an answer doubles until it is this long, seconds.
const LONGEST_WAIT: f64 = 0.4;

/// Something that was sent and has not been acknowledged.
#[derive(Debug, Clone)]
pub(super) struct Pending {
    pub(super) seq: u32,
    pub(super) line: Vec<u8>,
    pub(super) due: f64,
    wait: f64,
    pub(super) since: f64,
}

impl Pending {
    /// Sent at `now`, with an answer expected within `wait` seconds.
    pub(super) fn new(seq: u32, line: Vec<u8>, now: f64, wait: f64) -> Self {
        Self { seq, line, due: now + wait, wait, since: now }
    }

    /// Sent once more: the next wait is longer.
    pub(super) fn again(&mut self, now: f64) {
        self.wait = (self.wait * 2.0).min(self.wait.max(LONGEST_WAIT));
        self.due = now + self.wait;
    }
}
