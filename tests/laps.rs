//! A lap closes where it began and nowhere else: in spirals, combs and mazes of thin walls, where one
//! corridor looks like the next, with a gyro that drifts.

mod common;

use periplus::mapping::map::Phase;
use periplus::mapping::settings::Settings;
use periplus::robot::Intent;
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

/// What a lap may cost for every metre of the way, at 0.2 m/s: commands and seconds of robot time. A
/// metre without a stop takes five seconds.
const COSTS: [(&str, f64, f64); 5] = [
    (include_str!("../sims/rectangle.toml"), 7.7, 8.1),
    (include_str!("../sims/l_room.toml"), 9.0, 8.6),
    (include_str!("../sims/pentagon.toml"), 9.2, 8.7),
    (include_str!("../sims/circle.toml"), 11.0, 9.0),
    (include_str!("../sims/d_room.toml"), 10.2, 8.9),
];

#[test]
fn a_metre_of_wall_costs_few_commands_and_little_time() {
    for (text, commands, seconds) in COSTS {
        let world = World::from_toml(text, "room", 0.1).expect("a world");
        // What one lap costs is chance by a tenth: three of them.
        let (mut travel, mut spent) = (0.0, (0.0, 0.0));
        for seed in 1..=3 {
            let settings = Settings { seed, ..Settings::new(world.start) };
            let mut run = common::begun(&world, settings, NoiseProfile::Calibrated);
            run.intent(Intent::Run);
            while run.is_under_way() && run.session().mission().phase() == Phase::Boundary {
                run.advance();
            }
            let lap = run.snapshot().progress[0];
            assert!(lap.travel > 5.0, "{} {seed}: {} m", world.name, lap.travel);
            travel += lap.travel;
            spent = (spent.0 + f64::from(lap.commands), spent.1 + lap.seconds);
        }
        let (c, s) = (spent.0 / travel, spent.1 / travel);
        assert!(c < commands, "{}: {c} commands a metre", world.name);
        assert!(s < seconds, "{}: {s} s a metre", world.name);
    }
}

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

/// A floor where the tip of a board stands 0.31 m off the end of another: as far as the switches of both
/// sides just reach, and just do not.
const LAB: &str = include_str!("../sims/lab_maze.geojson");

#[test]
fn a_gap_that_is_refused_from_one_side_is_refused_from_the_other() {
    let world = World::from_geojson(LAB, "lab", 0.1).expect("a world");
    for seed in 5..=8 {
        let settings = Settings { seed, ..Settings::new(world.start) };
        let mut run = common::begun(&world, settings, NoiseProfile::Calibrated);
        run.intent(Intent::Run);
        while run.is_under_way() && run.session().mission().phase() == Phase::Boundary {
            run.advance();
        }
        let (map, way) = (run.snapshot().map, run.snapshot().progress[0].travel);
        assert!(map.closed, "{seed}: open");
        // Led through it, the robot would go round and round the island, and map that first.
        assert!(way < 2.0 * world.boundary.perimeter(), "{seed}: {way} m");
    }
}
