//! From the trials of a joint to its dead time.

use std::ops::Range;

use super::curve::Curve;
use super::excitation::one_frequency;
use super::feedback::feedback;
use super::profile::Profile;
use super::record::{Samples, Whitened, averaged, whitening};
use super::response::NUMERATORS;
use super::result::{Bounds, DeadTime, ErrorPoint, Feedback, Finding, Unknown};
use super::search::{Fitted, grid, least, profiles, with_one_lag};
use super::uncertainty::{Assessed, PARTS};
use super::windows::{Estimated, Known, same_in_all};
use crate::delay::settings::Settings;
use crate::experiment::Trial;
use crate::numerics::{autocovariances, student_quantile};
use crate::units::ceil_to_index;

/// Longest dead time that is looked for unasked, seconds: hydraulic joints have up to half of it.
const LONGEST_S: f64 = 1.0;

/// Fewest and most samples of the longest dead time.
const LONGEST: Range<usize> = 20..200;

/// Samples of a trial for each sample of the longest dead time.
const PER_DELAY: usize = 8;

/// Longest memory of the noise, samples: white noise of a sensor on a joint that drifts has a
/// long one, once it is differenced.
const MEMORY: usize = 30;

/// Rows that are enough to find lags; windows use all.
const ENOUGH: usize = 10_000;

/// Rows of a part of the record, of which every n-th is taken where there are more than enough.
const CHUNK: usize = 1_000;

/// Fewest rows.
const FEWEST: usize = 100;

/// Longest lag, samples; a longer one is an integrator.
const LONGEST_LAG: f64 = 200.0;

/// Samples of all trials that share a period.
struct Record {
    samples: Vec<(usize, Samples)>,
    longest: usize,
    period_s: f64,
}

impl Record {
    fn of(trials: &[Trial], settings: &Settings) -> Option<Self> {
        let period = trials.iter().max_by_key(|trial| trial.len())?.period();
        let alike = || trials.iter().enumerate().filter(move |(_, trial)| trial.period() == period);
        let curve =
            Curve::of(alike().map(|(_, trial)| trial.input()).collect::<Vec<_>>().into_iter())?;
        let samples: Vec<(usize, Samples)> =
            alike().map(|(number, trial)| (number, Samples::of(trial, &curve))).collect();
        let most = samples.iter().map(|(_, samples)| samples.output.len()).max()?;
        let averaged = averaged(period.seconds());
        let period_s = period.seconds() * averaged as f64;
        let asked = settings.at(period).max_delay.map(|samples| samples.div_ceil(averaged));
        let usual = || ceil_to_index(LONGEST_S / period_s).clamp(LONGEST.start, LONGEST.end);
        let longest = asked.unwrap_or_else(usual).min(most / PER_DELAY).max(2);
        Some(Self { samples, longest, period_s })
    }

    fn inputs(&self) -> Vec<&[f64]> {
        self.samples.iter().map(|(_, samples)| samples.input.as_slice()).collect()
    }

    /// The rows of each trial that no dead time reaches beyond, `enough` of them in all.
    fn rows(&self, enough: usize) -> Vec<Vec<Range<usize>>> {
        // No row's input or noise reaches back before the first sample.
        let skipped = (self.longest + NUMERATORS + 1).max(MEMORY + 2);
        let all = self.samples.iter().map(|(_, samples)| skipped..samples.output.len());
        let all: Vec<Range<usize>> = all.collect();
        let total: usize = all.iter().map(ExactSizeIterator::len).sum();
        let every = total.div_ceil(enough).max(1);
        let mut chunk = 0;
        let taken = |rows: &Range<usize>| {
            let chunks =
                rows.clone().step_by(CHUNK).map(|start| start..rows.end.min(start + CHUNK));
            let taken = chunks.filter(|_| {
                chunk += 1;
                (chunk - 1) % every == 0
            });
            taken.filter(|rows| !rows.is_empty()).collect()
        };
        all.iter().map(taken).collect()
    }

    fn whitened(&self, filter: &[f64], rows: &[Vec<Range<usize>>]) -> Vec<Whitened> {
        let trials = self.samples.iter().zip(rows).filter(|(_, rows)| !rows.is_empty());
        trials.map(|((_, samples), rows)| Whitened::of(samples, filter, rows)).collect()
    }
}

/// The dead time of a joint whose input moves all the time, and that in windows of the record.
///
/// The structure is a static curve, two lags, the dead time and, where that explains more, an
/// integrator, with noise that is an autoregression. See `docs/methods.md`.
///
/// # Examples
/// ```
/// use tauscope::delay::{Finding, Settings, dead_time};
/// use tauscope::experiment::Trial;
/// use tauscope::units::SamplePeriod;
///
/// // The speed follows a joystick 12 samples later.
/// let stick = |k: i32| (f64::from(k) * 0.07).sin() + (f64::from(k) * 0.023).cos();
/// let input: Vec<f64> = (0..1500).map(stick).collect();
/// let mut angle = 0.0;
/// let output = (0..1500).map(|k| {
///     let rough = f64::from(k * k % 17) - 8.0;
///     angle += 0.1 * stick(k - 13);
///     angle + 1e-3 * rough
/// });
/// let period = SamplePeriod::from_seconds(0.01).unwrap();
/// let trial = Trial::new("swing", 0.0, period, input, output.collect()).unwrap();
/// let Finding::Known(found) = dead_time(&[trial], &Settings::default()).finding else {
///     panic!()
/// };
/// assert!((found.value_s - 0.12).abs() < 0.005);
/// ```
pub fn dead_time(trials: &[Trial], settings: &Settings) -> DeadTime {
    /// Ratio of neighbouring lags; those of the least error are refined.
    const FINE: f64 = 1.8;
    let confidence = settings.interval;
    let record = Record::of(trials, settings);
    let Some(record) = record else { return unknown(Unknown::TooShort, confidence) };
    let rows = record.rows(ENOUGH);
    if rows.iter().flatten().map(ExactSizeIterator::len).sum::<usize>() < FEWEST {
        return unknown(Unknown::TooShort, confidence);
    }
    if let Some(cycles) = one_frequency(&record.inputs()) {
        return unknown(Unknown::OneFrequency(cycles / record.period_s), confidence);
    }
    let (filter, start) = noise(&record, &rows);
    if start.is_none() {
        return unknown(Unknown::NotExplained, confidence);
    }
    let trials = record.whitened(&filter, &rows);
    let longest_lag = longest_lag(&record);
    let profiles = profiles(&trials, record.longest, &grid(FINE, longest_lag));
    let solved = Solved { record: &record, trials: &trials, filter: &filter, confidence };
    let found = solved.dead_time(&profiles, longest_lag);
    found.unwrap_or_else(|| unknown(Unknown::NotExplained, confidence))
}

/// Nothing, and why.
fn unknown(why: Unknown, confidence: f64) -> DeadTime {
    DeadTime {
        finding: Finding::Unknown(why),
        lag_s: None,
        explained: 0.0,
        integrates: true,
        confidence,
        feedback: Feedback { p_value: 1.0, largest: 0.0 },
        curve: Vec::new(),
        windows: Vec::new(),
        same_in_all: None,
    }
}

fn longest_lag(record: &Record) -> f64 {
    let samples: usize = record.samples.iter().map(|(_, samples)| samples.output.len()).sum();
    (samples as f64 / 20.0).clamp(1.0, LONGEST_LAG)
}

/// The filter that whitens the noise, and the fit that it was taken from: both by turns.
fn noise(record: &Record, rows: &[Vec<Range<usize>>]) -> (Vec<f64>, Option<Fitted>) {
    /// Turns; another one changes no dead time by more than a tenth of its interval.
    const TURNS: usize = 2;
    /// Ratio of neighbouring lags: rough, since only the noise is wanted.
    const ROUGH: f64 = 2.5;
    let plain = record.whitened(&[1.0], rows);
    let lags = grid(ROUGH, longest_lag(record));
    let (mut filter, mut best) = (vec![1.0], None);
    for _ in 0..TURNS {
        let trials = record.whitened(&filter, rows);
        let found = profiles(&trials, record.longest, &lags);
        best = found
            .iter()
            .filter_map(|profile| least(profile))
            .min_by(|a, b| a.error.total_cmp(&b.error));
        let Some(best) = best.filter(|best| best.error.is_finite()) else { break };
        let residuals = best.design(&plain).residuals();
        let samples: usize = residuals.iter().map(Vec::len).sum();
        let memory = MEMORY.min(samples / 20);
        filter = whitening(&autocovariances(&residuals, memory), samples);
    }
    (filter, best.filter(|best| best.error.is_finite()))
}

/// A record with its noise known.
struct Solved<'a> {
    record: &'a Record,
    trials: &'a [Whitened],
    filter: &'a [f64],
    confidence: f64,
}

impl Solved<'_> {
    /// From the error of each dead time on a grid of lags, for each structure.
    fn dead_time(&self, coarse: &[Vec<Fitted>], longest_lag: f64) -> Option<DeadTime> {
        let (record, confidence) = (self.record, self.confidence);
        let longest = record.longest as f64;
        // On the grid, lags are off by more than structures differ.
        let refined = coarse.iter().filter_map(|coarse| {
            let mut profile = Profile::new(self.trials, coarse, longest, longest_lag);
            Some((profile.least()?, profile))
        });
        let mut refined: Vec<(Fitted, Profile<'_>)> = refined.collect();
        refined.sort_by(|a, b| a.0.error.total_cmp(&b.0.error));
        let (least, _) = *refined.first()?;
        let best = self.simplest(least, longest_lag);
        let assessed = Assessed::of(self.trials, best);
        let rows: f64 = assessed.errors.iter().map(|rows| rows.len() as f64).sum();
        let quantile = student_quantile(0.5 + 0.5 * confidence, (PARTS - 1) as f64);
        let threshold = quantile * quantile * assessed.widened;
        // n ln(SSE/SSE₀) = t²·widened.
        let limit = least.error * (threshold / rows).exp();
        // What the record cannot distinguish, as an input that is held between samples from one
        // that moves there, makes the dead time no better known.
        let alike = refined.iter_mut().filter(|(best, _)| best.error <= limit);
        let ends: Vec<_> = alike.map(|(best, profile)| profile.ends(*best, limit)).collect();
        let low = ends.iter().filter_map(|(low, _)| *low).min_by(f64::total_cmp);
        let highs: Option<Vec<f64>> = ends.iter().map(|(_, high)| *high).collect();
        let high = highs.and_then(|highs| highs.into_iter().max_by(f64::total_cmp));
        let (_, profile) = refined.first()?;
        let explained = self.explained(best);
        let finding =
            self.finding(best, (low, high), rows * -(1.0 - explained).ln() / assessed.widened);
        // A lag that is as long as any may be is not distinguishable from an integrator.
        // 1/(1 + as) goes over into 1/(as) as a grows.
        let only_integrates = !best.structure.integrates && best.lags.slow > 0.9 * longest_lag;
        let lag = if only_integrates { best.lags.fast } else { best.lags.mean() };
        let mut found = DeadTime {
            finding,
            lag_s: Some(lag * record.period_s),
            explained,
            integrates: best.structure.integrates || only_integrates,
            feedback: feedback(&assessed.errors, &self.inputs()),
            curve: self.curve(profile, least.error),
            ..unknown(Unknown::NotExplained, confidence)
        };
        if let Finding::Known(bounds) = finding {
            let samples = |seconds: f64| seconds / record.period_s;
            let half = samples(0.5 * (bounds.high_s - bounds.low_s));
            let alone = quantile * assessed.deviation;
            // Variances add up: what the lags leave uncertain is the rest of the interval.
            let by_lags = (half * half - alone * alone).max(0.0).sqrt();
            let widest = f64::max(1.0, 0.25 * best.delay);
            let rows = self.window_rows(rows * (alone / widest).powi(2), best);
            let known = Known {
                best,
                coefficients: &assessed.coefficients,
                longest: record.longest,
                rows,
                threshold,
                by_lags,
                widest: 2.0 * widest,
            };
            let windows = self.windows(&known);
            found.same_in_all = same_in_all(&windows, quantile);
            found.windows = windows.into_iter().map(|estimated| estimated.window).collect();
        }
        Some(found)
    }

    /// `best`, or that with one lag where the record does not speak for a second: by Schwarz's
    /// criterion. A second lag takes from the dead time what it does not need for itself.
    fn simplest(&self, best: Fitted, longest_lag: f64) -> Fitted {
        let one = with_one_lag(self.trials, best, longest_lag);
        let rows: usize =
            self.trials.iter().flat_map(|trial| &trial.rows).map(ExactSizeIterator::len).sum();
        let rows = rows as f64;
        // n ln SSE + p ln n, with one parameter less.
        if rows * (one.error / best.error).ln() < rows.ln() { one } else { best }
    }

    /// What a dead time with these ends is; `evidence` is twice the logarithm of the likelihood
    /// that the input has to do with the output.
    fn finding(&self, best: Fitted, ends: (Option<f64>, Option<f64>), evidence: f64) -> Finding {
        /// Part of a sample that no record distinguishes from zero.
        const NOTHING: f64 = 0.02;
        /// Evidence of an input that has nothing to do with the output, with ten parameters and
        /// hundreds of dead times to choose from: seen once in a thousand such logs.
        const LEAST_EVIDENCE: f64 = 40.0;
        let period_s = self.record.period_s;
        if evidence.is_nan() || evidence < LEAST_EVIDENCE {
            return Finding::Unknown(Unknown::NotExplained);
        }
        let (low, Some(high)) = ends else {
            return Finding::Unknown(Unknown::TooLong(self.record.longest as f64 * period_s));
        };
        let low = low.unwrap_or(0.0).max(0.0);
        let bounds = Bounds {
            value_s: best.delay * period_s,
            low_s: low.min(best.delay) * period_s,
            high_s: high.max(best.delay) * period_s,
        };
        if low > NOTHING { Finding::Known(bounds) } else { Finding::LagOnly(bounds) }
    }

    /// The part of the whitened changes that the input explains.
    fn explained(&self, best: Fitted) -> f64 {
        let without = super::moments::Moments::of(self.trials, best.lags, 0, 0).without_input();
        if without > 0.0 { (1.0 - best.error / without).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// The input in the rows.
    fn inputs(&self) -> Vec<&[f64]> {
        let trials = self.record.inputs().into_iter().zip(self.record.rows(ENOUGH));
        let of_trial = |(input, rows): (_, Vec<Range<usize>>)| {
            rows.into_iter().map(|rows| <[f64]>::get(input, rows).unwrap_or_default()).collect()
        };
        trials.flat_map::<Vec<&[f64]>, _>(of_trial).collect()
    }

    /// Rows of a window that are enough for intervals as narrow as is worth having.
    fn window_rows(&self, needed: f64, best: Fitted) -> usize {
        /// Windows know less than their part of the rows: not all excite alike.
        const SPARE: f64 = 2.0;
        /// Fewest rows, in all and for each sample of dead time and lag.
        const FEWEST_ROWS: f64 = 60.0;
        const PER_LAG: f64 = 20.0;
        /// Most windows of a record, half of which share no row.
        const MOST: f64 = 60.0;
        let samples: f64 = self.record.inputs().iter().map(|input| input.len() as f64).sum();
        let shortest = (PER_LAG * (best.delay + best.lags.mean().min(20.0))).max(FEWEST_ROWS);
        ceil_to_index((SPARE * needed).max(shortest).max(2.0 * samples / MOST))
    }

    fn windows(&self, known: &Known<'_>) -> Vec<Estimated> {
        let rows = self.record.rows(usize::MAX);
        let trials = self.record.samples.iter().zip(&rows);
        let of_trial = |((number, samples), rows): (&(usize, Samples), &Vec<Range<usize>>)| {
            known.windows(*number, samples, &Whitened::of(samples, self.filter, rows))
        };
        trials.flat_map(of_trial).collect()
    }

    fn curve(&self, profile: &Profile<'_>, least: f64) -> Vec<ErrorPoint> {
        let mut all: Vec<&Fitted> = profile.coarse.iter().chain(&profile.refined).collect();
        all.sort_by(|a, b| a.delay.total_cmp(&b.delay).then(a.error.total_cmp(&b.error)));
        all.dedup_by(|a, b| (a.delay - b.delay).abs() < 1e-9);
        let point = |fitted: &&Fitted| ErrorPoint {
            delay_s: fitted.delay * self.record.period_s,
            error: (fitted.error / least).sqrt(),
        };
        all.iter().map(point).filter(|point| point.error.is_finite()).collect()
    }
}
