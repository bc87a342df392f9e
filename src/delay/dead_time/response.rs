//! How an output follows its input after a dead time: two lags, perhaps an integrator.
//!
//! In samples, with the dead time `d` and the time constants `a ≥ b`,
//!
//! ```text
//! output = e^(−ds) / ((1 + as)(1 + bs))  · f(input)         the output follows the input
//! output = e^(−ds) / ((1 + as)(1 + bs)s) · f(input)         its speed does
//! ```
//!
//! The input is held between its samples, as a controller's is, or moves smoothly from one to the
//! next, as what was measured does: it is a cubic spline through them, `f(u)(t) = Σ c_k β(t − k)` with
//! B-splines `β`. Either way the change of the output is an exact recursion,
//!
//! ```text
//! (1 − e^(−1/a) q)(1 − e^(−1/b) q) Δy_k = Σ_m n_m c_(k−m+2)      q y_k = y_(k−1)
//! f(u_k) = (c_(k−1) + 4 c_k + c_(k+1))/6
//! ```
//!
//! with a few numerators `n_m` from `⌊d⌋` on, which vary smoothly with `d`. With `R` the
//! response of the output to a step, or to the cube `t³/6` of which B-splines are made, they are
//! differences of `R(m − d)`, one for the step, and one for each integral.
//!
//! # References
//! M. Unser, A. Aldroubi and M. Eden, "B-spline signal processing: part I, theory", IEEE Transactions
//! on Signal Processing 41 (1993).

/// What follows an input, and what the input does between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Structure {
    /// The speed follows the input, else the output does.
    pub(super) integrates: bool,
    /// The input moves smoothly between its samples, else it is held.
    pub(super) is_smooth: bool,
}

impl Structure {
    pub(super) const ALL: [Self; 4] = [
        Self { integrates: true, is_smooth: false },
        Self { integrates: true, is_smooth: true },
        Self { integrates: false, is_smooth: false },
        Self { integrates: false, is_smooth: true },
    ];

    /// The degree of the polynomials between samples.
    fn degree(self) -> i32 {
        if self.is_smooth { 3 } else { 0 }
    }

    /// How often a step is integrated on its way to the sample that is compared.
    fn integrals(self) -> i32 {
        i32::from(self.integrates) + self.degree()
    }
}

/// Two time constants, in samples; the first is not shorter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lags {
    pub(super) slow: f64,
    pub(super) fast: f64,
}

/// The shortest time constant, samples: no lag, as far as samples show.
pub(super) const NO_LAG: f64 = 1e-3;

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

/// Samples by which the coefficients that numerators multiply are ahead: a spline depends on those of two
/// samples later.
pub(super) const AHEAD: usize = 2;

/// Numerators that can be other than 0: three of two poles, one for a part of a sample, and one for each
/// difference.
pub(super) const NUMERATORS: usize = 9;

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
        // Differences: of the step, of each integral, and from the output to its change.
        let differences = (structure.degree() + 2).unsigned_abs() as usize;
        let count = differences + 3;
        let mut response: Vec<f64> = (0..count + differences)
            .map(|m| step_response(m as f64 - differences as f64 + first - delay, integrals, lags))
            .collect();
        for _ in 0..differences {
            for index in (1..response.len()).rev() {
                response[index] -= response[index - 1];
            }
        }
        let [a, b] = lags.poles();
        let before =
            |m: usize, back: usize| if m < back { 0.0 } else { response[differences + m - back] };
        // (1 − a q)(1 − b q) R, differenced: what remains is finitely long.
        let numerator = |m: usize| before(m, 0) - (a + b) * before(m, 1) + a * b * before(m, 2);
        let mut values = [0.0; NUMERATORS];
        // Coefficients of the spline, or a sample of the input in them, two later.
        let (shares, later): (&[f64], usize) =
            if structure.is_smooth { (&[1.0], 0) } else { (&[1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0], 1) };
        for m in 0..count {
            let value = numerator(m);
            shares.iter().zip(m + later..).for_each(|(share, at)| values[at] += share * value);
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative")]
        Self { first: first as usize, values }
    }
}

/// The response of `1/((1 + as)(1 + bs))` to a step, integrated so often, after `time` samples: by
/// partial fractions, `a/(1 + as)` less `b/(1 + bs)` over `a − b`.
fn step_response(time: f64, integrals: i32, lags: Lags) -> f64 {
    if time <= 0.0 {
        return 0.0;
    }
    let Lags { slow: a, fast: b } = lags;
    let of = |constant: f64| constant * response_of_one(time, integrals, constant);
    (of(a) - of(b)) / (a - b)
}

/// The response of `1/(1 + as)` to a step, integrated `n` times: `t^(n+1)/a · φ_(n+1)(−t/a)`, with
/// `φ_0(z) = e^z` and `φ_(k+1)(z) = (φ_k(z) − 1/k!)/z`, by its series where that would cancel.
fn response_of_one(time: f64, integrals: i32, a: f64) -> f64 {
    /// Terms of the series for `z` up to 1, to the last digit.
    const TERMS: i32 = 18;
    let z = time / a;
    if z < 1.0 {
        // t^(n+1)/(n+1)!.
        let power: f64 = (1..=integrals + 1).map(|k| time / f64::from(k)).product();
        let mut term = power / a;
        let mut sum = term;
        for j in 1..TERMS {
            term *= -z / f64::from(integrals + 1 + j);
            sum += term;
        }
        return sum;
    }
    let (mut phi, mut factorial) = ((-z).exp(), 1.0);
    for k in 0..=integrals {
        phi = (factorial - phi) / z;
        factorial /= f64::from(k + 1);
    }
    time.powi(integrals + 1) / a * phi
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
            let at = |back: usize| {
                let index = (k + AHEAD).checked_sub(back);
                index.map_or(0.0, |i| input[i.min(input.len() - 1)])
            };
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
            if time < -3.0 {
                return 0.0;
            }
            let (k, part) = (time.floor(), time - time.floor());
            let at = |k: f64| if k < 0.0 { 0.0 } else { input[floor_to_index(k).min(39)] };
            if !structure.is_smooth {
                return (at(k - 1.0) + 4.0 * at(k) + at(k + 1.0)) / 6.0;
            }
            // The four B-splines that are not 0 there.
            let cubes = [(1.0 - part).powi(3), part.powi(3)].map(|cube| cube / 6.0);
            let inner = |x: f64| 2.0 / 3.0 - x * x * (1.0 - x / 2.0);
            cubes[0] * at(k - 1.0)
                + inner(part) * at(k)
                + inner(1.0 - part) * at(k + 1.0)
                + cubes[1] * at(k + 2.0)
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
