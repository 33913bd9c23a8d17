//! How the simulated robot errs. Every source has its own seeded stream, so that the same seed gives
//! the same run on any machine.
//!
//! The streams begin anew with every motion, and rests have one of their own: what a motion meets
//! hangs on its number, not on how long the host took to ask for it. Two runs of the same seed over
//! lines of different delay then err alike (common random numbers, as simulation calls it), and what
//! their maps differ by is the doing of the line.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// How good the robot's wheels, gyro and switches are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NoiseProfile {
    /// Perfect.
    None,
    /// A calibrated robot: wheels within 0.2 %, gyro drift 5 to 20 degrees an hour.
    #[default]
    Calibrated,
    /// Out of the box: wheels within 1 %, gyro scale within 0.5 %.
    Raw,
    /// Worn: wheels within 2 %, drift up to 60 degrees an hour, switches off by up to 10 %.
    Harsh,
}

impl fmt::Display for NoiseProfile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::Calibrated => "calibrated",
            Self::Raw => "raw",
            Self::Harsh => "harsh",
        })
    }
}

impl FromStr for NoiseProfile {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        match word {
            "none" => Ok(Self::None),
            "calibrated" => Ok(Self::Calibrated),
            "raw" => Ok(Self::Raw),
            "harsh" => Ok(Self::Harsh),
            _ => Err(format!("\"{word}\" is no noise profile; use none, calibrated, raw or harsh")),
        }
    }
}

/// Sizes of the errors of a profile.
struct Sizes {
    wheel: f64,
    gyro_scale: f64,
    bias_low: f64,
    bias_high: f64,
    jitter: f64,
    range: f64,
    miss: f64,
}

/// The errors of one run.
#[derive(Debug, Clone)]
pub struct Noise {
    /// Believed over real travel of the left and right wheel.
    pub wheel_scale: [f64; 2],
    /// Believed over real turn.
    pub gyro_scale: f64,
    /// Drift, radians per second.
    pub gyro_bias: f64,
    gyro_walk: f64,
    jitter: f64,
    range: Vec<f64>,
    miss: f64,
    per_move: f64,
    slip_per_metre: f64,
    /// Motions begun so far.
    motions: u64,
    gyro: ChaCha8Rng,
    rest: ChaCha8Rng,
    switches: ChaCha8Rng,
    wheels: ChaCha8Rng,
}

/// Sources of chance, each a stream of its own.
#[derive(Debug, Clone, Copy)]
enum Source {
    /// What holds for the whole run.
    Fixed = 1,
    Gyro,
    Switches,
    Wheels,
    Rest,
}

/// Streams of one motion.
const STREAMS: u64 = 8;

impl Noise {
    /// Draws the errors of a run for a robot with `switches` switches.
    #[must_use]
    pub fn new(profile: NoiseProfile, seed: u64, switches: usize) -> Self {
        let degrees_an_hour = 1.0_f64.to_radians() / 3600.0;
        let sizes = match profile {
            NoiseProfile::None => Sizes {
                wheel: 0.0,
                gyro_scale: 0.0,
                bias_low: 0.0,
                bias_high: 0.0,
                jitter: 0.0,
                range: 0.0,
                miss: 0.0,
            },
            NoiseProfile::Calibrated => Sizes {
                wheel: 0.002,
                gyro_scale: 0.0,
                bias_low: 5.0,
                bias_high: 20.0,
                jitter: 0.0015,
                range: 0.0,
                miss: 0.0,
            },
            NoiseProfile::Raw => Sizes {
                wheel: 0.01,
                gyro_scale: 0.005,
                bias_low: 5.0,
                bias_high: 20.0,
                jitter: 0.0015,
                range: 0.0,
                miss: 0.0,
            },
            NoiseProfile::Harsh => Sizes {
                wheel: 0.02,
                gyro_scale: 0.005,
                bias_low: 20.0,
                bias_high: 60.0,
                jitter: 0.004,
                range: 0.1,
                miss: 0.01,
            },
        };
        let stream = |source: Source| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(source as u64);
            rng
        };
        let mut fixed = stream(Source::Fixed);
        let mut within = |size: f64| (fixed.random::<f64>() * 2.0 - 1.0) * size;
        let wheel_scale = [1.0 + within(sizes.wheel), 1.0 + within(sizes.wheel)];
        let gyro_scale = 1.0 + within(sizes.gyro_scale);
        let share = within(1.0);
        let size = sizes.bias_low + (sizes.bias_high - sizes.bias_low) * share.abs();
        let noisy = profile != NoiseProfile::None;
        Self {
            wheel_scale,
            gyro_scale,
            gyro_bias: size * share.signum() * degrees_an_hour,
            gyro_walk: if noisy { 0.05_f64.to_radians() } else { 0.0 },
            jitter: sizes.jitter,
            range: (0..switches).map(|_| 1.0 + within(sizes.range)).collect(),
            miss: sizes.miss,
            per_move: if noisy { 0.005 } else { 0.0 },
            slip_per_metre: if noisy { 0.01 } else { 0.0 },
            motions: 0,
            gyro: stream(Source::Gyro),
            rest: stream(Source::Rest),
            switches: stream(Source::Switches),
            wheels: stream(Source::Wheels),
        }
    }

    /// The next motion begins, with streams of its own.
    pub fn begin_motion(&mut self) {
        self.motions += 1;
        let first = self.motions * STREAMS;
        for (rng, source) in [
            (&mut self.gyro, Source::Gyro),
            (&mut self.rest, Source::Rest),
            (&mut self.switches, Source::Switches),
            (&mut self.wheels, Source::Wheels),
        ] {
            rng.set_stream(first + source as u64);
            rng.set_word_pos(0);
        }
    }

    /// What the gyro reads beyond the turn itself after `seconds` in which the body moves or stands,
    /// radians.
    pub fn gyro_error(&mut self, seconds: f64, moves: bool) -> f64 {
        if self.gyro_walk == 0.0 {
            return 0.0;
        }
        let rng = if moves { &mut self.gyro } else { &mut self.rest };
        self.gyro_bias * seconds + normal(rng) * self.gyro_walk * seconds.sqrt()
    }

    /// Believed over real travel for the next motion of both wheels: wheel scale, per-move error
    /// and, now and then, a slip.
    pub fn travel_scale(&mut self) -> [f64; 2] {
        if self.per_move == 0.0 {
            return [1.0, 1.0];
        }
        let common = 1.0 + normal(&mut self.wheels) * self.per_move;
        [self.wheel_scale[0] * common, self.wheel_scale[1] * common]
    }

    /// Ticks of travel lost to a slip during a drive of `metres`; usually none. Metres.
    pub fn slip(&mut self, metres: f64) -> f64 {
        if self.slip_per_metre == 0.0 {
            return 0.0;
        }
        let happens = self.wheels.random::<f64>() < self.slip_per_metre * metres;
        let size = self.wheels.random::<f64>() * 0.004;
        if happens { size } else { 0.0 }
    }

    /// The range of switch `index` (metres, nominal `range`) for its next edge.
    pub fn range(&mut self, index: usize, range: f64) -> f64 {
        if self.jitter == 0.0 {
            return range;
        }
        range * self.range[index] + normal(&mut self.switches) * self.jitter
    }

    /// Whether a switch misses what is in front of it this time.
    pub fn misses(&mut self) -> bool {
        self.miss > 0.0 && self.switches.random::<f64>() < self.miss
    }
}

/// A draw from the standard normal distribution (Box and Muller 1958).
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * libm::log(1.0 - rng.random::<f64>())).sqrt();
    radius * libm::cos(std::f64::consts::TAU * rng.random::<f64>())
}

#[cfg(test)]
mod tests;
