//! Lettering for pictures, drawn as single strokes: labels look the same in every viewer and in
//! the PNG, on machines without a single font installed. Knows text only, no maps.

mod glyphs;

use glyphs::{GLYPHS, Glyph, MARKS, MISSING};
use std::collections::BTreeSet;
use std::fmt::Write;
use unicode_normalization::UnicodeNormalization;

/// Height of a capital letter in the glyphs' own units.
const CAP: f64 = 7.0;
/// Height of a small one.
const SMALL: f64 = 5.0;
/// Space after each glyph, in the same units.
const SPACING: f64 = 1.5;

/// Collects the glyphs that a picture uses, so that each is defined once.
#[derive(Debug, Default)]
pub struct Lettering {
    used: BTreeSet<char>,
}

/// Where a text's given x is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// At its left end.
    Start,
    /// At its middle.
    Middle,
    /// At its right end.
    End,
}

/// How a text looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// Height of a capital letter, pixels.
    pub height: f64,
    /// Width of the pen as a share of the height.
    pub weight: f64,
    /// Colour, as SVG writes it.
    pub color: &'static str,
}

fn glyph(letter: char) -> &'static Glyph {
    let found = GLYPHS.iter().chain(MARKS).find(|glyph| glyph.letter == letter);
    found.unwrap_or(&MISSING)
}

/// The glyphs of a line, each with where it goes (x, y), and how wide all of it is, in the glyphs' units.
fn set(text: &str) -> (Vec<(&'static Glyph, f64, f64)>, f64) {
    let (mut line, mut at) = (Vec::new(), 0.0);
    let mut letters = text.nfd().peekable();
    let is_mark = |letter: char| MARKS.iter().any(|mark| mark.letter == letter);
    let (mut middle, mut top) = (0.0, 0.0);
    while let Some(letter) = letters.next() {
        if is_mark(letter) {
            line.push((glyph(letter), middle, if letter == '\u{327}' { 0.0 } else { -top }));
            continue;
        }
        // A mark takes the place of the dot.
        let is_marked = letters.peek().is_some_and(|next| is_mark(*next));
        let shape = glyph(if letter == 'i' && is_marked { 'ı' } else { letter });
        middle = at + shape.width / 2.0;
        top = if letter.is_uppercase() { CAP } else { SMALL };
        line.push((shape, at, 0.0));
        at += shape.width + SPACING;
    }
    (line, (at - SPACING).max(0.0))
}

/// Width of a text with capitals of `height` pixels, in pixels.
#[must_use]
pub fn width(text: &str, height: f64) -> f64 {
    set(text).1 * height / CAP
}

impl Lettering {
    /// An SVG element that draws `text` with its baseline at (`x`, `y`) pixels.
    pub fn text(&mut self, text: &str, x: f64, y: f64, anchor: Anchor, style: Style) -> String {
        let scale = style.height / CAP;
        let length = width(text, style.height);
        let left = match anchor {
            Anchor::Start => x,
            Anchor::Middle => x - length / 2.0,
            Anchor::End => x - length,
        };
        let mut out = format!(
            "<g role=\"img\" aria-label=\"{}\" transform=\"translate({left:.2} {y:.2}) scale({scale:.4})\" \
             fill=\"none\" stroke=\"{}\" stroke-width=\"{:.2}\" stroke-linecap=\"round\" \
             stroke-linejoin=\"round\">",
            escaped(text),
            style.color,
            style.weight * CAP,
        );
        for (shape, x, y) in set(text).0 {
            if shape.strokes.is_empty() {
                continue;
            }
            self.used.insert(shape.letter);
            // Writing to a string cannot fail.
            let _ = write!(out, "<use href=\"#g{:x}\" x=\"{x:.1}\"", shape.letter as u32);
            let _ = if y == 0.0 { write!(out, "/>") } else { write!(out, " y=\"{y:.1}\"/>") };
        }
        out.push_str("</g>\n");
        out
    }

    /// The definitions of every glyph used so far.
    #[must_use]
    pub fn definitions(&self) -> String {
        let mut out = String::from("<defs>");
        for &letter in &self.used {
            let strokes = glyph(letter).strokes;
            let _ = write!(out, "<path id=\"g{:x}\" d=\"{strokes}\"/>", letter as u32);
        }
        out.push_str("</defs>\n");
        out
    }
}

/// `text` as it may stand in an attribute or between tags.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // Control characters, and two that are none, are not allowed in XML at all.
            letter if letter.is_control() || matches!(letter, '\u{FFFE}' | '\u{FFFF}') => {
                out.push(' ');
            }
            letter => out.push(letter),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_letter_that_a_picture_needs_has_strokes() {
        let letters = ('!'..='~').chain("–—…±≥⌀°²×·αßı".chars());
        for letter in letters {
            let shape = glyph(letter);
            assert_eq!(shape.letter, letter, "no glyph for `{letter}`");
            assert!(shape.strokes.starts_with('M'), "`{letter}` has no strokes");
        }
    }

    #[test]
    fn what_may_not_stand_in_xml_is_left_out() {
        assert_eq!(escaped("a\u{FFFE}b\u{FFFF}\u{1}<é"), "a b  &lt;é");
    }

    #[test]
    fn no_two_glyphs_are_for_the_same_letter() {
        let mut seen = BTreeSet::new();
        for shape in GLYPHS.iter().chain(MARKS) {
            assert!(seen.insert(shape.letter), "two glyphs for `{}`", shape.letter);
        }
    }

    #[test]
    fn a_mark_stands_over_its_letter_and_takes_no_room() {
        assert_eq!(width("Küche", 7.0), width("Kuche", 7.0));
        assert_eq!(width("naïf", 7.0), width("naif", 7.0));
        let places = |text: &str| {
            let (line, _) = set(text);
            line.iter().map(|(shape, x, y)| (shape.letter, *x, *y)).collect::<Vec<_>>()
        };
        assert_eq!(places("ü"), [('u', 0.0, 0.0), ('\u{308}', glyph('u').width / 2.0, -SMALL)]);
        assert_eq!(places("Ç")[1].2, 0.0, "a cedilla goes under");
        assert_eq!(places("É")[1].2, -CAP);
        assert_eq!(places("ï")[0].0, 'ı', "without its dot");
    }

    #[test]
    fn text_from_outside_cannot_break_the_picture() {
        let mut letters = Lettering::default();
        let style = Style { height: 10.0, weight: 0.1, color: "#000" };
        let out = letters.text("<&\"\u{7}ß", 0.0, 0.0, Anchor::Start, style);
        assert!(out.contains("aria-label=\"&lt;&amp;&quot; ß\""), "{out}");
    }
}
