//! A robot that drives to and fro between two walls, and what it read of it.

use super::*;
use crate::geometry::Ring;
use crate::mapping::map::{ContactKind, Phase, Shape, ShapeClass, Spun};
use crate::mapping::shape;

/// Between rests the robot drives a metre in five seconds, or turns.
const LEG: f64 = 1.0;
/// The switch ahead and the one on the left.
const BEAMS: [f64; 2] = [0.0, angle::FRAC_PI_2];
const REACH: f64 = 0.16;
/// Travel of a wheel for a tick, and what one of them turns the robot, radians.
const TICK: f64 = 0.0005;
const TURN_OF_A_TICK: f64 = 0.003;

/// What a robot read whose gyro drifts by `drift` (radians per second) and whose wheels turn it by `uneven`
/// radians a metre more than they tell: ten times round a square of a metre that lies 0.16 m within the
/// walls of a room, touching the wall ahead at the end of each side, and the one on its left there.
struct Driven {
    network: Network,
    path: Vec<PathPoint>,
    contacts: Vec<Contact>,
    truth: Vec<Pose>,
}

fn driven(drift: f64, uneven: f64) -> Driven {
    driven_and_pushed(drift, uneven, Vector::zeros())
}

/// The same, but half way somebody pushes the robot, and it has found its place since.
fn driven_and_pushed(drift: f64, uneven: f64, push: Vector) -> Driven {
    let start = Pose::new(0.16, 0.16, 0.0);
    let (mut real, mut believed) = (start, start);
    let mut read = Reading::default();
    let mut driven = Driven {
        network: Network::new(start),
        path: Vec::new(),
        contacts: Vec::new(),
        truth: vec![start],
    };
    let point = |pose: Pose, time_us: u64| PathPoint {
        pose,
        time_us,
        rested_us: 0,
        spun: Spun::default(),
        phase: Phase::Boundary,
        carried: false,
    };
    driven.network.rest(Rest { reading: read, held_up: false });
    driven.path.push(point(start, 0));
    for motion in 0..80_u64 {
        let (ahead, turn, seconds) =
            if motion % 2 == 0 { (LEG, 0.0, 5.0) } else { (0.0, angle::FRAC_PI_2, 1.0) };
        // The gyro holds the heading: what it drifts the robot turns the other way.
        let turned = turn - drift * seconds;
        let middle = real.turned(turned / 2.0);
        real = Pose { heading: real.heading + turned, ..middle.advanced(ahead) };
        let side = believed.turned(turn / 2.0);
        believed = Pose { heading: believed.heading + turn, ..side.advanced(ahead) };
        read.time_us += (seconds * 1e6) as u64;
        read.active_us = read.time_us;
        read.ahead += ahead;
        read.turned += turn;
        read.against += turned + uneven * ahead;
        if motion == 40 {
            real.position += push;
            believed.position += push;
        }
        driven.path.push(point(believed, read.time_us));
        for (sensor, beam) in BEAMS.iter().enumerate() {
            // The wall that the beam meets: the nearer one of the two in its direction.
            let towards = angle::unit(real.heading + beam);
            let off = |at: f64, along: f64| {
                let wall = if along > 0.0 { LEG + 2.0 * REACH } else { 0.0 };
                if along.abs() < 0.5 { f64::INFINITY } else { (wall - at) / along }
            };
            let far = off(real.position.x, towards.x).min(off(real.position.y, towards.y));
            if far > 2.0 * REACH {
                continue;
            }
            let arm = angle::unit(*beam) * far;
            driven.network.glance(Glance { reading: read, sensor, arm, sure: true });
            driven.contacts.push(Contact {
                point: believed.position + believed.rotate(arm),
                from: believed.position,
                sensor: Some(sensor),
                kind: ContactKind::Range,
                time: read.time_us as f64 * 1e-6,
            });
        }
        driven.network.rest(Rest { reading: read, held_up: false });
        driven.truth.push(real);
    }
    driven
}

fn adjusted(driven: &Driven) -> Option<Adjusted> {
    adjusted_with(driven, Vec::new())
}

/// The same where the map has these `contacts`.
fn adjusted_with(driven: &Driven, contacts: Vec<Contact>) -> Option<Adjusted> {
    adjusted_within(driven, contacts, CLOSE)
}

/// The same where what is seen of a surface may seem to be off it by `within` metres.
fn adjusted_within(driven: &Driven, contacts: Vec<Contact>, within: f64) -> Option<Adjusted> {
    let size = LEG + 2.0 * REACH;
    let corners = [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)];
    let outline = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
    let shape: Shape = shape::identify(outline, &driven.contacts);
    assert_eq!(shape.class, ShapeClass::Convex);
    let map = RoomMap { shape: Some(shape), contacts, ..RoomMap::default() };
    driven.network.adjust(&Given {
        path: &driven.path,
        map: &map,
        beams: &BEAMS,
        stretch: 1.0,
        tick: TICK,
        resolution: TURN_OF_A_TICK,
        grip: (1e-7, 1.0),
        bias: 0.0,
        held: (0.0, 0.0),
        within,
        datum: false,
    })
}

/// How far the poses are from the truth at most, metres and radians.
fn worst(driven: &Driven, adjusted: &Adjusted) -> (f64, f64) {
    let off = |(at, real): (&Moved, &Pose)| {
        let turn = angle::wrap(at.after.heading - real.heading).abs();
        ((at.after.position - real.position).norm(), turn)
    };
    let all = adjusted.rests.iter().zip(&driven.truth).map(off);
    all.fold((0.0, 0.0), |(far, turned), (d, t)| (f64::max(far, d), f64::max(turned, t)))
}

#[test]
fn what_the_gyro_drifted_is_taken_out_of_the_first_metre_too() {
    let driven = driven(1.0e-4, 0.02);
    let adjusted = adjusted(&driven).expect("walls enough");
    assert_eq!(adjusted.used, driven.contacts.len());
    let believed = (driven.path[80].pose.heading - driven.truth[80].heading).abs();
    assert!(believed > 0.02, "it was off by {believed}");
    let (far, turned) = worst(&driven, &adjusted);
    assert!(far < 0.003 && turned < 0.002, "{far} m and {turned} rad off");
    assert!(adjusted.moved() > 0.005, "{}", adjusted.moved());
}

#[test]
fn read_on_the_way_too_the_wheels_tell_turns_better_than_to_a_tick() {
    // The wheels are rounded to ticks, each of which turns it by 3 mrad.
    let off_by = |on_the_way: bool| {
        let mut driven = driven(0.0, 0.013);
        let ticks = |share: f64| (share / TURN_OF_A_TICK).floor() * TURN_OF_A_TICK;
        let rests = driven.network.rests.clone();
        for pair in rests.windows(2) {
            let (from, to) = (pair[0].reading, pair[1].reading);
            let motion = to.since(&from);
            for k in 1..50 {
                let share = f64::from(k) / 49.75;
                let part = |whole_us: u64| (whole_us as f64 * share) as u64;
                // 40.2 ticks from one to the next.
                let ahead = (motion.ahead * share / TICK).floor() * TICK;
                let reading = Reading {
                    time_us: from.time_us + part(to.time_us - from.time_us),
                    active_us: from.active_us + part(to.active_us - from.active_us),
                    ahead: from.ahead + ahead,
                    against: ticks(from.against + motion.against * share),
                    turned: from.turned + motion.turned * share,
                };
                if on_the_way && motion.ahead > 0.0 {
                    driven.network.passed.push(reading);
                }
            }
        }
        for rest in &mut driven.network.rests {
            rest.reading.against = ticks(rest.reading.against);
        }
        let adjusted = adjusted(&driven).expect("walls enough");
        let turned =
            |(at, real): (&Moved, &Pose)| angle::wrap(at.after.heading - real.heading).powi(2);
        let sum: f64 = adjusted.rests.iter().zip(&driven.truth).map(turned).sum();
        (sum / driven.truth.len() as f64).sqrt()
    };
    let (ends, way) = (off_by(false), off_by(true));
    assert!(way < 0.8 * ends, "{way} rad off, and {ends} by the ends of the drives alone");
}

#[test]
fn contacts_and_trajectory_follow() {
    let driven = driven(1.0e-4, 0.0);
    let adjusted = adjusted(&driven).expect("walls enough");
    let size = LEG + 2.0 * REACH;
    for contact in &driven.contacts {
        let at = adjusted.contact(contact).point;
        let off = [at.x, at.y, size - at.x, size - at.y].map(f64::abs);
        let off = off.into_iter().fold(f64::INFINITY, f64::min);
        assert!(off < 0.002, "{at} is {off} m off every wall");
    }
    for (point, real) in driven.path.iter().zip(&driven.truth) {
        let pose = adjusted.pose(point.pose, point.time_us);
        assert!((pose.position - real.position).norm() < 0.003, "at {}", point.time_us);
    }
}

#[test]
fn where_the_robot_was_believed_elsewhere_its_contacts_are_taken_from_farther_off() {
    let mut driven = driven(1.0e-4, 0.0);
    // For half of the way it was believed to be 8 cm from where it was.
    for point in &mut driven.path[30..70] {
        point.pose.position += Vector::new(0.06, 0.06);
    }
    let close = adjusted(&driven).expect("walls enough");
    assert!(close.used * 4 < driven.contacts.len() * 3, "{}", close.used);
    let coarse = adjusted_within(&driven, Vec::new(), WITHIN[0]).expect("walls enough");
    assert_eq!(coarse.used, driven.contacts.len());
    let (far, turned) = worst(&driven, &coarse);
    assert!(far < 0.01 && turned < 0.004, "{far} m and {turned} rad off");
}

#[test]
fn nothing_is_adjusted_where_it_does_not_hang_together() {
    let mut carried = driven(1.0e-4, 0.0);
    carried.network.break_off();
    assert!(adjusted(&carried).is_none());
    // A room in which nothing was seen.
    let mut blind = driven(1.0e-4, 0.0);
    blind.network.glances.clear();
    assert!(adjusted(&blind).is_none());
}

#[test]
fn nothing_is_adjusted_where_the_robot_was_pushed_aside() {
    let mut pushed = driven(0.0, 0.0);
    let contacts = pushed.contacts.clone();
    assert!(adjusted_with(&pushed, contacts.clone()).is_some());
    // A quarter of the time it is 8 cm farther from the walls than its wheels know.
    let since = pushed.network.rests[60].reading.time_us;
    for glance in &mut pushed.network.glances {
        if glance.reading.time_us > since {
            glance.arm *= 1.5;
        }
    }
    assert!(adjusted_with(&pushed, contacts).is_none());
}

#[test]
fn nothing_is_adjusted_across_a_push_that_neither_wheels_nor_gyro_told() {
    assert!(adjusted(&driven_and_pushed(0.0, 0.0, Vector::zeros())).is_some());
    for push in [Vector::new(0.12, 0.0), Vector::new(0.0, 0.12)] {
        assert!(adjusted(&driven_and_pushed(0.0, 0.0, push)).is_none(), "{push:?}");
    }
}

#[test]
fn what_was_seen_on_a_motion_that_has_not_ended_hinders_nothing() {
    let mut driven = driven(1.0e-4, 0.0);
    let last = driven.network.glances[0];
    let mut reading = driven.network.rests[80].reading;
    reading.time_us += 10;
    driven.network.glance(Glance { reading, ..last });
    assert!(adjusted(&driven).is_some());
}
