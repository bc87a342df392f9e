//! Is the residual white, and do the steps of the input move it?
//!
//! The two classical questions of residual analysis, each asked of what can answer it:
//!
//! - *Whiteness* is of the residual itself, as it is plotted: measured minus simulated. It
//!   is white when nothing but white measurement noise is left. An integrator keeps every
//!   error it made, so a small error of the model correlates it over seconds; so does
//!   coloured noise. How long it is correlated tells the two apart.
//! - *Correlation with the input* is of changes from sample to sample, of the residual and
//!   of the input. In the levels each error is spread over all that follows it; the change
//!   of an integrator's residual is the error of its speed at that moment. An input in
//!   steps changes seldom and by chance, so at lag `l` stands how the speed errs `l` after
//!   a step, in the mean over all steps: a pulse between the true delay and the model's, a
//!   decay where a lag is missing, a plateau where the gain is wrong.
//!
//! Changes of noise are correlated, and so may those of the input be. Where the two are
//! independent, the correlation at each lag has the variance `1/n Σ_k ρ_ee(k) ρ_uu(k)`
//! (Bartlett), which gives the band. The sum is taken with triangular weights, which keep
//! it positive, and is at least its own standard error.
//!
//! At high sample rates both are of means over blocks, so that the lags are as many.
//!
//! # References
//! T. Söderström and P. Stoica, "System Identification", 1989, chapter 11. L. Ljung, "System
//! Identification", 1999, chapter 16. G. M. Ljung and G. E. P. Box, "On a measure of lack of
//! fit in time series models", Biometrika 65 (1978), 297-303.

use std::ops::Range;

use crate::numerics::{chi_square_tail, dot};

/// Part of the correlations that chance keeps within the bands.
pub const CONFIDENCE: f64 = 0.99;

/// Distance from zero, in standard deviations, within which a normal variable is with
/// probability [`CONFIDENCE`].
const BAND: f64 = 2.575_829_303_548_901;

/// Longest lag in seconds: transients of a joint have ended by then.
const LONGEST_S: f64 = 2.0;

/// Most lags on one side.
const MOST: usize = 200;

/// Fewest lags on one side, however slow the sampling.
const FEWEST: usize = 20;

/// One trial: what a model leaves of it, and what drove it.
#[derive(Clone, Debug)]
pub struct TrialSignals<'a> {
    /// Measured minus simulated, a value per sample.
    pub residual: &'a [f64],
    /// Spans of samples that count, in order, each simulated without a restart.
    pub windows: Vec<Range<usize>>,
    /// The input as it acts in the model, a value per sample.
    pub acting: &'a [f64],
    /// The input as it was measured, a value per sample.
    pub raw: &'a [f64],
}

/// Whether the residual is white noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Whiteness {
    /// Ljung and Box's statistic of all lags together.
    pub statistic: f64,
    /// The probability of so much or more when the residual is white; there are as many
    /// degrees of freedom as lags.
    pub p_value: f64,
    /// Seconds from lag 0 on over which all correlations are outside the band.
    pub correlated_s: f64,
    /// Part of the correlations of white noise that lies within the band.
    pub confidence: f64,
    /// Half the width of the band, about zero.
    pub band: f64,
    /// Seconds from one lag to the next.
    pub lag_step_s: f64,
    /// Autocorrelation of the residual, the first at a lag of one step.
    pub correlation: Vec<f64>,
}

/// Whether the changes of the input move the residual.
#[derive(Clone, Debug, PartialEq)]
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
#[derive(Clone, Debug, PartialEq)]
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

/// The lags that are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lags {
    /// Samples from one lag to the next, which are also the samples of a mean.
    block: usize,
    step_s: f64,
    /// Lags on one side.
    count: usize,
}

impl Lags {
    /// At most a quarter of the `longest` stretch of samples; `None` where that is none.
    fn new(period_s: f64, longest: usize) -> Option<Self> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
        let rounded = |value: f64| value.round() as usize;
        let block = rounded(LONGEST_S / (MOST as f64 * period_s)).max(1);
        let step_s = block as f64 * period_s;
        let wanted = rounded(LONGEST_S / step_s).clamp(FEWEST, MOST);
        let count = wanted.min(longest / block / 4);
        (count > 0).then_some(Self { block, step_s, count })
    }

    /// The lag at a place in a list that starts at the lowest one.
    fn seconds(self, place: usize) -> f64 {
        (place as f64 - self.count as f64) * self.step_s
    }
}

/// Tests whether the residual is white, window by window, each about its own mean.
///
/// `None` where the windows are too short, or nothing is left at all.
pub fn whiteness(trials: &[TrialSignals<'_>], period_s: f64) -> Option<Whiteness> {
    let of_trial = |trial: &TrialSignals<'_>| {
        let cut = |window: &Range<usize>| trial.residual.get(window.clone()).map(<[f64]>::to_vec);
        trial.windows.iter().filter_map(cut).collect::<Vec<_>>()
    };
    let windows: Vec<Vec<f64>> = trials.iter().flat_map(of_trial).collect();
    let lags = Lags::new(period_s, windows.iter().map(Vec::len).max()?)?;
    let windows = windows.iter().map(|window| centred(means(window, lags.block)));
    let windows: Vec<Vec<f64>> = windows.filter(|window| !window.is_empty()).collect();
    let samples: usize = windows.iter().map(Vec::len).sum();
    let correlation = centred_autocorrelation(&windows, lags.count)?;
    let n = samples as f64;
    let portion = |(r, lag): (&f64, usize)| {
        let pairs: usize = windows.iter().map(|window| window.len().saturating_sub(lag)).sum();
        n * (n + 2.0) * r * r / pairs as f64
    };
    let statistic: f64 = correlation.iter().zip(1..).map(portion).sum();
    let band = BAND / n.sqrt();
    let outside = correlation.iter().take_while(|r| r.abs() > band).count();
    Some(Whiteness {
        statistic,
        p_value: chi_square_tail(statistic, lags.count)?,
        correlated_s: outside as f64 * lags.step_s,
        confidence: CONFIDENCE,
        band,
        lag_step_s: lags.step_s,
        correlation,
    })
}

/// Autocorrelation at lags from 1 to `lags` of windows whose means were taken off; what
/// that takes off the correlation of white noise is put back.
fn centred_autocorrelation(windows: &[Vec<f64>], lags: usize) -> Option<Vec<f64>> {
    let covariance = autocovariance(windows, lags);
    let (&power, covariance) = covariance.split_first().filter(|(power, _)| **power > 0.0)?;
    let samples: usize = windows.iter().map(Vec::len).sum();
    let freedom = samples.checked_sub(windows.len()).filter(|freedom| *freedom > 0)? as f64;
    let lost = |lag: usize| -> f64 {
        windows.iter().map(|w| (1.0 - lag as f64 / w.len() as f64).max(0.0)).sum()
    };
    let lags = covariance.iter().zip(1..);
    Some(lags.map(|(product, lag)| product / power + lost(lag) / freedom).collect())
}

/// Correlates the changes of the residual with those of the input.
///
/// A change across the border of a window is none of the model's and is left out. `None`
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
        let inside = self.whole_blocks(block).map(|blocks| blocks.start + 1..blocks.end);
        kept(&changes(&means(self.residual, block)), inside)
    }

    /// Changes of `levels` that arrive in a window; zero elsewhere.
    fn input_changes(&self, levels: &[f64], block: usize) -> Vec<f64> {
        kept(&changes(&means(levels, block)), self.whole_blocks(block))
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
        let (place, &peak) = correlation.iter().enumerate().max_by(by_size)?;
        let once = chi_square_tail((peak / deviation).powi(2), 1)?;
        Some(Self {
            share_outside: outside as f64 / correlation.len() as f64,
            peak,
            peak_lag_s: lags.seconds(place),
            p_value: (once * correlation.len() as f64).min(1.0),
            band,
            correlation,
        })
    }
}

/// Standard deviation of the correlation of two independent signals at any one lag.
fn deviation(residual: &Changes, input: &Changes, samples: usize) -> f64 {
    let n = samples.max(1) as f64;
    let reach = residual.covariance.len() as f64;
    let weights = (1..).map(|lag: u32| 1.0 - f64::from(lag) / reach);
    let lags = weights.zip(residual.correlation().zip(input.correlation()));
    let (sum, squares) = lags.fold((1.0, 0.0), |(sum, squares), (weight, (e, u))| {
        (sum + 2.0 * weight * e * u, squares + (2.0 * weight * u).powi(2))
    });
    (sum.max((squares / n).sqrt()) / n).sqrt()
}

/// Means of whole blocks of `size` values.
fn means(values: &[f64], size: usize) -> Vec<f64> {
    values.chunks_exact(size).map(|block| block.iter().sum::<f64>() / size as f64).collect()
}

fn centred(mut values: Vec<f64>) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    for value in &mut values {
        *value -= mean;
    }
    values
}

/// Each value minus the one before; zero for the first.
fn changes(values: &[f64]) -> Vec<f64> {
    let before = values.first().into_iter().chain(values);
    values.iter().zip(before).map(|(value, before)| value - before).collect()
}

/// `values` within `spans`, zero elsewhere.
fn kept(values: &[f64], spans: impl Iterator<Item = Range<usize>>) -> Vec<f64> {
    let mut kept = vec![0.0; values.len()];
    for span in spans {
        if let (Some(to), Some(from)) = (kept.get_mut(span.clone()), values.get(span)) {
            to.copy_from_slice(from);
        }
    }
    kept
}

/// Sums of products from lag 0 to `lags`, over all `series`.
fn autocovariance(series: &[Vec<f64>], lags: usize) -> Vec<f64> {
    (0..=lags).map(|lag| products(series, series, lag)).collect()
}

/// The sum of `late_(k + lag) · early_k` over all pairs of series.
fn products(late: &[Vec<f64>], early: &[Vec<f64>], lag: usize) -> f64 {
    let pair =
        |(late, early): (&Vec<f64>, &Vec<f64>)| dot(late.get(lag..).unwrap_or_default(), early);
    late.iter().zip(early).map(pair).sum()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::numerics::testing::noise;

    /// Slow sampling, so that the longest lag is few samples.
    const PERIOD_S: f64 = 0.05;

    /// Random levels, each held for 20 to 59 samples.
    fn steps(seed: u64, count: usize) -> Vec<f64> {
        let levels = noise(1000 + seed, 0.0, count);
        let mut held = levels.iter().zip((7 * seed..).step_by(17)).flat_map(|(level, k)| {
            std::iter::repeat_n(*level, 20 + usize::try_from(k % 40).unwrap())
        });
        (0..count).map(|_| held.next().unwrap()).collect()
    }

    fn trial<'a>(residual: &'a [f64], input: &'a [f64]) -> TrialSignals<'a> {
        let windows = std::iter::once(0..residual.len()).collect();
        TrialSignals { residual, windows, acting: input, raw: input }
    }

    fn whiteness_of(residual: &[f64]) -> Whiteness {
        whiteness(&[trial(residual, residual)], PERIOD_S).unwrap()
    }

    /// Part of `0..200` that `is_found`.
    fn rate(is_found: impl Fn(u64) -> bool) -> f64 {
        (0..200).filter(|seed| is_found(*seed)).count() as f64 / 200.0
    }

    #[test]
    fn white_noise_is_seldom_called_correlated() {
        let rate = rate(|seed| whiteness_of(&noise(seed, 0.0, 1000)).p_value < 0.01);
        assert!(rate <= 0.03, "{rate}");
    }

    #[test]
    fn short_windows_do_not_make_white_noise_look_correlated() {
        let rate = rate(|seed| {
            let residual = noise(seed, 0.0, 2000);
            let windows = (0..20).map(|i| 100 * i..100 * (i + 1)).collect();
            let trial = TrialSignals { windows, ..trial(&residual, &residual) };
            whiteness(&[trial], PERIOD_S).unwrap().p_value < 0.01
        });
        assert!(rate <= 0.03, "{rate}");
    }

    #[test]
    fn noise_with_a_memory_is_correlated_for_as_long() {
        assert!(rate(|seed| whiteness_of(&noise(seed, 0.3, 1000)).p_value < 0.01) > 0.98);
        // Means over ten neighbours have nothing in common from lag 10 on.
        let white = noise(1, 0.0, 20_000);
        let found =
            whiteness_of(&white.windows(10).map(|ten| ten.iter().sum()).collect::<Vec<_>>());
        let lags = found.correlated_s / PERIOD_S;
        assert!(found.p_value < 1e-9 && (lags - 9.0).abs() < 3.0, "{lags}");
    }

    #[test]
    fn an_input_that_has_no_part_in_it_is_seldom_seen_in_the_residual() {
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
    fn a_wrong_delay_shows_between_the_two_delays() {
        let raw = steps(3, 4000);
        let delayed = |samples: usize| {
            let before = std::iter::repeat_n(raw[0], samples);
            before.chain(raw.iter().copied()).take(raw.len()).collect::<Vec<_>>()
        };
        let angle = |acting: &[f64]| {
            let mut sum = 0.0;
            let mut before = |u: &f64| {
                sum += u;
                sum - u
            };
            acting.iter().map(&mut before).collect::<Vec<_>>()
        };
        // True is 9, the model says 6: at lags 6 + 1 to 9 it is ahead of the joint.
        let (truth, acting) = (delayed(9), delayed(6));
        let pairs = angle(&truth).into_iter().zip(angle(&acting)).zip(noise(4, 0.0, 4000));
        let residual: Vec<f64> = pairs.map(|((y, model), e)| y - model + 0.3 * e).collect();
        let signals = TrialSignals { acting: &acting, raw: &raw, ..trial(&residual, &raw) };
        let found = input_correlation(&[signals], PERIOD_S).unwrap();
        let lags_below = |found: &CrossCorrelation| -> Vec<usize> {
            let below = |(_, r): &(usize, &f64)| **r < -2.0 * found.band;
            let lags = found.correlation.iter().enumerate().filter(below);
            lags.map(|(place, _)| place - found.correlation.len() / 2).collect()
        };
        assert_eq!(lags_below(&found.acting), [1, 2, 3]);
        assert_eq!(lags_below(&found.raw), [7, 8, 9]);
        assert!(found.acting.p_value < 1e-9);
        assert!(
            (1..=3).any(|lag| (found.acting.peak_lag_s / PERIOD_S - f64::from(lag)).abs() < 0.1)
        );
    }

    #[test]
    fn what_cannot_be_correlated_is_not() {
        let (values, still) = (noise(1, 0.0, 100), vec![1.0; 100]);
        assert_eq!(whiteness(&[], PERIOD_S), None);
        assert_eq!(whiteness(&[trial(&still, &still)], PERIOD_S), None);
        assert_eq!(whiteness(&[trial(&values[..3], &still[..3])], PERIOD_S), None);
        assert_eq!(input_correlation(&[trial(&values, &still)], PERIOD_S), None);
        assert_eq!(input_correlation(&[trial(&still, &values)], PERIOD_S), None);
    }

    #[test]
    fn fast_sampling_has_as_many_lags() {
        let lags = |period_s| Lags::new(period_s, 1_000_000).unwrap();
        assert_eq!((lags(0.01).count, lags(0.01).block), (200, 1));
        assert_eq!((lags(0.001).count, lags(0.001).block), (200, 10));
        assert_eq!((lags(1.0).count, lags(1.0).block), (20, 1));
        assert_eq!(Lags::new(0.01, 100).unwrap().count, 25);
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
            let found = input_correlation(&[signals], period_s).unwrap();
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
            for (input, found) in [(&acting, &found.acting), (&raw, &found.raw)] {
                let step = |b: usize| if in_window(b, b) { changes_of(input, block, b) } else { 0.0 };
                let square = |f: &dyn Fn(usize) -> f64| (0..blocks).map(|b| f(b) * f(b)).sum::<f64>();
                let size = (square(&change) * square(&step)).sqrt();
                let most = found.correlation.len() / 2;
                for (place, r) in found.correlation.iter().enumerate() {
                    let pairs = (0..blocks).filter_map(|b| Some((b, (b + most).checked_sub(place)?)));
                    let pairs = pairs.filter(|(_, early)| *early < blocks);
                    let sum: f64 = pairs.map(|(b, early)| change(b) * step(early)).sum();
                    prop_assert!((r - sum / size).abs() < 1e-9, "{} {} {}", place, r, sum / size);
                }
            }
        }

        #[test]
        fn autocorrelations_are_what_their_sums_say(seed in 0_u64..1000, count in 60_usize..200) {
            let values = noise(seed, 0.4, count);
            let found = whiteness_of(&values);
            let n = count as f64;
            let mean = values.iter().sum::<f64>() / n;
            let power: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
            let mut statistic = 0.0;
            for (r, lag) in found.correlation.iter().zip(1..) {
                let pairs = values.iter().zip(values.iter().skip(lag));
                let sum: f64 = pairs.map(|(a, b)| (a - mean) * (b - mean)).sum();
                let expected = sum / power + (1.0 - lag as f64 / n) / (n - 1.0);
                prop_assert!((r - expected).abs() < 1e-12);
                statistic += n * (n + 2.0) * expected * expected / (n - lag as f64);
            }
            prop_assert!((found.statistic / statistic - 1.0).abs() < 1e-9);
        }
    }
}
