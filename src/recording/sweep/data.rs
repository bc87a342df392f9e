//! What a program reads: a row per setting, and a row per step.

use serde_json::Value;

use super::swept::Swept;
use crate::delay::Settings;
use crate::delay::sweep::{RunSummary, SweptStep};
use crate::recording::chunk::{Chunks, columns, lists};
use crate::recording::error::RecordError;
use crate::report::Kind::{self, Real, Text, Whole};
use crate::units::Length;

/// Settings, what they made of the record, and how many combinations they represent.
type Run<'s> = (&'s Settings, Option<&'s RunSummary>, usize);

type OfRun = fn(&Run<'_>) -> Value;
type OfStep = fn(&&SweptStep) -> Value;

/// A row per run.
#[rustfmt::skip]
const SETTING: &[(&str, Kind, OfRun)] = &[
    ("method", Text, |(run, ..)| run.method.to_string().into()),
    ("passband_hz", Real, |(run, ..)| run.low_pass.map(|low_pass| low_pass.cutoff_hz).into()),
    ("alpha", Whole, |(run, ..)| samples(run.alpha_length()).into()),
    ("beta", Whole, |(run, ..)| samples(run.beta_length()).filter(|_| !run.method.spec().has_intervals).into()),
    ("combinations", Whole, |(.., combinations)| (*combinations).into()),
    ("accepted", Whole, |(_, found, _)| found.map(|run| run.accepted).into()),
    ("disagreements", Whole, |(_, found, _)| found.map(|run| run.disagreements).into()),
    ("median_delay_s", Real, |(_, found, _)| found.and_then(|run| run.median_s).into()),
    ("agrees", Real, |(_, found, _)| found.and_then(|run| run.agrees).into()),
    ("lag_mean_s", Real, |(_, found, _)| found.and_then(|run| run.lag_s).into()),
];

/// A row per step.
#[rustfmt::skip]
const STEP: &[(&str, Kind, OfStep)] = &[
    ("trial", Text, |step| step.trial.as_str().into()),
    ("i", Whole, |step| step.number.into()),
    ("p", Whole, |step| step.sample.into()),
    ("tried", Whole, |step| step.tried.into()),
    ("accepted", Whole, |step| step.accepted.into()),
    ("agree", Whole, |step| (step.accepted - step.disagreeing()).into()),
    ("agreed", Real, |step| step.agreement.map(|agreed| agreed.delay).into()),
    ("agreed_low", Real, |step| step.agreement.map(|agreed| agreed.low).into()),
    ("agreed_high", Real, |step| step.agreement.map(|agreed| agreed.high).into()),
    ("min", Real, |step| step.spread.map(|all| all.min).into()),
    ("max", Real, |step| step.spread.map(|all| all.max).into()),
    ("delay_hangs_on", Text, |step| step.delay_depends_on.as_ref().map(|on| on.factor.to_string()).into()),
    ("verdict_hangs_on", Text, |step| step.verdict_depends_on.map(|on| on.to_string()).into()),
];

/// A number of samples; none of what is in seconds.
fn samples(length: Length) -> Option<usize> {
    match length {
        Length::Samples(samples) => Some(samples),
        Length::Seconds(_) => None,
    }
}

/// Adds `/sweep/setting` and `/sweep/step` below `root`.
pub(super) fn add(chunks: &mut Chunks, swept: &Swept<'_>) -> Result<(), RecordError> {
    let runs = swept.grid.runs().iter().zip(&swept.reported.sweep.runs).zip(&swept.votes);
    let runs: Vec<Run<'_>> =
        runs.map(|((run, found), votes)| (run, found.as_ref(), *votes)).collect();
    let all = &swept.reported.sweep.steps;
    let of_run = |run: usize| all.iter().map(|step| Swept::delay(step, run)).collect::<Vec<_>>();
    let mut settings = columns(&runs, SETTING);
    settings.push(lists("delays", &(0..runs.len()).map(of_run).collect::<Vec<_>>()));
    chunks.push("sweep/setting", swept.settings(), settings)?;
    let steps: Vec<&SweptStep> = swept.steps.iter().map(|(step, _)| *step).collect();
    let of_step = |step: &&SweptStep| {
        (0..step.delays.len()).map(|run| Swept::delay(step, run)).collect::<Vec<_>>()
    };
    let mut of_steps = columns(&steps, STEP);
    of_steps.push(lists("delays", &steps.iter().map(of_step).collect::<Vec<_>>()));
    chunks.push("sweep/step", swept.index.clone(), of_steps)
}
