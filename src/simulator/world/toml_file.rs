//! Worlds as TOML, the format people write by hand. Strict: every unknown key is an error.

use super::{Draft, World, WorldError, WorldObject, outline};
use crate::geometry::{Pose, Ring};
use crate::spelling::{plainly, unknown_key};
use crate::wording::count;
use serde::Deserialize;
use serde_path_to_error::Segment;
use std::fmt::Write;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: Option<Spanned<String>>,
    start: Option<Spanned<Start>>,
    boundary: Option<Spanned<Outline>>,
    #[serde(default)]
    objects: Vec<Spanned<Outline>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Start {
    x: f64,
    y: f64,
    #[serde(default)]
    heading: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Outline {
    name: Option<Spanned<String>>,
    vertices: Option<Vec<Vec<f64>>>,
    circle: Option<Circle>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Circle {
    center: [f64; 2],
    radius: f64,
}

pub(super) fn parse(text: &str, place: &str) -> Result<Draft, WorldError> {
    if text.trim().is_empty() {
        return Err(WorldError::new(
            place,
            "the file is empty; a world needs start and [boundary]",
        ));
    }
    let read = toml::Deserializer::parse(text).map_err(|why| syntax(&why, "", text, place))?;
    let file: File = serde_path_to_error::deserialize(read).map_err(|why| {
        let key = key(why.path());
        syntax(why.inner(), &key, text, place)
    })?;
    let missing = |key: &str, example: &str| {
        WorldError::new(place, format!("`{key}` is missing; write for example {example}"))
    };
    let at = |start: usize, what: &str| format!("{place}:{}: {what}", line(text, start));
    let named = |name: &Spanned<String>| {
        let here = at(name.span().start, "name");
        outline::name(name.get_ref(), &here)
    };
    let start =
        file.start.ok_or_else(|| missing("start", "start = { x = 0.6, y = 0.6, heading = 90 }"))?;
    let start_place = at(start.span().start, "start");
    let Start { x, y, heading } = *start.get_ref();
    if !(x.is_finite() && y.is_finite() && heading.is_finite()) {
        return Err(WorldError::new(start_place, "one of x, y and heading is not a number"));
    }
    if heading.abs() > 360.0 {
        let what = format!("a heading of {heading} is more than a turn; it counts in degrees");
        return Err(WorldError::new(start_place, what));
    }
    let boundary = file.boundary.ok_or_else(|| {
        missing("boundary", "[boundary] with vertices = [[0, 0], [5, 0], [5, 4], [0, 4]]")
    })?;
    let boundary_place = at(boundary.span().start, "boundary");
    let boundary = ring(boundary.get_ref(), &boundary_place)?;
    let mut objects = Vec::with_capacity(file.objects.len());
    for (index, object) in file.objects.iter().enumerate() {
        let given = object.get_ref().name.as_ref().map(named).transpose()?.flatten();
        let listed = format!("objects[{index}]");
        let told = match &given {
            Some(name) => format!("{listed} \"{name}\""),
            None => format!("{listed} (counted from 0)"),
        };
        let here = at(object.span().start, &told);
        let name = given.unwrap_or(listed);
        let ring = ring(object.get_ref(), &here)?;
        objects.push(WorldObject { name, ring });
    }
    let name = file.name.as_ref().map(named).transpose()?.flatten();
    let name = name.unwrap_or_else(|| "unnamed".to_owned());
    let start = Pose::new(x, y, heading.to_radians());
    Ok(Draft { world: World { name, start, boundary, objects }, start_place, boundary_place })
}

/// An arc that turns by 350 degrees has this bulge: nobody draws one that turns farther, and who writes more, up to a
/// whole turn, means degrees.
const MOST_BULGE: f64 = 23.0;

/// The line of byte `at`, from 1.
fn line(text: &str, at: usize) -> usize {
    text.bytes().take(at).filter(|&byte| byte == b'\n').count() + 1
}

fn ring(outline: &Outline, place: &str) -> Result<Ring, WorldError> {
    match (&outline.vertices, &outline.circle) {
        (Some(vertices), None) => {
            let mut corners = Vec::with_capacity(vertices.len());
            for (k, v) in vertices.iter().enumerate() {
                match v.as_slice() {
                    [x, y] => corners.push((*x, *y, 0.0)),
                    [_, _, bulge] if (MOST_BULGE..=360.0).contains(&bulge.abs()) => {
                        let why = format!(
                            "{} has a bulge of {bulge}: that is the tangent of a quarter of the arc's turn, 1 for a \
                             half circle, and no angle in degrees",
                            outline::vertex(k)
                        );
                        return Err(WorldError::new(place, why));
                    }
                    [x, y, bulge] => corners.push((*x, *y, *bulge)),
                    _ => {
                        return Err(WorldError::new(
                            place,
                            format!(
                                "{} has {}; write [x, y] or [x, y, bulge]",
                                outline::vertex(k),
                                count(v.len(), "number", "numbers")
                            ),
                        ));
                    }
                }
            }
            outline::ring(&corners, place)
        }
        (None, Some(circle)) => outline::circle(circle.center, circle.radius, place),
        (Some(_), Some(_)) => {
            Err(WorldError::new(place, "has both `vertices` and `circle`; keep one of them"))
        }
        (None, None) => Err(WorldError::new(place, "needs `vertices` or `circle`")),
    }
}

/// The key at `path` as people write it.
fn key(path: &serde_path_to_error::Path) -> String {
    let mut key = String::new();
    for segment in path {
        let _ = match segment {
            // How the reader keeps places of the text is its own affair.
            Segment::Map { key: name } if name.starts_with('$') => Ok(()),
            Segment::Map { key: name } if key.is_empty() => write!(key, "{name}"),
            Segment::Map { key: name } => write!(key, ".{name}"),
            Segment::Seq { index } => write!(key, "[{index}]"),
            Segment::Enum { .. } | Segment::Unknown => Ok(()),
        };
    }
    key
}

/// What the reader `said` of the value at `key`, in the words of those who write worlds; none where its own will do.
fn mistake(said: &str, key: &str) -> Option<String> {
    if let Some(missing) = said.strip_prefix("missing field ") {
        return Some(format!("`{key}` has no {missing}"));
    }
    if let Some((length, wanted)) = said
        .strip_prefix("invalid length ")
        .and_then(|rest| rest.split_once(", expected an array of length "))
    {
        return Some(format!("`{key}` has {length} of its {wanted} numbers"));
    }
    let (found, wanted) = said.strip_prefix("invalid type: ")?.split_once(", expected ")?;
    let value = found.split('`').nth(1);
    let found = match (found, value) {
        ("map", _) => "a table",
        ("sequence", _) => "a list",
        (_, Some(value)) => value,
        (text, None) => text.strip_prefix("string ").unwrap_or(text),
    };
    let wanted = match wanted {
        "a sequence" if key == "objects" => "a list; each object begins with [[objects]]",
        "a sequence" => "a list in [ ]",
        "a string" => "text in quotes",
        "f64" => "a number",
        table if table.starts_with("struct ") => "a table of keys",
        other => other,
    };
    Some(format!("`{key}` is {found}, and should be {wanted}"))
}

fn syntax(why: &toml::de::Error, key: &str, text: &str, place: &str) -> WorldError {
    let line = why.span().map_or(1, |span| line(text, span.start));
    let mut what = why.message().trim().replace('\n', " ");
    // The reader names the key, and then those that it knows at that place, each in backticks.
    if let Some(rest) = what.strip_prefix("unknown field `") {
        let unknown = rest.split('`').next().unwrap_or_default();
        let known: Vec<&str> = rest.split('`').skip(2).step_by(2).collect();
        what = unknown_key(unknown, &known);
    }
    what = mistake(&what, key).unwrap_or_else(|| plainly(&what).to_owned());
    WorldError::new(format!("{place}:{line}"), what)
}
