//! What a program reads: a row per setting, and a row per step.

use super::swept::Swept;
use crate::delay::Settings;
use crate::delay::sweep::{Agreement, RunSummary, Spread, SweptStep};
use crate::recording::chunk::{Chunks, integers, lists, numbers, texts};
use crate::recording::error::RecordError;
use crate::units::{Length, signed};

/// Adds `/sweep/setting` and `/sweep/step` below `root`.
pub(super) fn add(chunks: &mut Chunks, swept: &Swept<'_>) -> Result<(), RecordError> {
    add_settings(chunks, swept)?;
    add_steps(chunks, swept)
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

fn add_settings(chunks: &mut Chunks, swept: &Swept<'_>) -> Result<(), RecordError> {
    let runs = || swept.grid.runs().iter();
    let whole = |of: fn(&Settings) -> Option<usize>| runs().map(move |run| of(run).map(signed));
    let summaries = || swept.reported.sweep.runs.iter().map(Option::as_ref);
    let count = |of: fn(&RunSummary) -> usize| summaries().map(move |run| Some(signed(of(run?))));
    let number = |of: fn(&RunSummary) -> Option<f64>| summaries().map(move |run| of(run?));
    let delays = |run: usize| {
        let steps = swept.reported.sweep.steps.iter();
        steps.map(|step| Swept::delay(step, run)).collect::<Vec<_>>()
    };
    let columns = [
        texts("method", runs().map(|run| Some(run.method.to_string()))),
        numbers("passband_hz", runs().map(|run| Some(run.low_pass?.cutoff_hz))),
        integers("alpha", whole(|run| samples(run.alpha_length()))),
        integers("beta", whole(|run| has_rows(run).then(|| samples(run.beta_length()))?)),
        integers("combinations", swept.votes.iter().map(|votes| Some(signed(*votes)))),
        integers("accepted", count(|run| run.accepted)),
        integers("disagreements", count(|run| run.disagreements)),
        numbers("median_delay_s", number(|run| run.median_s)),
        numbers("agrees", number(|run| run.agrees)),
        numbers("lag_mean_s", number(|run| run.lag_s)),
        lists("delays", &(0..runs().len()).map(delays).collect::<Vec<_>>()),
    ];
    chunks.push("sweep/setting", swept.settings(), columns)
}

fn add_steps(chunks: &mut Chunks, swept: &Swept<'_>) -> Result<(), RecordError> {
    let steps = || swept.steps.iter().map(|(step, _)| *step);
    let whole = |of: fn(&SweptStep) -> usize| steps().map(move |step| Some(signed(of(step))));
    let agreed = |of: fn(Agreement) -> f64| steps().map(move |step| step.agreement.map(of));
    let spread = |of: fn(Spread) -> f64| steps().map(move |step| step.spread.map(of));
    let on = |step: &SweptStep| step.delay_depends_on.as_ref().map(|on| on.factor.to_string());
    let delays = |step: &SweptStep| {
        (0..step.delays.len()).map(|run| Swept::delay(step, run)).collect::<Vec<_>>()
    };
    let columns = [
        texts("trial", steps().map(|step| Some(step.trial.clone()))),
        integers("i", whole(|step| step.number)),
        integers("p", whole(|step| step.sample)),
        integers("tried", whole(|step| step.tried)),
        integers("accepted", whole(|step| step.accepted)),
        integers("agree", whole(|step| step.accepted - step.disagreeing())),
        numbers("agreed", agreed(|agreed| agreed.delay)),
        numbers("agreed_low", agreed(|agreed| agreed.low)),
        numbers("agreed_high", agreed(|agreed| agreed.high)),
        numbers("min", spread(|all| all.min)),
        numbers("max", spread(|all| all.max)),
        texts("delay_hangs_on", steps().map(on)),
        texts(
            "verdict_hangs_on",
            steps().map(|step| step.verdict_depends_on.map(|on| on.to_string())),
        ),
        lists("delays", &steps().map(delays).collect::<Vec<_>>()),
    ];
    chunks.push("sweep/step", swept.index.clone(), columns)
}
