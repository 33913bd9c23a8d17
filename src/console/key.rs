//! One press of a key with its modifiers, and how it is written: `space`, `q`, `P`, `ctrl-c`,
//! `pageup`. Knows nothing of what a key does.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use std::fmt;

/// A key with the modifiers that count. Shift is in the letter (`p`, `P`), so it counts only for
/// keys that have no letter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd)]
pub struct Key {
    code: KeyCode,
    modifiers: KeyModifiers,
}

const NAMED: &[(&str, KeyCode)] = &[
    ("space", KeyCode::Char(' ')),
    ("left", KeyCode::Left),
    ("right", KeyCode::Right),
    ("up", KeyCode::Up),
    ("down", KeyCode::Down),
    ("pageup", KeyCode::PageUp),
    ("pagedown", KeyCode::PageDown),
    ("home", KeyCode::Home),
    ("end", KeyCode::End),
    ("enter", KeyCode::Enter),
    ("esc", KeyCode::Esc),
    ("tab", KeyCode::Tab),
    ("backtab", KeyCode::BackTab),
    ("backspace", KeyCode::Backspace),
    ("delete", KeyCode::Delete),
    ("insert", KeyCode::Insert),
];

impl Key {
    /// The key as the terminal reports it.
    #[must_use]
    pub fn from_event(event: &KeyEvent) -> Self {
        let mut modifiers =
            event.modifiers & (KeyModifiers::CONTROL | KeyModifiers::ALT | KeyModifiers::SHIFT);
        let mut code = event.code;
        if let KeyCode::Char(letter) = code {
            modifiers.remove(KeyModifiers::SHIFT);
            // Terminals disagree on whether ctrl-C is c or C.
            if modifiers.contains(KeyModifiers::CONTROL) {
                code = KeyCode::Char(letter.to_ascii_lowercase());
            }
        } else if code == KeyCode::BackTab {
            modifiers.remove(KeyModifiers::SHIFT);
        }
        Self { code, modifiers }
    }

    /// The key written as `text`; none when there is no such key.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let mut rest = text;
        let mut modifiers = KeyModifiers::NONE;
        loop {
            let (modifier, after) = if let Some(after) = rest.strip_prefix("ctrl-") {
                (KeyModifiers::CONTROL, after)
            } else if let Some(after) = rest.strip_prefix("alt-") {
                (KeyModifiers::ALT, after)
            } else if let Some(after) = rest.strip_prefix("shift-") {
                (KeyModifiers::SHIFT, after)
            } else {
                break;
            };
            modifiers |= modifier;
            rest = after;
        }
        let code = Self::code(rest)?;
        let event = KeyEvent::new(code, modifiers);
        // Shift with a letter has a spelling of its own: the capital.
        let spelled_twice =
            matches!(code, KeyCode::Char(_)) && modifiers.contains(KeyModifiers::SHIFT);
        (!spelled_twice).then(|| Self::from_event(&event))
    }

    fn code(name: &str) -> Option<KeyCode> {
        if let Some(&(_, code)) = NAMED.iter().find(|(known, _)| *known == name) {
            return Some(code);
        }
        let mut letters = name.chars();
        match (letters.next(), letters.next()) {
            (Some(letter), None) if !letter.is_control() && letter != ' ' => {
                Some(KeyCode::Char(letter))
            }
            (Some('f'), Some(_)) => {
                let number = name.strip_prefix('f')?.parse().ok()?;
                (1..=12).contains(&number).then_some(KeyCode::F(number))
            }
            _ => None,
        }
    }

    /// What a terminal sends where this key is pressed, when that is not this key. A plain terminal sends one
    /// byte for a letter with ctrl, and has 32 of them: several are those of keys with names, and the rest of the
    /// keyboard comes as if nobody held ctrl, if it comes at all.
    #[must_use]
    pub fn comes_as(self) -> Option<String> {
        const CTRL: KeyModifiers = KeyModifiers::CONTROL;
        let plain = self.modifiers.difference(CTRL | KeyModifiers::SHIFT);
        let (code, modifiers) = match self.code {
            KeyCode::Char(letter) if self.modifiers.contains(CTRL) => match letter {
                'i' => (KeyCode::Tab, plain),
                'j' | 'm' => (KeyCode::Enter, plain),
                'h' | '8' | '?' => (KeyCode::Backspace, plain),
                '[' | '3' => (KeyCode::Esc, plain),
                '@' | '2' => (KeyCode::Char(' '), plain | CTRL),
                '\\' => (KeyCode::Char('4'), plain | CTRL),
                ']' => (KeyCode::Char('5'), plain | CTRL),
                '^' => (KeyCode::Char('6'), plain | CTRL),
                '_' | '/' => (KeyCode::Char('7'), plain | CTRL),
                ' ' | 'a'..='z' | '4'..='7' => (self.code, self.modifiers),
                other => (KeyCode::Char(other), plain),
            },
            // Arrows and the like begin so.
            KeyCode::Char('[' | 'O') if self.modifiers == KeyModifiers::ALT => {
                return Some("the beginning of another key".to_owned());
            }
            KeyCode::Tab if self.modifiers.contains(KeyModifiers::SHIFT) => {
                (KeyCode::BackTab, KeyModifiers::NONE)
            }
            KeyCode::BackTab | KeyCode::Esc => (self.code, KeyModifiers::NONE),
            KeyCode::Enter | KeyCode::Tab | KeyCode::Backspace => (self.code, plain),
            _ => (self.code, self.modifiers),
        };
        let comes = Self { code, modifiers };
        (comes != self).then(|| comes.comes_as().unwrap_or_else(|| format!("`{comes}`")))
    }

    /// Whether this is Ctrl-C, by which everything in a terminal is stopped.
    #[must_use]
    pub fn is_ctrl_c(self) -> bool {
        self.code == KeyCode::Char('c') && self.modifiers == KeyModifiers::CONTROL
    }

    /// The letter typed, when it is one to be written down.
    #[must_use]
    pub fn typed(self) -> Option<char> {
        match self.code {
            KeyCode::Char(letter)
                if !self.modifiers.intersects(KeyModifiers::CONTROL | KeyModifiers::ALT) =>
            {
                Some(letter)
            }
            _ => None,
        }
    }

    /// Whether this is the named key without modifiers.
    #[must_use]
    pub fn is(self, code: KeyCode) -> bool {
        self.code == code && self.modifiers.is_empty()
    }

    /// How the key is shown on screen: arrows as arrows, the rest as written.
    #[must_use]
    pub fn label(self) -> String {
        let arrow = match self.code {
            KeyCode::Left => "←",
            KeyCode::Right => "→",
            KeyCode::Up => "↑",
            KeyCode::Down => "↓",
            KeyCode::PageUp => "pgup",
            KeyCode::PageDown => "pgdn",
            _ => return self.to_string(),
        };
        if self.modifiers.is_empty() { arrow.to_owned() } else { self.to_string() }
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (modifier, prefix) in [
            (KeyModifiers::CONTROL, "ctrl-"),
            (KeyModifiers::ALT, "alt-"),
            (KeyModifiers::SHIFT, "shift-"),
        ] {
            if self.modifiers.contains(modifier) {
                f.write_str(prefix)?;
            }
        }
        if let Some((name, _)) = NAMED.iter().find(|&&(_, code)| code == self.code) {
            return f.write_str(name);
        }
        match self.code {
            KeyCode::Char(letter) if letter.is_control() => f.write_str("control character"),
            KeyCode::Char(letter) => write!(f, "{letter}"),
            KeyCode::F(number) => write!(f, "f{number}"),
            _ => f.write_str("that key"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_read_as_they_are_written() {
        for text in [
            "space",
            "q",
            "P",
            "?",
            ":",
            "-",
            "+",
            "[",
            "<",
            "ctrl-c",
            "alt-x",
            "shift-left",
            "f1",
            "f12",
            "pageup",
            "0",
            "ctrl-pagedown",
            "α",
            "ctrl--",
        ] {
            let key = Key::parse(text).unwrap_or_else(|| panic!("{text} was not understood"));
            assert_eq!(key.to_string(), text);
        }
        for text in ["", "spce", "ctrl-", "f13", "f0", "shift-p", "qq", " ", "\u{7}"] {
            assert_eq!(Key::parse(text), None, "{text:?} was taken for a key");
        }
    }

    #[test]
    fn what_the_terminal_reports_is_the_key_that_is_written() {
        let event = KeyEvent::new(KeyCode::Char('C'), KeyModifiers::CONTROL | KeyModifiers::SHIFT);
        assert_eq!(Some(Key::from_event(&event)), Key::parse("ctrl-c"));
        let event = KeyEvent::new(KeyCode::Char('?'), KeyModifiers::SHIFT);
        assert_eq!(Some(Key::from_event(&event)), Key::parse("?"));
    }
}
