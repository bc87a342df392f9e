//! What is said of errors, joints and logs that failed, and how completely a command was done.

use anyhow::anyhow;

use crate::cli::advice::advice;
use crate::experiment::{Experiment, Failure};

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

/// What became of a command that ran to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Completion {
    /// Everything was done.
    Whole,
    /// Some joints or files failed; the rest is in the output.
    Partial,
}

impl Completion {
    /// Whole where nothing failed.
    pub(crate) fn without(failures: &[String]) -> Self {
        if failures.is_empty() { Self::Whole } else { Self::Partial }
    }
}
