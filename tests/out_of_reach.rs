//! What the robot cannot get to is told with the place and the width of the gap, and rooms without such
//! gaps are told to have none.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

mod common;

use periplus::geometry::Point;
use periplus::mapping::map::Phase;
use periplus::mapping::settings::Settings;
use periplus::mapping::unreached::Unreached;
use periplus::simulator::{NoiseProfile, World};

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
