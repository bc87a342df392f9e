//! Projections, and what they take of the memory of noise.
//!
//! A regression on columns with the orthonormal basis `Q` makes of noise `e` with
//! autocovariances `γ` the residual `r = (1 − QQᵀ)·e`, so that
//!
//! ```text
//! E Σ r_k·r_(k+h) = Σ_l kept_hl·γ_l        kept_hl = tr (1 − QQᵀ) S_h (1 − QQᵀ) T_l
//! ```
//!
//! with `S_h` half, and `T_l` the whole of what shifts by as many samples to both sides.
//! Solved for `γ`, short windows show the noise without bias, as long ones do.
//!
//! The basis is that of Gram and Schmidt, each column projected twice. Householder's QR with
//! column pivoting gives the same to rounding, and yet on two measured logs with short windows
//! the noise estimated so chose another lag: `tests/compare_builds.py` shows it.
//!
//! # References
//! B. N. Parlett, "The Symmetric Eigenvalue Problem" (1980), section 6.9 ("twice is enough").

use nalgebra::{DMatrix, DVector};

use super::moments::{dot, dots};
use super::rank::EXACT;

/// An orthonormal basis of what columns span.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    /// Samples of a column.
    length: usize,
    /// One column behind the other.
    columns: Vec<f64>,
}

impl Basis {
    /// Of `columns` of `length` samples each, one behind the other. A column whose distance
    /// from the span of those before it is not above `tolerance` of its own length is left out.
    pub(crate) fn of(columns: &[f64], length: usize, tolerance: f64) -> Self {
        let mut basis = Self { length, columns: Vec::with_capacity(columns.len()) };
        for column in columns.chunks_exact(length.max(1)) {
            let size = dot(column, column).sqrt();
            let distant = basis.residual(column);
            // q = (1 − QQᵀ) a / |(1 − QQᵀ) a|.
            let distance = dot(&distant, &distant).sqrt();
            if distance > tolerance * size {
                basis.columns.extend(distant.iter().map(|value| value / distance));
            }
        }
        basis
    }

    /// `(1 − QQᵀ)·values`: the residual of their regression on the columns.
    pub(crate) fn residual(&self, values: &[f64]) -> Vec<f64> {
        let mut residual = values.to_vec();
        // Twice is enough for what rounding leaves of the first time.
        (0..2).for_each(|_| self.subtract(&mut residual));
        residual
    }

    /// Number of its columns.
    fn rank(&self) -> usize {
        self.columns.len() / self.length.max(1)
    }

    fn columns(&self) -> Vec<&[f64]> {
        self.columns.chunks_exact(self.length.max(1)).collect()
    }

    /// Subtracts `QQᵀ·values`, four columns at a time.
    fn subtract(&self, values: &mut [f64]) {
        for columns in self.columns().chunks(4) {
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
}

/// The regression of a window's output on columns.
#[derive(Clone, Debug)]
pub(crate) struct Projection {
    residuals: Vec<f64>,
    basis: Basis,
}

impl Projection {
    /// Of `values` on the `columns`, one behind the other.
    pub(crate) fn of(columns: &[f64], values: &[f64]) -> Self {
        let basis = Basis::of(columns, values.len(), EXACT);
        Self { residuals: basis.residual(values), basis }
    }

    /// `(1 − QQᵀ)·values`.
    pub(crate) fn into_residuals(self) -> Vec<f64> {
        self.residuals
    }

    pub(crate) fn samples(&self) -> usize {
        self.residuals.len()
    }

    /// Mean square of the residual for each degree of freedom.
    pub(crate) fn power(&self) -> f64 {
        let freedom = self.samples().saturating_sub(self.basis.rank()).max(1);
        dot(&self.residuals, &self.residuals) / freedom as f64
    }

    /// How much of each autocovariance, up to `longest` samples, is in the products of the
    /// residuals: `kept`.
    fn kept(&self, longest: usize) -> DMatrix<f64> {
        let lags = longest + 1;
        let whole = |lag: usize| if lag == 0 { 1.0 } else { 2.0 };
        let mut kept = DMatrix::from_fn(lags, lags, |h, l| {
            if h == l { self.samples().saturating_sub(h) as f64 } else { 0.0 }
        });
        // tr (1 − QQᵀ) S_h (1 − QQᵀ) T_l = tr S_h T_l − 2 tr QᵀS_h T_l Q + tr QᵀS_h Q QᵀT_l Q.
        let columns = self.basis.columns();
        let products: Vec<DMatrix<f64>> =
            (0..lags).map(|lag| products_with_shifted(&columns, lag)).collect();
        let twice = products_of_shifts(&columns, lags);
        for (h, l) in (0..lags).flat_map(|h| (h..lags).map(move |l| (h, l))) {
            let taken = products[h].dot(&products[l]) - 2.0 * twice[(h, l)];
            kept[(h, l)] += whole(l) * taken;
            if h < l {
                kept[(l, h)] += whole(h) * taken;
            }
        }
        kept
    }
}

/// Autocovariances of the noise in the `projections`, up to `longest` samples. What is kept of
/// them is known well enough from some of the windows.
pub(crate) fn autocovariances(projections: &[&Projection], longest: usize) -> Vec<f64> {
    const ENOUGH: usize = 16;
    let mut kept = DMatrix::zeros(longest + 1, longest + 1);
    let mut samples = 0;
    for projection in projections.iter().step_by(projections.len().div_ceil(ENOUGH).max(1)) {
        // Windows of one joint are about as long: an even selection has their mean.
        kept += projection.kept(longest);
        samples += projection.samples();
    }
    let all: usize = projections.iter().map(|projection| projection.samples()).sum();
    let product = |lag: usize| -> f64 {
        projections.iter().map(|projection| lagged(&projection.residuals, lag)).sum()
    };
    let measured =
        DVector::from_fn(longest + 1, |lag, _| product(lag) * samples as f64 / all.max(1) as f64);
    // Σ_l kept_hl γ_l = E Σ r_k r_(k+h), solved for γ.
    kept.lu().solve(&measured).map_or_else(Vec::new, |found| found.iter().copied().collect())
}

/// `Σ v_k v_(k+lag)`; 0 for a lag beyond the values.
fn lagged(values: &[f64], lag: usize) -> f64 {
    values.get(lag..).map_or(0.0, |later| dot(values, later))
}

/// The products of every column with every other one shifted by `lag` samples to either side.
fn products_with_shifted(columns: &[&[f64]], lag: usize) -> DMatrix<f64> {
    let mut products = DMatrix::zeros(columns.len(), columns.len());
    let mut shifted = vec![0.0; columns.first().map_or(0, |column| column.len())];
    for (j, column) in columns.iter().enumerate() {
        shift(column, lag, &mut shifted);
        let found = columns[j..].chunks(4).flat_map(|others| with_each(&shifted, others));
        for (i, product) in (j..columns.len()).zip(found) {
            products[(i, j)] = product;
        }
    }
    products.fill_upper_triangle_with_lower_triangle();
    products
}

/// The products of a column with each of up to four others; 0 where there are fewer.
fn with_each(column: &[f64], others: &[&[f64]]) -> [f64; 4] {
    if let &[a, b, c, d] = others {
        return dots(column, [a, b, c, d]);
    }
    let mut products = [0.0; 4];
    for (slot, other) in products.iter_mut().zip(others) {
        *slot = dot(column, other);
    }
    products
}

/// Puts the mean of `column` shifted by `lag` samples to either side into `shifted`.
fn shift(column: &[f64], lag: usize, shifted: &mut [f64]) {
    let lag = lag.min(shifted.len());
    let (first, later) = shifted.split_at_mut(lag);
    first.fill(0.0);
    later.iter_mut().zip(column).for_each(|(slot, value)| *slot = 0.5 * value);
    shifted.iter_mut().zip(&column[lag..]).for_each(|(slot, value)| *slot += 0.5 * value);
}

/// The products of every column shifted by one lag to either side with itself shifted by another,
/// summed over the columns, for fewer than so many `lags` and the first of two no larger.
///
/// Were there no ends, two shifts by `h` and `l` would be half of one by `l − h` and half of one by
/// `l + h`; what they would move past an end, and back, is subtracted.
fn products_of_shifts(columns: &[&[f64]], lags: usize) -> DMatrix<f64> {
    let mut sums = DMatrix::zeros(lags, lags);
    for column in columns {
        let rows = column.len();
        let with_itself: Vec<f64> = (0..2 * lags).map(|lag| lagged(column, lag)).collect();
        for apart in 0..lags {
            let mut past = 0.0;
            for h in 0..lags - apart {
                let whole = with_itself[apart] + with_itself[2 * h + apart];
                sums[(h, h + apart)] += 0.5 * whole - 0.25 * past;
                // The sample this far from either end, and the one `apart` further in.
                if h + apart < rows {
                    let last = rows - 1 - h;
                    past += column[h] * column[h + apart] + column[last - apart] * column[last];
                }
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::super::testing::uniform;
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
            (0..=longest).for_each(|lag| sums[lag] += lagged(&left, lag));
        }
        let kept = Projection::of(&columns, &vec![1.0; n]).kept(longest);
        for (lag, sum) in sums.iter().enumerate() {
            assert!((sum - kept[(lag, 0)]).abs() < 1e-9, "{lag}: {sum} {}", kept[(lag, 0)]);
        }
    }

    #[test]
    fn what_is_kept_is_the_trace_of_projected_shifts() {
        let (n, longest) = (11_usize, 3);
        let projection = Projection::of(&columns(11), &[1.0; 11]);
        let basis = &projection.basis;
        let basis = DMatrix::from_column_slice(n, basis.rank(), &basis.columns);
        let left = DMatrix::identity(n, n) - &basis * basis.transpose();
        let shift = |lag: usize| {
            DMatrix::from_fn(n, n, |i, j| if i.abs_diff(j) == lag { 0.5 } else { 0.0 })
        };
        let kept = projection.kept(longest);
        for (h, l) in (0..=longest).flat_map(|h| (0..=longest).map(move |l| (h, l))) {
            let half = if h == 0 { DMatrix::identity(n, n) } else { shift(h) };
            let whole = if l == 0 { DMatrix::identity(n, n) } else { shift(l) * 2.0 };
            let trace = (&left * half * &left * whole).trace();
            assert!((kept[(h, l)] - trace).abs() < 1e-9, "{h} {l}: {} {trace}", kept[(h, l)]);
        }
    }

    #[test]
    fn short_windows_tell_the_memory_of_noise() {
        let mut white = uniform(5);
        for memory in [0.0, 0.4] {
            let mut value = 0.0;
            let columns = columns(24);
            let projections: Vec<_> = (0..800)
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
            let found = autocovariances(&projections.iter().collect::<Vec<_>>(), 4);
            let power = 1.0 / 12.0 / (1.0 - memory * memory);
            assert!((found[0] / power - 1.0).abs() < 0.1, "{found:?}");
            assert!((found[1] / found[0] - memory).abs() < 0.06, "{found:?}");
        }
    }
}
