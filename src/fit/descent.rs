//! Least squares within bounds, by Levenberg and Marquardt's method.
//!
//! With residuals `r` and their slopes `J`, a step `d` solves
//!
//! ```text
//! (JᵀJ + λ diag JᵀJ) d = −Jᵀr
//! ```
//!
//! for the values that are free to move; one at a bound beyond which the error falls stays, and
//! one that a step would take beyond its bound goes to it, while the others are solved for
//! anew. `λ` follows from how much of the predicted gain a step makes (Nielsen). Simulations are
//! expensive and `J` takes one for each value, so from step to step `J` is updated (Broyden), and
//! differenced again only where a step gains less than predicted, or before a descent ends.
//!
//! It has converged when the part of the sum of squares that a linear step could still take,
//! `gᵀ(JᵀJ)⁻¹g / rᵀr` with `g = Jᵀr` of the values that can move, is below a limit: the gradient,
//! each value in units of its own standard error.
//!
//! # References
//! D. W. Marquardt, "An algorithm for least-squares estimation of nonlinear parameters", Journal
//! of the Society for Industrial and Applied Mathematics 11 (1963), 431-441. H. B. Nielsen,
//! "Damping parameter in Marquardt's method", IMM-REP-1999-05, Technical University of Denmark.
//! C. G. Broyden, "A class of methods for solving nonlinear simultaneous equations", Mathematics
//! of Computation 19 (1965), 577-593.

use std::rc::Rc;

use nalgebra::{DMatrix, DVector};

use super::bounds::Bounds;
use super::problem::{Problem, cost_of};
use super::result::Termination;
use super::turn;
use crate::numerics::column_products;

/// How far a descent goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// It has converged when a linear step would make the sum of squares less by a smaller part.
    pub(super) relative_gain: f64,
    /// Steps that are tried.
    pub(super) max_iterations: usize,
    /// Whether slopes are differenced anew before a descent has converged; where it is only to
    /// be seen where one leads, those that were mended will do.
    pub(super) sure: bool,
}

/// Where a descent ended.
pub(super) struct Ended {
    pub(super) cost: f64,
    pub(super) termination: Termination,
    /// The slopes of the residuals there, where they were differenced last.
    pub(super) slopes: Option<DMatrix<f64>>,
}

/// Damping of the first step, in parts of the diagonal.
const FIRST_DAMPING: f64 = 1e-3;

/// Damping beyond which a step is none.
const MOST_DAMPING: f64 = 1e10;

/// Damping that only keeps from following combinations of columns that differences with steps of
/// 1e-6 cannot tell from none.
const LEAST_DAMPING: f64 = 1e-8;

/// The part of the predicted gain below which slopes that were mended are differenced anew.
const DISAPPOINTING: f64 = 0.25;

/// Steps that together must gain what one alone should at the end of a descent. Chosen: as many as
/// there are parameters in a large model, since slopes are mended by one direction a step.
const CREEPING: usize = 10;

/// Descends from where `problem` is; it is never left at a larger sum of squares. `slopes` are
/// about those of the residuals, where they are known.
pub(super) fn descend(
    problem: &mut Problem<'_, '_>,
    limits: Limits,
    slopes: Option<DMatrix<f64>>,
) -> Ended {
    let start = (problem.cost(), problem.free.clone());
    if problem.free.is_empty() {
        return Ended { cost: start.0, termination: Termination::NothingToFit, slopes: None };
    }
    let (termination, slopes) = Descent::new(problem, slopes).run(limits);
    let cost = problem.cost();
    if cost <= start.0 {
        return Ended { cost, termination, slopes };
    }
    problem.move_to(&start.1);
    Ended { cost: start.0, termination, slopes: None }
}

/// The state of a descent.
struct Descent<'d, 'p, 'r> {
    problem: &'d mut Problem<'p, 'r>,
    at: DVector<f64>,
    residuals: Rc<DVector<f64>>,
    slopes: Rc<DMatrix<f64>>,
    normal: Normal,
    /// Whether `slopes` are differenced at `at`.
    fresh: bool,
    /// The last place whose sum of squares is sure.
    anchor: Anchor,
    damping: f64,
    growth: f64,
    /// The sums of squares before each step since a start that was sure.
    costs: Vec<f64>,
}

/// A place at which windows started from the outputs that are best there. Those of the steps that
/// follow are kept, and where the error does not change smoothly with them, as at an end stop,
/// steps that seemed to gain may have lost.
struct Anchor {
    at: DVector<f64>,
    residuals: Rc<DVector<f64>>,
    /// The slopes there, where they are known.
    slopes: Option<Rc<DMatrix<f64>>>,
    cost: f64,
    damping: f64,
    growth: f64,
}

/// `slopes`, to go back to; of a very long record they are differenced again in that case.
fn kept(slopes: &Rc<DMatrix<f64>>) -> Option<Rc<DMatrix<f64>>> {
    (!turn::is_large(slopes.len())).then(|| Rc::clone(slopes))
}

impl<'d, 'p, 'r> Descent<'d, 'p, 'r> {
    fn new(problem: &'d mut Problem<'p, 'r>, slopes: Option<DMatrix<f64>>) -> Self {
        let (at, residuals) = (problem.free.clone(), Rc::new(problem.residuals()));
        let fresh = slopes.is_none();
        let slopes = Rc::new(slopes.unwrap_or_else(|| problem.jacobian(&residuals)));
        let normal = Normal::of(&slopes, &residuals);
        let (damping, growth) = (FIRST_DAMPING, 2.0);
        let anchor = Anchor {
            at: at.clone(),
            residuals: Rc::clone(&residuals),
            slopes: if fresh { kept(&slopes) } else { None },
            cost: normal.cost,
            damping,
            growth,
        };
        let costs = Vec::new();
        Self { problem, at, residuals, slopes, normal, fresh, anchor, damping, growth, costs }
    }

    fn run(mut self, limits: Limits) -> (Termination, Option<DMatrix<f64>>) {
        for _ in 0..limits.max_iterations {
            if !self.is_finite() {
                return self.ended(Termination::Numerical);
            }
            if self.has_converged(limits.relative_gain) {
                if self.fresh || !limits.sure {
                    return self.ended(Termination::Converged);
                }
                self.refresh();
                continue;
            }
            if self.damping > MOST_DAMPING || limits.sure && self.creeps(limits.relative_gain) {
                return self.ended(Termination::NoDescent);
            }
            self.costs.push(self.normal.cost);
            self.try_step();
        }
        self.ended(Termination::OutOfPatience)
    }

    fn ended(mut self, termination: Termination) -> (Termination, Option<DMatrix<f64>>) {
        if self.problem.free != self.at {
            self.problem.move_to(&self.at);
            if self.problem.cost() > self.anchor.cost {
                self.problem.move_to(&self.anchor.at);
                return (termination, self.anchor.slopes.take().map(Rc::unwrap_or_clone));
            }
        }
        // That of the anchor may be the same.
        drop(self.anchor);
        (termination, self.fresh.then(|| Rc::unwrap_or_clone(self.slopes)))
    }

    fn is_finite(&self) -> bool {
        self.normal.gradient.iter().all(|value| value.is_finite())
    }

    fn has_converged(&self, relative_gain: f64) -> bool {
        let bounds = &self.problem.space.bounds;
        let (_, gain) = self.normal.step(&self.at, bounds, LEAST_DAMPING);
        gain <= relative_gain * self.normal.cost
    }

    /// Whether the last steps together made the sum of squares less by no more than one of them
    /// alone should.
    fn creeps(&self, relative_gain: f64) -> bool {
        let before = self.costs.len().checked_sub(CREEPING).map(|index| self.costs[index]);
        before.is_some_and(|before| before - self.normal.cost < relative_gain * self.normal.cost)
    }

    /// The slopes anew, of windows that start where they are best now; back to the last such
    /// place, to leave it by a shorter step, where the steps since have gained nothing.
    fn refresh(&mut self) {
        self.problem.move_to(&self.at);
        self.residuals = Rc::new(self.problem.residuals());
        if cost_of(&self.residuals) > self.anchor.cost {
            return self.back();
        }
        // The old ones go before there are new ones: they are most of the memory of a fit.
        self.anchor.residuals = Rc::clone(&self.residuals);
        (self.anchor.slopes, self.slopes) = (None, Rc::new(DMatrix::zeros(0, 0)));
        self.slopes = Rc::new(self.problem.jacobian(&self.residuals));
        self.set_anchor();
    }

    fn back(&mut self) {
        let anchor = &mut self.anchor;
        anchor.damping *= anchor.growth;
        anchor.growth *= 2.0;
        (self.damping, self.growth) = (anchor.damping, anchor.growth);
        self.at.copy_from(&anchor.at);
        self.residuals = Rc::clone(&anchor.residuals);
        self.problem.move_to(&self.at);
        match &anchor.slopes {
            Some(slopes) => self.slopes = Rc::clone(slopes),
            None => self.slopes = Rc::new(self.problem.jacobian(&self.residuals)),
        }
        self.normal = Normal::of(&self.slopes, &self.residuals);
        self.fresh = true;
        self.costs.clear();
    }

    /// Takes this place, whose slopes are new, for the one to go back to.
    fn set_anchor(&mut self) {
        self.normal = Normal::of(&self.slopes, &self.residuals);
        self.fresh = true;
        self.anchor = Anchor {
            at: self.at.clone(),
            residuals: Rc::clone(&self.residuals),
            slopes: kept(&self.slopes),
            cost: self.normal.cost,
            damping: self.damping,
            growth: self.growth,
        };
    }

    fn try_step(&mut self) {
        let (step, predicted) =
            self.normal.step(&self.at, &self.problem.space.bounds, self.damping);
        // Rounding may have put what goes to its bound a little beyond.
        let mut there = &self.at + &step;
        let bounds = self.problem.space.bounds.iter();
        there.iter_mut().zip(bounds).for_each(|(value, bounds)| *value = bounds.clamped(*value));
        let residuals = self.problem.residuals_near(&there);
        let part = (self.normal.cost - cost_of(&residuals)) / predicted.max(f64::MIN_POSITIVE);
        if part <= 0.0 {
            return self.step_failed();
        }
        let change = &residuals - &*self.residuals;
        mend(Rc::make_mut(&mut self.slopes), &step, &change, &self.normal.scales);
        (self.at, self.residuals, self.fresh) = (there, Rc::new(residuals), false);
        self.damping *= (1.0 - (2.0 * part - 1.0).powi(3)).clamp(1.0 / 10.0, 2.0);
        self.damping = self.damping.max(LEAST_DAMPING);
        self.growth = 2.0;
        if part < DISAPPOINTING {
            self.refresh();
        } else {
            self.normal = Normal::of(&self.slopes, &self.residuals);
        }
    }

    fn step_failed(&mut self) {
        if self.fresh {
            self.damping *= self.growth;
            self.growth *= 2.0;
        } else {
            self.refresh();
        }
    }
}

/// Broyden's update of `slopes`, which `step` has shown to change the residuals by `change`:
/// the least one, steps being measured in `scales`.
fn mend(
    slopes: &mut DMatrix<f64>,
    step: &DVector<f64>,
    change: &DVector<f64>,
    scales: &DVector<f64>,
) {
    let weighted = step.component_mul(scales).component_mul(scales);
    let square = weighted.dot(step);
    if square > 0.0 {
        let missed = change - &*slopes * step;
        slopes.ger(1.0 / square, &missed, &weighted, 1.0);
    }
}

/// The normal equations, columns scaled to length one.
struct Normal {
    cost: f64,
    /// Lengths of the columns.
    scales: DVector<f64>,
    products: DMatrix<f64>,
    /// `Jᵀr`, scaled like the columns.
    gradient: DVector<f64>,
}

impl Normal {
    fn of(slopes: &DMatrix<f64>, residuals: &DVector<f64>) -> Self {
        let mut products = column_products(slopes);
        let scales = products.diagonal().map(f64::sqrt);
        let inverse = scales.map(|scale| if scale > 0.0 { scale.recip() } else { 0.0 });
        for (index, mut column) in products.column_iter_mut().enumerate() {
            column.component_mul_assign(&inverse);
            column *= inverse[index];
        }
        let gradient = slopes.tr_mul(residuals).component_mul(&inverse);
        Self { cost: cost_of(residuals), scales, products, gradient }
    }

    /// The step from `at` within `bounds`, and how much less the sum of squares is after it if
    /// residuals are linear.
    fn step(&self, at: &DVector<f64>, bounds: &[Bounds], damping: f64) -> (DVector<f64>, f64) {
        let size = at.len();
        let mut step = DVector::zeros(size);
        let downhill = |index: usize| -self.gradient[index];
        let is_free = |index: &usize| {
            self.scales[*index] > 0.0 && !bounds[*index].stop(at[*index], downhill(*index))
        };
        let mut free: Vec<usize> = (0..size).filter(is_free).collect();
        while !free.is_empty() {
            let Some(solved) = self.solved(&free, &step, damping) else { break };
            let there = |(k, index): (usize, &usize)| {
                let goal = at[*index] + solved[k] / self.scales[*index];
                (*index, goal, bounds[*index].clamped(goal))
            };
            let goals: Vec<_> = free.iter().enumerate().map(there).collect();
            let beyond = goals.iter().filter(|(_, goal, bound)| goal.total_cmp(bound).is_ne());
            let beyond: Vec<_> = beyond.map(|(index, _, bound)| (*index, *bound)).collect();
            if beyond.is_empty() {
                free.iter().enumerate().for_each(|(k, index)| step[*index] = solved[k]);
                break;
            }
            for (index, bound) in &beyond {
                step[*index] = (bound - at[*index]) * self.scales[*index];
            }
            free.retain(|index| beyond.iter().all(|(bound, _)| bound != index));
        }
        let gain = -(2.0 * self.gradient.dot(&step) + step.dot(&(&self.products * &step)));
        let inverse = |index| if self.scales[index] > 0.0 { 1.0 / self.scales[index] } else { 0.0 };
        (DVector::from_fn(size, |index, _| step[index] * inverse(index)), gain)
    }

    /// The damped solution for the columns `free`, those of the others being as in `step`.
    fn solved(&self, free: &[usize], step: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
        let left = DMatrix::from_fn(free.len(), free.len(), |row, column| {
            let product = self.products[(free[row], free[column])];
            if row == column { product + damping } else { product }
        });
        let moved = &self.products * step;
        let right =
            DVector::from_fn(free.len(), |row, _| -self.gradient[free[row]] - moved[free[row]]);
        Some(left.cholesky()?.solve(&right))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `r = A x − b` at `at`.
    fn linear(at: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
        let slopes = DMatrix::from_row_slice(3, 2, &[1.0, 2.0, 0.0, 300.0, 1.0, -100.0]);
        let residuals = &slopes * at - DVector::from_vec(vec![5.0, 600.0, -199.0]);
        (slopes, residuals)
    }

    const FREE: Bounds = Bounds { low: f64::MIN, high: f64::MAX };

    #[test]
    fn without_bounds_a_linear_problem_takes_one_step() {
        let at = DVector::from_vec(vec![7.0, -3.0]);
        let (slopes, residuals) = linear(&at);
        let (step, gain) = Normal::of(&slopes, &residuals).step(&at, &[FREE, FREE], 0.0);
        assert!((at + step - DVector::from_vec(vec![1.0, 2.0])).norm() < 1e-9);
        assert!((gain / residuals.norm_squared() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_value_that_would_leave_goes_to_its_bound_and_the_others_are_solved_for_there() {
        let at = DVector::from_vec(vec![7.0, -3.0]);
        let (slopes, residuals) = linear(&at);
        let low = [FREE, Bounds { low: -9.0, high: 1.5 }];
        let (step, _) = Normal::of(&slopes, &residuals).step(&at, &low, 0.0);
        let there = at + step;
        assert!((there[1] - 1.5).abs() < 1e-12);
        // With y = 1.5: x − 2 and x − 150 + 199 = x + 49, so x = −23.5.
        assert!((there[0] + 23.5).abs() < 1e-9, "{there}");
        let (_, residuals) = linear(&there);
        let (_, gain) = Normal::of(&slopes, &residuals).step(&there, &low, 0.0);
        assert!(gain.abs() < 1e-6);
    }

    #[test]
    fn mended_slopes_predict_the_step_that_mended_them() {
        let (mut slopes, _) = linear(&DVector::zeros(2));
        let step = DVector::from_vec(vec![0.3, -0.1]);
        let change = DVector::from_vec(vec![1.0, 2.0, 3.0]);
        mend(&mut slopes, &step, &change, &DVector::from_vec(vec![1.0, 50.0]));
        assert!((slopes * step - change).norm() < 1e-9);
    }
}
