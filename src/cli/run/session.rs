//! A command on logs, from reading them to its exit status.

use serde::Serialize;

use super::estimates::Estimates;
use crate::batch::Threads;
use crate::cli::args::{DataArgs, OwnSettings, RunArgs};
use crate::cli::console::{Bar, Verbosity, message, warn};
use crate::cli::exit::Completion;
use crate::cli::viewer::Stream;
use crate::delay::{Automatic, Settings};
use crate::experiment::{Experiment, Joint, ReadOptions};
use crate::study::{OtherResult, Review, estimate_each};

/// Logs that were read, and where what becomes of them goes.
pub(crate) struct Session<'a> {
    pub(crate) experiment: Experiment,
    pub(crate) stream: Stream,
    /// The name of the command.
    pub(crate) command: &'static str,
    review: Review,
    /// Results that are shown beside the delays.
    pub(super) beside: Vec<OtherResult>,
    own: OwnSettings,
    run: &'a RunArgs,
}

impl<'a> Session<'a> {
    /// Reads `data` for `command`, also of the joints that are not asked for what they draw from
    /// the supply that all share.
    pub(crate) fn with_others(
        command: &'static str,
        data: &DataArgs,
        run: &'a RunArgs,
        stream: Stream,
    ) -> anyhow::Result<Self> {
        let options = ReadOptions { others: true, ..data.options()? };
        Self::reading(command, data, &options, (run, stream))
    }

    /// Reads `data` for `command`.
    pub(crate) fn begin(
        command: &'static str,
        data: &DataArgs,
        run: &'a RunArgs,
        stream: Stream,
    ) -> anyhow::Result<Self> {
        Self::reading(command, data, &data.options()?, (run, stream))
    }

    fn reading(
        command: &'static str,
        data: &DataArgs,
        options: &ReadOptions,
        (run, stream): (&'a RunArgs, Stream),
    ) -> anyhow::Result<Self> {
        let _bar = Bar::spinner(run.verbosity(), "reading");
        let own = OwnSettings::of(options)?;
        let experiment = data.read_with(options)?;
        Ok(Self {
            experiment,
            stream,
            command,
            review: Review::default(),
            beside: Vec::new(),
            own,
            run,
        })
    }

    /// What reviewers said of the decisions overrides the conditions.
    pub(crate) fn reviewed(self, review: Review) -> Self {
        Self { review, ..self }
    }

    /// What is shown beside the delays.
    pub(crate) fn with_results(self, beside: Vec<OtherResult>) -> Self {
        Self { beside, ..self }
    }

    /// Applies what reviewers said, and warns of what could not be applied.
    fn apply_review(&self, estimates: &mut Estimates) {
        let notes = self.review.apply(&self.experiment.joints, estimates);
        warn(&notes.iter().map(ToString::to_string).collect::<Vec<_>>());
    }

    /// The settings that joints have of their own.
    pub(crate) fn own(&self) -> &OwnSettings {
        &self.own
    }

    pub(crate) fn verbosity(&self) -> Verbosity {
        self.run.verbosity()
    }

    /// Does `work` with as many threads as are to be used.
    pub(crate) fn in_threads<T: Send>(&self, work: impl FnOnce() -> T + Send) -> anyhow::Result<T> {
        self.run.in_threads(work)
    }

    /// `settings` in samples, where all trials of the logs have one period.
    pub(crate) fn in_samples(&self, settings: &Settings) -> Settings {
        settings.in_samples(self.experiment.joints.iter().flat_map(|joint| &joint.trials))
    }

    /// The delays of each joint with these settings, or with its own.
    fn estimated(&self, settings: &Settings, automatic: Automatic, bar: &Bar) -> Estimates {
        self.estimated_of(&self.experiment.joints, (settings, automatic), bar)
    }

    fn estimated_of(
        &self,
        joints: &[Joint],
        (settings, automatic): (&Settings, Automatic),
        bar: &Bar,
    ) -> Estimates {
        let asked = (settings.clone(), automatic);
        let of_joint = |joint: &Joint| self.own.of_joint(joint, &asked);
        estimate_each(joints, of_joint, || bar.step(), &Threads)
    }

    /// The delays of other joints, estimated as those of the logs.
    pub(crate) fn estimates_of(
        &self,
        joints: &[Joint],
        asked: (&Settings, Automatic),
    ) -> Estimates {
        let bar = Bar::new(self.verbosity(), "estimating", "trials", trials(joints));
        self.estimated_of(joints, asked, &bar)
    }

    /// The delays of the joints that are not asked for.
    pub(crate) fn estimates_of_others(&self, settings: &Settings) -> Estimates {
        let (others, automatic) = (&self.experiment.others, Automatic::default());
        let bar = Bar::new(self.verbosity(), "estimating", "trials", trials(others));
        self.estimated_of(others, (settings, automatic), &bar)
    }

    /// The delays of each joint.
    pub(crate) fn estimates(&self, settings: &Settings) -> Estimates {
        let bar = self.estimating(1);
        let mut estimates = self.estimated(settings, Automatic::default(), &bar);
        self.apply_review(&mut estimates);
        estimates
    }

    /// The delays of each joint with each of the settings, of which some are chosen for each
    /// joint from its own record.
    pub(crate) fn estimates_by_each(
        &self,
        settings: &[Settings],
        automatic: Automatic,
    ) -> Vec<Estimates> {
        let bar = self.estimating(settings.len());
        let one = |settings| self.estimated(settings, automatic, &bar);
        let mut all: Vec<Estimates> = settings.iter().map(one).collect();
        // A review is of the answer, not of what is reported beside it.
        if let Some(answer) = all.first_mut() {
            self.apply_review(answer);
        }
        all
    }

    /// A bar for all trials, each estimated `times` times.
    fn estimating(&self, times: usize) -> Bar {
        let trials = trials(&self.experiment.joints);
        Bar::new(self.verbosity(), "estimating", "trials", trials * times as u64)
    }

    /// Warns of what failed, and says what a person should know: `notes` beside those on the
    /// logs themselves.
    pub(crate) fn warn(&self, failures: &[String], notes: &[String]) {
        warn(failures);
        if self.verbosity() == Verbosity::Normal {
            let own = self.own.notes(&self.experiment);
            for note in self.experiment.notes.iter().chain(notes).chain(&own) {
                message("note", note);
            }
        }
    }

    /// Prints the results, and ends what viewers are sent.
    pub(crate) fn end<J: Serialize>(
        &self,
        completion: Completion,
        text: impl FnOnce() -> String,
        json: impl FnOnce() -> J,
    ) -> anyhow::Result<Completion> {
        self.run.print(text, json)?;
        self.stream.close(completion, self.run.verbosity())
    }
}

/// How many trials these joints have.
fn trials(joints: &[Joint]) -> u64 {
    joints.iter().map(|joint| joint.trials.len() as u64).sum()
}
