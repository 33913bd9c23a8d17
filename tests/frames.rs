//! Frames of every phase, symbols and styles both, held against what was looked at and found good.
//! After a wanted change: `INSTA_UPDATE=always cargo test --test frames`, and look at the difference.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

use periplus::console::action::{ACTIONS, Action};
use periplus::console::key::Key;
use periplus::console::model::{Model, Overlay};
use periplus::console::theme::Role;
use periplus::console::update::{Effect, perform, press};
use periplus::console::{Keymap, frame};
use periplus::geometry::{Piece, Point, Ring, perp};
use periplus::journal::Header;
use periplus::mapping::map::{Contact, ContactKind};
use periplus::mapping::settings::Settings;
use periplus::mapping::unreached::{Beyond, Unreached};
use periplus::robot::Intent;
use periplus::runtime::simulated::SimulatedRun;
use periplus::session::{Known, RunState, Snapshot};
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
    no_figure_is_cut(name, snapshot);
}

/// A number without its end is another number: beside the map nothing is cut off, however narrow it is.
fn no_figure_is_cut(name: &str, snapshot: &Snapshot) {
    for (cols, rows) in [(60, 16), (60, 20), (76, 22), (80, 24), (100, 30), (120, 40), (160, 42)] {
        let model = Model::new(cols, rows, Keymap::default());
        let (symbols, _) = frame::planes(&model, snapshot);
        let beside = symbols.lines().filter_map(|row| row.split_once('│'));
        let cut = beside.map(|(_, figure)| figure).find(|figure| figure.contains('…'));
        assert_eq!(cut, None, "{name} {cols}x{rows}");
    }
}

/// Of the two errors that walls have, the one among each other stays the longest when rows are short: the walls' own
/// row holds the other.
fn the_error_among_the_walls_gives_way_last(complete: &Snapshot) {
    let told = |rows: u16| {
        let (symbols, _) = frame::planes(&Model::new(80, rows, Keymap::default()), complete);
        (symbols.contains("± whole"), symbols.contains("± among"))
    };
    let seen: Vec<(bool, bool)> = (16..=40).map(told).collect();
    assert!(seen.iter().all(|&(whole, among)| among || !whole), "{seen:?}");
    assert!(seen.contains(&(true, true)) && seen.contains(&(false, true)), "{seen:?}");
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
        let overlay = Overlay::Line(place.into());
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
    // A motion that was broken off is not done.
    let (symbols, _) = frame::planes(&Model::new(80, 24, Keymap::default()), &run.snapshot());
    assert!(symbols.contains("│ stopped ") && !symbols.contains("│ done "), "{symbols}");
    let told = run.snapshot().events.len();
    run.intent(Intent::Stop);
    assert_eq!(run.snapshot().events.len(), told, "a stop that holds already is told again");
    run.intent(Intent::ClearStop);
    run.intent(Intent::Run);
    until_paused(&mut run);
    assert_eq!(run.session().run_state(), RunState::Complete);
    hold("9_complete", &run.snapshot(), &Overlay::None);
    the_error_among_the_walls_gives_way_last(&run.snapshot());
    hold("list", &run.snapshot(), &Overlay::List(0));
    let mut numbered = Model::new(80, 24, Keymap::default());
    perform(&mut numbered, &run.snapshot(), Action::ToggleWalls);
    let (symbols, _) = frame::planes(&numbered, &run.snapshot());
    for piece in 0..run.snapshot().map.shape.expect("a room").outline.pieces.len() {
        let name = format!("W{}", piece + 1);
        assert_eq!(symbols.matches(&name).count(), 1, "{name}: {symbols}");
    }
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
fn a_robot_that_is_not_heard_is_told_of_as_long_as_it_is_not() {
    let mut run = run_in(include_str!("../sims/rectangle.toml"));
    run.intent(Intent::Run);
    while run.snapshot().command.is_none() || run.snapshot().time < 5.0 {
        run.advance();
    }
    let heard = run.snapshot();
    let Known::Known(value) = heard.robot else { panic!("it is heard") };
    let silent = Snapshot { robot: Known::Stale { value, age: 23.0 }, ..heard.clone() };
    let mut model = Model { speed: None, ..Model::new(80, 24, Keymap::default()) };
    let paused = |snapshot: &Snapshot| Snapshot { run: RunState::Paused, ..snapshot.clone() };
    assert!(perform(&mut model, &paused(&silent), Action::RunPause).is_empty(), "told to drive");
    let (symbols, styles) = frame::planes(&model, &paused(&silent));
    assert!(
        styles.contains('z') && !styles.contains(['Z', 'B', 'a']),
        "as if it were heard: {styles}"
    );
    let header = symbols.lines().next().expect("a header");
    assert!(header.contains("LINK LOST 0:00:23") && !header.contains("live"), "{header}");
    assert!(symbols.contains("│ told ") && !symbols.contains("│ command "), "{symbols}");
    assert!(symbols.contains("▲ the robot is not heard"), "{symbols}");
    // There again, nothing says that it is not.
    let (symbols, _) = frame::planes(&model, &paused(&heard));
    assert!(symbols.contains(" live ") && !symbols.contains("LINK LOST"), "{symbols}");
    assert!(!symbols.contains("not heard"), "a remark outlived its truth: {symbols}");
}

#[test]
fn what_nobody_touched_is_not_drawn_as_wall() {
    let mut run = run_in(include_str!("../sims/rectangle.toml"));
    phase(&mut run);
    phase(&mut run);
    let mut snapshot = run.snapshot();
    let outline = &snapshot.map.shape.as_ref().expect("a shape").outline;
    let piece = outline.pieces[0];
    let model = Model::new(80, 24, Keymap::default());
    assert!(!frame::planes(&model, &snapshot).1.contains('y'));
    snapshot.map.unreached =
        vec![Unreached { at: piece.at(0.5), width: piece.length(), area: None }];
    let (symbols, styles) = frame::planes(&model, &snapshot);
    assert!(styles.matches('y').count() > 5, "{styles}");
    assert!(symbols.contains("unknown 1 stretch,"), "{symbols}");
    assert!(!symbols.contains("narrow "), "nobody knows that there is a gap: {symbols}");
}

/// What was felt behind a strait is dots, also where contacts are not shown, and the strait is no wall.
#[test]
fn behind_a_strait_are_dots_and_no_wall_is_across_it() {
    let mut run = run_in(include_str!("../sims/rectangle.toml"));
    phase(&mut run);
    phase(&mut run);
    let mut snapshot = run.snapshot();
    let outline = &mut snapshot.map.shape.as_mut().expect("a shape").outline;
    // The first wall in three, with a strait of 0.28 m.
    let (wall, at) = (outline.pieces[0], |t: f64| outline.pieces[0].at(t));
    let t = 0.28 / wall.length();
    let cut = [at(0.0), at(0.5), at(0.5 + t), at(1.0)];
    let pieces = cut.windows(2).map(|ends| Piece::Line { from: ends[0], to: ends[1] });
    let pieces: Vec<Piece> = pieces.collect();
    let behind = |p: Point| p - perp(wall.tangent(0.0)) * 1.5;
    let (strait, far) = (pieces[1], [behind(cut[1]), behind(cut[2])]);
    outline.pieces.splice(0..1, pieces);
    let model = Model::new(120, 40, Keymap::default());
    let (whole, _) = frame::planes(&model, &snapshot);
    let seen =
        |point| Contact { point, from: point, sensor: None, kind: ContactKind::Range, time: 0.0 };
    snapshot.map.beyond = vec![Beyond {
        outline: Ring::polygon(&[strait.from(), far[0], far[1], strait.to()]),
        contacts: far.map(seen).to_vec(),
    }];
    let shown = frame::planes(&model, &snapshot);
    assert_ne!(whole, shown.0, "nothing tells of it");
    assert!(shown.1.contains('y'), "wall across it: {}", shown.1);
    insta::assert_snapshot!("strait_120x40", format!("{}\n{}", shown.0, shown.1));
}

#[test]
fn a_replay_offers_nothing_that_it_does_not_do() {
    let mut run = run_in(include_str!("../sims/rectangle.toml"));
    phase(&mut run);
    let snapshot = Snapshot { recorded: true, alpha_is_open: false, ..run.snapshot() };
    let mut model = Model::new(120, 40, Keymap::default());
    let (symbols, _) = frame::planes(&model, &snapshot);
    let footer = symbols.lines().last().expect("a footer");
    assert!(footer.contains("at=SECONDS") && !footer.contains("lap"), "{footer}");
    for action in [Action::Finish, Action::Square, Action::LapAgain, Action::AlphaUp] {
        assert!(perform(&mut model, &snapshot, action).is_empty());
        assert_eq!(model.overlay, Overlay::None, "{action:?} asks what is not to be asked");
        let hint = model.hint.take().expect("a word on why nothing happens");
        assert!(hint.text.contains("not changed"), "{}", hint.text);
    }
}

/// The pages of the help, one under the other.
fn help(model: &mut Model, snapshot: &Snapshot) -> String {
    let mut pages = String::new();
    for scroll in (0..200).step_by(20) {
        model.overlay = Overlay::Help(scroll);
        pages += &frame::planes(model, snapshot).0;
    }
    model.overlay = Overlay::None;
    pages
}

#[test]
fn the_help_lists_what_works_here_and_says_of_the_rest_why_not() {
    let mut run = run_in(include_str!("../sims/rectangle.toml"));
    phase(&mut run);
    let mut model = Model::new(120, 40, Keymap::default());
    let lists = |text: &str, word: &str| {
        // After all its keys.
        let name = |line: &str| line.chars().skip(16).take(14).collect::<String>();
        text.lines().any(|line| name(line).trim() == word)
    };
    let live = help(&mut model, &run.snapshot());
    for word in ["lap-again", "alpha-up", "finish", "clear", "faster", "run", "quit"] {
        assert!(lists(&live, word), "{word}:\n{live}");
    }
    assert!(live.contains("export=DIR") && !live.contains("at=SECONDS"), "{live}");
    assert!(!live.contains("do nothing here"), "{live}");

    let snapshot = Snapshot { recorded: true, alpha_is_open: false, ..run.snapshot() };
    let replay = help(&mut model, &snapshot);
    for (action, word) in ACTIONS.iter().map(|info| (info.action, info.name)) {
        assert_eq!(lists(&replay, word), !action.changes_the_run(), "{word}:\n{replay}");
    }
    for words in
        ["c L B [ ] S X do nothing here: a replay", "play, or pause", "at=SECONDS", "speed=N"]
    {
        assert!(replay.contains(words), "{words}:\n{replay}");
    }
    for words in
        ["alpha=M", "tape=", "placed=", "export=DIR", "robot moves", "simulated time slower"]
    {
        assert!(!replay.contains(words), "{words}:\n{replay}");
    }

    // A real robot's time is not ours, and its map is written at the end.
    model.speed = None;
    let robot = help(&mut model, &run.snapshot());
    assert!(robot.contains("< > do nothing here: a real robot has one speed"), "{robot}");
    for word in ["slower", "faster"] {
        assert!(!lists(&robot, word), "{word}:\n{robot}");
    }
    assert!(robot.contains("alpha=M") && !robot.contains("export=DIR"), "{robot}");
}

/// Who asks for the plan wants to see it; who asks for the map, what is handed over.
#[test]
fn a_plan_that_was_all_that_was_asked_for_is_seen() {
    let mut run = run_in(include_str!("../sims/rectangle.toml"));
    for _ in 0..3 {
        phase(&mut run);
    }
    let planned = |snapshot: &Snapshot| {
        let (_, styles) = frame::planes(&Model::new(120, 40, Keymap::default()), snapshot);
        styles.matches(Role::LinePlanned.letter()).count()
    };
    let mut snapshot = Snapshot { run: RunState::Complete, ..run.snapshot() };
    assert!(planned(&snapshot) > 100, "{}", planned(&snapshot));
    snapshot.progress[3].done = true;
    assert_eq!(planned(&snapshot), 0);
}

#[test]
fn a_stop_does_not_cover_the_robot_and_a_question_is_whole() {
    let mut run = run_in(include_str!("../sims/rectangle.toml"));
    run.intent(Intent::Run);
    let mut seen = [false; 2];
    for _ in 0..80 {
        (0..75).for_each(|_| run.advance());
        let mut snapshot = run.snapshot();
        (snapshot.run, snapshot.latched) = (RunState::Stopped, true);
        for (cols, rows) in [(60, 16), (80, 24)] {
            let (symbols, styles) =
                frame::planes(&Model::new(cols, rows, Keymap::default()), &snapshot);
            let middle = usize::from(rows) / 2;
            // It has not yet said that it stands.
            let stop = symbols.lines().position(|row| row.contains("S T O P P"));
            seen[usize::from(stop.expect("a banner") > middle)] = true;
            assert!(styles.contains(['Z', 'B']), "{cols}x{rows}: no robot\n{symbols}");
            assert!(symbols.contains("clears the stop; phase and"), "{symbols}");
        }
    }
    assert!(seen[0], "the robot was never below");
    let model = Model { overlay: Overlay::ConfirmFinish, ..Model::new(60, 16, Keymap::default()) };
    let (symbols, _) = frame::planes(&model, &run.snapshot());
    assert!(symbols.contains("kept.") && symbols.contains("End it?"), "{symbols}");
    let model = Model { overlay: Overlay::ConfirmAnew, ..Model::new(60, 16, Keymap::default()) };
    let (symbols, _) = frame::planes(&model, &run.snapshot());
    assert!(symbols.contains("lap is dropped;") && symbols.contains("Drop?"), "{symbols}");
}

#[test]
fn a_robot_that_was_never_heard_of_and_a_terminal_too_small() {
    let settings = Settings::new(periplus::geometry::Pose::new(0.0, 0.0, 0.0));
    let snapshot = Snapshot::waiting(settings, "nowhere");
    hold("nothing_heard", &snapshot, &Overlay::None);
    let replay = Snapshot { recorded: true, ..snapshot.clone() };
    let (symbols, _) = frame::planes(&Model::new(80, 24, Keymap::default()), &replay);
    assert!(
        symbols.contains("in the record up to here") && !symbols.contains("waiting"),
        "{symbols}"
    );
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
