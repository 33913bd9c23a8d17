//! Worlds as GeoJSON in metres, as traced from real places.

use super::{World, WorldError, WorldObject, outline};
use crate::geometry::{Pose, Ring};
use serde::Deserialize;
use serde_json::Value;

#[derive(Deserialize)]
struct Collection {
    #[serde(rename = "type")]
    kind: Option<String>,
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

pub(super) fn parse(text: &str, place: &str) -> Result<World, WorldError> {
    let file: Collection = serde_json::from_str(text)
        .map_err(|why| WorldError::new(place, format!("not GeoJSON: {why}")))?;
    if file.kind.as_deref() != Some("FeatureCollection") {
        return Err(WorldError::new(place, "not a GeoJSON FeatureCollection"));
    }
    let (mut boundary, mut start, mut objects) = (None, None, Vec::new());
    for (index, feature) in file.features.iter().enumerate() {
        let role = feature.properties.get("role").and_then(Value::as_str).unwrap_or("");
        let here = format!("{place}: feature {index} ({role})");
        let Some(geometry) = &feature.geometry else {
            return Err(WorldError::new(here, "has no geometry"));
        };
        match role {
            "boundary" => {
                if boundary.is_some() {
                    return Err(WorldError::new(
                        here,
                        "is a second boundary; there can be only one",
                    ));
                }
                let mut rings = polygon(geometry, &here)?.into_iter();
                boundary = rings.next();
                objects.extend(rings.map(|ring| (format!("hole {index}"), ring)));
            }
            "object" => objects.push((name(feature, index), object(feature, geometry, &here)?)),
            "start" => {
                let [x, y] = point(geometry, &here)?;
                let heading =
                    feature.properties.get("heading").and_then(Value::as_f64).unwrap_or(0.0);
                start = Some(Pose::new(x, y, heading));
            }
            "start_alt" => {}
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
    let boundary = boundary.ok_or_else(|| missing("boundary"))?;
    let start = start.ok_or_else(|| missing("start"))?;
    let name = file.properties.get("id").and_then(Value::as_str).unwrap_or("unnamed").to_owned();
    Ok(World { name, start, boundary, objects })
}

fn name(feature: &Feature, index: usize) -> String {
    let id = feature.properties.get("id").and_then(Value::as_str);
    id.map_or_else(|| format!("object {index}"), str::to_owned)
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
