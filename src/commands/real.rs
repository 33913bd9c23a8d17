//! The commands that reach for a port: `run --port`, `console --port`, `robot` and `ports`. What a run that was
//! interrupted needs to go on is in `resume`.

mod resume;

use super::ending::{self, Kept, Told};
use super::{CommandError, glue, output, world};
use crate::cli::{ArgumentError, Common, RobotArgs, RobotChoice};
use crate::console::app::Options;
use crate::console::driver::Driver;
use crate::console::terminal;
use crate::export::body;
use crate::firmware::Device;
use crate::geometry::Pose;
use crate::link::{Address, Faults, FaultyWay, RobotEnd, port};
use crate::mapping::map::Phase;
use crate::mapping::settings::Settings;
use crate::robot::Intent;
use crate::runtime::line::Line;
use crate::runtime::live::{LiveRun, Plan};
use crate::runtime::progress::Bar;
use crate::runtime::robot::SimulatedRobot;
use crate::runtime::{Driven, Ending, OutputFolder, Signals, Stopwatch};
use crate::session::Snapshot;
use crate::simulator::Body;
use std::fs::File;
use std::io::IsTerminal;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// The port that was asked for, if one was.
///
/// # Errors
/// When it is no port's name, or a speed is given that has no serial port.
pub fn address(
    choice: &RobotChoice,
    configured: Option<(String, String)>,
) -> Result<Option<Address>, CommandError> {
    let flag = choice.port.clone().map(|port| (port, "--port".to_owned()));
    let Some((text, place)) = flag.or(configured.filter(|_| choice.world.is_none())) else {
        let alone =
            |baud| format!("--baud {baud}: the speed of a serial port; name it with --port");
        return choice.baud.map_or(Ok(None), |baud| Err(CommandError::Input(alone(baud))));
    };
    let address: Address =
        text.parse().map_err(|why| CommandError::Input(format!("{place}: {why}")))?;
    if let (Address::Tcp { .. }, Some(baud)) = (&address, choice.baud) {
        let why = "is the speed of a serial port, and a network has none of its own; set it at the bridge";
        return Err(CommandError::Input(format!("--baud {baud}: {address}: {why}")));
    }
    Ok(Some(address.at_baud(choice.baud)))
}

/// What the flags say; where a real robot stands is the origin, unless `--start` says otherwise.
fn settings(common: &Common) -> Result<Settings, CommandError> {
    let start = common.robot.start.unwrap_or(Pose::new(0.0, 0.0, 0.0));
    Ok(common.settings(start, common.body()?))
}

/// Opens the port over a fresh folder, or over that of an interrupted run.
fn open(
    address: &Address,
    common: &Common,
    until: Option<Phase>,
    at_once: bool,
    out: &Path,
    told: Told,
) -> Result<(Line, OutputFolder), CommandError> {
    if let Some(dir) = &common.keeping.resume {
        return resume::take_up(address, common, (until, at_once), told, dir);
    }
    OutputFolder::refuse_taken(out)?;
    let plan = Plan { settings: settings(common)?, port: address.to_string(), until, at_once };
    let (folder, journal) = OutputFolder::create(out)?;
    match Line::open(address.clone(), plan, journal, None) {
        Ok(line) => Ok((line, folder)),
        Err(error) => {
            // Nothing happened: the folder stays free for another try.
            folder.discard_unbegun();
            Err(CommandError::Input(error.to_string()))
        }
    }
}

/// Maps with the robot at `address`, without a terminal.
///
/// # Errors
/// When the port cannot be opened or the folder not be written.
pub fn run(
    address: &Address,
    common: &Common,
    until: Option<Phase>,
    out: &Path,
    told: Told,
) -> Result<u8, CommandError> {
    let (line, folder) = open(address, common, until, true, out, told)?;
    let signals = Signals::listen()
        .map_err(|source| CommandError::System { what: "listening for signals", source })?;
    let watch = Stopwatch::start();
    let mut bar = Bar::new();
    let (mut ending, signal) = loop {
        if let Some(signal) = signals.received() {
            let reason = format!("stopped by {}", signal.name());
            let outcome = crate::export::Outcome::Stopped;
            break (Ending { outcome, reason }, Some(signal));
        }
        if let Some(ending) = line.ending(Duration::from_millis(20)) {
            break (ending, None);
        }
        if let Some(progress) = line.progress() {
            bar.show(&progress, watch.seconds());
        }
    };
    let Some(mut run) = line.leave() else {
        return Err(CommandError::Input("the control thread failed; see the record".to_owned()));
    };
    if signal.is_none()
        && let Some(last) = run.ending()
    {
        ending = last;
    }
    // The robot stands by now, however long the terminal takes.
    let heard = bar.clear();
    let driven = Driven { ending, signal, wall_seconds: watch.seconds() };
    let kept = write(&mut run, &driven.ending, &folder, driven.wall_seconds);
    if signal.is_some() && !heard && std::io::stdout().is_terminal() {
        // Told to end, it does not wait for a terminal that takes nothing to take the last line.
        return Ok(driven.status());
    }
    // Where it lost itself, how it ended says how to go on.
    let told_how = driven.ending.reason.contains("--resume");
    let unfinished = run.can_go_on() && kept != Kept::Nothing && !told_how;
    let record = run.record(&driven.ending, driven.wall_seconds);
    let said =
        |record| ending::print_squared(record).and_then(|()| ending::print_unreached(record));
    let said = record.as_ref().map_or(Ok(()), said);
    let figures = record.and_then(|record| body::figures(&record));
    drop(run);
    let mut status = kept.status(driven.status());
    said?;
    if told == Told::Measured && kept != Kept::Nothing {
        status = status.max(ending::print_measured(figures, &folder)?);
    }
    ending::print(&driven.ending, &folder, &kept)?;
    if unfinished {
        say_unfinished(&folder);
    }
    Ok(status)
}

/// Ends the record and writes the results; tells what was kept.
fn write(run: &mut LiveRun<File>, ending: &Ending, folder: &OutputFolder, seconds: f64) -> Kept {
    let recorded = run.conclude();
    let record = run.record(ending, seconds);
    let results = record.map(|record| folder.write_results(&record));
    if results.is_none() {
        folder.discard_unbegun();
    }
    results.map_or(Kept::Nothing, |failures| Kept::unless(folder.complaint(recorded, &failures)))
}

/// Says how to go on with a run that has not come to its end, where its record is there.
fn say_unfinished(folder: &OutputFolder) {
    if !folder.journal().exists() {
        return;
    }
    let dir = folder.path().display();
    output::say(&format!("periplus: the run was not finished; --resume {dir} goes on with it"));
}

/// A robot under an operator's hands; the control thread has it.
struct LiveDriver {
    line: Line,
    waiting: Snapshot,
}

impl Driver for LiveDriver {
    fn snapshot(&self) -> Snapshot {
        // Asked first: what was followed by then is in the picture.
        let asked = self.line.is_behind();
        let shown = self.line.snapshot();
        let snapshot = shown.map_or_else(|| self.waiting.clone(), Arc::unwrap_or_clone);
        Snapshot { asked, ..snapshot }
    }

    fn version(&self) -> u64 {
        self.line.version()
    }

    fn intent(&mut self, intent: Intent) {
        self.line.intent(intent);
    }

    fn advance(&mut self, _seconds: f64) {}

    fn attended(&mut self) {
        self.line.attended();
    }

    fn failure(&self) -> Option<String> {
        self.line.failure()
    }

    fn has_own_time(&self) -> bool {
        false
    }

    fn export(&mut self, _dir: &Path) -> Result<String, String> {
        let how = "the map is written on leaving; in another shell `periplus export` makes it now";
        Err(how.to_owned())
    }
}

/// The console on the robot at `address`.
///
/// # Errors
/// When the port cannot be opened or the terminal not be used.
pub fn console(address: &Address, screen: Options, common: &Common) -> Result<u8, CommandError> {
    let out = match (&common.keeping.resume, &common.keeping.out) {
        (Some(dir), _) | (None, Some(dir)) => dir.clone(),
        (None, None) => glue::state_folder()?,
    };
    // Asked for first, so that a panic stops the robot before it writes to the terminal.
    terminal::restore_before_reports();
    let (line, folder) = open(address, common, None, false, &out, Told::Ending)?;
    let waiting = Snapshot::waiting(settings(common)?, address.to_string());
    let watch = Stopwatch::start();
    let mut driver = LiveDriver { line, waiting };
    let ended = glue::on_screen(&mut driver, screen);
    let run = driver.line.leave();
    let ended = ended?;
    let why = glue::why_left(&ended);
    let (mut kept, mut unfinished, mut unrecorded) = (Kept::Whole, false, false);
    if let Some(mut run) = run {
        let left = Ending { outcome: crate::export::Outcome::Stopped, reason: why };
        let ending = run.ending().unwrap_or(left);
        unfinished = run.can_go_on();
        unrecorded = run.is_unrecorded();
        kept = write(&mut run, &ending, &folder, watch.seconds());
        if kept == Kept::Nothing {
            output::say(&format!("periplus: nothing was recorded: {}", ending.reason));
        }
    }
    // An operator who leaves before the robot was there has seen that it was not.
    let status = if kept == Kept::Nothing && !unrecorded { 0 } else { kept.status(0) };
    glue::say_recorded(&folder, &kept);
    if unfinished && kept != Kept::Nothing {
        say_unfinished(&folder);
    }
    Ok(glue::status_of(ended, status))
}

/// A simulated robot on a line, until a signal comes.
///
/// # Errors
/// When the world is wrong or the line cannot be had.
pub fn robot(args: &RobotArgs) -> Result<u8, CommandError> {
    let common = Common { robot: args.robot.clone(), ..Common::default() };
    let (common, places) = common.with_config()?;
    let speed = args.speed.unwrap_or(1.0);
    if !(0.1..=1000.0).contains(&speed) {
        let why = format!("--speed {speed}: from 0.1 to 1000 times as fast as life");
        return Err(CommandError::Input(why));
    }
    let faults: Faults = match args.faults.as_deref().map(str::parse) {
        Some(Ok(faults)) => faults,
        Some(Err(why)) => return Err(CommandError::Input(format!("--faults {why}"))),
        None => Faults::default(),
    };
    let world = args.world.clone().or(places.world);
    let world = world.ok_or(ArgumentError::Missing { command: "robot", flag: "--world FILE" })?;
    let world = world::load(&world, &common)?;
    let chassis = common.body()?;
    let signals = Signals::listen()
        .map_err(|source| CommandError::System { what: "listening for signals", source })?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime =
        runtime.map_err(|source| CommandError::System { what: "the event loop", source })?;
    runtime.block_on(async {
        let refused = |error: port::PortError| CommandError::Input(error.to_string());
        let end = match &args.port {
            Some(port) => {
                let address: Address =
                    port.parse().map_err(|why| CommandError::Input(format!("--port {why}")))?;
                let end = RobotEnd::at(&address).await.map_err(refused)?;
                output::print(&format!("{address}\n"))?;
                end
            }
            None if args.pty => {
                let (end, path) = RobotEnd::pty().map_err(refused)?;
                output::print(&format!("{path}\n"))?;
                end
            }
            None => {
                let missing =
                    ArgumentError::Missing { command: "robot", flag: "--pty or --port DEVICE" };
                return Err(missing.into());
            }
        };
        let (noise, seed) =
            (common.robot.noise.unwrap_or_default(), common.robot.seed.unwrap_or(1));
        // Twice the largest seed is none.
        let ways = seed.wrapping_mul(2);
        let mut robot = SimulatedRobot {
            device: Device::new(&chassis, &world.name, std::process::id(), speed),
            body: Body::new(&world, &chassis, noise, seed),
            speed,
            ways: (FaultyWay::new(faults, ways), FaultyWay::new(faults, ways.wrapping_add(1))),
        };
        Ok(robot.serve(end, &signals).await.status())
    })
}

/// Lists the serial ports.
///
/// # Errors
/// When they cannot be printed.
pub fn ports() -> Result<u8, CommandError> {
    let lines = port::list();
    if lines.is_empty() {
        output::say("periplus: no serial ports; tcp://HOST:PORT and pseudo-terminals need none");
    }
    for line in lines {
        output::print(&format!("{line}\n"))?;
    }
    Ok(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The port may be named in a file as well as by a flag.
    #[test]
    fn a_speed_is_that_of_a_serial_port() {
        let flags = |port: Option<&str>| RobotChoice {
            port: port.map(str::to_owned),
            baud: Some(57_600),
            ..RobotChoice::default()
        };
        let in_file = |port: &str| Some((port.to_owned(), "lab.toml:1: `port`".to_owned()));
        let speed = |choice: RobotChoice, file| match address(&choice, file).expect("a port") {
            Some(Address::Serial { path, baud }) => (path, baud),
            other => unreachable!("{other:?}"),
        };
        let told = ("/dev/ttyS9".to_owned(), 57_600);
        assert_eq!(speed(flags(Some("/dev/ttyS9")), None), told);
        assert_eq!(speed(flags(None), in_file("/dev/ttyS9")), told);
        let refused = |choice: RobotChoice, file| {
            address(&choice, file).expect_err("no serial port").to_string()
        };
        let network = "tcp://robot.local:3333";
        for why in [refused(flags(Some(network)), None), refused(flags(None), in_file(network))] {
            assert!(why.contains("--baud 57600") && why.contains(network), "{why}");
        }
        let why = refused(flags(None), None);
        assert!(why.contains("--baud 57600") && why.contains("--port"), "{why}");
    }
}
