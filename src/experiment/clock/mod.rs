//! What the stamps of a trial say of its clock: its period, how far it jitters, where it
//! jumps, and which rows follow one another.
//!
//! A stamp is `t_k = a + T·n_k + d_k + j_k` with the place `n_k` of row `k` on an even grid, a
//! slow drift `d_k` and a jitter `j_k`. Lost rows show as a jump that the rows after it keep;
//! a stamp that is only late is made good by the next ones.

mod evenness;
mod period;
mod rows;
mod run;

use self::evenness::Deviations;
use self::period::{least_squares_period, typical_period};
use self::rows::{in_order, is_even_once_sorted, once, parted, short_gaps};
use self::run::not_increasing;
use super::error::{ReadError, ReadErrorKind};
use super::grid::Repair;
use crate::numerics::{as_written, median};

pub(super) use self::evenness::Evenness;
pub(super) use self::rows::between_restarts;
pub(super) use self::run::{Oddity, Run, single_row};

/// Largest difference of a time step from the median, as a part of it, that still
/// counts as uniform.
const UNIFORMITY: f64 = 0.01;

/// Digits of a period: 0.01 s out of times that are binary sums.
const DIGITS: usize = 9;

/// Whether samples may be so many seconds apart: from a nanosecond to three years, beyond which the
/// times of a record leave what a clock counts.
pub(crate) fn is_period(seconds: f64) -> bool {
    (1e-9..=1e8).contains(&seconds)
}

/// The clock of a trial.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Clock {
    pub(super) runs: Vec<Run>,
    /// Least-squares period of all runs, seconds; of uniform ones the mean.
    pub(super) period: f64,
    pub(super) evenness: Evenness,
    /// Standard deviation of the jitter, in periods.
    pub(super) jitter: f64,
    /// Largest jitter, in periods, and its row.
    pub(super) largest: (f64, usize),
    /// Short gaps: how many, the longest in periods, and the row after the first.
    pub(super) gaps: Option<(usize, usize, usize)>,
    /// Rows that are odd.
    pub(super) odd: Vec<(Oddity, usize)>,
}

impl Clock {
    /// The clock of uniform stamps `times`, in seconds, rows that are lost only where they may be filled; of any
    /// that increase, where they are put on a grid of another period.
    ///
    /// # Errors
    /// Of the kinds [`ReadErrorKind::Content`] and [`ReadErrorKind::NotUniform`] where [`Self::read`] may read them.
    pub(super) fn uniform(times: &[f64], repair: Repair) -> Result<Self, ReadError> {
        let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        if let Some(row) = steps.iter().position(|&step| step <= 0.0 || step.is_nan()) {
            return Err(not_increasing(times, row + 1));
        }
        let usual = median(&steps).ok_or_else(single_row)?;
        let rows: Vec<usize> = (0..times.len()).collect();
        let (runs, period, evenness) = if let Some(resample) = repair.resample {
            let is_joined = |_: &usize, row: &usize| {
                let longest_gap_s = repair.longest_gap_s(usual.max(resample.seconds()));
                steps[row - 1] <= longest_gap_s.max(resample.seconds()) * (1.0 + 1e-9)
            };
            let runs = rows.chunk_by(is_joined);
            let runs = runs.map(|rows| Run { rows: rows.to_vec(), places: Vec::new() });
            (runs.collect(), usual, Evenness::Uneven)
        } else {
            let places = place_rows(&steps, usual, repair)?;
            let last = places.last().copied().unwrap_or(1);
            let span = times[times.len() - 1] - times[0];
            let period = as_written(span / last as f64, DIGITS);
            (vec![Run { rows, places }], period, Evenness::Uniform)
        };
        let (jitter, largest, gaps, odd) = (0.0, (0.0, 0), None, Vec::new());
        Ok(Self { runs, period, evenness, jitter, largest, gaps, odd })
    }

    /// The clock of stamps `times`, in seconds; gaps that are filled do not part a run.
    pub(super) fn read(times: &[f64], repair: Repair) -> Result<Self, ReadError> {
        let typical = typical_period(times)?;
        let (mut runs, mut odd) = (Vec::new(), Vec::new());
        let longest = repair.longest_gap_s(typical.seconds) / typical.seconds;
        let parts = between_restarts(times, typical.seconds).or_else(|fault| {
            // Rows of one even clock, each of which has a time of its own, can be sorted.
            if is_even_once_sorted(times) {
                Ok(vec![(0..times.len()).collect()])
            } else {
                Err(fault)
            }
        })?;
        for (index, rows) in parts.into_iter().enumerate() {
            let rows = in_order(rows, times, &mut odd);
            let rows = once(rows, times, &typical, &mut odd);
            let first = rows.iter().min().filter(|_| index > 0);
            odd.extend(first.map(|first| (Oddity::Restart, *first)));
            for run in parted(&rows, times, &typical, longest.max(1.0)) {
                match run.rows.as_slice() {
                    [row] => odd.push((Oddity::Alone, *row)),
                    _ => runs.push(run),
                }
            }
        }
        let period = least_squares_period(&runs, times, &typical)?;
        let deviations = Deviations::of(&runs, times, period, &typical);
        let evenness = deviations.evenness(&runs, &typical, period)?;
        let (jitter, largest) = (deviations.deviation(), deviations.largest());
        Ok(Self { gaps: short_gaps(&runs), runs, period, evenness, jitter, largest, odd })
    }

    /// Rows of its longest run.
    pub(super) fn longest(&self) -> usize {
        self.runs.iter().map(|run| run.rows.len()).max().unwrap_or_default()
    }
}

/// The place of each row on a grid of `period`, from the steps between rows; rows are lost only where they may be
/// filled.
fn place_rows(steps: &[f64], period: f64, repair: Repair) -> Result<Vec<usize>, ReadError> {
    /// Places on the grid that are still distinct as floating-point numbers.
    const MOST_PLACES: f64 = 1e12;
    let mut places = Vec::with_capacity(steps.len() + 1);
    places.push(0);
    let mut place = 0;
    for (index, &step) in steps.iter().enumerate() {
        let periods = (step / period).round().max(1.0);
        let uniform = (step - periods * period).abs() <= UNIFORMITY * period;
        // Over a long pause the clock may drift by more than a part of one period.
        let pause = periods >= 1.0 / UNIFORMITY;
        let lost_rows = repair.fill_s.is_some() && (uniform || pause) && periods < MOST_PLACES;
        if !(lost_rows || uniform && periods < 1.5) {
            let period = as_written(period, DIGITS);
            let text = format!(
                "this sample comes {step} s after the one before, but the period is {period} s (median)"
            );
            let kind = ReadErrorKind::NotUniform { step, period };
            return Err(ReadError::new(kind, text).at_index(index + 1));
        }
        place += crate::units::floor_to_index(periods);
        places.push(place);
    }
    Ok(places)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers between −1 and 1 that look random, the same each time.
    fn noise(k: usize) -> f64 {
        ((k as f64 * 12.9898).sin() * 43_758.545_3).fract()
    }

    fn stamps(rows: usize, time: impl Fn(usize) -> f64) -> Vec<f64> {
        (0..rows).map(time).collect()
    }

    pub(super) fn read(times: &[f64]) -> Clock {
        Clock::read(times, Repair::default()).unwrap()
    }

    /// Whether a clock goes back, and the index of the row.
    fn refused(times: &[f64]) -> (bool, u64) {
        let fault = Clock::read(times, Repair::default()).unwrap_err();
        (matches!(fault.kind, ReadErrorKind::Content), fault.row().unwrap() - 1)
    }

    #[test]
    fn the_row_that_is_off_is_named() {
        for (times, says, row) in [
            (&[0.0, 0.1, 0.1][..], "must increase", 3),
            (&[0.0, 0.1, 0.05], "must increase", 3),
            (&[0.0], "one row only", 1),
            (&[0.0, 0.1, 0.2, 0.3, 0.5, 0.6], "but the period is 0.1 s", 5),
        ] {
            let fault = Clock::uniform(times, Repair::default()).unwrap_err();
            assert_eq!(fault.row(), Some(row), "{fault}");
            assert!(fault.to_string().contains(says), "{fault}");
        }
    }

    #[test]
    fn half_a_percent_of_jitter_is_uniform_and_two_are_not() {
        let is_uniform = |times: &[f64]| Clock::uniform(times, Repair::default()).is_ok();
        assert!(is_uniform(&[0.0, 1.0, 2.005, 3.0, 4.0]));
        assert!(!is_uniform(&[0.0, 1.0, 2.02, 3.0, 4.0]));
    }

    fn sizes(clock: &Clock) -> Vec<usize> {
        clock.runs.iter().map(|run| run.rows.len()).collect()
    }

    #[test]
    fn jitter_is_measured_and_leaves_every_row_at_its_place() {
        for size in [0.02, 0.1, 0.2] {
            let clock = read(&stamps(3000, |k| 5.0 + 0.01 * (k as f64 + size * noise(k))));
            assert_eq!((clock.evenness, sizes(&clock)), (Evenness::Jitters, vec![3000]));
            // Evenly spread: a standard deviation of size/√3.
            assert!((clock.jitter / (size / 3.0_f64.sqrt()) - 1.0).abs() < 0.1, "{clock:?}");
            assert!((clock.period / 0.01 - 1.0).abs() < 1e-4);
            assert_eq!(clock.runs[0].places.last(), Some(&2999));
        }
    }

    #[test]
    fn a_clock_that_drifts_slowly_keeps_its_rows() {
        let drift = |k: usize| 3.0 * (k as f64 / 4000.0).sin();
        let clock = read(&stamps(20_000, |k| 0.01 * (k as f64 + drift(k) + 0.05 * noise(k))));
        assert_eq!(clock.evenness, Evenness::Jitters);
        assert!(clock.jitter < 0.05, "{}", clock.jitter);
    }

    #[test]
    fn sampling_that_is_itself_uneven_is_told_from_noisy_stamps() {
        let mut time = 0.0;
        let mut step = |k: usize| {
            time += 0.01 * (1.0 + 0.3 * noise(k));
            time
        };
        let times: Vec<f64> = (0..2000).map(&mut step).collect();
        assert_eq!(read(&times).evenness, Evenness::Uneven);
    }

    #[test]
    fn two_rates_in_one_trial_are_uneven() {
        let clock = read(&stamps(300, |k| 0.01 * (k + k.saturating_sub(200)) as f64));
        assert_eq!(clock.evenness, Evenness::Uneven);
    }

    #[test]
    fn rounded_stamps_are_even() {
        // 128 Hz in steps of 10 ms; 50 Hz in tenths of a second and in whole seconds.
        for (period, grain) in [(1.0 / 128.0, 0.01), (0.02, 0.1), (0.02, 1.0)] {
            let rows = 2000;
            let clock = read(&stamps(rows, |k| (k as f64 * period / grain).floor() * grain));
            assert!(matches!(clock.evenness, Evenness::Rounded { .. }), "{clock:?}");
            assert!((clock.period / period - 1.0).abs() < 5e-3, "{}", clock.period);
            assert_eq!(sizes(&clock), [rows]);
        }
    }

    #[test]
    fn the_period_of_coarse_stamps_is_that_between_their_changes() {
        // Seconds since 1970 as 32-bit numbers change every 128 s.
        let coarse = |first: f64, rows: usize| {
            stamps(rows, |k| ((first + 0.05 * k as f64) / 128.0).round() * 128.0)
        };
        for first in [1.7e9, 1.7e9 + 40.0, 1.7e9 + 99.0] {
            let clock = read(&coarse(first, 9000));
            assert!((clock.period / 0.05 - 1.0).abs() < 1e-3, "{}", clock.period);
            assert_eq!(
                (clock.evenness, sizes(&clock)),
                (Evenness::Rounded { to_s: 128.0 }, vec![9000])
            );
        }
        // Halves are rounded to even whole seconds, so that their lengths differ.
        let to_even = stamps(6000, |k| (0.01 * k as f64).round_ties_even());
        assert_eq!(read(&to_even).evenness, Evenness::Rounded { to_s: 1.0 });
        let few = Clock::read(&coarse(1.7e9, 4000), Repair::default()).unwrap_err().to_string();
        assert!(few.contains("only 3 different times, 128 s apart"), "{few}");
    }

    #[test]
    fn stamps_that_are_rounded_to_less_than_a_period_lose_no_row() {
        // Near 100,000 s numbers of 32 bits are 7.8125 ms apart.
        let to_s = 0.007_812_5;
        let rounded = |rows: usize| stamps(rows, |k| (0.01 * k as f64 / to_s).round() * to_s);
        let clock = read(&rounded(3000));
        assert!((clock.period / 0.01 - 1.0).abs() < 1e-5, "{clock:?}");
        assert_eq!(
            (clock.evenness, clock.gaps, sizes(&clock)),
            (Evenness::Rounded { to_s }, None, vec![3000])
        );
        // Where rows are lost at random, times are as far apart, but on no line.
        let kept = (0..3600).filter(|k| noise(*k).abs() < 0.8).map(|k| to_s * k as f64);
        let kept: Vec<f64> = kept.collect();
        assert!((read(&kept).period / to_s - 1.0).abs() < 1e-6, "rows that are lost at random");
    }

    #[test]
    fn lost_rows_and_late_stamps_are_told_apart() {
        let lost = |k: usize| if k < 50 { k } else { k + 3 };
        let clock = read(&stamps(200, |k| 0.01 * (lost(k) as f64 + 0.05 * noise(k))));
        assert_eq!((clock.gaps, sizes(&clock)), (Some((1, 4, 50)), vec![200]));
        // Rows 50 to 60 were held up and come all at once.
        let late = |k: usize| if (50..60).contains(&k) { 60.0 + 1e-3 * k as f64 } else { k as f64 };
        let clock = read(&stamps(400, |k| 0.01 * late(k)));
        assert_eq!((clock.gaps, clock.evenness), (None, Evenness::Jitters));
        assert!(clock.odd.iter().all(|(oddity, _)| *oddity != Oddity::Twice), "{:?}", clock.odd);
        assert!(clock.largest.0 > 9.0);
    }

    #[test]
    fn a_long_gap_and_a_clock_that_starts_anew_part_the_rows() {
        let times = stamps(300, |k| match k {
            0..100 => 0.01 * k as f64,
            100..200 => 7.0 + 0.01 * k as f64,
            _ => 0.01 * (k - 200) as f64,
        });
        let clock = read(&times);
        assert_eq!(sizes(&clock), [100, 100, 100]);
        assert_eq!(clock.odd, [(Oddity::Restart, 200)]);
    }

    #[test]
    fn a_row_that_is_there_twice_is_left_out() {
        let clock = read(&stamps(200, |k| 0.01 * (if k < 80 { k } else { k - 1 }) as f64));
        assert_eq!((&clock.odd, sizes(&clock)), (&vec![(Oddity::Twice, 80)], vec![199]));
        let rounded = read(&stamps(200, |k| 0.01 * (if k == 80 { 79 } else { k }) as f64));
        assert_eq!((rounded.odd.len(), sizes(&rounded)), (0, vec![200]));
    }

    #[test]
    fn rows_out_of_order_are_sorted_and_garbage_is_named() {
        let swapped = |k: usize| match k {
            40 => 41,
            41 => 40,
            _ => k,
        };
        let clock = read(&stamps(100, |k| 0.01 * swapped(k) as f64));
        assert_eq!(clock.odd, [(Oddity::Disordered, 41)]);
        assert_eq!(clock.runs[0].rows[40..42], [41, 40]);
        for (wrong, row) in [(0.01, 60), (99.0, 61)] {
            let times = stamps(100, |k| if k == 60 { wrong } else { 0.01 * k as f64 });
            assert_eq!(refused(&times), (true, row));
        }
        assert_eq!(refused(&[1.0; 5]), (true, 1));
        assert_eq!(refused(&[1.0]), (false, 0), "a single row");
    }
}
