//! A clock whose unit changes within the log, as from seconds to milliseconds.

/// How many times as large numbers are in another unit of time.
const FACTORS: [f64; 6] = [1e3, 1e6, 1e9, 1e-3, 1e-6, 1e-9];

/// The index of the first time that is in another unit than those before it: the time and the steps
/// between times are multiplied by the same power of a thousand there. A pause multiplies neither, and
/// a clock that is set, or a slower sampling, multiplies one of them.
pub(super) fn unit_change(times: &[f64]) -> Option<usize> {
    let changes = |window: &[f64]| {
        let &[a, b, c, d, e, f] = window else { return false };
        let [before, again, after, next] = [b - a, c - b, e - d, f - e];
        let is_like = |one: f64, other: f64| (0.5..2.0).contains(&(one / other));
        let is_by = |factor: &f64| {
            // As late as within ten steps: rows may be lost where a logger is restarted.
            let late = d / factor - c;
            (0.0..=10.0 * again).contains(&late) && is_like(after, factor * again)
        };
        before > 0.0
            && is_like(again, before)
            && is_like(next, after)
            // The steps before and after tell most pairs apart at once.
            && !(0.01..100.0).contains(&(after / again))
            && FACTORS.iter().any(is_by)
    };
    Some(times.windows(6).position(changes)? + 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times that are `factor` times as large from the index `change` on.
    fn times(origin: f64, period: f64, change: usize, factor: f64) -> Vec<f64> {
        let time = |k: u32| origin + f64::from(k) * period;
        let scaled = |k: u32| if k as usize >= change { factor * time(k) } else { time(k) };
        (0..60).map(scaled).collect()
    }

    #[test]
    fn a_unit_that_changes_is_found_where_it_does() {
        for origin in [0.0, 7.3, 1_761_350_390.0] {
            for factor in [1e3, 1e6, 1e-3] {
                assert_eq!(unit_change(&times(origin, 0.01, 31, factor)), Some(31), "{origin}");
            }
        }
    }

    #[test]
    fn pauses_slower_sampling_and_a_clock_that_is_set_change_no_unit() {
        let mut paused = times(0.0, 0.01, 60, 1.0);
        paused[30..].iter_mut().for_each(|time| *time += 5000.0);
        let slower: Vec<f64> = (0..60)
            .map(|k| 0.01 * f64::from(k.min(30)) + 10.0 * f64::from(k.max(30) - 30))
            .collect();
        let mut set = times(3.0, 0.01, 60, 1.0);
        set[30..].iter_mut().for_each(|time| *time += 1_761_350_390.0);
        for times in [paused, slower, set] {
            assert_eq!(unit_change(&times), None);
        }
    }
}
