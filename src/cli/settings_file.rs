//! Strict TOML tables of plain settings: every complaint names file, line and key, and an unknown
//! key names the nearest known one. Knows no particular key.

use super::ArgumentError;
use crate::spelling::{plainly, unknown_key};
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The text of a settings file.
#[derive(Debug)]
pub struct SettingsFile {
    path: PathBuf,
    text: String,
}

/// One `key = value` of a settings file.
#[derive(Debug, Clone)]
pub struct Entry<'t> {
    /// The key.
    pub key: String,
    /// The value.
    pub value: &'t DeValue<'t>,
    /// Line of the key, from 1.
    pub line: usize,
}

impl SettingsFile {
    /// Reads the text of the file; `what` it is to be is for the complaint.
    ///
    /// # Errors
    /// When it cannot be opened or is not text.
    pub fn open(path: &Path, what: &'static str) -> Result<Self, ArgumentError> {
        match std::fs::read_to_string(path) {
            Ok(mut text) => {
                // Some editors put a mark of the byte order before everything else.
                if text.starts_with('\u{feff}') {
                    text.remove(0);
                }
                Ok(Self { path: path.to_owned(), text })
            }
            Err(error) => {
                let (path, reason) = (path.to_owned(), error.to_string());
                Err(ArgumentError::Unreadable { what, path, reason })
            }
        }
    }

    /// Whether there is nothing in it, not even a remark.
    pub fn is_blank(&self) -> bool {
        self.text.trim().is_empty()
    }

    /// The file's table.
    ///
    /// # Errors
    /// When the text is not TOML.
    pub fn table(&self) -> Result<Spanned<DeTable<'_>>, ArgumentError> {
        DeTable::parse(&self.text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            self.problem(self.line(at), plainly(error.message()))
        })
    }

    /// The entries of a table, in file order.
    pub fn entries<'t>(&self, table: &'t DeTable<'t>) -> Vec<Entry<'t>> {
        let mut entries: Vec<Entry<'t>> = table
            .iter()
            .map(|(key, value)| Entry {
                key: key.get_ref().to_string(),
                value: value.get_ref(),
                line: self.line(key.span().start),
            })
            .collect();
        entries.sort_by_key(|entry| entry.line);
        entries
    }

    /// The complaint about an unknown key.
    pub fn unknown(&self, entry: &Entry<'_>, known: &[&str]) -> ArgumentError {
        self.problem(entry.line, &unknown_key(&entry.key, known))
    }

    /// The complaint about values that do not go together.
    pub fn whole(&self, why: &str) -> ArgumentError {
        ArgumentError::Whole { path: self.path.clone(), problem: why.to_owned() }
    }

    /// The complaint about the value of a key.
    pub fn bad(&self, entry: &Entry<'_>, why: &str) -> ArgumentError {
        self.problem(entry.line, &format!("`{}`: {why}", entry.key))
    }

    /// File, line and key of an entry, for complaints that come later.
    pub fn place(&self, entry: &Entry<'_>) -> String {
        format!("{}:{}: `{}`", self.path.display(), entry.line, entry.key)
    }

    /// A path that the file names, which is relative to the file's folder.
    pub fn beside(&self, named: &str) -> PathBuf {
        self.path.parent().map_or_else(|| PathBuf::from(named), |folder| folder.join(named))
    }

    fn problem(&self, line: usize, problem: &str) -> ArgumentError {
        ArgumentError::InFile { path: self.path.clone(), line, problem: problem.to_owned() }
    }

    fn line(&self, at: usize) -> usize {
        self.text.bytes().take(at).filter(|&byte| byte == b'\n').count() + 1
    }
}

impl Entry<'_> {
    /// The value in the words that a flag would take: a list of numbers becomes `1,2,3`.
    ///
    /// # Errors
    /// When the value is a table or a date.
    pub fn words(&self) -> Result<String, String> {
        words(self.value)
    }

    /// The value as a finite number.
    ///
    /// # Errors
    /// When it is none.
    pub fn number(&self) -> Result<f64, String> {
        match self.value {
            DeValue::Integer(_) | DeValue::Float(_) => {
                let text = words(self.value)?;
                let value =
                    text.parse::<f64>().map_err(|_error| format!("`{text}` is not a number"))?;
                if value.is_finite() {
                    Ok(value)
                } else {
                    Err(format!("`{text}` is not a finite number"))
                }
            }
            other => Err(format!("expected a number, found a {}", kind(other))),
        }
    }
}

/// What a value is, for complaints.
#[must_use]
pub fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "string",
        DeValue::Integer(_) | DeValue::Float(_) => "number",
        DeValue::Boolean(_) => "truth value",
        DeValue::Datetime(_) => "date",
        DeValue::Array(_) => "list",
        DeValue::Table(_) => "table",
    }
}

fn words(value: &DeValue<'_>) -> Result<String, String> {
    match value {
        DeValue::String(text) => Ok(text.to_string()),
        DeValue::Integer(number) => Ok(number.as_str().replace('_', "")),
        DeValue::Float(number) => Ok(number.as_str().replace('_', "")),
        DeValue::Boolean(yes) => Ok(yes.to_string()),
        DeValue::Array(items) => {
            let parts: Result<Vec<String>, String> =
                items.iter().map(|item| words(item.get_ref())).collect();
            Ok(parts?.join(","))
        }
        other => Err(format!("a {} does not fit here", kind(other))),
    }
}
