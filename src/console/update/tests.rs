//! What keys do, and what they refuse, without a terminal and without a robot.

use super::line::obey;
use super::*;
use crate::console::Keymap;
use crate::console::command::Command;
use crate::mapping::event::Failure;

use crate::geometry::{Point, Pose};
use crate::mapping::map::{Contact, ContactKind, Plan, PlanFigures};
use crate::mapping::settings::{Settings, Strategy};
use crate::robot::SwitchSet;
use crate::session::snapshot::RobotView;

fn waiting() -> (Model, Snapshot) {
    let settings = Settings::new(Pose::new(0.0, 0.0, 0.0));
    (Model::new(80, 24, Keymap::default()), Snapshot::waiting(settings, "nowhere"))
}

/// A robot that stands at the origin.
fn at_rest() -> RobotView {
    RobotView {
        pose: Some(Pose::new(0.0, 0.0, 0.0)),
        position_sd: 0.0,
        switches: SwitchSet::default(),
        bumper: false,
        moving: false,
        needs_place: false,
    }
}

#[test]
fn keys_that_come_faster_than_frames_each_count() {
    let (mut model, mut snapshot) = waiting();
    let mut alphas = Vec::new();
    let mut key = |model: &mut Model, snapshot: &Snapshot, action: Action| {
        for effect in perform(model, snapshot, action) {
            let Effect::Intent(Intent::SetAlpha { alpha }) = effect else { continue };
            alphas.push(alpha);
        }
    };
    key(&mut model, &snapshot, Action::AlphaUp);
    key(&mut model, &snapshot, Action::AlphaUp);
    // Now the run has heard of both, and later of a step back.
    snapshot.settings.alpha = 0.35;
    key(&mut model, &snapshot, Action::AlphaDown);
    snapshot.settings.alpha = 0.3;
    key(&mut model, &snapshot, Action::AlphaUp);
    key(&mut model, &snapshot, Action::AlphaDown);
    assert_eq!(alphas, [0.3, 0.35, 0.3, 0.35, 0.3]);
}

#[test]
fn a_layer_shown_under_way_is_not_shown_at_the_end() {
    let (mut model, mut snapshot) = waiting();
    perform(&mut model, &snapshot, Action::ToggleContacts);
    assert!(model.layers.contacts.is_shown(false) && !model.layers.contacts.is_shown(true));
    snapshot.run = RunState::Complete;
    perform(&mut model, &snapshot, Action::ToggleContacts);
    assert!(model.layers.contacts.is_shown(true), "but one may ask for it");
}

#[test]
fn a_robot_lost_before_there_is_a_boundary_waits_for_its_place_and_says_so() {
    let (mut model, mut snapshot) = waiting();
    (snapshot.run, snapshot.latched) = (RunState::Stopped, true);
    snapshot.robot = Known::Known(RobotView {
        pose: None,
        position_sd: 0.0,
        switches: SwitchSet::default(),
        bumper: false,
        moving: false,
        needs_place: true,
    });
    let said = |model: &Model| model.hint.as_ref().expect("a remark").text.clone();
    assert_eq!(perform(&mut model, &snapshot, Action::ClearStop).len(), 1);
    assert!(said(&model).contains(":placed=X,Y,DEG"), "{}", said(&model));
    snapshot.run = RunState::Paused;
    for action in [Action::RunPause, Action::StepCommand, Action::StepEvent, Action::StepPhase] {
        model.hint = None;
        assert!(perform(&mut model, &snapshot, action).is_empty(), "{action:?}");
        assert!(said(&model).contains(":placed=X,Y,DEG"), "{}", said(&model));
    }
    // With a boundary it looks for its place by itself.
    let Known::Known(robot) = &mut snapshot.robot else { panic!("it is heard") };
    robot.needs_place = false;
    snapshot.map.closed = true;
    assert_eq!(perform(&mut model, &snapshot, Action::RunPause).len(), 1);
    // Unless it did not find it: then it waits for a word again.
    let Known::Known(robot) = &mut snapshot.robot else { panic!("it is heard") };
    robot.needs_place = true;
    for action in [Action::RunPause, Action::StepCommand, Action::StepEvent, Action::StepPhase] {
        model.hint = None;
        assert!(perform(&mut model, &snapshot, action).is_empty(), "{action:?}");
        let said = said(&model);
        assert!(said.contains(":placed=X,Y,DEG") && said.contains(":placed alone"), "{said}");
    }
}

#[test]
fn in_a_replay_there_is_no_robot_to_ask_about() {
    let (mut model, mut snapshot) = waiting();
    (snapshot.run, snapshot.recorded) = (RunState::Running, true);
    assert_eq!(perform(&mut model, &snapshot, Action::Quit), [Effect::Quit]);
    let space = Key::parse("space").expect("a key");
    model.overlay = Overlay::Line("at".into());
    assert!(press(&mut model, &snapshot, space).is_empty());
    assert_eq!(model.overlay, Overlay::Line("at ".into()));
    snapshot.recorded = false;
    assert_eq!(press(&mut model, &snapshot, space), [Effect::Intent(Intent::Stop)]);
    assert_eq!(
        model.overlay,
        Overlay::Line("at  ".into()),
        "a name that is typed keeps its spaces"
    );
}

/// The first lap hangs on nothing but where the robot has been since: it is not dropped by one line of text.
#[test]
fn a_robot_is_not_put_elsewhere_on_its_first_lap_before_it_was_stopped() {
    let (mut model, mut snapshot) = waiting();
    snapshot.robot = Known::Known(at_rest());
    let near = Some(Pose::new(1.0, 1.0, 0.0));
    let placed = [Effect::Intent(Intent::Placed { near })];
    let put = |model: &mut Model, snapshot: &Snapshot| obey(model, snapshot, Command::Placed(near));
    assert_eq!(put(&mut model, &snapshot), placed, "nothing was met yet");
    let contact = Contact {
        point: Point::new(1.0, 0.0),
        from: Point::new(1.0, 0.2),
        sensor: Some(0),
        time: 1.0,
        kind: ContactKind::Range,
    };
    snapshot.map.contacts.push(contact);
    assert!(put(&mut model, &snapshot).is_empty(), "the lap is dropped");
    let said = &model.hint.as_ref().expect("a remark").text;
    assert!(said.contains("the lap so far is dropped") && said.contains("space stops"), "{said}");
    (snapshot.run, snapshot.latched) = (RunState::Stopped, true);
    assert_eq!(put(&mut model, &snapshot), placed);
}

/// A real robot's keeper may be busy, with a plan: what it was asked for is not in the picture yet.
#[test]
fn what_was_asked_for_may_move_the_robot_before_it_is_seen_to() {
    let (mut model, mut snapshot) = waiting();
    snapshot.robot = Known::Known(at_rest());
    let (space, run) = (Key::parse("space").expect("a key"), Key::parse("r").expect("a key"));
    assert_eq!(press(&mut model, &snapshot, run), [Effect::Intent(Intent::Run)]);
    model.overlay = Overlay::Line("at".into());
    assert!(press(&mut model, &snapshot, space).is_empty(), "nothing moves: it is a letter");
    snapshot.asked = true;
    assert_eq!(press(&mut model, &snapshot, space), [Effect::Intent(Intent::Stop)]);
    model.overlay = Overlay::None;
    assert_eq!(press(&mut model, &snapshot, run), [Effect::Intent(Intent::Pause)]);
    assert!(press(&mut model, &snapshot, Key::parse("q").expect("a key")).is_empty());
    assert_eq!(model.overlay, Overlay::ConfirmQuit);
}

/// Told to stop is not yet stopped.
#[test]
fn a_robot_is_stopped_when_it_says_so() {
    let (model, mut snapshot) = waiting();
    (snapshot.run, snapshot.latched) = (RunState::Stopped, true);
    for (moving, shown, not) in [(true, "STOPPING", "STOPPED"), (false, "STOPPED", "STOPPING")] {
        let view = RobotView { moving, ..at_rest() };
        for robot in [Known::Known(view), Known::Stale { value: view, age: 2.0 }] {
            snapshot.robot = robot;
            let (symbols, _) = crate::console::frame::planes(&model, &snapshot);
            assert!(symbols.contains(shown) && !symbols.contains(not), "{symbols}");
            let spaced = |word: &str| word.chars().map(String::from).collect::<Vec<_>>().join(" ");
            assert!(symbols.contains(&spaced(shown)), "{symbols}");
            assert!(!symbols.contains(&spaced(not)), "{symbols}");
        }
    }
}

/// A whole file may be pasted by mistake, and no key is heard while it is taken in.
#[test]
fn what_is_longer_than_any_command_is_not_taken_in() {
    let (mut model, _) = waiting();
    model.overlay = Overlay::Line("export=".into());
    paste(&mut model, &"a".repeat(1_000_000));
    let Overlay::Line(line) = &model.overlay else { panic!("a line is typed") };
    let letters = line.text().len();
    assert!((500..5000).contains(&letters), "{letters}");
}

/// What was to be said to the robot then is nothing to be said to its record: it plays on, and pauses.
#[test]
fn a_replay_plays_on_over_a_stop_and_over_a_robot_that_asks_where_it_is() {
    let (mut model, mut snapshot) = waiting();
    (snapshot.recorded, snapshot.alpha_is_open) = (true, false);
    snapshot.robot = Known::Known(RobotView { pose: None, needs_place: true, ..at_rest() });
    for action in [Action::RunPause, Action::StepCommand, Action::StepEvent, Action::StepPhase] {
        assert_eq!(perform(&mut model, &snapshot, action).len(), 1, "{action:?}: {:?}", model.hint);
    }
    // Under way, it shows the run as it was.
    snapshot.robot = Known::Known(at_rest());
    (snapshot.run, snapshot.latched) = (RunState::Stopped, true);
    let pause = perform(&mut model, &snapshot, Action::RunPause);
    assert_eq!(pause, [Effect::Intent(Intent::Pause)], "{:?}", model.hint);
    let (symbols, _) = crate::console::frame::planes(&model, &snapshot);
    assert!(symbols.contains("S T O P P E D") && symbols.contains("r play/pause"), "{symbols}");
    assert!(!symbols.contains("clears the stop"), "{symbols}");
}

#[test]
fn a_wall_is_taped_by_its_number_on_the_list() {
    use crate::geometry::Ring;
    use crate::mapping::map::{Shape, ShapeClass};
    let (mut model, mut snapshot) = waiting();
    let tape = |model: &mut Model, snapshot: &Snapshot, wall, length| {
        let effects = obey(model, snapshot, Command::TapeWall { wall, length });
        (effects, model.hint.take().map_or_else(String::new, |hint| hint.text))
    };
    let (none, said) = tape(&mut model, &snapshot, 0, 4.0);
    assert!(none.is_empty() && said.contains("X,Y:X,Y=M"), "{said}");
    let corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)].map(|(x, y)| Point::new(x, y));
    let (outline, vertices) = (Ring::polygon(&corners), corners.to_vec());
    let class = ShapeClass::Convex;
    snapshot.map.shape = Some(Shape { class, outline, vertices, parts: Vec::new() });
    let (taped, _) = tape(&mut model, &snapshot, 1, 3.02);
    let [Effect::Intent(Intent::SetTape { from, to, length })] = taped[..] else {
        panic!("{taped:?}")
    };
    assert_eq!((from, to, length), (corners[1], corners[2], 3.02));
    let (none, said) = tape(&mut model, &snapshot, 4, 3.0);
    assert!(none.is_empty() && said.contains("no W5: the last is W4"), "{said}");
    let (none, said) = tape(&mut model, &snapshot, 0, 0.1);
    assert!(none.is_empty() && said.contains("at least"), "{said}");
}

#[test]
fn the_map_is_not_lost_by_going_further_and_further_away() {
    let (mut model, snapshot) = waiting();
    for _ in 0..100 {
        perform(&mut model, &snapshot, Action::ZoomOut);
    }
    let map = Regions::of(80, 24).expect("large enough").map;
    let ranges =
        [model.camera, Camera::Fit].map(|camera| viewport(&camera, &snapshot, map).x_range());
    assert!(ranges[0] > 5.0 * ranges[1] && ranges[0] < 10.0 * ranges[1], "{ranges:?}");
}

#[test]
fn however_near_the_title_says_how_much_is_shown() {
    let (mut model, snapshot) = waiting();
    let title = |model: &Model| {
        let (symbols, _) = crate::console::frame::planes(model, &snapshot);
        let row = symbols.lines().find(|row| row.contains(" map ")).expect("a title").to_owned();
        row.split("· ").nth(1).expect("a size").trim_end_matches(['─', ' ']).to_owned()
    };
    let whole = title(&model);
    assert!(whole.contains("m shown") && !whole.contains("cm"), "{whole}");
    for _ in 0..100 {
        perform(&mut model, &snapshot, Action::ZoomIn);
    }
    let near = title(&model);
    assert_eq!(near, "5.0 × 2.8 cm shown");
}

#[test]
fn what_has_no_key_is_called_by_its_name() {
    let bare = Keymap::parse("[keys]\nstop = [\"space\"]\nquit = [\"q\"]\n", "bare.toml");
    let bare = bare.expect("a keymap");
    assert_eq!(bare.way(Action::ClearStop), "(no key for clear)");
    assert!(bare.out_of_reach().contains(&"clear") && !bare.out_of_reach().contains(&"stop"));
    let line = "[keys]\nstop = [\"space\"]\nquit = [\"q\"]\ncommand-line = [\":\"]\n";
    let line = Keymap::parse(line, "line.toml").expect("a keymap");
    assert_eq!(line.way(Action::ClearStop), ":clear");
    assert!(line.out_of_reach().is_empty(), "everything has a name");
    assert_eq!(Keymap::default().way(Action::ClearStop), "c");
}

/// Whoever's hands know one key only: it stops, whatever the keymap has made of the others.
#[test]
fn ctrl_c_stops_the_robot_whatever_the_keymap_says() {
    let ctrl_c = Key::parse("ctrl-c").expect("a key");
    let bare = "[keys]\nstop = [\"f9\"]\nquit = [\"f10\"]\n";
    let other = format!("{bare}fit = [\"ctrl-c\"]\n");
    let stop = [Effect::Intent(Intent::Stop)];
    for text in [super::super::keymap::DEFAULT, bare, &other] {
        let keymap = Keymap::parse(text, "my.toml").expect("a keymap");
        let (_, mut snapshot) = waiting();
        snapshot.run = RunState::Running;
        for (cols, rows) in [(80, 24), (40, 12)] {
            for overlay in
                [Overlay::None, Overlay::Help(0), Overlay::Line("at".into()), Overlay::ConfirmQuit]
            {
                let mut model = Model { overlay, ..Model::new(cols, rows, keymap.clone()) };
                assert_eq!(press(&mut model, &snapshot, ctrl_c), stop, "{:?}", model.overlay);
            }
        }
    }
    // At rest it is what the keymap says: by default it leaves.
    let (mut model, snapshot) = waiting();
    assert_eq!(press(&mut model, &snapshot, ctrl_c), [Effect::Quit]);
    let mut model = Model { keymap: Keymap::parse(bare, "my.toml").expect("a keymap"), ..model };
    assert_eq!(press(&mut model, &snapshot, ctrl_c), stop);
}

#[test]
fn ctrl_z_stops_the_robot_and_leaves_for_the_shell_whatever_is_open() {
    let ctrl_z = Key::parse("ctrl-z").expect("a key");
    let (_, mut snapshot) = waiting();
    snapshot.run = RunState::Running;
    for overlay in [
        Overlay::None,
        Overlay::Help(0),
        Overlay::List(0),
        Overlay::Line("at".into()),
        Overlay::ConfirmQuit,
        Overlay::ConfirmFinish,
        Overlay::ConfirmAnew,
    ] {
        let mut model = Model { overlay, ..Model::new(80, 24, Keymap::default()) };
        let effects = press(&mut model, &snapshot, ctrl_z);
        assert_eq!(effects, [Effect::Intent(Intent::Stop), Effect::Suspend], "{:?}", model.overlay);
    }
}

#[test]
fn any_key_but_yes_is_no() {
    let (_, mut snapshot) = waiting();
    snapshot.run = RunState::Running;
    for name in ["q", "n", "enter", "x"] {
        let mut model =
            Model { overlay: Overlay::ConfirmQuit, ..Model::new(80, 24, Keymap::default()) };
        let key = Key::parse(name).expect("a key");
        assert!(press(&mut model, &snapshot, key).is_empty(), "{name} left");
        assert_eq!(model.overlay, Overlay::None, "{name} is an answer");
    }
}

#[test]
fn laps_that_are_closed_are_dropped_only_after_a_yes() {
    let key = |name| Key::parse(name).expect("a key");
    let (mut model, mut snapshot) = waiting();
    let dropped = [Effect::Intent(Intent::LapAnew)];
    // The run says why there is nothing to drop.
    assert_eq!(press(&mut model, &snapshot, key("B")), dropped);
    (snapshot.laps_are_open, snapshot.map.laps, snapshot.run) = (true, 3, RunState::Paused);
    for (answer, effects) in [("n", &[][..]), ("B", &[]), ("y", &dropped)] {
        assert!(press(&mut model, &snapshot, key("B")).is_empty(), "it asks first");
        assert_eq!(model.overlay, Overlay::ConfirmAnew);
        assert_eq!(press(&mut model, &snapshot, key(answer)), effects, "{answer}");
        assert_eq!(model.overlay, Overlay::None);
    }
}

#[test]
fn what_a_toggle_says_is_so_now_or_it_says_when() {
    let (mut model, mut snapshot) = waiting();
    let says = |model: &mut Model, snapshot: &Snapshot, action| {
        perform(model, snapshot, action);
        model.hint.take().expect("a remark").text
    };
    let outline = "as soon as there is an outline";
    let contacts = says(&mut model, &snapshot, Action::ToggleContacts);
    assert_eq!(contacts, "contacts: shown, and still when there is an outline");
    let contacts = says(&mut model, &snapshot, Action::ToggleContacts);
    assert_eq!(contacts, "contacts: shown as long as there is no outline, then hidden");
    let walls = says(&mut model, &snapshot, Action::ToggleWalls);
    assert_eq!(walls, format!("walls: shown {outline}"));
    assert_eq!(says(&mut model, &snapshot, Action::ToggleWalls), "walls: hidden");
    let rejected = says(&mut model, &snapshot, Action::ToggleRejected);
    assert_eq!(rejected, "rejected: shown as soon as there is a plan");
    assert_eq!(says(&mut model, &snapshot, Action::TogglePlan), "plan: hidden");
    assert_eq!(says(&mut model, &snapshot, Action::ToggleRejected), "rejected: hidden");
    let figures = PlanFigures { strategy: Strategy::Lean, lines: 0, length: 0.0, hidden_disc: 0.0 };
    let (lines, order, alternatives) = Default::default();
    snapshot.map.plan = Some(Plan { alpha: 0.25, lines, order, figures, alternatives });
    let rejected = says(&mut model, &snapshot, Action::ToggleRejected);
    assert_eq!(rejected, "rejected: shown with the plan, which is hidden");
    assert_eq!(says(&mut model, &snapshot, Action::ToggleRejected), "rejected: hidden");
    snapshot.map.plan = None;
    snapshot.run = RunState::Failed(Failure::Ended);
    let plan = says(&mut model, &snapshot, Action::TogglePlan);
    assert_eq!(plan, "plan: there is no plan");
    assert_eq!(says(&mut model, &snapshot, Action::ToggleTrajectory), "trajectory: shown");
}

/// A run may end before anything was fitted: then there is nothing to square, nor a plan to show.
#[test]
fn at_the_end_only_what_there_is_is_offered() {
    let (mut model, mut snapshot) = waiting();
    snapshot.run = RunState::Failed(Failure::LapEndless);
    let footer = |model: &Model, snapshot: &Snapshot| {
        let (symbols, _) = crate::console::frame::planes(model, snapshot);
        symbols.lines().last().expect("a footer").to_owned()
    };
    model.size = (160, 40);
    let none = footer(&model, &snapshot);
    assert!(!none.contains("square") && !none.contains("plan") && none.contains("2 way"), "{none}");
    assert!(perform(&mut model, &snapshot, Action::Square).is_empty());
    assert_eq!(
        model.hint.take().expect("a remark").text,
        "no outline was found: there is nothing to square"
    );
    model.overlay = Overlay::List(0);
    let (list, _) = crate::console::frame::planes(&model, &snapshot);
    assert!(list.contains("nothing: the run ended before"), "{list}");
    model.overlay = Overlay::None;
    snapshot.map.shape = Some(crate::mapping::map::Shape {
        class: crate::mapping::map::ShapeClass::Convex,
        outline: crate::geometry::Ring::default(),
        vertices: Vec::new(),
        parts: Vec::new(),
    });
    assert!(footer(&model, &snapshot).contains("S square"));
    assert_eq!(perform(&mut model, &snapshot, Action::Square), [Effect::Intent(Intent::Square)]);
}

#[test]
fn a_room_as_large_as_there_are_any_is_shown_whole_on_the_smallest_screen() {
    let (model, mut snapshot) = waiting();
    for corner in [(0.0, 0.0), (1000.0, 0.0), (0.0, 1000.0)] {
        snapshot.robot = Known::Known(RobotView {
            pose: Some(Pose::new(corner.0, corner.1, 0.0)),
            position_sd: 0.0,
            switches: SwitchSet::default(),
            bumper: false,
            moving: false,
            needs_place: false,
        });
        let map = Regions::of(60, 16).expect("large enough").map;
        let view = viewport(&model.camera, &snapshot, map);
        for (x, y) in [corner, (0.0, 0.0)] {
            assert!(view.to_cell(Point::new(x, y)).is_some(), "{x}, {y} is out of view");
        }
        let (symbols, _) =
            crate::console::frame::planes(&Model::new(60, 16, Keymap::default()), &snapshot);
        assert!(
            symbols.lines().nth(10).is_some_and(|row| row.contains(" m")),
            "a scale:\n{symbols}"
        );
    }
}

#[test]
fn the_title_of_the_map_leaves_that_of_the_panel_alone() {
    let (mut model, snapshot) = waiting();
    for (cols, rows) in [(60, 16), (76, 24), (80, 24), (120, 40)] {
        model.size = (cols, rows);
        for action in
            [Action::ZoomIn, Action::Follow, Action::ZoomOut, Action::Fit, Action::PanLeft]
        {
            perform(&mut model, &snapshot, action);
            for _ in 0..20 {
                perform(&mut model, &snapshot, Action::ZoomOut);
            }
            let (symbols, _) = crate::console::frame::planes(&model, &snapshot);
            let row = symbols.lines().find(|row| row.contains(" map · ")).expect("a title");
            assert!(row.contains("┬─ robot ─") && row.contains(" m shown"), "{row}");
        }
    }
}

#[test]
fn who_clears_the_stop_of_a_robot_that_is_not_heard_is_not_told_that_it_runs_on() {
    let (mut model, mut snapshot) = waiting();
    (snapshot.run, snapshot.latched) = (RunState::Stopped, true);
    let value = at_rest();
    let mut said = |robot: Known<RobotView>| {
        snapshot.robot = robot;
        assert_eq!(perform(&mut model, &snapshot, Action::ClearStop).len(), 1);
        model.hint.take().expect("a remark").text
    };
    assert_eq!(said(Known::Known(value)), "stop cleared; r runs on");
    let unheard = said(Known::Stale { value, age: 9.0 });
    assert_eq!(
        unheard,
        "stop cleared; the robot is not heard: see to the link, or quit and --resume"
    );
}

/// What is told to a robot that nobody has heard of yet is lost: so nothing is taken for it, and nothing offered.
#[test]
fn a_robot_that_has_not_answered_yet_is_told_nothing() {
    let (mut model, mut snapshot) = waiting();
    (model.speed, model.size) = (None, (160, 40));
    for name in ["r", "n", "e", "p", "[", "]", "L", "B", "S", "X"] {
        let effects = press(&mut model, &snapshot, Key::parse(name).expect("a key"));
        assert!(effects.is_empty() && model.overlay == Overlay::None, "{name}: {effects:?}");
        let said = model.remark(&snapshot).expect("a remark");
        assert!(said.refusal && said.text.contains("has not answered yet"), "{name}: {said:?}");
    }
    for line in ["alpha=0.3", "tape=0,0:5,0=5.02", "tape=W1=5.02", "placed", "placed=1,1,0"] {
        let command = Command::parse(line).expect("a command");
        assert!(obey(&mut model, &snapshot, command).is_empty(), "{line}");
        assert!(model.remark(&snapshot).is_some_and(|hint| hint.refusal), "{line}");
    }
    // Whatever moves, a stop is on its way.
    let stop = perform(&mut model, &snapshot, Action::Stop);
    assert_eq!(stop, [Effect::Intent(Intent::Stop)]);
    let told = model.remark(&snapshot).cloned();
    let frame =
        |model: &Model, snapshot: &Snapshot| crate::console::frame::planes(model, snapshot).0;
    model.hint = None;
    let alone = frame(&model, &snapshot);
    for offered in ["r run/pause", "n command", "[ ] α", "r begins"] {
        assert!(!alone.contains(offered), "{offered}:\n{alone}");
    }
    model.hint = told;
    snapshot.robot = Known::Known(at_rest());
    assert_eq!(model.remark(&snapshot), None, "it has answered");
    assert!(frame(&model, &snapshot).contains("r run/pause"));
    let run = perform(&mut model, &snapshot, Action::RunPause);
    assert_eq!(run, [Effect::Intent(Intent::Run)]);
}
