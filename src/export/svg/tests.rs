//! The picture holds what it should, and can be turned into pixels without any font.

use super::super::{png, sample};
use super::placement::Spot;
use super::*;
use crate::mapping::map::{LineStatus, MappedObject, PlanLine, RoomMap};
use crate::mapping::unreached::Unreached;

fn drawn(sample: &sample::Sample) -> String {
    write(&sample.record(), &Options::default())
}

/// Where in the drawing something begins.
fn place(drawing: &str, what: &str) -> usize {
    drawing.find(what).unwrap_or_else(|| panic!("no {what} in the picture"))
}

/// The labels of the drawing from a given place on, in order.
fn labels_from(drawing: &str, what: &str) -> Vec<String> {
    let rest = &drawing[place(drawing, what)..];
    let labels = rest.split("aria-label=\"").skip(1);
    labels.filter_map(|label| label.split('"').next().map(str::to_owned)).collect()
}

#[test]
fn every_layer_of_the_sample_is_drawn_and_explained() {
    let drawing = drawn(&sample::room());
    let ids = ["boundary", "cuts", "plan-planned", "plan-driven", "plan-blocked", "trajectory"];
    for id in ids.into_iter().chain(["object-open", "start", "scale", "dimensions"]) {
        assert!(drawing.contains(&format!("id=\"{id}\"")), "no layer {id}");
    }
    let lines = ["line planned", "line driven", "line blocked", "trajectory"];
    for name in ["wall", "object", "start", "O1"].into_iter().chain(lines) {
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
fn walls_and_objects_lie_on_the_way_driven() {
    let drawing = drawn(&sample::room());
    let lines = ["trajectory", "plan-planned", "plan-driven", "plan-blocked", "cuts"];
    let top = lines.map(|id| place(&drawing, &format!("id=\"{id}\""))).into_iter().max();
    let object = place(&drawing, "class=\"object\"");
    let open = place(&drawing, "id=\"object-open\"");
    let wall = place(&drawing, "id=\"boundary\"");
    let mark = place(&drawing, "id=\"start\"");
    let label = place(&drawing, "aria-label=\"O1\"");
    assert!(top < Some(object.min(open)), "a line runs over an object");
    assert!(object.max(open) < wall && wall < mark && mark < label, "walls, start, labels on top");
    assert!(place(&drawing, "id=\"trajectory\"") < place(&drawing, "id=\"plan-driven\""));
}

/// A colour that shines through another one is in no legend.
#[test]
fn every_colour_of_the_picture_is_opaque_and_in_the_legend() {
    let drawing = drawn(&sample::room());
    assert!(!drawing.contains("opacity"), "something shines through");
    let map = &drawing[..place(&drawing, "id=\"scale\"")];
    let legend = &drawing[place(&drawing, "id=\"scale\"")..];
    for pen in pens::OF_PLAN.iter().chain([&pens::TRAJECTORY, &pens::WALL, &pens::OBJECT]) {
        let stroke = format!("stroke=\"{}\"", pen.color);
        assert_eq!(map.contains(&stroke), legend.contains(&stroke), "{}", pen.name);
    }
}

#[test]
fn the_legend_has_the_same_order_whatever_came_first() {
    let mut sample = sample::room();
    let before = labels_from(&drawn(&sample), "id=\"scale\"");
    if let Some(plan) = &mut sample.map.plan {
        plan.lines.reverse();
    }
    sample.map.objects.reverse();
    assert_eq!(labels_from(&drawn(&sample), "id=\"scale\""), before);
    let expected = [
        "wall",
        "object",
        "object, half seen",
        "cut between parts",
        "line planned",
        "line driven",
        "line blocked",
        "trajectory",
        "start",
    ];
    assert_eq!(before[1..], expected, "the first is the scale bar's");
}

#[test]
fn a_line_driven_beyond_the_plan_is_told_apart() {
    let mut sample = sample::room();
    assert!(!drawn(&sample).contains("line added"), "nothing was added yet");
    if let Some(plan) = &mut sample.map.plan {
        let more = plan.lines.iter().find(|line| line.status == LineStatus::Driven).cloned();
        plan.lines.extend(more.map(|line| PlanLine { id: 99, ..line }));
    }
    let drawing = drawn(&sample);
    assert!(drawing.contains("id=\"plan-added\"") && drawing.contains("aria-label=\"line added\""));
    assert!(drawing.contains("3 lines and 1 added"), "the figures do not tell of it");
}

#[test]
fn what_was_not_reached_is_drawn_and_told() {
    let mut sample = sample::room();
    let names = [pens::UNTOUCHED.name, pens::NARROW.name];
    for name in names {
        assert!(!drawn(&sample).contains(name), "{name}: there is none");
    }
    // A short wall that nobody touched, and a gap between the column and the wall to its left.
    let at = |x: f64, y: f64| Point::new(x, y);
    sample.map.unreached = vec![
        Unreached { at: at(3.9, 0.0), width: 0.2, area: None },
        Unreached { at: at(0.5, 1.4), width: 1.0, area: Some(0.3) },
    ];
    let drawing = drawn(&sample);
    for name in names {
        assert!(drawing.contains(&format!("aria-label=\"{name}\"")), "no legend for {name}");
    }
    assert!(place(&drawing, "id=\"untouched\"") > place(&drawing, "id=\"boundary\""));
    assert!(
        drawing.contains("1 stretch not touched, 20 cm wide: a gap or a short wall"),
        "{drawing}"
    );
    assert!(drawing.contains("1 gap too narrow, 100 cm wide, with 0.30 m² behind"));
    // The bar goes from one side of the gap to the other.
    let bar = &drawing[place(&drawing, "id=\"narrow\"")..];
    let data = bar.split(" d=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("a bar");
    let ends: Vec<Vec<f64>> = data[1..]
        .split('L')
        .map(|end| end.split(' ').map(|n| n.parse().expect("a number")).collect())
        .collect();
    assert!((ends[0][1] - ends[1][1]).abs() < 0.2, "it lies across the gap: {data}");
    assert!((ends[0][0] - ends[1][0]).abs() > 200.0, "and is a metre wide: {data}");
}

#[test]
fn floor_behind_a_strait_is_no_room_and_what_was_felt_there_is_shown() {
    let mut sample = sample::room();
    assert!(!drawn(&sample).contains(pens::BEYOND), "there is none");
    let beyond = sample::beyond();
    let seen = beyond.contacts.len();
    sample.map.unreached = vec![beyond.told(&sample.settings.chassis).expect("a strait")];
    sample.map.beyond = vec![beyond];
    let drawing = drawn(&sample);
    let layer = &drawing[place(&drawing, "<g id=\"beyond\"")..];
    let layer = layer.split("</g>").next().expect("a layer");
    assert_eq!(layer.matches("<circle").count(), seen, "{layer}");
    assert!(drawing.contains(&format!("aria-label=\"{}\"", pens::BEYOND)));
    assert!(drawing.contains("1 gap too narrow, 28 cm wide, with 2.24 m² behind"), "{drawing}");
    // The wall line is taken away along the strait, and the bar lies there.
    let ends = |id: &str| {
        let pen = &drawing[place(&drawing, id)..];
        pen.split(" d=\"").nth(1).and_then(|rest| rest.split('"').next()).map(str::to_owned)
    };
    assert!(ends("id=\"untouched-floor\"").is_some());
    assert_eq!(ends("id=\"untouched-floor\""), ends("id=\"narrow\""));
}

#[test]
fn where_something_may_hide_is_drawn_when_the_promise_is_not_kept() {
    let mut sample = sample::room();
    sample.map.hidden_at = Some(Point::new(2.0, 1.5));
    sample.map.hidden_disc = Some(0.5);
    assert!(!drawn(&sample).contains("id=\"hidden\""), "lines are still to be driven");
    for line in sample.map.plan.iter_mut().flat_map(|plan| &mut plan.lines) {
        line.status = LineStatus::Driven;
    }
    let drawing = drawn(&sample);
    assert!(drawing.contains("id=\"hidden\""), "half a metre is more than α");
    assert!(drawing.contains(&format!("aria-label=\"{}\"", pens::HIDDEN.name)));
}

#[test]
fn of_a_lap_that_is_open_the_contacts_are_shown_and_nothing_between_them() {
    let mut sample = sample::room();
    (sample.map.shape, sample.map.plan, sample.map.closed) = (None, None, false);
    let drawing = drawn(&sample);
    let start = place(&drawing, "<g id=\"boundary\"");
    let layer = drawing[start..].split("</g>").next().expect("a layer");
    assert_eq!(layer.matches("<circle").count(), sample.map.contacts.len(), "{layer}");
    assert!(!layer.contains("<path"), "contacts are joined: {layer}");
    assert!(drawing.contains(&format!("aria-label=\"{}\"", pens::TOUCHED)));
    assert!(!drawing.contains("aria-label=\"wall\""), "nothing is a wall yet");
}

#[test]
fn a_run_of_the_boundary_alone_claims_no_more() {
    let mut sample = sample::room();
    (sample.map.plan, sample.map.objects) = (None, Vec::new());
    let mut record = sample.record();
    for phase in &mut record.progress[1..] {
        phase.done = false;
    }
    let drawing = write(&record, &Options::default());
    assert!(drawing.contains("complete up to the boundary phase"), "it was asked for no more");
    assert!(!drawing.contains("0 objects"), "nobody looked for objects");
}

#[test]
fn room_and_objects_have_their_sizes() {
    let mut sample = sample::room();
    let drawing = drawn(&sample);
    for text in ["4.00 m", "3.00 m", "⌀ 0.40 m", "0.63 × 0.32 m", "≥ 0.28 × 0.21 m"] {
        assert!(drawing.contains(&format!("aria-label=\"{text}\"")), "no {text}: {drawing}");
    }
    let errors = "walls ± 4 (4) mm, corners ± 9 (13) mm, objects ± 8 (8) mm";
    assert!(drawing.contains(errors), "no standard errors");
    assert!(drawing.contains("37.6 m driven in 0:07:10"), "time is not as on the screen");
    // Many are told of in a table, with the standard error of each.
    let one = sample.map.objects[0].clone();
    sample.map.objects = (1..=20).map(|id| MappedObject { id, ..one.clone() }).collect();
    let drawing = drawn(&sample);
    assert_eq!(drawing.matches("aria-label=\"⌀ 0.40 m\"").count(), 20);
    assert_eq!(drawing.matches("aria-label=\"± 8 mm\"").count(), 3, "that many are known");
}

#[test]
fn a_figure_that_is_wider_than_the_picture_goes_on_in_the_next_line() {
    let text = "standard errors, median (worst): walls ± 4 (4) mm, corners ± 8 (12) mm";
    let lines = wrapped(text, 200.0, FIGURES.height);
    assert!(lines.len() > 1, "{lines:?}");
    assert_eq!(lines.join(" "), text);
    let widest = lines.iter().map(|line| crate::export::strokes::width(line, FIGURES.height));
    assert!(widest.fold(0.0, f64::max) <= 200.0);
    assert_eq!(wrapped("short", 200.0, FIGURES.height), ["short"]);
    for widest in 120..400 {
        let lines = wrapped(text, f64::from(widest), FIGURES.height);
        let torn = lines.iter().any(|line| line.starts_with("mm") || line.ends_with('±'));
        assert!(!torn, "{lines:?}");
    }
    // A phrase that no line holds is torn all the same.
    let long = "so many words that belong together that no line is wide enough for them";
    assert_eq!(wrapped(long, 200.0, FIGURES.height).join(" "), long);
}

#[test]
fn a_circle_has_a_diameter_and_no_vertices() {
    let mut sample = sample::room();
    let ring = Ring::circle(sample::COLUMN.0, 1.5);
    if let Some(shape) = &mut sample.map.shape {
        shape.class = crate::mapping::map::ShapeClass::Circle;
        shape.vertices.clear();
        shape.parts.truncate(1);
        shape.parts[0].circle = Some((sample::COLUMN.0, 1.5));
        shape.outline = ring;
    }
    let drawing = drawn(&sample);
    assert!(drawing.contains("circle ⌀ 3.00 m ·") && !drawing.contains("vert"), "{drawing}");
}

/// Thirty columns as close together as a body passes, with numbers of two digits.
#[test]
fn no_label_lies_on_another() {
    let mut sample = sample::room();
    let one = sample.map.objects[0].clone();
    let column = |k: u32| MappedObject {
        id: 10 + k,
        outline: Ring::circle(
            Point::new(0.4 + 0.13 * f64::from(k % 6), 0.9 + 0.13 * f64::from(k / 6)),
            0.03,
        ),
        ..one.clone()
    };
    sample.map.objects = (0..30).map(column).collect();
    let record = sample.record();
    let spots = |of: &RunRecord<'_>| -> Vec<Spot> {
        let options = Options::default();
        let wall = boundary(of);
        let (low, high) = extent(of, wall.as_ref());
        let frame = Frame::around(low, high, (0.0, 0.0));
        let background = Background::of(of, &options, &frame, wall.as_ref());
        let scene = Scene { record: of, options: &options, frame, wall, background };
        labels::place(&scene).placed.into_iter().map(|(_, spot)| spot).collect()
    };
    let found = spots(&record);
    assert_eq!(found.len(), 30, "every object has its label");
    for (k, spot) in found.iter().enumerate() {
        let clear = found[..k].iter().all(|other| !spot.area.meets(&other.area));
        assert!(clear, "label {k} lies on another: {spot:?}");
    }
    assert_eq!(found, spots(&record), "another time, another picture");
}

#[test]
fn a_large_hall_does_not_fill_with_lines() {
    let mut sample = sample::room();
    let width = |sample: &sample::Sample| {
        let drawing = drawn(sample);
        let layer = &drawing[place(&drawing, "id=\"trajectory\"")..];
        let width = layer.split("stroke-width=\"").nth(1).and_then(|rest| rest.split('"').next());
        width.and_then(|width| width.parse::<f64>().ok()).expect("a width")
    };
    assert_eq!(width(&sample), pens::TRAJECTORY.width);
    sample.map.path = sample.map.path.repeat(60);
    assert!(width(&sample) < 0.5 * pens::TRAJECTORY.width, "{}", width(&sample));
}

#[test]
fn the_picture_has_ink_on_it() {
    let bytes = png::render(&drawn(&sample::room()), 400).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(&bytes[1..4], b"PNG");
    assert!(bytes.len() > 5_000, "{} bytes are an empty picture", bytes.len());
}

#[test]
fn an_empty_map_still_makes_a_picture() {
    let mut sample = sample::room();
    sample.map = RoomMap::default();
    let drawing = drawn(&sample);
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
