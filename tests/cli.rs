//! The program as a shell sees it: exit status, and where which words go.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::io::Read;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

fn periplus(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_periplus"))
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .expect("the program starts")
}

/// An empty folder for one test.
fn place(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).expect("a folder for the test");
    path
}

/// Asserts that the program refuses with status 2 and one message that has all of `words` in it.
fn refused(arguments: &[&str], words: &[&str]) {
    let output = periplus(arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?} ended otherwise: {message}");
    assert!(!message.contains("panicked"), "{arguments:?} panicked: {message}");
    for word in words {
        assert!(message.contains(word), "{arguments:?}: no `{word}` in: {message}");
    }
}

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
        (&["run", "--alpha", "wide"], &["--alpha", "not a number"]),
        (&["run", "--plan", "leen"], &["--plan", "leen", "lean"]),
        (&["run", "--contour", "three-pass"], &["--contour", "two-pass"]),
        (&["run", "--noise", "some"], &["--noise", "calibrated"]),
        (&["run", "--seed=-1"], &["--seed"]),
        (&["run", "--start", "1,2"], &["--start", "X,Y,DEG"]),
        (&["run", "--start", "1,2,nan"], &["--start", "not a finite number"]),
        (&["run", "--until", "end"], &["--until", "boundary"]),
        (&["snapshot", "--world", "a", "--until", "plan", "--size", "80"], &["--size", "80x24"]),
        (&["snapshot", "--replay", "a", "--size", "80x24"], &["--at"]),
        (&["snapshot", "--size", "80x24"], &["--world"]),
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
        ("\nalpha = 0\n", &["run.toml:2:", "`alpha`", "length"]),
        ("alpha = nan\n", &["run.toml:1:", "not a finite number"]),
        ("plan = \"leen\"\n", &["run.toml:1:", "paper, lean, lanes"]),
        ("start = [1, 2]\n", &["run.toml:1:", "X,Y,DEG"]),
        ("alpha = = 1\n", &["run.toml:1:"]),
    ];
    for (text, words) in cases {
        fs::write(&file, text).expect("a settings file");
        refused(&["run", "--config", shown], words);
    }
    refused(&["run", "--config", "/nowhere/run.toml"], &["/nowhere/run.toml"]);
    fs::write(&file, "alpha = 0.3\nstart = [1, 2, 90]\nworld = \"room.toml\"\n").expect("a file");
    refused(&["run", "--config", shown], &["needs --out DIR"]);
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
    fs::write(&file, "colour = \n").expect("a file");
    let output = periplus(&["check", file.to_str().expect("a plain path"), "/nowhere.toml"]);
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(told.contains("other.toml:1:") && told.contains("/nowhere.toml"), "{told}");
    assert_eq!(told.lines().count(), 2, "one line for each file: {told}");
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
    refused(&["export", from, "--format", "png", "--out", to], &["map.png", "finished run"]);
    refused(&["export", from, "--format", "ros", "--out", to], &["map.json", "finished run"]);
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
}

/// What a run left is not lost to an export under the wrong name, and a device stays a device.
#[test]
fn export_spares_results_and_devices() {
    let dir = place("export-spares");
    let (run, other) = (dir.join("run"), dir.join("other"));
    for folder in [&run, &other] {
        fs::create_dir_all(folder).expect("a folder");
        fs::write(folder.join("journal"), "a record\n").expect("a record");
        fs::write(folder.join("map.svg"), "<svg/>").expect("a result");
    }
    let from = run.to_str().expect("a path");
    let export = |format, to: &str| {
        let arguments = ["export", from, "--format", format, "--out", to];
        (arguments.map(str::to_owned), periplus(&arguments))
    };
    for name in ["journal", "map.svg", "map.json", "report.json", "../other/journal"] {
        let to = run.join(name);
        let arguments = ["export", from, "--format", "svg", "--out", to.to_str().expect("a path")];
        refused(&arguments, &["belongs to the run", "name another"]);
        let ros = ["export", from, "--format", "ros", "--out", to.to_str().expect("a path")];
        refused(&ros, &["belongs to the run"]);
    }
    #[cfg(unix)]
    {
        let link = dir.join("link.svg");
        std::os::unix::fs::symlink(run.join("journal"), &link).expect("a link");
        let to = link.to_str().expect("a path");
        refused(&["export", from, "--format", "svg", "--out", to], &["belongs to the run"]);
    }
    assert_eq!(fs::read_to_string(run.join("journal")).expect("the record"), "a record\n");
    assert_eq!(fs::read_to_string(other.join("journal")).expect("the record"), "a record\n");
    for to in ["-", "/dev/stdout"] {
        let (arguments, output) = export("svg", to);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert_eq!(output.stdout, b"<svg/>", "{arguments:?}");
        refused(&["export", from, "--format", "ros", "--out", to], &["name the YAML file"]);
    }
    let before = fs::metadata("/dev/null").expect("a device").file_type();
    let (arguments, output) = export("svg", "/dev/null");
    assert_eq!(output.status.code(), Some(0), "{arguments:?}");
    assert_eq!(fs::metadata("/dev/null").expect("a device").file_type(), before, "it was replaced");
}

/// An empty or damaged result is none, and what is said of the record was looked at.
#[test]
fn export_hands_over_no_empty_result() {
    let dir = place("export-empty");
    let (from, out) = (dir.to_str().expect("a path"), dir.join("copy"));
    let to = out.to_str().expect("a path");
    fs::write(dir.join("map.png"), "").expect("a file");
    fs::write(dir.join("map.geojson"), "{\"type\":").expect("a file");
    fs::write(dir.join("journal"), "").expect("a file");
    let export = |format| ["export", from, "--format", format, "--out", to];
    refused(&export("png"), &["map.png", "empty", "cannot be read"]);
    refused(&export("geojson"), &["map.geojson", "damaged"]);
    refused(&export("svg"), &["map.svg", "cannot be read"]);
    assert!(!out.exists(), "nothing was to be handed over");
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
        "--out",
        out.to_str().expect("a path"),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let report = fs::read_to_string(out.join("report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
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
    assert!(matches!(status, Some(0 | 141)), "ended with {status:?}: {told}");
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
        (&["--alpha", "4.5"], &["α of 4.5 m is larger than the room", "4.00 x 3.00"]),
        (&["--start", "9,9,0"], &["--start", "outside the room"]),
        (&["--start", "0.01,1,0"], &["--start"]),
        (&["--chassis", "/nowhere/robot.toml"], &["/nowhere/robot.toml"]),
    ];
    for (more, words) in cases {
        let arguments = [&["run", "--world", world, "--out", to], *more].concat();
        refused(&arguments, words);
    }
    assert!(!out.exists(), "a refused run has made its folder");
}

#[test]
fn a_chassis_is_read_strictly() {
    let dir = place("chassis");
    let (world, file) = (dir.join("room.toml"), dir.join("robot.toml"));
    fs::write(&world, ROOM).expect("a world");
    let (world, shown) = (world.to_str().expect("a path"), file.to_str().expect("a path"));
    let cases: &[(&str, &[&str])] = &[
        ("radius = 0.1\nrang = 0.05\n", &["robot.toml:2:", "`rang`", "did you mean `range`"]),
        ("radius = -1\n", &["robot.toml:1:", "`radius`", "between"]),
        ("radius = nan\n", &["robot.toml:1:", "not a finite number"]),
        ("sensors = 3\n", &["robot.toml:1:", "from 4 to 16"]),
        ("[[sensors]]\nname = \"front\"\nangel = 0\n", &["robot.toml:3:", "`angel`", "`angle`"]),
        ("speed = \"fast\"\n", &["robot.toml:1:", "`speed`", "a string"]),
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
}

#[test]
fn a_run_that_cannot_be_taken_up_says_why() {
    let dir = place("resume").join("run");
    let dir = dir.to_str().expect("a path");
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    refused(&["run", "--world", world, "--resume", dir], &["--resume", "made again by its seed"]);
    refused(&["run", "--port", "tcp://127.0.0.1:1", "--resume", dir], &[dir]);
    let run = periplus(&["run", "--world", world, "--until", "boundary", "--out", dir]);
    assert_eq!(run.status.code(), Some(0));
    let simulated = ["run", "--port", "tcp://127.0.0.1:1", "--resume", dir];
    refused(&simulated, &["made in the simulator"]);
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
fn a_frame_of_a_record() {
    let dir = place("replay").join("run");
    let dir = dir.to_str().expect("a path");
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    let run = periplus(&["run", "--world", world, "--until", "boundary", "--out", dir]);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    let frame = periplus(&["snapshot", "--replay", dir, "--at", "60", "--size", "80x24"]);
    let text = String::from_utf8_lossy(&frame.stdout);
    assert!(text.contains("0:01:00") || text.contains("0:00:59"), "{text}");
    assert_eq!(text.lines().count(), 24);
    refused(&["snapshot", "--replay", dir, "--at", "99999", "--size", "80x24"], &["ends at"]);
}

/// What no robot can have counted, or no run been started with, is not reckoned with: a replay ends.
#[test]
fn a_record_of_what_cannot_be_is_told_and_comes_to_its_end() {
    use periplus::journal::{Entry, Journal, read};
    use periplus::robot::{Odometer, SwitchSet, Telemetry};
    let dir = place("absurd");
    let (made, bent) = (dir.join("run"), dir.join("bent"));
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    let made = made.to_str().expect("a path");
    let run = periplus(&["run", "--world", world, "--until", "boundary", "--out", made]);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    let recording = read(made.as_ref()).expect("a record");
    fs::write(&bent, write_bent(&recording, |_| {})).expect("a record");
    let frame = ["snapshot", "--replay", bent.to_str().expect("a path"), "--size", "80x24", "--at"];
    // The far report comes at second 30.
    let output = periplus(&[&frame[..], &["40"]].concat());
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("differs from the run"), "{told}");
    let headers: [(&str, fn(&mut periplus::journal::Header)); 2] = [
        ("tick", |header| header.settings.chassis.tick = 1e308),
        ("0 switches", |header| header.settings.chassis.sensors.clear()),
    ];
    for (word, change) in headers {
        fs::write(&bent, write_bent(&recording, change)).expect("a record");
        refused(&[&frame[..], &["40"]].concat(), &["bent:1:", word]);
    }

    fn write_bent(
        recording: &periplus::journal::Recording,
        change: fn(&mut periplus::journal::Header),
    ) -> Vec<u8> {
        let mut header = recording.header.clone();
        change(&mut header);
        let mut journal = Journal::begin(Vec::new(), &header).expect("memory");
        let mut bent = false;
        for record in &recording.records {
            if record.time_us >= 30_000_000 && !bent {
                bent = true;
                let (left_ticks, time_us) = (900_000_000_000_000, record.time_us);
                let odometer = Odometer { time_us, left_ticks, right_ticks: 0, heading: 0.0 };
                let switches = SwitchSet::EMPTY;
                let entry = Entry::Telemetry(Telemetry::Report { odometer, switches, bumper: false });
                journal.record(&periplus::journal::Record { time_us, entry });
            }
            journal.record(record);
        }
        journal.finish().expect("memory")
    }
}

/// A limit on the length of files is met as a full disk is: one message, and no word of results that
/// are not there.
#[cfg(unix)]
#[test]
fn a_file_that_may_not_grow_is_told_once_and_truthfully() {
    let dir = place("limited");
    let out = dir.join("run");
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    // In blocks of 512 or 1024 bytes, as the shell pleases: the record is longer, its header is not.
    let limited = r#"ulimit -f 8 && exec "$0" run --world "$1" --until boundary --out "$2""#;
    let output = Command::new("sh")
        .args(["-c", limited, env!("CARGO_BIN_EXE_periplus"), world])
        .arg(&out)
        .stdin(Stdio::null())
        .output()
        .expect("a shell");
    let (said, told) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(1), "{said}{told}");
    assert_eq!(told.lines().count(), 1, "{told}");
    assert!(told.contains("the record of the run") && told.contains("room on the disk"), "{told}");
    assert!(said.contains("not all results could be written"), "{said}");
    assert!(!said.contains("; results in"), "{said}");
}

/// A port at which no robot answers leaves no folder, says no word of results, and the folder can be
/// used again.
#[cfg(unix)]
#[test]
fn a_robot_that_never_answers_leaves_nothing() {
    let dir = place("no-answer");
    let out = dir.join("run");
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = format!("tcp://{}", listener.local_addr().expect("an address"));
    let to = out.to_str().expect("a path");
    for _ in 0..2 {
        let output = periplus(&["run", "--port", &port, "--out", to]);
        let said = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("no answer") && said.contains("nothing was recorded"), "{said}");
        assert!(!out.exists(), "something was left");
    }
}
