//! Numbers on the command line, and what is said of those that cannot be used.

use crate::units::SamplePeriod;

/// A period in seconds.
pub(crate) fn period(text: &str) -> Result<SamplePeriod, String> {
    let period = text.parse().ok().and_then(SamplePeriod::from_seconds);
    period.ok_or_else(|| "expected a number of seconds above zero".to_owned())
}

/// A length of time in seconds.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|s: &f64| s.is_finite() && *s >= 0.0);
    seconds.ok_or_else(|| "expected a number of seconds from zero up".to_owned())
}

/// A number of threads.
pub(crate) fn threads(text: &str) -> Result<usize, String> {
    /// More than any machine has processors for.
    const MOST: usize = 1024;
    let number = text.parse().ok().filter(|number| (1..=MOST).contains(number));
    number.ok_or_else(|| format!("expected a whole number from 1 to {MOST}"))
}

/// A count.
pub(crate) fn at_least_one(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|number: &usize| *number > 0);
    number.ok_or_else(|| "expected a whole number from 1 up".to_owned())
}

/// A limit that is no less than 0.
pub(crate) fn threshold(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0);
    number.ok_or_else(|| "expected a number from 0 up".to_owned())
}

/// A probability that is neither 0 nor 1.
pub(crate) fn probability(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| *x > 0.0 && *x < 1.0);
    number.ok_or_else(|| "expected a number between 0 and 1, as in 0.99".to_owned())
}
