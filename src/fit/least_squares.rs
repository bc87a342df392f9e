//! The parameters that make the training error least.

use std::fmt;

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

use super::bounds::Bounds;
use super::covariance::{Covariance, robust_scale};
use super::record::{Evaluation, Part, Record};
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
/// from the start of each window; the starting angle is profiled out by taking the
/// window's mean off the residual. Outliers are weighted down (Huber's weights at
/// 1.345 times the robust standard deviation). Parameters stay in the bounds of their
/// effect for this record, and in those of the model.
///
/// An effect still at its neutral values is started from each of its own starts, and the
/// best result is kept.
///
/// Standard errors allow for correlated residuals, see [`super::covariance`].
///
/// # Errors
/// [`FitError`] when there are too few samples.
///
/// # References
/// J. J. Moré, "The Levenberg-Marquardt algorithm: implementation and theory", 1978.
/// P. J. Huber, "Robust estimation of a location parameter", 1964.
pub fn fit(
    record: &Record<'_>,
    model: &JointModel,
    range: &RecordRange<'_>,
) -> Result<Fit, FitError> {
    let space = Space::of(model, range);
    check_size(record, &space)?;
    let starts = starts(model, range);
    let fits = starts.iter().map(|start| descend(record, model, &space, start));
    let best = fits.min_by(|a, b| a.cost.total_cmp(&b.cost));
    let best = best.unwrap_or_else(|| descend(record, model, &space, &plain(model)));
    Ok(best.into_fit(record, &space))
}

/// The model as it is, with the standard errors its free parameters would have if they
/// were fitted.
///
/// # Errors
/// As [`fit`].
pub fn assess(
    record: &Record<'_>,
    model: &JointModel,
    range: &RecordRange<'_>,
) -> Result<Fit, FitError> {
    let space = Space::of(model, range);
    check_size(record, &space)?;
    let (model, cost, termination) = (model.clone(), f64::NAN, Termination::NothingToFit);
    Ok(Descent { model, cost, termination, simulations: 0 }.into_fit(record, &space))
}

fn check_size(record: &Record<'_>, space: &Space) -> Result<(), FitError> {
    let samples: usize = record.part(Part::Training).map(|w| w.end - w.start).sum();
    let parameters = space.free.len();
    if samples <= parameters + record.part(Part::Training).count() {
        return Err(FitError::TooFewSamples { samples, parameters });
    }
    Ok(())
}

fn plain(model: &JointModel) -> Vec<f64> {
    model.values().iter().map(|value| value.value).collect()
}

/// Start values: those of the model, or the starts of effects that are still neutral.
fn starts(model: &JointModel, range: &RecordRange<'_>) -> Vec<Vec<f64>> {
    /// Combinations that are tried at most.
    const MOST: usize = 12;
    let mut starts = vec![vec![model.gain.value, model.delay.value]];
    for component in model.components() {
        let values: Vec<f64> = component.parameters().iter().map(|p| p.value).collect();
        let own = if values == component.effect().spec().neutral() {
            component.effect().starts(range)
        } else {
            vec![values]
        };
        let with = |start: &Vec<f64>| {
            own.iter().map(|own| [start.as_slice(), own].concat()).collect::<Vec<_>>()
        };
        starts = starts.iter().flat_map(with).take(MOST).collect();
    }
    starts
}

/// The free parameters of a model and their bounds.
struct Space {
    /// Index in [`JointModel::values`] of each free parameter.
    free: Vec<usize>,
    bounds: Vec<Bounds>,
}

impl Space {
    fn of(model: &JointModel, range: &RecordRange<'_>) -> Self {
        /// No joint of this kind reacts later than this.
        const LONGEST_DELAY_S: f64 = 5.0;
        let delay = (0.0, LONGEST_DELAY_S.min(0.5 * range.duration_s));
        let mut bounds = vec![(f64::MIN, f64::MAX, true), (delay.0, delay.1, true)];
        for component in model.components() {
            let effect = component.effect();
            let fitted = effect.spec().parameters.iter().map(|parameter| parameter.fitted);
            bounds
                .extend(effect.bounds(range).into_iter().zip(fitted).map(|((l, h), f)| (l, h, f)));
        }
        let values = model.values();
        let all = bounds.iter().zip(&values).enumerate();
        let free = all.filter(|(_, ((_, _, fitted), value))| *fitted && !value.fixed);
        let (free, bounds) = free
            .map(|(index, ((low, high, _), value))| {
                let low = value.min.map_or(*low, |min| min.max(*low));
                let high = value.max.map_or(*high, |max| max.min(*high));
                (index, Bounds { low, high })
            })
            .unzip();
        Self { free, bounds }
    }

    /// All values of the model, with the free ones where the optimiser's variables are.
    fn values(&self, start: &[f64], variables: &DVector<f64>) -> Vec<f64> {
        let mut values = start.to_vec();
        for ((index, bounds), variable) in self.free.iter().zip(&self.bounds).zip(variables.iter())
        {
            if let Some(value) = values.get_mut(*index) {
                *value = bounds.value(*variable);
            }
        }
        values
    }
}

/// What the optimiser works on.
struct Problem<'p, 'r> {
    record: &'p Record<'r>,
    model: &'p JointModel,
    space: &'p Space,
    start: &'p [f64],
    variables: DVector<f64>,
    /// Square roots of the samples' weights.
    weights: Option<DVector<f64>>,
    simulations: std::cell::Cell<usize>,
}

impl Problem<'_, '_> {
    fn model_at(&self, variables: &DVector<f64>) -> JointModel {
        self.model.with_values(&self.space.values(self.start, variables))
    }

    /// Residuals of the training windows, one below the other.
    fn residuals_at(&self, variables: &DVector<f64>) -> DVector<f64> {
        self.simulations.set(self.simulations.get() + 1);
        training(self.record, &self.record.evaluate(&self.model_at(variables)))
    }

    fn weighted(&self, residuals: DVector<f64>) -> DVector<f64> {
        match &self.weights {
            Some(weights) => residuals.component_mul(weights),
            None => residuals,
        }
    }
}

/// Residuals of the training windows.
fn training(record: &Record<'_>, evaluation: &Evaluation) -> DVector<f64> {
    let windows = record.part(Part::Training);
    let values = windows.filter_map(|w| evaluation.residuals.get(w.trial)?.get(w.start..w.end));
    DVector::from_vec(values.flatten().copied().collect())
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_, '_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, variables: &DVector<f64>) {
        self.variables.copy_from(variables);
    }

    fn params(&self) -> DVector<f64> {
        self.variables.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let residuals = self.residuals_at(&self.variables);
        residuals.iter().all(|r| r.is_finite()).then(|| self.weighted(residuals))
    }

    /// By central differences in the optimiser's variables.
    fn jacobian(&self) -> Option<DMatrix<f64>> {
        /// A step in an angle, or in parts of a value.
        const STEP: f64 = 1e-5;
        let column = |index: usize| {
            let size = self.variables.get(index).map_or(1.0, |v| v.abs().max(1e-2));
            let step = STEP * size;
            let at = |shift: f64| {
                let mut variables = self.variables.clone();
                if let Some(variable) = variables.get_mut(index) {
                    *variable += shift;
                }
                self.residuals_at(&variables)
            };
            self.weighted((at(step) - at(-step)) / (2.0 * step))
        };
        let columns: Vec<_> = (0..self.variables.len()).map(column).collect();
        let finite = columns.iter().all(|column| column.iter().all(|value| value.is_finite()));
        finite.then(|| DMatrix::from_columns(&columns))
    }
}

/// A finished descent.
struct Descent {
    model: JointModel,
    cost: f64,
    termination: Termination,
    simulations: usize,
}

/// Descends from one start, with weights set anew as the residuals become smaller.
fn descend(record: &Record<'_>, model: &JointModel, space: &Space, start: &[f64]) -> Descent {
    /// Rounds of weights; they hardly change after the second.
    const ROUNDS: usize = 3;
    /// Evaluations per variable.
    const PATIENCE: usize = 40;
    let free = space.free.iter().zip(&space.bounds);
    let variables =
        free.map(|(index, bounds)| bounds.free(start.get(*index).copied().unwrap_or_default()));
    let variables = DVector::from_vec(variables.collect());
    let simulations = std::cell::Cell::new(0);
    let mut problem =
        Problem { record, model, space, start, variables, weights: None, simulations };
    let mut termination = Termination::NothingToFit;
    let optimiser = LevenbergMarquardt::new().with_ftol(1e-10).with_xtol(1e-9).with_gtol(1e-12);
    for _ in 0..ROUNDS {
        if space.free.is_empty() {
            break;
        }
        let (moved, report) = optimiser.with_patience(PATIENCE).minimize(problem);
        problem = moved;
        termination = Termination::of(&report.termination);
        let weights = huber(&problem.residuals_at(&problem.variables));
        if weights.is_none() {
            break;
        }
        problem.weights = weights;
    }
    let residuals = problem.residuals_at(&problem.variables);
    let cost = huber_cost(&residuals);
    let model = problem.model_at(&problem.variables);
    Descent { model, cost, termination, simulations: problem.simulations.get() }
}

/// Residuals beyond this many robust standard deviations are weighted down; it keeps
/// 95 % of the efficiency on normal noise (Huber 1964).
const HUBER: f64 = 1.345;

/// Square roots of the weights, or `None` where there is no outlier to speak of.
fn huber(residuals: &DVector<f64>) -> Option<DVector<f64>> {
    /// In normal noise no sample of a long record lies so far out.
    const OUTLIER: f64 = 6.0;
    let scale = robust_scale(residuals.as_slice());
    let is_outlier = |r: &f64| r.abs() > OUTLIER * scale;
    if scale <= 0.0 || !residuals.iter().any(is_outlier) {
        return None;
    }
    Some(residuals.map(|r| (HUBER * scale / r.abs().max(HUBER * scale)).sqrt()))
}

/// The sum of squares, outliers counted by their distance only.
fn huber_cost(residuals: &DVector<f64>) -> f64 {
    let limit = HUBER * robust_scale(residuals.as_slice());
    let cost = |r: f64| if r.abs() <= limit { r * r } else { limit * (2.0 * r.abs() - limit) };
    let cost: f64 = residuals.iter().map(|r| cost(*r)).sum();
    if cost.is_finite() { cost } else { f64::INFINITY }
}

impl Termination {
    fn of(reason: &TerminationReason) -> Self {
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

impl Descent {
    fn into_fit(self, record: &Record<'_>, space: &Space) -> Fit {
        let evaluation = record.evaluate(&self.model);
        let values = plain(&self.model);
        let covariance = Covariance::of(record, &self.model, &space.free, |index, value| {
            space.bounds.get(index).map_or(1e-6, |bounds| bounds.step(value))
        });
        let parameter = |(index, (name, value)): (usize, (String, f64))| {
            let Some(place) = space.free.iter().position(|free| *free == index) else {
                return Parameter { name, value, std_error: None, status: Status::Fixed };
            };
            let at_bound = space.bounds.get(place).is_some_and(|bounds| bounds.is_at(value));
            let std_error = covariance.std_error(place);
            let status = match std_error {
                None => Status::Undetermined,
                Some(_) if at_bound => Status::AtBound,
                Some(_) => Status::Fitted,
            };
            Parameter { name, value, std_error, status }
        };
        let named = self.model.names().into_iter().zip(values).enumerate();
        Fit {
            parameters: named.map(parameter).collect(),
            evaluation,
            cost: self.cost,
            model: self.model,
            termination: self.termination,
            simulations: self.simulations,
        }
    }
}
