//! The table of decisions: one row per input step.

use std::io::Write;

use serde::Serialize;

use super::EstimatedJoint;
use crate::delay::{Condition, Decision};
use crate::experiment::Trial;

/// One row of `--decisions`; sample numbers count from 1 within the trial.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DecisionRow<'a> {
    /// The joint.
    pub joint: &'a str,
    /// The trial.
    pub trial: &'a str,
    /// `i`: number of the input step in the trial.
    pub i: usize,
    /// `p`: sample of the input step.
    pub p: usize,
    /// `r`: first sample of the segment.
    pub r: usize,
    /// Last sample of the segment.
    pub end: usize,
    /// Candidate breakpoints in the segment.
    pub candidates: usize,
    /// `f`: the best candidate.
    pub f_opt: Option<usize>,
    /// `q`: its breakpoint.
    pub q: Option<usize>,
    /// `δ = q − p` in samples.
    pub delta: Option<i64>,
    /// `δ` in seconds.
    pub delta_s: Option<f64>,
    /// Squared error of both lines, output units squared.
    pub sse: Option<f64>,
    /// Slope of the line before the breakpoint, output units per sample.
    pub slope_before: Option<f64>,
    /// Its value at sample 0, output units.
    pub intercept_before: Option<f64>,
    /// Slope of the line from the breakpoint on, output units per sample.
    pub slope_after: Option<f64>,
    /// Its value at sample 0, output units.
    pub intercept_after: Option<f64>,
    /// `accepted`, or the first condition that failed.
    pub verdict: String,
    /// All conditions that failed, separated by spaces.
    pub failed: String,
}

impl<'a> DecisionRow<'a> {
    fn new(joint: &'a str, trial: &'a Trial, decision: &Decision) -> Self {
        let best = decision.breakpoint();
        let candidate = best.map(|best| best.candidate);
        let delta = best.map(|best| best.delay);
        let failed: Vec<_> = decision.failed().map(Condition::id).collect();
        Self {
            joint,
            trial: trial.label(),
            i: decision.number,
            p: decision.input_step.sample,
            r: decision.segment.first,
            end: decision.segment.last,
            candidates: decision.candidates.len(),
            f_opt: candidate.map(|candidate| candidate.f),
            q: candidate.map(|candidate| candidate.breakpoint),
            delta,
            delta_s: delta.map(|delta| tidy_seconds(delta as f64 * trial.period().seconds())),
            sse: candidate.map(|candidate| candidate.sse),
            slope_before: candidate.map(|candidate| candidate.before.slope),
            intercept_before: candidate.map(|candidate| candidate.before.intercept),
            slope_after: candidate.map(|candidate| candidate.after.slope),
            intercept_after: candidate.map(|candidate| candidate.after.intercept),
            verdict: decision.verdict().to_string(),
            failed: failed.join(" "),
        }
    }
}

/// Seconds to the nanosecond: `0.07`, not `0.07000000000000001`.
pub(super) fn tidy_seconds(seconds: f64) -> f64 {
    (seconds * 1e9).round() / 1e9
}

/// The rows of one joint, trial by trial.
pub fn decision_rows(
    joint: EstimatedJoint<'_>,
) -> impl Iterator<Item = (&Trial, DecisionRow<'_>)> + '_ {
    let EstimatedJoint { joint, estimate } = joint;
    let trials = joint.trials.iter().zip(&estimate.trials);
    let estimated = trials.filter_map(|(trial, result)| Some((trial, result.as_ref().ok()?)));
    estimated.flat_map(move |(trial, estimate)| {
        let row = move |decision| (trial, DecisionRow::new(&joint.name, trial, decision));
        estimate.decisions.iter().map(row)
    })
}

/// Writes the decisions of all joints as CSV.
///
/// # Errors
/// When `out` cannot be written.
pub fn write_decisions(joints: &[EstimatedJoint<'_>], out: impl Write) -> csv::Result<()> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
    writer.write_record(COLUMNS)?;
    for joint in joints {
        for (_, row) in decision_rows(*joint) {
            writer.serialize(row)?;
        }
    }
    Ok(writer.flush()?)
}

/// The header stands even when there is no row.
const COLUMNS: [&str; 18] = [
    "joint",
    "trial",
    "i",
    "p",
    "r",
    "end",
    "candidates",
    "f_opt",
    "q",
    "delta",
    "delta_s",
    "sse",
    "slope_before",
    "intercept_before",
    "slope_after",
    "intercept_after",
    "verdict",
    "failed",
];
