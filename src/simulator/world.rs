//! Worlds: the room, what stands in it and where the robot starts; from TOML or GeoJSON.
//!
//! Reading is strict: an unknown key, an outline that crosses itself or a start inside a wall is
//! an error that says where.

mod geojson;
mod outline;
mod toml_file;

use crate::geometry::{Point, Pose, Ring};
use std::path::Path;

/// Something that stands in the room. Whether it touches the boundary (intrinsic) or stands free
/// (extrinsic) nobody has to say.
#[derive(Debug, Clone, PartialEq)]
pub struct WorldObject {
    /// What it is called.
    pub name: String,
    /// Its surface, counter-clockwise.
    pub ring: Ring,
}

/// A room to simulate.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    /// What it is called.
    pub name: String,
    /// Where the robot starts.
    pub start: Pose,
    /// The wall line; free floor lies inside. Counter-clockwise.
    pub boundary: Ring,
    /// What stands in it.
    pub objects: Vec<WorldObject>,
}

/// Why a world cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{place}: {what}")]
pub struct WorldError {
    /// File, and line or feature and key where there is one.
    pub place: String,
    /// What is wrong and what to try.
    pub what: String,
}

impl WorldError {
    fn new(place: impl Into<String>, what: impl Into<String>) -> Self {
        Self { place: place.into(), what: what.into() }
    }
}

/// How far a chord may stray from an arc it stands for, metres.
pub(super) const SAGITTA: f64 = 1e-4;

/// A room that extends farther is not gone round in a day, metres: nobody meant it.
const LARGEST_ROOM: f64 = 1000.0;

/// More corners than this make no sense for a room and would only stall the program.
pub const MOST_VERTICES: usize = 100_000;

impl World {
    /// Reads a world and checks it for a robot of `radius` metres.
    ///
    /// # Errors
    /// When the file cannot be read or does not describe a room in which the robot can stand.
    pub fn load(path: &Path, radius: f64) -> Result<Self, WorldError> {
        let place = path.display().to_string();
        let read = |path: &Path| {
            std::fs::read_to_string(path)
                .map_err(|why| WorldError::new(&place, format!("cannot be read: {why}")))
        };
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("toml") => Self::from_toml(&read(path)?, &place, radius),
            Some("geojson" | "json") => Self::from_geojson(&read(path)?, &place, radius),
            Some("yaml" | "yml") => Err(WorldError::new(
                &place,
                "ROS maps cannot be read by this version; trace the map to TOML or GeoJSON",
            )),
            // What is not there, or a folder, is no better for another name.
            _ => Err(match std::fs::metadata(path) {
                Err(why) => WorldError::new(&place, format!("cannot be read: {why}")),
                Ok(there) if there.is_dir() => WorldError::new(
                    &place,
                    "a folder; name a world in it, a file ending in .toml or .geojson",
                ),
                Ok(_) => WorldError::new(
                    &place,
                    "not a world: expected a name ending in .toml or .geojson",
                ),
            }),
        }
    }

    /// Reads a world from TOML text; `place` names it in errors.
    ///
    /// # Errors
    /// As [`World::load`].
    pub fn from_toml(text: &str, place: &str, radius: f64) -> Result<Self, WorldError> {
        toml_file::parse(unmarked(text), place)?.checked(radius)
    }

    /// Reads a world from GeoJSON text; `place` names it in errors.
    ///
    /// # Errors
    /// As [`World::load`].
    pub fn from_geojson(text: &str, place: &str, radius: f64) -> Result<Self, WorldError> {
        geojson::parse(unmarked(text), place)?.checked(radius)
    }

    /// The same world with the robot at another place; `place` names where that was said in errors.
    ///
    /// # Errors
    /// When it cannot stand there.
    pub fn with_start(mut self, start: Pose, place: &str, radius: f64) -> Result<Self, WorldError> {
        self.start = start;
        self.check_start(place, radius)?;
        Ok(self)
    }

    /// The objects of which no robot in the room meets anything, because they lie outside of it.
    pub fn outside(&self) -> impl Iterator<Item = &WorldObject> {
        self.objects.iter().filter(|object| !outline::comes_into(&object.ring, &self.boundary))
    }

    fn check_extent(&self, place: &str) -> Result<(), WorldError> {
        let (low, high) = self.boundary.bounds().unwrap_or_default();
        let extent = (high.x - low.x).max(high.y - low.y);
        if extent > LARGEST_ROOM {
            let what = format!(
                "is {extent:.0} m long; a room is {LARGEST_ROOM} m at most, and lengths are metres"
            );
            return Err(WorldError::new(place, what));
        }
        Ok(())
    }

    /// How far it is from `at` to the nearest wall or object, metres, on whichever side of it.
    fn distance(&self, at: Point) -> f64 {
        std::iter::once(&self.boundary)
            .chain(self.objects.iter().map(|object| &object.ring))
            .map(|ring| ring.distance(at))
            .fold(f64::INFINITY, f64::min)
    }

    /// Whether a body of this `radius` can stand at `at`.
    #[must_use]
    pub fn can_stand(&self, at: Point, radius: f64) -> bool {
        self.boundary.contains(at)
            && !self.objects.iter().any(|object| object.ring.contains(at))
            && self.distance(at) >= radius
    }

    fn check_start(&self, place: &str, radius: f64) -> Result<(), WorldError> {
        let at = self.start.position;
        let says = |what: String| Err(WorldError::new(place, what));
        if !self.boundary.contains(at) {
            return says(format!("({}, {}) lies outside the room", at.x, at.y));
        }
        if let Some(object) = self.objects.iter().find(|object| object.ring.contains(at)) {
            return says(format!("({}, {}) lies inside object \"{}\"", at.x, at.y, object.name));
        }
        let room = self.distance(at);
        if room < radius {
            return says(format!(
                "({}, {}) is {room:.3} m from a wall, but the robot needs {radius} m; move it away",
                at.x, at.y
            ));
        }
        Ok(())
    }
}

/// A world as it was read, with where its parts stand in the file, for complaints.
struct Draft {
    world: World,
    start_place: String,
    boundary_place: String,
}

impl Draft {
    fn checked(self, radius: f64) -> Result<World, WorldError> {
        let Self { world, start_place, boundary_place } = self;
        world.check_extent(&boundary_place)?;
        world.check_start(&start_place, radius)?;
        Ok(world)
    }
}

/// Some editors put a mark of the byte order before everything else.
fn unmarked(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn toml(text: &str) -> Result<World, WorldError> {
        World::from_toml(text, "room.toml", 0.1)
    }

    const START: &str = "start = { x = 1, y = 1, heading = 90 }\n";

    #[test]
    fn a_good_world_is_read() {
        let text = format!(
            "name = \"L\"\n{START}[boundary]\nvertices = [[0,0],[5,0],[5,4],[3,4,0.4142],[0,4]]\n\
             [[objects]]\nname = \"column\"\ncircle = {{ center = [2, 2], radius = 0.2 }}\n"
        );
        let world = toml(&text).expect("a good world");
        assert_eq!(world.name, "L");
        assert_eq!(world.boundary.pieces.len(), 5);
        assert!((world.start.heading - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!((world.objects[0].ring.area() - 0.04 * std::f64::consts::PI).abs() < 1e-9);
    }

    #[test]
    fn each_mistake_is_named_with_its_place() {
        let square = "[boundary]\nvertices = [[0,0],[4,0],[4,4],[0,4]]\n";
        let table = [
            (format!("{START}{square}colour = 3\n"), "colour"),
            (format!("{START}[boundary]\nvertexes = [[0,0],[4,0],[4,4]]\n"), "`vertices`"),
            (
                format!("{START}[boundary]\nvertices = [[0,0],[4,4.5],[4,0],[0,4]]\n"),
                "what leads from (0, 0) to (4, 4.5) meets what leads from (4, 0) to (0, 4)",
            ),
            (format!("{START}[boundary]\nvertices = [[0,0],[4,4],[4]]\n"), "vertex 2 (counted"),
            (format!("{START}[boundary]\nvertices = [[0,0],[4,0]]\n"), "three"),
            (format!("{START}[boundary]\nvertices = [[0,0],[4,0],[nan,4]]\n"), "not a number"),
            (format!("start = {{ x = 9, y = 1 }}\n{square}"), "outside the room"),
            (format!("start = {{ x = 0.05, y = 1 }}\n{square}"), "from a wall"),
            (
                format!(
                    "{START}{square}[[objects]]\ncircle = {{ center = [1, 1], radius = 0.5 }}\n"
                ),
                "inside object",
            ),
            (String::new(), "empty"),
            (square.to_owned(), "start"),
            (START.to_owned(), "boundary"),
            (format!("{START}[boundary]\n"), "circle"),
            (format!("{START}[boundary]\ncircle = {{ center = [0, 0], radius = 1e4 }}\n"), "long"),
            (
                format!("{START}[boundary]\ncircle = {{ center = [0, 0], radius = 1e308 }}\n"),
                "100 km",
            ),
            (format!("{START}[boundary]\nvertices = [[0,0],[4,0,1e9],[4,4],[0,4]]\n"), "100 km"),
            (
                format!("{START}[boundary]\nvertices = [[0,0],[4,0,90],[4,4],[0,4]]\n"),
                "half circle",
            ),
            (
                format!(
                    "{START}{square}[[objects]]\ncircle = {{ center = [1e308, 1], radius = 1 }}\n"
                ),
                "100 km",
            ),
            (format!("{START}[boundary]\nvertices = [[0,0],[4,0],[4,4\n"), "room.toml:3"),
            (format!("name = 3\n{START}{square}"), "1: `name` is 3, and should be text in quotes"),
            (
                format!("start = {{ x = \"0\", y = 1 }}\n{square}"),
                "1: `start.x` is \"0\", and should be a number",
            ),
            (format!("start = {{ x = 0.5 }}\n{square}"), "1: `start` has no `y`"),
            (
                format!("{START}[boundary]\nvertices = [[0,0],[\"a\",0],[4,4]]\n"),
                "3: `boundary.vertices[1][0]` is \"a\", and should be a number",
            ),
            (
                format!("{START}{square}[objects]\nname = \"box\"\n"),
                "4: `objects` is a table, and should be a list; each object begins with [[objects]]",
            ),
            (
                format!("{START}{square}[[objects]]\ncircle = {{ center = [1], radius = 1 }}\n"),
                "`objects[0].circle.center` has 1 of its 2 numbers",
            ),
            (
                format!("{START}[boundary]\ncircle = {{ center = [0, 0], radius = .2 }}\n"),
                "3: a number has digits on both sides of its point",
            ),
        ];
        for (text, word) in table {
            let error = toml(&text).expect_err(&text).to_string();
            assert!(error.contains(word), "{text}\nsaid: {error}\nwanted: {word}");
            assert!(error.contains("room.toml"), "{error}");
        }
    }

    /// What overlaps the wall, as traced things do, is met, be it by a side alone.
    #[test]
    fn an_object_lies_outside_where_none_of_it_is_in_the_room() {
        let cases = [
            ("circle = { center = [9, 2], radius = 1 }", true),
            ("vertices = [[5,-1],[6,-1],[6,5],[5,5]]", true),
            // Beside the room, along its wall.
            ("vertices = [[4,0],[5,0],[5,4],[4,4]]", true),
            ("circle = { center = [4, 2], radius = 1 }", false),
            ("circle = { center = [4.5, 2], radius = 1 }", false),
            ("vertices = [[3.5,1],[3.8,1],[3.8,3],[3.5,3]]", false),
            // A beam through the room, one across its corner, and one that ends in two walls.
            ("vertices = [[-1,3],[5,3],[5,3.2],[-1,3.2]]", false),
            ("vertices = [[2,5],[5,2],[5,5]]", false),
            ("vertices = [[0,3],[4,3],[4,3.2],[0,3.2]]", false),
        ];
        for (object, is_outside) in cases {
            let text = format!(
                "{START}[boundary]\nvertices = [[0,0],[4,0],[4,4],[0,4]]\n[[objects]]\n{object}\n"
            );
            let world = toml(&text).expect("a world");
            assert_eq!(world.outside().count() == 1, is_outside, "{object}");
        }
    }

    #[test]
    fn an_unknown_key_names_its_line_and_the_nearest_one() {
        let text = format!("{START}[boundary]\nvertexes = [[0,0],[4,0],[4,4]]\n");
        let error = toml(&text).expect_err("unknown key").to_string();
        assert!(error.starts_with("room.toml:3"), "{error}");
        assert!(error.contains("vertexes") && error.contains("vertices"), "{error}");
    }

    #[test]
    fn geojson_mistakes_name_the_feature() {
        let cases = [
            ("{}", "FeatureCollection"),
            (" []", "a list; a GeoJSON FeatureCollection begins with {"),
            (r#"{"type":"FeatureCollection","features":[]}"#, "boundary"),
            (
                r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"role":"wall"},"geometry":{"type":"Point","coordinates":[0,0]}}]}"#,
                "feature 0",
            ),
            (
                r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"role":"object"},"geometry":{"type":"Point","coordinates":[0,0]}}]}"#,
                "radius",
            ),
            (
                r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"role":"object","radius":1e308},"geometry":{"type":"Point","coordinates":[0,0]}}]}"#,
                "100 km",
            ),
            ("not json", "line 1"),
        ];
        for (text, word) in cases {
            let error = World::from_geojson(text, "a.geojson", 0.1).expect_err(text).to_string();
            assert!(error.contains(word), "{text}\nsaid: {error}");
        }
    }

    #[test]
    fn complaints_name_the_line_where_the_key_stands() {
        let square = "[boundary]\nvertices = [[0,0],[4,0],[4,4],[0,4]]\n";
        let long = "x".repeat(201);
        let cases = [
            (format!("\nstart = {{ x = 9, y = 1 }}\n{square}"), "room.toml:2: start"),
            (
                format!("start = {{ x = 1, y = 1, heading = 1e308 }}\n{square}"),
                "room.toml:1: start",
            ),
            (format!("{START}\n[boundary]\nvertices = [[0,0],[4,0]]\n"), "room.toml:3: boundary"),
            (
                format!("{START}{square}[[objects]]\nname = \"a\"\n"),
                "room.toml:4: objects[0] \"a\"",
            ),
            (
                format!("{START}{square}[[objects]]\n"),
                "room.toml:4: objects[0] (counted from 0): needs",
            ),
            (format!("{START}name = \"{long}\"\n{square}"), "room.toml:2: name: has 201 letters"),
            (
                format!("{START}{square}[[objects]]\nname = \"{long}\"\n"),
                "room.toml:5: name: has 201 letters",
            ),
        ];
        for (text, words) in cases {
            let error = toml(&text).expect_err(&text).to_string();
            assert!(error.starts_with(words), "{error}\nwanted: {words}");
        }
        let far = toml(&format!("{START}colour = 3\n{square}")).expect_err("a key").to_string();
        assert!(far.contains("unknown key `colour`; those there are: name, start"), "{far}");
        let marked = format!("\u{feff}{START}{square}");
        assert!(toml(&marked).is_ok(), "a mark of the byte order is no mistake");
    }

    #[test]
    fn a_start_in_geojson_is_one_and_faces_somewhere() {
        let world = |starts: &str, name: &str| {
            let text = format!(
                r#"{{"type":"FeatureCollection","properties":{{"id":"{name}"}},"features":[
                {{"type":"Feature","properties":{{"role":"boundary"}},"geometry":{{"type":"Polygon",
                "coordinates":[[[0,0],[4,0],[4,4],[0,4],[0,0]]]}}}}{starts}]}}"#
            );
            World::from_geojson(&format!("\u{feff}{text}"), "a.geojson", 0.1)
                .map(|world| world.start.heading)
                .map_err(|error| error.to_string())
        };
        let start = |heading: &str| {
            format!(
                r#",{{"type":"Feature","properties":{{"role":"start"{heading}}},
                "geometry":{{"type":"Point","coordinates":[1,1]}}}}"#
            )
        };
        assert_eq!(world(&start(""), "a"), Ok(0.0));
        assert_eq!(world(&start(r#","heading":1.5"#), "a"), Ok(1.5));
        // Programs that keep properties in a table write those that a feature lacks as null.
        assert_eq!(world(&start(r#","heading":null,"radius":null"#), "a"), Ok(0.0));
        for bad in [r#","heading":"x""#, r#","heading":90"#, r#","heading":1e308"#] {
            let error = world(&start(bad), "a").expect_err(bad);
            assert!(error.contains("feature 1 (start)") && error.contains("radians"), "{error}");
        }
        let error = world(&[start(""), start("")].concat(), "a").expect_err("two of them");
        assert!(error.contains("feature 2 (start)") && error.contains("second start"), "{error}");
        let error = world(&start(""), &"x".repeat(300)).expect_err("a long name");
        assert!(error.contains("a.geojson: id: has 300 letters"), "{error}");
    }

    #[test]
    fn a_million_vertices_are_refused_quickly() {
        let mut text = format!("{START}[boundary]\nvertices = [");
        for k in 0..200_000 {
            text.extend(["[", &k.to_string(), ",0],"]);
        }
        text.push_str("]\n");
        let error = toml(&text).expect_err("too many").to_string();
        assert!(error.contains("100000"), "{error}");
    }
}
