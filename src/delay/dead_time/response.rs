//! How an output follows its input behind a dead time: two lags, perhaps an integrator.
//!
//! In samples, with the dead time `d` and the time constants `a ≥ b`,
//!
//! ```text
//! output = e^(−ds) / ((1 + as)(1 + bs))  · f(input)         the output follows the input
//! output = e^(−ds) / ((1 + as)(1 + bs)s) · f(input)         its speed does
//! ```
//!
//! The input is held between its samples, as a controller's is, or goes in a line from one to
//! the next, as what was measured does. Either way the change of the output is an exact
//! recursion,
//!
//! ```text
//! (1 − e^(−1/a) q)(1 − e^(−1/b) q) Δy_k = Σ_m n_m f(u_(k−m))      q y_k = y_(k−1)
//! ```
//!
//! with a few numerators `n_m` from `⌊d⌋` on, which vary smoothly with `d`. With `R` the
//! response of the output to a step, a ramp where the input goes in lines, they are the
//! differences of `R(m − d)`, one for the step, and one for each integral.

/// What follows an input, and what the input does between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Structure {
    /// The speed follows the input, else the output does.
    pub(super) integrates: bool,
    /// The input goes in lines between its samples, else it is held.
    pub(super) is_linear: bool,
}

impl Structure {
    pub(super) const ALL: [Self; 4] = [
        Self { integrates: true, is_linear: false },
        Self { integrates: true, is_linear: true },
        Self { integrates: false, is_linear: false },
        Self { integrates: false, is_linear: true },
    ];

    /// How often a step is integrated on its way to the sample that is compared.
    fn integrals(self) -> i32 {
        i32::from(self.integrates) + i32::from(self.is_linear)
    }
}

/// Two time constants, in samples; the first is not shorter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lags {
    pub(super) slow: f64,
    pub(super) fast: f64,
}

/// The shortest time constant, samples: no lag, as far as samples show.
pub(super) const NO_LAG: f64 = 0.02;

impl Lags {
    /// The two constants, in order and apart: equal ones would divide by nothing.
    pub(super) fn new(a: f64, b: f64) -> Self {
        /// The least relative difference, which shows in no response.
        const APART: f64 = 1e-3;
        let (slow, fast) = (a.max(b), a.min(b).max(NO_LAG));
        Self { slow: slow.max(fast * (1.0 + APART)), fast }
    }

    /// `e^(−1/a)` and `e^(−1/b)`.
    pub(super) fn poles(self) -> [f64; 2] {
        [self.slow, self.fast].map(|constant| (-constant.recip()).exp())
    }

    /// The lag of a slow motion.
    pub(super) fn mean(self) -> f64 {
        self.slow + self.fast
    }
}

/// Numerators that can be other than 0: three of two poles, one for a part of a sample, and
/// one for each difference.
pub(super) const NUMERATORS: usize = 7;

/// The numerators of a delay.
#[derive(Clone, Copy, Debug)]
pub(super) struct Numerators {
    /// Samples that the first one is late.
    pub(super) first: usize,
    pub(super) values: [f64; NUMERATORS],
}

impl Numerators {
    /// Of a dead time of `delay` samples.
    pub(super) fn of(structure: Structure, delay: f64, lags: Lags) -> Self {
        let integrals = structure.integrals();
        let first = delay.floor().max(0.0);
        // A line to a sample begins at the sample before.
        let ahead = if structure.is_linear { 1.0 } else { 0.0 };
        // Differences: of the step, of each integral, and from the output to its change.
        let differences = 2 + i32::from(structure.is_linear);
        let from = -f64::from(differences);
        let mut response: Vec<f64> = (0..NUMERATORS + 3)
            .map(|m| step_response(from + m as f64 + first - delay + ahead, integrals, lags))
            .collect();
        for _ in 0..differences {
            for index in (1..response.len()).rev() {
                response[index] -= response[index - 1];
            }
        }
        let [a, b] = lags.poles();
        let start = differences.unsigned_abs() as usize;
        let at = |index: usize, back: usize| {
            (start + index).checked_sub(back).and_then(|i| response.get(i)).copied().unwrap_or(0.0)
        };
        let numerator = |m: usize| {
            let before = |back: usize| if m < back { 0.0 } else { at(m, back) };
            // (1 − a q)(1 − b q) R, differenced: what remains is finitely long.
            at(m, 0) - (a + b) * before(1) + a * b * before(2)
        };
        let mut values = [0.0; NUMERATORS];
        for (m, value) in values.iter_mut().enumerate() {
            *value = numerator(m);
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative")]
        Self { first: first as usize, values }
    }
}

/// The response of `1/((1 + as)(1 + bs))` to a step, integrated so often, after `time` samples.
///
/// By partial fractions of `1/(s^(n+1)(1 + as)(1 + bs))`: a polynomial whose coefficients are
/// those of the series of `1/((1 + as)(1 + bs))`, and an exponential for each pole.
fn step_response(time: f64, integrals: i32, lags: Lags) -> f64 {
    if time <= 0.0 {
        return 0.0;
    }
    let Lags { slow: a, fast: b } = lags;
    // 1/((1 + as)(1 + bs)) = 1 − (a + b)·s + (a² + ab + b²)·s² − …
    let series = [1.0, -(a + b), a * a + a * b + b * b];
    let mut power = 1.0;
    let mut sum = 0.0;
    for degree in 0..=integrals {
        let coefficient = series.get((integrals - degree).unsigned_abs() as usize);
        sum += coefficient.copied().unwrap_or(0.0) * power;
        power *= time / f64::from(degree + 1);
    }
    let sign = if integrals % 2 == 0 { -1.0 } else { 1.0 };
    // The residue at s = −1/own.
    let pole = |own: f64, other: f64| own.powi(integrals + 1) / (own - other) * (-time / own).exp();
    sum + sign * (pole(a, b) + pole(b, a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::floor_to_index;

    /// The changes of the output to `input`, by the recursion.
    fn changes(structure: Structure, delay: f64, lags: Lags, input: &[f64]) -> Vec<f64> {
        let taps = Numerators::of(structure, delay, lags);
        let [a, b] = lags.poles();
        let mut out: Vec<f64> = Vec::new();
        for k in 0..input.len() {
            let at = |back: usize| k.checked_sub(back).map_or(0.0, |i| input[i]);
            let driven: f64 =
                taps.values.iter().zip(taps.first..).map(|(n, back)| n * at(back)).sum();
            let past = |back: usize| k.checked_sub(back).map_or(0.0, |i| out[i]);
            out.push(driven + (a + b) * past(1) - a * b * past(2));
        }
        out
    }

    /// The changes of the output by fine steps of Euler's method.
    fn by_steps(structure: Structure, delay: f64, lags: Lags, input: &[f64]) -> Vec<f64> {
        const FINE: usize = 4000;
        let level = |time: f64| {
            if time < -1.0 {
                return 0.0;
            }
            let (k, part) = (time.floor(), time - time.floor());
            let at = |k: f64| if k < 0.0 { 0.0 } else { input[floor_to_index(k)] };
            if structure.is_linear { at(k) + part * (at(k + 1.0) - at(k)) } else { at(k) }
        };
        let (mut x, mut speed, mut angle) = (0.0, 0.0, 0.0);
        let mut out = vec![0.0];
        let value = |speed: f64, angle: f64| if structure.integrates { angle } else { speed };
        for k in 0..input.len() - 1 {
            let before = value(speed, angle);
            for fine in 0..FINE {
                let time = k as f64 + (fine as f64 + 0.5) / FINE as f64 - delay;
                x += (level(time) - x) / lags.slow / FINE as f64;
                speed += (x - speed) / lags.fast / FINE as f64;
                angle += speed / FINE as f64;
            }
            out.push(value(speed, angle) - before);
        }
        out
    }

    #[test]
    fn the_recursion_is_what_fine_steps_give() {
        let input: Vec<f64> =
            (0..40).map(|k| f64::from(k) * 0.3).map(|t| t.sin() + (t * 2.3).cos() - 1.0).collect();
        for structure in Structure::ALL {
            for (delay, slow, fast) in [(0.0, 3.0, 0.5), (2.3, 1.5, 1.0), (4.9, 20.0, 0.3)] {
                let lags = Lags::new(slow, fast);
                let found = changes(structure, delay, lags, &input);
                let fine = by_steps(structure, delay, lags, &input);
                for (k, (found, fine)) in found.iter().zip(&fine).enumerate() {
                    assert!(
                        (found - fine).abs() < 3e-3,
                        "{structure:?} {delay} {k} {found} {fine}"
                    );
                }
            }
        }
    }
}
