//! Templates: text with places that are filled in.

/// `template` with each `@PLACE@` filled in.
pub(super) fn filled(template: &str, places: &[(&str, &str)]) -> String {
    places.iter().fold(template.to_owned(), |text, (place, content)| {
        text.replace(&format!("@{place}@"), content)
    })
}

/// Lines, each behind `indent`.
pub(super) fn indented(lines: impl IntoIterator<Item = String>, indent: &str) -> String {
    lines.into_iter().flat_map(|line| [indent.to_owned(), line, "\n".to_owned()]).collect()
}

/// Whether `name` is one in the languages that models are written in.
pub(super) fn is_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}
