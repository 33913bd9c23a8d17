//! Why a command could not be done, and the exit status that tells of it.

use crate::cli::ArgumentError;
use crate::journal::JournalError;
use crate::runtime::FolderError;
use std::io;
use std::path::PathBuf;

/// Why a command could not be done.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// Something is wrong with the arguments or with a settings file.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// Results cannot be kept where they should be.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// A record cannot be read.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// A world or keymap is wrong; the message names file, line and key.
    #[error("{0}")]
    Input(String),
    /// The console was asked for where there is no terminal.
    #[error(
        "the console needs a terminal; without one use `periplus run --world FILE --out DIR` to \
         map, or `periplus snapshot` for one frame"
    )]
    NoTerminal,
    /// Whoever read standard output has gone; there is nobody to tell.
    #[error("standard output was closed")]
    ReaderGone,
    /// The record of a run cannot be begun.
    #[error("{}: cannot be written: {source}; is there room on the disk?", path.display())]
    Unrecorded {
        /// The record.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The system refused something.
    #[error("{what}: {source}")]
    System {
        /// What was being done.
        what: &'static str,
        /// What the system said.
        source: io::Error,
    },
}

impl CommandError {
    /// Exit status: 2 for bad arguments or input, 1 for what the system refused.
    #[must_use]
    pub fn status(&self) -> u8 {
        match self {
            Self::System { .. }
            | Self::Unrecorded { .. }
            | Self::Folder(FolderError::Full { .. }) => 1,
            Self::ReaderGone => 0,
            _ => 2,
        }
    }
}
