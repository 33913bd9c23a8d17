//! The program at the end of a real line: a pseudo-terminal with a robot on the other side whose drive
//! is watched. Real ports and real signals, hence real time; the bounds are wide enough for a busy
//! machine.
#![cfg(unix)]
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

use periplus::firmware::Device;
use periplus::robot::{Chassis, Hardware};
use periplus::runtime::Stopwatch;
use periplus::simulator::{Body, NoiseProfile, World};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio_serial::{SerialPort, SerialStream};

const STEP: Duration = Duration::from_millis(20);

fn place(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&path);
    path
}

fn map_over(port: &str, out: &PathBuf) -> Child {
    Command::new(env!("CARGO_BIN_EXE_periplus"))
        .args(["run", "--start", "1,1,20", "--until", "boundary", "--port", port, "--out"])
        .arg(out)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts")
}

/// What the robot's side saw.
struct Seen {
    /// Seconds from the signal until the drive stood still.
    stopped: f64,
    /// Metres moved after the signal.
    went: f64,
    status: Option<i32>,
    /// Seconds from the signal until the program had ended.
    ended: f64,
}

/// Lets the program drive a robot, and sends it a signal while the robot moves.
fn interrupted_by(signal: &str) -> Seen {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.expect("a runtime").block_on(async {
        let text = include_str!("../sims/rectangle.toml");
        let world = World::from_toml(text, "rectangle", 0.1).expect("a world");
        let chassis = Chassis::default();
        let mut device = Device::new(&chassis, "tin", std::process::id(), 1.0);
        let mut body = Body::new(&world, &chassis, NoiseProfile::None, 1);
        let (mut ours, theirs) = SerialStream::pair().expect("a pseudo-terminal");
        let out = place(&format!("line-{signal}"));
        let mut child = map_over(&theirs.name().expect("a name"), &out);
        let mut tick = tokio::time::interval(STEP);
        let mut bytes = [0_u8; 512];
        let mut fast = 0;
        let watch = Stopwatch::start();
        let mut begun: Option<(f64, periplus::geometry::Point)> = None;
        let mut still: Option<f64> = None;
        let mut seen = Seen { stopped: f64::NAN, went: f64::NAN, status: None, ended: f64::NAN };
        for _ in 0..1500 {
            tokio::select! {
                biased;
                read = ours.read(&mut bytes) => {
                    let count = read.expect("the line is there");
                    if device.receive(&bytes[..count], &body) { body.begin_motion(); }
                }
                _ = tick.tick() => {
                    let before = body.true_pose().position;
                    device.step(&mut body, |_, _| {});
                    body.step(STEP.as_secs_f64());
                    let moved = (body.true_pose().position - before).norm();
                    fast = if moved > 0.003 { fast + 1 } else { 0 };
                    if begun.is_some() {
                        if moved > 1e-6 { still = None; } else { still = still.or(Some(watch.seconds())); }
                    }
                }
            }
            let said = device.take_output();
            ours.write_all(&said).await.expect("the line takes it");
            if begun.is_none() && fast > 10 {
                let id = child.id().to_string();
                // The shell's own `kill`: a bare machine may have no other.
                let words = format!("kill {signal} {id}");
                let sent = Command::new("sh").args(["-c", &words]).status().expect("a shell");
                assert!(sent.success());
                begun = Some((watch.seconds(), body.true_pose().position));
            }
            if let Some((from, at)) = begun
                && seen.ended.is_nan()
                && let Some(status) = child.try_wait().expect("a child")
            {
                seen.status = status.code();
                seen.ended = watch.seconds() - from;
                seen.went = (body.true_pose().position - at).norm();
            }
            if let (Some((from, at)), Some(still)) = (begun, still)
                && watch.seconds() - still > 0.6
                && !seen.ended.is_nan()
            {
                seen.stopped = still - from;
                seen.went = (body.true_pose().position - at).norm();
                break;
            }
        }
        let _ = child.kill();
        let _ = child.wait();
        assert!(body.odometer().time_us > 0);
        seen
    })
}

#[test]
fn signals_stop_the_robot_and_end_the_program() {
    for (signal, status) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        let seen = interrupted_by(signal);
        assert_eq!(seen.status, Some(status), "{signal}");
        // 100 ms to the stop, and braking from 0.2 m/s at 1 m/s² takes 200 ms.
        assert!(seen.stopped < 0.6, "{signal}: still driving after {} s", seen.stopped);
        assert!(seen.went < 0.09, "{signal}: {} m", seen.went);
        assert!(seen.ended < 3.0, "{signal}: ended after {} s", seen.ended);
        let folder = place_of(signal);
        for file in ["journal", "report.json", "map.geojson"] {
            assert!(folder.join(file).is_file(), "{signal}: no {file}");
        }
    }
}

fn place_of(signal: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("line-{signal}"))
}

#[test]
fn a_killed_host_leaves_the_robot_to_its_watchdog() {
    let seen = interrupted_by("-KILL");
    // 300 ms of silence since the last ping at most 100 ms old, then braking.
    assert!(seen.stopped < 0.9, "still driving after {} s", seen.stopped);
    assert!(seen.went < 0.12, "{} m", seen.went);
    let record = periplus::journal::read(&place_of("-KILL")).expect("a record");
    assert!(!record.records.is_empty(), "nothing was kept");
}
