//! Tests of the chart: which surface a contact is of, and how well that is known.

use super::*;
use crate::mapping::map::{ContactKind, ObjectClass, Shape, ShapeClass};

fn contact(x: f64, y: f64, time: f64) -> Contact {
    let point = Point::new(x, y);
    Contact { point, from: point, sensor: Some(0), kind: ContactKind::Range, time }
}

/// A room of 4 x 3 m, seen from the one knot that there is.
fn room() -> (Survey, Chart) {
    let mut survey = Survey::new(0.003);
    survey.mark(Point::origin(), 0);
    let outline = Ring::polygon(
        &[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)].map(|(x, y)| Point::new(x, y)),
    );
    let shape = Shape {
        class: ShapeClass::Convex,
        vertices: outline.pieces.iter().map(Piece::from).collect(),
        parts: Vec::new(),
        outline,
    };
    let map = RoomMap {
        closed: true,
        contacts: [(2.0, 0.002), (2.05, 0.002), (2.1, -0.002)]
            .map(|(x, y)| contact(x, y, 0.0))
            .to_vec(),
        shape: Some(shape),
        ..RoomMap::default()
    };
    let chart = Chart::new(&map, &survey);
    (survey, chart)
}

#[test]
fn a_contact_finds_its_wall_but_not_in_a_corner_nor_askance() {
    let (survey, chart) = room();
    let from = Point::new(2.0, 0.2);
    let surface = chart.surface_at(&survey, Point::new(2.0, 0.03), from, 0.15).expect("the wall");
    assert!((surface.at - Point::new(2.0, 0.0)).norm() < 1e-9);
    assert!((surface.normal.y.abs() - 1.0).abs() < 1e-9);
    assert!((surface.sd - 0.002).abs() < 1e-9, "{}", surface.sd);
    assert_eq!(chart.surface_at(&survey, Point::new(0.03, 0.0), Point::new(0.2, 0.2), 0.15), None);
    let askance = Point::new(1.0, 0.1);
    assert_eq!(chart.surface_at(&survey, Point::new(2.0, 0.03), askance, 0.15), None);
    assert_eq!(chart.surface_at(&survey, Point::new(2.0, 1.0), from, 0.15), None);
}

#[test]
fn a_wall_drawn_between_corners_alone_is_hardly_known() {
    let (survey, chart) = room();
    let (seen, from) = (Point::new(0.03, 1.5), Point::new(0.2, 1.5));
    let surface = chart.surface_at(&survey, seen, from, 0.15).expect("the wall, untouched");
    assert!((surface.sd - UNTOLD).abs() < 1e-9, "{}", surface.sd);
}

#[test]
fn a_contact_behind_a_thin_face_is_still_of_the_face_that_was_seen() {
    let (mut survey, mut chart) = room();
    let tie = survey.mark(Point::new(2.0, 1.0), 1);
    // A board of 20 mm, from (1, 1.5) to (3, 1.52), seen from below, 15 mm behind its face.
    let corners = [(1.0, 1.5), (3.0, 1.5), (3.0, 1.52), (1.0, 1.52)];
    let object = MappedObject {
        id: 1,
        class: ObjectClass::Rectangle,
        outline: Ring::polygon(&corners.map(|(x, y)| Point::new(x, y))),
        closed: true,
        contacts: vec![contact(2.0, 1.5, 1.0)],
    };
    chart.add(&object, Hung::Once(tie));
    let seen = Point::new(2.0, 1.515);
    let below = chart.surface_at(&survey, seen, Point::new(2.0, 1.35), 0.15);
    assert!((below.expect("the lower face").at.y - 1.5).abs() < 1e-9);
    let above = chart.surface_at(&survey, seen, Point::new(2.0, 1.68), 0.15);
    assert!((above.expect("the upper face").at.y - 1.52).abs() < 1e-9);
}

#[test]
fn what_is_known_is_told_by_the_nearest_surface() {
    let (mut survey, mut chart) = room();
    let tie = survey.mark(Point::new(2.0, 1.0), 1);
    let outline = Ring::circle(Point::new(2.0, 1.5), 0.3);
    let class = ObjectClass::Circle;
    let object = MappedObject {
        id: 1,
        class,
        outline,
        closed: true,
        contacts: vec![contact(1.7, 1.5, 1.0)],
    };
    chart.add(&object, Hung::Once(tie));
    assert_eq!(chart.distance(Point::new(2.0, 1.6)), (0.0, Some(0)));
    let (near, whose) = chart.distance(Point::new(2.0, 0.4));
    assert!((near - 0.4).abs() < 1e-9 && whose.is_none());
}

#[test]
fn a_round_column_is_a_fix_from_every_side() {
    let (mut survey, mut chart) = room();
    let tie = survey.mark(Point::new(2.0, 1.0), 1);
    let middle = Point::new(2.0, 1.5);
    let object = MappedObject {
        id: 1,
        class: ObjectClass::Circle,
        outline: Ring::circle(middle, 0.05),
        closed: true,
        contacts: vec![contact(1.95, 1.5, 1.0)],
    };
    chart.add(&object, Hung::Once(tie));
    for bearing in (0..360).step_by(15) {
        let towards = crate::geometry::angle::unit(f64::from(bearing).to_radians());
        let (seen, from) = (middle + towards * 0.052, middle + towards * 0.21);
        let surface = chart.surface_at(&survey, seen, from, 0.15);
        assert!(surface.is_some(), "at {bearing} degrees");
    }
}
