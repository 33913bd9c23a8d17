//! Faults as middleware: what a bad line does to the bytes that go over it, seeded, so that the same
//! faults come again. For tests, and for `periplus robot --faults`.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::VecDeque;
use std::str::FromStr;

/// Bytes that share one fate: a line is lost whole or in part.
const PIECE: usize = 16;
/// The longest delay that can be asked for, seconds: a host has given up by then.
const LONGEST_DELAY: f64 = 10.0;
const SHARE: &str = "a share is a number from 0 to 1";

/// What a line does to what is written to it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Faults {
    /// Share of the pieces that are lost.
    pub drop: f64,
    /// Share in which one bit is turned over.
    pub flip: f64,
    /// Share that comes twice.
    pub double: f64,
    /// Share that changes places with the piece after it.
    pub swap: f64,
    /// Longest delay, seconds; delayed pieces keep their order.
    pub delay: f64,
    /// Nothing passes between these instants, seconds.
    pub mute: (f64, f64),
}

impl FromStr for Faults {
    type Err = String;

    /// Reads `drop=0.05,flip=0.01,double=0.01,swap=0.01,delay=0.2`.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut faults = Self::default();
        for word in text.split(',') {
            let wrong =
                || format!("`{word}`: write drop, flip, double, swap or delay, and =NUMBER");
            let (name, value) = word.split_once('=').ok_or_else(wrong)?;
            let (field, most, what) = match name {
                "drop" => (&mut faults.drop, 1.0, SHARE),
                "flip" => (&mut faults.flip, 1.0, SHARE),
                "double" => (&mut faults.double, 1.0, SHARE),
                "swap" => (&mut faults.swap, 1.0, SHARE),
                "delay" => (&mut faults.delay, LONGEST_DELAY, "a delay is from 0 to 10 seconds"),
                _ => return Err(wrong()),
            };
            let value: Option<f64> =
                value.parse().ok().filter(|value| (0.0..=most).contains(value));
            let value = value.ok_or_else(|| format!("`{word}`: {what}"))?;
            *field = value;
        }
        Ok(faults)
    }
}

/// One direction of a faulty line.
#[derive(Debug, Clone)]
pub struct FaultyWay {
    faults: Faults,
    rng: ChaCha8Rng,
    pieces: VecDeque<(f64, Vec<u8>)>,
}

impl FaultyWay {
    /// A way with these faults.
    #[must_use]
    pub fn new(faults: Faults, seed: u64) -> Self {
        Self { faults, rng: ChaCha8Rng::seed_from_u64(seed), pieces: VecDeque::new() }
    }

    /// Puts bytes in at `now` (seconds).
    pub fn put(&mut self, bytes: &[u8], now: f64) {
        let Faults { drop, flip, double, swap, delay, mute } = self.faults;
        for piece in bytes.chunks(PIECE) {
            if (mute.0..mute.1).contains(&now) || self.rng.random::<f64>() < drop {
                continue;
            }
            let mut piece = piece.to_vec();
            if self.rng.random::<f64>() < flip {
                let at = self.rng.random_range(0..piece.len());
                piece[at] ^= 1 << self.rng.random_range(0..8);
            }
            if self.rng.random::<f64>() < double {
                piece.extend_from_within(..);
            }
            let after = self.pieces.back().map_or(0.0, |(due, _)| *due);
            let due = (now + self.rng.random::<f64>() * delay).max(after);
            let before = self.rng.random::<f64>() < swap;
            match self.pieces.back_mut().filter(|_| before) {
                Some(last) => {
                    std::mem::swap(&mut last.1, &mut piece);
                    self.pieces.push_back((due, piece));
                }
                None => self.pieces.push_back((due, piece)),
            }
        }
    }

    /// What comes out by `now`.
    pub fn take(&mut self, now: f64) -> Vec<u8> {
        let mut out = Vec::new();
        while self.pieces.front().is_some_and(|(due, _)| *due <= now) {
            out.extend(self.pieces.pop_front().map(|(_, piece)| piece).unwrap_or_default());
        }
        out
    }

    /// Forgets what is under way, as a line does that is unplugged.
    pub fn clear(&mut self) {
        self.pieces.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_shares_and_delays_are_seconds() {
        let faults: Faults = "drop=0.05,delay=2".parse().expect("faults");
        assert_eq!((faults.drop, faults.delay), (0.05, 2.0));
        for bad in ["drop=2", "flip=1.1", "swap=-1", "delay=11", "mute=1", "drop"] {
            assert!(bad.parse::<Faults>().is_err(), "`{bad}` was taken");
        }
    }

    #[test]
    fn what_is_refused_is_told_with_how_far_it_goes() {
        for name in ["drop", "flip", "double", "swap"] {
            for value in ["1.1", "20", "-1", "nan", "much", ""] {
                let told = format!("{name}={value}").parse::<Faults>().expect_err(value);
                assert!(
                    told.contains(&format!("`{name}={value}`")) && told.contains("0 to 1"),
                    "{told}"
                );
            }
        }
        for value in ["10.1", "20", "-1", "inf", "long"] {
            let told = format!("drop=0.1,delay={value}").parse::<Faults>().expect_err(value);
            assert!(told.contains(&format!("`delay={value}`")), "{told}");
            assert!(told.contains(&format!("0 to {LONGEST_DELAY} seconds")), "{told}");
        }
        let told = "mute=1".parse::<Faults>().expect_err("none of them");
        assert!(told.contains("drop, flip, double, swap or delay"), "{told}");
    }
}
