//! The folder that a run leaves its results in. Another run's folder is refused, and every file
//! appears whole or not at all.

use crate::export::native::MapFile;
use crate::export::{RunRecord, body, geojson, png, report, svg};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
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
        Self::Unwritable { path: path.to_owned(), reason: error.to_string() }
    }
}

impl OutputFolder {
    /// Refuses a folder that holds another run; touches nothing.
    ///
    /// # Errors
    /// When it does.
    pub fn refuse_taken(path: &Path) -> Result<(), FolderError> {
        match MARKS.into_iter().find(|mark| path.join(mark).exists()) {
            Some(mark) => Err(FolderError::Taken { path: path.to_owned(), mark }),
            None => Ok(()),
        }
    }

    /// Makes the folder if need be, and begins the record in it, which also shows that it can be
    /// written.
    ///
    /// # Errors
    /// When it holds another run or cannot be written.
    pub fn create(path: &Path) -> Result<(Self, File), FolderError> {
        Self::refuse_taken(path)?;
        fs::create_dir_all(path).map_err(|error| FolderError::unwritable(path, &error))?;
        let journal = path.join("journal");
        let file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&journal)
            .map_err(|error| FolderError::unwritable(&journal, &error))?;
        Ok((Self { path: path.to_owned() }, file))
    }

    /// The folder of a run that was interrupted, and its record cut to the `sound` bytes that hold,
    /// to go on with.
    ///
    /// # Errors
    /// When the record cannot be written.
    pub fn reopen(path: &Path, sound: u64) -> Result<(Self, File), FolderError> {
        let journal = path.join("journal");
        let reopened = OpenOptions::new().write(true).open(&journal).and_then(|mut file| {
            file.set_len(sound)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        });
        let file = reopened.map_err(|error| FolderError::unwritable(&journal, &error))?;
        Ok((Self { path: path.to_owned() }, file))
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
        let body = body::write(record).map(|text| ("chassis.toml", text));
        for (name, text) in texts.into_iter().chain(body) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::sample;

    /// An empty folder for one test, under the build's own temporary folder.
    fn place(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("periplus-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        path
    }

    #[test]
    fn a_folder_takes_one_run_and_no_second() {
        let path = place("one-run");
        let (folder, journal) = OutputFolder::create(&path).expect("a new folder");
        drop(journal);
        let failures = folder.write_results(&sample::room().record());
        assert!(failures.is_empty(), "{failures:?}");
        let mut names: Vec<String> = fs::read_dir(&path)
            .expect("the folder")
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        let expected = ["journal", "map.geojson", "map.json", "map.png", "map.svg", "report.json"];
        assert_eq!(names, expected, "all results and nothing half written");
        let size = fs::metadata(path.join("map.json")).expect("map.json").len();
        let report = fs::read_to_string(path.join("report.json")).expect("report.json");
        assert!(report.contains(&format!("\"map_bytes\": {size}")), "the report tells the size");
        let again = OutputFolder::create(&path).expect_err("a second run");
        assert!(again.to_string().contains("holds another run (journal)"), "{again}");
        let _ = fs::remove_dir_all(&path);
    }

    #[test]
    fn one_result_that_fails_does_not_keep_the_others_from_being_written() {
        let path = place("one-fails");
        let (folder, _journal) = OutputFolder::create(&path).expect("a new folder");
        // A folder in the way of a file is refused by every system and for every user.
        fs::create_dir_all(path.join("map.svg/in the way")).expect("an obstacle");
        let failures = folder.write_results(&sample::room().record());
        assert_eq!(failures.len(), 1, "{failures:?}");
        assert!(failures[0].to_string().contains("map.svg: cannot be written"), "{failures:?}");
        for name in ["map.geojson", "map.json", "map.png", "report.json"] {
            assert!(path.join(name).is_file(), "{name} is missing");
        }
        let _ = fs::remove_dir_all(&path);
    }

    #[test]
    fn a_folder_that_cannot_be_made_says_so() {
        let file = place("a-file");
        fs::write(&file, "in the way").expect("a file");
        let error = OutputFolder::create(&file.join("run")).expect_err("a folder in a file");
        assert!(error.to_string().contains("cannot be written"), "{error}");
        let _ = fs::remove_file(&file);
    }
}
