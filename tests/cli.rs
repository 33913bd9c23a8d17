//! The program as a shell sees it: exit status, and where which words go.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

mod shell;

use shell::{periplus, place, refused};
use std::fs;
use std::io::Read;
use std::path::PathBuf;
use std::process::{Command, Stdio};

#[test]
fn help_and_version_are_results() {
    for flag in ["--help", "--version"] {
        let output = periplus(&[flag]);
        assert_eq!(output.status.code(), Some(0), "{flag}");
        assert!(!output.stdout.is_empty() && output.stderr.is_empty(), "{flag} talks elsewhere");
    }
}

#[test]
fn bad_values_are_refused_with_the_flag_and_what_it_takes() {
    let cases: &[(&[&str], &[&str])] = &[
        (&["run", "--alpha", "0"], &["--alpha", "length"]),
        (&["run", "--alpha", "-0.5"], &["--alpha", "length"]),
        (&["run", "--alpha", "nan"], &["--alpha", "not a finite number"]),
        (&["run", "--alpha", "inf"], &["--alpha", "not a finite number"]),
        (&["run", "--alpha", "0.01"], &["--alpha", "length from 0.05 to 2 m"]),
        (&["run", "--alpha", "5"], &["--alpha", "length from 0.05 to 2 m"]),
        (&["run", "--name", ""], &["--name", "has letters"]),
        (&["robot", "--world", "a", "--pty", "--alpha", "0.3"], &["--alpha"]),
        (&["run", "--alpha", "wide"], &["--alpha", "not a number"]),
        (&["run", "--plan", "leen"], &["--plan", "leen", "lean"]),
        (&["run", "--contour", "three-pass"], &["--contour", "two-pass"]),
        (&["run", "--noise", "some"], &["--noise", "calibrated"]),
        (&["run", "--seed=-1"], &["--seed"]),
        (&["run", "--start", "1,2"], &["--start", "X,Y,DEG"]),
        (&["run", "--start", "1,2,nan"], &["--start", "not a finite number"]),
        (&["run", "--until", "end"], &["--until", "boundary"]),
        (&["snapshot", "--world", "a", "--until", "plan", "--size", "80"], &["--size", "80x24"]),
        // A minus is no flag where a number belongs.
        (
            &["snapshot", "--replay", "a", "--at", "-5", "--size", "80x24"],
            &["--at", "a time is not negative"],
        ),
        (
            &["snapshot", "--world", "a", "--until", "plan", "--size", "-3x4"],
            &["--size", "from 60x16"],
        ),
        (
            &["robot", "--world", "sims/rectangle.toml", "--pty", "--speed", "-3"],
            &["--speed -3", "times as fast"],
        ),
        (&["run", "--seed", "99999999999999999999"], &["--seed", "too large"]),
        (
            &["run", "--port", "127.0.0.1:3333", "--out", "target/nowhere"],
            &["no such port", "tcp://127.0.0.1:3333"],
        ),
        (&["snapshot", "--replay", "a", "--size", "80x24"], &["--at"]),
        (&["snapshot", "--size", "80x24"], &["--world"]),
        (
            &["snapshot", "--world", "a", "--until", "plan", "--size", "59x16"],
            &["--size 59x16", "60x16 at least"],
        ),
        // What would count for nothing is not taken.
        (&["run", "--world", "a", "--baud", "115200", "--out", "b"], &["--baud", "--world"]),
        (&["run", "--port", "tcp://a:1", "--noise", "raw", "--out", "b"], &["--port", "--noise"]),
        (
            &["snapshot", "--replay", "a", "--at", "1", "--seed", "2", "--size", "80x24"],
            &["--replay", "--seed"],
        ),
        (
            &["snapshot", "--replay", "a", "--at", "1", "--alpha", ".3", "--size", "80x24"],
            &["--replay", "--alpha"],
        ),
        (&["fly"], &["fly"]),
    ];
    for (arguments, words) in cases {
        refused(arguments, words);
    }
}

#[test]
fn what_is_missing_is_named() {
    refused(&["run", "--out", "x"], &["needs --world FILE or --port DEVICE"]);
    refused(&["run", "--world", "room.toml"], &["needs --out DIR"]);
    refused(&["check"], &["FILE"]);
    refused(&["robot", "--pty"], &["robot", "needs --world FILE"]);
    refused(&["snapshot", "--world", "room.toml", "--size", "80x24"], &["--until"]);
}

#[test]
fn a_taped_length_that_is_not_used_is_told_at_the_end() {
    let dir = std::env::temp_dir().join(format!("periplus-untaped-{}", std::process::id()));
    let _ = fs::remove_dir_all(&dir);
    let out = dir.to_str().expect("a path");
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/l_room.toml");
    let tape = ["--tape", "0,0:5,0=9", "--until", "shape", "--out", out];
    let run = periplus(&[&["run", "--world", world], tape.as_slice()].concat());
    let told = String::from_utf8_lossy(&run.stdout);
    assert!(told.contains("taped length not used: 9.000 m, but 4.99"), "{told}");
    let report = fs::read_to_string(dir.join("report.json")).expect("a report");
    assert!(report.contains("\"not_taped\": \"taped length not used"), "{report}");
    let _ = fs::remove_dir_all(&dir);
}

#[test]
fn a_taped_length_that_is_none_is_refused() {
    let run = ["run", "--world", "a", "--out", "x", "--tape"];
    for bad in ["5.02", "0,0:1,0", "0,0:1,0=-3", "0,0:1,0=far"] {
        refused(&[run.as_slice(), &[bad]].concat(), &["--tape"]);
    }
}

#[test]
fn a_folder_with_a_run_in_it_is_refused() {
    let dir = place("taken");
    fs::write(dir.join("report.json"), "{}").expect("a report");
    let shown = dir.to_str().expect("a plain path");
    refused(&["run", "--world", "room.toml", "--out", shown], &[shown, "holds another run"]);
    assert_eq!(fs::read_dir(&dir).expect("the folder").count(), 1, "nothing was added");
}

#[test]
fn the_console_without_a_terminal_hints_at_run_and_snapshot() {
    refused(&[], &["terminal", "periplus run", "periplus snapshot"]);
}

#[test]
fn a_settings_file_is_told_by_file_line_and_key() {
    let dir = place("config");
    let file = dir.join("run.toml");
    let shown = file.to_str().expect("a plain path");
    let cases: &[(&str, &[&str])] = &[
        ("seed = 3\nalpa = 0.3\n", &["run.toml:2:", "`alpa`", "did you mean `alpha`"]),
        ("\u{feff}alpa = 0.3\n", &["run.toml:1:", "`alpa`"]),
        ("out = \"a\"\nport = \"tcp://nowhere\"\n", &["run.toml:2: `port`", "tcp://HOST:PORT"]),
        ("wallpaper = 3\n", &["run.toml:1:", "`wallpaper`", "those there are: alpha, plan"]),
        ("\"a\\u001b[2J\" = 3\n", &["run.toml:1:", "unknown key `a?[2J`"]),
        ("out = \"a\"\nresume = \"b\"\n", &["run.toml:2:", "`resume`", "leave out"]),
        ("\nalpha = 0\n", &["run.toml:2:", "`alpha`", "length"]),
        ("alpha = nan\n", &["run.toml:1:", "not a finite number"]),
        ("plan = \"leen\"\n", &["run.toml:1:", "paper, lean, lanes"]),
        ("start = [1, 2]\n", &["run.toml:1:", "X,Y,DEG"]),
        ("alpha = = 1\n", &["run.toml:1:"]),
        ("placed = [1, 1, 0]\n", &["run.toml:1:", "`placed`", "only a flag: --placed"]),
        ("\nbaud = 9600\n", &["run.toml:2:", "`baud`", "only a flag: --baud"]),
    ];
    for (text, words) in cases {
        fs::write(&file, text).expect("a settings file");
        refused(&["run", "--config", shown], words);
    }
    refused(&["run", "--config", "/nowhere/run.toml"], &["/nowhere/run.toml"]);
    fs::write(&file, "laps = 1\n").expect("a settings file");
    refused(&["calibrate", "--config", shown], &["laps: two at least"]);
    refused(&["calibrate", "--laps", "1"], &["laps: two at least"]);
    fs::write(&file, "alpha = 0.3\nstart = [1, 2, 90]\nworld = \"room.toml\"\n").expect("a file");
    refused(&["run", "--config", shown], &["needs --out DIR"]);
}

#[test]
fn a_file_that_is_not_there_is_told_with_what_it_was_to_be() {
    let world = "sims/rectangle.toml";
    for (arguments, words) in [
        (&["run", "--world", "nosuch", "--out", "x"][..], "nosuch: cannot be read: "),
        (&["run", "--world", "sims", "--out", "x"], "sims: a folder; name a world in it"),
        (&["run", "--world", world, "--out", "x", "--chassis", "nosuch"], "the chassis nosuch: "),
        (&["run", "--world", world, "--out", "x", "--config", "nosuch"], "the config nosuch: "),
        (&["replay", "nosuch"], "the record nosuch: "),
        (&["run", "--resume", "nosuch"], "the record nosuch: "),
        // An address of nobody (RFC 5737): there is no port to have rights to.
        (&["robot", "--world", world, "--port", "tcp://192.0.2.1:80"], "cannot be waited at"),
    ] {
        refused(arguments, &[words]);
    }
}

#[test]
fn what_nobody_can_meet_in_a_world_is_told() {
    let file = place("outside").join("room.toml");
    let text = include_str!("../sims/rectangle.toml").to_owned()
        + "\n[[objects]]\nname = \"far\"\ncircle = { center = [50, 50], radius = 0.2 }\n";
    fs::write(&file, text).expect("a file");
    let output = periplus(&["check", file.to_str().expect("a plain path"), "sims/rectangle.toml"]);
    let told = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{told}");
    let lines: Vec<&str> = told.lines().collect();
    assert!(lines[0].contains("object \"far\" lies outside the room"), "{told}");
    assert!(lines[1].contains("ok, world of") && !lines[1].contains("outside"), "{told}");
}

#[test]
fn a_file_that_is_neither_world_nor_keymap_is_told_what_was_expected() {
    let dir = place("check");
    let file = dir.join("other.toml");
    fs::write(&file, "colour = \"red\"\n").expect("a file");
    let output = periplus(&["check", file.to_str().expect("a plain path")]);
    let told = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("[boundary]") && told.contains("[keys]"), "{told}");
    assert!(told.contains("other.toml:1: `colour`"), "{told}");
    fs::write(&file, "\nradiuss = 0.1\n").expect("a file");
    let output = periplus(&["check", file.to_str().expect("a plain path")]);
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(told.contains("other.toml:2: `radiuss`: no kind of file has such a key"), "{told}");
    assert!(told.contains("Did you mean `radius`?"), "{told}");
    fs::write(&file, "stop = [\"x\"]\nquit = [\"y\"]\n").expect("a file");
    let output = periplus(&["check", file.to_str().expect("a plain path")]);
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(told.contains("other.toml:1: `stop`: a keymap begins with a line [keys]"), "{told}");
    fs::write(&file, "# radius = 0.1\n").expect("a file");
    let output = periplus(&["check", file.to_str().expect("a plain path")]);
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(told.contains("other.toml: nothing is set in the file"), "{told}");
    fs::write(&file, "colour = \n").expect("a file");
    let output = periplus(&["check", file.to_str().expect("a plain path"), "/nowhere.toml"]);
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(told.contains("other.toml:1:") && told.contains("/nowhere.toml"), "{told}");
    assert_eq!(told.lines().count(), 2, "one line for each file: {told}");
    let missing = dir.join("nosuch");
    let shown = [&missing, &dir].map(|path| path.to_str().expect("a plain path"));
    let output = periplus(&["check", shown[0], shown[1]]);
    let told = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("nosuch: No such file") && !told.contains("expected"), "{told}");
    assert!(told.contains("a folder; name the files in it"), "{told}");
}

#[test]
fn check_knows_each_kind_of_file_and_begins_with_its_name() {
    let dir = place("kinds");
    let told = |name: &str, bytes: &[u8]| {
        let file = dir.join(name);
        fs::write(&file, bytes).expect("a file");
        let output = periplus(&["check", file.to_str().expect("a plain path")]);
        let told = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(told.starts_with(&format!("{}:", file.display())), "{told}");
        assert_eq!(told.lines().count(), 1, "{told}");
        (output.status.code(), told)
    };
    for (text, words) in [
        (&b""[..], "the file is empty"),
        (b"  \n", "the file is empty"),
        (b"\xff\x00\xfe", "cannot be read: "),
        (b"radius = 9\n", ":1: `radius`: 9 is not between"),
        (b"radius = 0.1\nspead = 1\n", ":2: unknown key `spead`, did you mean `speed`?"),
        (b"seed = 3\nalpha = 9\n", ":2: `alpha`: "),
        (b"start = { x = 1, y = 1 }\n", "`boundary` is missing"),
        (b"colour = 1\n", "a chassis"),
        (
            b"world = \"room.toml\"\nport = \"/dev/ttyUSB0\"\n",
            ":2: `port`: a run is of the simulator",
        ),
        (b"seed = 3\nnoise = none\n", ":2: a value is a number without a unit"),
    ] {
        let (status, told) = told("a.toml", text);
        assert!(status == Some(2) && told.contains(words), "{told}");
    }
    let (status, chassis) = told("b.toml", b"radius = 0.12\nsensors = 4\n");
    assert!(status == Some(0) && chassis.contains("ok, chassis"), "{chassis}");
    assert!(!chassis.contains("sent at"), "it stands in time: {chassis}");
    let (status, weak) = told("b.toml", b"acceleration = 0.1\n");
    assert!(status == Some(0) && weak.contains("sent at 0.07 m/s, not 0.20"), "{weak}");
    let (status, config) = told("c.toml", b"square = true\n");
    assert!(status == Some(0) && config.contains("ok, config"), "{config}");
    let (status, config) = told("c.toml", b"seed = 3\nalpha = 0.3\nstart = [1, 1, 90]\n");
    assert!(status == Some(0) && config.contains("ok, config"), "{config}");
}

#[test]
fn a_room_in_which_the_robot_cannot_move_is_told() {
    let dir = place("tight");
    let told = |size: f64, at: f64| {
        let file = dir.join("room.toml");
        let text = format!(
            "start = {{ x = {at}, y = {at} }}\n[boundary]\n\
             vertices = [[0, 0], [{size}, 0], [{size}, {size}], [0, {size}]]\n"
        );
        fs::write(&file, text).expect("a file");
        let output = periplus(&["check", file.to_str().expect("a plain path")]);
        assert_eq!(output.status.code(), Some(0), "it is a world all the same");
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    for (size, at) in [(0.2, 0.1), (0.26, 0.13), (0.34, 0.11)] {
        let told = told(size, at);
        assert!(told.contains("hardly room to move"), "{size}: {told}");
    }
    for (size, at) in [(0.5, 0.25), (4.0, 0.1), (900.0, 450.0)] {
        let told = told(size, at);
        assert!(!told.contains("hardly"), "{size}: {told}");
    }
}

/// One letter that is lost in the middle does not lose the run.
#[test]
fn what_is_whole_of_a_damaged_record_is_shown_and_handed_over() {
    let dir = place("damaged").join("run");
    let run = dir.to_str().expect("a path");
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    assert_eq!(
        periplus(&["run", "--world", world, "--until", "boundary", "--out", run]).status.code(),
        Some(0)
    );
    let record = dir.join("journal");
    let mut lines: Vec<Vec<u8>> = fs::read(&record)
        .expect("a record")
        .split_inclusive(|&byte| byte == b'\n')
        .map(<[u8]>::to_vec)
        .collect();
    let digit = lines[499].iter().rposition(u8::is_ascii_digit).expect("a digit");
    lines[499][digit] = if lines[499][digit] == b'7' { b'8' } else { b'7' };
    let left_out = lines.len() - 499;
    fs::write(&record, lines.concat()).expect("a record");
    // A result that tells more than what is whole is handed over, however old it is.
    let old = std::time::SystemTime::UNIX_EPOCH;
    let results = ["map.json", "map.geojson", "map.svg"];
    for name in results {
        let file = fs::File::options().append(true).open(dir.join(name)).expect("a result");
        file.set_modified(old).expect("its age");
        let format = name.split('.').nth(1).unwrap_or_default();
        let made = periplus(&["export", run, "--format", format, "--out", "-"]);
        let said = String::from_utf8_lossy(&made.stderr);
        assert!(said.contains("of which no more than the result tells is whole"), "{said}");
        assert!(made.stdout == fs::read(dir.join(name)).expect("a result"), "{name}: {said}");
    }
    for name in results {
        fs::remove_file(dir.join(name)).expect("a result");
    }
    let warned = |output: &std::process::Output| {
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{said}");
        let says =
            format!("damaged in line 500; it and what follows, {left_out} lines, is left out");
        assert!(said.contains(&says), "{said}");
    };
    let frame = periplus(&["snapshot", "--replay", run, "--at", "5", "--size", "80x24"]);
    warned(&frame);
    assert_eq!(String::from_utf8_lossy(&frame.stdout).lines().count(), 24);
    for format in ["json", "geojson", "svg"] {
        let made = periplus(&["export", run, "--format", format, "--out", "-"]);
        warned(&made);
        assert!(!made.stdout.is_empty());
    }
    // Nothing goes on from a record with a hole in it: what is behind that would be cut off.
    let bytes = fs::read(&record).expect("a record");
    refused(&["run", "--port", "tcp://127.0.0.1:1", "--resume", run], &["journal:500:", "export"]);
    assert_eq!(fs::read(&record).expect("a record"), bytes);
}

#[test]
fn squaring_is_told_at_the_end_and_in_the_report() {
    for (world, until, says, walls) in [
        ("sims/rectangle.toml", "shape", "squared: 4 walls", 4),
        ("sims/circle.toml", "shape", "nothing to square", 0),
    ] {
        let out = place("squared").join("run");
        let to = out.to_str().expect("a path");
        let run = periplus(&["run", "--world", world, "--until", until, "--square", "--out", to]);
        let said = String::from_utf8_lossy(&run.stdout);
        assert!(said.contains(says), "{world}: {said}");
        assert!(said.lines().last().is_some_and(|line| line.starts_with("complete")), "{said}");
        let report = fs::read_to_string(out.join("report.json")).expect("a report");
        let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
        assert_eq!(report["boundary"]["squared"]["walls"], walls, "{world}");
    }
}

#[test]
fn what_a_run_did_not_get_to_is_told_at_its_end() {
    let out = place("unreached").join("run");
    let to = out.to_str().expect("a path");
    let run = periplus(&["run", "--world", "sims/bedroom.geojson", "--noise", "none", "--out", to]);
    let said = String::from_utf8_lossy(&run.stdout);
    assert!(said.contains("touched by nobody: "), "{said}");
    assert!(said.lines().last().is_some_and(|line| line.starts_with("complete")), "{said}");
}

#[test]
fn export_hands_over_what_a_run_left() {
    let dir = place("export");
    fs::write(dir.join("map.svg"), "<svg/>").expect("a result");
    let out = dir.join("copy.svg");
    let (from, to) = (dir.to_str().expect("a path"), out.to_str().expect("a path"));
    let output = periplus(&["export", from, "--format", "svg", "--out", to]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(fs::read_to_string(&out).expect("the copy"), "<svg/>");
    refused(&["export", from, "--format", "png", "--out", to], &["map.png", "folder of a run"]);
    refused(&["export", from, "--format", "ros", "--out", to], &["map.json", "folder of a run"]);
    let square = r#"{"periplus_map":1,"name":"a room","alpha":0.25,"gap":0.34,"start":[1,1,0],
        "boundary":[[0,0],[2,0],[2,2],[0,2]]}"#;
    fs::write(dir.join("map.json"), square).expect("a result");
    let (yaml, picture) = (dir.join("room.yaml"), dir.join("room.pgm"));
    refused(
        &["export", from, "--format", "ros", "--out", picture.to_str().expect("a path")],
        &["room.yaml"],
    );
    let to = yaml.to_str().expect("a path");
    let output = periplus(&["export", from, "--format", "ros", "--out", to]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(fs::read_to_string(&yaml).expect("the YAML").starts_with("image: room.pgm\n"));
    assert!(fs::read(&picture).expect("the picture").starts_with(b"P5\n"));
    // What is there is not lost by a slip: not the YAML file to a picture, nor the picture beside it.
    let slip = ["export", from, "--format", "svg", "--out", to];
    refused(&slip, &["room.yaml: is there already", "--force"]);
    assert!(fs::read_to_string(&yaml).expect("the YAML").starts_with("image: room.pgm\n"));
    let beside = dir.join("beside.yaml");
    fs::write(dir.join("beside.pgm"), "a holiday").expect("a picture");
    let both = ["export", from, "--format", "ros", "--out", beside.to_str().expect("a path")];
    refused(&both, &["beside.pgm: is there already"]);
    assert!(!beside.exists(), "half of a pair was written");
    let output = periplus(&[&slip[..], &["--force"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(fs::read_to_string(&yaml).expect("the copy"), "<svg/>");
    // An empty file, as `mktemp` makes it, is there to be filled.
    fs::write(&yaml, "").expect("an empty file");
    assert_eq!(periplus(&slip).status.code(), Some(0));
}

#[test]
fn a_boundary_without_a_shape_is_as_long_as_its_wall() {
    let out = place("boundary_only").join("run");
    let output = periplus(&[
        "run",
        "--world",
        concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml"),
        "--until",
        "boundary",
        "--name",
        "the east wing",
        "--out",
        out.to_str().expect("a path"),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    // The map is not complete, and nobody says so.
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.starts_with("complete: boundary phase done, no further was asked for"), "{said}");
    // The log says that the run was to end here, and not first that the next phase begins.
    let record = fs::read_to_string(out.join("journal")).expect("a record");
    let begins = |phase: &str| record.contains(&format!(r#""phase_began","phase":"{phase}""#));
    assert!(begins("boundary") && !begins("shape"), "a phase begins that nobody asked for");
    let report = fs::read_to_string(out.join("report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!(report["world"], "the east wing");
    assert!(report["shape"].is_null(), "{}", report["shape"]);
    // 5 m by 4 m; its corners are joined from contact to contact.
    let perimeter = report["boundary"]["perimeter_m"].as_f64().expect("a length");
    assert!((17.0..18.1).contains(&perimeter), "{perimeter}");
}

#[test]
fn a_reader_that_goes_away_is_no_panic() {
    let files: Vec<String> = (0..3000).map(|k| format!("/nowhere/{k}.toml")).collect();
    let mut child = Command::new(env!("CARGO_BIN_EXE_periplus"))
        .arg("check")
        .args(&files)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let mut told = String::new();
    child.stderr.take().expect("piped").read_to_string(&mut told).expect("text");
    let status = child.wait().expect("an end").code();
    // What was found counts, whether or not anybody reads of it.
    assert_eq!(status, Some(2), "{told}");
    assert!(told.is_empty(), "a closed pipe is nobody's fault: {told}");
}

const ROOM: &str = "name = \"room\"\nstart = { x = 0.6, y = 0.6, heading = 0 }\n[boundary]\n\
                    vertices = [[0, 0], [4, 0], [4, 3], [0, 3]]\n";

#[test]
fn what_does_not_fit_the_room_is_refused_before_anything_is_written() {
    let dir = place("fit");
    let (world, out) = (dir.join("room.toml"), dir.join("out"));
    fs::write(&world, ROOM).expect("a world");
    let (world, to) = (world.to_str().expect("a path"), out.to_str().expect("a path"));
    let cases: &[(&[&str], &[&str])] = &[
        (&["--start", "9,9,0"], &["--start", "outside the room"]),
        (&["--start", "0.01,1,0"], &["--start"]),
        (&["--chassis", "/nowhere/robot.toml"], &["/nowhere/robot.toml"]),
        (&["--resume", "a"], &["--resume", "cannot be used with", "--out"]),
        (&["--tape", "0,0:4,0=4.0", "--until", "boundary"], &["until: shape at least", "--tape"]),
    ];
    for (more, words) in cases {
        let arguments = [&["run", "--world", world, "--out", to], *more].concat();
        refused(&arguments, words);
    }
    let closet = dir.join("closet.toml");
    fs::write(&closet, ROOM.replace("[4, 0], [4, 3], [0, 3]", "[1.5, 0], [1.5, 1.2], [0, 1.2]"))
        .expect("a world");
    let closet = ["run", "--world", closet.to_str().expect("a path"), "--out", to];
    let larger = ["α of 1.8 m is larger than the room", "1.50 x 1.20"];
    refused(&[&closet[..], &["--alpha", "1.8"]].concat(), &larger);
    let config = dir.join("run.toml");
    fs::write(&config, "alpha = 0.3\nstart = [9, 9, 0]\n").expect("a settings file");
    let config = config.to_str().expect("a path");
    let from_file = ["run", "--world", world, "--out", to, "--config", config];
    refused(&from_file, &["run.toml:2: `start`", "outside the room"]);
    refused(&[&from_file[..], &["--start", "8,8,0"]].concat(), &["--start", "(8, 8) lies outside"]);
    assert!(!out.exists(), "a refused run has made its folder");
}

#[test]
fn a_chassis_is_read_strictly() {
    let dir = place("chassis");
    let (world, file) = (dir.join("room.toml"), dir.join("robot.toml"));
    fs::write(&world, ROOM).expect("a world");
    let (world, shown) = (world.to_str().expect("a path"), file.to_str().expect("a path"));
    let switch = |(name, angle)| format!("[[sensors]]\nname = \"{name}\"\nangle = {angle}\n");
    let namesakes: String =
        [("front", 0), ("left", 90), ("right", -90), ("left", 45)].map(switch).concat();
    let cases: &[(&str, &[&str])] = &[
        ("radius = 0.1\nrang = 0.05\n", &["robot.toml:2:", "`rang`", "did you mean `range`"]),
        ("radius = -1\n", &["robot.toml:1:", "`radius`", "between"]),
        ("radius = nan\n", &["robot.toml:1:", "not a finite number"]),
        ("turn_rate = 1.5\n", &["robot.toml:1:", "1.5 is not between 10 and 720 degrees a second"]),
        ("speed = 20\n", &["robot.toml:1:", "20 is not between 0.01 and 2 metres a second"]),
        ("sensors = 3\n", &["robot.toml:1:", "from 4 to 16"]),
        ("[[sensors]]\nname = \"front\"\nangel = 0\n", &["robot.toml:3:", "`angel`", "`angle`"]),
        ("speed = \"fast\"\n", &["robot.toml:1:", "`speed`", "a string"]),
        ("range = 0.02\nhysteresis = 0.05\n", &["robot.toml:2:", "larger than the range"]),
        (&namesakes, &["robot.toml:1:", "two switches are called \"left\""]),
    ];
    for (text, words) in cases {
        fs::write(&file, text).expect("a chassis");
        let out = dir.join("out");
        let to = out.to_str().expect("a path");
        refused(&["run", "--world", world, "--out", to, "--chassis", shown], words);
    }
}

#[test]
fn check_says_ok_or_what_is_wrong_and_where() {
    let dir = place("worlds");
    let (good, bad) = (dir.join("good.toml"), dir.join("bad.toml"));
    fs::write(&good, ROOM).expect("a world");
    fs::write(&bad, ROOM.replace("vertices", "vertexes")).expect("a world");
    let (good, bad) = (good.to_str().expect("a path"), bad.to_str().expect("a path"));
    let output = periplus(&["check", good]);
    let told = String::from_utf8_lossy(&output.stdout);
    assert_eq!((output.status.code(), told.contains("ok")), (Some(0), true), "{told}");
    let output = periplus(&["check", good, bad]);
    let told = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(2), "one bad file: {told}");
    assert!(told.contains("vertexes") && told.contains("vertices"), "{told}");
}

#[test]
fn ports_and_robots_are_refused_with_what_to_try() {
    refused(&["run", "--port", "tcp://nowhere", "--out", "x"], &["--port", "tcp://HOST:PORT"]);
    let out = place("no-port").join("run");
    let out = out.to_str().expect("a path");
    let missing = "/dev/there-is-no-such-port";
    refused(&["run", "--port", missing, "--out", out], &[missing, "periplus ports"]);
    assert!(!PathBuf::from(out).exists(), "a run that never began left a folder");
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    refused(&["robot", "--world", world], &["--pty"]);
    refused(&["robot", "--world", world, "--pty", "--speed", "0"], &["--speed", "0.1"]);
    refused(
        &["robot", "--world", world, "--pty", "--faults", "drop=2"],
        &["drop=2", "from 0 to 1"],
    );
    refused(&["run", "--port", world, "--out", out], &["a file or a folder", "periplus ports"]);
}

#[test]
fn a_run_that_cannot_be_taken_up_says_why() {
    let dir = place("resume").join("run");
    let dir = dir.to_str().expect("a path");
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    refused(&["run", "--world", world, "--resume", dir], &["--resume", "made again by its seed"]);
    refused(&["run", "--port", "tcp://127.0.0.1:1", "--resume", dir], &[dir]);
    let with_body = ["run", "--port", "tcp://127.0.0.1:1", "--chassis", "b.toml", "--resume", dir];
    refused(&with_body, &["--chassis is not used", "the robot", dir]);
    let run = periplus(&["run", "--world", world, "--until", "boundary", "--out", dir]);
    assert_eq!(run.status.code(), Some(0));
    let simulated = ["run", "--port", "tcp://127.0.0.1:1", "--resume", dir];
    refused(&simulated, &["made in the simulator"]);
    // Nobody is sent for a world first.
    refused(&["run", "--resume", dir], &["made in the simulator", "--seed 1"]);
}

#[test]
fn the_protocol_is_printed() {
    let output = periplus(&["protocol"]);
    assert_eq!(output.status.code(), Some(0));
    let page = String::from_utf8_lossy(&output.stdout);
    for word in ["CRC-16", "Host to robot", "9600"] {
        assert!(page.contains(word), "no {word}");
    }
}

/// A record is played back to a frame; an instant beyond it is refused.
#[test]
fn flags_that_would_be_ignored_are_refused() {
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    let out = place("ignored").join("run");
    let out = out.to_str().expect("a path");
    refused(
        &["run", "--world", world, "--placed", "1,1,0", "--out", out],
        &["--placed", "--resume DIR"],
    );
    refused(&["calibrate", "--world", world], &["periplus calibrate", "--out DIR"]);
    refused(
        &["calibrate", "--world", world, "--until", "boundary", "--out", out],
        &["until", "shape at least"],
    );
    assert!(!std::path::Path::new(out).exists(), "nothing was begun");
}

#[test]
fn a_frame_of_a_record() {
    let dir = place("replay").join("run");
    let dir = dir.to_str().expect("a path");
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    let run = periplus(&["run", "--world", world, "--until", "boundary", "--out", dir]);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    let frame = periplus(&["snapshot", "--replay", dir, "--at", "60", "--size", "80x24"]);
    let text = String::from_utf8_lossy(&frame.stdout);
    assert!(text.contains("0:01:00") || text.contains("0:00:59"), "{text}");
    assert!(
        text.contains("replay 60/") && !text.contains("stop"),
        "of then, and not of now: {text}"
    );
    assert_eq!(text.lines().count(), 24);
    refused(&["snapshot", "--replay", dir, "--at", "99999", "--size", "80x24"], &["ends at"]);
    // Results that were lost, as after a kill, are made again from the record.
    let there = std::path::Path::new(dir).join("map.json");
    let map = fs::read(&there).expect("a map");
    fs::remove_file(&there).expect("a file");
    let made = periplus(&["export", dir, "--format", "json", "--out", "-"]);
    assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
    assert_eq!(made.stdout, map, "{}", String::from_utf8_lossy(&made.stdout));
    assert!(String::from_utf8_lossy(&made.stderr).contains("made from its record"));
    // Those that are older than the record, as when the run was taken up again, are not the run's.
    fs::write(&there, "{}").expect("a file");
    let old = fs::File::options().write(true).open(&there).expect("a file");
    old.set_modified(std::time::UNIX_EPOCH).expect("a time");
    let made = periplus(&["export", dir, "--format", "json", "--out", "-"]);
    assert_eq!(made.stdout, map, "{}", String::from_utf8_lossy(&made.stdout));
    assert!(String::from_utf8_lossy(&made.stderr).contains("went on after"));
}

#[test]
fn a_calibration_tells_its_figures_and_where_the_body_is() {
    let out = place("calibrated").join("run");
    let to = out.to_str().expect("a path");
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    let output = periplus(&["calibrate", "--world", world, "--noise", "raw", "--out", to]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8_lossy(&output.stdout);
    let body = fs::read_to_string(out.join("chassis.toml")).expect("a body");
    let base = body.lines().find_map(|line| line.strip_prefix("wheel_base = ")).expect("a base");
    let base = base.split(' ').next().unwrap_or_default();
    for words in [&format!("wheel base: {base} ± "), "gyro scale", "not measured: give --tape", to]
    {
        assert!(said.contains(words), "no `{words}` in {said}");
    }
    assert!(said.contains("chassis.toml"), "{said}");
    assert!(said.lines().last().is_some_and(|line| line.starts_with("complete: ")), "{said}");
}
