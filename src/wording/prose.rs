//! Sentences: lists, counts, lines of a terminal, and what a text may hold that is shown.

use crate::experiment::is_control;

/// Columns of a line of prose.
const WIDTH: usize = 92;

/// `text` in lines of at most [`WIDTH`] columns where words allow.
pub(crate) fn wrapped(text: &str) -> String {
    lines(text, WIDTH, [0, 0]).join("\n")
}

/// `text` in such lines, of which the first stands out by two columns.
pub(crate) fn hanging(text: &str) -> String {
    lines(text, WIDTH, [0, 2]).join("\n")
}

/// `text` in lines of at most `width` columns where words allow; before the first one stand so many
/// columns, and so many before the others.
pub(crate) fn lines(text: &str, width: usize, [first, others]: [usize; 2]) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let length = |line: &str| line.chars().count();
        match lines.last_mut() {
            // Its number would be on another line.
            Some(line) if word.starts_with('%') || length(line) + 1 + length(word) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            None => lines.push(" ".repeat(first) + word),
            Some(_) => lines.push(" ".repeat(others) + word),
        }
    }
    lines
}

/// `1, 2 and 3`, with `and` or another word before the last.
pub(crate) fn listed(items: &[String], conjunction: &str) -> String {
    match items {
        [before @ .., last] if !before.is_empty() => {
            format!("{} {conjunction} {last}", before.join(", "))
        }
        _ => items.concat(),
    }
}

/// `text` with a capital in front.
pub(crate) fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The parts of a sentence, and whether each stands between backticks as what is typed; one part where
/// the backticks are no pairs, as in a name from a log.
pub(crate) fn typed_parts(sentence: &str) -> Vec<(&str, bool)> {
    let parts: Vec<&str> = sentence.split('`').collect();
    let is_paired = parts.len() % 2 == 1 && parts.iter().skip(1).step_by(2).all(|p| !p.is_empty());
    if !is_paired {
        return vec![(sentence, false)];
    }
    parts.into_iter().enumerate().map(|(place, part)| (part, place % 2 == 1)).collect()
}

/// `1 joint`, `2 joints`.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

/// `text` of several lines with `U+FFFD` in the place of what moves a cursor or turns the direction of
/// writing.
pub(crate) fn legible(text: &str) -> String {
    text.replace(|letter| is_control(letter) && !matches!(letter, '\n' | '\t'), "\u{fffd}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_counts_read_as_prose() {
        let items = ["1", "2", "3"].map(str::to_owned);
        assert_eq!(
            [0, 1, 2, 3].map(|n| listed(&items[..n], "or")),
            ["", "1", "1 or 2", "1, 2 or 3"]
        );
        assert_eq!([0, 1, 2].map(|n| counted(n, "joint")), ["0 joints", "1 joint", "2 joints"]);
    }

    #[test]
    fn lines_break_between_words() {
        let text = "word ".repeat(40);
        assert!(wrapped(&text).lines().all(|line| line.starts_with("word")));
        let lines = hanging(&text);
        assert!(lines.lines().all(|line| line.len() <= WIDTH));
        assert!(lines.lines().skip(1).all(|line| line.starts_with("  word")));
        assert_eq!(lines.split_whitespace().count(), 40);
        let shares = wrapped(&"12 % ".repeat(40));
        assert!(shares.lines().all(|line| line.starts_with("12 %") && line.ends_with('%')));
    }
}

#[cfg(test)]
mod legible_tests {
    use super::*;

    #[test]
    fn lines_stay_and_what_moves_a_cursor_goes() {
        assert_eq!(
            legible("a\n\tb\u{1b}[2J\u{202e}c\u{2028}\0"),
            "a\n\tb\u{fffd}[2J\u{fffd}c\u{fffd}\u{fffd}"
        );
    }
}
