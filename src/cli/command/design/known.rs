//! What is known before an experiment is designed: logs, models, where it is played.

use crate::batch::Threads;
use crate::delay::Settings;
use crate::design::{DURATION_S, Logged, TestRig, reach};
use crate::effect::UNLIMITED;
use crate::experiment::{Experiment, Joint, Trial};
use crate::fit::{Horizon, Split};
use crate::model::{JointModel, ModelFile};
use crate::study::{Mode, Protocol, estimate_joints};
use crate::units::SamplePeriod;
use anyhow::{Context as _, anyhow, bail};

use super::args::Args;
use crate::cli::args::{read, read_model};
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
    /// The joints of the logs with their inputs as differences to where they rest, but for those
    /// whose model is given, which knows.
    joints: Vec<Joint>,
    /// What was played on each.
    logged: Vec<Logged>,
    period: SamplePeriod,
}

/// How a log's model is fitted before anything is said of the next experiment: to all of it, as
/// nothing is to be judged by a part that was kept.
pub(crate) const PROTOCOL: Protocol =
    Protocol { mode: Mode::FitOrIntegrator, split: Some(Split::Time(1.0)), horizon: Horizon::Auto };

impl Known {
    pub(crate) fn new(args: &Args) -> anyhow::Result<Self> {
        let file = args.model.as_deref().map(read_model).transpose()?.unwrap_or_default();
        let logs = Some(&args.data).filter(|data| !data.is_empty());
        let experiment = logs.map(|data| read(data, &args.reading.options()?)).transpose()?;
        let first = experiment.iter().flat_map(|e| &e.joints).flat_map(|joint| &joint.trials);
        let logged = first.map(Trial::period).next();
        let given = args
            .rate
            .map(|rate| SamplePeriod::from_seconds(1.0 / rate).context("--rate: out of range"));
        let usual = SamplePeriod::from_seconds(1.0 / RATE_HZ).context("a sample period")?;
        let logged =
            logged.map(|logged| if args.separate.is_empty() { at_most(logged) } else { logged });
        let period = given.transpose()?.or(logged).unwrap_or(usual);
        let names = names(args, &file, experiment.as_ref())?;
        check_length(args, (&file, &names), period)?;
        check_gains(&file, &names)?;
        let joints = experiment.iter().flat_map(|experiment| &experiment.joints);
        let centred = |joint: &Joint| {
            let logged = Logged::of(joint);
            let has_model = file.joint(&joint.name).is_some();
            let logged = match args.output_range {
                _ if has_model => logged.as_it_is(),
                Some(range) if args.separate.is_empty() => logged.within(range),
                _ => logged,
            };
            let played = if args.separate.is_empty() {
                logged.thinned(joint)
            } else {
                logged.centred(joint)
            };
            (played, logged)
        };
        let (joints, logged) = joints.map(centred).unzip();
        Ok(Self { file, experiment, names, joints, logged, period })
    }

    /// The joint `name` in the logs.
    fn joint(&self, name: &str) -> Option<&Joint> {
        self.joints.iter().find(|joint| joint.name == name)
    }

    /// What was played on the joint `name`.
    pub(crate) fn logged(&self, name: &str) -> Option<&Logged> {
        let place = self.joints.iter().position(|joint| joint.name == name)?;
        self.logged.get(place)
    }

    /// The input at which the joint `name` is meant to rest.
    pub(crate) fn rest(&self, name: &str) -> f64 {
        self.logged(name).map_or(0.0, |logged| logged.rest)
    }

    /// What is to be said of models that are given and did not explain the log they were fitted to.
    pub(crate) fn cautions(&self) -> Vec<String> {
        let names = self.names.iter().filter(|name| self.file.is_unexplained(name));
        let caution = |name: &String| {
            format!(
                "joint `{name}`: when its model was fitted, an error remained that no effect \
                 accounts for (verdict `unexplained`), so the output may leave the predicted \
                 range; try the input at a fraction of its size first"
            )
        };
        names.map(caution).collect()
    }

    /// The model of `name` in the file.
    pub(crate) fn model(&self, name: &str) -> Option<&JointModel> {
        self.file.joint(name)
    }

    /// All joints of the logs and their delays, where there are logs.
    pub(crate) fn estimated(&self) -> Option<(&[Joint], Estimates)> {
        let joints = self.joints.as_slice();
        if joints.is_empty() {
            return None;
        }
        Some((joints, estimate_joints(joints, &Settings::default(), || (), &Threads)))
    }

    /// Where `name` is played, within `range`.
    pub(crate) fn rig(&self, args: &Args, name: &str, range: Option<(f64, f64)>) -> TestRig {
        let joint = self.joint(name);
        let unit = |of: fn(&Joint) -> Option<&String>| joint.and_then(of).cloned();
        let logged = self.logged(name);
        let within = range.map(|range| reach(range, logged).unwrap_or(range));
        let middle = within.or(logged.map(|logged| logged.extent));
        let middle = middle.map(|(low, high)| 0.5 * (low + high));
        TestRig {
            name: name.to_owned(),
            input_unit: unit(|joint| joint.input_unit.as_ref()),
            output_unit: unit(|joint| joint.output_unit.as_ref()),
            period: self.period,
            start: args.start.or(logged.and_then(Logged::settled)).or(middle).unwrap_or(0.0),
            range,
        }
    }
}

/// Refuses an input that is too long to be searched, holds below a sample, and a delay that no input would
/// outlast.
fn check_length(
    args: &Args,
    (file, names): (&ModelFile, &[String]),
    period: SamplePeriod,
) -> anyhow::Result<()> {
    /// Samples of an input, at most: a search holds several inputs of this length at a time.
    const MOST: f64 = 1e6;
    let samples = |seconds: f64| seconds / period.seconds();
    let length = samples(args.duration.unwrap_or(DURATION_S));
    if length > MOST {
        bail!(
            "--duration and --rate: an input of {length:.1e} samples is longer than the {MOST:.0e} \
             that are searched; choose a shorter one, or a lower rate"
        );
    }
    if let Some((shortest, _)) = args.hold.filter(|(shortest, _)| samples(*shortest) < 1.0) {
        let period = period.seconds();
        bail!(
            "--hold: {shortest} s is less than a sample of {period} s; choose longer holds, or a higher --rate"
        );
    }
    for name in names {
        let delay_s = file.joint(name).map_or(0.0, |model| model.delay.value);
        if samples(delay_s) > MOST {
            bail!(
                "--model: joint `{name}` has a delay of {delay_s:.1e} s, which is more than \
                 {MOST:.0e} samples; correct it, or choose a lower --rate"
            );
        }
    }
    Ok(())
}

/// Refuses a gain with which outputs leave double precision.
fn check_gains(file: &ModelFile, names: &[String]) -> anyhow::Result<()> {
    let gain = |name: &String| file.joint(name).map_or(0.0, |model| model.gain.value);
    match names.iter().find(|name| gain(name).abs() > UNLIMITED) {
        Some(name) => bail!(
            "--model: joint `{name}` has a gain of {:.1e}, with which outputs cannot be planned; \
             correct it, or write it in other units, up to {UNLIMITED:.0e}",
            gain(name)
        ),
        None => Ok(()),
    }
}

/// `logged`, or ten milliseconds where it is shorter: no level is held for less than half a second.
fn at_most(logged: SamplePeriod) -> SamplePeriod {
    let usual = SamplePeriod::from_seconds(1.0 / RATE_HZ);
    usual.filter(|usual| usual.seconds() > logged.seconds()).unwrap_or(logged)
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
    let named = args.reading.joints();
    if let Some(unknown) = named.iter().find(|name| !known.is_empty() && !known.contains(name)) {
        let known = known.join(", ");
        return Err(anyhow!("joint `{unknown}`: not in the model file, which has {known}"));
    }
    for (index, name) in named.iter().enumerate() {
        if named.iter().take(index).any(|other| other == name) {
            bail!("--joint {name}: named twice");
        }
    }
    match (named.as_slice(), known.as_slice()) {
        ([], []) => Ok(vec![NAME.to_owned()]),
        ([], known) => Ok(known.to_vec()),
        (named, _) => Ok(named.to_vec()),
    }
}
