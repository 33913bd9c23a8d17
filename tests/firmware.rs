//! The reference firmware, built with the system's C++ compiler, maps a room through the protocol. It
//! shares no line with the robot in `src/firmware`: what both understand is what the page says.
#![cfg(unix)]
#![expect(clippy::print_stderr, reason = "a test that was skipped says so")]
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

use periplus::firmware::Device;
use periplus::robot::Chassis;
use periplus::wire::{Decoder, Item, ToRobot, VERSION, seal};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// A folder of the test's own, empty.
fn folder(name: &str) -> PathBuf {
    let place = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).expect("a folder");
    place
}

/// The program `main`, a file below the crate, built with the reference firmware; none where there is no
/// compiler.
fn built(main: &str, into: &Path) -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = into.join("program");
    let built = Command::new("c++")
        .args(["-std=c++11", "-O2", "-Wall", "-Wextra", "-Werror", "-o"])
        .arg(&program)
        .arg("-I")
        .arg(root.join("firmware"))
        .args([root.join(main), root.join("firmware/periplus_robot.cpp")])
        .status();
    let Ok(status) = built else {
        eprintln!("skipped: there is no C++ compiler (c++) here");
        return None;
    };
    assert!(status.success(), "the reference firmware does not build");
    Some(program)
}

/// A child that does not outlive its test.
struct Kept(Child);

impl Drop for Kept {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn the_reference_firmware_maps_a_room() {
    let place = folder("firmware");
    let Some(program) = built("firmware/bench.cpp", &place) else { return };
    let mut robot = Kept(
        Command::new(program).arg("25").stdout(Stdio::piped()).spawn().expect("the bench starts"),
    );
    let mut port = String::new();
    let said = robot.0.stdout.take().expect("its output");
    BufReader::new(said).read_line(&mut port).expect("a path");
    let out = place.join("run");
    let status = Command::new(env!("CARGO_BIN_EXE_periplus"))
        .args(["run", "--start", "1,1,20.0535", "--until", "shape", "--port", port.trim(), "--out"])
        .arg(&out)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .status()
        .expect("the program starts");
    let report = std::fs::read_to_string(out.join("report.json")).expect("a report");
    assert_eq!(status.code(), Some(0), "{report}");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    let area = report["boundary"]["area_m2"].as_f64().expect("an area");
    assert!((area - 7.2).abs() < 0.05, "{area} m² of 7.2");
    assert_eq!(report["shape"]["class"], "convex");
    assert_eq!(report["shape"]["vertices"], 4);
}

/// A letter that the line cannot carry would leave the robot without an introduction.
#[test]
fn any_name_is_told_in_printable_letters() {
    let place = folder("firmware_names");
    let Some(program) = built("tests/firmware/names.cpp", &place) else { return };
    let said = Command::new(program).output().expect("it runs").stdout;
    assert!(said.iter().all(|&byte| byte == b'\n' || (32..127).contains(&byte)), "{said:?}");
    let said = String::from_utf8(said).expect("text");
    assert!(said.starts_with("h 1 00000001 00000000 300 8 K??fer*FFCF\n"), "{said}");
    assert!(said.contains("\ns 3 2356194 hinten?links*"), "{said}");
}

/// Nor is more asked of the board's C library than small ones have: they know no 64 bits.
#[test]
fn a_report_is_printed_without_a_printf_of_64_bits() {
    let source = include_str!("../firmware/periplus_robot.cpp");
    assert!(!source.contains("%ll") && !source.contains("llround"), "small C libraries lack them");
    let place = folder("firmware_late");
    let Some(program) = built("tests/firmware/late.cpp", &place) else { return };
    let said = Command::new(program).output().expect("it runs").stdout;
    let said = String::from_utf8(said).expect("text");
    assert_eq!(said.trim(), "r 12345678901 -12 40021 -3250000 05 0 0 0*EE6A");
}

/// What a board must have room for is told to those who port it.
#[test]
fn the_largest_bursts_are_as_the_readme_tells() {
    let place = folder("firmware_burst");
    let Some(program) = built("tests/firmware/burst.cpp", &place) else { return };
    let said = Command::new(program).output().expect("it runs").stdout;
    let said = String::from_utf8(said).expect("text");
    let bodies: Vec<Vec<&str>> = said.lines().map(|line| line.split(' ').collect()).collect();
    assert_eq!(bodies.len(), 2, "{said}");
    let readme = include_str!("../firmware/README.md");
    for (call, (usual, most)) in
        ["receive()", "step()", "poll()"].iter().zip(bodies[0].iter().zip(&bodies[1]))
    {
        let told = readme.lines().find(|line| line.starts_with(&format!("| `{call}`")));
        let told = told.unwrap_or_else(|| panic!("{call} is not told"));
        assert!(told.ends_with(&format!(" | {usual} | {most} |")), "{said}: {told}");
    }
}

/// A line that echoes says what the robot said, and no host is there all the same.
#[test]
fn an_echo_is_no_host() {
    let place = folder("firmware_echo");
    let Some(program) = built("tests/firmware/echo.cpp", &place) else { return };
    let said = Command::new(program).output().expect("it runs").stdout;
    let steps: i32 = String::from_utf8(said).expect("text").trim().parse().expect("steps");
    // 300 ms, and 0.2 s of braking from 0.2 m/s.
    assert!((20..=28).contains(&steps), "it stood after {steps} steps of 20 ms");
}

/// How many steps it drives on when the bumper is pressed while it brakes for another reason, and what it tells.
#[test]
fn the_bumper_stops_at_once_what_is_braking_already() {
    let place = folder("firmware_bumper");
    let Some(program) = built("tests/firmware/bumper.cpp", &place) else { return };
    let said = Command::new(program).output().expect("it runs").stdout;
    assert_eq!(String::from_utf8(said).expect("text").trim(), "1 time");
}

/// How many steps it takes to stand, after a motion began to brake by itself: on its own, and with a stop.
#[test]
fn a_stop_brakes_hard_what_is_braking_already() {
    let place = folder("firmware_stop");
    let Some(program) = built("tests/firmware/stop.cpp", &place) else { return };
    let said = Command::new(program).output().expect("it runs").stdout;
    let said = String::from_utf8(said).expect("text");
    let steps: Vec<i32> = said.split_whitespace().map(|n| n.parse().expect("steps")).collect();
    assert_eq!(steps.len(), 3, "{said}");
    assert!(steps[0] >= 8 && steps[1] <= steps[0] / 2 + 1, "{steps:?} without and with a stop");
    // The page: v / (2 a) and a step of 20 ms, after the one in which it began to brake by itself.
    assert!(steps[1] <= 1 + 5 + 1, "{steps:?} from 0.2 m/s at 1 m/s²");
    assert!((16..=1 + 20 + 1).contains(&steps[2]), "{steps:?} from 0.2 m/s at 0.25 m/s²");
}

/// The whole line of a body, without its end.
fn line(body: &str) -> String {
    let mut line = Vec::new();
    seal(body, &mut line);
    String::from_utf8(line).expect("text").trim_end().to_owned()
}

/// What a robot of the simulator answers to a line, after it was greeted.
fn answered(line: &str) -> String {
    let mut device = Device::new(&Chassis::default(), "reference", 1, 1.0);
    let mut hello = Vec::new();
    seal(&ToRobot::Hello { version: VERSION, session: 42 }, &mut hello);
    device.receive(&hello);
    let _ = device.take_output();
    device.receive(line.as_bytes());
    device.receive(b"\n");
    let said = device.take_output();
    let answers = Decoder::default().feed(&said).collect::<Vec<Item>>().into_iter();
    answers.fold(String::new(), |all, item| match item {
        Item::Body(body) => format!("{all}{body};"),
        _ => all,
    })
}

/// What a host may have got wrong, and what the page has robots answer to it.
fn wrong_and_right() -> Vec<(String, &'static str)> {
    let bodies = [
        ("M 1 100 100 00 00 900", "a 1;"),
        ("M 1 -100 100 fF 0 900", "a 1;"),
        ("M 1 100 100 0 0 900 extra", "a 1;"),
        ("M 4294967295 100 100 0 0 900", "a 4294967295;"),
        ("M 4294967296 100 100 0 0 900", ""),
        ("M1 100 100 0 0 900", ""),
        ("M  1 100 100 0 0 900", ""),
        ("M -1 100 100 0 0 900", ""),
        (" M 1 100 100 0 0 900", ""),
        ("MM 1 100 100 0 0 900", ""),
        ("m 1 100 100 0 0 900", ""),
        ("M 0 100 100 0 0 900", "n 0 not understood;"),
        ("M 1 100  100 0 0 900", "n 1 not understood;"),
        ("M 1 1.5 100 0 0 900", "n 1 not understood;"),
        ("M 1 100 100 10000 0 900", "n 1 not understood;"),
        ("M 1 100 100 -1 0 900", "n 1 not understood;"),
        ("M 1 100 100 0x1 0 900", "n 1 not understood;"),
        ("M 1 100 100 0 0", "n 1 not understood;"),
        ("M 1 100 100 0 0 ", "n 1 not understood;"),
        ("M 1 100 -1 0 0 900", "n 1 faster than this robot can go;"),
        ("M 1 100 100 0 0 -900", "n 1 without a time limit;"),
        ("T 1 -100000 100 0 0 900", "a 1;"),
        ("T 0 100000 100 0 0 900", "n 0 not understood;"),
        ("T 1 100000 100 0 0 9s", "n 1 not understood;"),
        ("R 1 500", "a 1;"),
        ("R 0 500", "n 0 not understood;"),
        ("R 1", "n 1 not understood;"),
        ("R 1x 500", ""),
        ("S 2147483649", "a 2147483649;"),
        ("S -1", ""),
        ("S  5", ""),
        ("S", ""),
        ("P 4294967295 0", "p 4294967295;"),
        ("P 1 0 later", "p 1;"),
        ("P 1", ""),
        ("P -1 0", ""),
        ("P 1 -1", ""),
        ("X 1", ""),
    ];
    let mut all: Vec<_> = bodies.map(|(body, answer)| (line(body), answer)).into();
    // A sum that strtoul would take as well: "0" as a space or a sign, and small letters.
    let sums = |sound: fn(&str) -> bool| {
        (1..999)
            .map(|number| line(&format!("P {number} 0")))
            .find(|line| sound(&line[line.len() - 4..]))
    };
    let nought = sums(|sum| sum.starts_with('0')).expect("one in sixteen");
    let letters = sums(|sum| sum.contains(|digit: char| digit.is_ascii_uppercase()));
    let letters = letters.expect("most have one");
    let (body, sum) = nought.split_at(nought.len() - 4);
    all.extend([" ", "+", ""].map(|sign| (format!("{body}{sign}{}", &sum[1..]), "")));
    let (body, sum) = letters.split_at(letters.len() - 4);
    all.push((format!("{body}{}", sum.to_lowercase()), ""));
    all
}

/// Neither robot takes for a command what no host can have meant, and both agree on what that is.
#[test]
fn the_reference_firmware_reads_as_strictly_as_the_page_asks() {
    let cases = wrong_and_right();
    for (line, answer) in &cases {
        assert_eq!(answered(line), *answer, "the simulated robot on {line:?}");
    }
    let place = folder("firmware_strict");
    let Some(program) = built("tests/firmware/strict.cpp", &place) else { return };
    let mut robot = Command::new(program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("it runs");
    let mut lines = robot.stdin.take().expect("its input");
    for (line, _) in &cases {
        writeln!(lines, "{line}").expect("it reads");
    }
    drop(lines);
    let said = robot.wait_with_output().expect("it ends").stdout;
    let said = String::from_utf8(said).expect("text");
    assert_eq!(said.lines().count(), cases.len(), "{said}");
    for (said, (line, answer)) in said.lines().zip(&cases) {
        assert_eq!(said, *answer, "the reference firmware on {line:?}");
    }
}

/// All that must end a motion or keep one from beginning, and in how many control steps at most: what the robot
/// does by itself is the last that stops it when its host, the line or the room does something else.
#[test]
fn the_reference_firmware_stops_and_refuses_by_itself() {
    let place = folder("firmware_safe");
    let Some(program) = built("tests/firmware/safe.cpp", &place) else { return };
    let said = Command::new(program).output().expect("it runs").stdout;
    let said = String::from_utf8(said).expect("text");
    // A stop from 0.2 m/s takes 100 ms at twice the usual 1 m/s², and everything else twice as long.
    let expected = [
        ("beginning: stands", 0),
        ("stop byte: 1 stop", 6),
        ("stop line: a 9, 1 stop", 6),
        ("after a bad line and a stop byte: a 9", 0),
        ("after half a line and a stop byte: a 9", 0),
        ("another host: 1 stop", 6),
        ("silence: 1 host", 27),
        ("a host that is back: stands", 0),
        ("silence at twice the pace: 1 host", 42),
        ("time limit: 1 time", 62),
        ("rest: stands", 0),
        ("its end: 1 ok", 22),
        ("guard: 1 g3+", 11),
        ("guard and stop: 1 g3+", 7),
        ("falling guard: 1 g3-", 11),
        ("no guard: moves", 0),
        ("bumper: 1 bump", 1),
        ("backing off: moves", 0),
        ("held: 1 stall", 13),
        ("no hello: n 1 say hello first", 0),
        ("another in hand: n 2 another motion is in hand", 0),
        ("too fast: n 1 faster than this robot can go", 0),
        ("turning too fast: n 1 faster than this robot can go", 0),
        ("backwards in time: n 1 faster than this robot can go", 0),
        ("no limit: n 1 without a time limit", 0),
        ("no words: n 1 not understood", 0),
        ("wrong checksum: stands", 0),
        ("said once: 1 ok", 25),
        ("said twice: a 1, stands", 0),
        ("H 1 2A: a 1, stands", 0),
        ("H 1 2B: a 1, moves", 0),
        ("an end: said again and again", 0),
        ("an end that is known: said no more", 0),
        ("an end of another host's: said no more", 0),
        ("a hole: told, stands", 0),
        ("after it: n 2 say hello first", 0),
        ("speed: within bounds", 0),
    ];
    let mut lines = said.lines();
    for (what, most) in expected {
        let line = lines.next().unwrap_or_default();
        let (came, steps) = line.split_once(" after ").filter(|_| most > 0).unwrap_or((line, "0"));
        assert_eq!(came, what, "{said}");
        let steps: i32 = steps.parse().expect("a number of steps");
        assert!(steps <= most, "{line}: {most} steps are enough");
    }
    assert_eq!(lines.next(), None);
    let patient =
        said.lines().find_map(|line| line.strip_prefix("silence at twice the pace: 1 host after "));
    let steps: i32 = patient.expect("a line").parse().expect("steps");
    assert!(steps > 30, "it waits as long by its host's time: {steps} steps");
}
