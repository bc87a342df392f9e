//! `improve` as text and JSON: the ladder of errors.

use serde_json::{Value, json};

use super::compare::{error_json, errors_note, horizons, model_json};
use super::conclusion::Conclusion;
use super::conclusion::{Passage, Topic};
use super::explain::finding_json;
use super::json::{document, joined};
use super::ladder::{LadderRow, change_in_words, errors_of, figures, ladder_table};
use super::parameters::{model_text, parameters_json};
use super::{Before, ComparedJoint, Finding, History};
use crate::experiment::Joint;
use crate::explain::{Candidate, Change, Revision, Verdict};
use crate::wording::effect_ids;

/// A joint whose model was improved.
#[derive(Clone, Copy, Debug)]
pub struct ImprovedJoint<'a> {
    /// What is to be said of the last revision.
    pub finding: Finding<'a>,
    /// The model as it was given, and after each change.
    pub revisions: &'a [Revision],
    /// Number of the first of them.
    pub first_revision: u32,
    /// How the model that was given came about.
    pub history: History<'a>,
    /// Whether it was stopped before it came to an end.
    pub interrupted: bool,
    /// Whether more is missing, and as many effects were added as are allowed.
    pub reached_limit: bool,
}

impl<'a> ImprovedJoint<'a> {
    /// `revisions` that end with the model of `finding`, which was not stopped.
    pub fn of(finding: Finding<'a>, revisions: &'a [Revision]) -> Self {
        let later = u32::try_from(revisions.len().saturating_sub(1)).unwrap_or(u32::MAX);
        let first_revision = finding.compared.revision.saturating_sub(later);
        let (interrupted, reached_limit, history) = (false, false, History::default());
        Self { finding, revisions, first_revision, history, interrupted, reached_limit }
    }

    /// This, with all effects that came since its history began.
    #[must_use]
    pub(crate) fn since_its_beginning(self) -> Self {
        let beginning = Before::History(self.history, self.revisions);
        let before = beginning.rmse().map(|_| beginning).or(self.finding.before);
        Self { finding: Finding { before, ..self.finding }, ..self }
    }

    /// The revisions with their numbers.
    pub fn numbered(&self) -> impl Iterator<Item = (u32, &'a Revision)> + use<'a> {
        (self.first_revision..).zip(self.revisions)
    }

    /// Each revision as a model beside the measurement.
    pub(crate) fn compared(&self) -> impl Iterator<Item = ComparedJoint<'a>> + use<'a> {
        let last = self.finding.compared;
        let compared = move |(revision, step): (u32, &'a Revision)| ComparedJoint {
            revision,
            comparison: &step.comparison,
            ..last
        };
        self.numbered().map(compared)
    }

    /// The candidate of the revision at `index` that the next one took, or would take.
    pub fn proposed(&self, index: usize) -> Option<&'a Candidate> {
        let ranking = &self.revisions.get(index)?.ranking;
        ranking.iter().find(|candidate| self.is_taken(index, candidate))
    }

    fn is_taken(&self, index: usize, candidate: &Candidate) -> bool {
        match self.revisions.get(index + 1).map(|next| next.change) {
            Some(Change::Added(id) | Change::Replaced { new: id, .. }) => {
                candidate.effects.first() == Some(&id)
            }
            Some(_) => false,
            None => self.finding.verdict == Verdict::MissingEffect,
        }
    }

    /// The name of the joint.
    pub fn name(&self) -> &'a str {
        &self.finding.compared.joint.name
    }

    /// What is to be said of the last revision, and why it is the last.
    pub(crate) fn conclusion(&self) -> Conclusion {
        let mut conclusion = self.finding.conclusion();
        if self.reached_limit {
            let why =
                "The search ended at the limit of `--max-effects`; a larger limit continues it.";
            conclusion.passages.extend(Passage::of(Topic::NEXT, [why.to_owned()]));
        }
        conclusion
    }

    /// The ladder of errors: the revisions of the model's history, and those made now.
    pub(super) fn ladder(&self) -> Vec<LadderRow> {
        self.history.rows(self.first_revision, self.revisions)
    }

    fn text(&self) -> String {
        let conclusion = self.conclusion();
        let stopped = if self.interrupted { " (stopped before the end)" } else { "" };
        let ladder = ladder_table(self.finding.compared.joint, &self.ladder());
        let compared = &self.finding.compared;
        let model = model_text(compared.joint, compared.comparison, None);
        let headline = &conclusion.headline;
        format!("{headline}{stopped}\n{ladder}\n\n{}\n{model}\n", conclusion.printed())
    }
}

/// One line on a revision, for somebody who waits: `boom: + dead_band: validation error 0.06 deg`.
pub(crate) fn revision_line(joint: &Joint, revision: &Revision) -> String {
    let [training, validation, ..] = figures(joint, &errors_of(&revision.comparison));
    let change = change_in_words(revision);
    let error = match revision.comparison.validation {
        Some(_) => format!("validation error {validation}"),
        None => format!("training error {training}"),
    };
    format!("{}: {change}: {error}", joint.name)
}

/// For each joint the ladder of errors and what is to be said of the last revision.
pub(crate) fn improve_text(joints: &[ImprovedJoint<'_>]) -> String {
    let horizon = horizons(joints.iter().map(|joint| joint.finding.compared));
    let joints: Vec<String> = joints.iter().map(ImprovedJoint::text).collect();
    format!("{}\n{}\n", joints.join("\n\n"), errors_note(&horizon))
}

/// The document of `improve --format json`.
pub(crate) fn improve_json(joints: &[ImprovedJoint<'_>], failures: &[String]) -> Value {
    let joint = |improved: &ImprovedJoint<'_>| {
        let compared = &improved.finding.compared;
        let revisions = improved.numbered();
        let revisions = revisions.map(|(number, one)| revision(compared.joint, number, one));
        let course = json!({
            "revisions": revisions.collect::<Value>(),
            "interrupted": improved.interrupted,
        });
        let found = finding_json(&improved.finding, &improved.conclusion());
        joined([model_json(compared), course, found])
    };
    let joints: Value = joints.iter().map(joint).collect();
    document("tauscope/improve/1", json!({ "joints": joints, "failures": failures }))
}

fn revision(joint: &Joint, number: u32, revision: &Revision) -> Value {
    let (added, removed) = match revision.change {
        Change::Start => (None, None),
        Change::Added(id) => (Some(id), None),
        Change::Removed(id) => (None, Some(id)),
        Change::Replaced { old, new } => (Some(new), Some(old)),
    };
    let fit = &revision.comparison.fit;
    json!({
        "revision": number,
        "added": added,
        "removed": removed,
        "effects": effect_ids(&fit.model),
        "parameters": parameters_json(joint, fit),
        "error": error_json(&revision.comparison),
        "lack_of_fit": revision.comparison.lack_of_fit,
    })
}
