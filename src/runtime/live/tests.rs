//! The whole run over a line that loses, bends, doubles and delays bytes, with a simulated robot at
//! the other end; in virtual time.

mod adversity;
mod attended;
mod carried;
mod liar;
mod others;
mod outage;
mod same;
mod stops;

use super::*;
use crate::firmware::{Device, STEP};
use crate::link::{Faults, FaultyWay};
use crate::mapping::event::EventKind;
use crate::robot::Hardware;
use crate::session::RunState;
use crate::simulator::{Body, NoiseProfile, World};
use liar::{Broken, Liar};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A record in memory that outlives its host.
#[derive(Clone, Default)]
struct Memory {
    bytes: std::rc::Rc<std::cell::RefCell<Vec<u8>>>,
    /// How many writes the disk still has room for; none: for all.
    room: std::rc::Rc<std::cell::Cell<Option<usize>>>,
}

impl Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match self.room.get() {
            Some(0) => return Err(std::io::Error::other("no space left on device")),
            Some(left) => self.room.set(Some(left - 1)),
            None => {}
        }
        self.bytes.borrow_mut().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Whether anything passes the line, either way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Passage {
    Open,
    /// The next command is lost, and all that follows.
    UntilACommand,
    Cut,
}

/// A robot, a line and a host.
struct Rig {
    run: LiveRun<Memory>,
    memory: Memory,
    device: Device,
    /// How often it was started: no two lives have one number.
    boots: u32,
    body: Body,
    down: FaultyWay,
    up: FaultyWay,
    now: f64,
    host_dead: bool,
    line: Passage,
    /// The line hands on what it was given only so often, seconds; 0 for at once.
    bundle: f64,
    /// What the robot says its wheels did, as shares of what they did.
    lie: [f64; 2],
    /// What its clock says at a time, both in microseconds.
    clock: fn(u64) -> u64,
    broken: Option<Broken>,
    chattered: bool,
    /// Edges of one switch that come all at once.
    storm: u32,
    /// What the robot hears, read beside it: where it was when it last had a good line.
    ear: crate::wire::Decoder,
    good: crate::geometry::Point,
    /// Farthest that it ever went without one, metres.
    farthest: f64,
}

fn rig(faults: Faults, seed: u64, at_once: bool) -> Rig {
    let text = include_str!("../../../sims/rectangle.toml");
    let world = World::from_toml(text, "rectangle", 0.1).expect("a world");
    rig_in(&world, NoiseProfile::None, faults, seed, (at_once, Some(Phase::Boundary)))
}

/// A robot in `world`, at its start; whether it goes on by itself, and to the end of which phase.
fn rig_in(
    world: &World,
    noise: NoiseProfile,
    faults: Faults,
    seed: u64,
    (at_once, until): (bool, Option<Phase>),
) -> Rig {
    let chassis = crate::wire::told(&crate::robot::Chassis::default());
    let memory = Memory::default();
    let settings = Settings { seed, ..Settings::new(world.start) };
    let plan = Plan { settings, port: "test".to_owned(), until, at_once };
    Rig {
        run: LiveRun::new(plan, Host::new(115_200, 7, 0.0), Some(memory.clone())),
        memory,
        device: Device::new(&chassis, "tin", 3, 1.0),
        boots: 3,
        body: Body::new(world, &chassis, noise, seed),
        down: FaultyWay::new(faults, seed * 2),
        up: FaultyWay::new(faults, seed * 2 + 1),
        now: 0.0,
        host_dead: false,
        line: Passage::Open,
        bundle: 0.0,
        lie: [1.0, 1.0],
        clock: |us| us,
        broken: None,
        chattered: false,
        storm: 0,
        ear: crate::wire::Decoder::default(),
        good: world.start.position,
        farthest: 0.0,
    }
}

impl Rig {
    /// 10 ms of everybody's time.
    fn step(&mut self) {
        let bundles = |at: f64| (at / self.bundle).floor();
        let before = self.now;
        self.now += STEP / 2.0;
        let due = self.bundle == 0.0 || bundles(before) < bundles(self.now);
        if !self.host_dead {
            let up = if due { self.up.take(self.now) } else { Vec::new() };
            self.run.receive(&up, self.now);
            self.run.tick(self.now);
            let out = self.run.take_output();
            if self.line == Passage::UntilACommand && orders(&out) {
                self.line = Passage::Cut;
            }
            if self.line != Passage::Cut {
                self.down.put(&out, self.now);
            }
        }
        let down = if due { self.down.take(self.now) } else { Vec::new() };
        let at = self.body.true_pose().position;
        let heard = |item: &crate::wire::Item| matches!(item, crate::wire::Item::Body(_));
        if self.ear.feed(&down).filter(heard).count() > 0 {
            self.good = at;
        }
        self.farthest = self.farthest.max((at - self.good).norm());
        let mut liar = Liar {
            body: &mut self.body,
            lie: self.lie,
            clock: self.clock,
            broken: self.broken,
            chattered: &mut self.chattered,
            storm: &mut self.storm,
        };
        self.device.receive(&down);
        let even = ((self.now / STEP * 2.0).round() as u64).is_multiple_of(2);
        if even {
            self.device.step(&mut liar, |_, _| {});
            self.body.step(STEP);
        }
        let out = self.device.take_output();
        if self.line != Passage::Cut {
            self.up.put(&out, self.now);
        }
    }

    /// Alarms in the log that say `what`.
    fn alarms(&self, what: &str) -> usize {
        let is =
            |kind: &EventKind| matches!(kind, EventKind::Alarm { what: w } if w.contains(what));
        let events = self.run.session().expect("a session").events();
        events.iter().filter(|event| is(&event.kind)).count()
    }

    fn run_state(&self) -> RunState {
        self.run.session().expect("a session").run_state()
    }

    /// The board is started again: its motors stand still then.
    fn reboot(&mut self) {
        self.boots += 1;
        self.device = Device::new(&crate::robot::Chassis::default(), "tin", self.boots, 1.0);
        Hardware::drive(&mut self.body, 0.0, 0.0);
    }

    fn until(&mut self, seconds: f64, done: impl Fn(&Self) -> bool) -> bool {
        let end = self.now + seconds;
        while self.now < end {
            if done(self) {
                return true;
            }
            self.step();
        }
        done(self)
    }

    fn speed(&mut self) -> f64 {
        let before = self.body.true_pose();
        for _ in 0..2 {
            self.step();
        }
        let moved = self.body.true_pose().position - before.position;
        moved.norm() / STEP
    }
}

/// Whether a motion is among what the host says.
fn orders(said: &[u8]) -> bool {
    let is = |item: &crate::wire::Item| matches!(item, crate::wire::Item::Body(body) if body.starts_with(['M', 'T', 'R']));
    crate::wire::Decoder::default().feed(said).any(|item| is(&item))
}

#[test]
fn a_lap_over_a_good_line() {
    let mut rig = rig(Faults::default(), 1, true);
    assert!(rig.until(900.0, |rig| rig.run.ending().is_some()), "it goes on for ever");
    let ending = rig.run.ending().expect("an ending");
    assert_eq!(ending.outcome, Outcome::Complete, "{}", ending.reason);
    let map = rig.run.session().expect("a session").mission().map();
    assert!(map.closed);
}

#[test]
fn a_lap_over_a_line_that_loses_and_bends_a_twentieth() {
    for seed in 1..=4 {
        let faults =
            Faults { drop: 0.02, flip: 0.02, double: 0.01, delay: 0.03, ..Faults::default() };
        let mut rig = rig(faults, seed, true);
        assert!(rig.until(3000.0, |rig| rig.run.ending().is_some()), "seed {seed} hangs");
        let ending = rig.run.ending().expect("an ending");
        assert_eq!(ending.outcome, Outcome::Complete, "seed {seed}: {}", ending.reason);
        let shape = rig.run.session().expect("a session").mission().map().clone();
        assert!(shape.closed, "seed {seed}");
    }
}

#[test]
fn a_host_that_falls_silent_leaves_the_robot_standing() {
    for at in [5.0, 20.0, 33.0, 47.0] {
        let mut rig = rig(Faults::default(), 1, true);
        rig.until(at, |_| false);
        rig.host_dead = true;
        let from = rig.body.true_pose().position;
        rig.until(2.0, |_| false);
        let went = (rig.body.true_pose().position - from).norm();
        // 0.3 s of watchdog and braking from 0.2 m/s at 1 m/s².
        assert!(went < 0.2 * 0.34 + 0.02, "{went} m after {at} s");
        assert!(!rig.device.is_moving());
        assert!(rig.speed() < 1e-9);
    }
}

#[test]
fn a_short_silence_is_an_ordinary_end_of_a_motion() {
    let faults = Faults { mute: (20.0, 20.7), ..Faults::default() };
    let mut rig = rig(faults, 1, true);
    assert!(rig.until(900.0, |rig| rig.run.ending().is_some()));
    assert_eq!(rig.run.ending().expect("an ending").outcome, Outcome::Complete);
}

#[test]
fn a_long_silence_latches_and_the_operator_goes_on() {
    let faults = Faults { mute: (20.0, 24.0), ..Faults::default() };
    let mut rig = rig(faults, 1, false);
    assert!(rig.until(3.0, |rig| rig.run.session().is_some()));
    let now = rig.now;
    rig.run.intent(Intent::Run, now);
    rig.until(22.5, |_| false);
    let state = rig.run.session().expect("a session").run_state();
    assert_eq!(state, RunState::Stopped, "the link was lost");
    assert!(matches!(rig.run.snapshot(rig.now).robot, crate::session::Known::Stale { .. }));
    rig.until(6.0, |_| false);
    assert_eq!(rig.run.host().health(), Health::Up, "the line came back");
    assert!(rig.speed() < 1e-9, "it moved without a word of the operator");
    let now = rig.now;
    rig.run.intent(Intent::ClearStop, now);
    rig.run.intent(Intent::Run, now);
    assert!(rig.until(900.0, |rig| rig.run.ending().is_some()));
    assert_eq!(rig.run.ending().expect("an ending").outcome, Outcome::Complete);
}

#[test]
fn a_stop_wins_whatever_the_line_does() {
    for seed in 0..40 {
        let faults = Faults { drop: 0.2, flip: 0.05, delay: 0.1, ..Faults::default() };
        let mut rig = rig(faults, seed, false);
        rig.until(10.0, |rig| rig.run.session().is_some());
        if rig.run.session().is_none() {
            continue;
        }
        let now = rig.now;
        rig.run.intent(Intent::Run, now);
        rig.until(1.0 + seed as f64 * 0.37, |_| false);
        let now = rig.now;
        rig.run.intent(Intent::Stop, now);
        rig.until(1.5, |_| false);
        assert!(rig.speed() < 1e-9, "seed {seed} still moves");
        assert!(!rig.device.is_moving(), "seed {seed}");
    }
}

#[test]
fn a_robot_that_was_started_again_is_not_believed() {
    let mut rig = rig(Faults::default(), 1, true);
    rig.until(30.0, |_| false);
    rig.reboot();
    assert!(rig.until(5.0, |rig| rig.run.ending().is_some()));
    let ending = rig.run.ending().expect("an ending");
    assert_eq!(ending.outcome, Outcome::Failed);
    assert!(ending.reason.contains("started again"), "{}", ending.reason);
    rig.until(1.0, |_| false);
    assert!(!rig.device.is_moving());
}

#[test]
fn nobody_there_is_said() {
    let mut rig = rig(Faults { drop: 1.0, ..Faults::default() }, 1, true);
    assert!(rig.until(6.0, |rig| rig.run.ending().is_some()));
    assert!(rig.run.ending().expect("an ending").reason.contains("switched on"));
}

/// A new host takes up the run of one that died; the robot was `placed` somewhere else, if it was.
fn resurrect(rig: &mut Rig, session: u32, placed: Option<Pose>) {
    let bytes = rig.memory.bytes.borrow().clone();
    let recording =
        crate::journal::reader::parse(std::path::Path::new("memory"), &bytes).expect("a record");
    rig.memory.bytes.borrow_mut().truncate(recording.sound);
    let header = recording.header.clone();
    let records = recording.records.len() as u64;
    let life = recording.life();
    let mut replay = crate::session::Replay::new(recording);
    replay.finish();
    assert_eq!(replay.difference(), None);
    let (before, unrecorded) = replay.into_session();
    let interrupted = Interrupted {
        session: before,
        robot: header.robot.expect("a robot"),
        life,
        placed,
        unrecorded,
        records,
    };
    let plan = Plan {
        settings: header.settings,
        port: "test".to_owned(),
        until: header.until,
        at_once: true,
    };
    let host = Host::new(115_200, session, rig.now);
    rig.run = LiveRun::new(plan, host, Some(rig.memory.clone())).going_on(interrupted);
    rig.host_dead = false;
}

#[test]
fn a_host_that_is_killed_again_and_again_ends_with_the_same_map() {
    let mut whole = rig(Faults::default(), 1, true);
    assert!(whole.until(900.0, |rig| rig.run.ending().is_some()));
    let area = |rig: &Rig| {
        let map = rig.run.session().expect("a session").mission().map();
        crate::mapping::shape::AlongWall::of(&map.contacts, 0.16)
            .outline(0.0, crate::mapping::shape::Loops::Touched)
            .expect("an outline")
            .area()
    };
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for trial in 0..6 {
        let mut rig = rig(Faults::default(), 1, true);
        let mut lives = 0;
        while rig.run.ending().is_none() {
            lives += 1;
            let life = 3.0 + rng.random::<f64>() * 30.0;
            if rig.until(life, |rig| rig.run.ending().is_some()) {
                break;
            }
            // A dead host hears nothing; what it wrote last may be cut anywhere.
            rig.host_dead = true;
            let cut = rng.random_range(0..40);
            let length = rig.memory.bytes.borrow().len();
            rig.memory.bytes.borrow_mut().truncate(length.saturating_sub(cut));
            rig.until(0.2 + rng.random::<f64>() * 3.0, |_| false);
            rig.up.clear();
            resurrect(&mut rig, 100 + lives, None);
            assert!(lives < 200, "trial {trial} does not come to an end");
        }
        let ending = rig.run.ending().expect("an ending");
        assert_eq!(ending.outcome, Outcome::Complete, "trial {trial}: {}", ending.reason);
        assert!(lives > 3, "trial {trial} was hardly killed");
        let off = (area(&rig) - area(&whole)).abs();
        assert!(off < 0.05, "trial {trial}: {off} m² off after {lives} lives");
    }
}

/// Runs of one lap over lines with random faults: whatever happens, the robot never goes farther on its
/// own than its watchdog and its brakes let it, what is called complete is right, and it ends.
fn faulty_runs(seeds: std::ops::Range<u64>) {
    let (mut complete, mut lost) = (0, 0);
    for seed in seeds {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut share =
            |most: f64| if rng.random::<f64>() < 0.4 { rng.random::<f64>() * most } else { 0.0 };
        let slow = share(2.0).max(0.05);
        let faults = Faults {
            drop: share(0.15),
            flip: share(0.05),
            double: share(0.05),
            swap: share(0.05),
            delay: share(slow),
            mute: if share(1.0) > 0.3 { (20.0, 20.0 + share(3.0)) } else { (0.0, 0.0) },
        };
        let reboot = share(1.0) > 0.8;
        let mut rig = rig(faults, seed, true);
        if reboot {
            rig.until(25.0, |rig| rig.run.ending().is_some());
            rig.reboot();
        }
        assert!(
            rig.until(4000.0, |rig| rig.run.ending().is_some()),
            "seed {seed} hangs: {faults:?}"
        );
        let ending = rig.run.ending().expect("an ending");
        // 0.3 s of watchdog at 0.2 m/s, a control step, and braking at 1 m/s².
        assert!(rig.farthest < 0.2 * 0.34 + 0.021, "seed {seed}: {} m", rig.farthest);
        // The last stop is under way for as long as the line takes.
        rig.until(2.0 * faults.delay + 1.0, |_| false);
        if ending.outcome == Outcome::Complete {
            complete += 1;
            let map = rig.run.session().expect("a session").mission().map();
            let outline = crate::mapping::shape::AlongWall::of(&map.contacts, 0.16)
                .outline(0.0, crate::mapping::shape::Loops::Touched)
                .expect("an outline");
            let off = (outline.area() - 20.0).abs();
            assert!(off < 0.1, "seed {seed} is called complete and is {off} m² wrong: {faults:?}");
        } else {
            lost += 1;
            assert!(rig.speed() < 1e-9, "seed {seed} still moves after {}", ending.reason);
            assert!(!ending.reason.is_empty());
        }
    }
    assert!(complete > lost / 4, "{complete} complete, {lost} lost: nothing was tested");
    eprintln!("{complete} complete, {lost} ended with what was lost");
}

#[test]
fn faulty_lines_never_cost_more_than_the_run() {
    faulty_runs(0..40);
}

/// `cargo test --release -- --ignored a_thousand`
#[test]
#[ignore = "minutes; the same as above over a thousand seeds"]
fn a_thousand_faulty_lines() {
    faulty_runs(0..1000);
}

#[test]
fn a_map_with_a_name_is_called_by_it_after_a_resume_as_well() {
    let mut rig = rig(Faults::default(), 1, true);
    rig.run.plan.settings.name = Some("the kitchen".to_owned());
    for resumed in [false, true] {
        assert!(rig.until(5.0, |rig| rig.run.session().is_some()), "nobody there");
        assert_eq!(rig.run.snapshot(rig.now).source, "the kitchen", "resumed: {resumed}");
        let ending = Ending { outcome: Outcome::Stopped, reason: String::new() };
        let record = rig.run.record(&ending, 0.0).expect("a record");
        assert_eq!(record.world, "the kitchen", "resumed: {resumed}");
        if !resumed {
            resurrect(&mut rig, 2, None);
        }
    }
}

/// A robot counts its time from when it was switched on. What a run shows and tells counts from its beginning, and
/// its record played back does so too.
#[test]
fn a_robot_that_was_switched_on_long_ago_begins_its_run_at_nought() {
    use crate::console::driver::Driver;
    use crate::runtime::recorded::RecordedDriver;
    let mut rig = rig(Faults::default(), 1, true);
    rig.clock = |us| us + 500_000_000;
    rig.until(20.0, |_| false);
    let live = rig.run.snapshot(rig.now);
    let late = |snapshot: &crate::session::Snapshot| {
        let events = snapshot.events.iter().map(|event| event.time_us as f64 * 1e-6);
        events.fold(snapshot.time, f64::max)
    };
    assert!(live.time > 15.0 && late(&live) < 20.1, "{} s", late(&live));
    let progress = rig.run.progress().expect("it goes on");
    assert_eq!(progress.time, live.time);
    assert!((live.progress[0].seconds - live.time).abs() < 1e-6, "what the report tells");

    rig.run.hand_record_on();
    let bytes = rig.memory.bytes.borrow().clone();
    let read = || crate::journal::reader::parse(std::path::Path::new("record"), &bytes);
    let mut driver = RecordedDriver::new(crate::session::Replay::new(read().expect("a record")));
    let first = driver.snapshot();
    assert!(matches!(first.robot, crate::session::Known::Known(_)), "it is there from the first");
    assert!(first.time < 0.2, "{} s", first.time);
    assert!(first.source.starts_with("replay 0/20 s of "), "{}", first.source);
    driver.go_to(10.0).expect("an instant");
    let at = driver.snapshot();
    // A report is recorded with the time of the one before.
    assert!((9.9..=10.2).contains(&at.time) && late(&at) <= 10.2, "{} s", at.time);
    assert_eq!(driver.go_to(400.0), Err("the record ends at 20 s".to_owned()));
    driver.intent(Intent::Run);
    driver.advance(5.0);
    assert!((14.9..=15.2).contains(&driver.snapshot().time), "{} s", driver.snapshot().time);
}
