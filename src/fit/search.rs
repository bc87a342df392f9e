//! Descents from one start value.

use std::cell::OnceCell;

use levenberg_marquardt::{LeastSquaresProblem as _, LevenbergMarquardt};
use nalgebra::{DVector, DVectorView};

use super::problem::Problem;
use super::record::FitRecord;
use super::result::Termination;
use super::space::Space;
use crate::model::JointModel;

/// A descent from one start.
pub(super) struct Search<'p, 'r> {
    pub(super) problem: Problem<'p, 'r>,
    /// The robust sum of squared errors where it stopped; infinite before it set out.
    pub(super) cost: f64,
    pub(super) termination: Termination,
}

/// How far a descent goes.
#[derive(Clone, Copy)]
pub(super) struct Depth {
    /// It stops when a step makes the sum of squares less by a smaller part than this.
    relative_gain: f64,
    /// Evaluations per variable.
    patience: usize,
    /// How often weights are set anew, at most.
    rounds: usize,
}

/// Reweighting has converged when it changes the robust error by a smaller part than this.
const CONVERGED: f64 = 1e-6;

impl Depth {
    /// To see which of many starts to follow.
    pub(super) const SCREEN: Self = Self { relative_gain: 3e-2, patience: 1, rounds: 1 };

    /// To see which of several starts leads down.
    pub(super) const ROUGH: Self = Self { relative_gain: 3e-3, patience: 4, rounds: 1 };

    /// To compare models: what could still be gained is far below the noise.
    pub(super) fn comparing(samples: usize) -> Self {
        Self { relative_gain: 1e-2 / samples.max(1) as f64, patience: 12, rounds: 4 }
    }

    /// As far as the data reach: one standard error of a parameter changes the sum of
    /// squares of `n` samples by its part `1/n`, a hundredth of one by `1e-4/n`.
    pub(super) fn whole(samples: usize) -> Self {
        Self { relative_gain: 1e-4 / samples.max(1) as f64, patience: 40, rounds: 20 }
    }
}

impl<'p, 'r> Search<'p, 'r> {
    pub(super) fn new(
        record: &'p FitRecord<'r>,
        model: &'p JointModel,
        space: &'p Space,
        start: Vec<f64>,
    ) -> Self {
        let free = space.free.iter().zip(&space.bounds);
        let variables = free.map(|(index, bounds)| bounds.free(start[*index]));
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
        };
        Self { problem, cost: f64::INFINITY, termination: Termination::NothingToFit }
    }

    /// Goes on from here on another cut of the record.
    pub(super) fn onto(mut self, record: &'p FitRecord<'r>) -> Self {
        self.problem.record = record;
        self.problem.weights = None;
        self.problem.here.take();
        self
    }

    /// Goes on from here, as far down as `depth` says.
    pub(super) fn descended(mut self, depth: Depth) -> Self {
        let gain = depth.relative_gain;
        let optimiser = LevenbergMarquardt::new().with_ftol(gain).with_xtol(1e-9).with_gtol(1e-12);
        if self.problem.variables.is_empty() {
            self.cost = self.problem.cost();
            return self;
        }
        self.problem.moves = true;
        for round in 1..=depth.rounds {
            let (moved, report) = optimiser.with_patience(depth.patience).minimize(self.problem);
            self.problem = moved;
            self.termination = Termination::of(&report.termination);
            let before = std::mem::replace(&mut self.cost, self.problem.cost());
            let converged = (before - self.cost).abs() <= CONVERGED * self.cost;
            if converged || round == depth.rounds || !self.problem.reweigh() {
                break;
            }
        }
        self
    }

    /// Moves the parameters on which the error depends only in jumps to their best.
    pub(super) fn across_flats(mut self) -> Self {
        /// One may have to wait for another.
        const PASSES: usize = 3;
        for _ in 0..PASSES {
            let flats = self.flat_variables();
            let crossed = flats.iter().filter(|index| self.problem.cross_flat(**index)).count();
            if crossed == 0 && !self.problem.cross_two_flats(&flats) {
                break;
            }
            self = self.descended(Depth::ROUGH);
        }
        self
    }

    /// The variables on which the error depends only in jumps.
    fn flat_variables(&self) -> Vec<usize> {
        let Some(jacobian) = self.problem.jacobian() else { return Vec::new() };
        let is_flat = |(_, column): &(usize, DVectorView<'_, f64>)| column.amax() <= 0.0;
        jacobian.column_iter().enumerate().filter(is_flat).map(|(index, _)| index).collect()
    }
}
