//! What driving, closing, touching and weighing do to a small survey, worked out by hand.

use super::*;
use crate::mapping::map::Spun;

/// Straight on for `metres` in steps of 0.05 m at 0.2 m/s: the gyro errs by `gyro` and the wheels by
/// `wheels` radians a metre; the believed pose follows the gyro.
fn drive(survey: &mut Survey, from: Pose, metres: f64, gyro: f64, wheels: f64) -> Pose {
    let steps = (metres / 0.05).round() as u32;
    let (mut pose, mut spun) = (from, Spun::default());
    for k in 0..steps {
        let mut next = spun;
        next.gyro += gyro * 0.05;
        next.wheels += wheels * 0.05;
        next.wound += (gyro * 0.05).abs();
        next.strides += 0.05 * 0.05 * (2.0 * f64::from(k) + 1.0);
        let to = Pose {
            position: pose.position + angle::unit(pose.heading) * 0.05,
            heading: pose.heading + gyro * 0.05,
        };
        survey.predict(&Step { from: pose, to, seconds: 0.25, spun: (spun, next) });
        (pose, spun) = (to, next);
    }
    pose
}

/// A quarter turn to the left on the spot.
fn turn(survey: &mut Survey, from: Pose) -> Pose {
    let to = Pose { heading: from.heading + angle::PI / 2.0, ..from };
    let wound = angle::PI / 2.0;
    let squares = wound * wound;
    let spun = (Spun::default(), Spun { gyro: wound, wheels: wound, wound, squares, strides: 0.0 });
    survey.predict(&Step { from, to, seconds: 0.8, spun });
    to
}

const TICK: f64 = 0.0005 / 0.16;

#[test]
fn driving_makes_the_pose_less_certain_and_a_touch_more() {
    let mut survey = Survey::new(TICK);
    let origin = survey.mark(Point::origin(), 0);
    let pose = drive(&mut survey, Pose::new(0.0, 0.0, 0.0), 4.0, 0.0, 0.0);
    let there = survey.mark(pose.position, 1);
    let before = survey.relative(&origin, &there);
    let sd = |across: &Matrix3<f64>, k: usize| across[(k, k)].sqrt();
    // One drive in a row is off by a share of it; to the side only the heading puts it off.
    assert!(sd(&before, 0) > 0.018 && sd(&before, 1) < 0.012, "{before}");
    // A wall across the way, seen 20 mm nearer than it was mapped from the origin.
    let contact = pose.position + Vector::new(0.16, 0.0);
    let at = contact + Vector::new(0.02, 0.0);
    let surface =
        Surface { at, normal: Vector::new(-1.0, 0.0), tie: origin, sd: 0.002, within: 0.15 };
    let fixed = survey.touch(pose, contact, &surface).expect("near enough");
    assert!((fixed.position.x - pose.position.x - 0.02).abs() < 0.005, "{fixed:?}");
    assert!((fixed.position.y - pose.position.y).abs() < 0.002, "the way along the wall is open");
    // Along the wall it is as uncertain as before, across it much less.
    let here = survey.mark(fixed.position, 1);
    let across = survey.relative(&origin, &here);
    assert!(sd(&across, 0) < 0.004 && sd(&across, 1) > 0.95 * sd(&before, 1), "{across}");
}

#[test]
fn a_contact_that_cannot_be_of_the_surface_is_refused() {
    let mut survey = Survey::new(TICK);
    let origin = survey.mark(Point::origin(), 0);
    let pose = drive(&mut survey, Pose::new(0.0, 0.0, 0.0), 0.5, 0.0, 0.0);
    let contact = pose.position + Vector::new(0.16, 0.0);
    let at = contact + Vector::new(0.12, 0.0);
    let surface =
        Surface { at, normal: Vector::new(-1.0, 0.0), tie: origin, sd: 0.002, within: 0.15 };
    let mut before = survey.clone();
    assert_eq!(survey.touch(pose, contact, &surface), None);
    survey.covariance.settle();
    before.covariance.settle();
    assert_eq!(survey, before);
}

/// Four walls of 3 m, all with the gyro's drift of `gyro` radians a metre.
fn lap(gyro: f64) -> (Survey, Tie, Tie, Pose) {
    let mut survey = Survey::new(TICK);
    let mut pose = Pose::new(0.0, 0.0, 0.0);
    let first = survey.mark(pose.position, 0);
    for side in 1..=4 {
        pose = drive(&mut survey, pose, 3.0, gyro, 0.0);
        pose = turn(&mut survey, pose);
        survey.mark(pose.position, side * 15_000_000);
    }
    let last = survey.mark(pose.position, 61_000_000);
    (survey, first, last, pose)
}

#[test]
fn a_closed_lap_ends_where_it_began_and_is_spread_between() {
    let (mut survey, first, last, end) = lap(0.003);
    let off = end.position.coords.norm();
    assert!(off > 0.03, "{off}");
    // Measured well: the end lies on the beginning.
    let normal = Matrix3::from_diagonal(&Vector3::new(1e6, 1e6, 1e6));
    let misclosure =
        Vector3::new(end.position.x, end.position.y, angle::wrap(end.heading - 2.0 * angle::PI));
    survey.close(&first, &last, &normal, &(normal * misclosure));
    let closed = survey.place(end, &last);
    assert!(closed.position.coords.norm() < 0.003, "{closed:?}");
    // The far corner should be at (3, 3); it is now nearer to it than the drift left it.
    let middle = survey.tie(30_000_000, survey.knots());
    let raw = survey.knots[middle.first].at;
    let adjusted = raw + survey.displacement(raw, &middle);
    let corner = Point::new(3.0, 3.0);
    assert!((adjusted - corner).norm() < 0.6 * (raw - corner).norm(), "{raw} {adjusted}");
    // What was learnt: the gyro drifts.
    assert!(survey.take_bias() < -1e-4);
}

#[test]
fn on_long_legs_the_wheels_are_believed_once_they_agree_with_each_other() {
    // A long rest has told the gyro's drift. It wanders one way and the other; the wheels run true.
    let mut survey = Survey::new(TICK);
    survey.rest(1e5, 0.0);
    let mut pose = Pose::new(0.0, 0.0, 0.0);
    for leg in 0..24 {
        let wander = if leg % 2 == 0 { 0.003 } else { -0.003 };
        let end = drive(&mut survey, pose, 4.0, wander, 0.0);
        pose = turn(&mut survey, end);
    }
    let from = survey.take_pose(pose);
    let begin = survey.mark(from.position, 1);
    let end = drive(&mut survey, from, 4.0, 0.003, 0.0);
    let corner = turn(&mut survey, end);
    // Of the 12 mrad between its ends, the gyro's own, most are taken out.
    let (first, last) = (survey.place(from, &begin), survey.take_pose(corner));
    let turned = angle::wrap(last.heading - first.heading - angle::PI / 2.0);
    assert!(turned.abs() < 0.0045, "{turned}");
}

#[test]
fn a_pose_is_loose_beside_what_was_mapped_long_ago_though_not_beside_what_it_has_just_left() {
    let mut survey = Survey::new(TICK);
    let wall = survey.mark(Point::origin(), 0);
    let pose = drive(&mut survey, Pose::new(0.0, 0.0, 0.0), 8.0, 0.0, 0.0);
    let thing = survey.mark(pose.position, 1);
    let (far, near) = (Point::new(0.0, 0.2), pose.position);
    assert!(survey.looseness(near, &thing) < 1e-6);
    let loose = survey.looseness(far, &wall);
    // Half a percent of one drive of 8 m, at least.
    assert!(loose > 0.035, "{loose}");
    // It is the same asked before the knots were brought up to date, and after.
    let spread = survey.spread_beside(far, &wall);
    survey.covariance.settle();
    assert!((survey.spread_beside(far, &wall) - spread).norm() < 1e-12);
}

#[test]
fn a_touch_counts_what_the_wheels_have_put_right_before_it() {
    let mut survey = Survey::new(TICK);
    survey.rest(1e5, 0.0);
    let begin = survey.mark(Point::origin(), 0);
    let mut pose = Pose::new(0.0, 0.0, 0.0);
    for leg in 0..24 {
        let wander = if leg % 2 == 0 || leg > 16 { 0.003 } else { -0.003 };
        let end = drive(&mut survey, pose, 4.0, wander, 0.0);
        pose = turn(&mut survey, end);
    }
    // A wall, just where it is seen from the pose that is not put right yet.
    let put_right = survey.clone().take_pose(pose).position - pose.position;
    let normal = put_right.normalize();
    assert!(put_right.norm() > 0.005, "{put_right}");
    let contact = pose.position + normal * 0.16;
    let surface = Surface { at: contact, normal, tie: begin, sd: 0.002, within: 0.15 };
    let fixed = survey.touch(pose, contact, &surface).expect("near enough");
    // The contact lies on the wall, wherever that is believed by now.
    let seen = fixed.to_world(pose.to_local(contact));
    let off = normal.dot(&(seen - contact - survey.displacement(contact, &begin)));
    assert!(off.abs() < 0.002, "{off}");
}

#[test]
fn a_gyro_that_never_disagrees_with_the_wheels_is_better_than_its_datasheet() {
    // Steps of 0.25 s, each off to one side or the other by the same: a random walk.
    let walk = |wander: f64| {
        let (mut survey, mut pose) = (Survey::new(TICK), Pose::new(0.0, 0.0, 0.0));
        let mut chance: u32 = 1;
        for _ in 0..1200 {
            chance = chance.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let sign = if chance >> 31 == 0 { wander } else { -wander };
            pose = drive(&mut survey, pose, 0.05, sign, 0.0);
        }
        survey.grip.walk().sqrt()
    };
    // 0.05 degrees a root second are 0.44 mrad in each; ticks, which these wheels do not have, make
    // that half as much again.
    assert!(walk(0.013) > 0.7, "as its datasheet says: {}", walk(0.013));
    assert!(walk(0.0) < 0.3, "better: {}", walk(0.0));
}

#[test]
fn stretches_in_which_the_wheels_scrub_tell_nothing_of_the_gyro() {
    // Metre by metre, with a turn of 0.1 rad to and fro in each half; wheels and gyro agree by chance.
    let walk = |turned: f64| {
        let (mut survey, mut pose) = (Survey::new(TICK), Pose::new(0.0, 0.0, 0.0));
        for k in 0..400 {
            let turned = if k % 2 == 0 { turned } else { -turned };
            let (wound, squares) = (turned.abs(), turned * turned);
            let spun = Spun { gyro: turned, wheels: turned, wound, squares, strides: 0.25 };
            let heading = pose.heading + turned;
            let to = Pose { position: pose.position + angle::unit(heading) * 0.5, heading };
            survey.predict(&Step { from: pose, to, seconds: 2.5, spun: (Spun::default(), spun) });
            pose = to;
        }
        survey.grip.walk()
    };
    let datasheet = Survey::new(TICK).grip.walk();
    assert_eq!(walk(0.1), datasheet);
    assert!(walk(0.0) < 0.5 * datasheet, "{}", walk(0.0));
}

#[test]
fn what_all_at_once_says_of_the_robot_is_taken_out_of_its_next_turns() {
    let mut survey = Survey::new(TICK);
    // A gyro that tells 1 % too much of each turn, and wheels that tell a turn of 5 mrad a metre on the straight.
    survey.errs(&SystematicErrors { drift: 1e-4, scale: 0.01, wheels: 0.005, track: 0.0 });
    assert_eq!(survey.take_bias(), 0.0, "the drift is taken out of the readings themselves");
    assert!((survey.lopsided().abs() - 0.005).abs() < 1e-12);
    let told = turn(&mut survey, Pose::new(0.0, 0.0, 0.0));
    let real = survey.take_pose(told);
    let off = told.heading - real.heading;
    // The wheels, which told as much as the gyro, say something of it too, but little.
    assert!((0.004..0.012).contains(&(off / told.heading)), "{off}");
}
