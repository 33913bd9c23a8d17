//! The house rules that a machine can check, see the crate documentation.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::{Path, PathBuf};

/// Lower ranks never import higher ones; equal ranks do not import each other.
const RANKS: &[(&str, u8)] = &[
    ("geometry", 0),
    ("spelling", 0),
    ("wording", 0),
    ("robot", 1),
    ("wire", 2),
    ("mapping", 2),
    ("safety", 2),
    ("simulator", 2),
    ("firmware", 3),
    ("journal", 3),
    ("session", 4),
    ("link", 5),
    ("console", 5),
    ("export", 5),
    ("runtime", 6),
    ("cli", 6),
    ("commands", 7),
];

/// Lines beyond which a file is two files.
const LONGEST: usize = 600;

struct Source {
    path: PathBuf,
    /// Top-level module that it belongs to; none for the crate roots.
    module: Option<String>,
    text: String,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn sources() -> Vec<Source> {
    let mut all = Vec::new();
    collect(&root().join("src"), &mut all);
    all.sort_by(|a, b| a.path.cmp(&b.path));
    assert!(all.len() > 20, "only {} files found: the walk is broken", all.len());
    all
}

fn collect(folder: &Path, all: &mut Vec<Source>) {
    for entry in fs::read_dir(folder).expect("a source folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            collect(&path, all);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let inner = path.strip_prefix(root().join("src")).expect("below src");
            let first = inner.components().next().expect("a name").as_os_str().to_string_lossy();
            let module = first.trim_end_matches(".rs").to_owned();
            let module = (!["lib", "main"].contains(&module.as_str())).then_some(module);
            let text = fs::read_to_string(&path).expect("a source file");
            all.push(Source { path, module, text });
        }
    }
}

fn rank(module: &str) -> Option<u8> {
    RANKS.iter().find(|(name, _)| *name == module).map(|(_, rank)| *rank)
}

/// The text without comments, so that links in documentation are no imports.
fn code(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// The top-level modules that some code names after `crate::`.
fn imports(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + "crate::".len()..];
        let Some(group) = rest.strip_prefix('{') else {
            found.push(word(rest));
            continue;
        };
        let mut depth = 0;
        let mut start = true;
        for (k, letter) in group.char_indices() {
            match letter {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => start = true,
                _ if letter.is_whitespace() => {}
                _ => {
                    if start {
                        found.push(word(&group[k..]));
                    }
                    start = false;
                }
            }
        }
    }
    found
}

fn word(text: &str) -> String {
    text.chars().take_while(|letter| letter.is_alphanumeric() || *letter == '_').collect()
}

#[test]
fn imports_are_found_in_every_form() {
    let code = "use crate::robot::Command;\nuse crate::{\n geometry::{Point, Pose}, mapping };";
    assert_eq!(imports(code), ["robot", "geometry", "mapping"]);
}

#[test]
fn imports_go_one_way() {
    let mut faults = Vec::new();
    let mut seen = 0;
    for source in sources() {
        let Some(module) = &source.module else {
            continue;
        };
        let Some(own) = rank(module) else {
            faults.push(format!("src/{module}: has no rank in tests/tidy.rs"));
            continue;
        };
        for other in imports(&code(&source.text)) {
            seen += 1;
            let allowed = match rank(&other) {
                Some(rank) => other == *module || rank < own,
                // A macro or an item of the crate root.
                None => true,
            };
            if !allowed {
                faults.push(format!("{}: {module} imports {other}", source.path.display()));
            }
        }
    }
    assert!(seen > 50, "only {seen} imports seen: the search is broken");
    assert!(faults.is_empty(), "imports against the ranks:\n{}", faults.join("\n"));
}

#[test]
fn the_core_and_the_simulator_do_not_know_each_other() {
    for source in sources() {
        let other = match source.module.as_deref() {
            Some("mapping") => "simulator",
            Some("simulator") => "mapping",
            _ => continue,
        };
        let named = imports(&code(&source.text)).contains(&other.to_owned());
        assert!(!named, "{} names {other}", source.path.display());
    }
}

#[test]
fn only_the_runtime_reads_a_clock() {
    const CLOCKS: [&str; 5] =
        ["Instant::now", "SystemTime", "thread::sleep", "time::sleep", "time::interval"];
    let mut in_runtime = 0;
    for source in sources() {
        let text = code(&source.text);
        for clock in CLOCKS.into_iter().filter(|clock| text.contains(clock)) {
            if source.module.as_deref() == Some("runtime") {
                in_runtime += 1;
            } else {
                panic!("{}: {clock} outside of runtime/", source.path.display());
            }
        }
    }
    assert!(in_runtime > 0, "not even the runtime reads a clock: the search is broken");
}

#[test]
fn files_are_named_alike_and_short() {
    for source in sources() {
        let shown = source.path.display();
        assert!(!source.path.ends_with("mod.rs"), "{shown}: name it after its module");
        let lines = source.text.lines().count();
        assert!(lines <= LONGEST, "{shown}: {lines} lines; split it");
        assert!(source.text.starts_with("//!"), "{shown}: say first what the file owns");
    }
}
