//! What an output does by itself and what a step adds to it: a linear state.
//!
//! Between two onsets the state `x` of `N` numbers moves as `x' = A x`, and the output is its first
//! number. An onset of size `a` adds `a·b` to it, and what was under way before is any state at the
//! start of a window, so that every response of this kind is fitted in the same way:
//!
//! ```text
//! y_j = c F^j x_0 + a·c F^(j−k) e^(A f) b·[j ≥ k] + e_j      F = e^A,  c = (1 0 … 0)
//! ```
//!
//! with the onset at `τ = k − f` between two samples. `x_0` and `a` are linear and solved for; what
//! remains is a squared error for each `τ`, a quotient of products that are known for every `k`
//! once
//!
//! ```text
//! z_k = Σ_(j≥k) (c F^(j−k))ᵀ y_j          backward over the window: z_k = cᵀ y_k + Fᵀ z_(k+1)
//! Q_m = Σ_(i<m) (c F^i)ᵀ (c F^i)          the same for all windows
//! ```
//!
//! are. With `S = Q_n`, `x̂ = S⁻¹ z_0`, `β = e^(A f) b` and `v = (F^k)ᵀ Q_(n−k) β`:
//!
//! ```text
//! SSE(τ) = SSE_0 − g²/d      g = βᵀ z_k − vᵀ x̂      d = βᵀ Q_(n−k) β − vᵀ S⁻¹ v
//! ```
//!
//! A second direction of the jump, whose size is of no interest, and an end of what the onset added
//! are further columns of the same kind.
//!
//! # References
//! A. S. Willsky and H. L. Jones, "A generalized likelihood ratio approach to the detection and
//! estimation of jumps in linear systems", IEEE Transactions on Automatic Control 21 (1976); here
//! without process noise, so that the likelihood is a least-squares problem.

use nalgebra::{SMatrix, SVector};

use crate::units::ceil_to_index;

pub(super) type Square<const N: usize> = SMatrix<f64, N, N>;
pub(super) type State<const N: usize> = SVector<f64, N>;

/// A part of the square of a column below which it depends on the others: half of the digits, since the
/// inverse of an information matrix has no more where a window begins just before its onset.
const DEPENDENT: f64 = 1.5e-8;

/// What is fitted to windows, whatever the size of its state.
pub(super) trait Response {
    /// Parameters of one window: the state, the onset, and its sizes.
    fn parameters(&self) -> usize;

    /// The `values` of a window, with what was under way `before`; what an onset added ends after
    /// so many samples. `None` where the values are too few, or more than was asked for at first.
    fn window(&self, values: &[f64], ends: f64, before: Before) -> Option<Box<dyn Fit + '_>>;
}

/// A window, fitted with an onset at any position between its samples.
pub(super) trait Fit {
    fn samples(&self) -> usize;

    /// `SSE_0`: without an onset.
    fn sse_without(&self) -> f64;

    /// The onset at a `position`.
    fn at(&self, position: f64) -> Jump;

    /// The output as it is fitted with an onset at `position`.
    fn fitted(&self, position: f64) -> Vec<f64>;
}

/// How an output moves, in samples; see the [module](self).
pub(super) struct Dynamics<const N: usize> {
    generator: Square<N>,
    jump: State<N>,
    /// A second direction of the jump.
    nuisance: Option<State<N>>,
    /// `F^m`.
    powers: Vec<Square<N>>,
    /// `Q_m`.
    information: Vec<Square<N>>,
    steady: Steady<N>,
}

/// What was under way before a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Before {
    /// Any motion.
    Any,
    /// A steady one.
    Steady,
}

/// The states of steady motion: a column each, the others being 0.
#[derive(Clone, Debug)]
pub(super) struct Steady<const N: usize>(pub(super) Square<N>);

impl<const N: usize> Steady<N> {
    /// Any state.
    #[cfg(test)]
    pub(super) fn any() -> Self {
        Self(Square::identity())
    }

    /// The inverse of an information matrix among these states.
    fn inverse(&self, information: &Square<N>) -> Option<Square<N>> {
        let within = self.0.tr_mul(&(information * self.0));
        let mut unused = within;
        // A state that is none of them has nothing to say.
        (0..N).for_each(|i| unused[(i, i)] += f64::from(u8::from(self.0.column(i).norm() == 0.0)));
        Some(self.0 * inverse(&unused)? * self.0.transpose())
    }
}

/// The sums over a window from which its squared error at any onset follows.
struct Window<'a, const N: usize> {
    dynamics: &'a Dynamics<N>,
    /// `z_k`.
    behind: Vec<State<N>>,
    /// `S⁻¹`.
    inverse: Square<N>,
    /// `x̂`.
    free: State<N>,
    samples: usize,
    mean: f64,
    /// Samples after which what an onset added ends; infinite where it lasts.
    ends: f64,
    sse_without: f64,
}

/// An onset at one position of a window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jump {
    pub(super) sse: f64,
    /// `a`.
    pub(super) size: f64,
    /// The inverse variance of `a`, for noise of variance 1.
    pub(super) information: f64,
    /// The size in the second direction.
    other: f64,
}

/// A jump at a sample: its first one `k`, and `e^(A f) b`.
struct Column<const N: usize> {
    k: usize,
    beta: State<N>,
}

/// A column's products: `Q β`, `v`, and `g`.
struct Products<const N: usize> {
    w: State<N>,
    v: State<N>,
    g: f64,
}

impl<const N: usize> Dynamics<N> {
    /// For windows of fewer than `longest` samples.
    pub(super) fn new(
        generator: Square<N>,
        jump: State<N>,
        nuisance: Option<State<N>>,
        steady: Steady<N>,
        longest: usize,
    ) -> Self {
        let step = exponential(&generator);
        let (mut power, mut sum) = (Square::<N>::identity(), Square::<N>::zeros());
        let (mut powers, mut information) = (Vec::new(), Vec::new());
        for _ in 0..=longest.max(1) {
            powers.push(power);
            information.push(sum);
            let row = power.row(0).transpose();
            sum += row * row.transpose();
            power = step * power;
        }
        Self { generator, jump, nuisance, powers, information, steady }
    }

    /// `e^(A f) b` for `f` of a sample at most, by its series.
    fn moved(&self, b: &State<N>, f: f64) -> State<N> {
        let (mut term, mut sum) = (*b, *b);
        let mut order = 1.0;
        while f > 0.0 && term.norm() > f64::EPSILON * sum.norm() {
            term = self.generator * term * (f / order);
            sum += term;
            order += 1.0;
        }
        sum
    }
}

impl<const N: usize> Response for Dynamics<N> {
    fn parameters(&self) -> usize {
        N + 2 + usize::from(self.nuisance.is_some())
    }

    fn window(&self, values: &[f64], ends: f64, before: Before) -> Option<Box<dyn Fit + '_>> {
        let n = values.len();
        if n <= self.parameters() || n >= self.powers.len() {
            return None;
        }
        let mean = values.iter().sum::<f64>() / n as f64;
        let step = self.powers[1].transpose();
        let mut behind = vec![State::<N>::zeros(); n + 1];
        let mut squares = 0.0;
        for k in (0..n).rev() {
            let y = values[k] - mean;
            squares += y * y;
            let mut z = step * behind[k + 1];
            z[0] += y;
            behind[k] = z;
        }
        let inverse = match before {
            Before::Steady => self.steady.inverse(&self.information[n])?,
            Before::Any => inverse(&self.information[n])?,
        };
        let free = inverse * behind[0];
        let sse_without = (squares - behind[0].dot(&free)).max(0.0);
        let dynamics = self;
        let samples = n;
        Some(Box::new(Window { dynamics, behind, inverse, free, samples, mean, ends, sse_without }))
    }
}

impl<const N: usize> Window<'_, N> {
    fn column(&self, b: &State<N>, position: f64) -> Column<N> {
        let k = ceil_to_index(position.max(0.0)).min(self.samples - 1);
        Column { k, beta: self.dynamics.moved(b, (k as f64 - position).clamp(0.0, 1.0)) }
    }

    /// Where what the onset added ends, if it does within the window.
    fn end(&self, position: f64) -> Option<Column<N>> {
        let end = position + self.ends;
        (end <= self.samples as f64 - 1.0).then(|| self.column(&self.dynamics.jump, end))
    }

    fn products(&self, column: &Column<N>) -> Products<N> {
        let w = self.dynamics.information[self.samples - column.k] * column.beta;
        let v = self.dynamics.powers[column.k].tr_mul(&w);
        let g = column.beta.dot(&self.behind[column.k]) - v.dot(&self.free);
        Products { w, v, g }
    }
}

impl<const N: usize> Fit for Window<'_, N> {
    fn samples(&self) -> usize {
        self.samples
    }

    fn sse_without(&self) -> f64 {
        self.sse_without
    }

    fn at(&self, position: f64) -> Jump {
        let nothing = Jump { sse: self.sse_without, size: 0.0, information: 0.0, other: 0.0 };
        let column = self.column(&self.dynamics.jump, position);
        let Products { mut w, mut v, mut g } = self.products(&column);
        let mut square = column.beta.dot(&w);
        if let Some(end) = self.end(position) {
            let taken = self.products(&end);
            let between = &self.dynamics.powers[end.k - column.k];
            square += end.beta.dot(&taken.w) - 2.0 * column.beta.dot(&between.tr_mul(&taken.w));
            w -= between.tr_mul(&taken.w);
            v -= taken.v;
            g -= taken.g;
        }
        let solved = self.inverse * v;
        let d = square - v.dot(&solved);
        if d <= DEPENDENT * square {
            return nothing;
        }
        let Some(second) = &self.dynamics.nuisance else {
            return Jump {
                sse: (self.sse_without - g * g / d).max(0.0),
                size: g / d,
                information: d,
                other: 0.0,
            };
        };
        let second = self.column(second, position);
        let its = self.products(&second);
        let its_square = second.beta.dot(&its.w);
        let own = its_square - its.v.dot(&(self.inverse * its.v));
        let cross = second.beta.dot(&w) - its.v.dot(&solved);
        let det = d * own - cross * cross;
        if own <= DEPENDENT * its_square || det <= DEPENDENT * square * own {
            return nothing;
        }
        let size = (g * own - its.g * cross) / det;
        let other = (its.g * d - g * cross) / det;
        let sse = (self.sse_without - g * size - its.g * other).max(0.0);
        Jump { sse, size, information: det / own, other }
    }

    fn fitted(&self, position: f64) -> Vec<f64> {
        let jump = self.at(position);
        let mut columns = vec![(self.column(&self.dynamics.jump, position), jump.size)];
        columns.extend(self.end(position).map(|end| (end, -jump.size)));
        let second = self.dynamics.nuisance.as_ref();
        columns.extend(second.map(|b| (self.column(b, position), jump.other)));
        let mut start = self.free;
        for (column, size) in &columns {
            start -= self.inverse * self.products(column).v * *size;
        }
        let value = |state: &State<N>, after: usize| {
            self.dynamics.powers[after].row(0).transpose().dot(state)
        };
        let at = |j: usize| {
            let added = columns.iter().filter(|(column, _)| j >= column.k);
            let added: f64 =
                added.map(|(column, size)| size * value(&column.beta, j - column.k)).sum();
            self.mean + value(&start, j) + added
        };
        (0..self.samples).map(at).collect()
    }
}

/// `e^A`, by its series for a small part of `A`, squared again and again.
fn exponential<const N: usize>(a: &Square<N>) -> Square<N> {
    let mut halvings = 0;
    let mut part = *a;
    while part.norm() > 0.5 {
        part *= 0.5;
        halvings += 1;
    }
    let (mut term, mut sum) = (Square::<N>::identity(), Square::<N>::identity());
    for order in 1..=16 {
        term = term * part / f64::from(order);
        sum += term;
    }
    for _ in 0..halvings {
        sum = sum * sum;
    }
    sum
}

/// The inverse of an information matrix; a state that the samples do not show is held by a prior
/// that is far weaker than any sample.
fn inverse<const N: usize>(information: &Square<N>) -> Option<Square<N>> {
    /// In parts of the information on each state.
    const PRIOR: f64 = 1e-11;
    let scale = information.diagonal().map(|d| if d > 0.0 { d.sqrt().recip() } else { 1.0 });
    let scaled = |m: &Square<N>| Square::<N>::from_fn(|i, j| m[(i, j)] * scale[i] * scale[j]);
    let held = scaled(information) + Square::<N>::identity() * PRIOR;
    let inverse = held.cholesky()?.inverse();
    Some(scaled(&inverse))
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::super::response::response_of;
    use super::super::shape::{Family, Shape};
    use super::*;
    use crate::numerics::testing::uniform;

    /// After a first-order lag of 4 samples.
    fn lagged() -> Dynamics<3> {
        let a = Square::<3>::new(0.0, 1.0, 0.0, 0.0, -0.25, 0.25, 0.0, 0.0, 0.0);
        Dynamics::new(a, State::<3>::new(0.0, 0.0, 1.0), None, Steady::any(), 100)
    }

    fn response_at(t: f64) -> f64 {
        if t <= 0.0 { 0.0 } else { t - 4.0 * (1.0 - (-t / 4.0).exp()) }
    }

    #[test]
    fn the_error_is_that_of_the_regression_on_all_columns() {
        let mut white = uniform(3);
        let y: Vec<f64> = (0..60).map(|k| response_at(f64::from(k) - 23.4) + white()).collect();
        let dynamics = lagged();
        let window = dynamics.window(&y, f64::INFINITY, Before::Any).unwrap();
        for position in [9.0, 17.25, 23.4, 40.9] {
            let columns = DMatrix::from_fn(60, 4, |j, column| {
                let t = j as f64;
                [1.0, t, (-t / 4.0).exp(), response_at(t - position)][column]
            });
            let y = DVector::from_column_slice(&y);
            let solved = columns.clone().svd(true, true).solve(&y, 1e-12).unwrap();
            let sse = (&y - &columns * &solved).norm_squared();
            let found = window.at(position);
            assert!((found.sse - sse).abs() < 1e-7 * sse, "{position}: {} {sse}", found.sse);
            assert!((found.size - solved[3]).abs() < 1e-7, "{position}");
            let fitted = DVector::from_vec(window.fitted(position));
            assert!((fitted - &columns * &solved).norm() < 1e-5, "{position}");
        }
    }

    #[test]
    fn what_an_onset_added_may_end() {
        let y: Vec<f64> = (0..80)
            .map(|k| {
                let ramp = |from: f64| (f64::from(k) - from).max(0.0);
                2.0 + 0.5 * (ramp(20.3) - ramp(35.3))
            })
            .collect();
        let a = Square::<2>::new(0.0, 1.0, 0.0, 0.0);
        let dynamics = Dynamics::new(a, State::<2>::new(0.0, 1.0), None, Steady::any(), 100);
        let window = dynamics.window(&y, 15.0, Before::Any).unwrap();
        let found = window.at(20.3);
        assert!(found.sse < 1e-6 && (found.size - 0.5).abs() < 1e-6, "{found:?}");
        assert!(window.at(22.0).sse > 0.1);
    }

    #[test]
    fn a_window_that_is_too_short_has_no_onset() {
        assert!(lagged().window(&[0.0; 5], f64::INFINITY, Before::Any).is_none());
        assert!(lagged().window(&[0.0; 200], f64::INFINITY, Before::Any).is_none());
    }

    #[test]
    fn an_onset_where_the_window_begins_explains_no_noise() {
        // What it adds there is the motion before it in all samples but the first.
        let shape = Shape { family: Family::Pair, curved: true, logs: [0.346_f64.ln(), 0.66, 0.0] };
        let response = response_of(&shape, 145.0, 600);
        let mut white = uniform(7);
        let value = |k: i32| 200.0 + 3.0 * response_at(f64::from(k) - 330.2) + white();
        let y: Vec<f64> = (0..541).map(value).collect();
        let window = response.window(&y, f64::INFINITY, Before::Any).unwrap();
        // Variance of uniform noise, a third of it taken at most.
        let least = 541.0 / 12.0 * 2.0 / 3.0;
        for position in (4..1076).map(|half| f64::from(half) / 2.0) {
            let sse = window.at(position).sse;
            assert!(sse > least, "{position}: {sse}");
        }
    }
}
