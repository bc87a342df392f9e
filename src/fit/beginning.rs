//! Which of several starts of an effect are followed, and with what slopes.
//!
//! A start moves the effect's own parameters only; the others are where the model has them. With
//! the residual `r` there, the slopes `J` to the other parameters, and `d` the change of the
//! residual on the way to the start, both less their projection on `J`, what a fit would leave is
//! to first order
//!
//! ```text
//! |r|² − max(0, −r·d)² / d·d
//! ```
//!
//! as in the [score](super::score): one simulation for each start, where a descent takes many.
//! From the start a descent begins with the same `J`, and only the effect's own slopes anew.

use nalgebra::{DMatrix, DVector};

use super::problem::cost_of;
use super::record::FitRecord;
use super::search::Search;
use super::space::Space;
use crate::model::{BESIDE, JointModel};
use crate::numerics::{Basis, rank};

/// Where all starts of a model begin: its values as they are.
pub(super) struct Beginning<'p, 'r> {
    search: Search<'p, 'r>,
    residuals: DVector<f64>,
    /// Whether starts move a free value.
    own: Vec<bool>,
    /// Slopes to the others; 0 for those that starts move.
    slopes: DMatrix<f64>,
}

/// What the other parameters explain.
struct Rest {
    others: Basis,
    /// The residual without what they explain.
    residual: DVector<f64>,
}

impl<'p, 'r> Beginning<'p, 'r> {
    pub(super) fn of(
        record: &'p FitRecord<'r>,
        model: &'p JointModel,
        space: &'p Space,
        (given, starts): (Vec<f64>, &[Vec<f64>]),
    ) -> Self {
        let search = Search::new(record, model, space, given.clone());
        let residuals = search.problem.residuals();
        #[expect(clippy::float_cmp, reason = "a start has its own value or that of the model")]
        let moves = |index: &usize| starts.iter().any(|start| start[*index] != given[*index]);
        let own: Vec<bool> = space.free.iter().map(moves).collect();
        let mut slopes = DMatrix::zeros(residuals.len(), own.len());
        let given: Vec<usize> = (0..own.len()).filter(|index| !own[*index]).collect();
        search.problem.put_slopes(&mut slopes, &given, &residuals);
        Self { search, residuals, own, slopes }
    }

    /// The sum of squares without a start.
    pub(super) fn cost(&self) -> f64 {
        cost_of(&self.residuals)
    }

    /// So many of `starts` at most: those from which fits would leave least.
    pub(super) fn most_promising(&self, starts: Vec<Vec<f64>>, most: usize) -> Vec<Vec<f64>> {
        if starts.len() <= most {
            return starts;
        }
        let mut ranked: Vec<_> = self.expected(&starts).into_iter().zip(starts).collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        ranked.into_iter().take(most).map(|(_, start)| start).collect()
    }

    /// The sums of squares that fits from `starts` would leave, to first order.
    fn expected(&self, starts: &[Vec<f64>]) -> Vec<f64> {
        let problem = &self.search.problem;
        let model = |start: &Vec<f64>| {
            let there = problem.space.within(start);
            // What starts move and no fit does is in the start alone.
            problem.model.with_values(&problem.space.values(start, &there))
        };
        let others = Basis::of(self.slopes.as_slice(), self.slopes.nrows(), rank::DIFFERENCED);
        let residual = DVector::from_vec(others.residual(self.residuals.as_slice()));
        let rest = Rest { others, residual };
        let left = |some: &[Vec<f64>]| -> Vec<f64> {
            let models: Vec<JointModel> = some.iter().map(model).collect();
            let found = problem.record.training_near(&models, problem.here());
            found.into_iter().map(|residuals| rest.left(&(residuals - &self.residuals))).collect()
        };
        // Of many starts all at once would take more than a fit.
        starts.chunks(BESIDE).flat_map(left).collect()
    }

    /// The search from `start`, which knows the slopes about there.
    pub(super) fn search(&self, start: Vec<f64>) -> Search<'p, 'r> {
        let problem = &self.search.problem;
        let search = Search::new(problem.record, problem.model, problem.space, start);
        let residuals = search.problem.residuals();
        let mut slopes = self.slopes.clone();
        let own: Vec<usize> = (0..self.own.len()).filter(|index| self.own[*index]).collect();
        for index in &own {
            slopes.column_mut(*index).fill(0.0);
        }
        search.problem.put_slopes(&mut slopes, &own, &residuals);
        search.knowing(Some(slopes))
    }
}

impl Rest {
    /// The sum of squares that is left where a start makes `change` of the residuals.
    fn left(&self, change: &DVector<f64>) -> f64 {
        let change = DVector::from_vec(self.others.residual(change.as_slice()));
        let (forwards, square) = (-self.residual.dot(&change), change.norm_squared());
        let gain = if square > 0.0 { forwards.max(0.0).powi(2) / square } else { 0.0 };
        let expected = self.residual.norm_squared() - gain;
        if expected.is_finite() { expected } else { f64::INFINITY }
    }
}
