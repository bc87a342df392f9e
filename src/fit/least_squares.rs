//! The parameters that make the training error least.

use std::sync::Arc;

use super::covariance::Covariance;
use super::descent::Limits;
use super::problem::Problem;
use super::record::FitRecord;
use super::result::{AssessedModel, Assessment, Fit, FitError, Parameter, Status};
use super::search::{Search, check_record, comparing, plain, whole};
use super::space::Space;
use super::survey::{Survey, survey};
use super::turn;
use crate::effect::RecordRange;
use crate::experiment::{LARGEST, Trial};
use crate::model::JointModel;

/// Fits the free parameters of `model` to the training windows of `record`.
///
/// Minimises `Σ w_k (y_k − ŷ_k)²` by Levenberg and Marquardt's method. `ŷ` is simulated
/// from the start of each window, from the output that makes the window's error least. `w_k` is
/// 1, and 0 for isolated spikes of the sensor, which follow from the record alone: the sum is
/// that of the training error, for every model. Parameters stay in the bounds of their effect
/// for this record, and in those of the model.
///
/// Parameters of an effect that are neutral start from each of the effect's own starts. Those
/// that promise most are followed until it is seen where they lead, in short windows, where an
/// error does not add up and there are fewer valleys, and in one of some samples; the best two go on in whole
/// windows, and the better of them on all samples. Levels at which an effect jumps, as those of a
/// stiction, are chosen on all windows, fitted or not. The model as it was given is a start, too: the
/// error is never larger than its own, so an effect that was added where it is neutral never makes it
/// larger.
///
/// Standard errors allow for correlated residuals (Newey and West, 1987).
///
/// # Errors
/// [`FitError`] when there are too few samples, or the model gives no finite numbers.
///
/// # References
/// D. W. Marquardt, "An algorithm for least-squares estimation of nonlinear parameters", 1963.
pub fn fit(
    record: &FitRecord<'_>,
    model: &JointModel,
    range: &RecordRange<'_>,
) -> Result<Fit, FitError> {
    fit_to(record, model, range, whole(record.training_samples()))
}

/// Whether a model gives numbers on the whole record that double precision can compute with.
fn check_numbers(assessment: &Assessment) -> Result<(), FitError> {
    let mut residuals = assessment.evaluation.residuals.iter().flatten();
    // What is no number is not in the range.
    let is_usable = residuals.all(|residual| (-LARGEST..=LARGEST).contains(residual));
    if is_usable { Ok(()) } else { Err(FitError::NotFinite) }
}

/// Fits as [`fit`] does, but stops when the cost can fall by too little to change a comparison
/// of models. Standard errors are those of [`fit`].
///
/// # Errors
/// As [`fit`].
pub fn fit_to_compare(
    record: &FitRecord<'_>,
    model: &JointModel,
    range: &RecordRange<'_>,
) -> Result<Fit, FitError> {
    fit_to(record, model, range, comparing(record.training_samples()))
}

fn fit_to(
    record: &FitRecord<'_>,
    model: &JointModel,
    range: &RecordRange<'_>,
    limits: Limits,
) -> Result<Fit, FitError> {
    check_record(record, &Space::of(model, range))?;
    check_changes(record)?;
    let surveyed = survey(record, model, range)?;
    descended(record, (&surveyed.model, model), range, limits)
}

/// The fit of a model that was [surveyed](survey), as far as [`fit_to_compare`] goes. The error is not
/// larger than that of `other`, the same structure at other values: those of a simpler model, and neutral
/// ones.
///
/// # Errors
/// As [`fit`].
pub fn fit_surveyed(
    record: &FitRecord<'_>,
    surveyed: &Survey,
    other: &JointModel,
    range: &RecordRange<'_>,
) -> Result<Fit, FitError> {
    let limits = comparing(record.training_samples());
    descended(record, (&surveyed.model, other), range, limits)
}

/// The fit on all samples from the values of `surveyed`, or from those of `other` where these are better
/// than what it leads to.
fn descended(
    record: &FitRecord<'_>,
    (surveyed, other): (&JointModel, &JointModel),
    range: &RecordRange<'_>,
    limits: Limits,
) -> Result<Fit, FitError> {
    let space = Space::of(surveyed, range);
    let _turn = turn::wait_for(record.training_samples() * space.free.len());
    let training = record.for_training();
    let mut found = Search::new(&training, surveyed, &space, plain(surveyed)).descended(limits);
    // A descent may have come across a level that only the part has that is not fitted.
    let whole = space.has_jumps().then(|| record.coarser_for(surveyed).unsplit());
    if let Some(whole) = &whole {
        let before = found.problem.free.clone();
        found = found.across_flats_of(whole);
        if found.problem.free != before {
            found = found.descended(limits);
        }
    }
    // A value that does nothing may lie outside of the bounds.
    let given = plain(other);
    let held = space.holding(&given);
    let given = Search::new(&training, other, &held, given);
    let is_less = found.cost <= given.problem.cost();
    let best = if is_less { found } else { given.descended(limits) };
    let fit = best.into_fit(record);
    check_numbers(&fit.assessment)?;
    Ok(fit)
}

/// The model as it is, with the standard errors its free parameters would have if they
/// were fitted.
///
/// # Errors
/// As [`fit`].
pub fn assess(
    record: &FitRecord<'_>,
    model: &JointModel,
    range: &RecordRange<'_>,
) -> Result<Assessment, FitError> {
    let space = Space::of(model, range);
    check_record(record, &space)?;
    let training = record.for_training();
    // The bounds are those of a fit to this record: a model that is compared as it is may lie
    // beyond them.
    let values = plain(model);
    let held = space.holding(&values);
    let assessment = Search::new(&training, model, &held, values).assessment(record);
    check_numbers(&assessment)?;
    Ok(assessment)
}

/// Whether both signals change: a gain is the one in parts of the other.
fn check_changes(record: &FitRecord<'_>) -> Result<(), FitError> {
    let trials = &record.joint().trials;
    let changes = |signal: fn(&Trial) -> &[f64]| {
        let mut values = trials.iter().flat_map(signal);
        let first = values.next();
        values.any(|value| first.is_some_and(|first| (*value - *first).abs() > 0.0))
    };
    for (name, signal) in
        [("input", Trial::input as fn(&Trial) -> &[f64]), ("output", Trial::output)]
    {
        if !changes(signal) {
            return Err(FitError::NeverChanges { signal: name });
        }
    }
    Ok(())
}

impl Search<'_, '_> {
    /// The fit to the training windows that was searched, on all of `whole`.
    fn into_fit(self, whole: &FitRecord<'_>) -> Fit {
        let (cost, termination) = (self.cost, self.termination);
        Fit { assessment: self.assessment(whole), cost, termination }
    }

    /// The model as it is now, on all of `whole`.
    fn assessment(mut self, whole: &FitRecord<'_>) -> Assessment {
        let slopes = self.slopes.take();
        let Problem { space, .. } = &self.problem;
        let (model, residuals) = (self.problem.model_now(), self.problem.residuals());
        let slopes = slopes.unwrap_or_else(|| self.problem.jacobian(&residuals));
        let covariance = Covariance::of(slopes, &residuals, space, &plain(&model));
        let parameter = |(index, (name, value)): (usize, (String, f64))| {
            let free = space.free.iter().position(|free| *free == index);
            let status = free.map_or(Status::Fixed, |free| covariance.status(space, free, value));
            let std_error = free.and_then(|free| covariance.std_error(free));
            let std_error = std_error.filter(|_| status == Status::Fitted);
            Parameter { name, value, std_error, status }
        };
        let named = model.names().into_iter().zip(plain(&model)).enumerate();
        let parameters = named.map(parameter).collect();
        let evaluation = Arc::new(whole.evaluate(&model));
        Assessment { assessed: AssessedModel { model, parameters }, evaluation }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Stiction;
    use crate::experiment::{Joint, Trial};
    use crate::fit::{Horizon, Split};
    use crate::model::Component;
    use crate::units::SamplePeriod;

    #[test]
    fn a_level_that_only_the_unseen_part_has_decides_where_a_stiction_starts() {
        // Only the second of each three blocks of four holds has levels at which the joint sticks.
        let large = [1.0, 0.0, -1.0, 0.0];
        let small = [0.5, 0.0, -0.5, 0.0];
        let levels = [large, small, large, large, small, large, large].concat();
        let input: Vec<f64> =
            levels.iter().flat_map(|level| std::iter::repeat_n(*level, 60)).collect();
        let mut angle = 0.0;
        let mut turn = |level: &f64| {
            angle += 0.1 * if level.abs() > 0.6 { *level } else { 0.0 };
            angle
        };
        let output = input.iter().map(&mut turn).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let joint = Joint::new("boom", vec![Trial::new("1", 0.0, period, input, output).unwrap()]);
        let record = FitRecord::new(&joint, Split::Blocks, Horizon::Steps);
        let model = JointModel::integrator(8.0, 0.0).with(Component::neutral(&Stiction));
        let found = fit(&record, &model, &record.range(10.0)).unwrap();
        let start = found.model.components()[0].plain()[0];
        assert!((0.5..1.0).contains(&start), "{start}");
    }
}
