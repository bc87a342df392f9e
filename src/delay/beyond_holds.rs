//! Delays that are longer than the holds of the input, seen over the whole record.
//!
//! The search for a breakpoint looks at one step at a time. Where a joint reacts later than the
//! next step, what moves in a segment answers an earlier step, and its delay to the step of the
//! segment is a number without meaning. Over the record the two are separable: with the increments
//! of the output over blocks of a tenth of a hold, regressed on the input of `lag` blocks before,
//!
//! ```text
//! y_(b+1) − y_b = c_0 + c_1 max(u_(b−lag), 0) + c_2 min(u_(b−lag), 0) + e_b
//! ```
//!
//! `Σ e²` has its minimum at the delay, and the levels of other steps explain little.

use super::input_motion::InputMotion;
use super::steps::are_strokes;
use crate::experiment::{Record, Trial};
use crate::numerics::{Regression, median};

/// Blocks in a hold.
const PER_HOLD: usize = 10;

/// Longest delay that is looked for, in holds.
const LONGEST: usize = 8;

/// Fewest blocks of a record of which something can be said.
const FEWEST: usize = 100;

/// The delay is longer than this part of a hold, others shorter than that. Chosen: between the two
/// a segment holds a reaction to its own step.
const LONG: f64 = 0.8;
const SHORT: f64 = 0.5;

/// What the long delay leaves unexplained at most, and the best short one at least. A lag, whatever
/// its time constant, is not so sharp.
const EXPLAINED: f64 = 0.2;
const UNEXPLAINED: f64 = 0.5;

/// The delay over a record in seconds, where it is longer than most holds of the input
/// and not to be mistaken for a short one; none elsewhere.
pub(crate) fn delay_beyond_holds(trials: &Record) -> Option<f64> {
    if InputMotion::of(trials).is_continuous() || are_strokes(trials) {
        return None;
    }
    let hold = median(&trials.iter().flat_map(holds).collect::<Vec<f64>>())?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "samples")]
    let block = (hold as usize / PER_HOLD).max(1);
    let blocks: Vec<Blocks> = trials.iter().map(|trial| Blocks::of(trial, block)).collect();
    let longest = LONGEST * PER_HOLD;
    let rows: usize = blocks.iter().map(|of| of.increments.len().saturating_sub(longest)).sum();
    if rows < FEWEST {
        return None;
    }
    let total = unexplained(&blocks, longest, None);
    let shares: Vec<f64> =
        (0..=longest).map(|lag| unexplained(&blocks, longest, Some(lag)) / total).collect();
    let in_holds = |lag: usize| (lag * block) as f64 / hold;
    let (lag, least) = shares.iter().copied().enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let short = (0..=longest).filter(|lag| in_holds(*lag) <= SHORT).map(|lag| shares[lag]);
    let is_long = in_holds(lag) > LONG && least < EXPLAINED;
    let period_s = trials.first()?.period().seconds();
    (is_long && short.fold(f64::INFINITY, f64::min) > UNEXPLAINED)
        .then(|| (lag * block) as f64 * period_s)
}

/// Samples for which each level of the input is held.
fn holds(trial: &Trial) -> Vec<f64> {
    let runs = trial.input().chunk_by(|a, b| a.to_bits() == b.to_bits());
    let mut holds: Vec<f64> = runs.map(|run| run.len() as f64).collect();
    // The last one may have gone on.
    holds.pop();
    holds
}

/// A trial in blocks.
struct Blocks {
    /// Of the output, from each block's first sample to the next one's.
    increments: Vec<f64>,
    /// Means of the input, above and below zero.
    above: Vec<f64>,
    below: Vec<f64>,
}

impl Blocks {
    fn of(trial: &Trial, block: usize) -> Self {
        let firsts: Vec<f64> = trial.output().iter().step_by(block).copied().collect();
        let mean = |part: fn(f64) -> f64| -> Vec<f64> {
            let chunks = trial.input().chunks_exact(block);
            chunks.map(|chunk| chunk.iter().map(|u| part(*u)).sum::<f64>() / block as f64).collect()
        };
        let mut increments: Vec<f64> = firsts.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let (above, below) = (mean(|u| u.max(0.0)), mean(|u| u.min(0.0)));
        increments.truncate(above.len());
        Self { increments, above, below }
    }
}

/// The squared error of the increments after the first `skipped` blocks, on the input `lag` blocks
/// before, or on a constant.
fn unexplained(blocks: &[Blocks], skipped: usize, lag: Option<usize>) -> f64 {
    let long = || blocks.iter().filter(|of| of.increments.len() > skipped);
    let target: Vec<Vec<f64>> = long().map(|of| of.increments[skipped..].to_vec()).collect();
    let constant: Vec<Vec<f64>> = target.iter().map(|rows| vec![1.0; rows.len()]).collect();
    // Every lag over the same blocks.
    let column = |part: fn(&Blocks) -> &Vec<f64>, lag: usize| -> Vec<Vec<f64>> {
        long().map(|of| part(of)[skipped - lag..of.increments.len() - lag].to_vec()).collect()
    };
    let driven = lag.map(|lag| [column(|of| &of.above, lag), column(|of| &of.below, lag)]);
    let columns: Vec<_> = std::iter::once(&constant).chain(driven.iter().flatten()).collect();
    Regression::of(&target, &columns).error.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::uniform;
    use crate::units::SamplePeriod;

    /// An integrator that reacts `delay` samples late, through a lag of `lag` samples, to levels
    /// that are held for 100 to 200 samples.
    fn trial(delay: usize, lag: f64) -> Trial {
        // From -0.5 to 0.5.
        let mut random = uniform(7);
        let mut input = vec![0.0; 50];
        while input.len() < 9000 {
            let level = 10.0 * random();
            let more = 100.0 * (random() + 0.5);
            let held = 100 + (0..100).filter(|part| f64::from(*part) < more).count();
            input.extend(std::iter::repeat_n(level, held));
        }
        let (mut angle, mut speed, mut output) = (0.0, 0.0, Vec::new());
        for k in 0..input.len() {
            output.push(angle + 0.04 * random());
            let drive = 10.0 * input[k.saturating_sub(delay)];
            speed += (drive - speed) / (1.0 + lag);
            angle += 0.01 * speed;
        }
        Trial::new("1", 0.0, SamplePeriod::from_seconds(0.01).unwrap(), input, output).unwrap()
    }

    fn found(trial: Trial) -> Option<f64> {
        let trials = [trial];
        delay_beyond_holds(&trials.into())
    }

    #[test]
    fn a_delay_longer_than_the_holds_is_seen() {
        for delay in [140, 200, 450] {
            let found = found(trial(delay, 0.0)).unwrap();
            assert!((found - 0.01 * delay as f64).abs() < 0.11, "{delay}: {found}");
        }
    }

    #[test]
    fn short_delays_and_long_lags_are_not_taken_for_one() {
        for (delay, lag) in [(0, 0.0), (15, 0.0), (60, 0.0), (15, 40.0), (15, 150.0), (15, 400.0)] {
            assert_eq!(found(trial(delay, lag)), None, "{delay}, {lag}");
        }
    }
}
