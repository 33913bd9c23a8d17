//! Both ways of going round an object map the same objects: past it on one side and back on the
//! other, and one full round (paper III.F). One of the objects stands on its corner, too near to the
//! wall to pass behind: it is an object all the same.

mod common;

use periplus::geometry::{Point, Ring, ring};
use periplus::mapping::event::EventKind;
use periplus::mapping::map::Phase;
use periplus::mapping::settings::{Contour, Settings};
use periplus::robot::Intent;
use periplus::runtime::simulated::SimulatedRun;
use periplus::simulator::{NoiseProfile, World};
use std::io::Sink;

const ROOM: &str = r#"
name = "two boxes and a column"
start = { x = 0.5, y = 0.6, heading = 180 }
[boundary]
vertices = [[0, 0], [4.2, 0], [4.2, 3.1], [0, 3.1]]
[[objects]]
name = "box"
vertices = [[1.2, 1.2], [1.7, 1.2], [1.7, 1.6], [1.2, 1.6]]
[[objects]]
name = "column"
circle = { center = [2.9, 1.9], radius = 0.2 }
[[objects]]
name = "box on its corner"
vertices = [[2.4, 0.25], [2.7, 0.55], [2.4, 0.85], [2.1, 0.55]]
"#;

fn centre(ring: &Ring) -> Option<Point> {
    ring::bounds(&ring.to_points(0.001)).map(|(low, high)| nalgebra::center(&low, &high))
}

#[test]
fn both_contours_find_every_object() {
    let world = World::from_toml(ROOM, "room", 0.1).expect("a world");
    for contour in [Contour::TwoPass, Contour::FullLoop] {
        let settings = Settings { contour, ..Settings::new(world.start) };
        let map = common::mapped(&world, settings, NoiseProfile::None, Phase::Objects);
        assert_eq!(map.objects.len(), world.objects.len(), "{contour:?}");
        for object in &world.objects {
            let (at, area) = (centre(&object.ring), object.ring.area());
            let off = |ring: &Ring| centre(ring).zip(at).map(|(a, b)| (a - b).norm());
            let found = map.objects.iter().find(|o| off(&o.outline).is_some_and(|off| off < 0.02));
            let found = found.unwrap_or_else(|| panic!("{contour:?}: no {}", object.name));
            assert!(found.closed, "{contour:?}: {} is open", object.name);
            let share = found.outline.area() / area;
            assert!((0.93..1.07).contains(&share), "{contour:?}: {} is {share}", object.name);
        }
    }
}

/// The whole run of a robot that passes things on both sides, with a plan for `alpha`.
fn two_pass(world: &World, alpha: f64) -> SimulatedRun<Sink> {
    let settings = Settings { alpha, contour: Contour::TwoPass, ..Settings::new(world.start) };
    let mut run = common::begun(world, settings, NoiseProfile::None);
    run.intent(Intent::Run);
    while run.is_under_way() {
        run.advance();
    }
    run
}

#[test]
fn past_one_side_on_to_the_end_of_the_line_and_back_past_the_other() {
    // Before, a robot that was past an object went back to where its line begins, through what was not on the map
    // yet: it met it from behind, and now and then took the same side for the other one.
    let world = World::from_toml(ROOM, "room", 0.1).expect("a world");
    // Plans of several kinds, which pass different things.
    let runs = [0.25, 0.35].map(|alpha| two_pass(&world, alpha));
    let halves: Vec<usize> = runs.iter().map(halves_of).collect();
    assert!(
        halves.iter().all(|count| *count > 0) && halves.iter().sum::<usize>() >= 2,
        "{halves:?}"
    );
}

/// How many things were passed on one side in this run: each time what is told next is as it has to be.
fn halves_of(run: &SimulatedRun<Sink>) -> usize {
    let told: Vec<EventKind> =
        run.session().events().iter().map(|event| event.kind.clone()).collect();
    // What is met beyond it on the same line is another story.
    let of_the_line = |kind: &&EventKind, thing: u32| {
        use EventKind::{LineBegan, LineDriven, LineEnded, ObjectClosed, ObjectFound};
        match kind {
            LineBegan { .. } | LineDriven { .. } | LineEnded { .. } => true,
            ObjectFound { id, .. } | ObjectClosed { id } => *id == thing,
            _ => false,
        }
    };
    let mut halves = 0;
    for (k, kind) in told.iter().enumerate() {
        let EventKind::ObjectHalf { id: thing } = *kind else { continue };
        halves += 1;
        let next: Vec<&EventKind> =
            told[k..].iter().filter(|kind| of_the_line(kind, thing)).take(4).collect();
        let [EventKind::LineDriven { id }, EventKind::LineBegan { id: again, .. }, found, closed] =
            next[..]
        else {
            panic!("{next:?}")
        };
        assert_eq!(id, again);
        assert!(matches!(found, EventKind::ObjectFound { .. }), "{next:?}");
        assert!(matches!(closed, EventKind::ObjectClosed { .. }), "{next:?}");
    }
    halves
}

const SMALL: &str = r#"
name = "two small boxes"
start = { x = -0.011, y = -0.735, heading = 264 }
[boundary]
vertices = [[-0.0092, 1.8909], [-0.3033, 1.2094], [-2.5447, 1.2283], [-1.3228, -1.7509], [-0.7002, -1.3706], [0.1512, -2.5314], [1.0789, -1.2538], [1.3581, -1.1472]]
[[objects]]
name = "one box"
vertices = [[-1.5188, -0.2645], [-1.4938, -0.4187], [-1.3395, -0.3937], [-1.3645, -0.2394]]
[[objects]]
name = "another box"
vertices = [[-1.4257, -0.8384], [-1.4007, -0.9926], [-1.2464, -0.9676], [-1.2714, -0.8134]]
"#;

#[test]
fn round_what_is_too_small_to_be_passed_the_robot_goes_once() {
    // A line that meets a small thing beside its middle is crossed again hardly any farther on. Before, the robot
    // went round and round for 30 m each time, and in a room with chairs it never came to an end.
    let world = World::from_toml(SMALL, "room", 0.1).expect("a world");
    let run = two_pass(&world, 0.25);
    let session = run.session();
    assert_eq!(session.mission().map_now().objects.len(), world.objects.len());
    let travel = session.progress()[3].travel;
    assert!(travel < 50.0, "{travel} m among the objects; of the plan there are 23");
}
