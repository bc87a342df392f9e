//! How coarse a sensor is beside the motion that it measures.

use super::trial::Trial;
use crate::numerics::median;

/// The count of a sensor, and how long the joint takes for one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Resolution {
    /// One count, output units.
    pub(crate) count: f64,
    /// The usual time from one count to the next in the same direction, seconds.
    pub(crate) between_s: f64,
}

/// The resolution of a sensor whose joint moves by one count at a time, with several samples between; none
/// of a finer one.
pub(crate) fn coarse_resolution(trials: &[Trial]) -> Option<Resolution> {
    /// Samples between counts from which on these are what is seen of the motion, and not the samples.
    const COARSE: f64 = 5.0;
    /// Fewest changes of the output, and the part of them that are one count.
    const FEWEST: usize = 20;
    const PART: f64 = 0.8;
    /// What counts may differ by as they are written, of one.
    const ROUNDED: f64 = 0.01;
    let mut changes: Vec<f64> = Vec::new();
    let mut between: Vec<f64> = Vec::new();
    for trial in trials {
        let mut last: Option<(usize, f64)> = None;
        for (sample, pair) in trial.output().windows(2).enumerate() {
            let change = pair[1] - pair[0];
            if change.abs() <= 0.0 {
                continue;
            }
            changes.push(change.abs());
            let same = last.filter(|(_, before)| before * change > 0.0);
            between.extend(
                same.map(|(before, _)| (sample - before) as f64 * trial.period().seconds()),
            );
            last = Some((sample, change));
        }
    }
    let count = median(&changes).filter(|_| changes.len() >= FEWEST)?;
    let is_one = |change: &&f64| (**change - count).abs() <= ROUNDED * count;
    if (changes.iter().filter(is_one).count() as f64) < PART * changes.len() as f64 {
        return None;
    }
    let between_s = median(&between)?;
    let longest_s = trials.iter().map(|trial| trial.period().seconds()).fold(0.0, f64::max);
    (between_s >= COARSE * longest_s).then_some(Resolution { count, between_s })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;
    use crate::units::SamplePeriod;

    fn found(output: impl Fn(f64, f64) -> f64) -> Option<Resolution> {
        let noise = noise(3, 0.0, 4000);
        let output: Vec<f64> = (0..4000).map(|k| output(0.01 * k as f64, noise[k])).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        coarse_resolution(&[Trial::new("1", 0.0, period, output.clone(), output).unwrap()])
    }

    /// 5 units a second, to and fro.
    fn motion(time_s: f64) -> f64 {
        (time_s.rem_euclid(8.0) - 4.0).abs() * 5.0
    }

    #[test]
    fn counts_with_several_samples_between_are_coarse() {
        let coarse = found(|time, _| (2.0 * motion(time)).round() / 2.0).unwrap();
        assert!((coarse.count - 0.5).abs() < 1e-9, "{coarse:?}");
        assert!((coarse.between_s - 0.1).abs() < 0.011, "{coarse:?}");
        assert_eq!(found(|time, _| (20.0 * motion(time)).round() / 20.0), None, "a count a sample");
        assert_eq!(found(|time, noise| motion(time) + 0.01 * noise), None);
        let noisy = |time, noise: f64| (10.0 * (motion(time) + 0.3 * noise)).round() / 10.0;
        assert_eq!(found(noisy), None, "noise of several counts");
    }
}
