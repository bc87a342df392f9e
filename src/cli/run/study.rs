//! Models fitted to the joints of logs: with the delays, in threads, shown and recorded.

use std::ops::Deref;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::estimates::{Estimates, estimated, spikes_of};
use super::session::Session;
use crate::cli::args::{DataArgs, ResultArgs};
use crate::cli::console::Bar;
use crate::cli::failure::Completion;
use crate::cli::output::{OutputKind, Outputs, of_delays};
use crate::delay::Settings;
use crate::experiment::{Joint, Other};
use crate::fit::Mended;
use crate::report::{ComparedJoint, ImprovedJoint, Recording};
use crate::study::others_of;

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
