//! Regression lines, and a fit that grows by one value at constant cost.

/// A line `y = intercept + slope · k` over the sample number `k` of the trial.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Line {
    /// Output units per sample.
    pub slope: f64,
    /// Output units, at sample 0.
    pub intercept: f64,
}

impl Line {
    /// Its value at sample `k`.
    pub fn at(&self, k: f64) -> f64 {
        self.intercept + self.slope * k
    }
}

/// Least-squares line through equally spaced values, grown one value at a time.
///
/// For `n` values `y_1 … y_n` at `k = 1 … n`, with `S₀ = Σ y_k` and `S₁ = Σ k·y_k`, the
/// line's value one step ahead is `ŷ = (6·S₁ − (2n+4)·S₀) / (n·(n−1))`, and the squared
/// error grows by
///
/// `SSE_(n+1) = SSE_n + (y_(n+1) − ŷ)² · n·(n−1) / ((n+1)·(n+2))`
///
/// (recursive least squares with the equal spacing put in). Every term is positive, so
/// nothing cancels, unlike in `Σy² − …`: the error of a fit that is exact to 1e-8 of the
/// output's range keeps its digits. Values are best centred before.
///
/// # References
/// R. L. Plackett, "Some theorems in least squares", Biometrika 37 (1950), 149-157.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RunningLine {
    n: f64,
    s0: f64,
    s1: f64,
    sse: f64,
}

impl RunningLine {
    /// Adds the next value.
    pub(crate) fn push(&mut self, y: f64) {
        let n = self.n;
        let after = n + 1.0;
        if n >= 2.0 {
            let spread = n * (n - 1.0);
            // The prediction error times `spread`: one division instead of two.
            let error = y * spread - (6.0 * self.s1 - (2.0 * n + 4.0) * self.s0);
            self.sse += error * error / (spread * after * (n + 2.0));
        }
        self.n = after;
        self.s0 += y;
        self.s1 += after * y;
    }

    /// Sum of squared errors of the line through the values so far.
    pub(crate) fn sse(&self) -> f64 {
        self.sse
    }

    /// Slope per step. One value has none: its line is level.
    pub(crate) fn slope(&self) -> f64 {
        let n = self.n;
        if n < 2.0 {
            0.0
        } else {
            (12.0 * self.s1 - 6.0 * (n + 1.0) * self.s0) / (n * (n * n - 1.0))
        }
    }

    /// Value of the line in the middle of the values, at `k = (n+1)/2`: their mean.
    pub(crate) fn mean(&self) -> f64 {
        self.s0 / self.n
    }
}

/// Means, variances and covariance of pairs, updated one by one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PairSums {
    count: f64,
    mean: (f64, f64),
    /// Sums of squares and of products about the means.
    xx: f64,
    yy: f64,
    xy: f64,
}

impl PairSums {
    pub(crate) fn of(pairs: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut sums = Self::default();
        pairs.into_iter().for_each(|(x, y)| sums.push(x, y));
        sums
    }

    /// Welford's update; pairs that are not numbers are left out.
    pub(crate) fn push(&mut self, x: f64, y: f64) {
        if !(x.is_finite() && y.is_finite()) {
            return;
        }
        self.count += 1.0;
        let (dx, dy) = (x - self.mean.0, y - self.mean.1);
        self.mean.0 += dx / self.count;
        self.mean.1 += dy / self.count;
        self.xx += dx * (x - self.mean.0);
        self.yy += dy * (y - self.mean.1);
        self.xy += dx * (y - self.mean.1);
    }

    pub(crate) fn r_squared(&self) -> f64 {
        let scale = self.xx * self.yy;
        if scale > 0.0 { self.xy * self.xy / scale } else { 0.0 }
    }

    /// Slope and intercept of the regression of the second on the first.
    pub(crate) fn line(&self) -> (f64, f64) {
        let slope = if self.xx > 0.0 { self.xy / self.xx } else { 0.0 };
        (slope, self.mean.1 - slope * self.mean.0)
    }

    /// Squared error of that regression.
    pub(crate) fn sse(&self) -> f64 {
        (self.yy - self.xy * self.xy / self.xx.max(f64::MIN_POSITIVE)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line_through(values: &[f64]) -> RunningLine {
        let mut line = RunningLine::default();
        for &y in values {
            line.push(y);
        }
        line
    }

    #[test]
    fn three_points_by_hand() {
        // y = 1, 2, 4: slope 1.5, mean 7/3, residuals 1/6, -1/3, 1/6.
        let line = line_through(&[1.0, 2.0, 4.0]);
        assert!((line.slope() - 1.5).abs() < 1e-14);
        assert!((line.mean() - 7.0 / 3.0).abs() < 1e-14);
        assert!((line.sse() - 1.0 / 6.0).abs() < 1e-14);
    }

    #[test]
    fn one_or_two_points_have_no_error() {
        assert!(line_through(&[3.0]).sse().abs() < 1e-300);
        assert!(line_through(&[3.0]).slope().abs() < 1e-300);
        let two = line_through(&[3.0, 5.0]);
        assert!(two.sse().abs() < 1e-300);
        assert!((two.slope() - 2.0).abs() < 1e-14);
    }

    #[test]
    fn small_errors_on_a_steep_line_keep_their_digits() {
        // ±1e-7 in alternation on a line that climbs to 1e4: Σy² would drown it.
        let error = |k: i32| if k % 2 == 0 { 1e-7 } else { -1e-7 };
        let values: Vec<f64> = (1..=1000).map(|k| 10.0 * f64::from(k) + error(k)).collect();
        let sse = line_through(&values).sse();
        assert!((sse / (1000.0 * 1e-14) - 1.0).abs() < 1e-3, "{sse:e}");
    }
}
