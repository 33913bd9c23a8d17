//! The robot's clock, held against the host's: it may be late, as all is that comes over a line, and it cannot
//! be early. Knows nothing of what is told, only when.

/// Patience of a robot whose time goes as fast as life, milliseconds; simulated hardware whose time goes
/// faster announces as much more.
const PATIENCE: f64 = 300.0;
/// A clock that went on by no more than this too much is right, seconds of the host: lines differ in how late
/// they are, and clocks in how fast they go.
const AHEAD: f64 = 10.0;
/// From one message to the next, no more than this is made of a line that has become later, or of a clock
/// that goes slower than it should, seconds: what waited while the host slept is late only then.
const LATER: f64 = 1.0;
/// Whether a robot's time goes as fast as its patience says is looked at after this long, seconds of the host.
const LOOK: f64 = 3.0;
/// A robot that waits longer than this for its host is simulated hardware whose time goes as much faster, or
/// drives on where nobody stops it; milliseconds.
const LONG: u32 = 2000;
/// Time that goes no faster than this is that of life.
const LIFE: f64 = 1.5;

/// When messages come, and when they were made.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock {
    /// Seconds of the robot for one of the host, at most.
    pace: f64,
    /// Patience that is still to be believed, milliseconds, and when its time was looked at first: the robot's
    /// and the host's, seconds.
    doubted: Option<u32>,
    since: Option<(f64, f64)>,
    /// How late the host's clock is beside the robot's, seconds, and when that was last found so; none before
    /// anything was heard.
    late: Option<(f64, f64)>,
}

impl Clock {
    /// Of a robot that waits `watchdog` milliseconds for its host.
    pub(super) fn new(watchdog: u32) -> Self {
        let doubted = (watchdog > LONG).then_some(watchdog);
        let pace = (f64::from(watchdog) / PATIENCE).max(1.0);
        Self { pace, doubted, since: None, late: None }
    }

    /// The patience of a robot whose time goes no faster than life although it is that patient, seconds; told
    /// once. To be asked after each message that was made at `time_us` and came at `now`.
    pub(super) fn take_patience(&mut self, time_us: u64, now: f64) -> Option<f64> {
        let watchdog = self.doubted?;
        let made = time_us as f64 * 1e-6;
        let (from, since) = *self.since.get_or_insert((made, now));
        if now - since < LOOK {
            return None;
        }
        self.doubted = None;
        (made - from < LIFE * (now - since)).then(|| f64::from(watchdog) * 1e-3)
    }

    /// Takes a message into account that was made at `time_us` (robot time) and came at `now` (seconds).
    ///
    /// # Errors
    /// Seconds of robot time by which it was made after it came; it is not taken into account.
    pub(super) fn admit(&mut self, time_us: u64, now: f64) -> Result<(), f64> {
        let late = now - time_us as f64 * 1e-6 / self.pace;
        let (before, since) = self.late.unwrap_or((late, now));
        if before - late > AHEAD {
            return Err((before - late) * self.pace);
        }
        let later = (late - before).min((now - since).clamp(0.0, LATER));
        self.late = Some((before + later, now));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten reports a second, each as late as `late` says of the time, after `seconds` of them.
    fn after(watchdog: u32, seconds: u32, pace: f64, late: impl Fn(f64) -> f64) -> (Clock, f64) {
        let mut clock = Clock::new(watchdog);
        for k in 0..10 * seconds {
            let made = f64::from(k) * 0.1;
            let told = clock.admit((made * pace * 1e6) as u64, made + late(made));
            assert_eq!(told, Ok(()), "at {made} s");
        }
        (clock, f64::from(seconds))
    }

    #[test]
    fn lines_may_be_late_and_clocks_a_little_fast_or_slow() {
        after(300, 3600, 1.0, |_| 0.0);
        after(300, 3600, 1.0, |made| made % 1.7);
        after(300, 36_000, 1.02, |_| 0.0);
        after(300, 36_000, 0.98, |_| 0.0);
        after(7500, 3600, 25.0, |made| made % 1.7);
        // The host slept for ten minutes: what waited in its buffers comes first, and then what is new.
        let (mut clock, asleep) = after(300, 100, 1.0, |_| 0.02);
        let awake = asleep + 600.0;
        for k in 0..85 {
            let made = asleep + f64::from(k) * 0.1;
            assert_eq!(clock.admit((made * 1e6) as u64, awake), Ok(()));
        }
        assert_eq!(clock.admit((awake * 1e6) as u64, awake), Ok(()));
    }

    #[test]
    fn who_is_patient_and_no_faster_than_life_is_told_once() {
        let told = |watchdog: u32, pace: f64| {
            let mut clock = Clock::new(watchdog);
            let at = |k: u32| (f64::from(k) * 0.1 * pace * 1e6, f64::from(k) * 0.1);
            let take = |k| clock.take_patience(at(k).0 as u64, at(k).1);
            (0..100).filter_map(take).collect::<Vec<f64>>()
        };
        assert!(told(300, 1.0).is_empty());
        assert!(told(2000, 1.0).is_empty());
        assert_eq!(told(60_000, 1.0), [60.0]);
        assert!(told(6000, 20.0).is_empty());
        // A simulated robot whose computer does not keep up.
        assert!(told(60_000, 10.0).is_empty());
    }

    #[test]
    fn a_clock_that_goes_on_without_the_hosts_is_told_however_slow_it_was() {
        for (watchdog, pace) in [(300, 1.0), (300, 0.98), (300, 0.1), (600, 1.0), (7500, 25.0)] {
            let (mut clock, now) = after(watchdog, 1000, pace, |_| 0.02);
            let us = (now * pace * 1e6) as u64;
            let told = clock.admit(us + 4_294_967_296, now).expect_err("it leapt");
            assert!((told - 4295.0).abs() < 1.0, "{told} s");
            // The next one is right.
            assert_eq!(clock.admit(us + 100_000, now + 0.1), Ok(()));
        }
    }
}
