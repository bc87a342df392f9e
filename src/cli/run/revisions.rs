//! The revisions of models: as they come, in recordings, and in the model file.

use std::path::Path;

use super::study::Study;
use crate::cli::args::{check_models, name_of};
use crate::cli::console::Interrupt;
use crate::cli::failure::{joint_left_out, nothing_usable, read_failures};
use crate::diagnosis::Comparison;
use crate::experiment::{Joint, Source};
use crate::explain::{Change, Explanation, Improvement, Revision as Step, Verdict};
use crate::model::{Fitted, FittedParameter, JointModel, LogHash, ModelFile, Revision};
use crate::report::improve::{gone, revision_line};
use crate::report::ladder::errors_of;
use crate::report::{Before, ComparedJoint, Finding, History, ImprovedJoint};
use crate::wording::parameter_units;

/// What the models of a study begin with, and what they are called.
pub(crate) struct Start<'a> {
    study: &'a Study<'a>,
    file: &'a ModelFile,
    /// The name of the model in the output.
    name: String,
    /// Per joint, what follows the effect in the command that adds one.
    arguments: Vec<String>,
}

impl<'a> Start<'a> {
    /// The models of `file`, which is at `path`; refuses one that is of other joints than the logs.
    pub(crate) fn of(
        study: &'a Study<'a>,
        file: &'a ModelFile,
        path: Option<&Path>,
        arguments: Vec<String>,
    ) -> anyhow::Result<Self> {
        check_models(file, study.joints(), study.verbosity())?;
        Ok(Self { study, file, name: name_of(path), arguments })
    }

    /// The model with which a joint begins; a plain integrator where there is none.
    pub(crate) fn model(&self, joint: &Joint) -> Option<JointModel> {
        self.file.joint(&joint.name).cloned()
    }

    /// The number of its revision.
    fn revision(&self, joint: &Joint) -> u32 {
        self.file.revision(&joint.name).unwrap_or(0)
    }

    /// Says what a revision of the joint at `index` changed.
    pub(crate) fn say(&self, index: usize, revision: &Step) {
        if let Some(joint) = self.study.joints().get(index) {
            self.study.verbosity().say("improving", revision_line(joint, revision));
        }
    }

    /// What is to be said of the joint at `index`, which was improved.
    pub(crate) fn improved<'b>(
        &'b self,
        index: usize,
        joint: &'b Joint,
        improvement: &'b Improvement,
    ) -> Option<ImprovedJoint<'b>> {
        let Self { study, file, name, arguments } = self;
        let Improvement { revisions, verdict, attribution } = improvement;
        let last = revisions.last()?;
        let first_revision = self.revision(joint);
        let revision = (first_revision..).zip(revisions).last()?.0;
        let first = revisions.first().filter(|_| revisions.len() > 1);
        let finding = Finding {
            compared: ComparedJoint { joint, model: name, revision, comparison: &last.comparison },
            verdict: *verdict,
            ranking: last.ranking.as_slice(),
            add_arguments: arguments.get(index).map_or("", String::as_str),
            before: first.map(|first| Before::Model(&first.comparison)),
            attribution: Some(attribution),
            delays: study.estimates.get(index).and_then(|estimate| estimate.as_ref().ok()),
        };
        let improved = ImprovedJoint::of(finding, revisions);
        let history =
            History { revisions: file.history(&joint.name), fitted: file.fitted(&joint.name) };
        Some(ImprovedJoint { first_revision, history, ..improved })
    }

    /// What is to be said of each joint that has a result, and messages on the others.
    ///
    /// # Errors
    /// The first message when there is nothing else.
    pub(crate) fn outcomes<'b, E: std::error::Error + 'static>(
        &'b self,
        results: &'b [Option<Result<Improvement, E>>],
    ) -> anyhow::Result<(Vec<ImprovedJoint<'b>>, Vec<String>)> {
        let mut failures = read_failures(&self.study.experiment);
        let mut improved = Vec::new();
        for (index, (joint, result)) in self.study.joints().iter().zip(results).enumerate() {
            match result {
                Some(Ok(found)) => improved.extend(self.improved(index, joint, found)),
                Some(Err(error)) => failures.push(joint_left_out(&joint.name, error)),
                None => failures.push(format!("joint `{}` has no model", joint.name)),
            }
        }
        match failures.first() {
            Some(first) if improved.is_empty() => Err(nothing_usable(Some(first))),
            _ => Ok((improved, failures)),
        }
    }

    /// The file with all revisions of all joints, and with the verdict on each where `judged` has one. A
    /// joint that has no new one stays as it is.
    pub(crate) fn revised(
        &self,
        improved: &[ImprovedJoint<'_>],
        judged: impl Fn(&ImprovedJoint<'_>) -> Option<Verdict>,
    ) -> anyhow::Result<ModelFile> {
        let Self { study, file, .. } = self;
        let sources = &study.experiment.sources;
        let revised_for =
            |file, joint: &ImprovedJoint<'_>| revised_for(file, joint, judged(joint), sources);
        let is_known = |joint: &&ImprovedJoint<'_>| file.joint(joint.name()).is_some();
        let known = improved.iter().filter(is_known);
        let file = known.clone().try_fold((*file).clone(), &revised_for)?;
        let new = improved.iter().filter(|joint| !is_known(joint));
        let new: Vec<ModelFile> =
            new.map(|joint| revised_for(file.emptied(), joint)).collect::<anyhow::Result<_>>()?;
        Ok(file.joined(&new)?)
    }
}

/// `improved` after a search that only the limit has ended, or who pressed `interrupt`, where more is
/// missing.
pub(crate) fn ended(improved: ImprovedJoint<'_>, interrupt: Interrupt) -> ImprovedJoint<'_> {
    let verdict = improved.finding.verdict;
    let is_stopped = interrupt.was_pressed();
    let interrupted = is_stopped && verdict != Verdict::Adequate;
    let reached_limit = !is_stopped && verdict == Verdict::MissingEffect;
    ImprovedJoint { interrupted, reached_limit, ..improved }
}

/// A model and what it lacks, as the only revision.
pub(crate) fn as_it_is(explanation: Explanation) -> Improvement {
    let Explanation { base, verdict, ranking, attribution } = explanation;
    let revisions = vec![Step { change: Change::Start, comparison: base, ranking }];
    Improvement { revisions, verdict, attribution }
}

/// `file` with all revisions of a joint.
fn revised_for(
    mut file: ModelFile,
    joint: &ImprovedJoint<'_>,
    verdict: Option<Verdict>,
    sources: &[Source],
) -> anyhow::Result<ModelFile> {
    let pairs = (joint.first_revision + 1..).zip(joint.revisions.windows(2));
    for (number, pair) in pairs {
        let [before, after] = pair else { continue };
        let model = &after.comparison.fit.model;
        let added = match after.change {
            Change::Added(id) | Change::Replaced { new: id, .. } => Some(id),
            Change::Start | Change::Removed(_) => None,
        };
        let entry = entry(number, added, &before.comparison, &after.comparison);
        file = file.revised(joint.name(), model, &entry)?;
    }
    let is_new = file.joint(joint.name()).is_none();
    let compared = joint.finding.compared;
    if is_new {
        file = file.refitted(joint.name(), &compared.comparison.fit.model)?;
    }
    if is_new || joint.revisions.len() > 1 {
        let first = joint.numbered().next().map(|(number, first)| (number, &first.comparison));
        file = with_fit(&file, &compared, first, verdict, sources)?;
    }
    Ok(file)
}

/// `file` with what the model of a joint was fitted to; `first` is the model that this work began
/// with, and the number of that revision.
fn with_fit(
    file: &ModelFile,
    compared: &ComparedJoint<'_>,
    first: Option<(u32, &Comparison)>,
    verdict: Option<Verdict>,
    sources: &[Source],
) -> anyhow::Result<ModelFile> {
    let ComparedJoint { joint, comparison, .. } = compared;
    let known = file.fitted(&joint.name).and_then(|fitted| fitted.start.clone());
    // The errors before a history that this work only goes on with are not known.
    let oldest = file.history(&joint.name).first();
    let begins = |number: u32| oldest.is_none_or(|entry| entry.revision == number + 1);
    let start = first.filter(|(number, _)| begins(*number)).map(|(_, first)| errors_of(first));
    let fit = &comparison.fit;
    let units = parameter_units(joint, &fit.model);
    let parameters = fit.parameters.iter().zip(units).map(|(parameter, unit)| {
        let known = FittedParameter { std_error: parameter.std_error, unit };
        (parameter.name.clone(), known)
    });
    let fitted = Fitted {
        logs: log_hashes(sources),
        input_unit: joint.input_unit.clone(),
        output_unit: joint.output_unit.clone(),
        sensor_noise: comparison.sensor_noise,
        verdict: verdict.map(|verdict| verdict.id().to_owned()),
        start: known.or(start),
        parameters: parameters.collect(),
    };
    Ok(file.fitted_to(&joint.name, &fitted)?)
}

/// The logs that were read, as a model file names them.
pub(crate) fn log_hashes(sources: &[Source]) -> Vec<LogHash> {
    let hash = |source: &Source| LogHash {
        file: source.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        sha256: source.sha256.clone(),
    };
    sources.iter().map(hash).collect()
}

/// What the history says of `after`, to which `added` came.
fn entry(revision: u32, added: Option<&str>, before: &Comparison, after: &Comparison) -> Revision {
    let removed = gone(&before.fit.model, &after.fit.model);
    Revision {
        revision,
        added: added.map(str::to_owned),
        removed: removed.first().map(|id| (*id).to_owned()),
        errors: errors_of(after),
    }
}
