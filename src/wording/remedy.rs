//! What would have accepted a step, as options of `tauscope estimate`.

use crate::delay::Remedy;

/// The option with its value between two `quote`s, or that no setting helps.
pub(crate) fn remedy_text(remedy: Remedy, quote: &str) -> String {
    let option = match remedy {
        Remedy::KeepFirstLast => "--keep-first-last".to_owned(),
        Remedy::OutputLimits(low, high) => format!("--output-limits {low},{high}"),
        Remedy::MinSlopeChange(change) => format!("--min-slope-change {change}"),
        Remedy::MinDelay(samples) => format!("--min-delay {samples}"),
        Remedy::MaxSse(sse) => format!("--max-sse {sse}"),
        Remedy::Beta(samples) => format!("--beta {samples}"),
        Remedy::Confidence(Some(confidence)) => format!("--confidence {confidence}"),
        Remedy::Confidence(None) => "--confidence none".to_owned(),
        Remedy::None(condition) => return format!("no setting: {}", condition.meaning()),
    };
    format!("{quote}{option}{quote}")
}
