//! The worlds that come with the program: each loads, says what it shows, and leaves no doubt about
//! which of its gaps a robot fits through.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

use periplus::geometry::Point;
use periplus::robot::Chassis;
use periplus::simulator::World;
use std::collections::VecDeque;
use std::fs;
use std::path::{Path, PathBuf};

/// Gaps of drawn worlds are narrower than this, metres, or ...
const SHUT: f64 = 0.18;
/// ... wider than this, so that no threshold in between decides what the map is.
const OPEN: f64 = 0.45;

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("sims");
    let mut files: Vec<PathBuf> = fs::read_dir(folder)
        .expect("the folder sims/")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| ["toml", "geojson"].contains(&ending(path)))
        .collect();
    files.sort();
    files
}

fn ending(path: &Path) -> &str {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default()
}

fn load(path: &Path) -> World {
    World::load(path, Chassis::default().radius).expect("a world that comes with the program")
}

fn drawn() -> Vec<(String, World)> {
    let files = files().into_iter().filter(|path| ending(path) == "toml");
    files.map(|path| (path.display().to_string(), load(&path))).collect()
}

/// Metres to the nearest wall or object.
fn clearance(world: &World, at: Point) -> f64 {
    let rings = std::iter::once(&world.boundary).chain(world.objects.iter().map(|o| &o.ring));
    rings.map(|ring| ring.distance(at)).fold(f64::INFINITY, f64::min)
}

fn free(world: &World, at: Point) -> bool {
    world.boundary.contains(at) && !world.objects.iter().any(|o| o.ring.contains(at))
}

#[test]
fn there_are_at_least_sixteen_and_each_loads() {
    let files = files();
    assert!(files.len() >= 16, "only {} worlds in sims/", files.len());
    for path in files {
        let world = load(&path);
        assert!(
            world.boundary.area() > 4.0,
            "{}: {} m² is no room",
            path.display(),
            world.boundary.area()
        );
    }
}

#[test]
fn each_drawn_world_says_what_it_shows() {
    for path in files().into_iter().filter(|path| ending(path) == "toml") {
        let text = fs::read_to_string(&path).expect("a world");
        let first = text.lines().next().unwrap_or_default();
        let said = first.strip_prefix("# ").is_some_and(|words| words.ends_with('.'));
        assert!(said, "{}: begins with \"{first}\", not with a sentence", path.display());
        assert!(load(&path).name != "unnamed", "{}: has no name", path.display());
    }
}

#[test]
fn traced_worlds_name_their_source() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("sims");
    let notice = fs::read_to_string(folder.join("NOTICE.md")).expect("sims/NOTICE.md");
    let mut traced = 0;
    for path in files().into_iter().filter(|path| ending(path) == "geojson") {
        let name = path.file_name().expect("a name").to_string_lossy();
        assert!(notice.contains(name.as_ref()), "{name} is not in sims/NOTICE.md");
        traced += 1;
    }
    assert!(traced >= 2, "only {traced} worlds traced from real places");
}

#[test]
fn objects_touch_walls_or_stand_well_clear() {
    let mut objects = 0;
    for (path, world) in drawn() {
        for (k, object) in world.objects.iter().enumerate() {
            let others = world.objects.iter().enumerate().filter(|(j, _)| *j != k);
            let rings = others.map(|(_, o)| &o.ring).chain([&world.boundary]);
            let gap = object.ring.to_points(0.001).into_iter();
            let gap = gap.fold(f64::INFINITY, |least, point| {
                rings.clone().map(|r| r.distance(point)).fold(least, f64::min)
            });
            objects += 1;
            assert!(
                !(SHUT..=OPEN).contains(&gap),
                "{path}: \"{}\" leaves a gap of {gap:.3} m",
                object.name
            );
        }
    }
    assert!(objects >= 6, "only {objects} objects in all worlds");
}

/// Whatever a body of diameter [`SHUT`] reaches is one piece of floor for a body of diameter
/// [`OPEN`] as well.
#[test]
fn no_passage_is_in_doubt() {
    const PITCH: f64 = 0.025;
    for (path, world) in drawn() {
        let (low, high) = world.boundary.bounds().expect("an outline");
        let columns = ((high.x - low.x) / PITCH) as usize + 1;
        let rows = ((high.y - low.y) / PITCH) as usize + 1;
        let place = |k: usize| {
            let (row, column) = (k / columns, k % columns);
            Point::new(low.x + column as f64 * PITCH, low.y + row as f64 * PITCH)
        };
        let room: Vec<f64> = (0..columns * rows)
            .map(|k| {
                let at = place(k);
                if free(&world, at) { clearance(&world, at) } else { 0.0 }
            })
            .collect();
        let flood = |from: usize, radius: f64| {
            let mut seen = vec![false; room.len()];
            let mut waiting = VecDeque::from([from]);
            seen[from] = true;
            while let Some(k) = waiting.pop_front() {
                for next in [k - 1, k + 1, k - columns, k + columns] {
                    if !seen[next] && room[next] >= radius {
                        seen[next] = true;
                        waiting.push_back(next);
                    }
                }
            }
            seen
        };
        let start = world.start.position - low;
        let start =
            (start.y / PITCH).round() as usize * columns + (start.x / PITCH).round() as usize;
        let slim = flood(start, SHUT / 2.0);
        let wide = flood(start, OPEN / 2.0);
        let roomy = (0..room.len()).filter(|&k| slim[k] && room[k] >= OPEN / 2.0);
        let mut count = 0;
        for k in roomy {
            count += 1;
            let at = place(k);
            assert!(
                wide[k],
                "{path}: ({:.2}, {:.2}) lies behind a gap between {SHUT} and {OPEN} m",
                at.x, at.y
            );
        }
        assert!(count > 1000, "{path}: only {count} places seen");
    }
}

#[test]
fn extrinsic_first_meets_an_object_before_any_wall() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("sims/extrinsic_first.toml");
    let world = load(&path);
    let reach = Chassis::default().reach();
    let mut pose = world.start;
    while clearance(&world, pose.position) > reach {
        pose = pose.advanced(0.01);
    }
    assert!(
        world.boundary.distance(pose.position) > 1.0,
        "the start heading leads to a wall at {}",
        pose.position
    );
}
