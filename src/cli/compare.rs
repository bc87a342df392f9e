//! `tauscope compare`: a model beside the measurement.

use std::io::{self, Write as _};
use std::path::PathBuf;

use anyhow::{Context as _, anyhow};
use clap::{Args as ClapArgs, ValueEnum};
use tauscope::batch::{Mode, Protocol, compare_joints, estimate_joints, with_threads};
use tauscope::delay::Settings;
use tauscope::diagnosis::Comparison;
use tauscope::experiment::Joint;
use tauscope::fit::{FitError, Horizon, Split};
use tauscope::model::{JointModel, ModelFile};
use tauscope::report::{CompareJson, ComparedJoint, EstimatedJoint, compare_table};

use super::data::DataArgs;
use super::output::check_outputs;
use super::progress::Verbosity;
use super::record::{Contents, Detail};
use super::{Completion, message};

/// Compare a model with the measurement
///
/// Without a model file each joint is compared with a plain integrator, whose gain and
/// delay are fitted.
#[derive(ClapArgs, Debug)]
pub(super) struct Args {
    #[command(flatten)]
    data: DataArgs,

    /// A model file (TOML, schema `tauscope/model/1`). May be repeated
    #[arg(short, long, value_name = "MODEL.toml", help_heading = "Model")]
    model: Vec<PathBuf>,

    /// Fit the free parameters of the model files, starting at their values
    #[arg(long, help_heading = "Model")]
    fit: bool,

    /// How long a simulation runs before its angle is set to the measured one: `free`
    /// (never), `steps` (at every step of the input), or seconds
    #[arg(long, value_name = "free|steps|SECONDS", default_value = "free", value_parser = horizon, help_heading = "Model")]
    horizon: Horizon,

    /// Share of each trial's time that is for training, or `trials`: every third trial is
    /// for validation [default: trials from six on, else 0.7]
    #[arg(long, value_name = "SHARE|trials", value_parser = split, help_heading = "Model")]
    split: Option<Split>,

    /// Record models and decisions for the Rerun viewer
    #[arg(short = 'o', long = "output", value_name = "FILE.rrd", help_heading = "Output")]
    recording: Option<PathBuf>,

    /// How results are printed
    #[arg(long, value_enum, default_value_t = Format::Text, help_heading = "Output")]
    format: Format,

    /// Threads to use [default: all processors]
    #[arg(long, value_name = "N", value_parser = super::data::threads, help_heading = "Output")]
    threads: Option<usize>,

    /// No notices
    #[arg(short, long, help_heading = "Output")]
    quiet: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    /// A table
    Text,
    /// JSON, schema `tauscope/compare/1`
    Json,
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

/// A model by the name it has in the output.
struct Named {
    name: String,
    /// None: plain integrators.
    file: Option<ModelFile>,
}

pub(super) fn run(args: &Args) -> anyhow::Result<Completion> {
    let models = models(&args.model)?;
    if let Some(path) = &args.recording {
        check_outputs(&[path.as_path()], &args.data.files())?;
    }
    let experiment = args.data.read()?;
    let joints = &experiment.joints;
    let settings = Settings::default();
    let work = || {
        let estimates = estimate_joints(joints, &settings, || ());
        let one = |named: &Named| {
            let starts = |joint: &Joint| named.starts(joint);
            let (split, horizon) = (args.split, args.horizon);
            let protocol = Protocol { mode: named.mode(args), split, horizon };
            compare_joints(joints, &estimates, starts, protocol)
        };
        let results = models.iter().map(one).collect::<Vec<_>>();
        (estimates, results)
    };
    let (estimates, results) = with_threads(args.threads, work)
        .map_err(|error| anyhow!("threads cannot be started: {error}"))?;
    let mut failures = super::read_failures(&experiment);
    let mut compared = Vec::new();
    for (named, results) in models.iter().zip(&results) {
        for (joint, result) in joints.iter().zip(results) {
            match named.compared(joint, result.as_ref()) {
                Ok(joint) => compared.push(joint),
                Err(failure) => failures.push(failure),
            }
        }
    }
    if let Some(first) = failures.first().filter(|_| compared.is_empty()) {
        return Err(anyhow!(first.clone()));
    }
    if let Some(path) = &args.recording {
        let pairs = joints.iter().zip(&estimates);
        let pairs = pairs.filter_map(|(joint, estimate)| Some((joint, estimate.as_ref().ok()?)));
        let joints: Vec<_> =
            pairs.map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect();
        let (settings, sources) = (&settings, &experiment.sources);
        let detail = Detail::Full;
        let (joints, models) = (joints.as_slice(), compared.as_slice());
        let reading = &experiment.options;
        let contents = Contents { joints, settings, sources, reading, models, detail };
        contents.record(path, if args.quiet { Verbosity::Quiet } else { Verbosity::Normal })?;
    }
    finish(args, &compared, &failures)
}

fn finish(
    args: &Args,
    compared: &[ComparedJoint<'_>],
    failures: &[String],
) -> anyhow::Result<Completion> {
    for failure in failures {
        message("warning", failure);
    }
    print(args, compared, failures).context("standard output cannot be written")?;
    Ok(if failures.is_empty() { Completion::Whole } else { Completion::Partial })
}

fn models(paths: &[PathBuf]) -> anyhow::Result<Vec<Named>> {
    if paths.is_empty() {
        return Ok(vec![Named { name: "integrator".to_owned(), file: None }]);
    }
    let named = |path: &PathBuf| {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Named { name, file: Some(ModelFile::read(path)?) })
    };
    paths.iter().map(named).collect()
}

impl Named {
    /// The model of `joint` in the file; none without a file, where there is none to ask.
    fn starts(&self, joint: &Joint) -> Option<JointModel> {
        self.file.as_ref().and_then(|file| file.joint(&joint.name)).cloned()
    }

    /// A joint's result, or a message on why there is none.
    fn compared<'a>(
        &'a self,
        joint: &'a Joint,
        result: Option<&'a Result<Comparison, FitError>>,
    ) -> Result<ComparedJoint<'a>, String> {
        let name = &joint.name;
        let result =
            result.ok_or_else(|| format!("joint `{name}`: not in model `{}`", self.name))?;
        let comparison = result.as_ref();
        let comparison =
            comparison.map_err(|error| format!("joint `{name}` is left out: {error}"))?;
        let revision = self.file.as_ref().and_then(|file| file.revision(name)).unwrap_or(0);
        Ok(ComparedJoint { joint, model: &self.name, revision, comparison })
    }

    fn mode(&self, args: &Args) -> Mode {
        match (&self.file, args.fit) {
            (None, _) => Mode::Integrator,
            (Some(_), true) => Mode::Fit,
            (Some(_), false) => Mode::AsItIs,
        }
    }
}

fn print(args: &Args, compared: &[ComparedJoint<'_>], failures: &[String]) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match args.format {
        Format::Text => {
            let horizon = match args.horizon {
                Horizon::FreeRun => "free run".to_owned(),
                Horizon::Steps => "restarted at every step of the input".to_owned(),
                Horizon::Seconds(seconds) => format!("restarted every {seconds} s"),
            };
            out.write_all(compare_table(compared, &horizon).as_bytes())?;
        }
        Format::Json => {
            serde_json::to_writer(&mut out, &CompareJson::new(compared, failures))?;
            out.write_all(b"\n")?;
        }
    }
    out.flush()
}
