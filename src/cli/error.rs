//! What is wrong with the arguments, in one message each; all of it ends with exit status 2.

use std::path::PathBuf;

/// Why the arguments cannot be followed.
#[derive(Debug, thiserror::Error)]
pub enum ArgumentError {
    /// A flag that the command cannot do without.
    #[error("`periplus {command}` needs {flag}")]
    Missing {
        /// The command.
        command: &'static str,
        /// The flag with its value.
        flag: &'static str,
    },
    /// A flag that means nothing without another one.
    #[error("{flag} is for a run that is taken up again: it needs {needs}")]
    Alone {
        /// The flag.
        flag: &'static str,
        /// The other one with its value.
        needs: &'static str,
    },
    /// α does not fit the room.
    #[error(
        "α of {alpha} m is larger than the room ({width:.2} x {height:.2} m): \
         give --alpha a length below {limit:.2}"
    )]
    AlphaTooLarge {
        /// α, metres.
        alpha: f64,
        /// Extent of the room in x, metres.
        width: f64,
        /// Extent of the room in y, metres.
        height: f64,
        /// The larger of the two.
        limit: f64,
    },
    /// A settings file that cannot be opened.
    #[error("{what} {}: cannot be read: {reason}", path.display())]
    Unreadable {
        /// What it was to be.
        what: &'static str,
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// A settings file whose values do not go together.
    #[error("{}: {problem}", path.display())]
    Whole {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// A settings file with something wrong in it.
    #[error("{}:{line}: {problem}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The key, and what is wrong.
        problem: String,
    },
}
