//! What a log shows of how a joint may be driven: where its input rests, which levels were
//! played, and where the output has been.

use crate::delay::{FirstOrder, Neutral, alike, level_tolerance};
use crate::experiment::{Joint, Record, Trial};
use crate::numerics::{limits, median, quantile};

/// What was played on a joint, and where it went.
#[derive(Clone, Debug, PartialEq)]
pub struct Logged {
    /// The input at which the joint is meant to rest, input units.
    pub rest: f64,
    /// Levels that were played, ascending, as differences to `rest`.
    pub levels: Vec<f64>,
    /// Lowest and highest output.
    pub extent: (f64, f64),
    /// Of an output that regulates itself, as a speed or a pressure does.
    pub settling: Option<Settling>,
}

/// Where an output that regulates itself comes to rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Settling {
    /// The output that each of the levels leads to, output units.
    pub outputs: Vec<f64>,
    /// The time that it takes, seconds.
    pub time_s: f64,
}

/// Part of the record, at least, for which a level is held that was not played by chance.
const LEAST_SHARE: f64 = 0.01;

/// Part of the record that levels make up together, where it is one of levels.
const MOSTLY: f64 = 0.8;

impl Logged {
    /// What the trials of `joint` show.
    pub fn of(joint: &Joint) -> Self {
        let tolerance = level_tolerance(&joint.trials);
        let rest = Neutral::of(&joint.trials).map_or(0.0, |neutral| neutral.level);
        // Zero is meant where a converter leaves a little.
        let rest = if rest.abs() > tolerance { rest } else { 0.0 };
        let extent = limits(joint.trials.iter().flat_map(Trial::output).copied());
        let levels = levels(joint);
        let settling = FirstOrder::of(&joint.trials).map(|found| {
            let output = |level: &f64| {
                let held = held_outputs(joint, (*level, tolerance), found.settling_s());
                median(&held).unwrap_or_else(|| found.settled_at(*level))
            };
            Settling { outputs: levels.iter().map(output).collect(), time_s: found.settling_s() }
        });
        let levels = levels.into_iter().map(|level| level - rest).collect();
        Self { rest, levels, extent, settling }
    }

    /// These levels about the one at which a self-regulating output is to rest.
    ///
    /// It is the one where it settles nearest to the middle of the range. Other outputs rest where
    /// they do.
    #[must_use]
    pub fn within(self, (low, high): (f64, f64)) -> Self {
        let (low, high) = (low.max(self.extent.0), high.min(self.extent.1));
        let off_middle = |output: f64| (output - 0.5 * (low + high)).abs();
        let settled = self.settling.iter().flat_map(|settling| &settling.outputs);
        let pairs = self.levels.iter().zip(settled);
        let inside = pairs.filter(|(_, output)| **output > low && **output < high);
        let nearest = inside.min_by(|a, b| off_middle(*a.1).total_cmp(&off_middle(*b.1)));
        let Some((&home, _)) = nearest else { return self };
        let levels = self.levels.iter().map(|level| level - home).collect();
        Self { rest: self.rest + home, levels, ..self }
    }

    /// Where an output that regulates itself settles at rest.
    pub fn settled(&self) -> Option<f64> {
        let outputs = &self.settling.as_ref()?.outputs;
        let place = self.levels.iter().position(|level| level.abs() <= f64::EPSILON)?;
        outputs.get(place).copied()
    }

    /// The levels at which a self-regulating output settles from `low` to `high`; all levels of
    /// other outputs.
    #[must_use]
    pub(super) fn settling_within(&self, (low, high): (f64, f64)) -> Self {
        let Some(settling) = &self.settling else { return self.clone() };
        let both = self.levels.iter().copied().zip(settling.outputs.iter().copied());
        let inside = both.filter(|(_, output)| *output >= low && *output <= high);
        let (levels, outputs) = inside.unzip();
        let settling = Some(Settling { outputs, ..*settling });
        Self { levels, settling, ..self.clone() }
    }

    /// These levels as they are in the log, about zero.
    #[must_use]
    pub fn as_it_is(self) -> Self {
        let levels = self.levels.iter().map(|level| level + self.rest).collect();
        Self { rest: 0.0, levels, ..self }
    }

    /// `joint` with its input as difference to where it rests.
    #[must_use]
    pub(crate) fn centred(&self, joint: &Joint) -> Joint {
        let centred = |trial: &Trial| {
            let input = trial.input().iter().map(|input| input - self.rest).collect();
            let (start_s, output) = (trial.time_s(1), trial.output().to_vec());
            Trial::new(trial.label(), start_s, trial.period(), input, output).ok()
        };
        let trials: Option<Record> = joint.trials.iter().map(centred).collect();
        trials.map_or_else(|| joint.clone(), |trials| Joint { trials, ..joint.clone() })
    }

    /// `joint` with its input as difference to where it rests, and no more samples than a model of
    /// its motion needs: every so many of a log that has more than 100 a second, or very many.
    #[must_use]
    pub fn thinned(&self, joint: &Joint) -> Joint {
        /// Shortest time between samples that is kept, seconds, and the longest that is made.
        const SHORTEST_S: f64 = 0.01;
        const LONGEST_S: f64 = 0.04;
        /// Samples with which a model is found in some seconds.
        const ENOUGH: f64 = 12_000.0;
        let samples: usize = joint.trials.iter().map(Trial::len).sum();
        let centred = self.centred(joint);
        let thinned = |trial: &Trial| {
            let period_s = trial.period().seconds();
            let wanted = (samples as f64 / ENOUGH).min(LONGEST_S / period_s);
            let wanted = wanted.max(SHORTEST_S / period_s).round().max(1.0);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "≥ 1")]
            let every = wanted as usize;
            trial.every(every)
        };
        let trials: Vec<Trial> = centred.trials.iter().filter_map(thinned).collect();
        if trials.len() < centred.trials.len() {
            return centred;
        }
        centred.of_trials(trials)
    }

    /// The largest magnitude of a level, as a difference to rest.
    pub fn largest(&self) -> f64 {
        self.levels.iter().fold(0.0, |largest: f64, level| largest.max(level.abs()))
    }

    /// Levels of either sign, ascending: the highest that was played, and the one nearest to the
    /// middle between it and the end of the band in which the joint rests.
    ///
    /// Played levels alone are taken: what a joint does between two of them is not known from
    /// what it does at them.
    pub(super) fn beyond(&self, (lower, upper): (f64, f64)) -> Vec<f64> {
        let below = self.levels.iter().map(|level| -level);
        let below: Vec<f64> = side(below, -lower).iter().rev().map(|level| -level).collect();
        let above = side(self.levels.iter().copied(), upper);
        below.into_iter().chain(above).collect()
    }
}

/// Of the positive `levels`, the highest, and the one beyond `edge` that is nearest to the middle
/// between.
fn side(levels: impl Iterator<Item = f64>, edge: f64) -> Vec<f64> {
    /// As parts of the highest level: how far a level that surely moves the joint lies beyond the
    /// edge, and how far from the highest one that is another.
    const BEHIND: f64 = 0.1;
    const APART: f64 = 0.15;
    let levels: Vec<f64> = levels.filter(|level| *level > 0.0).collect();
    let highest = levels.iter().copied().fold(0.0, f64::max);
    if highest <= edge {
        return Vec::new();
    }
    // As far from the band as from the highest: what bends in between shows most.
    let middle = 0.5 * (edge + highest);
    let others = levels
        .into_iter()
        .filter(|level| *level >= edge + BEHIND * highest && *level <= highest - APART * highest);
    let nearest = others.min_by(|a, b| (a - middle).abs().total_cmp(&(b - middle).abs()));
    nearest.into_iter().chain([highest]).collect()
}

/// The output of `joint` at the ends of holds of a level, to a tolerance, that are longer than
/// `longer_s`.
fn held_outputs(joint: &Joint, (level, tolerance): (f64, f64), longer_s: f64) -> Vec<f64> {
    let mut held = Vec::new();
    for trial in &joint.trials {
        let period_s = trial.period().seconds();
        let is_level = |input: &f64| (input - level).abs() <= tolerance;
        let (mut samples, input) = (0_u32, trial.input());
        for (index, output) in trial.output().iter().enumerate() {
            samples = if input.get(index).is_some_and(is_level) { samples + 1 } else { 0 };
            let is_last = !input.get(index + 1).is_some_and(is_level);
            if is_last && f64::from(samples) * period_s > longer_s {
                held.push(*output);
            }
        }
    }
    held
}

/// Levels of the input that were held, ascending; of an input that never holds, its tenths
/// without the last parts of it.
fn levels(joint: &Joint) -> Vec<f64> {
    let mut inputs: Vec<f64> = joint.trials.iter().flat_map(Trial::input).copied().collect();
    inputs.sort_by(f64::total_cmp);
    let tolerance = level_tolerance(&joint.trials);
    let is_held = |same: &&[f64]| same.len() as f64 >= LEAST_SHARE * inputs.len() as f64;
    let held: Vec<&[f64]> =
        alike(&inputs, |input| *input, tolerance).into_iter().filter(is_held).collect();
    let samples: usize = held.iter().map(|same| same.len()).sum();
    if samples as f64 >= MOSTLY * inputs.len() as f64 && held.len() <= MOST_LEVELS {
        return held.iter().map(|same| same[same.len() / 2]).collect();
    }
    let part = |k: u32| quantile(&inputs, 0.01 + 0.098 * f64::from(k));
    (0..=10).filter_map(part).collect()
}

/// More levels are those of an input that never holds, which makes up bins of one percent.
const MOST_LEVELS: usize = 30;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    fn joint(input: Vec<f64>) -> Joint {
        let mut angle = 50.0;
        let output = input.iter().map(|u| {
            angle += 0.1 * (u - 7.5);
            angle
        });
        let output = output.collect();
        let period = SamplePeriod::from_seconds(0.02).unwrap();
        Joint::new("boom", vec![Trial::new("1", 0.0, period, input, output).unwrap()])
    }

    fn steps(levels: &[f64]) -> Vec<f64> {
        levels.iter().flat_map(|level| std::iter::repeat_n(*level, 100)).collect()
    }

    #[test]
    fn levels_are_those_that_were_played_about_the_one_at_rest() {
        let joint = joint(steps(&[7.5, 9.0, 7.5, 5.0, 7.5, 10.0, 7.5, 6.0, 7.5, 8.0, 7.5]));
        let logged = Logged::of(&joint);
        assert_eq!((logged.rest, logged.largest()), (7.5, 2.5));
        assert_eq!(logged.levels, [-2.5, -1.5, 0.0, 0.5, 1.5, 2.5]);
        assert_eq!(logged.beyond((-0.4, 0.4)), [-2.5, -1.5, 1.5, 2.5]);
        assert_eq!(logged.beyond((-2.0, 2.0)), [-2.5, 2.5]);
        assert_eq!(logged.beyond((-3.0, 2.0)), [2.5]);
        let thinned = logged.thinned(&joint);
        assert_eq!(thinned.trials[0].input()[..2], [0.0, 0.0]);
        assert_eq!(thinned.trials[0].len(), joint.trials[0].len());
    }

    #[test]
    fn a_log_with_many_samples_is_thinned() {
        let slow = joint(steps(&[0.0, 2.0, 0.0, -1.0]));
        let period = SamplePeriod::from_seconds(0.001).unwrap();
        let (input, output) = (slow.trials[0].input().to_vec(), slow.trials[0].output().to_vec());
        let trials = vec![Trial::new("1", 0.0, period, input, output).unwrap()];
        let fast = Joint { trials: trials.into(), ..slow };
        let thinned = Logged::of(&fast).thinned(&fast);
        let thinned = &thinned.trials[0];
        assert_eq!((thinned.len(), thinned.period().seconds()), (40, 0.01));
        assert_eq!(thinned.output()[1].to_bits(), fast.trials[0].output()[10].to_bits());
    }

    #[test]
    fn an_output_that_settles_rests_at_the_level_nearest_to_the_middle_of_its_range() {
        let input = steps(&[0.0, 2.0, 1.0, 3.0, 0.0, 1.0, 3.0, 2.0]);
        let mut y = 0.0;
        let output = input.iter().map(|u| {
            y += 0.1 * (10.0 * u + 5.0 - y);
            y
        });
        let period = SamplePeriod::from_seconds(0.02).unwrap();
        let output: Vec<f64> = output.collect();
        let trials = vec![Trial::new("1", 0.0, period, input, output).unwrap()];
        let joint = Joint { trials: trials.into(), ..joint(vec![0.0; 10]) };
        let logged = Logged::of(&joint).within((10.0, 32.0));
        assert!((logged.rest - 2.0).abs() < 1e-9, "{}", logged.rest);
        assert!((logged.settled().unwrap() - 25.0).abs() < 0.1);
        assert_eq!(logged.levels, [-2.0, -1.0, 0.0, 1.0]);
        assert_eq!(logged.settling_within((10.0, 32.0)).levels, [-1.0, 0.0]);
        assert_eq!(Logged::of(&joint).within((50.0, 60.0)).rest.to_bits(), 0.0_f64.to_bits());
    }

    #[test]
    fn an_input_that_never_holds_has_levels_within_its_range() {
        let input: Vec<f64> = (0..2000).map(|k| 7.5 + 2.0 * (f64::from(k) / 50.0).sin()).collect();
        let levels = Logged::of(&joint(input)).levels;
        assert_eq!(levels.len(), 11);
        assert!(levels.iter().all(|level| level.abs() <= 9.5));
    }
}
