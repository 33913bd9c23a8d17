//! `--chassis FILE`: the robot's body in TOML. Every key is optional; what is not said is as on
//! the default robot. Lengths in metres, angles in degrees counter-clockwise from ahead.
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
use crate::robot::{Chassis, SensorMount};
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

const KEYS: [&str; 10] = [
    "radius",
    "wheel_base",
    "tick",
    "range",
    "hysteresis",
    "speed",
    "turn_rate",
    "acceleration",
    "bumper_half_angle",
    "sensors",
];

/// Reads a chassis.
///
/// # Errors
/// When the file cannot be read, a key is unknown or a value is refused.
pub fn read(path: &Path) -> Result<Chassis, ArgumentError> {
    let file = SettingsFile::open(path)?;
    let table = file.table()?;
    let mut chassis = Chassis::default();
    for entry in file.entries(table.get_ref()) {
        if entry.key == "sensors" {
            chassis.sensors = sensors(&file, &entry)?;
            continue;
        }
        let Some((slot, low, high)) = slot(&mut chassis, &entry.key) else {
            return Err(file.unknown(&entry, &KEYS));
        };
        let value = entry.number().map_err(|why| file.bad(&entry, &why))?;
        if !(low..=high).contains(&value) {
            let why = format!("{value} is not between {low} and {high}");
            return Err(file.bad(&entry, &why));
        }
        *slot = match entry.key.as_str() {
            "turn_rate" | "bumper_half_angle" => value.to_radians(),
            _ => value,
        };
    }
    Ok(chassis)
}

/// Where a number belongs and between which limits it makes sense, in the file's units.
fn slot<'c>(chassis: &'c mut Chassis, key: &str) -> Option<(&'c mut f64, f64, f64)> {
    Some(match key {
        "radius" => (&mut chassis.radius, 0.01, 1.0),
        "wheel_base" => (&mut chassis.wheel_base, 0.01, 2.0),
        "tick" => (&mut chassis.tick, 1e-6, 0.02),
        "range" => (&mut chassis.range, 0.005, 1.0),
        "hysteresis" => (&mut chassis.hysteresis, 0.0, 0.1),
        "speed" => (&mut chassis.speed, 0.01, 2.0),
        "turn_rate" => (&mut chassis.turn_rate, 1.0, 720.0),
        "acceleration" => (&mut chassis.acceleration, 0.05, 20.0),
        "bumper_half_angle" => (&mut chassis.bumper_half_angle, 0.0, 180.0),
        _ => return None,
    })
}

fn sensors(file: &SettingsFile, entry: &Entry<'_>) -> Result<Vec<SensorMount>, ArgumentError> {
    let mounts = match entry.value {
        DeValue::Integer(_) => {
            let count = entry.number().map_err(|why| file.bad(entry, &why))?;
            if !(4.0..=16.0).contains(&count) {
                return Err(file.bad(entry, "a robot has from 4 to 16 switches"));
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
    if (4..=16).contains(&mounts.len()) {
        Ok(mounts)
    } else {
        Err(file.bad(entry, "a robot has from 4 to 16 switches"))
    }
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
