//! `explain`, `add` and `improve` as text and JSON: verdict, ranking, the ladder of errors, and what is
//! concluded.

use serde_json::{Map, Value, json};

use super::compare::{compare_table, error_json, errors_note, horizons, model_json};
use super::conclusion::{Conclusion, Passage, Topic};
use super::finding::{Consequence, candidate_json, ranking_table};
use super::json::{document, joined};
use super::ladder::{LadderRow, change_in_words, errors_of, figures, ladder_table};
use super::parameters::{model_text, parameters_json};
use super::{Before, ComparedJoint, Finding, History};
use crate::diagnosis::ErrorFigures;
use crate::experiment::Joint;
use crate::explain::{Candidate, Change, Contribution, Revision, Verdict};
use crate::model::JointModel;
use crate::numerics::to_decimals;
use crate::wording::{effect_ids, number, p_text, with_unit};

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

/// For each joint the verdict, the ranking and what they mean.
pub(crate) fn explain_text(findings: &[Finding<'_>]) -> String {
    let joint = |finding: &Finding<'_>| {
        let ComparedJoint { joint, comparison, .. } = finding.compared;
        let conclusion = finding.conclusion();
        let ranking = match finding.ranking {
            [] => String::new(),
            ranking => format!("{}\n", ranking_table(joint, ranking)),
        };
        let (text, model) = (conclusion.printed(), model_text(joint, comparison, None));
        format!("{}\n{ranking}\n{text}\n{model}\n", conclusion.headline)
    };
    let joints: Vec<String> = findings.iter().map(joint).collect();
    let horizon = horizons(findings.iter().map(|finding| finding.compared));
    format!(
        "{}\nroot-mean-square errors, less the mean of each run between restarts, {horizon}; ± is \
         one standard error\n",
        joints.join("\n\n")
    )
}

/// Verdict, ranking and words.
pub(super) fn finding_json(finding: &Finding<'_>, conclusion: &Conclusion) -> Value {
    let joint = finding.compared.joint;
    let candidates = finding.ranking.iter();
    json!({
        "verdict": finding.verdict.id(),
        "ranking": candidates.map(|candidate| candidate_json(joint, candidate)).collect::<Value>(),
        "conclusion": conclusion_json(&conclusion.headline, &finding.consequence()),
        "headline": conclusion.headline,
        "in_words": conclusion.sentences(),
        "commands": conclusion.commands,
    })
}

/// What was found, how much it explains, and what remains.
pub(super) fn conclusion_json(headline: &str, of: &Consequence<'_>) -> Value {
    let all = parameters_json(of.joint, of.fit);
    let found = |one: &Contribution| {
        let prefix = format!("{}.", one.effect);
        let own = all.iter().filter(|(name, _)| name.starts_with(&prefix));
        let own = own.map(|(name, value)| (name.clone(), value.clone()));
        json!({
            "effect": one.effect,
            "error_share_percent": 100.0 * one.error_share,
            "alternatives": one.alternative_names(),
            "parameters": own.collect::<Map<_, _>>(),
        })
    };
    let remaining = |error: ErrorFigures| {
        json!({
            "rmse": error.rmse,
            "times_sensor_noise": of.times_noise(),
            "percent_of_motion": 100.0 - error.fit_percent,
        })
    };
    let known = of.attribution.iter();
    json!({
        "headline": headline,
        "found": known.clone().flat_map(|one| &one.found).map(found).collect::<Value>(),
        "doubtful": known.clone().flat_map(|one| &one.doubtful).map(found).collect::<Value>(),
        "refinements": known.flat_map(|one| &one.refinements).collect::<Vec<_>>(),
        "explained_percent": of.explained().map(|share| 100.0 * share),
        "sensor_noise": of.sensor_noise,
        "remaining": of.after.map(remaining),
    })
}

/// The document of `explain --format json`.
pub(crate) fn explain_json(findings: &[Finding<'_>], failures: &[String]) -> Value {
    let joint = |finding: &Finding<'_>| {
        let found = finding_json(finding, &finding.conclusion());
        joined([model_json(&finding.compared), found])
    };
    let joints: Value = findings.iter().map(joint).collect();
    document("tauscope/explain/1", json!({ "joints": joints, "failures": failures }))
}

/// A joint whose model got another effect.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AddedJoint<'a> {
    /// The model before and after, as revisions.
    pub(crate) improved: ImprovedJoint<'a>,
    /// Id of the effect.
    pub(crate) effect: &'static str,
    /// Probability of so much or more when the effect is not there; none where the models do not nest.
    pub(crate) p_value: Option<f64>,
}

/// Ids of the effects that `after` has no more.
pub(crate) fn gone(before: &JointModel, after: &JointModel) -> Vec<&'static str> {
    let left = effect_ids(after);
    effect_ids(before).into_iter().filter(|id| !left.contains(id)).collect()
}

impl<'a> AddedJoint<'a> {
    /// The model before and after.
    fn compared(&self) -> [ComparedJoint<'a>; 2] {
        let after = self.improved.finding.compared;
        [self.improved.compared().next().unwrap_or(after), after]
    }

    /// `boom: with dead_band the error falls from 2.9 to 0.4 deg, by 87 %`.
    fn sentence(&self) -> String {
        let error = |of: ComparedJoint<'_>| of.comparison.judged().map_or(f64::NAN, |it| it.rmse);
        let ([before, after], joint) = (self.compared().map(error), self.improved.name());
        let unit = self.improved.finding.compared.joint.output_unit.as_deref();
        let p_value = self.p_value.map_or_else(String::new, |p| {
            let verdict = if p < 0.01 { "" } else { ": not significant" };
            format!(" ({}{verdict})", p_text(p))
        });
        format!("{joint}: with {} the error {}{p_value}", self.effect, change(before, after, unit))
    }
}

/// `falls from 2.9 to 0.4 deg, by 87 %`; `stays 0 deg` where there is nothing to divide by.
fn change(before: f64, after: f64, unit: Option<&str>) -> String {
    let (from, to) = (number(before), with_unit(after, unit));
    let taken = 100.0 * (1.0 - after / before);
    if before.total_cmp(&after).is_eq() {
        return format!("stays {to}");
    }
    let falls = if after < before { "falls" } else { "rises" };
    if !taken.is_finite() {
        return format!("{falls} from {from} to {to}");
    }
    let share = to_decimals(taken.abs(), 1);
    format!("{falls} from {from} to {to}, by {share} %")
}

/// Each joint's model before and after, and what it means.
pub(crate) fn add_text(joints: &[AddedJoint<'_>]) -> String {
    let revisions = joints.iter().flat_map(|joint| joint.improved.numbered());
    // `revision 0, integrator` and `revision 1, + dead_band`.
    let label = |(number, step)| format!("revision {number}, {}", change_in_words(step));
    let labels: Vec<String> = revisions.map(label).collect();
    let models = joints.iter().flat_map(|joint| joint.improved.compared());
    let named = models.zip(&labels).map(|(one, label)| ComparedJoint { model: label, ..one });
    let compared: Vec<_> = named.collect();
    let sentences: Vec<_> = joints.iter().map(AddedJoint::sentence).collect();
    format!("{}\n{}\n", compare_table(&compared), sentences.join("\n"))
}

/// The document of `add --format json`.
pub(crate) fn add_json(model_file: &str, joints: &[AddedJoint<'_>], failures: &[String]) -> Value {
    let joint = |added: &AddedJoint<'_>| {
        let [before, after] = added.compared();
        let model = &before.comparison.fit.model;
        let change = json!({
            "added": added.effect,
            "removed": gone(model, &after.comparison.fit.model),
            "p_value": added.p_value,
            "before": {
                "revision": before.revision,
                "effects": effect_ids(model),
                "error": error_json(before.comparison),
            },
            "conclusion": conclusion_json(&added.sentence(), &added.improved.finding.consequence()),
        });
        joined([model_json(&after), change])
    };
    let joints: Value = joints.iter().map(joint).collect();
    let facts = json!({ "model_file": model_file, "joints": joints, "failures": failures });
    document("tauscope/add/1", facts)
}
