//! The parameters that make the training error least.

use std::cell::{Cell, OnceCell};
use std::fmt;

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, DVectorView, Dyn};

use super::bounds::Bounds;
use super::covariance::{Covariance, robust_scale};
use super::record::{Evaluation, Part, Record, Weights};
use crate::effect::{Dimension, RecordRange};
use crate::model::{Component, JointModel, Value};

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
    record: &Record<'_>,
    model: &JointModel,
    range: &RecordRange<'_>,
) -> Result<Fit, FitError> {
    let space = Space::of(model, range);
    check_size(record, &space)?;
    let short = record.shortened();
    let begin = |start| Search::new(&short, model, &space, start).descended(Depth::ROUGH);
    let mut searches: Vec<_> = starts(model, range).into_iter().map(begin).collect();
    searches.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let given_up = searches.split_off(FINALISTS.min(searches.len()));
    let depth = Depth::whole(record.training_samples());
    let mut finished: Vec<_> =
        searches.into_iter().map(|s| s.across_flats().onto(record).descended(depth)).collect();
    finished.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let simulations = finished.iter().chain(&given_up).map(Search::simulations).sum();
    let best = finished.into_iter().next();
    let best = best.unwrap_or_else(|| Search::new(record, model, &space, plain(model)));
    Ok(best.into_fit(simulations))
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
    Ok(Search::new(record, model, &space, plain(model)).into_fit(0))
}

fn check_size(record: &Record<'_>, space: &Space) -> Result<(), FitError> {
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

/// Searches that are brought to their end; the others are given up when it is seen where
/// they lead.
const FINALISTS: usize = 2;

/// Start values: those of the model, and the starts of effects that are still neutral.
fn starts(model: &JointModel, range: &RecordRange<'_>) -> Vec<Vec<f64>> {
    /// Combinations that are tried at most.
    const MOST: usize = 16;
    let mut starts = vec![vec![model.gain.value, model.delay.value]];
    for component in model.components() {
        let own = component_starts(component, range);
        let with = |start: &Vec<f64>| {
            own.iter().map(|own| [start.as_slice(), own].concat()).collect::<Vec<_>>()
        };
        starts = starts.iter().flat_map(with).take(MOST).collect();
    }
    starts
}

/// The starts of one effect: its own for those of its parameters that are neutral and not
/// fixed, and the values it has where any is not neutral.
fn component_starts(component: &Component, range: &RecordRange<'_>) -> Vec<Vec<f64>> {
    let given = component.parameters();
    let neutral = component.effect().spec().neutral();
    #[expect(clippy::float_cmp, reason = "neutral is a number that is set")]
    let keeps = |(value, neutral): (&Value, &f64)| value.fixed || value.value != *neutral;
    let keeps: Vec<bool> = given.iter().zip(&neutral).map(keeps).collect();
    let plain: Vec<f64> = given.iter().map(|value| value.value).collect();
    if keeps.iter().all(|keeps| *keeps) {
        return vec![plain];
    }
    let mut starts = component.effect().starts(range);
    for start in &mut starts {
        for (value, (given, _)) in
            start.iter_mut().zip(plain.iter().zip(&keeps)).filter(|(_, (_, keeps))| **keeps)
        {
            *value = *given;
        }
    }
    starts.dedup();
    let any_set = given.iter().zip(&keeps).any(|(value, keeps)| *keeps && !value.fixed);
    if any_set {
        starts.insert(0, plain);
    }
    starts
}

/// The free parameters of a model and their bounds.
struct Space {
    /// Index in [`JointModel::values`] of each free parameter.
    free: Vec<usize>,
    bounds: Vec<Bounds>,
    /// For each of them the values, one for each gap between levels of the input, between
    /// which an effect may do nothing but switch; none for what is not a level.
    flats: Vec<Vec<f64>>,
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
        let (free, bounds): (Vec<_>, Vec<_>) = free
            .map(|(index, ((low, high, _), value))| {
                let low = value.min.map_or(*low, |min| min.max(*low));
                let high = value.max.map_or(*high, |max| max.min(*high));
                (index, Bounds { low, high })
            })
            .unzip();
        let flats = free.iter().zip(&bounds).map(|(index, bounds)| {
            if is_level(model, *index) {
                bounds.within(&range.thresholds(usize::MAX))
            } else {
                Vec::new()
            }
        });
        Self { flats: flats.collect(), free, bounds }
    }

    /// What a fit could do with a free parameter.
    fn status(&self, covariance: &Covariance, place: usize) -> Status {
        let is_lost = |error| self.bounds.get(place).is_some_and(|bounds| bounds.is_lost_in(error));
        match covariance.std_error(place) {
            _ if covariance.is_at_bound(place) => Status::AtBound,
            Some(error) if !is_lost(error) => Status::Fitted,
            _ => Status::Undetermined,
        }
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

/// Whether a parameter of `model` is a level of the input.
fn is_level(model: &JointModel, index: usize) -> bool {
    let specs = model.components().iter().flat_map(|c| c.effect().spec().parameters);
    let place = index.checked_sub(2);
    place
        .and_then(|place| specs.clone().nth(place))
        .is_some_and(|p| p.dimension == Dimension::Input)
}

/// What the optimiser works on.
struct Problem<'p, 'r> {
    record: &'p Record<'r>,
    model: &'p JointModel,
    space: &'p Space,
    start: Vec<f64>,
    variables: DVector<f64>,
    /// Whether the optimiser has it: before, the start holds, also where it is on a bound.
    moves: bool,
    weights: Option<Weights>,
    /// The evaluation at `variables`, once it is asked for.
    here: OnceCell<Evaluation>,
    evaluations: Cell<usize>,
}

impl Problem<'_, '_> {
    fn model_at(&self, variables: &DVector<f64>) -> JointModel {
        self.model.with_values(&self.space.values(&self.start, variables))
    }

    fn model_now(&self) -> JointModel {
        if self.moves {
            self.model_at(&self.variables)
        } else {
            self.model.with_values(&self.start)
        }
    }

    fn here(&self) -> &Evaluation {
        self.here.get_or_init(|| {
            self.evaluations.set(self.evaluations.get() + 1);
            self.record.evaluate_weighted(&self.model_now(), self.weights.as_ref())
        })
    }

    /// The residuals of the training windows, one behind the other, times the roots of
    /// their weights.
    fn weighted(&self, residuals: &[Vec<f64>]) -> DVector<f64> {
        let mut residuals = self.record.training(residuals);
        if let Some(weights) = &self.weights {
            let weights = self.record.training(weights);
            residuals.zip_apply(&weights, |residual, weight| *residual *= weight.sqrt());
        }
        residuals
    }

    /// The slope of the residuals, which are `here` now, to one variable.
    fn slope(&self, place: usize, here: &DVector<f64>) -> DVector<f64> {
        /// A step in an angle, or in parts of a value.
        const STEP: f64 = 1e-6;
        let mut variables = self.variables.clone();
        let step = variables.get(place).map_or(STEP, |v| STEP * v.abs().max(0.1));
        if let Some(variable) = variables.get_mut(place) {
            *variable += step;
        }
        self.evaluations.set(self.evaluations.get() + 1);
        let (model, weights) = (self.model_at(&variables), self.weights.as_ref());
        (self.weighted(&self.record.residuals_near(&model, weights, self.here())) - here) / step
    }

    /// Sets weights anew from the residuals; whether there is anything to weigh.
    fn reweigh(&mut self) -> bool {
        let weights = huber(self.record, &self.here().residuals);
        let any = weights.is_some() || self.weights.is_some();
        if any {
            self.weights = weights;
            self.here.take();
        }
        any
    }

    /// The robust error of the training windows.
    fn cost(&self) -> f64 {
        huber_cost(&self.record.training(&self.here().residuals))
    }

    /// Moves a variable on whose small changes nothing depends to the best of the values
    /// between which it matters; whether that is another one.
    fn cross_flat(&mut self, place: usize) -> bool {
        /// Values that are tried first; then those about the best of them.
        const COARSE: usize = 24;
        let values = self.space.flats.get(place).map_or(&[][..], Vec::as_slice);
        let stride = values.len().div_ceil(COARSE).max(1);
        let (cost, start) = (self.cost(), self.variables.clone());
        let coarse: Vec<usize> = (0..values.len()).step_by(stride).collect();
        let Some((_, about)) = self.best_of(place, values, coarse) else { return false };
        let near = about.saturating_sub(stride)..(about + stride).min(values.len());
        let best = self.best_of(place, values, near).filter(|(least, _)| *least < cost);
        self.set_params(&start);
        let Some(value) = best.and_then(|(_, index)| values.get(index)) else { return false };
        self.set_value(place, *value);
        true
    }

    /// The least error with one of `values` for a variable, and its index.
    fn best_of(
        &mut self,
        place: usize,
        values: &[f64],
        indices: impl IntoIterator<Item = usize>,
    ) -> Option<(f64, usize)> {
        let costs = indices.into_iter().filter_map(|index| {
            self.set_value(place, *values.get(index)?);
            Some((self.cost(), index))
        });
        costs.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Sets one variable to that of `value`.
    fn set_value(&mut self, place: usize, value: f64) {
        let pair = self.variables.get_mut(place).zip(self.space.bounds.get(place));
        if let Some((variable, bounds)) = pair {
            *variable = bounds.free(value);
        }
        self.here.take();
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_, '_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, variables: &DVector<f64>) {
        self.variables.copy_from(variables);
        self.here.take();
    }

    fn params(&self) -> DVector<f64> {
        self.variables.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let residuals = self.weighted(&self.here().residuals);
        residuals.iter().all(|r| r.is_finite()).then_some(residuals)
    }

    /// By differences in the optimiser's variables, windows starting where they do here. A
    /// variable that has come to its bound stays there.
    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let here = self.weighted(&self.here().residuals);
        let noise = here.norm() / (here.len() as f64).sqrt();
        let column = |(place, bounds): (usize, &Bounds)| {
            let mut column = self.slope(place, &here);
            let std_error = noise / column.norm();
            let variable = self.variables.get(place).copied().unwrap_or_default();
            if bounds.stops(variable, column.dot(&here), std_error) {
                column.fill(0.0);
            }
            column
        };
        let columns: Vec<_> = self.space.bounds.iter().enumerate().map(column).collect();
        let finite = columns.iter().all(|column| column.iter().all(|value| value.is_finite()));
        finite.then(|| DMatrix::from_columns(&columns))
    }
}

/// A descent from one start.
struct Search<'p, 'r> {
    problem: Problem<'p, 'r>,
    cost: f64,
    termination: Termination,
}

/// How far a descent goes.
#[derive(Clone, Copy)]
struct Depth {
    /// It stops when a step makes the sum of squares less by a smaller part than this.
    relative_gain: f64,
    /// Evaluations per variable.
    patience: usize,
    /// How often weights are set anew, at most.
    rounds: usize,
}

/// Weights are settled when they change the robust error by a smaller part than this.
const SETTLED: f64 = 1e-6;

impl Depth {
    /// To see which of several starts leads down.
    const ROUGH: Self = Self { relative_gain: 1e-3, patience: 6, rounds: 1 };

    /// As far as the data reach: one standard error of a parameter changes the sum of
    /// squares of `n` samples by its part `1/n`, a hundredth of one by `1e-4/n`.
    fn whole(samples: usize) -> Self {
        Self { relative_gain: 1e-4 / samples.max(1) as f64, patience: 40, rounds: 20 }
    }
}

impl<'p, 'r> Search<'p, 'r> {
    fn new(
        record: &'p Record<'r>,
        model: &'p JointModel,
        space: &'p Space,
        start: Vec<f64>,
    ) -> Self {
        let free = space.free.iter().zip(&space.bounds);
        let variables =
            free.map(|(index, bounds)| bounds.free(start.get(*index).copied().unwrap_or_default()));
        let variables = DVector::from_vec(variables.collect());
        let problem = Problem {
            record,
            model,
            space,
            start,
            variables,
            moves: false,
            weights: None,
            here: OnceCell::new(),
            evaluations: Cell::new(0),
        };
        Self { problem, cost: f64::NAN, termination: Termination::NothingToFit }
    }

    /// The same on another cut of the record.
    fn onto(mut self, record: &'p Record<'r>) -> Self {
        self.problem.record = record;
        self.problem.weights = None;
        self.problem.here.take();
        self
    }

    /// The same further down.
    fn descended(mut self, depth: Depth) -> Self {
        let gain = depth.relative_gain;
        let optimiser = LevenbergMarquardt::new().with_ftol(gain).with_xtol(1e-9).with_gtol(1e-12);
        let rounds = if self.problem.variables.is_empty() { 0 } else { depth.rounds };
        self.problem.moves = rounds > 0;
        for round in 1..=rounds {
            let (moved, report) = optimiser.with_patience(depth.patience).minimize(self.problem);
            self.problem = moved;
            self.termination = Termination::of(&report.termination);
            let before = std::mem::replace(&mut self.cost, self.problem.cost());
            let settled = (before - self.cost).abs() <= SETTLED * self.cost;
            if settled || round == rounds || !self.problem.reweigh() {
                break;
            }
        }
        self
    }

    /// The same with the parameters on which nothing depends but in jumps at their best.
    fn across_flats(mut self) -> Self {
        /// One may have to wait for another.
        const PASSES: usize = 3;
        for _ in 0..PASSES {
            let Some(jacobian) = self.problem.jacobian() else { break };
            let is_flat = |(_, column): &(usize, DVectorView<'_, f64>)| column.amax() <= 0.0;
            let flat = jacobian.column_iter().enumerate().filter(is_flat);
            let places: Vec<usize> = flat.map(|(place, _)| place).collect();
            if places.into_iter().filter(|place| self.problem.cross_flat(*place)).count() == 0 {
                break;
            }
            self = self.descended(Depth::ROUGH);
        }
        self
    }

    fn simulations(&self) -> usize {
        self.problem.evaluations.get()
    }
}

/// Residuals beyond this many robust standard deviations are weighted down; it keeps
/// 95 % of the efficiency on normal noise (Huber 1964).
const HUBER: f64 = 1.345;

/// The weights, or `None` where there is no outlier to speak of.
fn huber(record: &Record<'_>, residuals: &[Vec<f64>]) -> Option<Weights> {
    /// In normal noise no sample of a long record lies so far out.
    const OUTLIER: f64 = 6.0;
    let training = record.training(residuals);
    let scale = robust_scale(training.as_slice());
    let is_outlier = |r: &f64| r.abs() > OUTLIER * scale;
    if scale <= 0.0 || !training.iter().any(is_outlier) {
        return None;
    }
    let weight = |r: &f64| HUBER * scale / r.abs().max(HUBER * scale);
    Some(residuals.iter().map(|residuals| residuals.iter().map(weight).collect()).collect())
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

impl Search<'_, '_> {
    fn into_fit(self, simulations: usize) -> Fit {
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
            evaluation: evaluation.clone(),
            cost: self.cost,
            model,
            termination: self.termination,
            simulations,
        }
    }
}
