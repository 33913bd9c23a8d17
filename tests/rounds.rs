//! Rooms with round walls, as a robot with the noise of a calibrated one finds them: the class, the parts, and the
//! radius of each that is round.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

mod common;

use common::mapped;
use periplus::geometry::{Point, angle};
use periplus::mapping::map::{PartClass, Phase, RoomMap, ShapeClass};
use periplus::mapping::settings::Settings;
use periplus::simulator::{NoiseProfile, World};

fn shape_of(world: &str, seed: u64) -> RoomMap {
    let world = World::from_toml(world, "world", 0.1).expect("a world");
    let settings = Settings { seed, ..Settings::new(world.start) };
    mapped(&world, settings, NoiseProfile::Calibrated, Phase::Shape)
}

/// Holds that each of the robots finds these parts of a complex room; the radii within 1.5 %, of which the
/// wheels may be off a half, and a short arc tells little.
fn parts_are(world: &str, seeds: &[u64], parts: &[(PartClass, Option<f64>)]) {
    for &seed in seeds {
        let shape = shape_of(world, seed).shape.expect("a shape");
        assert_eq!(shape.class, ShapeClass::Complex);
        let found: Vec<(PartClass, Option<f64>)> = shape
            .parts
            .iter()
            .map(|part| (part.class, part.circle.map(|(_, radius)| radius)))
            .collect();
        assert_eq!(found.len(), parts.len(), "seed {seed}: {found:?}");
        let mut left = found.clone();
        for (class, radius) in parts {
            let is_it = |it: &(PartClass, Option<f64>)| {
                let near = match (it.1, radius) {
                    (Some(found), Some(true_one)) => (found / true_one - 1.0).abs() < 0.015,
                    (found, true_one) => found.is_none() && true_one.is_none(),
                };
                it.0 == *class && near
            };
            let at = left.iter().position(is_it);
            left.remove(at.unwrap_or_else(|| panic!("seed {seed}: no {class:?} in {found:?}")));
        }
    }
}

#[test]
fn rooms_of_a_straight_and_a_round_wall_are_one_part() {
    // Drawn as two sectors, a disc with a corner cut off, or with a bent side by these robots before.
    let half = "name = \"half a disc\"\nstart = { x = 0.1, y = 1.6, heading = 50 }\n[boundary]\n\
                vertices = [[-4, 0], [4, 0, 1.0]]\n";
    parts_are(half, &[1, 3, 6, 14], &[(PartClass::Semicircle, Some(4.0))]);
    // A piece of cake whose corners no robot touches.
    let bulge = angle::tan(angle::PI / 12.0);
    let cake = format!(
        "name = \"cake\"\nstart = {{ x = 0.87, y = 0.5, heading = 10 }}\n[boundary]\n\
         vertices = [[0, 0], [2, 0, {bulge}], [1, {}]]\n",
        3.0_f64.sqrt()
    );
    parts_are(&cake, &[6, 10, 14], &[(PartClass::Sector, Some(2.0))]);
}

#[test]
fn the_round_part_of_a_room_is_one_however_the_lap_is_bent() {
    let keyhole = include_str!("../sims/keyhole.toml");
    let parts = [(PartClass::Circle, Some(1.03)), (PartClass::Convex, None)];
    parts_are(keyhole, &[1, 3], &parts);
    let stadium = "name = \"stadium\"\nstart = { x = 1.5, y = 2, heading = 20 }\n[boundary]\n\
                   vertices = [[0, 0], [3, 0, 1.0], [3, 4], [0, 4, 1.0]]\n";
    let parts = [
        (PartClass::Semicircle, Some(2.0)),
        (PartClass::Semicircle, Some(2.0)),
        (PartClass::Convex, None),
    ];
    parts_are(stadium, &[1, 2], &parts);
    let parts = parts.map(|(class, radius)| (class, radius.map(|_| 1.5)));
    parts_are(include_str!("../sims/stadium.toml"), &[8], &parts);
}

#[test]
fn a_round_room_with_one_contact_off_is_round() {
    let round = "name = \"round\"\nstart = { x = 0.4, y = 0.2, heading = 30 }\n[boundary]\n\
                 circle = { center = [0, 0], radius = 2 }\n";
    for seed in [1, 7] {
        let shape = shape_of(round, seed).shape.expect("a shape");
        assert_eq!((shape.class, shape.parts.len()), (ShapeClass::Circle, 1), "seed {seed}");
    }
}

/// Nothing of a round wall tells how far the robot has turned about the middle: things do.
#[test]
fn in_a_round_hall_each_column_is_on_the_map_once_and_where_it_is() {
    let columns = [(-2.52, 3.45), (2.8, -2.2), (0.5, 3.9), (-3.9, -1.2)];
    let object =
        |(x, y)| format!("[[objects]]\ncircle = {{ center = [{x}, {y}], radius = 0.15 }}\n");
    let things: String = columns.map(object).concat();
    let hall = format!(
        "name = \"hall\"\nstart = {{ x = 0, y = 0, heading = 0 }}\n[boundary]\n\
         circle = {{ center = [0, 0], radius = 5 }}\n{things}"
    );
    let world = World::from_toml(&hall, "hall", 0.1).expect("a world");
    // Before, these robots mapped six and eight columns, none of them where one is.
    for seed in [1, 3] {
        let settings = Settings { seed, ..Settings::new(world.start) };
        let map = mapped(&world, settings, NoiseProfile::Calibrated, Phase::Objects);
        let found: Vec<Point> = map.objects.iter().map(|o| o.outline.middle()).collect();
        assert_eq!(found.len(), columns.len(), "robot {seed}: {found:?}");
        for (x, y) in columns {
            let off = found.iter().map(|at| (at - Point::new(x, y)).norm());
            let off = off.fold(f64::INFINITY, f64::min);
            // Within two standard errors: in an hour the gyro walks by almost a degree.
            assert!(off < 0.15, "robot {seed}: {off} m");
        }
    }
}
