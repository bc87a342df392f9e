//! Which rows follow one another: in order, each once, and parted where the clock jumps.

use super::period::Typical;
use super::run::{JUMP, Oddity, Run, not_increasing};
use crate::experiment::error::ReadError;
use crate::numerics::median;

/// Rows after a jump that are asked whether it lasts.
const LOOK_AHEAD: usize = 5;

/// Whether the stamps, sorted, are those of one clock without a gap, and none is there twice.
pub(super) fn is_even_once_sorted(times: &[f64]) -> bool {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    let steps: Vec<f64> = sorted.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let is_usual = |middle: f64| steps.iter().all(|step| (0.5..JUMP).contains(&(step / middle)));
    median(&steps).is_some_and(is_usual)
}

/// Runs of rows between the places where time jumps back for good.
pub(in crate::experiment) fn between_restarts(
    times: &[f64],
    period: f64,
) -> Result<Vec<Vec<usize>>, ReadError> {
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
                return Err(not_increasing(times, row));
            }
            runs.push(Vec::new());
        }
        if let Some(run) = runs.last_mut() {
            run.push(row);
        }
    }
    Ok(runs)
}

/// `rows` in the order of their stamps.
pub(super) fn in_order(
    mut rows: Vec<usize>,
    times: &[f64],
    odd: &mut Vec<(Oddity, usize)>,
) -> Vec<usize> {
    let time = |row: usize| times.get(row).copied().unwrap_or(f64::NAN);
    let late = rows.windows(2).filter(|pair| time(pair[1]) < time(pair[0]));
    odd.extend(late.map(|pair| (Oddity::Disordered, pair[1])));
    rows.sort_by(|a, b| time(*a).total_cmp(&time(*b)));
    rows
}

/// `rows` without those that are there twice: a row at the time of the one before it,
/// between steps as usual, and not made good by those after it, as a rounded stamp is: the last
/// row, after which there is none, only where it has the same stamp.
/// Of two with one stamp the later stays: where they differ, it says what holds from then on.
pub(super) fn once(
    rows: Vec<usize>,
    times: &[f64],
    typical: &Typical,
    odd: &mut Vec<(Oddity, usize)>,
) -> Vec<usize> {
    /// Part of a period from which a row is one of its own.
    const OWN: f64 = 0.25;
    let time = |index: usize| rows.get(index).and_then(|&row| times.get(row)).copied();
    let step = |from: usize, to: usize| Some((time(to)? - time(from)?) / typical.seconds);
    let is_usual = |step: Option<f64>| step.is_none_or(|step| (0.5..JUMP).contains(&step));
    let is_twice = |index: usize| {
        let Some(before) = index.checked_sub(1) else { return false };
        let later = (1..=LOOK_AHEAD + 1).map_while(|k| Some(step(before, before + k)? - k as f64));
        let own = if time(index + 1).is_some() { OWN } else { f64::MIN_POSITIVE };
        typical.grain_s <= 0.0
            && step(before, index).is_some_and(|step| step < own)
            && is_usual(before.checked_sub(1).and_then(|first| step(first, before)))
            && is_usual(step(index, index + 1))
            && later.fold(f64::NEG_INFINITY, f64::max) < -0.5
    };
    let mut stays = vec![true; rows.len()];
    for index in (0..rows.len()).filter(|index| is_twice(*index)) {
        odd.push((Oddity::Twice, rows[index]));
        let has_one_stamp = step(index - 1, index).is_some_and(|step| step <= 0.0);
        stays[if has_one_stamp { index - 1 } else { index }] = false;
    }
    rows.into_iter().zip(stays).filter(|(_, stays)| *stays).map(|(row, _)| row).collect()
}

/// `rows` in parts, between gaps of more than `longest` periods.
pub(super) fn parted(rows: &[usize], times: &[f64], typical: &Typical, longest: f64) -> Vec<Run> {
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
            _ => runs.push(Run { rows: vec![row], places: vec![0] }),
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

/// Rows that are missing before the row at `index`, as far as the rows after it say so; the
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

pub(super) fn short_gaps(runs: &[Run]) -> Option<(usize, usize, usize)> {
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
