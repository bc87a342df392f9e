//! Numbers and words on the command line, and what is said of those that cannot be used.

use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::batch::MOST_THREADS;
use crate::experiment::is_period;
use crate::units::{Length, SamplePeriod};

/// A period in seconds.
pub(crate) fn period(text: &str) -> Result<SamplePeriod, String> {
    let period = text.parse().ok().filter(|seconds| is_period(*seconds));
    let period = period.and_then(SamplePeriod::from_seconds);
    period.ok_or_else(|| "expected a number of seconds from 1e-9 to 1e8, as in 0.01".to_owned())
}

/// A finite number that `is_allowed`; `expected` is said of all else.
pub(crate) fn number_where(
    text: &str,
    is_allowed: impl Fn(f64) -> bool,
    expected: &str,
) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && is_allowed(*number));
    number.ok_or_else(|| expected.to_owned())
}

/// A number, or `none`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum OrNone {
    Number(f64),
    None,
}

impl OrNone {
    /// The number, where there is one.
    pub(crate) fn number(self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(number),
            Self::None => None,
        }
    }
}

/// What `number` understands, or `none`.
pub(crate) fn or_none(
    text: &str,
    number: impl Fn(&str) -> Result<f64, String>,
) -> Result<OrNone, String> {
    if text == "none" { Ok(OrNone::None) } else { number(text).map(OrNone::Number) }
}

/// A length of time in seconds.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    number_where(text, |s| s >= 0.0, "expected a number of seconds from zero up")
}

/// A number of bytes, alone or in kilobytes and so on.
pub(crate) fn bytes(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, f64); 6] =
        [("kB", 1e3), ("KB", 1e3), ("MB", 1e6), ("GB", 1e9), ("TB", 1e12), ("B", 1.0)];
    let with_unit = UNITS.iter().find_map(|(unit, size)| Some((text.strip_suffix(unit)?, *size)));
    let (number, size) = with_unit.unwrap_or((text, 1.0));
    let bytes = number.trim().parse().ok().map(|number: f64| number * size);
    let bytes = bytes.filter(|bytes| *bytes >= 1.0 && *bytes < 2_f64.powi(63));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it was checked")]
    let bytes = bytes.map(|bytes| bytes as u64);
    bytes.ok_or_else(|| "expected a number of bytes, as in 500MB or 4GB".to_owned())
}

/// A number of threads.
pub(crate) fn threads(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|number| (1..=MOST_THREADS).contains(number));
    number.ok_or_else(|| format!("expected a whole number from 1 to {MOST_THREADS}"))
}

/// A whole number that may be 0: a count, or the seed of random numbers.
pub(crate) fn whole<N: FromStr>(text: &str) -> Result<N, String> {
    text.parse().ok().ok_or_else(|| "expected a whole number from 0 up".to_owned())
}

/// A count.
pub(crate) fn at_least_one(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|number: &usize| *number > 0);
    number.ok_or_else(|| "expected a whole number from 1 up".to_owned())
}

/// A length of time: a number of samples, or seconds with their unit.
pub(crate) fn length(text: &str) -> Result<Length, String> {
    let found = any_length(text).filter(|length| *length != Length::Samples(0));
    let found = found.filter(|length| *length != Length::Seconds(0.0));
    found.ok_or_else(|| {
        "expected a whole number of samples from 1 up, or seconds as in 0.5s".to_owned()
    })
}

/// A length of time that may be 0.
pub(crate) fn length_or_none(text: &str) -> Result<Length, String> {
    any_length(text).ok_or_else(|| {
        "expected a whole number of samples from 0 up, or seconds as in 0.5s".to_owned()
    })
}

fn any_length(text: &str) -> Option<Length> {
    let seconds = |text: &str, unit_s: f64| {
        let number = text.trim_end().parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0)?;
        Some(Length::Seconds(number * unit_s))
    };
    if let Some(milliseconds) = text.strip_suffix("ms") {
        return seconds(milliseconds, 1e-3);
    }
    match text.strip_suffix('s') {
        Some(text) => seconds(text, 1.0),
        None => text.parse().ok().map(Length::Samples),
    }
}

/// A limit that is no less than 0.
pub(crate) fn threshold(text: &str) -> Result<f64, String> {
    number_where(text, |x| x >= 0.0, "expected a number from 0 up")
}

/// A probability that is neither 0 nor 1.
pub(crate) fn probability(text: &str) -> Result<f64, String> {
    number_where(text, |x| x > 0.0 && x < 1.0, "expected a number between 0 and 1, as in 0.99")
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_samples_or_seconds() {
        let texts = ["50", "0.5s", "0.5 s", "20ms"];
        let expected = [
            Length::Samples(50),
            Length::Seconds(0.5),
            Length::Seconds(0.5),
            Length::Seconds(0.02),
        ];
        assert_eq!(texts.map(|text| length(text).unwrap()), expected);
        for wrong in ["", "0", "0s", "-1s", "s", "0.5", "nans", "infs", "5 m"] {
            assert!(length(wrong).is_err(), "{wrong}");
        }
        assert_eq!(length_or_none("0"), Ok(Length::Samples(0)));
    }

    #[test]
    fn bytes_are_read_with_and_without_a_unit() {
        let texts = ["500MB", "4 GB", "1.5kB", "77", "77B"];
        let expected = [500_000_000, 4_000_000_000, 1500, 77, 77];
        assert_eq!(texts.map(|text| bytes(text).unwrap()), expected);
        for wrong in ["", "0", "-1GB", "GB", "1e30", "NaN", "4 cats"] {
            assert!(bytes(wrong).is_err(), "{wrong}");
        }
    }
}
