//! `tauscope sweep`: every delay with every setting.

mod values;

use std::path::{Path, PathBuf};

use crate::batch::{SweptJoint, sweep_joints, with_threads};
use crate::delay::sweep::{Base, Grid};
use crate::delay::{EstimateError, Method};
use crate::experiment::Experiment;
use crate::report::{ReportedSweep, StepsShown, SweepJson, sweep_text};
use anyhow::{anyhow, bail};
use clap::Args as ClapArgs;

use super::data::{DataArgs, threads};
use super::fitting::{Format, read};
use super::output::check_outputs;
use super::progress::{Bar, Verbosity};
use super::record::SweepContents;
use super::settings::{ConditionArgs, Passband, ids_with, threshold};
use super::stream::StreamArgs;
use super::terminal::{self, message};
use super::{Completion, read_failures};
use values::{Values, methods, passbands, whole};

/// Estimate every delay with many settings, and say which of them it hangs on
///
/// Every combination of the values is tried on every joint. A list is `1,2,5`; a range, with
/// both ends, is `1..10` or `2..20:2`.
#[derive(ClapArgs, Debug)]
pub(super) struct Args {
    #[command(flatten)]
    data: DataArgs,

    /// How a breakpoint is found
    #[arg(long, value_name = "NAMES", default_value_t = Values::all(), value_parser = methods, help_heading = "Settings that are varied")]
    method: Values<Method>,

    /// Samples that a segment reaches beyond its input steps
    #[arg(long, value_name = "LIST", default_value = "5,10,20", value_parser = whole, allow_hyphen_values = true, help_heading = "Settings that are varied")]
    alpha: Values<usize>,

    #[arg(long, help = format!("Samples between two candidate breakpoints; for `{}` alone", ids_with(|spec| spec.has_rows)), value_name = "LIST", default_value = "1,2,5,10", value_parser = whole, allow_hyphen_values = true, help_heading = "Settings that are varied")]
    beta: Values<usize>,

    #[arg(long, help = format!("Cutoffs of the low-pass in Hz, and `none` [default: 2,5,10,none for {}, else none]", ids_with(|spec| spec.low_pass.is_some())), value_name = "LIST", value_parser = passbands, allow_hyphen_values = true, help_heading = "Settings that are varied")]
    passband: Option<Values<Passband>>,

    /// Delays that differ by so many samples more than β or their intervals allow still agree
    #[arg(long, value_name = "SAMPLES", default_value_t = 2.0, value_parser = threshold, allow_negative_numbers = true, help_heading = "Settings that are varied")]
    tolerance: f64,

    #[command(flatten)]
    conditions: ConditionArgs,

    #[command(flatten)]
    output: OutputArgs,
}

/// What is printed and recorded.
#[derive(ClapArgs, Debug)]
#[command(next_help_heading = "Output")]
struct OutputArgs {
    /// Record how every delay moves with the settings, for the Rerun viewer
    #[arg(short = 'o', long = "output", value_name = "FILE.rrd")]
    recording: Option<PathBuf>,

    #[command(flatten)]
    stream: StreamArgs,

    /// Show all steps that hang on a setting, not only those that most do
    #[arg(long)]
    steps: bool,

    /// How results are printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,

    /// Threads to use [default: all processors]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    threads: Option<usize>,

    /// No progress, no notices
    #[arg(short, long)]
    quiet: bool,
}

type JointResult = Result<SweptJoint, EstimateError>;

pub(super) fn run(args: &Args) -> anyhow::Result<Completion> {
    let verbosity = if args.output.quiet { Verbosity::Quiet } else { Verbosity::Normal };
    let grid = args.grid()?;
    let recording = args.output.recording.as_deref();
    check_outputs(&recording.into_iter().collect::<Vec<&Path>>(), &args.data.files())?;
    let stream = args.output.stream.open(verbosity)?;
    let experiment = read(&args.data, verbosity)?;
    let joints = &experiment.joints;
    let runs = (joints.len() * grid.runs().len()) as u64;
    let bar = Bar::new(verbosity, "sweeping", "runs", runs);
    let work = || sweep_joints(joints, &grid, args.tolerance, || bar.step());
    let results = with_threads(args.output.threads, work)
        .map_err(|error| anyhow!("threads cannot be started: {error}"))?;
    drop(bar);
    let failures = failures(&experiment, &grid, &results);
    let swept = joints.iter().zip(&results);
    let swept = swept.filter_map(|(joint, result)| Some((joint, result.as_ref().ok()?)));
    let swept: Vec<_> =
        swept.map(|(joint, swept)| ReportedSweep { joint, sweep: &swept.sweep }).collect();
    if swept.is_empty() {
        let first = failures.into_iter().next_back();
        return Err(anyhow!(first.unwrap_or_else(|| "no joint in the logs".to_owned())));
    }
    for failure in &failures {
        message("warning", failure);
    }
    if verbosity == Verbosity::Normal {
        for note in &experiment.notes {
            message("note", note);
        }
    }
    let contents = SweepContents {
        joints: &swept,
        grid: &grid,
        tolerance: args.tolerance,
        sources: &experiment.sources,
        reading: &experiment.options,
    };
    if let Some(path) = recording {
        contents.record(path, verbosity)?;
    }
    stream.send_sweep(&contents)?;
    args.print(&grid, &swept, &experiment.notes, &failures)?;
    let completion = if failures.is_empty() { Completion::Whole } else { Completion::Partial };
    stream.close(completion, verbosity)
}

/// A message on each file, joint and setting that failed.
fn failures(experiment: &Experiment, grid: &Grid, results: &[JointResult]) -> Vec<String> {
    let of_joint = |(joint, result): (&crate::experiment::Joint, &JointResult)| {
        let name = &joint.name;
        match result {
            Err(error) => vec![format!("joint `{name}` is left out: {error}")],
            Ok(swept) => {
                let mut different: Vec<&EstimateError> = Vec::new();
                for (_, error) in &swept.failed {
                    if !different.contains(&error) {
                        different.push(error);
                    }
                }
                let count = |error| swept.failed.iter().filter(|(_, other)| other == error).count();
                let all = grid.runs().len();
                let why = |error| {
                    let count = count(error);
                    format!("joint `{name}`, {count} of {all} settings are left out: {error}")
                };
                different.into_iter().map(why).collect()
            }
        }
    };
    let of_joints = experiment.joints.iter().zip(results).flat_map(of_joint);
    read_failures(experiment).into_iter().chain(of_joints).collect()
}

impl Args {
    /// Every combination of the values.
    fn grid(&self) -> anyhow::Result<Grid> {
        /// More would take days, and no memory holds them.
        const MOST: usize = 20_000;
        let order = self.conditions.filter_order;
        let usual = [Passband::Hz(2.0), Passband::Hz(5.0), Passband::Hz(10.0), Passband::None];
        let passbands = self.passband.as_ref().map_or(usual.as_slice(), |given| &given.0);
        let base = |method: &Method| {
            let settings = self.conditions.settings(*method);
            // Who looks at the output as it was measured is not smoothed unasked.
            let keeps_low_pass = self.passband.is_none() && settings.low_pass.is_none();
            Base { settings, keeps_low_pass }
        };
        let bases: Vec<Base> = self.method.0.iter().map(base).collect();
        let (alphas, betas) = (self.alpha.0.clone(), self.beta.0.clone());
        let counts = [bases.len(), passbands.len(), alphas.len(), betas.len()];
        let combinations = counts.into_iter().fold(1, usize::saturating_mul);
        if combinations > MOST {
            bail!("{combinations} combinations of settings are more than {MOST}; try fewer values");
        }
        let passbands = passbands.iter().map(|passband| passband.low_pass(order)).collect();
        Ok(Grid::new(bases, passbands, alphas, betas))
    }

    fn print(
        &self,
        grid: &Grid,
        joints: &[ReportedSweep<'_>],
        notes: &[String],
        failures: &[String],
    ) -> anyhow::Result<()> {
        let shown = if self.output.steps { StepsShown::All } else { StepsShown::Worst };
        match self.output.format {
            Format::Text => terminal::print(&sweep_text(grid, self.tolerance, joints, shown)),
            Format::Json => {
                let json = SweepJson::new(grid, self.tolerance, joints, notes, failures);
                terminal::print_json(&json)
            }
        }
    }
}
