//! Command lines that are suggested or reported.

/// Words of a command line, each so that a shell takes it for one.
pub(crate) fn quoted(words: &[String]) -> String {
    // A name out of a log may hold NUL, which no shell can be given.
    let quoter = shlex::Quoter::new().allow_nul(true);
    quoter.join(words.iter().map(String::as_str)).unwrap_or_else(|_nul| words.join(" "))
}

/// The options that say which columns are the time and the trial, where they are named, and those of
/// each joint: its name, its input and its output.
pub(crate) fn mapping_options(named: [Option<&str>; 2], joints: &[[String; 3]]) -> String {
    let named = ["--time", "--trial"].into_iter().zip(named);
    let named = named.filter_map(|(option, column)| Some([option.to_owned(), column?.to_owned()]));
    let joints = joints
        .iter()
        .map(|[name, input, output]| ["--joint".to_owned(), format!("{name}={input}:{output}")]);
    quoted(&named.chain(joints).flatten().collect::<Vec<_>>())
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
