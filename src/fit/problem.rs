//! A model on a record, as a descent sees it.

use std::cell::OnceCell;

use nalgebra::{DMatrix, DVector};

use super::evaluation::Evaluation;
use super::record::FitRecord;
use super::space::Space;
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

    /// The residuals of the training windows, one behind the other; 0 at spikes.
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

    /// Moves a variable on whose small changes the error does not depend to the best of the values
    /// between which it matters; whether that is another one.
    pub(super) fn cross_flat(&mut self, variable: usize) -> bool {
        let values = self.space.flats.get(variable).map_or(&[][..], Vec::as_slice);
        let (cost, start) = (self.cost(), self.free.clone());
        let best = self.best_within(variable, values).filter(|(least, _)| *least < cost);
        self.move_to(&start);
        let Some(value) = best.and_then(|(_, index)| values.get(index)) else { return false };
        self.set_value(variable, *value);
        true
    }

    /// Does so for two of the variables `flats`, where neither gains by itself: a valve
    /// that stops at a higher level than it starts at stops where it starts, whatever the one
    /// that is lower.
    pub(super) fn cross_two_flats(&mut self, flats: &[usize]) -> bool {
        // Levels that belong together are neighbours.
        let pairs = flats.windows(2).filter_map(|pair| <[usize; 2]>::try_from(pair).ok());
        let (cost, start) = (self.cost(), self.free.clone());
        let best = pairs.filter_map(|pair| self.best_of_two(pair)).collect::<Vec<_>>();
        let best = best.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        self.move_to(&start);
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

    /// Sets one free value.
    fn set_value(&mut self, variable: usize, value: f64) {
        self.free[variable] = value;
        self.here.take();
    }
}

/// The sum of squares; infinite where one is not a number.
pub(super) fn cost_of(residuals: &DVector<f64>) -> f64 {
    let cost = residuals.norm_squared();
    if cost.is_finite() { cost } else { f64::INFINITY }
}
