//! Where the clock starts anew: a simulation that is reset, or a computer whose clock is set back. The
//! messages of each run are aligned by themselves.

use std::ops::Range;

use super::series::{Series, interval};
use crate::numerics::median;

/// Usual intervals that a time must lie behind the latest one before it, as in tables.
const BACK: f64 = 5.0;

/// Messages behind it that must not come up to that one again, else it is late by itself.
const LOOK_AHEAD: usize = 5;

/// Messages to one restart, at least (chosen): where there are more, the messages are in no order.
const SELDOM: usize = 100;

/// The messages of all series in runs, as the clock of that of `topic` starts anew.
pub(super) fn in_runs(series: Vec<Series>, topic: usize) -> Vec<Vec<Series>> {
    let clock = series.iter().find(|series| series.topic == topic);
    let starts = clock.map(|clock| restarts(&clock.times)).unwrap_or_default();
    let (Some(clock), false) = (clock, starts.is_empty()) else { return vec![series] };
    let starts: Vec<_> = series.iter().map(|series| starts_of(series, clock, &starts)).collect();
    let mut runs: Vec<Vec<Series>> = Vec::new();
    for (series, starts) in series.into_iter().zip(starts) {
        runs.resize_with(starts.len() + 1, Vec::new);
        for (run, part) in runs.iter_mut().zip(series.split(&starts)) {
            run.push(part);
        }
    }
    runs
}

/// Where the runs of a series begin, given the `starts` of those of the clock.
///
/// What is sent at changes alone does not show by itself where its clock starts anew: its runs
/// begin where those of the clock do in the file, and with the messages before it that are behind
/// the clock already.
fn starts_of(series: &Series, clock: &Series, starts: &[usize]) -> Vec<usize> {
    let mut behind = Vec::new();
    for (place, time) in series.places.iter().zip(&series.times) {
        let before = clock.places.partition_point(|own| own < place).checked_sub(1);
        let latest = before.and_then(|before| clock.times.get(before));
        behind.push(latest.map_or(0.0, |latest| latest.saturating_sub(*time) as f64));
    }
    let usual = median(&behind).unwrap_or_default();
    let limit = usual + BACK * interval(&clock.times).unwrap_or_default();
    let mut begins = Vec::new();
    for place in starts.iter().filter_map(|start| clock.places.get(*start)) {
        let end = series.places.partition_point(|own| own < place);
        let early = behind[..end].iter().rev().take_while(|behind| **behind > limit).count();
        begins.push((end - early).max(begins.last().copied().unwrap_or_default()));
    }
    begins
}

/// Where the clock starts anew, of `times` in the order of the file, in nanoseconds.
///
/// Runs that do not overlap are parts of one record in another order.
fn restarts(times: &[i64]) -> Vec<usize> {
    let Some(usual) = interval(times) else { return Vec::new() };
    let mut starts = Vec::new();
    let mut latest = i64::MIN;
    for (index, &time) in times.iter().enumerate() {
        let is_behind = index > 0 && latest.saturating_sub(time) as f64 > BACK * usual;
        let mut later = times.iter().skip(index + 1).take(LOOK_AHEAD);
        if is_behind && later.all(|later| *later < latest) {
            starts.push(index);
            latest = time;
        }
        latest = latest.max(time);
    }
    let are_shuffled = starts.len() * SELDOM > times.len();
    if are_shuffled || !overlap(times, &starts) { Vec::new() } else { starts }
}

/// Whether two of the runs with these `starts`, but for the first one, cover the same times.
fn overlap(times: &[i64], starts: &[usize]) -> bool {
    let begins = std::iter::once(0).chain(starts.iter().copied());
    let ends = starts.iter().copied().chain([times.len()]);
    let covered = |run: Range<usize>| {
        let run = times.get(run)?;
        run.iter().min().zip(run.iter().max())
    };
    let mut covered: Vec<_> = begins.zip(ends).filter_map(|(from, to)| covered(from..to)).collect();
    covered.sort_unstable();
    covered.windows(2).any(|pair| pair[1].0 < pair[0].1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(count: i64, first: i64) -> Vec<i64> {
        (0..count).map(|k| first + 10 * k).collect()
    }

    #[test]
    fn a_clock_that_is_set_back_starts_anew() {
        assert_eq!(restarts(&[times(500, 0), times(300, 0)].concat()), [500]);
        assert_eq!(restarts(&[times(500, 0), times(300, 4900)].concat()), [500]);
    }

    #[test]
    fn messages_out_of_order_do_not_start_it_anew() {
        // Later part first, late messages, two publishers, and any order.
        assert!(restarts(&[times(300, 5000), times(500, 0)].concat()).is_empty());
        let mut late = times(500, 0);
        late[300..303].iter_mut().for_each(|time| *time -= 900);
        assert!(restarts(&late).is_empty());
        let two: Vec<i64> = times(500, 0).into_iter().flat_map(|time| [time, time - 200]).collect();
        assert!(restarts(&two).is_empty());
        let wild: Vec<i64> = (0..1000).map(|k| k * 7919 % 1000).collect();
        assert!(restarts(&wild).is_empty());
        assert!(restarts(&[]).is_empty());
    }
}
