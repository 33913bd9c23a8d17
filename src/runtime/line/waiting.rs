//! What waits for the port to take it, and whether the port takes nothing any more. Told the time; no I/O.

use crate::wire::STOP;

/// A port that takes nothing for this long is gone, seconds.
const STUCK: f64 = 1.0;

/// Bytes on their way into a port.
#[derive(Debug)]
pub(super) struct Waiting {
    bytes: Vec<u8>,
    /// When the port took something last, or had nothing to take.
    taken: f64,
    /// When [`Waiting::is_stuck`] was asked last: until then the port was offered what waits.
    looked: f64,
}

impl Waiting {
    /// Nothing yet, for a port that was opened at `now`, seconds.
    pub(super) fn new(now: f64) -> Self {
        Self { bytes: Vec::new(), taken: now, looked: now }
    }

    /// What the port is offered.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Whether the next that leaves is a stop.
    pub(super) fn is_stop(&self) -> bool {
        self.bytes.first() == Some(&STOP)
    }

    /// The port took `count` of them.
    pub(super) fn took(&mut self, count: usize, now: f64) {
        self.bytes.drain(..count);
        self.taken = now;
    }

    /// Adds what is to be written as well.
    pub(super) fn add(&mut self, fresh: &[u8], now: f64) {
        if self.bytes.is_empty() {
            self.taken = now;
        }
        if fresh.first() == Some(&STOP) {
            // Nothing that is still waiting may leave before a stop; a line cut short is dropped.
            self.bytes.clear();
        }
        self.bytes.extend_from_slice(fresh);
    }

    /// Whether the port has taken nothing for too long. Judged as of the time when this was asked before: whoever
    /// was busy since then, with a plan or a disk, or was halted, has offered it nothing meanwhile.
    pub(super) fn is_stuck(&mut self, now: f64) -> bool {
        let judged = std::mem::replace(&mut self.looked, now);
        !self.bytes.is_empty() && judged - self.taken > STUCK
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Looks every 5 ms from `from` until `until`; whether the port was found stuck.
    fn looks(waiting: &mut Waiting, (from, until): (u32, u32)) -> bool {
        (from..until).any(|step| waiting.is_stuck(f64::from(step) * 0.005))
    }

    #[test]
    fn a_port_that_takes_nothing_is_stuck_after_a_second() {
        let mut waiting = Waiting::new(0.0);
        assert!(!looks(&mut waiting, (0, 1000)), "there is nothing to take");
        waiting.add(b"P 1 0\n", 5.0);
        assert!(!looks(&mut waiting, (1000, 1195)), "it has time");
        waiting.took(1, 5.975);
        assert!(!looks(&mut waiting, (1195, 1395)), "it took some");
        assert_eq!(waiting.bytes(), b" 1 0\n");
        waiting.add(b"P 2 0\n", 6.97);
        assert!(looks(&mut waiting, (1395, 1400)), "it took none of it");
    }

    /// A plan that took seconds, a disk, or a host that was halted: the port was not even asked meanwhile.
    #[test]
    fn a_host_that_was_busy_has_not_lost_its_port() {
        for waits in [false, true] {
            let mut waiting = Waiting::new(0.0);
            if waits {
                waiting.add(b"P 1 0\n", 0.9);
            }
            assert!(!looks(&mut waiting, (0, 200)));
            waiting.add(b"M 1 100 200 00 00 1000\n", 8.0);
            assert!(!waiting.is_stuck(8.0), "waits: {waits}: it was not asked");
            let count = waiting.bytes().len();
            waiting.took(count, 8.001);
            assert!(!looks(&mut waiting, (1601, 2000)), "waits: {waits}");
        }
    }

    #[test]
    fn nothing_that_waits_leaves_before_a_stop() {
        let mut waiting = Waiting::new(0.0);
        waiting.add(b"M 1 100 200 00 00 1000\n", 0.0);
        waiting.add(&[STOP, b'S'], 0.1);
        assert_eq!(waiting.bytes(), [STOP, b'S']);
        waiting.add(b"P", 0.2);
        assert_eq!(waiting.bytes(), [STOP, b'S', b'P']);
    }
}
