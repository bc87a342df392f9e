//! The doubt of a decision in words, and what would have accepted its step.

use super::to_place;
use crate::delay::{Condition, Doubt, Flag, Remedy, Verdict};

/// Margin of a condition that failed up to which it failed by little.
const LITTLE: f64 = 0.3;

/// What speaks most against a decision with this verdict, on a trial sampled every `period_s`
/// seconds.
pub(crate) fn doubt_sentence(doubt: &Doubt, verdict: Verdict, period_s: f64) -> String {
    let near = doubt.nearest.filter(|(_, margin)| *margin < 1.0);
    if let Verdict::Rejected(_) = verdict {
        return near.map_or_else(
            || "no number is near its limit".to_owned(),
            |(condition, margin)| {
                let far = if margin < LITTLE { "by little" } else { "but not by much" };
                format!("{condition} fails {far}")
            },
        );
    }
    let flags = doubt.flags.iter().map(|flag: &Flag| flag.meaning().to_owned());
    let sentences = flags.chain(least(doubt, period_s));
    sentences.collect::<Vec<_>>().join("; ")
}

/// What brings an accepted decision nearest to its limit, in a clause.
fn least(doubt: &Doubt, period_s: f64) -> Option<String> {
    let seconds = |samples: f64| format!("{} s", to_place(samples * period_s, 3));
    let [explained, placed, meeting] = doubt.margins();
    let left = to_place(100.0 * (1.0 - explained), 0);
    let (what, of) =
        if doubt.settles { ("reaction", "no reaction") } else { ("break", "one line") };
    let (spread, crossing) = (seconds(doubt.spread), seconds(doubt.crossing));
    let reasons = [
        (explained, format!("with a {what} the squared error is still {left} % of that with {of}")),
        (placed, format!("breakpoints {spread} apart fit about as well")),
        (meeting, format!("the lines cross {crossing} from the breakpoint")),
    ];
    let near = doubt.nearest.filter(|(_, margin)| *margin < 1.0);
    let near = near.map(|(condition, margin)| (margin, by_little(condition)));
    let all = reasons.into_iter().chain(near);
    all.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, said)| said)
}

/// A condition that holds by little.
fn by_little(condition: Condition) -> String {
    let words = match condition {
        Condition::BeforeInput => "the breakpoint is close to the input step",
        Condition::SlopeChange => "the change of slope is close to its limit",
        Condition::ShortHold => "the hold is close to the shortest allowed",
        Condition::OutputLimit => "the output is near its limit",
        Condition::Sse => "the squared error is near its limit",
        Condition::AtRest => "the joint hardly moves",
        Condition::NothingHappened => "noise alone could explain it",
        Condition::FirstOrLast | Condition::TooShort | Condition::Reviewer => {
            return format!("{condition} is near its limit");
        }
    };
    format!("{words} ({condition})")
}

/// The doubt in percent.
pub(crate) fn doubt_percent(doubt: &Doubt) -> String {
    format!("{:.0} %", 100.0 * doubt.value())
}

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
