//! What is known before an experiment is designed: logs, models, where it is played.

use crate::batch::Threads;
use crate::delay::Settings;
use crate::design::TestRig;
use crate::experiment::{Experiment, Joint, ReadOptions, Trial, expand_folders};
use crate::fit::{Horizon, Split};
use crate::model::{JointModel, ModelFile};
use crate::study::{Mode, Protocol, estimate_joints};
use crate::units::SamplePeriod;
use anyhow::{Context as _, anyhow, bail};

use super::args::Args;
use crate::cli::run::Estimates;

/// Samples per second where nothing is known.
const RATE_HZ: f64 = 100.0;

/// The name of a joint where nothing names one.
const NAME: &str = "joint";

/// Logs, models and the joints that are driven.
pub(crate) struct Known {
    pub(crate) file: ModelFile,
    pub(crate) experiment: Option<Experiment>,
    pub(crate) names: Vec<String>,
    period: SamplePeriod,
}

/// How a log's model is fitted before anything is said of the next experiment: to all of it, as
/// nothing is to be judged by a part that was kept.
pub(crate) const PROTOCOL: Protocol = Protocol {
    mode: Mode::FitOrIntegrator,
    split: Some(Split::Time(1.0)),
    horizon: Horizon::Steps,
};

impl Known {
    pub(crate) fn new(args: &Args) -> anyhow::Result<Self> {
        let file = args.model.as_deref().map(ModelFile::read).transpose()?.unwrap_or_default();
        let experiment = read(args)?;
        let first = experiment.iter().flat_map(|e| &e.joints).flat_map(|joint| &joint.trials);
        let logged = first.map(Trial::period).next();
        let given = args
            .rate
            .map(|rate| SamplePeriod::from_seconds(1.0 / rate).context("--rate: out of range"));
        let usual = SamplePeriod::from_seconds(1.0 / RATE_HZ).context("a sample period")?;
        let period = given.transpose()?.or(logged).unwrap_or(usual);
        let names = names(args, &file, experiment.as_ref())?;
        Ok(Self { file, experiment, names, period })
    }

    /// The joint `name` in the logs.
    pub(crate) fn joint(&self, name: &str) -> Option<&Joint> {
        let mut joints = self.experiment.iter().flat_map(|experiment| &experiment.joints);
        joints.find(|joint| joint.name == name)
    }

    /// The model of `name` in the file.
    pub(crate) fn model(&self, name: &str) -> Option<&JointModel> {
        self.file.joint(name)
    }

    /// All joints of the logs and their delays, where there are logs.
    pub(crate) fn estimated(&self) -> Option<(&[Joint], Estimates)> {
        let joints = self.experiment.as_ref()?.joints.as_slice();
        Some((joints, estimate_joints(joints, &Settings::default(), || (), &Threads)))
    }

    /// Where `name` is played, within `range`.
    pub(crate) fn rig(&self, args: &Args, name: &str, range: Option<(f64, f64)>) -> TestRig {
        let joint = self.joint(name);
        let unit = |of: fn(&Joint) -> Option<&String>| joint.and_then(of).cloned();
        let is_inside = |(low, high): (f64, f64)| low <= 0.0 && high >= 0.0;
        let middle = range.filter(|range| !is_inside(*range)).map(|(low, high)| 0.5 * (low + high));
        TestRig {
            name: name.to_owned(),
            input_unit: unit(|joint| joint.input_unit.as_ref()),
            output_unit: unit(|joint| joint.output_unit.as_ref()),
            period: self.period,
            start: args.start.or(middle).unwrap_or(0.0),
            range,
        }
    }
}

/// The logs, where there are any.
fn read(args: &Args) -> anyhow::Result<Option<Experiment>> {
    if args.data.is_empty() {
        return Ok(None);
    }
    let (files, unlisted) = expand_folders(&args.data);
    let options = ReadOptions { joints: args.joint.clone(), ..ReadOptions::default() };
    let mut experiment = Experiment::read(&files, &options);
    experiment.failures.splice(0..0, unlisted);
    if experiment.joints.is_empty() {
        let first = experiment.failures.drain(..).next().context("no joint in the logs")?;
        return Err(anyhow::Error::from(first.error).context("nothing could be read"));
    }
    Ok(Some(experiment))
}

/// The joints that are driven.
fn names(
    args: &Args,
    file: &ModelFile,
    experiment: Option<&Experiment>,
) -> anyhow::Result<Vec<String>> {
    if let Some(experiment) = experiment {
        return Ok(experiment.joints.iter().map(|joint| joint.name.clone()).collect());
    }
    let known: Vec<String> = file.names().map(str::to_owned).collect();
    if let Some(unknown) = args.joint.iter().find(|name| !known.is_empty() && !known.contains(name))
    {
        let known = known.join(", ");
        return Err(anyhow!("joint `{unknown}`: not in the model file, which has {known}"));
    }
    for (index, name) in args.joint.iter().enumerate() {
        if args.joint.iter().take(index).any(|other| other == name) {
            bail!("--joint {name}: named twice");
        }
    }
    match (args.joint.as_slice(), known.as_slice()) {
        ([], []) => Ok(vec![NAME.to_owned()]),
        ([], known) => Ok(known.to_vec()),
        (named, _) => Ok(named.to_vec()),
    }
}

/// The largest magnitude of the input in the log of `joint`.
pub(crate) fn largest(joint: &Joint) -> f64 {
    let inputs = joint.trials.iter().flat_map(Trial::input);
    inputs.fold(0.0, |largest: f64, input| largest.max(input.abs()))
}

/// Lowest and highest output in the log of `joint`.
pub(crate) fn extent(joint: &Joint) -> (f64, f64) {
    let outputs = joint.trials.iter().flat_map(Trial::output);
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    outputs.fold(none, |(low, high), y| (low.min(*y), high.max(*y)))
}
