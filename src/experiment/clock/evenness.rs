//! How far stamps are from an even grid, and what that makes of the clock.

use super::period::Typical;
use super::run::{LOST_SHARE, Run};
use crate::experiment::error::{ReadError, ReadErrorKind};
use crate::numerics::{median, quantile};

/// Rows whose stamps lie within this part of a period of the even grid stay as they are; what
/// interpolating them would add is of the same size as what it would mend.
const KEPT: f64 = 0.25;

/// Part of the rows that must lie within it: single stamps may be late by any amount.
const KEPT_SHARE: f64 = 0.95;

/// Rows of a block, over which the slow drift of the clock is its median.
const BLOCK: usize = 50;

/// Largest drift from block to block, as a part of the time between them, and the period's
/// own tolerance: the same as of a clock without jitter.
const DRIFT: f64 = 0.01;

/// What the stamps of a trial are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::experiment) enum Evenness {
    /// Each step is the period, or several where rows are lost.
    Uniform,
    /// The stamps jitter about an even grid.
    Jitters,
    /// The stamps are rounded to so many seconds, which is more than half a period.
    Rounded { to_s: f64 },
    /// The sampling itself is uneven.
    Uneven,
}

/// How far stamps are from the even grid, in periods.
pub(super) struct Deviations {
    /// Beside the slow drift, of every row of every run.
    jitter: Vec<(f64, usize)>,
    /// Largest change of the drift from block to block, as a part of the time between them.
    rate: f64,
}

impl Deviations {
    pub(super) fn of(runs: &[Run], times: &[f64], period: f64, typical: &Typical) -> Self {
        let block = block_rows(typical, period);
        let mut all = Self { jitter: Vec::new(), rate: 0.0 };
        for run in runs {
            let start = run.start_s(times, period);
            let whole: Vec<f64> =
                run.points(times).map(|(place, time)| (time - start) / period - place).collect();
            let mut blocks: Vec<f64> = whole.chunks(block).filter_map(median).collect();
            // Of part of a grain, the median is no drift.
            if typical.is_coarse() && blocks.len() > 1 && !whole.len().is_multiple_of(block) {
                blocks.pop();
            }
            for pair in blocks.windows(2) {
                all.rate = all.rate.max((pair[1] - pair[0]).abs() / block as f64);
            }
            for (k, (deviation, &row)) in whole.iter().zip(&run.rows).enumerate() {
                let drift = between_blocks(&blocks, block, k);
                all.jitter.push((deviation - drift, row));
            }
        }
        all
    }

    pub(super) fn deviation(&self) -> f64 {
        let squares = self.jitter.iter().map(|(jitter, _)| jitter * jitter).sum::<f64>();
        (squares / self.jitter.len().max(1) as f64).sqrt()
    }

    pub(super) fn largest(&self) -> (f64, usize) {
        let sizes = self.jitter.iter().map(|(jitter, row)| (jitter.abs(), *row));
        sizes.fold((0.0, 0), |largest, one| if one.0 > largest.0 { one } else { largest })
    }

    /// From the least to the largest jitter, without the few beyond [`KEPT_SHARE`].
    fn range(&self) -> f64 {
        let jitter: Vec<f64> = self.jitter.iter().map(|(jitter, _)| *jitter).collect();
        let beyond = 0.5 * (1.0 - KEPT_SHARE);
        let ends = quantile(&jitter, 1.0 - beyond).zip(quantile(&jitter, beyond));
        ends.map_or(f64::INFINITY, |(high, low)| high - low)
    }

    pub(super) fn evenness(
        &self,
        runs: &[Run],
        typical: &Typical,
        period: f64,
    ) -> Result<Evenness, ReadError> {
        let sizes: Vec<f64> = self.jitter.iter().map(|(jitter, _)| jitter.abs()).collect();
        let within = |limit: f64| quantile(&sizes, KEPT_SHARE).is_some_and(|size| size <= limit);
        let rows: usize = runs.iter().map(|run| run.rows.len()).sum();
        let places = runs.iter().filter_map(|run| run.places.last()).map(|last| last + 1);
        let whole = (1.0 - LOST_SHARE) * places.sum::<usize>() as f64 <= rows as f64;
        // Where rounded stamps change is known to a period.
        let known =
            if typical.is_coarse() { 1.5 / block_rows(typical, period) as f64 } else { 0.0 };
        let steady = whole && self.rate <= DRIFT.max(known);
        // Rounding moves a stamp by up to half a grain either way, about a line that is off by part of
        // one where there are few.
        let rounding = 0.55 * typical.grain_s / period;
        let is_one_grain = typical.is_coarse() && self.range() <= 2.0 * rounding;
        if steady && typical.grain_s > 0.0 && (within(rounding.max(KEPT)) || is_one_grain) {
            return Ok(Evenness::Rounded { to_s: typical.grain_s });
        }
        if typical.grain_s > 2.0 * period {
            let (_, row) = self.largest();
            let grain_s = typical.grain_s;
            let text = format!(
                "the times are rounded to {grain_s} s, with an uneven number of samples (about {:.0}) at each, \
                 so the time of a sample is not known; write times with more digits",
                grain_s / period
            );
            return Err(ReadError::new(ReadErrorKind::Times, text).at_index(row));
        }
        Ok(if steady && within(KEPT) { Evenness::Jitters } else { Evenness::Uneven })
    }
}

/// Rows of a block: whole grains of stamps that are rounded, whose sawtooth is no drift.
fn block_rows(typical: &Typical, period: f64) -> usize {
    let grain = crate::units::floor_to_index((typical.grain_s / period).round()).max(1);
    grain.saturating_mul(BLOCK.div_ceil(grain))
}

/// The drift at row `k` of a run: the line between the medians of its blocks.
fn between_blocks(blocks: &[f64], block: usize, k: usize) -> f64 {
    let center = (k as f64 + 0.5) / block as f64 - 0.5;
    let last = blocks.len().saturating_sub(1);
    let index = crate::units::floor_to_index(center).min(last);
    let (Some(&from), Some(&to)) = (blocks.get(index), blocks.get((index + 1).min(last))) else {
        return 0.0;
    };
    from + (center - index as f64).clamp(0.0, 1.0) * (to - from)
}
