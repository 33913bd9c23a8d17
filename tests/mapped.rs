//! A room that was mapped, driven in once more.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

mod shell;

use periplus::geometry::{Point, Ring};
use shell::{periplus, place, refused};
use std::fs;

#[test]
fn a_room_that_was_mapped_is_a_world() {
    let dir = place("mapped");
    let sim = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/extrinsic_first.toml");
    let run = |world: &str, out: &str| {
        let out = dir.join(out);
        let to = out.to_str().expect("a path");
        let run = ["run", "--world", world, "--noise", "none", "--alpha", "1", "--out", to];
        let output = periplus(&run);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let report = fs::read_to_string(out.join("report.json")).expect("a report");
        let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
        let area = |of: &serde_json::Value| of["area_m2"].as_f64().expect("an area");
        let objects = report["objects"].as_array().expect("objects");
        (area(&report["boundary"]), objects.iter().map(area).collect::<Vec<_>>())
    };
    let (floor, things) = run(sim, "first");
    let map = dir.join("first").join("map.geojson");
    let (again, same) = run(map.to_str().expect("a path"), "second");
    assert!((floor - again).abs() < 0.01 * floor, "{floor} {again}");
    assert!(!things.is_empty() && things.len() == same.len(), "{things:?} {same:?}");
    for (a, b) in things.iter().zip(&same) {
        assert!((a - b).abs() < 0.05 * a, "{a} {b}");
    }
    // What is not known of the room stands in no world.
    let text = fs::read_to_string(&map).expect("a map");
    for (role, open, word) in
        [("object", "object_open", "get round"), ("boundary", "boundary_open", "did not close")]
    {
        let file = dir.join(format!("{open}.geojson"));
        let role = format!("\"role\":\"{role}\"");
        fs::write(&file, text.replace(&role, &format!("\"role\":\"{open}\""))).expect("a file");
        let run = ["run", "--world", file.to_str().expect("a path"), "--out", "never"];
        refused(&run, &["feature", open, word]);
    }
}

/// The touches of the tour move the walls by millimetres to centimetres: the lines that were planned on them go along.
#[test]
fn the_lines_of_the_plan_lead_from_wall_to_wall_of_the_map_that_is_handed_over() {
    let dir = place("planned");
    let sim = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/l_room.toml");
    let out = dir.join("run");
    let to = out.to_str().expect("a path");
    let run = periplus(&["run", "--world", sim, "--seed", "11", "--out", to]);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    let map = fs::read_to_string(out.join("map.geojson")).expect("a map");
    let map: serde_json::Value = serde_json::from_str(&map).expect("JSON");
    let features = map["features"].as_array().expect("features");
    let of = |role: &'static str| {
        features.iter().filter(move |feature| feature["properties"]["role"] == role)
    };
    let point = |at: &serde_json::Value| {
        let [x, y] = [&at[0], &at[1]].map(|value| value.as_f64().expect("metres"));
        Point::new(x, y)
    };
    let boundary = &of("boundary").next().expect("a boundary")["geometry"]["coordinates"][0];
    let corners: Vec<Point> = boundary.as_array().expect("points").iter().map(point).collect();
    let walls = Ring::polygon(&corners[1..]);
    let driven = of("plan").map(|line| &line["properties"]).filter(|it| it["status"] == "driven");
    let mut off: Vec<f64> = driven.map(|it| walls.distance(point(&it["wall_start"]))).collect();
    off.sort_by(f64::total_cmp);
    assert!(off.len() > 8, "{off:?}");
    // Measured: 0.2 mm in the median, and 9 mm where they stayed.
    assert!(off[off.len() / 2] < 0.002, "{off:?}");
}
