//! `tauscope estimate`: read, estimate, write, print.

mod args;
mod files;
mod follow;

use crate::batch::{JointEstimate, estimate_joints_with, with_threads};
use crate::delay::{Condition, EstimateError, Settings};
use crate::experiment::Experiment;
use crate::report::{
    EstimateJson, EstimatedJoint, JointSummary, against_table, estimate_table, steps_table,
};
use anyhow::anyhow;

use super::fitting::{Format, estimating, read};
use super::folder::Each;
use super::progress::Verbosity;
use super::terminal::{self, message};
use super::{Completion, read_failures};
use files::Files;

pub(super) use args::{AlgorithmArgs, Args};

type JointResult = Result<JointEstimate, EstimateError>;

pub(super) fn run(args: &Args) -> anyhow::Result<Completion> {
    if args.folder.is_asked_for() {
        return each_log(args);
    }
    let verbosity = args.output.verbosity();
    let settings = args.algorithm.runs();
    let files = Files::check(&args.output, &args.data.files())?;
    let stream = args.output.stream.open(verbosity)?;
    let told = args.follow.is_on.then(|| follow::follow(args, &settings, &stream)).transpose()?;
    let experiment = read(&args.data, verbosity)?;
    let bar = estimating(&experiment.joints, settings.len(), verbosity);
    let automatic = args.algorithm.automatic();
    let one =
        |settings| estimate_joints_with(&experiment.joints, settings, automatic, || bar.step());
    let work = || settings.iter().map(one).collect::<Vec<Vec<JointResult>>>();
    let results = with_threads(args.output.threads, work)
        .map_err(|error| anyhow!("threads cannot be started: {error}"))?;
    drop(bar);
    let first = results.first().map(Vec::as_slice).unwrap_or_default();
    let failures = failures(&experiment, first);
    let joints: Vec<_> = results.iter().map(|results| estimated(&experiment, results)).collect();
    let runs: Vec<Run<'_>> = settings
        .iter()
        .zip(&joints)
        .map(|(settings, joints)| (settings, joints.as_slice()))
        .collect();
    let Some((answer, first_joints)) = runs.first().filter(|(_, joints)| !joints.is_empty()) else {
        let first = failures.into_iter().next_back();
        return Err(anyhow!(first.unwrap_or_else(|| "no joint in the logs".to_owned())));
    };
    if let Some(told) = told {
        told.tell_changes(first_joints);
    }
    for failure in &failures {
        message("warning", failure);
    }
    if verbosity == Verbosity::Normal {
        for note in experiment.notes.iter().chain(&notes(first_joints)) {
            message("note", note);
        }
    }
    let result =
        Estimated { experiment: &experiment, joints: first_joints, settings: answer, runs: &runs };
    files.write(&result, &stream, verbosity)?;
    print(&args.output, &result, &failures)?;
    let completion = if failures.is_empty() { Completion::Whole } else { Completion::Partial };
    stream.close(completion, verbosity)
}

/// Estimates each log by itself.
fn each_log(args: &Args) -> anyhow::Result<Completion> {
    let output = &args.output;
    args.folder.run(&Each {
        command: "estimate",
        data: &args.data,
        decisions: output.decisions.as_deref(),
        refused: &[
            ("--output", output.recording.is_some()),
            ("--connect, --spawn or --serve", output.stream.is_asked()),
            ("--follow", args.follow.is_on),
            ("--delays", output.delays.is_some()),
            ("--steps", output.steps),
            ("--against-state", output.against_state),
        ],
        format: output.format,
        threads: output.threads,
        verbosity: output.verbosity(),
    })
}

/// The joints that have an estimate with some settings.
type Run<'a> = (&'a Settings, &'a [EstimatedJoint<'a>]);

/// What was read and what came out.
#[derive(Clone, Copy)]
struct Estimated<'a> {
    experiment: &'a Experiment,
    /// The answer: what came out by the first method.
    joints: &'a [EstimatedJoint<'a>],
    settings: &'a Settings,
    /// What came out by each method.
    runs: &'a [Run<'a>],
}

/// The joints that have an estimate, in the order of the log.
pub(super) fn estimated<'a>(
    experiment: &'a Experiment,
    results: &'a [JointResult],
) -> Vec<EstimatedJoint<'a>> {
    let joints = experiment.joints.iter().zip(results);
    let estimated = joints.filter_map(|(joint, result)| Some((joint, result.as_ref().ok()?)));
    estimated.map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect()
}

/// A message on each file, joint and trial that failed.
pub(super) fn failures(experiment: &Experiment, results: &[JointResult]) -> Vec<String> {
    // With several files a trial's name tells which one it is from.
    let file = match experiment.sources.as_slice() {
        [source] => format!("{}: ", source.path.display()),
        _ => String::new(),
    };
    let joints = experiment.joints.iter().zip(results);
    let unestimated = joints.flat_map(|(joint, result)| {
        let name = &joint.name;
        let whole = result.as_ref().err();
        let whole = whole.map(|error| format!("joint `{name}` is left out: {file}{error}"));
        let parts = result.iter().flat_map(JointEstimate::failed);
        let part = |error| format!("joint `{name}`, one trial is left out: {file}{error}");
        whole.into_iter().chain(parts.map(part)).collect::<Vec<_>>()
    });
    read_failures(experiment).into_iter().chain(unestimated).collect()
}

/// What a person should know who looks at the numbers.
pub(super) fn notes(joints: &[EstimatedJoint<'_>]) -> Vec<String> {
    let mut notes = Vec::new();
    for EstimatedJoint { joint, estimate } in joints {
        let name = &joint.name;
        let steps: usize = estimate.estimated().map(|trial| trial.decisions.len()).sum();
        let samples: usize = joint.trials.iter().map(crate::experiment::Trial::len).sum();
        let summary = JointSummary::of(EstimatedJoint { joint, estimate });
        if steps > 0 && summary.rejected == [(Condition::FirstOrLast, steps)] {
            notes.push(format!(
                "joint `{name}`: every step is the first or the last of its trial; \
                 `--keep-first-last` judges them like the others"
            ));
        }
        if 2 * steps > samples {
            notes.push(format!(
                "joint `{name}`: the input changes at {steps} of {samples} samples, so it is \
                 hardly held; `--min-step X` counts only changes above X"
            ));
        }
    }
    notes
}

fn print(
    args: &args::OutputArgs,
    result: &Estimated<'_>,
    failures: &[String],
) -> anyhow::Result<()> {
    if let Format::Json = args.format {
        return terminal::print_json(&EstimateJson::new(result.experiment, result.runs, failures));
    }
    let mut text = String::new();
    for (settings, joints) in result.runs {
        text += &estimate_table(joints, settings);
        if args.steps {
            text += &steps_table(joints);
        }
    }
    if args.against_state {
        let found = result.joints.iter().map(|j| (j.joint.name.as_str(), j.against_state()));
        let found: Vec<_> = found.collect();
        text += "\n";
        text += &against_table(found.iter().map(|(name, found)| (*name, found)));
    }
    terminal::print(&text)
}
