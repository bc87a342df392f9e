//! A command on logs, from reading them to its exit status.

use std::sync::Once;

use serde::Serialize;

use super::estimates::Estimates;
use crate::batch::Threads;
use crate::cli::args::{DataArgs, OwnSettings, RunArgs, read};
use crate::cli::console::{Bar, Verbosity, warn};
use crate::cli::failure::Completion;
use crate::cli::viewer::Stream;
use crate::delay::Settings;
use crate::experiment::{Experiment, Joint, ReadOptions};
use crate::study::{OtherResult, Review, estimate_each};

/// Logs that were read, and where what becomes of them goes.
pub(crate) struct Session<'a> {
    pub(crate) experiment: Experiment,
    pub(crate) stream: Stream,
    /// The name of the command.
    pub(crate) command: &'static str,
    /// What reviewers said of the decisions, which overrides the conditions.
    review: Review,
    /// Results that are shown beside the delays.
    pub(crate) beside: Vec<OtherResult>,
    own: OwnSettings,
    run: &'a RunArgs,
    notes: Once,
}

impl<'a> Session<'a> {
    /// Reads `data` for `command`.
    pub(crate) fn begin(
        command: &'static str,
        data: &DataArgs,
        options: &ReadOptions,
        (run, stream): (&'a RunArgs, Stream),
    ) -> anyhow::Result<Self> {
        let _bar = Bar::spinner(run.verbosity(), "reading");
        let own = OwnSettings::of(options)?;
        let experiment = read(data.given(), options)?;
        let (review, beside) = (Review::default(), Vec::new());
        let notes = Once::new();
        Ok(Self { experiment, stream, command, review, beside, own, run, notes })
    }

    /// With what reviewers said of the decisions.
    pub(crate) fn reviewed(self, review: Review) -> Self {
        Self { review, ..self }
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

    /// The delays of `joints` with each of the settings, or with their own.
    pub(crate) fn estimates_of(&self, joints: &[Joint], settings: &[Settings]) -> Vec<Estimates> {
        let trials = joints.iter().map(|joint| joint.trials.len()).sum::<usize>();
        let runs = (trials * settings.len()) as u64;
        let bar = Bar::new(self.verbosity(), "estimating", "trials", runs);
        let one = |settings: &Settings| {
            let of_joint = |joint: &Joint| self.own.of_joint(joint, settings);
            estimate_each(joints, of_joint, || bar.step(), &Threads)
        };
        settings.iter().map(one).collect()
    }

    /// The delays of each joint with each of the settings.
    pub(crate) fn estimates(&self, settings: &[Settings]) -> Vec<Estimates> {
        let mut all = self.estimates_of(&self.experiment.joints, settings);
        // A review is of the answer, not of what is reported beside it.
        if let Some(answer) = all.first_mut() {
            let notes = self.review.apply(&self.experiment.joints, answer);
            warn(&notes);
        }
        all
    }

    /// Warns of what failed, and says what a person should know: `notes` beside those on the
    /// logs themselves.
    pub(crate) fn warn(&self, failures: &[String], notes: &[String]) {
        warn(failures);
        self.say_notes();
        for note in notes.iter().chain(&self.own.notes(&self.experiment)) {
            self.verbosity().say("note", note);
        }
    }

    /// Says how the logs were read, once.
    pub(crate) fn say_notes(&self) {
        self.notes.call_once(|| {
            for note in &self.experiment.notes {
                self.verbosity().say("note", note);
            }
        });
    }

    /// Prints the results, and ends what viewers are sent.
    pub(crate) fn end<J: Serialize>(
        &self,
        completion: Completion,
        text: impl FnOnce() -> String,
        json: impl FnOnce() -> J,
    ) -> anyhow::Result<Completion> {
        self.run.format.print(text, json)?;
        self.stream.close(completion, self.verbosity())
    }
}
