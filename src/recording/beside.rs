//! What other methods, settings or logs gave for a step, beside the decision.

use super::palette::{self, Rgb};
use crate::delay::{Decision, Verdict};
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

/// What a result says of a step, in words: its delay and interval in samples, and its verdict.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    delay: Option<f64>,
    interval: Option<(f64, f64)>,
    verdict: Verdict,
}

impl Shown {
    /// What was decided here.
    pub(super) fn of(decision: &Decision) -> Self {
        let interval = decision.fine.map(|fine| (fine.low, fine.high));
        Self { delay: decision.delay(), interval, verdict: decision.verdict() }
    }

    /// What another result says.
    pub(super) fn there(step: &StepResult) -> Self {
        Self { delay: step.delay, interval: step.interval, verdict: step.verdict }
    }

    /// The line of the result `name` in a legend; its interval is drawn.
    pub(super) fn in_short(self, name: &str) -> String {
        let delay = self.delay.map_or_else(|| "none".to_owned(), number);
        match self.verdict {
            Verdict::Accepted => format!("{name}: δ = {delay} ✓"),
            Verdict::Rejected(condition) => format!("{name}: δ = {delay} ✗ {condition}"),
        }
    }

    /// The row of the result `name` in a table.
    pub(super) fn row(self, name: &str) -> String {
        format!("| {name} | {} | {} |", self.delay(), verdict_in_short(self.verdict, "✓ accepted"))
    }

    fn delay(self) -> String {
        let delay = self.delay.map_or_else(|| "none".to_owned(), number);
        match self.interval {
            Some(ends) => format!("{delay} ({})", interval(ends)),
            None => delay,
        }
    }
}
