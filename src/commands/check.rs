//! `periplus check`: one line for each file, `ok` or what is wrong and where.

use super::{CommandError, glue, output};
use crate::cli::CheckArgs;
use crate::cli::settings_file::SettingsFile;
use crate::robot::Chassis;
use crate::simulator::World;
use std::path::Path;

/// Checks all files.
///
/// # Errors
/// When standard output cannot be written.
pub fn check(args: &CheckArgs) -> Result<u8, CommandError> {
    let mut bad = false;
    for path in &args.files {
        let line = match verdict(path) {
            Ok(kind) => format!("{}: ok, {kind}\n", path.display()),
            Err(error) => {
                bad = true;
                format!("{}\n", output::harmless(&error))
            }
        };
        output::print(&line)?;
    }
    Ok(if bad { 2 } else { 0 })
}

/// What the file is, when nothing is wrong with it.
fn verdict(path: &Path) -> Result<String, String> {
    let there = std::fs::metadata(path).map_err(|why| format!("{}: {why}", path.display()))?;
    if there.is_dir() {
        let why = "a folder; name the files in it, such as DIR/*.toml";
        return Err(format!("{}: {why}", path.display()));
    }
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    match extension {
        // The reader of worlds says best why it reads no ROS maps.
        "geojson" | "json" | "yaml" | "yml" => world(path),
        "toml" => toml(path),
        _ => Err(format!(
            "{}: expected a world (.toml, .geojson) or a keymap (.toml)",
            path.display()
        )),
    }
}

fn toml(path: &Path) -> Result<String, String> {
    let file = SettingsFile::open(path).map_err(|error| error.to_string())?;
    let table = file.table().map_err(|error| error.to_string())?;
    let keys = file.entries(table.get_ref());
    let has = |key: &str| keys.iter().any(|entry| entry.key == key);
    if has("boundary") {
        return world(path);
    }
    if has("keys") {
        return glue::check_keymap(path);
    }
    Err(format!(
        "{}: neither a world, which has [boundary], nor a keymap, which has [keys]",
        path.display()
    ))
}

fn world(path: &Path) -> Result<String, String> {
    let radius = Chassis::default().radius;
    World::load(path, radius).map(|_| "world".to_owned()).map_err(|error| error.to_string())
}
