//! The grids of a log, and what its reader should know of them where its clock is not uniform.

use super::clock::{Clock, Evenness, Oddity, Run, single_row};
use super::error::{ReadError, ReadErrorKind};
use super::grid::{Grid, Part, Repair};
use crate::numerics::as_written;
use crate::units::SamplePeriod;

/// Trials whose periods differ by less are of one rate: the tolerance of a uniform clock.
const ONE_RATE: f64 = 0.01;

/// Tolerance of one rate where the sampling is uneven, so that a period is only a mean.
const ONE_UNEVEN_RATE: f64 = 0.15;

/// By so many periods a row may be off its time because the period is a round number.
const ROUNDING: f64 = 0.1;

/// Part by which the period of a grid that is laid anew may be rounded.
const ROUND_RELATIVE: f64 = 0.03;

/// The grids of all trials, whose rows have the times `trials`; and a line on each thing that
/// was found, which calls a row of a trial by `number`. Where something cannot be mended it comes back with
/// its trial.
pub(super) fn grids(
    trials: &[&[f64]],
    repair: Repair,
    number: Number<'_>,
) -> Result<(Vec<Grid>, Vec<String>), (usize, ReadError)> {
    let clocks = |read: fn(&[f64], Repair) -> Result<Clock, ReadError>| {
        let clocks = trials.iter().enumerate();
        let clocks =
            clocks.map(|(trial, times)| read(times, repair).map_err(|fault| (trial, fault)));
        clocks.collect::<Result<Vec<_>, _>>()
    };
    let (clocks, is_uniform) = match clocks(Clock::uniform) {
        Ok(clocks) => (clocks, true),
        Err((_, fault)) if is_mended(&fault) && !repair.as_it_stands => {
            (clocks(Clock::read)?, false)
        }
        Err(fault) => return Err(fault),
    };
    let periods = match repair.resample {
        Some(period) => vec![period.seconds(); clocks.len()],
        None if is_uniform => clocks.iter().map(|clock| clock.period).collect(),
        None => common_periods(&clocks),
    };
    let (mut grids, mut laid) = (Vec::new(), Vec::new());
    for (trial, (clock, period)) in clocks.into_iter().zip(periods).enumerate() {
        let times = trials[trial];
        grids.push(grid(&clock, times, period, repair).map_err(|fault| (trial, fault))?);
        let is_uniform = is_uniform || Clock::uniform(times, repair).is_ok();
        laid.push(Laid { clock, period, is_uniform });
    }
    Ok((grids, lines(&laid, repair.resample, number)))
}

/// Whether a clock that is not uniform so is put on a grid unasked.
fn is_mended(fault: &ReadError) -> bool {
    matches!(fault.kind, ReadErrorKind::Content | ReadErrorKind::NotUniform { .. })
}

/// The period of each trial's grid: trials of one rate share their mean, each counting by its rows, as a round
/// number where that puts no row at another place. Even clocks come first, since their periods are known best:
/// uneven ones near them take theirs.
fn common_periods(clocks: &[Clock]) -> Vec<f64> {
    let is_uneven = |clock: &Clock| clock.evenness == Evenness::Uneven;
    let mut order: Vec<(usize, &Clock)> = clocks.iter().enumerate().collect();
    order.sort_by(|(_, a), (_, b)| {
        is_uneven(a).cmp(&is_uneven(b)).then(a.period.total_cmp(&b.period))
    });
    let mut groups: Vec<Vec<(usize, &Clock)>> = Vec::new();
    for (trial, clock) in order {
        let one_rate = if is_uneven(clock) { ONE_UNEVEN_RATE } else { ONE_RATE };
        let is_near = |group: &&mut Vec<(usize, &Clock)>| {
            (clock.period / group[0].1.period - 1.0).abs() <= one_rate
        };
        match groups.iter_mut().find(is_near) {
            Some(group) => group.push((trial, clock)),
            None => groups.push(vec![(trial, clock)]),
        }
    }
    let mut periods = vec![0.0; clocks.len()];
    for group in groups {
        let is_guess = is_uneven(group[0].1);
        let (mut rows, mut sum, mut longest) = (0.0, 0.0, 1);
        for (_, clock) in group.iter().filter(|(_, clock)| is_uneven(clock) == is_guess) {
            let count = clock.runs.iter().map(|run| run.rows.len()).sum::<usize>() as f64;
            (rows, sum) = (rows + count, sum + count * clock.period);
            longest = longest.max(clock.longest());
        }
        let by_a_row = (ROUNDING / longest as f64).min(2.0 * ONE_RATE);
        let period = rounded(sum / rows, if is_guess { ROUND_RELATIVE } else { by_a_row });
        for (trial, _) in group {
            periods[trial] = period;
        }
    }
    periods
}

/// `period` with as few digits as leave it right to a part `tolerance`.
fn rounded(period: f64, tolerance: f64) -> f64 {
    let is_right = |rounded: &f64| (rounded / period - 1.0).abs() <= tolerance;
    (1..=9).map(|digits| as_written(period, digits)).find(is_right).unwrap_or(period)
}

/// The grid of a trial.
fn grid(clock: &Clock, times: &[f64], period: f64, repair: Repair) -> Result<Grid, ReadError> {
    let longest_gap_s = repair.longest_gap_s(if repair.resample.is_some() {
        period.max(clock.period)
    } else {
        period
    });
    let part = |run: &Run| {
        let start_s = match clock.evenness {
            _ if repair.resample.is_some() => None,
            Evenness::Uneven => None,
            Evenness::Uniform => times.first().copied(),
            Evenness::Jitters | Evenness::Rounded { .. } => Some(run.start_s(times, period)),
        };
        match start_s {
            Some(start_s) => Part::at_places(start_s, run.rows.clone(), &run.places, longest_gap_s),
            None => interpolated(run, times, longest_gap_s),
        }
    };
    let parts = clock.runs.iter().map(part).collect();
    Grid::of_parts(SamplePeriod::from_seconds(period).ok_or_else(single_row)?, parts)
}

/// A run on a grid that lies anew over its times.
fn interpolated(run: &Run, times: &[f64], longest_gap_s: f64) -> Part {
    let time = |row: usize| times.get(row).copied().unwrap_or(f64::NAN);
    // Of rows with one stamp the last counts, as where the input steps: there is no line between
    // them.
    let mut rows: Vec<usize> = Vec::with_capacity(run.rows.len());
    for &row in &run.rows {
        match rows.last_mut() {
            Some(last) if time(row) <= time(*last) => *last = row,
            _ => rows.push(row),
        }
    }
    let times: Vec<f64> = rows.iter().map(|&row| time(row)).collect();
    // What the run holds together, the grid does.
    let steps = times.windows(2).map(|pair| pair[1] - pair[0]);
    let longest_gap_s = steps.fold(longest_gap_s, f64::max);
    Part::resampled(rows, times, longest_gap_s)
}

/// The clock of a trial, and the period of its grid.
struct Laid {
    clock: Clock,
    period: f64,
    /// Whether there is nothing to say of it.
    is_uniform: bool,
}

impl Laid {
    /// Whether its sampling is worth a word.
    fn is_odd(&self) -> bool {
        !self.is_uniform && !self.is_only_cut()
    }

    /// Whether nothing is to be said of the clock but where it is cut.
    fn is_only_cut(&self) -> bool {
        /// Jitter, in periods, that is rounding.
        const NONE: f64 = 1e-3;
        let is_cut = match self.clock.evenness {
            Evenness::Jitters => true,
            Evenness::Uneven => self.clock.gaps.is_some(),
            Evenness::Uniform | Evenness::Rounded { .. } => false,
        };
        is_cut && self.clock.jitter < NONE
    }
}

/// What messages call a row of a trial.
type Number<'a> = &'a dyn Fn(usize, usize) -> u64;

/// A line on each thing that was found in the clocks of a log.
fn lines(trials: &[Laid], resample: Option<SamplePeriod>, number: Number<'_>) -> Vec<String> {
    const ODDITIES: [(Oddity, &str); 4] = [
        (Oddity::Twice, "at the same time as the row before; one of the two is left out"),
        (Oddity::Disordered, "out of order and sorted by time"),
        (Oddity::Alone, "alone between gaps and left out"),
        (Oddity::Restart, ""),
    ];
    let mut lines = on_periods(trials, resample, number);
    lines.extend(on_gaps(trials, number));
    for (oddity, says) in ODDITIES {
        let mut rows = Vec::new();
        for (trial, laid) in trials.iter().enumerate() {
            let odd = laid.clock.odd.iter().filter(|(found, _)| *found == oddity);
            rows.extend(odd.map(|(_, row)| (trial, *row)));
        }
        let Some((trial, row)) = rows.iter().min() else { continue };
        let (count, row) = (rows.len(), number(*trial, *row));
        let [times, are] = match count {
            1 => ["once".to_owned(), "row is".to_owned()],
            _ => [format!("{count} times"), "rows are".to_owned()],
        };
        lines.push(if oddity == Oddity::Restart {
            format!("the clock starts anew {times} (first at row {row}): a new part begins there")
        } else {
            format!("{count} {are} {says} (first at row {row})")
        });
    }
    lines
}

/// A line on each rate and kind of clock, by the worst of its trials.
fn on_periods(trials: &[Laid], resample: Option<SamplePeriod>, number: Number<'_>) -> Vec<String> {
    type Kind<'a> = ((Evenness, f64), Vec<(usize, &'a Clock)>);
    let mut kinds: Vec<Kind<'_>> = Vec::new();
    for (trial, Laid { clock, period, .. }) in trials.iter().enumerate().filter(|(_, t)| t.is_odd())
    {
        let kind = (clock.evenness, *period);
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, of_kind)) => of_kind.push((trial, clock)),
            None => kinds.push((kind, vec![(trial, clock)])),
        }
    }
    let mut lines = Vec::new();
    for ((evenness, period), of_kind) in kinds {
        let whose = match trials.len() {
            1 => String::new(),
            all => format!("{} of {all} trials: ", of_kind.len()),
        };
        let grid = duration(period);
        let is_worse =
            |a: &&(usize, &Clock), b: &&(usize, &Clock)| a.1.largest.0.total_cmp(&b.1.largest.0);
        let Some((trial, worst)) = of_kind.iter().max_by(is_worse) else { continue };
        let (largest, row) = worst.largest;
        lines.push(if let Evenness::Rounded { to_s } = evenness {
            let to = duration(to_s);
            format!("{whose}the times are rounded to {to}: samples are placed evenly, {grid} apart")
        } else {
            let what = if resample.is_none() && evenness == Evenness::Jitters {
                "samples are placed"
            } else {
                "the output is interpolated and the input held"
            };
            format!(
                "{whose}the clock jitters by {} % of its period of {} (standard deviation), \
                 largest {} % at row {}: {what} on a grid of {grid}",
                two_digits(100.0 * worst.jitter),
                duration(worst.period),
                two_digits(100.0 * largest),
                number(*trial, row),
            )
        });
    }
    lines
}

/// Rows that are lost or come more slowly; other uneven samples are interpolated anyhow.
fn on_gaps(trials: &[Laid], number: Number<'_>) -> Option<String> {
    let gaps = trials.iter().enumerate().filter_map(|(trial, laid)| {
        let is_even = laid.clock.evenness != Evenness::Uneven;
        let gaps = laid.clock.gaps.filter(|_| is_even || laid.is_only_cut())?;
        Some((trial, gaps))
    });
    let gaps: Vec<(usize, (usize, usize, usize))> = gaps.collect();
    let (trial, (_, _, row)) = *gaps.first()?;
    let row = number(trial, row);
    let many: usize = gaps.iter().map(|(_, (many, ..))| many).sum();
    let longest = gaps.iter().map(|(_, (_, periods, _))| *periods).max()?;
    let gaps = if many == 1 { "gap" } else { "gaps" };
    Some(format!(
        "{many} {gaps} of up to {longest} periods (first before row {row}), where rows are lost or the logger \
         is slower: they are filled, the output interpolated and the input held"
    ))
}

/// A length of time for people: `10 ms`, `7.753 ms`, `1 s`.
fn duration(seconds: f64) -> String {
    let (value, unit) = match seconds {
        1.0.. => (seconds, "s"),
        1e-3.. => (seconds * 1e3, "ms"),
        _ => (seconds * 1e6, "µs"),
    };
    format!("{} {unit}", as_written(value, 4))
}

/// A percentage to two digits: `2.3`, `14`, `0.087`.
fn two_digits(percent: f64) -> String {
    as_written(percent, 2).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::grid::Signals;

    fn noise(k: usize) -> f64 {
        ((k as f64 * 12.9898).sin() * 43_758.545_3).fract()
    }

    fn jittering(rows: usize, period: f64, size: f64) -> Vec<f64> {
        (0..rows).map(|k| period * (k as f64 + size * noise(k))).collect()
    }

    fn laid(trials: &[&[f64]]) -> (Vec<Grid>, Vec<String>) {
        grids(trials, Repair::default(), &|_, row| row as u64 + 2).unwrap()
    }

    fn signals(input: &[f64], output: &[f64]) -> Signals {
        Signals { input: input.to_vec(), output: output.to_vec(), covariates: Vec::new() }
    }

    #[test]
    fn uniform_rows_pass_as_they_are() {
        let times: Vec<f64> = (0..500).map(|k| 3.0 + f64::from(k) * 0.01).collect();
        let (grids, notes) = laid(&[&times]);
        assert_eq!((grids[0].period().to_string().as_str(), notes.len()), ("0.01 s", 0));
        let pieces = grids[0].pieces(signals(&vec![1.0; 500], &vec![2.0; 500]));
        assert_eq!(pieces.len(), 1);
        assert_eq!(pieces[0].signals.output.len(), 500);
    }

    #[test]
    fn resampling_does_not_bridge_a_pause() {
        let mut times: Vec<f64> = (0..20).map(f64::from).collect();
        times.extend((0..20).map(|k| 100.0 + f64::from(k)));
        let resampled = Repair { resample: SamplePeriod::from_seconds(1.0), ..Repair::default() };
        let (grids, _) = grids(&[&times], resampled, &|_, row| row as u64).unwrap();
        assert_eq!(grids[0].pieces(signals(&times, &times)).len(), 2);
    }

    #[test]
    fn trials_of_one_rate_share_a_round_period() {
        let trials = [jittering(400, 0.009_999_7, 0.1), jittering(300, 0.010_000_2, 0.05)];
        let other = jittering(200, 0.05, 0.1);
        let (grids, notes) = laid(&[&trials[0], &trials[1], &other]);
        let periods: Vec<_> = grids.iter().map(|grid| grid.period().to_string()).collect();
        assert_eq!(periods, ["0.01 s", "0.01 s", "0.05 s"]);
        assert_eq!(notes.len(), 2, "{notes:?}");
        assert!(notes[0].starts_with("2 of 3 trials: the clock jitters by "), "{notes:?}");
        assert!(notes[0].ends_with("samples are placed on a grid of 10 ms"), "{notes:?}");
    }

    #[test]
    fn jitter_changes_no_value_and_uneven_samples_are_interpolated() {
        let signals = |times: &[f64]| signals(&vec![1.0; times.len()], times);
        let times = jittering(200, 0.01, 0.1);
        let (grids, _) = laid(&[&times]);
        assert_eq!(grids[0].pieces(signals(&times))[0].signals.output, times);
        let mut now = 0.0;
        let mut step = |k: usize| {
            now += 0.01 * (1.0 + 0.5 * noise(k));
            now
        };
        let times: Vec<f64> = (0..500).map(&mut step).collect();
        let (grids, notes) = laid(&[&times]);
        assert!(notes[0].contains("interpolated"), "{notes:?}");
        let piece = &grids[0].pieces(signals(&times))[0];
        for (k, output) in piece.signals.output.iter().enumerate() {
            let time = piece.start_s + k as f64 * grids[0].period().seconds();
            assert!((output - time).abs() < 1e-9, "the output is its time");
        }
    }

    #[test]
    fn lengths_of_time_and_shares_are_short() {
        assert_eq!(
            [0.01, 0.007_753_13, 2.0, 2e-5].map(duration),
            ["10 ms", "7.753 ms", "2 s", "20 µs"]
        );
        assert_eq!([2.345, 14.4, 0.0871].map(two_digits), ["2.3", "14", "0.087"]);
    }
}
