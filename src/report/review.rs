//! What persons said of the decisions: the sheet they fill in, and the count of their verdicts.

use serde::Serialize;
use serde_json::{Map, Value};

use super::Kind::{Real, Text, Whole};
use super::decisions::{DECISION, DecisionFact, by_doubt};
use super::facts::Part::Paper;
use super::facts::{self, Place, UNSAID, Unit, fact};
use super::{DataTable, Doubted, EstimatedJoint, TextTable};
use crate::delay::Verdict;
use crate::numerics::to_decimals;
use crate::wording::counted;

/// Where those are read that persons spoke of.
const SHOWN: &[Place] = &[Place::Report];

/// What stands on a review sheet: what to fill in, and what the program says.
#[rustfmt::skip]
const REVIEW: &[DecisionFact] = &[
    DECISION[0],
    DECISION[1],
    DECISION[2],
    fact("verdict", Text, Paper, ("verdict", "", Unit::None, SHOWN), |of| of.said_verdict().into()),
    fact("delay_s", Real, Paper, ("δ", "", Unit::Seconds, SHOWN), |of| of.delay_s(of.said().and_then(|said| said.delay)).into()),
    fact("note", Text, Paper, ("note", "", Unit::None, SHOWN), |of| of.said().map_or("", |said| &said.note).into()),
    fact("reviewer", Text, Paper, ("by", "", Unit::None, SHOWN), |of| of.said().map_or("", |said| &said.reviewer).into()),
    fact("p", Whole, Paper, UNSAID, |of| of.decision.input_step.sample.into()),
    fact("program_verdict", Text, Paper, ("the program's verdict", "", Unit::None, SHOWN), |of| of.decision.program_verdict().to_string().into()),
    fact("program_delay_s", Real, Paper, ("its δ", "", Unit::Seconds, SHOWN), |of| of.delay_s(of.decision.program_delay()).into()),
    fact("doubt", Real, Paper, UNSAID, |of| to_decimals(of.doubt.value(), 3).into()),
    fact("why", Text, Paper, UNSAID, |of| of.why().into()),
];

impl Doubted<'_> {
    /// What a person said, as the sheet has it.
    fn said_verdict(&self) -> &'static str {
        match self.said() {
            Some(said) if said.accepted => "accepted",
            Some(_) => "rejected",
            None => "",
        }
    }
}

/// A row of the sheet by the names of its columns.
pub(super) fn review_json(found: &Doubted<'_>) -> Map<String, Value> {
    facts::object(REVIEW, Paper, found)
}

/// The decisions that persons spoke of.
pub(super) fn reviewed_table(joint: EstimatedJoint<'_>) -> TextTable {
    let rows = by_doubt(&[joint]).into_iter();
    let rows = rows.filter(|found| found.decision.reviewer_verdict.is_some());
    facts::text_table(REVIEW, Place::Report, None, rows)
}

/// A review sheet of all decisions: a table for `--review` to fill in, the most doubtful
/// decision first. Verdicts that were given already are in it.
pub(crate) fn review_sheet(joints: &[EstimatedJoint<'_>]) -> DataTable {
    let rows = by_doubt(joints).into_iter();
    facts::data_table(REVIEW, Paper, rows)
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
            "{steps} reviewed by a person: {accepted} accepted, {rejected} rejected; {overruled} \
             differing from the program"
        )
    }
}
