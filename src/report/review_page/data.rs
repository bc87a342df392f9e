//! What the page holds of each decision.

use serde::Serialize;

use crate::delay::{Check, Decision, Outcome};
use crate::numerics::as_written;
use crate::report::doubt::all_by_doubt;
use crate::report::review::SheetRow;
use crate::report::{Doubted, EstimatedJoint};

/// All that the page is made from.
#[derive(Debug, Serialize)]
pub(super) struct ReviewPageJson<'a> {
    /// The log.
    name: &'a str,
    /// All decisions there are; the page may hold fewer.
    decisions: usize,
    steps: Vec<StepJson<'a>>,
}

/// One decision, with what a reviewer looks at.
#[derive(Debug, Serialize)]
struct StepJson<'a> {
    /// The row of the review, as it is saved.
    #[serde(flatten)]
    row: SheetRow<'a>,
    input_unit: Option<&'a str>,
    output_unit: Option<&'a str>,
    period_s: f64,
    /// Levels of the input before and after the step.
    input: [f64; 2],
    /// First and last sample of the segment.
    segment: [usize; 2],
    /// Last sample that the lines are fitted to: of rows of β samples an incomplete one is left out.
    fitted_to: usize,
    hold: usize,
    /// Sample number of the first value below.
    first: usize,
    measured: Vec<f64>,
    /// What the lines were fitted to; empty where it is the measured output.
    smoothed: Vec<f64>,
    /// Breakpoint and squared error of every candidate.
    errors: Vec<(usize, f64)>,
    conditions: Vec<ConditionJson>,
    flags: Vec<&'static str>,
}

#[derive(Debug, Serialize)]
struct ConditionJson {
    id: &'static str,
    meaning: &'static str,
    asks: &'static str,
    value: Option<f64>,
    limit: Option<f64>,
    /// `true` where it is met, `null` where it was not checked.
    met: Option<bool>,
}

impl From<Check> for ConditionJson {
    fn from(check: Check) -> Self {
        let met = match check.outcome {
            Outcome::Passed => Some(true),
            Outcome::Failed => Some(false),
            Outcome::NotChecked => None,
        };
        let condition = check.condition;
        let (id, meaning, asks) = (condition.id(), condition.meaning(), condition.asks());
        Self { id, meaning, asks, value: check.value, limit: check.limit, met }
    }
}

impl<'a> ReviewPageJson<'a> {
    /// The `most` most doubtful decisions on `joints`.
    pub(super) fn of(name: &'a str, joints: &'a [EstimatedJoint<'a>], most: usize) -> Self {
        let all = all_by_doubt(joints);
        let decisions = all.len();
        let steps = all.into_iter().take(most).map(|(joint, doubted)| step(joint, &doubted));
        Self { name, decisions, steps: steps.collect() }
    }
}

fn step<'a>(joint: EstimatedJoint<'a>, doubted: &Doubted<'a>) -> StepJson<'a> {
    let Doubted { trial, decision, doubt, .. } = doubted;
    let (first, last) = (decision.segment.first, decision.segment.last);
    let margin = (decision.segment.len() / 12).max(3);
    let start = first.min(decision.input_step.sample).saturating_sub(margin).max(1);
    let end = (last + margin).min(trial.len());
    let part = |values: &[f64]| {
        let part = values.get(start - 1..end).unwrap_or_default();
        part.iter().map(|value| six_digits(*value)).collect::<Vec<_>>()
    };
    let smoothed = doubted.smoothed.map(part).unwrap_or_default();
    let errors = decision.candidates.iter().map(|c| (c.breakpoint, six_digits(c.sse)));
    StepJson {
        row: SheetRow::of(&joint.joint.name, doubted),
        input_unit: joint.joint.input_unit.as_deref(),
        output_unit: joint.joint.output_unit.as_deref(),
        period_s: trial.period().seconds(),
        input: [decision.input_step.before, decision.input_step.after],
        segment: [first, last],
        fitted_to: fitted_to(decision).unwrap_or(last),
        hold: decision.hold,
        first: start,
        measured: part(trial.output()),
        smoothed,
        errors: errors.collect(),
        conditions: decision.checks.into_iter().map(ConditionJson::from).collect(),
        flags: doubt.flags.iter().map(|flag| flag.meaning()).collect(),
    }
}

/// Last sample of the last whole row of the segment; `None` where the rows are not known.
fn fitted_to(decision: &Decision) -> Option<usize> {
    let breakpoint = |back: usize| {
        let candidates = &decision.candidates;
        candidates.get(candidates.len().checked_sub(back)?).map(|candidate| candidate.breakpoint)
    };
    let beta = breakpoint(1)?.checked_sub(breakpoint(2)?)?;
    Some((breakpoint(1)? + beta.saturating_sub(1)).min(decision.segment.last))
}

/// What is drawn needs no more.
fn six_digits(value: f64) -> f64 {
    as_written(value, 6)
}
