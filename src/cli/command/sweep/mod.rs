//! `tauscope sweep`: every delay with every setting.

use anyhow::bail;
use clap::Args as ClapArgs;
use values::{Values, lengths, methods, passbands};

use crate::batch::Threads;
use crate::cli::args::number::{self, OrNone};
use crate::cli::args::{ConditionArgs, DataArgs, ResultArgs, ids_with, low_pass};
use crate::cli::console::Bar;
use crate::cli::failure::{Completion, joint_left_out, nothing_usable, read_failures, said};
use crate::cli::output::{OutputKind, Outputs, Recorded};
use crate::cli::run::Session;
use crate::delay::sweep::{Base, Grid};
use crate::delay::{EstimateError, Method};
use crate::experiment::{Experiment, Joint, Trial};
use crate::numerics::LowPass;
use crate::report::sweep::{WORST, sweep_json, sweep_text};
use crate::report::{ReportedSweep, SweepRecording};
use crate::study::{SweptJoint, sweep_joints};
use crate::units::Length;

mod values;

/// Estimate every delay with many settings, and say which of them it depends on
///
/// Every combination of the values is tried on every joint. A list is `1,2,5`; a range, with
/// both ends, is `1..10` or `2..20:2`.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    #[command(flatten)]
    data: DataArgs,

    /// The methods by which delays are found
    #[arg(long, value_name = "NAMES", default_value_t = Values::all(), value_parser = methods)]
    method: Values<Method>,

    /// How far a segment extends before its input step and after the next one, in samples or in
    /// seconds as in `0.05s,0.1s`
    #[arg(long, value_name = "LIST", default_value = "5,10,20", value_parser = lengths, allow_hyphen_values = true)]
    alpha: Values<Length>,

    #[arg(long, help = format!("Samples, or seconds, between two candidate breakpoints; for `{}` alone", ids_with(|spec| !spec.has_intervals)), value_name = "LIST", default_value = "1,2,5,10", value_parser = lengths, allow_hyphen_values = true)]
    beta: Values<Length>,

    #[arg(long, help = format!("Cutoffs of the low-pass in Hz, and `none` [default: 2,5,10,none]; for `{}` alone", ids_with(|spec| !spec.has_intervals)), value_name = "LIST", value_parser = passbands, allow_hyphen_values = true)]
    passband: Option<Values<OrNone>>,

    /// Two delays agree if they differ by no more than this, beyond the resolution of each (± β/2,
    /// or its interval)
    #[arg(long, value_name = "SAMPLES", default_value_t = 2.0, value_parser = number::threshold)]
    tolerance: f64,

    #[command(flatten)]
    conditions: ConditionArgs,

    /// Show all steps that depend on a setting, not only those that do most
    #[arg(long)]
    steps: bool,

    #[command(flatten)]
    output: ResultArgs,
}

/// Joints in a recording: the viewer cannot read one with the views of eight hundred.
const MOST_RECORDED: usize = 200;

type JointResult = Result<SweptJoint, EstimateError>;

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    let verbosity = args.output.run.verbosity();
    let grid = args.grid()?;
    let recording = args.output.recording.as_deref();
    Outputs::default().with(OutputKind::Recording, recording).check(&args.data.files())?;
    let stream = args.output.stream.open(verbosity)?;
    let session =
        Session::begin("sweep", &args.data, &args.data.options()?, (&args.output.run, stream))?;
    let experiment = &session.experiment;
    let joints = &experiment.joints;
    if recording.is_some() && joints.len() > MOST_RECORDED {
        bail!(
            "{} joints; a recording of a sweep is for {MOST_RECORDED} at most: choose some with \
             --joint, or leave out --output",
            joints.len()
        );
    }
    let trials = || joints.iter().flat_map(|joint| &joint.trials);
    let grid = grid.in_samples(trials());
    let (grid, notes) =
        if args.passband.is_some() { (grid, Vec::new()) } else { fitting(&grid, trials()) };
    let runs = (joints.len() * grid.runs().len()) as u64;
    let bar = Bar::new(verbosity, "sweeping", "runs", runs);
    let own = session.own();
    let of_joint = |joint: &Joint| grid.with_settings(|settings| own.of_joint(joint, settings));
    let work = || sweep_joints(joints, of_joint, args.tolerance, || bar.step(), &Threads);
    let results = session.in_threads(work)?;
    drop(bar);
    let failures = failures(experiment, &grid, &results);
    let swept = joints.iter().zip(&results);
    let swept = swept.filter_map(|(joint, result)| Some((joint, result.as_ref().ok()?)));
    let swept: Vec<_> =
        swept.map(|(joint, swept)| ReportedSweep { joint, sweep: &swept.sweep }).collect();
    if swept.is_empty() {
        return Err(nothing_usable(failures.last()));
    }
    session.warn(&failures, &notes);
    let contents = SweepRecording {
        joints: &swept,
        grid: &grid,
        tolerance: args.tolerance,
        sources: &experiment.sources,
        reading: &experiment.options,
    };
    if let Some(path) = recording {
        Recorded::Sweep(&contents).record(path, verbosity)?;
    }
    session.stream.send_sweep(&contents)?;
    let shown = if args.steps { [usize::MAX; 2] } else { WORST };
    session.end(
        Completion::without(&failures),
        || sweep_text(&grid, args.tolerance, &swept, shown),
        || sweep_json(&grid, args.tolerance, &swept, &experiment.notes, &failures),
    )
}

/// `grid` without the low-passes that do not fit all of `trials`, and a note on them: nobody asked
/// for them.
fn fitting<'a>(grid: &Grid, trials: impl Iterator<Item = &'a Trial>) -> (Grid, Vec<String>) {
    let nyquist_hz = trials.map(|trial| trial.period().nyquist_hz()).fold(f64::INFINITY, f64::min);
    let fits = |low_pass: &LowPass| low_pass.cutoff_hz < nyquist_hz;
    let (kept, left_out): (Vec<Option<LowPass>>, Vec<Option<LowPass>>) =
        grid.passbands().iter().partition(|passband| passband.as_ref().is_none_or(fits));
    if left_out.is_empty() || kept.is_empty() {
        return (grid.clone(), Vec::new());
    }
    let hz: Vec<String> = left_out.iter().flatten().map(|it| it.cutoff_hz.to_string()).collect();
    let samples = 2.0 * nyquist_hz;
    let note = format!(
        "the {} Hz low-pass is left out, since the log has no more than {samples} samples per \
         second",
        hz.join(" and ")
    );
    (grid.with_passbands(kept), vec![note])
}

/// A message on each file, joint and setting that failed.
fn failures(experiment: &Experiment, grid: &Grid, results: &[JointResult]) -> Vec<String> {
    let all = grid.runs().len();
    let of_joint = |(joint, result): (&Joint, &JointResult)| {
        let name = &joint.name;
        let swept = match result {
            Err(error) => return vec![joint_left_out(name, error)],
            Ok(swept) => swept,
        };
        let mut different: Vec<(&EstimateError, usize)> = Vec::new();
        for (_, error) in &swept.failed {
            match different.iter_mut().find(|(known, _)| *known == error) {
                Some((_, count)) => *count += 1,
                None => different.push((error, 1)),
            }
        }
        let why = |(error, count): (&EstimateError, usize)| {
            format!("joint `{name}`, {count} of {all} settings are left out: {}", said(error))
        };
        different.into_iter().map(why).collect()
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
        let usual = [OrNone::Number(2.0), OrNone::Number(5.0), OrNone::Number(10.0), OrNone::None];
        let passbands = self.passband.as_ref().map_or(usual.as_slice(), |given| &given.0);
        let base = |method: &Method| {
            let settings = self.conditions.settings(*method);
            // Onsets are found in the output as it was measured.
            let keeps_low_pass = settings.method.spec().has_intervals;
            Base { settings, keeps_low_pass }
        };
        let bases: Vec<Base> = self.method.0.iter().map(base).collect();
        let (alphas, betas) = (self.alpha.0.clone(), self.beta.0.clone());
        let counts = [bases.len(), passbands.len(), alphas.len(), betas.len()];
        let combinations = counts.into_iter().fold(1, usize::saturating_mul);
        if combinations > MOST {
            bail!("{combinations} combinations of settings are more than {MOST}; try fewer values");
        }
        let passbands = passbands.iter().map(|passband| low_pass(*passband, order)).collect();
        Ok(Grid::new(bases, passbands, alphas, betas))
    }
}
