//! Names from a log inside Markdown.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_cannot_break_a_table() {
        assert_eq!(plain("a|b *c* _d_"), "a\\|b \\*c\\* \\_d\\_");
        assert_eq!(plain("boom"), "boom");
        assert_eq!(plain("input_saturation"), "input_saturation");
    }
}
