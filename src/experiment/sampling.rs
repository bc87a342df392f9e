//! From rows with times to a uniform grid: checks, filling, splitting, resampling.

use std::ops::Range;

use crate::units::SamplePeriod;

/// What may be done to a log that is not uniform or not complete.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Repair {
    /// Put every trial on a grid of this period: output linear, input held.
    pub resample: Option<SamplePeriod>,
    /// Fill gaps up to this many seconds; longer ones split the trial in two.
    pub fill_s: Option<f64>,
}

/// Largest difference of a time step from the median, as a part of it, that still
/// counts as uniform.
const UNIFORMITY: f64 = 0.01;

/// Without a stated limit, resampling does not bridge gaps longer than this many
/// periods: a line drawn over a pause would look like a measurement.
const RESAMPLE_GAP_PERIODS: f64 = 10.0;

/// Why rows cannot be put on a grid. `row` counts the rows of the trial from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fault {
    NotIncreasing { row: usize },
    NotUniform { row: usize, step: f64, period: f64 },
    SingleRow,
}

/// Times of a trial's rows, checked, and the grid they are put on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    period: SamplePeriod,
    placement: Placement,
}

#[derive(Clone, Debug, PartialEq)]
enum Placement {
    /// Each row has its own place on the grid; places without a row are gaps.
    Rows { start_s: f64, places: Vec<usize>, fill: f64 },
    /// The grid lies anew over the rows' times.
    Resampled { times: Vec<f64>, longest_gap_s: f64 },
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
    pub(super) signals: Signals,
}

impl Grid {
    /// Checks `times` (seconds, one per row) and lays the grid.
    pub(super) fn lay(times: &[f64], repair: Repair) -> Result<Self, Fault> {
        let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        if let Some(row) = steps.iter().position(|&step| step <= 0.0 || step.is_nan()) {
            return Err(Fault::NotIncreasing { row: row + 1 });
        }
        let median = median(&steps).ok_or(Fault::SingleRow)?;
        if let Some(period) = repair.resample {
            let default_gap = RESAMPLE_GAP_PERIODS * period.seconds().max(median);
            let longest_gap_s = repair.fill_s.unwrap_or(default_gap);
            let placement = Placement::Resampled { times: times.to_vec(), longest_gap_s };
            return Ok(Self { period, placement });
        }
        let places = place_rows(&steps, median, repair)?;
        let start_s = times.first().copied().unwrap_or_default();
        let span = times.last().copied().unwrap_or_default() - start_s;
        let period = span / places.last().copied().unwrap_or(1) as f64;
        let period = SamplePeriod::from_seconds(tidy(period)).ok_or(Fault::SingleRow)?;
        let fill = repair.fill_s.map_or(1.0, |fill| fill / period.seconds());
        Ok(Self { period, placement: Placement::Rows { start_s, places, fill } })
    }

    /// A grid on which row follows row, where the log has no times.
    pub(super) fn of_rows(rows: usize, period: SamplePeriod, repair: Repair) -> Self {
        let fill = repair.fill_s.map_or(1.0, |fill| fill / period.seconds());
        let placement = Placement::Rows { start_s: 0.0, places: (0..rows).collect(), fill };
        Self { period, placement }
    }

    pub(super) fn period(&self) -> SamplePeriod {
        self.period
    }

    /// The signals of a joint on the grid, cut at its long gaps.
    pub(super) fn pieces(&self, signals: &Signals) -> Vec<Piece> {
        match &self.placement {
            Placement::Rows { start_s, places, fill } => {
                let whole = spread(signals, places);
                let ranges = runs(&whole.output, *fill);
                let piece = |range: Range<usize>| Piece {
                    start_s: start_s + range.start as f64 * self.period.seconds(),
                    signals: filled(&whole, range),
                };
                ranges.into_iter().map(piece).collect()
            }
            Placement::Resampled { times, longest_gap_s } => {
                resampled(signals, times, *longest_gap_s, self.period)
            }
        }
    }
}

/// The place of each row on a grid of `period`, from the steps between rows.
fn place_rows(steps: &[f64], period: f64, repair: Repair) -> Result<Vec<usize>, Fault> {
    let mut places = Vec::with_capacity(steps.len() + 1);
    places.push(0);
    let mut place = 0;
    for (index, &step) in steps.iter().enumerate() {
        let periods = (step / period).round().max(1.0);
        let uniform = (step - periods * period).abs() <= UNIFORMITY * period;
        // Over a long pause the clock may drift by more than a part of one period.
        let pause = periods >= 1.0 / UNIFORMITY;
        let lost_rows = repair.fill_s.is_some() && (uniform || pause);
        if !(lost_rows || uniform && periods < 1.5) {
            return Err(Fault::NotUniform { row: index + 1, step, period: tidy(period) });
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "≥ 1")]
        let periods = periods as usize;
        place += periods;
        places.push(place);
    }
    Ok(places)
}

/// Places longer than this in one gap are not spread out: the trial is split there
/// whatever the limit, so that a clock set anew does not fill the memory.
const LONGEST_GAP: usize = 10_000_000;

/// Signals on every place of the grid, NaN where no row has one.
fn spread(signals: &Signals, places: &[usize]) -> Signals {
    let length = places.last().map_or(0, |last| last + 1);
    if length == places.len() {
        return signals.clone();
    }
    let length = length.min(places.len() + LONGEST_GAP);
    let spread_one = |values: &Vec<f64>| {
        let mut spread = vec![f64::NAN; length];
        for (&value, &place) in values.iter().zip(places) {
            if let Some(slot) = spread.get_mut(place) {
                *slot = value;
            }
        }
        spread
    };
    Signals {
        input: spread_one(&signals.input),
        output: spread_one(&signals.output),
        covariates: signals.covariates.iter().map(spread_one).collect(),
    }
}

/// Runs of `values` from number to number in which no two numbers are more than
/// `longest` places apart.
fn runs(values: &[f64], longest: f64) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (place, _) in values.iter().enumerate().filter(|(_, value)| !value.is_nan()) {
        match runs.last_mut() {
            Some(run) if (place + 1 - run.end) as f64 <= longest.max(1.0) => run.end = place + 1,
            _ => runs.push(place..place + 1),
        }
    }
    runs
}

/// A range of the signals with its gaps filled: output linear, input held.
fn filled(whole: &Signals, range: Range<usize>) -> Signals {
    let held_before = whole.input.get(..range.start).unwrap_or_default();
    let held = held_before.iter().rev().find(|value| !value.is_nan()).copied();
    let cut = |values: &Vec<f64>| values.get(range.clone()).unwrap_or_default().to_vec();
    let mut signals = Signals {
        input: cut(&whole.input),
        output: cut(&whole.output),
        covariates: whole.covariates.iter().map(cut).collect(),
    };
    hold(&mut signals.input, held);
    interpolate(&mut signals.output);
    signals
}

/// Replaces each NaN by the number before it; the first ones by `before` or, without
/// it, by the first number that comes.
fn hold(values: &mut [f64], before: Option<f64>) {
    let first = values.iter().find(|value| !value.is_nan()).copied();
    let Some(mut last) = before.or(first) else {
        return;
    };
    for value in values {
        if value.is_nan() {
            *value = last;
        }
        last = *value;
    }
}

/// Replaces each NaN by the line between its neighbours.
fn interpolate(values: &mut [f64]) {
    let mut last: Option<(usize, f64)> = None;
    for index in 0..values.len() {
        let Some(&value) = values.get(index).filter(|value| !value.is_nan()) else {
            continue;
        };
        if let Some((from, start)) = last.filter(|(from, _)| index - from > 1) {
            let slope = (value - start) / (index - from) as f64;
            for (offset, slot) in values.iter_mut().take(index).skip(from).enumerate() {
                *slot = start + slope * offset as f64;
            }
        }
        last = Some((index, value));
    }
}

fn resampled(
    signals: &Signals,
    times: &[f64],
    longest_gap_s: f64,
    period: SamplePeriod,
) -> Vec<Piece> {
    let measured: Vec<usize> = (0..times.len())
        .filter(|&row| signals.output.get(row).is_some_and(|y| !y.is_nan()))
        .collect();
    let time = |row: usize| times.get(row).copied().unwrap_or(f64::NAN);
    let joined = |&from: &usize, &to: &usize| time(to) - time(from) <= longest_gap_s;
    measured
        .chunk_by(joined)
        .filter(|rows| rows.len() > 1)
        .map(|rows| resampled_piece(signals, times, rows, period))
        .collect()
}

/// One piece: `rows` are those with an output, no long gap between them.
fn resampled_piece(
    signals: &Signals,
    times: &[f64],
    rows: &[usize],
    period: SamplePeriod,
) -> Piece {
    /// Part of a period by which a row may come late and still count as on time.
    const ON_TIME: f64 = 1e-6;
    let time = |row: usize| times.get(row).copied().unwrap_or(f64::NAN);
    let start_s = rows.first().map_or(0.0, |&row| time(row));
    let span = rows.last().map_or(0.0, |&row| time(row)) - start_s;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "span ≥ 0")]
    let count = (span / period.seconds() + ON_TIME) as usize + 1;
    let grid = (0..count).map(|k| start_s + k as f64 * period.seconds());
    let late = ON_TIME * period.seconds();
    let (mut row, mut pair) = (0, 0);
    let mut piece =
        Signals { covariates: vec![Vec::new(); signals.covariates.len()], ..Signals::default() };
    for now in grid {
        while row + 1 < times.len() && time(row + 1) <= now + late {
            row += 1;
        }
        while pair + 2 < rows.len() && rows.get(pair + 1).is_some_and(|&next| time(next) <= now) {
            pair += 1;
        }
        let (Some(&from), Some(&to)) = (rows.get(pair), rows.get(pair + 1)) else {
            break;
        };
        let part = ((now - time(from)) / (time(to) - time(from))).clamp(0.0, 1.0);
        let value = |values: &[f64], row: usize| values.get(row).copied().unwrap_or(f64::NAN);
        let between = |values: &[f64]| {
            let (start, end) = (value(values, from), value(values, to));
            start + part * (end - start)
        };
        piece.input.push(value(&signals.input, row));
        piece.output.push(between(&signals.output));
        for (target, source) in piece.covariates.iter_mut().zip(&signals.covariates) {
            target.push(between(source));
        }
    }
    let before = signals.input.iter().find(|value| !value.is_nan()).copied();
    hold(&mut piece.input, before);
    Piece { start_s, signals: piece }
}

fn median(steps: &[f64]) -> Option<f64> {
    let mut sorted = steps.to_vec();
    let middle = sorted.len() / 2;
    (!sorted.is_empty()).then(|| *sorted.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// `seconds` to nine significant digits: 0.01 s out of times that are binary sums.
fn tidy(seconds: f64) -> f64 {
    format!("{seconds:.8e}").parse().unwrap_or(seconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAN: f64 = f64::NAN;

    fn signals(input: &[f64], output: &[f64]) -> Signals {
        Signals { input: input.to_vec(), output: output.to_vec(), covariates: Vec::new() }
    }

    fn repair(resample: Option<f64>, fill_s: Option<f64>) -> Repair {
        Repair { resample: resample.and_then(SamplePeriod::from_seconds), fill_s }
    }

    #[test]
    fn uniform_rows_pass_as_they_are() {
        let times: Vec<f64> = (0..500).map(|k| 3.0 + f64::from(k) * 0.01).collect();
        let grid = Grid::lay(&times, Repair::default()).unwrap();
        assert_eq!(grid.period().seconds().to_string(), "0.01");
        let pieces = grid.pieces(&signals(&vec![1.0; 500], &vec![2.0; 500]));
        assert_eq!(pieces.len(), 1);
        assert_eq!(pieces[0].signals.output.len(), 500);
    }

    #[test]
    fn the_row_that_is_off_is_named() {
        let lay = |times: &[f64]| Grid::lay(times, Repair::default());
        assert_eq!(lay(&[0.0, 0.1, 0.1]), Err(Fault::NotIncreasing { row: 2 }));
        assert_eq!(lay(&[0.0, 0.1, 0.05]), Err(Fault::NotIncreasing { row: 2 }));
        assert_eq!(lay(&[0.0]), Err(Fault::SingleRow));
        let off = lay(&[0.0, 0.1, 0.2, 0.3, 0.5, 0.6]);
        assert!(matches!(off, Err(Fault::NotUniform { row: 4, .. })), "{off:?}");
    }

    #[test]
    fn half_a_percent_of_jitter_is_uniform_and_two_are_not() {
        assert!(Grid::lay(&[0.0, 1.0, 2.005, 3.0, 4.0], Repair::default()).is_ok());
        assert!(Grid::lay(&[0.0, 1.0, 2.02, 3.0, 4.0], Repair::default()).is_err());
    }

    #[test]
    fn a_short_gap_is_filled_and_a_long_one_splits() {
        let times = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        let grid = Grid::lay(&times, repair(None, Some(2.0))).unwrap();
        let log = signals(
            &[5.0, 5.0, 6.0, 6.0, 6.0, 7.0, 7.0, 7.0],
            &[0.0, NAN, 2.0, 3.0, NAN, NAN, 6.0, 7.0],
        );
        let pieces = grid.pieces(&log);
        assert_eq!(pieces.len(), 2);
        assert_eq!(pieces[0].signals.output, [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(pieces[0].signals.input, [5.0, 5.0, 6.0, 6.0]);
        assert_eq!(pieces[1].start_s.to_string(), "6");
        assert_eq!(pieces[1].signals.input, [7.0, 7.0]);
    }

    #[test]
    fn lost_rows_are_filled_too() {
        let times = [0.0, 1.0, 2.0, 4.0, 5.0, 6.0];
        assert!(Grid::lay(&times, Repair::default()).is_err());
        let grid = Grid::lay(&times, repair(None, Some(2.0))).unwrap();
        let log = signals(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0], &[0.0, 1.0, 2.0, 4.0, 5.0, 6.0]);
        let pieces = grid.pieces(&log);
        assert_eq!(pieces.len(), 1);
        assert_eq!(pieces[0].signals.output, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(pieces[0].signals.input, [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    }

    #[test]
    fn resampling_draws_lines_and_holds_the_input() {
        let times = [0.0, 0.9, 2.1, 3.0];
        let grid = Grid::lay(&times, repair(Some(0.5), None)).unwrap();
        let log = signals(&[1.0, 2.0, 3.0, 4.0], &[0.0, 0.9, 2.1, 3.0]);
        let piece = &grid.pieces(&log)[0].signals;
        assert_eq!(piece.input, [1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 4.0]);
        for (k, y) in piece.output.iter().enumerate() {
            assert!((y - 0.5 * k as f64).abs() < 1e-12, "{:?}", piece.output);
        }
    }

    #[test]
    fn resampling_does_not_bridge_a_pause() {
        let mut times: Vec<f64> = (0..20).map(f64::from).collect();
        times.extend((0..20).map(|k| 100.0 + f64::from(k)));
        let grid = Grid::lay(&times, repair(Some(1.0), None)).unwrap();
        assert_eq!(grid.pieces(&signals(&times, &times)).len(), 2);
    }
}
