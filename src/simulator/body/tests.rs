//! The simulated body against geometry worked out by hand.

use super::*;
use std::f64::consts::{FRAC_PI_4, FRAC_PI_6, PI, TAU};

const STEP: f64 = 0.02;

/// 4 x 3 m with a column and a wedge; the body starts at (`x`, `y`) facing `heading` radians.
fn body(x: f64, y: f64, heading: f64) -> Body {
    Body::new(&world(x, y, heading), &Chassis::default(), NoiseProfile::None, 1)
}

fn world(x: f64, y: f64, heading: f64) -> World {
    let text = "start = { x = 2.0, y = 1.5 }\n[boundary]\nvertices = [[0, 0], [4, 0], [4, 3], [0, 3]]\n[[objects]]\ncircle = { center = [1, 1], radius = 0.2 }\n[[objects]]\nvertices = [[0.8, 2.2], [1.4, 2.2], [0.9, 2.4]]\n";
    World::from_toml(text, "test", 0.1)
        .expect("a good world")
        .with_start(Pose::new(x, y, heading), "start", 0.1)
        .expect("a good start")
}

fn room(world: &World, at: Point) -> f64 {
    let rings = std::iter::once(&world.boundary).chain(world.objects.iter().map(|o| &o.ring));
    rings.map(|ring| ring.distance(at)).fold(f64::INFINITY, f64::min)
}

/// Drives until `seconds` have passed; all edges met, each with the true pose.
fn drive(body: &mut Body, speed: f64, rate: f64, seconds: f64) -> Vec<(Edge, Pose)> {
    let mut edges = Vec::new();
    body.drive(speed, rate);
    for _ in 0..(seconds / STEP).round() as u32 {
        body.step(STEP);
        while let Some(edge) = body.take_edge() {
            edges.push((edge, body.truth_of_edge()));
        }
    }
    body.drive(0.0, 0.0);
    edges
}

fn first(edges: &[(Edge, Pose)], sensor: usize, rising: bool) -> (Edge, Pose) {
    let found = edges.iter().find(|(e, _)| e.sensor == sensor && e.rising == rising);
    *found.unwrap_or_else(|| panic!("no edge of switch {sensor}, rising {rising}: {edges:?}"))
}

fn travelled(edge: &Edge) -> f64 {
    (edge.odometer.left_ticks + edge.odometer.right_ticks) as f64 * Chassis::default().tick / 2.0
}

#[test]
fn no_heading_and_no_speed_takes_the_body_through_a_wall() {
    for k in 0..48 {
        for (speed, rate) in [(0.2, 0.0), (0.6, 0.0), (-0.4, 0.0), (0.3, 0.05)] {
            let heading = TAU * f64::from(k) / 48.0 + 0.01;
            let world = world(2.0, 1.5, heading);
            let mut body = Body::new(&world, &Chassis::default(), NoiseProfile::None, 1);
            body.drive(speed, rate);
            for _ in 0..800 {
                body.step(STEP);
                let at = body.true_pose().position;
                // Chords stand for the column's arc, to a tenth of a millimetre.
                assert!(
                    world.boundary.contains(at) && room(&world, at) > 0.1 - 2e-4,
                    "speed {speed}, heading {heading}: at {at}, {} m from a wall",
                    room(&world, at)
                );
            }
            assert!(body.contact() > 0.0 || rate != 0.0, "heading {heading}: never met a wall");
        }
    }
}

/// The smallest and fastest robot that is taken goes twice its width in a step.
#[test]
fn a_small_fast_body_does_not_leap_through_a_wall() {
    let chassis = Chassis { radius: 0.01, range: 0.01, speed: 2.0, ..Chassis::default() };
    for k in 0..48 {
        let heading = TAU * f64::from(k) / 48.0 + 0.01;
        let world = world(2.0, 1.5, heading);
        let mut body = Body::new(&world, &chassis, NoiseProfile::None, 1);
        drive(&mut body, chassis.speed, 0.0, 3.0);
        let at = body.true_pose().position;
        let objects = world.objects.iter().any(|object| object.ring.contains(at));
        assert!(world.boundary.contains(at) && !objects, "heading {heading}: at {at}");
        assert!(room(&world, at) > 0.01 - 2e-4, "heading {heading}: overlaps a wall at {at}");
    }
}

/// One that covers 60 degrees to either side does not feel the wall beside it, and that ahead all the same.
#[test]
fn a_bumper_is_pressed_by_the_wall_ahead_when_another_is_touched_beside_it() {
    let chassis = Chassis { bumper_half_angle: PI / 3.0, ..Chassis::default() };
    for heading in [-0.2_f64, 0.2] {
        let y = if heading > 0.0 { 2.85 } else { 0.15 };
        let mut body = Body::new(&world(3.0, y, heading), &chassis, NoiseProfile::None, 1);
        drive(&mut body, 0.2, 0.0, 3.0);
        assert!(!body.bumper(), "heading {heading}: the wall beside it is at 79 degrees");
        drive(&mut body, 0.2, 0.0, 5.0);
        assert!((body.true_pose().position.x - 3.9).abs() < 1e-3, "{}", body.true_pose().position);
        assert!(body.bumper(), "heading {heading}: pressed against the wall ahead");
    }
}

#[test]
fn the_body_slides_along_a_wall_it_meets_at_an_angle() {
    let mut body = body(3.0, 1.0, FRAC_PI_4);
    drive(&mut body, 0.2, 0.0, 7.0);
    let at = body.true_pose().position;
    assert!((at.x - 3.9).abs() < 1e-3, "held off the wall at {at}, not at x 3.9");
    let free = 0.9 / angle::cos(FRAC_PI_4);
    // Along the wall goes only that part of the speed that the wall leaves.
    let expected = 1.9 + (1.4 - free) * angle::sin(FRAC_PI_4);
    assert!((at.y - expected).abs() < 0.01, "slid to y {}, not {expected}", at.y);
    assert!(body.bumper(), "pressed against a wall ahead");
    assert_eq!(body.bumps(), 1, "one touch is one bump");
}

#[test]
fn the_body_stalls_head_on_and_its_wheels_say_so() {
    let mut body = body(3.0, 1.5, 0.0);
    drive(&mut body, 0.2, 0.0, 10.0);
    assert!((body.true_pose().position.x - 3.9).abs() < 1e-3);
    let ticks = body.odometer().left_ticks;
    assert!((ticks - 1800).abs() <= 1, "{ticks} ticks for 0.9 m");
}

#[test]
fn the_bumper_covers_the_front_half_only() {
    let mut body = body(3.0, 1.5, PI);
    drive(&mut body, -0.2, 0.0, 6.0);
    assert!(!body.bumper(), "backed into a wall: the bumper is in front");
    assert_eq!(body.bumps(), 0);
}

#[test]
fn the_front_switch_closes_at_r_plus_d_and_opens_a_hysteresis_later() {
    let chassis = Chassis::default();
    let mut body = body(3.0, 1.5, 0.0);
    let edges = drive(&mut body, 0.2, 0.0, 4.5);
    let (edge, pose) = first(&edges, 0, true);
    let closes = 4.0 - chassis.reach();
    assert!((pose.position.x - closes).abs() < 5e-4, "closed at {}", pose.position);
    assert!((3.0 + travelled(&edge) - closes).abs() < 6e-4, "told {}", travelled(&edge));
    assert!(
        edge.odometer.time_us.abs_diff(4_200_000) < 5_000,
        "0.84 m at 0.2 m/s, closed at {} us",
        edge.odometer.time_us
    );
    let edges = drive(&mut body, -0.2, 0.0, 2.0);
    let (_, pose) = first(&edges, 0, false);
    let opens = closes - chassis.hysteresis;
    assert!((pose.position.x - opens).abs() < 5e-4, "opened at {}", pose.position);
}

#[test]
fn a_wall_met_at_an_angle_closes_the_switch_along_the_beam() {
    // Beyond acos(r / (r + d)), 51 degrees, the body is held up before the front beam reaches.
    for heading in [-FRAC_PI_4, -FRAC_PI_6, FRAC_PI_6, FRAC_PI_4] {
        let mut body = body(3.3, 1.5, heading);
        let edges = drive(&mut body, 0.2, 0.0, 7.0);
        let (_, pose) = first(&edges, 0, true);
        let expected = 4.0 - 0.16 * angle::cos(heading);
        assert!(
            (pose.position.x - expected).abs() < 5e-4,
            "heading {heading}: closed at {}, expected x {expected}",
            pose.position
        );
    }
}

#[test]
fn a_column_closes_the_switch_at_its_surface() {
    let mut body = body(2.0, 1.0, PI);
    let edges = drive(&mut body, 0.2, 0.0, 4.0);
    let (_, pose) = first(&edges, 0, true);
    let expected = 1.0 + 0.2 + 0.16;
    assert!(
        (pose.position.x - expected).abs() < 5e-4,
        "closed at {}, expected x {expected}",
        pose.position
    );
}

#[test]
fn a_turn_finds_the_angle_at_which_a_switch_closes() {
    let mut body = body(3.85, 1.5, FRAC_PI_4);
    let edges = drive(&mut body, 0.0, -0.5, 1.5);
    let (edge, pose) = first(&edges, 0, true);
    let expected = angle::acos(0.15 / 0.16);
    assert!(
        (pose.heading - expected).abs() < 1e-3,
        "closed at {}, expected {expected}",
        pose.heading
    );
    assert!(
        (edge.odometer.heading - expected).abs() < 1e-3,
        "the gyro told {}",
        edge.odometer.heading
    );
}

#[test]
fn wheels_and_gyro_count_a_turn() {
    let chassis = Chassis::default();
    let mut body = body(2.0, 1.5, 0.0);
    drive(&mut body, 0.0, 1.0, 3.0);
    let told = body.odometer();
    assert!((told.heading - 3.0).abs() < 1e-9, "gyro {}", told.heading);
    let ticks = (3.0 * chassis.wheel_base / 2.0 / chassis.tick).round() as i64;
    assert_eq!((told.left_ticks, told.right_ticks), (-ticks, ticks));
    assert_eq!(told.time_us, 3_000_000);
}

#[test]
fn time_passes_while_the_body_stands() {
    let mut body = body(2.0, 1.5, 0.3);
    let before = body.true_pose();
    assert!(drive(&mut body, 0.0, 0.0, 1.0).is_empty());
    assert_eq!(body.true_pose(), before);
    assert_eq!(body.odometer().time_us, 1_000_000);
}
