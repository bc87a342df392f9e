//! What persons said of the decisions: the sheet they fill in, and the count of their verdicts.

use std::io::Write;

use serde::Serialize;

use super::doubt::all_by_doubt;
use super::{Doubted, EstimatedJoint};
use crate::delay::Verdict;
use crate::numerics::{to_decimals, to_nanoseconds};
use crate::wording::{counted, doubt_sentence};

/// A row of a review sheet: what to fill in, and what the program says.
#[derive(Debug, Serialize)]
pub(crate) struct SheetRow<'a> {
    joint: &'a str,
    trial: &'a str,
    i: usize,
    /// `accepted` or `rejected`; empty as long as nobody said anything.
    verdict: &'static str,
    delay_s: Option<f64>,
    note: &'a str,
    reviewer: &'a str,
    p: usize,
    program_verdict: String,
    program_delay_s: Option<f64>,
    /// From 0 to 1, to three digits.
    doubt: f64,
    why: String,
}

impl<'a> SheetRow<'a> {
    pub(crate) fn of(joint: &'a str, doubted: &Doubted<'a>) -> Self {
        let Doubted { trial, decision, doubt, .. } = doubted;
        let period_s = trial.period().seconds();
        let seconds = |delay: Option<f64>| delay.map(|delay| to_nanoseconds(delay * period_s));
        let program = decision.program_verdict();
        let said = decision.reviewer_verdict.as_ref();
        let verdict = |accepted| if accepted { "accepted" } else { "rejected" };
        Self {
            joint,
            trial: trial.label(),
            i: decision.number,
            verdict: said.map_or("", |said| verdict(said.accepted)),
            delay_s: seconds(said.and_then(|said| said.delay)),
            note: said.map_or("", |said| &said.note),
            reviewer: said.map_or("", |said| &said.reviewer),
            p: decision.input_step.sample,
            program_verdict: program.to_string(),
            program_delay_s: seconds(decision.program_delay()),
            doubt: to_decimals(doubt.value(), 3),
            why: doubt_sentence(doubt, program, period_s),
        }
    }
}

/// Writes a review sheet of all decisions: a table for `--review` to fill in, the most doubtful
/// decision first. Verdicts that were given already are in it.
///
/// # Errors
/// When `out` cannot be written.
pub(crate) fn write_review_sheet(
    joints: &[EstimatedJoint<'_>],
    out: impl Write,
) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    for (joint, doubted) in all_by_doubt(joints) {
        writer.serialize(SheetRow::of(&joint.joint.name, &doubted))?;
    }
    Ok(writer.flush()?)
}

/// How many steps of a joint persons spoke of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct ReviewCount {
    /// Steps that they accepted.
    pub(crate) accepted: usize,
    /// Steps that they rejected.
    pub(crate) rejected: usize,
    /// Steps whose verdict they turned.
    pub(crate) overruled: usize,
}

impl ReviewCount {
    /// Those on `joint`; none where nobody spoke.
    pub(crate) fn on(joint: EstimatedJoint<'_>) -> Option<Self> {
        let decisions = joint.estimate.estimated().flat_map(|trial| &trial.decisions);
        let mut count = Self::default();
        for decision in decisions {
            let Some(said) = &decision.reviewer_verdict else { continue };
            let by_program = decision.program_verdict() == Verdict::Accepted;
            count.accepted += usize::from(said.accepted);
            count.rejected += usize::from(!said.accepted);
            count.overruled += usize::from(said.accepted != by_program);
        }
        (count != Self::default()).then_some(count)
    }

    /// The count in a sentence.
    pub(crate) fn sentence(self) -> String {
        let Self { accepted, rejected, overruled } = self;
        let steps = counted(accepted + rejected, "step");
        format!(
            "{steps} reviewed by a person: {accepted} accepted, {rejected} rejected, {overruled} \
             against the program"
        )
    }
}
