//! The table of decisions: one row per input step.

use serde::{Serialize, Serializer};

use super::{DataTable, EstimatedJoint, Kind};
use crate::delay::{Check, Condition, Decision, Method, Settings, Verdict};
use crate::experiment::Trial;
use crate::numerics::to_nanoseconds;
use crate::wording::{number, remedy_text};

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
    /// `q`: its breakpoint; between samples where the method finds it so.
    #[serde(serialize_with = "samples")]
    pub q: Option<f64>,
    /// `δ = q − p` in samples.
    #[serde(serialize_with = "samples")]
    pub delta: Option<f64>,
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
    #[serde(serialize_with = "in_words")]
    pub verdict: Verdict,
    /// All conditions that failed, separated by spaces.
    pub failed: String,
}

/// Further details of a decision: the columns behind those of [`DecisionRow`] where a
/// method other than the paper's was run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct DecisionDetail {
    /// The method's name.
    pub(crate) method: &'static str,
    /// Lower end of the delay's interval, samples.
    pub(crate) delta_low: Option<f64>,
    /// Upper end of it.
    pub(crate) delta_high: Option<f64>,
    /// p-value of the reaction: how often noise alone looks as much like one; where tested.
    pub(crate) p_value: Option<f64>,
    /// The second-best breakpoint.
    pub(crate) runner_up_q: Option<usize>,
    /// By how much its squared error is larger, as a part of the best one's.
    pub(crate) runner_up_margin: Option<f64>,
    /// What would have accepted the step, all else being as it was; separated by `; `.
    pub(crate) accepted_with: String,
}

impl DecisionDetail {
    fn new(decision: &Decision, settings: &Settings, output: &[f64]) -> Self {
        let second = decision.runner_up();
        let remedies = decision.remedies(settings, output);
        let remedies: Vec<_> = remedies.into_iter().map(|remedy| remedy_text(remedy, "")).collect();
        let tested = |check: &Check| check.condition == Condition::NothingHappened;
        Self {
            method: settings.method.id(),
            delta_low: decision.fine.map(|fine| fine.low),
            delta_high: decision.fine.map(|fine| fine.high),
            p_value: decision.checks.into_iter().find(tested).and_then(|check| check.value),
            runner_up_q: second.map(|second| second.breakpoint),
            runner_up_margin: second.map(|second| second.margin).filter(|m| m.is_finite()),
            accepted_with: remedies.join("; "),
        }
    }

    /// The delay's interval as `11.2 … 12.9`, samples; `-` where there is none.
    pub(super) fn interval_text(&self) -> String {
        let ends = self.delta_low.zip(self.delta_high);
        ends.map_or_else(
            || "-".to_owned(),
            |(low, high)| format!("{} … {}", number(low), number(high)),
        )
    }
}

impl<'a> DecisionRow<'a> {
    fn new(joint: &'a str, trial: &'a Trial, decision: &Decision) -> Self {
        let best = decision.breakpoint();
        let candidate = best.map(|best| best.candidate);
        let delta = decision.delay();
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
            q: delta.map(|delta| decision.input_step.sample as f64 + delta),
            delta,
            delta_s: delta.map(|delta| to_nanoseconds(delta * trial.period().seconds())),
            sse: candidate.map(|candidate| candidate.sse),
            slope_before: candidate.map(|candidate| candidate.before.slope),
            intercept_before: candidate.map(|candidate| candidate.before.intercept),
            slope_after: candidate.map(|candidate| candidate.after.slope),
            intercept_after: candidate.map(|candidate| candidate.after.intercept),
            verdict: decision.verdict(),
            failed: failed.join(" "),
        }
    }
}

/// The verdict as its [`Display`](std::fmt::Display) has it.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde gives it so")]
fn in_words<S: Serializer>(verdict: &Verdict, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(verdict)
}

/// Whole numbers without a point.
#[expect(clippy::ref_option, reason = "serde gives it so")]
fn samples<S: Serializer>(value: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    /// Below it every whole number is one.
    const EXACT: f64 = 9_007_199_254_740_992.0;
    #[expect(clippy::cast_possible_truncation, reason = "it is whole and below 2^53")]
    match value {
        Some(value) if value.fract() == 0.0 && value.abs() < EXACT => {
            serializer.serialize_some(&(*value as i64))
        }
        value => value.serialize(serializer),
    }
}

/// The rows of one joint, trial by trial.
pub fn decision_rows(
    joint: EstimatedJoint<'_>,
) -> impl Iterator<Item = (&Trial, DecisionRow<'_>)> + '_ {
    let name = joint.joint.name.as_str();
    joint.decisions().map(|(trial, _, decision)| (trial, DecisionRow::new(name, trial, decision)))
}

/// The rows of one joint with their details.
pub(super) fn detailed_rows(
    joint: EstimatedJoint<'_>,
) -> impl Iterator<Item = DetailedRow<'_>> + '_ {
    let settings = &joint.estimate.settings;
    joint.decisions().map(move |(trial, found, decision)| {
        let output = found.smoothed.as_deref().unwrap_or(trial.output());
        DetailedRow {
            row: DecisionRow::new(&joint.joint.name, trial, decision),
            detail: DecisionDetail::new(decision, settings, output),
        }
    })
}

/// The columns of [`decision_table`] for decisions of the methods with these ids: of the paper's alone
/// without those of the details.
pub(crate) fn decision_columns<'a>(
    mut methods: impl Iterator<Item = &'a str>,
) -> impl Iterator<Item = (&'static str, Kind)> {
    let is_of_paper = methods.all(|id| id == Method::TWO_LINE.id());
    COLUMNS.into_iter().take(if is_of_paper { OF_THE_PAPER } else { COLUMNS.len() })
}

/// The decisions of all joints, those of one run of settings below those of another. With a method
/// other than the paper's there are columns for its details.
///
/// # Errors
/// Never: the rows have fields.
pub(crate) fn decision_table(
    runs: &[(&Settings, &[EstimatedJoint<'_>])],
) -> serde_json::Result<DataTable> {
    let methods = runs.iter().map(|(settings, _)| settings.method.id());
    let mut table = DataTable::new(decision_columns(methods));
    for row in runs.iter().flat_map(|(_, joints)| *joints).flat_map(|joint| detailed_rows(*joint)) {
        table.push_fields(row)?;
    }
    Ok(table)
}

/// A decision with its details.
#[derive(Debug, Serialize)]
pub(super) struct DetailedRow<'a> {
    #[serde(flatten)]
    pub(super) row: DecisionRow<'a>,
    #[serde(flatten)]
    pub(super) detail: DecisionDetail,
}

/// Names of the columns, and what they hold: those of [`DecisionRow`], then those of
/// [`DecisionDetail`].
const COLUMNS: [(&str, Kind); 25] = [
    ("joint", Kind::Text),
    ("trial", Kind::Text),
    ("i", Kind::Whole),
    ("p", Kind::Whole),
    ("r", Kind::Whole),
    ("end", Kind::Whole),
    ("candidates", Kind::Whole),
    ("f_opt", Kind::Whole),
    ("q", Kind::Samples),
    ("delta", Kind::Samples),
    ("delta_s", Kind::Real),
    ("sse", Kind::Real),
    ("slope_before", Kind::Real),
    ("intercept_before", Kind::Real),
    ("slope_after", Kind::Real),
    ("intercept_after", Kind::Real),
    ("verdict", Kind::Text),
    ("failed", Kind::Text),
    ("method", Kind::Text),
    ("delta_low", Kind::Real),
    ("delta_high", Kind::Real),
    ("p_value", Kind::Real),
    ("runner_up_q", Kind::Whole),
    ("runner_up_margin", Kind::Real),
    ("accepted_with", Kind::Text),
];

/// How many of them there are where all decisions are the paper's.
const OF_THE_PAPER: usize = 18;
