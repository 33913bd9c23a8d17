//! What happened and why, as the screen, the journal and the tests share it. How it is said is in
//! `words`.

use super::map::{Alike, LineReason, Phase, ShapeClass};
use super::square::Squared;
use super::trust::Defect;
use crate::geometry::Point;
use crate::robot::{Chassis, DoneReason};
use serde::{Deserialize, Serialize};

mod words;

/// One thing worth telling, with the robot's time at which it happened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Robot time, microseconds.
    pub time_us: u64,
    /// What happened.
    pub kind: EventKind,
}

/// How much an event should stand out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Routine detail: why a motion was chosen.
    Detail,
    /// Progress.
    Notice,
    /// Something did not go as it should.
    Warning,
    /// The run cannot go on by itself.
    Fault,
}

/// What happened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "event")]
pub enum EventKind {
    /// A phase began.
    PhaseBegan {
        /// Which.
        phase: Phase,
    },
    /// The robot is sent slower than it can go, because it would not stand in time.
    Slower {
        /// What it is sent with, metres per second.
        speed: f64,
        /// What it can do, metres per second.
        able: f64,
        /// How far it would go from there until it stands, metres.
        stopping: f64,
        /// How far its switches see, metres.
        range: f64,
    },
    /// A phase ended as it should.
    PhaseEnded {
        /// Which.
        phase: Phase,
    },
    /// A new direction to search in, radians.
    Heading {
        /// Direction of the search.
        heading: f64,
        /// How many directions were tried before.
        tried: usize,
    },
    /// The first contact of a lap.
    ContactGained {
        /// Name of the switch, or "bumper".
        by: String,
    },
    /// The wall was lost and is being looked for.
    ContactLost,
    /// A corner was met; positive angles turn left.
    Corner {
        /// Turn of the wall, radians.
        angle: f64,
    },
    /// Position and turning say that a lap may have closed.
    LapCandidate {
        /// Distance from the first contact, metres.
        off: f64,
    },
    /// A lap closed.
    LapClosed {
        /// Length, metres.
        length: f64,
        /// Whether the robot is outside of what it went round.
        extrinsic: bool,
    },
    /// The lap would have closed elsewhere as well; the end that leaves the gyro the least drift was taken.
    LapAlike {
        /// The other end.
        alike: Alike,
    },
    /// A lap was given up.
    LapFailed {
        /// Why.
        why: Failure,
    },
    /// A lap closed in a pocket, which the robot came into by a gap that it would not enter along a
    /// wall.
    Pocket {
        /// Length, metres.
        length: f64,
    },
    /// A lap was led off to a thing beside what it follows, and round that; the gap that led it off is closed to
    /// the robot from here on.
    LedBack {
        /// Width of the gap, metres.
        width: f64,
    },
    /// The operator wants so many laps.
    LapsWanted {
        /// How many in all.
        laps: u32,
    },
    /// The lap is driven again, the other way round.
    LapAgain {
        /// Which lap it is, from 2.
        lap: u32,
    },
    /// A lap more was averaged in.
    LapAveraged {
        /// Which lap it was, from 2.
        lap: u32,
        /// Contacts that were touches of the wall.
        touches: usize,
        /// Largest move of a corner, metres.
        moved: f64,
    },
    /// A further lap was given up; what it touched counts.
    LapCut {
        /// Why.
        why: Failure,
    },
    /// The shape is known.
    ShapeFound {
        /// Its class.
        class: ShapeClass,
        /// How many vertices.
        vertices: usize,
        /// How many parts.
        parts: usize,
    },
    /// All that was read was adjusted at once.
    AdjustedWhole {
        /// How far the robot had been from where it was believed to be, root mean square, metres.
        moved: f64,
        /// Contacts that were of mapped surfaces.
        used: usize,
    },
    /// With all adjusted more is hidden than was believed: the tour goes on.
    GoesOn {
        /// Diameter of the hidden disc, metres.
        diameter: f64,
    },
    /// The map ends at a strait, whatever was felt behind it.
    Strait {
        /// The middle of it.
        at: Point,
        /// How wide it is, metres.
        width: f64,
        /// Floor for the body's centre behind it, square metres.
        area: f64,
    },
    /// There is floor that cannot be reached.
    Unreached {
        /// Where the gap is narrowest.
        at: Point,
        /// How wide it is there, metres.
        width: f64,
        /// Floor for the body's centre behind it, square metres.
        area: f64,
    },
    /// Nobody touched these stretches of the outline: gaps that the robot did not enter, or wall.
    Untouched {
        /// How many there are.
        count: usize,
        /// The narrowest, metres.
        least: f64,
        /// The widest, metres.
        most: f64,
    },
    /// Nearly right angles of the map handed over are right.
    MadeSquare {
        /// Walls along the axes.
        walls: usize,
        /// Straight walls that stay as they were.
        left: usize,
        /// The farthest that a wall was turned, radians.
        turned: f64,
        /// The farthest that a corner was moved, metres.
        moved: f64,
    },
    /// Whether the map is to be squared as soon as there is an outline.
    SquareNoted {
        /// It is.
        wanted: bool,
    },
    /// There are no nearly right angles.
    NothingSquare,
    /// The map is handed over as it was mapped.
    Unsquared,
    /// The map was stretched to a taped length.
    TapeLaid {
        /// The length on the map before, metres.
        mapped: f64,
        /// What the tape said, metres.
        taped: f64,
        /// Real over believed travel of the wheels.
        stretch: f64,
    },
    /// A taped length was given; it counts as soon as there is an outline.
    TapeNoted {
        /// What the tape said, metres.
        taped: f64,
    },
    /// Another length was taped: this one counts no longer.
    TapeReplaced {
        /// What the tape said, metres.
        taped: f64,
    },
    /// A taped length is too far from the mapped one to be the same.
    TapeRefused {
        /// The length on the map, metres.
        mapped: f64,
        /// What the tape said, metres.
        taped: f64,
    },
    /// No wall was mapped near the ends of the tape.
    TapeNowhere,
    /// Where the tape was held is known so badly that it says nothing.
    TapeVague,
    /// The path plan is made.
    PlanMade {
        /// Lines to drive.
        lines: usize,
        /// Metres to drive.
        length: f64,
        /// Hidden disc, metres.
        hidden_disc: f64,
        /// Whether that is more than α: the plan does not keep the promise.
        #[serde(default)]
        over: bool,
    },
    /// A line is begun.
    LineBegan {
        /// Its id.
        id: u32,
        /// Whether it is driven from its end to its vertex.
        backwards: bool,
    },
    /// A line ended as it should.
    LineDriven {
        /// Its id.
        id: u32,
    },
    /// A line ended before its end.
    LineEnded {
        /// Its id.
        id: u32,
        /// Why.
        reason: LineReason,
    },
    /// An unknown object was met.
    ObjectFound {
        /// Its id.
        id: u32,
        /// Name of the switch, or "bumper".
        by: String,
    },
    /// An object is closed.
    ObjectClosed {
        /// Its id.
        id: u32,
    },
    /// One side of an object was passed; the other follows on the way back (two-pass contour).
    ObjectHalf {
        /// The number it will have.
        id: u32,
    },
    /// Something was gone round as part of the wall or of another thing, but only a gap joins it to
    /// that.
    ObjectApart {
        /// Its id.
        id: u32,
    },
    /// What was gone round is on the map already: the pose was off.
    ObjectKnown {
        /// The number it would have had.
        id: u32,
    },
    /// What was met far from any wall is on the map, only elsewhere: the pose was put right.
    Recognised {
        /// The object it is; none for the boundary.
        object: Option<u32>,
        /// By how much the pose was off, metres.
        off: f64,
    },
    /// An object could not be closed.
    ObjectOpen {
        /// Its id.
        id: u32,
        /// Why.
        why: Failure,
    },
    /// A known object was met and is gone round.
    Detour {
        /// Its id.
        id: u32,
    },
    /// A contact near the boundary was passed over (III.F, first case).
    NearBoundary,
    /// The pose was corrected by a touch of a mapped wall.
    Fixed {
        /// By how much, metres.
        by: f64,
    },
    /// The pose had become uncertain: the robot goes to a corner to see where it is.
    Bearings {
        /// One standard deviation of its position beside the walls there, metres.
        sd: f64,
    },
    /// The round has come to the boundary: the object is gone along the other way.
    TurnedBack {
        /// Its id.
        id: u32,
    },
    /// An object was gone along from the boundary to the boundary: what is behind it is too narrow.
    ObjectBehind {
        /// Its id.
        id: u32,
    },
    /// An object is measured from what it stands beside.
    Tying {
        /// Its id; 0 in records of old.
        #[serde(default)]
        id: u32,
        /// One standard deviation of the distance between the two so far, metres.
        sd: f64,
    },
    /// The robot is not where it was believed to be any more: it was carried, or started anew.
    Carried,
    /// What the robot met cannot be where it believes it is: the body has been there, or the room does not
    /// reach that far.
    Astray {
        /// Where it believed it was.
        at: Point,
    },
    /// An object that was mapped while the robot was astray is not there.
    ObjectRefuted {
        /// Its number.
        id: u32,
    },
    /// What was done since the robot's place was last sure does not count.
    TakenBack {
        /// Lines that are driven again.
        lines: usize,
    },
    /// Its place was not found by what is there: it goes on where it believes it is.
    StillAstray,
    /// With no boundary to know the place by, the lap begins anew; this many objects are dropped.
    BegunAnew {
        /// Objects that were found before.
        dropped: usize,
    },
    /// The robot knows again where it is.
    PlaceFound {
        /// Where, map frame.
        at: Point,
        /// Metres driven to find it.
        driven: f64,
    },
    /// It cannot know where it is: no boundary is closed yet.
    PlaceNeeded,
    /// It does not, after all that could be driven.
    PlaceUnclear {
        /// Places of the map that look like this one.
        places: usize,
    },
    /// The tour is over, and more than α may still hide somewhere.
    StillHidden {
        /// Diameter of the largest disc, metres.
        diameter: f64,
        /// Its centre.
        at: Point,
    },
    /// A switch gave itself away as broken: it is not listened to any more.
    SwitchDoubted {
        /// What it is called.
        switch: String,
        /// What is wrong with it.
        defect: Defect,
    },
    /// Why the next motion was chosen.
    Reason {
        /// In words.
        why: String,
    },
    /// A wish of the operator that was not granted.
    Refused {
        /// Why, in words.
        why: String,
    },
    /// The bumper was pressed or the robot stalled.
    Bumped,
    /// Something is wrong with the link or the record.
    Alarm {
        /// What, in words.
        what: String,
    },
    /// A motion ended in a way that was not expected.
    Odd {
        /// How it ended.
        reason: DoneReason,
    },
    /// The operator stopped the robot.
    Stopped,
    /// The operator cleared the stop.
    StopCleared,
    /// α was changed, metres.
    AlphaSet {
        /// Metres.
        alpha: f64,
    },
    /// The phase is done that was to end the run, short of a complete map.
    AsFarAsAsked {
        /// Which phase.
        phase: Phase,
    },
    /// Everything is done.
    Complete,
    /// The run ended short of its goal.
    Failed {
        /// Why.
        why: Failure,
    },
}

/// Why something could not be done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Failure {
    /// The wall could not be found again.
    WallLost,
    /// The lap went on far longer than any room allows without closing.
    LapEndless,
    /// No boundary was met in any direction.
    NoBoundary,
    /// The robot cannot move: it is held on all sides.
    Boxed,
    /// The robot does not get out of a pocket that it came into.
    Pocketed,
    /// Of two sides to be passed one after the other only one was met.
    OneSided,
    /// The contacts make no simple closed outline.
    OutlineBroken,
    /// Too many bumps in one place.
    TooManyBumps,
    /// The two wheels and the gyro contradict each other.
    WheelsLie,
    /// Many motions in a row led nowhere, by wheels and gyro.
    Unmoved,
    /// What the robot calls done went the other way by its own gyro or wheels.
    Contrary,
    /// Every switch stays closed, however far the robot goes.
    AllShut,
    /// The bumper stays pressed, however far the robot backs off.
    BumperStuck,
    /// Hardly a switch is left that can be believed.
    SwitchesOut,
    /// The program gave a command that no robot may be given, or none at all.
    Internal,
    /// The operator ended the run.
    Ended,
}

impl EventKind {
    /// Thing `id` of those that one round went round as one: the first of them closed it.
    #[must_use]
    pub fn gone_round(id: u32, first: bool) -> Self {
        if first { Self::ObjectClosed { id } } else { Self::ObjectApart { id } }
    }

    /// That a robot with this body is sent slower than it can go, if it is by more than a twentieth.
    #[must_use]
    pub fn slower(chassis: &Chassis) -> Option<Self> {
        let Chassis { speed: able, range, .. } = *chassis;
        let speed = chassis.cruise();
        (speed < 0.95 * able).then(|| Self::Slower {
            speed,
            able,
            stopping: chassis.stopping(able),
            range,
        })
    }

    /// What squaring made of the outline: nothing, where no walls are nearly at right angles.
    #[must_use]
    pub fn squared(squared: Option<&Squared>) -> Self {
        squared.map_or(Self::NothingSquare, |&Squared { walls, left, turned, moved, .. }| {
            Self::MadeSquare { walls, left, turned, moved }
        })
    }
}
