//! How the output of a joint settles: the time constants that its steps share.

use nalgebra::DMatrix;

use super::constants::TimeConstants;
use super::curvature::{is_curved, mean_hold};
use super::following::FirstOrder;
use super::response::Response;
use super::search::Search;
use super::trial::{Found, SettlingTrial};
use crate::delay::broken_line;
use crate::delay::interval::FineDelay;
use crate::delay::lag::LagPart;
use crate::delay::prepared::Prepared;
use crate::delay::settings::Settings;
use crate::experiment::Record;
use crate::numerics::{NoiseModel, dot, robust_scale, student_quantile};
use crate::units::SamplePeriod;

/// How an output settles behind its dead times: `T y' + y = x`, where `x` steps to the level at
/// which the output settles.
///
/// # References
/// Åström, K. J., and Hägglund, T., 2006, Advanced PID Control, section 2.4 (processes with
/// self-regulation).
#[derive(Clone, Debug, PartialEq)]
pub struct Settling {
    period: SamplePeriod,
    law: Law,
    /// One with or without a further lag that the record does not exclude.
    other: Option<Law>,
    noise: NoiseModel,
}

/// Time constants, and how well they are known.
#[derive(Clone, Debug, PartialEq)]
struct Law {
    constants: TimeConstants,
    /// Of their logarithms.
    covariance: DMatrix<f64>,
}

/// Windows that can show a time constant.
const FEWEST: usize = 3;

/// Samples from which a further lag is distinguished from an onset between two of them (chosen).
const SEEN: f64 = 2.0;

/// Samples of the shortest time constant that samples show: behind a shorter one an output goes to
/// its level at once, and at which sample it left the one before is all that is known.
const RESOLVED: f64 = 2.0;

/// Mean holds that a time constant lasts at most: a longer one is an integrator's.
const MOST_HOLDS: f64 = 3.0;

/// Trials with the sample period of the first.
fn alike<'t, 'a>(prepared: &'t [Prepared<'a>]) -> Vec<&'t Prepared<'a>> {
    let period = prepared.first().map(|trial| trial.period);
    prepared.iter().filter(|trial| Some(trial.period) == period).collect()
}

impl Settling {
    /// The first order from which the law of a joint is looked for, whatever the low-pass of what
    /// was prepared; none where the output does not settle.
    pub(in crate::delay) fn start(
        trials: &Record,
        prepared: &[Prepared<'_>],
        settings: &Settings,
    ) -> Option<FirstOrder> {
        let alike = alike(prepared);
        let hold_s = mean_hold(&alike) * prepared.first()?.period.seconds();
        match settings.settles {
            Some(false) => None,
            Some(true) => Some(FirstOrder::likely_within_holds(trials, hold_s)?.0),
            None => FirstOrder::of(trials).or_else(|| {
                is_curved(&alike).then(|| FirstOrder::within_holds(trials, hold_s)).flatten()
            }),
        }
    }

    /// How the output of a joint settles; none where it does not by an exponential law.
    pub(in crate::delay) fn of(
        start: FirstOrder,
        prepared: &[Prepared<'_>],
        settings: &Settings,
    ) -> Option<Self> {
        let period = prepared.first()?.period;
        let alike = alike(prepared);
        let constants = TimeConstants::one(start.time_constant_s / period.seconds());
        let white = NoiseModel::white();
        let rough = all_onsets(&alike, settings, &constants);
        let rough = Search::of(&rough, constants, &white).descended().constants;
        let onsets = all_onsets(&alike, settings, &rough);
        let (search, other) = selected(Search::of(&onsets, rough, &white).descended());
        let longest = MOST_HOLDS * mean_hold(&alike);
        let is_resolved = (RESOLVED..=longest).contains(&search.constants.rising)
            && search.constants.shortest() >= RESOLVED;
        let is_law = is_resolved && is_exponential(&search, &alike);
        if search.windows() < FEWEST || !(is_law || settings.settles == Some(true)) {
            return None;
        }
        let noise = search.noise();
        let law = |search: &Search<'_>| {
            let known = Search::of(&onsets, search.constants, &noise).descended();
            Law { constants: known.constants, covariance: bounded(&known) }
        };
        let (law, other) = (law(&search), other.as_ref().map(law));
        Some(Self { period, law, other, noise: noise.clone() })
    }

    /// Time constant with which the output settles after the input rises, seconds.
    pub fn rising_s(&self) -> LagPart {
        self.part(self.law.constants.rising, 0)
    }

    /// Time constant after the input falls, seconds, where it is another one.
    pub fn falling_s(&self) -> Option<LagPart> {
        Some(self.part(self.law.constants.falling?, 1))
    }

    /// Time constant of a further lag, seconds, where there is one.
    pub fn further_s(&self) -> Option<LagPart> {
        Some(self.part(self.law.constants.further?, self.law.constants.parameters() - 1))
    }

    fn part(&self, samples: f64, index: usize) -> LagPart {
        let value = samples * self.period.seconds();
        let variance = self.law.covariance[(index, index)];
        LagPart { value, std_error: value * variance.max(0.0).sqrt() }
    }

    /// The onset of every step of a trial; none for one that has no room. Its interval holds those
    /// of every law that the record allows.
    pub(in crate::delay) fn onsets(
        &self,
        trial: &Prepared<'_>,
        settings: &Settings,
    ) -> Vec<Option<SettlingOnset>> {
        let by = self.period.seconds() / trial.period.seconds();
        let of = |law: &Law| law.onsets(trial, settings, by, &self.noise);
        let mut found = of(&self.law);
        for (onset, other) in found.iter_mut().zip(self.other.iter().flat_map(of)) {
            if let Some((onset, other)) = onset.as_mut().zip(other) {
                onset.fine.low = onset.fine.low.min(other.fine.low);
                onset.fine.high = onset.fine.high.max(other.fine.high);
            }
        }
        found
    }
}

impl Law {
    /// The onset of every step of a trial, whose samples are `by` times as many.
    fn onsets(
        &self,
        trial: &Prepared<'_>,
        settings: &Settings,
        by: f64,
        noise: &NoiseModel,
    ) -> Vec<Option<SettlingOnset>> {
        let constants = self.constants.scaled(by);
        let found = SettlingTrial::of(trial, settings, &constants, noise);
        let onset = |index: usize| {
            let origin = trial.steps.get(index)?.sample as f64 - 1.0;
            let here = found.find(index, found.path.window(index), &constants, noise)?;
            let slopes = slopes(&found, index, &here, &constants);
            Some(self.onset(&here, &slopes, origin, settings.interval))
        };
        (0..trial.steps.len()).map(onset).collect()
    }

    /// An onset as a delay, with the profile likelihood of its own and, independent of it, the
    /// uncertainty of the time constants.
    fn onset(
        &self,
        found: &Found<'_>,
        slopes: &[f64],
        origin: f64,
        confidence: f64,
    ) -> SettlingOnset {
        let Found { range, window, constants, onset, sse, .. } = found;
        let freedom = window.freedom(constants);
        let t = student_quantile(f64::midpoint(1.0, confidence), freedom);
        let own = t * window.standard_error(constants, (*onset, *sse));
        // Delta method; independent of the onset's own noise.
        let shared = t * self.variance_along(slopes).sqrt();
        let side = |sign: f64| {
            let reach = window.reach(constants, (*onset, *sse), sign * own, t * t * sse / freedom);
            sign * reach.hypot(shared)
        };
        let (low, high) =
            if own < window.len() as f64 { (side(-1.0), side(1.0)) } else { (-own, own) };
        let delay = range.start as f64 + onset - origin;
        let ends = (delay + low, delay + high);
        let median = broken_line::median(delay, ends, t);
        let explained = found.explained();
        SettlingOnset {
            fine: FineDelay::causal(median, ends.0, ends.1, confidence),
            p_value: found.p_value(explained),
            start: range.start,
            sse: [-1.0, 0.0, 1.0].map(|by| window.sse(constants, onset + by)),
            response: window.response(constants, *onset, explained.max(0.0)),
        }
    }

    fn variance_along(&self, slopes: &[f64]) -> f64 {
        let product = |(i, a): (usize, &f64)| -> f64 {
            let entry = |j: usize| self.covariance[(i, j)];
            slopes.iter().enumerate().map(|(j, b)| a * entry(j) * b).sum()
        };
        slopes.iter().enumerate().map(product).sum::<f64>().max(0.0)
    }
}

/// How far an onset moves with each parameter.
fn slopes(
    trial: &SettlingTrial<'_>,
    index: usize,
    found: &Found<'_>,
    constants: &TimeConstants,
) -> Vec<f64> {
    /// Change of a logarithm to each side.
    const STEP: f64 = 1e-3;
    // The onset moves so that the residual stays orthogonal to its slope: −g·Δr/(g·g).
    let along = found.window.onset_slope(&found.constants, found.onset);
    let square = dot(&along, &along);
    let slope = |parameter: usize| {
        let [low, high] = [-STEP, STEP].map(|by| {
            let about = trial.about(index, &constants.moved_one(parameter, by));
            found.window.residual(&about, found.onset)
        });
        let change: f64 =
            along.iter().zip(low.iter().zip(high)).map(|(a, (l, h))| a * (h - l)).sum();
        -change / (2.0 * STEP) / square
    };
    (0..constants.parameters()).map(slope).collect()
}

/// An onset of an output that settles.
#[derive(Clone, Debug)]
pub(in crate::delay) struct SettlingOnset {
    /// The delay, samples.
    pub(in crate::delay) fine: FineDelay,
    /// How often noise alone looks as much like a reaction.
    pub(in crate::delay) p_value: f64,
    /// Index of the first sample that was looked at.
    pub(in crate::delay) start: usize,
    /// Squared errors with the onset a sample earlier, here, and a sample later.
    pub(in crate::delay) sse: [f64; 3],
    /// The response at the samples that were looked at.
    pub(in crate::delay) response: Response,
}

/// The onsets of all trials, in white noise.
fn all_onsets<'a>(
    trials: &[&'a Prepared<'_>],
    settings: &Settings,
    constants: &TimeConstants,
) -> Vec<SettlingTrial<'a>> {
    let white = NoiseModel::white();
    trials.iter().map(|trial| SettlingTrial::of(trial, settings, constants, &white)).collect()
}

/// The covariance of the parameters, for a further lag that may be so short that it is hardly seen.
///
/// What a short lag `T₂` does beside a shift of the onset grows with its square: its upper bound is
/// not `T₂·(1 + z·e)` with the standard error `e` of its logarithm, but `T₂·√(1 + 2·z·e)`.
fn bounded(search: &Search<'_>) -> DMatrix<f64> {
    /// Standard errors from an estimate to the end of its 95 % interval.
    const Z: f64 = 1.96;
    let mut covariance = search.covariance();
    let last = search.constants.parameters() - 1;
    let variance = covariance[(last, last)];
    if search.constants.further.is_none() || variance.is_nan() || variance <= 0.0 {
        return covariance;
    }
    let error = variance.sqrt();
    // (√(1 + 2·z·e) − 1)/(z·e): the standard error whose upper end is at T₂·√(1 + 2·z·e).
    let factor = ((1.0 + 2.0 * Z * error).sqrt() - 1.0) / (Z * error);
    covariance.row_mut(last).scale_mut(factor);
    covariance.column_mut(last).scale_mut(factor);
    covariance
}

/// The law with the parameters that the record asks for; and one with a further lag, or without,
/// that it does not exclude.
fn selected(search: Search<'_>) -> (Search<'_>, Option<Search<'_>>) {
    /// Twice the logarithm of a likelihood ratio that excludes the law that is less likely: χ² of
    /// one degree of freedom is beyond it once in 22 times.
    const EXCLUDED: f64 = 4.0;
    let falling = search.started_at(search.constants.with_falling(), 0.0).descended();
    let penalty = search.penalty();
    let search = if search.gain(&falling) > 2.0 * penalty { falling } else { search };
    let Some(free) = with_further(&search, 0.0) else { return (search, None) };
    if search.gain(&free) > 2.0 * penalty {
        return (free, None);
    }
    // A lag of about a sample fits noise: the first sample behind each onset is then free.
    let Some(lagging) = with_further(&search, SEEN) else { return (search, None) };
    let gain = search.gain(&lagging);
    if gain > penalty {
        (lagging, Some(search))
    } else if gain > -EXCLUDED {
        (search, Some(lagging))
    } else {
        (search, None)
    }
}

/// `search` with a further lag of at least `least` samples.
fn with_further<'a>(search: &Search<'a>, least: f64) -> Option<Search<'a>> {
    /// Parts of the time constant at which it is looked for: the valley has several hollows.
    const PARTS: [f64; 3] = [0.02, 0.06, 0.2];
    let started = |part: f64| {
        let constants = search.constants.with_further(part, least);
        search.started_at(constants, constants.further_or_zero()).descended()
    };
    PARTS.into_iter().map(started).min_by(|a, b| a.sse.total_cmp(&b.sse))
}

/// Whether the law explains the output better than straight lines do, and its residual is little more
/// than noise.
fn is_exponential(search: &Search<'_>, trials: &[&Prepared<'_>]) -> bool {
    /// Largest squared error of the law, as a part of that about lines (chosen).
    const PART: f64 = 0.7;
    /// Largest residual of the law: times the noise, and part of the output's range (chosen).
    const TIMES: f64 = 2.0;
    const LITTLE: f64 = 0.01;
    let outputs = || trials.iter().flat_map(|trial| trial.raw.iter());
    let low = outputs().copied().fold(f64::INFINITY, f64::min);
    let high = outputs().copied().fold(f64::NEG_INFINITY, f64::max);
    let bends = trials.iter().flat_map(|trial| trial.raw.windows(3));
    let bends: Vec<f64> = bends.map(|y| y[0] - 2.0 * y[1] + y[2]).collect();
    // White noise of variance 1 has second differences of variance 6.
    let noise = robust_scale(&bends) / 6.0_f64.sqrt();
    let most = (TIMES * noise).max(LITTLE * (high - low));
    search.variance() <= most * most && search.sse < PART * search.sse_of_lines()
}
