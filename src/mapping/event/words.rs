//! What happened, in the words of the log, and how much it should stand out.

use super::{EventKind, Failure, Severity};
use crate::mapping::map::{LineReason, ObjectClass, Phase, ShapeClass};
use crate::mapping::tape::Untaped;
use crate::mapping::trust::Defect;
use crate::wording;
use std::fmt;

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::WallLost => "the wall could not be found again",
            Self::LapEndless => "the lap goes on without closing",
            Self::NoBoundary => "no boundary was met in any direction",
            Self::Boxed => "the robot is held on all sides",
            Self::Pocketed => {
                "the robot does not get out again through the gap by which it came into a pocket of the \
                 room: carry it out, close the gap, and begin anew"
            }
            Self::OneSided => "its other side was not met",
            Self::OutlineBroken => {
                "the contacts make no simple closed outline around the robot's way: the lap errs by more \
                 than walls are thick (a calibrated robot errs less: `periplus calibrate`), or the room \
                 is hardly wider than the robot"
            }
            Self::TooManyBumps => "too many bumps in one place",
            Self::WheelsLie => {
                "by its wheels the robot goes in curves where by its gyro it goes straight: see to \
                 the encoders, and to the wheel base of the chassis"
            }
            Self::Unmoved => {
                "one motion after the other ends and the robot is where it was: see whether a wheel is \
                 blocked, whether motors, encoders and gyro work, and whether it can turn by half a degree"
            }
            Self::Contrary => {
                "motions that the robot calls done went the other way by its own count: see to the sign of the \
                 gyro (is it mounted upside down?) and of the encoders"
            }
            Self::AllShut => {
                "every switch says that something is near, however far the robot goes: are they read the other \
                 way round (active low)?"
            }
            Self::BumperStuck => {
                "the bumper says that it is pressed, however far the robot goes from there: see to it"
            }
            Self::SwitchesOut => {
                "hardly a switch is left that can be believed: see to those that the log names"
            }
            Self::Internal => {
                "a mistake in the program: it gave a command that cannot be, or none at all; what is mapped \
                 is kept, and the log says more"
            }
            Self::Ended => "ended by the operator",
        })
    }
}

impl fmt::Display for LineReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AlongBoundary => "runs along the boundary",
            Self::LeavesArea => "leaves the reachable area",
            Self::Duplicate => "is in the plan already",
            Self::NoClearance => "too narrow for the robot",
            Self::Redundant => "a shorter plan does without it",
            Self::CoveredByObjects => "covered by known objects",
            Self::EndOccupied => "an object stands on its end",
            Self::ObjectOnLine => "an object blocks it",
            Self::Unreachable => "no way leads there",
        })
    }
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::StuckClosed => "stays closed wherever the robot goes",
            Self::NeverFires => "never fires where others do",
            Self::Chatters => "opens and closes for no reason",
        })
    }
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Boundary => "boundary",
            Self::Shape => "shape",
            Self::Plan => "plan",
            Self::Objects => "objects",
        })
    }
}

impl fmt::Display for ObjectClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Circle => "circle",
            Self::Rectangle => "box",
            Self::Convex => "convex",
            Self::Concave => "concave",
            Self::Open => "open",
        })
    }
}

impl fmt::Display for ShapeClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Circle => "circle",
            Self::Convex => "convex",
            Self::Concave => "concave",
            Self::Complex => "complex",
        })
    }
}

/// What became of a taped length.
fn tape(f: &mut fmt::Formatter<'_>, kind: &EventKind) -> fmt::Result {
    match kind {
        EventKind::TapeLaid { mapped, taped, stretch } => write!(
            f,
            "taped length: {taped:.3} m, mapped as {mapped:.3} m; the map is stretched by {:+.2} %",
            (stretch - 1.0) * 100.0
        ),
        EventKind::TapeRefused { mapped, taped } => {
            write!(f, "{}", Untaped::Refused { mapped: *mapped, taped: *taped })
        }
        EventKind::TapeNoted { taped } => {
            write!(f, "taped length noted: {taped:.3} m; it counts once the shape is found")
        }
        EventKind::TapeReplaced { taped } => {
            write!(f, "the taped length of {taped:.3} m counts no longer: another one is given")
        }
        EventKind::TapeNowhere => write!(f, "{}", Untaped::Nowhere),
        EventKind::TapeVague => write!(f, "{}", Untaped::Vague),
        _ => Ok(()),
    }
}

/// That the run is over short of its goal.
fn ended(f: &mut fmt::Formatter<'_>, why: Failure) -> fmt::Result {
    match why {
        Failure::Ended => write!(f, "run {why}"),
        _ => write!(f, "run ended: {why}"),
    }
}

/// What the plan comes to.
fn plan(f: &mut fmt::Formatter<'_>, kind: &EventKind) -> fmt::Result {
    let EventKind::PlanMade { lines, length, hidden_disc, over } = kind else { return Ok(()) };
    let disc = hidden_disc * 1e3;
    if let (0, false) = (lines, over) {
        return write!(f, "plan: no line needed, hidden disc {disc:.0} mm already");
    }
    let lines = wording::count(*lines, "line", "lines");
    let more = if *over { ", more than α" } else { "" };
    write!(f, "plan: {lines}, {length:.1} m, hidden disc {disc:.0} mm{more}")
}

/// What is out of reach.
fn out_of_reach(f: &mut fmt::Formatter<'_>, kind: &EventKind) -> fmt::Result {
    match kind {
        EventKind::Unreached { at, width, area } => write!(
            f,
            "a gap of {:.0} mm at ({:.2}, {:.2}) is too narrow: {area:.2} m² not reached",
            width * 1e3,
            at.x,
            at.y
        ),
        EventKind::Strait { at, width, area } => write!(
            f,
            "the map ends at a gap of {:.0} mm at ({:.2}, {:.2}), not passed every time: {area:.2} m² behind it",
            width * 1e3,
            at.x,
            at.y
        ),
        EventKind::Untouched { count: 1, most, .. } => {
            write!(
                f,
                "{:.0} mm of the outline touched by nobody: a narrow gap, or wall",
                most * 1e3
            )
        }
        EventKind::Untouched { count, least, most } => write!(
            f,
            "{count} stretches of {:.0} to {:.0} mm touched by nobody: narrow gaps, or wall",
            least * 1e3,
            most * 1e3
        ),
        EventKind::StillHidden { diameter, at } => write!(
            f,
            "the promise is not kept: {:.0} mm may still hide around ({:.2}, {:.2})",
            diameter * 1e3,
            at.x,
            at.y
        ),
        _ => Ok(()),
    }
}

/// What squaring did.
fn squaring(f: &mut fmt::Formatter<'_>, kind: &EventKind) -> fmt::Result {
    match kind {
        EventKind::MadeSquare { walls, left, turned, moved } => {
            let (turned, moved) = (turned.to_degrees(), moved * 1e3);
            write!(f, "squared: {walls} walls by {turned:.1}°, corners by {moved:.0} mm at most")?;
            if *left > 0 { write!(f, "; {left} stay askew") } else { Ok(()) }
        }
        EventKind::SquareNoted { wanted: true } => {
            f.write_str("to be squared as soon as the shape is known; until then nothing changes")
        }
        EventKind::SquareNoted { wanted: false } => {
            f.write_str("not to be squared when the shape is known")
        }
        EventKind::NothingSquare => f.write_str("nothing to square: no walls at right angles"),
        EventKind::Unsquared => f.write_str("no longer squared: the map is as it was mapped"),
        _ => Ok(()),
    }
}

/// Where a wall is looked for, and what became of the lap round it.
fn laps(f: &mut fmt::Formatter<'_>, kind: &EventKind) -> fmt::Result {
    match kind {
        EventKind::Heading { heading, tried } => {
            // No minus before a zero.
            let (towards, time) = (heading.to_degrees().round() + 0.0, tried + 1);
            write!(f, "looking for a wall towards {towards:.0}° (try {time})")
        }
        EventKind::LapCandidate { off } => write!(f, "lap may be closed, {:.0} mm off", off * 1e3),
        EventKind::LapClosed { length, extrinsic: false } => {
            write!(f, "lap closed after {length:.2} m, gone round from inside, as a boundary is")
        }
        EventKind::LapClosed { length, extrinsic: true } => {
            write!(f, "lap closed after {length:.2} m, gone round from outside, as an object is")
        }
        EventKind::LapAlike { alike } => write!(
            f,
            "its walls are alike all round: it would close {} as well, if the gyro drifted by {:.0}°/h; the \
             least drift is believed: compare a length of the map with a tape",
            alike.where_to(),
            alike.drift.abs().to_degrees() * 3600.0
        ),
        EventKind::LapFailed { why } => write!(f, "lap given up: {why}"),
        EventKind::Pocket { length } => write!(
            f,
            "lap closed after {length:.2} m: a pocket behind a narrow gap, not the room; back out"
        ),
        EventKind::LedBack { width } => write!(
            f,
            "round and round a thing beside the wall: the gap of {:.0} mm that led there counts as closed",
            width * 1e3
        ),
        EventKind::LapsWanted { laps } => {
            write!(f, "{laps} laps in all")
        }
        EventKind::LapAgain { lap } => write!(f, "lap {lap} begins, the other way round"),
        EventKind::LapAveraged { lap, touches, moved } => write!(
            f,
            "lap {lap} averaged in: {touches} touches, corners moved by {:.0} mm at most",
            moved * 1e3
        ),
        EventKind::LapCut { why } => write!(f, "no further lap: {why}; what was touched counts"),
        _ => Ok(()),
    }
}

fn recognised(f: &mut fmt::Formatter<'_>, object: Option<u32>, off: f64) -> fmt::Result {
    let name = object.map_or_else(|| "the boundary".to_owned(), |id| format!("O{id}"));
    write!(f, "this is {name}: the pose was {:.0} mm off, and is put right", off * 1e3)
}

/// What became of a robot that was carried, or has a broken switch.
fn trouble(f: &mut fmt::Formatter<'_>, kind: &EventKind) -> fmt::Result {
    match kind {
        EventKind::Carried => {
            f.write_str("the robot is no longer where it was: its place has to be found again")
        }
        EventKind::Astray { at } => write!(
            f,
            "nothing can be here, where the robot has been or the room ends: it may not be at \
             ({:.2}, {:.2}), and looks for its place",
            at.x, at.y
        ),
        EventKind::TakenBack { lines } => write!(
            f,
            "what was done since its place was last sure does not count; lines driven again: {lines}"
        ),
        EventKind::StillAstray => f.write_str(
            "its place is not to be told from what is here: it goes on where it believes it is",
        ),
        EventKind::BegunAnew { dropped: 0 } => f.write_str("the lap begins anew from here"),
        EventKind::BegunAnew { dropped } => {
            write!(f, "the lap begins anew from here; objects found before are dropped: {dropped}")
        }
        EventKind::PlaceFound { at, driven } => {
            write!(f, "place found after {driven:.1} m: ({:.2}, {:.2})", at.x, at.y)
        }
        EventKind::SwitchDoubted { switch, defect } => {
            write!(f, "switch `{switch}` {defect}: going on without it; see to it")
        }
        EventKind::PlaceNeeded => f.write_str(
            "no boundary is closed yet to know a place by: put the robot down, at the start or \
             elsewhere, and say where, placed=X,Y,DEG; the lap begins anew",
        ),
        EventKind::PlaceUnclear { places: 0 | 1 } => f.write_str(
            "the map shows nothing like what is here where it was looked for: say where the robot is, \
             placed=X,Y,DEG, or placed alone to look everywhere; if it is not near a mapped wall, put it there \
             first",
        ),
        EventKind::PlaceUnclear { places } => write!(
            f,
            "{places} places of the map look like this one: say about where it is, placed=X,Y,DEG"
        ),
        _ => Ok(()),
    }
}

/// What became of an object that was met.
fn objects(f: &mut fmt::Formatter<'_>, kind: &EventKind) -> fmt::Result {
    match kind {
        EventKind::ObjectFound { id, by } => write!(f, "unknown object O{id} met ({by})"),
        EventKind::ObjectClosed { id } => write!(f, "object O{id} closed"),
        EventKind::ObjectHalf { id } => {
            write!(f, "object O{id} passed on one side; the other follows on the way back")
        }
        EventKind::ObjectKnown { id } => {
            write!(f, "object O{id} is one known already")
        }
        EventKind::ObjectApart { id } => {
            write!(f, "object O{id} stands apart, behind a gap too narrow to pass")
        }
        EventKind::TurnedBack { id } => {
            write!(f, "no passage between object O{id} and the boundary: going the other way")
        }
        EventKind::ObjectBehind { id } => {
            write!(f, "object O{id} seen from wall to wall; the gap behind it is too narrow")
        }
        EventKind::ObjectRefuted { id } => {
            write!(f, "object O{id} is not there: it was mapped while the robot was astray")
        }
        EventKind::ObjectOpen { id, why } => write!(f, "object O{id} left open: {why}"),
        _ => Ok(()),
    }
}

/// What the shape was found to be; a circle has no vertices.
fn shape(
    f: &mut fmt::Formatter<'_>,
    class: ShapeClass,
    vertices: usize,
    parts: usize,
) -> fmt::Result {
    write!(f, "shape: {class}")?;
    if vertices > 0 {
        write!(f, ", {vertices} vertices")?;
    }
    if parts == 1 { Ok(()) } else { write!(f, ", {parts} parts") }
}

/// What is measured to know better where the robot and the objects are.
fn fixes(f: &mut fmt::Formatter<'_>, kind: &EventKind) -> fmt::Result {
    let millimetres = |sd: &f64| sd * 1e3;
    match kind {
        EventKind::Fixed { by } => write!(f, "pose corrected by {:.0} mm", millimetres(by)),
        EventKind::Bearings { sd } => {
            write!(
                f,
                "position sure to {:.0} mm only: taking bearings in a corner",
                millimetres(sd)
            )
        }
        EventKind::Tying { id, sd } => {
            let which = if *id > 0 { format!("object O{id}") } else { "an object".to_owned() };
            let sd = millimetres(sd).ceil();
            write!(
                f,
                "{which} is known to {sd:.0} mm only from what it stands beside: measuring that"
            )
        }
        EventKind::GoesOn { diameter } => write!(
            f,
            "by that {:.0} mm may still be hidden: it is driven through as well",
            millimetres(diameter)
        ),
        EventKind::AdjustedWhole { moved, used } => write!(
            f,
            "all adjusted at once, with {used} contacts: the robot had been {:.0} mm off (rms)",
            millimetres(moved)
        ),
        _ => Ok(()),
    }
}

/// Why a robot is sent with the first of two speeds and not the second.
fn slower(
    f: &mut fmt::Formatter<'_>,
    (speed, able): (f64, f64),
    stopping: f64,
    range: f64,
) -> fmt::Result {
    write!(
        f,
        "sent at {speed:.2} m/s, not {able:.2}: from there it would go {:.0} mm until it stands, and its switches \
         see {:.0}",
        1e3 * stopping,
        1e3 * range
    )
}

impl fmt::Display for EventKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PhaseBegan { phase } => write!(f, "{phase} phase begins"),
            Self::PhaseEnded { phase } => write!(f, "{phase} phase done"),
            Self::Slower { speed, able, stopping, range } => {
                slower(f, (*speed, *able), *stopping, *range)
            }
            Self::ContactGained { by } => write!(f, "contact: {by}"),
            Self::ContactLost => f.write_str("wall lost, looking for it"),
            Self::Corner { angle } => write!(f, "corner of {:.0}°", angle.to_degrees()),
            Self::ShapeFound { class, vertices, parts } => shape(f, *class, *vertices, *parts),
            Self::PlanMade { .. } => plan(f, self),
            Self::Strait { .. }
            | Self::Unreached { .. }
            | Self::Untouched { .. }
            | Self::StillHidden { .. } => out_of_reach(f, self),
            Self::MadeSquare { .. }
            | Self::SquareNoted { .. }
            | Self::NothingSquare
            | Self::Unsquared => squaring(f, self),
            Self::Heading { .. }
            | Self::LapCandidate { .. }
            | Self::LapClosed { .. }
            | Self::LapAlike { .. }
            | Self::LapFailed { .. }
            | Self::Pocket { .. }
            | Self::LedBack { .. }
            | Self::LapsWanted { .. }
            | Self::LapAgain { .. }
            | Self::LapAveraged { .. }
            | Self::LapCut { .. } => laps(f, self),
            Self::TapeLaid { .. }
            | Self::TapeRefused { .. }
            | Self::TapeNoted { .. }
            | Self::TapeReplaced { .. }
            | Self::TapeNowhere
            | Self::TapeVague => tape(f, self),
            Self::LineBegan { id, backwards: false } => write!(f, "line L{id} begins"),
            Self::LineBegan { id, backwards: true } => write!(f, "line L{id} begins, from its end"),
            Self::LineDriven { id } => write!(f, "line L{id} driven"),
            Self::LineEnded { id, reason } => write!(f, "line L{id} ended: {reason}"),
            Self::ObjectFound { .. }
            | Self::ObjectClosed { .. }
            | Self::ObjectHalf { .. }
            | Self::ObjectKnown { .. }
            | Self::ObjectApart { .. }
            | Self::TurnedBack { .. }
            | Self::ObjectBehind { .. }
            | Self::ObjectRefuted { .. }
            | Self::ObjectOpen { .. } => objects(f, self),
            Self::Recognised { object, off } => recognised(f, *object, *off),
            Self::Carried
            | Self::Astray { .. }
            | Self::TakenBack { .. }
            | Self::StillAstray
            | Self::BegunAnew { .. }
            | Self::PlaceFound { .. }
            | Self::PlaceNeeded
            | Self::PlaceUnclear { .. }
            | Self::SwitchDoubted { .. } => trouble(f, self),
            Self::Detour { id } => write!(f, "known object O{id}: going round it"),
            Self::NearBoundary => f.write_str("contact near the boundary: carrying on"),
            Self::Fixed { .. }
            | Self::Bearings { .. }
            | Self::Tying { .. }
            | Self::AdjustedWhole { .. }
            | Self::GoesOn { .. } => fixes(f, self),
            Self::Reason { why } | Self::Refused { why } => f.write_str(why),
            Self::Alarm { what } => f.write_str(what),
            Self::Bumped => f.write_str("bumper"),
            Self::Odd { reason } => write!(f, "motion ended early: {reason}"),
            Self::Stopped => f.write_str("stopped: nothing moves until the stop is cleared"),
            Self::StopCleared => f.write_str("stop cleared"),
            Self::AlphaSet { alpha } => write!(f, "α set to {alpha:.2} m"),
            Self::AsFarAsAsked { phase } => {
                write!(f, "the run was to end with the {phase} phase")
            }
            Self::Complete => f.write_str("map complete"),
            Self::Failed { why } => ended(f, *why),
        }
    }
}

impl EventKind {
    /// How much the event should stand out.
    #[must_use]
    pub fn severity(&self) -> Severity {
        match self {
            Self::Reason { .. } | Self::Fixed { .. } | Self::NearBoundary | Self::Corner { .. } => {
                Severity::Detail
            }
            Self::LapAlike { .. }
            | Self::LapFailed { .. }
            | Self::LapCut { .. }
            | Self::Pocket { .. }
            | Self::LedBack { .. }
            | Self::ContactLost
            | Self::LineEnded { .. }
            | Self::ObjectOpen { .. }
            | Self::ObjectKnown { .. }
            | Self::Recognised { .. }
            | Self::StillHidden { .. }
            | Self::Carried
            | Self::Astray { .. }
            | Self::StillAstray
            | Self::PlaceNeeded
            | Self::PlaceUnclear { .. }
            | Self::SwitchDoubted { .. }
            | Self::TapeRefused { .. }
            | Self::TapeNowhere
            | Self::TapeVague
            | Self::PlanMade { over: true, .. }
            | Self::Bumped
            | Self::Odd { .. }
            | Self::Alarm { .. }
            | Self::Refused { .. }
            | Self::Stopped => Severity::Warning,
            Self::Failed { .. } => Severity::Fault,
            _ => Severity::Notice,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_that_does_not_keep_the_promise_says_so() {
        let plan = |lines, hidden_disc, over| {
            let kind = EventKind::PlanMade { lines, length: 215.92, hidden_disc, over };
            (kind.to_string(), kind.severity())
        };
        let (told, severity) = plan(46, 0.0119, true);
        assert_eq!(told, "plan: 46 lines, 215.9 m, hidden disc 12 mm, more than α");
        assert_eq!(severity, Severity::Warning);
        let (told, severity) = plan(46, 0.24, false);
        assert_eq!(told, "plan: 46 lines, 215.9 m, hidden disc 240 mm");
        assert_eq!(severity, Severity::Notice);
        assert_eq!(plan(0, 0.6, false).0, "plan: no line needed, hidden disc 600 mm already");
    }

    /// The same laps are driven to find a place again: then they are no news of the room.
    #[test]
    fn a_lap_says_what_was_gone_round_and_not_what_is_made_of_it() {
        let told = |extrinsic| EventKind::LapClosed { length: 54.76, extrinsic }.to_string();
        assert_eq!(
            told(false),
            "lap closed after 54.76 m, gone round from inside, as a boundary is"
        );
        assert_eq!(
            told(true),
            "lap closed after 54.76 m, gone round from outside, as an object is"
        );
    }

    #[test]
    fn a_place_that_is_not_found_is_asked_for_with_all_there_is_to_try() {
        for places in [0, 1] {
            let told = EventKind::PlaceUnclear { places }.to_string();
            for words in
                ["where it was looked for", "placed=X,Y,DEG", "placed alone", "near a mapped wall"]
            {
                assert!(told.contains(words), "{told}");
            }
        }
    }

    #[test]
    fn plans_of_older_records_are_read() {
        let text = r#"{"event":"plan_made","lines":3,"length":9.5,"hidden_disc":0.2}"#;
        let kind: EventKind = serde_json::from_str(text).expect("an event");
        assert_eq!(kind.to_string(), "plan: 3 lines, 9.5 m, hidden disc 200 mm");
    }
}
