//! `periplus check`: one line for each file, `ok` or what is wrong and where.

use super::{CommandError, glue, output};
use crate::cli::settings_file::{Entry, SettingsFile, kind};
use crate::cli::{ArgumentError, CheckArgs, Common, chassis, config};
use crate::geometry::Vector;
use crate::mapping::event::EventKind;
use crate::robot::Chassis;
use crate::simulator::World;
use crate::spelling::nearest;
use std::collections::{HashSet, VecDeque};
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
        output::tell(&line)?;
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
            "{}: expected a world (.toml, .geojson), or a keymap, chassis or config (.toml)",
            path.display()
        )),
    }
}

fn toml(path: &Path) -> Result<String, String> {
    let file = SettingsFile::open(path, "the file").map_err(|error| match error {
        // Every line begins with the name of its file.
        ArgumentError::Unreadable { path, reason, .. } => {
            format!("{}: cannot be read: {reason}", path.display())
        }
        other => other.to_string(),
    })?;
    let table = file.table().map_err(|error| error.to_string())?;
    let keys = file.entries(table.get_ref());
    let has = |key: &str| keys.iter().any(|entry| entry.key == key);
    // A config file has a start as well, as a list.
    let starts = |entry: &Entry<'_>| entry.key == "start" && kind(entry.value) == "table";
    if has("boundary") || has("objects") || keys.iter().any(starts) {
        return world(path);
    }
    if has("keys") {
        return glue::check_keymap(path);
    }
    // What may be set in a config as well is one.
    let is_binding = |entry: &Entry<'_>| glue::is_action(&entry.key);
    let is_bindings =
        keys.iter().all(is_binding) && keys.iter().any(|entry| !config::has(&entry.key));
    if let (true, Some(first)) = (is_bindings, keys.first()) {
        let why = "a keymap begins with a line [keys]: put it above this one";
        return Err(file.bad(first, why).to_string());
    }
    if keys.iter().any(|entry| chassis::has(&entry.key)) {
        let body = chassis::read(path).map_err(|error| error.to_string())?;
        let switches = crate::wording::count(body.sensors.len(), "switch", "switches");
        let slower = EventKind::slower(&body).map_or_else(String::new, |told| format!("; {told}"));
        return Ok(format!("chassis of {:.2} m radius, {switches}{slower}", body.radius));
    }
    // Half of all files have a name.
    if keys.iter().any(|entry| entry.key != "name" && config::has(&entry.key)) {
        let read = config::read(path, &mut Common::default());
        let settings = crate::wording::count(keys.len(), "setting", "settings");
        return read.map(|_| format!("config, {settings}")).map_err(|error| error.to_string());
    }
    let Some(first) = keys.first() else {
        let why = if file.is_blank() { "the file is empty" } else { "nothing is set in the file" };
        return Err(format!("{}: {why}", path.display()));
    };
    // One letter in its only key hides what a file is to be.
    let worlds = ["boundary", "objects", "keys"].into_iter();
    let known: Vec<&str> = worlds.chain(chassis::keys()).chain(config::keys()).collect();
    let near = |entry: &Entry<'_>| nearest(&entry.key, known.iter().copied());
    let meant = keys.iter().find_map(|entry| near(entry).map(|name| (entry, name)));
    let (entry, hint) = match meant {
        Some((entry, name)) => (entry, format!(" Did you mean `{name}`?")),
        None => (first, String::new()),
    };
    let why = format!(
        "no kind of file has such a key: neither a world, which has [boundary], nor a keymap, which has [keys], \
         nor a chassis (radius, range, sensors ...), nor a config (alpha, seed, world ...).{hint}"
    );
    Err(file.bad(entry, &why).to_string())
}

fn world(path: &Path) -> Result<String, String> {
    let radius = Chassis::default().radius;
    World::load(path, radius)
        .map(|world| describe(&world, radius))
        .map_err(|error| error.to_string())
}

/// How large a world is, what stands in it, and what nobody will ever meet there.
fn describe(world: &World, radius: f64) -> String {
    let (low, high) = world.boundary.bounds().unwrap_or_default();
    let objects = crate::wording::count(world.objects.len(), "object", "objects");
    let mut text = format!("world of {:.2} × {:.2} m, {objects}", high.x - low.x, high.y - low.y);
    if !has_room(world, radius) {
        let _ = write!(text, "; at its start a robot of {radius} m radius has hardly room to move");
    }
    for object in world.outside() {
        let _ = write!(text, "; object \"{}\" lies outside the room: nobody meets it", object.name);
    }
    output::harmless(&text)
}

/// A robot that gets no farther than this from where it starts does not move, metres.
const NEAR: f64 = 0.05;
/// Steps of the search for floor, in each radius of the body.
const STEPS: f64 = 10.0;

/// Whether the body's centre gets anywhere from the start, and to no less floor than the body covers. Floor is
/// looked for step by step, and no farther than that, however large the world.
fn has_room(world: &World, radius: f64) -> bool {
    let step = radius / STEPS;
    let enough = std::f64::consts::PI * STEPS * STEPS;
    let start = world.start.position;
    let at = |(x, y): (i32, i32)| start + Vector::new(f64::from(x), f64::from(y)) * step;
    let mut seen = HashSet::from([(0, 0)]);
    let mut todo = VecDeque::from([(0, 0)]);
    let mut farthest: f64 = 0.0;
    while let Some((x, y)) = todo.pop_front() {
        farthest = farthest.max((at((x, y)) - start).norm());
        if seen.len() as f64 >= enough && farthest >= NEAR {
            return true;
        }
        for next in [(x + 1, y), (x, y + 1), (x - 1, y), (x, y - 1)] {
            if !seen.contains(&next) && world.can_stand(at(next), radius) {
                seen.insert(next);
                todo.push_back(next);
            }
        }
    }
    false
}
