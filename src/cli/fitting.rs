//! The options and the way of every command that fits models.

use std::io::{StdoutLock, Write as _};
use std::path::{Path, PathBuf};

use crate::batch::{JointEstimate, Mode, Protocol, estimate_joints, with_threads};
use crate::delay::{EstimateError, Settings};
use crate::effect::{Effect, REGISTRY, find_among};
use crate::experiment::{Experiment, Joint};
use crate::fit::{Horizon, Split};
use crate::report::{ComparedJoint, EstimatedJoint, ImprovedJoint};
use anyhow::{Context as _, anyhow};
use clap::{Args, ValueEnum};

use super::data::DataArgs;
use super::progress::{Bar, Verbosity};
use super::record::{Contents, Detail};
use super::stream::{Stream, StreamArgs};
use super::terminal::{self, message};
use super::{Completion, read_failures};

/// By what rules models are judged.
#[derive(Args, Debug)]
pub(super) struct ProtocolArgs {
    /// How long a simulation runs before its angle is set to the measured one: `free`
    /// (never), `steps` (at every step of the input, in long holds every 200 samples), or
    /// seconds [default: free to compare, else steps, where an error counts where it is made]
    #[arg(long, value_name = "free|steps|SECONDS", value_parser = horizon, help_heading = "Model")]
    horizon: Option<Horizon>,

    /// Share of each trial's time that is for training, or `trials`: every third trial is
    /// for validation [default: trials from six on, else 0.7]
    #[arg(long, value_name = "SHARE|trials", value_parser = split, help_heading = "Model")]
    split: Option<Split>,
}

/// Where results go.
#[derive(Args, Debug)]
pub(super) struct ResultArgs {
    /// Record models and decisions for the Rerun viewer
    #[arg(short = 'o', long = "output", value_name = "FILE.rrd", help_heading = "Output")]
    pub(super) recording: Option<PathBuf>,

    #[command(flatten)]
    pub(super) stream: StreamArgs,

    /// How results are printed
    #[arg(long, value_enum, default_value_t = Format::Text, help_heading = "Output")]
    pub(super) format: Format,

    /// Threads to use [default: all processors]
    #[arg(long, value_name = "N", value_parser = super::data::threads, help_heading = "Output")]
    threads: Option<usize>,

    /// No progress, no notices
    #[arg(short, long, help_heading = "Output")]
    quiet: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Format {
    /// For people
    Text,
    /// JSON, schema `tauscope/<command>/1`
    Json,
}

/// Which effects are tried.
#[derive(Args, Debug)]
pub(super) struct EffectArgs {
    /// Effects that are tried, separated by commas [default: the catalogue and the
    /// candidates of the model file]
    #[arg(long, value_name = "LIST", value_delimiter = ',', help_heading = "Model")]
    effects: Vec<String>,
}

fn horizon(text: &str) -> Result<Horizon, String> {
    match text {
        "free" => Ok(Horizon::FreeRun),
        "steps" => Ok(Horizon::Steps),
        _ => {
            let seconds = text.parse().ok().filter(|s: &f64| s.is_finite() && *s > 0.0);
            seconds
                .map(Horizon::Seconds)
                .ok_or_else(|| "expected free, steps, or seconds".to_owned())
        }
    }
}

fn split(text: &str) -> Result<Split, String> {
    if text == "trials" {
        return Ok(Split::Trials);
    }
    let share = text.parse().ok().filter(|share: &f64| *share > 0.0 && *share <= 1.0);
    share
        .map(Split::Time)
        .ok_or_else(|| "expected a share above 0 and up to 1, or trials".to_owned())
}

impl ProtocolArgs {
    /// The rules, `default` being the horizon where none is asked for.
    pub(super) fn with(&self, mode: Mode, default: Horizon) -> Protocol {
        Protocol { mode, split: self.split, horizon: self.horizon.unwrap_or(default) }
    }

    /// How training and validation are told apart, where that was said.
    pub(super) fn split(&self) -> Option<Split> {
        self.split
    }

    /// The horizon in words.
    pub(super) fn horizon(&self, default: Horizon) -> String {
        self.horizon.unwrap_or(default).to_string()
    }

    /// These options as they are typed.
    pub(super) fn typed(&self) -> Vec<String> {
        let horizon = self.horizon.map(|horizon| match horizon {
            Horizon::FreeRun => "free".to_owned(),
            Horizon::Steps => "steps".to_owned(),
            Horizon::Seconds(seconds) => seconds.to_string(),
        });
        let split = self.split.map(|split| match split {
            Split::Time(share) => share.to_string(),
            Split::Trials => "trials".to_owned(),
        });
        let options = [("--horizon", horizon), ("--split", split)].into_iter();
        let given = options.filter_map(|(name, value)| Some([name.to_owned(), value?]));
        given.flatten().collect()
    }
}

impl ResultArgs {
    /// Threads, where that was said.
    pub(super) fn threads(&self) -> Option<usize> {
        self.threads
    }

    pub(super) fn verbosity(&self) -> Verbosity {
        if self.quiet { Verbosity::Quiet } else { Verbosity::Normal }
    }

    /// Whether anything is made for a viewer.
    pub(super) fn is_recorded(&self) -> bool {
        self.recording.is_some() || self.stream.is_asked()
    }
}

impl EffectArgs {
    /// The effects of the list; all of the catalogue and of `own` without one.
    pub(super) fn effects(
        &self,
        own: &[&'static dyn Effect],
    ) -> anyhow::Result<Vec<&'static dyn Effect>> {
        if self.effects.is_empty() {
            return Ok(REGISTRY.iter().chain(own).copied().collect());
        }
        let mut effects: Vec<&'static dyn Effect> = Vec::new();
        for id in &self.effects {
            let effect = find(id.trim(), own).context("--effects")?;
            if effects.iter().all(|other| other.spec().id != effect.spec().id) {
                effects.push(effect);
            }
        }
        Ok(effects)
    }
}

/// The effect `id`, of the catalogue or of `own`.
pub(super) fn find(id: &str, own: &[&'static dyn Effect]) -> anyhow::Result<&'static dyn Effect> {
    let lists = || anyhow!("`tauscope effects` lists the catalogue");
    find_among(id, own).map_err(|unknown| lists().context(unknown))
}

/// Words of a command line, each so that a shell takes it for one.
pub(super) fn quoted(words: &[String]) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_-./:=,+%@".contains(c);
    let quote = |word: &String| {
        if !word.is_empty() && word.chars().all(is_plain) {
            return word.clone();
        }
        format!("'{}'", word.replace('\'', r"'\''"))
    };
    words.iter().map(quote).collect::<Vec<_>>().join(" ")
}

/// Reads `data` and says so meanwhile.
pub(super) fn read(data: &DataArgs, verbosity: Verbosity) -> anyhow::Result<Experiment> {
    let _bar = Bar::spinner(verbosity, "reading");
    data.read()
}

/// A bar for the trials of `joints`, each estimated `times` times.
pub(super) fn estimating(joints: &[Joint], times: usize, verbosity: Verbosity) -> Bar {
    let trials: usize = joints.iter().map(|joint| joint.trials.len()).sum();
    Bar::new(verbosity, "estimating", "trials", (trials * times) as u64)
}

/// The delays of each joint.
pub(super) type Estimates = Vec<Result<JointEstimate, EstimateError>>;

/// Logs, the delays in them, and what came of the joints.
pub(super) struct Study<T> {
    pub(super) experiment: Experiment,
    estimates: Estimates,
    settings: Settings,
    stream: Stream,
    pub(super) result: T,
}

/// What work on the joints begins with.
#[derive(Clone, Copy)]
pub(super) struct Begun<'a> {
    experiment: &'a Experiment,
    pub(super) joints: &'a [Joint],
    pub(super) estimates: &'a Estimates,
    settings: &'a Settings,
    stream: &'a Stream,
}

/// Reads `data`, estimates the delays and does `work` with both; `what` that is, is shown
/// meanwhile on a bar that counts its fits.
pub(super) fn study<T: Send>(
    data: &DataArgs,
    output: &ResultArgs,
    (what, stream): (&'static str, Stream),
    work: impl FnOnce(Begun<'_>, &Bar) -> T + Send,
) -> anyhow::Result<Study<T>> {
    let verbosity = output.verbosity();
    let experiment = read(data, verbosity)?;
    let joints = experiment.joints.as_slice();
    let settings = Settings::default();
    let all = || -> anyhow::Result<_> {
        let bar = estimating(joints, 1, verbosity);
        let estimates = estimate_joints(joints, &settings, || bar.step());
        drop(bar);
        let (estimates, settings, stream) = (&estimates, &settings, &stream);
        let begun = Begun { experiment: &experiment, joints, estimates, settings, stream };
        begun.show(&[], &[], None)?;
        let bar = Bar::new(verbosity, what, "fits", 0);
        Ok((work(begun, &bar), estimates.clone()))
    };
    let done = with_threads(output.threads, all);
    let (result, estimates) = done.map_err(|e| anyhow!("threads cannot be started: {e}"))??;
    Ok(Study { experiment, estimates, settings, stream, result })
}

impl Begun<'_> {
    /// Whether somebody looks on.
    pub(super) fn is_shown(&self) -> bool {
        self.stream.is_open()
    }

    /// Shows `models` and `revisions` beside the decisions, in a viewer that looks on.
    pub(super) fn show(
        &self,
        models: &[ComparedJoint<'_>],
        revisions: &[ImprovedJoint<'_>],
        joint: Option<&str>,
    ) -> anyhow::Result<()> {
        if !self.is_shown() {
            return Ok(());
        }
        self.with_contents(models, revisions, |contents| self.stream.send(contents, joint))
    }

    fn with_contents(
        &self,
        models: &[ComparedJoint<'_>],
        revisions: &[ImprovedJoint<'_>],
        take: impl FnOnce(&Contents<'_>) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let pairs = self.joints.iter().zip(self.estimates);
        let pairs = pairs.filter_map(|(joint, estimate)| Some((joint, estimate.as_ref().ok()?)));
        let joints: Vec<_> =
            pairs.map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect();
        let (sources, reading) = (&self.experiment.sources, &self.experiment.options);
        let (joints, settings, detail) = (&joints, self.settings, Detail::Full);
        let also = &[];
        take(&Contents { joints, settings, also, sources, reading, models, revisions, detail })
    }
}

impl<T> Study<T> {
    /// Records `models` and `revisions` beside the decisions, and shows them.
    pub(super) fn record(
        &self,
        path: Option<&Path>,
        models: &[ComparedJoint<'_>],
        revisions: &[ImprovedJoint<'_>],
        verbosity: Verbosity,
    ) -> anyhow::Result<()> {
        let Self { experiment, estimates, settings, stream, .. } = self;
        let joints = &experiment.joints;
        let begun = Begun { experiment, joints, estimates, settings, stream };
        if let Some(path) = path {
            begun.with_contents(models, revisions, |contents| contents.record(path, verbosity))?;
        }
        begun.show(models, revisions, None)
    }

    /// Ends what viewers are sent.
    pub(super) fn close(
        self,
        completion: Completion,
        verbosity: Verbosity,
    ) -> anyhow::Result<Completion> {
        self.stream.close(completion, verbosity)
    }
}

/// What came of each joint, and messages on what failed.
///
/// # Errors
/// The first message when there is nothing else.
pub(super) fn outcomes<'a, T, U, E: std::error::Error + 'static>(
    experiment: &'a Experiment,
    results: &'a [Option<Result<T, E>>],
    outcome: impl Fn(usize, &'a Joint, &'a T) -> U,
) -> anyhow::Result<(Vec<U>, Vec<String>)> {
    let mut failures = read_failures(experiment);
    let mut done = Vec::new();
    for (index, (joint, result)) in experiment.joints.iter().zip(results).enumerate() {
        match result {
            Some(Ok(result)) => done.push(outcome(index, joint, result)),
            Some(Err(error)) => {
                let why = super::with_causes(error);
                failures.push(format!("joint `{}` is left out: {why}", joint.name));
            }
            None => failures.push(format!("joint `{}` has no model", joint.name)),
        }
    }
    match failures.first() {
        Some(first) if done.is_empty() => Err(anyhow!(first.clone())),
        _ => Ok((done, failures)),
    }
}

/// Prints `text`, or JSON, and says what failed.
pub(super) fn print(
    format: Format,
    failures: &[String],
    text: impl FnOnce() -> String,
    json: impl FnOnce(&mut StdoutLock<'_>) -> serde_json::Result<()>,
) -> anyhow::Result<Completion> {
    for failure in failures {
        message("warning", failure);
    }
    match format {
        Format::Text => terminal::print(&text())?,
        Format::Json => terminal::print_with(|out| {
            json(out)?;
            out.write_all(b"\n")
        })?,
    }
    Ok(if failures.is_empty() { Completion::Whole } else { Completion::Partial })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_takes_each_word_for_one() {
        let words = ["log.csv", "--joint", "my boom", "it's", ""].map(str::to_owned);
        assert_eq!(quoted(&words), r"log.csv --joint 'my boom' 'it'\''s' ''");
    }
}
