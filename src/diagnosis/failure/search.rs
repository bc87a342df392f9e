//! The search for the conditions that hold most of an error.

use super::feature::Feature;
use super::grid::{Grid, Selection};
use super::record::{ResidualRecord, Row, of_row};
use super::significance::{Excess, Shuffler, blocks};

/// The gain below which a condition is not worth acting on.
pub(super) const MIN_GAIN: f64 = 0.1;

/// What a second clause must add to the gain to be worth reading.
const CLAUSE_COST: f64 = 0.05;

/// A record made ready to be searched.
#[derive(Debug)]
pub(super) struct Search {
    pub(super) grid: Grid,
    block_of: Vec<u32>,
    shares: Vec<f64>,
}

impl Search {
    /// `shares` of the squared error for each sample of `record`.
    pub(super) fn new(record: &ResidualRecord, shares: Vec<f64>) -> Self {
        Self { grid: Grid::of(record, |_| true), block_of: blocks(record), shares }
    }

    /// The best clause for the samples `rows` that chance does not explain, with a second one among
    /// its samples where that adds enough, and the larger of their p-values.
    pub(super) fn best(&self, rows: &[Row]) -> Option<(Vec<Selection>, f64)> {
        let (first, p_value) = self.best_clause(rows, |_| true)?;
        let inside = self.grid.members(&[first], rows.iter().copied());
        let wanted = self.gain_among(rows, &inside) + CLAUSE_COST;
        let adds_enough = |second: Selection| {
            let both = self.grid.members(&[second], inside.iter().copied());
            self.gain_among(rows, &both) > wanted
        };
        let Some((second, of_second)) = self.best_clause(&inside, adds_enough) else {
            return Some((vec![first], p_value));
        };
        let selections = if first.axis == second.axis {
            let (from, to) = (first.from.max(second.from), first.to.min(second.to));
            vec![Selection { from, to, ..first }]
        } else if first.axis < second.axis {
            vec![first, second]
        } else {
            vec![second, first]
        };
        Some((selections, p_value.max(of_second)))
    }

    /// The best clause for the samples `rows`, where it `is_worth` more than chance, with its p-value.
    fn best_clause(
        &self,
        rows: &[Row],
        is_worth: impl Fn(Selection) -> bool,
    ) -> Option<(Selection, f64)> {
        let excess = Excess::new(&self.shares, rows)?;
        let (best, score) = self.grid.best(&self.grid.part_sums(rows, |row| excess.of(row)));
        let best = best.filter(|best| is_worth(*best))?;
        let p_value = Shuffler::new(&self.grid, rows, &excess, &self.block_of).p_value(score)?;
        Some((best, p_value))
    }

    /// Share of the squared error in the samples `rows`.
    pub(super) fn share(&self, rows: &[Row]) -> f64 {
        // Σ_S e²/Σ e².
        rows.iter().map(|row| of_row(&self.shares, *row)).sum()
    }

    /// Share of the squared error minus share of the time, of the whole record.
    pub(super) fn gain(&self, rows: &[Row]) -> f64 {
        // J(S).
        self.share(rows) - rows.len() as f64 / self.shares.len() as f64
    }

    /// Whether the error in the samples `rows` is hardly more than their share of the squared
    /// speed: what is wrong there is the gain.
    pub(super) fn only_moves(&self, record: &ResidualRecord, rows: &[Row]) -> bool {
        let square = |row: &Row| of_row(&record.samples().speed, *row).powi(2);
        let all: f64 = record.samples().speed.iter().map(|v| v * v).sum();
        let here: f64 = rows.iter().map(square).sum();
        self.share(rows) - here / all.max(f64::MIN_POSITIVE) < MIN_GAIN
    }

    /// The search for where the error over the speed is large, among the samples `rows`, by
    /// what does not say how fast the joint is driven.
    ///
    /// The squared error is over `v² + 0.2 mean v²`: what noise adds does not depend on the
    /// speed, and over that of the slowest samples it would be most of all.
    pub(super) fn relative(&self, record: &ResidualRecord, rows: &[Row]) -> Option<Self> {
        const FLOOR: f64 = 0.2;
        let square = |row: &Row| of_row(&record.samples().speed, *row).powi(2);
        let floor = FLOOR * rows.iter().map(square).sum::<f64>() / rows.len().max(1) as f64;
        let mut shares = vec![0.0; self.shares.len()];
        for row in rows {
            shares[*row as usize] = of_row(&self.shares, *row) / (square(row) + floor);
        }
        let sum: f64 = shares.iter().sum();
        let is_known = sum > 0.0 && sum.is_finite();
        is_known.then(|| {
            for share in &mut shares {
                *share /= sum;
            }
            let drives = [Feature::Input, Feature::AbsInput, Feature::Speed, Feature::AbsSpeed];
            let grid = Grid::of(record, |feature| !drives.contains(&feature));
            Self { grid, block_of: self.block_of.clone(), shares }
        })
    }

    /// The gain of `rows` among the rows of a part of the record.
    pub(super) fn gain_among(&self, part: &[Row], rows: &[Row]) -> f64 {
        self.share(rows) / self.share(part) - rows.len() as f64 / part.len() as f64
    }
}
