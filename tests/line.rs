//! The program at the end of a real line: a pseudo-terminal with a robot on the other side whose drive
//! is watched. Real ports and real signals, hence real time; the bounds are wide enough for a busy
//! machine.
#![cfg(unix)]
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

use periplus::firmware::Device;
use periplus::journal::Entry;
use periplus::robot::{Chassis, DoneReason, Hardware, Telemetry};
use periplus::runtime::Stopwatch;
use periplus::simulator::{Body, NoiseProfile, World};
use std::fs::File;
use std::io::{Read, Write};
use std::os::unix::process::CommandExt;
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
    let said = File::create(out.with_extension("said")).expect("a file");
    Command::new(env!("CARGO_BIN_EXE_periplus"))
        .args(["run", "--start", "1,1,20", "--until", "boundary", "--port", port, "--out"])
        .arg(out)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(said)
        .spawn()
        .expect("the program starts")
}

/// The console on a terminal of its own, at the same line.
fn console_over(port: &str, out: &PathBuf, terminal: &str) -> Child {
    let sized = Command::new("sh")
        .args(["-c", &format!("stty rows 24 cols 80 < {terminal}")])
        .status()
        .expect("a shell");
    assert!(sized.success(), "stty");
    let open = || {
        let file = File::options().read(true).write(true).open(terminal);
        Stdio::from(file.expect("the terminal opens"))
    };
    Command::new(env!("CARGO_BIN_EXE_periplus"))
        .args(["console", "--start", "1,1,20", "--port", port, "--out"])
        .arg(out)
        .env("TERM", "xterm-256color")
        .process_group(0)
        .stdin(open())
        .stdout(open())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts")
}

/// How a run on a moving robot ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    /// `periplus run` gets a signal.
    Signal(&'static str),
    /// The console's operator says quit, and yes.
    Quit,
    /// The console is put to sleep with Ctrl-Z, woken again once the robot stands, and then left.
    Suspended,
    /// The console's terminal is gone: nothing can be read from it or written to it any more, and no
    /// signal tells.
    TerminalGone,
    /// The console's terminal is there and takes nothing more, as over a connection that stalls. Once the
    /// robot stands, the program gets a signal.
    TerminalStuck,
    /// The console's operator says stop behind a thousand other keys, all at once, as a connection brings them that
    /// had stalled; and leaves once the robot stands.
    StopBehindKeys,
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

/// Lets the program drive a robot, and ends it while the robot moves.
#[expect(clippy::too_many_lines, reason = "one loop in which line, robot and terminal take turns")]
fn ended_by(end: End) -> Seen {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.expect("a runtime").block_on(async {
        let text = include_str!("../sims/rectangle.toml");
        let world = World::from_toml(text, "rectangle", 0.1).expect("a world");
        let chassis = Chassis::default();
        let mut device = Device::new(&chassis, "tin", std::process::id(), 1.0);
        let mut body = Body::new(&world, &chassis, NoiseProfile::None, 1);
        let (mut ours, theirs) = SerialStream::pair().expect("a pseudo-terminal");
        let out = place(&name_of(end));
        let port = theirs.name().expect("a name");
        let mut terminal = None;
        let mut child = if let End::Signal(_) = end {
            map_over(&port, &out)
        } else {
            let (master, slave) = terminal_pair();
            let child = console_over(&port, &out, &slave);
            terminal = Some(master);
            child
        };
        let mut tick = tokio::time::interval(STEP);
        let mut bytes = [0_u8; 512];
        let mut fast = 0;
        let watch = Stopwatch::start();
        let mut run_asked = false;
        let mut screen = [0_u8; 4096];
        let mut begun: Option<(f64, periplus::geometry::Point)> = None;
        let mut still: Option<f64> = None;
        let mut asleep = matches!(end, End::Suspended | End::TerminalStuck | End::StopBehindKeys);
        let mut woken: Option<f64> = None;
        let mut seen = Seen { stopped: f64::NAN, went: f64::NAN, status: None, ended: f64::NAN };
        for _ in 0..1500 {
            tokio::select! {
                biased;
                read = AsyncReadExt::read(&mut ours, &mut bytes) => {
                    let count = read.expect("the line is there");
                    device.receive(&bytes[..count]);
                }
                _ = tick.tick() => {
                    let stuck = end == End::TerminalStuck && begun.is_some();
                    if let Some(terminal) = &mut terminal {
                        // All is drawn anew, and again, until no more goes in.
                        if stuck { let _ = terminal.write(b"\x0c"); }
                        while !stuck && terminal.read(&mut screen).is_ok_and(|count| count > 0) {}
                    }
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
            AsyncWriteExt::write_all(&mut ours, &said).await.expect("the line takes it");
            if !run_asked && watch.seconds() > 2.0 {
                run_asked = true;
                if let Some(terminal) = &mut terminal {
                    terminal.write_all(b"r").expect("the terminal takes it");
                }
            }
            if begun.is_none() && fast > 10 {
                match end {
                    End::Signal(signal) => kill(&child, signal),
                    End::Quit => {
                        let keys = terminal.as_mut().expect("a terminal");
                        keys.write_all(b"qy").expect("the terminal takes it");
                    }
                    End::Suspended => {
                        let keys = terminal.as_mut().expect("a terminal");
                        keys.write_all(b"\x1a").expect("the terminal takes it");
                    }
                    End::StopBehindKeys => {
                        let keys = terminal.as_mut().expect("a terminal");
                        let said = [b"hjkl".repeat(500), b" ".to_vec()].concat();
                        keys.write_all(&said).expect("the terminal takes it");
                    }
                    End::TerminalGone => terminal = None,
                    End::TerminalStuck => {}
                }
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
            if let (Some((from, at)), Some(still), true) = (begun, still, asleep)
                && watch.seconds() - still > 0.6
            {
                (seen.stopped, seen.went) = (still - from, (body.true_pose().position - at).norm());
                asleep = false;
                match end {
                    End::TerminalStuck => kill(&child, "-TERM"),
                    End::StopBehindKeys => woken = Some(watch.seconds() - 1.0),
                    _ => {
                        kill(&child, "-CONT");
                        woken = Some(watch.seconds());
                    }
                }
            }
            // It has taken the terminal on again.
            if woken.take_if(|at| watch.seconds() - *at > 1.0).is_some() {
                let keys = terminal.as_mut().expect("a terminal");
                keys.write_all(b"q").expect("the terminal takes it");
            }
            if let (Some((from, at)), Some(still)) = (begun, still)
                && watch.seconds() - still > 0.6
                && !seen.ended.is_nan()
            {
                if seen.stopped.is_nan() {
                    seen.stopped = still - from;
                }
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

/// A terminal: the end that a program does not inherit, and the name of the other. Reading it never
/// waits.
fn terminal_pair() -> (File, String) {
    use rustix::fs::{OFlags, fcntl_setfl};
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
    let master = openpt(flags).expect("a pseudo-terminal");
    grantpt(&master).expect("granted");
    unlockpt(&master).expect("unlocked");
    let slave = ptsname(&master, Vec::new()).expect("a name");
    fcntl_setfl(&master, OFlags::NONBLOCK).expect("a flag");
    (File::from(master), slave.into_string().expect("a plain name"))
}

fn kill(child: &Child, signal: &str) {
    // The shell's own `kill`: a bare machine may have no other.
    let words = format!("kill {signal} {}", child.id());
    let sent = Command::new("sh").args(["-c", &words]).status().expect("a shell");
    assert!(sent.success());
}

#[test]
fn signals_stop_the_robot_and_end_the_program() {
    for (signal, status) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        let seen = ended_by(End::Signal(signal));
        assert_eq!(seen.status, Some(status), "{signal}");
        // 100 ms to the stop, and braking from 0.2 m/s at 2 m/s² takes 100 ms; the rest is for a busy machine.
        assert!(seen.stopped < 0.6, "{signal}: still driving after {} s", seen.stopped);
        assert!(seen.went < 0.09, "{signal}: {} m", seen.went);
        assert!(seen.ended < 3.0, "{signal}: ended after {} s", seen.ended);
        let folder = place_of(End::Signal(signal));
        for file in ["journal", "report.json", "map.geojson"] {
            assert!(folder.join(file).is_file(), "{signal}: no {file}");
        }
        let said = std::fs::read_to_string(folder.with_extension("said")).expect("what was said");
        assert!(said.contains("--resume"), "{signal}: nobody says how to go on: {said}");
    }
}

fn name_of(end: End) -> String {
    match end {
        End::Signal(signal) => format!("line-{signal}"),
        End::Quit => "line-quit".to_owned(),
        End::Suspended => "line-suspended".to_owned(),
        End::TerminalGone => "line-gone".to_owned(),
        End::TerminalStuck => "line-stuck".to_owned(),
        End::StopBehindKeys => "line-behind".to_owned(),
    }
}

fn place_of(end: End) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name_of(end))
}

#[test]
fn a_console_that_is_left_or_loses_its_terminal_stops_the_robot() {
    for end in [End::Quit, End::TerminalGone] {
        let seen = ended_by(end);
        assert!(seen.stopped < 0.6, "{end:?}: still driving after {} s", seen.stopped);
        assert!(seen.went < 0.09, "{end:?}: {} m", seen.went);
        assert!(seen.ended < 3.0, "{end:?}: ended after {} s", seen.ended);
        assert!(was_told_to_stop(end), "{end:?}: the watchdog stopped the robot, or nobody");
    }
}

/// Whether the record says that the robot was told to stop, and did: its watchdog is another reason.
fn was_told_to_stop(end: End) -> bool {
    let record = periplus::journal::read(&place_of(end)).expect("a record");
    record.records.iter().any(|record| {
        let reason = DoneReason::Stopped;
        matches!(&record.entry, Entry::Telemetry(Telemetry::Done { reason: r, .. }) if *r == reason)
    })
}

/// Nobody sees what is written to a terminal that takes nothing: the robot does not drive on alone, and the
/// program is not deaf.
#[test]
fn a_console_whose_terminal_takes_nothing_stops_the_robot_and_can_be_ended() {
    let seen = ended_by(End::TerminalStuck);
    // The terminal is full after two or three frames; a second later the robot is stopped, and brakes.
    assert!(seen.stopped < 2.2, "still driving after {} s", seen.stopped);
    assert!(seen.went < 0.4, "{} m", seen.went);
    assert_eq!(seen.status, Some(143));
    let folder = place_of(End::TerminalStuck);
    for file in ["journal", "report.json", "map.geojson"] {
        assert!(folder.join(file).is_file(), "no {file}");
    }
    let record = periplus::journal::read(&folder).expect("a record");
    let told = record.records.iter().any(|record| {
        matches!(&record.entry, Entry::Event(event) if event.kind.to_string().contains("console"))
    });
    assert!(told, "the record does not say why");
}

/// Nobody looks at a console that sleeps: the robot stands before it does, and stays where it is.
#[test]
fn a_console_that_is_put_to_sleep_stops_the_robot_and_can_be_woken() {
    let seen = ended_by(End::Suspended);
    assert!(seen.stopped < 0.6, "still driving after {} s", seen.stopped);
    assert!(seen.went < 0.09, "{} m", seen.went);
    // Nobody answers what this terminal is asked: it must not be asked anything.
    assert_eq!(seen.status, Some(0));
    assert!(was_told_to_stop(End::Suspended), "the watchdog stopped the robot, or nobody");
}

/// However much is said before it at once: a stop does not wait for the next key.
#[test]
fn a_stop_behind_a_thousand_keys_is_heard() {
    let seen = ended_by(End::StopBehindKeys);
    assert!(seen.stopped < 1.2, "still driving after {} s", seen.stopped);
    assert!(seen.went < 0.21, "{} m", seen.went);
    assert_eq!(seen.status, Some(0));
}

#[test]
fn a_killed_host_leaves_the_robot_to_its_watchdog() {
    let seen = ended_by(End::Signal("-KILL"));
    // 300 ms of silence since the last ping at most 100 ms old, then braking.
    assert!(seen.stopped < 0.9, "still driving after {} s", seen.stopped);
    assert!(seen.went < 0.12, "{} m", seen.went);
    let record = periplus::journal::read(&place_of(End::Signal("-KILL"))).expect("a record");
    assert!(!record.records.is_empty(), "nothing was kept");
}
