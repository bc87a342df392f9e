//! What other methods, settings or logs gave for a step, beside the decision.

use super::palette::{self, Rgb};
use crate::delay::Verdict;
use crate::report::{EstimatedJoint, Recording};
use crate::study::{JointDifferences, JointResult, StepPair, StepResult};
use crate::wording::{interval, number, verdict_in_short};

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

/// The line of the result `name` in a legend, by what it says of a step; its interval is drawn.
pub(super) fn in_short(step: &StepResult, name: &str) -> String {
    let delay = step.delay.map_or_else(|| "none".to_owned(), number);
    match step.verdict {
        Verdict::Accepted => format!("{name}: δ = {delay} ✓"),
        Verdict::Rejected(condition) => format!("{name}: δ = {delay} ✗ {condition}"),
    }
}

/// The row of the result `name` in a table: its delay with the interval in samples, and its verdict.
pub(super) fn row(step: &StepResult, name: &str) -> String {
    let delay = step.delay.map_or_else(|| "none".to_owned(), number);
    let ends = step.interval.map_or_else(String::new, |ends| format!(" ({})", interval(ends)));
    format!("| {name} | {delay}{ends} | {} |", verdict_in_short(step.verdict, "✓ accepted"))
}
