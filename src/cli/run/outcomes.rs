//! What came of each joint.

use crate::cli::failure::{joint_left_out, nothing_usable, read_failures};
use crate::experiment::{Experiment, Joint};

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
