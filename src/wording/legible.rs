//! What a text may hold that is shown.

use crate::experiment::is_control;

/// `text` of several lines with `U+FFFD` in the place of what moves a cursor or turns the direction of
/// writing.
pub(crate) fn legible(text: &str) -> String {
    text.replace(|letter| is_control(letter) && !matches!(letter, '\n' | '\t'), "\u{fffd}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stay_and_what_moves_a_cursor_goes() {
        assert_eq!(
            legible("a\n\tb\u{1b}[2J\u{202e}c\u{2028}\0"),
            "a\n\tb\u{fffd}[2J\u{fffd}c\u{fffd}\u{fffd}"
        );
    }
}
