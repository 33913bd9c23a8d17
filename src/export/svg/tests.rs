//! The picture holds what it should, and can be turned into pixels without any font.

use super::super::{png, sample};
use super::*;

#[test]
fn every_layer_of_the_sample_is_drawn_and_explained() {
    let sample = sample::room();
    let drawing = write(&sample.record(), &Options::default());
    let ids = ["boundary", "cuts", "plan-planned", "plan-driven", "plan-blocked", "trajectory"];
    for id in ids.into_iter().chain(["object-open", "start", "scale"]) {
        assert!(drawing.contains(&format!("id=\"{id}\"")), "no layer {id}");
    }
    for name in ["wall", "object", "planned", "driven", "blocked", "trajectory", "start", "O1"] {
        assert!(drawing.contains(&format!("aria-label=\"{name}\"")), "no label {name}");
    }
    assert!(!drawing.contains("plan-rejected"), "rejected lines are drawn only when asked for");
    assert!(!drawing.contains("<text"), "labels are strokes, no font is needed");
}

#[test]
fn the_drawing_of_a_plan_shows_what_was_rejected() {
    let sample = sample::room();
    let drawing = write(&sample.record(), &Options::plan_drawing());
    assert!(drawing.contains("id=\"plan-rejected\""), "figure 8 shows rejected lines");
    assert!(!drawing.contains("id=\"trajectory\""), "figures 7 to 10 show no trajectory");
}

#[test]
fn the_picture_has_ink_on_it() {
    let sample = sample::room();
    let drawing = write(&sample.record(), &Options::default());
    let bytes = png::render(&drawing, 400).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(&bytes[1..4], b"PNG");
    assert!(bytes.len() > 5_000, "{} bytes are an empty picture", bytes.len());
}

#[test]
fn an_empty_map_still_makes_a_picture() {
    let mut sample = sample::room();
    sample.map = crate::mapping::map::RoomMap::default();
    let drawing = write(&sample.record(), &Options::default());
    png::render(&drawing, 200).unwrap_or_else(|error| panic!("{error}: {drawing}"));
}

#[test]
fn long_names_are_cut_to_the_sheet() {
    let long = "a very long name ".repeat(40);
    let kept = shortened(&long, 300.0, 12.0);
    assert!(kept.ends_with("..."), "{kept}");
    assert!(super::super::strokes::width(&kept, 12.0) <= 300.0, "{kept}");
    assert_eq!(shortened("short", 300.0, 12.0), "short");
}
