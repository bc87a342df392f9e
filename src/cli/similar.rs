//! The name that was probably meant.

/// The one of `names` that is like `wanted`, where one is.
pub(crate) fn nearest<'a>(
    wanted: &str,
    names: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    /// Jaro-Winkler similarity from which a name is offered; clap uses the same.
    const SIMILAR: f64 = 0.7;
    let score = |name: &'a str| (strsim::jaro_winkler(wanted, name), name);
    let best = names.into_iter().map(score).max_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|(likeness, _)| *likeness > SIMILAR).map(|(_, name)| name)
}

/// `; did you mean …`, where one of `names` is like `wanted`; else nothing.
pub(crate) fn did_you_mean<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let near = nearest(wanted, names);
    near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_name_that_is_alike_is_offered() {
        assert_eq!(did_you_mean("bom", ["stick", "boom"]), "; did you mean `boom`?");
        assert_eq!(did_you_mean("jaw", ["stick", "boom"]), "");
        assert_eq!(did_you_mean("jaw", []), "");
    }
}
