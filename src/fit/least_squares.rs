//! The parameters that make the training error least.

use std::fmt;

use levenberg_marquardt::TerminationReason;

use super::covariance::Covariance;
use super::problem::Problem;
use super::record::{Evaluation, FitRecord, Part};
use super::search::{Depth, Search};
use super::space::Space;
use super::starts::starts;
use crate::effect::RecordRange;
use crate::model::JointModel;

/// A fitted model, with how sure its parameters are and why the fit stopped.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The robust sum of squared errors that was made least; `NaN` for a model as it is.
    pub cost: f64,
    /// The model at the fitted values.
    pub model: JointModel,
    /// Its parameters, in the order of [`JointModel::values`].
    pub parameters: Vec<Parameter>,
    /// The model on the record.
    pub evaluation: Evaluation,
    /// Why it stopped.
    pub termination: Termination,
    /// Simulations of the record that it took.
    pub simulations: usize,
}

/// A parameter of a fitted model.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// `gain`, or `dead_band.lower`.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its standard error, where the data determine it.
    pub std_error: Option<f64>,
    /// What the fit could do with it.
    pub status: Status,
}

/// What a fit could do with a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// It was fitted.
    Fitted,
    /// It was not to be changed.
    Fixed,
    /// It came to lie on a bound: its standard error says little.
    AtBound,
    /// The data do not determine it: the error is the same over a wide range.
    Undetermined,
}

/// Why a fit stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// No change of the parameters makes the error less.
    Converged,
    /// There was nothing to fit.
    NothingToFit,
    /// It took too many simulations; the parameters may not be the best.
    OutOfPatience,
    /// The simulation gave no numbers any more.
    Numerical,
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::NothingToFit => "nothing to fit",
            Self::OutOfPatience => "stopped after too many simulations",
            Self::Numerical => "the simulation gave no numbers",
        })
    }
}

/// Why a model cannot be fitted at all.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// There are fewer samples for training than parameters.
    #[error("{samples} samples for training are too few for {parameters} parameters")]
    TooFewSamples {
        /// Samples there are.
        samples: usize,
        /// Parameters to fit.
        parameters: usize,
    },
}

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

/// The same, stopped when what is left to gain is too little to change a comparison of
/// models. Standard errors are those of [`fit`].
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
    let (searches, given_up) = rough(&short, model, &space, range);
    let mut finished: Vec<_> =
        searches.into_iter().map(|s| s.across_flats().onto(&training).descended(depth)).collect();
    finished.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let simulations: usize = finished.iter().map(Search::simulations).sum();
    let best = finished.into_iter().next();
    let best = best.unwrap_or_else(|| Search::new(&training, model, &space, plain(model)));
    Ok(best.into_fit(record, simulations + given_up))
}

/// A glance at each start and a rough descent from the best few: the best of these, and the
/// simulations of the others.
fn rough<'p, 'r>(
    short: &'p FitRecord<'r>,
    model: &'p JointModel,
    space: &'p Space,
    range: &RecordRange<'_>,
) -> (Vec<Search<'p, 'r>>, usize) {
    let starts = starts(model, range);
    let depth = if starts.len() > FOLLOWED { Depth::GLANCE } else { Depth::ROUGH };
    let begin = |start| Search::new(short, model, space, start).descended(depth);
    let mut searches: Vec<_> = starts.into_iter().map(begin).collect();
    searches.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut given_up = 0;
    if searches.len() > FOLLOWED {
        given_up += searches.split_off(FOLLOWED).iter().map(Search::simulations).sum::<usize>();
        searches = searches.into_iter().map(|s| s.descended(Depth::ROUGH)).collect();
        searches.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    }
    let others = searches.split_off(FINALISTS.min(searches.len()));
    (searches, given_up + others.iter().map(Search::simulations).sum::<usize>())
}

/// A glance at a model: where a rough descent in short windows leads, and its robust sum of
/// squared errors there.
///
/// Sums are comparable between models of the same record.
#[derive(Clone, Debug)]
pub struct Survey {
    /// The model at the values that were found.
    pub model: JointModel,
    /// The sum in the short windows.
    pub cost: f64,
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
    let (searches, _) = rough(&short, model, &space, range);
    let best = searches.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
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
) -> Result<Fit, FitError> {
    let space = Space::of(model, range);
    check_size(record, &space)?;
    let training = record.for_training();
    Ok(Search::new(&training, model, &space, plain(model)).into_fit(record, 0))
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

/// Starts that are followed beyond a glance.
const FOLLOWED: usize = 3;

/// Searches that are brought to their end; the others are given up when it is seen where
/// they lead.
const FINALISTS: usize = 2;

impl Termination {
    pub(super) fn of(reason: &TerminationReason) -> Self {
        match reason {
            TerminationReason::LostPatience => Self::OutOfPatience,
            TerminationReason::User(_)
            | TerminationReason::Numerical(_)
            | TerminationReason::WrongDimensions(_) => Self::Numerical,
            TerminationReason::NoParameters | TerminationReason::NoResiduals => Self::NothingToFit,
            TerminationReason::ResidualsZero
            | TerminationReason::Orthogonal
            | TerminationReason::Converged { .. }
            | TerminationReason::NoImprovementPossible(_) => Self::Converged,
        }
    }
}

impl Search<'_, '_> {
    /// The fit to the training windows that was searched, on all of `whole`.
    fn into_fit(self, whole: &FitRecord<'_>, simulations: usize) -> Fit {
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
            let place = space.free.iter().position(|free| *free == index);
            let status = place.map_or(Status::Fixed, |place| space.status(&covariance, place));
            let std_error = place.and_then(|place| covariance.std_error(place));
            let std_error = std_error.filter(|_| status != Status::Undetermined);
            Parameter { name, value, std_error, status }
        };
        let named = model.names().into_iter().zip(plain(&model)).enumerate();
        Fit {
            parameters: named.map(parameter).collect(),
            evaluation: self.problem.on(whole),
            cost: self.cost,
            model,
            termination: self.termination,
            simulations,
        }
    }
}
