//! Descents from one start value.

use std::cell::OnceCell;

use nalgebra::DMatrix;

use super::descent::{Ended, Limits, descend};
use super::problem::Problem;
use super::record::FitRecord;
use super::result::{FitError, Termination};
use super::space::Space;
use super::window::Part;
use crate::effect::UNLIMITED;
use crate::experiment::Trial;
use crate::model::JointModel;

/// A descent from one start.
pub(super) struct Search<'p, 'r> {
    pub(super) problem: Problem<'p, 'r>,
    /// The sum of squared errors where it stopped; infinite before it set out.
    pub(super) cost: f64,
    pub(super) termination: Termination,
    /// The slopes of the residuals where it stopped, where they are known.
    pub(super) slopes: Option<DMatrix<f64>>,
}

/// To see which of several starts leads down.
pub(super) const ROUGH: Limits = Limits { relative_gain: 3e-3, max_iterations: 16, sure: false };

/// To compare models: what could still be gained is far below the noise.
pub(super) fn comparing(samples: usize) -> Limits {
    Limits { relative_gain: 1e-2 / samples.max(1) as f64, max_iterations: 100, sure: true }
}

/// As far as the data reach: one standard error of a parameter changes the sum of squares of
/// `n` samples by its part `1/n`, a hundredth of one by `1e-4/n`.
pub(super) fn whole(samples: usize) -> Limits {
    Limits { relative_gain: 1e-4 / samples.max(1) as f64, max_iterations: 400, sure: true }
}

impl<'p, 'r> Search<'p, 'r> {
    /// From `start`, all values of the model, which are moved into their bounds.
    pub(super) fn new(
        record: &'p FitRecord<'r>,
        model: &'p JointModel,
        space: &'p Space,
        start: Vec<f64>,
    ) -> Self {
        let free = space.within(&start);
        let problem = Problem { record, model, space, start, free, here: OnceCell::new() };
        let (cost, termination) = (f64::INFINITY, Termination::NothingToFit);
        Self { problem, cost, termination, slopes: None }
    }

    /// Knows the slopes of the residuals here, where there are any.
    pub(super) fn knowing(self, slopes: Option<DMatrix<f64>>) -> Self {
        Self { slopes, ..self }
    }

    /// Goes on from here on another cut of the record.
    pub(super) fn onto(mut self, record: &'p FitRecord<'r>) -> Self {
        if self.problem.record.windows() != record.windows() {
            self.slopes = None;
            self.problem.here.take();
        }
        self.problem.record = record;
        self
    }

    /// Goes on from here, as far down as `limits` say.
    pub(super) fn descended(mut self, limits: Limits) -> Self {
        let known = self.slopes.take();
        let Ended { cost, termination, slopes } = descend(&mut self.problem, limits, known);
        Self { cost, termination, slopes, ..self }
    }

    /// Moves the parameters with which an effect jumps to their best in the windows of `whole`, fitted or
    /// not: the part that is fitted may have none of the levels at which it jumps.
    pub(super) fn across_flats_of(self, whole: &'p FitRecord<'r>) -> Self {
        let own = self.problem.record;
        let mut crossed = self.onto(whole).across_flats().onto(own);
        crossed.cost = crossed.problem.cost();
        crossed
    }

    /// Moves the parameters with which an effect jumps to their best.
    fn across_flats(mut self) -> Self {
        /// One may have to wait for another.
        const PASSES: usize = 3;
        for _ in 0..PASSES {
            let flats = self.jumping_variables();
            let crossed = flats.iter().filter(|index| self.problem.cross_flat(**index)).count();
            if crossed == 0 && !self.problem.cross_two_flats(&flats) {
                break;
            }
            self.slopes = None;
            self = self.descended(ROUGH);
        }
        self
    }

    /// The variables with which an effect jumps; of thresholds, those on which nothing else depends.
    fn jumping_variables(&self) -> Vec<usize> {
        let space = self.problem.space;
        let all =
            (0..self.problem.free.len()).filter(|index| !space.between_jumps(*index).is_empty());
        let (sloped, levels): (Vec<_>, Vec<_>) = all.partition(|index| space.is_sloped(*index));
        let residuals = self.problem.residuals();
        let mut slopes = DMatrix::zeros(residuals.len(), self.problem.free.len());
        self.problem.put_slopes(&mut slopes, &levels, &residuals);
        let flat = levels.into_iter().filter(|index| slopes.column(*index).amax() <= 0.0);
        flat.chain(sloped).collect()
    }
}

/// Whether a record has samples enough for the free parameters, and outputs that these can reach.
pub(super) fn check_record(record: &FitRecord<'_>, space: &Space) -> Result<(), FitError> {
    let mut outputs = record.joint().trials.iter().flat_map(Trial::output);
    if outputs.any(|output| output.abs() > UNLIMITED) {
        return Err(FitError::BeyondParameters);
    }
    let samples = record.training_samples();
    let parameters = space.free.len();
    if samples <= parameters + record.part(Part::Training).count() {
        return Err(FitError::TooFewSamples { samples, parameters });
    }
    Ok(())
}

/// The values of all parameters of a model.
pub(super) fn plain(model: &JointModel) -> Vec<f64> {
    model.values().iter().map(|value| value.value).collect()
}
