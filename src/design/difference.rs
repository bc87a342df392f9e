//! Where two outputs are apart, as a fit sees it.

use super::schedule::{Hold, Schedule};

/// How far two outputs are apart along an input.
#[derive(Clone, Debug, PartialEq)]
pub struct Apart {
    /// The difference at each sample in deviations of the noise, every window of a fit without
    /// its mean.
    pub over_noise: Vec<f64>,
    /// The difference during each hold.
    pub holds: Vec<HoldApart>,
}

/// How far two outputs are apart during one hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoldApart {
    /// Its first sample, from 0.
    pub start: usize,
    /// The hold.
    pub hold: Hold,
    /// The largest magnitude of the difference, in deviations of the noise.
    pub largest: f64,
    /// The part of all squared differences that lies here, 0 to 1.
    pub share: f64,
}

/// Compares the outputs `one` and `other` of `schedule`, with noise of the deviation `noise`.
///
/// A fit starts anew at each step of the input, so that what two models gained on each other
/// before does not count. The sum of the squares is the noncentrality of a rival that keeps its
/// numbers; a fit of it takes part of that away (see [`Expected`](super::Expected)).
pub fn apart(schedule: &Schedule, one: &[f64], other: &[f64], noise: f64) -> Apart {
    let difference: Vec<f64> = one.iter().zip(other).map(|(one, other)| one - other).collect();
    let centred = centred(&difference, &schedule.windows(schedule.holds().len()));
    let over_noise: Vec<f64> = centred.iter().map(|by| by / noise).collect();
    let square = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>();
    let whole = square(&over_noise).max(f64::MIN_POSITIVE);
    let mut start = 0;
    let of = |hold: &Hold| {
        let own = over_noise.get(start..start + hold.samples).unwrap_or_default();
        let largest = own.iter().fold(0.0, |most: f64, by| most.max(by.abs()));
        let found = HoldApart { start, hold: *hold, largest, share: square(own) / whole };
        start += hold.samples;
        found
    };
    let holds = schedule.holds().iter().map(of).collect();
    Apart { over_noise, holds }
}

/// `values` in windows, each without its mean: a fit starts anew there.
pub(super) fn centred(values: &[f64], windows: &[(usize, usize)]) -> Vec<f64> {
    let window = |(start, end): &(usize, usize)| {
        let part = &values[*start..*end];
        let mean = part.iter().sum::<f64>() / part.len().max(1) as f64;
        part.iter().map(|value| value - mean).collect::<Vec<_>>()
    };
    windows.iter().flat_map(window).collect()
}

#[cfg(test)]
mod tests {
    use super::super::predict::tests::rig;
    use super::*;

    #[test]
    fn what_was_gained_before_a_step_does_not_count_after_it() {
        let hold = |level, samples| Hold { level, samples };
        let schedule = Schedule::new(rig(None).period, vec![hold(1.0, 3), hold(0.0, 2)]);
        let one = [0.0, 1.0, 2.0, 2.0, 2.0];
        let found = apart(&schedule, &one, &[0.0; 5], 0.5);
        assert_eq!(found.over_noise, [-2.0, 0.0, 2.0, 0.0, 0.0]);
        let shares: Vec<_> = found.holds.iter().map(|hold| (hold.start, hold.share)).collect();
        assert_eq!(shares, [(0, 1.0), (3, 0.0)]);
        assert!((found.holds[0].largest - 2.0).abs() < 1e-12);
    }
}
