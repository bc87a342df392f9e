//! Names in messages: cut to a length, listed, and the one that was probably meant.

/// The start of a cell, without characters that a terminal obeys.
pub(super) fn shown(text: &str) -> String {
    /// Characters that identify a cell.
    const ENOUGH: usize = 40;
    let start: String = text.chars().take(ENOUGH).flat_map(char::escape_debug).collect();
    if text.chars().count() > ENOUGH { format!("{start}…") } else { start }
}

/// Names as a list, cut where nobody reads on.
pub(super) fn listed<'a>(names: impl ExactSizeIterator<Item = &'a str>) -> String {
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
