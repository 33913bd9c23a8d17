//! Frames of every phase, symbols and styles both, held against what was looked at and found good.
//! After a wanted change: `INSTA_UPDATE=always cargo test --test frames`, and look at the difference.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

use periplus::console::action::Action;
use periplus::console::key::Key;
use periplus::console::model::{Model, Overlay};
use periplus::console::update::{Effect, perform, press};
use periplus::console::{Keymap, frame};
use periplus::journal::Header;
use periplus::mapping::settings::Settings;
use periplus::robot::Intent;
use periplus::runtime::simulated::SimulatedRun;
use periplus::session::{RunState, Snapshot};
use periplus::simulator::{NoiseProfile, World};
use std::io::Sink;

type Run = SimulatedRun<Sink>;

fn run_in(world: &str) -> Run {
    let world = World::from_toml(world, "world", 0.1).expect("a world");
    let header = Header {
        settings: Settings::new(world.start),
        source: world.name.clone(),
        noise: "none".to_owned(),
        until: None,
        robot: None,
    };
    SimulatedRun::new(&world, header, NoiseProfile::None, None)
}

/// Lets the run go on until it waits again.
fn until_paused(run: &mut Run) {
    for _ in 0..400_000 {
        if !run.is_under_way() {
            return;
        }
        run.advance();
    }
    panic!("the run goes on for ever");
}

fn phase(run: &mut Run) {
    run.intent(Intent::StepPhase);
    until_paused(run);
}

/// Holds a frame at 80x24 and 120x40: the symbols, and below them the letter of each cell's style.
fn hold(name: &str, snapshot: &Snapshot, overlay: &Overlay) {
    for (cols, rows) in [(80, 24), (120, 40)] {
        let model = Model { overlay: overlay.clone(), ..Model::new(cols, rows, Keymap::default()) };
        let (symbols, styles) = frame::planes(&model, snapshot);
        insta::assert_snapshot!(format!("{name}_{cols}x{rows}"), format!("{symbols}\n{styles}"));
    }
}

#[test]
fn every_phase_of_a_room_with_an_object() {
    let mut run = run_in(include_str!("../sims/extrinsic_first.toml"));
    hold("1_waiting", &run.snapshot(), &Overlay::None);
    run.intent(Intent::Run);
    for _ in 0..2000 {
        run.advance();
    }
    hold("2_boundary_under_way", &run.snapshot(), &Overlay::None);
    run.intent(Intent::Pause);
    until_paused(&mut run);
    phase(&mut run);
    hold("3_boundary_closed", &run.snapshot(), &Overlay::None);
    phase(&mut run);
    hold("4_shape", &run.snapshot(), &Overlay::None);
    phase(&mut run);
    hold("5_plan", &run.snapshot(), &Overlay::None);
    // No robot stands outside the room.
    for (place, is_taken) in [("placed=1,1,0", true), ("placed=99,1,0", false)] {
        let overlay = Overlay::Line(place.to_owned());
        let mut model = Model { overlay, ..Model::new(80, 24, Keymap::default()) };
        let effects = press(&mut model, &run.snapshot(), Key::parse("enter").expect("a key"));
        let taken = matches!(effects[..], [Effect::Intent(Intent::Placed { .. })]);
        assert_eq!(taken, is_taken, "{place}: {effects:?}");
    }
    run.intent(Intent::SetAlpha { alpha: 0.5 });
    hold("6_plan_at_another_alpha", &run.snapshot(), &Overlay::None);
    run.intent(Intent::Run);
    for _ in 0..3000 {
        run.advance();
    }
    hold("7_objects_under_way", &run.snapshot(), &Overlay::None);
    run.intent(Intent::Stop);
    for _ in 0..50 {
        run.advance();
    }
    hold("8_stopped", &run.snapshot(), &Overlay::None);
    run.intent(Intent::ClearStop);
    run.intent(Intent::Run);
    until_paused(&mut run);
    assert_eq!(run.session().run_state(), RunState::Complete);
    hold("9_complete", &run.snapshot(), &Overlay::None);
    let mut owing = run.snapshot();
    owing.map.hidden_disc = Some(1.5);
    let model = Model::new(80, 24, Keymap::default());
    let (symbols, _) = frame::planes(&model, &owing);
    assert!(symbols.contains("! NOT ALL SEEN") && !symbols.contains("COMPLETE"), "{symbols}");
    // A stop holds after the end too, and is cleared like any other.
    let mut model = Model::new(80, 24, Keymap::default());
    run.intent(Intent::Stop);
    let effects = perform(&mut model, &run.snapshot(), Action::ClearStop);
    assert_eq!(effects, [Effect::Intent(Intent::ClearStop)]);
    run.intent(Intent::ClearStop);
    assert!(perform(&mut model, &run.snapshot(), Action::ClearStop).is_empty(), "nothing to clear");
}

#[test]
fn a_robot_that_was_never_heard_of_and_a_terminal_too_small() {
    let settings = Settings::new(periplus::geometry::Pose::new(0.0, 0.0, 0.0));
    let snapshot = Snapshot::waiting(settings, "nowhere");
    hold("nothing_heard", &snapshot, &Overlay::None);
    hold("help", &snapshot, &Overlay::Help(0));
    let model = Model::new(60, 20, Keymap::default());
    let (symbols, styles) = frame::planes(&model, &snapshot);
    insta::assert_snapshot!("too_small_60x20", format!("{symbols}\n{styles}"));
    // What a phase took gives way to its name.
    let mut done = snapshot;
    for phase in &mut done.progress {
        (phase.done, phase.seconds) = (true, 638.0);
    }
    let (symbols, _) = frame::planes(&model, &done);
    let strip = symbols.lines().nth(1).expect("the strip of the phases");
    assert!(strip.contains("✓ boundary ") && !strip.contains(':'), "{strip}");
}
