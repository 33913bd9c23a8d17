//! Which key asks for which action: a strict TOML file, the built-in one or the operator's own.
//! Owns parsing and look-up; what keys and actions are is said in their own files.

use super::action::{ACTIONS, Action};
use super::key::Key;
use crate::spelling::nearest;
use std::ops::Range;
use thiserror::Error;

/// The keymap that is built in.
pub const DEFAULT: &str = include_str!("../../keymaps/default.toml");

/// What is wrong with a keymap, and where. Lines count from 1.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum KeymapError {
    /// The file is not TOML.
    #[error("{file}:{line}: not a keymap: {what}")]
    Syntax {
        /// Name of the file.
        file: String,
        /// Line.
        line: usize,
        /// What the parser says.
        what: String,
    },
    /// A table or key that keymaps do not have.
    #[error("{file}:{line}: a keymap has no `{name}`; it holds one table, [keys]")]
    UnknownTable {
        /// Name of the file.
        file: String,
        /// Line.
        line: usize,
        /// What was found.
        name: String,
    },
    /// An action that does not exist.
    #[error("{file}:{line}: there is no action `{name}`{}", suggestion(.meant.as_deref()))]
    UnknownAction {
        /// Name of the file.
        file: String,
        /// Line.
        line: usize,
        /// What was found.
        name: String,
        /// The action most likely meant.
        meant: Option<String>,
    },
    /// A value that is neither a key nor a list of keys.
    #[error("{file}:{line}: `{name}` must be a list of keys, such as [\"space\"]")]
    NotKeys {
        /// Name of the file.
        file: String,
        /// Line.
        line: usize,
        /// The action.
        name: String,
    },
    /// A key that does not exist.
    #[error(
        "{file}:{line}: `{key}` for `{name}` is not a key: write one character (for shift the \
             one it makes), or a name such as space, left, pageup, f1, with ctrl- or alt- before either and shift- \
             before a name"
    )]
    UnknownKey {
        /// Name of the file.
        file: String,
        /// Line.
        line: usize,
        /// The action.
        name: String,
        /// What was found.
        key: String,
    },
    /// A key that no terminal sends, or not as itself.
    #[error(
        "{file}:{line}: `{key}` for `{name}` is a key that no terminal sends: it comes as {comes}"
    )]
    Unsent {
        /// Name of the file.
        file: String,
        /// Line.
        line: usize,
        /// The action.
        name: String,
        /// What was found.
        key: String,
        /// What comes instead.
        comes: String,
    },
    /// One key for two actions.
    #[error(
        "{file}:{line}: the key `{key}` is given to `{name}` and, on line {first_line}, to \
             `{first}`"
    )]
    Duplicate {
        /// Name of the file.
        file: String,
        /// Line.
        line: usize,
        /// The key.
        key: String,
        /// The action that came second.
        name: String,
        /// The action that came first.
        first: String,
        /// Its line.
        first_line: usize,
    },
    /// An action that nobody may be without has no key.
    #[error("{file}: no key for `{name}`; add a line such as {name} = [\"{usual}\"]")]
    Missing {
        /// Name of the file.
        file: String,
        /// The action.
        name: &'static str,
        /// The key it has by default.
        usual: String,
    },
}

fn suggestion(meant: Option<&str>) -> String {
    meant.map_or_else(
        || "; `?` in the console lists them all".to_owned(),
        |name| format!("; did you mean `{name}`?"),
    )
}

/// Which key asks for which action.
#[derive(Debug, Clone, PartialEq)]
pub struct Keymap {
    /// In the order of the file.
    bindings: Vec<(Key, Action)>,
}

impl Default for Keymap {
    fn default() -> Self {
        // A test holds that the built-in file is good.
        Self::parse(DEFAULT, "keymaps/default.toml").unwrap_or(Self { bindings: Vec::new() })
    }
}

impl Keymap {
    /// Reads a keymap; `file` is what the messages call it.
    ///
    /// # Errors
    /// The first thing that is wrong, with its line.
    pub fn parse(text: &str, file: &str) -> Result<Self, KeymapError> {
        Reader { text, file, seen: Vec::new() }.read()
    }

    /// What `key` asks for. Where nothing is said of Ctrl-C, it stops the robot.
    #[must_use]
    pub fn action(&self, key: Key) -> Option<Action> {
        let bound = self.bindings.iter().find(|(bound, _)| *bound == key);
        let usual = || key.is_ctrl_c().then_some(Action::Stop);
        bound.map(|&(_, action)| action).or_else(usual)
    }

    /// The keys that ask for `action`, in the order of the file.
    pub fn keys(&self, action: Action) -> impl Iterator<Item = Key> {
        self.bindings.iter().filter(move |(_, bound)| *bound == action).map(|&(key, _)| key)
    }

    /// The first key that asks for `action`, as shown on screen; empty when it has none.
    #[must_use]
    pub fn label(&self, action: Action) -> String {
        self.keys(action).next().map(Key::label).unwrap_or_default()
    }
}

impl Keymap {
    /// The keys that ask for `action`, as shown on screen: the first, and of the others as many as fit in so many
    /// columns.
    #[must_use]
    pub fn labels(&self, action: Action, columns: usize) -> String {
        let mut shown = self.label(action);
        for key in self.keys(action).skip(1).map(Key::label) {
            if shown.chars().count() + 1 + key.chars().count() <= columns {
                shown = format!("{shown} {key}");
            }
        }
        shown
    }

    /// How the operator comes to `action`: by its first key, or else by its name on the command line.
    #[must_use]
    pub fn way(&self, action: Action) -> String {
        let (key, line) = (self.label(action), self.label(Action::CommandLine));
        if key.is_empty() && !line.is_empty() {
            format!("{line}{}", action.info().name)
        } else if key.is_empty() {
            format!("(no key for {})", action.info().name)
        } else {
            key
        }
    }

    /// The actions that this keymap leaves without a way to them: no key, and none for the command line.
    #[must_use]
    pub fn out_of_reach(&self) -> Vec<&'static str> {
        if self.keys(Action::CommandLine).next().is_some() {
            return Vec::new();
        }
        let without = ACTIONS.iter().filter(|info| self.keys(info.action).next().is_none());
        without.map(|info| info.name).collect()
    }
}

struct Reader<'a> {
    text: &'a str,
    file: &'a str,
    /// Every key so far, its action and its line.
    seen: Vec<(Key, &'static str, usize)>,
}

type Spanned<T> = toml::Spanned<T>;

impl Reader<'_> {
    fn read(mut self) -> Result<Keymap, KeymapError> {
        let root = toml::de::DeTable::parse(self.text).map_err(|error| KeymapError::Syntax {
            file: self.file.to_owned(),
            line: self.line(error.span().unwrap_or(0..0)),
            what: error.message().to_owned(),
        })?;
        let mut bindings = Vec::new();
        for (name, value) in in_file_order(root.get_ref()) {
            let Some(table) = value.get_ref().as_table().filter(|_| name.get_ref() == "keys")
            else {
                return Err(KeymapError::UnknownTable {
                    file: self.file.to_owned(),
                    line: self.line(name.span()),
                    name: name.get_ref().to_string(),
                });
            };
            for (name, value) in in_file_order(table) {
                self.read_action(name.get_ref(), name.span(), value, &mut bindings)?;
            }
        }
        for action in [Action::Stop, Action::Quit] {
            if !bindings.iter().any(|&(_, bound)| bound == action) {
                return Err(KeymapError::Missing {
                    file: self.file.to_owned(),
                    name: action.info().name,
                    usual: if action == Action::Stop { "space" } else { "q" }.to_owned(),
                });
            }
        }
        Ok(Keymap { bindings })
    }

    fn read_action(
        &mut self,
        name: &str,
        at: Range<usize>,
        value: &Spanned<toml::de::DeValue<'_>>,
        bindings: &mut Vec<(Key, Action)>,
    ) -> Result<(), KeymapError> {
        let Some(action) = Action::named(name) else {
            return Err(KeymapError::UnknownAction {
                file: self.file.to_owned(),
                line: self.line(at),
                name: name.to_owned(),
                meant: nearest(name, ACTIONS.iter().map(|info| info.name)).map(str::to_owned),
            });
        };
        let not_keys = |span: Range<usize>| KeymapError::NotKeys {
            file: self.file.to_owned(),
            line: self.line(span),
            name: name.to_owned(),
        };
        let keys: Vec<(String, Range<usize>)> = match value.get_ref() {
            toml::de::DeValue::String(key) => vec![(key.to_string(), value.span())],
            toml::de::DeValue::Array(keys) => keys
                .iter()
                .map(|key| match key.get_ref() {
                    toml::de::DeValue::String(text) => Ok((text.to_string(), key.span())),
                    _ => Err(not_keys(key.span())),
                })
                .collect::<Result<_, _>>()?,
            _ => return Err(not_keys(value.span())),
        };
        for (key, span) in keys {
            let key = self.read_key(action, &key, span)?;
            bindings.push((key, action));
        }
        Ok(())
    }

    fn read_key(
        &mut self,
        action: Action,
        text: &str,
        at: Range<usize>,
    ) -> Result<Key, KeymapError> {
        let (file, line, name) = (self.file.to_owned(), self.line(at), action.info().name);
        let Some(key) = Key::parse(text) else {
            return Err(KeymapError::UnknownKey {
                file,
                line,
                name: name.to_owned(),
                key: text.to_owned(),
            });
        };
        if let Some(comes) = key.comes_as() {
            let (name, key) = (name.to_owned(), text.to_owned());
            return Err(KeymapError::Unsent { file, line, name, key, comes });
        }
        if let Some(&(_, first, first_line)) = self.seen.iter().find(|(seen, ..)| *seen == key) {
            return Err(KeymapError::Duplicate {
                file,
                line,
                key: text.to_owned(),
                name: name.to_owned(),
                first: first.to_owned(),
                first_line,
            });
        }
        self.seen.push((key, name, line));
        Ok(key)
    }

    fn line(&self, span: Range<usize>) -> usize {
        1 + self.text.bytes().take(span.start).filter(|&byte| byte == b'\n').count()
    }
}

/// The entries as they stand in the file, so that of two wrongs the first is told.
fn in_file_order<'t, 'i>(
    table: &'t toml::de::DeTable<'i>,
) -> Vec<(&'t Spanned<toml::de::DeString<'i>>, &'t Spanned<toml::de::DeValue<'i>>)> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(name, _)| name.span().start);
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        match Keymap::parse(text, "my.toml") {
            Ok(_) => "it was accepted".to_owned(),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn the_built_in_keymap_is_good_and_reaches_every_action() {
        let keymap = Keymap::parse(DEFAULT, "default").unwrap();
        for info in ACTIONS {
            assert!(keymap.keys(info.action).next().is_some(), "no key for {}", info.name);
        }
    }

    #[test]
    fn the_fixed_keys_do_what_they_must() {
        let keymap = Keymap::default();
        for (key, action) in [
            ("space", Action::Stop),
            ("c", Action::ClearStop),
            ("r", Action::RunPause),
            ("n", Action::StepCommand),
            ("e", Action::StepEvent),
            ("p", Action::StepPhase),
            ("[", Action::AlphaDown),
            ("]", Action::AlphaUp),
            ("<", Action::SlowDown),
            (">", Action::SpeedUp),
            ("+", Action::ZoomIn),
            ("-", Action::ZoomOut),
            ("left", Action::PanLeft),
            ("right", Action::PanRight),
            ("up", Action::PanUp),
            ("down", Action::PanDown),
            ("h", Action::PanLeft),
            ("j", Action::PanDown),
            ("k", Action::PanUp),
            ("l", Action::PanRight),
            ("f", Action::Follow),
            ("0", Action::Fit),
            ("?", Action::Help),
            (":", Action::CommandLine),
            ("q", Action::Quit),
        ] {
            assert_eq!(keymap.action(Key::parse(key).unwrap()), Some(action), "key {key}");
        }
    }

    #[test]
    fn a_key_that_comes_as_another_is_refused_with_that_one() {
        for (key, comes) in [
            ("ctrl-m", "enter"),
            ("ctrl-j", "enter"),
            ("ctrl-i", "tab"),
            ("ctrl-h", "backspace"),
            ("ctrl-[", "esc"),
            ("ctrl-3", "esc"),
            ("ctrl-2", "ctrl-space"),
            ("ctrl-1", "1"),
            ("ctrl-.", "."),
            ("ctrl--", "-"),
            ("ctrl-α", "α"),
            ("ctrl-enter", "enter"),
            ("ctrl-alt-m", "alt-enter"),
            ("shift-enter", "enter"),
            ("shift-tab", "backtab"),
            ("ctrl-esc", "esc"),
            ("alt-esc", "esc"),
            ("ctrl-\\", "ctrl-4"),
        ] {
            let key = key.replace('\\', "\\\\");
            let told = error(&format!("[keys]\nquit = [\"q\"]\nstop = [\"{key}\"]\n"));
            let says = format!("no terminal sends: it comes as `{comes}`");
            assert!(told.starts_with("my.toml:3: `") && told.contains(&says), "{key}: {told}");
        }
        let begins = error("[keys]\nquit = [\"q\"]\nstop = [\"alt-[\"]\n");
        assert!(begins.contains("`alt-[`") && begins.contains("begin"), "{begins}");
        let sent = "[\"ctrl-space\", \"ctrl-4\", \"ctrl-l\", \"ctrl-c\", \"alt-x\", \"alt-enter\", \
                    \"ctrl-alt-x\", \"shift-left\", \"ctrl-pagedown\", \"backtab\", \"enter\", \"shift-f5\"]";
        let told = error(&format!("[keys]\nquit = [\"q\"]\nstop = {sent}\n"));
        assert_eq!(told, "it was accepted");
    }

    #[test]
    fn every_mistake_is_named_with_its_line() {
        let good = "[keys]\nstop = [\"space\"]\nquit = \"q\"\n";
        assert!(Keymap::parse(good, "my.toml").is_ok(), "{}", error(good));
        for (text, says) in [
            ("[keys]\nstop = [", "my.toml:2: not a keymap"),
            ("[key]\nstop = [\"space\"]", "my.toml:1: a keymap has no `key`"),
            (
                "[keys]\nstopp = [\"space\"]",
                "my.toml:2: there is no action `stopp`; did you mean `stop`?",
            ),
            ("[keys]\nstop = 3", "my.toml:2: `stop` must be a list of keys"),
            ("[keys]\nstop = [\n \"space\",\n 4]", "my.toml:4: `stop` must be a list of keys"),
            ("[keys]\nstop = [\"spce\"]", "my.toml:2: `spce` for `stop` is not a key"),
            (
                "[keys]\nstop = [\"space\"]\nquit = [\"q\"]\nrun = [\"q\"]",
                "my.toml:4: the key `q` is given to `run` and, on line 3, to `quit`",
            ),
            ("[keys]\nquit = [\"q\"]", "my.toml: no key for `stop`"),
            ("[keys]\nstop = [\"space\"]", "my.toml: no key for `quit`"),
            ("", "my.toml: no key for `stop`"),
        ] {
            assert!(error(text).starts_with(says), "{text:?} gave: {}", error(text));
        }
    }
}
