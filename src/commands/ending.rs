//! What is said last of a run: how it ended, and truthfully what was kept of it.

use super::{CommandError, output};
use crate::runtime::{Ending, OutputFolder};

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

/// Prints the last line of a run.
///
/// # Errors
/// When standard output cannot be written.
pub fn print(ending: &Ending, folder: &OutputFolder, kept: &Kept) -> Result<(), CommandError> {
    let outcome = format!("{:?}", ending.outcome).to_lowercase();
    let folder = folder.path();
    let what = match kept {
        Kept::Whole => format!("results in {}", folder.display()),
        Kept::Part(_) => format!("not all results could be written to {}", folder.display()),
        Kept::Nothing if folder.exists() => format!("{} is as it was", folder.display()),
        Kept::Nothing => "nothing was recorded".to_owned(),
    };
    output::print(&format!("{outcome}: {}; {what}\n", ending.reason))
}
