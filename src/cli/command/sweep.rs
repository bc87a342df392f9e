//! `tauscope sweep`: every delay with every setting.

use std::fmt;

use anyhow::bail;
use clap::Args as ClapArgs;

use crate::batch::Threads;
use crate::cli::args::number::{self, OrNone, at_least_one, length};
use crate::cli::args::{ConditionArgs, DataArgs, ResultArgs, ids_with, low_pass, passband};
use crate::cli::console::Bar;
use crate::cli::failure::{Completion, joint_left_out, nothing_usable, read_failures, said};
use crate::cli::output::{OutputKind, Outputs, Recorded};
use crate::cli::run::Session;
use crate::delay::sweep::{Base, Grid};
use crate::delay::{EstimateError, Method};
use crate::experiment::{Experiment, Joint, Trial, did_you_mean, nearest_name};
use crate::numerics::LowPass;
use crate::report::sweep::{WORST, sweep_json, sweep_text};
use crate::report::{ReportedSweep, SweepRecording};
use crate::study::{SweptJoint, sweep_joints};
use crate::units::Length;

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

/// Most values of one range.
const MOST: usize = 1000;

/// The values of an argument, each once, in their order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Values<T>(pub(crate) Vec<T>);

impl Values<Method> {
    /// Every method.
    pub(super) fn all() -> Self {
        // `auto` is one of the others.
        Self(Method::all().filter(|method| *method != Method::AUTO).collect())
    }
}

impl fmt::Display for Values<Method> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ids: Vec<_> = self.0.iter().map(|method| method.id()).collect();
        f.write_str(&ids.join(","))
    }
}

/// Lengths of time: whole numbers of samples from 1 up, or seconds.
pub(crate) fn lengths(text: &str) -> Result<Values<Length>, String> {
    let expected = "expected whole numbers from 1 up, as in 1,2,5 or 1..10 or 2..20:2, or \
                    seconds as in 0.05s,0.1s";
    let whole = |text: &str| at_least_one(text).ok().ok_or_else(|| expected.to_owned());
    listed(text, |part| match Range::of(part) {
        None => Ok(vec![length(part).ok().ok_or_else(|| expected.to_owned())?]),
        Some(range) => {
            let (first, last) = (whole(range.first)?, whole(range.last)?);
            let values = (first..=last).step_by(range.step.map_or(Ok(1), whole)?);
            range.checked(values.map(Length::Samples).take(MOST + 1).collect())
        }
    })
}

/// Cutoffs in Hz, and `none`.
pub(crate) fn passbands(text: &str) -> Result<Values<OrNone>, String> {
    let expected = "expected frequencies in Hz, or `none`, as in 2,5,none or 1..10 or 1..2:0.5";
    let one = |text: &str| passband(text).ok().ok_or_else(|| expected.to_owned());
    let hz = |text: &str| one(text)?.number().ok_or_else(|| expected.to_owned());
    listed(text, |part| match Range::of(part) {
        None => Ok(vec![one(part)?]),
        Some(range) => {
            let (first, last) = (hz(range.first)?, hz(range.last)?);
            let step = range.step.map_or(Ok(1.0), hz)?;
            // The last value belongs to the range, however its multiple is rounded.
            let end = last + 1e-9 * step;
            let values = (0_u32..).map(|n| first + f64::from(n) * step);
            let values = values.take_while(|value| *value <= end).map(OrNone::Number);
            range.checked(values.take(MOST + 1).collect())
        }
    })
}

/// Names of methods.
pub(crate) fn methods(text: &str) -> Result<Values<Method>, String> {
    let one = |name: &str| {
        let ids = || Method::all().map(Method::id);
        let expected = || {
            let names: Vec<_> = ids().collect();
            let near = did_you_mean(nearest_name(name, ids()));
            format!("expected some of {}{near}", names.join(", "))
        };
        Method::find(name).map(|method| vec![method]).ok_or_else(expected)
    };
    listed(text, one)
}

/// What the parts of a list say, each value once.
fn listed<T: PartialEq>(
    text: &str,
    part: impl Fn(&str) -> Result<Vec<T>, String>,
) -> Result<Values<T>, String> {
    let mut found: Vec<T> = Vec::new();
    for text in text.split(',') {
        for value in part(text.trim())? {
            if !found.contains(&value) {
                found.push(value);
            }
        }
    }
    Ok(Values(found))
}

/// `first..last` or `first..last:step`, both ends included.
struct Range<'a> {
    text: &'a str,
    first: &'a str,
    last: &'a str,
    step: Option<&'a str>,
}

impl<'a> Range<'a> {
    fn of(text: &'a str) -> Option<Self> {
        let (first, rest) = text.split_once("..")?;
        let (last, step) = match rest.split_once(':') {
            Some((last, step)) => (last, Some(step)),
            None => (rest, None),
        };
        Some(Self { text, first, last, step })
    }

    /// Its values, unless there are none or too many.
    fn checked<T>(&self, values: Vec<T>) -> Result<Vec<T>, String> {
        match values.len() {
            0 => Err(format!("the range `{}` ends before it begins", self.text)),
            1..=MOST => Ok(values),
            _ => Err(format!("the range `{}` has more than {MOST} values", self.text)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_ranges_name_each_value_once() {
        let whole =
            |samples: &[usize]| Ok(Values(samples.iter().copied().map(Length::Samples).collect()));
        assert_eq!(lengths("5,10,20"), whole(&[5, 10, 20]));
        assert_eq!(lengths("1..4, 3,9"), whole(&[1, 2, 3, 4, 9]));
        assert_eq!(lengths("2..9:3"), whole(&[2, 5, 8]));
        let mixed = vec![Length::Seconds(0.05), Length::Seconds(0.1), Length::Samples(3)];
        assert_eq!(lengths("0.05s,0.1s,3"), Ok(Values(mixed)));
        let hz = |values: &[f64]| values.iter().map(|hz| OrNone::Number(*hz)).collect::<Vec<_>>();
        assert_eq!(passbands("1..2:0.5"), Ok(Values(hz(&[1.0, 1.5, 2.0]))));
        let last = passbands("5,none").map(|found| found.0.last().copied());
        assert_eq!(last, Ok(Some(OrNone::None)));
        assert_eq!(methods("hinge,two-line"), Ok(Values(vec![Method::HINGE, Method::TWO_LINE])));
    }

    #[test]
    fn what_is_no_list_says_what_would_be() {
        for wrong in ["", "0", "1,,2", "4..2", "1..1000000000", "1..", "a..b", "1..3:0", "-1..3"] {
            assert!(lengths(wrong).is_err(), "{wrong}");
        }
        for wrong in ["", "0", "none..5", "5..1", "1e-9..5:1e-9", "nan", "1..inf"] {
            assert!(passbands(wrong).is_err(), "{wrong}");
        }
        assert!(methods("hinge,tow-line").is_err_and(|why| why.contains("mean `two-line`")));
    }
}
