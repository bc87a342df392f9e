//! The search for the conditions that hold most of an error.

use super::grid::{Choice, Family, Grid};
use super::record::{ResidualRecord, Row, of_row};
use super::significance::{Chance, Excess, Shuffler, blocks};

/// The gain below which a condition is not worth acting on.
pub(super) const MIN_GAIN: f64 = 0.1;

/// What a threshold with more digits must add to the gain.
pub(super) const DIGITS_COST: f64 = 0.01;

/// A record made ready to be searched.
#[derive(Debug)]
pub(super) struct Search {
    grid: Grid,
    block_of: Vec<u32>,
    shares: Vec<f64>,
}

impl Search {
    /// `shares` of the squared error for each sample of `record`.
    pub(super) fn new(record: &ResidualRecord, shares: Vec<f64>) -> Self {
        Self { grid: Grid::new(record), block_of: blocks(record), shares }
    }

    /// The features, cut into parts.
    pub(super) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The best condition for the samples `rows` that chance does not explain.
    pub(super) fn best(&self, rows: &[Row]) -> Option<(Choice, f64)> {
        let excess = Excess::new(&self.shares, rows)?;
        let (one, one_p, chance) = self.best_of_one(rows, &excess)?;
        let pair = self.grid.best_pair(rows, |row| excess.of(row));
        if pair.score <= one.score {
            return Some((one, one_p));
        }
        let pair_p = self.pair_p_value(&pair, rows, &chance);
        Some(pair_p.map_or((one, one_p), |p_value| (pair, p_value)))
    }

    /// The best condition on one feature for the samples `rows`, likewise.
    pub(super) fn best_on_one_feature(&self, rows: &[Row]) -> Option<(Choice, f64)> {
        let (choice, p_value, _) = self.best_of_one(rows, &Excess::new(&self.shares, rows)?)?;
        Some((choice, p_value))
    }

    fn best_of_one(&self, rows: &[Row], excess: &Excess<'_>) -> Option<(Choice, f64, Chance)> {
        let sums = self.grid.part_sums(rows, |row| excess.of(row));
        let one = self.grid.best_of(&sums);
        if one.selections.is_empty() {
            return None;
        }
        let shuffler = Shuffler::new(&self.grid, rows, excess, &self.block_of);
        let chance = shuffler.stands_out(Family::OneFeature, one.score)?;
        let p_value = chance.p_value(Family::OneFeature, one.score)?;
        Some((one, p_value, chance))
    }

    /// The p-value of two clauses: of either alone, and of the other among its samples.
    fn pair_p_value(&self, pair: &Choice, rows: &[Row], chance: &Chance) -> Option<f64> {
        let [a, b] = pair.selections.as_slice() else { return None };
        let orders = [(*a, *b), (*b, *a)];
        let p_value = |(first, second)| {
            let inside = self.grid.members(&[first], rows.iter().copied());
            let alone = chance.p_value(Family::OneClause, self.gain_among(rows, &inside))?;
            let gain =
                self.gain_among(&inside, &self.grid.members(&[second], inside.iter().copied()));
            let excess = Excess::new(&self.shares, &inside)?;
            let shuffler = Shuffler::new(&self.grid, &inside, &excess, &self.block_of);
            let chance = shuffler.stands_out(Family::OneClause, gain)?;
            // Both clauses must stand out: the larger of the two.
            Some(alone.max(chance.p_value(Family::OneClause, gain)?))
        };
        orders.into_iter().find_map(p_value)
    }

    /// The condition with its thresholds moved to where the gain is largest, and the grid
    /// it is of; none when that gains too little to be worth the digits.
    pub(super) fn sharpened(
        &self,
        record: &ResidualRecord,
        choice: &Choice,
        rows: &[Row],
    ) -> Option<(Grid, Choice)> {
        let excess = Excess::new(&self.shares, rows)?;
        let excess = |row| excess.of(row);
        let grid = self.grid.about(record, choice)?;
        let sharp = match choice.selections.len() {
            1 => grid.best_of(&grid.part_sums(rows, excess)),
            _ => grid.best_pair(rows, excess),
        };
        (sharp.score > choice.score + DIGITS_COST).then_some((grid, sharp))
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
            let grid = Grid::beside_motion(record);
            Self { grid, block_of: self.block_of.clone(), shares }
        })
    }

    /// The gain of `rows` among the rows of a part of the record.
    pub(super) fn gain_among(&self, part: &[Row], rows: &[Row]) -> f64 {
        self.share(rows) / self.share(part) - rows.len() as f64 / part.len() as f64
    }
}
