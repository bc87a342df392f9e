//! Names from a log inside Markdown.

/// A name from a log as Markdown that means nothing but itself.
pub(super) fn plain(name: &str) -> String {
    let mut text = String::with_capacity(name.len());
    for character in name.chars() {
        if "\\`*_[]<>#|~".contains(character) {
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
    }
}
