//! `map.json`: the map itself in its smallest lossless form (paper IV.1). Arcs stay arcs; the
//! trajectory, the plan's lines and, once there is an outline, the contacts are not part of it. Reads back
//! what it writes.
//!
//! Outlines are lists of `[x, y]` or `[x, y, bulge]` as in world files: metres to a tenth of a
//! millimetre, bulge = tan(sweep / 4) of the arc to the next vertex, positive counter-clockwise.

use super::{RunRecord, boundary, position, rounded, surface_points};
use crate::geometry::{Piece, Point, Ring, angle};
use crate::mapping::map::{ObjectClass, Part, PartClass, Plan, RoomMap, ShapeClass};
use crate::mapping::settings::Strategy;
use serde::{Deserialize, Serialize};

/// The version of the format that this program writes, and the newest that it reads.
pub const VERSION: u32 = 1;

/// A map as it is kept in a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MapFile {
    /// Version of the format.
    pub periplus_map: u32,
    /// What it is called, or where it was made: name of the world or port.
    pub name: String,
    /// α, metres.
    pub alpha: f64,
    /// Gaps narrower than this were taken as closed, metres.
    pub gap: f64,
    /// Start pose: x, y in metres, heading in degrees counter-clockwise from +x.
    pub start: [f64; 3],
    /// Class of the shape, once it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub class: Option<ShapeClass>,
    /// The wall line, counter-clockwise, once the lap is closed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub boundary: Option<Outline>,
    /// Until then the places where something was met, in the order in which it was.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub touched: Vec<[f64; 2]>,
    /// The parts of a complex shape; empty when there is only the whole.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartFile>,
    /// Extrinsic objects.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<ObjectFile>,
    /// The plan's figures, once there is a plan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan: Option<PlanFile>,
    /// How well all this is known, once there is an outline.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub errors: Option<ErrorFile>,
}

/// Standard errors in the map frame, whole millimetres, rounded up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ErrorFile {
    /// Across each piece of the boundary at its middle: in the order of the vertices at which they
    /// begin, an arc that takes two vertices twice; a circle has one.
    pub walls: Vec<u32>,
    /// Of each vertex of the boundary, likewise.
    pub corners: Vec<u32>,
    /// Of each object's place, in their order.
    pub objects: Vec<u32>,
    /// What all of the map has in common of them, and what is left within it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub whole: Option<WholeFile>,
}

/// How surely the map lies in its frame as one piece, and its walls among each other; but for the scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WholeFile {
    /// Of the turn of all, degrees, rounded up.
    pub turn_deg: f64,
    /// Of the displacement of all, whole millimetres, rounded up.
    pub shift: u32,
    /// Of a wall among the others, the median, likewise.
    pub within: u32,
}

/// One part of a complex shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartFile {
    /// What it is.
    pub class: PartClass,
    /// Its outline.
    pub outline: Outline,
    /// Which pieces of the outline are cuts through open floor, by index.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cuts: Vec<usize>,
}

/// One object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ObjectFile {
    /// Its number.
    pub id: u32,
    /// What it looks like; `open` when not all of it was seen.
    pub class: ObjectClass,
    /// Its surface.
    pub outline: Outline,
}

/// What the plan cost and promised.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PlanFile {
    /// Which strategy.
    pub strategy: Strategy,
    /// Lines to be driven.
    pub lines: usize,
    /// Metres to drive.
    pub length: f64,
    /// Diameter of the hidden disc, metres.
    pub hidden_disc: f64,
}

/// A closed outline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Outline {
    /// A full circle.
    Circle {
        /// x and y of the centre and the radius, metres.
        circle: [f64; 3],
    },
    /// Vertices, the last joined to the first.
    Vertices(Vec<Vertex>),
}

/// One vertex and the piece that leads from it to the next.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Vertex {
    /// x, y and the bulge of the arc to the next vertex.
    Arc([f64; 3]),
    /// x and y; the next vertex is reached straight.
    Line([f64; 2]),
}

/// Why a map file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum NativeError {
    /// It is not JSON, or not of this form.
    #[error("line {line}: not a map of periplus: {reason}")]
    Form {
        /// Line, from 1.
        line: usize,
        /// What the parser met.
        reason: String,
    },
    /// It was written by a newer program.
    #[error("format version {found} is newer than {VERSION}, the newest that this version reads")]
    Newer {
        /// The file's version.
        found: u32,
    },
    /// An outline that no robot has gone round.
    #[error("{what} reaches more than 100 km from the origin: the file is damaged")]
    Far {
        /// Whose outline.
        what: String,
    },
}

/// Nothing on a map is farther from its origin in x or y, metres.
const FAR: f64 = 1e5;

impl MapFile {
    /// The map of a run.
    #[must_use]
    pub fn of(record: &RunRecord<'_>) -> Self {
        let map = record.map;
        let start = record.settings.start;
        let shape = map.shape.as_ref();
        let parts = shape.map_or(&[][..], |shape| &shape.parts);
        let boundary = boundary(record);
        Self {
            periplus_map: VERSION,
            name: record.world.to_owned(),
            alpha: record.settings.alpha,
            gap: rounded(record.settings.chassis.passable_gap(), 4),
            start: [
                rounded(start.position.x, 4),
                rounded(start.position.y, 4),
                rounded(start.heading.to_degrees(), 4),
            ],
            class: shape.map(|shape| shape.class),
            touched: match boundary {
                Some(_) => Vec::new(),
                None => surface_points(map).into_iter().map(position).collect(),
            },
            boundary: boundary.as_ref().map(Outline::of),
            parts: if parts.len() > 1 { parts.iter().map(PartFile::of).collect() } else { vec![] },
            objects: map
                .objects
                .iter()
                .map(|object| ObjectFile {
                    id: object.id,
                    class: object.class,
                    outline: Outline::of(&object.outline),
                })
                .collect(),
            plan: map.plan.as_ref().map(PlanFile::of),
            errors: ErrorFile::of(map),
        }
    }

    /// The text of the file, on one line.
    #[must_use]
    pub fn write(&self) -> String {
        // Plain numbers, strings and lists: writing them to memory cannot fail.
        let mut text = serde_json::to_string(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// When the text is no map, or one of a newer version.
    pub fn parse(text: &str) -> Result<Self, NativeError> {
        #[derive(Deserialize)]
        struct Version {
            periplus_map: u32,
        }
        let form = |error: serde_json::Error| NativeError::Form {
            line: error.line(),
            reason: error.to_string(),
        };
        let version: Version = serde_json::from_str(text).map_err(form)?;
        if version.periplus_map > VERSION {
            return Err(NativeError::Newer { found: version.periplus_map });
        }
        let map: Self = serde_json::from_str(text).map_err(form)?;
        map.far().map_or(Ok(map), |what| Err(NativeError::Far { what }))
    }

    /// Whose outline is nowhere near the origin.
    fn far(&self) -> Option<String> {
        let boundary = self.boundary.iter().map(|outline| ("boundary".to_owned(), outline));
        let parts = self.parts.iter().enumerate();
        let parts = parts.map(|(k, part)| (format!("parts[{k}]"), &part.outline));
        let objects = self.objects.iter().enumerate();
        let objects = objects.map(|(k, object)| (format!("objects[{k}]"), &object.outline));
        let mut all = boundary.chain(parts).chain(objects);
        all.find(|(_, outline)| !outline.is_near()).map(|(what, _)| what)
    }
}

impl ErrorFile {
    fn of(map: &RoomMap) -> Option<Self> {
        let (accuracy, shape) = (map.accuracy.as_ref()?, map.shape.as_ref()?);
        // What is no number is not stated as an error of none.
        let mut all = accuracy.walls.iter().chain(&accuracy.corners).chain(&accuracy.objects);
        if !all.all(|sd| sd.is_finite()) {
            return None;
        }
        let mm = |metres: &f64| (metres * 1e3).ceil() as u32;
        let pieces = &shape.outline.pieces;
        let by_vertex = |all: &[f64]| {
            let each = pieces.iter().zip(all);
            each.flat_map(|(piece, sd)| vec![mm(sd); vertices(piece).len()]).collect::<Vec<_>>()
        };
        let whole = matches!(Outline::of(&shape.outline), Outline::Circle { .. });
        let (walls, corners) = if whole {
            (accuracy.walls.iter().map(mm).collect(), Vec::new())
        } else {
            (by_vertex(&accuracy.walls), by_vertex(&accuracy.corners))
        };
        let whole = accuracy.datum.map(|datum| WholeFile {
            turn_deg: (datum.turn.to_degrees() * 100.0).ceil() / 100.0,
            shift: mm(&datum.shift),
            within: mm(&datum.within),
        });
        let objects = accuracy.objects.iter().map(mm).collect();
        Some(Self { walls, corners, objects, whole })
    }
}

impl PartFile {
    fn of(part: &Part) -> Self {
        let outline = Outline::of(&part.ring);
        // A piece that takes two vertices is a wall or a cut at both.
        let by_vertex = part.ring.pieces.iter().zip(&part.cut);
        let by_vertex =
            by_vertex.flat_map(|(piece, &cut)| std::iter::repeat_n(cut, vertices(piece).len()));
        let cuts = by_vertex.enumerate().filter(|&(_, cut)| cut);
        Self { class: part.class, cuts: cuts.map(|(k, _)| k).collect(), outline }
    }
}

impl PlanFile {
    fn of(plan: &Plan) -> Self {
        Self {
            strategy: plan.figures.strategy,
            lines: plan.figures.lines,
            length: rounded(plan.figures.length, 2),
            hidden_disc: rounded(plan.figures.hidden_disc, 4),
        }
    }
}

impl Outline {
    /// The outline of a ring.
    #[must_use]
    pub fn of(ring: &Ring) -> Self {
        if let [Piece::Arc { center, radius, sweep, .. }] = ring.pieces[..]
            && sweep.abs() > angle::TAU - 1e-6
        {
            let circle = [center.x, center.y, radius].map(|value| rounded(value, 4));
            return Self::Circle { circle };
        }
        Self::Vertices(ring.pieces.iter().flat_map(vertices).collect())
    }

    /// Whether all of it is about the origin; bulges can throw an arc far beyond its ends.
    fn is_near(&self) -> bool {
        self.ring().bounds().is_none_or(|(low, high)| {
            [low.x, low.y, high.x, high.y].iter().all(|value| value.abs() <= FAR)
        })
    }

    /// The ring of an outline.
    #[must_use]
    pub fn ring(&self) -> Ring {
        match self {
            Self::Circle { circle: [x, y, radius] } => Ring::circle(Point::new(*x, *y), *radius),
            Self::Vertices(vertices) => {
                let piece = |k: usize| {
                    let (from, bulge) = vertices[k].parts();
                    let (to, _) = vertices[(k + 1) % vertices.len()].parts();
                    Piece::with_bulge(from, to, bulge)
                };
                Ring { pieces: (0..vertices.len()).map(piece).collect() }
            }
        }
    }
}

impl Vertex {
    fn parts(self) -> (Point, f64) {
        match self {
            Self::Arc([x, y, bulge]) => (Point::new(x, y), bulge),
            Self::Line([x, y]) => (Point::new(x, y), 0.0),
        }
    }
}

/// A piece as one vertex, or an arc of more than a half turn as two: its chord would be short,
/// and rounding would move the arc.
fn vertices(piece: &Piece) -> Vec<Vertex> {
    let at = |point: Point| [rounded(point.x, 4), rounded(point.y, 4)];
    match *piece {
        Piece::Line { from, .. } => vec![Vertex::Line(at(from))],
        Piece::Arc { sweep, .. } => {
            let count = if sweep.abs() > angle::PI { 2 } else { 1 };
            let bulge = rounded(angle::tan(sweep / f64::from(count) / 4.0), 6);
            (0..count)
                .map(|k| {
                    let [x, y] = at(piece.at(f64::from(k) / f64::from(count)));
                    Vertex::Arc([x, y, bulge])
                })
                .collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    #[test]
    fn what_is_written_reads_back_the_same() {
        let sample = sample::room();
        let map = MapFile::of(&sample.record());
        let back = MapFile::parse(&map.write()).expect("its own text");
        assert_eq!(map, back);
        let ring = back.boundary.expect("a boundary").ring();
        assert!((ring.area() - sample::outline().area()).abs() < 1e-3, "area {}", ring.area());
    }

    #[test]
    fn an_error_that_is_no_number_is_not_stated_as_none() {
        let mut sample = sample::room();
        assert!(MapFile::of(&sample.record()).errors.is_some());
        let accuracy = sample.map.accuracy.as_mut().expect("stated");
        accuracy.corners[0] = f64::NAN;
        assert_eq!(MapFile::of(&sample.record()).errors, None);
    }

    #[test]
    fn a_long_arc_survives_the_rounding() {
        let keyhole = Ring {
            pieces: vec![
                Piece::Arc { center: Point::new(0.0, 0.0), radius: 2.0, start: 0.1, sweep: 6.0 },
                Piece::Line {
                    from: Point::from(angle::unit(6.1) * 2.0),
                    to: Point::from(angle::unit(0.1) * 2.0),
                },
            ],
        };
        let back = Outline::of(&keyhole).ring();
        assert!((back.area() - keyhole.area()).abs() < 2e-3, "area {}", back.area());
    }

    #[test]
    fn a_cut_is_told_beside_an_arc_that_takes_two_vertices() {
        let (from, to) = (angle::unit(6.1) * 2.0, angle::unit(0.1) * 2.0);
        let ring = Ring {
            pieces: vec![
                Piece::Arc { center: Point::origin(), radius: 2.0, start: 0.1, sweep: 6.0 },
                Piece::Line { from: Point::from(from), to: Point::from(to) },
            ],
        };
        let circle = Some((Point::origin(), 2.0));
        let part = Part { class: PartClass::Circle, ring, cut: vec![false, true], circle };
        let file = PartFile::of(&part);
        let Outline::Vertices(vertices) = &file.outline else { panic!("{file:?}") };
        assert_eq!(vertices.len(), 3, "two for the arc");
        assert_eq!(file.cuts, [2], "where its chord begins");
    }

    #[test]
    fn a_room_of_sixty_vertices_takes_about_a_kilobyte() {
        let mut sample = sample::room();
        let corners: Vec<Point> = (0..60)
            .map(|k| {
                let radius = if k % 2 == 0 { 4.0 } else { 3.1 };
                Point::new(5.0, 5.0) + angle::unit(f64::from(k) * angle::TAU / 60.0) * radius
            })
            .collect();
        sample.map.objects.clear();
        sample.map.shape.as_mut().expect("a shape").outline = Ring::polygon(&corners);
        sample.map.shape.as_mut().expect("a shape").parts.truncate(1);
        let bytes = MapFile::of(&sample.record()).write().len();
        assert!((900..1400).contains(&bytes), "{bytes} bytes");
    }

    #[test]
    fn a_broken_or_newer_file_says_where_or_why() {
        let error = MapFile::parse("{\n\"periplus_map\": }").expect_err("broken");
        assert!(error.to_string().starts_with("line 2: "), "{error}");
        let error = MapFile::parse("{\"periplus_map\": 9}").expect_err("newer");
        assert!(error.to_string().contains("version 9 is newer"), "{error}");
        let head = r#"{"periplus_map":1,"name":"a","alpha":0.25,"gap":0.34,"start":[1,1,0],"#;
        let outlines =
            ["{\"circle\":[1e308,0,1]}", "{\"circle\":[0,0,1e9]}", "[[0,0],[2,0,1e9],[2,2]]"];
        for outline in outlines {
            let text = format!("{head}\"boundary\":{outline}}}");
            let error = MapFile::parse(&text).expect_err("far away").to_string();
            assert!(error.starts_with("boundary reaches"), "{error}");
        }
    }
}
