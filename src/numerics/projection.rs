//! What regressions leave of noise, and what they take of its memory.
//!
//! A regression on columns with the orthonormal basis `Q` leaves `r = (1 − QQᵀ)·e` of noise
//! with autocovariances `γ`, so that
//!
//! ```text
//! E Σ r_k·r_(k+h) = Σ_l kept_hl·γ_l        kept_hl = tr (1 − QQᵀ) S_h (1 − QQᵀ) T_l
//! ```
//!
//! with `S_h` half, and `T_l` the whole of what shifts by as many samples to both sides.
//! Solved for `γ`, short windows tell the noise as truly as long ones.

use nalgebra::{DMatrix, DVector};

use super::{dot, dots};

/// What a regression left of the output of a window.
#[derive(Clone, Debug)]
pub(crate) struct Projection {
    residuals: Vec<f64>,
    /// Orthonormal columns, one behind the other.
    basis: Vec<f64>,
}

impl Projection {
    /// What the `columns`, one behind the other, leave of `values`.
    pub(crate) fn of(columns: &[f64], values: &[f64]) -> Self {
        let length = values.len().max(1);
        let mut basis: Vec<f64> = Vec::with_capacity(columns.len());
        for column in columns.chunks_exact(length) {
            /// Columns of which less is left are made up by those before.
            const DEPENDENT: f64 = 1e-7;
            let size = dot(column, column).sqrt();
            let mut column = column.to_vec();
            // Twice is enough for what rounding leaves of the first time.
            (0..2).for_each(|_| take_off(&basis, &mut column));
            let left = dot(&column, &column).sqrt();
            if left > DEPENDENT * size {
                basis.extend(column.iter().map(|value| value / left));
            }
        }
        let mut residuals = values.to_vec();
        (0..2).for_each(|_| take_off(&basis, &mut residuals));
        Self { residuals, basis }
    }

    pub(crate) fn samples(&self) -> usize {
        self.residuals.len()
    }

    /// Mean square of what is left, for each degree of freedom.
    pub(crate) fn power(&self) -> f64 {
        let parameters = self.basis.len() / self.residuals.len().max(1);
        let freedom = self.residuals.len().saturating_sub(parameters).max(1);
        dot(&self.residuals, &self.residuals) / freedom as f64
    }

    /// How much of each autocovariance, up to `longest` samples, is in the products of the
    /// residuals: `kept`.
    fn kept(&self, longest: usize) -> DMatrix<f64> {
        let length = self.residuals.len().max(1);
        let lags = longest + 1;
        let whole = |lag: usize| if lag == 0 { 1.0 } else { 2.0 };
        let mut kept = DMatrix::from_fn(lags, lags, |h, l| {
            if h == l { length.saturating_sub(h) as f64 } else { 0.0 }
        });
        let columns: Vec<&[f64]> = self.basis.chunks_exact(length).collect();
        let products: Vec<DMatrix<f64>> =
            (0..lags).map(|lag| products_with_shifted(&columns, lag)).collect();
        let twice = products_of_shifts(&columns, lags);
        for (h, a) in products.iter().enumerate() {
            for (l, b) in products.iter().enumerate().skip(h) {
                let taken = a.dot(b) - 2.0 * twice[(h, l)];
                kept[(h, l)] += whole(l) * taken;
                if h < l {
                    kept[(l, h)] += whole(h) * taken;
                }
            }
        }
        kept
    }
}

/// Autocovariances of the noise of which the `leftovers` are left, up to `longest` samples.
/// What is kept of them is known well enough from some of the windows.
pub(crate) fn autocovariances(leftovers: &[&Projection], longest: usize) -> Vec<f64> {
    const ENOUGH: usize = 16;
    let mut kept = DMatrix::zeros(longest + 1, longest + 1);
    let mut samples = 0;
    for leftover in leftovers.iter().step_by(leftovers.len().div_ceil(ENOUGH).max(1)) {
        kept += leftover.kept(longest);
        samples += leftover.samples();
    }
    let all: usize = leftovers.iter().map(|leftover| leftover.samples()).sum();
    let product = |lag: usize| {
        let of = |residuals: &[f64]| dot(residuals, residuals.get(lag..).unwrap_or_default());
        leftovers.iter().map(|leftover| of(&leftover.residuals)).sum::<f64>()
    };
    let measured =
        DVector::from_fn(longest + 1, |lag, _| product(lag) * samples as f64 / all.max(1) as f64);
    kept.lu().solve(&measured).map_or_else(Vec::new, |found| found.iter().copied().collect())
}

/// The products of every column with every other one shifted by `lag` samples to either side.
fn products_with_shifted(columns: &[&[f64]], lag: usize) -> DMatrix<f64> {
    let mut products = DMatrix::zeros(columns.len(), columns.len());
    let mut shifted = vec![0.0; columns.first().map_or(0, |column| column.len())];
    for (j, (column, mut slots)) in columns.iter().zip(products.column_iter_mut()).enumerate() {
        shift(column, lag, &mut shifted);
        let others = columns.get(j..).unwrap_or_default();
        let found = others.chunks(4).flat_map(|others| with_each(&shifted, others));
        slots.iter_mut().skip(j).zip(found).for_each(|(slot, product)| *slot = product);
    }
    products.fill_upper_triangle_with_lower_triangle();
    products
}

/// The products of every column shifted by one lag to either side with itself shifted by another,
/// summed over the columns, for fewer than so many `lags` and the first of two no larger.
///
/// Were there no ends, two shifts by `h` and `l` would be half of one by `l − h` and half of one by
/// `l + h`; what they would move past an end, and back, is taken off.
fn products_of_shifts(columns: &[&[f64]], lags: usize) -> DMatrix<f64> {
    let mut sums = DMatrix::zeros(lags, lags);
    for column in columns {
        let with_itself = |lag: usize| dot(column, column.get(lag..).unwrap_or_default());
        let with_itself: Vec<f64> = (0..2 * lags).map(with_itself).collect();
        let at = |lag: usize| with_itself.get(lag).copied().unwrap_or_default();
        for apart in 0..lags {
            let later = column.get(apart..).unwrap_or_default();
            let pairs = column.iter().zip(later);
            let last = column.iter().rev().skip(apart).zip(column.iter().rev());
            let ends = pairs.zip(last).map(|((a, b), (c, d))| a * b + c * d);
            let mut past = 0.0;
            let mut ends = ends.chain(std::iter::repeat(0.0));
            for h in 0..lags - apart {
                sums[(h, h + apart)] += 0.5 * (at(apart) + at(2 * h + apart)) - 0.25 * past;
                past += ends.next().unwrap_or_default();
            }
        }
    }
    sums
}

/// Takes off what the orthonormal `basis` explains.
fn take_off(basis: &[f64], values: &mut [f64]) {
    let columns: Vec<&[f64]> = basis.chunks_exact(values.len().max(1)).collect();
    for columns in columns.chunks(4) {
        let parts = with_each(values, columns);
        if let ([a, b, c, d], [p, q, r, s]) = (columns, parts) {
            let pairs = a.iter().zip(*b).zip(c.iter().zip(*d));
            for (value, ((a, b), (c, d))) in values.iter_mut().zip(pairs) {
                *value -= p * a + q * b + r * c + s * d;
            }
            continue;
        }
        for (column, part) in columns.iter().zip(parts) {
            values.iter_mut().zip(*column).for_each(|(value, by)| *value -= part * by);
        }
    }
}

/// The products of a column with each of four others; 0 where there are fewer.
fn with_each(column: &[f64], others: &[&[f64]]) -> [f64; 4] {
    if let &[a, b, c, d] = others {
        return dots(column, [a, b, c, d]);
    }
    let mut products = [0.0; 4];
    let slots = products.iter_mut().zip(others);
    slots.for_each(|(slot, other)| *slot = dot(column, other));
    products
}

/// Puts the mean of `column` shifted by `lag` samples to either side into `shifted`.
fn shift(column: &[f64], lag: usize, shifted: &mut [f64]) {
    let quiet = lag.min(shifted.len());
    let (first, later) = shifted.split_at_mut(quiet);
    first.fill(0.0);
    later.iter_mut().zip(column).for_each(|(slot, value)| *slot = 0.5 * value);
    let earlier = shifted.iter_mut().zip(column.get(quiet..).unwrap_or_default());
    earlier.for_each(|(slot, value)| *slot += 0.5 * value);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Line, parabola and cubic over `n` samples, which take much of slow noise.
    fn columns(n: i32) -> Vec<f64> {
        let power = |p: i32| (0..n).map(move |k| (f64::from(k) / f64::from(n)).powi(p));
        (0..4).flat_map(power).collect()
    }

    #[test]
    fn what_is_kept_is_the_mean_of_what_every_noise_leaves() {
        // The noise e = one of the unit vectors, whose sum has γ = (1, 0, …).
        let (n, longest) = (20_usize, 3);
        let columns = columns(20);
        let mut sums = vec![0.0; longest + 1];
        for k in 0..n {
            let mut unit = vec![0.0; n];
            unit[k] = 1.0;
            let left = Projection::of(&columns, &unit).residuals;
            (0..=longest).for_each(|lag| sums[lag] += dot(&left, &left[lag..]));
        }
        let kept = Projection::of(&columns, &vec![1.0; n]).kept(longest);
        for (lag, sum) in sums.iter().enumerate() {
            assert!((sum - kept[(lag, 0)]).abs() < 1e-9, "{lag}: {sum} {}", kept[(lag, 0)]);
        }
    }

    #[test]
    fn what_is_kept_is_the_trace_of_projected_shifts() {
        let (n, longest) = (11_usize, 3);
        let leftover = Projection::of(&columns(11), &[1.0; 11]);
        let basis = DMatrix::from_column_slice(n, leftover.basis.len() / n, &leftover.basis);
        let left = DMatrix::identity(n, n) - &basis * basis.transpose();
        let shift = |lag: usize| {
            DMatrix::from_fn(n, n, |i, j| if i.abs_diff(j) == lag { 0.5 } else { 0.0 })
        };
        let kept = leftover.kept(longest);
        for (h, l) in (0..=longest).flat_map(|h| (0..=longest).map(move |l| (h, l))) {
            let half = if h == 0 { DMatrix::identity(n, n) } else { shift(h) };
            let whole = if l == 0 { DMatrix::identity(n, n) } else { shift(l) * 2.0 };
            let trace = (&left * half * &left * whole).trace();
            assert!((kept[(h, l)] - trace).abs() < 1e-9, "{h} {l}: {} {trace}", kept[(h, l)]);
        }
    }

    #[test]
    fn short_windows_tell_the_memory_of_noise() {
        let mut state = 5_u32;
        let mut white = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1_u32 << 24) - 0.5
        };
        for memory in [0.0, 0.4] {
            let mut value = 0.0;
            let columns = columns(24);
            let leftovers: Vec<_> = (0..800)
                .map(|_| {
                    let window: Vec<f64> = (0..24)
                        .map(|_| {
                            value = memory * value + white();
                            value
                        })
                        .collect();
                    Projection::of(&columns, &window)
                })
                .collect();
            let found = autocovariances(&leftovers.iter().collect::<Vec<_>>(), 4);
            let power = 1.0 / 12.0 / (1.0 - memory * memory);
            assert!((found[0] / power - 1.0).abs() < 0.1, "{found:?}");
            assert!((found[1] / found[0] - memory).abs() < 0.06, "{found:?}");
        }
    }
}
