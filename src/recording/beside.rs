//! What other methods, settings or logs gave for a step, beside the decision.

use super::palette::{self, Rgb};
use super::recorded::Recording;
use crate::delay::{Decision, Verdict};
use crate::report::EstimatedJoint;
use crate::study::{JointDifferences, JointResult, StepPair, StepResult};
use crate::wording::number;

/// Another result on one joint.
#[derive(Debug)]
pub(super) struct Other<'a> {
    pub(super) name: &'a str,
    pub(super) settings: Option<&'a str>,
    pub(super) rgb: Rgb,
    pub(super) differences: JointDifferences,
}

impl<'a> Recording<'a> {
    /// What other results say of the joint, in the order they were asked for.
    pub(super) fn others(&self, estimated: EstimatedJoint<'_>) -> Vec<Other<'a>> {
        if self.also.is_empty() {
            return Vec::new();
        }
        let here = JointResult::of(estimated.joint, estimated.estimate);
        let known = self.also.iter().zip(palette::others());
        let known = known.filter_map(|(other, rgb)| Some((other, other.joint(&here.joint)?, rgb)));
        known
            .map(|(other, there, rgb)| Other {
                name: &other.name,
                settings: other.settings.as_deref(),
                rgb,
                differences: JointDifferences::of(&here, Some(there)),
            })
            .collect()
    }
}

impl Other<'_> {
    /// What it says of the step at sample `p` of the trial `label`.
    pub(super) fn pair(&self, label: &str, p: usize) -> Option<&StepPair> {
        self.differences.pair(label, p)
    }
}

/// How much the results differ most on the step at sample `p` of the trial `label`: see
/// [`StepPair::weight`].
pub(super) fn weight(others: &[Other<'_>], label: &str, p: usize) -> (u8, f64) {
    let pairs = others.iter().filter_map(|other| other.pair(label, p));
    let larger = |a: (u8, f64), b: (u8, f64)| if b > a { b } else { a };
    pairs.map(StepPair::weight).fold((0, 0.0), larger)
}

/// The verdict of the method `name` on a step, with the delay and its interval in samples.
pub(super) fn decided_in_short(name: &str, decision: &Decision) -> String {
    let interval = decision.fine.map(|fine| (fine.low, fine.high));
    format!("{name}: δ = {} {}", delay(decision.delay(), interval), mark(decision.verdict()))
}

/// The verdict of another result on a step, with the delay and its interval.
pub(super) fn in_short(name: &str, step: &StepResult) -> String {
    format!("{name}: δ = {} {}", delay(step.delay, step.interval), mark(step.verdict))
}

fn mark(verdict: Verdict) -> String {
    match verdict {
        Verdict::Accepted => "✓".to_owned(),
        Verdict::Rejected(condition) => format!("✗ {}", condition.meaning()),
    }
}

/// A row of the table of results: of the decision itself.
pub(super) fn decided_row(name: &str, decision: &Decision) -> String {
    let interval = decision.fine.map(|fine| (fine.low, fine.high));
    cells(name, &delay(decision.delay(), interval), decision.verdict())
}

/// A row of the table of results.
pub(super) fn row(name: &str, step: &StepResult) -> String {
    cells(name, &delay(step.delay, step.interval), step.verdict)
}

fn cells(name: &str, delay: &str, verdict: Verdict) -> String {
    let verdict = match verdict {
        Verdict::Accepted => "✓ accepted".to_owned(),
        Verdict::Rejected(condition) => format!("✗ {}", condition.meaning()),
    };
    format!("| {name} | {delay} | {verdict} |")
}

fn delay(delay: Option<f64>, interval: Option<(f64, f64)>) -> String {
    let delay = delay.map_or_else(|| "none".to_owned(), number);
    let interval =
        interval.map(|(low, high)| format!("{delay} ({} … {})", number(low), number(high)));
    interval.unwrap_or(delay)
}
