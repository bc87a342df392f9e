//! What a program reads: a row per setting, and a row per step.

use rerun::EntityPath;

use super::swept::Swept;
use crate::delay::Settings;
use crate::delay::sweep::{Agreement, RunSummary, Spread, SweptStep};
use crate::recording::chunk::{Chunks, integers, numbers, optional_lists, texts};
use crate::recording::error::RecordError;
use crate::recording::paths::{at, sweep as paths};
use crate::units::{Length, signed};

/// Adds `/sweep/setting` and `/sweep/step` below `root`.
pub(super) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    swept: &Swept<'_>,
) -> Result<(), RecordError> {
    add_settings(chunks, at(root, paths::SETTING), swept)?;
    add_steps(chunks, at(root, paths::STEP), swept)
}

/// A number of samples; none of what is in seconds.
fn samples(length: Length) -> Option<usize> {
    match length {
        Length::Samples(samples) => Some(samples),
        Length::Seconds(_) => None,
    }
}

fn has_rows(run: &Settings) -> bool {
    !run.method.spec().has_intervals
}

fn add_settings(
    chunks: &mut Chunks,
    entity: EntityPath,
    swept: &Swept<'_>,
) -> Result<(), RecordError> {
    let runs = swept.grid.runs();
    let whole = |of: fn(&Settings) -> Option<usize>| -> Vec<Option<i64>> {
        runs.iter().map(|run| of(run).map(signed)).collect()
    };
    let summaries = &swept.reported.sweep.runs;
    let count = |of: fn(&RunSummary) -> usize| -> Vec<Option<i64>> {
        summaries.iter().map(|run| run.as_ref().map(|run| signed(of(run)))).collect()
    };
    let number = |of: fn(&RunSummary) -> Option<f64>| -> Vec<Option<f64>> {
        summaries.iter().map(|run| run.as_ref().and_then(of)).collect()
    };
    let passbands = runs.iter().map(|run| run.low_pass.map(|low_pass| low_pass.cutoff_hz));
    let votes = swept.votes.iter().map(|votes| Some(signed(*votes)));
    let delays = |run: usize| {
        let steps = swept.reported.sweep.steps.iter();
        steps.map(|step| Swept::delay(step, run)).collect::<Vec<_>>()
    };
    let columns = [
        texts("method", &runs.iter().map(|run| Some(run.method.to_string())).collect::<Vec<_>>()),
        numbers("passband_hz", &passbands.collect::<Vec<_>>()),
        integers("alpha", &whole(|run| samples(run.alpha_length()))),
        integers("beta", &whole(|run| has_rows(run).then(|| samples(run.beta_length()))?)),
        integers("combinations", &votes.collect::<Vec<_>>()),
        integers("accepted", &count(|run| run.accepted)),
        integers("disagreements", &count(|run| run.disagreements)),
        numbers("median_delay_s", &number(|run| run.median_s)),
        numbers("agrees", &number(|run| run.agrees)),
        numbers("lag_mean_s", &number(|run| run.lag_s)),
        optional_lists("delays", &(0..runs.len()).map(delays).collect::<Vec<_>>()),
    ];
    chunks.push(entity, swept.settings(), columns)
}

fn add_steps(
    chunks: &mut Chunks,
    entity: EntityPath,
    swept: &Swept<'_>,
) -> Result<(), RecordError> {
    let steps = || swept.steps.iter().map(|(step, _)| *step);
    let whole = |of: fn(&SweptStep) -> usize| -> Vec<Option<i64>> {
        steps().map(|step| Some(signed(of(step)))).collect()
    };
    let agreed = |of: fn(Agreement) -> f64| -> Vec<Option<f64>> {
        steps().map(|step| step.agreement.map(of)).collect()
    };
    let spread = |of: fn(Spread) -> f64| -> Vec<Option<f64>> {
        steps().map(|step| step.spread.map(of)).collect()
    };
    let words =
        |of: fn(&SweptStep) -> Option<String>| -> Vec<Option<String>> { steps().map(of).collect() };
    let on = |step: &SweptStep| step.delay_depends_on.as_ref().map(|on| on.factor.to_string());
    let delays = |step: &SweptStep| {
        (0..step.delays.len()).map(|run| Swept::delay(step, run)).collect::<Vec<_>>()
    };
    let columns = [
        texts("trial", &words(|step| Some(step.trial.clone()))),
        integers("i", &whole(|step| step.number)),
        integers("p", &whole(|step| step.sample)),
        integers("tried", &whole(|step| step.tried)),
        integers("accepted", &whole(|step| step.accepted)),
        integers("agree", &whole(|step| step.accepted - step.disagreeing())),
        numbers("agreed", &agreed(|agreed| agreed.delay)),
        numbers("agreed_low", &agreed(|agreed| agreed.low)),
        numbers("agreed_high", &agreed(|agreed| agreed.high)),
        numbers("min", &spread(|all| all.min)),
        numbers("max", &spread(|all| all.max)),
        texts("delay_hangs_on", &words(on)),
        texts("verdict_hangs_on", &words(|s| s.verdict_depends_on.map(|on| on.to_string()))),
        optional_lists("delays", &steps().map(delays).collect::<Vec<_>>()),
    ];
    chunks.push(entity, swept.index.clone(), columns)
}
