//! Robots with other bodies than ours: one whose brakes do not stop it within what its switches see, some that
//! see farther past the end of a thin wall than the wall is thick, ten switches of which none is abeam, six
//! of which none is near it, and one of half a metre across in a room that is as much larger.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

mod common;

use periplus::geometry::angle;
use periplus::mapping::event::EventKind;
use periplus::mapping::map::Phase;
use periplus::mapping::settings::Settings;
use periplus::robot::{Chassis, Intent};
use periplus::simulator::{NoiseProfile, World};
use periplus::wire::told;
use serde_json::Value;
use std::path::Path;

/// Two rooms of 1.6 by 0.8 m, one behind the end of the thin wall between them.
const BEHIND: &str = r#"
name = "a room behind the end of a thin wall"
start = { x = 0.62, y = 0.3, heading = 120 }
[boundary]
vertices = [[0, 0], [1.6, 0], [1.6, 1.6], [0, 1.6], [0, 0.81], [1.2, 0.81], [1.2, 0.79], [0, 0.79]]
"#;

fn world(name: &str, radius: f64) -> World {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("sims").join(name);
    World::load(&path, radius).expect("a world")
}

/// A traced world in which all lengths are `times` as long.
fn enlarged(name: &str, times: f64, radius: f64) -> World {
    fn enlarge(coordinates: &mut Value, times: f64) {
        match coordinates {
            Value::Array(parts) => parts.iter_mut().for_each(|part| enlarge(part, times)),
            number => *number = (number.as_f64().expect("a number") * times).into(),
        }
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("sims").join(name);
    let text = std::fs::read_to_string(path).expect("a world");
    let mut world: Value = serde_json::from_str(&text).expect("JSON");
    for feature in world["features"].as_array_mut().expect("features") {
        enlarge(&mut feature["geometry"]["coordinates"], times);
    }
    World::from_geojson(&world.to_string(), name, radius).expect("a world")
}

/// The area of what a robot without noise takes for the boundary of `world`, square metres, and how often the
/// bumper or a stall ended a motion meanwhile.
fn bounded(world: &World, chassis: &Chassis, seed: u64) -> (f64, u32) {
    let settings = Settings { seed, chassis: told(chassis), ..Settings::new(world.start) };
    let mut run = common::begun(world, settings, NoiseProfile::None);
    run.intent(Intent::Run);
    while run.is_under_way() && run.session().mission().phase() <= Phase::Shape {
        run.advance();
    }
    let snapshot = run.snapshot();
    (snapshot.map.shape.as_ref().expect("a shape").outline.area(), snapshot.bumps)
}

/// Weak brakes: from its own speed it stands after 111 mm, and its switches see 96.
fn slow_to_stand() -> Chassis {
    Chassis {
        radius: 0.164,
        wheel_base: 0.262,
        tick: 0.001,
        range: 0.096,
        hysteresis: 0.0148,
        speed: 0.296,
        turn_rate: 2.566,
        acceleration: 0.43,
        bumper_half_angle: angle::PI,
        ..Chassis::with_switches(10)
    }
}

#[test]
fn a_robot_that_would_not_stand_in_time_is_sent_slower_and_touches_nothing() {
    let chassis = slow_to_stand();
    let world = world("u_room.toml", chassis.radius);
    let (area, bumps) = bounded(&world, &chassis, 18);
    assert_eq!(bumps, 0);
    assert!((area / world.boundary.area() - 1.0).abs() < 0.005, "{area} m2");
    // And whoever watches is told.
    let told = EventKind::slower(&chassis).expect("slower").to_string();
    assert_eq!(
        told,
        "sent at 0.19 m/s, not 0.30: from there it would go 111 mm until it stands, and its switches see 96"
    );
    assert_eq!(EventKind::slower(&Chassis::default()), None);
}

#[test]
fn the_far_side_of_a_thin_wall_leads_nobody_across_the_gap_at_its_end() {
    // Before, both took the face that they had come along, two centimetres behind the one before them, for the way
    // on, which lay across the gap, and left 0.5 m2 behind it out.
    let far = Chassis {
        radius: 0.086,
        range: 0.107,
        tick: 0.001,
        hysteresis: 0.0176,
        speed: 0.216,
        turn_rate: 0.925,
        acceleration: 2.0,
        ..Chassis::default()
    };
    let ten = Chassis {
        radius: 0.125,
        range: 0.061,
        tick: 0.0001,
        hysteresis: 0.0065,
        speed: 0.175,
        turn_rate: 1.658,
        acceleration: 0.71,
        wheel_base: 0.167,
        ..Chassis::with_switches(10)
    };
    for (chassis, seed) in [(far, 15), (ten, 143)] {
        let world = world("lab_maze.geojson", chassis.radius);
        let (area, _) = bounded(&world, &chassis, seed);
        assert!((area / world.boundary.area() - 1.0).abs() < 0.005, "seed {seed}: {area} m2");
    }
}

#[test]
fn what_is_seen_of_the_wall_across_a_gap_is_no_thing_of_its_own() {
    // A board ends .79 m off a wall, and the swath is .8 m: going round it, the robot sees the wall in the gap. What
    // it saw of that was told apart from the board, and was a thing of 34 cm by nothing on the wall.
    let large = Chassis {
        radius: 0.25,
        wheel_base: 0.4,
        range: 0.15,
        hysteresis: 0.0125,
        speed: 0.5,
        turn_rate: 1.99,
        acceleration: 2.5,
        ..Chassis::default()
    };
    let world = enlarged("lab_maze.geojson", 2.5, large.radius);
    let settings =
        Settings { seed: 1, alpha: 0.625, chassis: told(&large), ..Settings::new(world.start) };
    let map = common::mapped(&world, settings, NoiseProfile::None, Phase::Objects);
    let things: Vec<f64> = map.objects.iter().map(|thing| thing.outline.area().abs()).collect();
    assert_eq!(things.len(), world.objects.len() - 1, "two boards touch: {things:?}");
    assert!(things.iter().all(|&area| area > 0.05), "{things:?}");
}

#[test]
fn without_a_switch_abeam_of_the_wall_no_gap_is_stepped_over() {
    let six = Chassis {
        radius: 0.071,
        wheel_base: 0.105,
        tick: 0.0003,
        range: 0.062,
        hysteresis: 0.0072,
        speed: 0.137,
        turn_rate: 1.623,
        acceleration: 1.29,
        ..Chassis::with_switches(6)
    };
    let world = World::from_toml(BEHIND, "behind", six.radius).expect("a world");
    let (area, _) = bounded(&world, &six, 4);
    assert!((area / world.boundary.area() - 1.0).abs() < 0.005, "{area} m2");
}
