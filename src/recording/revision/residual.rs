//! What a revision leaves, against what the next effect depends on most.
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

/// Bins with as many samples each.
const BINS: usize = 40;

/// A sample: the variable, what is left, and what the effect takes of it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    x: f64,
    left: f64,
    taken: f64,
}

/// What revision `number` leaves of `joint`, and what `candidate` takes of that.
pub(super) fn figure(
    joint: &Joint,
    comparison: &Comparison,
    number: u32,
    candidate: &Candidate,
) -> Figure {
    let of_each = variables(joint, &comparison.fit.evaluation, &candidate.fit.evaluation);
    let binned = of_each.map(|(name, samples)| (name, bins(samples)));
    let clearest = binned.into_iter().max_by(|a, b| followed(&a.1).total_cmp(&followed(&b.1)));
    let (name, bins) = clearest.unwrap_or_default();
    let noise = comparison.noise_floor.unwrap_or(0.0);
    let point = |(mean, count): &(Sample, f64)| Held {
        level: mean.x,
        speed: mean.left,
        std_error: noise / count.sqrt(),
    };
    let taken: Law = bins.iter().map(|(mean, _)| (mean.x, mean.taken)).collect();
    let unit = joint.output_unit.as_ref().map_or(String::new(), |unit| format!(" [{unit}]"));
    let heights = bins.iter().flat_map(|(mean, _)| [mean.left, mean.taken, 0.0]);
    Figure {
        title: format!("left{unit} against {name}"),
        x: Span::around(bins.iter().map(|(mean, _)| mean.x), 0.03),
        y: Span::around(heights, 0.3),
        points: bins.iter().map(point).collect(),
        laws: [Law::new(), Law::new(), taken],
        names: [
            Some(format!("revision {number} leaves the points")),
            None,
            Some(format!("{} takes", candidate.name())),
        ],
    }
}

/// What an effect may depend on, sample by sample.
fn variables(
    joint: &Joint,
    own: &Evaluation,
    next: &Evaluation,
) -> [(&'static str, Vec<Sample>); 4] {
    let names = ["the input", "the angle", "the time [s]", "the time since a step [s]"];
    let mut all = names.map(|name| (name, Vec::new()));
    let trials = joint.trials.iter().zip(&own.simulated);
    let residuals = own.residuals.iter().zip(&next.residuals);
    for ((trial, simulated), (left, after)) in trials.zip(residuals) {
        let period = trial.period().seconds();
        let directions = directions(&simulated.acting);
        let since = since_step(&simulated.acting, period);
        let start = trial.time_s(1);
        let times: Vec<f64> = (0..left.len()).map(|k| start + k as f64 * period).collect();
        // A step down turns what follows it over.
        let plain = vec![1.0; left.len()];
        let columns: [(&[f64], &[f64]); 4] = [
            (&simulated.acting, &plain),
            (trial.output(), &plain),
            (&times, &plain),
            (&since, &directions),
        ];
        for ((_, samples), (x, signs)) in all.iter_mut().zip(columns) {
            let rows = x.iter().zip(signs).zip(left.iter().zip(after));
            let known = rows.filter(|((_, sign), _)| **sign != 0.0);
            samples.extend(known.map(|((x, sign), (left, after))| Sample {
                x: *x,
                left: sign * left,
                taken: sign * (left - after),
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
        let (x, left, taken) = (of(|s| s.x), of(|s| s.left), of(|s| s.taken));
        (Sample { x, left, taken }, n)
    };
    samples.chunks(size).map(mean).collect()
}

/// The square of what the effect takes that the means of bins hold, per sample.
fn followed(bins: &[(Sample, f64)]) -> f64 {
    let all: f64 = bins.iter().map(|(_, count)| count).sum();
    let squares: f64 = bins.iter().map(|(mean, count)| count * mean.taken * mean.taken).sum();
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
        let sample = |k: u32| Sample { x: 79.0 - f64::from(k), left: f64::from(k), taken: 1.0 };
        let found = bins((0..80).map(sample).collect());
        assert_eq!(found.len(), BINS);
        assert_eq!(found[0], (Sample { x: 0.5, left: 78.5, taken: 1.0 }, 2.0));
        assert!((followed(&found) - 1.0).abs() < 1e-12);
    }
}
