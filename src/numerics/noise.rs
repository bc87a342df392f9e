//! The noise of the output, and what takes its memory away.

use super::projection::{self, Projection};
use super::{Autoregression, autocovariances, dot};

/// Longest memory of the noise that is looked for, samples.
const LONGEST_MEMORY: usize = 8;

/// Largest sum of the coefficients: noise that wanders is no noise about a line.
const LARGEST_SUM: f64 = 0.98;

/// Correlation of neighbours below which noise counts as white.
const LEAST: f64 = 0.08;

/// Values whose memory is taken away at a time: a processor adds a few at once.
const LANES: usize = 8;

/// Noise as an autoregression, `e_k = Σ a_i e_(k−i) + w_k` with white `w`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NoiseModel {
    coefficients: Vec<f64>,
    /// `1 − Σ a_i`: what whitening makes of 1.
    pub(crate) level: f64,
    /// `Σ i·a_i`: whitening makes `level·k + shift` of `k`.
    pub(crate) shift: f64,
}

impl NoiseModel {
    pub(crate) fn white() -> Self {
        Self::new(Vec::new())
    }

    fn new(mut coefficients: Vec<f64>) -> Self {
        let sum: f64 = coefficients.iter().sum();
        if sum > LARGEST_SUM {
            for a in &mut coefficients {
                *a *= LARGEST_SUM / sum;
            }
        }
        let level = 1.0 - coefficients.iter().sum::<f64>();
        let shift = coefficients.iter().zip(1..).map(|(a, i)| f64::from(i) * a).sum();
        Self { coefficients, level, shift }
    }

    /// The noise that the residuals of many fits with so many `parameters` each show.
    ///
    /// Each parameter takes the power of slow noise from the residuals, `S/n` from every
    /// autocovariance, with `S` their sum over all lags and `n` the length of a fit; it is
    /// put back. Little memory is taken for none.
    pub(crate) fn of(residuals: &[Vec<f64>], parameters: usize) -> Self {
        /// Times that `S` is estimated from what it corrects.
        const ROUNDS: usize = 3;
        let power = |values: &Vec<f64>| dot(values, values) / values.len().max(1) as f64;
        let residuals = usual_ones(residuals, power);
        let samples: usize = residuals.iter().map(|values| values.len()).sum();
        let length = samples as f64 / residuals.len().max(1) as f64;
        let measured = autocovariances(&residuals, LONGEST_MEMORY.min(samples / 10));
        let mut found = Autoregression::default();
        for _ in 0..ROUNDS {
            let noise = Self::new(found.coefficients.clone());
            let power = measured.first().copied().unwrap_or(0.0) * (1.0 - found.explained);
            let taken = parameters as f64 / length.max(1.0) * power / noise.level.powi(2);
            let whole: Vec<f64> = measured.iter().map(|value| value + taken).collect();
            found = Autoregression::of(&whole, samples);
        }
        if found.explained > LEAST * LEAST { Self::new(found.coefficients) } else { Self::white() }
    }

    /// The noise that regressions of short windows leave.
    pub(crate) fn left_by(leftovers: &[Projection]) -> Self {
        let usual = usual_ones(leftovers, Projection::power);
        let samples: usize = usual.iter().map(|leftover| leftover.samples()).sum();
        let longest = LONGEST_MEMORY.min(samples / 10);
        let found = Autoregression::of(&projection::autocovariances(&usual, longest), samples);
        if found.explained > LEAST * LEAST { Self::new(found.coefficients) } else { Self::white() }
    }

    /// Samples that it remembers.
    pub(crate) fn order(&self) -> usize {
        self.coefficients.len()
    }

    /// `|1 − Σ a_i e^(−iωi)|²`: what whitening makes of power at `omega` radians per sample.
    pub(crate) fn memory_gain(&self, omega: f64) -> f64 {
        let terms = self.coefficients.iter().zip(1..);
        let part = |(real, imaginary): (f64, f64), (a, i): (&f64, i32)| {
            let (sine, cosine) = (omega * f64::from(i)).sin_cos();
            (real - a * cosine, imaginary + a * sine)
        };
        let (real, imaginary) = terms.fold((1.0, 0.0), part);
        real * real + imaginary * imaginary
    }

    /// What whitening makes, `d = 1 … order` samples behind the break, of a level and of a
    /// ramp that begin there: `(w_d, h_d)`.
    pub(crate) fn onset(&self) -> Vec<(f64, f64)> {
        let (mut level, mut shift) = (1.0, 0.0);
        let mut onset = Vec::with_capacity(self.order());
        for (a, d) in self.coefficients.iter().zip(1..) {
            let d = f64::from(d);
            onset.push((level, d * level + shift));
            level -= a;
            shift += d * a;
        }
        onset
    }

    /// Turns whitened `values` into those whose products with any column are the products of
    /// `values` with the whitened column.
    pub(crate) fn pull(&self, values: &mut [f64]) {
        let order = self.order();
        if order == 0 {
            return;
        }
        // Forwards: no value is used after it was changed.
        let mut from = 0;
        while let Some(block) = values.get(from..from + LANES + order) {
            let mut sums = [0.0; LANES];
            for (a, later) in self.coefficients.iter().zip(block.windows(LANES).skip(1)) {
                sums.iter_mut().zip(later).for_each(|(sum, y)| *sum += a * y);
            }
            let block = values.get_mut(from..).unwrap_or_default();
            block.iter_mut().zip(sums).for_each(|(y, sum)| *y -= sum);
            from += LANES;
        }
        for k in from..values.len() {
            let (now, later) = values.split_at_mut(k + 1);
            let expected: f64 = self.coefficients.iter().zip(later).map(|(a, y)| a * *y).sum();
            if let Some(now) = now.last_mut() {
                *now -= expected;
            }
        }
    }

    /// Takes the memory out of `values` in place; the first ones become 0.
    pub(crate) fn whiten(&self, values: &mut [f64]) {
        let order = self.order();
        if order == 0 {
            return;
        }
        // Backwards: no value is used after it was changed.
        let mut end = values.len();
        while let Some(from) = end.checked_sub(LANES + order) {
            let block = values.get_mut(from..end).unwrap_or_default();
            let mut sums = [0.0; LANES];
            let past = block.windows(LANES).rev().skip(1);
            for (a, past) in self.coefficients.iter().zip(past) {
                sums.iter_mut().zip(past).for_each(|(sum, y)| *sum += a * y);
            }
            block.iter_mut().skip(order).zip(sums).for_each(|(y, sum)| *y -= sum);
            end -= LANES;
        }
        for k in (order..end).rev() {
            let (past, now) = values.split_at_mut(k);
            let recent = past.iter().rev();
            let expected: f64 = self.coefficients.iter().zip(recent).map(|(a, y)| a * y).sum();
            if let Some(now) = now.first_mut() {
                *now -= expected;
            }
        }
        values.iter_mut().take(order).for_each(|value| *value = 0.0);
    }
}

/// Those whose `power` is not far larger than that of most: what is left in others is no
/// noise.
fn usual_ones<T>(all: &[T], power: impl Fn(&T) -> f64) -> Vec<&T> {
    /// Times the median of the mean squares.
    const STRANGE: f64 = 2.5;
    let powers: Vec<f64> = all.iter().map(power).collect();
    let mut sorted = powers.clone();
    sorted.sort_by(f64::total_cmp);
    let most = sorted.get(sorted.len() / 2).map_or(0.0, |median| STRANGE * median);
    all.iter().zip(powers).filter(|(_, power)| *power <= most).map(|(one, _)| one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whitening_makes_of_a_line_and_of_an_onset_what_is_promised() {
        let noise = NoiseModel::new(vec![0.5, -0.2]);
        let mut line: Vec<f64> = (0..30).map(f64::from).collect();
        noise.whiten(&mut line);
        for (k, value) in line.iter().enumerate().skip(2) {
            let expected = noise.level * k as f64 + noise.shift;
            assert!((value - expected).abs() < 1e-12, "{k}: {value} {expected}");
        }
        let mut ramp: Vec<f64> = (0..9).map(|k| f64::from((k - 4).max(0))).collect();
        noise.whiten(&mut ramp);
        for (d, (_, h)) in noise.onset().into_iter().enumerate() {
            assert!((ramp[5 + d] - h).abs() < 1e-12);
        }
    }

    #[test]
    fn products_with_what_is_pulled_are_those_with_a_whitened_column() {
        let noise = NoiseModel::new(vec![0.5, -0.2]);
        let mut column: Vec<f64> = (0..29).map(|k| f64::from(k * k)).collect();
        let mut values: Vec<f64> = (0..29).map(|k| f64::from(k % 4)).collect();
        noise.whiten(&mut values);
        let mut pulled = values.clone();
        noise.pull(&mut pulled);
        let with_column = dot(&pulled, &column);
        noise.whiten(&mut column);
        assert!((with_column - dot(&values, &column)).abs() < 1e-12);
    }

    #[test]
    fn little_memory_is_none() {
        let mut state = 3_u32;
        let white = |_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1_u32 << 24) - 0.5
        };
        let signal: Vec<f64> = (0..400).map(white).collect();
        assert_eq!(NoiseModel::of(&[signal], 2).order(), 0);
    }
}
