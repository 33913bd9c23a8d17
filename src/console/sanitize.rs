//! Text from outside, made harmless before it reaches a cell: no control characters, no escape
//! sequences, nothing that turns the direction of the text around or hides in it.

use std::borrow::Cow;

/// `text` with everything that could do more than be read replaced by `�`.
#[must_use]
pub(super) fn clean(text: &str) -> Cow<'_, str> {
    if text.chars().any(is_harmful) {
        let replace = |letter| {
            if is_harmful(letter) { '\u{fffd}' } else { letter }
        };
        Cow::Owned(text.chars().map(replace).collect())
    } else {
        Cow::Borrowed(text)
    }
}

fn is_harmful(letter: char) -> bool {
    letter.is_control()
        || matches!(letter,
            '\u{ad}' | '\u{61c}' | '\u{180e}'
            | '\u{200b}'..='\u{200f}'
            | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}'
            | '\u{fe00}'..='\u{fe0f}'
            | '\u{feff}' | '\u{fff9}'..='\u{fffb}'
            | '\u{e0000}'..='\u{e0fff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn harmful_text_is_replaced_and_the_rest_kept() {
        assert_eq!(clean("Küche 5 × 4, α"), "Küche 5 × 4, α");
        assert_eq!(
            clean("a\x1b[2Jb\u{202e}c\u{200b}\n\u{9b}"),
            "a\u{fffd}[2Jb\u{fffd}c\u{fffd}\u{fffd}\u{fffd}"
        );
        assert!(matches!(clean("plain"), Cow::Borrowed(_)));
    }
}
