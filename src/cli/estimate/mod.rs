//! `tauscope estimate`: read, estimate, write, print.

mod args;
mod files;

use std::io::{self, Write as _};

use anyhow::Context as _;
use tauscope::batch::{JointEstimate, estimate_joints, with_threads};
use tauscope::delay::{EstimateError, Settings};
use tauscope::experiment::Experiment;
use tauscope::report::{EstimateJson, EstimatedJoint, estimate_table};

use super::progress::{self, Verbosity};
use super::{Completion, message};
use files::Files;

pub(super) use args::Args;

type JointResult = Result<JointEstimate, EstimateError>;

pub(super) fn run(args: &Args) -> anyhow::Result<Completion> {
    let verbosity = args.output.verbosity();
    let settings = args.algorithm.settings();
    let files = Files::create(&args.output)?;
    let experiment = {
        let _bar = progress::bar(verbosity, "reading", 0);
        args.data.read()?
    };
    let trials = experiment.joints.iter().map(|joint| joint.trials.len() as u64).sum();
    let bar = progress::bar(verbosity, "estimating", trials);
    let work = || estimate_joints(&experiment.joints, &settings, || bar.inc(1));
    let results = with_threads(args.output.threads, work).context("threads cannot be started")?;
    drop(bar);
    let failures = failures(&experiment, &results);
    let estimated = estimated(&experiment, &results);
    if estimated.is_empty() {
        let first = results.into_iter().find_map(Result::err).context("no joint")?;
        return Err(anyhow::Error::from(first).context("no joint could be estimated"));
    }
    for failure in &failures {
        message("warning", failure);
    }
    if verbosity == Verbosity::Normal {
        for note in notes(&estimated) {
            message("note", &note);
        }
    }
    let result = Estimated { experiment: &experiment, joints: &estimated, settings: &settings };
    files.write(&result, verbosity)?;
    print(args.output.format, &result, &failures)?;
    Ok(if failures.is_empty() { Completion::Whole } else { Completion::Partial })
}

/// What was read and what came out.
#[derive(Clone, Copy)]
struct Estimated<'a> {
    experiment: &'a Experiment,
    joints: &'a [EstimatedJoint<'a>],
    settings: &'a Settings,
}

/// The joints that have an estimate, in the order of the log.
fn estimated<'a>(
    experiment: &'a Experiment,
    results: &'a [JointResult],
) -> Vec<EstimatedJoint<'a>> {
    let joints = experiment.joints.iter().zip(results);
    let estimated = joints.filter_map(|(joint, result)| Some((joint, result.as_ref().ok()?)));
    estimated.map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect()
}

/// A message on each file and joint that failed.
fn failures(experiment: &Experiment, results: &[JointResult]) -> Vec<String> {
    let unread = experiment.failures.iter().map(|failure| {
        let error = anyhow_chain(&failure.error);
        match &failure.joint {
            Some(joint) => format!("joint `{joint}` is left out: {error}"),
            None => format!("file is left out: {error}"),
        }
    });
    let joints = experiment.joints.iter().zip(results);
    let unestimated = joints.filter_map(|(joint, result)| {
        let error = result.as_ref().err()?;
        Some(format!("joint `{}` is left out: {error}", joint.name))
    });
    unread.chain(unestimated).collect()
}

/// An error with its causes, in one line.
fn anyhow_chain(error: &(dyn std::error::Error + 'static)) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    causes.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}

/// What a person should know who looks at the numbers.
fn notes(joints: &[EstimatedJoint<'_>]) -> Vec<String> {
    let mut notes = Vec::new();
    for EstimatedJoint { joint, estimate } in joints {
        let name = &joint.name;
        for error in estimate.failed() {
            notes.push(format!("joint `{name}`: {error}; the other trials are used"));
        }
        let steps: usize = estimate.estimated().map(|trial| trial.decisions.len()).sum();
        let samples: usize = joint.trials.iter().map(tauscope::experiment::Trial::len).sum();
        if 2 * steps > samples {
            notes.push(format!(
                "joint `{name}`: the input changes at {steps} of {samples} samples, so it is \
                 hardly held; `--min-step X` counts only changes above X"
            ));
        }
    }
    notes
}

fn print(format: args::Format, result: &Estimated<'_>, failures: &[String]) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    match format {
        args::Format::Text => {
            let table = estimate_table(result.joints, result.settings);
            out.write_all(table.as_bytes())?;
        }
        args::Format::Json => {
            let sources = &result.experiment.sources;
            let json = EstimateJson::new(sources, result.settings, result.joints, failures);
            serde_json::to_writer(&mut out, &json).map_err(io::Error::from)?;
            out.write_all(b"\n")?;
        }
    }
    Ok(out.flush()?)
}
