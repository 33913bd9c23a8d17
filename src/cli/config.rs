//! `--config FILE`: the flags as a TOML table, with the same keys and the same words. Flags given
//! on the command line win. Files that it names are relative to its own folder.

use super::settings_file::{Entry, SettingsFile};
use super::values::{self, Common};
use super::{ArgumentError, ThemeName};
use crate::mapping::map::Phase;
use std::path::{Path, PathBuf};

/// What a config file may say besides the flags common to all commands.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Places {
    /// World file.
    pub world: Option<PathBuf>,
    /// Key bindings.
    pub keymap: Option<PathBuf>,
    /// Colours.
    pub theme: Option<ThemeName>,
    /// Phase whose end completes the run.
    pub until: Option<Phase>,
    /// Serial port or address of a real robot, and file, line and key that it came from.
    pub port: Option<(String, String)>,
}

const KEYS: [&str; 18] = [
    "alpha", "plan", "contour", "noise", "seed", "start", "laps", "square", "tape", "chassis",
    "name", "out", "resume", "world", "keymap", "theme", "until", "port",
];

/// What belongs to one start of the program, and to no file that is used again.
const FLAGS_ONLY: [&str; 3] = ["placed", "baud", "config"];

/// The keys that a config file may have.
pub fn keys() -> impl Iterator<Item = &'static str> {
    KEYS.into_iter()
}

/// Whether a config file has such a key.
#[must_use]
pub fn has(key: &str) -> bool {
    KEYS.contains(&key) || FLAGS_ONLY.contains(&key)
}

/// Reads the file and fills in what `flags` leaves open.
///
/// # Errors
/// When the file cannot be read, a key is unknown or a value is refused.
pub fn read(path: &Path, flags: &mut Common) -> Result<Places, ArgumentError> {
    let file = SettingsFile::open(path, "the config")?;
    let table = file.table()?;
    let mut places = Places::default();
    let entries = file.entries(table.get_ref());
    let both = ["out", "resume"].iter().all(|key| entries.iter().any(|entry| entry.key == *key));
    if both && let Some(entry) = entries.iter().find(|entry| entry.key == "resume") {
        let why = "a run that goes on stays in its folder; leave out `out` or `resume`";
        return Err(file.bad(entry, why));
    }
    let both = ["world", "port"].iter().all(|key| entries.iter().any(|entry| entry.key == *key));
    if both && let Some(entry) = entries.iter().find(|entry| entry.key == "port") {
        let why = "a run is of the simulator or of a real robot; leave out `world` or `port`";
        return Err(file.bad(entry, why));
    }
    for entry in entries {
        if FLAGS_ONLY.contains(&entry.key.as_str()) {
            return Err(file.bad(&entry, &format!("this is only a flag: --{}", entry.key)));
        }
        if !KEYS.contains(&entry.key.as_str()) {
            return Err(file.unknown(&entry, &KEYS));
        }
        set(&file, &entry, flags, &mut places).map_err(|why| file.bad(&entry, &why))?;
    }
    Ok(places)
}

fn set(
    file: &SettingsFile,
    entry: &Entry<'_>,
    flags: &mut Common,
    places: &mut Places,
) -> Result<(), String> {
    let words = entry.words()?;
    let text = words.as_str();
    let path = || file.beside(text);
    match entry.key.as_str() {
        "alpha" => fill(&mut flags.mapping.alpha, values::alpha(text)?),
        "plan" => fill(&mut flags.mapping.plan, values::named_strategy(text)?),
        "contour" => fill(&mut flags.mapping.contour, values::named_contour(text)?),
        "noise" => fill(&mut flags.robot.noise, values::named_noise(text)?),
        "seed" => fill(&mut flags.robot.seed, values::seed(text)?),
        "start" => {
            if flags.robot.start.is_none() {
                flags.robot.start_place = Some(file.place(entry));
            }
            fill(&mut flags.robot.start, values::start(text)?);
        }
        "laps" => fill(&mut flags.mapping.laps, values::laps(text)?),
        "square" => flags.mapping.square |= values::yes(text)?,
        "tape" => fill(&mut flags.mapping.tape, values::tape(text)?),
        "chassis" => fill(&mut flags.robot.chassis, path()),
        "name" => fill(&mut flags.keeping.name, values::title(text)?),
        "out" => fill(&mut flags.keeping.out, path()),
        "resume" => fill(&mut flags.keeping.resume, path()),
        "world" => fill(&mut places.world, path()),
        "keymap" => fill(&mut places.keymap, path()),
        "theme" => fill(&mut places.theme, values::named_theme(text)?),
        "until" => fill(&mut places.until, values::named_phase(text)?),
        _ => fill(&mut places.port, (words, file.place(entry))),
    }
    Ok(())
}

fn fill<T>(slot: &mut Option<T>, value: T) {
    slot.get_or_insert(value);
}
