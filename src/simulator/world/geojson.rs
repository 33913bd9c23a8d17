//! Worlds as GeoJSON in metres: as traced from real places, or as a robot has mapped them.

use super::{Draft, World, WorldError, WorldObject, outline};
use crate::geometry::{Pose, Ring, angle};
use serde::Deserialize;
use serde_json::Value;

#[derive(Deserialize)]
struct Collection {
    #[serde(rename = "type")]
    kind: Option<String>,
    /// What a map is called.
    #[serde(default)]
    name: Value,
    #[serde(default)]
    properties: Value,
    #[serde(default)]
    features: Vec<Feature>,
}

#[derive(Deserialize)]
struct Feature {
    #[serde(default)]
    properties: Value,
    geometry: Option<Geometry>,
}

#[derive(Deserialize)]
struct Geometry {
    #[serde(rename = "type")]
    kind: String,
    coordinates: Value,
}

/// What a map tells besides of how it came about, and of what it could not reach: nothing to run into.
const TOLD_BY_A_MAP: [&str; 8] = [
    "path",
    "true_path",
    "plan",
    "gap",
    "beyond",
    "object_surface",
    "boundary_fitted",
    "boundary_mapped",
];

pub(super) fn parse(text: &str, place: &str) -> Result<Draft, WorldError> {
    // The reader would take a list for the fields of a collection, in their order.
    if text.trim_start().starts_with('[') {
        return Err(WorldError::new(place, "a list; a GeoJSON FeatureCollection begins with {"));
    }
    let file: Collection = serde_json::from_str(text)
        .map_err(|why| WorldError::new(place, format!("not GeoJSON: {why}")))?;
    if file.kind.as_deref() != Some("FeatureCollection") {
        return Err(WorldError::new(place, "not a GeoJSON FeatureCollection"));
    }
    let (mut boundary, mut start, mut objects) = (None, None, Vec::new());
    let second = |here: &str, what: &str| {
        Err(WorldError::new(here, format!("is a second {what}; there can be only one")))
    };
    for (index, feature) in file.features.iter().enumerate() {
        let role = feature.properties.get("role").and_then(Value::as_str).unwrap_or("");
        let here = format!("{place}: feature {index} ({role})");
        let Some(geometry) = &feature.geometry else {
            return Err(WorldError::new(here, "has no geometry"));
        };
        match role {
            "boundary" => {
                if boundary.is_some() {
                    return second(&here, "boundary");
                }
                let mut rings = polygon(geometry, &here)?.into_iter();
                boundary = rings.next().map(|ring| (ring, here));
                objects.extend(rings.map(|ring| (format!("hole in feature {index}"), ring)));
            }
            "object" => {
                let ring = object(feature, geometry, &here)?;
                objects.push((name(feature, index, &here)?, ring));
            }
            "start" => {
                if start.is_some() {
                    return second(&here, "start; use start_alt for others");
                }
                let [x, y] = point(geometry, &here)?;
                start = Some((Pose::new(x, y, heading(feature, &here)?), here));
            }
            "start_alt" => {}
            told if TOLD_BY_A_MAP.contains(&told) => {}
            "boundary_open" => {
                let why = "the lap of this map did not close, so nobody knows the room; \
                           let the robot go on first";
                return Err(WorldError::new(here, why));
            }
            "object_open" => {
                let why = "the robot did not get round this object, so nobody knows how far it goes; \
                           take it out, or give it an outline and the role object";
                return Err(WorldError::new(here, why));
            }
            other => {
                return Err(WorldError::new(
                    here,
                    format!(
                        "role \"{other}\" is unknown; use boundary, object, start or start_alt"
                    ),
                ));
            }
        }
    }
    let missing = |role: &str| {
        WorldError::new(place, format!("no feature with role `{role}`; a world needs one"))
    };
    let objects = objects.into_iter().map(|(name, ring)| WorldObject { name, ring }).collect();
    let (boundary, boundary_place) = boundary.ok_or_else(|| missing("boundary"))?;
    let (start, start_place) = start.ok_or_else(|| missing("start"))?;
    let name = match named(&file.properties, place)? {
        Some(name) => Some(name),
        None => match file.name.as_str() {
            Some(name) => outline::name(name, &format!("{place}: name"))?,
            None => None,
        },
    };
    let name = name.unwrap_or_else(|| "unnamed".to_owned());
    Ok(Draft { world: World { name, start, boundary, objects }, start_place, boundary_place })
}

fn name(feature: &Feature, index: usize, place: &str) -> Result<String, WorldError> {
    let name = named(&feature.properties, place)?;
    Ok(name.unwrap_or_else(|| format!("feature {index}")))
}

fn named(properties: &Value, place: &str) -> Result<Option<String>, WorldError> {
    let id = properties.get("id").and_then(Value::as_str);
    Ok(id.map(|id| outline::name(id, &format!("{place}: id"))).transpose()?.flatten())
}

/// Where the robot faces: radians counter-clockwise from +x.
fn heading(feature: &Feature, place: &str) -> Result<f64, WorldError> {
    // Null is how a table writes that there is none.
    let heading = feature.properties.get("heading").filter(|value| !value.is_null());
    let Some(value) = heading else { return Ok(0.0) };
    let within = |heading: &f64| heading.abs() <= angle::TAU;
    value.as_f64().filter(within).ok_or_else(|| {
        let what = format!("heading {value} is none; it counts in radians, from -6.28 to 6.28");
        WorldError::new(place, what)
    })
}

fn object(feature: &Feature, geometry: &Geometry, place: &str) -> Result<Ring, WorldError> {
    if geometry.kind == "Point" {
        let radius = feature.properties.get("radius").and_then(Value::as_f64);
        let radius = radius.ok_or_else(|| WorldError::new(place, "a Point needs a `radius`"))?;
        return outline::circle(point(geometry, place)?, radius, place);
    }
    let mut rings = polygon(geometry, place)?;
    if rings.is_empty() {
        return Err(WorldError::new(place, "has no ring"));
    }
    Ok(rings.swap_remove(0))
}

fn pair(value: &Value, place: &str) -> Result<[f64; 2], WorldError> {
    let number = |k: usize| value.get(k).and_then(Value::as_f64);
    match (number(0), number(1)) {
        (Some(x), Some(y)) => Ok([x, y]),
        _ => Err(WorldError::new(place, format!("{value} is not a position [x, y]"))),
    }
}

fn point(geometry: &Geometry, place: &str) -> Result<[f64; 2], WorldError> {
    if geometry.kind != "Point" {
        return Err(WorldError::new(place, format!("is a {}; expected a Point", geometry.kind)));
    }
    pair(&geometry.coordinates, place)
}

fn polygon(geometry: &Geometry, place: &str) -> Result<Vec<Ring>, WorldError> {
    if geometry.kind != "Polygon" {
        return Err(WorldError::new(place, format!("is a {}; expected a Polygon", geometry.kind)));
    }
    let rings = geometry.coordinates.as_array().filter(|rings| !rings.is_empty());
    let rings = rings.ok_or_else(|| WorldError::new(place, "the Polygon has no ring"))?;
    rings
        .iter()
        .map(|ring| {
            let positions = ring.as_array().map_or(&[][..], Vec::as_slice);
            let corners = positions
                .iter()
                .map(|position| pair(position, place).map(|[x, y]| (x, y, 0.0)))
                .collect::<Result<Vec<_>, _>>()?;
            if corners.len() > 1 && corners.first() != corners.last() {
                return Err(WorldError::new(
                    place,
                    "the ring is open: its last position must repeat its first",
                ));
            }
            outline::ring(&corners, place)
        })
        .collect()
}
