//! The folder that a run leaves its results in. Another run's folder is refused, and every file
//! appears whole or not at all.

use crate::export::native::MapFile;
use crate::export::{RunRecord, body, geojson, png, report, svg};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// What marks a folder as holding a run.
pub const MARKS: [&str; 2] = ["journal", "report.json"];

/// Every file that a run may leave.
pub const RESULTS: [&str; 7] =
    ["journal", "report.json", "map.geojson", "map.json", "map.svg", "map.png", "chassis.toml"];

/// Bytes of the longest header of a record.
const LONGEST_HEADER: u64 = 1 << 20;

/// A folder that takes the results of one run.
#[derive(Debug, Clone)]
pub struct OutputFolder {
    path: PathBuf,
    /// It was not there before.
    made: bool,
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
    /// One of our files is in there, of which nobody knows whence.
    #[error("{}: holds a `{name}`, which a run would write over; name a new folder", path.display())]
    InTheWay {
        /// The folder.
        path: PathBuf,
        /// The file.
        name: &'static str,
    },
    /// A run is going on in there.
    #[error("{}: another program is recording a run there; end that one first, or name a new folder", path.display())]
    Busy {
        /// The folder.
        path: PathBuf,
    },
    /// There is something else.
    #[error("{}: is no folder; name a new one", path.display())]
    NoFolder {
        /// What is there.
        path: PathBuf,
    },
    /// It cannot be made or written.
    #[error("{}: cannot be written: {reason}", path.display())]
    Unwritable {
        /// The folder or file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// There is no room for it: another name would not help.
    #[error("{}: cannot be written: {reason}; is there room on the disk?", path.display())]
    Full {
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
        let (path, reason) = (path.to_owned(), error.to_string());
        match error.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
                Self::Full { path, reason }
            }
            _ => Self::Unwritable { path, reason },
        }
    }
}

impl OutputFolder {
    /// Refuses a folder that holds another run; touches nothing.
    ///
    /// # Errors
    /// When it does.
    pub fn refuse_taken(path: &Path) -> Result<(), FolderError> {
        let there = |name: &&str| path.join(name).exists() && !is_unbegun(&path.join(name));
        match RESULTS.into_iter().find(there) {
            Some(mark) if MARKS.contains(&mark) => {
                Err(FolderError::Taken { path: path.to_owned(), mark })
            }
            Some(name) => Err(FolderError::InTheWay { path: path.to_owned(), name }),
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
        if path.exists() && !path.is_dir() {
            return Err(FolderError::NoFolder { path: path.to_owned() });
        }
        let made = !path.exists();
        fs::create_dir_all(path).map_err(|error| FolderError::unwritable(path, &error))?;
        let journal = path.join("journal");
        let unwritable = |error: io::Error| FolderError::unwritable(&journal, &error);
        // What a run that never began left behind is written over, but not one that begins just now.
        let mut options = OpenOptions::new();
        let file = options.write(true).create(true).truncate(false).open(&journal);
        let file = file.map_err(unwritable)?;
        only_writer(path, &file)?;
        Self::refuse_taken(path)?;
        file.set_len(0).map_err(unwritable)?;
        Ok((Self { path: path.to_owned(), made }, file))
    }

    /// The folder of a run that was interrupted, and its record, to be read and gone on with: from now on
    /// nobody else writes to it, so what is read of it is all that there will be.
    ///
    /// # Errors
    /// When another program has it in hand, or it cannot be written.
    pub fn reopen(path: &Path) -> Result<(Self, File), FolderError> {
        let journal = path.join("journal");
        let file = OpenOptions::new().read(true).write(true).open(&journal);
        let file = file.map_err(|error| FolderError::unwritable(&journal, &error))?;
        only_writer(path, &file)?;
        Ok((Self { path: path.to_owned(), made: false }, file))
    }

    /// Cuts the record that was [reopened](Self::reopen) to the `sound` bytes that hold; what is written next
    /// goes on from there.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn cut(&self, journal: &mut File, sound: u64) -> Result<(), FolderError> {
        let cut = journal.set_len(sound).and_then(|()| journal.seek(SeekFrom::End(0)));
        cut.map(drop).map_err(|error| FolderError::unwritable(&self.journal(), &error))
    }

    /// Clears away what a run left that never began: the folder is free for another try.
    pub fn discard_unbegun(&self) {
        let journal = self.journal();
        if is_unbegun(&journal) {
            // Should it stay, it is no obstacle either.
            let _ = fs::remove_file(journal);
            if self.made {
                let _ = fs::remove_dir(&self.path);
            }
        }
    }

    /// All that could not be written, the `record` of the run among it, in one message; none when
    /// nothing failed.
    #[must_use]
    pub fn complaint(&self, record: io::Result<()>, failures: &[FolderError]) -> Option<String> {
        let mut names = Vec::new();
        let mut reasons = Vec::new();
        if let Err(error) = record {
            names.push("the record of the run".to_owned());
            reasons.push(error.to_string());
        }
        for failure in failures {
            let (path, reason) = match failure {
                FolderError::Unwritable { path, reason }
                | FolderError::Full { path, reason }
                | FolderError::Unmade { path, reason } => (path, reason.clone()),
                other => (&self.path, other.to_string()),
            };
            names.push(path.file_name().unwrap_or_default().to_string_lossy().into_owned());
            if !reasons.contains(&reason) {
                reasons.push(reason);
            }
        }
        (!names.is_empty()).then(|| {
            let (names, reasons) = (names.join(", "), reasons.join("; "));
            let folder = self.path.display();
            let advice = if !self.path.exists() {
                "the folder is no longer there"
            } else if !self.journal().exists() {
                "its record is no longer there"
            } else {
                "is there room on the disk?"
            };
            format!("{folder}: not written whole: {names} ({reasons}); {advice}")
        })
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its record.
    #[must_use]
    pub fn journal(&self) -> PathBuf {
        self.path.join("journal")
    }

    /// Writes every result of the run. One that fails does not keep the others from being
    /// written; what failed is given back.
    #[must_use]
    pub fn write_results(&self, record: &RunRecord<'_>) -> Vec<FolderError> {
        // Should somebody have removed the folder meanwhile, the map is not lost for that; what else is wrong with
        // it, writing tells.
        let _ = fs::create_dir_all(&self.path);
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

/// The folder that somebody named where no shell reads along: `~` is the home folder, and the answer is
/// whole, so that what is told of it can be found.
///
/// # Errors
/// In words, when it is nobody's home, or there is no telling where it is.
pub fn named(dir: &Path) -> Result<PathBuf, String> {
    under(dir, std::env::var_os("HOME").map(PathBuf::from))
}

fn under(dir: &Path, home: Option<PathBuf>) -> Result<PathBuf, String> {
    let refused = |why: &str| Err(format!("{}: {why}", dir.display()));
    let dir = match (dir.strip_prefix("~"), home) {
        (Ok(rest), Some(home)) => home.join(rest),
        (Ok(_), None) => return refused("nobody knows where the home folder is"),
        (Err(_), _) if dir.to_string_lossy().starts_with('~') => {
            return refused("name the folder of another user in full");
        }
        (Err(_), _) => dir.to_owned(),
    };
    std::path::absolute(&dir).map_err(|error| format!("{}: {error}", dir.display()))
}

/// Whether the record at `path` is one of a run that never began.
fn is_unbegun(path: &Path) -> bool {
    let name = path.file_name().is_some_and(|name| name == "journal");
    let short = fs::metadata(path).is_ok_and(|data| data.is_file() && data.len() < LONGEST_HEADER);
    name && short && fs::read(path).is_ok_and(|bytes| crate::journal::is_unbegun(&bytes))
}

/// Refuses a record that another program has in hand.
fn only_writer(path: &Path, journal: &File) -> Result<(), FolderError> {
    match journal.try_lock() {
        Err(TryLockError::WouldBlock) => Err(FolderError::Busy { path: path.to_owned() }),
        // Where files cannot be locked it is left to the operator.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(()),
    }
}

/// Whether there is something at `path` that is no file: a device, a pipe, a socket. It is written to,
/// never replaced.
#[must_use]
pub fn is_device(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|data| !data.is_file() && !data.is_dir())
}

/// Writes a file so that whoever looks sees the old one or the whole new one. What is no file takes the
/// bytes as they come; a link stays, and what it leads to is written.
///
/// # Errors
/// When it cannot be written; the old file, if any, is still there then.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), FolderError> {
    // What the system opens under such a name is no place in a folder.
    let opened = ["/dev/fd", "/dev/stderr", "/proc"].iter().any(|top| path.starts_with(top));
    if opened || is_device(path) {
        let mut options = OpenOptions::new();
        let written = options.write(true).open(path).and_then(|mut file| file.write_all(bytes));
        return written.map_err(|error| FolderError::unwritable(path, &error));
    }
    let leads_to = fs::canonicalize(path);
    let path = leads_to.as_deref().unwrap_or(path);
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
    fn a_folder_that_was_removed_meanwhile_costs_no_map() {
        let path = place("removed");
        let (folder, journal) = OutputFolder::create(&path).expect("a new folder");
        fs::remove_dir_all(&path).expect("removed");
        drop(journal);
        let failures = folder.write_results(&sample::room().record());
        assert!(failures.is_empty(), "{failures:?}");
        assert!(path.join("map.json").is_file());
        let gone = Err(io::Error::other("somebody removed it"));
        let told = folder.complaint(gone, &failures).expect("the record is lost");
        assert!(told.contains("its record is no longer there"), "{told}");
        let _ = fs::remove_dir_all(&path);
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
        assert!(again.to_string().contains("holds another run (report.json)"), "{again}");
        fs::remove_file(path.join("report.json")).expect("a report");
        let again = OutputFolder::create(&path).expect_err("results");
        assert!(again.to_string().contains("holds a `map.geojson`"), "{again}");
        fs::write(path.join("journal"), "periplus-journal 1 {}\n").expect("a record");
        let again = OutputFolder::create(&path).expect_err("a record");
        assert!(again.to_string().contains("holds another run (journal)"), "{again}");
        let _ = fs::remove_dir_all(&path);
    }

    #[test]
    fn one_result_that_fails_does_not_keep_the_others_from_being_written() {
        for fails in ["map.svg", "report.json", "map.geojson", "map.png"] {
            let path = place("one-fails");
            let (folder, _journal) = OutputFolder::create(&path).expect("a new folder");
            // A folder in the way of a file is refused by every system and for every user.
            fs::create_dir_all(path.join(fails).join("in the way")).expect("an obstacle");
            let failures = folder.write_results(&sample::room().record());
            assert_eq!(failures.len(), 1, "{failures:?}");
            let told = failures[0].to_string();
            assert!(told.contains(&format!("{fails}: cannot be written")), "{told}");
            let names = ["map.geojson", "map.json", "map.svg", "map.png", "report.json"];
            for name in names.into_iter().filter(|name| *name != fails) {
                assert!(path.join(name).is_file(), "{name} is missing");
                assert!(!path.join(format!("{fails}.part")).exists(), "half of it is left");
            }
            let _ = fs::remove_dir_all(&path);
        }
    }

    #[test]
    fn a_run_that_never_began_leaves_its_folder_free() {
        let path = place("unbegun");
        for left in ["", "periplus-jour", "periplus-journal 1 {\"settings\":{"] {
            fs::create_dir_all(&path).expect("a folder");
            fs::write(path.join("journal"), left).expect("a remnant");
            let (folder, file) = OutputFolder::create(&path).expect("a free folder");
            assert_eq!(file.metadata().expect("a file").len(), 0, "`{left}` is left in it");
            let busy = OutputFolder::create(&path).expect_err("two at once").to_string();
            assert!(busy.contains("another program"), "{busy}");
            drop(file);
            folder.discard_unbegun();
            let within = fs::read_dir(&path).expect("somebody's folder is kept").count();
            assert_eq!(within, 0, "`{left}`: something is left in it");
        }
        fs::remove_dir(&path).expect("an empty folder");
        let (folder, file) = OutputFolder::create(&path).expect("a folder of its own");
        drop(file);
        folder.discard_unbegun();
        assert!(!path.exists(), "the folder is still there");
        fs::create_dir_all(&path).expect("a folder");
        fs::write(path.join("journal"), "my diary").expect("a file");
        assert!(OutputFolder::create(&path).is_err(), "somebody's file was taken");
        let _ = fs::remove_dir_all(&path);
    }

    #[test]
    fn a_record_that_is_gone_on_with_is_nobody_elses_before_it_is_read() {
        use std::io::Read;
        let path = place("taken-up");
        fs::create_dir_all(&path).expect("a folder");
        let record = path.join("journal");
        fs::write(&record, "one\n").expect("a record");
        let (_, mut first) = OutputFolder::reopen(&path).expect("nobody has it");
        let busy = OutputFolder::reopen(&path).expect_err("two writers");
        assert!(matches!(busy, FolderError::Busy { .. }), "{busy}");
        let mut text = String::new();
        first.read_to_string(&mut text).expect("text");
        first.write_all(b"two\nthr").expect("room");
        drop(first);
        let (folder, mut second) = OutputFolder::reopen(&path).expect("the other has ended");
        text.clear();
        second.read_to_string(&mut text).expect("text");
        assert_eq!(text, "one\ntwo\nthr", "what the other wrote last is there");
        folder.cut(&mut second, 8).expect("it is cut");
        second.write_all(b"three\n").expect("room");
        assert_eq!(fs::read_to_string(&record).expect("text"), "one\ntwo\nthree\n");
        let _ = fs::remove_dir_all(&path);
    }

    #[test]
    fn a_folder_named_in_the_console_is_where_a_shell_would_put_it() {
        let home = || Some(PathBuf::from("/home/ada"));
        let of = |name: &str| under(Path::new(name), home());
        assert_eq!(of("~/map"), Ok(PathBuf::from("/home/ada/map")));
        assert_eq!(of("/tmp/~/map"), Ok(PathBuf::from("/tmp/~/map")));
        assert!(of("map").is_ok_and(|dir| dir.is_absolute() && dir.ends_with("map")));
        assert!(of("~bob/map").is_err(), "a folder called ~bob is not what was meant");
        assert!(under(Path::new("~/map"), None).is_err());
    }

    #[test]
    fn a_full_disk_is_one_message() {
        let folder = OutputFolder { path: PathBuf::from("out"), made: false };
        assert_eq!(folder.complaint(Ok(()), &[]), None);
        let full = || io::Error::other("no room");
        let failed = ["map.svg", "map.png"]
            .map(|name| FolderError::unwritable(&Path::new("out").join(name), &full()));
        let told = folder.complaint(Err(full()), &failed).expect("a complaint");
        assert_eq!(told.matches("no room").count(), 1, "{told}");
        for word in ["the record", "map.svg", "map.png", "out:"] {
            assert!(told.contains(word), "{told}");
        }
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
