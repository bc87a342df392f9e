//! What experiments there can be on the joint of a record.

use super::levels::{level_sets, thresholds, two_digits, two_digits_of};
use crate::diagnosis::sensor_noise;
use crate::effect::{Effect, RecordRange};
use crate::explain::candidate::Candidate;
use crate::explain::separation::{Proposal, Start};
use crate::fit::FitRecord;
use crate::model::Component;

/// What experiments there can be on the joint of a record.
pub(super) struct ExperimentSpace {
    pub(super) period_s: f64,
    /// Seconds between steps of the input, on average.
    pub(super) hold_s: f64,
    /// Least and largest magnitude of the input that is not zero.
    pub(super) levels: (f64, f64),
    /// Lowest and highest output.
    pub(super) range: (f64, f64),
    pub(super) duration_s: f64,
    pub(super) radians_per_output_unit: f64,
    pub(super) sensor_noise: Option<f64>,
}

impl ExperimentSpace {
    pub(super) fn of(record: &FitRecord<'_>) -> Self {
        let levels = record.input_levels();
        let RecordRange {
            output_min,
            output_max,
            duration_s,
            sample_period_s,
            radians_per_output_unit,
            ..
        } = record.range(1.0);
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
            sensor_noise: sensor_noise(&record.measured().trials),
        }
    }

    /// Experiments with levels of the record and below, and with larger ones.
    pub(super) fn proposals(&self, pair: [&Candidate; 2]) -> (Vec<Proposal>, Vec<Proposal>) {
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

    /// Starts that are worth a trial: at several angles, with other joints moving or not, cold
    /// and warm, where one of the two depends on it.
    fn start_sets(&self, pair: [&Candidate; 2]) -> Vec<Vec<Start>> {
        let (low, high) = self.range;
        let at = |part: f64| two_digits_of(low + part * (high - low), high - low);
        let middle = Start { angle: at(0.5), others: 0.0, worked_s: self.duration_s };
        let added = || pair.into_iter().flat_map(Candidate::added).map(Component::effect);
        let mut sets = vec![vec![middle]];
        if pair.iter().any(|candidate| candidate.fit.model.depends_on_angle()) {
            sets.push([0.2, 0.5, 0.8].map(|part| Start { angle: at(part), ..middle }).to_vec());
        }
        if added().any(Effect::depends_on_others) {
            sets.push(vec![middle, Start { others: 1.0, ..middle }]);
        }
        if added().any(Effect::depends_on_warmth) {
            sets.push(vec![Start { worked_s: 0.0, ..middle }, middle]);
        }
        sets
    }

    /// A hold in two digits, and no less than a few samples.
    fn hold(&self, seconds: f64) -> f64 {
        const FEWEST: f64 = 10.0;
        two_digits(seconds.max(FEWEST * self.period_s))
    }
}

/// Changes of the input.
fn steps(input: &[f64]) -> usize {
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let changes = |pair: &&[f64]| matches!(pair, [a, b] if a != b);
    input.windows(2).filter(changes).count()
}
