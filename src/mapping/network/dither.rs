//! How much the readings on a straight drive tell, each of them rounded to ticks.
//!
//! What the wheels turned is known no better than to a tick where it is read once. The mean of many readings
//! is nearer the truth, but only if the travel falls between two ticks now here, now there (dither: Schuchman
//! 1964). A wheel that makes 40.2 ticks from one report to the next is read all over a tick in five reports;
//! one that makes 40 is read in the same place every time, and all its readings are as wrong as one.

use super::record::{Reading, Rest, Share};

/// Ticks between two readings differ from the usual by no more than this while the robot goes evenly.
const EVENLY: f64 = 1.0;
/// Over how much of a tick the readings went is known to this, ticks: each end of it is rounded.
const UNSURE: f64 = 0.5;

/// A reading on a straight drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Passed {
    pub(super) reading: Reading,
    /// Where it was.
    pub(super) share: Share,
    /// How much it counts: 1 where it is rounded by itself.
    pub(super) weight: f64,
}

/// Those of `passed` that were taken on straight drives; `tick` is the travel of a wheel for one of its
/// ticks, metres.
pub(super) fn weighed(passed: &[Reading], rests: &[Rest], tick: f64) -> Vec<Passed> {
    let place = |reading: &Reading| {
        Some(Passed { reading: *reading, share: reading.share(rests)?, weight: 1.0 })
    };
    let mut placed: Vec<Passed> =
        passed.iter().filter_map(place).filter(|it| it.share.is_straight()).collect();
    placed.chunk_by_mut(|a, b| a.share.from == b.share.from).for_each(|drive| weigh(drive, tick));
    placed
}

/// Weighs the readings of one drive. While the robot goes evenly all of them together count as one where they
/// fall in the same place of a tick, each of them where they fall all over it; while it gathers way or slows
/// down each does.
fn weigh(drive: &mut [Passed], tick: f64) {
    let step = |a: &Passed, b: &Passed| {
        (
            b.reading.time_us.saturating_sub(a.reading.time_us),
            (b.reading.ahead - a.reading.ahead) / tick,
        )
    };
    let mut steps: Vec<(u64, f64)> = drive.windows(2).map(|it| step(&it[0], &it[1])).collect();
    steps.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let Some(usual) = steps.get(steps.len() / 2).copied() else { return };
    let is_even = |it: &(u64, f64)| it.0 == usual.0 && (it.1 - usual.1).abs() <= EVENLY;
    let (count, ticks) = steps
        .iter()
        .filter(|it| is_even(it))
        .fold((0.0, 0.0), |(n, sum), it| (n + 1.0, sum + it.1));
    let beyond = ticks / count;
    let over = ((beyond - beyond.round()).abs() * count - UNSURE).max(0.0);
    let missed = (1.0 - over).max(0.0);
    // The mean is off by what was missed of a tick, and no less than by chance.
    let even = 1.0 / f64::max(missed * missed * count, 1.0);
    for k in 1..drive.len() {
        if is_even(&step(&drive[k - 1], &drive[k])) {
            drive[k].weight = even;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: f64 = 0.0005;
    const BASE: f64 = 0.16;

    /// What is read of a drive on which the wheels make `ticks` from one report to the next, the right one
    /// `ahead` of the left by this part of a tick; the gyro tells a turn of `turned` in all.
    fn drive(ticks: f64, ahead: f64, turned: f64) -> (Vec<Reading>, [Rest; 2]) {
        let read = |k: u64| {
            let left = (k as f64 * ticks).floor() * TICK;
            let right = (k as f64 * ticks + ahead).floor() * TICK;
            let (time_us, share) = (k * 100_000, k as f64 / 26.0);
            Reading {
                time_us,
                active_us: time_us,
                ahead: f64::midpoint(left, right),
                against: (right - left) / BASE,
                turned: share * turned,
            }
        };
        let rest = |k: u64| Rest { reading: read(k), held_up: false };
        ((1..26).map(read).collect(), [rest(0), rest(26)])
    }

    /// The weighed mean of what the wheels turned, in ticks of one of them, and how much there was of it.
    fn mean(passed: &[Passed]) -> (f64, f64) {
        let weight: f64 = passed.iter().map(|it| it.weight).sum();
        let sum: f64 = passed.iter().map(|it| it.weight * it.reading.against * BASE / TICK).sum();
        (sum / weight, weight)
    }

    #[test]
    fn what_is_read_all_over_a_tick_is_known_to_less_than_one() {
        for ahead in [0.1, 0.3, 0.5, 0.8] {
            let (passed, rests) = drive(40.2, ahead, 0.0);
            let (told, weight) = mean(&weighed(&passed, &rests, TICK));
            assert!(weight > 24.0, "{weight} readings");
            assert!((told - ahead).abs() < 0.15, "{told} and not {ahead}");
        }
    }

    #[test]
    fn what_is_read_in_the_same_place_again_and_again_is_one_reading() {
        let (passed, rests) = drive(40.0, 0.4, 0.0);
        let (told, weight) = mean(&weighed(&passed, &rests, TICK));
        assert!(told.abs() < 1e-9, "wrong, and nothing shows it: {told}");
        assert!(weight < 2.1, "{weight} readings");
    }

    #[test]
    fn turns_tell_nothing_and_neither_do_drives_that_have_not_ended() {
        let (passed, rests) = drive(40.2, 0.3, 0.5);
        assert!(weighed(&passed, &rests, TICK).is_empty(), "a turn");
        let (passed, rests) = drive(40.2, 0.3, 0.0);
        assert_eq!(weighed(&passed[..1], &rests, TICK).len(), 1, "one by itself");
        assert!(weighed(&[], &rests, TICK).is_empty(), "none");
        assert!(weighed(&passed, &rests[..1], TICK).is_empty(), "not ended");
    }
}
