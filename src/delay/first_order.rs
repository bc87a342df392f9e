//! Whether an output follows its input itself and not its integral: a speed, a pressure, a
//! temperature, a servo's position. It then settles at a level for each level of the input, as a
//! first order with dead time,
//!
//! ```text
//! T y' + y = K u(t − τ) + y0
//! ```
//!
//! # References
//! Åström, K. J., and Hägglund, T., 2006, Advanced PID Control, section 2.4 (processes with
//! self-regulation).

use crate::experiment::{Property, Record, Trial};
use crate::numerics::PairSums;
use crate::units::floor_to_index;

/// Squared correlation of output and input from which the output follows the input. Chosen: of
/// measured machines, servos and speeds have 0.94 and more, angles and positions that are driven
/// by a speed 0.36 and less.
const FOLLOWS: f64 = 0.7;

/// Samples that a correlation needs, and fewer ones of which it needs [`FOLLOWS_CLOSELY`]. Chosen: of
/// a hundred samples of two random walks one pair in fifty has as much.
const ENOUGH_SAMPLES: usize = 200;
const FEWEST: usize = 100;
const FOLLOWS_CLOSELY: f64 = 0.9;

/// The lag in samples at which the output follows the input best, and the squared correlation
/// there; none where it does not follow it.
pub(crate) fn followed(record: &Record) -> Option<(usize, f64)> {
    record.property::<Followed>().0
}

struct Followed(Option<(usize, f64)>);

impl Property for Followed {
    fn find(record: &Record) -> Self {
        Self(best_lag(record))
    }
}

fn best_lag(trials: &[Trial]) -> Option<(usize, f64)> {
    let samples: usize = trials.iter().map(Trial::len).sum();
    if samples < FEWEST {
        return None;
    }
    let best = |of: fn(f64) -> f64| {
        let tried = lags(trials).map(|lag| (lag, correlation(trials, lag, of)));
        tried.max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let least = if samples < ENOUGH_SAMPLES { FOLLOWS_CLOSELY } else { FOLLOWS };
    let follows = best(|input| input).filter(|(_, squared)| *squared >= least)?;
    // A joint that runs into its stops follows the sign of its input just as well.
    (follows.1 > best(sign)?.1).then_some(follows)
}

/// Samples by which the output may lag.
fn lags(trials: &[Trial]) -> impl Iterator<Item = usize> + use<> {
    /// Longest lag as a part of the shortest trial, and each lag of the one before.
    const PART: usize = 10;
    const RATIO: f64 = 1.25;
    let longest = trials.iter().map(Trial::len).min().unwrap_or(0) / PART;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small, above 0")]
    let next = |lag: &usize| Some((*lag as f64 * RATIO) as usize + 1);
    std::iter::successors(Some(0), next).take_while(move |lag| *lag <= longest)
}

/// Squared correlation of the output with what `of` makes of the input `lag` samples before.
fn correlation(trials: &[Trial], lag: usize, of: fn(f64) -> f64) -> f64 {
    let mut sums = PairSums::default();
    for trial in trials {
        let behind = trial.output().get(lag..).unwrap_or_default();
        let pairs = trial.input().iter().zip(behind);
        pairs.for_each(|(input, output)| sums.push(of(*input), *output));
    }
    sums.r_squared()
}

fn sign(input: f64) -> f64 {
    if input == 0.0 { 0.0 } else { input.signum() }
}

/// A first order `T y' + y = K u(t − τ) + y0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FirstOrder {
    pub(crate) time_constant_s: f64,
    pub(crate) dead_time_s: f64,
    pub(crate) static_gain: f64,
    pub(crate) at_zero: f64,
}

impl Property for Option<FirstOrder> {
    fn find(record: &Record) -> Self {
        /// Times of 1.5 each, from two samples on.
        const COUNT: usize = 16;
        // The whole lag is a dead time and the time constant after it.
        let (longest, _) = followed(record)?;
        Some(best(record, longest, f64::INFINITY, COUNT)?.0)
    }
}

impl FirstOrder {
    /// The one that the output of a joint follows best; none where it does not follow the input.
    pub(crate) fn of(record: &Record) -> Option<Self> {
        *record.property()
    }

    /// Where the output settles at `input`.
    pub(crate) fn settled_at(&self, input: f64) -> f64 {
        self.at_zero + self.static_gain * input
    }

    /// Seconds after which the output has settled to 5 %.
    pub(crate) fn settling_s(&self) -> f64 {
        /// Time constants: ln 20.
        const CONSTANTS: f64 = 3.0;
        self.dead_time_s + CONSTANTS * self.time_constant_s
    }

    /// Where a fit of a first order may start, though the input alone does not show one: its time
    /// constant may be as long as a quarter of the record, if the input moves about enough.
    pub(crate) fn likely(trials: &[Trial]) -> Option<Self> {
        /// Samples that are looked at, and time constants (chosen).
        const ENOUGH: usize = 50_000;
        const COUNT: usize = 40;
        const PART: f64 = 0.25;
        /// Squared correlation (chosen).
        const LIKELY: f64 = 0.7;
        let mut left = ENOUGH;
        let parts = trials.iter().map_while(|trial| {
            let part = trial.part(0, trial.len().min(left));
            left = left.saturating_sub(trial.len());
            part
        });
        let trials: Vec<Trial> = parts.collect();
        let longest = trials.iter().max_by_key(|trial| trial.len())?;
        let longest_s = PART * longest.len() as f64 * longest.period().seconds();
        let (found, squared) = best(&trials, usize::MAX, longest_s, COUNT)?;
        let dead = floor_to_index(found.dead_time_s / longest.period().seconds());
        let of_sign = lagging(&trials, found.time_constant_s, dead, sign).r_squared();
        (squared >= LIKELY && squared > of_sign).then_some(found)
    }
}

/// The first order with a dead time of at most `longest` samples that explains the output best, of
/// `count` time constants up to so many seconds; and the squared correlation.
fn best(
    trials: &[Trial],
    longest: usize,
    longest_s: f64,
    count: usize,
) -> Option<(FirstOrder, f64)> {
    /// Time constants: the shortest in sample periods, each of the one before.
    const SHORTEST: f64 = 2.0;
    const RATIO: f64 = 1.5;
    let dead = || lags(trials).take_while(|lag| *lag <= longest);
    let periods = trials.iter().map(|trial| trial.period().seconds());
    let period_s = periods.fold(0.0, f64::max);
    let times = std::iter::successors(Some(SHORTEST * period_s), |time| Some(RATIO * time));
    let times = times.take_while(|time| *time <= longest_s).take(count);
    let pairs = times.flat_map(|time_s| dead().map(move |lag| (time_s, lag)));
    let tried = pairs.map(|(time_s, lag)| (time_s, lag, lagging(trials, time_s, lag, |u| u)));
    let best = tried.max_by(|a, b| a.2.r_squared().total_cmp(&b.2.r_squared()));
    let (time_constant_s, lag, sums) = best?;
    let (static_gain, at_zero) = sums.line();
    let dead_time_s = lag as f64 * period_s;
    Some((FirstOrder { time_constant_s, dead_time_s, static_gain, at_zero }, sums.r_squared()))
}

/// How the output goes with what `of` makes of the input `dead` samples before, after a lag of the
/// first order.
fn lagging(trials: &[Trial], time_s: f64, dead: usize, of: fn(f64) -> f64) -> PairSums {
    let mut sums = PairSums::default();
    for trial in trials {
        let left = (-trial.period().seconds() / time_s).exp();
        let mut state = trial.input().first().copied().map_or(0.0, of);
        let behind = trial.output().get(dead..).unwrap_or_default();
        for (input, output) in trial.input().iter().zip(behind) {
            sums.push(state, *output);
            // The exact step of T y′ + y = u for an input held over the sample.
            state = of(*input) + (state - of(*input)) * left;
        }
    }
    sums
}
