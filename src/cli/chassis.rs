//! `--chassis FILE`: the robot's body in TOML. Every key is optional; what is not said is as on
//! the default robot. Lengths in metres, angles in degrees counter-clockwise from ahead, `turn_rate` in
//! degrees a second.
//!
//! ```toml
//! radius = 0.12
//! range = 0.08
//! sensors = 4                       # evenly round the body, the first straight ahead
//! # or one by one:
//! # [[sensors]]
//! # name = "front"
//! # angle = 0
//! ```

use super::ArgumentError;
use super::settings_file::{Entry, SettingsFile, kind};
use crate::geometry::angle;
use crate::robot::bounds::{MEASURES, Measure, SWITCHES};
use crate::robot::{Chassis, SensorMount, Unfit};
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The keys that a chassis file may have.
pub fn keys() -> impl Iterator<Item = &'static str> {
    MEASURES.iter().map(|measure| measure.name).chain(["sensors"])
}

/// Whether a chassis file has such a key.
#[must_use]
pub fn has(key: &str) -> bool {
    keys().any(|known| known == key)
}

/// Reads a chassis.
///
/// # Errors
/// When the file cannot be read, a key is unknown or a value is refused.
pub fn read(path: &Path) -> Result<Chassis, ArgumentError> {
    let file = SettingsFile::open(path, "the chassis")?;
    let table = file.table()?;
    let mut chassis = Chassis::default();
    let entries = file.entries(table.get_ref());
    for entry in &entries {
        if entry.key == "sensors" {
            chassis.sensors = sensors(&file, entry)?;
            continue;
        }
        let Some(measure) = MEASURES.iter().find(|measure| measure.name == entry.key) else {
            return Err(file.unknown(entry, &keys().collect::<Vec<_>>()));
        };
        let Measure { low, high, unit, degrees, of, .. } = *measure;
        let value = entry.number().map_err(|why| file.bad(entry, &why))?;
        if !(low..=high).contains(&value) {
            let why = format!("{value} is not between {low} and {high} {unit}");
            return Err(file.bad(entry, &why));
        }
        *of(&mut chassis) = if degrees { value.to_radians() } else { value };
    }
    let Err(unfit) = chassis.check() else { return Ok(chassis) };
    let keys: &[&str] = match &unfit {
        Unfit::Measure { name, .. } => &[name],
        Unfit::Hysteresis { .. } => &["hysteresis", "range"],
        Unfit::Switches { .. } | Unfit::Switch { .. } => &["sensors"],
    };
    let blamed = keys.iter().find_map(|key| entries.iter().find(|entry| entry.key == *key));
    let why = unfit.to_string();
    Err(blamed.map_or_else(|| file.whole(&why), |entry| file.bad(entry, &why)))
}

fn sensors(file: &SettingsFile, entry: &Entry<'_>) -> Result<Vec<SensorMount>, ArgumentError> {
    let mounts = match entry.value {
        DeValue::Integer(_) => {
            let count = entry.number().map_err(|why| file.bad(entry, &why))?;
            if !SWITCHES.contains(&(count as usize)) {
                return Err(file.bad(entry, &how_many()));
            }
            return Ok(Chassis::with_switches(count as usize).sensors);
        }
        DeValue::Array(items) => items.iter().map(|item| mount(file, entry, item)).collect(),
        other => {
            let why = format!("expected a count or a list of switches, found a {}", kind(other));
            Err(file.bad(entry, &why))
        }
    };
    let mounts: Vec<SensorMount> = mounts?;
    let twice =
        mounts.iter().enumerate().find(|(k, it)| mounts[..*k].iter().any(|e| e.name == it.name));
    if let Some((_, twice)) = twice {
        // What is told of a switch names it.
        return Err(file.bad(entry, &format!("two switches are called \"{}\"", twice.name)));
    }
    if SWITCHES.contains(&mounts.len()) { Ok(mounts) } else { Err(file.bad(entry, &how_many())) }
}

fn how_many() -> String {
    format!("a robot has from {} to {} switches", SWITCHES.start(), SWITCHES.end())
}

fn mount(
    file: &SettingsFile,
    list: &Entry<'_>,
    item: &Spanned<DeValue<'_>>,
) -> Result<SensorMount, ArgumentError> {
    let DeValue::Table(table) = item.get_ref() else {
        let why =
            format!("a switch is a table with name and angle, not a {}", kind(item.get_ref()));
        return Err(file.bad(list, &why));
    };
    let (name, direction) = name_and_angle(file, table)?;
    match (name, direction) {
        (Some(name), Some(direction)) => {
            Ok(SensorMount { name, angle: angle::wrap(direction.to_radians()) })
        }
        _ => Err(file.bad(list, "each switch needs a `name` and an `angle`")),
    }
}

fn name_and_angle(
    file: &SettingsFile,
    table: &DeTable<'_>,
) -> Result<(Option<String>, Option<f64>), ArgumentError> {
    let (mut name, mut direction) = (None, None);
    for entry in file.entries(table) {
        match (entry.key.as_str(), entry.value) {
            ("name", DeValue::String(text)) => name = Some(text.to_string()),
            ("name", _) => return Err(file.bad(&entry, "a name is a string")),
            ("angle", _) => {
                direction = Some(entry.number().map_err(|why| file.bad(&entry, &why))?);
            }
            _ => return Err(file.unknown(&entry, &["name", "angle"])),
        }
    }
    Ok((name, direction))
}
