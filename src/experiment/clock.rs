//! What the stamps of a trial say of its clock: its period, how far it jitters, where it
//! jumps, and which rows follow one another.
//!
//! A stamp is `t_k = a + T·n_k + d_k + j_k` with the place `n_k` of row `k` on an even grid, a
//! slow drift `d_k` and a jitter `j_k`. Lost rows show as a jump that the rows behind it keep;
//! a stamp that is only late is made good by the next ones.

use crate::numerics::{median, quantile};

/// A step of more periods than this may be a jump.
const JUMP: f64 = 1.5;

/// Rows behind a jump that are asked whether it lasts.
const LOOK_AHEAD: usize = 5;

/// A gap is filled up to so many periods: one row of Algorithm 1's Φ at its usual β.
const FILLED_PERIODS: f64 = 5.0;

/// A gap is filled up to so many seconds: short beside the dead times of hydraulic joints.
const FILLED_S: f64 = 0.05;

/// Rows whose stamps lie within this part of a period of the even grid stay as they are; what
/// interpolating them would add is of the same size as what it would mend.
const KEPT: f64 = 0.25;

/// Part of the rows that must lie within it: single stamps may be late by any amount.
const KEPT_SHARE: f64 = 0.95;

/// Largest part of the places without a row; above it rows are not lost, but not even.
const LOST_SHARE: f64 = 0.1;

/// Rows of a block, over which the slow drift of the clock is its median.
const BLOCK: usize = 50;

/// Largest drift from block to block, as a part of the time between them, and the period's
/// own tolerance: the same as of a clock without jitter.
const DRIFT: f64 = 0.01;

/// Why a clock cannot be read; `row` counts the rows from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ClockFault {
    /// One stamp is far from its neighbours.
    Garbage { row: usize },
    /// All stamps are equal.
    StandsStill,
    /// There is one row only.
    SingleRow,
    /// The stamps are coarser than the sampling, and not even.
    TooCoarse { row: usize, step: f64, period: f64 },
}

/// Rows that follow one another without a long gap.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Run {
    /// Rows in the order of their time.
    pub(super) rows: Vec<usize>,
    /// Their places on an even grid; the first is 0.
    pub(super) places: Vec<usize>,
    /// Whether the clock starts anew here, and not behind a gap.
    pub(super) restarts: bool,
}

/// What became of the rows of a trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Evenness {
    /// The stamps jitter about an even grid.
    Jitters,
    /// The stamps are rounded to so many seconds, which is more than half a period.
    Rounded { to_s: f64 },
    /// The sampling itself is uneven.
    Uneven,
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
    /// Largest drift from the even grid, in periods.
    pub(super) drift: f64,
    /// Short gaps: how many, the longest in periods, and the row behind the first.
    pub(super) gaps: Option<(usize, usize, usize)>,
    /// Rows that are there twice: how many, and the first.
    pub(super) twice: Option<(usize, usize)>,
    /// Rows that came out of order: how many, and the first.
    pub(super) disordered: Option<(usize, usize)>,
    /// Rows during which the clock stood still before it jumped: how many, and the first.
    pub(super) frozen: Option<(usize, usize)>,
    /// Rows that stand alone between two gaps, and are left out.
    pub(super) alone: usize,
}

/// The longest gap that is filled unasked, in seconds.
pub(super) fn filled_s(period: f64) -> f64 {
    (FILLED_PERIODS * period).max(FILLED_S)
}

impl Clock {
    /// Reads the stamps `times`, in seconds; gaps up to `fill_s` do not part a run, nor those
    /// that are filled unasked where it is none.
    pub(super) fn read(times: &[f64], fill_s: Option<f64>) -> Result<Self, ClockFault> {
        let typical = typical_period(times)?;
        let mut found = Found::default();
        let (mut runs, mut alone) = (Vec::new(), 0);
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
            let rows = found.without_frozen(rows, times, &typical);
            let rows = found.once(rows, times, &typical);
            let mut parts = parted(&rows, times, &typical, longest.max(1.0));
            if let Some(first) = parts.first_mut() {
                first.restarts = index > 0;
            }
            alone += parts.iter().filter(|run| run.rows.len() < 2).count();
            runs.extend(parts.into_iter().filter(|run| run.rows.len() > 1));
        }
        let period = least_squares_period(&runs, times).ok_or(ClockFault::SingleRow)?;
        let deviations = Deviations::of(&runs, times, period, block_rows(&typical, period));
        let evenness = deviations.evenness(&runs, &typical, period)?;
        Ok(Self {
            gaps: short_gaps(&runs),
            runs,
            period,
            evenness,
            jitter: deviations.deviation(),
            largest: deviations.largest(),
            drift: deviations.drift,
            twice: found.twice,
            disordered: found.disordered,
            frozen: found.frozen,
            alone,
        })
    }

    /// Rows of its longest run.
    pub(super) fn longest(&self) -> usize {
        self.runs.iter().map(|run| run.rows.len()).max().unwrap_or_default()
    }

    /// When the places of `run` begin, on a grid of `period`: the least-squares offset.
    pub(super) fn start_s(run: &Run, times: &[f64], period: f64) -> f64 {
        let offsets = run.points(times).map(|(place, time)| time - place * period);
        offsets.sum::<f64>() / run.rows.len().max(1) as f64
    }
}

impl Run {
    /// Place and stamp of each row.
    fn points<'a>(&'a self, times: &'a [f64]) -> impl Iterator<Item = (f64, f64)> + 'a {
        let stamps = self.rows.iter().filter_map(|&row| times.get(row).copied());
        self.places.iter().map(|&place| place as f64).zip(stamps)
    }
}

/// The period before it is fitted, and what stamps are rounded to.
struct Typical {
    seconds: f64,
    /// The grain of the stamps where it is above half a period; else 0.
    grain_s: f64,
}

/// The mean of the steps that are no jumps. Stamps that are rounded may stand still.
fn typical_period(times: &[f64]) -> Result<Typical, ClockFault> {
    let steps = times.windows(2).map(|pair| pair[1] - pair[0]);
    let forward: Vec<f64> = steps.clone().filter(|step| *step > 0.0).collect();
    if times.len() < 2 {
        return Err(ClockFault::SingleRow);
    }
    let middle = median(&forward).ok_or(ClockFault::StandsStill)?;
    let even: Vec<f64> = steps.filter(|step| (0.0..=JUMP * middle).contains(step)).collect();
    // Rows that are there twice are few; stamps that are rounded stand still often.
    let still = even.iter().filter(|step| **step < middle * 1e-3).count();
    let rounded = still as f64 > LOST_SHARE * even.len() as f64;
    let counted = even.len() - if rounded { 0 } else { still };
    let seconds = even.iter().sum::<f64>() / counted.max(1) as f64;
    let grain = forward.iter().copied().fold(f64::INFINITY, f64::min);
    let is_multiple = |step: &f64| ((step / grain) - (step / grain).round()).abs() < 1e-3;
    let coarse = grain > 0.5 * seconds && rounded && forward.iter().all(is_multiple);
    Ok(Typical { seconds, grain_s: if coarse { grain } else { 0.0 } })
}

/// Whether the stamps, sorted, are those of one clock without a gap, and none is there twice.
fn is_even_once_sorted(times: &[f64]) -> bool {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    let steps: Vec<f64> = sorted.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let is_usual = |middle: f64| steps.iter().all(|step| (0.5..JUMP).contains(&(step / middle)));
    median(&steps).is_some_and(is_usual)
}

/// The rows at which the sampling goes over to another rate for good: the first of them, the
/// period before and behind it, and how many there are.
pub(super) fn rate_changes(run: &Run, times: &[f64]) -> Option<(usize, [f64; 2], usize)> {
    /// Steps on either side whose medians are compared.
    const STEPS: usize = 20;
    /// Part by which they must differ.
    const OTHER: f64 = 0.1;
    let stamps: Vec<f64> = run.rows.iter().filter_map(|row| times.get(*row).copied()).collect();
    let steps: Vec<f64> = stamps.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut found: Option<(usize, [f64; 2], usize)> = None;
    let mut index = STEPS;
    while let (Some(before), Some(behind)) =
        (steps.get(index.saturating_sub(STEPS)..index), steps.get(index..index + STEPS))
    {
        index += 1;
        let Some((before, behind)) = median(before).zip(median(behind)) else { continue };
        if (behind / before - 1.0).abs() <= OTHER {
            continue;
        }
        let is_new = |step: &&f64| (**step - behind).abs() < (**step - before).abs();
        let later = steps.iter().skip(index - 1).take_while(|step| !is_new(step)).count();
        let first = run.rows.get(index + later).copied().unwrap_or_default();
        // Behind the change, and not across it.
        let own = steps.iter().skip(index - 1 + later).take(STEPS).copied();
        let behind = median(&own.collect::<Vec<_>>()).unwrap_or(behind);
        let (first, periods, count) = found.unwrap_or((first, [before, behind], 0));
        found = Some((first, periods, count + 1));
        index += later + STEPS;
    }
    found
}

/// Runs of rows between the places where time jumps back for good.
fn between_restarts(times: &[f64], period: f64) -> Result<Vec<Vec<usize>>, ClockFault> {
    let at = |row: usize| times.get(row).copied();
    let mut runs = vec![Vec::new()];
    for row in 0..times.len() {
        let before = row.checked_sub(1).and_then(at);
        let back = before.zip(at(row)).map_or(0.0, |(before, now)| (before - now) / period);
        if back > LOOK_AHEAD as f64 {
            let later = (row + 1..=row + LOOK_AHEAD).filter_map(at);
            let returns = before.is_some_and(|before| later.clone().any(|time| time > before));
            let spike = row.checked_sub(2).and_then(at).zip(at(row)).is_some_and(|(a, b)| b > a);
            if returns || spike {
                return Err(ClockFault::Garbage { row });
            }
            runs.push(Vec::new());
        }
        if let Some(run) = runs.last_mut() {
            run.push(row);
        }
    }
    Ok(runs)
}

/// What was found on the way.
#[derive(Default)]
struct Found {
    twice: Option<(usize, usize)>,
    disordered: Option<(usize, usize)>,
    frozen: Option<(usize, usize)>,
}

fn count(found: &mut Option<(usize, usize)>, row: usize) {
    let (many, first) = found.unwrap_or((0, row));
    *found = Some((many + 1, first.min(row)));
}

impl Found {
    /// `rows` in the order of their stamps.
    fn in_order(&mut self, mut rows: Vec<usize>, times: &[f64]) -> Vec<usize> {
        let time = |row: usize| times.get(row).copied().unwrap_or(f64::NAN);
        for pair in rows.windows(2).filter(|pair| time(pair[1]) < time(pair[0])) {
            count(&mut self.disordered, pair[1]);
        }
        rows.sort_by(|a, b| time(*a).total_cmp(&time(*b)));
        rows
    }

    /// `rows` without those at which the clock stood still: many of one stamp, as usual before
    /// the first of them, and with a jump behind the last that makes up for them. When each of
    /// them was measured is not known.
    fn without_frozen(&mut self, rows: Vec<usize>, times: &[f64], typical: &Typical) -> Vec<usize> {
        if typical.grain_s > 0.0 {
            return rows;
        }
        let time = |row: &usize| times.get(*row).copied().unwrap_or(f64::NAN);
        #[expect(clippy::float_cmp, reason = "whether a stamp is repeated")]
        let groups: Vec<&[usize]> = rows.chunk_by(|a, b| time(a) == time(b)).collect();
        let at = |index: usize| Some(time(groups.get(index)?.first()?));
        let step = |from: Option<usize>, to: usize| Some((at(to)? - at(from?)?) / typical.seconds);
        let mut kept = Vec::with_capacity(rows.len());
        for (index, group) in groups.iter().enumerate() {
            let makes_up = |step: f64| step > 0.5 * group.len() as f64;
            let is_frozen = group.len() > LOOK_AHEAD
                && step(index.checked_sub(1), index).is_none_or(|step| step <= JUMP)
                && step(Some(index), index + 1).is_none_or(makes_up);
            let (first, others) = group.split_at(if is_frozen { 1 } else { group.len() });
            kept.extend_from_slice(first);
            for row in others {
                count(&mut self.frozen, *row);
            }
        }
        kept
    }

    /// `rows` without those that are there twice: a row at the time of the one before it,
    /// between steps as usual, and not made good by those behind it, as a rounded stamp is.
    fn once(&mut self, rows: Vec<usize>, times: &[f64], typical: &Typical) -> Vec<usize> {
        /// Part of a period from which a row is one of its own.
        const OWN: f64 = 0.25;
        let time = |index: usize| rows.get(index).and_then(|&row| times.get(row)).copied();
        let step = |from: usize, to: usize| Some((time(to)? - time(from)?) / typical.seconds);
        let is_usual = |step: Option<f64>| step.is_none_or(|step| (0.5..JUMP).contains(&step));
        let is_twice = |index: usize| {
            let Some(before) = index.checked_sub(1) else { return false };
            let later =
                (1..=LOOK_AHEAD + 1).map_while(|k| Some(step(before, before + k)? - k as f64));
            typical.grain_s <= 0.0
                && step(before, index).is_some_and(|step| step < OWN)
                && is_usual(before.checked_sub(1).and_then(|first| step(first, before)))
                && is_usual(step(index, index + 1))
                && later.fold(f64::NEG_INFINITY, f64::max) < -0.5
        };
        let twice: Vec<bool> = (0..rows.len()).map(is_twice).collect();
        for (&row, _) in rows.iter().zip(&twice).filter(|(_, twice)| **twice) {
            count(&mut self.twice, row);
        }
        rows.into_iter().zip(twice).filter(|(_, twice)| !twice).map(|(row, _)| row).collect()
    }
}

/// `rows` in parts, between gaps of more than `longest` periods.
fn parted(rows: &[usize], times: &[f64], typical: &Typical, longest: f64) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (index, &row) in rows.iter().enumerate() {
        let early = runs.last().map_or(0.0, |run| earliness(run, times, typical.seconds));
        let lost = if index == 0 { 0 } else { lost_before(index, rows, times, typical, early) };
        let step = lost + 1;
        match runs.last_mut().filter(|_| step as f64 <= longest * (1.0 + 1e-9)) {
            Some(run) if index > 0 => {
                let place = run.places.last().copied().unwrap_or_default() + step;
                run.rows.push(row);
                run.places.push(place);
            }
            _ => runs.push(Run { rows: vec![row], places: vec![0], restarts: false }),
        }
    }
    runs
}

/// By how many periods the last stamp of `run` comes early, beside the few before it.
fn earliness(run: &Run, times: &[f64], period: f64) -> f64 {
    let time = |row: &usize| times.get(*row).copied().unwrap_or(f64::NAN);
    let points = run.places.iter().zip(&run.rows).rev().take(LOOK_AHEAD);
    let phases: Vec<f64> = points.map(|(place, row)| time(row) / period - *place as f64).collect();
    median(&phases).zip(phases.first()).map_or(0.0, |(usual, last)| usual - last)
}

/// Rows that are missing before the row at `index`, as far as the rows behind it say so; the
/// one before it comes `early` by so many periods.
fn lost_before(
    index: usize,
    rows: &[usize],
    times: &[f64],
    typical: &Typical,
    early: f64,
) -> usize {
    /// More places are no longer distinct as floating-point numbers.
    const MOST: f64 = 1e12;
    let time = |index: usize| rows.get(index).and_then(|&row| times.get(row)).copied();
    let Some(before) = index.checked_sub(1).and_then(time) else { return 0 };
    let shift = |(later, k): (f64, f64)| (later - before) / typical.seconds - early - k;
    let step = time(index).map_or(0.0, |now| shift((now, 0.0)));
    let slack = typical.grain_s / typical.seconds;
    if step <= JUMP + slack {
        return 0;
    }
    // As many rows as it takes to catch up, if they came late.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 200")]
    let ahead = ((2.0 * step).min(200.0) as usize).max(LOOK_AHEAD);
    let later = (index..=index + ahead).map_while(time).zip((1..).map(f64::from));
    let lasting = later.map(shift).fold(f64::INFINITY, f64::min);
    let lost = if lasting > (0.5 + slack).max(0.5 * (step - 1.0)) {
        step.round() - 1.0
    } else if lasting > 0.5 + slack {
        lasting.round()
    } else {
        0.0
    };
    crate::units::floor_to_index(lost.min(MOST))
}

/// The slope of stamps over places that all `runs` share.
fn least_squares_period(runs: &[Run], times: &[f64]) -> Option<f64> {
    let (mut products, mut squares) = (0.0, 0.0);
    for run in runs {
        let n = run.rows.len() as f64;
        let place = run.places.iter().map(|&place| place as f64).sum::<f64>() / n;
        let time = run.points(times).map(|(_, time)| time).sum::<f64>() / n;
        for (x, t) in run.points(times) {
            products += (x - place) * (t - time);
            squares += (x - place) * (x - place);
        }
    }
    let period = products / squares;
    (period.is_finite() && period > 0.0).then_some(period)
}

/// How far stamps are from the even grid, in periods.
struct Deviations {
    /// Beside the slow drift, of every row of every run.
    jitter: Vec<(f64, usize)>,
    drift: f64,
    /// Largest change of the drift from block to block, as a part of the time between them.
    rate: f64,
}

impl Deviations {
    fn of(runs: &[Run], times: &[f64], period: f64, block: usize) -> Self {
        let mut all = Self { jitter: Vec::new(), drift: 0.0, rate: 0.0 };
        for run in runs {
            let start = Clock::start_s(run, times, period);
            let whole: Vec<f64> =
                run.points(times).map(|(place, time)| (time - start) / period - place).collect();
            let blocks: Vec<f64> = whole.chunks(block).filter_map(median).collect();
            for pair in blocks.windows(2) {
                all.rate = all.rate.max((pair[1] - pair[0]).abs() / block as f64);
            }
            for (k, (deviation, &row)) in whole.iter().zip(&run.rows).enumerate() {
                let drift = between_blocks(&blocks, block, k);
                all.drift = all.drift.max(drift.abs());
                all.jitter.push((deviation - drift, row));
            }
        }
        all
    }

    fn deviation(&self) -> f64 {
        let squares = self.jitter.iter().map(|(jitter, _)| jitter * jitter).sum::<f64>();
        (squares / self.jitter.len().max(1) as f64).sqrt()
    }

    fn largest(&self) -> (f64, usize) {
        let sizes = self.jitter.iter().map(|(jitter, row)| (jitter.abs(), *row));
        sizes.fold((0.0, 0), |largest, one| if one.0 > largest.0 { one } else { largest })
    }

    fn evenness(
        &self,
        runs: &[Run],
        typical: &Typical,
        period: f64,
    ) -> Result<Evenness, ClockFault> {
        let sizes: Vec<f64> = self.jitter.iter().map(|(jitter, _)| jitter.abs()).collect();
        let within = |limit: f64| quantile(&sizes, KEPT_SHARE).is_some_and(|size| size <= limit);
        let rows: usize = runs.iter().map(|run| run.rows.len()).sum();
        let places = runs.iter().filter_map(|run| run.places.last()).map(|last| last + 1);
        let whole = (1.0 - LOST_SHARE) * places.sum::<usize>() as f64 <= rows as f64;
        let steady = whole && self.rate <= DRIFT;
        // Rounding moves a stamp by up to half a grain either way.
        let rounding = 0.55 * typical.grain_s / period;
        if steady && typical.grain_s > 0.0 && within(rounding.max(KEPT)) {
            return Ok(Evenness::Rounded { to_s: typical.grain_s });
        }
        if typical.grain_s > 2.0 * period {
            let (largest, row) = self.largest();
            return Err(ClockFault::TooCoarse { row, step: largest * period, period });
        }
        Ok(if steady && within(KEPT) { Evenness::Jitters } else { Evenness::Uneven })
    }
}

/// Rows of a block: whole grains of stamps that are rounded, whose sawtooth is no drift.
fn block_rows(typical: &Typical, period: f64) -> usize {
    let grain = crate::units::floor_to_index((typical.grain_s / period).round()).max(1);
    grain.saturating_mul(BLOCK.div_ceil(grain))
}

/// The drift at row `k` of a run: the line between the medians of its blocks.
fn between_blocks(blocks: &[f64], block: usize, k: usize) -> f64 {
    let center = (k as f64 + 0.5) / block as f64 - 0.5;
    let last = blocks.len().saturating_sub(1);
    let index = crate::units::floor_to_index(center).min(last);
    let (Some(&from), Some(&to)) = (blocks.get(index), blocks.get((index + 1).min(last))) else {
        return 0.0;
    };
    from + (center - index as f64).clamp(0.0, 1.0) * (to - from)
}

fn short_gaps(runs: &[Run]) -> Option<(usize, usize, usize)> {
    let mut gaps: Option<(usize, usize, usize)> = None;
    for run in runs {
        for (pair, &row) in run.places.windows(2).zip(run.rows.iter().skip(1)) {
            let step = pair[1] - pair[0];
            if step > 1 {
                let (many, longest, first) = gaps.unwrap_or((0, 0, row));
                gaps = Some((many + 1, longest.max(step), first));
            }
        }
    }
    gaps
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

    fn read(times: &[f64]) -> Clock {
        Clock::read(times, None).unwrap()
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
        assert!(clock.drift > 1.0 && clock.jitter < 0.05, "{} {}", clock.drift, clock.jitter);
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
    fn lost_rows_and_late_stamps_are_told_apart() {
        let lost = |k: usize| if k < 50 { k } else { k + 3 };
        let clock = read(&stamps(200, |k| 0.01 * (lost(k) as f64 + 0.05 * noise(k))));
        assert_eq!((clock.gaps, sizes(&clock)), (Some((1, 4, 50)), vec![200]));
        // Rows 50 to 60 were held up and come all at once.
        let late = |k: usize| if (50..60).contains(&k) { 60.0 + 1e-3 * k as f64 } else { k as f64 };
        let clock = read(&stamps(400, |k| 0.01 * late(k)));
        assert_eq!((clock.gaps, clock.twice, clock.evenness), (None, None, Evenness::Jitters));
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
        let restarts: Vec<bool> = clock.runs.iter().map(|run| run.restarts).collect();
        assert_eq!(restarts, [false, false, true]);
    }

    #[test]
    fn a_row_that_is_there_twice_is_left_out() {
        let clock = read(&stamps(200, |k| 0.01 * (if k < 80 { k } else { k - 1 }) as f64));
        assert_eq!((clock.twice, sizes(&clock)), (Some((1, 80)), vec![199]));
        let rounded = read(&stamps(200, |k| 0.01 * (if k == 80 { 79 } else { k }) as f64));
        assert_eq!((rounded.twice, sizes(&rounded)), (None, vec![200]));
    }

    #[test]
    fn rows_out_of_order_are_sorted_and_garbage_is_named() {
        let swapped = |k: usize| match k {
            40 => 41,
            41 => 40,
            _ => k,
        };
        let clock = read(&stamps(100, |k| 0.01 * swapped(k) as f64));
        assert_eq!(clock.disordered, Some((1, 41)));
        assert_eq!(clock.runs[0].rows[40..42], [41, 40]);
        for (wrong, row) in [(0.01, 60), (99.0, 61)] {
            let times = stamps(100, |k| if k == 60 { wrong } else { 0.01 * k as f64 });
            assert_eq!(Clock::read(&times, None), Err(ClockFault::Garbage { row }));
        }
        assert_eq!(Clock::read(&[1.0; 5], None), Err(ClockFault::StandsStill));
        assert_eq!(Clock::read(&[1.0], None), Err(ClockFault::SingleRow));
    }
}
