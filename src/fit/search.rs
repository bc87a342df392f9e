//! Descents from one start value.

use std::cell::{Cell, OnceCell};

use levenberg_marquardt::{LeastSquaresProblem as _, LevenbergMarquardt};
use nalgebra::{DVector, DVectorView};

use super::least_squares::Termination;
use super::problem::Problem;
use super::record::FitRecord;
use super::space::Space;
use crate::model::JointModel;

/// A descent from one start.
pub(super) struct Search<'p, 'r> {
    pub(super) problem: Problem<'p, 'r>,
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

/// Weights are settled when they change the robust error by a smaller part than this.
const SETTLED: f64 = 1e-6;

impl Depth {
    /// To see which of many starts to follow.
    pub(super) const GLANCE: Self = Self { relative_gain: 3e-2, patience: 1, rounds: 1 };

    /// To see which of several starts leads down.
    pub(super) const ROUGH: Self = Self { relative_gain: 3e-3, patience: 4, rounds: 1 };

    /// To compare models: what is left to gain is far below the noise.
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
    pub(super) fn onto(mut self, record: &'p FitRecord<'r>) -> Self {
        self.problem.record = record;
        self.problem.weights = None;
        self.problem.here.take();
        self
    }

    /// The same further down.
    pub(super) fn descended(mut self, depth: Depth) -> Self {
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
    pub(super) fn across_flats(mut self) -> Self {
        /// One may have to wait for another.
        const PASSES: usize = 3;
        for _ in 0..PASSES {
            let places = self.flat_places();
            let crossed = places.iter().filter(|place| self.problem.cross_flat(**place)).count();
            if crossed == 0 && !self.problem.cross_two_flats(&places) {
                break;
            }
            self = self.descended(Depth::ROUGH);
        }
        self
    }

    /// The variables on which nothing depends but in jumps.
    fn flat_places(&self) -> Vec<usize> {
        let Some(jacobian) = self.problem.jacobian() else { return Vec::new() };
        let is_flat = |(_, column): &(usize, DVectorView<'_, f64>)| column.amax() <= 0.0;
        jacobian.column_iter().enumerate().filter(is_flat).map(|(place, _)| place).collect()
    }

    pub(super) fn simulations(&self) -> usize {
        self.problem.evaluations.get()
    }
}
