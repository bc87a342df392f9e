//! What other methods found of a step, beside the first.

use super::layout::{SegmentLayout, TrialLayout};
use super::palette::{self, Rgb};
use super::recorded::{Beside, Recording};
use crate::delay::{Decision, Method, Verdict};
use crate::experiment::Joint;
use crate::study::JointEstimate;
use crate::wording::number;

/// Another method on one joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Other<'a> {
    pub(super) method: Method,
    pub(super) rgb: Rgb,
    estimate: &'a JointEstimate,
}

impl<'a> Recording<'a> {
    /// What other methods found of `joint`, in the order they were asked for.
    pub(super) fn others(&self, joint: &Joint) -> Vec<Other<'a>> {
        let of_joint = |beside: &Beside<'a>| {
            let found = beside.joints.iter().find(|other| other.joint.name == joint.name)?;
            Some((beside.settings.method, found.estimate))
        };
        let found = self.also.iter().filter_map(of_joint).zip(palette::others());
        found.map(|((method, estimate), rgb)| Other { method, rgb, estimate }).collect()
    }
}

impl<'a> Other<'a> {
    /// What it decided on the step of `segment`.
    pub(super) fn decision(
        &self,
        trial: &TrialLayout<'_>,
        segment: &SegmentLayout<'_>,
    ) -> Option<&'a Decision> {
        let step = segment.decision.input_step;
        let found = self.estimate.trials.get(trial.index)?.as_ref().ok()?;
        found.decisions.iter().find(|decision| decision.input_step == step)
    }
}

/// The verdict of a method on a step, with the delay and its interval in samples.
pub(super) fn in_short(method: Method, decision: &Decision) -> String {
    let mark = match decision.verdict() {
        Verdict::Accepted => "✓".to_owned(),
        Verdict::Rejected(condition) => format!("✗ {}", condition.meaning()),
    };
    format!("{method}: δ = {} {mark}", delay(decision))
}

/// A row of the table of methods.
pub(super) fn row(method: Method, decision: &Decision) -> String {
    let verdict = match decision.verdict() {
        Verdict::Accepted => "✓ accepted".to_owned(),
        Verdict::Rejected(condition) => format!("✗ {}", condition.meaning()),
    };
    format!("| {method} | {} | {verdict} |", delay(decision))
}

fn delay(decision: &Decision) -> String {
    let delay = decision.delay().map_or_else(|| "none".to_owned(), number);
    let interval =
        decision.fine.map(|fine| format!("{delay} ({} … {})", number(fine.low), number(fine.high)));
    interval.unwrap_or(delay)
}
