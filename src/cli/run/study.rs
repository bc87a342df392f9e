//! Models fitted to the joints of logs: with the delays, in threads, shown and recorded.

use std::path::Path;

use serde::Serialize;

use super::estimates::{Estimates, estimated};
use super::sensor::spikes_of;
use super::session::Session;
use crate::cli::console::{Bar, Verbosity};
use crate::cli::exit::Completion;
use crate::cli::output::{Contents, Detail};
use crate::delay::Settings;
use crate::experiment::{Experiment, Joint, Other};
use crate::fit::Mended;
use crate::report::{ComparedJoint, ImprovedJoint};
use crate::study::{OtherResult, others_of};

/// Logs, the delays in them, and what came of the joints.
pub(crate) struct Study<'a, T> {
    session: Session<'a>,
    pub(crate) estimates: Estimates,
    pub(crate) settings: Settings,
    pub(crate) result: T,
}

/// What work on the joints begins with.
#[derive(Clone, Copy)]
pub(crate) struct StudyContext<'a> {
    session: &'a Session<'a>,
    pub(crate) joints: &'a [Joint],
    pub(crate) estimates: &'a Estimates,
    /// The joints that are not asked for.
    pub(crate) others: &'a [Other<'a>],
    pub(crate) settings: &'a Settings,
}

impl<'a, T: Send> Study<'a, T> {
    /// Estimates the delays by `settings`, shows them, and does `work` with them.
    pub(crate) fn of(
        session: Session<'a>,
        settings: &Settings,
        work: impl FnOnce(StudyContext<'_>) -> T + Send,
    ) -> anyhow::Result<Self> {
        let settings = session.in_samples(settings);
        let (estimates, result) = session.in_threads(|| {
            let estimates = session.estimates(&settings);
            let result = {
                let of_others = session.estimates_of_others(&settings);
                let others = others_of(&session.experiment.others, &of_others);
                let context = StudyContext {
                    others: &others,
                    ..StudyContext::of(&session, &estimates, &settings)
                };
                context.show(&[], &[], None)?;
                work(context)
            };
            anyhow::Ok((estimates, result))
        })??;
        Ok(Self { session, estimates, settings, result })
    }
}

impl<'a> StudyContext<'a> {
    fn of(session: &'a Session<'a>, estimates: &'a Estimates, settings: &'a Settings) -> Self {
        let joints = &session.experiment.joints;
        Self { session, joints, estimates, others: &[], settings }
    }

    /// The logs.
    pub(crate) fn experiment(&self) -> &'a Experiment {
        &self.session.experiment
    }

    /// A bar that counts the fits of what is being done.
    pub(crate) fn bar(&self, what: &'static str) -> Bar {
        Bar::new(self.verbosity(), what, "fits", 0)
    }

    pub(crate) fn verbosity(&self) -> Verbosity {
        self.session.verbosity()
    }

    /// Whether a viewer shows it.
    pub(crate) fn is_shown(&self) -> bool {
        self.session.stream.is_open()
    }

    /// Shows `models` and `revisions` beside the decisions, in a viewer; of one joint alone
    /// where it is named.
    pub(crate) fn show(
        &self,
        models: &[ComparedJoint<'_>],
        revisions: &[ImprovedJoint<'_>],
        joint: Option<&str>,
    ) -> anyhow::Result<()> {
        if !self.is_shown() {
            return Ok(());
        }
        let stream = &self.session.stream;
        self.with_contents(models, revisions, |contents| stream.send(contents, joint))
    }

    fn with_contents(
        &self,
        models: &[ComparedJoint<'_>],
        revisions: &[ImprovedJoint<'_>],
        take: impl FnOnce(&Contents<'_>) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let Self { session: Session { experiment, command, .. }, estimates, settings, .. } = *self;
        take(&Contents {
            command,
            joints: &estimated(experiment, estimates),
            settings,
            also: &self.session.beside,
            sources: &experiment.sources,
            reading: &experiment.options,
            models,
            revisions,
            detail: Detail::Auto,
        })
    }
}

impl<'a, T, E> Study<'a, Result<T, E>> {
    /// The study, where its work has not failed.
    pub(crate) fn transpose(self) -> Result<Study<'a, T>, E> {
        let Self { session, estimates, settings, result } = self;
        Ok(Study { session, estimates, settings, result: result? })
    }
}

impl<T> Study<'_, T> {
    /// The logs.
    pub(crate) fn experiment(&self) -> &Experiment {
        &self.session.experiment
    }

    pub(crate) fn verbosity(&self) -> Verbosity {
        self.session.verbosity()
    }

    /// Results that are shown beside the delays.
    pub(crate) fn beside(&self) -> &[OtherResult] {
        &self.session.beside
    }

    /// Records `models` and `revisions` beside the decisions, and shows them.
    pub(crate) fn record(
        &self,
        path: Option<&Path>,
        models: &[ComparedJoint<'_>],
        revisions: &[ImprovedJoint<'_>],
    ) -> anyhow::Result<()> {
        let context = StudyContext::of(&self.session, &self.estimates, &self.settings);
        if let Some(path) = path {
            let verbosity = self.verbosity();
            context
                .with_contents(models, revisions, |contents| contents.record(path, verbosity))?;
        }
        context.show(models, revisions, None)
    }

    /// Says what failed, and how the logs were read, prints the results, and ends what viewers are sent.
    pub(crate) fn end<J: Serialize>(
        &self,
        failures: &[String],
        text: impl FnOnce() -> String,
        json: impl FnOnce() -> J,
    ) -> anyhow::Result<Completion> {
        self.session.warn(failures, &notes_on_models(&self.experiment().joints));
        self.session.end(Completion::without(failures), text, json)
    }
}

/// What models are not held against in the records of `joints`.
fn notes_on_models(joints: &[Joint]) -> Vec<String> {
    let note = |joint: &Joint| {
        let spikes = spikes_of(joint).map(|spikes| format!("{spikes}, which no error counts"));
        let noise = joint.trials.property::<Mended>().has_noisy_input.then(|| {
            format!(
                "joint `{}`: the input has noise or glitches: models take the levels that it holds",
                joint.name
            )
        });
        spikes.into_iter().chain(noise)
    };
    joints.iter().flat_map(note).collect()
}
