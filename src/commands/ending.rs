//! What is said last of a run: how it ended, and truthfully what was kept of it.

use super::{CommandError, output};
use crate::export::RunRecord;
use crate::mapping::event::EventKind;
use crate::mapping::unreached;
use crate::runtime::{Ending, OutputFolder};
use crate::wording::ended;

/// What is told on standard output when a run is over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Told {
    /// How it ended.
    Ending,
    /// Before that, what it measured of the robot.
    Measured,
}

/// Laps both ways round, for what they tell of the robot.
pub const BOTH_WAYS: u32 = 2;

/// What was kept of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Kept {
    /// All of it.
    Whole,
    /// Not all of it, and why.
    Part(String),
    /// There was nothing to keep: the robot never said who it is.
    Nothing,
}

impl Kept {
    /// All of it, unless there is a complaint.
    pub fn unless(complaint: Option<String>) -> Self {
        complaint.map_or(Self::Whole, Self::Part)
    }

    /// The exit status of a run that would have ended with `status`; what was not kept is told.
    pub fn status(&self, status: u8) -> u8 {
        match self {
            Self::Whole => status,
            Self::Part(why) => {
                output::say(&format!("periplus: {why}"));
                status.max(1)
            }
            Self::Nothing => status.max(1),
        }
    }
}

/// Prints the `figures` that a calibration was driven for, and where they are kept; gives the exit status, 1
/// when there are none.
///
/// # Errors
/// When standard output cannot be written.
pub fn print_measured(figures: Option<String>, folder: &OutputFolder) -> Result<u8, CommandError> {
    let Some(figures) = figures else {
        let why = "nothing was measured of the robot: it takes a lap each way round";
        output::say(&format!("periplus: {why}; see the log in the record"));
        return Ok(1);
    };
    output::tell(&figures)?;
    let chassis = folder.path().join("chassis.toml");
    if chassis.exists() {
        let what = "put its figures into the robot (--chassis is for the simulated one)";
        output::tell(&format!("body written to {}: {what}\n", chassis.display()))?;
    }
    Ok(0)
}

/// Prints what squaring made of the map that is handed over, where it was asked for and there is an outline.
///
/// # Errors
/// When standard output cannot be written.
pub fn print_squared(record: &RunRecord<'_>) -> Result<(), CommandError> {
    if !record.settings.square || record.map.shape.is_none() {
        return Ok(());
    }
    let told = EventKind::squared(record.map.squared.as_ref());
    output::tell(&format!("{told}\n"))
}

/// Prints what the robot did not get to, where it drove all it had to.
///
/// # Errors
/// When standard output cannot be written.
pub fn print_unreached(record: &RunRecord<'_>) -> Result<(), CommandError> {
    for told in unreached::told(&record.map.unreached) {
        output::tell(&format!("{told}\n"))?;
    }
    Ok(())
}

/// Prints the last line of a run.
///
/// # Errors
/// When standard output cannot be written.
pub fn print(ending: &Ending, folder: &OutputFolder, kept: &Kept) -> Result<(), CommandError> {
    let told = told(ending);
    let folder = folder.path();
    let what = match kept {
        Kept::Whole => format!("results in {}", folder.display()),
        Kept::Part(_) => format!("not all results could be written to {}", folder.display()),
        Kept::Nothing if folder.exists() => format!("{} is as it was", folder.display()),
        Kept::Nothing => "nothing was recorded".to_owned(),
    };
    output::tell(&format!("{told}; {what}\n"))
}

/// How a run ended and why.
fn told(ending: &Ending) -> String {
    ended(&format!("{:?}", ending.outcome).to_lowercase(), &ending.reason)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::Outcome;

    #[test]
    fn how_a_run_ended_is_said_once() {
        let ending = |outcome, reason: &str| told(&Ending { outcome, reason: reason.to_owned() });
        assert_eq!(ending(Outcome::Stopped, "stopped by interrupt"), "stopped by interrupt");
        assert_eq!(
            ending(Outcome::Complete, "all four phases done"),
            "complete: all four phases done"
        );
    }
}
