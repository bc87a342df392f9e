//! A stretch of output in which a joint reacts behind a lag: one linear regression, and
//! what becomes of it when reactions and lag move a little.
//!
//! ```text
//! y_k = A + v·k + Σ b_m·mode_m(k) + Σ c_j·G(k − τ_j)
//! ```
//!
//! `A`, `v`, the modes that earlier steps left, and the changes of speed `c_j` are linear,
//! so they are solved for and never searched. Moving `τ_j` adds `c_j·∂G/∂τ_j` to the
//! output, a change of the lag's shape `Σ c_j·∂G/∂θ + Σ b_m·∂mode_m/∂θ`: further columns,
//! whose coefficients are Gauss and Newton's steps.

use std::f64::consts::FRAC_1_SQRT_2;

use super::basis::{Basis, LINE, Motion, common};
use super::chain::ceil;
use super::response::{MOST, Response, Shape};
use crate::numerics::NoiseModel;
use crate::numerics::NormalEquations;
use crate::numerics::Projection;

/// Samples: after a step as small as this the next one does not matter, since each is about
/// the square of the one before.
pub(super) const FINE: f64 = 0.02;

/// Output of a window, and where in it the joint reacts (indices of the window); the last
/// place is the one in question.
#[derive(Clone, Debug)]
pub(super) struct Stretch<'a> {
    pub(super) values: &'a [f64],
    pub(super) places: Vec<f64>,
    /// Samples at its beginning and at its end that a neighbour has too: they count half in
    /// each of the two, so that nothing is told twice.
    pub(super) shared: (usize, usize),
}

/// A stretch regressed at its places.
#[derive(Clone, Debug)]
pub(super) struct Linearised {
    /// Squared error.
    pub(super) sse: f64,
    /// Coefficients of line, modes and reactions.
    pub(super) parts: Vec<f64>,
    equations: NormalEquations,
    /// Before any column was eliminated.
    whole: NormalEquations,
    modes: usize,
    reactions: usize,
}

/// A column of the regression since its beginning; 0 before.
struct Column {
    start: usize,
    motion: Motion,
}

impl<'a> Stretch<'a> {
    /// One that shares nothing.
    pub(super) fn alone(values: &'a [f64], places: Vec<f64>) -> Self {
        Self { values, places, shared: (0, 0) }
    }

    /// How many samples it counts for.
    pub(super) fn weight(&self) -> f64 {
        self.values.len() as f64 - 0.5 * (self.shared.0 + self.shared.1) as f64
    }

    /// The regression with the lag as it is.
    pub(super) fn at(&self, basis: &Basis, noise: &NoiseModel) -> Linearised {
        if noise.order() > 0 {
            return self.linearised(&basis.shape, noise, None);
        }
        let modes = basis.response.modes();
        Linearised::of(self.equations(basis), modes, self.places.len())
    }

    /// The products of all columns and the output, piece by piece between their beginnings.
    /// The noise is white.
    fn equations(&self, basis: &Basis) -> NormalEquations {
        let mut columns = self.columns(basis);
        let size = columns.len() + 1;
        let mut products = vec![0.0; size * size];
        let offset = self.values.first().copied().unwrap_or_default();
        let cuts = self.cuts(&columns);
        for (from, to) in cuts.iter().zip(cuts.iter().skip(1)) {
            let piece = basis.products(self.values.get(*from..*to).unwrap_or_default(), offset);
            let weight = self.weight_at(*from);
            for (i, row) in products.chunks_exact_mut(size).enumerate() {
                let Some(columns @ [column, ..]) = columns.get(i..) else { continue };
                if column.start > *from {
                    continue;
                }
                let along = piece.along(&column.motion);
                for (slot, other) in row.iter_mut().skip(i).zip(columns) {
                    let begun = if other.start <= *from { weight } else { 0.0 };
                    *slot += begun * common(&along, &other.motion);
                }
                row.iter_mut().rev().take(1).for_each(|slot| {
                    *slot += weight * piece.with_output(&column.motion);
                });
            }
            products.iter_mut().rev().take(1).for_each(|slot| *slot += weight * piece.square);
            for column in columns.iter_mut().filter(|column| column.start <= *from) {
                column.motion = basis.later(&column.motion, to - from);
            }
        }
        NormalEquations::from_products(size, products)
    }

    /// Line, modes, reactions, and the derivatives of the reactions to their places.
    fn columns(&self, basis: &Basis) -> Vec<Column> {
        let free = (0..LINE + basis.response.modes()).map(|index| {
            let mut motion = Motion::default();
            motion.iter_mut().skip(index).take(1).for_each(|slot| *slot = 1.0);
            Column { start: 0, motion }
        });
        let reaction = |place: &f64| {
            let start = ceil(*place);
            (start, basis.response.motions(start as f64 - place))
        };
        let reactions: Vec<_> = self.places.iter().map(reaction).collect();
        let positions = reactions.iter().map(|(start, (motion, _))| (*start, *motion));
        let moves = reactions.iter().map(|(start, (_, motion))| (*start, *motion));
        let begun = positions.chain(moves).map(|(start, motion)| Column { start, motion });
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
    pub(super) fn with_shape(
        &self,
        shape: &Shape,
        noise: &NoiseModel,
        parts: &[f64],
    ) -> Linearised {
        self.linearised(shape, noise, Some(parts))
    }

    fn linearised(&self, shape: &Shape, noise: &NoiseModel, parts: Option<&[f64]>) -> Linearised {
        let length = self.values.len();
        let response = Response::of(shape);
        let (modes, reactions) = (response.modes(), self.places.len());
        let shapes = if parts.is_some() { shape.order() } else { 0 };
        let size = LINE + modes + 2 * reactions + shapes + 1;
        let mut columns = vec![0.0; size * length];
        let (linear, rest) = columns.split_at_mut((LINE + modes + reactions) * length);
        let (moves, rest) = rest.split_at_mut(reactions * length);
        let (shape_columns, target) = rest.split_at_mut(shapes * length);
        self.fill_linear(&response, linear, moves);
        if let Some(parts) = parts {
            let slots = shape_columns.chunks_exact_mut(length.max(1)).enumerate();
            for (index, column) in slots {
                self.fill_shape(&shape.nudged(index), parts, linear, column);
            }
        }
        let offset = self.values.first().copied().unwrap_or_default();
        for (slot, y) in target.iter_mut().zip(self.values) {
            *slot = y - offset;
        }
        for column in columns.chunks_exact_mut(length.max(1)) {
            noise.whiten(column);
            self.weigh(column);
        }
        let equations = NormalEquations::of(&columns, length, &self.starts(modes));
        Linearised::of(equations, modes, reactions)
    }

    /// The row at which each column begins, as far as one does: line, modes, reactions, moves.
    fn starts(&self, modes: usize) -> Vec<usize> {
        let places = self.places.iter().map(|place| ceil(*place));
        std::iter::repeat_n(0, LINE + modes).chain(places.clone()).chain(places).collect()
    }

    /// Makes what is shared count half in a sum of squares.
    fn weigh(&self, column: &mut [f64]) {
        for shared in [0..self.shared.0, self.own_end()..column.len()] {
            let shared = column.get_mut(shared).unwrap_or_default();
            for value in shared {
                *value *= FRAC_1_SQRT_2;
            }
        }
    }

    /// Line, modes and reactions; and, where there is room, the derivatives of the
    /// reactions to their places.
    fn fill_linear(&self, response: &Response, linear: &mut [f64], moves: &mut [f64]) {
        let length = self.values.len().max(1);
        let (line, rest) = linear.split_at_mut(LINE * length);
        let (modes, reactions) = rest.split_at_mut(response.modes() * length);
        let (ones, ramp) = line.split_at_mut(length);
        ones.fill(1.0);
        for (slot, k) in ramp.iter_mut().zip(0_u32..) {
            *slot = f64::from(k);
        }
        response.fill_modes(modes, length);
        let mut moves = moves.chunks_exact_mut(length);
        for (place, position) in self.places.iter().zip(reactions.chunks_exact_mut(length)) {
            response.fill(*place, position, moves.next().unwrap_or_default());
        }
    }

    /// What changes with one parameter of the shape, given the shape a little changed.
    fn fill_shape(&self, nudged: &Shape, parts: &[f64], linear: &[f64], column: &mut [f64]) {
        let length = self.values.len().max(1);
        let response = Response::of(nudged);
        let mut changed = vec![0.0; linear.len()];
        self.fill_linear(&response, &mut changed, &mut []);
        let pairs = changed.chunks_exact(length).zip(linear.chunks_exact(length));
        for ((after, before), part) in pairs.zip(parts).skip(LINE) {
            let scale = part / Shape::nudge();
            for ((slot, after), before) in column.iter_mut().zip(after).zip(before) {
                *slot += scale * (after - before);
            }
        }
    }

    /// What a regression leaves of the output when its reactions may move a little.
    pub(super) fn leftover(&self, shape: &Shape) -> Projection {
        let length = self.values.len().max(1);
        let response = Response::of(shape);
        let linear = (LINE + response.modes() + self.places.len()) * length;
        let mut columns = vec![0.0; linear + self.places.len() * length];
        let (linear, moves) = columns.split_at_mut(linear);
        self.fill_linear(&response, linear, moves);
        let offset = self.values.first().copied().unwrap_or_default();
        let values: Vec<f64> = self.values.iter().map(|y| y - offset).collect();
        Projection::of(&columns, &values)
    }

    /// Limits halfway to the neighbours, whatever the order of the places.
    pub(super) fn halfway(&self) -> Vec<(f64, f64)> {
        let end = self.values.len() as f64 - 2.0;
        let limits = |place: &f64| {
            let others = || self.places.iter();
            let below = others().filter(|other| *other < place).fold(-end, |a, b| a.max(*b));
            let above = others().filter(|other| *other > place).fold(end, |a, b| a.min(*b));
            (place.midpoint(below), place.midpoint(above))
        };
        self.places.iter().map(limits).collect()
    }

    /// Moves all reactions to where the squared error is least, each within its `limits`, until
    /// a step is no longer than `fine`.
    pub(super) fn settle(
        &mut self,
        basis: &Basis,
        noise: &NoiseModel,
        limits: &[(f64, f64)],
        fine: f64,
    ) -> Linearised {
        /// Steps, and halvings of one step, at most.
        const STEPS: usize = 10;
        /// Samples that no interval shows.
        const THERE: f64 = 0.001;
        let mut best = self.at(basis, noise);
        let mut factor = 1.0;
        let mut moves = best.moves(&[0.0; MOST]);
        for _ in 0..STEPS {
            let moved = self.places.iter().zip(&moves).zip(limits);
            let places: Vec<f64> = moved
                .map(|((place, by), (low, high))| bounded(place + factor * by, *low, *high))
                .collect();
            let largest = self.places.iter().zip(&places).map(|(a, b)| (a - b).abs());
            let largest = largest.fold(0.0, f64::max);
            if largest < THERE {
                break;
            }
            let there = Self { places, ..*self };
            let found = there.at(basis, noise);
            if found.sse > best.sse {
                factor /= 3.0;
                if largest < fine {
                    break;
                }
                continue;
            }
            (self.places, best, factor) = (there.places, found, 1.0);
            if largest < fine {
                break;
            }
            moves = best.moves(&[0.0; MOST]);
        }
        best
    }
}

fn bounded(value: f64, low: f64, high: f64) -> f64 {
    value.max(low).min(high.max(low))
}

impl Linearised {
    fn of(mut equations: NormalEquations, modes: usize, reactions: usize) -> Self {
        let linear = LINE + modes + reactions;
        let whole = equations.clone();
        (0..linear).for_each(|column| equations.eliminate(column));
        let sse = equations.error();
        let parts = equations.coefficients(linear, &[]);
        (linear..linear + reactions).for_each(|column| equations.eliminate(column));
        Self { sse, parts, equations, whole, modes, reactions }
    }

    /// The part of the squared error that the last reaction takes away, when the others may
    /// move in its stead.
    pub(super) fn share(&self) -> f64 {
        let linear = self.first_reaction() + self.reactions;
        let last = linear - 1;
        let others = (0..last).chain(linear..linear + self.reactions - 1);
        let order: Vec<usize> = others.chain([last, self.whole.size() - 1]).collect();
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
    pub(super) fn change(&self) -> f64 {
        self.parts.last().copied().unwrap_or_default()
    }

    /// Gauss and Newton's steps of the places, given that of the shape; no longer than
    /// what a straight continuation is good for.
    pub(super) fn moves(&self, shape_change: &[f64; MOST]) -> Vec<f64> {
        const LONGEST: f64 = 8.0;
        let locals = self.first_reaction() + 2 * self.reactions;
        let behind: Vec<_> =
            shape_change.iter().enumerate().map(|(i, by)| (locals + i, *by)).collect();
        let behind = behind.get(..self.shapes()).unwrap_or_default();
        let found = self.equations.coefficients(locals, behind);
        let (changes, moves) = found.split_at(self.first_reaction() + self.reactions);
        let changes = changes.iter().skip(self.first_reaction());
        let step = |(change, by): (&f64, &f64)| {
            let step = by / change;
            if step.is_finite() { step.clamp(-LONGEST, LONGEST) } else { 0.0 }
        };
        changes.zip(moves).map(step).collect()
    }

    /// Columns of the shape.
    fn shapes(&self) -> usize {
        self.equations.size().saturating_sub(self.last_move() + 2)
    }

    /// Variance of the last place, as a part of the noise's, with the shape as it is.
    pub(super) fn place_variance(&self) -> f64 {
        let column = self.last_move();
        let change = self.change();
        if !self.equations.stands_alone(column) {
            return f64::INFINITY;
        }
        1.0 / (self.equations.at(column, column) * change * change)
    }

    /// How far the last place moves with each parameter of the shape.
    pub(super) fn place_slopes(&self) -> [f64; MOST] {
        let column = self.last_move();
        let pivot = self.equations.at(column, column) * self.change();
        let mut slopes = [0.0; MOST];
        for (index, slope) in slopes.iter_mut().enumerate().take(self.shapes()) {
            *slope = -self.equations.at(column, column + 1 + index) / pivot;
        }
        slopes
    }

    /// Adds what this stretch says about the shape: products of its columns with each
    /// other and with the output, all else taken off.
    pub(super) fn add_shape(&self, products: &mut [[f64; MOST]; MOST], with: &mut [f64; MOST]) {
        let first = self.last_move() + 1;
        let count = self.shapes();
        for i in 0..count {
            for j in i..count {
                let product = self.equations.at(first + i, first + j);
                for (a, b) in if i == j { vec![(i, j)] } else { vec![(i, j), (j, i)] } {
                    if let Some(slot) = products.get_mut(a).and_then(|row| row.get_mut(b)) {
                        *slot += product;
                    }
                }
            }
            if let Some(slot) = with.get_mut(i) {
                *slot += self.equations.at(first + i, first + count);
            }
        }
    }

    /// Parameters that were solved for.
    pub(super) fn parameters(&self) -> usize {
        self.first_reaction() + 2 * self.reactions
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(shape: &Shape, place: f64) -> Vec<f64> {
        let (mut y, mut unused) = (vec![0.0; 120], vec![0.0; 120]);
        let (mut old, mut older) = (vec![0.0; 120], vec![0.0; 120]);
        Response::of(shape).fill(place, &mut y, &mut unused);
        Response::of(shape).fill(-11.0, &mut old, &mut older);
        let line = |k: usize| 5.0 + 0.1 * k as f64;
        (0..120).map(|k| line(k) - 0.4 * old[k] + 0.7 * y[k]).collect()
    }

    #[test]
    fn a_reaction_is_found_between_samples_although_the_one_before_is_not_over() {
        for shape in [Shape::real(6.0), Shape::pair_of(0.157, 0.25)] {
            let values = made(&shape, 47.37);
            let mut stretch = Stretch::alone(&values, vec![52.0]);
            let basis = Basis::of(&shape, values.len());
            let found = stretch.settle(&basis, &NoiseModel::white(), &[(0.0, 120.0)], FINE);
            assert!((stretch.places[0] - 47.37).abs() < 1e-3, "{:?}", stretch.places);
            assert!((found.change() - 0.7).abs() < 1e-3, "{}", found.change());
            assert!(stretch.leftover(&shape).power() < 1e-6);
        }
    }

    #[test]
    fn products_over_pieces_are_those_of_whole_columns() {
        let pairs = [(0.157, 0.25), (0.1, 1.0), (0.2, 1.8)];
        let pairs = pairs.map(|(omega, zeta)| Shape::pair_of(omega, zeta));
        let others = [Shape::NONE, Shape::real(0.3), Shape::real(6.0)];
        let both = Shape::pair_of(0.2, 0.3).behind(6.0);
        for shape in pairs.into_iter().chain(others).chain([both]) {
            let values = made(&shape, 47.37);
            for (places, shared) in [
                (vec![47.37], (0, 0)),
                (vec![-3.2, 20.0, 20.7, 118.5], (9, 30)),
                (vec![80.1, 30.9], (90, 70)),
            ] {
                let stretch = Stretch { values: &values, places, shared };
                let noise = NoiseModel::white();
                let dense = stretch.linearised(&shape, &noise, None).whole;
                let sums = stretch.at(&Basis::of(&shape, 120), &noise).whole;
                let size = dense.size();
                for (i, j) in (0..size).flat_map(|i| (i..size).map(move |j| (i, j))) {
                    let scale = (dense.at(i, i) * dense.at(j, j)).sqrt();
                    let apart = (dense.at(i, j) - sums.at(i, j)).abs();
                    assert!(apart <= 1e-10 * scale, "{shape:?} {i} {j}: {apart} {scale}");
                }
            }
        }
    }

    #[test]
    fn columns_of_the_shape_are_what_changes_with_it() {
        let shape = Shape::pair_of(0.2, 0.4).behind(4.0);
        let values = made(&shape.nudged(1), 47.37);
        let noise = NoiseModel::white();
        let stretch = Stretch::alone(&values, vec![47.37]);
        let parts = stretch.at(&Basis::of(&shape, 120), &noise).parts;
        let found = stretch.with_shape(&shape, &noise, &parts);
        let (mut products, mut with) = ([[0.0; MOST]; MOST], [0.0; MOST]);
        found.add_shape(&mut products, &mut with);
        // To first order the nudge is all there is to find.
        let matrix = nalgebra::Matrix3::from_fn(|i, j| products[i][j]);
        let solved = matrix.lu().solve(&nalgebra::Vector3::from(with)).unwrap();
        assert!((solved[1] / Shape::nudge() - 1.0).abs() < 0.02, "{solved}");
        assert!(solved[0].abs() + solved[2].abs() < 0.02 * Shape::nudge(), "{solved}");
    }
}
