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
use self::rows::{Found, count, is_even_once_sorted, parted, short_gaps};
use super::error::ReadError;

pub(super) use self::evenness::Evenness;
pub(super) use self::rows::between_restarts;
pub(super) use self::run::{Run, is_mended, not_increasing, single_row};

/// A gap is filled up to so many periods: one row of Algorithm 1's Φ at its usual β.
const FILLED_PERIODS: f64 = 5.0;

/// A gap is filled up to so many seconds: short beside the dead times of hydraulic joints.
const FILLED_S: f64 = 0.05;

/// Whether samples may be so many seconds apart: from a nanosecond to three years, beyond which the
/// times of a record leave what a clock counts.
pub(crate) fn is_period(seconds: f64) -> bool {
    (1e-9..=1e8).contains(&seconds)
}

/// The clock of a trial.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Clock {
    pub(super) runs: Vec<Run>,
    /// Least-squares period of all runs, seconds.
    pub(super) period: f64,
    pub(super) evenness: Evenness,
    /// Standard deviation of the jitter, in periods.
    pub(super) jitter: f64,
    /// Largest jitter, in periods, and its row.
    pub(super) largest: (f64, usize),
    /// Short gaps: how many, the longest in periods, and the row after the first.
    pub(super) gaps: Option<(usize, usize, usize)>,
    pub(super) found: Found,
}

impl Clock {
    /// Reads the stamps `times`, in seconds; gaps up to `fill_s` do not part a run, nor those
    /// that are filled unasked where it is none.
    pub(super) fn read(times: &[f64], fill_s: Option<f64>) -> Result<Self, ReadError> {
        let typical = typical_period(times)?;
        let mut found = Found::default();
        let mut runs = Vec::new();
        let longest = fill_s.unwrap_or_else(|| filled_s(typical.seconds)) / typical.seconds;
        let parts = between_restarts(times, typical.seconds).or_else(|fault| {
            // Rows of one even clock, each of which has a time of its own, can be sorted.
            if is_even_once_sorted(times) {
                Ok(vec![(0..times.len()).collect()])
            } else {
                Err(fault)
            }
        })?;
        for (index, rows) in parts.into_iter().enumerate() {
            let rows = found.in_order(rows, times);
            let rows = found.once(rows, times, &typical);
            if let Some(first) = rows.iter().min().filter(|_| index > 0) {
                count(&mut found.restarts, *first);
            }
            for run in parted(&rows, times, &typical, longest.max(1.0)) {
                match run.rows.as_slice() {
                    [row] => count(&mut found.alone, *row),
                    _ => runs.push(run),
                }
            }
        }
        let period = least_squares_period(&runs, times, &typical)?;
        let deviations = Deviations::of(&runs, times, period, &typical);
        let evenness = deviations.evenness(&runs, &typical, period)?;
        Ok(Self {
            gaps: short_gaps(&runs),
            runs,
            period,
            evenness,
            jitter: deviations.deviation(),
            largest: deviations.largest(),
            found,
        })
    }

    /// Rows of its longest run.
    pub(super) fn longest(&self) -> usize {
        self.runs.iter().map(|run| run.rows.len()).max().unwrap_or_default()
    }
}

/// The longest gap that is filled unasked, in seconds.
pub(super) fn filled_s(period: f64) -> f64 {
    (FILLED_PERIODS * period).max(FILLED_S)
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
        Clock::read(times, None).unwrap()
    }

    /// Whether a clock goes back, and the index of the row.
    fn refused(times: &[f64]) -> (bool, u64) {
        let fault = Clock::read(times, None).unwrap_err();
        (is_mended(&fault), fault.row().unwrap() - 1)
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
        let few = Clock::read(&coarse(1.7e9, 4000), None).unwrap_err().to_string();
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
        assert_eq!(
            (clock.gaps, clock.found.twice, clock.evenness),
            (None, None, Evenness::Jitters)
        );
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
        assert_eq!(clock.found.restarts, Some((1, 200)));
    }

    #[test]
    fn a_row_that_is_there_twice_is_left_out() {
        let clock = read(&stamps(200, |k| 0.01 * (if k < 80 { k } else { k - 1 }) as f64));
        assert_eq!((clock.found.twice, sizes(&clock)), (Some((1, 80)), vec![199]));
        let rounded = read(&stamps(200, |k| 0.01 * (if k == 80 { 79 } else { k }) as f64));
        assert_eq!((rounded.found.twice, sizes(&rounded)), (None, vec![200]));
    }

    #[test]
    fn rows_out_of_order_are_sorted_and_garbage_is_named() {
        let swapped = |k: usize| match k {
            40 => 41,
            41 => 40,
            _ => k,
        };
        let clock = read(&stamps(100, |k| 0.01 * swapped(k) as f64));
        assert_eq!(clock.found.disordered, Some((1, 41)));
        assert_eq!(clock.runs[0].rows[40..42], [41, 40]);
        for (wrong, row) in [(0.01, 60), (99.0, 61)] {
            let times = stamps(100, |k| if k == 60 { wrong } else { 0.01 * k as f64 });
            assert_eq!(refused(&times), (true, row));
        }
        assert_eq!(refused(&[1.0; 5]), (true, 1));
        assert_eq!(refused(&[1.0]), (false, 0), "a single row");
    }
}
