//! A robot that is started again, and carried somewhere else meanwhile: it finds its place, or asks.

use super::*;
use crate::mapping::map::LineStatus;

pub(super) fn l_room() -> World {
    let text = include_str!("../../../../sims/l_room.toml");
    World::from_toml(text, "l_room", 0.1).expect("a world")
}

/// The robot is switched off, carried to `place`, and switched on.
pub(super) fn carry(rig: &mut Rig, world: &World, place: Pose) {
    rig.reboot();
    let there = World { start: place, ..world.clone() };
    rig.body = Body::new(&there, &crate::robot::Chassis::default(), NoiseProfile::None, 5);
    rig.good = place.position;
    rig.up.clear();
}

pub(super) fn is_touring(rig: &Rig) -> bool {
    let driven = |session: &Session| {
        let lines = session.mission().map().plan.as_ref().map_or(&[][..], |plan| &plan.lines);
        lines.iter().filter(|line| line.status == LineStatus::Driven).count()
    };
    rig.run.session().is_some_and(|session| driven(session) >= 2)
}

/// How far the believed place is from the true one, metres.
pub(super) fn off(rig: &Rig) -> f64 {
    let believed = rig.run.session().expect("a session").mission().tracker().pose();
    (believed.position - rig.body.true_pose().position).norm()
}

#[test]
fn a_robot_carried_elsewhere_finds_its_place_and_ends_its_tour() {
    let world = l_room();
    for place in [Pose::new(0.5, 3.0, -2.0), Pose::new(4.2, 0.7, 1.0), Pose::new(2.5, 1.2, 3.0)] {
        let mut rig = rig_in(&world, NoiseProfile::None, Faults::default(), 1, (true, None));
        assert!(rig.until(2000.0, is_touring));
        carry(&mut rig, &world, place);
        assert!(rig.until(10.0, |rig| rig.run.ending().is_some()));
        let reason = rig.run.ending().expect("an ending").reason;
        assert!(reason.contains("started again") && reason.contains("--resume"), "{reason}");
        rig.up.clear();
        resurrect(&mut rig, 9, None);
        let lost = |rig: &Rig| rig.run.session().is_some_and(|s| s.mission().is_lost());
        assert!(rig.until(10.0, lost), "it goes on as if nothing had been");
        let crate::session::Known::Known(view) = rig.run.snapshot(rig.now).robot else {
            panic!("heard")
        };
        assert_eq!(view.pose, None, "a place that nobody knows is shown");
        assert!(rig.until(1000.0, |rig| !lost(rig)), "not found from {place:?}");
        assert!(off(&rig) < 0.03, "{} m off from {place:?}", off(&rig));
        assert!(rig.until(3000.0, |rig| rig.run.ending().is_some()));
        let ending = rig.run.ending().expect("an ending");
        assert_eq!(ending.outcome, Outcome::Complete, "{}", ending.reason);
        assert!(off(&rig) < 0.03, "{} m off at the end", off(&rig));
        let map = rig.run.session().expect("a session").mission().map_now();
        assert_eq!(map.path.iter().filter(|point| point.carried).count(), 1);
        assert!(map.hidden_disc.expect("measured") < 0.26);
        // The record has all of it: the replay comes to the same.
        let bytes = rig.memory.bytes.borrow().clone();
        let recording = crate::journal::reader::parse(std::path::Path::new("memory"), &bytes);
        let mut replay = crate::session::Replay::new(recording.expect("a record"));
        replay.finish();
        assert_eq!(replay.difference(), None);
        assert!(replay.is_complete());
    }
}

/// A board that has no number for its lives says the same one again, and counts from nothing: whoever goes on with
/// the run is not told for ever that its clock went back.
#[test]
fn a_robot_started_again_under_the_same_number_finds_its_place() {
    let world = l_room();
    let mut rig = rig_in(&world, NoiseProfile::None, Faults::default(), 1, (true, None));
    assert!(rig.until(2000.0, is_touring));
    rig.boots -= 1;
    rig.reboot();
    assert!(rig.until(10.0, |rig| rig.run.ending().is_some()));
    let reason = rig.run.ending().expect("an ending").reason;
    assert!(reason.contains("--resume finds its place again"), "{reason}");
    rig.up.clear();
    resurrect(&mut rig, 9, None);
    assert!(rig.until(4000.0, |rig| rig.run.ending().is_some()));
    let ending = rig.run.ending().expect("an ending");
    assert_eq!(ending.outcome, Outcome::Complete, "{}", ending.reason);
    assert!(off(&rig) < 0.03, "{} m off at the end", off(&rig));
}

/// Where no boundary is closed yet, nothing promises that a robot that was started again finds its place.
#[test]
fn without_a_boundary_a_restarted_robot_has_to_be_told_its_place() {
    let mut rig = rig(Faults::default(), 1, true);
    rig.until(20.0, |_| false);
    rig.reboot();
    assert!(rig.until(10.0, |rig| rig.run.ending().is_some()));
    let reason = rig.run.ending().expect("an ending").reason;
    assert!(reason.contains("--placed X,Y,DEG begins the lap anew"), "{reason}");
    assert!(!reason.contains("finds its place"), "{reason}");
}

/// A robot that was started again within the run is the same one, still switched on, when the run is taken up
/// after that: it knows its place, and goes on counting where the run was.
#[test]
fn a_robot_started_again_within_the_run_is_known_when_it_is_taken_up() {
    let world = l_room();
    let mut rig = rig_in(&world, NoiseProfile::None, Faults::default(), 1, (false, None));
    assert!(rig.until(5.0, |rig| rig.run.session().is_some()));
    rig.run.intent(Intent::Run, rig.now);
    assert!(rig.until(2000.0, is_touring));
    rig.reboot();
    rig.until(5.0, |_| false);
    rig.run.intent(Intent::ClearStop, rig.now);
    rig.run.intent(Intent::Run, rig.now);
    let lost = |rig: &Rig| rig.run.session().is_some_and(|s| s.mission().is_lost());
    assert!(lost(&rig));
    assert!(rig.until(1000.0, |rig| !lost(rig)), "not found");
    rig.until(20.0, |_| false);
    for session in [9, 10] {
        rig.host_dead = true;
        rig.until(2.0, |_| false);
        rig.up.clear();
        resurrect(&mut rig, session, None);
        assert!(rig.until(5.0, |rig| rig.run.session().is_some()));
        rig.until(10.0, |_| false);
        assert!(!lost(&rig), "it looks for its place once more");
        assert_eq!(rig.run.ending().map(|ending| ending.reason), None);
        assert!(off(&rig) < 0.03, "{} m off", off(&rig));
    }
    assert!(rig.until(3000.0, |rig| rig.run.ending().is_some()));
    let ending = rig.run.ending().expect("an ending");
    assert_eq!(ending.outcome, Outcome::Complete, "{}", ending.reason);
}

/// The operator clears the stop and says run before the robot was heard to stand still, or steps: it does not
/// forget over that that its place is unknown.
#[test]
fn no_word_of_the_operator_makes_a_restarted_robot_forget_that_it_is_lost() {
    let world = l_room();
    for wish in [Intent::Run, Intent::StepCommand, Intent::StepPhase] {
        let mut rig = rig_in(&world, NoiseProfile::None, Faults::default(), 1, (false, None));
        assert!(rig.until(5.0, |rig| rig.run.session().is_some()));
        rig.run.intent(Intent::Run, rig.now);
        assert!(rig.until(2000.0, is_touring));
        carry(&mut rig, &world, Pose::new(4.2, 0.7, 1.0));
        assert!(rig.until(5.0, |rig| rig.run_state() == RunState::Stopped));
        rig.run.intent(Intent::ClearStop, rig.now);
        rig.run.intent(wish, rig.now);
        rig.until(10.0, |_| false);
        let session = rig.run.session().expect("a session");
        assert!(session.mission().is_lost(), "{wish:?}: it drives on, {} m off", off(&rig));
        let why = |kind: &EventKind| kind.to_string().contains("stands still");
        assert!(session.events().iter().any(|e| why(&e.kind)), "{wish:?}: nobody was told why");
        // Now it may.
        rig.run.intent(Intent::ClearStop, rig.now);
        rig.run.intent(Intent::Run, rig.now);
        let lost = |rig: &Rig| rig.run.session().is_some_and(|s| s.mission().is_lost());
        assert!(rig.until(1000.0, |rig| !lost(rig)), "{wish:?}: not found");
        assert!(off(&rig) < 0.03, "{wish:?}: {} m off", off(&rig));
    }
}

/// The same while a run is taken up whose robot was placed elsewhere; what the operator says meanwhile of where
/// it stands counts for more.
#[test]
fn no_word_of_the_operator_makes_a_run_forget_that_its_robot_was_placed() {
    let world = l_room();
    let there = Pose::new(4.2, 0.7, 1.0);
    for again in [false, true] {
        let mut rig = rig_in(&world, NoiseProfile::None, Faults::default(), 1, (true, None));
        assert!(rig.until(2000.0, is_touring));
        rig.host_dead = true;
        rig.until(2.0, |_| false);
        rig.body.push(there);
        rig.good = there.position;
        rig.up.clear();
        resurrect(&mut rig, 9, Some(if again { Pose::new(0.6, 0.6, 0.0) } else { there }));
        (rig.run.plan.at_once, rig.run.goes_on) = (false, false);
        assert!(rig.until(5.0, |rig| rig.run.session().is_some()));
        if again {
            rig.run.intent(Intent::Placed { near: Some(there) }, rig.now);
        }
        rig.run.intent(Intent::Run, rig.now);
        rig.until(10.0, |_| false);
        let lost = |rig: &Rig| rig.run.session().is_some_and(|s| s.mission().is_lost());
        assert!(lost(&rig), "again: {again}: it drives on, {} m off", off(&rig));
        rig.run.intent(Intent::ClearStop, rig.now);
        rig.run.intent(Intent::Run, rig.now);
        assert!(rig.until(1000.0, |rig| !lost(rig)), "again: {again}: not found");
        assert!(off(&rig) < 0.03, "again: {again}: {} m off", off(&rig));
    }
}

/// The robot is pushed a third of a metre aside to where it stands free, and turned a little; nobody tells.
fn push(rig: &mut Rig, world: &World, way: f64) {
    use crate::geometry::{Ring, angle};
    let pose = rig.body.true_pose();
    let rings = || std::iter::once(&world.boundary).chain(world.objects.iter().map(|o| &o.ring));
    let room =
        |p: crate::geometry::Point| rings().map(|r: &Ring| r.distance(p)).fold(9.0, f64::min);
    let to = (0..12)
        .map(|k| pose.position + angle::unit(way + f64::from(k) * 0.5) * 0.35)
        .find(|p| world.boundary.contains(*p) && room(*p) > 0.2)
        .expect("room beside it");
    rig.body.push(Pose { position: to, heading: pose.heading + 0.12 });
}

/// What a robot that is pushed `way` during its tour, `later` seconds after its second line, has at the end:
/// a place that it knows, and objects as there are in the room.
fn pushed_and_right(world: &World, noise: NoiseProfile, seed: u64, (later, way): (f64, f64)) {
    let mut rig = rig_in(world, noise, Faults::default(), seed, (true, None));
    assert!(rig.until(4000.0, is_touring));
    let later = rig.now + later;
    rig.until(later, |rig| rig.now > later);
    push(&mut rig, world, way);
    assert!(off(&rig) > 0.25, "it is hardly pushed");
    assert!(rig.until(9000.0, |rig| rig.run.ending().is_some()));
    let ending = rig.run.ending().expect("an ending");
    assert_eq!(ending.outcome, Outcome::Complete, "{}", ending.reason);
    let most = if noise == NoiseProfile::None { 0.03 } else { 0.06 };
    assert!(off(&rig) < most, "{seed}: {} m off at the end", off(&rig));
    let map = rig.run.session().expect("a session").mission().map();
    let objects: Vec<_> = map.objects.iter().map(|o| (o.class, o.outline.middle())).collect();
    assert_eq!(objects.len(), world.objects.len(), "{seed}: nothing is there twice: {objects:?}");
}

#[test]
fn a_robot_that_was_pushed_finds_out_and_maps_nothing_twice() {
    for (trial, way) in [0.3, 1.9, 3.5, 5.1].into_iter().enumerate() {
        pushed_and_right(&l_room(), NoiseProfile::None, trial as u64, (0.0, way));
    }
}

/// Where robots were seen that took walls for objects before they found out, or whose map held things where they are
/// not: what a robot did since its place was last sure is taken back.
#[test]
fn what_a_robot_did_while_it_was_astray_is_taken_back() {
    let flat = include_str!("../../../../sims/flat.toml");
    let flat = World::from_toml(flat, "flat", 0.1).expect("a world");
    let objects = include_str!("../../../../sims/objects.toml");
    let objects = World::from_toml(objects, "objects", 0.1).expect("a world");
    for (world, seed) in [(&l_room(), 3), (&l_room(), 7), (&flat, 9), (&objects, 4), (&objects, 8)]
    {
        let (later, way) = (40.0 * seed as f64, 0.8 * seed as f64);
        pushed_and_right(world, NoiseProfile::Calibrated, seed, (later, way));
    }
}

#[test]
fn where_two_places_look_the_same_the_robot_asks() {
    let text = include_str!("../../../../sims/rectangle.toml");
    let world = World::from_toml(text, "rectangle", 0.1).expect("a world");
    let mut rig = rig_in(&world, NoiseProfile::None, Faults::default(), 1, (true, None));
    assert!(rig.until(2000.0, is_touring));
    let place = Pose::new(4.3, 1.1, 1.4);
    carry(&mut rig, &world, place);
    rig.until(10.0, |rig| rig.run.ending().is_some());
    rig.up.clear();
    resurrect(&mut rig, 9, None);
    assert!(rig.until(1000.0, |rig| rig.run.ending().is_some()));
    let reason = rig.run.ending().expect("an ending").reason;
    assert!(reason.contains("--placed"), "{reason}");
    rig.until(1.0, |_| false);
    assert!(rig.speed() < 1e-9, "it moves and does not know where");
    // Taken up without a word, and not started again meanwhile, it looks once more.
    resurrect(&mut rig, 11, None);
    let moves = |rig: &Rig| rig.run.session().is_some_and(|one| one.mission().is_moving());
    assert!(rig.until(60.0, moves), "{:?}", rig.run.ending());
    assert!(rig.until(1000.0, |rig| rig.run.ending().is_some()));
    // The operator puts it back where it was found, and says so, roughly.
    carry(&mut rig, &world, place);
    resurrect(&mut rig, 10, Some(Pose::new(4.1, 1.3, 1.2)));
    assert!(rig.until(3000.0, |rig| rig.run.ending().is_some()));
    let ending = rig.run.ending().expect("an ending");
    assert_eq!(ending.outcome, Outcome::Complete, "{}", ending.reason);
    assert!(off(&rig) < 0.03, "{} m off at the end", off(&rig));
    // Where it drove while it looked in vain nobody knows: no way of it is on the map.
    let map = rig.run.session().expect("a session").mission().map_now();
    let way = |two: &[crate::mapping::map::PathPoint]| two[1].pose.position - two[0].pose.position;
    let longest = map.path.windows(2).filter(|two| !two[1].carried).map(|two| way(two).norm());
    assert!(longest.fold(0.0, f64::max) < 0.3, "it drove where it did not");
    assert!(map.path.iter().all(|point| world.boundary.contains(point.pose.position)));
}

#[test]
fn without_a_boundary_the_lap_begins_anew_from_where_the_operator_says() {
    let world = l_room();
    let mut rig = rig_in(&world, NoiseProfile::None, Faults::default(), 1, (false, None));
    assert!(rig.until(5.0, |rig| rig.run.session().is_some()));
    let now = rig.now;
    rig.run.intent(Intent::Run, now);
    rig.until(40.0, |_| false);
    let place = Pose::new(1.0, 1.0, 0.5);
    carry(&mut rig, &world, place);
    rig.until(5.0, |_| false);
    let session = rig.run.session().expect("a session");
    assert_eq!(session.run_state(), RunState::Stopped);
    assert!(session.mission().is_lost());
    let now = rig.now;
    for wish in [Intent::ClearStop, Intent::Run] {
        rig.run.intent(wish, now);
    }
    rig.until(5.0, |_| false);
    assert!(rig.speed() < 1e-9, "it moves and does not know where");
    let now = rig.now;
    for wish in [Intent::Placed { near: Some(place) }, Intent::Run] {
        rig.run.intent(wish, now);
    }
    assert!(rig.until(3000.0, |rig| rig.run.ending().is_some()));
    let ending = rig.run.ending().expect("an ending");
    assert_eq!(ending.outcome, Outcome::Complete, "{}", ending.reason);
    assert!(off(&rig) < 0.03, "{} m off at the end", off(&rig));
}

/// A run that was to end with a phase is over after it: where the robot stands then changes nothing.
#[test]
fn a_run_that_is_over_is_not_told_where_the_robot_is() {
    let mut rig = rig(Faults::default(), 1, true);
    assert!(rig.until(900.0, |rig| rig.run.ending().is_some()));
    let before = rig.run.session().expect("a session").mission().map_now();
    rig.run.intent(Intent::Placed { near: Some(Pose::new(1.0, 1.0, 0.5)) }, rig.now);
    let mission = rig.run.session().expect("a session").mission();
    assert!(!mission.is_lost() && mission.map_now() == before, "it was believed");
}

/// The robot is turned on the spot during its tour, by so many radians, and nobody tells; its run to the end.
fn turned(world: &World, by: f64) -> Rig {
    let mut rig = rig_in(world, NoiseProfile::None, Faults::default(), 1, (true, None));
    assert!(rig.until(4000.0, is_touring));
    let pose = rig.body.true_pose();
    rig.body.push(Pose { heading: pose.heading + by, ..pose });
    assert!(rig.until(20000.0, |rig| rig.run.ending().is_some()));
    rig
}

#[test]
fn a_robot_that_is_not_where_it_believes_it_is_looks_for_its_place_anywhere() {
    // Before, it went on where it believed it was, again and again, and said in the end that all was done.
    let rig = turned(&l_room(), 1.5);
    let ending = rig.run.ending().expect("an ending");
    assert_eq!(ending.outcome, Outcome::Complete, "{}", ending.reason);
    assert!(off(&rig) < 0.03, "{} m off at the end", off(&rig));
    let session = rig.run.session().expect("a session");
    assert_eq!(session.mission().map().objects.len(), l_room().objects.len());
    let told = |kind: &EventKind| session.events().iter().filter(|e| e.kind == *kind).count();
    assert_eq!(told(&EventKind::StillAstray), 1);
}

#[test]
fn a_robot_that_does_not_find_its_place_anywhere_waits_for_word() {
    let world = include_str!("../../../../sims/rectangle.toml");
    let rig = turned(&World::from_toml(world, "rectangle", 0.1).expect("a world"), 1.0);
    let session = rig.run.session().expect("a session");
    assert!(session.mission().waits_for_place());
    let last =
        session.events().iter().rev().find(|e| matches!(e.kind, EventKind::PlaceUnclear { .. }));
    assert_eq!(last.map(|e| e.kind.clone()), Some(EventKind::PlaceUnclear { places: 2 }));
    let ending = rig.run.ending().expect("an ending");
    assert_eq!(ending.outcome, Outcome::Failed);
    assert!(ending.reason.contains("does not know where it is"), "{}", ending.reason);
}

/// How far the mapped outline is from the true one at its corners, at most, metres.
fn worst_corner(rig: &Rig, world: &World) -> f64 {
    let map = rig.run.session().expect("a session").mission().map();
    let outline = &map.shape.as_ref().expect("a shape").outline;
    let corners = world.boundary.pieces.iter().map(crate::geometry::Piece::from);
    corners.map(|corner| outline.distance(corner)).fold(0.0, f64::max)
}

/// Runs that are carried to a random place of a world, with noise: how far off the robot believes it is
/// when it has found its place, and how far the map is off at the end.
/// `cargo test --release -- --ignored many_carried`
#[test]
#[ignore = "minutes; prints a table"]
fn many_carried() {
    let worlds = [
        include_str!("../../../../sims/l_room.toml"),
        include_str!("../../../../sims/flat.toml"),
        include_str!("../../../../sims/u_room.toml"),
        include_str!("../../../../sims/comb.toml"),
        include_str!("../../../../sims/keyhole.toml"),
    ];
    for (n, text) in worlds.iter().enumerate() {
        let world = World::from_toml(text, "world", 0.1).expect("a world");
        for trial in 0..4_u64 {
            let start = |seed| {
                let noise = NoiseProfile::Calibrated;
                let mut rig = rig_in(&world, noise, Faults::default(), seed, (true, None));
                assert!(rig.until(4000.0, is_touring));
                rig
            };
            let mut rng = ChaCha8Rng::seed_from_u64(n as u64 * 100 + trial);
            let mut rig = start(trial);
            let before = worst_corner(&rig, &world);
            let path = rig.run.session().expect("touring").mission().map_now().path;
            let at = path[rng.random_range(0..path.len())].pose.position;
            let place = Pose { position: at, heading: rng.random::<f64>() * 6.0 };
            rig.reboot();
            let there = World { start: place, ..world.clone() };
            let chassis = crate::robot::Chassis::default();
            rig.body = Body::new(&there, &chassis, NoiseProfile::Calibrated, trial);
            rig.up.clear();
            rig.until(10.0, |rig| rig.run.ending().is_some());
            rig.up.clear();
            resurrect(&mut rig, 9, None);
            let lost = |rig: &Rig| rig.run.session().is_some_and(|s| s.mission().is_lost());
            rig.until(10.0, lost);
            rig.until(2000.0, |rig| !lost(rig) || rig.run.ending().is_some());
            let (found, near) = (!lost(&rig), off(&rig));
            let pose = rig.run.session().expect("a session").mission().tracker().pose();
            let turned = pose.heading - rig.body.true_pose().heading;
            let turned = crate::geometry::angle::wrap(turned);
            rig.until(6000.0, |rig| rig.run.ending().is_some());
            let after = worst_corner(&rig, &world);
            let mut whole = start(trial);
            whole.until(6000.0, |rig| rig.run.ending().is_some());
            println!(
                "{n} {trial} found {found} off {near:.3} m {turned:+.4} rad; worst corner \
                 {before:.3} before, {after:.3} at the end, {:.3} without",
                worst_corner(&whole, &world)
            );
        }
    }
}

/// Runs with noise whose robot is pushed aside during its tour: how far off the robot believes it is at the
/// end, and how many objects there are on the map and in the room.
/// `cargo test --release -- --ignored many_pushed --nocapture`
#[test]
#[ignore = "minutes; prints a table"]
fn many_pushed() {
    let worlds = [
        ("l_room", include_str!("../../../../sims/l_room.toml")),
        ("flat", include_str!("../../../../sims/flat.toml")),
        ("u_room", include_str!("../../../../sims/u_room.toml")),
        ("objects", include_str!("../../../../sims/objects.toml")),
    ];
    for (name, text) in worlds {
        let world = World::from_toml(text, name, 0.1).expect("a world");
        for trial in 0..13_u64 {
            let noise = NoiseProfile::Calibrated;
            let mut rig = rig_in(&world, noise, Faults::default(), trial, (true, None));
            assert!(rig.until(4000.0, is_touring));
            let later = rig.now + 40.0 * trial as f64;
            rig.until(later, |rig| rig.now > later);
            push(&mut rig, &world, 0.8 * trial as f64);
            let pushed = off(&rig);
            rig.until(9000.0, |rig| rig.run.ending().is_some());
            let session = rig.run.session().expect("a session");
            let objects = session.mission().map().objects.len();
            let known = world.objects.len();
            println!(
                "{name} {trial}: pushed {pushed:.3} m; {:.3} m off at the end; worst corner {:.3}; \
                 {objects} objects of {known}; {:?}",
                off(&rig),
                worst_corner(&rig, &world),
                rig.run.ending().map(|ending| ending.outcome)
            );
        }
    }
}
