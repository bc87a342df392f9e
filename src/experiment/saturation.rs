//! Sensors and converters whose range ends before the motion does.

use super::trial::Trial;
use crate::numerics::{least_change, noise_of_bends};

/// Samples in a row at the end of a range that are no chance.
const IN_A_ROW: usize = 5;

/// An output that stands at the end of its sensor's range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Saturation {
    /// Where the range ends, output units.
    pub(crate) at: f64,
    /// The part of the samples that are there.
    pub(crate) share: f64,
}

/// The ends of its range at which the output of `trials` stands exactly, while it has noise elsewhere: a
/// joint that rests at a stop has it there, too, or nowhere.
pub(crate) fn saturations(trials: &[Trial]) -> Vec<Saturation> {
    /// Stretches, or samples of a long one, and the part of all samples in them, at least.
    const FEWEST: usize = 3;
    const LONG: usize = 50;
    const SHARE: f64 = 0.01;
    /// The part of all other samples that are as the one before, at most, and counts of the sensor that
    /// its noise has at least: with less a joint that rests shows none.
    const STILL: f64 = 0.05;
    const COUNTS: f64 = 1.0;
    let outputs = || trials.iter().flat_map(Trial::output).copied();
    let (low, high) = outputs().fold((f64::MAX, f64::MIN), |(l, h), y| (l.min(y), h.max(y)));
    let is_at = |end: f64, value: f64| (value - end).abs() <= 0.0;
    let samples = outputs().count() as f64;
    let at = |end: f64| {
        let runs = trials.iter().flat_map(|trial| {
            trial.output().chunk_by(move |a, b| is_at(end, *a) && is_at(end, *b))
        });
        let runs = runs.map(<[f64]>::len).filter(|length| *length >= IN_A_ROW);
        let runs: Vec<usize> = runs.collect();
        let share = runs.iter().sum::<usize>() as f64 / samples;
        let is_long = runs.len() >= FEWEST || runs.iter().any(|length| *length >= LONG);
        (is_long && share >= SHARE).then_some(Saturation { at: end, share })
    };
    let found: Vec<Saturation> = [low, high].into_iter().filter_map(at).collect();
    if found.is_empty() {
        return found;
    }
    let pairs = || trials.iter().flat_map(|trial| trial.output().windows(2));
    let others = || pairs().filter(|pair| !(is_at(low, pair[1]) || is_at(high, pair[1])));
    let still = others().filter(|pair| is_at(pair[0], pair[1])).count() as f64;
    let count = least_change(others()).unwrap_or(f64::MAX);
    // In second differences, a joint that moves evenly has no part.
    let triples = trials.iter().flat_map(|trial| trial.output().windows(3));
    let noise =
        noise_of_bends(triples.filter(|t| !t.iter().any(|y| is_at(low, *y) || is_at(high, *y))));
    let has_noise =
        high > low && still <= STILL * others().count() as f64 && noise >= COUNTS * count;
    if has_noise { found } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;
    use crate::units::SamplePeriod;

    fn found(output: impl Fn(usize, f64) -> f64) -> Vec<Saturation> {
        let noise = noise(3, 0.0, 4000);
        let output: Vec<f64> = (0..4000).map(|k| output(k, 0.01 * noise[k])).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        saturations(&[Trial::new("1", 0.0, period, output.clone(), output).unwrap()])
    }

    #[test]
    fn an_output_that_is_cut_off_stands_at_the_end_of_its_range() {
        let motion = |k: usize| (k as f64 / 100.0).sin();
        let cut = found(|k, noise| (motion(k) + noise).clamp(-0.6, 0.8));
        let at: Vec<f64> = cut.iter().map(|end| end.at).collect();
        assert_eq!(at, [-0.6, 0.8]);
        assert!((0.1..0.3).contains(&cut[1].share), "{cut:?}");
        assert_eq!(found(|k, noise| motion(k) + noise), []);
        assert_eq!(found(|k, noise| motion(k).clamp(-0.6, 0.8) + noise), [], "a stop");
        assert_eq!(found(|k, _| (20.0 * motion(k)).round()), [], "a coarse encoder");
        // Off where it began, which a sensor of counts beyond its noise shows as one value.
        let cycle = |k: usize| (k % 400).min(400 - k % 400).saturating_sub(60) as f64;
        assert_eq!(found(|k, noise| (cycle(k) + noise).round()), [], "counts beyond the noise");
        let once = found(|k, noise| (motion(k.min(500)) + noise).min(0.8));
        assert_eq!(once.len(), 1, "one long stretch");
    }
}
