//! Decisions beside those of other results.

use serde::Serialize;

use crate::report::Against;
use crate::study::{JointDifferences, StepPair, StepResult, Verdicts};

/// Another result, and how it differs.
#[derive(Debug, Serialize)]
pub(super) struct OtherJson<'a> {
    name: &'a str,
    settings: Option<&'a str>,
    joints: Vec<JointJson<'a>>,
    /// Joints that the other result has and this one does not.
    only_there: &'a [&'a str],
}

#[derive(Debug, Serialize)]
struct JointJson<'a> {
    joint: &'a str,
    compared: usize,
    accepted_by_both: usize,
    accepted_here_only: usize,
    accepted_there_only: usize,
    accepted_by_neither: usize,
    other_delay: usize,
    median_distance_s: Option<f64>,
    largest_distance_s: Option<f64>,
    matched_by_number: &'a [String],
    only_here: Vec<StepJson<'a>>,
    only_there: Vec<StepJson<'a>>,
    /// Those that differ, the most different first.
    differences: Vec<PairJson<'a>>,
}

/// A step that only one of both has.
#[derive(Debug, Serialize)]
struct StepJson<'a> {
    trial: &'a str,
    i: usize,
    p: usize,
}

#[derive(Debug, Serialize)]
struct PairJson<'a> {
    trial: &'a str,
    i: usize,
    p: usize,
    verdict: String,
    delay_s: Option<f64>,
    other_i: usize,
    other_p: usize,
    other_verdict: String,
    other_delay_s: Option<f64>,
    difference_s: Option<f64>,
}

impl<'a> OtherJson<'a> {
    pub(super) fn new(against: &'a Against<'a>) -> Self {
        Self {
            name: &against.other.name,
            settings: against.other.settings.as_deref(),
            joints: against
                .joints
                .iter()
                .map(|(name, found)| JointJson::new(name, found))
                .collect(),
            only_there: &against.only_there,
        }
    }
}

impl<'a> JointJson<'a> {
    fn new(joint: &'a str, found: &'a JointDifferences) -> Self {
        let steps = |steps: &'a [StepResult]| {
            let step = |step: &'a StepResult| StepJson { trial: &step.trial, i: step.i, p: step.p };
            steps.iter().map(step).collect()
        };
        Self {
            joint,
            compared: found.pairs.len(),
            accepted_by_both: found.count(Verdicts::BothAccepted),
            accepted_here_only: found.count(Verdicts::OnlyHere),
            accepted_there_only: found.count(Verdicts::OnlyThere),
            accepted_by_neither: found.count(Verdicts::BothRejected),
            other_delay: found.moved(),
            median_distance_s: found.median_s(),
            largest_distance_s: found.largest_s(),
            matched_by_number: &found.by_number,
            only_here: steps(&found.only_here),
            only_there: steps(&found.only_there),
            differences: found.differing().map(PairJson::new).collect(),
        }
    }
}

impl<'a> PairJson<'a> {
    fn new(pair: &'a StepPair) -> Self {
        let StepPair { here, there } = pair;
        Self {
            trial: &here.trial,
            i: here.i,
            p: here.p,
            verdict: here.verdict.to_string(),
            delay_s: here.delay_s,
            other_i: there.i,
            other_p: there.p,
            other_verdict: there.verdict.to_string(),
            other_delay_s: there.delay_s,
            difference_s: pair.difference_s(),
        }
    }
}
