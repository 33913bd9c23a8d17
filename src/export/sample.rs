//! A hand-made record for tests: a room of 4 by 3 m with one corner cut off by an arc, a column
//! and a box in it, and a short trajectory.

use super::{Outcome, RunRecord};
use crate::geometry::{Piece, Point, Pose, Ring};
use crate::mapping::accuracy::Accuracy;
use crate::mapping::map::{
    Contact, ContactKind, LineReason, LineStatus, MappedObject, Misclosure, ObjectClass, Part,
    PartClass, PathPoint, Phase, Plan, PlanFigures, PlanLine, RoomMap, Shape, ShapeClass, Spun,
};
use crate::mapping::network::Datum;
use crate::mapping::settings::{Settings, Strategy};
use crate::mapping::unreached::Beyond;
use crate::session::snapshot::PhaseProgress;

/// Centre and radius of the sample's column.
pub(crate) const COLUMN: (Point, f64) = (Point::new(1.2, 1.4), 0.2);

/// What a record borrows from.
pub(crate) struct Sample {
    pub(crate) map: RoomMap,
    pub(crate) settings: Settings,
    pub(crate) truth: Vec<Pose>,
}

impl Sample {
    pub(crate) fn record(&self) -> RunRecord<'_> {
        let phase = |seconds, travel, commands| PhaseProgress {
            share: Some(1.0),
            seconds,
            travel,
            commands,
            done: true,
        };
        RunRecord {
            map: &self.map,
            settings: &self.settings,
            outcome: Outcome::Complete,
            reason: "map complete",
            world: "a room with a rounded corner",
            noise: "calibrated",
            progress: [
                phase(120.0, 13.4, 210),
                phase(0.0, 0.0, 0),
                phase(0.0, 0.0, 0),
                phase(310.5, 24.25, 140),
            ],
            laps: 1,
            bumps: 2,
            contact: 0.01,
            true_path: Some(&self.truth),
            wall_seconds: 0.42,
        }
    }
}

/// The outline: 4 by 3 m, the upper right corner rounded with a radius of 1 m.
pub(crate) fn outline() -> Ring {
    let quarter = 0.414_213_562_373_095_03;
    let vertices =
        [(0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (4.0, 2.0, quarter), (3.0, 3.0, 0.0), (0.0, 3.0, 0.0)];
    let piece = |k: usize| {
        let (x, y, bulge) = vertices[k];
        let (to_x, to_y, _) = vertices[(k + 1) % vertices.len()];
        Piece::with_bulge(Point::new(x, y), Point::new(to_x, to_y), bulge)
    };
    Ring { pieces: (0..vertices.len()).map(piece).collect() }
}

/// Floor of 2 by 1.5 m behind a strait of 0.28 m in the wall on the right.
pub(crate) fn beyond() -> Beyond {
    let corners = [(4.0, 0.5), (4.0, 0.2), (6.0, 0.2), (6.0, 1.7), (4.0, 1.7), (4.0, 0.78)];
    let outline = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
    let contacts = outline.pieces[..5].iter().map(|piece| contact(piece.at(0.5))).collect();
    Beyond { outline, contacts }
}

pub(crate) fn room() -> Sample {
    let outline = outline();
    let settings = Settings::new(Pose::new(0.6, 0.6, 1.2));
    let path = path();
    // Truth strays from belief by a few millimetres, as odometry does.
    let truth = path
        .iter()
        .enumerate()
        .map(|(k, point)| {
            let off = 0.0005 * (k % 7) as f64;
            let at = point.pose.position;
            Pose::new(at.x + off, at.y - off, point.pose.heading)
        })
        .collect();
    let map = RoomMap {
        contacts: outline.to_points(0.01).into_iter().map(contact).collect(),
        closed: true,
        misclosure: Some(Misclosure { dx: 0.012, dy: -0.004, heading: 0.003, lap: 12.6 }),
        alike: None,
        shape: Some(shape(outline)),
        plan: Some(plan()),
        objects: objects(),
        path,
        hidden_disc: Some(0.21),
        hidden_at: None,
        accuracy: Some(Accuracy {
            walls: vec![0.004; 5],
            corners: vec![0.0061, 0.0117, 0.0123, 0.0082, 0.0069],
            objects: vec![0.0075; 3],
            datum: Some(Datum { turn: 0.0031, shift: 0.0042, within: 0.0017 }),
        }),
        unreached: Vec::new(),
        beyond: Vec::new(),
        calibration: None,
        laps: 1,
        squared: None,
        taped: None,
        untaped: None,
        taken_away: 0,
        doubted: Vec::new(),
    };
    Sample { map, settings, truth }
}

fn contact(point: Point) -> Contact {
    Contact { point, from: point, sensor: Some(2), kind: ContactKind::Range, time: 1.0 }
}

fn shape(outline: Ring) -> Shape {
    let vertices = outline.pieces.iter().map(Piece::from).collect();
    let cut = vec![false; outline.pieces.len()];
    Shape {
        class: ShapeClass::Complex,
        vertices,
        parts: vec![
            Part { class: PartClass::Convex, ring: outline.clone(), cut, circle: None },
            Part {
                class: PartClass::Sector,
                ring: Ring::polygon(&[
                    Point::new(3.0, 2.0),
                    Point::new(4.0, 2.0),
                    Point::new(3.0, 3.0),
                ]),
                cut: vec![true, false, true],
                circle: Some((Point::new(3.0, 2.0), 1.0)),
            },
        ],
        outline,
    }
}

fn plan() -> Plan {
    let line = |id: u32, from: (f64, f64), to: (f64, f64), angle: f64, status, reason| {
        let (start, end) = (Point::new(from.0, from.1), Point::new(to.0, to.1));
        let ahead = (end - start).normalize();
        let drive =
            (status != LineStatus::Rejected).then_some((start + ahead * 0.15, end - ahead * 0.15));
        PlanLine { id, part: 0, vertex: 0, start, end, angle, drive, status, reason }
    };
    let lines = vec![
        line(1, (0.0, 0.0), (4.0, 0.0), 0.0, LineStatus::Rejected, Some(LineReason::AlongBoundary)),
        line(2, (0.0, 0.0), (4.0, 1.0), 0.245, LineStatus::Driven, None),
        line(3, (0.0, 0.0), (4.0, 2.0), 0.4636, LineStatus::Planned, None),
        line(4, (0.0, 0.0), (2.5, 3.0), 0.876, LineStatus::Blocked, Some(LineReason::ObjectOnLine)),
        line(5, (0.0, 0.0), (1.0, 3.0), 1.249, LineStatus::Skipped, Some(LineReason::Redundant)),
    ];
    let figures =
        |strategy, lines, length, hidden_disc| PlanFigures { strategy, lines, length, hidden_disc };
    Plan {
        alpha: 0.25,
        lines,
        order: vec![(2, false), (3, true), (4, false)],
        figures: figures(Strategy::Lean, 3, 11.2, 0.24),
        alternatives: vec![
            figures(Strategy::Paper, 182, 640.0, 0.04),
            figures(Strategy::Lanes, 8, 38.0, 0.2),
        ],
    }
}

fn objects() -> Vec<MappedObject> {
    let object = |id, class, outline: Ring, closed| MappedObject {
        id,
        class,
        contacts: outline.to_points(0.01).into_iter().map(contact).collect(),
        outline,
        closed,
    };
    let box_corners = [(2.4, 0.7), (3.0, 0.9), (2.9, 1.2), (2.3, 1.0)];
    let corners: Vec<Point> = box_corners.iter().map(|&(x, y)| Point::new(x, y)).collect();
    let half_seen = [(2.0, 2.2), (2.2, 2.4), (2.0, 2.5)];
    let chain: Vec<Point> = half_seen.iter().map(|&(x, y)| Point::new(x, y)).collect();
    vec![
        object(1, ObjectClass::Circle, Ring::circle(COLUMN.0, COLUMN.1), true),
        object(2, ObjectClass::Rectangle, Ring::polygon(&corners), true),
        object(3, ObjectClass::Open, Ring::polygon(&chain), false),
    ]
}

/// Once round the room at 0.15 m from the walls, then along lines 2 and 4.
fn path() -> Vec<PathPoint> {
    let stops = [
        (0.6, 0.6, Phase::Boundary),
        (0.15, 0.15, Phase::Boundary),
        (3.85, 0.15, Phase::Boundary),
        (3.85, 2.0, Phase::Boundary),
        (3.6, 2.6, Phase::Boundary),
        (3.0, 2.85, Phase::Boundary),
        (0.15, 2.85, Phase::Boundary),
        (0.15, 0.15, Phase::Boundary),
        (0.15, 0.15, Phase::Plan),
        (0.15, 0.15, Phase::Objects),
        (3.85, 1.0, Phase::Objects),
        (2.2, 2.75, Phase::Objects),
        (1.6, 1.85, Phase::Objects),
    ];
    let mut points = Vec::new();
    let mut time_us = 0;
    for pair in stops.windows(2) {
        let (from, to) = (Point::new(pair[0].0, pair[0].1), Point::new(pair[1].0, pair[1].1));
        let heading = crate::geometry::angle::of(to - from);
        let steps = (((to - from).norm() / 0.1).ceil() as u32).max(1);
        for k in 0..steps {
            let at = from + (to - from) * (f64::from(k) / f64::from(steps));
            let pose = Pose { position: at, heading };
            let phase = if k == 0 { pair[0].2 } else { pair[1].2 };
            points.push(PathPoint {
                pose,
                time_us,
                rested_us: 0,
                spun: Spun::default(),
                phase,
                carried: false,
            });
            time_us += 500_000;
        }
    }
    points
}
