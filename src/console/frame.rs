//! One frame without a terminal: as text, with colours, or as a picture.

use super::model::Model;
use super::theme::Theme;
use super::view;
use crate::session::Snapshot;
use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier};
use ratatui::text::Span;
use std::fmt::Write;

/// How a frame is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Symbols only.
    Text,
    /// With the escapes that colour a terminal.
    Ansi,
    /// A picture that needs no braille font.
    Svg,
}

/// The frame of `snapshot` in the console `model`.
#[must_use]
pub fn render(model: &Model, snapshot: &Snapshot, format: Format) -> String {
    let buf = draw(model, snapshot, &Theme::dark());
    match format {
        Format::Text => text(&buf),
        Format::Ansi => ansi(&buf),
        Format::Svg => svg(&buf),
    }
}

/// The same as two planes of text: the symbols, and for each cell the letter of its style role, so
/// that a test sees an alarm that lost its colour.
#[must_use]
pub fn planes(model: &Model, snapshot: &Snapshot) -> (String, String) {
    let symbols = text(&draw(model, snapshot, &Theme::dark()));
    let probe = draw(model, snapshot, &Theme::probe());
    let letter = |cell: &Cell| Theme::probed(cell.fg).map_or(' ', super::theme::Role::letter);
    let mut letters = String::new();
    for y in 0..probe.area.height {
        let line: String = (0..probe.area.width).map(|x| letter(&probe[(x, y)])).collect();
        letters.push_str(line.trim_end());
        letters.push('\n');
    }
    (symbols, letters)
}

fn draw(model: &Model, snapshot: &Snapshot, theme: &Theme) -> Buffer {
    let area = Rect::new(0, 0, model.size.0, model.size.1);
    let mut buf = Buffer::empty(area);
    view::draw(model, snapshot, theme, area, &mut buf);
    buf
}

fn text(buf: &Buffer) -> String {
    let mut out = String::new();
    for y in 0..buf.area.height {
        let line: String = seen(buf, y).map(Cell::symbol).collect();
        out.push_str(line.trim_end());
        out.push('\n');
    }
    out
}

/// The cells of row `y` from the left, without those that a wide letter before them lies over.
fn seen(buf: &Buffer, y: u16) -> impl Iterator<Item = &Cell> {
    let mut x = 0;
    std::iter::from_fn(move || {
        let cell = (x < buf.area.width).then(|| &buf[(x, y)])?;
        x += u16::try_from(Span::raw(cell.symbol()).width()).unwrap_or(1).max(1);
        Some(cell)
    })
}

fn ansi(buf: &Buffer) -> String {
    let mut out = String::new();
    for y in 0..buf.area.height {
        for cell in seen(buf, y) {
            let mut codes = String::from("0");
            for (modifier, code) in [
                (Modifier::BOLD, ";1"),
                (Modifier::DIM, ";2"),
                (Modifier::UNDERLINED, ";4"),
                (Modifier::REVERSED, ";7"),
            ] {
                if cell.modifier.contains(modifier) {
                    codes.push_str(code);
                }
            }
            if let Some(code) = code_of(cell.fg, 30) {
                let _ = write!(codes, ";{code}");
            }
            if let Some(code) = code_of(cell.bg, 40) {
                let _ = write!(codes, ";{code}");
            }
            let _ = write!(out, "\x1b[{codes}m{}", cell.symbol());
        }
        out.push_str("\x1b[0m\n");
    }
    out
}

const PALETTE: [(Color, &str); 16] = [
    (Color::Black, "#1c1c1c"),
    (Color::Red, "#d75f5f"),
    (Color::Green, "#87af5f"),
    (Color::Yellow, "#d7af5f"),
    (Color::Blue, "#5f87d7"),
    (Color::Magenta, "#af87d7"),
    (Color::Cyan, "#5fafaf"),
    (Color::Gray, "#bcbcbc"),
    (Color::DarkGray, "#767676"),
    (Color::LightRed, "#ff8787"),
    (Color::LightGreen, "#afd787"),
    (Color::LightYellow, "#ffd787"),
    (Color::LightBlue, "#87afff"),
    (Color::LightMagenta, "#d7afff"),
    (Color::LightCyan, "#87d7d7"),
    (Color::White, "#eeeeee"),
];

fn code_of(colour: Color, base: usize) -> Option<usize> {
    let index = PALETTE.iter().position(|(known, _)| *known == colour)?;
    Some(if index < 8 { base + index } else { base + 60 + index - 8 })
}

fn hex(colour: Color, otherwise: &'static str) -> &'static str {
    PALETTE.iter().find(|(known, _)| *known == colour).map_or(otherwise, |(_, hex)| hex)
}

fn svg(buf: &Buffer) -> String {
    const W: f64 = 9.0;
    const H: f64 = 18.0;
    let (width, height) = (f64::from(buf.area.width) * W, f64::from(buf.area.height) * H);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         font-family=\"monospace\" font-size=\"15\"><rect width=\"100%\" height=\"100%\" fill=\"#121212\"/>\n"
    );
    for y in 0..buf.area.height {
        for x in 0..buf.area.width {
            let cell = &buf[(x, y)];
            let reversed = cell.modifier.contains(Modifier::REVERSED);
            let (mut ink, mut paper) = (hex(cell.fg, "#d0d0d0"), hex(cell.bg, "#121212"));
            if reversed {
                (ink, paper) = (paper, ink);
            }
            let (left, top) = (f64::from(x) * W, f64::from(y) * H);
            if paper != "#121212" {
                let _ = writeln!(
                    out,
                    "<rect x=\"{left}\" y=\"{top}\" width=\"{W}\" height=\"{H}\" fill=\"{paper}\"/>"
                );
            }
            let symbol = cell.symbol().chars().next().unwrap_or(' ');
            let dots = (symbol as u32).wrapping_sub(0x2800);
            if dots < 256 {
                braille(&mut out, dots, (left, top), (W, H), ink);
            } else if symbol != ' ' {
                let escaped = match symbol {
                    '<' => "&lt;".to_owned(),
                    '&' => "&amp;".to_owned(),
                    other => other.to_string(),
                };
                let weight = if cell.modifier.contains(Modifier::BOLD) {
                    " font-weight=\"bold\""
                } else {
                    ""
                };
                let base = top + H * 0.76;
                let _ = writeln!(
                    out,
                    "<text x=\"{left}\" y=\"{base}\" fill=\"{ink}\"{weight}>{escaped}</text>"
                );
            }
        }
    }
    out.push_str("</svg>\n");
    out
}

/// The dots of a braille cell as small circles.
fn braille(out: &mut String, dots: u32, at: (f64, f64), size: (f64, f64), ink: &str) {
    const BITS: [[u32; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];
    for (row, bits) in (0..).zip(BITS) {
        for (col, bit) in (0..).zip(bits) {
            if dots & bit != 0 {
                let x = at.0 + size.0 * (f64::from(col) * 0.5 + 0.25);
                let y = at.1 + size.1 * (f64::from(row) * 0.25 + 0.125);
                let _ =
                    writeln!(out, "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"1.4\" fill=\"{ink}\"/>");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::Keymap;
    use crate::geometry::Pose;
    use crate::mapping::settings::Settings;

    /// A letter that takes two columns is followed by none of its own.
    #[test]
    fn rows_are_as_long_with_wide_letters_as_without() {
        let columns = |source: &str, format| {
            let snapshot = Snapshot::waiting(Settings::new(Pose::new(0.0, 0.0, 0.0)), source);
            let frame = render(&Model::new(80, 24, Keymap::default()), &snapshot, format);
            // What follows an escape follows its `m`.
            let plain = |part: &str| part.split_once('m').map_or("", |(_, text)| text).to_owned();
            let row = |row: &str| match row.split_once('\u{1b}') {
                Some((_, rest)) => rest.split('\u{1b}').map(plain).collect(),
                None => row.to_owned(),
            };
            let rows: Vec<String> = frame.lines().map(row).collect();
            let told = |row: &&String| row.contains('四') || row.contains("four");
            Span::raw(rows.iter().find(told).expect("the source")).width()
        };
        for format in [Format::Text, Format::Ansi] {
            assert_eq!(columns("四四四四", format), columns("four four", format), "{format:?}");
        }
    }
}
