//! How far apart two models are in an experiment.

use super::space::ExperimentSpace;
use crate::explain::separation::{Proposal, Start};
use crate::model::{JointModel, Simulated, Surroundings, simulate_input};

/// How far apart two models are in an experiment.
pub(super) struct Contrast {
    /// The largest difference of their outputs, in times the noise.
    pub(super) times_noise: f64,
    /// Seconds from the start of a run to that.
    pub(super) after_s: f64,
    /// Twice the expected difference in log-likelihood.
    pub(super) evidence: f64,
}

impl ExperimentSpace {
    /// Both models in `proposal`; `None` where the joint would leave the range it has been in.
    pub(super) fn contrast(
        &self,
        proposal: &Proposal,
        models: [&JointModel; 2],
        noise: f64,
    ) -> Option<Contrast> {
        /// Beyond the range of the record, in parts of it.
        const MARGIN: f64 = 0.1;
        let hold = samples(proposal.hold_s, self.period_s);
        let input: Vec<f64> = proposal
            .sequence()
            .into_iter()
            .flat_map(|level| std::iter::repeat_n(level, hold))
            .collect();
        let margin = MARGIN * (self.range.1 - self.range.0);
        let inside = self.range.0 - margin..=self.range.1 + margin;
        let mut found = Contrast { times_noise: 0.0, after_s: 0.0, evidence: 0.0 };
        let (mut differences, mut motions) = (Vec::new(), Vec::new());
        for start in &proposal.starts {
            let [one, other] = models.map(|model| self.simulated(model, &input, start));
            let (one, other) = (one.output, other.output);
            if one.iter().chain(&other).any(|angle| !inside.contains(angle)) {
                return None;
            }
            let difference: Vec<f64> = one.iter().zip(&other).map(|(a, b)| a - b).collect();
            for (sample, difference) in difference.iter().enumerate() {
                if difference.abs() > found.times_noise * noise {
                    found.times_noise = difference.abs() / noise;
                    found.after_s = sample as f64 * self.period_s;
                }
            }
            differences.extend(centred(&difference, hold));
            motions.extend(centred(&one, hold));
        }
        found.evidence = residual_squares(&differences, &motions) / (noise * noise);
        Some(found)
    }

    /// What `model` does with `input` from `start`.
    fn simulated(&self, model: &JointModel, input: &[f64], start: &Start) -> Simulated {
        let others = vec![start.others; input.len()];
        let surroundings = Surroundings {
            others: &others,
            radians_per_output_unit: self.radians_per_output_unit,
            start_s: start.worked_s,
            ..Surroundings::default()
        };
        simulate_input(model, input, self.period_s, start.angle, &surroundings)
    }
}

/// The sum of squares of the residual of `values` after regression on `shape`.
fn residual_squares(values: &[f64], shape: &[f64]) -> f64 {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let own = product(shape, shape).max(f64::MIN_POSITIVE);
    let with = product(values, shape);
    (product(values, values) - with * with / own).max(0.0)
}

/// `values` in parts of `length`, each without its mean: where a fit starts anew its offset
/// is free.
fn centred(values: &[f64], length: usize) -> Vec<f64> {
    let part = |part: &[f64]| {
        let mean = part.iter().sum::<f64>() / part.len() as f64;
        part.iter().map(|value| value - mean).collect::<Vec<_>>()
    };
    values.chunks(length.max(1)).flat_map(part).collect()
}

fn samples(seconds: f64, period_s: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1")]
    let samples = (seconds / period_s).round().max(1.0) as usize;
    samples
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{DeadBand, FlowCurve};
    use crate::explain::separation::Pattern;
    use crate::model::Component;

    fn proposal(pattern: Pattern, levels: &[f64], angle: f64) -> Proposal {
        let starts = vec![Start { angle, others: 0.0, worked_s: 0.0 }];
        Proposal { pattern, levels: levels.to_vec(), hold_s: 1.0, starts }
    }

    fn space() -> ExperimentSpace {
        ExperimentSpace {
            period_s: 0.01,
            hold_s: 1.0,
            levels: (1.0, 2.0),
            range: (-30.0, 30.0),
            duration_s: 60.0,
            sensor_noise: None,
            radians_per_output_unit: 1_f64.to_radians(),
        }
    }

    fn model(effect: &'static dyn crate::effect::Effect, values: &[f64]) -> JointModel {
        let values = values.iter().map(|value| (*value).into()).collect();
        JointModel::integrator(10.0, 0.0).with(Component::new(effect, values).unwrap())
    }

    #[test]
    fn the_difference_is_that_of_the_outputs() {
        // At 0.4 V the one rests and the other moves at 4 deg/s.
        let (band, plain) = (model(&DeadBand, &[-0.5, 0.5]), model(&FlowCurve, &[1.0]));
        let tried = proposal(Pattern::Reversals, &[0.4], 0.0);
        let found = space().contrast(&tried, [&band, &plain], 0.1).unwrap();
        assert!((found.times_noise - 40.0).abs() < 1e-6 && (found.after_s - 2.0).abs() < 1e-9);
        // The outputs are 4 deg/s apart for two holds of 100 samples: 2 · 100 · 4² / 12.
        let expected = 2.0 * 100.0 * 16.0 / 12.0 / 0.01;
        assert!((found.evidence / expected - 1.0).abs() < 0.01, "{}", found.evidence);
    }

    #[test]
    fn another_gain_is_no_difference() {
        let slow = JointModel::integrator(10.0, 0.1);
        let fast = JointModel::integrator(11.0, 0.1);
        let tried = proposal(Pattern::Ladder, &[0.5, 1.0], 0.0);
        let found = space().contrast(&tried, [&slow, &fast], 0.1).unwrap();
        assert!(found.times_noise > 10.0 && found.evidence < 1e-6);
    }

    #[test]
    fn no_experiment_leaves_the_range_of_the_record() {
        let same = JointModel::integrator(10.0, 0.1);
        let run = |angle| {
            let tried = proposal(Pattern::Ladder, &[1.0, 2.0], angle);
            space().contrast(&tried, [&same, &same], 0.1).is_some()
        };
        // It goes 40 deg up.
        assert!(run(-5.0) && !run(0.0));
    }
}
