//! `map.geojson`: one feature collection in metres, in the map frame, that other programs (and
//! whoever judges a map) read. It knows the roles of features and nothing of files.

use super::reach::{closing, felt, moved_in};
use super::{RunRecord, boundary, closed_positions, is_simple, position, rounded, surface_points};
use crate::geometry::{Point, Pose, Ring};
use crate::mapping::follow::clearance;
use crate::mapping::map::{
    Contact, ContactKind, LineReason, LineStatus, MappedObject, ObjectClass, Phase, PlanLine,
};
use crate::mapping::settings::Strategy;
use crate::mapping::unreached::{Beyond, Unreached};
use serde_json::{Map, Value, json};

/// The record as the text of a GeoJSON file, one feature a line.
#[must_use]
pub fn write(record: &RunRecord<'_>) -> String {
    let features: Vec<String> = features(record).iter().map(Value::to_string).collect();
    format!(
        "{{\"type\":\"FeatureCollection\",\"name\":{},\"generator\":\"periplus {}\",\"features\":[\n{}\n]}}\n",
        Value::from(record.world),
        env!("CARGO_PKG_VERSION"),
        features.join(",\n")
    )
}

fn features(record: &RunRecord<'_>) -> Vec<Value> {
    let mut all = vec![start(record.settings.start)];
    all.extend(outline(record));
    all.extend(walls(record));
    let radius = record.settings.chassis.radius;
    let way: Vec<Point> = record.map.path.iter().map(|place| place.pose.position).collect();
    all.extend(record.map.objects.iter().flat_map(|thing| object(thing, radius, &way)));
    all.extend(record.map.unreached.iter().map(gap));
    all.extend(record.map.beyond.iter().filter_map(beyond));
    if let Some(squared) = &record.map.squared {
        let mapped = squared.before.to_points(super::SAGITTA);
        all.extend(open("boundary_mapped", &mapped, json!({})));
    }
    if let Some(plan) = &record.map.plan {
        // A shorter plan does without most of the paper's lines, which can be a hundred thousand;
        // only the paper's own plan is told whole (figure 8).
        let whole = plan.figures.strategy == Strategy::Paper;
        let left_out = |line: &&PlanLine| {
            line.reason == Some(LineReason::Redundant) || line.status == LineStatus::Rejected
        };
        let told = plan.lines.iter().filter(|line| whole || !left_out(line));
        all.extend(told.filter_map(plan_line));
    }
    all.extend(paths(record));
    all
}

fn feature(role: &str, kind: &str, coordinates: impl Into<Value>, more: Value) -> Value {
    let mut properties = Map::new();
    properties.insert("role".to_owned(), role.into());
    if let Value::Object(more) = more {
        properties.extend(more);
    }
    json!({
        "type": "Feature",
        "properties": properties,
        "geometry": { "type": kind, "coordinates": coordinates.into() },
    })
}

fn start(pose: Pose) -> Value {
    let heading = rounded(pose.heading, 6);
    let at = json!(position(pose.position));
    feature("start", "Point", at, json!({ "heading": heading }))
}

fn outline(record: &RunRecord<'_>) -> Option<Value> {
    let reachable = boundary(record).map(|ring| sensed(record, &ring).unwrap_or(ring));
    let known = reachable.and_then(|ring| closed_positions(&ring));
    if let Some(ring) = known {
        let more = json!({ "fitted": record.map.shape.is_some() });
        return Some(feature("boundary", "Polygon", json!([ring]), more));
    }
    open("boundary_open", &surface_points(record.map), json!({}))
}

/// The outline as far as switches see into its sharp corners; none when that is all of it.
fn sensed(record: &RunRecord<'_>, ring: &Ring) -> Option<Ring> {
    record.map.shape.as_ref()?;
    felt(ring, clearance(&record.settings.chassis))
}

/// The walls to where they would meet, where the robot has not seen them meet.
fn walls(record: &RunRecord<'_>) -> Option<Value> {
    let ring = boundary(record)?;
    sensed(record, &ring)?;
    let ring = closed_positions(&ring)?;
    Some(feature("boundary_fitted", "Polygon", json!([ring]), json!({})))
}

/// A gap that the robot does not pass, where it is narrowest.
fn gap(unreached: &Unreached) -> Value {
    let area = unreached.area.map(|area| rounded(area, 2));
    let more = json!({ "width": rounded(unreached.width, 3), "area_behind": area });
    feature("gap", "Point", json!(position(unreached.at)), more)
}

/// What is round floor behind a strait, which is no part of the map.
fn beyond(beyond: &Beyond) -> Option<Value> {
    let ring = closed_positions(&beyond.outline)?;
    let area = rounded(beyond.outline.area(), 2);
    Some(feature("beyond", "Polygon", json!([ring]), json!({ "area": area })))
}

/// A line through points that do not close; none for fewer than two places.
fn open(role: &str, points: &[Point], more: Value) -> Option<Value> {
    let line: Vec<[f64; 2]> = points.iter().copied().map(position).collect();
    let goes_on = line.iter().any(|place| *place != line[0]);
    goes_on.then(|| feature(role, "LineString", json!(line), more))
}

/// An object by what it keeps a body of `radius` metres off that went this `way`; where that is more than its
/// surfaces, these follow as a line.
fn object(object: &MappedObject, radius: f64, way: &[Point]) -> Vec<Value> {
    let more = json!({ "id": object.id, "class": object.class, "closed": object.closed });
    if object.class != ObjectClass::Open {
        let Some(surface) = closed_positions(&object.outline) else { return Vec::new() };
        let is_surface = |contact: &&Contact| contact.kind != ContactKind::Edge;
        let touched = object.contacts.iter().filter(is_surface).map(|contact| contact.point);
        let faces = moved_in(&object.outline, &touched.collect::<Vec<_>>(), (way, radius));
        let is_moved = faces != object.outline;
        let kept_off = closing(&faces, radius).or_else(|| is_moved.then_some(faces));
        let kept_off = kept_off.and_then(|ring| closed_positions(&ring));
        // No reader takes a polygon that crosses itself; the surfaces are one that does not.
        let Some(ring) = kept_off.filter(|ring| is_simple(ring)) else {
            return vec![feature("object", "Polygon", json!([surface]), more)];
        };
        let id = json!({ "id": object.id });
        return vec![
            feature("object", "Polygon", json!([ring]), more),
            feature("object_surface", "LineString", json!(surface), id),
        ];
    }
    // The closing chord of an open outline is nobody's surface, and is left out.
    let mut chain = object.outline.to_points(super::SAGITTA);
    if chain.len() < 2 {
        chain = object.contacts.iter().map(|contact| contact.point).collect();
    }
    open("object_open", &chain, more).into_iter().collect()
}

/// None for a place that was only gone to: no reader takes a line of no length.
fn plan_line(line: &PlanLine) -> Option<Value> {
    let (from, to) = line.drive.unwrap_or((line.start, line.end));
    let ends = [position(from), position(to)];
    if ends[0] == ends[1] {
        return None;
    }
    let status = match line.status {
        // A run that ended in the middle of a line has not driven it.
        LineStatus::Driving => LineStatus::Planned,
        other => other,
    };
    let more = json!({
        "id": line.id,
        "part": line.part,
        "vertex": line.vertex,
        "angle_deg": rounded(line.angle.to_degrees(), 4),
        "status": status,
        "reason": line.reason.map(|reason| reason.to_string()),
        "wall_start": position(line.start),
        "wall_end": position(line.end),
    });
    Some(feature("plan", "LineString", json!(ends), more))
}

/// A vertex of the trajectory: believed and, with a simulator, true position.
struct Vertex {
    believed: [f64; 2],
    truth: Option<[f64; 2]>,
    boundary: bool,
    carried: bool,
}

/// The trajectory in stretches of one phase each. A stretch begins with the vertex that the one
/// before it ends with, unless the robot was carried there; `true_path` has the same stretches with
/// the same vertices. Where it only turned on the spot there is none.
fn paths(record: &RunRecord<'_>) -> Vec<Value> {
    let vertices = vertices(record);
    let mut all = Vec::new();
    let mut truths = Vec::new();
    let mut first = 0;
    while first + 1 < vertices.len() {
        if vertices[first + 1].carried {
            first += 1;
            continue;
        }
        // A piece of trajectory belongs to the phase in which it ended.
        let boundary = vertices[first + 1].boundary;
        let on = |vertex: &&Vertex| vertex.boundary == boundary && !vertex.carried;
        let run = vertices[first + 1..].iter().take_while(on).count();
        let stretch = &vertices[first..=first + run];
        first += run;
        if stretch.iter().all(|vertex| vertex.believed == stretch[0].believed) {
            continue;
        }
        let more = json!({ "phase": if boundary { "boundary" } else { "objects" } });
        let believed: Vec<[f64; 2]> = stretch.iter().map(|vertex| vertex.believed).collect();
        all.push(feature("path", "LineString", json!(believed), more.clone()));
        let truth: Option<Vec<[f64; 2]>> = stretch.iter().map(|vertex| vertex.truth).collect();
        truths.extend(truth.map(|line| feature("true_path", "LineString", json!(line), more)));
    }
    all.extend(truths);
    all
}

fn vertices(record: &RunRecord<'_>) -> Vec<Vertex> {
    let path = &record.map.path;
    // A trajectory of another length cannot be laid beside this one vertex by vertex.
    let truth = record.true_path.filter(|truth| truth.len() == path.len());
    let mut vertices: Vec<Vertex> = Vec::with_capacity(path.len());
    for (k, point) in path.iter().enumerate() {
        let vertex = Vertex {
            believed: position(point.pose.position),
            truth: truth.map(|truth| position(truth[k].position)),
            boundary: point.phase != Phase::Objects,
            carried: point.carried,
        };
        // Turning on the spot adds vertices that no reader can tell apart.
        let same = vertices.len() > 1
            && !point.carried
            && vertices.last().is_some_and(|last| {
                last.believed == vertex.believed
                    && last.truth == vertex.truth
                    && last.boundary == vertex.boundary
            });
        if !same {
            vertices.push(vertex);
        }
    }
    vertices
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    fn parsed(record: &RunRecord<'_>) -> Vec<Value> {
        let text = write(record);
        let value: Value = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e}: {text}"));
        value["features"].as_array().expect("features").clone()
    }

    fn role<'a>(features: &'a [Value], role: &str) -> Vec<&'a Value> {
        features.iter().filter(|feature| feature["properties"]["role"] == role).collect()
    }

    #[test]
    fn paths_share_their_ends_and_true_paths_their_vertices() {
        let sample = sample::room();
        let features = parsed(&sample.record());
        let paths = role(&features, "path");
        let truths = role(&features, "true_path");
        assert_eq!(paths.len(), 2, "one stretch for each phase that moves");
        assert_eq!(truths.len(), 2, "the truth has the same stretches");
        for (path, truth) in paths.iter().zip(&truths) {
            let count = |f: &Value| f["geometry"]["coordinates"].as_array().map_or(0, Vec::len);
            assert_eq!(count(path), count(truth), "vertex by vertex");
        }
        let line = |k: usize| paths[k]["geometry"]["coordinates"].as_array().expect("line");
        assert_eq!(line(0).last(), line(1).first(), "no gap between stretches");
    }

    #[test]
    fn what_goes_nowhere_is_no_line() {
        let mut sample = sample::room();
        let plan = sample.map.plan.as_mut().expect("a plan");
        let spot = plan.lines[0].start;
        (plan.lines[0].end, plan.lines[0].drive) = (spot, Some((spot, spot)));
        plan.lines[0].status = LineStatus::Driven;
        // Turned on the spot, and was stopped there.
        sample.map.path.truncate(2);
        let stood = sample.map.path[0];
        sample.map.path[1].pose.position = stood.pose.position;
        sample.truth.truncate(2);
        sample.map.closed = false;
        let touched = sample.map.contacts[0];
        sample.map.contacts = vec![touched; 2];
        for line in parsed(&sample.record()) {
            let geometry = &line["geometry"];
            let places = geometry["coordinates"].as_array().expect("places");
            let line = geometry["type"] != "LineString" || places.iter().any(|p| *p != places[0]);
            assert!(line, "a line of no length: {geometry}");
        }
    }

    #[test]
    fn arcs_stray_hardly_from_their_chords_and_a_column_is_as_thick_as_it_is() {
        let sample = sample::room();
        let features = parsed(&sample.record());
        let column = role(&features, "object")[0];
        let ring = column["geometry"]["coordinates"][0].as_array().expect("ring");
        assert_eq!(ring.first(), ring.last(), "rings are closed");
        for pair in ring.windows(2) {
            let mid = |axis: usize| {
                f64::midpoint(
                    pair[0][axis].as_f64().expect("x"),
                    pair[1][axis].as_f64().expect("x"),
                )
            };
            let off = (Point::new(mid(0), mid(1)) - sample::COLUMN.0).norm();
            let sagitta = sample::COLUMN.1 - off;
            assert!(sagitta <= 0.0002, "a chord strays {sagitta} m from its arc");
        }
        let at =
            |pair: &[Value], k: usize, axis: usize| pair[k][axis].as_f64().expect("a coordinate");
        let doubled: f64 = ring
            .windows(2)
            .map(|pair| at(pair, 0, 0) * at(pair, 1, 1) - at(pair, 1, 0) * at(pair, 0, 1))
            .sum();
        let thick = 2.0 * (doubled.abs() / 2.0 / std::f64::consts::PI).sqrt();
        assert!((thick - 2.0 * sample::COLUMN.1).abs() < 3e-4, "{thick} m thick");
    }

    #[test]
    fn an_open_lap_gives_no_boundary_polygon() {
        let mut sample = sample::room();
        sample.map.closed = false;
        sample.map.shape = None;
        let features = parsed(&sample.record());
        assert!(role(&features, "boundary").is_empty(), "the lap is open");
        assert_eq!(role(&features, "boundary_open").len(), 1);
    }

    #[test]
    fn floor_behind_a_strait_is_no_part_of_the_boundary() {
        let mut sample = sample::room();
        let plain = parsed(&sample.record());
        assert!(role(&plain, "beyond").is_empty(), "there is none");
        sample.map.beyond = vec![sample::beyond()];
        let features = parsed(&sample.record());
        assert_eq!(role(&features, "boundary"), role(&plain, "boundary"));
        let [beyond] = role(&features, "beyond")[..] else { panic!("one piece of floor") };
        assert_eq!(beyond["properties"]["area"], 3.0);
        let ring = beyond["geometry"]["coordinates"][0].as_array().expect("a ring");
        assert_eq!(ring.first(), ring.last(), "rings are closed");
    }

    #[test]
    fn plan_lines_carry_their_entry_and_reason() {
        let mut sample = sample::room();
        if let Some(plan) = &mut sample.map.plan {
            plan.figures.strategy = Strategy::Paper;
        }
        let features = parsed(&sample.record());
        let lines = role(&features, "plan");
        assert_eq!(lines.len(), sample.map.plan.as_ref().expect("plan").lines.len());
        let rejected = lines
            .iter()
            .find(|line| line["properties"]["status"] == "rejected")
            .expect("a rejected line");
        assert_eq!(rejected["properties"]["reason"], "runs along the boundary");
        assert_eq!(rejected["properties"]["angle_deg"], 0.0);
    }
}
