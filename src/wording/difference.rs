//! Decisions beside those of another result, in words.

use std::collections::BTreeSet;

use super::{counted, to_place};
use crate::delay::Verdict;
use crate::study::{JointDifferences, StepPair, StepResult, Verdicts};

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
