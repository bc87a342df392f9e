//! A window of output in which a joint reacts behind a lag: one linear regression, and
//! what becomes of it when reactions and lag move a little.
//!
//! ```text
//! y_k = A + v·k + Σ b_m·mode_m(k) + Σ c_j·G(k − τ_j)
//! ```
//!
//! `A`, `v`, the modes that earlier steps left, and the changes of speed `c_j` are linear,
//! so they are solved for and never searched. Moving `τ_j` adds `c_j·∂G/∂τ_j` to the
//! output, a change of the lag's parameters `Σ c_j·∂G/∂θ + Σ b_m·∂mode_m/∂θ`: further columns,
//! whose coefficients are Gauss and Newton's steps.
//!
//! # References
//! G. H. Golub and V. Pereyra, "The differentiation of pseudo-inverses and nonlinear least
//! squares problems whose variables separate", SIAM J. Numer. Anal. 10 (1973), whose variable
//! projection this is, with Kaufman's simpler Jacobian.

use std::f64::consts::FRAC_1_SQRT_2;

use super::basis::Basis;
use super::linearised::Linearised;
use super::model::{LagModel, MAX_PARAMETERS};
use super::motion::{LINE, Motion, inner_product};
use super::response::Response;
use crate::numerics::{NoiseModel, NormalEquations, Projection};
use crate::units::ceil_to_index;

/// Samples: after a step as small as this the next one does not matter, since each is about
/// the square of the one before.
pub(crate) const FINE: f64 = 0.02;

/// Output of a window, of some samples, and where in it the joint reacts: some onsets as indices
/// of the window, of which the last is the one in question.
#[derive(Clone, Debug)]
pub(crate) struct FitWindow<'a> {
    pub(crate) values: &'a [f64],
    pub(crate) onsets: Vec<f64>,
    /// Samples at its beginning and at its end that a neighbour has too: they count half in
    /// each of the two, so that nothing counts twice.
    pub(crate) shared: (usize, usize),
}

/// A column of the regression since its beginning; 0 before.
struct Column {
    start: usize,
    motion: Motion,
}

impl<'a> FitWindow<'a> {
    /// One that shares nothing.
    pub(crate) fn alone(values: &'a [f64], onsets: Vec<f64>) -> Self {
        Self { values, onsets, shared: (0, 0) }
    }

    /// How many samples it counts for.
    pub(crate) fn weight(&self) -> f64 {
        self.values.len() as f64 - 0.5 * (self.shared.0 + self.shared.1) as f64
    }

    /// The regression with the lag as it is.
    pub(crate) fn at(&self, basis: &Basis, noise: &NoiseModel) -> Linearised {
        if noise.order() > 0 {
            return self.linearised(&basis.model, noise, None);
        }
        let modes = basis.response.modes();
        Linearised::of(self.equations(basis), modes, self.onsets.len())
    }

    /// The products of all columns and the output, piece by piece between their beginnings.
    /// The noise is white.
    fn equations(&self, basis: &Basis) -> NormalEquations {
        let mut columns = self.columns(basis);
        let size = columns.len() + 1;
        let mut products = vec![0.0; size * size];
        let cuts = self.cuts(&columns);
        for ends in cuts.windows(2) {
            let (from, to) = (ends[0], ends[1]);
            let piece = basis.products(&self.values[from..to], self.values[0]);
            let weight = self.weight_at(from);
            // Upper triangle of XᵀX and Xᵀy, over the rows of this piece.
            for (i, column) in columns.iter().enumerate() {
                if column.start > from {
                    continue;
                }
                let row = &mut products[i * size..(i + 1) * size];
                let along = piece.along(&column.motion);
                for (slot, other) in row[i..].iter_mut().zip(&columns[i..]) {
                    let begun = if other.start <= from { weight } else { 0.0 };
                    *slot += begun * inner_product(&along, &other.motion);
                }
                row[size - 1] += weight * piece.with_output(&column.motion);
            }
            products[size * size - 1] += weight * piece.square;
            // Each motion that has begun, from the next piece's first sample on.
            for column in columns.iter_mut().filter(|column| column.start <= from) {
                column.motion = basis.later(&column.motion, to - from);
            }
        }
        NormalEquations::from_products(size, products)
    }

    /// Line, modes, reactions, and the derivatives of the reactions to their onsets.
    fn columns(&self, basis: &Basis) -> Vec<Column> {
        let free = (0..LINE + basis.response.modes()).map(|index| {
            let mut motion = Motion::default();
            motion[index] = 1.0;
            Column { start: 0, motion }
        });
        let reaction = |onset: &f64| {
            let start = ceil_to_index(*onset);
            (start, basis.response.motions(start as f64 - onset))
        };
        let reactions: Vec<_> = self.onsets.iter().map(reaction).collect();
        let step_responses = reactions.iter().map(|(start, (motion, _))| (*start, *motion));
        let moves = reactions.iter().map(|(start, (_, motion))| (*start, *motion));
        let begun = step_responses.chain(moves).map(|(start, motion)| Column { start, motion });
        free.chain(begun).collect()
    }

    /// Where a column begins, or what is shared begins or ends; both ends.
    fn cuts(&self, columns: &[Column]) -> Vec<usize> {
        let end = self.values.len();
        let starts = columns.iter().map(|column| column.start);
        let mut cuts: Vec<usize> =
            starts.chain([0, self.shared.0, self.own_end(), end]).map(|cut| cut.min(end)).collect();
        cuts.sort_unstable();
        cuts.dedup();
        cuts
    }

    /// Behind the last sample before those that are shared at the end.
    fn own_end(&self) -> usize {
        self.values.len().saturating_sub(self.shared.1).max(self.shared.0)
    }

    /// How much a square counts at an index.
    fn weight_at(&self, index: usize) -> f64 {
        if (self.shared.0..self.own_end()).contains(&index) { 1.0 } else { 0.5 }
    }

    /// The regression with columns for changes of the lag as well; `parts` are the
    /// coefficients of a regression nearby.
    pub(crate) fn with_lag_columns(
        &self,
        model: &LagModel,
        noise: &NoiseModel,
        parts: &[f64],
    ) -> Linearised {
        self.linearised(model, noise, Some(parts))
    }

    fn linearised(
        &self,
        model: &LagModel,
        noise: &NoiseModel,
        parts: Option<&[f64]>,
    ) -> Linearised {
        let length = self.values.len();
        let response = Response::of(model);
        let (modes, reactions) = (response.modes(), self.onsets.len());
        // Without coefficients nearby nothing is known of how the output changes with the lag.
        let order = if parts.is_some() { model.order() } else { 0 };
        let size = LINE + modes + 2 * reactions + order + 1;
        let mut columns = vec![0.0; size * length];
        let (linear, rest) = columns.split_at_mut((LINE + modes + reactions) * length);
        let (moves, rest) = rest.split_at_mut(reactions * length);
        let (lag_columns, target) = rest.split_at_mut(order * length);
        self.fill_linear(&response, linear, moves);
        if let Some(parts) = parts {
            for (index, column) in lag_columns.chunks_exact_mut(length).enumerate() {
                self.fill_lag_column(&model.perturbed(index), parts, linear, column);
            }
        }
        for (slot, y) in target.iter_mut().zip(self.values) {
            *slot = y - self.values[0];
        }
        for column in columns.chunks_exact_mut(length) {
            noise.whiten(column);
            self.weigh(column);
        }
        let equations = NormalEquations::of(&columns, length, &self.starts(modes));
        Linearised::of(equations, modes, reactions)
    }

    /// The row at which each column begins, as far as one does: line, modes, reactions, moves.
    fn starts(&self, modes: usize) -> Vec<usize> {
        let onsets = self.onsets.iter().map(|onset| ceil_to_index(*onset));
        std::iter::repeat_n(0, LINE + modes).chain(onsets.clone()).chain(onsets).collect()
    }

    /// Makes what is shared count half in a sum of squares.
    fn weigh(&self, column: &mut [f64]) {
        let end = column.len();
        for shared in [0..self.shared.0.min(end), self.own_end().min(end)..end] {
            column[shared].iter_mut().for_each(|value| *value *= FRAC_1_SQRT_2);
        }
    }

    /// Line, modes and reactions; and, where there is room, the derivatives of the
    /// reactions to their onsets.
    fn fill_linear(&self, response: &Response, linear: &mut [f64], moves: &mut [f64]) {
        let length = self.values.len();
        let (line, rest) = linear.split_at_mut(LINE * length);
        let (modes, reactions) = rest.split_at_mut(response.modes() * length);
        let (ones, ramp) = line.split_at_mut(length);
        ones.fill(1.0);
        for (slot, k) in ramp.iter_mut().zip(0_u32..) {
            *slot = f64::from(k);
        }
        response.fill_modes(modes, length);
        let mut moves = moves.chunks_exact_mut(length);
        for (onset, step_response) in self.onsets.iter().zip(reactions.chunks_exact_mut(length)) {
            response.fill(*onset, step_response, moves.next().unwrap_or_default());
        }
    }

    /// What changes with one parameter of the model, given the model a little changed.
    fn fill_lag_column(
        &self,
        perturbed: &LagModel,
        parts: &[f64],
        linear: &[f64],
        column: &mut [f64],
    ) {
        let length = self.values.len();
        let response = Response::of(perturbed);
        let mut changed = vec![0.0; linear.len()];
        self.fill_linear(&response, &mut changed, &mut []);
        let pairs = changed.chunks_exact(length).zip(linear.chunks_exact(length));
        for ((after, before), part) in pairs.zip(parts).skip(LINE) {
            // ∂y/∂θ = Σ part·∂column/∂θ, by a forward difference.
            let scale = part / LagModel::perturbation();
            for ((slot, after), before) in column.iter_mut().zip(after).zip(before) {
                *slot += scale * (after - before);
            }
        }
    }

    /// The residuals of the regression whose onsets may move a little, and its columns.
    pub(crate) fn projection(&self, model: &LagModel) -> Projection {
        let length = self.values.len();
        let response = Response::of(model);
        let linear = (LINE + response.modes() + self.onsets.len()) * length;
        let mut columns = vec![0.0; linear + self.onsets.len() * length];
        let (linear, moves) = columns.split_at_mut(linear);
        self.fill_linear(&response, linear, moves);
        let values: Vec<f64> = self.values.iter().map(|y| y - self.values[0]).collect();
        Projection::of(&columns, &values)
    }

    /// The last onset.
    pub(crate) fn last_onset(&self) -> f64 {
        self.onsets[self.onsets.len() - 1]
    }

    /// This window with its last onset elsewhere.
    pub(crate) fn with_last_onset(&self, onset: f64) -> Self {
        let mut there = self.clone();
        there.onsets[self.onsets.len() - 1] = onset;
        there
    }

    /// Limits halfway to the neighbours, whatever the order of the onsets.
    pub(crate) fn halfway(&self) -> Vec<(f64, f64)> {
        let end = self.values.len() as f64 - 2.0;
        // Onsets that pass each other would change steps.
        let limits = |onset: &f64| {
            let others = || self.onsets.iter();
            let below = others().filter(|other| *other < onset).fold(-end, |a, b| a.max(*b));
            let above = others().filter(|other| *other > onset).fold(end, |a, b| a.min(*b));
            (onset.midpoint(below), onset.midpoint(above))
        };
        self.onsets.iter().map(limits).collect()
    }

    /// Moves all onsets to where the squared error is least, each within its `limits`, until
    /// a step is no longer than `fine`: Gauss and Newton's method on the variable projection.
    pub(crate) fn minimise(
        &mut self,
        basis: &Basis,
        noise: &NoiseModel,
        limits: &[(f64, f64)],
        fine: f64,
    ) -> Linearised {
        /// Steps, shortened ones among them, at most; chosen.
        const STEPS: usize = 10;
        /// Samples, so few that no interval shows them.
        const NEGLIGIBLE: f64 = 0.001;
        /// The part that remains of a step that did not lower the squared error.
        const SHORTENED: f64 = 1.0 / 3.0;
        let mut best = self.at(basis, noise);
        let mut factor = 1.0;
        let mut moves = best.moves(&[0.0; MAX_PARAMETERS]);
        for _ in 0..STEPS {
            let moved = self.onsets.iter().zip(&moves).zip(limits);
            let onsets: Vec<f64> = moved
                .map(|((onset, by), (low, high))| bounded(onset + factor * by, *low, *high))
                .collect();
            let largest = self.onsets.iter().zip(&onsets).map(|(a, b)| (a - b).abs());
            let largest = largest.fold(0.0, f64::max);
            if largest < NEGLIGIBLE {
                break;
            }
            let there = Self { onsets, ..*self };
            let found = there.at(basis, noise);
            if found.sse > best.sse {
                // Gauss and Newton's step descends, but may be too long.
                factor *= SHORTENED;
                if largest < fine {
                    break;
                }
                continue;
            }
            // Linearised anew where the error is smaller.
            (self.onsets, best, factor) = (there.onsets, found, 1.0);
            if largest < fine {
                break;
            }
            moves = best.moves(&[0.0; MAX_PARAMETERS]);
        }
        best
    }
}

fn bounded(value: f64, low: f64, high: f64) -> f64 {
    value.max(low).min(high.max(low))
}

#[cfg(test)]
mod tests {
    use super::super::information::Information;
    use super::*;

    fn made(model: &LagModel, onset: f64) -> Vec<f64> {
        let (mut y, mut unused) = (vec![0.0; 120], vec![0.0; 120]);
        let (mut old, mut older) = (vec![0.0; 120], vec![0.0; 120]);
        Response::of(model).fill(onset, &mut y, &mut unused);
        Response::of(model).fill(-11.0, &mut old, &mut older);
        let line = |k: usize| 5.0 + 0.1 * k as f64;
        (0..120).map(|k| line(k) - 0.4 * old[k] + 0.7 * y[k]).collect()
    }

    #[test]
    fn a_reaction_is_found_between_samples_although_the_one_before_is_not_over() {
        for model in [LagModel::real(6.0), LagModel::pair_of(0.157, 0.25)] {
            let values = made(&model, 47.37);
            let mut window = FitWindow::alone(&values, vec![52.0]);
            let basis = Basis::of(&model, values.len());
            let found = window.minimise(&basis, &NoiseModel::white(), &[(0.0, 120.0)], FINE);
            assert!((window.onsets[0] - 47.37).abs() < 1e-3, "{:?}", window.onsets);
            assert!((found.change() - 0.7).abs() < 1e-3, "{}", found.change());
            assert!(window.projection(&model).power() < 1e-6);
        }
    }

    #[test]
    fn products_over_pieces_are_those_of_whole_columns() {
        let pairs = [(0.157, 0.25), (0.1, 1.0), (0.2, 1.8)];
        let pairs = pairs.map(|(omega, zeta)| LagModel::pair_of(omega, zeta));
        let others = [LagModel::NONE, LagModel::real(0.3), LagModel::real(6.0)];
        let both = LagModel::pair_of(0.2, 0.3).behind(6.0);
        for model in pairs.into_iter().chain(others).chain([both]) {
            let values = made(&model, 47.37);
            for (onsets, shared) in [
                (vec![47.37], (0, 0)),
                (vec![-3.2, 20.0, 20.7, 118.5], (9, 30)),
                (vec![80.1, 30.9], (90, 70)),
            ] {
                let window = FitWindow { values: &values, onsets, shared };
                let noise = NoiseModel::white();
                let dense = window.linearised(&model, &noise, None).whole;
                let sums = window.at(&Basis::of(&model, 120), &noise).whole;
                let size = dense.size();
                for (i, j) in (0..size).flat_map(|i| (i..size).map(move |j| (i, j))) {
                    let scale = (dense.at(i, i) * dense.at(j, j)).sqrt();
                    let apart = (dense.at(i, j) - sums.at(i, j)).abs();
                    assert!(apart <= 1e-10 * scale, "{model:?} {i} {j}: {apart} {scale}");
                }
            }
        }
    }

    #[test]
    fn columns_of_the_lag_are_what_changes_with_it() {
        let model = LagModel::pair_of(0.2, 0.4).behind(4.0);
        let values = made(&model.perturbed(1), 47.37);
        let noise = NoiseModel::white();
        let window = FitWindow::alone(&values, vec![47.37]);
        let parts = window.at(&Basis::of(&model, 120), &noise).parts;
        let found = window.with_lag_columns(&model, &noise, &parts);
        let mut information = Information::default();
        found.inform(&mut information);
        // To first order the perturbation is all there is to find.
        let matrix = nalgebra::Matrix3::from_fn(|i, j| information.products[i][j]);
        let solved = matrix.lu().solve(&nalgebra::Vector3::from(information.with)).unwrap();
        assert!((solved[1] / LagModel::perturbation() - 1.0).abs() < 0.02, "{solved}");
        assert!(solved[0].abs() + solved[2].abs() < 0.02 * LagModel::perturbation(), "{solved}");
    }
}
