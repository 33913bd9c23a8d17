//! Reading a record back. A torn tail, as a crash leaves it, is cut off and reported. Damage anywhere else
//! leaves what is before it, for those who only look; to go on from there is refused, because what is behind
//! the damage would be lost. Nothing plays on over a hole: that would tell a story that never was.

use super::{Entry, Header, Life, MAGIC, Record, VERSION, is_unbegun};
use crate::mapping::settings;
use crate::mapping::tape::Tape;
use crate::robot::{Intent, Odometer, SwitchSet, Telemetry};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Letters of the longest name of a world, or of a robot and its port.
const LONGEST_SOURCE: usize = 5000;

/// A record that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// What the run was started with.
    pub header: Header,
    /// What happened, in order.
    pub records: Vec<Record>,
    /// What was cut off the end.
    pub torn: Option<Torn>,
    /// Bytes of the record that hold, from its beginning.
    pub sound: usize,
}

impl Recording {
    /// The life that the robot was in at the end, when that is not the one of the header.
    #[must_use]
    pub fn life(&self) -> Option<Life> {
        self.records.iter().rev().find_map(|record| match record.entry {
            Entry::Life(life) => Some(life),
            _ => None,
        })
    }
}

/// The end of a record that was not written whole, or what follows damage in the middle of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Torn {
    /// Line at which it was cut, from 1.
    pub line: usize,
    /// Lines left out.
    pub lines: usize,
    /// Bytes left out.
    pub bytes: usize,
    /// Whether some of what is left out holds: the record was damaged, not cut off.
    pub damaged: bool,
}

/// Why a record cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// It cannot be opened.
    #[error("the record {}: cannot be read: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// It is something else.
    #[error("{}: not a record of a run of periplus", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// It was written by a newer program.
    #[error("{}: format version {found} is newer than {VERSION}, the newest that this version reads", path.display())]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
    /// Nothing was recorded: the robot never said who it is, or the disk was full.
    #[error("{}: holds nothing: that run never began; name the folder with --out to begin one in it", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// Its header says what no run can be started with.
    #[error("{}:1: the header tells of {why}; no run can be started so, was it changed by hand?", path.display())]
    Senseless {
        /// The file.
        path: PathBuf,
        /// What makes no sense.
        why: String,
    },
    /// A line before the last is damaged.
    #[error("{}:{line}: {why}; {}", path.display(), what_is_left(*.line))]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        why: String,
    },
}

/// What can be had of a record that is damaged in `line`. The first tells what the run was started with.
fn what_is_left(line: usize) -> &'static str {
    if line == 1 {
        "without its header there is nothing to be had of the record"
    } else {
        "`replay`, `snapshot` and `export` show what is whole, up to there"
    }
}

/// Reads the record in a file, or in the file `journal` of a folder, to go on with it.
///
/// # Errors
/// When the file cannot be opened, is no record, or is damaged before its end.
pub fn read(path: &Path) -> Result<Recording, JournalError> {
    open(path).and_then(|(path, bytes)| parse(&path, &bytes))
}

/// Reads as much of the record as is whole, to look at it: of a damaged one what is before the damage.
///
/// # Errors
/// When the file cannot be opened, is no record, or is damaged in its header.
pub fn read_whole_part(path: &Path) -> Result<Recording, JournalError> {
    let (path, bytes) = open(path)?;
    Ok(whole_part(&path, &bytes)?.0)
}

fn open(path: &Path) -> Result<(PathBuf, Vec<u8>), JournalError> {
    let path = if path.is_dir() { path.join("journal") } else { path.to_owned() };
    match std::fs::read(&path) {
        Ok(bytes) => Ok((path, bytes)),
        Err(error) => Err(JournalError::Unreadable { path, reason: error.to_string() }),
    }
}

/// Reads a record that is open, from where it stands; `path` is for complaints only.
///
/// # Errors
/// As [`read`].
pub fn read_open(path: &Path, file: &mut impl Read) -> Result<Recording, JournalError> {
    let mut bytes = Vec::new();
    match file.read_to_end(&mut bytes) {
        Ok(_) => parse(path, &bytes),
        Err(error) => {
            Err(JournalError::Unreadable { path: path.to_owned(), reason: error.to_string() })
        }
    }
}

/// Reads a record from memory; `path` is for complaints only.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Recording, JournalError> {
    let (recording, why) = whole_part(path, bytes)?;
    match recording.torn {
        Some(Torn { line, damaged: true, .. }) => {
            Err(JournalError::Damaged { path: path.to_owned(), line, why })
        }
        _ => Ok(recording),
    }
}

/// What of the record is whole, and what is wrong with the first line that is not.
fn whole_part(path: &Path, bytes: &[u8]) -> Result<(Recording, String), JournalError> {
    if is_unbegun(bytes) {
        return Err(JournalError::Empty { path: path.to_owned() });
    }
    let mut lines = bytes.split_inclusive(|&byte| byte == b'\n');
    let header = header(path, lines.next().unwrap_or_default())?;
    let mut records = Vec::new();
    let mut torn: Option<Torn> = None;
    let mut wrong = String::new();
    for (index, line) in lines.enumerate() {
        if let Some(torn) = &mut torn {
            torn.lines += 1;
            torn.bytes += line.len();
            // A line that holds after one that does not: the damage is not at the end.
            torn.damaged |= unseal(line).is_ok();
            continue;
        }
        match record(line, records.len() as u64) {
            Ok(record) => records.push(record),
            Err(why) => {
                torn = Some(Torn { line: index + 2, lines: 1, bytes: line.len(), damaged: false });
                wrong = why;
            }
        }
    }
    let sound = bytes.len() - torn.map_or(0, |torn| torn.bytes);
    Ok((Recording { header, records, torn, sound }, wrong))
}

fn header(path: &Path, line: &[u8]) -> Result<Header, JournalError> {
    let foreign = || JournalError::Foreign { path: path.to_owned() };
    let text = std::str::from_utf8(line).map_err(|_error| foreign())?;
    let rest = text.strip_prefix(MAGIC).ok_or_else(foreign)?;
    let version = rest.split_whitespace().next().and_then(|word| word.parse().ok());
    match version {
        Some(found) if found > VERSION => {
            return Err(JournalError::Newer { path: path.to_owned(), found });
        }
        Some(_) => {}
        None => return Err(foreign()),
    }
    let damaged = |why: String| JournalError::Damaged { path: path.to_owned(), line: 1, why };
    let text = unseal(line).map_err(damaged)?;
    let payload = text.splitn(3, ' ').nth(2).unwrap_or_default();
    let header: Header =
        serde_json::from_str(payload).map_err(|error| damaged(error.to_string()))?;
    let source = header.source.chars().count();
    let sound = if source > LONGEST_SOURCE {
        Err(format!("a source with a name of {source} letters"))
    } else {
        header.settings.check()
    };
    match sound {
        Ok(()) => Ok(header),
        Err(why) => Err(JournalError::Senseless { path: path.to_owned(), why }),
    }
}

/// The text of a line without its checksum, when the checksum holds.
fn unseal(line: &[u8]) -> Result<&str, String> {
    let line = line.strip_suffix(b"\n").ok_or("the line does not end")?;
    let split = line.len().checked_sub(9).ok_or("the line is too short")?;
    let text = |bytes| std::str::from_utf8(bytes).map_err(|_error| "the line is not text");
    let sum = text(&line[split..])?.strip_prefix(' ').unwrap_or_default();
    let sum = u32::from_str_radix(sum, 16).map_err(|_error| "the line has no checksum")?;
    let body = &line[..split];
    if crc32fast::hash(body) == sum {
        Ok(text(body)?)
    } else {
        Err("the checksum does not match".to_owned())
    }
}

fn record(line: &[u8], expected: u64) -> Result<Record, String> {
    let text = unseal(line)?;
    let mut words = text.splitn(4, ' ');
    let mut word = || words.next().ok_or("the line is too short");
    let (sequence, time, kind, payload) = (word()?, word()?, word()?, word()?);
    if sequence.parse() != Ok(expected) {
        return Err(format!("record {sequence} where record {expected} should be"));
    }
    let time_us = time.parse().map_err(|_error| format!("`{time}` is not a time"))?;
    let entry = entry(kind, payload).map_err(|error| format!("payload: {error}"))?;
    Ok(Record { time_us, entry })
}

fn entry(kind: &str, payload: &str) -> Result<Entry, String> {
    let parsed = match kind {
        "c" => serde_json::from_str(payload).map(Entry::Command),
        "t" => serde_json::from_str(payload).map(Entry::Telemetry),
        "r" => serde_json::from_str(payload).map(|row| Entry::Telemetry(report(row))),
        "i" => return wish(payload).map(Entry::Intent),
        "e" => serde_json::from_str(payload).map(Entry::Event),
        "p" => serde_json::from_str(payload).map(Entry::PhaseEnd),
        "l" => serde_json::from_str(payload).map(Entry::Life),
        other => return Err(format!("unknown kind `{other}`")),
    };
    parsed.map_err(|error| error.to_string())
}

/// A wish of the operator, held against what an operator can wish.
fn wish(payload: &str) -> Result<Intent, String> {
    let intent: Intent = serde_json::from_str(payload).map_err(|error| error.to_string())?;
    match intent {
        Intent::SetAlpha { alpha } => settings::check_alpha(alpha)?,
        Intent::Placed { near: Some(near) } => settings::check_pose(&near)?,
        Intent::SetTape { from, to, length } => {
            Tape { from, to, length }.checked().map_err(|why| why.to_string())?;
        }
        _ => {}
    }
    Ok(intent)
}

fn report(
    (time_us, left_ticks, right_ticks, heading, switches, bumper): (u64, i64, i64, f64, u16, u8),
) -> Telemetry {
    Telemetry::Report {
        odometer: Odometer { time_us, left_ticks, right_ticks, heading },
        switches: SwitchSet(switches),
        bumper: bumper != 0,
    }
}
