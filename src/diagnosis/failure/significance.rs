//! Whether a condition holds more of the error than chance would put there.
//!
//! A residual is correlated: its large values come in runs, and some condition will always
//! seem to hold them. So the record is cut into blocks, the blocks are put in another
//! order and each is turned round by a random part of its length; the runs stay, their
//! place is lost. The best condition for such a record is what chance gives. A condition
//! counts when almost no shuffled record has one as good, whatever it says, so that the
//! number of conditions tried is accounted for.
//!
//! # References
//! P. Good, "Permutation, Parametric and Bootstrap Tests of Hypotheses", 3rd ed. (2005);
//! D. N. Politis, J. P. Romano, "A circular
//! block-resampling procedure for stationary data" (1992); B. Phipson, G. K. Smyth,
//! "Permutation p-values should never be zero" (2010).

use std::ops::Range;

use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::grid::{BestScores, Family, Grid};
use super::record::{ResidualRecord, Row, of_row};

/// Shuffled records that a condition is held against.
const SHUFFLES: u32 = 199;

/// The largest p-value that counts.
const LEVEL: f64 = 0.01;

/// Shuffles whose best condition may be as good: p is then (1 + 1)/(1 + 199), the level.
const ALLOWED: u32 = 1;

/// Blocks below which there are too few orders for a p-value.
const MIN_BLOCKS: usize = 8;

/// A block lasts this many correlation times, if that leaves [`MERGED`] blocks.
const CORRELATION_TIMES: f64 = 5.0;

/// Blocks that merging segments leaves at least.
const MERGED: usize = 40;

/// No block is longer than one of so many parts of the record.
const PARTED: usize = 20;

/// Correlation below which signs count as independent.
const INDEPENDENT: f64 = 0.05;

/// Any number does; the same record is to give the same answer.
const SEED: u64 = 0x7A05_C09E;

/// The block of each sample.
///
/// Blocks are the segments. Where those are short against the residual's correlation time
/// neighbours are merged; where they are long against the record they are parted.
pub(super) fn blocks(record: &ResidualRecord) -> Vec<u32> {
    let samples = record.len();
    let enough = (samples / MERGED).max(1);
    // Within a block the correlation stays as it is.
    let shortest = correlation_time(&record.samples().residual, enough);
    let shortest = shortest.min(enough);
    let longest = (samples / PARTED).max(1);
    let mut block_of = Vec::with_capacity(samples);
    let mut block = 0;
    // Four bytes for each sample, of which there may be tens of millions.
    let numbered = |block: usize| u32::try_from(block).unwrap_or(u32::MAX);
    for span in merged(record, shortest) {
        let parts = span.len().div_ceil(longest).max(1);
        let length = span.len().div_ceil(parts).max(1);
        block_of.extend((0..span.len()).map(|offset| numbered(block + offset / length)));
        block += parts;
    }
    block_of
}

/// The spans between the segments' borders, merged until each has `shortest` samples.
fn merged(record: &ResidualRecord, shortest: usize) -> Vec<Range<usize>> {
    let mut spans: Vec<Range<usize>> = Vec::new();
    let mut start = 0;
    let borders = record.segments().iter().flat_map(|span| [span.start, span.end]);
    for border in borders.chain([record.len()]) {
        if border >= start + shortest {
            spans.push(start..border);
            start = border;
        }
    }
    match spans.last_mut() {
        Some(last) => last.end = record.len(),
        None => spans.push(0..record.len()),
    }
    spans
}

/// Five times the samples over which the sign of the residual is correlated, at most
/// `most`: `5 (1 + 2 Σ ρ_k)` up to the first lag whose `ρ_k` is small.
///
/// Signs about the median do not feel that the residual is larger in some places.
fn correlation_time(residual: &[f64], most: usize) -> usize {
    let mut sorted = residual.to_vec();
    let middle = sorted.len() / 2;
    if sorted.is_empty() {
        return 1;
    }
    let (_, &mut median, _) = sorted.select_nth_unstable_by(middle, f64::total_cmp);
    let signs: Vec<i32> = residual.iter().map(|r| if *r > median { 1 } else { -1 }).collect();
    let mut time = 1.0;
    for lag in 1..=most.min(signs.len() - 1) {
        let pairs = signs.iter().zip(&signs[lag..]);
        let sum: i32 = pairs.map(|(a, b)| a * b).sum();
        let correlation = f64::from(sum) / (signs.len() - lag) as f64;
        if correlation < INDEPENDENT {
            break;
        }
        // 1 + 2 Σ ρ_k.
        time += 2.0 * correlation;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few samples")]
    let samples = (CORRELATION_TIMES * time).ceil() as usize;
    samples.min(most).max(1)
}

/// Part of the rows in which an axis stays in one part: how many rows there are up to its end, and
/// the part. Of a feature that is noise there are as many as rows.
type Run = (Row, u8);

/// The best scores that chance gives.
pub(super) struct Chance {
    best: Vec<BestScores>,
}

impl Chance {
    /// `p = (1 + shuffles that are as good) / (1 + shuffles)`; none above the level.
    pub(super) fn p_value(&self, family: Family, score: f64) -> Option<f64> {
        let as_good = self.best.iter().filter(|best| best[family as usize] >= score).count();
        let p_value = (1.0 + as_good as f64) / (1.0 + self.best.len() as f64);
        (p_value <= LEVEL).then_some(p_value)
    }
}

/// The squared error of each row beyond an even spread, as shares of that of all rows.
pub(super) struct Excess<'a> {
    shares: &'a [f64],
    /// One over the sum of the shares of the rows.
    scale: f64,
    even: f64,
}

impl<'a> Excess<'a> {
    /// From the `shares` of all samples of a record; none where those of `rows` are 0.
    pub(super) fn new(shares: &'a [f64], rows: &[Row]) -> Option<Self> {
        let total: f64 = rows.iter().map(|row| of_row(shares, *row)).sum();
        (total > 0.0).then(|| Self { shares, scale: total.recip(), even: 1.0 / rows.len() as f64 })
    }

    pub(super) fn of(&self, row: Row) -> f64 {
        of_row(self.shares, row) * self.scale - self.even
    }
}

/// Rows of a record, ready to be shuffled.
pub(super) struct Shuffler<'a> {
    grid: &'a Grid,
    /// Of each row: it is read in each shuffle.
    excess: Vec<f64>,
    blocks: Vec<Range<usize>>,
    runs: Vec<Vec<Run>>,
}

impl<'a> Shuffler<'a> {
    /// `excess` of the samples `rows`; `block_of` every sample.
    pub(super) fn new(grid: &'a Grid, rows: &[Row], excess: &Excess<'_>, block_of: &[u32]) -> Self {
        let mut blocks = Vec::new();
        let mut start = 0;
        for block in rows.chunk_by(|a, b| of_row(block_of, *a) == of_row(block_of, *b)) {
            blocks.push(start..start + block.len());
            start += block.len();
        }
        let runs = grid.axes.iter().map(|axis| runs(rows, &axis.part_of)).collect();
        let excess = rows.iter().map(|row| excess.of(*row)).collect();
        Self { grid, excess, blocks, runs }
    }

    /// The best scores of all shuffled records, if a condition of `family` that scores
    /// `score` stands out from them; none either when there are too few blocks.
    pub(super) fn stands_out(&self, family: Family, score: f64) -> Option<Chance> {
        if self.blocks.len() < MIN_BLOCKS {
            return None;
        }
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        let mut order: Vec<usize> = (0..self.blocks.len()).collect();
        let mut cumulative = Vec::with_capacity(self.excess.len() + 1);
        let mut best = Vec::new();
        let mut as_good = 0;
        for _ in 0..SHUFFLES {
            self.shuffle(&mut order, &mut random, &mut cumulative);
            let scores = self.grid.best_scores(&self.part_sums(&cumulative));
            as_good += u32::from(scores[family as usize] >= score);
            // Two of 199 as good: p = 3/200 > LEVEL, whatever follows.
            if as_good > ALLOWED {
                return None;
            }
            best.push(scores);
        }
        Some(Chance { best })
    }

    /// Cumulative sums of the excess in a new order.
    fn shuffle(&self, order: &mut [usize], random: &mut ChaCha8Rng, cumulative: &mut Vec<f64>) {
        for last in (1..order.len()).rev() {
            // Fisher and Yates.
            order.swap(last, below(random, last + 1));
        }
        let mut sum = 0.0;
        cumulative.clear();
        cumulative.push(sum);
        for &block in order.iter() {
            let block = &self.excess[self.blocks[block].clone()];
            // Turned round within itself.
            let (front, back) = block.split_at(below(random, block.len()));
            for part in [back, front] {
                cumulative.extend(part.iter().map(|excess| {
                    sum += excess;
                    sum
                }));
            }
        }
    }

    fn part_sums(&self, cumulative: &[f64]) -> Vec<Vec<f64>> {
        let sum = |(runs, parts): (&Vec<Run>, usize)| {
            let mut sums = vec![0.0; parts + 1];
            let mut before = 0.0;
            for &(end, part) in runs {
                let here = of_row(cumulative, end);
                sums[usize::from(part)] += here - before;
                before = here;
            }
            sums
        };
        let parts = self.grid.axes.iter().map(super::axis::Axis::parts);
        self.runs.iter().zip(parts).map(sum).collect()
    }
}

fn runs(rows: &[Row], part_of: &[u8]) -> Vec<Run> {
    let mut end: Row = 0;
    let same = rows.chunk_by(|a, b| of_row(part_of, *a) == of_row(part_of, *b));
    let run = same.map(|rows| {
        end += Row::try_from(rows.len()).unwrap_or(Row::MAX);
        (end, rows.first().map_or(0, |row| of_row(part_of, *row)))
    });
    run.collect()
}

/// A number below `end`; even to a part in 2³² of it.
fn below(random: &mut ChaCha8Rng, end: usize) -> usize {
    let product = u64::from(random.next_u32()) * end as u64;
    usize::try_from(product >> 32).unwrap_or(0)
}
