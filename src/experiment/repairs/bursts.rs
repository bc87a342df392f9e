//! Rows that come in bursts, as packets over a network bring them: their stamps say when a packet came,
//! and not when each row was measured.

use crate::experiment::log::Log;
use crate::numerics::median;

/// Usual steps beyond which one is a pause.
const JUMP: f64 = 1.5;

/// Pauses, at least: one or two part a record.
const FEWEST: usize = 5;

/// Rows between two pauses, at most, where they are not at once; and usual steps that a usual pause
/// lasts, at least (chosen).
const LONGEST: usize = 25;
const PAUSE: f64 = 2.5;

/// Part of the time that passes in pauses, at least; and for packets of more rows, which lie within so
/// many seconds.
const IN_PAUSES: f64 = 0.5;
const NEARLY_ALL: f64 = 0.9;
const AT_ONCE_S: f64 = 0.1;

/// Rows to one that goes back in time, at least: rows in no order come in no bursts.
const SELDOM: usize = 100;

/// Usual pauses beyond which one parts the record, and no packet came.
const BREAK: f64 = 5.0;

/// Spreads the rows of each trial that come in bursts.
pub(super) fn spread_out(log: &mut Log<'_>) {
    let spans = log.spans();
    let mut any = false;
    for rows in spans {
        let Some(times) = log.times.get_mut(rows).filter(|times| !is_even(times)) else { continue };
        if let Some(even) = spread(times) {
            times.copy_from_slice(&even);
            any = true;
        }
    }
    log.notes.extend(any.then(|| {
        "rows come in bursts, as in packets over a network: the rows of each are spread evenly \
         over the time since the burst before"
            .to_owned()
    }));
}

/// Whether no step is a pause, as of most clocks.
fn is_even(times: &[f64]) -> bool {
    let steps = times.windows(2).map(|pair| pair[1] - pair[0]);
    let (low, high) = steps.fold((f64::MAX, 0.0_f64), |(l, h), s| (l.min(s), h.max(s)));
    high <= JUMP * low
}

/// `times` whose rows are spread evenly over the time since the packet before theirs; none where rows do
/// not come in bursts.
fn spread(times: &[f64]) -> Option<Vec<f64>> {
    let forward = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
    let forward: Vec<f64> = forward.collect();
    let back = times.windows(2).filter(|pair| pair[1] < pair[0]).count();
    if SELDOM * back > times.len() {
        return None;
    }
    let middle = median(&forward)?;
    let is_pause = |step: f64| step > JUMP * middle;
    let pauses: Vec<f64> = forward.iter().copied().filter(|step| is_pause(*step)).collect();
    let usual = median(&pauses).filter(|usual| *usual >= PAUSE * middle)?;
    if pauses.len() < FEWEST {
        return None;
    }
    let known = || forward.iter().copied().filter(|step| *step <= BREAK * usual);
    let (all, in_pauses) =
        (known().sum::<f64>(), known().filter(|step| is_pause(*step)).sum::<f64>());
    let longest = forward.split(|step| is_pause(*step)).map(<[f64]>::len).max().unwrap_or_default();
    let are_packets = in_pauses > NEARLY_ALL * all && longest as f64 * middle < AT_ONCE_S;
    if in_pauses <= IN_PAUSES * all || !(longest <= LONGEST || are_packets) {
        return None;
    }
    let period = all / known().count() as f64;
    let mut even = Vec::with_capacity(times.len());
    let mut before: Option<f64> = None;
    for packet in times.chunk_by(|a, b| (0.0..=JUMP * middle).contains(&(b - a))) {
        let (came, rows) = (packet[packet.len() - 1], packet.len() as f64);
        // After a break, and where the clock starts anew, it is known to a period how far rows are apart.
        let since = before.map(|before| came - before);
        let since = since.filter(|since| (0.0..=BREAK * usual).contains(since));
        let apart = since.map_or(period, |since| since / rows);
        even.extend((0..packet.len()).rev().map(|behind| came - apart * behind as f64));
        before = Some(came);
    }
    Some(even)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(k: usize) -> f64 {
        ((k as f64 * 12.9898).sin() * 43_758.545_3).fract()
    }

    #[test]
    fn rows_of_a_packet_are_spread_over_the_time_since_the_one_before() {
        for (size, apart) in [(2, 1e-6), (2, 2e-4), (5, 1e-5), (10, 1e-4), (50, 1e-6), (50, 1e-4)] {
            let came = |k: usize| 0.01 * (k - k % size + size - 1) as f64;
            let time = |k: usize| came(k) - apart * (size - 1 - k % size) as f64;
            let times: Vec<f64> = (0..3000).map(time).collect();
            let even = spread(&times).unwrap();
            let off = |k: &usize| (even[*k] - 0.01 * *k as f64).abs() > 0.002;
            assert_eq!((size..3000).filter(off).count(), 0, "{size} {apart}");
        }
    }

    #[test]
    fn rows_that_come_late_keep_their_mean() {
        let mut latest = 0.0;
        let late = |k: usize| {
            latest = f64::max(latest + 1e-5, 0.01 * k as f64 + 0.025 * (1.0 + noise(k)));
            latest
        };
        let times: Vec<f64> = (0..3000).map(late).collect();
        let even = spread(&times).unwrap();
        assert!(even.is_sorted());
        let steps = even.windows(2).map(|pair| pair[1] - pair[0]);
        assert!(median(&steps.collect::<Vec<_>>()).unwrap() > 0.005);
    }

    #[test]
    fn clocks_that_jitter_and_records_in_parts_are_no_bursts() {
        let jitters: Vec<f64> = (0..2000).map(|k| 0.01 * (k as f64 + 0.4 * noise(k))).collect();
        assert_eq!(spread(&jitters), None);
        let parts = (0..3000).map(|k| 0.01 * f64::from(k) + 5.0 * f64::from(k / 300));
        assert_eq!(spread(&parts.collect::<Vec<_>>()), None, "three seconds at a time");
        let pause = [0.0, 0.01, 0.02, 1000.0, 1000.01, 1000.02, 2000.0, 2000.01];
        assert_eq!(spread(&pause), None, "two pauses");
        let rounded = (0..3000).map(|k| (0.02 * f64::from(k) * 10.0).floor() / 10.0);
        assert_eq!(spread(&rounded.collect::<Vec<_>>()), None, "of one stamp");
    }
}
