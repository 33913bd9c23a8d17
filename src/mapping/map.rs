//! The map as far as it is known: contacts, outline, shape, plan and objects, as plain data.
//! Every phase adds its part; the screen and the exports read it.

mod promise;

pub use promise::Shortfall;

use super::accuracy::Accuracy;
use super::calibration::Calibration;
use super::settings::Strategy;
use super::square::{Squared, square};
use super::tape::{Taped, Untaped};
use super::trust::Doubted;
use super::unreached::{Beyond, Unreached};
use crate::geometry::measure::{Measure, measure};
use crate::geometry::{Point, Pose, Ring, Vector};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// The four phases, in order (paper III.C to III.F).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Phase {
    /// III.C: find and follow the boundary.
    Boundary,
    /// III.D: what shape it has.
    Shape,
    /// III.E: the path plan.
    Plan,
    /// III.F: drive the plan and map what is met.
    Objects,
}

/// What kind of evidence a contact is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ContactKind {
    /// A switch closed or opened at its known range: the point lies on a surface.
    Range,
    /// A beam slid off the end of something nearer than its range: the point is where the
    /// surface was believed to end, good to a few centimetres along the beam.
    Edge,
    /// The bumper or a stall: the point is the body's rim in the direction of travel.
    Touch,
}

/// One piece of evidence of a surface, in the map frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Where the surface is.
    pub point: Point,
    /// Where the robot's centre was.
    pub from: Point,
    /// Which switch; none for the bumper.
    pub sensor: Option<usize>,
    /// What kind of evidence.
    pub kind: ContactKind,
    /// Robot time, seconds.
    pub time: f64,
}

impl Contact {
    /// Robot time, microseconds.
    #[must_use]
    pub fn time_us(&self) -> u64 {
        (self.time * 1e6).round() as u64
    }
}

/// What odometry was off by when a lap closed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Misclosure {
    /// Metres in x.
    pub dx: f64,
    /// Metres in y.
    pub dy: f64,
    /// Radians.
    pub heading: f64,
    /// Length of the lap, metres.
    pub lap: f64,
}

impl Misclosure {
    /// N of 1:N, the surveyor's ratio of lap length to misclosure; infinite for none.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        let off = crate::geometry::angle::hypot(self.dx, self.dy);
        if off > 0.0 { self.lap / off } else { f64::INFINITY }
    }
}

/// Another end of a lap that all that was driven beyond it fits as well: bays that are alike all round.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Alike {
    /// By how much the lap is longer then, metres by odometer.
    pub longer: f64,
    /// By how much the gyro drifts then, radians per second.
    pub drift: f64,
}

impl Alike {
    /// Where that is along the lap, in words.
    #[must_use]
    pub fn where_to(&self) -> String {
        let later = if self.longer < 0.0 { "sooner" } else { "later" };
        format!("{:.2} m {later}", self.longer.abs())
    }
}

/// The shape of the boundary (paper III.D).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ShapeClass {
    /// No vertices: one circle.
    Circle,
    /// A polygon that always turns the same way.
    Convex,
    /// A polygon that also turns the other way.
    Concave,
    /// Straight and circular pieces together.
    Complex,
}

/// The shape of one part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PartClass {
    /// A convex polygon.
    Convex,
    /// A concave polygon.
    Concave,
    /// A full circle.
    Circle,
    /// Half of a circle, on a cut or wall through the centre (within tolerance).
    Semicircle,
    /// Any other piece of a circle, bounded by one arc and its chord or radii.
    Sector,
}

/// A part of the reachable area that is planned for itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// What it is.
    pub class: PartClass,
    /// Its outline, counter-clockwise.
    pub ring: Ring,
    /// For each piece of `ring`: whether it is a cut through open floor rather than a wall.
    pub cut: Vec<bool>,
    /// The circle, for the circular classes: centre and radius in metres.
    pub circle: Option<(Point, f64)>,
}

/// What the Shape phase found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// What the whole is.
    pub class: ShapeClass,
    /// The wall line: straight and circular pieces, counter-clockwise, closed, simple.
    pub outline: Ring,
    /// The turn points: where the outline turns by more than 1 degree (III.D).
    pub vertices: Vec<Point>,
    /// The parts to plan; one for everything that is not complex.
    pub parts: Vec<Part>,
}

/// How far a line of the plan has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LineStatus {
    /// To be driven.
    Planned,
    /// Being driven.
    Driving,
    /// Driven from end to end.
    Driven,
    /// Something stands on it; driven as far as could be.
    Blocked,
    /// Left out for a stated reason.
    Skipped,
    /// Never part of the plan, kept for the record with its reason (figure 8).
    Rejected,
}

/// Why a line was rejected, blocked or skipped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LineReason {
    /// It runs along the boundary, which was already driven (III.E).
    AlongBoundary,
    /// Part of it leaves the reachable area (III.E, figure 8).
    LeavesArea,
    /// The same line is in the plan already.
    Duplicate,
    /// The robot's body does not fit along it.
    NoClearance,
    /// A shorter plan does without it.
    Redundant,
    /// Known objects already cover all of it.
    CoveredByObjects,
    /// An object stands where it begins or ends.
    EndOccupied,
    /// An object that could not be passed stands on it.
    ObjectOnLine,
    /// No way for the body leads there.
    Unreachable,
}

/// One entry of the path plan: [start vertex, end point, line id, angle] (III.E), with the piece of
/// it that the robot's centre can drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanLine {
    /// Its number, from 1.
    pub id: u32,
    /// Index of the part it belongs to.
    pub part: usize,
    /// Index of the start vertex in the part's outline (for a circle: of the point on it).
    pub vertex: usize,
    /// The start vertex on the wall line.
    pub start: Point,
    /// The end point on the opposite edge.
    pub end: Point,
    /// Angle at the start vertex from the outgoing boundary edge to the line, radians,
    /// anti-clockwise.
    pub angle: f64,
    /// Where the robot's centre begins and ends when it drives the line; none when it cannot.
    pub drive: Option<(Point, Point)>,
    /// How far it has come.
    pub status: LineStatus,
    /// Why, unless planned or driven.
    pub reason: Option<LineReason>,
}

/// What a strategy costs and promises.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PlanFigures {
    /// Which strategy.
    pub strategy: Strategy,
    /// Lines to be driven.
    pub lines: usize,
    /// Their length together with the ways between them, metres.
    pub length: f64,
    /// Diameter of the hidden disc that remains, metres.
    pub hidden_disc: f64,
}

/// What the Plan phase found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// α it was made for, metres.
    pub alpha: f64,
    /// All entries, the rejected ones too.
    pub lines: Vec<PlanLine>,
    /// Ids of the lines to drive, in driving order, and whether each is driven from its end.
    pub order: Vec<(u32, bool)>,
    /// Figures of the chosen strategy.
    pub figures: PlanFigures,
    /// Figures of the other strategies.
    pub alternatives: Vec<PlanFigures>,
}

impl Plan {
    /// The lines that the plan was made of. The others were added later, for what those could not sweep.
    #[must_use]
    pub fn own(&self) -> BTreeSet<u32> {
        self.order.iter().map(|(id, _)| *id).collect()
    }

    /// The lines that were driven beyond the plan as it was made, to keep its promise.
    pub fn added(&self) -> impl Iterator<Item = &PlanLine> {
        let own = self.own();
        let driven = |line: &&PlanLine| line.status == LineStatus::Driven;
        self.lines.iter().filter(driven).filter(move |line| !own.contains(&line.id))
    }
}

/// What an object looks like.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ObjectClass {
    /// A circle.
    Circle,
    /// Four right angles.
    Rectangle,
    /// Any other convex outline.
    Convex,
    /// An outline with a bay.
    Concave,
    /// Not closed yet.
    Open,
}

/// An extrinsic object (III.A).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MappedObject {
    /// Its number, from 1.
    pub id: u32,
    /// What it looks like.
    pub class: ObjectClass,
    /// Its surface, counter-clockwise; where it was not gone round, closed by a chord.
    pub outline: Ring,
    /// Whether all 360 degrees were seen. If not, it is open (its class says so), or hides its back
    /// behind a gap that is too narrow.
    pub closed: bool,
    /// The contacts it was made of.
    pub contacts: Vec<Contact>,
}

impl MappedObject {
    /// When the first and the last of its contacts were made, microseconds of robot time; 0 where there are none. They
    /// lie in the order of its outline.
    #[must_use]
    pub fn seen_us(&self) -> (u64, u64) {
        let times = || self.contacts.iter().map(Contact::time_us);
        (times().min().unwrap_or(0), times().max().unwrap_or(0))
    }

    /// How large it is, in words: its diameter, or the longer and the shorter side of the smallest rectangle
    /// about it. One that was not seen all round is at least as large. None where it has no extent.
    #[must_use]
    pub fn size(&self) -> Option<String> {
        let Measure { width, length, .. } = measure(&self.outline)?;
        let least = if self.closed { "" } else { "≥ " };
        Some(match self.class {
            ObjectClass::Circle => format!("{least}⌀ {:.2} m", f64::midpoint(width, length)),
            _ => format!("{least}{length:.2} × {width:.2} m"),
        })
    }

    /// Moves all of it.
    pub fn displace(&mut self, displacement: impl Fn(Point) -> Vector) {
        self.outline = self.outline.deformed(&displacement);
        for contact in &mut self.contacts {
            contact.point += displacement(contact.point);
            contact.from += displacement(contact.from);
        }
    }
}

/// How far the robot turned since the beginning, by gyro and by wheels, and in what strides it drove.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Spun {
    /// By the gyro, believed drift taken out, radians, whole turns counted.
    pub gyro: f64,
    /// By the wheels, right less left over the wheel base, radians.
    pub wheels: f64,
    /// To and fro by the gyro: all turns added up without their sign, radians.
    pub wound: f64,
    /// The same, each turn to one side squared by itself, square radians.
    pub squares: f64,
    /// Straight drives, each squared by itself, square metres.
    pub strides: f64,
}

/// One place of the trajectory.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PathPoint {
    /// Believed pose in the map frame.
    pub pose: Pose,
    /// Robot time, microseconds.
    pub time_us: u64,
    /// How long the robot had stood still in all, microseconds.
    pub rested_us: u64,
    /// How far gyro and wheels had turned in all.
    pub spun: Spun,
    /// Which phase it belongs to.
    pub phase: Phase,
    /// The robot was carried here: it did not drive from the place before to this one.
    #[serde(default)]
    pub carried: bool,
}

/// The pieces of a trajectory in which the robot drove all the way.
pub fn stretches(path: &[PathPoint]) -> impl Iterator<Item = &[PathPoint]> {
    path.chunk_by(|_, next| !next.carried)
}

/// Whether no number was taken away, and none needs to be written.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands over a reference")]
fn is_zero(number: &u32) -> bool {
    *number == 0
}

impl RoomMap {
    /// Whether the room is one whole circle: nothing of its wall tells a turn about the middle.
    #[must_use]
    pub fn is_round(&self) -> bool {
        self.shape.as_ref().is_some_and(|shape| shape.outline.is_circle())
    }

    /// The number of the next object.
    #[must_use]
    pub fn next_id(&self) -> u32 {
        self.objects.iter().map(|object| object.id).fold(self.taken_away, u32::max) + 1
    }

    /// The map with its nearly right angles right, if it has any.
    #[must_use]
    pub fn squared(mut self) -> Self {
        if let Some(shape) = &mut self.shape
            && let Some((outline, squared)) = square(&shape.outline)
        {
            shape.outline = outline;
            self.squared = Some(squared);
        }
        self
    }
}

/// Everything known so far.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RoomMap {
    /// Every contact that made the boundary, in order along the lap, adjusted.
    pub contacts: Vec<Contact>,
    /// Whether the boundary's lap is closed.
    pub closed: bool,
    /// Misclosure of that lap, before adjusting.
    pub misclosure: Option<Misclosure>,
    /// Where else that lap would have closed as well; the end that leaves the gyro the least drift was taken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alike: Option<Alike>,
    /// The Shape phase's result.
    pub shape: Option<Shape>,
    /// The Plan phase's result.
    pub plan: Option<Plan>,
    /// The extrinsic objects.
    pub objects: Vec<MappedObject>,
    /// Where the robot believes it went, chord error at most 1 mm.
    pub path: Vec<PathPoint>,
    /// Diameter of the hidden disc as driven so far, metres; none before the Plan phase.
    pub hidden_disc: Option<f64>,
    /// Where its centre is.
    pub hidden_at: Option<Point>,
    /// How well it is known, once there is an outline.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<Accuracy>,
    /// Floor that cannot be reached, or may be there, behind gaps too narrow.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unreached: Vec<Unreached>,
    /// Floor behind straits, which the lap went round and which is no part of the shape.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub beyond: Vec<Beyond>,
    /// What the laps have found out about wheels and gyro, once they were driven both ways round.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibration: Option<Calibration>,
    /// How many laps of the boundary it is made of.
    #[serde(default)]
    pub laps: u32,
    /// What squaring changed, if it was asked for; the outline is squared then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub squared: Option<Squared>,
    /// What a taped length made of the map, if one was given and fitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taped: Option<Taped>,
    /// Why the last one that was given made nothing of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub untaped: Option<Untaped>,
    /// The highest number of an object that was taken away again: no other gets it.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub taken_away: u32,
    /// Switches that gave themselves away as broken, and were not listened to from then on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub doubted: Vec<Doubted>,
}
