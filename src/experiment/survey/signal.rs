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
        let changes = |pair: &&[f64]| (pair[1] - pair[0]).abs() > 0.0;
        let (all, changed) = (pairs.clone().count(), pairs.filter(changes).count());
        (all > 0).then(|| Self { values, changing: changed as f64 / all as f64 })
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
            0.0..HOLDS => format!(
                "it is held at levels (it changes at {percent:.1} % of the \
                 rows)"
            ),
            _ => format!("it changes at {percent:.0} % of the rows"),
        }
    }

    /// The correlation of its rate with `input` some samples before, where it is clear: the partial one given
    /// its level, so that what comes to rest at a level of its input follows as well as what goes on moving.
    pub(super) fn follows(&self, input: &Self) -> Option<f64> {
        /// Rows over which a rate is taken, and rows that a reaction may come late.
        const OVER: usize = 5;
        const LATE: [usize; 14] = [0, 5, 10, 15, 20, 25, 30, 35, 40, 50, 70, 100, 150, 200];
        /// Rows that are looked at, spread over the record.
        const ROWS: usize = 2_000;
        /// Correlation from which one follows the other.
        const CLEAR: f64 = 0.3;
        let (u, y) = (&input.values, &self.values);
        let rows = u.len().min(y.len()).saturating_sub(OVER);
        let mut best = 0.0_f64;
        for late in LATE.into_iter().filter(|late| 4 * late <= rows) {
            let sampled = (late..rows).step_by(rows.div_ceil(ROWS).max(1));
            let triple =
                |k: usize| Some([*u.get(k - late)?, *y.get(k)?, y.get(k + OVER)? - y.get(k)?]);
            let known = sampled.filter_map(triple).filter(|t| t.iter().all(|x| x.is_finite()));
            let found = partial_correlation(&known.collect::<Vec<_>>());
            best = if found.abs() > best.abs() { found } else { best };
        }
        (best.abs() >= CLEAR).then_some(best)
    }
}

impl Signal {
    /// Whether it is the rate of `position`: its sum over some rows is what the position moves in them, and
    /// no better so for rows before, as it would be for a speed that is given.
    pub(super) fn is_rate_of(&self, position: &Self) -> bool {
        /// Rows that are summed, for which the noise of the position counts the less the more they are.
        const OVER: [usize; 3] = [5, 20, 80];
        /// Rows that the speed may be before or after the position's.
        const SHIFT: usize = 20;
        /// Rows that are looked at, spread over the record.
        const ROWS: usize = 2_000;
        /// Correlation from which all that moves the position is in the speed but noise: nine tenths of the
        /// variance.
        const WHOLE: f64 = 0.95;
        let mut sum = 0.0;
        let sums = std::iter::once(0.0).chain(self.values.windows(2).map(|pair| {
            let step = 0.5 * (pair[0] + pair[1]);
            sum += if step.is_finite() { step } else { 0.0 };
            sum
        }));
        let (sums, y): (Vec<f64>, _) = (sums.collect(), &position.values);
        let rows = sums.len().min(y.len());
        let moved = |of: &[f64], k: usize, over: usize| Some(of.get(k + over)? - of.get(k)?);
        let of_shift = |over: usize, shift: usize| {
            let starts = SHIFT..rows.saturating_sub(over + SHIFT);
            let starts = starts.step_by(rows.div_ceil(ROWS).max(1));
            let pair =
                |k: usize| Some([moved(&sums, k + SHIFT - shift, over)?, moved(y, k, over)?]);
            let known = starts.filter_map(pair).filter(|pair| pair.iter().all(|x| x.is_finite()));
            correlation(&known.collect::<Vec<_>>(), 0, 1)
        };
        OVER.into_iter().any(|over| {
            let all = (0..=2 * SHIFT).map(|shift| of_shift(over, shift));
            let best = all.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b));
            best.is_some_and(|(shift, most)| most >= WHOLE && shift <= SHIFT)
        })
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

/// The correlation of the first with the third number, each without what the second explains of it; 0 where
/// nothing varies.
fn partial_correlation(rows: &[[f64; 3]]) -> f64 {
    let [uy, ur, yr] = [(0, 1), (0, 2), (1, 2)].map(|(a, b)| correlation(rows, a, b));
    let scale = ((1.0 - uy * uy) * (1.0 - yr * yr)).sqrt();
    if scale > f64::EPSILON { (ur - uy * yr) / scale } else { 0.0 }
}

/// The correlation of two of the numbers of each row; 0 where one does not vary.
fn correlation<const N: usize>(rows: &[[f64; N]], a: usize, b: usize) -> f64 {
    let mean = |of: usize| rows.iter().map(|row| row[of]).sum::<f64>() / rows.len().max(1) as f64;
    let (of_a, of_b) = (mean(a), mean(b));
    let sums = rows.iter().fold([0.0; 3], |[aa, bb, ab], row| {
        let (a, b) = (row[a] - of_a, row[b] - of_b);
        [aa + a * a, bb + b * b, ab + a * b]
    });
    let scale = (sums[0] * sums[1]).sqrt();
    if scale > 0.0 { sums[2] / scale } else { 0.0 }
}
