//! Writes text into one region: clipped to it, cleaned of what could harm the terminal, styled
//! by role.

use crate::console::sanitize::clean;
use crate::console::theme::{Role, Theme};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Span;

/// A piece of text and what it means.
pub(super) type Piece = (Role, String);

/// Writes into one region.
pub(super) struct Pen<'a> {
    buf: &'a mut Buffer,
    theme: &'a Theme,
    area: Rect,
}

impl<'a> Pen<'a> {
    pub(super) fn new(buf: &'a mut Buffer, theme: &'a Theme, area: Rect) -> Self {
        let area = area.intersection(buf.area);
        Self { buf, theme, area }
    }

    /// Writes `text` at (`x`, `y`) of the screen and answers the column after it. What does not fit ends
    /// with `…`: cut without a mark, a number would be another number.
    pub(super) fn text(&mut self, x: u16, y: u16, text: &str, role: Role) -> u16 {
        let inside = y >= self.area.top() && y < self.area.bottom();
        if !inside || x < self.area.left() || x >= self.area.right() {
            return x;
        }
        let room = self.area.right() - x;
        let style = self.theme.style(role);
        let text = clean(text);
        if width(&text) <= room {
            return self.buf.set_stringn(x, y, text, usize::from(room), style).0;
        }
        let end = self.buf.set_stringn(x, y, text, usize::from(room - 1), style).0;
        self.buf.set_stringn(end, y, "…", usize::from(self.area.right() - end), style).0
    }

    /// Writes `text` so that it ends before column `right`.
    pub(super) fn text_right(&mut self, right: u16, y: u16, text: &str, role: Role) -> u16 {
        let start = right.saturating_sub(width(text));
        self.text(start, y, text, role);
        start
    }

    /// Writes several pieces one after the other; ends with `…` when they do not fit.
    pub(super) fn pieces(&mut self, x: u16, y: u16, pieces: &[Piece]) -> u16 {
        let end = pieces.iter().fold(x, |x, (role, text)| self.text(x, y, text, *role));
        let wanted = pieces.iter().fold(x, |x, (_, text)| x.saturating_add(width(text)));
        if wanted > self.area.right() && !self.area.is_empty() {
            self.text(self.area.right() - 1, y, "…", Role::Muted);
        }
        end
    }

    /// Empties a rectangle.
    pub(super) fn clear(&mut self, rect: Rect) {
        for position in rect.intersection(self.area).positions() {
            self.buf[position].reset();
        }
    }

    /// Fills a rectangle with the style of `role`.
    pub(super) fn fill(&mut self, rect: Rect, role: Role) {
        let style = self.theme.style(role);
        for position in rect.intersection(self.area).positions() {
            self.buf[position].reset();
            self.buf[position].set_style(style);
        }
    }
}

/// How many columns `text` takes.
pub(super) fn width(text: &str) -> u16 {
    u16::try_from(Span::raw(text).width()).unwrap_or(u16::MAX)
}
