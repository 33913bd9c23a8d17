//! Where the commands meet the simulator, the session and the console. The functions here are the
//! whole of that meeting; everything else in [`super`] is written against them.

use super::CommandError;
use super::ending::Kept;
use crate::cli::{Common, FrameFormat, FrameSize, ScreenFlags, SnapshotArgs, ThemeName};
use crate::console::action::Action;
use crate::console::app::{self, Options};
use crate::console::driver::Driver;
use crate::console::model::Model;
use crate::console::theme::{self, Theme};
use crate::console::{Keymap, frame};
use crate::journal::{Header, Journal, Recording, Torn};
use crate::runtime::driver::{RealClock, SimulatedDriver};
use crate::runtime::recorded::{RecordedDriver, looked_back_at};
use crate::runtime::simulated::{Headless, SimulatedRun};
use crate::runtime::{OutputFolder, Runner, Signal, Signals};
use crate::session::Replay;
use crate::simulator::{NoiseProfile, World};
use std::fs::File;
use std::path::{Path, PathBuf};

/// Checks a keymap and answers what there is to say of it.
///
/// # Errors
/// Says what is wrong, with file, line and key.
pub fn check_keymap(path: &Path) -> Result<String, String> {
    let keymap = keymap(Some(path)).map_err(|error| error.to_string())?;
    Ok(match keymap.out_of_reach()[..] {
        [] => "keymap".to_owned(),
        ref without => format!(
            "keymap; but with no key for the command line nothing leads to {}",
            without.join(", ")
        ),
    })
}

/// Whether a keymap may give keys to something of this name.
#[must_use]
pub fn is_action(name: &str) -> bool {
    Action::named(name).is_some()
}

/// A run in the simulator, ready to be driven; it keeps the record.
///
/// # Errors
/// When the simulator refuses the world.
pub fn simulated(
    world: &World,
    header: &Header,
    noise: NoiseProfile,
    journal: Journal<File>,
) -> Result<Box<dyn Runner>, CommandError> {
    let run = SimulatedRun::new(world, header.clone(), noise, Some(journal));
    Ok(Box::new(Headless::new(run)))
}

/// The world that `periplus` shows when nothing is said.
const DEMO: &str = include_str!("../../sims/flat.toml");

fn world_or_demo(world: Option<&Path>, common: &Common) -> Result<World, CommandError> {
    match world {
        Some(path) => super::world::load(path, common),
        None => super::world::built_in(DEMO, common),
    }
}

pub(super) fn keymap(path: Option<&Path>) -> Result<Keymap, CommandError> {
    let Some(path) = path else {
        return Ok(Keymap::default());
    };
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|why| CommandError::Input(format!("the keymap {name}: cannot be read: {why}")))?;
    Keymap::parse(&text, &name).map_err(|error| CommandError::Input(error.to_string()))
}

/// The console's keys and colours, where no flag says which as the environment has it: `NO_COLOR`
/// (no-color.org), and the colours that some terminals tell of in `COLORFGBG`.
pub(super) fn options(screen: &ScreenFlags) -> Result<Options, CommandError> {
    let keymap = keymap(screen.keymap.as_deref())?;
    let says = |name| std::env::var_os(name).unwrap_or_default();
    let name = match screen.theme {
        Some(name) => name,
        None if !says("NO_COLOR").is_empty() => ThemeName::Mono,
        None if theme::is_light(&says("COLORFGBG").to_string_lossy()) => ThemeName::Light,
        None => ThemeName::Dark,
    };
    let theme = match name {
        ThemeName::Dark => Theme::dark(),
        ThemeName::Light => Theme::light(),
        ThemeName::Mono => Theme::mono(),
    };
    Ok(Options { keymap, theme })
}

/// The console on a world, or on the built-in one.
///
/// # Errors
/// When the world or the keymap is wrong, or the terminal cannot be used.
pub fn console(
    world: Option<&Path>,
    screen: &ScreenFlags,
    common: &Common,
) -> Result<u8, CommandError> {
    let screen = options(screen)?;
    let world = world_or_demo(world, common)?;
    let header = header_of(&world, common, None)?;
    let out = common.keeping.out.clone().map_or_else(state_folder, Ok)?;
    OutputFolder::refuse_taken(&out)?;
    let (folder, file) = OutputFolder::create(&out)?;
    let journal = Journal::begin(file, &header).map_err(|source| {
        folder.discard_unbegun();
        CommandError::Unrecorded { path: folder.journal(), source }
    })?;
    let noise = common.robot.noise.unwrap_or_default();
    let run = SimulatedRun::new(&world, header, noise, Some(journal));
    let driver = SimulatedDriver::new(run.recorded_at(folder.journal()));
    let mut driver = driver.writing_to(folder.clone());
    let ended = on_screen(&mut driver, screen)?;
    let wall_seconds = driver.wall_seconds();
    let mut headless = Headless::left(driver.into_run());
    let unfinished = headless.inner().ending().is_none();
    let kept = Kept::unless(headless.write(&folder, &why_left(&ended), wall_seconds));
    let status = kept.status(0);
    say_recorded(&folder, &kept);
    if unfinished && kept == Kept::Whole {
        // A line each that an 80 column terminal does not break in the middle of a word.
        super::output::say("periplus: the run was not finished: the map is as far as it went");
        super::output::say(
            "periplus: a simulated run cannot be resumed, only run again with its seed",
        );
    }
    Ok(status_of(ended, status))
}

/// Says where the run was recorded, if it was.
pub(super) fn say_recorded(folder: &OutputFolder, kept: &Kept) {
    if *kept == Kept::Whole {
        super::output::say(&format!("periplus: recorded in {}", folder.path().display()));
    }
}

/// Hands `driver` to the operator until the console is left.
pub(super) fn on_screen(
    driver: &mut dyn Driver,
    options: Options,
) -> Result<Result<app::Ending, app::ConsoleError>, CommandError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime =
        runtime.map_err(|source| CommandError::System { what: "the event loop", source })?;
    let signals = Signals::listen()
        .map_err(|source| CommandError::System { what: "listening for signals", source })?;
    Ok(runtime.block_on(app::run(driver, options, &mut RealClock::start(signals))))
}

/// Why a run ended that had not ended by itself when the console was left.
pub(super) fn why_left(ended: &Result<app::Ending, app::ConsoleError>) -> String {
    match ended {
        Ok(app::Ending::Quit) => "left by the operator before it was finished".to_owned(),
        Ok(app::Ending::Signal(number)) => {
            let name = Signal::numbered(*number).map_or("a signal", Signal::name);
            format!("stopped by {name}")
        }
        Err(error) => format!("the console ended: {error}"),
    }
}

/// Exit status after the console was left; `status` when it was left in peace.
pub(super) fn status_of(ended: Result<app::Ending, app::ConsoleError>, status: u8) -> u8 {
    match ended {
        Ok(app::Ending::Quit) => status,
        Ok(app::Ending::Signal(number)) => 128 + number,
        Err(error) => {
            super::output::say(&format!("periplus: {error}"));
            1
        }
    }
}

/// A fresh folder under the XDG state folder.
pub(super) fn state_folder() -> Result<PathBuf, CommandError> {
    let home = std::env::var_os("XDG_STATE_HOME").map(PathBuf::from).or_else(|| {
        std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".local").join("state"))
    });
    let runs = home.unwrap_or_else(std::env::temp_dir).join("periplus").join("runs");
    (1..100_000)
        .map(|number| runs.join(format!("{number:05}")))
        .find(|dir| !dir.exists())
        .ok_or(CommandError::Input(format!("{} is full; remove old runs", runs.display())))
}

fn header_of(
    world: &World,
    common: &Common,
    until: Option<crate::mapping::map::Phase>,
) -> Result<Header, CommandError> {
    Ok(Header {
        settings: common.settings(world.start, common.body()?),
        source: world.name.clone(),
        noise: common.robot.noise.unwrap_or_default().to_string(),
        until,
        robot: None,
    })
}

/// The console over a record.
///
/// # Errors
/// As [`console`]; also when the replay went another way than the run.
pub fn replay(recording: Recording, screen: &ScreenFlags) -> Result<u8, CommandError> {
    let screen = options(screen)?;
    warn_torn(&recording);
    let mut driver = RecordedDriver::new(Replay::new(recording));
    let ended = on_screen(&mut driver, screen)?;
    match driver.replay().difference() {
        Some(difference) => {
            super::output::say(&format!("periplus: the replay differs from the run: {difference}"));
            Ok(1)
        }
        None => Ok(status_of(ended, 0)),
    }
}

pub(super) fn warn_torn(recording: &Recording) {
    if let Some(Torn { line, lines, bytes, damaged }) = recording.torn {
        super::output::say(&if damaged {
            let lines = crate::wording::count(lines, "line", "lines");
            format!(
                "periplus: the record is damaged in line {line}; it and what follows, {lines}, is left out"
            )
        } else {
            format!("periplus: the record was cut off in line {line}; {bytes} bytes are left out")
        });
    }
}

/// A frame of a record at an instant, in robot seconds since the run began.
///
/// # Errors
/// When the record does not reach that instant, or is played back another way than it was made.
pub fn snapshot_of_record(
    recording: Recording,
    at: f64,
    size: FrameSize,
    format: FrameFormat,
) -> Result<String, CommandError> {
    warn_torn(&recording);
    let mut model = Model::new(size.columns, size.rows, Keymap::default());
    if recording.header.robot.is_some() {
        // A real robot has one speed, and no factor stands in the header.
        model.speed = None;
    }
    let mut replay = Replay::new(recording);
    let end = replay.duration();
    // The end is named in hundredths.
    if at > end + 0.005 {
        let why = format!("--at {at}: the record ends at {end:.2} s; name an earlier instant");
        return Err(CommandError::Input(why));
    }
    replay.advance_to(at.min(end));
    if let Some(difference) = replay.difference() {
        let why = format!(
            "the replay differs from the run: {difference}; was it made by another version?"
        );
        return Err(CommandError::Input(why));
    }
    let snapshot = looked_back_at(replay.session().snapshot(), at.min(end), end);
    Ok(frame::render(&model, &snapshot, format_of(format)))
}

fn format_of(format: FrameFormat) -> frame::Format {
    match format {
        FrameFormat::Text => frame::Format::Text,
        FrameFormat::Ansi => frame::Format::Ansi,
        FrameFormat::Svg => frame::Format::Svg,
    }
}

/// A frame of a world after a phase.
///
/// # Errors
/// When the world is wrong.
pub fn snapshot_of_world(args: &SnapshotArgs, common: &Common) -> Result<String, CommandError> {
    let world = world_or_demo(args.world.as_deref(), common)?;
    let header = header_of(&world, common, args.until)?;
    let noise = common.robot.noise.unwrap_or_default();
    let run: SimulatedRun<std::io::Sink> = SimulatedRun::new(&world, header, noise, None);
    let mut headless = Headless::new(run);
    while headless.step() == crate::runtime::Step::Going {}
    let snapshot = headless.inner().snapshot();
    let model = Model::new(args.size.columns, args.size.rows, Keymap::default());
    Ok(frame::render(&model, &snapshot, format_of(args.format)))
}
