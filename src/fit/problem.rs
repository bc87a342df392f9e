//! A model on a record, as the optimiser sees it.

use std::cell::OnceCell;

use levenberg_marquardt::LeastSquaresProblem;
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

use super::bounds::Bounds;
use super::evaluation::{Evaluation, Weights};
use super::record::FitRecord;
use super::space::Space;
use crate::model::JointModel;
use crate::numerics::robust_scale;

/// What the optimiser works on.
pub(super) struct Problem<'p, 'r> {
    pub(super) record: &'p FitRecord<'r>,
    pub(super) model: &'p JointModel,
    pub(super) space: &'p Space,
    pub(super) start: Vec<f64>,
    pub(super) variables: DVector<f64>,
    /// Whether the optimiser has it: before, the start holds, also where it is on a bound.
    pub(super) moves: bool,
    pub(super) weights: Option<Weights>,
    /// The evaluation at `variables`, once it is asked for.
    pub(super) here: OnceCell<Evaluation>,
}

impl Problem<'_, '_> {
    fn model_at(&self, variables: &DVector<f64>) -> JointModel {
        self.model.with_values(&self.space.values(&self.start, variables))
    }

    pub(super) fn model_now(&self) -> JointModel {
        if self.moves {
            self.model_at(&self.variables)
        } else {
            self.model.with_values(&self.start)
        }
    }

    pub(super) fn here(&self) -> &Evaluation {
        self.here
            .get_or_init(|| self.record.evaluate_weighted(&self.model_now(), self.weights.as_ref()))
    }

    /// The model as it is now on another cut of the record; outliers there are weighted down
    /// too.
    pub(super) fn on(&self, record: &FitRecord<'_>) -> Evaluation {
        let model = self.model_now();
        let evaluation = record.evaluate_weighted(&model, self.weights.as_ref());
        let weights = self.weights.as_ref().and_then(|_| huber(record, &evaluation.residuals));
        weights.map_or(evaluation, |w| record.evaluate_weighted(&model, Some(&w)))
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
    fn slope(&self, index: usize, here: &DVector<f64>) -> DVector<f64> {
        /// A step in an angle, or in parts of a value.
        const STEP: f64 = 1e-6;
        let mut variables = self.variables.clone();
        let step = STEP * variables[index].abs().max(0.1);
        variables[index] += step;
        let (model, weights) = (self.model_at(&variables), self.weights.as_ref());
        (self.weighted(&self.record.residuals_near(&model, weights, self.here())) - here) / step
    }

    /// Sets weights anew from the residuals; whether there is anything to weigh.
    pub(super) fn reweigh(&mut self) -> bool {
        let weights = huber(self.record, &self.here().residuals);
        let any = weights.is_some() || self.weights.is_some();
        if any {
            self.weights = weights;
            self.here.take();
        }
        any
    }

    /// The robust error of the training windows.
    pub(super) fn cost(&self) -> f64 {
        huber_cost(&self.record.training(&self.here().residuals))
    }

    /// Moves a variable on whose small changes the error does not depend to the best of the values
    /// between which it matters; whether that is another one.
    pub(super) fn cross_flat(&mut self, variable: usize) -> bool {
        let values = self.space.flats.get(variable).map_or(&[][..], Vec::as_slice);
        let (cost, start) = (self.cost(), self.variables.clone());
        let best = self.best_within(variable, values).filter(|(least, _)| *least < cost);
        self.set_params(&start);
        let Some(value) = best.and_then(|(_, index)| values.get(index)) else { return false };
        self.set_value(variable, *value);
        true
    }

    /// Does so for two of the variables `flats`, where neither gains by itself: a valve
    /// that stops at a higher level than it starts at stops where it starts, whatever the one
    /// that is lower.
    pub(super) fn cross_two_flats(&mut self, flats: &[usize]) -> bool {
        let pairs = flats.iter().enumerate();
        let pairs = pairs.flat_map(|(n, one)| flats.iter().skip(n + 1).map(|two| [*one, *two]));
        let (cost, start) = (self.cost(), self.variables.clone());
        let best = pairs.filter_map(|pair| self.best_of_two(pair)).collect::<Vec<_>>();
        let best = best.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        self.set_params(&start);
        let Some((_, values)) = best.filter(|(least, _)| *least < cost) else { return false };
        for (variable, value) in values {
            self.set_value(variable, value);
        }
        true
    }

    /// The least error with some of the values of two variables, and these.
    fn best_of_two(&mut self, [one, two]: [usize; 2]) -> Option<(f64, [(usize, f64); 2])> {
        /// Values of each that are tried: all levels of most experiments.
        const COARSE: usize = 12;
        let space = self.space;
        let (firsts, seconds) = (space.flats.get(one)?, space.flats.get(two)?);
        let some = |values: &[f64]| (0..values.len()).step_by(values.len().div_ceil(COARSE).max(1));
        let of_first = |index: usize| {
            let first = *firsts.get(index)?;
            self.set_value(one, first);
            let (cost, second) = self.best_of(two, seconds, some(seconds))?;
            Some((cost, [(one, first), (two, *seconds.get(second)?)]))
        };
        let all = some(firsts).filter_map(of_first).collect::<Vec<_>>();
        all.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The least error with one of `values` for a variable, and its index: some of them are
    /// tried, then those near the best of these, ever closer.
    fn best_within(&mut self, variable: usize, values: &[f64]) -> Option<(f64, usize)> {
        /// Values that are tried at a time.
        const COARSE: usize = 24;
        let mut stride = values.len().div_ceil(COARSE).max(1);
        let mut best = self.best_of(variable, values, (0..values.len()).step_by(stride))?;
        while stride > 1 {
            let near = best.1.saturating_sub(stride)..(best.1 + stride).min(values.len());
            stride = (2 * stride).div_ceil(COARSE);
            best = self.best_of(variable, values, near.step_by(stride))?;
        }
        Some(best)
    }

    /// The least error with one of `values` for a variable, and its index.
    fn best_of(
        &mut self,
        variable: usize,
        values: &[f64],
        indices: impl IntoIterator<Item = usize>,
    ) -> Option<(f64, usize)> {
        let costs = indices.into_iter().filter_map(|index| {
            self.set_value(variable, *values.get(index)?);
            Some((self.cost(), index))
        });
        costs.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Sets one variable to that of `value`.
    fn set_value(&mut self, variable: usize, value: f64) {
        self.variables[variable] = self.space.bounds[variable].free(value);
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
        let column = |(index, bounds): (usize, &Bounds)| {
            let mut column = self.slope(index, &here);
            let std_error = noise / column.norm();
            let variable = self.variables[index];
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

/// Residuals beyond this many robust standard deviations are weighted down; it keeps
/// 95 % of the efficiency on normal noise (Huber 1964).
const HUBER: f64 = 1.345;

/// The weights, or `None` where there is no outlier to speak of.
fn huber(record: &FitRecord<'_>, residuals: &[Vec<f64>]) -> Option<Weights> {
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
