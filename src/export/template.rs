//! Templates: text with places that are filled in.

/// `template` with each `@PLACE@` filled in.
pub(super) fn filled(template: &str, places: &[(&str, impl AsRef<str>)]) -> String {
    places.iter().fold(template.to_owned(), |text, (place, content)| {
        text.replace(&format!("@{place}@"), content.as_ref())
    })
}

/// Lines, each behind `indent`.
pub(super) fn indented(lines: impl IntoIterator<Item = String>, indent: &str) -> String {
    lines.into_iter().flat_map(|line| [indent.to_owned(), line, "\n".to_owned()]).collect()
}
