//! Outputs of a sensor that is slower than its log: each reading is repeated in several rows.

use std::ops::Range;

use crate::experiment::layout::JointLayout;
use crate::experiment::log::{Log, Mended};
use crate::numerics::quantile;

/// Rows in which a reading is repeated, at least.
const FEWEST_ROWS: usize = 3;

/// Readings that show it.
const FEWEST: usize = 20;

/// The output of a joint with the first row alone of each reading, where its sensor is slower than the log.
pub(super) fn first_readings(log: &Log<'_>, joint: &JointLayout) -> Option<Mended> {
    let (values, spans) = (&log.column(joint.output.column)?.values, log.spans());
    let rows = rows_of_a_reading(values, &spans)?;
    let mut values = values.clone();
    keep_first(&mut values, &spans, rows);
    let note = format!(
        "each reading of the output is repeated in {rows} rows; only the first of them is used"
    );
    Some((values, Some(note)))
}

/// Leaves the first row of each reading alone, and NaN in the others.
fn keep_first(values: &mut [f64], trials: &[Range<usize>], rows: usize) {
    for trial in trials {
        let Some(values) = values.get_mut(trial.clone()) else { continue };
        let known = (0..values.len()).filter(|row| !values[*row].is_nan()).collect::<Vec<_>>();
        let mut others = Vec::new();
        for run in known.chunk_by(|a, b| (values[*b] - values[*a]).abs() <= 0.0) {
            // A reading may be what the one before was.
            let readings = ((run.len() + rows / 2) / rows).max(1);
            let is_first = |at: usize| at.is_multiple_of(rows) && at / rows < readings;
            let later = run.iter().enumerate().filter(|(at, _)| !is_first(*at));
            others.extend(later.map(|(_, row)| *row));
        }
        for row in others {
            values[row] = f64::NAN;
        }
    }
}

/// The rows in which a reading is repeated, where a sensor is read anew every so many rows.
///
/// That is seen by changes that come at one interval or at multiples of it, each by as much as the output
/// moved meanwhile: an output that is rounded coarsely changes by one step at a time.
fn rows_of_a_reading(values: &[f64], trials: &[Range<usize>]) -> Option<usize> {
    /// Part of the intervals that are one or a multiple of it, and that are one.
    const MULTIPLES: f64 = 0.95;
    const ONE: f64 = 0.5;
    /// How much larger large changes are than small ones, at least.
    const APART: f64 = 3.0;
    let trials = || trials.iter().filter_map(|trial| values.get(trial.clone()));
    let is_new = |pair: &&[f64]| (pair[1] - pair[0]).abs() > 0.0;
    // Of most outputs every sample is a new one.
    let new = trials().flat_map(|values| values.windows(2)).filter(is_new).count();
    if new <= FEWEST || new * FEWEST_ROWS > values.len() {
        return None;
    }
    let (mut intervals, mut changes) = (Vec::new(), Vec::new());
    for values in trials() {
        let changed = values.windows(2).enumerate().filter(|(_, pair)| is_new(pair));
        let mut before = None;
        for (row, pair) in changed {
            intervals.extend(before.map(|before| row - before));
            changes.push((pair[1] - pair[0]).abs());
            before = Some(row);
        }
    }
    let of = |part: f64| {
        let mut sorted = intervals.clone();
        sorted.sort_unstable();
        sorted.get(crate::units::floor_to_index(part * sorted.len() as f64)).copied()
    };
    let rows = of(0.25).filter(|rows| *rows >= FEWEST_ROWS)?;
    // The clocks of sensor and log drift past one another.
    let room = usize::from(rows >= 5);
    let is_near = |interval: usize, times: usize| interval.abs_diff(times * rows) <= room;
    let all = intervals.len() as f64;
    let multiples = intervals.iter().filter(|interval| {
        let times = (**interval + rows / 2) / rows;
        is_near(**interval, times.max(1))
    });
    let ones = intervals.iter().filter(|interval| is_near(**interval, 1)).count() as f64;
    let (small, large) = (quantile(&changes, 0.1)?, quantile(&changes, 0.9)?);
    let are_readings =
        multiples.count() as f64 >= MULTIPLES * all && ones >= ONE * all && large > APART * small;
    are_readings.then_some(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;

    #[expect(clippy::single_range_in_vec_init, reason = "one trial")]
    fn whole(values: &[f64]) -> [Range<usize>; 1] {
        [0..values.len()]
    }

    fn keep_readings(values: &mut [f64], trials: &[Range<usize>]) -> Option<usize> {
        let rows = rows_of_a_reading(values, trials)?;
        keep_first(values, trials, rows);
        Some(rows)
    }

    #[test]
    fn each_reading_is_kept_once() {
        for rows in [3, 4, 10] {
            let noise = noise(7, 0.0, 4000);
            let moves = |k: usize| 20.0 * (k as f64 / 150.0).sin() + 0.01 * noise[k];
            let truth: Vec<f64> = (0..4000).map(moves).collect();
            let mut shown: Vec<f64> = (0..4000).map(|k| truth[k - k % rows]).collect();
            assert_eq!(keep_readings(&mut shown, &whole(&truth)), Some(rows));
            let kept: Vec<usize> = (0..4000).filter(|k| !shown[*k].is_nan()).collect();
            assert!(kept.len().abs_diff(4000 / rows) <= 1, "{}", kept.len());
            assert!(kept.iter().all(|k| k % rows == 0 && (shown[*k] - truth[*k]).abs() < 1e-12));
        }
    }

    #[test]
    fn readings_that_are_alike_are_kept_too() {
        let at = |k: usize| if k < 400 { (k * k) as f64 / 100.0 } else { 0.0 };
        let mut shown: Vec<f64> = (0..800).map(|k| at(k - k % 10)).collect();
        let all = whole(&shown);
        assert_eq!(keep_readings(&mut shown, &all), Some(10));
        assert_eq!(shown.iter().filter(|value| !value.is_nan()).count(), 80);
    }

    #[test]
    fn what_is_logged_as_it_is_read_is_left_as_it_is() {
        let noise = noise(9, 0.0, 4000);
        let smooth: Vec<f64> = (0..4000).map(|k| (f64::from(k) / 90.0).sin()).collect();
        let noisy: Vec<f64> = smooth.iter().zip(&noise).map(|(y, e)| y + 0.01 * e).collect();
        let coarse: Vec<f64> = smooth.iter().map(|y| (40.0 * y).round() / 40.0).collect();
        let line: Vec<f64> = (0..4000).map(|k| (0.1 * f64::from(k)).floor()).collect();
        for values in [smooth, noisy, coarse, line] {
            let mut kept = values.clone();
            assert_eq!(keep_readings(&mut kept, &whole(&values)), None);
            assert_eq!(kept, values);
        }
    }
}
