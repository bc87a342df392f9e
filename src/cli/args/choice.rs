//! Options that take one of a few words.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Words, what the help says of each, and what it stands for.
pub(crate) type Choices<T> = &'static [(&'static str, &'static str, T)];

/// Takes one of `choices`, which the help lists.
pub(crate) fn one_of<T: Copy + Send + Sync>(
    choices: Choices<T>,
) -> impl TypedValueParser<Value = T> {
    let known = choices.iter().map(|(word, help, _)| {
        let help = Some(*help).filter(|help| !help.is_empty());
        PossibleValue::new(*word).help(help)
    });
    PossibleValuesParser::new(known).try_map(|word| chosen(choices, &word))
}

/// What `word` stands for.
pub(crate) fn chosen<T: Copy>(choices: Choices<T>, word: &str) -> Result<T, String> {
    let found = choices.iter().find(|(known, ..)| *known == word);
    found.map(|(.., value)| *value).ok_or_else(|| {
        let words: Vec<&str> = choices.iter().map(|(word, ..)| *word).collect();
        let (last, others) = words.split_last().unwrap_or((&"", &[]));
        format!("expected {} or {last}", others.join(", "))
    })
}
