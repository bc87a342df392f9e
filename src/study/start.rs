//! Where the model of a joint starts from, and what becomes of it before it is compared.

use super::estimate::JointEstimate;
use super::protocol::Mode;
use crate::delay::{Decision, EstimateError, TrialEstimate};
use crate::experiment::Joint;
use crate::fit::{Assessment, Fit, FitError, FitRecord, assess, fit};
use crate::model::{JointModel, integrators};
use crate::numerics::median;

/// The models that a joint may start from; `None` where it needs one and has none.
pub(super) fn starts(
    mode: Mode,
    joint: &Joint,
    estimated: &[&TrialEstimate],
    models: &impl Fn(&Joint) -> Option<JointModel>,
) -> Option<Vec<JointModel>> {
    match mode {
        Mode::Integrator => Some(integrators(joint, estimated)),
        Mode::Fit | Mode::AsItIs => Some(vec![models(joint)?]),
        Mode::FitOrIntegrator => {
            let given = models(joint).map(|model| vec![model]);
            Some(given.unwrap_or_else(|| integrators(joint, estimated)))
        }
    }
}

/// The median of the accepted delays of a joint in seconds, or its dead time over the record;
/// 0 without any.
pub(super) fn typical_delay_s(
    (joint, estimate): (&Joint, &Result<JointEstimate, EstimateError>),
) -> f64 {
    let estimated = estimate.iter().flat_map(JointEstimate::estimated);
    let delays = estimated.flat_map(|trial| {
        let known = joint.trials.iter().find(|known| known.label() == trial.label);
        let period_s = known.map_or(0.0, |known| known.period().seconds());
        let accepted = trial.decisions.iter().filter_map(Decision::accepted_delay);
        accepted.map(move |samples| samples * period_s)
    });
    let delays: Vec<f64> = delays.collect();
    let over_record = || Some(estimate.as_ref().ok()?.dead_time.as_ref()?.bounds()?.value_s);
    median(&delays).or_else(over_record).unwrap_or(0.0)
}

/// The best of the fits from several starts.
pub(super) fn best_fit(
    record: &FitRecord<'_>,
    starts: &[JointModel],
) -> Option<Result<Fit, FitError>> {
    let range = record.range_for(starts.first()?);
    let fits = starts.iter().map(|start| fit(record, start, &range));
    let cost = |result: &Result<Fit, FitError>| result.as_ref().map_or(f64::MAX, |fit| fit.cost);
    fits.min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

/// The first of the models as it is.
pub(super) fn as_it_is(
    record: &FitRecord<'_>,
    models: &[JointModel],
) -> Option<Result<Assessment, FitError>> {
    let model = models.first()?;
    Some(assess(record, model, &record.range_for(model)))
}
