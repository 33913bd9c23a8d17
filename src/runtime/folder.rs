//! The folder that a run leaves its results in. Another run's folder is refused, and every file
//! appears whole or not at all.

use crate::export::native::MapFile;
use crate::export::{RunRecord, geojson, png, report, svg};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// What marks a folder as holding a run.
const MARKS: [&str; 2] = ["journal", "report.json"];

/// A folder that takes the results of one run.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
}

/// Why results cannot be kept.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// Another run is in there.
    #[error("{}: holds another run ({mark}); name a new folder", path.display())]
    Taken {
        /// The folder.
        path: PathBuf,
        /// The file that gives it away.
        mark: &'static str,
    },
    /// It cannot be made or written.
    #[error("{}: cannot be written: {reason}", path.display())]
    Unwritable {
        /// The folder or file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// A result could not be made.
    #[error("{}: cannot be made: {reason}", path.display())]
    Unmade {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}

impl FolderError {
    fn unwritable(path: &Path, error: &io::Error) -> Self {
        Self::Unwritable {
            path: path.to_owned(),
            reason: error.to_string(),
        }
    }
}

impl OutputFolder {
    /// Makes the folder if need be, and begins the record in it, which also shows that it can be
    /// written.
    ///
    /// # Errors
    /// When it holds another run or cannot be written.
    pub fn create(path: &Path) -> Result<(Self, File), FolderError> {
        if let Some(mark) = MARKS.into_iter().find(|mark| path.join(mark).exists()) {
            return Err(FolderError::Taken {
                path: path.to_owned(),
                mark,
            });
        }
        fs::create_dir_all(path).map_err(|error| FolderError::unwritable(path, &error))?;
        let journal = path.join("journal");
        let file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&journal)
            .map_err(|error| FolderError::unwritable(&journal, &error))?;
        Ok((
            Self {
                path: path.to_owned(),
            },
            file,
        ))
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes every result of the run. One that fails does not keep the others from being
    /// written; what failed is given back.
    #[must_use]
    pub fn write_results(&self, record: &RunRecord<'_>) -> Vec<FolderError> {
        let map = MapFile::of(record).write();
        let drawing = svg::write(record, &svg::Options::default());
        let mut failures = Vec::new();
        let texts = [
            ("map.geojson", geojson::write(record)),
            ("report.json", report::write(record, map.len())),
            ("map.json", map),
        ];
        for (name, text) in texts {
            failures.extend(self.write(name, text.as_bytes()).err());
        }
        failures.extend(self.write("map.svg", drawing.as_bytes()).err());
        let picture = match png::render(&drawing, png::WIDTH) {
            Ok(bytes) => self.write("map.png", &bytes),
            Err(error) => Err(FolderError::Unmade {
                path: self.path.join("map.png"),
                reason: error.to_string(),
            }),
        };
        failures.extend(picture.err());
        failures
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), FolderError> {
        write_whole(&self.path.join(name), bytes)
    }
}

/// Writes a file so that whoever looks sees the old one or the whole new one.
///
/// # Errors
/// When it cannot be written; the old file, if any, is still there then.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), FolderError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let part = path.with_file_name(name);
    let written = File::create(&part)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(&part, path));
    written.map_err(|error| {
        // Half a file helps nobody; that it may be undeletable changes nothing.
        let _ = fs::remove_file(&part);
        FolderError::unwritable(path, &error)
    })
}
