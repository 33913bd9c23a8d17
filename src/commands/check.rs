//! `periplus check`: one line for each file, `ok` or what is wrong and where.

use super::{CommandError, glue, output};
use crate::cli::CheckArgs;
use crate::cli::settings_file::SettingsFile;
use crate::robot::Chassis;
use crate::simulator::World;
use std::fmt::Write;
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
    let file = SettingsFile::open(path, "the file").map_err(|error| error.to_string())?;
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
    World::load(path, radius).map(|world| describe(&world)).map_err(|error| error.to_string())
}

/// How large a world is, what stands in it, and what nobody will ever meet there.
fn describe(world: &World) -> String {
    let (low, high) = world.boundary.bounds().unwrap_or_default();
    let objects = crate::wording::count(world.objects.len(), "object", "objects");
    let mut text = format!("world of {:.2} × {:.2} m, {objects}", high.x - low.x, high.y - low.y);
    for object in &world.objects {
        if !object.ring.to_points(0.01).iter().any(|point| world.boundary.contains(*point)) {
            let _ =
                write!(text, "; object \"{}\" lies outside the room: nobody meets it", object.name);
        }
    }
    output::harmless(&text)
}
