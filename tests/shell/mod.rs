//! The program as a shell runs it.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

pub(crate) fn periplus(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_periplus"))
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .expect("the program starts")
}

/// An empty folder for one test.
pub(crate) fn place(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).expect("a folder for the test");
    path
}

/// Asserts that the program refuses with status 2 and one message that has all of `words` in it.
pub(crate) fn refused(arguments: &[&str], words: &[&str]) {
    let output = periplus(arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?} ended otherwise: {message}");
    assert!(!message.contains("panicked"), "{arguments:?} panicked: {message}");
    for word in words {
        assert!(message.contains(word), "{arguments:?}: no `{word}` in: {message}");
    }
}
