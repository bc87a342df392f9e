//! α, β and the passband as a joint's own record suggests them.
//!
//! **Passband.** Smoothing pays where the output is noise, and costs where it is motion. Both
//! are seen in the second difference of the output, in which a motion of straight lines is a
//! row of single peaks, with a flat spectrum, and noise rises with the fourth power of the
//! frequency. With `P(ω)` the measured spectrum of the second difference and
//!
//! ```text
//! N(ω) = s² · |2 sin(ω/2)|⁴ / |1 − Σ a_i e^(−iωi)|²
//! ```
//!
//! that of noise with the innovations `s²` and the memory `a`, the cutoff is the lowest
//! frequency at which motion is no stronger than noise, `P(ω) ≤ 2 N(ω)`: where Wiener's
//! filter passes one half, as the low-pass does at its cutoff. It is not below one over a
//! usual hold, since neighbouring reactions would be mixed. Where noise is nowhere stronger,
//! nothing is smoothed. Noise is the residual about lines of the later halves of the times between
//! two reactions, where a lag has died away. Methods that look at the output as it was
//! measured stay so: smoothing would take from noise what intervals are made of.
//!
//! **α.** After the next input step the output goes on as before for as long as the next
//! delay takes. These samples belong to the line, and the first ones of the next reaction do
//! not: α is a delay that nine of ten exceed, of those that two lines that meet know best.
//!
//! **β.** Candidates a sample apart resolve the delay most finely. Only two lines that need not
//! meet, through an output that is not smoothed, cannot use that: their squared error grows
//! by `c²d³/3` when they meet `d` samples beside a change of slope `c`, which shows above the
//! noise `σ²` of two parameters from
//!
//! ```text
//! d = (6 σ² / c²)^(1/3)
//! ```
//!
//! on. That is β without a low-pass, and 1 with one.
//!
//! # References
//! N. Wiener, "Extrapolation, Interpolation, and Smoothing of Stationary Time Series" (1949).
//! P. D. Welch, "The use of fast Fourier transform for the estimation of power spectra", IEEE
//! Trans. Audio Electroacoust. 15 (1967).

use std::f64::consts::{PI, TAU};

use serde::Serialize;

use super::decision::{Decision, Verdict};
use super::input_motion::InputMotion;
use super::interval::FineDelay;
use super::neutral::Neutral;
use super::prepared::Prepared;
use super::settings::{FirstLast, InSeconds, Settings};
use super::spec::Method;
use crate::experiment::{Record, Trial};
use crate::numerics::{
    LowPass, NoiseModel, RunningLine, autocovariances, median, quantile, to_digits,
};
use crate::units::ceil_to_index;

/// Which settings are chosen from the record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Automatic {
    /// α is.
    pub alpha: bool,
    /// β is.
    pub beta: bool,
    /// The passband is.
    pub passband: bool,
}

impl Automatic {
    /// Whether anything is chosen.
    pub fn any(self) -> bool {
        self.alpha || self.beta || self.passband
    }
}

/// What settings were chosen from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RecordStatistics {
    /// The delay that nine of ten exceed, samples.
    pub short_delay: Option<f64>,
    /// Standard deviation of the noise, output units.
    pub noise: Option<f64>,
    /// Correlation of neighbouring samples of the noise.
    pub noise_correlation: Option<f64>,
    /// Where the motion sinks into the noise, Hz; none where it does not.
    pub motion_ends_hz: Option<f64>,
}

/// Which settings of a joint were chosen, and from what.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Chosen {
    /// Which settings.
    pub automatic: Automatic,
    /// What the record showed.
    #[serde(rename = "grounds")]
    pub statistics: RecordStatistics,
}

/// `settings` with those that are `automatic` chosen from the trials of a joint, and from
/// what. What the record does not show stays as it is in `settings`.
///
/// # Examples
/// ```
/// use tauscope::delay::{Automatic, Settings, choose};
/// use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate};
///
/// let input = InputSpec::Levels { levels: vec![-1.0, 0.5, 1.0], hold_s: [0.9, 2.0] };
/// let delay = DelayLaw::Uniform { min: 0.1, max: 0.4 };
/// let joint = JointSpec { noise: 0.4, ..JointSpec::new("boom", input, delay) };
/// let made = simulate(&PlantSpec::new(1, 60.0, vec![joint]))?;
///
/// let all = Automatic { alpha: true, beta: true, passband: true };
/// let (settings, chosen) = choose(&made.joints[0].trials, &Settings::default(), all);
/// assert!((10..20).contains(&settings.alpha), "a short delay: {}", settings.alpha);
/// assert!(settings.low_pass.is_some_and(|filter| filter.cutoff_hz < 5.0));
/// assert!((chosen.statistics.noise.unwrap_or(0.0) - 0.4).abs() < 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn choose(trials: &Record, settings: &Settings, automatic: Automatic) -> (Settings, Chosen) {
    let mut chosen = settings.clone();
    let record = Observed::of(trials, settings);
    let statistics = record.statistics();
    if let Some(delay) = statistics.short_delay.filter(|_| automatic.alpha) {
        chosen = chosen.with_alpha(ceil_to_index(delay).max(1).into());
    }
    if automatic.passband {
        chosen.low_pass = record.low_pass(settings.low_pass, statistics.motion_ends_hz);
    }
    if automatic.beta {
        let beta = if chosen.low_pass.is_some() { 1 } else { record.blur() };
        chosen = chosen.with_beta(beta.into());
    }
    (chosen, Chosen { automatic, statistics })
}

/// What bends show of a joint.
struct Observed<'a> {
    /// Trials of the first one's sample period.
    outputs: Vec<&'a [f64]>,
    period_s: f64,
    delays: Vec<FineDelay>,
    holds: Vec<f64>,
    /// Residuals about lines of the times when nothing happens.
    quiet: Vec<Vec<f64>>,
    /// Changes of slope at reactions.
    bends: Vec<f64>,
    noise: NoiseModel,
    /// `s²`: power of the innovations.
    innovations: f64,
}

/// Parameters of a line.
const LINE: usize = 2;

impl<'a> Observed<'a> {
    fn of(trials: &'a Record, settings: &Settings) -> Self {
        let hinge = Settings {
            max_delay: settings.max_delay,
            in_seconds: InSeconds {
                max_delay: settings.in_seconds.max_delay,
                ..InSeconds::default()
            },
            min_step: settings.min_step,
            input: settings.with_input(&InputMotion::of(trials)).input,
            // Every change of the input is a step where it is for the paper.
            grows: settings.paper || settings.grows,
            first_last: FirstLast::Keep,
            low_pass: None,
            ..Settings::of(Method::HINGE)
        };
        let period = trials.first().map(Trial::period);
        let hinge = period.map_or_else(|| hinge.clone(), |period| hinge.at(period));
        let alike = trials.iter().filter(|trial| Some(trial.period()) == period);
        let mut record = Self {
            outputs: alike.map(Trial::output).collect(),
            period_s: period.map_or(1.0, crate::units::SamplePeriod::seconds),
            delays: Vec::new(),
            holds: Vec::new(),
            quiet: Vec::new(),
            bends: Vec::new(),
            noise: NoiseModel::white(),
            innovations: 0.0,
        };
        // Without a low-pass nothing can fail to fit.
        let prepared = Prepared::all(trials, &hinge);
        let alike = prepared.into_iter().filter(|trial| Some(trial.period) == period);
        let alike: Vec<Prepared<'_>> = alike.filter(|trial| !trial.steps.is_empty()).collect();
        let model = Method::HINGE.shared(&alike, Neutral::of(trials), &hinge);
        for trial in &alike {
            let decisions = Method::HINGE.decide(trial, model.as_ref(), &hinge);
            record.add(&trial.raw, &decisions);
        }
        record.noise = NoiseModel::of(&record.quiet, LINE);
        record.innovations = record.innovations();
        record
    }

    /// The delays and holds, and the halves of the times between two reactions in which a
    /// lag is over.
    fn add(&mut self, output: &[f64], decisions: &[Decision]) {
        self.holds.extend(decisions.iter().rev().skip(1).map(|decision| decision.hold as f64));
        let accepted = decisions.iter().filter(|one| one.verdict() == Verdict::Accepted);
        self.delays.extend(accepted.filter_map(|one| one.fine));
        // What was not accepted may be a reaction all the same: no line goes across it.
        let place = |one: &Decision| {
            let place = one.input_step.sample as f64 - 1.0 + one.fine?.delay;
            Some(ceil_to_index(place).min(output.len()))
        };
        let places: Vec<usize> = decisions.iter().filter_map(place).collect();
        let ends = places.iter().skip(1).copied().chain([output.len()]);
        let mut slope_before = None;
        for (place, end) in places.iter().zip(ends) {
            // In the later half a lag has died away.
            let start = place.midpoint(end);
            let Some((slope, residuals)) = output.get(start..end).and_then(without_line) else {
                slope_before = None;
                continue;
            };
            self.bends.extend(slope_before.map(|before| slope - before));
            slope_before = Some(slope);
            self.quiet.push(residuals);
        }
    }

    /// A delay that nine of ten exceed, of the half that is known best: the noise of the
    /// others makes their shortest ones shorter.
    fn short_delay(&self) -> Option<f64> {
        /// The part of the delays that may be shorter than α.
        const SHORT: f64 = 0.1;
        let width = |fine: &FineDelay| fine.high - fine.low;
        let usual = median(&self.delays.iter().map(width).collect::<Vec<_>>())?;
        let known = self.delays.iter().filter(|fine| width(fine) <= usual);
        quantile(&known.map(|fine| fine.delay).collect::<Vec<_>>(), SHORT)
    }

    /// The power of the whitened residuals.
    fn innovations(&self) -> f64 {
        let order = self.noise.order();
        let whitened = |residuals: &Vec<f64>| {
            let mut residuals = residuals.clone();
            self.noise.whiten(&mut residuals);
            let rows = residuals.len().saturating_sub(order + LINE);
            (residuals.iter().map(|value| value * value).sum::<f64>(), rows as f64)
        };
        let all = self.quiet.iter().map(whitened).filter(|(_, rows)| *rows > 0.0);
        // The median, so that the rest of a slow lag counts for nothing.
        let powers: Vec<f64> = all.map(|(power, rows)| power / rows).collect();
        median(&powers).unwrap_or(0.0)
    }

    fn statistics(&self) -> RecordStatistics {
        let samples: usize = self.quiet.iter().map(Vec::len).sum();
        let covariances = autocovariances(&self.quiet, 1);
        let correlation =
            covariances.first().zip(covariances.get(1)).map(|(power, next)| next / power);
        let freedom = samples.saturating_sub(LINE * self.quiet.len());
        let sum = covariances.first().map(|power| power * samples as f64);
        let known = freedom > 0;
        RecordStatistics {
            short_delay: self.short_delay(),
            noise: sum.filter(|_| known).map(|sum| (sum / freedom as f64).sqrt()),
            noise_correlation: correlation.filter(|c| known && c.is_finite()),
            motion_ends_hz: self.motion_ends().map(|omega| omega / (TAU * self.period_s)),
        }
    }

    /// A low-pass that ends where the motion does; `usual` where that cannot be determined.
    fn low_pass(&self, usual: Option<LowPass>, motion_ends_hz: Option<f64>) -> Option<LowPass> {
        /// The part of Nyquist's frequency from which on a low-pass has nothing to take.
        const TOP: f64 = 0.9;
        let order = usual.map_or(4, |usual| usual.order);
        let Some(hold) = median(&self.holds).filter(|_| !self.quiet.is_empty()) else {
            return usual;
        };
        let slowest = 1.0 / (hold * self.period_s);
        let cutoff_hz = to_digits(motion_ends_hz?.max(slowest), 2);
        (cutoff_hz < TOP * 0.5 / self.period_s).then_some(LowPass { cutoff_hz, order })
    }

    /// The distance at which two breakpoints can be distinguished, samples.
    fn blur(&self) -> usize {
        /// The greatest that is chosen: half of the paper's α.
        const MOST: usize = 5;
        let bends: Vec<f64> = self.bends.iter().map(|bend| bend * bend).collect();
        let Some(bend) = median(&bends).filter(|bend| *bend > 0.0) else { return 1 };
        // What a line over many samples sees of noise with a memory.
        // The spectrum of noise at ω = 0: s²/(1 − Σ a_i)².
        let noise = self.innovations / self.noise.level.powi(2);
        // d = (6 σ²/c²)^(1/3).
        ceil_to_index((6.0 * noise / bend).cbrt().round()).clamp(1, MOST)
    }

    /// The lowest frequency, radians per sample, at which motion is no stronger than noise.
    fn motion_ends(&self) -> Option<f64> {
        let spectrum = Spectrum::of(&self.outputs)?;
        let noise: Vec<f64> = (0..spectrum.power.len())
            .map(|bin| self.innovations * gain(&self.noise, spectrum.omega(bin)))
            .collect();
        // One period of white noise is no evidence: bands of a third of an octave are.
        let band = |bin: usize, up: f64| {
            let last = ceil_to_index(bin as f64 * up).min(noise.len().saturating_sub(1));
            let sum = |values: &[f64]| values.get(bin..=last).map_or(0.0, |v| v.iter().sum());
            let (all, own): (f64, f64) = (sum(&spectrum.power), sum(&noise));
            // P ≤ 2 N, over the band.
            all <= 2.0 * own
        };
        let bin = (1..noise.len()).find(|bin| band(*bin, 1.26) && band(*bin, 2.0))?;
        Some(spectrum.omega(bin))
    }
}

/// The spectrum of the second difference of `noise`, for innovations of power 1.
fn gain(noise: &NoiseModel, omega: f64) -> f64 {
    // N(ω)/s².
    (2.0 * (0.5 * omega).sin()).powi(4) / noise.memory_gain(omega)
}

/// The slope of the line through `values`, and their residuals; `None` for too few of them.
fn without_line(values: &[f64]) -> Option<(f64, Vec<f64>)> {
    /// Samples from which on noise can be distinguished from a line.
    const FEWEST: usize = 8;
    let offset = values.first().filter(|_| values.len() >= FEWEST)?;
    let mut line = RunningLine::default();
    for value in values {
        line.push(value - offset);
    }
    let (slope, mean) = (line.slope(), line.mean() + offset);
    let middle = 0.5 * (values.len() - 1) as f64;
    let samples = values.iter().enumerate();
    Some((slope, samples.map(|(k, value)| value - mean - slope * (k as f64 - middle)).collect()))
}

/// The spectrum of second differences, by Welch's method.
struct Spectrum {
    /// Samples of a window.
    length: usize,
    /// Power at each bin from 0 on; that of white noise is its variance.
    power: Vec<f64>,
}

impl Spectrum {
    fn of(outputs: &[&[f64]]) -> Option<Self> {
        /// Samples of a window: 0.2 Hz at 100 Hz.
        const LENGTH: usize = 512;
        /// Windows that are enough, from all over the record.
        const ENOUGH: usize = 64;
        let longest = outputs.iter().map(|output| output.len().saturating_sub(2)).max()?;
        let length = longest.min(LENGTH);
        if length < LENGTH / 8 {
            return None;
        }
        let windows = outputs.iter().flat_map(|output| {
            let last = output.len().saturating_sub(length + 2);
            let fits = output.len() >= length + 2;
            // Welch: windows that overlap by half.
            let starts = (0..=last).step_by(length / 2).filter(move |_| fits);
            starts.filter_map(|start| output.get(start..start + length + 2))
        });
        let windows: Vec<&[f64]> = windows.collect();
        let every = windows.len().div_ceil(ENOUGH).max(1);
        let mut power = vec![0.0; length / 2 + 1];
        let mut count = 0.0;
        for window in windows.iter().step_by(every) {
            let values = windowed(window);
            for (bin, power) in power.iter_mut().enumerate() {
                *power += power_at(&values, TAU * bin as f64 / length as f64);
            }
            count += 1.0;
        }
        for power in &mut power {
            *power /= count;
        }
        Some(Self { length, power })
    }

    /// The frequency of a bin, radians per sample.
    fn omega(&self, bin: usize) -> f64 {
        TAU * bin as f64 / self.length as f64
    }
}

/// The second differences under a window of Hann, of power 1.
fn windowed(values: &[f64]) -> Vec<f64> {
    let length = values.len().saturating_sub(2) as f64;
    // The mean square of the window is 3/8.
    let scale = (0.375 * length).sqrt().recip();
    let bend = |(k, three): (usize, &[f64])| match three {
        [a, b, c] => (a - 2.0 * b + c) * scale * (PI * (k as f64 + 0.5) / length).sin().powi(2),
        _ => 0.0,
    };
    values.windows(3).enumerate().map(bend).collect()
}

/// `|Σ x_k e^(−iωk)|²`, by Goertzel's recursion.
fn power_at(values: &[f64], omega: f64) -> f64 {
    let turn = 2.0 * omega.cos();
    let step = |(last, before): (f64, f64), value: &f64| (value + turn * last - before, last);
    let (last, before) = values.iter().fold((0.0, 0.0), step);
    last * last + before * before - turn * last * before
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::Method;
    use crate::numerics::testing::uniform;
    use crate::units::SamplePeriod;

    const ALL: Automatic = Automatic { alpha: true, beta: true, passband: true };

    /// White values of variance 1/12.
    fn white(count: usize) -> Vec<f64> {
        std::iter::repeat_with(uniform(7)).take(count).collect()
    }

    /// A joint of 20 deg/s that turns every second, 14 samples late, with noise.
    fn trial(noise: f64) -> Trial {
        let turns = |k: i32| f64::from(k.div_euclid(100).rem_euclid(2));
        let input = (0..6000).map(turns).collect();
        let mut angle = 0.0;
        let output = (0..6000).zip(white(6000)).map(|(k, e)| {
            angle += 0.2 * (turns(k - 15) - 0.5);
            angle + noise * e
        });
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        Trial::new("1", 0.0, period, input, output.collect()).unwrap()
    }

    #[test]
    fn a_window_keeps_the_power_of_noise() {
        let noise = white(20_000);
        let spectrum = Spectrum::of(&[&noise]).unwrap();
        for bin in [40, 100, 200, 250] {
            let about = spectrum.power.get(bin - 5..bin + 5).unwrap().iter().sum::<f64>() / 10.0;
            let expected = gain(&NoiseModel::white(), spectrum.omega(bin)) / 12.0;
            assert!((about / expected - 1.0).abs() < 0.3, "{bin}: {about} {expected}");
        }
    }

    #[test]
    fn goertzel_finds_the_power_of_a_tone() {
        let tone = |k: i32| (TAU * 5.0 * f64::from(k) / 64.0).cos();
        let values: Vec<f64> = (0..64).map(tone).collect();
        assert!((power_at(&values, TAU * 5.0 / 64.0) - 32.0_f64.powi(2)).abs() < 1e-6);
        assert!(power_at(&values, TAU * 9.0 / 64.0) < 1e-6);
    }

    #[test]
    fn more_noise_takes_a_lower_passband() {
        let cutoff = |noise| {
            let (settings, chosen) =
                choose(&vec![trial(noise)].into(), &Settings::of(Method::TWO_LINE), ALL);
            assert!((12..=14).contains(&settings.alpha), "{chosen:?}");
            assert_eq!(settings.beta, 1);
            let found = chosen.statistics.noise.unwrap();
            assert!((found / (noise / 12.0_f64.sqrt()) - 1.0).abs() < 0.1, "{found} {noise}");
            settings.low_pass.unwrap().cutoff_hz
        };
        let (little, some, much) = (cutoff(0.1), cutoff(0.4), cutoff(2.0));
        assert!(little > some && some > much, "{little} {some} {much}");
        // Four times as much noise, half the frequency.
        assert!((little / some - 2.0).abs() < 0.6, "{little} {some}");
    }

    #[test]
    fn without_noise_nothing_is_smoothed() {
        let (settings, chosen) =
            choose(&vec![trial(0.0)].into(), &Settings::of(Method::TWO_LINE), ALL);
        assert_eq!(settings.low_pass, None, "{chosen:?}");
        assert_eq!(settings.beta, 1);
    }

    #[test]
    fn what_is_not_automatic_stays() {
        let given = Settings { alpha: 3, beta: 7, ..Settings::of(Method::TWO_LINE) };
        let (settings, _) = choose(&vec![trial(0.4)].into(), &given, Automatic::default());
        assert_eq!(settings, given);
        let alone = Automatic { alpha: true, ..Automatic::default() };
        let (settings, _) = choose(&vec![trial(0.4)].into(), &given, alone);
        assert_eq!(settings, Settings { alpha: 14, ..given });
    }

    #[test]
    fn a_record_that_tells_nothing_leaves_all_as_it_is() {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let odd: [(Vec<f64>, Vec<f64>); 4] = [
            (vec![0.0; 300], vec![1.0; 300]),
            (vec![0.0, 1.0, 0.0], vec![1.0, 2.0, 3.0]),
            (vec![1.0], vec![1.0]),
            ((0..200).map(f64::from).collect(), vec![0.0; 200]),
        ];
        for (input, output) in odd {
            let trial = Trial::new("1", 0.0, period, input, output).unwrap();
            let (settings, _) = choose(&vec![trial].into(), &Settings::of(Method::TWO_LINE), ALL);
            assert!(settings.check().is_ok() && settings.alpha >= 1);
        }
        let (settings, chosen) = choose(&Record::default(), &Settings::of(Method::TWO_LINE), ALL);
        assert_eq!(
            (settings.alpha, settings.low_pass),
            (10, Settings::of(Method::TWO_LINE).low_pass)
        );
        assert_eq!(chosen.statistics, RecordStatistics::default());
    }
}
