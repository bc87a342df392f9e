//! The regression of a window, linearised in its onsets and in the lag's parameters.

use super::information::Information;
use super::model::MAX_PARAMETERS;
use super::motion::LINE;
use crate::numerics::NormalEquations;

/// A window regressed at its onsets.
#[derive(Clone, Debug)]
pub(crate) struct Linearised {
    /// Squared error.
    pub(crate) sse: f64,
    /// Coefficients of line, modes and reactions.
    pub(crate) parts: Vec<f64>,
    equations: NormalEquations,
    /// Before any column was eliminated.
    pub(super) whole: NormalEquations,
    modes: usize,
    reactions: usize,
}

impl Linearised {
    /// The regression with so many columns of `modes` and of `reactions`, followed by those of
    /// the onsets' moves and, if any, of the lag's parameters.
    pub(super) fn of(mut equations: NormalEquations, modes: usize, reactions: usize) -> Self {
        let linear = LINE + modes + reactions;
        let whole = equations.clone();
        // Line, modes and reactions: the linear parameters, whose residual is projected out.
        (0..linear).for_each(|column| equations.eliminate(column));
        let sse = equations.error();
        let parts = equations.coefficients(linear, &[]);
        // Moves of the onsets: what remains behind them belongs to the lag.
        (linear..linear + reactions).for_each(|column| equations.eliminate(column));
        Self { sse, parts, equations, whole, modes, reactions }
    }

    /// The part of the squared error that the last reaction explains, when the others may
    /// move in its stead.
    pub(crate) fn share(&self) -> f64 {
        let linear = self.first_reaction() + self.reactions;
        let last = linear - 1;
        let others = (0..last).chain(linear..linear + self.reactions - 1);
        let order: Vec<usize> = others.chain([last, self.whole.size() - 1]).collect();
        // The last reaction behind all others and their moves: what it explains then is its own.
        let mut equations = self.whole.reordered(&order);
        let count = order.len() - 2;
        (0..count).for_each(|column| equations.eliminate(column));
        let without = equations.error();
        equations.eliminate(count);
        1.0 - equations.error() / without.max(f64::MIN_POSITIVE)
    }

    fn first_reaction(&self) -> usize {
        LINE + self.modes
    }

    /// Column of the last reaction's move.
    fn last_move(&self) -> usize {
        self.first_reaction() + 2 * self.reactions - 1
    }

    /// The change of speed at the last reaction, output units per sample.
    pub(crate) fn change(&self) -> f64 {
        self.parts[self.parts.len() - 1]
    }

    /// Gauss and Newton's steps of the onsets, given that of the model; no longer than
    /// what a straight continuation is good for.
    pub(crate) fn moves(&self, lag_change: &[f64; MAX_PARAMETERS]) -> Vec<f64> {
        /// Samples, beyond which the linearisation is no guide; chosen.
        const LONGEST: f64 = 8.0;
        let locals = self.first_reaction() + 2 * self.reactions;
        let given: Vec<_> = (0..self.order()).map(|i| (locals + i, lag_change[i])).collect();
        let found = self.equations.coefficients(locals, &given);
        let (changes, moves) = found[self.first_reaction()..].split_at(self.reactions);
        // The coefficient of a move's column is c_j·Δτ_j.
        let step = |(change, by): (&f64, &f64)| {
            let step = by / change;
            if step.is_finite() { step.clamp(-LONGEST, LONGEST) } else { 0.0 }
        };
        changes.iter().zip(moves).map(step).collect()
    }

    /// Columns of the lag's parameters.
    fn order(&self) -> usize {
        self.equations.size().saturating_sub(self.last_move() + 2)
    }

    /// Variance of the last onset, as a part of the noise's, with the model as it is.
    pub(crate) fn onset_variance(&self) -> f64 {
        let column = self.last_move();
        let change = self.change();
        if !self.equations.stands_alone(column) {
            return f64::INFINITY;
        }
        // σ²(τ) = σ²/(|∂y/∂τ|² c²), the column beside all linear ones being ∂y/∂τ per unit of c.
        1.0 / (self.equations.at(column, column) * change * change)
    }

    /// How far the last onset moves with each parameter of the model.
    pub(crate) fn onset_slopes(&self) -> [f64; MAX_PARAMETERS] {
        let column = self.last_move();
        let pivot = self.equations.at(column, column) * self.change();
        let mut slopes = [0.0; MAX_PARAMETERS];
        for (index, slope) in slopes[..self.order()].iter_mut().enumerate() {
            // ∂τ/∂θ of the least error: −(g_τ·g_θ)/(g_τ·g_τ).
            *slope = -self.equations.at(column, column + 1 + index) / pivot;
        }
        slopes
    }

    /// Adds what this window says about the lag: the products of its parameters' columns with
    /// each other and with the output, all else eliminated.
    pub(super) fn inform(&self, information: &mut Information) {
        let (first, order) = (self.last_move() + 1, self.order());
        for i in 0..order {
            for j in 0..order {
                let product = self.equations.at(first + i.min(j), first + i.max(j));
                information.products[i][j] += product;
            }
            information.with[i] += self.equations.at(first + i, first + order);
        }
    }

    /// Parameters that were solved for.
    pub(crate) fn parameters(&self) -> usize {
        self.first_reaction() + 2 * self.reactions
    }
}
