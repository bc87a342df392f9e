//! Command lines that are suggested or reported.

/// Words of a command line, each so that a shell takes it for one.
pub(crate) fn quoted(words: &[String]) -> String {
    // A name out of a log may hold NUL, which no shell can be given.
    let quoter = shlex::Quoter::new().allow_nul(true);
    quoter.join(words.iter().map(String::as_str)).unwrap_or_else(|_nul| words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_takes_each_word_for_one() {
        let words = ["log.csv", "--joint", "my boom", "it's", ""].map(str::to_owned);
        assert_eq!(quoted(&words), r#"log.csv --joint 'my boom' "it's" ''"#);
    }
}
