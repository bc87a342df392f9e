//! Do the steps of the input move the residual?
//!
//! The second of the two classical questions of residual analysis is asked of changes from
//! sample to sample, of the residual and of the input. In the levels each error is spread over
//! all that follows it; the change of an integrator's residual is the error of its speed at
//! that moment. An input in steps changes seldom and by chance, so the correlation at lag `l`
//! is how the speed errs `l` after a step, in the mean over all steps: a pulse between the true
//! delay and the model's, a decay where a lag is missing, a plateau where the gain is wrong.
//!
//! Changes of noise are correlated, and so may those of the input be. Where the two are
//! independent, the correlation at each lag has the variance `1/n Σ_k ρ_ee(k) ρ_uu(k)`
//! (Bartlett), which gives the band. The sum is taken with triangular weights, which keep
//! it positive, and is at least its own standard error.
//!
//! At high sample rates it is of means over blocks, so that the lags are as many.
//!
//! # References
//! T. Söderström and P. Stoica, "System Identification", 1989, chapter 11. L. Ljung, "System
//! Identification", 1999, chapter 16.

use std::ops::Range;

use serde::Serialize;

use super::lags::{BAND, CONFIDENCE, Lags, TrialSignals, autocovariance, means, products};
use crate::numerics::chi_square_tail;

/// Whether the changes of the input move the residual.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InputCorrelation {
    /// Part of the correlations of independent signals that lies within the band.
    pub confidence: f64,
    /// Seconds from one lag to the next.
    pub lag_step_s: f64,
    /// The lowest lag in seconds. At positive lags the residual follows the input.
    pub first_lag_s: f64,
    /// With the input as it acts in the model.
    pub acting: CrossCorrelation,
    /// With the input as it was measured, without its delay.
    pub raw: CrossCorrelation,
}

/// Correlations of the residual with one input, lag by lag.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CrossCorrelation {
    /// Part of the lags whose correlation is outside the band.
    pub share_outside: f64,
    /// The correlation that is farthest from zero.
    pub peak: f64,
    /// Its lag in seconds.
    pub peak_lag_s: f64,
    /// The probability of a peak as high at any of the lags when the two are independent,
    /// at most (Bonferroni).
    pub p_value: f64,
    /// Half the width of the band, about zero.
    pub band: f64,
    /// The correlations, from the lowest lag to the highest.
    pub correlation: Vec<f64>,
}

/// Correlates the changes of the residual with those of the input.
///
/// A change across the border of a window is not the model's and does not count. `None`
/// where the windows are too short, or one of the two never changes.
pub fn input_correlation(trials: &[TrialSignals<'_>], period_s: f64) -> Option<InputCorrelation> {
    let lags = Lags::new(period_s, trials.iter().map(|trial| trial.residual.len()).max()?)?;
    let residual = Changes::new(trials.iter().map(|t| t.residual_changes(lags.block)), lags)?;
    let with = |input: fn(&TrialSignals<'_>, usize) -> Vec<f64>| {
        let input = Changes::new(trials.iter().map(|trial| input(trial, lags.block)), lags)?;
        let pairs = trials.iter().flat_map(|trial| trial.whole_blocks(lags.block));
        let samples: usize = pairs.map(|blocks| blocks.len().saturating_sub(1)).sum();
        CrossCorrelation::of(&residual, &input, samples, lags)
    };
    Some(InputCorrelation {
        confidence: CONFIDENCE,
        lag_step_s: lags.step_s,
        first_lag_s: lags.seconds(0),
        acting: with(|trial, block| trial.input_changes(trial.acting, block))?,
        raw: with(|trial, block| trial.input_changes(trial.raw, block))?,
    })
}

impl TrialSignals<'_> {
    /// The blocks that lie in a window as a whole, window by window.
    fn whole_blocks(&self, block: usize) -> impl Iterator<Item = Range<usize>> + '_ {
        self.windows.iter().map(move |window| window.start.div_ceil(block)..window.end / block)
    }

    /// Changes of the residual from block to block, both of one window; zero elsewhere.
    fn residual_changes(&self, block: usize) -> Vec<f64> {
        // The first block of a window has no block before it that the model went on from.
        let inside = self.whole_blocks(block).map(|blocks| blocks.start + 1..blocks.end);
        kept(changes(means(self.residual, block)), inside)
    }

    /// Changes of `levels` that arrive in a window; zero elsewhere.
    fn input_changes(&self, levels: &[f64], block: usize) -> Vec<f64> {
        kept(changes(means(levels, block)), self.whole_blocks(block))
    }
}

/// Changes of a signal in every trial, and how they are correlated.
struct Changes {
    trials: Vec<Vec<f64>>,
    /// From lag 0 on.
    covariance: Vec<f64>,
    /// Root of the covariance at lag 0; above zero.
    size: f64,
}

impl Changes {
    /// `None` where nothing ever changes.
    fn new(trials: impl Iterator<Item = Vec<f64>>, lags: Lags) -> Option<Self> {
        let trials: Vec<_> = trials.collect();
        let covariance = autocovariance(&trials, lags.count);
        let size = covariance.first().map(|power| power.sqrt()).filter(|size| *size > 0.0)?;
        Some(Self { trials, covariance, size })
    }

    /// Autocorrelation from lag 1 on.
    fn correlation(&self) -> impl Iterator<Item = f64> + '_ {
        self.covariance.iter().skip(1).map(|covariance| covariance / (self.size * self.size))
    }
}

impl CrossCorrelation {
    fn of(residual: &Changes, input: &Changes, samples: usize, lags: Lags) -> Option<Self> {
        let (e, u) = (&residual.trials, &input.trials);
        let before = (1..=lags.count).rev().map(|lag| products(u, e, lag));
        let behind = (0..=lags.count).map(|lag| products(e, u, lag));
        let scale = residual.size * input.size;
        let correlation: Vec<f64> = before.chain(behind).map(|sum| sum / scale).collect();
        let deviation = deviation(residual, input, samples);
        let band = BAND * deviation;
        let outside = correlation.iter().filter(|r| r.abs() > band).count();
        let by_size = |a: &(usize, &f64), b: &(usize, &f64)| a.1.abs().total_cmp(&b.1.abs());
        let (index, &peak) = correlation.iter().enumerate().max_by(by_size)?;
        // r/σ is normal, its square χ² with one degree of freedom.
        let once = chi_square_tail((peak / deviation).powi(2), 1)?;
        Some(Self {
            share_outside: outside as f64 / correlation.len() as f64,
            peak,
            peak_lag_s: lags.seconds(index),
            // Bonferroni, over all lags.
            p_value: (once * correlation.len() as f64).min(1.0),
            band,
            correlation,
        })
    }
}

/// Standard deviation of the correlation of two independent signals at any one lag.
fn deviation(residual: &Changes, input: &Changes, samples: usize) -> f64 {
    // var = 1/n (1 + 2 Σ w ρ_ee ρ_uu), and the standard error of the sum with white residuals.
    let n = samples.max(1) as f64;
    let reach = residual.covariance.len() as f64;
    // Bartlett's triangular weights keep the sum positive.
    let weights = (1..).map(|lag: u32| 1.0 - f64::from(lag) / reach);
    let lags = weights.zip(residual.correlation().zip(input.correlation()));
    let (sum, squares) = lags.fold((1.0, 0.0), |(sum, squares), (weight, (e, u))| {
        (sum + 2.0 * weight * e * u, squares + (2.0 * weight * u).powi(2))
    });
    (sum.max((squares / n).sqrt()) / n).sqrt()
}

/// Each value minus the one before; zero for the first.
fn changes(mut values: Vec<f64>) -> Vec<f64> {
    let mut before = values.first().copied().unwrap_or_default();
    for value in &mut values {
        let now = *value;
        *value = now - before;
        before = now;
    }
    values
}

/// `values` within `spans`, which are in their order, zero elsewhere.
fn kept(mut values: Vec<f64>, spans: impl Iterator<Item = Range<usize>>) -> Vec<f64> {
    let (mut done, samples) = (0, values.len());
    for span in spans.filter(|span| span.start <= span.end && span.end <= samples) {
        values[done..span.start.max(done)].fill(0.0);
        done = span.end.max(done);
    }
    values[done..].fill(0.0);
    values
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::lags::testing::{PERIOD_S, rate, trial};
    use super::*;
    use crate::numerics::testing::noise;

    /// Random levels, each held for 20 to 59 samples.
    fn steps(seed: u64, count: usize) -> Vec<f64> {
        let levels = noise(1000 + seed, 0.0, count);
        let mut held = levels.iter().zip((7 * seed..).step_by(17)).flat_map(|(level, k)| {
            std::iter::repeat_n(*level, 20 + usize::try_from(k % 40).unwrap())
        });
        (0..count).map(|_| held.next().unwrap()).collect()
    }

    #[test]
    fn an_independent_input_is_seldom_seen_in_the_residual() {
        for rho in [0.0, 0.9] {
            let found = |seed| {
                let (residual, input) = (noise(seed, rho, 1500), steps(seed, 1500));
                input_correlation(&[trial(&residual, &input)], PERIOD_S).unwrap().acting
            };
            let found: Vec<_> = (0..200).map(found).collect();
            let alarms = found.iter().filter(|found| found.p_value < 0.01).count();
            assert!(alarms <= 6, "{alarms} of 200 at {rho}");
            let outside = found.iter().map(|found| found.share_outside).sum::<f64>() / 200.0;
            println!("{rho}: {alarms} of 200; {outside:.4} of the lags");
            assert!((0.003..0.02).contains(&outside), "{outside} at {rho}");
        }
    }

    #[test]
    fn neither_is_one_that_is_as_smooth_as_a_wave() {
        let waves = |k: u32| (f64::from(k) / 9.0).sin() + (f64::from(k) / 23.0).sin();
        let input: Vec<f64> = (0..1500).map(waves).collect();
        let rate = rate(|seed| {
            let residual = noise(seed, 0.5, 1500);
            let found = input_correlation(&[trial(&residual, &input)], PERIOD_S);
            found.unwrap().acting.p_value < 0.01
        });
        assert!(rate <= 0.03, "{rate}");
    }

    #[test]
    fn what_never_changes_is_not_correlated() {
        let (values, still) = (noise(1, 0.0, 100), vec![1.0; 100]);
        assert_eq!(input_correlation(&[trial(&values, &still)], PERIOD_S), None);
        assert_eq!(input_correlation(&[trial(&still, &values)], PERIOD_S), None);
    }

    /// The changes of `values` from block to block, straight from what they are.
    fn changes_of(values: &[f64], block: usize, at: usize) -> f64 {
        let mean = |b: usize| (0..block).map(|k| values[b * block + k]).sum::<f64>() / block as f64;
        if at == 0 { 0.0 } else { mean(at) - mean(at - 1) }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn correlations_are_what_their_sums_say(
            seed in 0_u64..1000, count in 90_usize..200, border in 20_usize..60,
            fast in any::<bool>(),
        ) {
            let period_s = if fast { 0.005 } else { PERIOD_S };
            let (residual, raw) = (noise(seed, 0.4, count), steps(seed, count));
            let acting = noise(seed + 1, 0.0, count);
            let windows = vec![0..border, border..count - 10];
            let signals =
                TrialSignals { residual: &residual, windows, acting: &acting, raw: &raw };
            let found = input_correlation(&[signals], period_s);
            let block = if fast { 2 } else { 1 };
            let blocks = count / block;
            let in_window = |b: usize, from: usize| {
                (from * block >= border || (b + 1) * block <= border)
                    && (b + 1) * block <= count - 10
            };
            let change = |b: usize| {
                let counts = b > 0 && in_window(b, b - 1);
                if counts { changes_of(&residual, block, b) } else { 0.0 }
            };
            let Some(found) = found else {
                // An input that holds one level in all windows is not correlated.
                let moves = |b: usize| in_window(b, b) && changes_of(&raw, block, b).abs() > 0.0;
                prop_assert!(!(0..blocks).any(moves));
                return Ok(());
            };
            for (input, found) in [(&acting, &found.acting), (&raw, &found.raw)] {
                let step = |b: usize| if in_window(b, b) { changes_of(input, block, b) } else { 0.0 };
                let square = |f: &dyn Fn(usize) -> f64| (0..blocks).map(|b| f(b) * f(b)).sum::<f64>();
                let size = (square(&change) * square(&step)).sqrt();
                let most = found.correlation.len() / 2;
                for (index, r) in found.correlation.iter().enumerate() {
                    let pairs = (0..blocks).filter_map(|b| Some((b, (b + most).checked_sub(index)?)));
                    let pairs = pairs.filter(|(_, early)| *early < blocks);
                    let sum: f64 = pairs.map(|(b, early)| change(b) * step(early)).sum();
                    prop_assert!((r - sum / size).abs() < 1e-9, "{} {} {}", index, r, sum / size);
                }
            }
        }
    }
}
