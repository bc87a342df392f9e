//! What is said of errors, joints and logs that failed.

use anyhow::anyhow;

use crate::cli::advice::advice;
use crate::experiment::{Experiment, Failure, Joint};

/// An error with its causes and the option to use, in one line.
pub(crate) fn said(error: &(dyn std::error::Error + 'static)) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    let advice: String = causes.clone().map(advice).collect();
    causes.map(ToString::to_string).collect::<Vec<_>>().join(": ") + &advice
}

/// A message on a joint that failed.
pub(crate) fn joint_left_out(joint: &str, error: &(dyn std::error::Error + 'static)) -> String {
    format!("joint `{joint}` is left out: {}", said(error))
}

/// A message on each file and joint that could not be read.
pub(crate) fn read_failures(experiment: &Experiment) -> Vec<String> {
    let failure = |failure: &Failure| match &failure.joint {
        Some(joint) => joint_left_out(joint, &failure.error),
        None => format!("left out: {}", said(&failure.error)),
    };
    experiment.failures.iter().map(failure).collect()
}

/// The error of a command none of whose joints is of use; `failure` is a reason.
pub(crate) fn nothing_usable(failure: Option<&String>) -> anyhow::Error {
    anyhow!(failure.map_or("no joint in the logs", String::as_str).to_owned())
}

/// What came of each joint, and messages on what failed.
///
/// # Errors
/// The first message when there is nothing else.
pub(crate) fn outcomes<'a, T, U, E: std::error::Error + 'static>(
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
                failures.push(joint_left_out(&joint.name, error));
            }
            None => failures.push(format!("joint `{}` has no model", joint.name)),
        }
    }
    match failures.first() {
        Some(first) if done.is_empty() => Err(nothing_usable(Some(first))),
        _ => Ok((done, failures)),
    }
}
