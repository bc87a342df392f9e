//! The period of a clock: a first guess, and the least-squares period.

use super::run::{JUMP, LOST_SHARE, Run, not_increasing, single_row};
use crate::experiment::error::{ReadError, ReadErrorKind};
use crate::numerics::median;

/// Changes of stamps that are rounded to several periods, from which the period follows: two whole
/// grains, of which the number of rows is known.
const FEWEST_STAMPS: usize = 3;

/// The period before it is fitted, and what stamps are rounded to.
pub(super) struct Typical {
    pub(super) seconds: f64,
    /// The grain of the stamps where it is above half a period; else 0.
    pub(super) grain_s: f64,
}

impl Typical {
    /// Whether several rows share a stamp.
    pub(super) fn is_coarse(&self) -> bool {
        self.grain_s > 2.0 * self.seconds
    }
}

/// The mean of the steps that are no jumps. Stamps that are rounded may stand still.
pub(super) fn typical_period(times: &[f64]) -> Result<Typical, ReadError> {
    let steps = times.windows(2).map(|pair| pair[1] - pair[0]);
    let forward: Vec<f64> = steps.clone().filter(|step| *step > 0.0).collect();
    if times.len() < 2 {
        return Err(single_row());
    }
    let middle = median(&forward).ok_or_else(|| not_increasing(times, 1))?;
    if let Some(found) = rounded_period(times, &forward) {
        return Ok(found);
    }
    let even: Vec<f64> = steps.filter(|step| (0.0..=JUMP * middle).contains(step)).collect();
    // Rows that are there twice are few; stamps that are rounded stand still often.
    let still = even.iter().filter(|step| **step < middle * 1e-3).count();
    let rounded = still as f64 > LOST_SHARE * even.len() as f64;
    let counted = even.len() - if rounded { 0 } else { still };
    let seconds = even.iter().sum::<f64>() / counted.max(1) as f64;
    let grain = forward.iter().copied().fold(f64::INFINITY, f64::min);
    let is_multiple = |step: &f64| ((step / grain) - (step / grain).round()).abs() < 1e-3;
    let coarse = grain > 0.5 * seconds && rounded && forward.iter().all(is_multiple);
    Ok(Typical { seconds, grain_s: if coarse { grain } else { 0.0 } })
}

/// The period of `times` without a gap that are rounded to a grain of less than it, as 32-bit numbers
/// are far from zero: one grain apart or two, which looks like rows that are lost, but all of them
/// within a grain of one line.
fn rounded_period(times: &[f64], forward: &[f64]) -> Option<Typical> {
    /// Part of the steps that must be of one grain, and of two: else the period is a grain.
    const PART: f64 = 0.05;
    /// How far times lie apart about the line, in grains; of rounding it is one.
    const APART: f64 = 1.1;
    /// Part of a grain that a step may be off a multiple.
    const OFF: f64 = 1e-3;
    let grain = forward.iter().copied().fold(f64::INFINITY, f64::min);
    let of = |grains: f64| {
        let count = forward.iter().filter(|step| (**step / grain - grains).abs() < OFF).count();
        count as f64 / forward.len() as f64
    };
    let (one, two) = (of(1.0), of(2.0));
    if one.min(two) < PART || one + two < 1.0 || forward.len() + 1 < times.len() {
        return None;
    }
    let rows = times.len() as f64;
    let (middle, mean) = (0.5 * (rows - 1.0), times.iter().sum::<f64>() / rows);
    let points = || times.iter().zip(0_u32..).map(|(time, k)| (f64::from(k) - middle, time - mean));
    let products: f64 = points().map(|(place, time)| place * time).sum();
    let seconds = products / points().map(|(place, _)| place * place).sum::<f64>();
    let ends = points().map(|(place, time)| time - seconds * place);
    let (low, high) = ends.fold((f64::MAX, f64::MIN), |(l, h), off| (l.min(off), h.max(off)));
    (high - low <= APART * grain).then_some(Typical { seconds, grain_s: grain })
}

/// The slope of stamps over places that all `runs` share.
///
/// Of stamps that are rounded to several periods only the rows count at which they change: when
/// these were measured is known to a period, of the others to a grain.
pub(super) fn least_squares_period(
    runs: &[Run],
    times: &[f64],
    typical: &Typical,
) -> Result<f64, ReadError> {
    let stamps: usize = runs.iter().map(|run| known_to_a_period(run, times, typical).count()).sum();
    if typical.is_coarse() && stamps < FEWEST_STAMPS {
        let (rows, stamps, grain_s) = (times.len(), stamps + runs.len(), typical.grain_s);
        let text = format!(
            "the {rows} rows of this trial have only {stamps} different times, {grain_s} s apart: too few to \
             determine the sample period; write times as 64-bit numbers or with more digits"
        );
        return Err(ReadError::new(ReadErrorKind::Times, text).at_index(0));
    }
    let (mut products, mut squares) = (0.0, 0.0);
    for run in runs {
        let points = || known_to_a_period(run, times, typical);
        let n = points().count() as f64;
        let place = points().map(|(place, _)| place).sum::<f64>() / n;
        let time = points().map(|(_, time)| time).sum::<f64>() / n;
        for (x, t) in points() {
            products += (x - place) * (t - time);
            squares += (x - place) * (x - place);
        }
    }
    let period = products / squares;
    if period.is_finite() && period > 0.0 { Ok(period) } else { Err(single_row()) }
}

/// Places and stamps of the rows of `run` whose stamps say when they were measured.
fn known_to_a_period<'a>(
    run: &'a Run,
    times: &'a [f64],
    typical: &Typical,
) -> impl Iterator<Item = (f64, f64)> + 'a {
    let is_coarse = typical.is_coarse();
    let mut before = None;
    run.points(times).filter(move |(_, time)| {
        // When the first stamp began is not known.
        let changes = before.replace(*time).is_some_and(|before: f64| before < *time);
        !is_coarse || changes
    })
}
