//! Decisions in words: their doubt, what would have accepted a step, and how they differ from those of
//! another result.

use std::collections::BTreeSet;

use super::{counted, to_place};
use crate::delay::{Condition, Doubt, Flag, Remedy, Verdict};
use crate::study::{JointDifferences, StepPair, StepResult, Verdicts};

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

/// Steps that a sentence names.
const NAMED: usize = 5;

/// A time to the tenth of a millisecond.
fn seconds_text(seconds: f64) -> String {
    format!("{} s", to_place(seconds, 4))
}

/// What is `accepted`, or `✗` and why it is not.
pub(crate) fn verdict_in_short(verdict: Verdict, accepted: &str) -> String {
    match verdict {
        Verdict::Accepted => accepted.to_owned(),
        Verdict::Rejected(condition) => format!("✗ {}", condition.meaning()),
    }
}

/// What a result says of a step: `✓ 0.15 s`, or `✗` and why.
pub(crate) fn result_in_short(step: &StepResult) -> String {
    let delay = step.delay_s.map_or_else(String::new, seconds_text);
    verdict_in_short(step.verdict, format!("✓ {delay}").trim_end())
}

/// How two results differ on a step, in a few words.
pub(crate) fn difference_in_short(pair: &StepPair) -> String {
    let delay = pair.difference_s().map_or_else(String::new, |difference| {
        let way = if difference < 0.0 { "earlier" } else { "later" };
        format!("{} {way} here", seconds_text(difference.abs()))
    });
    match pair.verdicts() {
        Verdicts::OnlyHere => "accepted here only".to_owned(),
        Verdicts::OnlyThere => "accepted there only".to_owned(),
        Verdicts::BothRejected => "rejected by both".to_owned(),
        Verdicts::BothAccepted if pair.differs() => delay,
        Verdicts::BothAccepted => "alike".to_owned(),
    }
}

/// A step, with its trial where there are several `trials`.
pub(crate) fn step_name(step: &StepResult, trials: usize) -> String {
    if trials > 1 { format!("{}, step {}", step.trial, step.i) } else { format!("step {}", step.i) }
}

/// How two results differ on a joint, a sentence each.
pub(crate) fn difference_sentences(found: &JointDifferences) -> Vec<String> {
    let count = |verdicts| found.count(verdicts);
    let (steps, both) = (counted(found.pairs.len(), "step"), count(Verdicts::BothAccepted));
    let (here, there) = (count(Verdicts::OnlyHere), count(Verdicts::OnlyThere));
    let none = count(Verdicts::BothRejected);
    let mut sentences = vec![format!(
        "{steps} in both: {both} accepted by both, {here} here only, {there} there only, {none} by \
         neither"
    )];
    if let Some((median, largest)) = found.median_s().zip(found.largest_s()) {
        let moved = found.moved();
        sentences.push(format!(
            "of the {both} accepted by both {moved} have another delay: median distance {}, \
             largest {}",
            seconds_text(median),
            seconds_text(largest)
        ));
    }
    sentences.extend(missing_sentences(found));
    if !found.by_number.is_empty() {
        sentences.push(format!(
            "the steps of trial {} are at other samples there, so steps of the same number are \
             compared",
            found.by_number.join(", ")
        ));
    }
    sentences
}

/// Which steps only one of both results has.
fn missing_sentences(found: &JointDifferences) -> Vec<String> {
    let left_over = [(&found.only_here, "there"), (&found.only_there, "here")];
    let left_over = left_over.into_iter().filter(|(steps, _)| !steps.is_empty());
    left_over.map(|(steps, place)| missing(steps, place)).collect()
}

/// Steps without a counterpart at a `place`.
fn missing(steps: &[StepResult], place: &str) -> String {
    let labels: BTreeSet<&str> = steps.iter().map(|step| step.trial.as_str()).collect();
    let name = |step: &StepResult| step_name(step, labels.len());
    let named: Vec<_> = steps.iter().take(NAMED).map(name).collect();
    let more = steps.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let count = counted(steps.len(), "step");
    format!("{count} without a counterpart {place}: {}{more}", named.join("; "))
}
