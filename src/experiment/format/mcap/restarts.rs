//! Where the clock of a topic starts anew: a simulation that is reset, or a computer whose clock is set
//! back.

use std::ops::Range;

use crate::numerics::median;

/// Usual intervals that a time must lie behind the latest one before it, as in tables.
pub(super) const BACK: f64 = 5.0;

/// Messages behind it that must not come up to that one again, else it is late by itself.
const LOOK_AHEAD: usize = 5;

/// Messages to one restart, at least (chosen): where there are more, the messages are in no order.
const SELDOM: usize = 100;

/// Where the runs begin between which the clock starts anew, of `times` in the order of the file, in
/// nanoseconds; the first is 0.
///
/// Runs that do not overlap are parts of one record in another order.
pub(super) fn run_starts(times: &[i64]) -> Vec<usize> {
    let Some(usual) = interval(times) else { return vec![0] };
    let mut starts = vec![0];
    let mut latest = i64::MIN;
    for (index, &time) in times.iter().enumerate() {
        let is_behind = index > 0 && latest.saturating_sub(time) as f64 > BACK * usual;
        let later = times.iter().skip(index + 1).take(LOOK_AHEAD);
        if is_behind && later.clone().all(|later| *later < latest) {
            starts.push(index);
            latest = time;
        }
        latest = latest.max(time);
    }
    let are_shuffled = starts.len() * SELDOM > times.len() + SELDOM;
    if are_shuffled || !overlap(times, &starts) { vec![0] } else { starts }
}

/// The usual interval between `times` that follow one another.
pub(super) fn interval(times: &[i64]) -> Option<f64> {
    let steps = times.windows(2).map(|pair| pair[1].saturating_sub(pair[0]) as f64);
    median(&steps.filter(|step| *step > 0.0).collect::<Vec<_>>())
}

/// Whether two of the runs cover the same times.
fn overlap(times: &[i64], starts: &[usize]) -> bool {
    let ends = |run: Range<usize>| {
        let run = times.get(run).unwrap_or_default();
        run.iter().min().zip(run.iter().max())
    };
    let mut covered: Vec<_> = runs(starts, times.len()).into_iter().filter_map(ends).collect();
    covered.sort_unstable();
    covered.windows(2).any(|pair| pair[1].0 < pair[0].1)
}

/// From each start to the next.
pub(super) fn runs(starts: &[usize], length: usize) -> Vec<Range<usize>> {
    let ends = starts.iter().skip(1).copied().chain([length]);
    starts.iter().zip(ends).map(|(start, end)| *start..end).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(count: i64, first: i64) -> Vec<i64> {
        (0..count).map(|k| first + 10 * k).collect()
    }

    #[test]
    fn a_clock_that_is_set_back_starts_anew() {
        assert_eq!(run_starts(&[times(500, 0), times(300, 0)].concat()), [0, 500]);
        assert_eq!(run_starts(&[times(500, 0), times(300, 4900)].concat()), [0, 500]);
    }

    #[test]
    fn messages_out_of_order_do_not_start_it_anew() {
        // Later part first, late messages, two publishers, and any order.
        assert_eq!(run_starts(&[times(300, 5000), times(500, 0)].concat()), [0]);
        let mut late = times(500, 0);
        late[300..303].iter_mut().for_each(|time| *time -= 900);
        assert_eq!(run_starts(&late), [0]);
        let two: Vec<i64> = times(500, 0).into_iter().flat_map(|time| [time, time - 200]).collect();
        assert_eq!(run_starts(&two), [0]);
        let wild: Vec<i64> = (0..1000).map(|k| k * 7919 % 1000).collect();
        assert_eq!(run_starts(&wild), [0]);
        assert_eq!(run_starts(&[]), [0]);
    }
}
