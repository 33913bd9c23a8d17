//! Lettering for pictures, drawn as single strokes: labels look the same in every viewer and in
//! the PNG, on machines without a single font installed. Knows text only, no maps.

mod glyphs;

use glyphs::{GLYPHS, Glyph, MISSING};
use std::collections::BTreeSet;
use std::fmt::Write;

/// Height of a capital letter in the glyphs' own units.
const CAP: f64 = 7.0;
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
    let found = GLYPHS.iter().find(|glyph| glyph.letter == letter);
    found.unwrap_or(&MISSING)
}

/// Width of a text with capitals of `height` pixels, in pixels.
#[must_use]
pub fn width(text: &str, height: f64) -> f64 {
    let units: f64 = text.chars().map(|letter| glyph(letter).width + SPACING).sum();
    (units - SPACING).max(0.0) * height / CAP
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
        let mut at = 0.0;
        for letter in text.chars() {
            let shape = glyph(letter);
            if !shape.strokes.is_empty() {
                self.used.insert(shape.letter);
                // Writing to a string cannot fail.
                let _ = write!(out, "<use href=\"#g{:x}\" x=\"{at:.1}\"/>", shape.letter as u32);
            }
            at += shape.width + SPACING;
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
            // Control characters are not allowed in XML at all.
            letter if letter.is_control() => out.push(' '),
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
        let letters = ('a'..='z')
            .chain('A'..='Z')
            .chain('0'..='9')
            .chain(".,:;-–/()%+=±≥⌀°²×·α'_!?#".chars());
        for letter in letters {
            let shape = glyph(letter);
            assert_eq!(shape.letter, letter, "no glyph for `{letter}`");
            assert!(shape.strokes.starts_with('M'), "`{letter}` has no strokes");
        }
    }

    #[test]
    fn no_two_glyphs_are_for_the_same_letter() {
        let mut seen = BTreeSet::new();
        for shape in GLYPHS {
            assert!(seen.insert(shape.letter), "two glyphs for `{}`", shape.letter);
        }
    }

    #[test]
    fn text_from_outside_cannot_break_the_picture() {
        let mut letters = Lettering::default();
        let style = Style { height: 10.0, weight: 0.1, color: "#000" };
        let out = letters.text("<&\"\u{7}ß", 0.0, 0.0, Anchor::Start, style);
        assert!(out.contains("aria-label=\"&lt;&amp;&quot; ß\""), "{out}");
    }
}
