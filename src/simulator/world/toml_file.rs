//! Worlds as TOML, the format people write by hand. Strict: every unknown key is an error.

use super::{Draft, World, WorldError, WorldObject, outline};
use crate::geometry::{Pose, Ring};
use crate::spelling::unknown_key;
use crate::wording::count;
use serde::Deserialize;
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
    let file: File = toml::from_str(text).map_err(|why| syntax(&why, text, place))?;
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

fn syntax(why: &toml::de::Error, text: &str, place: &str) -> WorldError {
    let line = why.span().map_or(1, |span| line(text, span.start));
    let mut what = why.message().trim().replace('\n', " ");
    // The reader names the key, and then those that it knows at that place, each in backticks.
    if let Some(rest) = what.strip_prefix("unknown field `") {
        let unknown = rest.split('`').next().unwrap_or_default();
        let known: Vec<&str> = rest.split('`').skip(2).step_by(2).collect();
        what = unknown_key(unknown, &known);
    }
    WorldError::new(format!("{place}:{line}"), what)
}
