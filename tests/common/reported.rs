//! Mapping a world with the program itself, for tests that read what it reports.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

use std::ffi::OsStr;
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};

/// What the program reports of the boundary of a `world`, mapped by a robot with such `noise`: its area, square
/// metres, and the way that it took, metres.
pub(crate) fn bounded(world: &str, noise: &str, seed: u64) -> (f64, f64) {
    bounded_by(world, noise, seed, &[])
}

/// The same, asked of the program with `more` than that.
pub(crate) fn bounded_by(world: &str, noise: &str, seed: u64, more: &[&str]) -> (f64, f64) {
    static RUNS: AtomicU32 = AtomicU32::new(0);
    let run = format!("periplus-{}-{}", std::process::id(), RUNS.fetch_add(1, Ordering::Relaxed));
    let dir = std::env::temp_dir().join(run);
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).expect("a directory");
    let (file, out) = (dir.join("world.toml"), dir.join("run"));
    std::fs::write(&file, world).expect("a world");
    let done = Command::new(env!("CARGO_BIN_EXE_periplus"))
        .args(["run", "--noise", noise, "--until", "shape", "--seed", &seed.to_string()])
        .args(more)
        .args([OsStr::new("--world"), file.as_os_str(), OsStr::new("--out"), out.as_os_str()])
        .output()
        .expect("the program");
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "seed {seed}: {said}");
    let report = std::fs::read_to_string(out.join("report.json")).expect("a report");
    let _ = std::fs::remove_dir_all(&dir);
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    let figure = |of: &serde_json::Value| of.as_f64().expect("a figure");
    (figure(&report["boundary"]["area_m2"]), figure(&report["phases"][0]["travel_m"]))
}
