//! A lap closes where it began and nowhere else: in spirals, combs and mazes of thin walls, where one
//! corridor looks like the next, with a gyro that drifts.

mod common;

use periplus::mapping::map::Phase;
use periplus::mapping::settings::Settings;
use periplus::simulator::{NoiseProfile, World};

/// A corridor of 0.6 m that winds inwards, walls 0.1 m thick.
const SPIRAL: &str = r#"
name = "spiral"
start = { x = 0.3, y = 0.3, heading = 0 }
[boundary]
vertices = [[0, 0], [4, 0], [4, 4], [0.7, 4], [0.7, 1.4], [2.6, 1.4], [2.6, 2.6], [2, 2.6], [2, 2],
            [1.3, 2], [1.3, 3.4], [3.4, 3.4], [3.4, 0.6], [0, 0.6]]
"#;

/// Corridors of 0.5 m up and down, walls of 20 mm passed on both sides.
const ZIGZAG: &str = r#"
name = "zigzag"
start = { x = 0.25, y = 1.5, heading = 90 }
[boundary]
vertices = [[0, 0], [0.5, 0], [0.5, 2.5], [0.52, 2.5], [0.52, 0], [1.54, 0], [1.54, 2.5], [1.56, 2.5],
            [1.56, 0], [2.58, 0], [2.58, 3], [2.08, 3], [2.08, 0.5], [2.06, 0.5], [2.06, 3], [1.04, 3],
            [1.04, 0.5], [1.02, 0.5], [1.02, 3], [0, 3]]
"#;

const COMB: &str = include_str!("../sims/comb.toml");

#[test]
fn laps_close_where_they_began() {
    for (text, noise) in [
        (SPIRAL, NoiseProfile::Calibrated),
        (ZIGZAG, NoiseProfile::Calibrated),
        (COMB, NoiseProfile::Calibrated),
        (SPIRAL, NoiseProfile::Harsh),
    ] {
        let world = World::from_toml(text, "maze", 0.1).expect("a world");
        let perimeter = world.boundary.perimeter();
        for seed in 1..=3 {
            let settings = Settings { seed, ..Settings::new(world.start) };
            let map = common::mapped(&world, settings, noise, Phase::Boundary);
            let name = &world.name;
            assert!(map.closed, "{name} {seed}: open");
            let lap = map.misclosure.expect("a closed lap").lap;
            // The way of the centre is shorter than the wall inside corners, longer round their outside.
            let share = lap / perimeter;
            assert!((0.8..1.1).contains(&share), "{name} {seed}: {lap} m along {perimeter} m");
        }
    }
}
