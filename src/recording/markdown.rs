//! Names from a log inside Markdown.

use crate::wording::typed_parts;

/// A name from a log as Markdown that means nothing but itself.
pub(super) fn plain(name: &str) -> String {
    let mut text = String::with_capacity(name.len());
    let mut before = None;
    let mut rest = name.chars().peekable();
    while let Some(character) = rest.next() {
        // Inside a word an underscore means nothing, and a viewer breaks lines at an escaped one.
        let is_within = character == '_'
            && [before, rest.peek().copied()].iter().all(|c| c.is_some_and(char::is_alphanumeric));
        before = Some(character);
        if "\\`*_[]<>#|~".contains(character) && !is_within {
            text.push('\\');
        }
        text.push(character);
    }
    text
}

/// Sentences of ours, with names from a log, in which backticks hold what is typed.
pub(super) fn prose(sentences: &str) -> String {
    let part = |(part, is_typed): (&str, bool)| {
        if is_typed { format!("`{part}`") } else { plain(part) }
    };
    typed_parts(sentences).into_iter().map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_cannot_break_a_table() {
        assert_eq!(plain("a|b *c* _d_"), "a\\|b \\*c\\* \\_d\\_");
        assert_eq!(plain("boom"), "boom");
        assert_eq!(plain("input_saturation"), "input_saturation");
    }

    #[test]
    fn what_is_typed_stays_as_it_is() {
        assert_eq!(prose("`gain[H]` of a_ *b*"), "`gain[H]` of a\\_ \\*b\\*");
        for unpaired in ["a ` *b*", "`` *b*"] {
            assert_eq!(prose(unpaired), plain(unpaired));
        }
    }
}
