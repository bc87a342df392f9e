//! Templates: text with places that are filled in.

/// `template` with each `@PLACE@` filled in; what is filled in is not looked at again, so that a
/// text of the user's cannot name a place.
pub(super) fn filled(template: &str, places: &[(&str, impl AsRef<str>)]) -> String {
    let mut text = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('@') {
        text.push_str(before);
        let place = after.split_once('@').and_then(|(name, behind)| {
            places.iter().find(|(place, _)| *place == name).map(|(_, content)| (content, behind))
        });
        if let Some((content, behind)) = place {
            text.push_str(content.as_ref());
            rest = behind;
        } else {
            text.push('@');
            rest = after;
        }
    }
    text + rest
}

/// Lines, each behind `indent`.
pub(super) fn indented(lines: impl IntoIterator<Item = String>, indent: &str) -> String {
    lines.into_iter().flat_map(|line| [indent.to_owned(), line, "\n".to_owned()]).collect()
}

#[cfg(test)]
mod tests {
    use super::filled;

    #[test]
    fn what_is_filled_in_names_no_place() {
        let places = [("A", "@B@"), ("B", "x@A@"), ("N", "n")];
        assert_eq!(filled("@A@ @B@, @none@N@ a@b @A", &places), "@B@ x@A@, @nonen a@b @A");
        assert_eq!(filled("@@N@@ @", &places), "@n@ @");
        assert_eq!(filled("", &places), "");
    }
}
