//! The delays of a joint for whoever only wants the delays.

use super::estimate::estimate_joint;
use super::method::Method;
use super::settings::{FirstLast, Settings};
use super::trial_estimate::EstimateError;
use crate::experiment::{Record, Trial};

/// The dead time of one change of the input, seconds, with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepDelay {
    /// The most likely one.
    pub delay_s: f64,
    /// Lower end of the interval.
    pub low_s: f64,
    /// Upper end of the interval.
    pub high_s: f64,
}

/// The dead time of every change of the input in all `trials` of a joint, by the best
/// method there is; none where nothing happened or it cannot be determined.
///
/// # Errors
/// [`EstimateError`], when a trial cannot be estimated.
///
/// # Examples
/// ```
/// use tauscope::delay::step_delays;
/// use tauscope::experiment::Trial;
/// use tauscope::units::SamplePeriod;
///
/// // The output follows 12 samples later.
/// let input: Vec<f64> = (0..200).map(|k| if k < 100 { 0.0 } else { 1.0 }).collect();
/// let output: Vec<f64> = (0..200).map(|k| 0.2 * f64::from((k - 112).max(0))).collect();
/// let period = SamplePeriod::from_seconds(0.01).unwrap();
/// let trial = Trial::new("swing", 0.0, period, input, output).unwrap();
/// let delays = step_delays(&[trial].into()).unwrap();
/// assert!((delays[0][0].unwrap().delay_s - 0.12).abs() < 1e-6);
/// ```
pub fn step_delays(trials: &Record) -> Result<Vec<Vec<Option<StepDelay>>>, EstimateError> {
    // A line between the samples of a slow sensor looks like a lag: what is asked then is where the output
    // bends, without one.
    let is_interpolated = trials.iter().any(|trial| !trial.interpolated().is_empty());
    let method = if is_interpolated { Method::HINGE } else { Method::AUTO };
    let settings = Settings { first_last: FirstLast::Keep, ..Settings::of(method) };
    let estimates = estimate_joint(trials, &settings);
    let of = |(trial, estimate): (&Trial, Result<_, EstimateError>)| {
        let estimate: super::trial_estimate::TrialEstimate = estimate?;
        let period_s = trial.period().seconds();
        let decisions = estimate.decisions.iter().map(|decision| {
            decision.accepted_delay()?;
            let fine = decision.fine?;
            Some(StepDelay {
                delay_s: fine.delay * period_s,
                low_s: fine.low * period_s,
                high_s: fine.high * period_s,
            })
        });
        Ok(decisions.collect())
    };
    trials.iter().zip(estimates).map(of).collect()
}
