//! Rows on a uniform grid: filling, splitting, resampling.

use std::ops::Range;

use serde::Serialize;

use super::error::{ReadError, ReadErrorKind};
use crate::units::{SamplePeriod, floor_to_index};

/// What may be done to a log that is not uniform or not complete.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Repair {
    /// Put every trial on a grid of this period: output linear, input held.
    pub resample: Option<SamplePeriod>,
    /// Fill gaps up to this many seconds; longer ones split the trial in two. None: gaps of
    /// a few samples are filled.
    pub fill_s: Option<f64>,
    /// Leave out a last line without an end, and refuse times that are not uniform and cells that are empty:
    /// what is made of them depends on the whole log, which may still grow.
    #[serde(skip)]
    pub as_it_stands: bool,
}

/// Samples of one trial that are still handled: 8 GB as numbers.
const MOST_SAMPLES: f64 = 1e9;

impl Repair {
    /// Seconds up to which a gap is filled in samples with this period.
    pub(super) fn longest_gap_s(self, period: f64) -> f64 {
        self.fill_s.unwrap_or_else(|| filled_s(period))
    }

    /// Whether nothing was asked for, so that what suits the log is done.
    pub(super) fn is_free(self) -> bool {
        let Self { resample, fill_s, as_it_stands } = self;
        resample.is_none() && fill_s.is_none() && !as_it_stands
    }
}

/// The longest gap that is filled unasked, in seconds.
pub(super) fn filled_s(period: f64) -> f64 {
    /// One row of Algorithm 1's Φ at its usual β, and short beside the dead times of hydraulic joints.
    const PERIODS: f64 = 5.0;
    const SECONDS: f64 = 0.05;
    (PERIODS * period).max(SECONDS)
}

/// Where the rows of a trial lie on a grid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    period: SamplePeriod,
    parts: Vec<Part>,
}

/// Rows of a trial that follow one another, in the order of their time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    /// The rows of the trial that it consists of.
    rows: Vec<usize>,
    /// Where each lies: in samples of a grid that begins at so many seconds, else in seconds.
    at: Vec<f64>,
    on_grid_from_s: Option<f64>,
    /// Gaps up to so many seconds are filled, longer ones cut the part.
    longest_gap_s: f64,
}

/// The signals of one joint in one trial, a value per row, NaN where missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Signals {
    pub(super) input: Vec<f64>,
    pub(super) output: Vec<f64>,
    pub(super) covariates: Vec<Vec<f64>>,
}

/// A run without a gap: where it starts, and its signals on the grid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    pub(super) start_s: f64,
    /// The row of the trial that it starts with.
    pub(super) first_row: usize,
    pub(super) signals: Signals,
    /// Samples whose output was not measured.
    pub(super) filled: Vec<Range<usize>>,
}

impl Grid {
    /// The grid of some `parts`.
    ///
    /// # Errors
    /// [`ReadErrorKind::TooManySamples`] where it would have more samples than can be handled.
    pub(super) fn of_parts(period: SamplePeriod, parts: Vec<Part>) -> Result<Self, ReadError> {
        let grid = Self { period, parts };
        let (samples, period) = (grid.length(), period.seconds());
        if samples <= MOST_SAMPLES {
            return Ok(grid);
        }
        let text =
            format!("would have {samples:e} samples on a grid of {period} s; check the times");
        Err(ReadError::new(ReadErrorKind::TooManySamples, text))
    }

    pub(super) fn period(&self) -> SamplePeriod {
        self.period
    }

    /// Samples that the grid may have, its short gaps filled.
    pub(super) fn samples(&self) -> usize {
        floor_to_index(self.length())
    }

    fn length(&self) -> f64 {
        self.parts.iter().map(|part| part.length(self.period.seconds())).sum()
    }

    /// The signals of a joint on the grid, cut at its long gaps.
    pub(super) fn pieces(&self, mut signals: Signals) -> Vec<Piece> {
        hold(&mut signals.input);
        self.parts.iter().flat_map(|part| part.pieces(&signals, self.period.seconds())).collect()
    }
}

impl Part {
    /// These `rows` of the trial in these `places` of a grid that begins at `start_s`.
    pub(super) fn at_places(
        start_s: f64,
        rows: Vec<usize>,
        places: &[usize],
        longest_gap_s: f64,
    ) -> Self {
        let at = places.iter().map(|place| *place as f64).collect();
        Self { rows, at, on_grid_from_s: Some(start_s), longest_gap_s }
    }

    /// These `rows` of the trial at these times, which increase, under a grid that lies anew over them.
    pub(super) fn resampled(rows: Vec<usize>, times: Vec<f64>, longest_gap_s: f64) -> Self {
        Self { rows, at: times, on_grid_from_s: None, longest_gap_s }
    }

    /// The row of the trial with this index among its own.
    fn row(&self, index: usize) -> usize {
        self.rows.get(index).copied().unwrap_or(usize::MAX)
    }

    fn at(&self, index: usize) -> f64 {
        self.at.get(index).copied().unwrap_or(f64::NAN)
    }

    /// Seconds of what places are counted in, of a grid of this period.
    fn unit_s(&self, period: f64) -> f64 {
        if self.on_grid_from_s.is_some() { period } else { 1.0 }
    }

    /// The time between two rows, seconds.
    fn apart_s(&self, from: usize, to: usize, period: f64) -> f64 {
        (self.at(to) - self.at(from)) * self.unit_s(period)
    }

    /// Whether the time between two rows is not a gap that cuts, rounding left aside. Rows in neighbouring
    /// places are joined however little may be filled.
    fn joins(&self, from: usize, to: usize, period: f64) -> bool {
        self.apart_s(from, to, period) <= self.longest_gap_s.max(period) * (1.0 + 1e-9)
    }

    /// Samples that it may have.
    fn length(&self, period: f64) -> f64 {
        let to_next = |row: usize| {
            let is_joined = self.joins(row - 1, row, period);
            if is_joined { self.apart_s(row - 1, row, period) / period } else { 1.0 }
        };
        1.0 + (1..self.at.len()).map(to_next).sum::<f64>()
    }

    fn pieces(&self, signals: &Signals, period: f64) -> Vec<Piece> {
        let is_measured =
            |index: &usize| signals.output.get(self.row(*index)).is_some_and(|y| !y.is_nan());
        let measured: Vec<usize> = (0..self.at.len()).filter(is_measured).collect();
        let runs = measured.chunk_by(|from, to| self.joins(*from, *to, period));
        // Of one row alone it is not known to what time its grid belongs.
        let runs = runs.filter(|run| self.on_grid_from_s.is_some() || run.len() > 1);
        runs.map(|run| self.piece(signals, run, period)).collect()
    }

    /// One piece: `rows` are those with an output, no long gap between them. On the grid the output lies on the
    /// lines between them, and the input is held.
    fn piece(&self, signals: &Signals, rows: &[usize], period: f64) -> Piece {
        /// Part of a period by which a row may come late and still count as on time.
        const ON_TIME: f64 = 1e-6;
        let (unit_s, first, last) = (self.unit_s(period), rows[0], rows[rows.len() - 1]);
        let (step, start) = (period / unit_s, self.at(first));
        let count = floor_to_index((self.at(last) - start) / step + ON_TIME) + 1;
        let value =
            |values: &[f64], index: usize| values.get(self.row(index)).copied().unwrap_or(f64::NAN);
        let mut piece = Piece {
            start_s: self.on_grid_from_s.unwrap_or_default() + start * unit_s,
            first_row: self.row(first),
            signals: signals.map(|_| Vec::with_capacity(count)),
            filled: Vec::new(),
        };
        let (mut row, mut pair) = (first, 0);
        for now in (0..count).map(|k| start + k as f64 * step) {
            while row < last && self.at(row + 1) <= now + ON_TIME * step {
                row += 1;
            }
            while pair + 2 < rows.len() && self.at(rows[pair + 1]) <= now {
                pair += 1;
            }
            let (from, to) = (rows[pair], rows[(pair + 1).min(rows.len() - 1)]);
            let between = |values: &[f64]| {
                let (start, end) = (value(values, from), value(values, to));
                let part = (now - self.at(from)) / (self.at(to) - self.at(from));
                match part {
                    1.0.. => end,
                    0.0.. => start + part * (end - start),
                    _ => start,
                }
            };
            let is_at_a_row = (self.at(row) - now).abs() <= 0.0;
            let further = |values: &[f64]| match self.on_grid_from_s {
                _ if is_at_a_row => value(values, row),
                Some(_) => f64::NAN,
                None => between(values),
            };
            piece.signals.input.push(value(&signals.input, row));
            piece.signals.output.push(between(&signals.output));
            for (target, source) in piece.signals.covariates.iter_mut().zip(&signals.covariates) {
                target.push(further(source));
            }
        }
        if self.on_grid_from_s.is_some() {
            let places =
                rows.windows(2).map(|pair| [pair[0], pair[1]].map(|row| self.at(row) - start));
            let between = places.map(|[from, to]| floor_to_index(from) + 1..floor_to_index(to));
            piece.filled = between.filter(|samples| !samples.is_empty()).collect();
        }
        piece
    }
}

impl Signals {
    /// Each signal made anew.
    fn map(&self, of: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        Self {
            input: of(&self.input),
            output: of(&self.output),
            covariates: self.covariates.iter().map(|signal| of(signal)).collect(),
        }
    }
}

/// Replaces each NaN by the number before it, the first ones by the first number.
pub(super) fn hold(values: &mut [f64]) {
    let first = values.iter().find(|value| !value.is_nan()).copied();
    let mut last = first.unwrap_or(f64::NAN);
    for value in values {
        if value.is_nan() {
            *value = last;
        }
        last = *value;
    }
}
