//! The reference firmware, built with the system's C++ compiler, maps a room through the protocol. It
//! shares no line with the robot in `src/firmware`: what both understand is what the page says.
#![cfg(unix)]
#![expect(clippy::print_stderr, reason = "a test that was skipped says so")]
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

use std::io::{BufRead, BufReader};
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

/// How many steps it takes to stand, after a motion began to brake by itself: on its own, and with a stop.
#[test]
fn a_stop_brakes_hard_what_is_braking_already() {
/// How many steps it drives on when the bumper is pressed while it brakes for another reason, and what it tells.
#[test]
fn the_bumper_stops_at_once_what_is_braking_already() {
    let place = folder("firmware_bumper");
    let Some(program) = built("tests/firmware/bumper.cpp", &place) else { return };
    let said = Command::new(program).output().expect("it runs").stdout;
    assert_eq!(String::from_utf8(said).expect("text").trim(), "1 time");
}

    let place = folder("firmware_stop");
    let Some(program) = built("tests/firmware/stop.cpp", &place) else { return };
    let said = Command::new(program).output().expect("it runs").stdout;
    let said = String::from_utf8(said).expect("text");
    let steps: Vec<i32> = said.split_whitespace().map(|n| n.parse().expect("steps")).collect();
    assert_eq!(steps.len(), 2, "{said}");
    assert!(steps[0] >= 8 && steps[1] <= steps[0] / 2 + 1, "{steps:?} without and with a stop");
}
