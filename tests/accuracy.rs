//! What the map says of its own errors is true: the corners of a room lie within two standard errors
//! of where they are, as often as such errors do.

mod common;

use periplus::geometry::Point;
use periplus::mapping::map::Phase;
use periplus::mapping::settings::Settings;
use periplus::simulator::{NoiseProfile, World};

const ROOM: &str = include_str!("../sims/u_room.toml");

#[test]
fn corners_lie_within_two_standard_errors_nine_times_in_ten() {
    let world = World::from_toml(ROOM, "U", 0.1).expect("a world");
    let truth: Vec<Point> =
        world.boundary.pieces.iter().map(periplus::geometry::Piece::from).collect();
    let (mut within, mut all, mut smallest) = (0, 0, f64::INFINITY);
    for seed in 1..=12 {
        let settings = Settings { seed, ..Settings::new(world.start) };
        let map = common::mapped(&world, settings, NoiseProfile::Calibrated, Phase::Plan);
        let accuracy = map.accuracy.expect("stated with the shape");
        let shape = map.shape.expect("a shape");
        assert_eq!(accuracy.walls.len(), shape.outline.pieces.len());
        assert_eq!(accuracy.corners.len(), shape.outline.pieces.len());
        for corner in &truth {
            let off = |k: &usize| (shape.outline.pieces[*k].from() - corner).norm();
            let near = (0..shape.outline.pieces.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
            let near = near.expect("corners");
            all += 1;
            within += usize::from(off(&near) < 2.0 * accuracy.corners[near]);
            smallest = smallest.min(accuracy.corners[near]);
        }
    }
    assert!(within * 10 >= all * 9, "{within} of {all}");
    // An error that is stated so large that it always holds says nothing.
    assert!(smallest < 0.02, "{smallest}");
}
