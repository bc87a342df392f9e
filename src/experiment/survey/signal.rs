//! A column of numbers as a survey sees it, and whether one follows another.

use crate::experiment::grid::hold;
use crate::experiment::table::{BadCell, Column};

/// A column of numbers.
#[derive(Clone, Debug)]
pub(super) struct Signal {
    values: Vec<f64>,
    /// Part of the samples at which it changes.
    changing: f64,
}

/// A signal that changes at fewer of its samples holds levels.
const HOLDS: f64 = 0.1;

impl Signal {
    /// `None` where the column does not hold numbers. One that ends at a cell that is no number holds
    /// those before it: whoever reads it says which cell that is.
    pub(super) fn of(column: &Column) -> Option<Self> {
        /// Part of the rows without a value above which a column has few of its own.
        const SPARSE: f64 = 0.3;
        let known = column.values.iter().filter(|value| !value.is_nan()).count();
        match &column.error {
            Some((_, BadCell::Kind(_))) => return None,
            Some((_, bad)) if known < 2 => return is_number_like(bad).then(Self::unread),
            None if column.values.len() < 2 => return None,
            _ => {}
        }
        let mut values = column.values.clone();
        let known: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
        let is_sparse = (known.len() as f64) < (1.0 - SPARSE) * values.len() as f64;
        if is_sparse {
            hold(&mut values);
        }
        let pairs = if is_sparse { &known } else { &values }.windows(2);
        let pairs = pairs.filter(|pair| pair.iter().all(|value| !value.is_nan()));
        #[expect(clippy::float_cmp, reason = "whether a value is held")]
        let (all, changes) = pairs.fold((0_usize, 0_usize), |(all, changes), pair| {
            (all + 1, changes + usize::from(pair[0] != pair[1]))
        });
        (all > 0).then(|| Self { values, changing: changes as f64 / all as f64 })
    }

    /// Numbers of which none can be read.
    fn unread() -> Self {
        Self { values: Vec::new(), changing: 1.0 }
    }

    pub(super) fn is_constant(&self) -> bool {
        self.changing <= 0.0
    }

    pub(super) fn holds_levels(&self) -> bool {
        self.changing < HOLDS
    }

    /// How it moves, for people.
    pub(super) fn says(&self) -> String {
        let percent = 100.0 * self.changing;
        match self.changing {
            0.0 => "it never changes".to_owned(),
            0.0..HOLDS => format!("it holds levels (changes at {percent:.1} % of the rows)"),
            _ => format!("it changes at {percent:.0} % of the rows"),
        }
    }

    /// The correlation of its rate with `input` some samples before, where it is clear.
    pub(super) fn follows(&self, input: &Self) -> Option<f64> {
        /// Rows over which a rate is taken, rows that a reaction may come late, and rows
        /// that are looked at.
        const OVER: usize = 5;
        const LATE: usize = 50;
        const ROWS: usize = 20_000;
        /// Correlation from which one follows the other.
        const CLEAR: f64 = 0.3;
        let (u, y) = (&input.values, &self.values);
        let rows = u.len().min(y.len()).min(ROWS);
        let at = |values: &[f64], k: usize| values.get(k).copied().unwrap_or(f64::NAN);
        let rate = |k: usize| at(y, k + OVER) - at(y, k);
        let correlation = |late: usize| {
            let pairs = (late..rows.saturating_sub(OVER)).map(|k| (at(u, k - late), rate(k)));
            correlation(pairs.filter(|(a, b)| a.is_finite() && b.is_finite()))
        };
        let lags = (0..LATE).step_by(OVER).map(correlation);
        let best = lags.max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        (best.abs() >= CLEAR).then_some(best)
    }
}

/// Whether a cell is a number that is written in a way that is not read, as `9,993.91`.
fn is_number_like(bad: &BadCell) -> bool {
    match bad {
        BadCell::Text(text) => {
            text.contains(|c: char| c.is_ascii_digit())
                && text.chars().all(|c| c.is_ascii_digit() || "+-., '".contains(c))
        }
        BadCell::Kind(_) => false,
        _ => true,
    }
}

/// Pearson's correlation; 0 of what does not vary.
fn correlation(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let pairs: Vec<(f64, f64)> = pairs.collect();
    let n = pairs.len().max(1) as f64;
    let (a, b) = pairs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in pairs {
        xy += (x - a) * (y - b);
        xx += (x - a) * (x - a);
        yy += (y - b) * (y - b);
    }
    let scale: f64 = xx * yy;
    if scale > 0.0 { xy / scale.sqrt() } else { 0.0 }
}
