//! What becomes of the robot when this program fails: on a real pseudo-terminal, in real time, with the
//! robot's drive watched.

use super::*;
use crate::export::Outcome;
use crate::firmware::{Device, STEP};
use crate::mapping::settings::Settings;
use crate::robot::Chassis;
use crate::session::{Known, RunState};
use crate::simulator::{Body, NoiseProfile, World};
use tokio_serial::{SerialPort, SerialStream};

/// Which part of the program fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Failing {
    /// The thread that keeps the robot.
    Control,
    /// Whoever holds the line: the screen.
    Screen,
    /// Somebody who has nothing to do with it, while the line is held on to.
    Bystander,
    /// Nobody, but who held the line lets go of it without a word.
    Holder,
    /// None of it: the line is unplugged.
    Nothing,
}

/// What the robot's side saw.
struct Seen {
    /// Seconds from the failure until the drive stood still, and metres driven meanwhile.
    stopped: f64,
    went: f64,
    ending: Option<Ending>,
    /// What the screen shows last, looking as the console does.
    shown: Option<Arc<Snapshot>>,
}

/// Looks as the console does, at every new picture, for so many seconds.
fn look(line: &Line, seconds: f64) -> Option<Arc<Snapshot>> {
    let watch = Stopwatch::start();
    let (mut drawn, mut shown) = (None, None);
    while watch.seconds() < seconds {
        let version = line.version();
        if drawn != Some(version) {
            shown = line.snapshot();
            drawn = Some(version);
        }
        std::thread::park_timeout(Duration::from_millis(33));
    }
    shown
}

/// Fails so; whoever lets go of the line waits for its last word elsewhere.
fn fail(what: Failing, line: &mut Option<Line>) {
    match what {
        Failing::Nothing => {}
        Failing::Control => {
            let held = line.as_ref().expect("still held");
            held.requests.send(Request::Panic).expect("it listens");
        }
        Failing::Bystander => drop(std::thread::spawn(|| panic!("asked to"))),
        Failing::Holder => {
            let line = line.take();
            std::thread::spawn(move || drop(line));
        }
        Failing::Screen => {
            let line = line.take();
            std::thread::spawn(move || {
                let _line = line;
                panic!("asked to");
            });
        }
    }
}

fn failing(what: Failing) -> Seen {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.expect("a runtime");
    let text = include_str!("../../../sims/rectangle.toml");
    let world = World::from_toml(text, "rectangle", 0.1).expect("a world");
    let mut device = Device::new(&Chassis::default(), "tin", 1, 1.0);
    let mut body = Body::new(&world, &Chassis::default(), NoiseProfile::None, 1);
    let (mut ours, theirs) = {
        let _inside = runtime.enter();
        SerialStream::pair().expect("a pseudo-terminal")
    };
    let address: Address = theirs.name().expect("a name").parse().expect("an address");
    let port = address.to_string();
    let plan = Plan { settings: Settings::new(world.start), port, until: None, at_once: true };
    let record = std::env::temp_dir().join(format!("periplus-{}-{what:?}", std::process::id()));
    let journal = File::create(&record).expect("a record");
    let mut line = Some(Line::open(address, plan, journal, None).expect("the line opens"));
    let seen = runtime.block_on(async {
        let watch = Stopwatch::start();
        let mut tick = tokio::time::interval(Duration::from_secs_f64(STEP));
        let mut bytes = [0_u8; 512];
        let mut fast = 0;
        let mut failed = None;
        let mut seen = Seen { stopped: f64::NAN, went: f64::NAN, ending: None, shown: None };
        while watch.seconds() < 30.0 {
            tokio::select! {
                biased;
                read = ours.read(&mut bytes) => {
                    let count = read.expect("the line is there");
                    device.receive(&bytes[..count]);
                }
                _ = tick.tick() => {
                    let before = body.true_pose().position;
                    device.step(&mut body, |_, _| {});
                    body.step(STEP);
                    let moved = (body.true_pose().position - before).norm();
                    fast = if moved > 0.0035 { fast + 1 } else { 0 };
                    if let Some((since, from)) = failed && moved < 1e-6 {
                        let from: crate::geometry::Point = from;
                        seen.stopped = watch.seconds() - since;
                        seen.went = (body.true_pose().position - from).norm();
                        break;
                    }
                }
            }
            let said = device.take_output();
            ours.write_all(&said).await.expect("the line takes it");
            if failed.is_none() && fast > 10 {
                failed = Some((watch.seconds(), body.true_pose().position));
                if what == Failing::Nothing {
                    break;
                }
                fail(what, &mut line);
            }
        }
        seen
    });
    drop(ours);
    let shown = line.as_ref().filter(|_| what == Failing::Nothing).and_then(|l| look(l, 1.0));
    let ending = line.as_ref().and_then(|line| line.ending(Duration::from_secs(5)));
    if what == Failing::Control {
        let why = line.as_ref().and_then(Line::failure).expect("said");
        assert!(why.contains("asked to"), "{why}");
        let mut run = line.and_then(Line::leave).expect("what is known is still there");
        run.conclude().expect("the record is whole");
        assert!(run.session().is_some());
    }
    let kept = crate::journal::read(&record).expect("a record");
    assert!(!kept.records.is_empty(), "nothing was kept");
    let _ = std::fs::remove_file(&record);
    Seen { ending, shown, ..seen }
}

/// A keeper of a robot that it has not heard yet, with its record, and the way to ask it for something.
fn keeper(journal: Option<File>, syncing: Option<Syncing>) -> (Keeper, UnboundedSender<Request>) {
    let address: Address = "tcp://192.0.2.1:9".parse().expect("an address");
    let settings = Settings::new(crate::geometry::Pose::new(0.0, 0.0, 0.0));
    let plan = Plan { settings, port: address.to_string(), until: None, at_once: false };
    let run = LiveRun::new(plan, Host::new(0, 1, 0.0), journal);
    let (requests, asked) = unbounded_channel();
    let (watch, shown) = (Stopwatch::start(), Arc::new(Shown::default()));
    let (asked, followed, progress_due) = (Requests::new(asked), 0, 0.0);
    (Keeper { address, run, watch, shown, asked, followed, syncing, progress_due }, requests)
}

/// The same, with a record in a file `name` that does not reach the disk, and a robot that has introduced itself.
fn unsynced(name: &str) -> Keeper {
    let record = std::env::temp_dir().join(format!("periplus-{}-{name}", std::process::id()));
    let journal = File::create(&record).expect("a record");
    let _ = std::fs::remove_file(&record);
    let (tried, tries) = std::sync::mpsc::channel();
    let syncing = Syncing::with(Duration::ZERO, move || {
        let _ = tried.send(());
        Err(std::io::Error::other("input/output error"))
    });
    let (mut keeper, _) = keeper(Some(journal), Some(syncing.expect("a thread")));
    // The second try comes after the first has failed.
    for _ in 0..2 {
        tries.recv().expect("it is tried");
    }
    let mut device = Device::new(&Chassis::default(), "tin", 1, 1.0);
    for _ in 0..2 {
        keeper.run.tick(0.0);
        device.receive(&keeper.run.take_output());
        keeper.run.receive(&device.take_output(), 0.0);
    }
    assert!(keeper.run.session().is_some());
    keeper
}

/// A record that does not reach the disk stops the robot as soon as that is known, and is told as lost at the
/// end at the latest.
#[test]
fn a_record_that_does_not_reach_the_disk_is_noticed_by_the_keeper() {
    let mut keeper = unsynced("unsynced");
    let _ = keeper.run.take_output();
    keeper.tick(0.1);
    assert_eq!(keeper.run.take_output().first(), Some(&STOP));
    let run = unsynced("unsynced-at-the-end");
    assert!(run.into_run().conclude().is_err(), "called whole");
}

/// Nobody reads what was written before; a stop does not wait for that, and who leaves stops the robot first.
#[test]
fn a_stop_does_not_wait_behind_what_the_port_has_not_taken() {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.expect("a runtime").block_on(async {
        for wish in [Request::Intent(Intent::Stop), Request::Leave] {
            let (mut keeper, requests) = keeper(None, None);
            // Room for half a line.
            let (ours, mut theirs) = tokio::io::duplex(8);
            let leaves = matches!(wish, Request::Leave);
            let robot = async {
                let mut said = vec![theirs.read_u8().await.expect("a byte")];
                requests.send(wish).expect("it listens");
                while said.last() != Some(&STOP) {
                    said.push(theirs.read_u8().await.expect("a byte"));
                }
                if !leaves {
                    requests.send(Request::Leave).expect("it listens");
                }
                (said, theirs)
            };
            let both = async { tokio::join!(keeper.converse(Box::new(ours)), robot) };
            let both = tokio::time::timeout(Duration::from_secs(60), both).await;
            let (left, (said, _)) = both.expect("it is left");
            assert!(left, "taken for a port that is gone");
            let before = String::from_utf8_lossy(&said).into_owned();
            assert!(!before.contains('\n'), "the stop came behind `{before}`");
        }
    });
}

/// What came while this program was busy, with a plan or a disk, is read before anybody calls the robot lost, and what
/// is to be said is offered to the port before anybody calls it gone.
#[test]
fn a_keeper_that_was_busy_has_not_lost_its_robot() {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.expect("a runtime").block_on(async {
        let record = std::env::temp_dir().join(format!("periplus-{}-busy", std::process::id()));
        let journal = File::create(&record).expect("a record");
        let _ = std::fs::remove_file(&record);
        let (mut keeper, requests) = keeper(Some(journal), None);
        let (ours, mut theirs) = tokio::io::duplex(4096);
        let world =
            World::from_toml(include_str!("../../../sims/rectangle.toml"), "rectangle", 0.1);
        let mut body =
            Body::new(&world.expect("a world"), &Chassis::default(), NoiseProfile::None, 1);
        let mut device = Device::new(&Chassis::default(), "tin", 1, 1.0);
        let robot = async {
            let mut bytes = [0_u8; 512];
            // No clock is waited for: after each word of the host a tenth of a second has passed.
            for word in 0..40 {
                let count = theirs.read(&mut bytes).await.expect("the line is there");
                device.receive(&bytes[..count]);
                for _ in 0..5 {
                    device.step(&mut body, |_, _| {});
                    body.step(STEP);
                }
                theirs.write_all(&device.take_output()).await.expect("the line takes it");
                let busy = match word {
                    20 => 1.2,
                    25 => 2.0,
                    30 => 12.0,
                    _ => 0.1,
                };
                requests.send(Request::Busy(busy)).expect("it listens");
            }
            requests.send(Request::Leave).expect("it listens");
            theirs
        };
        let both = async { tokio::join!(keeper.converse(Box::new(ours)), robot) };
        let both = tokio::time::timeout(Duration::from_secs(60), both).await;
        assert!(both.expect("it is left").0, "taken for a port that is gone");
        let session = keeper.run.session().expect("a session");
        let told: Vec<String> = session.events().iter().map(|e| e.kind.to_string()).collect();
        assert!(!told.iter().any(|what| what.contains("link lost")), "{told:?}");
    });
}

/// A bridge that does not answer keeps nobody: who is told to leave leaves at once.
#[test]
fn a_bridge_that_does_not_answer_is_left_at_once() {
    let (mut keeper, requests) = keeper(None, None);
    requests.send(Request::Intent(Intent::Stop)).expect("it listens");
    requests.send(Request::Leave).expect("it listens");
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let never = keeper.meanwhile(std::future::pending::<()>());
    assert_eq!(runtime.expect("a runtime").block_on(never), None);
}

/// A line over `bridge`, whose record `name` nobody looks at.
fn line_over(bridge: &std::net::TcpListener, name: &str) -> Line {
    let address = format!("tcp://{}", bridge.local_addr().expect("an address"));
    let address: Address = address.parse().expect("an address");
    let settings = Settings::new(crate::geometry::Pose::new(0.0, 0.0, 0.0));
    let plan = Plan { settings, port: address.to_string(), until: None, at_once: false };
    let record = std::env::temp_dir().join(format!("periplus-{}-{name}", std::process::id()));
    let journal = File::create(&record).expect("a record");
    let _ = std::fs::remove_file(&record);
    Line::open(address, plan, journal, None).expect("the line opens")
}

/// A bridge that lost its power says nothing of it, and the system would keep the connection for minutes.
#[test]
fn a_bridge_that_falls_silent_is_tried_anew() {
    let bridge = std::net::TcpListener::bind("127.0.0.1:0").expect("a free port");
    let line = line_over(&bridge, "bridge");
    let (told, tries) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        // Taken, kept, and never answered.
        for connection in bridge.incoming() {
            if told.send(connection).is_err() {
                return;
            }
        }
    });
    let first = tries.recv_timeout(Duration::from_secs(20));
    let second = tries.recv_timeout(Duration::from_secs(20));
    assert!(first.is_ok() && second.is_ok(), "it is waited for for ever");
    drop(line.leave());
}

/// What was asked for before a stop may take its time, as a plan does: the stop does not wait for it.
#[test]
fn a_stop_does_not_wait_for_what_was_asked_before_it() {
    let bridge = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let line = line_over(&bridge, "ahead");
    let (mut robot, _) = bridge.accept().expect("the line");
    robot.set_read_timeout(Some(Duration::from_secs(20))).expect("a socket");
    let (go_on, ways): (Vec<_>, Vec<_>) = (0..2).map(|_| std::sync::mpsc::channel()).unzip();
    for way in ways {
        line.requests.send(Request::Held(way)).expect("it listens");
    }
    line.intent(Intent::Run);
    line.intent(Intent::Stop);
    assert!(line.is_behind(), "a picture of what was not done yet");
    // It is busy with the first; behind that the second and the stop wait.
    go_on[0].send(()).expect("it is held");
    let mut said = [0];
    while said != [STOP] {
        std::io::Read::read_exact(&mut robot, &mut said).expect("a stop");
    }
    assert!(line.is_behind(), "a picture of what was not done yet");
    go_on[1].send(()).expect("it is held");
    while line.is_behind() {
        std::thread::yield_now();
    }
    drop(line.leave());
}

/// One test, since a panic anywhere stops every robot that this program keeps.
#[test]
fn a_panic_stops_the_robot_and_an_unplugged_line_is_seen() {
    for what in [Failing::Control, Failing::Screen, Failing::Bystander, Failing::Holder] {
        let seen = failing(what);
        // Sooner than the watchdog, which ends it 300 ms after the last word: braking from 0.2 m/s at
        // 2 m/s² takes 100 ms and 10 mm, and the stop 100 ms at most.
        assert!(seen.stopped < 0.4, "{what:?}: still driving after {} s", seen.stopped);
        assert!(seen.went < 0.055, "{what:?}: {} m", seen.went);
        if what == Failing::Control {
            assert_eq!(seen.ending.map(|ending| ending.outcome), Some(Outcome::Failed));
        }
    }
    let seen = failing(Failing::Nothing);
    let shown = seen.shown.expect("a picture");
    assert!(matches!(shown.robot, Known::Stale { age, .. } if age > 0.5), "{:?}", shown.robot);
    assert_eq!(shown.run, RunState::Stopped);
    let why = seen.ending.expect("an ending").reason;
    assert!(why.contains("unplugged"), "{why}");
}
