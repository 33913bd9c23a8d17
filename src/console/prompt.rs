//! The command line as it is typed: its text with a cursor, and the lines typed before. What a line means is
//! `command`'s business, what it does is `update`'s.

use super::command::{Command, Steered};
use super::key::Key;
use crossterm::event::KeyCode;
use tui_input::{Input, InputRequest};

/// As many lines are remembered.
const REMEMBERED: usize = 100;
/// Letters in a line at most: more than the longest path.
const LONGEST: usize = 4096;

/// The lines typed before, the oldest first.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Past(Vec<String>);

impl Past {
    /// Remembers `line`, once where it is typed again and again.
    pub fn add(&mut self, line: &str) {
        if line.trim().is_empty() || self.0.last().is_some_and(|last| last == line) {
            return;
        }
        self.0.push(line.to_owned());
        if self.0.len() > REMEMBERED {
            self.0.remove(0);
        }
    }
}

/// A line that is being typed.
#[derive(Debug, Clone, Default)]
pub struct Prompt {
    input: Input,
    /// How many lines back it looks.
    back: usize,
    /// What was typed before it looked back.
    draft: String,
}

/// What a key made of the line.
#[derive(Debug, Clone, PartialEq)]
pub enum Typed {
    /// It is still typed.
    On(Prompt),
    /// It is done.
    Entered(String),
    /// It was given up.
    Left,
}

impl PartialEq for Prompt {
    /// Whether both look the same: what could be pasted into them does not show.
    fn eq(&self, other: &Self) -> bool {
        self.text() == other.text() && self.input.cursor() == other.input.cursor()
    }
}

impl Eq for Prompt {}

impl From<&str> for Prompt {
    fn from(text: &str) -> Self {
        Self { input: Input::from(text), ..Self::default() }
    }
}

impl Prompt {
    /// What stands there.
    #[must_use]
    pub fn text(&self) -> &str {
        self.input.value()
    }

    /// What stands before the cursor, under it (nothing at the end) and after it.
    #[must_use]
    pub fn around_cursor(&self) -> (String, String, String) {
        let letters = || self.text().chars();
        let at = self.input.cursor();
        (
            letters().take(at).collect(),
            letters().skip(at).take(1).collect(),
            letters().skip(at + 1).collect(),
        )
    }

    /// Writes `text` at the cursor, without what is no letter and what makes it longer than any command.
    pub fn insert(&mut self, text: &str) {
        let room = LONGEST.saturating_sub(self.text().chars().count());
        for letter in text.chars().filter(|letter| !letter.is_control()).take(room) {
            self.input.handle(InputRequest::InsertChar(letter));
        }
    }

    /// A key was pressed; `past` are the lines typed before, `steered` is what commands are for.
    #[must_use]
    pub fn press(mut self, key: Key, past: &Past, steered: Steered) -> Typed {
        let name = key.to_string();
        if key.is(KeyCode::Enter) {
            return Typed::Entered(self.text().to_owned());
        }
        let empty_back = key.is(KeyCode::Backspace) && self.text().is_empty();
        if key.is(KeyCode::Esc) || name == "ctrl-c" || empty_back {
            return Typed::Left;
        }
        match name.as_str() {
            "tab" if self.is_at_end() => {
                if let Some(whole) = Command::complete(self.text(), steered) {
                    self.write(&whole);
                }
            }
            "up" | "ctrl-p" => self.look(past, self.back + 1),
            "down" | "ctrl-n" => self.look(past, self.back.saturating_sub(1)),
            name => {
                let request = edit(name).or_else(|| key.typed().map(InputRequest::InsertChar));
                request.and_then(|request| self.input.handle(request));
            }
        }
        Typed::On(self)
    }

    fn is_at_end(&self) -> bool {
        self.input.cursor() == self.text().chars().count()
    }

    fn write(&mut self, text: &str) {
        self.input = std::mem::take(&mut self.input).with_value(text.to_owned());
    }

    /// Shows the line typed so many lines ago; what is typed now is 0 lines ago, and not lost.
    fn look(&mut self, past: &Past, back: usize) {
        let Some(at) = past.0.len().checked_sub(back) else { return };
        if self.back == 0 {
            self.draft = self.text().to_owned();
        }
        let text = past.0.get(at).unwrap_or(&self.draft).clone();
        self.write(&text);
        self.back = back;
    }
}

/// What a key edits, as the line editors of shells have it.
fn edit(key: &str) -> Option<InputRequest> {
    Some(match key {
        "left" | "ctrl-b" => InputRequest::GoToPrevChar,
        "right" | "ctrl-f" => InputRequest::GoToNextChar,
        "ctrl-left" | "alt-left" | "alt-b" => InputRequest::GoToPrevWord,
        "ctrl-right" | "alt-right" | "alt-f" => InputRequest::GoToNextWord,
        "home" | "ctrl-a" => InputRequest::GoToStart,
        "end" | "ctrl-e" => InputRequest::GoToEnd,
        "backspace" | "ctrl-h" => InputRequest::DeletePrevChar,
        "delete" | "ctrl-d" => InputRequest::DeleteNextChar,
        "ctrl-w" | "alt-backspace" => InputRequest::DeletePrevWord,
        "alt-d" => InputRequest::DeleteNextWord,
        "ctrl-u" => InputRequest::DeleteFromStart,
        "ctrl-k" => InputRequest::DeleteTillEnd,
        "ctrl-y" => InputRequest::Yank,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(from: &str, keys: &[&str], past: &Past) -> Prompt {
        keys.iter().fold(Prompt::from(from), |prompt, key| {
            let key = Key::parse(key).unwrap_or_else(|| panic!("{key} is no key"));
            match prompt.press(key, past, Steered::Simulator) {
                Typed::On(prompt) => prompt,
                other => panic!("{key}: {other:?}"),
            }
        })
    }

    #[test]
    fn a_slip_in_the_middle_is_mended_in_the_middle() {
        let none = Past::default();
        for (keys, text, before) in [
            (&["left", "left", "left", "backspace", "7"][..], "placed=1,7,90", "placed=1,7"),
            (&["home", "delete", "delete"], "aced=1,2,90", ""),
            (&["ctrl-a", "ctrl-k", "s"], "s", "s"),
            (&["ctrl-u", "x"], "x", "x"),
            (&["ctrl-w"], "placed=", "placed="),
            (&["ctrl-w", "ctrl-y"], "placed=1,2,90", "placed=1,2,90"),
            (&["end", "backspace", "up", "down"], "placed=1,2,9", "placed=1,2,9"),
        ] {
            let prompt = after("placed=1,2,90", keys, &none);
            let shown = (prompt.text(), prompt.around_cursor().0);
            assert_eq!(shown, (text, before.to_owned()), "{keys:?}");
        }
        let mut prompt = after("ab", &["left"], &none);
        prompt.insert("1\n2\u{1b}");
        assert_eq!(prompt.around_cursor(), ("a12".into(), "b".into(), String::new()));
        let end = after("ab", &["tab"], &none);
        assert_eq!(end.around_cursor().1, "", "there is nothing under a cursor at the end");
    }

    #[test]
    fn lines_typed_before_come_back_and_what_was_begun_is_not_lost() {
        let mut past = Past::default();
        for line in ["alpha=.3", "alpha=.3", " ", "fit"] {
            past.add(line);
        }
        let texts = |keys: &[&str]| after("beg", keys, &past).text().to_owned();
        assert_eq!(texts(&["up"]), "fit");
        assert_eq!(texts(&["up", "up"]), "alpha=.3");
        assert_eq!(texts(&["up", "up", "up"]), "alpha=.3", "there is none before the first");
        assert_eq!(texts(&["up", "up", "down"]), "fit");
        assert_eq!(texts(&["up", "up", "down", "down", "down"]), "beg");
        for number in 0..200 {
            past.add(&format!("at={number}"));
        }
        assert_eq!(past.0.len(), REMEMBERED);
    }

    #[test]
    fn a_line_is_entered_or_left() {
        let press = |text: &str, key: &str| {
            let key = Key::parse(key).expect("a key");
            Prompt::from(text).press(key, &Past::default(), Steered::Robot)
        };
        assert_eq!(press("fit", "enter"), Typed::Entered("fit".to_owned()));
        assert_eq!(press("fit", "esc"), Typed::Left);
        assert_eq!(press("fit", "ctrl-c"), Typed::Left);
        assert_eq!(press("", "backspace"), Typed::Left);
        assert_eq!(press("f", "backspace"), Typed::On(Prompt::default()));
    }
}
