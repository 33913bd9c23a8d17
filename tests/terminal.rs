//! The console on a terminal, from the first frame to the last word: how it is left, and what is kept then.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

use rustix::process::{Pid, Signal, kill_process};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus};

/// A console on a pseudo-terminal, and the terminal's side of it.
struct Console {
    terminal: File,
    child: Child,
}

impl Console {
    fn open(out: &Path) -> Self {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).expect("a pseudo-terminal");
        grantpt(&master).expect("it is ours");
        unlockpt(&master).expect("it opens");
        let size = Winsize { ws_row: 24, ws_col: 80, ws_xpixel: 0, ws_ypixel: 0 };
        tcsetwinsize(&master, size).expect("it has a size");
        let name = ptsname(&master, Vec::new()).expect("it has a name");
        let name = name.into_string().expect("letters");
        let screen = OpenOptions::new().read(true).write(true).open(name).expect("the other side");
        let dup = || screen.try_clone().expect("a handle");
        let child = Command::new(env!("CARGO_BIN_EXE_periplus"))
            .args(["--world", concat!(env!("CARGO_MANIFEST_DIR"), "/sims/rectangle.toml")])
            .args(["--out".as_ref(), out.as_os_str()])
            .env("TERM", "xterm-256color")
            .stdin(dup())
            .stdout(dup())
            .stderr(dup())
            .spawn()
            .expect("the program starts");
        Self { terminal: File::from(master), child }
    }

    /// Reads until the console has drawn something: by then it hears keys and signals.
    fn until_drawn(&mut self) {
        let mut seen = Vec::new();
        let mut bytes = [0; 4096];
        while !String::from_utf8_lossy(&seen).contains("PERIPLUS") {
            let count = self.terminal.read(&mut bytes).expect("the console draws");
            seen.extend_from_slice(&bytes[..count]);
        }
    }

    /// All that it says until it is gone.
    fn end(mut self) -> (String, ExitStatus) {
        let (mut said, mut bytes) = (Vec::new(), [0; 4096]);
        // A terminal that nobody holds any more cannot be read.
        while let Ok(count @ 1..) = self.terminal.read(&mut bytes) {
            said.extend_from_slice(&bytes[..count]);
        }
        let status = self.child.wait().expect("it ends");
        (String::from_utf8_lossy(&said).into_owned(), status)
    }
}

fn reason(out: &Path) -> String {
    let report = std::fs::read_to_string(out.join("report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!(report["outcome"], "stopped");
    report["reason"].as_str().expect("a reason").to_owned()
}

/// What the report says of a console that `leave` left, and how the program ended.
fn left(name: &str, leave: impl FnOnce(&mut Console)) -> (String, Option<i32>) {
    let out = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("left").join(name);
    let _ = std::fs::remove_dir_all(&out);
    let mut console = Console::open(&out);
    console.until_drawn();
    leave(&mut console);
    let (said, status) = console.end();
    assert!(said.contains("recorded in"), "{said}");
    assert!(said.contains("\u{1b}[?1049l"), "the terminal is not as it was: {said}");
    (reason(&out), status.code())
}

#[test]
fn how_the_console_was_left_is_what_the_report_says() {
    let keys = |keys: &'static [u8]| {
        move |console: &mut Console| console.terminal.write_all(keys).expect("keys")
    };
    let (why, status) = left("quit", keys(b"q"));
    assert_eq!((why.as_str(), status), ("left by the operator before it was finished", Some(0)));
    let (why, status) = left("finished", keys(b"Xyq"));
    assert_eq!((why.as_str(), status), ("ended by the operator", Some(0)));
    let (why, status) = left("killed", |console| {
        kill_process(Pid::from_child(&console.child), Signal::TERM).expect("it is heard");
    });
    assert_eq!((why.as_str(), status), ("stopped by the termination signal", Some(128 + 15)));
}
