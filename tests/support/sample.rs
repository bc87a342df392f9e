//! How large the samples of slow statistics are.

/// A size that shows a gross fault within seconds, or the whole one where the environment has
/// `TAUSCOPE_STATISTICS=whole`.
pub(crate) fn size<T>(short: T, whole: T) -> T {
    let is_whole = std::env::var_os("TAUSCOPE_STATISTICS").is_some_and(|size| size == "whole");
    if is_whole { whole } else { short }
}

/// How many of `count` hold at least what holds with probability `share`: its expectation less
/// so many standard deviations of the binomial distribution.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
pub(crate) fn least(count: usize, share: f64, deviations: f64) -> usize {
    let count = count as f64;
    (count * share - deviations * (count * share * (1.0 - share)).sqrt()).max(0.0) as usize
}
