//! The grids of a log whose clock is not uniform, and what its reader should know of them.

use super::clock::{Clock, ClockFault, Evenness, Run, filled_s, rate_changes, spread};
use super::sampling::{Fault, Grid, Part, Repair, is_uniform};
use crate::numerics::as_written;
use crate::units::SamplePeriod;

/// Trials whose periods differ by less are of one rate: the tolerance of a uniform clock.
const ONE_RATE: f64 = 0.01;

/// Tolerance of one rate where the sampling is uneven, so that a period is only a mean.
const ONE_UNEVEN_RATE: f64 = 0.15;

/// By so many periods a row may be off its time because the period is a round number.
const ROUNDING: f64 = 0.1;

/// Significant digits of the period of a grid that is laid anew.
const ROUND_RELATIVE: f64 = 0.03;

/// The grids of all trials, whose rows have the times `trials`; and a line on each thing that
/// was found, which calls a row of a trial by `number`.
pub(super) fn grids(
    trials: &[&[f64]],
    repair: Repair,
    number: &dyn Fn(usize, usize) -> u64,
) -> Result<(Vec<Grid>, Vec<String>), (usize, Fault)> {
    let in_bursts = trials.iter().map(|times| if is_uniform(times) { None } else { spread(times) });
    let in_bursts: Vec<Option<Vec<f64>>> = in_bursts.collect();
    let even = trials.iter().zip(&in_bursts);
    let trials: Vec<&[f64]> = even.map(|(times, even)| even.as_deref().unwrap_or(times)).collect();
    let trials = trials.as_slice();
    let read = |(index, times): (usize, &&[f64])| {
        Clock::read(times, repair.fill_s).map_err(|fault| (index, fault_of(fault)))
    };
    let clocks = trials.iter().enumerate().map(read).collect::<Result<Vec<_>, _>>()?;
    let periods = common_periods(&clocks, repair.resample);
    let mut grids = Vec::new();
    for (index, ((clock, times), period)) in clocks.iter().zip(trials).zip(&periods).enumerate() {
        let parts = clock.runs.iter().map(|run| part(run, clock, times, *period, repair));
        let parts = parts.collect::<Result<Vec<_>, _>>().map_err(|fault| (index, fault))?;
        let period = SamplePeriod::from_seconds(*period).ok_or((index, Fault::SingleRow))?;
        grids.push(Grid::of_parts(period, parts));
    }
    let uniform: Vec<bool> = trials.iter().map(|times| is_uniform(times)).collect();
    let notes =
        Findings { clocks: &clocks, trials, periods: &periods, uniform: &uniform, number, repair };
    let spread = in_bursts.iter().any(Option::is_some).then(|| {
        "rows come in bursts, as packets bring them: those of each are spread evenly over the time since \
         the one before"
            .to_owned()
    });
    Ok((grids, spread.into_iter().chain(notes.lines()).collect()))
}

fn fault_of(fault: ClockFault) -> Fault {
    match fault {
        ClockFault::Garbage { row } => Fault::NotIncreasing { row },
        ClockFault::StandsStill => Fault::NotIncreasing { row: 1 },
        ClockFault::SingleRow => Fault::SingleRow,
        ClockFault::FewStamps { stamps, grain_s } => Fault::FewStamps { stamps, grain_s },
        ClockFault::TooCoarse { row, grain_s, period } => Fault::Coarse { row, grain_s, period },
    }
}

/// The period of each trial's grid: trials of one rate share one, a round number where that
/// puts no row at another place.
fn common_periods(clocks: &[Clock], resample: Option<SamplePeriod>) -> Vec<f64> {
    if let Some(period) = resample {
        return vec![period.seconds(); clocks.len()];
    }
    let is_even = |clock: &&Clock| clock.evenness != Evenness::Uneven;
    let mut rates: Vec<f64> = Vec::new();
    let even: Vec<&Clock> = clocks.iter().filter(is_even).collect();
    for group in grouped(even, ONE_RATE) {
        let longest = group.iter().map(|clock| clock.longest()).max().unwrap_or(1);
        rates.push(rounded(mean_period(&group), (ROUNDING / longest as f64).min(2.0 * ONE_RATE)));
    }
    let uneven: Vec<&Clock> = clocks.iter().filter(|clock| !is_even(clock)).collect();
    for group in grouped(uneven, ONE_UNEVEN_RATE) {
        let mean = mean_period(&group);
        let near = |rate: &&f64| (**rate / mean - 1.0).abs() <= ONE_UNEVEN_RATE;
        if !rates.iter().any(|rate| near(&rate)) {
            rates.push(rounded(mean, ROUND_RELATIVE));
        }
    }
    let distance = |rate: f64, clock: &Clock| (rate / clock.period).ln().abs();
    let nearest = |clock: &Clock| {
        let by_distance = |a: &f64, b: &f64| distance(*a, clock).total_cmp(&distance(*b, clock));
        rates.iter().copied().min_by(by_distance).unwrap_or(clock.period)
    };
    clocks.iter().map(nearest).collect()
}

/// Clocks whose periods differ by no more than a part `tolerance` of the first of their group.
fn grouped(mut clocks: Vec<&Clock>, tolerance: f64) -> Vec<Vec<&Clock>> {
    clocks.sort_by(|a, b| a.period.total_cmp(&b.period));
    let mut groups: Vec<Vec<&Clock>> = Vec::new();
    for clock in clocks {
        let of_one_rate = |group: &&mut Vec<&Clock>| {
            let first = group.first().map_or(f64::NAN, |first| first.period);
            clock.period <= first * (1.0 + tolerance)
        };
        match groups.last_mut().filter(of_one_rate) {
            Some(group) => group.push(clock),
            None => groups.push(vec![clock]),
        }
    }
    groups
}

/// The mean period, each trial counting by its rows.
fn mean_period(clocks: &[&Clock]) -> f64 {
    let rows = |clock: &Clock| clock.runs.iter().map(|run| run.rows.len()).sum::<usize>() as f64;
    let all: f64 = clocks.iter().map(|clock| rows(clock)).sum();
    clocks.iter().map(|clock| clock.period * rows(clock)).sum::<f64>() / all
}

/// `period` with as few digits as leave it right to a part `tolerance`.
fn rounded(period: f64, tolerance: f64) -> f64 {
    let is_right = |rounded: &f64| (rounded / period - 1.0).abs() <= tolerance;
    (1..=9).map(|digits| as_written(period, digits)).find(is_right).unwrap_or(period)
}

/// The grid of a run.
fn part(
    run: &Run,
    clock: &Clock,
    times: &[f64],
    period: f64,
    repair: Repair,
) -> Result<Part, Fault> {
    let time = |row: usize| times.get(row).copied().unwrap_or(f64::NAN);
    let sampled = SamplePeriod::from_seconds(period).ok_or(Fault::SingleRow)?;
    let longest_gap_s = repair.fill_s.unwrap_or_else(|| filled_s(period));
    if clock.evenness != Evenness::Uneven && repair.resample.is_none() {
        let start_s = run.start_s(times, period);
        let grid = Grid::of_places(start_s, run.places.clone(), sampled, longest_gap_s)?;
        return Ok(Part { rows: run.rows.clone(), grid });
    }
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
    Ok(Part { rows, grid: Grid::resampled(times, sampled, longest_gap_s)? })
}

/// What was found in the clocks of a log.
struct Findings<'a> {
    clocks: &'a [Clock],
    /// The times of the rows of each trial.
    trials: &'a [&'a [f64]],
    periods: &'a [f64],
    /// Which of them are uniform, so that there is nothing to say of them.
    uniform: &'a [bool],
    /// What messages call a row of a trial.
    number: &'a dyn Fn(usize, usize) -> u64,
    repair: Repair,
}

impl Findings<'_> {
    fn lines(&self) -> Vec<String> {
        let mut lines = self.on_periods();
        lines.extend(self.on_gaps());
        let of = |what: fn(&Clock) -> Option<(usize, usize)>, says: &str| {
            let (count, row) = self.first(what)?;
            let rows = if count == 1 { "row is" } else { "rows are" };
            Some(format!("{count} {rows} {says} (first at row {row})"))
        };
        lines.extend(of(
            |clock| clock.twice,
            "at the time of the row before, and one of the two is left out",
        ));
        lines.extend(of(|clock| clock.disordered, "out of order and sorted by time"));
        let still = "stamped while the clock stood still, and left out: their times are not known";
        lines.extend(of(|clock| clock.frozen, still));
        lines.extend(self.on_restarts());
        let alone: usize = self.clocks.iter().map(|clock| clock.alone).sum();
        if alone > 0 {
            let samples = if alone == 1 { "sample is" } else { "samples are" };
            lines.push(format!("{alone} {samples} alone between gaps and left out"));
        }
        lines
    }

    /// Rows of a kind in all trials, and the number of the first.
    fn first(&self, what: fn(&Clock) -> Option<(usize, usize)>) -> Option<(usize, u64)> {
        let found = self.clocks.iter().enumerate();
        let mut found = found.filter_map(|(trial, clock)| Some((trial, what(clock)?)));
        let (trial, (count, row)) = found.next()?;
        let count = found.fold(count, |count, (_, (more, _))| count + more);
        Some((count, (self.number)(trial, row)))
    }

    /// Whether nothing is to be said of a clock but where it is cut.
    fn is_only_cut(&self, trial: usize) -> bool {
        /// Jitter, in periods, that is rounding.
        const NONE: f64 = 1e-3;
        let Some(clock) = self.clocks.get(trial).filter(|clock| clock.jitter < NONE) else {
            return false;
        };
        match clock.evenness {
            Evenness::Jitters => true,
            Evenness::Uneven => clock.gaps.is_some() && self.on_rates(&[trial]).is_none(),
            Evenness::Rounded { .. } => false,
        }
    }

    /// A line on each rate and kind of clock.
    fn on_periods(&self) -> Vec<String> {
        let kind = |index: usize| {
            let (clock, period) = (self.clocks.get(index)?, self.periods.get(index)?);
            let uniform = self.uniform.get(index).copied().unwrap_or_default();
            (!uniform && !self.is_only_cut(index)).then_some((clock.evenness, *period))
        };
        let mut kinds: Vec<(Evenness, f64)> = Vec::new();
        for found in (0..self.clocks.len()).filter_map(kind) {
            if !kinds.contains(&found) {
                kinds.push(found);
            }
        }
        let members = |found: &(Evenness, f64)| {
            let members = (0..self.clocks.len()).filter(|index| kind(*index) == Some(*found));
            members.collect::<Vec<_>>()
        };
        kinds.iter().map(|found| self.on_period(*found, &members(found))).collect()
    }

    fn on_period(&self, (evenness, grid): (Evenness, f64), members: &[usize]) -> String {
        let clocks: Vec<&Clock> = members.iter().filter_map(|&i| self.clocks.get(i)).collect();
        let all = self.clocks.len();
        let whose =
            if all == 1 { String::new() } else { format!("{} of {all} trials: ", members.len()) };
        if let Evenness::Rounded { to_s } = evenness {
            let (to, grid) = (duration(to_s), duration(grid));
            return format!(
                "{whose}the times are rounded to {to}: samples are placed evenly, {grid} apart"
            );
        }
        let what = if self.repair.resample.is_none() && evenness == Evenness::Jitters {
            "samples are placed on a grid of"
        } else {
            "samples are interpolated, the input held, on a grid of"
        };
        if let Some(changes) = self.on_rates(members) {
            return format!("{whose}{changes}: {what} {}", duration(grid));
        }
        let mean = duration(mean_period(&clocks));
        let squares = clocks.iter().map(|clock| clock.jitter * clock.jitter).sum::<f64>();
        let deviation = 100.0 * (squares / clocks.len() as f64).sqrt();
        let worst = members.iter().zip(&clocks);
        let worst = worst.max_by(|(_, a), (_, b)| a.largest.0.total_cmp(&b.largest.0));
        let (size, row) = worst.map_or((0.0, 0), |(trial, clock)| {
            (100.0 * clock.largest.0, (self.number)(*trial, clock.largest.1))
        });
        let drift = clocks.iter().map(|clock| clock.drift).fold(0.0, f64::max);
        let drift = if drift > 0.5 && evenness == Evenness::Jitters {
            format!(" and drifts by up to {drift:.1} periods")
        } else {
            String::new()
        };
        format!(
            "{whose}the clock jitters by {} % of its period of {mean} (standard deviation), \
             largest {} % at row {row}{drift}: {what} {}",
            two_digits(deviation),
            two_digits(size),
            duration(grid)
        )
    }

    /// Where clocks that do not jitter go over to other rates.
    fn on_rates(&self, members: &[usize]) -> Option<String> {
        /// Jitter, in periods, below which a clock is one of several rates.
        const STEADY: f64 = 0.02;
        let mut found: Option<(u64, [f64; 2], usize)> = None;
        for &trial in members {
            let (clock, times) = (self.clocks.get(trial)?, self.trials.get(trial)?);
            let is_steady = clock.evenness == Evenness::Uneven && clock.jitter < STEADY;
            for run in clock.runs.iter().filter(|_| is_steady) {
                let Some((row, periods, count)) = rate_changes(run, times) else { continue };
                let (first, periods, before) =
                    found.unwrap_or(((self.number)(trial, row), periods, 0));
                found = Some((first, periods, before + count));
            }
        }
        let (row, [before, behind], count) = found?;
        let times =
            if count == 1 { String::new() } else { format!(" and {} times more", count - 1) };
        let (before, behind) = (duration(before), duration(behind));
        Some(format!(
            "the sample rate changes at row {row}, from a sample per {before} to one per \
             {behind}{times}"
        ))
    }

    fn on_gaps(&self) -> Option<String> {
        // Other uneven samples are interpolated anyhow.
        let is_reported = |trial: &usize| {
            let even = self.clocks.get(*trial).map(|clock| clock.evenness != Evenness::Uneven);
            even == Some(true) || self.is_only_cut(*trial)
        };
        let reported = (0..self.clocks.len()).filter(is_reported);
        let reported = reported.filter_map(|trial| Some((trial, self.clocks.get(trial)?.gaps?)));
        let reported: Vec<(usize, (usize, usize, usize))> = reported.collect();
        let (trial, (_, _, row)) = *reported.first()?;
        let row = (self.number)(trial, row);
        let many: usize = reported.iter().map(|(_, (many, ..))| many).sum();
        let longest = reported.iter().map(|(_, (_, periods, _))| *periods).max()?;
        let gaps = if many == 1 { "gap" } else { "gaps" };
        Some(format!(
            "rows are lost in {many} {gaps} of up to {longest} periods (first before row {row}): \
             they are filled, the output in a line, the input held"
        ))
    }

    fn on_restarts(&self) -> Option<String> {
        let restarts = |clock: &Clock| {
            let mut runs = clock.runs.iter().filter(|run| run.restarts);
            let first = runs.next()?.rows.iter().min().copied()?;
            Some((1 + runs.count(), first))
        };
        let (count, row) = self.first(restarts)?;
        let times = if count == 1 { "once".to_owned() } else { format!("{count} times") };
        Some(format!("the clock starts anew {times} (first at row {row}): a new part begins there"))
    }
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
    use crate::experiment::sampling::Signals;

    fn noise(k: usize) -> f64 {
        ((k as f64 * 12.9898).sin() * 43_758.545_3).fract()
    }

    fn jittering(rows: usize, period: f64, size: f64) -> Vec<f64> {
        (0..rows).map(|k| period * (k as f64 + size * noise(k))).collect()
    }

    fn laid(trials: &[&[f64]]) -> (Vec<Grid>, Vec<String>) {
        grids(trials, Repair::default(), &|_, row| row as u64 + 2).unwrap()
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
        let signals = |times: &[f64]| Signals {
            input: vec![1.0; times.len()],
            output: times.to_vec(),
            covariates: Vec::new(),
        };
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
