//! What the operator chooses before a run.

use super::tape::Tape;
use crate::geometry::{Point, Pose};
use crate::robot::Chassis;
use serde::{Deserialize, Serialize};

/// How the path plan is made (paper III.E).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Strategy {
    /// Every vertex to every opposite edge at α: the paper to the letter.
    Paper,
    /// The fewest of the paper's own lines that leave no larger hidden disc than α.
    #[default]
    Lean,
    /// Parallel lanes.
    Lanes,
}

/// How an object met on a line is gone round (paper III.F).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Contour {
    /// Past it on one side, then the same line the other way with the object on the same side.
    TwoPass,
    /// One full round at first contact.
    #[default]
    FullLoop,
}

/// The least α of any record, metres; what can be chosen begins higher.
const LEAST_ALPHA: f64 = 0.01;
/// The least and greatest α that a person may ask for, metres.
pub const ALPHA: (f64, f64) = (0.05, 2.0);
/// Letters of the longest name of a map.
pub const LONGEST_NAME: usize = 200;
/// Nobody goes round more often.
pub const MOST_LAPS: u32 = 9;
/// Nothing is farther from the origin in x or y, metres.
const FAR: f64 = 1e5;
/// A heading is a few turns at most, radians.
const MOST_HEADING: f64 = 100.0;

fn one() -> u32 {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the form serde asks for")]
fn is_one(laps: &u32) -> bool {
    *laps == 1
}

/// Everything that shapes a run besides what the robot meets, and what its map is called.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// α: the accuracy factor, metres.
    pub alpha: f64,
    /// How the path plan is made.
    pub strategy: Strategy,
    /// How objects are gone round.
    pub contour: Contour,
    /// Seeds the random directions of the search and the first diameter of a circle's plan.
    pub seed: u64,
    /// Where the robot stands at the beginning, in the map frame.
    pub start: Pose,
    /// How often the robot goes round the boundary, once at least; each lap after the first is averaged in.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub laps: u32,
    /// Nearly right angles of the map are handed over right.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub square: bool,
    /// A length measured by tape, which the map is stretched to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tape: Option<Tape>,
    /// What the map is called; none for the name of the world or of the port.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The robot's body.
    pub chassis: Chassis,
}

impl Settings {
    /// The design's defaults for a robot that starts at `start`.
    #[must_use]
    pub fn new(start: Pose) -> Self {
        Self {
            alpha: 0.25,
            strategy: Strategy::default(),
            contour: Contour::default(),
            seed: 1,
            start,
            laps: 1,
            square: false,
            tape: None,
            name: None,
            chassis: Chassis::default(),
        }
    }

    /// Whether a run can have been started with this.
    ///
    /// # Errors
    /// Says which of it makes no sense.
    pub fn check(&self) -> Result<(), String> {
        check_alpha(self.alpha)?;
        check_pose(&self.start).map_err(|why| format!("a `start` that is none: {why}"))?;
        if !(1..=MOST_LAPS).contains(&self.laps) {
            return Err(format!("{} `laps`", self.laps));
        }
        if let Some(Err(why)) = self.tape.map(Tape::checked) {
            return Err(format!("a `tape` that is none: {why}"));
        }
        if let Some(Err(why)) = self.name.as_deref().map(check_name) {
            return Err(format!("a `name` that is none: {why}"));
        }
        self.chassis.check().map_err(|why| format!("a `chassis` that no robot has: {why}"))
    }
}

/// Whether a plan can be made with this α, metres.
///
/// # Errors
/// Says that it cannot.
pub fn check_alpha(alpha: f64) -> Result<(), String> {
    let can = (LEAST_ALPHA..=FAR).contains(&alpha);
    if can { Ok(()) } else { Err(format!("`alpha` of {alpha} m")) }
}

/// Whether a map can be called that.
///
/// # Errors
/// Says that it cannot.
pub fn check_name(name: &str) -> Result<(), String> {
    if name.chars().any(char::is_control) {
        return Err("a name has no control characters in it".to_owned());
    }
    match name.chars().count() {
        count if count > LONGEST_NAME => {
            Err(format!("{count} letters; a name has {LONGEST_NAME} at most"))
        }
        _ => Ok(()),
    }
}

/// Whether a robot can stand there.
///
/// # Errors
/// Says that it cannot.
pub fn check_pose(pose: &Pose) -> Result<(), String> {
    let Pose { position: Point { coords: at }, heading } = pose;
    let near = at.x.abs() <= FAR && at.y.abs() <= FAR && heading.abs() <= MOST_HEADING;
    if near { Ok(()) } else { Err("a place beyond 100 km, or a heading of many turns".to_owned()) }
}
