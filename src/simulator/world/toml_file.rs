//! Worlds as TOML, the format people write by hand. Strict: every unknown key is an error.

use super::{World, WorldError, WorldObject, outline};
use crate::geometry::{Pose, Ring};
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: Option<String>,
    start: Option<Start>,
    boundary: Option<Outline>,
    #[serde(default)]
    objects: Vec<Outline>,
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
    name: Option<String>,
    vertices: Option<Vec<Vec<f64>>>,
    circle: Option<Circle>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Circle {
    center: [f64; 2],
    radius: f64,
}

const KEYS: [&str; 11] = [
    "name", "start", "boundary", "objects", "x", "y", "heading", "vertices", "circle", "center",
    "radius",
];

pub(super) fn parse(text: &str, place: &str) -> Result<World, WorldError> {
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
    let start =
        file.start.ok_or_else(|| missing("start", "start = { x = 0.6, y = 0.6, heading = 90 }"))?;
    if !(start.x.is_finite() && start.y.is_finite() && start.heading.is_finite()) {
        return Err(WorldError::new(format!("{place}: start"), "is not a number"));
    }
    let boundary = file.boundary.ok_or_else(|| {
        missing("boundary", "[boundary] with vertices = [[0, 0], [5, 0], [5, 4], [0, 4]]")
    })?;
    let boundary = ring(&boundary, &format!("{place}: boundary"))?;
    let mut objects = Vec::with_capacity(file.objects.len());
    for (index, object) in file.objects.iter().enumerate() {
        let name = object.name.clone().unwrap_or_else(|| format!("object {index}"));
        let ring = ring(object, &format!("{place}: objects[{index}] \"{name}\""))?;
        objects.push(WorldObject { name, ring });
    }
    let name = file.name.unwrap_or_else(|| "unnamed".to_owned());
    let start = Pose::new(start.x, start.y, start.heading.to_radians());
    Ok(World { name, start, boundary, objects })
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
                                "vertex {k} has {} numbers; write [x, y] or [x, y, bulge]",
                                v.len()
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
    let line =
        why.span().map_or(1, |span| text[..span.start.min(text.len())].matches('\n').count() + 1);
    let mut what = why.message().trim().replace('\n', " ");
    if let Some(unknown) =
        what.strip_prefix("unknown field `").and_then(|rest| rest.split('`').next())
    {
        let nearest = KEYS.iter().min_by_key(|key| distance(key, unknown));
        if let Some(nearest) = nearest {
            what = format!("unknown key `{unknown}`; did you mean `{nearest}`?");
        }
    }
    WorldError::new(format!("{place}:{line}"), what)
}

/// Levenshtein's distance between two words.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let next = (diagonal + usize::from(x != *y)).min(row[j] + 1).min(row[j + 1] + 1);
            diagonal = row[j + 1];
            row[j + 1] = next;
        }
    }
    row[b.len()]
}
