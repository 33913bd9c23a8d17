//! The map over a line is the map without one: the same world and seed, embedded and at the end of a
//! line.

use super::*;
use crate::geometry::{Point, Ring};
use crate::journal::Header;
use crate::mapping::map::RoomMap;
use crate::robot::Chassis;
use crate::runtime::simulated::SimulatedRun;
use crate::wire::told;

const SEED: u64 = 2;

fn world() -> World {
    let text = include_str!("../../../../sims/l_room.toml");
    World::from_toml(text, "l_room", 0.1).expect("a world")
}

fn embedded(noise: NoiseProfile) -> RoomMap {
    let world = world();
    let mut settings = Settings::new(world.start);
    settings.seed = SEED;
    settings.chassis = told(&Chassis::default());
    let header = Header {
        settings,
        source: world.name.clone(),
        noise: noise.to_string(),
        until: None,
        robot: None,
    };
    let mut run = SimulatedRun::new(&world, header, noise, None::<Journal<std::io::Sink>>);
    run.intent(Intent::Run);
    while run.is_under_way() {
        run.advance();
    }
    run.snapshot().map
}

fn over(faults: Faults, noise: NoiseProfile) -> RoomMap {
    let mut rig = rig_in(&world(), noise, faults, SEED, (true, None));
    assert!(rig.until(3000.0, |rig| rig.run.ending().is_some()), "it goes on for ever");
    rig.run.session().expect("a session").mission().map().clone()
}

/// The outlines of a map as points.
fn drawn(map: &RoomMap) -> (Vec<Ring>, Vec<Point>) {
    let shape = map.shape.as_ref().expect("a shape");
    let mut rings = vec![shape.outline.clone()];
    rings.extend(map.objects.iter().map(|object| object.outline.clone()));
    let points = rings.iter().flat_map(|ring| ring.to_points(1e-4)).collect();
    (rings, points)
}

/// Largest distance of an outline of either map to those of the other, metres.
fn apart(a: &RoomMap, b: &RoomMap) -> f64 {
    let (a, b) = (drawn(a), drawn(b));
    let off = |points: &[Point], rings: &[Ring]| {
        let nearest =
            |p: &Point| rings.iter().map(|ring| ring.distance(*p)).fold(f64::INFINITY, f64::min);
        points.iter().map(nearest).fold(0.0, f64::max)
    };
    off(&a.1, &b.0).max(off(&b.1, &a.0))
}

/// The line of a simulated robot on a pseudo-terminal or a socket answers within the time that the body
/// is given to come to rest: nothing then tells the run on it from the one without.
#[test]
fn it_is_the_same_map_however_late_the_line_with_and_without_noise() {
    for noise in [NoiseProfile::None, NoiseProfile::Calibrated] {
        let here = embedded(noise);
        for delay in [0.0, 0.02] {
            let there = over(Faults { delay, ..Faults::default() }, noise);
            let apart = apart(&here, &there);
            assert!(apart < 1e-9, "{noise}, up to {delay} s late: {apart} m");
        }
    }
}

/// A line that loses a twentieth makes the robot wait here and there, and the gyro drifts meanwhile.
#[test]
fn over_a_bad_line_it_is_as_good() {
    let here = embedded(NoiseProfile::None);
    let there = over(Faults { drop: 0.05, ..Faults::default() }, NoiseProfile::None);
    let apart = apart(&here, &there);
    assert!(apart < 15e-3, "{apart} m");
}
