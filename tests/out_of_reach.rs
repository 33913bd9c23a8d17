//! What the robot cannot get to is told with the place and the width of the gap, and rooms without such
//! gaps are told to have none.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

mod common;
#[path = "common/stepped.rs"]
mod stepped;

use periplus::geometry::Point;
use periplus::mapping::map::{Phase, RoomMap};
use periplus::mapping::settings::Settings;
use periplus::mapping::unreached::{Beyond, Unreached};
use periplus::robot::Intent;
use periplus::simulator::{NoiseProfile, World};
use stepped::step_phase;

/// Niches of 0.10, 0.15 and 0.20 m in one wall and of 0.25 m in another, and a corner closed off by two
/// boards that stand 0.25 m apart.
const NICHES: &str = r#"
name = "niches"
start = { x = 0.6, y = 0.6, heading = 30 }
[boundary]
vertices = [[0, 0], [1.5, 0], [1.5, -0.5], [1.6, -0.5], [1.6, 0], [3, 0], [3, -0.6], [3.15, -0.6],
            [3.15, 0], [4.5, 0], [4.5, -0.8], [4.7, -0.8], [4.7, 0], [6, 0], [6, 1.5], [6.6, 1.5],
            [6.6, 1.75], [6, 1.75], [6, 4], [0, 4]]
[[objects]]
name = "one board"
vertices = [[4.9, 2.6], [6, 2.6], [6, 2.65], [4.9, 2.65]]
[[objects]]
name = "another board"
vertices = [[4.6, 2.6], [4.65, 2.6], [4.65, 4], [4.6, 4]]
"#;

fn told(world: &str) -> Vec<Unreached> {
    let world = World::from_toml(world, "test", 0.1).expect("a world");
    let settings = Settings::new(world.start);
    common::mapped(&world, settings, NoiseProfile::None, Phase::Objects).unreached
}

#[test]
fn every_gap_is_told_with_its_place_and_its_width() {
    let gaps = told(NICHES);
    let truth = [
        (1.55, 0.0, 0.10),
        (3.075, 0.0, 0.15),
        (4.6, 0.0, 0.20),
        (6.0, 1.625, 0.25),
        (4.775, 2.6, 0.25),
    ];
    assert_eq!(gaps.len(), truth.len(), "{gaps:?}");
    for (x, y, width) in truth {
        let near = |gap: &&Unreached| (gap.at - Point::new(x, y)).norm() < 0.08;
        let gap = gaps.iter().find(near).expect("a gap there");
        assert!((gap.width - width).abs() < 0.005, "{gap:?} instead of {width}");
    }
}

#[test]
fn rooms_without_gaps_are_told_to_have_none() {
    for room in [
        include_str!("../sims/flat.toml"),
        include_str!("../sims/comb.toml"),
        include_str!("../sims/objects.toml"),
        include_str!("../sims/keyhole.toml"),
    ] {
        assert_eq!(told(room), Vec::new());
    }
}

/// Two rooms of about 2 x 2 m. Two corners between them stand so far apart, and askew to each other by so much,
/// metres: of what is wider than the body by 1 to 4 cm robots get through some, and through others not.
fn chicane(gap: f64, askew: f64) -> World {
    let low = 1.135 - (gap * gap - askew * askew).sqrt();
    let text = format!(
        r#"
name = "chicane"
start = {{ x = 0.6, y = 0.6, heading = 30 }}
[boundary]
vertices = [[0, 0], [{0}, 0], [{0}, {low}], [2.7, {low}], [2.7, 0], [4.2, 0], [4.2, 2], [2, 2],
            [2, 1.135], [1.5, 1.135], [1.5, 2], [0, 2]]
"#,
        2.0 + askew
    );
    World::from_toml(&text, "test", 0.1).expect("a world")
}

#[test]
fn the_map_ends_at_a_strait_whether_the_robot_got_through_or_not() {
    let world = chicane(0.27, 0.25);
    let mapped = |seed| {
        let settings = Settings { seed, ..Settings::new(world.start) };
        common::mapped(&world, settings, NoiseProfile::Calibrated, Phase::Objects)
    };
    // Of the first hundred robots the 55th and the 79th get through.
    let maps = [12, 13, 55, 79].map(mapped);
    let through = maps.iter().filter(|map| !map.beyond.is_empty()).count();
    assert!(through > 0 && through < maps.len(), "{through} of the robots got through");
    for map in &maps {
        let area = map.shape.as_ref().expect("a shape").outline.area();
        assert!((area - 3.84).abs() < 0.06, "{area}");
        let [gap] = map.unreached[..] else { panic!("{:?}", map.unreached) };
        assert!((gap.at - Point::new(2.125, 1.084)).norm() < 0.1, "{gap:?}");
        // Where a robot did not get in, the corners stand less far into the gap than they do.
        assert!((0.25..0.34).contains(&gap.width), "{gap:?}");
        let outline = &map.shape.as_ref().expect("a shape").outline;
        let strait = map.beyond.first().and_then(Beyond::strait);
        assert!(
            strait.is_none_or(|strait| outline.distance(strait.at(0.5)) < 0.005),
            "{outline:?}"
        );
        // Behind it 2.2 x 2 m less a block of 0.45 x 1.03 m, worn down by the body.
        let known = gap.area.is_none_or(|area| (area - 2.75).abs() < 0.1);
        assert!(known && gap.area.is_some() != map.beyond.is_empty(), "{gap:?}");
    }
}

/// Rounds in the room behind are no rounds of the first one, nor is the way that they are of the lap.
#[test]
fn a_lap_through_a_strait_and_back_makes_a_map() {
    for (gap, askew) in [(0.26, 0.05), (0.27, 0.05), (0.28, 0.15), (0.27, 0.25)] {
        let world = chicane(gap, askew);
        for seed in 1..=12 {
            let settings = Settings { seed, ..Settings::new(world.start) };
            let map = common::mapped(&world, settings, NoiseProfile::Calibrated, Phase::Shape);
            assert!(map.shape.is_some(), "a gap of {gap} m, askew by {askew} m, robot {seed}");
        }
    }
}

#[test]
fn a_tape_laid_later_leaves_the_end_of_the_map_where_it_is() {
    let world = chicane(0.27, 0.25);
    let settings = Settings { seed: 55, ..Settings::new(world.start) };
    let mut run = common::begun(&world, settings, NoiseProfile::Calibrated);
    (0..3).for_each(|_| step_phase(&mut run));
    let area = |map: &RoomMap| map.shape.as_ref().expect("a shape").outline.area();
    let before = area(&run.snapshot().map);
    let (from, to) = (Point::new(0.0, 0.0), Point::new(2.25, 0.0));
    run.intent(Intent::SetTape { from, to, length: 2.27 });
    let map = run.snapshot().map;
    let taped = map.taped.expect("a tape that is laid");
    let (grown, told) = (area(&map) / before, taped.stretch.powi(2));
    assert!(told > 1.005 && (grown - told).abs() < 0.002, "{grown} for {told}");
    let strait = map.beyond[0].strait().expect("a chord").at(0.5);
    let off = map.shape.expect("a shape").outline.distance(strait);
    assert!(off < 0.005, "{off}");
}
