//! The name that was probably meant.

use crate::experiment::nearest_name;

/// `; did you mean …`, where one of `names` is like `wanted`; else nothing.
pub(crate) fn did_you_mean<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let near = nearest_name(wanted, names);
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
