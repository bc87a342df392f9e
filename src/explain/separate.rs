//! The experiment that would tell two effects apart.
//!
//! Two fitted models are simulated on a number of inputs that suit the record: levels about
//! the fitted thresholds, below the smallest and up to the largest level, in ladders, pulses
//! and reversals, with short and long holds, at several angles. The input is proposed that
//! brings the most evidence per second of experiment.

use super::Workers;
use super::candidate::Candidate;
use super::race::ALIKE;
use crate::effect::{Dimension, RecordRange};
use crate::experiment::Trial;
use crate::fit::Record;
use crate::model::{JointModel, Restart, Simulated, Surroundings, arrivals, simulate};
use crate::units::SamplePeriod;

/// How the levels of an input follow one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// Rising and then falling, first in one direction and then in the other.
    Ladder,
    /// Each in both directions, with the input at zero behind each.
    Pulses,
    /// Each in both directions, one at once behind the other.
    Reversals,
}

/// Where and when a run of an experiment starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The angle, output units.
    pub angle: f64,
    /// Activity of the other joints meanwhile, 0 to 1.
    pub others: f64,
    /// Seconds for which the machine has worked before.
    pub worked_s: f64,
}

/// An experiment: an input, and the runs that are made with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// How the levels follow one another.
    pub pattern: Pattern,
    /// Their magnitudes, ascending, input units.
    pub levels: Vec<f64>,
    /// How long each is held, seconds.
    pub hold_s: f64,
    /// Where each run starts.
    pub starts: Vec<Start>,
}

/// What would tell two effects apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Separation {
    /// Id of the other effect.
    pub other: &'static str,
    /// The best experiment of those that were tried.
    pub proposal: Proposal,
    /// The largest difference between the outputs of the two models in it, in times the
    /// noise of the measurement.
    pub times_noise: f64,
    /// Seconds from the start of a run to that.
    pub after_s: f64,
    /// Whether a change of gain and of starts would leave so much of the difference that the
    /// two are told apart.
    pub is_clear: bool,
}

impl Proposal {
    /// The levels of a run in their order, each held for [`hold_s`](Self::hold_s); the joint
    /// rests as long before the first.
    pub fn sequence(&self) -> Vec<f64> {
        let mirrored = |level: &f64| [*level, -level];
        match self.pattern {
            Pattern::Ladder => {
                let falling = self.levels.iter().rev().skip(1);
                let up_and_down: Vec<f64> = self.levels.iter().chain(falling).copied().collect();
                let back = up_and_down.iter().map(|level| -level);
                std::iter::once(0.0).chain(up_and_down.iter().copied()).chain(back).collect()
            }
            Pattern::Pulses => {
                let pulses = self.levels.iter().flat_map(mirrored);
                std::iter::once(0.0).chain(pulses.flat_map(|level| [level, 0.0])).collect()
            }
            Pattern::Reversals => {
                std::iter::once(0.0).chain(self.levels.iter().flat_map(mirrored)).collect()
            }
        }
    }

    /// Seconds that all runs take together.
    pub fn duration_s(&self) -> f64 {
        (self.sequence().len() * self.starts.len()) as f64 * self.hold_s
    }
}

/// Tells each candidate that is worth a name by what it is told from those it cannot be
/// told from.
pub(super) fn separate(record: &Record<'_>, ranking: &mut [Candidate], workers: &impl Workers) {
    let place = |id: &str| ranking.iter().position(|c| c.effects == [id]);
    let of_one = |(one, candidate): (usize, &Candidate)| {
        let worthy = candidate.is_significant();
        let others = candidate.indistinguishable_from.iter().filter_map(|id| place(id));
        others.filter(move |_| worthy).map(move |other| (one, other)).collect::<Vec<_>>()
    };
    let pairs: Vec<_> = ranking.iter().enumerate().flat_map(of_one).collect();
    let setting = Setting::of(record);
    let apart = |(one, other): &(usize, usize)| {
        Some((*one, setting.apart(ranking.get(*one)?, ranking.get(*other)?)?))
    };
    let found = workers.map(&pairs, apart);
    for (one, separation) in found.into_iter().flatten() {
        if let Some(candidate) = ranking.get_mut(one) {
            candidate.separated_by.push(separation);
        }
    }
}

/// A difference of less than so many times the noise tells nothing apart.
const VISIBLE: f64 = 3.0;

/// Twice the difference in log-likelihood from which two models are told apart: well above
/// that below which they are alike, because a fit may take some of it away.
const CLEAR: f64 = 4.0 * ALIKE;

/// What experiments there can be on the joint of a record.
struct Setting {
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
    fn of(record: &Record<'_>) -> Self {
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
    fn apart(&self, one: &Candidate, other: &Candidate) -> Option<Separation> {
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
        let sets = self.level_sets(pair);
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
    fn level_sets(&self, pair: [&Candidate; 2]) -> Vec<(Vec<f64>, &'static [Pattern])> {
        const ALL: &[Pattern] = &[Pattern::Ladder, Pattern::Pulses, Pattern::Reversals];
        const LADDER: &[Pattern] = &[Pattern::Ladder];
        let (least, largest) = self.levels;
        let about = |level: f64, parts: &[f64]| -> Vec<f64> {
            let mut levels: Vec<f64> = parts.iter().map(|part| two_digits(part * level)).collect();
            levels.dedup();
            levels
        };
        let mut sets = vec![
            (about(least, &[0.25, 0.5, 0.75, 1.0]), LADDER),
            (about(largest, &[0.25, 0.5, 0.75, 1.0]), LADDER),
            (about(largest, &[0.5, 1.0]), ALL),
            (about(largest, &[1.25, 1.5]), ALL),
        ];
        let thresholds = thresholds(pair, largest);
        sets.extend(thresholds.iter().map(|t| (about(*t, &[0.6, 0.8, 1.2, 1.4]), LADDER)));
        sets
    }

    /// Sets of starts: in the middle, at several angles, and what else the effects depend on.
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

/// The levels of the input at which the two switch or bend, different ones.
fn thresholds(pair: [&Candidate; 2], largest: f64) -> Vec<f64> {
    /// Thresholds that are tried.
    const MOST: usize = 4;
    /// What is nearer, in parts, is the same.
    const SAME: f64 = 0.15;
    /// A threshold of a smaller part of the largest level is none.
    const LEAST: f64 = 0.02;
    let mut found: Vec<f64> = Vec::new();
    let components = pair.iter().flat_map(|candidate| {
        let all = candidate.fit.model.components().iter();
        all.filter(|c| candidate.effects.contains(&c.effect().spec().id))
    });
    for component in components {
        let specs = component.effect().spec().parameters.iter();
        let levels = specs.zip(component.parameters());
        for (_, value) in levels.filter(|(spec, _)| spec.dimension == Dimension::Input) {
            let level = value.value.abs();
            let is_new = found.iter().all(|known| (level / known - 1.0).abs() > SAME);
            if is_new && level > LEAST * largest && level < largest {
                found.push(level);
            }
        }
    }
    found.truncate(MOST);
    found
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

/// `value` to two significant digits, so that what is said is what was tried.
fn two_digits(value: f64) -> f64 {
    two_digits_of(value, value)
}

/// `value` to the second significant digit of `size`.
fn two_digits_of(value: f64, size: f64) -> f64 {
    if size == 0.0 || !size.is_finite() {
        return value;
    }
    #[expect(clippy::cast_possible_truncation, reason = "an exponent is small")]
    let exponent = size.abs().log10().floor() as i32 - 1;
    let unit = 10_f64.powi(exponent.abs());
    if exponent < 0 { (value * unit).round() / unit } else { (value / unit).round() * unit }
}

#[cfg(test)]
mod tests {
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
    fn each_pattern_goes_both_ways() {
        let levels = |pattern| proposal(pattern, &[1.0, 2.0], 0.0).sequence();
        assert_eq!(levels(Pattern::Ladder), [0.0, 1.0, 2.0, 1.0, -1.0, -2.0, -1.0]);
        assert_eq!(levels(Pattern::Pulses), [0.0, 1.0, 0.0, -1.0, 0.0, 2.0, 0.0, -2.0, 0.0]);
        assert_eq!(levels(Pattern::Reversals), [0.0, 1.0, -1.0, 2.0, -2.0]);
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

    #[test]
    fn levels_are_said_in_two_digits() {
        let shown = [0.123_4, 1.56, 0.0, 123.0].map(|value| two_digits(value).to_string());
        assert_eq!(shown, ["0.12", "1.6", "0", "120"]);
        assert!((two_digits_of(32.456, 80.0) - 32.0).abs() < 1e-12);
    }
}
