//! What experiments there can be on a joint, and which of them tells two models apart.

use super::Separation;
use super::levels::{level_sets, thresholds, two_digits, two_digits_of};
use super::proposal::{Proposal, Start};
use crate::effect::RecordRange;
use crate::experiment::Trial;
use crate::explain::candidate::Candidate;
use crate::explain::race::ALIKE;
use crate::fit::FitRecord;
use crate::model::{JointModel, Restart, Simulated, Surroundings, arrivals, simulate};
use crate::units::SamplePeriod;

/// A difference of less than so many times the noise tells nothing apart.
const VISIBLE: f64 = 3.0;

/// Twice the difference in log-likelihood from which two models are told apart: well above
/// that below which they are alike, because a fit may take some of it away.
const CLEAR: f64 = 4.0 * ALIKE;

/// What experiments there can be on the joint of a record.
pub(super) struct Setting {
    period_s: f64,
    /// Seconds between steps of the input, on average.
    hold_s: f64,
    /// Least and largest magnitude of the input that is not zero.
    levels: (f64, f64),
    /// Lowest and highest output.
    range: (f64, f64),
    duration_s: f64,
    radians_per_output_unit: f64,
}

/// Two models in an experiment.
struct Trialled {
    times_noise: f64,
    after_s: f64,
    /// Twice the expected difference in log-likelihood.
    evidence: f64,
}

impl Setting {
    pub(super) fn of(record: &FitRecord<'_>) -> Self {
        let levels = record.input_levels();
        let RecordRange {
            output_min,
            output_max,
            duration_s,
            sample_period_s,
            radians_per_output_unit,
            ..
        } = record.range(&levels, 1.0);
        let least = levels.iter().copied().find(|level| *level > 0.0).unwrap_or(1.0);
        let largest = levels.last().copied().filter(|level| *level > 0.0).unwrap_or(1.0);
        let trials = record.joint().trials.iter();
        let holds: usize = trials.map(|trial| 1 + steps(trial.input())).sum();
        Self {
            period_s: sample_period_s,
            hold_s: duration_s / holds.max(1) as f64,
            levels: (least, largest),
            range: (output_min, output_max),
            duration_s,
            radians_per_output_unit,
        }
    }

    /// The best experiment: within the levels of the record, and beyond them only where
    /// none within tells the two apart.
    pub(super) fn apart(&self, one: &Candidate, other: &Candidate) -> Option<Separation> {
        let &[id] = other.effects.as_slice() else { return None };
        let noise = one.noise_floor.or(one.training.map(|error| error.rmse));
        let noise = noise.filter(|noise| *noise > 0.0)?;
        let (within, beyond) = self.proposals([one, other]);
        let separation = |proposal: Proposal| {
            let found = self.run(&proposal, [&one.fit.model, &other.fit.model], noise)?;
            let Trialled { times_noise, after_s, evidence } = found;
            let is_clear = times_noise >= VISIBLE && evidence >= CLEAR;
            let per_second = evidence / proposal.duration_s();
            let found = Separation { other: id, proposal, times_noise, after_s, is_clear };
            Some((found, per_second))
        };
        let best = |proposals: Vec<Proposal>| {
            let found = proposals.into_iter().filter_map(separation);
            let order = |a: &(Separation, f64), b: &(Separation, f64)| {
                a.0.is_clear.cmp(&b.0.is_clear).then(a.1.total_cmp(&b.1))
            };
            found.max_by(order).map(|(separation, _)| separation)
        };
        let inside = best(within);
        if inside.as_ref().is_some_and(|found| found.is_clear) {
            return inside;
        }
        best(beyond).filter(|found| found.is_clear).or(inside)
    }

    /// Experiments with levels of the record and below, and with larger ones.
    fn proposals(&self, pair: [&Candidate; 2]) -> (Vec<Proposal>, Vec<Proposal>) {
        /// What may be added to the largest level by rounding.
        const ROUNDED: f64 = 1.05;
        let suspects = pair.map(|c| (&c.fit.model, c.effects.as_slice()));
        let sets = level_sets(self.levels, &thresholds(suspects, self.levels.1));
        let starts = self.start_sets(pair);
        let holds = [0.25, 1.0, 4.0].map(|part| self.hold(part * self.hold_s));
        let mut all = Vec::new();
        for (levels, patterns) in &sets {
            for (pattern, hold_s) in patterns.iter().flat_map(|p| holds.map(|h| (*p, h))) {
                let with = |starts: &Vec<Start>| Proposal {
                    pattern,
                    levels: levels.clone(),
                    hold_s,
                    starts: starts.clone(),
                };
                all.extend(starts.iter().map(with));
            }
        }
        let most = ROUNDED * self.levels.1;
        all.into_iter().partition(|p| p.levels.iter().all(|level| *level <= most))
    }

    /// Levels that are worth a trial, and the patterns to try them in.
    fn start_sets(&self, pair: [&Candidate; 2]) -> Vec<Vec<Start>> {
        let (low, high) = self.range;
        let at = |part: f64| two_digits_of(low + part * (high - low), high - low);
        let middle = Start { angle: at(0.5), others: 0.0, worked_s: self.duration_s };
        let has = |id: &str| pair.iter().any(|candidate| candidate.effects.contains(&id));
        let mut sets = vec![vec![middle]];
        if pair.iter().any(|candidate| candidate.fit.model.depends_on_angle()) {
            sets.push([0.2, 0.5, 0.8].map(|part| Start { angle: at(part), ..middle }).to_vec());
        }
        if has("supply_droop") {
            sets.push(vec![middle, Start { others: 1.0, ..middle }]);
        }
        if has("thermal_drift") {
            sets.push(vec![Start { worked_s: 0.0, ..middle }, middle]);
        }
        sets
    }

    /// A hold in two digits, and no less than a few samples.
    fn hold(&self, seconds: f64) -> f64 {
        const FEWEST: f64 = 10.0;
        two_digits(seconds.max(FEWEST * self.period_s))
    }

    /// Both models in `proposal`; `None` where the joint would leave the range it has been in.
    fn run(&self, proposal: &Proposal, models: [&JointModel; 2], noise: f64) -> Option<Trialled> {
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
        let mut found = Trialled { times_noise: 0.0, after_s: 0.0, evidence: 0.0 };
        let (mut differences, mut motions) = (Vec::new(), Vec::new());
        for start in &proposal.starts {
            let [one, other] = models.map(|model| self.simulated(model, &input, start));
            let (one, other) = (one?.output, other?.output);
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
        found.evidence = beside(&differences, &motions) / (noise * noise);
        Some(found)
    }

    /// What `model` does with `input` from `start`.
    fn simulated(&self, model: &JointModel, input: &[f64], start: &Start) -> Option<Simulated> {
        let period = SamplePeriod::from_seconds(self.period_s)?;
        let nothing = vec![0.0; input.len()];
        let trial = Trial::new("", 0.0, period, input.to_vec(), nothing).ok()?;
        let others = vec![start.others; input.len()];
        let surroundings = Surroundings {
            others: &others,
            radians_per_output_unit: self.radians_per_output_unit,
            start_s: start.worked_s,
        };
        let arriving = arrivals(model, &trial, start.worked_s, None);
        let begin = [Restart { sample: 0, output: start.angle, speed: None }];
        Some(simulate(model, &arriving, input.len(), self.period_s, &begin, &surroundings))
    }
}

/// The sum of squares of `values` without what `shape` would explain.
fn beside(values: &[f64], shape: &[f64]) -> f64 {
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

/// Changes of the input.
fn steps(input: &[f64]) -> usize {
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let changes = |pair: &&[f64]| matches!(pair, [a, b] if a != b);
    input.windows(2).filter(changes).count()
}

fn samples(seconds: f64, period_s: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1")]
    let samples = (seconds / period_s).round().max(1.0) as usize;
    samples
}

#[cfg(test)]
mod tests {
    use super::super::proposal::Pattern;
    use super::*;
    use crate::effect::{DeadBand, FlowCurve};
    use crate::model::Component;

    fn proposal(pattern: Pattern, levels: &[f64], angle: f64) -> Proposal {
        let starts = vec![Start { angle, others: 0.0, worked_s: 0.0 }];
        Proposal { pattern, levels: levels.to_vec(), hold_s: 1.0, starts }
    }

    fn setting() -> Setting {
        Setting {
            period_s: 0.01,
            hold_s: 1.0,
            levels: (1.0, 2.0),
            range: (-30.0, 30.0),
            duration_s: 60.0,
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
        let found = setting().run(&tried, [&band, &plain], 0.1).unwrap();
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
        let found = setting().run(&tried, [&slow, &fast], 0.1).unwrap();
        assert!(found.times_noise > 10.0 && found.evidence < 1e-6);
    }

    #[test]
    fn no_experiment_leaves_the_range_of_the_record() {
        let same = JointModel::integrator(10.0, 0.1);
        let run = |angle| {
            let tried = proposal(Pattern::Ladder, &[1.0, 2.0], angle);
            setting().run(&tried, [&same, &same], 0.1).is_some()
        };
        // It goes 40 deg up.
        assert!(run(-5.0) && !run(0.0));
    }
}
