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

use crate::statistics::{dot, dots};

/// What a regression left of the output of a window.
#[derive(Clone, Debug)]
pub(super) struct Leftover {
    residuals: Vec<f64>,
    /// Orthonormal columns, one behind the other.
    basis: Vec<f64>,
}

impl Leftover {
    /// What the `columns`, one behind the other, leave of `values`.
    pub(super) fn of(columns: &[f64], values: &[f64]) -> Self {
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

    pub(super) fn samples(&self) -> usize {
        self.residuals.len()
    }

    /// Mean square of what is left, for each degree of freedom.
    pub(super) fn power(&self) -> f64 {
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
        let shifted = |column: &&[f64]| {
            let by = |lag| shifted(column, lag);
            (0..lags).map(by).collect::<Vec<_>>()
        };
        let shifted: Vec<Vec<Vec<f64>>> = columns.iter().map(shifted).collect();
        let products: Vec<DMatrix<f64>> = (0..lags)
            .map(|lag| {
                let mut products = DMatrix::from_fn(columns.len(), columns.len(), |i, j| {
                    let there = shifted.get(j).filter(|_| i >= j).and_then(|all| all.get(lag));
                    let here = columns.get(i).copied().unwrap_or_default();
                    there.map_or(0.0, |there| dot(here, there))
                });
                products.fill_upper_triangle_with_lower_triangle();
                products
            })
            .collect();
        // What two shifts have in common hangs on no order.
        for (h, a) in products.iter().enumerate() {
            let once = products_of_shifts(&shifted, h);
            for (l, b) in products.iter().enumerate().skip(h) {
                let once = once.get(l - h).copied().unwrap_or_default();
                let taken = a.dot(b) - 2.0 * once;
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
pub(super) fn autocovariances(leftovers: &[&Leftover], longest: usize) -> Vec<f64> {
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

/// The products of every column shifted by `lag` samples with itself shifted by so many and by
/// more, summed over the columns.
fn products_of_shifts(shifted: &[Vec<Vec<f64>>], lag: usize) -> Vec<f64> {
    let mut sums = vec![0.0; shifted.first().map_or(0, |all| all.len() - lag)];
    for all in shifted {
        let Some([one, ..]) = all.get(lag..) else { continue };
        let others = all.get(lag..).unwrap_or_default().chunks(4);
        for (others, sums) in others.zip(sums.chunks_mut(4)) {
            if let [a, b, c, d] = others {
                let products = dots(one, [a, b, c, d]);
                sums.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
            } else {
                sums.iter_mut().zip(others).for_each(|(sum, other)| *sum += dot(one, other));
            }
        }
    }
    sums
}

/// Takes off what the orthonormal `basis` explains.
fn take_off(basis: &[f64], values: &mut [f64]) {
    for column in basis.chunks_exact(values.len().max(1)) {
        let part = dot(column, values);
        values.iter_mut().zip(column).for_each(|(value, by)| *value -= part * by);
    }
}

/// The mean of `column` shifted by `lag` samples to either side.
fn shifted(column: &[f64], lag: usize) -> Vec<f64> {
    let mut sum = vec![0.0; column.len()];
    let later = sum.iter_mut().skip(lag).zip(column);
    later.for_each(|(slot, value)| *slot += 0.5 * value);
    let earlier = sum.iter_mut().zip(column.iter().skip(lag));
    earlier.for_each(|(slot, value)| *slot += 0.5 * value);
    sum
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
            let left = Leftover::of(&columns, &unit).residuals;
            (0..=longest).for_each(|lag| sums[lag] += dot(&left, &left[lag..]));
        }
        let kept = Leftover::of(&columns, &vec![1.0; n]).kept(longest);
        for (lag, sum) in sums.iter().enumerate() {
            assert!((sum - kept[(lag, 0)]).abs() < 1e-9, "{lag}: {sum} {}", kept[(lag, 0)]);
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
                    Leftover::of(&columns, &window)
                })
                .collect();
            let found = autocovariances(&leftovers.iter().collect::<Vec<_>>(), 4);
            let power = 1.0 / 12.0 / (1.0 - memory * memory);
            assert!((found[0] / power - 1.0).abs() < 0.1, "{found:?}");
            assert!((found[1] / found[0] - memory).abs() < 0.06, "{found:?}");
        }
    }
}
