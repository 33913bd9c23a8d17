//! The commands that reach for a port: `run --port`, `console --port`, `robot` and `ports`.

use super::ending::{self, BOTH_WAYS, Kept, Told};
use super::{CommandError, glue, output, world};
use crate::cli::{ArgumentError, Common, RobotArgs, RobotChoice};
use crate::console::app::Options;
use crate::console::driver::Driver;
use crate::console::terminal;
use crate::export::body;
use crate::firmware::Device;
use crate::geometry::Pose;
use crate::journal::{Header, JournalError, Recording};
use crate::link::{Address, Faults, FaultyWay, RobotEnd, port};
use crate::mapping::map::Phase;
use crate::mapping::mission::Mission;
use crate::mapping::settings::Settings;
use crate::mapping::tape::Tape;
use crate::robot::Intent;
use crate::runtime::line::Line;
use crate::runtime::live::{Interrupted, LiveRun, Plan};
use crate::runtime::progress::Bar;
use crate::runtime::robot::SimulatedRobot;
use crate::runtime::{Driven, Ending, FolderError, OutputFolder, Signals, Stopwatch};
use crate::session::{Replay, Snapshot};
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
        return take_up(address, common, (until, at_once), told, dir);
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

/// Plays the record of an interrupted run back into the core and opens the port to go on with it.
fn take_up(
    address: &Address,
    common: &Common,
    (until, at_once): (Option<Phase>, bool),
    told: Told,
    dir: &Path,
) -> Result<(Line, OutputFolder), CommandError> {
    let refused = |why: String| CommandError::Input(format!("--resume {}: {why}", dir.display()));
    let (folder, mut journal) = reopen(dir)?;
    let recording = crate::journal::read_open(&folder.journal(), &mut journal);
    let recording = recording.map_err(|error| damaged(error, address, dir))?;
    glue::warn_torn(&recording);
    let (header, sound) = (recording.header.clone(), recording.sound as u64);
    let records = recording.records.len() as u64;
    let life = recording.life();
    let robot = header.robot.clone().ok_or_else(|| {
        refused("it was made in the simulator; the same seed makes it again".to_owned())
    })?;
    let mut replay = Replay::new(recording);
    replay.finish();
    if let Some(difference) = replay.difference() {
        let why = format!(
            "the replay differs from the run ({difference}): it was made by another version"
        );
        return Err(refused(why));
    }
    if let Some(Ending { reason, .. }) = Ending::of(replay.session()) {
        let todo = "what is over is not gone on with, begin another with --out DIR";
        return Err(refused(format!("it is over: {reason}; {todo}")));
    }
    if told == Told::Measured {
        measures(&header, replay.session().mission()).map_err(|what| {
            let todo = format!("`periplus run --port {address} --resume {}`", dir.display());
            refused(format!(
                "{what}; {todo} goes on with it, and `periplus calibrate --out DIR` begins another"
            ))
        })?;
    }
    let holds = replay.session().mission().settings();
    same_settings(&header.settings, holds, common).map_err(refused)?;
    if until.is_some() && until != header.until {
        let told = |until: Option<Phase>| until.map_or("not given".to_owned(), |to| to.to_string());
        let (was, now) = (told(header.until), told(until));
        return Err(refused(format!("--until was {was} and is now {now}; leave it out to go on")));
    }
    let (session, unrecorded) = replay.into_session();
    output::say(&format!(
        "periplus: going on in the {} phase, {:.0} s into the run",
        session.mission().phase(),
        session.mission().tracker().passed()
    ));
    if common.keeping.placed.is_some() && session.mission().phase() == Phase::Boundary {
        let why = "the boundary is not closed yet: the lap begins anew from --placed";
        output::say(&format!("periplus: {why}"));
    }
    let plan =
        Plan { settings: header.settings, port: address.to_string(), until: header.until, at_once };
    folder.cut(&mut journal, sound)?;
    let placed = common.keeping.placed;
    let interrupted = Interrupted { session, robot, life, placed, unrecorded, records };
    let line = Line::open(address.clone(), plan, journal, Some(interrupted));
    Ok((line.map_err(|error| CommandError::Input(error.to_string()))?, folder))
}

/// Refuses to go on calibrating with a run that comes to its end without having measured its robot, and says what
/// it is.
fn measures(header: &Header, mission: &Mission) -> Result<(), String> {
    let takes = "and a calibration takes a lap each way round";
    // Fewer than it was begun with are those after which the robot could not go on.
    if mission.settings().laps.max(header.settings.laps) < BOTH_WAYS {
        return Err(format!("it is the record of a run of one lap, {takes}"));
    }
    if header.until == Some(Phase::Boundary) {
        let why = "it is the record of a run that ends with the boundary";
        return Err(format!("{why}, and the laps are laid on the walls after that"));
    }
    if mission.phase() != Phase::Boundary && mission.map().laps < BOTH_WAYS {
        return Err(format!("it is the record of a run that went on after one lap, {takes}"));
    }
    Ok(())
}

/// What to do about a record that is `damaged` in the middle: going on in it would cut off what is behind that. In
/// a copy of what is whole nothing is lost; only the robot has driven on since, and must not be believed to stand
/// where that ends.
fn damaged(error: JournalError, address: &Address, dir: &Path) -> CommandError {
    let JournalError::Damaged { path, line, .. } = &error else { return error.into() };
    let real = |whole: Recording| whole.header.robot.is_some();
    if *line == 1 || !crate::journal::read_whole_part(path).is_ok_and(real) {
        return error.into();
    }
    let (record, whole) = (path.display(), line - 1);
    CommandError::Input(format!(
        "--resume {}: {error}. To go on from there, copy that to a new folder NEW: `mkdir NEW; head -n {whole} \
         {record} > NEW/journal`; switch the robot off and on, since it has driven on after that and has to find \
         its place; then `periplus run --port {address} --resume NEW --placed X,Y,DEG`, with the place where it \
         stands about",
        dir.display()
    ))
}

/// Takes the record of an interrupted run in hand, before it is read: another program may still write to it.
fn reopen(dir: &Path) -> Result<(OutputFolder, File), CommandError> {
    match OutputFolder::reopen(dir) {
        Ok(open) => Ok(open),
        Err(busy @ FolderError::Busy { .. }) => Err(busy.into()),
        Err(error) => {
            // What cannot be read either says more.
            crate::journal::read(dir)?;
            Err(error.into())
        }
    }
}

/// A run goes on as it was begun, and as its operator changed it since: a flag that says something else than
/// what `holds` now is refused with the difference.
fn same_settings(begun: &Settings, holds: &Settings, common: &Common) -> Result<(), String> {
    let unsaid = || "not given".to_owned();
    let named = |name: &Option<String>| name.clone().unwrap_or_else(unsaid);
    let taped = |tape: Option<Tape>| tape.map_or_else(unsaid, as_flag);
    let (mapping, robot) = (&common.mapping, &common.robot);
    if let Some(now) = &common.keeping.name {
        let now = Some(now.clone());
        same("--name", &begun.name, &holds.name, &now, named)?;
    }
    if let Some(now) = mapping.alpha {
        same("--alpha", &begun.alpha, &holds.alpha, &now, f64::to_string)?;
    }
    if let Some(now) = mapping.plan {
        same("--plan", &begun.strategy, &holds.strategy, &now, |plan| format!("{plan:?}"))?;
    }
    if let Some(now) = mapping.contour {
        same("--contour", &begun.contour, &holds.contour, &now, |contour| format!("{contour:?}"))?;
    }
    if let Some(now) = robot.seed {
        same("--seed", &begun.seed, &holds.seed, &now, u64::to_string)?;
    }
    if let Some(now) = robot.start {
        same("--start", &begun.start, &holds.start, &now, |start| format!("{start:?}"))?;
    }
    if let Some(now) = mapping.laps {
        // Fewer than it was begun with are those after which the robot could not go on: nobody wished for them.
        let wished = holds.laps.max(begun.laps);
        same("--laps", &begun.laps, &wished, &now, u32::to_string)?;
    }
    if let Some(now) = mapping.tape {
        same("--tape", &begun.tape, &holds.tape, &Some(now), |tape| taped(*tape))?;
    }
    if mapping.square {
        let given = |square: &bool| if *square { "given".to_owned() } else { unsaid() };
        same("--square", &begun.square, &holds.square, &true, given)?;
    }
    Ok(())
}

/// Refuses a flag whose value `now` differs from the one that `holds`; the one that the run was `begun` with is
/// told as well, where it is another.
fn same<T: PartialEq>(
    flag: &str,
    begun: &T,
    holds: &T,
    now: &T,
    tell: impl Fn(&T) -> String,
) -> Result<(), String> {
    if now == holds {
        return Ok(());
    }
    let then = if begun == holds { String::new() } else { format!(", then {},", tell(holds)) };
    let (was, now) = (tell(begun), tell(now));
    Err(format!("{flag} was {was}{then} and is now {now}; leave it out to go on"))
}

/// A taped length as its flag takes it, metres.
fn as_flag(Tape { from, to, length }: Tape) -> String {
    format!("{},{}:{},{}={length}", from.x, from.y, to.x, to.y)
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
    let record = run.record(&driven.ending, driven.wall_seconds);
    let squared = record.as_ref().map_or(Ok(()), ending::print_squared);
    let figures = record.and_then(|record| body::figures(&record));
    drop(run);
    if signal.is_some() && !heard && std::io::stdout().is_terminal() {
        // Told to end, it does not wait for a terminal that takes nothing to take the last line.
        return Ok(driven.status());
    }
    let mut status = kept.status(driven.status());
    squared?;
    if told == Told::Measured && kept != Kept::Nothing {
        status = status.max(ending::print_measured(figures, &folder)?);
    }
    ending::print(&driven.ending, &folder, &kept)?;
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

/// A robot under an operator's hands; the control thread has it.
struct LiveDriver {
    line: Line,
    waiting: Snapshot,
}

impl Driver for LiveDriver {
    fn snapshot(&self) -> Snapshot {
        let shown = self.line.snapshot();
        shown.map_or_else(|| self.waiting.clone(), Arc::unwrap_or_clone)
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
    let (mut kept, mut unfinished) = (Kept::Whole, false);
    if let Some(mut run) = run {
        let left = Ending { outcome: crate::export::Outcome::Stopped, reason: why };
        let ending = run.ending().unwrap_or(left);
        unfinished = run.ending().is_none();
        kept = write(&mut run, &ending, &folder, watch.seconds());
        if kept == Kept::Nothing {
            output::say(&format!("periplus: nothing was recorded: {}", ending.reason));
        }
    }
    // An operator who leaves before the robot was there has seen that it was not.
    let status = if kept == Kept::Nothing { 0 } else { kept.status(0) };
    glue::say_recorded(&folder, &kept);
    if unfinished && kept != Kept::Nothing {
        let dir = folder.path().display();
        output::say(&format!("periplus: the run was not finished; --resume {dir} goes on with it"));
    }
    Ok(glue::status_of(ended, status))
}

/// A simulated robot on a line, until a signal comes.
///
/// # Errors
/// When the world is wrong or the line cannot be had.
pub fn robot(args: &RobotArgs) -> Result<u8, CommandError> {
    let common = Common { robot: args.robot.clone(), ..Common::default() };
    let (common, _) = common.with_config()?;
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
    let world = world::load(&args.world, &common)?;
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

    /// Read before it is in hand, what the other program writes last would be cut off as damage.
    #[test]
    fn a_record_that_another_program_writes_is_not_even_read() {
        let dir = std::env::temp_dir().join(format!("periplus-{}-busy", std::process::id()));
        std::fs::create_dir_all(&dir).expect("a folder");
        let file = File::create(dir.join("journal")).expect("a record");
        file.try_lock().expect("nobody has it");
        let address: Address = "tcp://127.0.0.1:1".parse().expect("an address");
        let taken = || take_up(&address, &Common::default(), (None, false), Told::Ending, &dir);
        let why = taken().err().expect("two writers").to_string();
        assert!(why.contains("another program is recording"), "{why}");
        drop(file);
        let why = taken().err().expect("it is empty").to_string();
        assert!(why.contains("never began"), "{why}");
        let _ = std::fs::remove_dir_all(&dir);
    }
}
