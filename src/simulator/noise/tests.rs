//! The noise profiles hold what they promise, over many seeds.

use super::*;

const SEEDS: u64 = 400;

/// Degrees an hour in radians per second.
const DEGREES_AN_HOUR: f64 = std::f64::consts::PI / 180.0 / 3600.0;

fn draws(profile: NoiseProfile) -> impl Iterator<Item = Noise> {
    (0..SEEDS).map(move |seed| Noise::new(profile, seed, 8))
}

fn wheel_errors(profile: NoiseProfile) -> Vec<f64> {
    draws(profile).flat_map(|noise| noise.wheel_scale).map(|scale| (scale - 1.0).abs()).collect()
}

fn biases(profile: NoiseProfile) -> Vec<f64> {
    draws(profile).map(|noise| noise.gyro_bias / DEGREES_AN_HOUR).collect()
}

fn most(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, |most, v| most.max(v.abs()))
}

fn deviation(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let sum: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    (sum / values.len() as f64).sqrt()
}

#[test]
fn wheels_stay_within_what_the_profile_says_and_use_it_up() {
    for (profile, size) in
        [(NoiseProfile::Calibrated, 0.002), (NoiseProfile::Raw, 0.01), (NoiseProfile::Harsh, 0.02)]
    {
        let largest = most(&wheel_errors(profile));
        assert!(
            largest <= size && largest > 0.9 * size,
            "{profile}: wheels off by up to {largest}"
        );
    }
}

#[test]
fn gyro_drift_lies_between_its_bounds_with_either_sign() {
    for (profile, low, high) in [
        (NoiseProfile::Calibrated, 5.0, 20.0),
        (NoiseProfile::Raw, 5.0, 20.0),
        (NoiseProfile::Harsh, 20.0, 60.0),
    ] {
        let biases = biases(profile);
        for bias in &biases {
            assert!(
                bias.abs() >= low - 1e-9 && bias.abs() <= high + 1e-9,
                "{profile}: {bias} degrees an hour"
            );
        }
        let left = biases.iter().filter(|bias| **bias > 0.0).count();
        assert!(left > 120 && left < 280, "{profile}: {left} of {SEEDS} drift to the left");
    }
}

#[test]
fn gyro_scale_is_off_by_half_a_percent_at_most() {
    for (profile, size) in [
        (NoiseProfile::None, 0.0),
        (NoiseProfile::Calibrated, 0.0),
        (NoiseProfile::Raw, 0.005),
        (NoiseProfile::Harsh, 0.005),
    ] {
        let scales: Vec<f64> = draws(profile).map(|noise| noise.gyro_scale - 1.0).collect();
        assert!(
            most(&scales) <= size && most(&scales) >= 0.9 * size,
            "{profile}: {}",
            most(&scales)
        );
    }
}

#[test]
fn a_second_at_rest_walks_the_gyro_by_a_twentieth_of_a_degree() {
    let mut noise = Noise::new(NoiseProfile::Calibrated, 3, 8);
    let walks: Vec<f64> =
        (0..1000).map(|_| (0..50).map(|_| noise.gyro_error(0.02, false)).sum::<f64>()).collect();
    let walk = deviation(&walks).to_degrees();
    assert!((walk - 0.05).abs() < 0.005, "{walk} degrees after a second");
}

#[test]
fn what_a_motion_errs_by_hangs_on_its_number_and_not_on_the_wait_before_it() {
    let (mut prompt, mut late) =
        (Noise::new(NoiseProfile::Harsh, 7, 8), Noise::new(NoiseProfile::Harsh, 7, 8));
    let mut seen = Vec::new();
    for k in 0..50 {
        for _ in 0..k {
            late.gyro_error(0.02, false);
        }
        let errors = [&mut prompt, &mut late].map(|noise| {
            noise.begin_motion();
            let turned: f64 = (0..9).map(|_| noise.gyro_error(0.02, true)).sum();
            (noise.travel_scale(), noise.slip(0.1), noise.range(3, 0.06), noise.misses(), turned)
        });
        assert_eq!(errors[0], errors[1], "motion {k}");
        seen.push(errors[0]);
    }
    seen.dedup();
    assert_eq!(seen.len(), 50, "each motion errs by itself");
}

#[test]
fn each_move_is_off_by_half_a_percent_and_each_edge_by_a_millimetre_and_a_half() {
    let mut noise = Noise::new(NoiseProfile::Calibrated, 4, 8);
    let moves: Vec<f64> = (0..2000).map(|_| noise.travel_scale()[0]).collect();
    let size = deviation(&moves);
    assert!((size - 0.005).abs() < 5e-4, "moves are off by {size}");
    let edges: Vec<f64> = (0..2000).map(|_| noise.range(2, 0.06)).collect();
    let size = deviation(&edges);
    assert!((size - 0.0015).abs() < 1.5e-4, "edges are off by {size} m");
}

#[test]
fn harsh_switches_are_off_by_a_tenth_and_miss_now_and_then() {
    let mut noise = Noise::new(NoiseProfile::Harsh, 5, 8);
    let missed = (0..10_000).filter(|_| noise.misses()).count();
    assert!(missed > 50 && missed < 200, "{missed} of 10000 missed");
    let ranges: Vec<f64> =
        draws(NoiseProfile::Harsh).flat_map(|noise| noise.range).map(|range| range - 1.0).collect();
    assert!(most(&ranges) <= 0.1 && most(&ranges) > 0.09, "{}", most(&ranges));
}

#[test]
fn slips_are_rare_and_small() {
    let mut noise = Noise::new(NoiseProfile::Calibrated, 6, 8);
    let slips: Vec<f64> = (0..200_000).map(|_| noise.slip(0.004)).collect();
    let count = slips.iter().filter(|slip| **slip > 0.0).count();
    assert!(count > 3 && count < 20, "{count} slips in 800 m");
    assert!(most(&slips) <= 0.004, "a slip of {} m", most(&slips));
}

#[test]
fn no_noise_is_none_at_all() {
    let mut noise = Noise::new(NoiseProfile::None, 1, 8);
    assert_eq!(noise.travel_scale(), [1.0, 1.0]);
    assert_eq!(noise.gyro_error(10.0, true), 0.0);
    assert_eq!(noise.range(0, 0.06), 0.06);
    assert_eq!(noise.slip(10.0), 0.0);
    assert!(!noise.misses());
}
