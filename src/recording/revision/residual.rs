//! The residual of a revision, against what the next effect depends on most.
//!
//! For effects that change no steady speed, such as a lag: the mean residual in bins of the
//! variable that the effect's own share of it follows most, and that share.

use super::figure::{Figure, Held, Law};
use crate::diagnosis::Comparison;
use crate::experiment::Joint;
use crate::explain::Candidate;
use crate::fit::Evaluation;
use crate::recording::canvas::Span;
use crate::recording::scatter::since_step;
use crate::wording::bracketed;

/// Bins with as many samples each.
const BINS: usize = 40;

/// A sample: the variable, the residual, and the part of it that the effect explains.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    x: f64,
    residual: f64,
    explained: f64,
}

/// The residual of revision `number` of `joint`, and the part of it that `candidate` explains, whose
/// series are `next`.
pub(super) fn figure(
    joint: &Joint,
    comparison: &Comparison,
    number: u32,
    (candidate, next): (&Candidate, &Evaluation),
) -> Figure {
    let of_each = variables(joint, &comparison.fit.evaluation, next);
    let binned = of_each.map(|(name, samples)| (name, bins(samples)));
    let clearest = binned.into_iter().max_by(|a, b| followed(&a.1).total_cmp(&followed(&b.1)));
    let (name, bins) = clearest.unwrap_or_default();
    let noise = comparison.sensor_noise.unwrap_or(0.0);
    let point = |(mean, count): &(Sample, f64)| Held {
        level: mean.x,
        speed: mean.residual,
        std_error: noise / count.sqrt(),
        fell: false,
        simulated: None,
    };
    let explained: Law = bins.iter().map(|(mean, _)| (mean.x, mean.explained)).collect();
    let heights = bins.iter().flat_map(|(mean, _)| [mean.residual, mean.explained, 0.0]);
    Figure {
        names: [name.to_owned(), bracketed("residual", joint.output_unit.as_deref())],
        x: Span::around(bins.iter().map(|(mean, _)| mean.x), 0.03),
        y: Span::around(heights, 0.3),
        points: bins.iter().map(point).collect(),
        laws: [
            Some((format!("residual of revision {number}: points"), Law::new())),
            None,
            Some((format!("explained by {}", candidate.name()), explained)),
        ],
    }
}

/// What an effect may depend on, sample by sample.
fn variables(
    joint: &Joint,
    own: &Evaluation,
    next: &Evaluation,
) -> [(&'static str, Vec<Sample>); 4] {
    let names = ["input", "output", "time [s]", "time since the step [s]"];
    let mut all = names.map(|name| (name, Vec::new()));
    let trials = joint.trials.iter().zip(&own.simulated);
    let residuals = own.residuals.iter().zip(&next.residuals);
    for ((trial, simulated), (residual, after)) in trials.zip(residuals) {
        let period = trial.period().seconds();
        let directions = directions(&simulated.acting);
        let since = since_step(&simulated.acting, period);
        let start = trial.time_s(1);
        let times: Vec<f64> = (0..residual.len()).map(|k| start + k as f64 * period).collect();
        // A step down turns what follows it over.
        let plain = vec![1.0; residual.len()];
        let columns: [(&[f64], &[f64]); 4] = [
            (&simulated.acting, &plain),
            (trial.output(), &plain),
            (&times, &plain),
            (&since, &directions),
        ];
        for ((_, samples), (x, signs)) in all.iter_mut().zip(columns) {
            let rows = x.iter().zip(signs).zip(residual.iter().zip(after));
            let known = rows.filter(|((_, sign), _)| **sign != 0.0);
            samples.extend(known.map(|((x, sign), (residual, after))| Sample {
                x: *x,
                residual: sign * residual,
                explained: sign * (residual - after),
            }));
        }
    }
    all
}

/// The sign of the last change of `acting`; 0 before the first.
fn directions(acting: &[f64]) -> Vec<f64> {
    let mut before = acting.first().copied().unwrap_or_default();
    let mut sign = 0.0;
    let direction = |level: &f64| {
        let change = level - before;
        if change != 0.0 {
            sign = change.signum();
        }
        before = *level;
        sign
    };
    acting.iter().map(direction).collect()
}

/// The means of bins of samples, ascending, and how many are in each.
fn bins(mut samples: Vec<Sample>) -> Vec<(Sample, f64)> {
    samples.sort_by(|a, b| a.x.total_cmp(&b.x));
    let size = samples.len().div_ceil(BINS).max(1);
    let mean = |bin: &[Sample]| {
        let n = bin.len() as f64;
        let of = |value: fn(&Sample) -> f64| bin.iter().map(value).sum::<f64>() / n;
        let (x, residual, explained) = (of(|s| s.x), of(|s| s.residual), of(|s| s.explained));
        (Sample { x, residual, explained }, n)
    };
    samples.chunks(size).map(mean).collect()
}

/// The mean square of the means of bins of what the effect explains.
fn followed(bins: &[(Sample, f64)]) -> f64 {
    let all: f64 = bins.iter().map(|(_, count)| count).sum();
    let squares: f64 =
        bins.iter().map(|(mean, count)| count * mean.explained * mean.explained).sum();
    squares / all.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_direction_is_that_of_the_last_step() {
        let found = directions(&[1.0, 1.0, 2.0, 2.0, -1.0]);
        assert_eq!(found, [0.0, 0.0, 1.0, 1.0, -1.0]);
    }

    #[test]
    fn bins_hold_means_in_order_of_the_variable() {
        let sample =
            |k: u32| Sample { x: 79.0 - f64::from(k), residual: f64::from(k), explained: 1.0 };
        let found = bins((0..80).map(sample).collect());
        assert_eq!(found.len(), BINS);
        assert_eq!(found[0], (Sample { x: 0.5, residual: 78.5, explained: 1.0 }, 2.0));
        assert!((followed(&found) - 1.0).abs() < 1e-12);
    }
}
