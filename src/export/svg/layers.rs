//! The layers of the map, from the floor up: floor, trajectory, plan, cuts, objects, walls, what was not
//! reached, start, labels. The way driven is the background: walls and objects lie on it and are opaque.

use super::super::picture::Frame;
use super::super::strokes::Lettering;
use super::super::{RunRecord, surface_points};
use super::labels::{self, Labels};
use super::pens::{self, Pen, color};
use super::placement::Area;
use super::{Scene, gaps};
use crate::geometry::{Point, Pose, Vector};
use crate::mapping::map::{MappedObject, ObjectClass, stretches};
use std::fmt::Write;

/// All layers.
pub(super) fn draw(scene: &Scene<'_>, labels: &Labels, letters: &mut Lettering) -> String {
    let (record, frame) = (scene.record, &scene.frame);
    let wall = scene.wall.as_ref().map(|ring| frame.ring(ring));
    let mut out = wall.as_deref().map_or_else(String::new, floor);
    if scene.options.trajectory {
        out.push_str(&trajectory(scene));
    }
    out.push_str(&plan(scene));
    out.push_str(&cuts(record, frame));
    for object in &record.map.objects {
        out.push_str(&solid(object, frame));
    }
    match wall {
        Some(data) => out.push_str(&pens::WALL.stroke(&data)),
        None => out.push_str(&touched(record, frame)),
    }
    out.push_str(&beyond(record, frame));
    out.push_str(&gaps::draw(scene));
    out.push_str(&start(record.settings.start, frame));
    out.push_str(&labels::draw(labels, letters));
    out
}

/// The floor with the walls round it, without their edge.
fn floor(wall: &str) -> String {
    // A broad band under the floor's white leaves half of itself outside: the wall.
    format!(
        "<g id=\"floor\" stroke-linejoin=\"round\"><path d=\"{wall}\" fill=\"none\" stroke=\"{}\" \
         stroke-width=\"15\"/><path d=\"{wall}\" fill=\"{}\"/></g>\n",
        color::SOLID,
        color::FLOOR,
    )
}

/// The contacts of a lap that is not closed. What is between two of them nobody knows: they are not
/// joined, not even in the order in which they were felt.
fn touched(record: &RunRecord<'_>, frame: &Frame) -> String {
    dots("boundary", surface_points(record.map), frame)
}

/// What was felt behind straits, which is no part of the map.
fn beyond(record: &RunRecord<'_>, frame: &Frame) -> String {
    let contacts = record.map.beyond.iter().flat_map(|beyond| &beyond.contacts);
    dots("beyond", contacts.map(|contact| contact.point), frame)
}

fn dots(id: &str, points: impl IntoIterator<Item = Point>, frame: &Frame) -> String {
    let mut dots = String::new();
    for point in points {
        let (x, y) = frame.at(point);
        // Writing to a string cannot fail.
        let _ = write!(dots, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"1.6\"/>");
    }
    if dots.is_empty() {
        return dots;
    }
    format!("<g id=\"{id}\" fill=\"{}\">{dots}</g>\n", color::WALL)
}

fn cuts(record: &RunRecord<'_>, frame: &Frame) -> String {
    let parts = record.map.shape.iter().flat_map(|shape| &shape.parts);
    let pieces = parts.flat_map(|part| part.ring.pieces.iter().zip(&part.cut));
    let data: String =
        pieces.filter(|&(_, &cut)| cut).map(|(piece, _)| frame.single(piece)).collect();
    pens::CUT.stroke(&data)
}

fn plan(scene: &Scene<'_>) -> String {
    let Some(plan) = &scene.record.map.plan else {
        return String::new();
    };
    let drawn: Vec<_> = pens::of_lines(plan, scene.options).collect();
    let layer = |pen: &Pen| {
        let lines = drawn.iter().filter(|(_, of)| of == pen).map(|(line, _)| line);
        let ends = lines.map(|line| line.drive.unwrap_or((line.start, line.end)));
        let data: String = ends.map(|(from, to)| scene.frame.line([from, to])).collect();
        scene.background.plan(pen).stroke(&data)
    };
    // What was driven lies on what was not.
    pens::OF_PLAN.iter().rev().map(layer).collect()
}

fn trajectory(scene: &Scene<'_>) -> String {
    let data: String = stretches(&scene.record.map.path)
        .map(|stretch| scene.frame.line(stretch.iter().map(|point| point.pose.position)))
        .collect();
    scene.background.trajectory().stroke(&data)
}

fn solid(object: &MappedObject, frame: &Frame) -> String {
    if object.class == ObjectClass::Open {
        return pens::HALF_SEEN.stroke(&frame.line(object.outline.to_points(0.001)));
    }
    // Its back, where it was not gone round, is a guess.
    let pen = if object.closed { pens::OBJECT } else { pens::HALF_SEEN };
    let data = frame.ring(&object.outline);
    let edge = pen.edge();
    format!("<path class=\"object\" d=\"{data}\" fill=\"{}\" {edge}/>\n", color::OBJECT)
}

/// What the mark of the start covers.
pub(super) fn start_area(pose: Pose, frame: &Frame) -> Area {
    let (x, y) = frame.at(pose.position);
    let (ahead_x, ahead_y) = frame.at(pose.to_world(Point::new(9.0 / frame.scale, 0.0)));
    let middle = nalgebra::center(&Point::new(x, y), &Point::new(ahead_x, ahead_y));
    Area::around(middle, Vector::repeat(24.0))
}

/// A disc with an arrow in the direction of the start.
fn start(pose: Pose, frame: &Frame) -> String {
    let (x, y) = frame.at(pose.position);
    let tip = |ahead: f64, left: f64| {
        let reach = |pixels: f64| pixels / frame.scale;
        let (px, py) = frame.at(pose.to_world(Point::new(reach(ahead), reach(left))));
        format!("{px:.1} {py:.1}")
    };
    format!(
        "<g id=\"start\" fill=\"{0}\"><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\"/>\
         <path d=\"M{1}L{2}L{3}L{4}Z\"/></g>\n",
        color::START,
        tip(19.0, 0.0),
        tip(8.0, 5.0),
        tip(10.5, 0.0),
        tip(8.0, -5.0)
    )
}
