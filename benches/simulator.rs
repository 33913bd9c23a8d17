//! Steps of the simulated robot: a 10 x 10 m room with 42 wall segments in all, 20 ms a step, a
//! robot that drives and turns in it; beside it the same beams and one nearest point by parry.
//! `cargo bench --bench simulator`. One item is one step.

use divan::counter::ItemsCount;
use parry2d::math::Vector as ParryVector;
use parry2d::query::{PointQuery, Ray, RayCast};
use parry2d::shape::Polyline;
use periplus::firmware::{Firmware, STEP};
use periplus::geometry::{Pose, angle};
use periplus::link::SimulatedLink;
use periplus::robot::{Chassis, Command, CommandId, Guard, Hardware, Motion};
use periplus::simulator::{Body, NoiseProfile, World};
use std::fmt::Write;

/// Steps in one sample.
const STEPS: u32 = 20_000;
/// Range of the beams that parry casts, metres from the centre.
const BEAM: f64 = 0.3;

fn main() {
    divan::main();
}

/// Four walls, eight boxes and a hexagon: 42 segments.
fn world() -> World {
    let mut text = String::from(
        "start = { x = 5.0, y = 0.7, heading = 20 }\n[boundary]\nvertices = [[0, 0], [10, 0], [10, 10], [0, 10]]\n",
    );
    for k in 0..8 {
        let (x, y) = (1.2 + 2.2 * f64::from(k % 4), 2.0 + 5.0 * f64::from(k / 4));
        let _ = writeln!(
            text,
            "[[objects]]\nvertices = [[{x}, {y}], [{}, {y}], [{}, {}], [{x}, {}]]",
            x + 0.8,
            x + 0.8,
            y + 0.9,
            y + 0.9
        );
    }
    let corner = |k: i32| angle::unit(f64::from(k) * angle::TAU / 6.0) * 0.7;
    let corners: Vec<String> =
        (0..6).map(|k| format!("[{}, {}]", 5.0 + corner(k).x, 5.0 + corner(k).y)).collect();
    let _ = writeln!(text, "[[objects]]\nvertices = [{}]", corners.join(", "));
    match World::from_toml(&text, "bench", 0.1) {
        Ok(world) => world,
        Err(error) => panic!("{error}"),
    }
}

/// Sets the drive for one step: arcs and straights, and away from what the bumper felt.
fn steer(body: &mut Body, step: u32) {
    let (speed, rate) = match (step / 50) % 4 {
        0 | 2 => (0.2, 0.0),
        1 => (0.2, 0.8),
        _ => (0.2, -0.7),
    };
    if body.bumper() {
        body.drive(0.0, 2.0);
    } else if step.is_multiple_of(10) {
        body.drive(speed, rate);
    }
}

#[divan::bench(args = [NoiseProfile::None, NoiseProfile::Calibrated])]
fn body_step(bencher: divan::Bencher<'_, '_>, noise: NoiseProfile) {
    let mut body = Body::new(&world(), &Chassis::default(), noise, 1);
    let mut step = 0;
    bencher.counter(ItemsCount::new(STEPS)).bench_local(|| {
        for _ in 0..STEPS {
            steer(&mut body, step);
            body.step(STEP);
            while body.take_edge().is_some() {}
            step += 1;
        }
        body.true_pose()
    });
}

/// Along a wall, where every beam has something to look at.
#[divan::bench(args = [NoiseProfile::None, NoiseProfile::Calibrated])]
fn body_step_at_a_wall(bencher: divan::Bencher<'_, '_>, noise: NoiseProfile) {
    let world = match world().with_start(Pose::new(0.3, 0.15, 0.0), "start", 0.1) {
        Ok(world) => world,
        Err(error) => panic!("{error}"),
    };
    let mut body = Body::new(&world, &Chassis::default(), noise, 1);
    let mut step = 0;
    bencher.counter(ItemsCount::new(STEPS)).bench_local(|| {
        for _ in 0..STEPS {
            let speed = if (step / 2000) % 2 == 0 { 0.2 } else { -0.2 };
            body.drive(speed, 0.0);
            body.step(STEP);
            while body.take_edge().is_some() {}
            step += 1;
        }
        body.true_pose()
    });
}

/// The motions of a robot that has no plan: a leg, a turn, and so on.
fn wander(number: u32) -> Command {
    let motion = if number.is_multiple_of(2) {
        Motion::Move { distance: 1.5, speed: 0.2 }
    } else {
        Motion::Turn { angle: 0.9 + f64::from(number % 7) * 0.3, rate: 2.0 }
    };
    Command { id: CommandId(number + 1), motion, guard: Guard::default(), time_limit: 20.0 }
}

#[divan::bench]
fn firmware_and_body(bencher: divan::Bencher<'_, '_>) {
    let chassis = Chassis::default();
    let mut body = Body::new(&world(), &chassis, NoiseProfile::Calibrated, 1);
    let mut firmware = Firmware::new(&chassis);
    let mut number = 0;
    bencher.counter(ItemsCount::new(STEPS)).bench_local(|| {
        for _ in 0..STEPS {
            if !firmware.is_moving() {
                firmware.command(wander(number));
                number += 1;
            }
            firmware.heartbeat();
            firmware.step(&mut body, |telemetry, _| {
                divan::black_box(telemetry);
            });
            body.step(STEP);
        }
        body.true_pose()
    });
}

#[divan::bench]
fn whole_link(bencher: divan::Bencher<'_, '_>) {
    let mut link = SimulatedLink::new(&world(), &Chassis::default(), NoiseProfile::Calibrated, 1);
    let mut said = Vec::new();
    let mut number = 0;
    bencher.counter(ItemsCount::new(STEPS)).bench_local(|| {
        for _ in 0..STEPS {
            if !link.is_moving() {
                link.send(wander(number));
                number += 1;
            }
            said.clear();
            link.advance(&mut said);
        }
        said.len()
    });
}

/// What a step would cost with parry's queries alone, over the poses of the same drive.
#[divan::bench]
fn parry_rays_and_point(bencher: divan::Bencher<'_, '_>) {
    let world = world();
    let mut points = Vec::new();
    let mut ends = Vec::new();
    for ring in std::iter::once(&world.boundary).chain(world.objects.iter().map(|o| &o.ring)) {
        let first = points.len() as u32;
        let corners = ring.to_points(1e-4);
        let count = corners.len() as u32;
        points.extend(corners.iter().map(|p| ParryVector::new(p.x, p.y)));
        ends.extend((0..count).map(|k| [first + k, first + (k + 1) % count]));
    }
    assert_eq!(ends.len(), 42, "the scene has 42 segments");
    let walls = Polyline::new(points, Some(ends));
    let mut body = Body::new(&world, &Chassis::default(), NoiseProfile::None, 1);
    let poses: Vec<Pose> = (0..STEPS)
        .map(|step| {
            steer(&mut body, step);
            body.step(STEP);
            body.true_pose()
        })
        .collect();
    bencher.counter(ItemsCount::new(STEPS)).bench_local(|| {
        let mut met = 0;
        for pose in &poses {
            let here = ParryVector::new(pose.position.x, pose.position.y);
            let ahead = pose.direction();
            for k in 0..8 {
                let beam = angle::unit(f64::from(k) * angle::FRAC_PI_4);
                let (x, y) =
                    (ahead.x * beam.x - ahead.y * beam.y, ahead.y * beam.x + ahead.x * beam.y);
                let ray = Ray::new(here, ParryVector::new(x, y));
                met += usize::from(walls.cast_local_ray(&ray, BEAM, false).is_some());
            }
            met += usize::from(walls.project_local_point(here, false).is_inside);
        }
        met
    });
}
