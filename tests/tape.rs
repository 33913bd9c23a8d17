//! A taped length takes the wheels' common scale out of a map. The robots are out of the box: their
//! wheels are off by up to one per cent, which no closed lap shows.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

mod common;
#[path = "common/stepped.rs"]
mod stepped;

use periplus::geometry::Point;
use periplus::mapping::map::{Phase, RoomMap};
use periplus::mapping::settings::Settings;
use periplus::mapping::tape::Tape;
use periplus::robot::Intent;
use periplus::runtime::simulated::SimulatedRun;
use periplus::simulator::{NoiseProfile, World};
use std::io::Sink;
use stepped::step_phase;

const ROOM: &str = include_str!("../sims/rectangle.toml");

/// The map of a room of 5 x 4 m once its boundary is planned for.
fn mapped(seed: u64, tape: Option<Tape>) -> RoomMap {
    let world = World::from_toml(ROOM, "rectangle", 0.1).expect("a world");
    let settings = Settings { seed, tape, ..Settings::new(world.start) };
    common::mapped(&world, settings, NoiseProfile::Raw, Phase::Plan)
}

/// Mapped over true size: the root of the ratio of the areas.
fn size(map: &RoomMap) -> f64 {
    let shape = map.shape.as_ref().expect("a shape");
    (shape.outline.area() / 20.0).sqrt()
}

fn held(from: (f64, f64), to: (f64, f64), length: f64) -> Tape {
    Tape { from: Point::new(from.0, from.1), to: Point::new(to.0, to.1), length }
}

#[test]
fn the_map_is_as_large_as_the_tape_says() {
    let (mut raw, mut taped) = (0.0_f64, 0.0_f64);
    for seed in 5..=8 {
        let off = |map: &RoomMap| (size(map) - 1.0).powi(2) / 4.0;
        raw += off(&mapped(seed, None));
        let map = mapped(seed, Some(held((0.0, 0.0), (5.0, 0.0), 5.0)));
        let figures = map.taped.expect("a tape that fits");
        assert!((figures.taped / figures.mapped - figures.stretch).abs() < 2e-3, "{figures:?}");
        taped += off(&map);
    }
    let (raw, taped) = (raw.sqrt(), taped.sqrt());
    assert!(raw > 0.002, "these robots are out of the box: {raw}");
    assert!(taped < 0.5 * raw, "{taped} of {raw}");
}

#[test]
fn a_tape_held_elsewhere_changes_nothing() {
    let (plain, odd) = (mapped(1, None), mapped(1, Some(held((0.0, 0.0), (5.0, 0.0), 3.0))));
    assert_eq!(odd.taped, None);
    assert_eq!(plain.shape, odd.shape);
}

/// The last one counts, and whoever reads the log is told that the one before does not.
#[test]
fn another_tape_takes_the_place_of_the_first() {
    let world = World::from_toml(ROOM, "rectangle", 0.1).expect("a world");
    let settings = Settings { seed: 1, ..Settings::new(world.start) };
    let mut run = common::begun(&world, settings, NoiseProfile::Raw);
    let tell = |run: &mut SimulatedRun<Sink>, (from, to, length)| {
        let Tape { from, to, length } = held(from, to, length);
        run.intent(Intent::SetTape { from, to, length });
    };
    tell(&mut run, ((0.0, 0.0), (5.0, 0.0), 5.01));
    tell(&mut run, ((0.0, 0.0), (0.0, 4.0), 4.0));
    let told: Vec<String> =
        run.session().events().iter().map(|event| event.kind.to_string()).collect();
    let replaced = "the taped length of 5.010 m counts no longer: another one is given";
    assert_eq!(told.iter().filter(|text| *text == replaced).count(), 1, "{told:?}");
    assert_eq!(run.snapshot().settings.tape.map(|tape| tape.length), Some(4.0));
}

/// One that cannot be of the same wall leaves the map, and what is said of it, as the one before made them.
#[test]
fn a_tape_that_is_refused_takes_the_place_of_none() {
    let world = World::from_toml(ROOM, "rectangle", 0.1).expect("a world");
    let settings = Settings { seed: 1, ..Settings::new(world.start) };
    let mut run = common::begun(&world, settings, NoiseProfile::Raw);
    (0..3).for_each(|_| step_phase(&mut run));
    let tell = |run: &mut SimulatedRun<Sink>, taped| {
        let Tape { from, to, length } = held((0.0, 0.0), (5.0, 0.0), taped);
        run.intent(Intent::SetTape { from, to, length });
    };
    tell(&mut run, 5.0);
    let first = run.snapshot().map;
    assert!(first.taped.is_some());
    tell(&mut run, 6.0);
    let map = run.snapshot().map;
    assert_eq!((map.taped, map.untaped, &map.shape), (first.taped, None, &first.shape));
    assert_eq!(run.snapshot().settings.tape.map(|tape| tape.length), Some(5.0));
    let told: Vec<String> =
        run.session().events().iter().map(|event| event.kind.to_string()).collect();
    assert!(!told.iter().any(|text| text.contains("counts no longer")), "{told:?}");
    assert!(told.iter().any(|text| text.contains("taped length not used")), "{told:?}");
}

#[test]
fn a_tape_may_be_told_at_any_time_before_the_plan_is_driven() {
    let world = World::from_toml(ROOM, "rectangle", 0.1).expect("a world");
    let Tape { from, to, length } = held((0.0, 0.0), (5.0, 0.0), 5.0);
    let tell = Intent::SetTape { from, to, length };
    let sizes: Vec<f64> = [0, 3]
        .into_iter()
        .map(|told_after| {
            let settings = Settings { seed: 1, ..Settings::new(world.start) };
            let mut run = common::begun(&world, settings, NoiseProfile::Raw);
            for phase in 0..3 {
                if phase == told_after {
                    run.intent(tell);
                }
                step_phase(&mut run);
            }
            if told_after == 3 {
                run.intent(tell);
            }
            let map = run.snapshot().map;
            assert!(map.taped.is_some(), "told after {told_after} phases, and not laid");
            size(&map)
        })
        .collect();
    for size in &sizes {
        assert!((size - 1.0).abs() < 0.002, "{sizes:?}");
    }
}
