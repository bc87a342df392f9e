//! The delays of a joint in a sentence or two, wherever they are told; the dead time of one whose input
//! moves all the time.

use super::decisions::{Doubted, doubted};
use super::summary::Headline;
use super::{DelayRange, EstimatedJoint, JointSummary};
use crate::delay::{Bounds, Condition, DeadTime, Finding, InputMotion, Unknown};
use crate::wording::{capitalized, percent};

/// What the delays of a joint are: by kind of step where these differ; of an input that moves all the
/// time its dead time.
pub(crate) fn delay_answer(estimated: EstimatedJoint<'_>) -> String {
    // What was found, then why it is one for the whole record.
    if let [moves, found, ..] = dead_time_sentences(&estimated).as_slice() {
        return format!("{}. {}.", capitalized(found), capitalized(moves));
    }
    let summary = JointSummary::of(estimated);
    match estimated.obstacle() {
        Some(obstacle) if summary.accepted == 0 => format!("No delay: {}.", obstacle.short),
        _ => delay_sentence(&summary, &estimated.kind_sentences(summary.headline.kinds())),
    }
}

/// How many decisions are doubtful that no person has reviewed, where any is.
pub(crate) fn doubtful_count(estimated: EstimatedJoint<'_>) -> Option<String> {
    match doubted(estimated).filter(Doubted::is_open).count() {
        0 => None,
        1 => Some("1 decision is doubtful.".to_owned()),
        count => Some(format!("{count} decisions are doubtful.")),
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

/// That the input of a joint moves all the time, and what follows from it.
pub(crate) fn input_note(joint: &EstimatedJoint<'_>) -> Option<String> {
    joint.estimate.dead_time.as_ref()?;
    Some(format!("joint `{}`: {}", joint.joint.name, moves(&joint.estimate.motion)))
}

/// What is said of the dead time of a joint: that its input moves, its dead time and lag, what
/// windows say, and what may bias it. Empty for a joint whose input is made of steps.
pub(crate) fn dead_time_sentences(joint: &EstimatedJoint<'_>) -> Vec<String> {
    let Some(found) = joint.estimate.dead_time.as_ref() else { return Vec::new() };
    let mut sentences = vec![moves(&joint.estimate.motion), finding(found)];
    sentences.extend(windows(found));
    sentences.extend(feedback(found));
    sentences
}

fn moves(motion: &InputMotion) -> String {
    let changes = percent(motion.changes);
    let steps = motion.travel_in_steps.map_or_else(String::new, |share| {
        format!("; steps between held levels make up {} of its travel", percent(share))
    });
    format!(
        "the input moves all the time (it changes at {changes} of its samples{steps}), so one \
         dead time is estimated for the record instead of one per step"
    )
}

fn seconds(Bounds { value_s, low_s, high_s }: Bounds) -> String {
    format!("{value_s:.3} s ({low_s:.3} to {high_s:.3} s)")
}

fn finding(found: &DeadTime) -> String {
    let lag = found.lag_s.unwrap_or(0.0);
    let what = if found.integrates { "the speed" } else { "the output" };
    let confidence = percent(found.confidence);
    match found.finding {
        Finding::Known(bounds) if found.varies() => format!(
            "the dead time varies: {} for the record at {confidence} confidence, then {what} \
             follows with a lag of {lag:.3} s",
            seconds(bounds)
        ),
        Finding::Known(bounds) => format!(
            "dead time {} at {confidence}, then {what} follows with a lag of {lag:.3} s",
            seconds(bounds)
        ),
        Finding::LagOnly(Bounds { high_s, .. }) => format!(
            "no dead time is shown (at {confidence} confidence it is at most {high_s:.3} s); \
             {what} follows with a lag of {lag:.3} s"
        ),
        Finding::Unknown(Unknown::TooShort) => {
            "no dead time: the record is too short, or the input hardly moves".to_owned()
        }
        Finding::Unknown(Unknown::NotExplained) => {
            "no dead time: the output does not follow the input".to_owned()
        }
        Finding::Unknown(Unknown::OneFrequency(hz)) => format!(
            "no dead time: the input is a sine of a single frequency, {hz:.3} Hz, at which a lag \
             and a dead time have the same phase; drive the joint at several frequencies, or in \
             steps"
        ),
        Finding::Unknown(Unknown::TooLong(longest_s)) => {
            format!("no dead time found up to {longest_s:.3} s; search further with `--max-delay`")
        }
    }
}

fn windows(found: &DeadTime) -> Option<String> {
    let known: Vec<Bounds> = found.windows.iter().filter_map(|window| window.estimate).collect();
    let least = known.iter().map(|bounds| bounds.value_s).min_by(f64::total_cmp)?;
    let most = known.iter().map(|bounds| bounds.value_s).max_by(f64::total_cmp)?;
    let differ = match found.same_in_all {
        None => "",
        Some(_) if found.varies() => ", differing by more than chance",
        Some(_) => ", not differing by more than chance",
    };
    let (count, all) = (known.len(), found.windows.len());
    Some(format!(
        "in windows of the record {least:.3} to {most:.3} s, determined in {count} of {all}{differ}"
    ))
}

fn feedback(found: &DeadTime) -> Option<String> {
    let bias = "the input follows the output, as in closed loop, so the dead time may be biased";
    found.feedback.is_present().then(|| bias.to_owned())
}
