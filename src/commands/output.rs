//! Results go to standard output, talk to standard error. A reader that has gone away is no
//! reason to panic.

use super::CommandError;
use std::io::{self, ErrorKind, Write};

/// Writes a result to standard output.
///
/// # Errors
/// [`CommandError::ReaderGone`] when nobody reads any more.
pub fn print(text: &str) -> Result<(), CommandError> {
    print_bytes(text.as_bytes())
}

/// Writes a result that is no text to standard output.
///
/// # Errors
/// As [`print()`].
pub fn print_bytes(bytes: &[u8]) -> Result<(), CommandError> {
    printed(io::stdout().lock().write_all(bytes))
}

/// Writes what is said of something that was done: done it is, whether or not anybody reads of it.
///
/// # Errors
/// As [`print()`], but that nobody reads is none.
pub fn tell(text: &str) -> Result<(), CommandError> {
    match print(text) {
        Err(CommandError::ReaderGone) => Ok(()),
        said => said,
    }
}

/// Sees to it that what was `written` to standard output is there.
///
/// # Errors
/// As [`print()`].
pub fn printed(written: io::Result<()>) -> Result<(), CommandError> {
    match written.and_then(|()| io::stdout().lock().flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Err(CommandError::ReaderGone),
        Err(source) => Err(CommandError::System { what: "standard output", source }),
    }
}

/// Says something on standard error; that nobody listens is not an error.
pub fn say(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", harmless(text));
}

/// The text without anything that could steer a terminal: it may quote a file of anybody's.
#[must_use]
pub fn harmless(text: &str) -> String {
    text.chars().map(|c| if c.is_control() && c != '\n' { '?' } else { c }).collect()
}
