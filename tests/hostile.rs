//! What nobody should do, and what nobody can help: exports over the run itself, records that were bent,
//! disks that are full, ports at which nobody is.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

mod shell;

use periplus::journal::{Entry, Header, Journal, Record, Recording, RobotMark, read};
use periplus::mapping::map::Phase;
use periplus::mapping::settings::Settings;
use periplus::mapping::tape::Tape;
use periplus::robot::{Intent, Odometer, SwitchSet, Telemetry};
use periplus::runtime::OutputFolder;
use periplus::runtime::simulated::{Headless, SimulatedRun};
use periplus::simulator::{NoiseProfile, World};
use shell::{periplus, place, refused};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

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
    #[cfg(unix)]
    {
        let pipe = dir.join("pipe");
        let to = pipe.to_str().expect("a path");
        let made = Command::new("mkfifo").arg(to).status().expect("mkfifo");
        assert!(made.success(), "no pipe");
        let mut reader = Command::new("cat");
        let mut reader = reader.arg(to).stdout(Stdio::piped()).spawn().expect("a reader");
        let (arguments, output) = export("svg", to);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        let replaced = pipe.is_file();
        if replaced {
            reader.kill().expect("an end");
        }
        assert!(!replaced, "the pipe was replaced");
        let read = reader.wait_with_output().expect("an end").stdout;
        assert_eq!(read, b"<svg/>", "it did not go through the pipe");
        refused(&["export", from, "--format", "ros", "--out", to], &["name the YAML file"]);
    }
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

type Change = fn(&mut Header);

/// The record with another header, and with a report from far away at second 30.
fn write_bent(recording: &Recording, change: Change) -> Vec<u8> {
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
            journal.record(&Record { time_us, entry });
        }
        journal.record(record);
    }
    journal.finish().expect("memory")
}

/// What no robot can have counted, or no run been started with, is not reckoned with: a replay ends.
#[test]
fn a_record_of_what_cannot_be_is_told_and_comes_to_its_end() {
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
    let headers: [(&str, Change); 2] = [
        ("tick", |header| header.settings.chassis.tick = 1e308),
        ("0 switches", |header| header.settings.chassis.sensors.clear()),
    ];
    for (word, change) in headers {
        fs::write(&bent, write_bent(&recording, change)).expect("a record");
        refused(&[&frame[..], &["40"]].concat(), &["bent:1:", word]);
    }
    let robot = RobotMark { name: "rover".to_owned(), boot: 7 };
    let mut header = recording.header;
    header.robot = Some(robot);
    let real = Journal::begin(Vec::new(), &header).and_then(Journal::finish).expect("memory");
    fs::write(&bent, real).expect("a record");
    refused(&["run", "--resume", bent.to_str().expect("a path")], &["goes on with", "its --port"]);
}

/// The record of a boundary, driven in the simulator, as if a real robot had driven it.
fn as_of_a_real_robot(dir: &Path) -> (Header, Vec<Record>) {
    let made = dir.join("run");
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    let out = made.to_str().expect("a path");
    let run = periplus(&["run", "--world", world, "--until", "boundary", "--out", out]);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    let Recording { mut header, records, .. } = read(&made).expect("a record");
    header.robot = Some(RobotMark { name: "rover".to_owned(), boot: 7 });
    (header, records)
}

/// Writes the record of a boundary as that of a run that was to go on behind it, and broke off there.
fn begun_to_the_end(header: &Header, records: &[Record], real: &Path) {
    let header = Header { until: None, ..header.clone() };
    let mut journal = Journal::begin(Vec::new(), &header).expect("memory");
    let ended = |record: &Record| matches!(record.entry, Entry::PhaseEnd(_));
    records.iter().take_while(|it| !ended(it)).for_each(|record| journal.record(record));
    fs::write(real.join("journal"), journal.finish().expect("memory")).expect("a record");
}

/// What was asked for is done: nobody is told to ask for less of it, or for nothing.
#[test]
fn a_run_that_is_over_is_not_gone_on_with_and_says_what_to_do() {
    let dir = place("over");
    let real = dir.join("real");
    let (header, records) = as_of_a_real_robot(&dir);
    let write = |header: &Header, share: usize| {
        let mut journal = Journal::begin(Vec::new(), header).expect("memory");
        let count = records.len() / share;
        records[..count].iter().for_each(|record| journal.record(record));
        fs::create_dir_all(&real).expect("a folder");
        fs::write(real.join("journal"), journal.finish().expect("memory")).expect("a record");
    };
    write(&header, 1);
    let resume = ["run", "--port", "tcp://127.0.0.1:1", "--resume", real.to_str().expect("a path")];
    let done = ["it is over", "boundary phase done", "begin another with --out"];
    refused(&resume, &done);
    refused(&[&resume[..], &["--until", "objects"]].concat(), &done);
    // One that is not over goes on to where it was to end.
    write(&header, 2);
    refused(
        &[&resume[..], &["--until", "objects"]].concat(),
        &["--until was boundary and is now objects; leave it out to go on"],
    );
    // What can no longer be had is refused as well, and not left out without a word.
    let cases: [(&[&str], &str); 6] = [
        (&["--plan", "paper"], "--plan was lean and is now paper"),
        (&["--contour", "two-pass"], "--contour was full-loop and is now two-pass"),
        (&["--start", "0.5,-1,90"], "--start was 1,1,20 and is now 0.5,-1,90"),
        (&["--laps", "3"], "--laps was 1 and is now 3"),
        (&["--square"], "--square was not given and is now given"),
        (&["--tape", "0,0:5,-1=5.02"], "--tape was not given and is now 0,0:5,-1=5.02"),
    ];
    for (flags, why) in cases {
        refused(&[&resume[..], flags].concat(), &[why, "leave it out to go on"]);
    }
    // A place that is not in the room is a slip of the hand.
    begun_to_the_end(&header, &records, &real);
    refused(
        &[&resume[..], &["--placed", "50,1,0"]].concat(),
        &["--placed 50,1,0 is not in the room", "from -0.", "m in y"],
    );
    refused(&[&resume[..], &["--placed", "1,1,0"]].concat(), &["cannot be reached"]);
    // What nobody said does not differ: a calibration goes on to the end and the laps it was begun with.
    let mut begun = header;
    (begun.settings.laps, begun.until) = (3, Some(Phase::Objects));
    write(&begun, 2);
    let calibrate = [&["calibrate"], &resume[1..]].concat();
    refused(&calibrate, &["cannot be reached"]);
}

/// Nobody drives a run to its end to hear then that it measured nothing.
#[test]
fn a_run_of_one_lap_is_not_gone_on_with_as_a_calibration() {
    let dir = place("not-measuring");
    let real = dir.join("real");
    let (header, records) = as_of_a_real_robot(&dir);
    let write = |laps: u32, until: Option<Phase>| {
        let mut header = header.clone();
        (header.settings.laps, header.until) = (laps, until);
        let mut journal = Journal::begin(Vec::new(), &header).expect("memory");
        records[..records.len() / 2].iter().for_each(|record| journal.record(record));
        fs::create_dir_all(&real).expect("a folder");
        let bytes = journal.finish().expect("memory");
        fs::write(real.join("journal"), &bytes).expect("a record");
        bytes
    };
    let dir = real.to_str().expect("a path");
    let resume = ["--port", "tcp://127.0.0.1:1", "--resume", dir];
    let (calibrate, run) =
        ([&["calibrate"][..], &resume].concat(), [&["run"][..], &resume].concat());
    let before = write(1, None);
    let instead = format!("`periplus run --port tcp://127.0.0.1:1 --resume {dir}` goes on with it");
    refused(&calibrate, &["record of a run of one lap", &instead, "calibrate --out DIR"]);
    assert_eq!(fs::read(real.join("journal")).expect("a record"), before, "it was written to");
    refused(&run, &["cannot be reached"]);
    write(2, Some(Phase::Boundary));
    refused(&calibrate, &["ends with the boundary", &instead]);
    // A calibration may be gone on with as a run: it writes the same files.
    write(2, Some(Phase::Shape));
    refused(&calibrate, &["cannot be reached"]);
    refused(&run, &["cannot be reached"]);
}

/// What is behind the damage is nobody's to throw away; what is before it can be gone on with in a copy.
#[test]
fn a_damaged_run_says_how_to_go_on_from_what_is_whole() {
    let dir = place("damaged-run");
    let (real, copy) = (dir.join("real"), dir.join("copy"));
    let (header, records) = as_of_a_real_robot(&dir);
    let mut journal = Journal::begin(Vec::new(), &header).expect("memory");
    records[..records.len() / 2].iter().for_each(|record| journal.record(record));
    let text = String::from_utf8(journal.finish().expect("memory")).expect("text");
    let mut lines: Vec<&str> = text.split_inclusive('\n').collect();
    lines[499] = "one line that was lost\n";
    for (dir, lines) in [(&real, &lines[..]), (&copy, &lines[..499])] {
        fs::create_dir_all(dir).expect("a folder");
        fs::write(dir.join("journal"), lines.concat()).expect("a record");
    }
    let port = "tcp://127.0.0.1:1";
    let record = real.join("journal");
    let head = format!("head -n 499 {} > NEW/journal", record.display());
    let says =
        ["journal:500:", &head, "off and on", "--port tcp://127.0.0.1:1 --resume NEW --placed"];
    refused(&["run", "--port", port, "--resume", real.to_str().expect("a path")], &says);
    assert_eq!(fs::read_to_string(&record).expect("text"), lines.concat());
    let told =
        ["run", "--port", port, "--resume", copy.to_str().expect("a path"), "--placed", "1,1,90"];
    refused(&told, &["cannot be reached"]);
}

/// A robot counts its time from when it was switched on.
#[test]
fn an_instant_of_a_real_robots_record_counts_from_the_beginning_of_the_run() {
    let dir = place("switched-on");
    let real = dir.join("real");
    let (header, records) = as_of_a_real_robot(&dir);
    let before = 3_600_000_000;
    let mut journal = Journal::begin(Vec::new(), &header).expect("memory");
    let mut began = false;
    for mut record in records.iter().take(1500).cloned() {
        if began {
            record.time_us += before;
        }
        match &mut record.entry {
            Entry::Telemetry(
                Telemetry::Report { odometer, .. } | Telemetry::Done { odometer, .. },
            ) => {
                odometer.time_us += before;
                began = true;
            }
            Entry::Telemetry(Telemetry::Edge(edge)) => edge.odometer.time_us += before,
            _ => {}
        }
        journal.record(&record);
    }
    fs::create_dir_all(&real).expect("a folder");
    fs::write(real.join("journal"), journal.finish().expect("memory")).expect("a record");
    let dir = real.to_str().expect("a path");
    let frame = |at: &str| periplus(&["snapshot", "--replay", dir, "--at", at, "--size", "80x24"]);
    let shown = frame("10");
    let text = String::from_utf8_lossy(&shown.stdout);
    assert_eq!(shown.status.code(), Some(0), "{}", String::from_utf8_lossy(&shown.stderr));
    let header = text.lines().next().expect("a header");
    assert!(header.contains("0:00:10") || header.contains("0:00:09"), "{text}");
    assert!(!text.contains("1:00:"), "{text}");
    refused(
        &["snapshot", "--replay", dir, "--at", "3600", "--size", "80x24"],
        &["the record ends at"],
    );
}

/// What the operator changed since the run began is in the record, and that is what holds.
#[test]
fn a_run_goes_on_with_what_its_operator_chose_last() {
    let dir = place("chosen");
    let real = dir.join("real");
    let (header, records) = as_of_a_real_robot(&dir);
    let mut journal = Journal::begin(Vec::new(), &header).expect("memory");
    let half = &records[..records.len() / 2];
    for record in half {
        journal.record(record);
    }
    let time_us = half.last().expect("a record").time_us;
    let tape: Tape = "0,0:5,0=5.02".parse().expect("a tape");
    let wishes = [
        Intent::SetAlpha { alpha: 0.4 },
        Intent::SetTape { from: tape.from, to: tape.to, length: tape.length },
        Intent::Square,
        Intent::LapAgain,
    ];
    for wish in wishes {
        journal.record(&Record { time_us, entry: Entry::Intent(wish) });
    }
    fs::create_dir_all(&real).expect("a folder");
    fs::write(real.join("journal"), journal.finish().expect("memory")).expect("a record");
    let resume = ["run", "--port", "tcp://127.0.0.1:1", "--resume", real.to_str().expect("a path")];
    let held = ["--alpha", "0.4", "--tape", "0,0:5,0=5.02", "--square", "--laps", "2"];
    refused(&[&resume[..], &held].concat(), &["cannot be reached"]);
    let cases: [(&[&str], &str); 4] = [
        (&["--alpha", "0.25"], "--alpha was 0.25, then 0.4, and is now 0.25"),
        (&["--alpha", "0.5"], "--alpha was 0.25, then 0.4, and is now 0.5"),
        (
            &["--tape", "0,0:5,0=5.1"],
            "--tape was not given, then 0,0:5,0=5.02, and is now 0,0:5,0=5.1",
        ),
        (&["--laps", "1"], "--laps was 1, then 2, and is now 1"),
    ];
    for (flags, why) in cases {
        refused(&[&resume[..], flags].concat(), &[why, "leave it out to go on"]);
    }
}

#[test]
fn a_lap_that_is_given_up_leaves_what_was_touched() {
    let dir = place("held");
    let (world, out) = (dir.join("box.toml"), dir.join("run"));
    let room = "name = \"box\"\nstart = { x = 0.11, y = 0.11 }\n[boundary]\n\
                vertices = [[0, 0], [0.22, 0], [0.22, 0.22], [0, 0.22]]\n";
    fs::write(&world, room).expect("a world");
    let paths = [&world, &out].map(|path| path.to_str().expect("a path"));
    let run = periplus(&["run", "--world", paths[0], "--out", paths[1]]);
    let told = String::from_utf8_lossy(&run.stdout);
    assert_eq!(run.status.code(), Some(1), "{told}");
    assert!(told.contains("held on all sides"), "{told}");
    let map = fs::read_to_string(out.join("map.json")).expect("a map");
    let map: serde_json::Value = serde_json::from_str(&map).expect("JSON");
    let touched = map["touched"].as_array().map_or(0, Vec::len);
    assert!(map["boundary"].is_null() && touched > 4, "{touched} contacts are kept");
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
    // It does not go on to the end of the room first.
    assert!(said.contains("the record cannot be written") && said.contains("stopped"), "{said}");
}

/// `periplus run … | head` may end before the run does; how that ended is still told to whoever asks for the status.
#[cfg(unix)]
#[test]
fn how_a_run_ended_is_told_whether_or_not_anybody_reads_its_last_line() {
    let dir = place("unread");
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = format!("tcp://{}", listener.local_addr().expect("an address"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_periplus"))
        .args(["run", "--port", &port, "--out"])
        .arg(dir.join("run"))
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    assert_eq!(child.wait().expect("an end").code(), Some(1));
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

/// Half of a pair is of no use, and lies about where nobody looks for it.
#[test]
fn a_folder_in_the_way_of_a_ros_map_leaves_no_half_of_it() {
    let dir = place("ros-in-the-way");
    let square = r#"{"periplus_map":1,"name":"a room","alpha":0.25,"gap":0.34,"start":[1,1,0],
        "boundary":[[0,0],[2,0],[2,2],[0,2]]}"#;
    fs::write(dir.join("map.json"), square).expect("a result");
    for name in ["room", "hall.pgm"] {
        fs::create_dir(dir.join(name)).expect("a folder");
    }
    let from = dir.to_str().expect("a path");
    for (out, in_the_way) in [("room", "room: "), ("hall.yaml", "hall.pgm: ")] {
        let to = dir.join(out);
        let export = ["export", from, "--format", "ros", "--out", to.to_str().expect("a path")];
        refused(&export, &[in_the_way, "a folder"]);
        refused(&[&export[..], &["--force"]].concat(), &[in_the_way, "a folder"]);
    }
    assert!(!dir.join("room.pgm").exists() && !dir.join("hall.yaml").exists(), "half of a pair");
}

/// What was asked for and could not be written is not done.
#[cfg(target_os = "linux")]
#[test]
fn help_that_could_not_be_written_is_told() {
    for arguments in [&["--help"][..], &["--version"], &["help", "run"]] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("a full device");
        let output = Command::new(env!("CARGO_BIN_EXE_periplus"))
            .args(arguments)
            .stdout(full)
            .output()
            .expect("the program starts");
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {told}");
        assert!(told.contains("standard output"), "{arguments:?}: {told}");
    }
}

/// A full disk is no mistake in the arguments, wherever the result was to go; a folder that is not there is one.
#[cfg(target_os = "linux")]
#[test]
fn an_export_that_finds_no_room_ends_as_one_to_standard_output_does() {
    let dir = place("export-full");
    fs::write(dir.join("map.svg"), "<svg/>").expect("a result");
    let from = dir.to_str().expect("a path");
    let export = |out: &str| {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("a full device");
        let output = Command::new(env!("CARGO_BIN_EXE_periplus"))
            .args(["export", from, "--format", "svg", "--out", out])
            .stdout(full)
            .output()
            .expect("the program starts");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    for out in ["-", "/dev/full"] {
        let (status, told) = export(out);
        assert_eq!(status, Some(1), "{out}: {told}");
        assert_eq!(told.lines().count(), 1, "{out}: {told}");
    }
    assert!(export("/dev/full").1.contains("/dev/full: cannot be written"));
    let (status, told) = export(dir.join("nowhere/map.svg").to_str().expect("a path"));
    assert_eq!(status, Some(2), "{told}");
}

/// The seeds of the two ways of a line come from the robot's, whatever it is.
#[cfg(unix)]
#[test]
fn a_robot_takes_every_seed_that_a_run_takes() {
    use std::io::{BufRead, BufReader};
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    let seed = u64::MAX.to_string();
    let mut robot = Command::new(env!("CARGO_BIN_EXE_periplus"))
        .args(["robot", "--world", world, "--port", "tcp://127.0.0.1:0", "--seed", &seed])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut line = String::new();
    let mut said = BufReader::new(robot.stdout.take().expect("a pipe"));
    said.read_line(&mut line).expect("its address");
    let signalled = Command::new("kill").arg(robot.id().to_string()).status().expect("kill");
    let output = robot.wait_with_output().expect("it ends");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(signalled.success() && line.starts_with("tcp://"), "{line}{told}");
    assert_eq!(output.status.code(), Some(143), "{told}");
}

/// Who copies a folder gives its files another age.
#[test]
fn a_copied_run_is_not_taken_for_one_that_went_on() {
    let dir = place("copied");
    let run = dir.join("run");
    let from = run.to_str().expect("a path");
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    let made = periplus(&["run", "--world", world, "--until", "shape", "--out", from]);
    assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
    let result = fs::read(run.join("map.geojson")).expect("a result");
    let old = fs::OpenOptions::new().append(true).open(run.join("map.geojson")).expect("a result");
    old.set_modified(std::time::UNIX_EPOCH).expect("another age");
    let export = periplus(&["export", from, "--format", "geojson", "--out", "-"]);
    assert!(export.stderr.is_empty(), "{}", String::from_utf8_lossy(&export.stderr));
    assert!(export.stdout == result, "what only the simulator knows is lost");
    // A result that is not of this record is made anew.
    fs::write(run.join("map.svg"), "<svg/>").expect("another result");
    let export = periplus(&["export", from, "--format", "geojson", "--out", "-"]);
    assert!(String::from_utf8_lossy(&export.stderr).contains("made from its record"));
}

/// Nor is one that was stopped, although its record does not tell why it was, and its results do.
#[test]
fn a_copy_of_an_interrupted_run_keeps_what_only_the_simulator_knows() {
    let run = place("copied-interrupted").join("run");
    let from = run.to_str().expect("a path");
    let text = include_str!("../sims/rectangle.toml");
    let world = World::from_toml(text, "rectangle", 0.1).expect("a world");
    let header = Header {
        settings: Settings::new(world.start),
        source: world.name.clone(),
        noise: "calibrated".to_owned(),
        until: None,
        robot: None,
    };
    let (folder, file) = OutputFolder::create(&run).expect("a folder");
    let journal = Journal::begin(file, &header).expect("a record");
    let mut going = SimulatedRun::new(&world, header, NoiseProfile::Calibrated, Some(journal));
    going.intent(Intent::Run);
    while going.session().mission().phase() < Phase::Objects {
        going.advance();
    }
    let failed = Headless::left(going).write(&folder, "stopped by interrupt (Ctrl-C)", 1.0);
    assert_eq!(failed, None);
    let results = ["map.geojson", "map.svg", "map.png", "map.json"];
    let export = |name: &str| {
        let format = name.strip_prefix("map.").expect("a map");
        let output = periplus(&["export", from, "--format", format, "--out", "-"]);
        (output.stdout, String::from_utf8_lossy(&output.stderr).into_owned())
    };
    for name in results {
        let result = fs::read(run.join(name)).expect("a result");
        let old = fs::OpenOptions::new().append(true).open(run.join(name)).expect("a result");
        old.set_modified(std::time::UNIX_EPOCH).expect("another age");
        let (made, told) = export(name);
        assert!(told.is_empty() && made == result, "{name}: {told}");
    }
    // It is believed of why the run was stopped, and of nothing else.
    let record = fs::read_to_string(run.join("journal")).expect("a record");
    let lines: Vec<&str> = record.split_inclusive('\n').collect();
    fs::write(run.join("journal"), lines[..lines.len() - 20].concat()).expect("another record");
    for name in ["map.geojson", "map.svg"] {
        assert!(export(name).1.contains("made from its record"), "{name}");
    }
    let report = fs::read_to_string(run.join("report.json")).expect("a report");
    fs::write(run.join("journal"), record).expect("the record");
    let complete = report.replace("\"outcome\": \"stopped\"", "\"outcome\": \"complete\"");
    assert!(complete != report, "{report}");
    fs::write(run.join("report.json"), complete).expect("another report");
    assert!(export("map.svg").1.contains("made from its record"));
}

/// Where there is no file to complain of, what the map was made from is named.
#[test]
fn a_map_that_was_made_from_the_record_is_not_told_by_a_file_that_is_not_there() {
    let dir = place("made-from-record");
    let run = dir.join("run");
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml");
    let from = run.to_str().expect("a path");
    let made = periplus(&["run", "--world", world, "--until", "boundary", "--out", from]);
    assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
    let record = fs::read_to_string(run.join("journal")).expect("a record");
    let begun: Vec<&str> = record.split_inclusive('\n').take(50).collect();
    fs::write(run.join("journal"), begun.concat()).expect("a record");
    fs::remove_file(run.join("map.json")).expect("a result");
    let out = dir.join("room.yaml");
    let ros = ["export", from, "--format", "ros", "--out", out.to_str().expect("a path")];
    let output = periplus(&ros);
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("run/journal: ") && !told.contains("map.json"), "{told}");
}
