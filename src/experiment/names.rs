//! Names as a log has them, and in messages: on one line, cut to a length, listed, and the one that
//! was probably meant.

use std::borrow::Cow;

/// Whether a character moves a cursor, ends a line where none ends, or turns the direction of
/// writing: names in a log, in a model or of a file may hold it.
pub(crate) fn is_control(letter: char) -> bool {
    let is_turn = matches!(letter, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let is_break = matches!(letter, '\u{2028}' | '\u{2029}');
    letter.is_control() || is_turn || is_break
}

/// A name without blanks around it and without what would break the lines of a table, move a
/// terminal's cursor or turn the direction of writing: breaks of lines become blanks, as in a
/// heading `angle (deg)` of a spreadsheet on two lines, and other control characters are written as
/// `\u{1b}`, so that names which differ by them stay different.
pub(super) fn on_one_line(text: &str) -> Cow<'_, str> {
    let text = text.trim();
    if !text.contains(is_control) {
        return Cow::Borrowed(text);
    }
    let text = text.chars().fold(String::new(), |mut text, letter| {
        if is_control(letter) && !letter.is_whitespace() {
            text.extend(letter.escape_unicode());
        } else {
            text.push(letter);
        }
        text
    });
    Cow::Owned(text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// The start of a cell, without characters that a terminal obeys.
pub(super) fn shown(text: &str) -> String {
    /// Characters that identify a cell.
    const ENOUGH: usize = 40;
    let start: String = text.chars().take(ENOUGH).flat_map(char::escape_debug).collect();
    if text.chars().count() > ENOUGH { format!("{start}…") } else { start }
}

/// Names as a list, cut where nobody reads on.
pub(crate) fn listed<'a>(names: impl ExactSizeIterator<Item = &'a str>) -> String {
    /// Names that are shown.
    const SHOWN: usize = 30;
    let all = names.len();
    let mut list = names.take(SHOWN).map(shown).collect::<Vec<_>>().join(", ");
    if all > SHOWN {
        list += " and more";
    }
    list
}

/// The one of `names` that `wanted` was probably meant to be, where one is similar.
pub(crate) fn nearest_name<'a>(
    wanted: &str,
    names: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    /// Jaro-Winkler similarity from which a name is offered; clap uses the same.
    const SIMILAR: f64 = 0.7;
    let score = |name: &'a str| (strsim::jaro_winkler(wanted, name), name);
    let best = names.into_iter().map(score).max_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|(similarity, _)| *similarity > SIMILAR).map(|(_, name)| name)
}

/// ` (did you mean `…`?)`, after what was not found; nothing where no name is near.
pub(crate) fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_name_that_is_alike_is_offered() {
        let offered = |wanted, names: &[&'static str]| {
            did_you_mean(nearest_name(wanted, names.iter().copied()))
        };
        assert_eq!(offered("bom", &["stick", "boom"]), " (did you mean `boom`?)");
        assert_eq!(offered("jaw", &["stick", "boom"]), "");
        assert_eq!(offered("jaw", &[]), "");
    }

    #[test]
    fn a_name_is_one_line_that_no_terminal_obeys() {
        assert_eq!(on_one_line(" boom  angle "), "boom  angle");
        assert_eq!(on_one_line("angle\r\n\t(deg)"), "angle (deg)");
        assert_eq!(on_one_line("a\u{1b}[31mb\u{202e}c\u{2028}d"), r"a\u{1b}[31mb\u{202e}c d");
    }
}
