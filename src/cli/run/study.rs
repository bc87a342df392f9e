//! Models fitted to the joints of logs: with the delays, in threads, shown and recorded; their revisions as
//! they come, in recordings, and in the model file.

use std::ops::Deref;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::estimates::{Estimates, estimated, spikes_of};
use super::session::Session;
use crate::cli::args::{DataArgs, ResultArgs, check_models, name_of};
use crate::cli::console::{Bar, Interrupt};
use crate::cli::failure::{Completion, joint_left_out, nothing_usable, read_failures};
use crate::cli::output::{OutputKind, Outputs, of_delays};
use crate::delay::Settings;
use crate::diagnosis::Comparison;
use crate::experiment::{Joint, Other, Source};
use crate::explain::{Change, Explanation, Improvement, Revision as Step, Verdict};
use crate::fit::Mended;
use crate::model::{Fitted, FittedParameter, JointModel, LogHash, ModelFile, Revision};
use crate::report::improve::{gone, revision_line};
use crate::report::ladder::errors_of;
use crate::report::{Before, ComparedJoint, Finding, History, ImprovedJoint, Recording};
use crate::study::others_of;
use crate::wording::parameter_units;

/// Logs and the delays in them.
pub(crate) struct Study<'a> {
    session: Session<'a>,
    pub(crate) estimates: Estimates,
    /// Of the joints that are not asked for.
    of_others: Estimates,
    pub(crate) settings: Settings,
}

impl<'a> Deref for Study<'a> {
    type Target = Session<'a>;

    fn deref(&self) -> &Session<'a> {
        &self.session
    }
}

impl<'a> Study<'a> {
    /// The logs and delays for a `command` that fits models. Before that it refuses outputs that cannot be
    /// written, where the model file `written` is one and those of `inputs` are read, too.
    pub(crate) fn begin(
        command: &'static str,
        data: &DataArgs,
        args: &'a ResultArgs,
        (written, inputs): (Option<&Path>, Vec<PathBuf>),
    ) -> anyhow::Result<Self> {
        let outputs = Outputs::default().with(OutputKind::Recording, &args.recording);
        let outputs = outputs.with(OutputKind::Toml, written);
        outputs.check(&[data.files(), inputs].concat())?;
        let stream = args.stream.open(args.run.verbosity())?;
        let options = data.options_with_others()?;
        let session = Session::begin(command, data, &options, (&args.run, stream))?;
        let study = Self::of(session, &Settings { lines: args.lines(), ..Settings::default() })?;
        for note in study.joints().iter().filter_map(note_on_spikes) {
            study.verbosity().say("note", note);
        }
        Ok(study)
    }

    /// Estimates the delays by `settings`, and shows them.
    pub(crate) fn of(session: Session<'a>, settings: &Settings) -> anyhow::Result<Self> {
        let settings = session.in_samples(settings);
        let asked = std::slice::from_ref(&settings);
        let [estimates, of_others] = session.in_threads(|| {
            let others = &session.experiment.others;
            [session.estimates(asked), session.estimates_of(others, asked)]
                .map(|mut all| all.pop().unwrap_or_default())
        })?;
        let study = Self { session, estimates, of_others, settings };
        study.show(&[], &[], None)?;
        Ok(study)
    }

    /// Does `work` with a bar that counts the fits of `what`, and with the joints that are not asked for.
    pub(crate) fn work<T: Send>(
        &self,
        what: &'static str,
        work: impl FnOnce(&Bar, &[Other<'_>]) -> T + Send,
    ) -> anyhow::Result<T> {
        let others = others_of(&self.session.experiment.others, &self.of_others);
        self.session.in_threads(|| work(&Bar::new(self.verbosity(), what, "fits", 0), &others))
    }

    /// The joints of the logs.
    pub(crate) fn joints(&self) -> &[Joint] {
        &self.session.experiment.joints
    }

    /// Shows `models` and `revisions` beside the decisions, in a viewer; of one joint alone
    /// where it is named.
    pub(crate) fn show(
        &self,
        models: &[ComparedJoint<'_>],
        revisions: &[ImprovedJoint<'_>],
        joint: Option<&str>,
    ) -> anyhow::Result<()> {
        if !self.stream.is_open() {
            return Ok(());
        }
        self.with_recording(models, revisions, |recording| self.stream.send(recording, joint))
    }

    fn with_recording(
        &self,
        models: &[ComparedJoint<'_>],
        revisions: &[ImprovedJoint<'_>],
        take: impl FnOnce(&Recording<'_>) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let Session { experiment, command, beside, .. } = &self.session;
        let joints = estimated(experiment, &self.estimates);
        let recording = of_delays(command, experiment, (&joints, &self.settings));
        take(&Recording { also: beside, models, revisions, ..recording })
    }

    /// Records `models` and `revisions` beside the decisions, and shows them.
    pub(crate) fn record(
        &self,
        path: Option<&Path>,
        models: &[ComparedJoint<'_>],
        revisions: &[ImprovedJoint<'_>],
    ) -> anyhow::Result<()> {
        if let Some(path) = path {
            let record = |recording: &Recording<'_>| recording.record(path, self.verbosity());
            self.with_recording(models, revisions, record)?;
        }
        self.show(models, revisions, None)
    }

    /// Records the revisions of models, each as a model too, and shows them.
    pub(crate) fn record_revisions(
        &self,
        path: Option<&Path>,
        improved: &[ImprovedJoint<'_>],
    ) -> anyhow::Result<()> {
        let last = improved.iter().map(|joint| joint.finding.compared.revision).max().unwrap_or(0);
        let names: Vec<String> = (0..=last).map(|number| format!("revision {number}")).collect();
        let compared = improved.iter().flat_map(ImprovedJoint::compared);
        let models = compared.filter_map(|one| {
            let model = names.get(one.revision as usize)?;
            Some(ComparedJoint { model, ..one })
        });
        let models: Vec<_> = models.collect();
        self.record(path, &models, improved)
    }

    /// Says what failed, and how the logs were read, prints the results, and ends what viewers are sent.
    pub(crate) fn end<J: Serialize>(
        &self,
        failures: &[String],
        text: impl FnOnce() -> String,
        json: impl FnOnce() -> J,
    ) -> anyhow::Result<Completion> {
        let notes: Vec<String> = self.joints().iter().filter_map(note_on_noisy_input).collect();
        self.session.warn(failures, &notes);
        self.session.end(Completion::without(failures), text, json)
    }
}

/// The spikes that fits and errors of models leave out, where there are any.
fn note_on_spikes(joint: &Joint) -> Option<String> {
    let spikes = spikes_of(joint)?;
    Some(format!("joint `{}`: {spikes}: excluded from fits and errors", joint.name))
}

/// That models do not take the input of `joint` as it was logged, where that is so.
fn note_on_noisy_input(joint: &Joint) -> Option<String> {
    joint.trials.property::<Mended>().has_noisy_input.then(|| {
        format!(
            "joint `{}`: the input has noise or glitches: models use the levels at which it is held",
            joint.name
        )
    })
}

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
