//! The delays of a joint in a sentence or two, wherever they are told.

use super::{DelayRange, EstimatedJoint, Headline, JointSummary, dead_time_sentences};
use crate::delay::Condition;
use crate::wording::capitalized;

/// What the delays of a joint are: by kind of step where these differ; of an input that moves all the
/// time its dead time.
pub(crate) fn delay_answer(estimated: EstimatedJoint<'_>) -> String {
    let over_record: Vec<String> = dead_time_sentences(&estimated)
        .iter()
        .take(2)
        .map(|words| format!("{}.", capitalized(words)))
        .collect();
    if !over_record.is_empty() {
        return over_record.join(" ");
    }
    let summary = JointSummary::of(estimated);
    match estimated.obstacle() {
        Some(obstacle) if summary.accepted == 0 => format!("No delay: {}.", obstacle.short),
        _ => delay_sentence(&summary, &estimated.kind_sentences(summary.headline.kinds())),
    }
}

fn delay_sentence(summary: &JointSummary, kinds: &[String]) -> String {
    let JointSummary { steps, accepted, rejected, delay_s, headline, .. } = summary;
    if *steps == 0 {
        return format!("No step: {}.", summary.without_steps);
    }
    let counted = |(why, count): &(Condition, usize)| format!("{}: {count}", why.meaning());
    let why = match rejected.as_slice() {
        [] => String::new(),
        [(why, _)] => format!(" ({})", why.meaning()),
        several => format!(" ({})", several.iter().map(counted).collect::<Vec<_>>().join(", ")),
    };
    let rest = steps - accepted;
    let kinds = kinds.join("; ");
    match (headline, delay_s) {
        (_, None) => format!("No delay: all {steps} steps were rejected{why}."),
        (Headline::All, Some(DelayRange { min, median, max })) => format!(
            "Delay {median:.3} s (median; {min:.3} to {max:.3} s); {accepted} of {steps} steps \
             accepted, {rest} rejected{why}."
        ),
        (Headline::Kinds(_), _) => format!(
            "The delay differs by kind of step: {kinds}. In all {accepted} of {steps} steps \
             accepted, {rest} rejected{why}."
        ),
        (Headline::None(_), _) => format!("No typical delay: {kinds}."),
    }
}
