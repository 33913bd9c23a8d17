//! The objects' labels: number and size where there is room for both, else the number alone, and a table
//! of the sizes below the map.

use super::super::picture::Frame;
use super::super::strokes::{Anchor, Lettering, Style, width};
use super::Scene;
use super::layers;
use super::pens::color;
use super::placement::{Area, Board, Outline, Spot};
use crate::geometry::measure::measure;
use crate::geometry::{Point, Ring, Segment, Vector, segment};
use crate::mapping::map::{MappedObject, ObjectClass};
use std::fmt::Write;

const NAME: Style = Style { height: 9.0, weight: 0.14, color: color::LABEL };
const SIZE: Style = Style { height: 7.0, weight: 0.13, color: color::LABEL };
/// Between the two lines of a label, pixels.
const LEADING: f64 = 5.0;
/// More objects than this are told of in a table.
const MOST_WITH_SIZE: usize = 12;
/// A label with the size stands no farther off than this, pixels.
const NEAR: f64 = 60.0;
/// How far off a number may stand, pixels.
const FAR: f64 = 400.0;
/// Outlines are made of chords that stray no more than this, pixels.
const STRAY: f64 = 0.3;

/// Every label with its place.
#[derive(Debug)]
pub(super) struct Labels {
    /// Lines and places, one for each label that found room.
    pub(super) placed: Vec<(Vec<String>, Spot)>,
    /// Whether the sizes are left to the table.
    pub(super) listed: bool,
}

/// Finds a place for every label.
pub(super) fn place(scene: &Scene<'_>) -> Labels {
    let (objects, frame) = (&scene.record.map.objects, &scene.frame);
    let empty = board(scene);
    if objects.len() <= MOST_WITH_SIZE {
        let lines = |object: &MappedObject| {
            let name = format!("O{}", object.id);
            [Some(name), object.size()].into_iter().flatten().collect()
        };
        let placed = all(objects, frame, empty.clone(), NEAR, lines);
        if placed.len() == objects.len() {
            return Labels { placed, listed: false };
        }
    }
    let placed = all(objects, frame, empty, FAR, |object| vec![format!("O{}", object.id)]);
    Labels { placed, listed: true }
}

/// The labels that find a place: first those within their objects, which are at home there, then the
/// others, in order of their numbers.
fn all(
    objects: &[MappedObject],
    frame: &Frame,
    mut board: Board,
    farthest: f64,
    lines: impl Fn(&MappedObject) -> Vec<String>,
) -> Vec<(Vec<String>, Spot)> {
    let mut spots: Vec<Option<Spot>> = vec![None; objects.len()];
    let text: Vec<Vec<String>> = objects.iter().map(lines).collect();
    for (k, object) in objects.iter().enumerate() {
        // What has no back has no inside.
        let size = measure(&object.outline).filter(|_| object.class != ObjectClass::Open);
        spots[k] = size.and_then(|size| {
            let (x, y) = frame.at(size.center);
            board.within(k, Point::new(x, y), extent(&text[k]))
        });
    }
    let left: Vec<usize> = (0..objects.len()).filter(|&k| spots[k].is_none()).collect();
    let sizes: Vec<(usize, Vector)> = left.iter().map(|&k| (k, extent(&text[k]))).collect();
    for (k, spot) in board.all_beside(&sizes, farthest) {
        spots[k] = Some(spot);
    }
    text.into_iter().zip(spots).filter_map(|(text, spot)| Some((text, spot?))).collect()
}

/// The style of a label's line.
fn style(line: usize) -> Style {
    if line == 0 { NAME } else { SIZE }
}

/// What a label covers, pixels.
fn extent(lines: &[String]) -> Vector {
    let widths = lines.iter().enumerate().map(|(k, line)| width(line, style(k).height));
    let heights = (0..lines.len()).map(|k| style(k).height);
    let between = LEADING * lines.len().saturating_sub(1) as f64;
    Vector::new(widths.fold(0.0, f64::max), heights.sum::<f64>() + between)
}

/// The sheet before any label is on it.
fn board(scene: &Scene<'_>) -> Board {
    let (record, frame) = (scene.record, &scene.frame);
    let outline = |ring: &Ring| {
        let chords = segment::chords(ring, STRAY / frame.scale);
        let points = chords.iter().map(|chord: &Segment| {
            let (x, y) = frame.at(chord.from);
            Point::new(x, y)
        });
        Outline::new(&points.collect::<Vec<_>>())
    };
    let objects = record.map.objects.iter().map(|object| outline(&object.outline)).collect();
    let floor = scene.wall.as_ref().and_then(outline);
    let (low, high) = frame.corners();
    let sheet = Area { low, high };
    Board {
        sheet,
        floor,
        objects,
        taken: vec![layers::start_area(record.settings.start, frame)],
        leaders: Vec::new(),
    }
}

/// All labels with their leaders.
pub(super) fn draw(labels: &Labels, letters: &mut Lettering) -> String {
    let mut out = String::new();
    for (lines, spot) in &labels.placed {
        let area = spot.area;
        if let Some(leader) = spot.leader {
            let (from, to) = (leader.from, leader.to());
            // Writing to a string cannot fail.
            let _ = writeln!(
                out,
                "<path class=\"leader\" d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"{}\" \
                 stroke-width=\"0.8\" fill=\"none\"/>",
                from.x,
                from.y,
                to.x,
                to.y,
                color::OBJECT_EDGE
            );
        }
        if !spot.within {
            // The lines driven do not run through the letters.
            let _ = writeln!(
                out,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"2\" fill=\"{}\"/>",
                area.low.x - 2.0,
                area.low.y - 2.0,
                area.size().x + 4.0,
                area.size().y + 4.0,
                color::FLOOR
            );
        }
        let mut y = area.low.y;
        for (k, line) in lines.iter().enumerate() {
            y += style(k).height;
            out.push_str(&letters.text(line, area.middle().x, y, Anchor::Middle, style(k)));
            y += LEADING;
        }
    }
    out
}
