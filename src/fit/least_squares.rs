//! The parameters that make the training error least.

use super::covariance::Covariance;
use super::problem::Problem;
use super::record::FitRecord;
use super::result::{Assessment, Fit, FitError, Parameter, Status, Survey};
use super::search::{Depth, Search};
use super::space::Space;
use super::starts::starts;
use super::window::Part;
use crate::effect::RecordRange;
use crate::model::JointModel;

/// Fits the free parameters of `model` to the training windows of `record`.
///
/// Minimises `Σ w_k (y_k − ŷ_k)²` by Levenberg and Marquardt's method. `ŷ` is simulated
/// from the start of each window, from the output that makes the window's error least.
/// Outliers are weighted down (Huber's weights at 1.345 times the robust standard
/// deviation). Parameters stay in the bounds of their effect for this record, and in those
/// of the model.
///
/// Parameters of an effect that are neutral start from each of the effect's own starts. All
/// are followed until it is seen where they lead, in short windows, where an error does not
/// add up and there are fewer valleys; the best two go on to the end.
///
/// Standard errors allow for correlated residuals (Newey and West, 1987).
///
/// # Errors
/// [`FitError`] when there are too few samples.
///
/// # References
/// J. J. Moré, "The Levenberg-Marquardt algorithm: implementation and theory", 1978.
/// P. J. Huber, "Robust estimation of a location parameter", 1964.
pub fn fit(
    record: &FitRecord<'_>,
    model: &JointModel,
    range: &RecordRange<'_>,
) -> Result<Fit, FitError> {
    fit_to(record, model, range, Depth::whole(record.training_samples()))
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
    fit_to(record, model, range, Depth::comparing(record.training_samples()))
}

fn fit_to(
    record: &FitRecord<'_>,
    model: &JointModel,
    range: &RecordRange<'_>,
    depth: Depth,
) -> Result<Fit, FitError> {
    let space = Space::of(model, range);
    check_size(record, &space)?;
    let (training, short) = (record.for_training(), record.shortened());
    let searches = rough(&short, model, &space, range).into_iter();
    let finished = searches.map(|s| s.across_flats().onto(&training).descended(depth));
    let best = finished.min_by(|a, b| a.cost.total_cmp(&b.cost));
    let as_given = || Search::new(&training, model, &space, plain(model)).descended(depth);
    Ok(best.unwrap_or_else(as_given).into_fit(record))
}

/// A short descent from each start and a rough one from the best few: the best of these.
fn rough<'p, 'r>(
    short: &'p FitRecord<'r>,
    model: &'p JointModel,
    space: &'p Space,
    range: &RecordRange<'_>,
) -> Vec<Search<'p, 'r>> {
    let starts = starts(model, range);
    let are_many = starts.len() > FOLLOWED;
    let depth = if are_many { Depth::SCREEN } else { Depth::ROUGH };
    let begin = |start| Search::new(short, model, space, start).descended(depth);
    let mut searches: Vec<_> = starts.into_iter().map(begin).collect();
    searches.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    if are_many {
        let followed = searches.into_iter().take(FOLLOWED);
        searches = followed.map(|search| search.descended(Depth::ROUGH)).collect();
        searches.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    }
    searches.truncate(FINALISTS);
    searches
}

/// Surveys the free parameters of `model`, from the same starts as [`fit`].
///
/// # Errors
/// As [`fit`].
pub fn survey(
    record: &FitRecord<'_>,
    model: &JointModel,
    range: &RecordRange<'_>,
) -> Result<Survey, FitError> {
    let space = Space::of(model, range);
    check_size(record, &space)?;
    let short = record.shortened();
    let best =
        rough(&short, model, &space, range).into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
    let best = best.map(Search::across_flats);
    let found = best.map(|search| Survey { model: search.problem.model_now(), cost: search.cost });
    Ok(found.unwrap_or_else(|| Survey { model: model.clone(), cost: f64::MAX }))
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
    check_size(record, &space)?;
    let training = record.for_training();
    Ok(Search::new(&training, model, &space, plain(model)).assessment(record))
}

fn check_size(record: &FitRecord<'_>, space: &Space) -> Result<(), FitError> {
    let samples = record.training_samples();
    let parameters = space.free.len();
    if samples <= parameters + record.part(Part::Training).count() {
        return Err(FitError::TooFewSamples { samples, parameters });
    }
    Ok(())
}

fn plain(model: &JointModel) -> Vec<f64> {
    model.values().iter().map(|value| value.value).collect()
}

/// Starts that are followed beyond the first short descent.
const FOLLOWED: usize = 3;

/// Searches that are brought to their end; the others are given up when it is seen where
/// they lead.
const FINALISTS: usize = 2;

impl Search<'_, '_> {
    /// The fit to the training windows that was searched, on all of `whole`.
    fn into_fit(self, whole: &FitRecord<'_>) -> Fit {
        Fit { assessment: self.assessment(whole), cost: self.cost, termination: self.termination }
    }

    /// The model as it is now, on all of `whole`.
    fn assessment(&self, whole: &FitRecord<'_>) -> Assessment {
        let Problem { record, space, weights, .. } = &self.problem;
        let model = self.problem.model_now();
        let evaluation = self.problem.here();
        let covariance = Covariance::of(
            record,
            &model,
            (evaluation, weights.as_ref()),
            (&space.free, &space.bounds),
        );
        let parameter = |(index, (name, value)): (usize, (String, f64))| {
            let free = space.free.iter().position(|free| *free == index);
            let status = free.map_or(Status::Fixed, |free| space.status(&covariance, free));
            let std_error = free.and_then(|free| covariance.std_error(free));
            let std_error = std_error.filter(|_| status != Status::Undetermined);
            Parameter { name, value, std_error, status }
        };
        let named = model.names().into_iter().zip(plain(&model)).enumerate();
        Assessment {
            parameters: named.map(parameter).collect(),
            evaluation: self.problem.on(whole),
            model,
        }
    }
}
