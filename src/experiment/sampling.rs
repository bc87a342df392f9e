//! From rows with times to a uniform grid: checks, filling, splitting, resampling.

use serde::Serialize;

use super::clock::filled_s;
use crate::numerics::median;
use crate::units::SamplePeriod;

/// What may be done to a log that is not uniform or not complete.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Repair {
    /// Put every trial on a grid of this period: output linear, input held.
    pub resample: Option<SamplePeriod>,
    /// Fill gaps up to this many seconds; longer ones split the trial in two. None: gaps of
    /// a few samples are filled.
    pub fill_s: Option<f64>,
    /// Refuse times that are not uniform and cells that are empty: what is made of them
    /// depends on the whole log, which may still grow.
    #[serde(skip)]
    pub as_it_stands: bool,
    /// Fill the gaps in which all steps of a joint lie, so that delays count from their ends. What
    /// is filled is no motion that a model should follow.
    #[serde(skip)]
    pub joins_steps: bool,
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
    FewStamps { stamps: usize, grain_s: f64 },
    Coarse { row: usize, grain_s: f64, period: f64 },
    TooMany { samples: f64, period: f64 },
}

impl Fault {
    /// Whether a clock with this fault is put on a grid unasked.
    pub(super) fn is_mended(self) -> bool {
        matches!(self, Self::NotIncreasing { .. } | Self::NotUniform { .. })
    }
}

/// Times of a trial's rows, checked, and the grid they are put on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    period: SamplePeriod,
    placement: Placement,
}

#[derive(Clone, Debug, PartialEq)]
enum Placement {
    /// Each row has its own place on the grid; places without a row are gaps, and those
    /// of `fill` places and less may be filled.
    Rows { start_s: f64, places: Vec<usize>, fill: f64 },
    /// The grid lies anew over the rows' times.
    Resampled { times: Vec<f64>, longest_gap_s: f64 },
    /// Some of the rows have a grid of their own each.
    Parts(Vec<Part>),
}

/// Rows of a trial, in the order of their time, and their grid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    pub(super) rows: Vec<usize>,
    pub(super) grid: Grid,
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
            let bridged = steps.iter().filter(|step| is_within(**step, longest_gap_s));
            let samples = bridged.sum::<f64>() / period.seconds();
            check_size(samples, period.seconds())?;
            let placement = Placement::Resampled { times: times.to_vec(), longest_gap_s };
            return Ok(Self { period, placement });
        }
        let places = place_rows(&steps, median, repair)?;
        let start_s = times.first().copied().unwrap_or_default();
        let span = times.last().copied().unwrap_or_default() - start_s;
        let period = span / places.last().copied().unwrap_or(1) as f64;
        let period = SamplePeriod::from_seconds(tidy(period)).ok_or(Fault::SingleRow)?;
        let fill = repair.fill_periods(period);
        let gaps = places.windows(2).map(|pair| (pair[1] - pair[0]) as f64);
        check_size(gaps.filter(|gap| is_within(*gap, fill)).sum(), period.seconds())?;
        Ok(Self { period, placement: Placement::Rows { start_s, places, fill } })
    }

    /// A grid on which row follows row, where the log has no times.
    pub(super) fn of_rows(rows: usize, period: SamplePeriod, repair: Repair) -> Self {
        let fill = repair.fill_periods(period);
        let placement = Placement::Rows { start_s: 0.0, places: (0..rows).collect(), fill };
        Self { period, placement }
    }

    /// A grid from `start_s` on, in whose `places` the rows are; gaps up to `longest_gap_s`
    /// are filled.
    pub(super) fn of_places(
        start_s: f64,
        places: Vec<usize>,
        period: SamplePeriod,
        longest_gap_s: f64,
    ) -> Result<Self, Fault> {
        check_size(places.last().map_or(0.0, |last| *last as f64), period.seconds())?;
        let fill = (longest_gap_s / period.seconds()).max(1.0);
        Ok(Self { period, placement: Placement::Rows { start_s, places, fill } })
    }

    /// A grid that lies anew over rows at `times`, which increase.
    pub(super) fn resampled(
        times: Vec<f64>,
        period: SamplePeriod,
        longest_gap_s: f64,
    ) -> Result<Self, Fault> {
        let span = times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first);
        check_size(span / period.seconds(), period.seconds())?;
        Ok(Self { period, placement: Placement::Resampled { times, longest_gap_s } })
    }

    /// Grids of `parts` of the rows.
    pub(super) fn of_parts(period: SamplePeriod, parts: Vec<Part>) -> Self {
        Self { period, placement: Placement::Parts(parts) }
    }

    /// This grid, of rows of which only `rows` are looked at.
    pub(super) fn of_some(self, rows: Vec<usize>) -> Self {
        Self::of_parts(self.period, vec![Part { rows, grid: self }])
    }

    pub(super) fn period(&self) -> SamplePeriod {
        self.period
    }

    /// Samples that the grid may have, its short gaps filled.
    pub(super) fn samples(&self) -> usize {
        let bridged = |steps: f64, count: usize| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "≥ 0")]
            let steps = steps as usize;
            steps.saturating_add(count)
        };
        match &self.placement {
            Placement::Rows { places, fill, .. } => {
                let gaps = places.windows(2).map(|pair| (pair[1] - pair[0]) as f64);
                bridged(gaps.filter(|gap| is_within(*gap, *fill)).sum(), places.len())
            }
            Placement::Resampled { times, longest_gap_s } => {
                let gaps = times.windows(2).map(|pair| pair[1] - pair[0]);
                let bridges = gaps.filter(|gap| is_within(*gap, *longest_gap_s));
                bridged(bridges.sum::<f64>() / self.period.seconds(), 1)
            }
            Placement::Parts(parts) => parts.iter().map(|part| part.grid.samples()).sum(),
        }
    }

    /// The signals of a joint on the grid, cut at its long gaps.
    pub(super) fn pieces(&self, mut signals: Signals) -> Vec<Piece> {
        hold(&mut signals.input);
        match &self.placement {
            Placement::Rows { start_s, places, fill } => {
                let place_s = |place: usize| start_s + place as f64 * self.period.seconds();
                let measured = measured_rows(&signals);
                let joined = |&from: &usize, &to: &usize| match (places.get(from), places.get(to)) {
                    (Some(from), Some(to)) => is_within((to - from) as f64, fill.max(1.0)),
                    _ => false,
                };
                let piece = |rows: &[usize]| {
                    let (first, last) = (*rows.first()?, *rows.last()?);
                    let places = places.get(first..=last)?;
                    let start_s = place_s(*places.first()?);
                    Some(Piece { start_s, signals: on_grid(&signals, first, places) })
                };
                measured.chunk_by(joined).filter_map(piece).collect()
            }
            Placement::Resampled { times, longest_gap_s } => {
                resampled(&signals, times, *longest_gap_s, self.period)
            }
            Placement::Parts(parts) => {
                let pieces = |part: &Part| part.grid.pieces(signals.of_rows(&part.rows));
                parts.iter().flat_map(pieces).collect()
            }
        }
    }
}

impl Repair {
    /// Periods up to which a gap is filled.
    fn fill_periods(self, period: SamplePeriod) -> f64 {
        self.fill_s.unwrap_or_else(|| filled_s(period.seconds())) / period.seconds()
    }

    /// Whether nothing was asked for, so that what suits the log is done.
    pub(super) fn is_free(self) -> bool {
        let Self { resample, fill_s, as_it_stands, joins_steps: _ } = self;
        resample.is_none() && fill_s.is_none() && !as_it_stands
    }
}

impl Signals {
    /// The values of some rows, in their order.
    pub(super) fn of_rows(&self, rows: &[usize]) -> Self {
        let of = |values: &Vec<f64>| {
            rows.iter().map(|&row| values.get(row).copied().unwrap_or(f64::NAN)).collect()
        };
        Self {
            input: of(&self.input),
            output: of(&self.output),
            covariates: self.covariates.iter().map(of).collect(),
        }
    }
}

/// Whether rows at `times` are uniform as they stand, no row missing.
pub(super) fn is_uniform(times: &[f64]) -> bool {
    Grid::lay(times, Repair::default()).is_ok()
}

/// Rows with an output.
fn measured_rows(signals: &Signals) -> Vec<usize> {
    let rows = signals.output.iter().enumerate().filter(|(_, y)| !y.is_nan());
    rows.map(|(row, _)| row).collect()
}

/// Places on the grid that are still distinct as floating-point numbers.
const MOST_PLACES: f64 = 1e12;

/// Samples of one trial that are still handled: 8 GB as numbers.
const MOST_SAMPLES: f64 = 1e9;

fn check_size(samples: f64, period: f64) -> Result<(), Fault> {
    if samples > MOST_SAMPLES { Err(Fault::TooMany { samples, period }) } else { Ok(()) }
}

/// Whether a gap is no longer than the limit, rounding left aside.
fn is_within(gap: f64, limit: f64) -> bool {
    gap <= limit * (1.0 + 1e-9)
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
        let countable = periods < MOST_PLACES;
        let lost_rows = repair.fill_s.is_some() && (uniform || pause) && countable;
        if !(lost_rows || uniform && periods < 1.5) {
            return Err(Fault::NotUniform { row: index + 1, step, period: tidy(period) });
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "≥ 1")]
        let periods = periods as usize;
        place = periods.saturating_add(place);
        places.push(place);
    }
    Ok(places)
}

/// The signals of the rows from `first` on at their `places`, gaps between them filled:
/// output linear, input held.
fn on_grid(signals: &Signals, first: usize, places: &[usize]) -> Signals {
    let start = places.first().copied().unwrap_or_default();
    let length = places.last().map_or(0, |last| last + 1 - start);
    let spread = |values: &Vec<f64>| {
        let mut grid = vec![f64::NAN; length];
        for (value, place) in values.iter().skip(first).zip(places) {
            if let Some(slot) = grid.get_mut(place - start) {
                *slot = *value;
            }
        }
        grid
    };
    let mut grid = Signals {
        input: spread(&signals.input),
        output: spread(&signals.output),
        covariates: signals.covariates.iter().map(spread).collect(),
    };
    hold(&mut grid.input);
    interpolate(&mut grid.output);
    grid
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

/// Replaces each NaN by the line between its neighbours.
fn interpolate(values: &mut [f64]) {
    let mut last: Option<(usize, f64)> = None;
    for index in 0..values.len() {
        let Some(&value) = values.get(index).filter(|value| !value.is_nan()) else {
            continue;
        };
        if let Some((from, start)) = last.filter(|(from, _)| index - from > 1) {
            let slope = (value - start) / (index - from) as f64;
            for (offset, slot) in values[from..index].iter_mut().enumerate() {
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
    let time = |row: usize| times.get(row).copied().unwrap_or(f64::NAN);
    let joined = |&from: &usize, &to: &usize| is_within(time(to) - time(from), longest_gap_s);
    measured_rows(signals)
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
    Piece { start_s, signals: piece }
}

/// `seconds` to nine significant digits: 0.01 s out of times that are binary sums.
fn tidy(seconds: f64) -> f64 {
    format!("{seconds:.8e}").parse().unwrap_or(seconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signals(input: &[f64], output: &[f64]) -> Signals {
        Signals { input: input.to_vec(), output: output.to_vec(), covariates: Vec::new() }
    }

    #[test]
    fn uniform_rows_pass_as_they_are() {
        let times: Vec<f64> = (0..500).map(|k| 3.0 + f64::from(k) * 0.01).collect();
        let grid = Grid::lay(&times, Repair::default()).unwrap();
        assert_eq!(grid.period().seconds().to_string(), "0.01");
        let pieces = grid.pieces(signals(&vec![1.0; 500], &vec![2.0; 500]));
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
    fn resampling_does_not_bridge_a_pause() {
        let mut times: Vec<f64> = (0..20).map(f64::from).collect();
        times.extend((0..20).map(|k| 100.0 + f64::from(k)));
        let resampled = Repair { resample: SamplePeriod::from_seconds(1.0), ..Repair::default() };
        let grid = Grid::lay(&times, resampled).unwrap();
        assert_eq!(grid.pieces(signals(&times, &times)).len(), 2);
    }
}
