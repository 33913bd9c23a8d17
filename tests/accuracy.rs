//! What the map says of its own errors is true: the corners of a room lie within two standard errors
//! of where they are, as often as such errors do.

use periplus::geometry::Point;
use periplus::journal::Header;
use periplus::mapping::map::{Phase, RoomMap};
use periplus::mapping::settings::Settings;
use periplus::robot::Intent;
use periplus::runtime::simulated::SimulatedRun;
use periplus::simulator::{NoiseProfile, World};
use std::io::Sink;

const ROOM: &str = include_str!("../sims/u_room.toml");

fn mapped(world: &World, seed: u64) -> RoomMap {
    let header = Header {
        settings: Settings { seed, ..Settings::new(world.start) },
        source: world.name.clone(),
        noise: String::new(),
        until: None,
        robot: None,
    };
    let mut run: SimulatedRun<Sink> =
        SimulatedRun::new(world, header, NoiseProfile::Calibrated, None);
    run.intent(Intent::Run);
    while run.is_under_way() && run.snapshot().phase != Phase::Objects {
        run.advance();
    }
    run.snapshot().map
}

#[test]
fn corners_lie_within_two_standard_errors_nine_times_in_ten() {
    let world = World::from_toml(ROOM, "U", 0.1).expect("a world");
    let truth: Vec<Point> =
        world.boundary.pieces.iter().map(periplus::geometry::Piece::from).collect();
    let (mut within, mut all, mut smallest) = (0, 0, f64::INFINITY);
    for seed in 1..=12 {
        let map = mapped(&world, seed);
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
