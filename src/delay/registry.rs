//! The methods: one file each, one entry here.

use super::decision::Decision;
use super::prepared::Prepared;
use super::response::Lag;
use super::settings::{Method, Settings};
use super::{hinge, lag_aware, two_line};

/// The lag that the trials of a joint share, where the method looks for it.
pub(super) fn lag_of(trials: &[Prepared<'_>], settings: &Settings) -> Option<Lag> {
    settings.method.shares_a_lag().then(|| lag_aware::lag_of(trials, settings))
}

/// The decisions on all steps of a trial.
pub(super) fn decide_all(
    trial: &Prepared<'_>,
    lag: Option<&Lag>,
    settings: &Settings,
) -> Vec<Decision> {
    let (output, steps) = (trial.output(), trial.steps.as_slice());
    match (settings.method, lag) {
        (Method::TwoLine, _) => two_line::decide_all(output, trial.raw, steps, settings),
        (Method::LagAware, Some(lag)) if lag.order() > 0 => {
            lag_aware::decide_all(output, steps, lag, trial.period, settings)
        }
        // Without a lag there is nothing but the broken line.
        (Method::Hinge | Method::LagAware, _) => hinge::decide_all(output, steps, settings),
    }
}
