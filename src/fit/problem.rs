//! A model on a record, as a descent sees it.

use std::cell::OnceCell;

use nalgebra::{DMatrix, DVector};

use super::evaluation::Evaluation;
use super::record::FitRecord;
use super::space::{Space, place};
use crate::model::{BESIDE, JointModel};

/// A model on a record, and the free values at which it is.
pub(super) struct Problem<'p, 'r> {
    pub(super) record: &'p FitRecord<'r>,
    pub(super) model: &'p JointModel,
    pub(super) space: &'p Space,
    /// All values of the model; those that are free count where they are not changed.
    pub(super) start: Vec<f64>,
    /// The free values, in the order of the space.
    pub(super) free: DVector<f64>,
    /// The evaluation at `free`, once it is asked for: its residuals alone.
    pub(super) here: OnceCell<Evaluation>,
}

impl Problem<'_, '_> {
    fn model_at(&self, free: &DVector<f64>) -> JointModel {
        self.model.with_values(&self.space.values(&self.start, free))
    }

    pub(super) fn model_now(&self) -> JointModel {
        self.model_at(&self.free)
    }

    pub(super) fn here(&self) -> &Evaluation {
        self.here.get_or_init(|| self.record.evaluate_residuals(&self.model_now()))
    }

    /// The residuals of the training windows, one after the other; 0 at spikes.
    pub(super) fn residuals(&self) -> DVector<f64> {
        self.record.training(&self.here().residuals)
    }

    /// The residuals at free values near to those here, windows starting where they do here.
    pub(super) fn residuals_near(&self, free: &DVector<f64>) -> DVector<f64> {
        let mut found = self.record.training_near(&[self.model_at(free)], self.here());
        found.pop().unwrap_or_default()
    }

    /// The slopes of the residuals, which are `residuals` here, by differences.
    pub(super) fn jacobian(&self, residuals: &DVector<f64>) -> DMatrix<f64> {
        let mut slopes = DMatrix::zeros(residuals.len(), self.free.len());
        let all: Vec<usize> = (0..self.free.len()).collect();
        self.put_slopes(&mut slopes, &all, residuals);
        slopes
    }

    /// Puts the slopes of the residuals, which are `here` now, to the free values `indices` into
    /// these columns of `slopes`.
    pub(super) fn put_slopes(
        &self,
        slopes: &mut DMatrix<f64>,
        indices: &[usize],
        here: &DVector<f64>,
    ) {
        let step = |index: &usize| {
            let step = self.space.bounds[*index].step(self.free[*index]);
            (step != 0.0).then_some((*index, step))
        };
        let steps: Vec<(usize, f64)> = indices.iter().filter_map(step).collect();
        // All at once would take a second matrix.
        for some in steps.chunks(BESIDE) {
            let there = |(index, step): &(usize, f64)| {
                let mut there = self.free.clone();
                there[*index] += step;
                self.model_at(&there)
            };
            let models: Vec<JointModel> = some.iter().map(there).collect();
            let residuals = self.record.training_near(&models, self.here());
            for ((index, step), there) in some.iter().zip(residuals) {
                slopes.set_column(*index, &((there - here) / *step));
            }
        }
    }

    /// The sum of squares of the training windows, which a fit makes least; infinite where the
    /// simulation gives no numbers.
    pub(super) fn cost(&self) -> f64 {
        cost_of(&self.residuals())
    }

    pub(super) fn move_to(&mut self, free: &DVector<f64>) {
        self.free.copy_from(free);
        self.here.take();
    }

    /// Moves a variable across the jumps of its effect to the best value between two of them; whether that
    /// is another one.
    pub(super) fn cross_flat(&mut self, variable: usize) -> bool {
        let values = self.space.between_jumps(variable);
        let Some(index) = self.best_within(variable, values) else { return false };
        values.get(index).is_some_and(|value| self.is_better_with(&[(variable, *value)]))
    }

    /// Does so for two of the variables `flats`, where neither gains by itself: a valve
    /// that stops at a higher level than it starts at stops where it starts, whatever the one
    /// that is lower.
    pub(super) fn cross_two_flats(&mut self, flats: &[usize]) -> bool {
        // Levels that belong together are neighbours, and parameters of one effect.
        let pairs = flats.windows(2).filter_map(|pair| <[usize; 2]>::try_from(pair).ok());
        let pairs = pairs.filter(|pair| self.are_of_one_effect(*pair));
        let best =
            pairs.filter_map(|pair| self.best_of_two(pair)).min_by(|a, b| a.0.total_cmp(&b.0));
        best.is_some_and(|(_, values)| self.is_better_with(&values))
    }

    /// Moves to these values of some variables, where the error is less there; whether it is.
    fn is_better_with(&mut self, values: &[(usize, f64)]) -> bool {
        let (cost, start) = (self.cost(), self.free.clone());
        self.move_to(&with_values(&start, values));
        let is_better = self.cost() < cost;
        if !is_better {
            self.move_to(&start);
        }
        is_better
    }

    /// Whether two variables are parameters of the same effect.
    fn are_of_one_effect(&self, variables: [usize; 2]) -> bool {
        let [one, two] = variables.map(|variable| {
            let index = self.space.free.get(variable)?;
            place(self.model, *index).map(|(component, _)| component.effect().spec().id)
        });
        one == two
    }

    /// About the least error with some of the values of two variables, and these.
    fn best_of_two(&self, [one, two]: [usize; 2]) -> Option<(f64, [(usize, f64); 2])> {
        /// Values of each that are tried: all levels of most experiments.
        const COARSE: usize = 12;
        let some = |variable: usize| -> Vec<f64> {
            let values = self.space.between_jumps(variable);
            values.iter().step_by(values.len().div_ceil(COARSE).max(1)).copied().collect()
        };
        let (firsts, seconds) = (some(one), some(two));
        let with = |first: &f64| {
            let first = *first;
            seconds.iter().map(move |second| [(one, first), (two, *second)])
        };
        let all: Vec<_> = firsts.iter().flat_map(with).collect();
        let (cost, index) = self.least_of(&all)?;
        Some((cost, *all.get(index)?))
    }

    /// The index of about the best of `values` for a variable: some of them and the one next to where it
    /// is are tried, then those near the best of these, ever closer.
    fn best_within(&self, variable: usize, values: &[f64]) -> Option<usize> {
        /// Values that are tried at a time.
        const COARSE: usize = 24;
        let best_of = |indices: Vec<usize>| {
            let value = |index: &usize| Some([(variable, *values.get(*index)?)]);
            let tried: Vec<_> = indices.iter().filter_map(value).collect();
            indices.get(self.least_of(&tried)?.1).copied()
        };
        let mut stride = values.len().div_ceil(COARSE).max(1);
        let here = values.partition_point(|value| *value < self.free[variable]);
        let here = here.min(values.len().checked_sub(1)?);
        let mut best = best_of((0..values.len()).step_by(stride).chain([here]).collect())?;
        while stride > 1 {
            let near = best.saturating_sub(stride)..(best + stride).min(values.len());
            stride = (2 * stride).div_ceil(COARSE);
            best = best_of(near.step_by(stride).collect())?;
        }
        Some(best)
    }

    /// The least error with one of `all` values of some variables, and its index. Windows start at the
    /// outputs at which they start here: near enough to choose by, and one simulation each.
    fn least_of<const N: usize>(&self, all: &[[(usize, f64); N]]) -> Option<(f64, usize)> {
        let model = |values: &[(usize, f64); N]| self.model_at(&with_values(&self.free, values));
        let costs = all.chunks(BESIDE).flat_map(|some| {
            let models: Vec<JointModel> = some.iter().map(model).collect();
            let residuals = self.record.training_near(&models, self.here());
            residuals.iter().map(cost_of).collect::<Vec<f64>>()
        });
        costs.zip(0..).min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// `free` with other values of some variables.
fn with_values(free: &DVector<f64>, values: &[(usize, f64)]) -> DVector<f64> {
    let mut there = free.clone();
    for (variable, value) in values {
        there[*variable] = *value;
    }
    there
}

/// The sum of squares; infinite where one is not a number.
pub(super) fn cost_of(residuals: &DVector<f64>) -> f64 {
    let cost = residuals.norm_squared();
    if cost.is_finite() { cost } else { f64::INFINITY }
}
