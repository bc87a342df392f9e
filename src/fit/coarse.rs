//! A record of fewer samples, on which descents go most of their way.
//!
//! A simulation takes a step for each sample, and a hold of a second logged at 100 Hz says hardly more of
//! a model than every fourth sample of it. So valleys are looked for in one of so many samples of all
//! windows, and only the end of a descent is on all samples: as in a multigrid method, the coarse
//! problem has the same valleys. The input keeps its steps at the times at which they are; where it
//! changes several times between two samples that are kept, its mean acts.
//!
//! # References
//! S. G. Nash, "A multigrid approach to discretized optimization problems", Optimization Methods and
//! Software 14 (2000), 99-116.

use std::sync::Arc;

use super::mended::Mended;
use super::record::FitRecord;
use super::window::Window;
use crate::experiment::{Joint, Property, Record, Trial};
use crate::model::JointModel;

/// One of so many samples is kept.
#[derive(Debug)]
pub(super) struct Stride(pub(super) usize);

impl Property for Stride {
    /// As many as leave nearly all of the variance of the input between their means: in more samples
    /// its steps would be seen too rarely, or its moves lost.
    fn find(record: &Record) -> Self {
        /// The part of the variance that may be within the blocks. Chosen: a step each 120 samples is
        /// then seen at every eighth. With 0.012, half of that stride, models are the same and take half
        /// as long again.
        const WITHIN: f64 = 0.03;
        /// The largest stride: the end of a descent is then most of its time. With half of it errors of
        /// measured joints are a tenth larger or smaller, as with any other path.
        const LARGEST: usize = 8;
        /// Samples that are kept at least: of fewer nothing is saved.
        const FEWEST: usize = 1000;
        let samples: usize = record.iter().map(Trial::len).sum();
        let largest = (samples / FEWEST).clamp(1, LARGEST);
        let all = record.iter().flat_map(|trial| trial.input().iter().copied());
        let mean = all.clone().sum::<f64>() / samples.max(1) as f64;
        let whole = squares(all, mean);
        let is_fine = |stride: &usize| {
            let blocks = record.iter().flat_map(|trial| trial.input().chunks(*stride));
            let within = blocks.map(|block| {
                let mean = block.iter().sum::<f64>() / block.len() as f64;
                squares(block.iter().copied(), mean)
            });
            within.sum::<f64>() <= WITHIN * whole
        };
        Self((2..=largest).take_while(is_fine).last().unwrap_or(1))
    }
}

/// A joint of which one sample of so many is kept.
#[derive(Clone, Debug)]
pub(super) struct Coarse {
    pub(super) joint: Joint,
    pub(super) stride: usize,
}

fn squares(values: impl Iterator<Item = f64>, mean: f64) -> f64 {
    values.map(|value| (value - mean).powi(2)).sum()
}

/// Every so many of `values`.
fn every<T: Copy>(values: &[T], stride: usize) -> Vec<T> {
    values.iter().step_by(stride).copied().collect()
}

impl FitRecord<'_> {
    /// This record with one of some samples of each trial, for fits of `model`.
    pub(super) fn coarser_for(&self, model: &JointModel) -> Self {
        let stride = self.joint().trials.property::<Stride>().0;
        let trials = self.joint().trials.iter().map(|trial| trial.every(stride));
        let is_whole = stride == 1 || model.takes_measured_delays();
        let trials: Option<Record> = if is_whole { None } else { trials.collect() };
        let Some(trials) = trials else { return self.clone() };
        let joint = Joint { trials, ..self.joint().clone() };
        let window = |window: &Window| {
            let (start, end) = (window.start.div_ceil(stride), window.end.div_ceil(stride));
            (start < end).then_some(Window { start, end, ..*window })
        };
        let periods = joint.trials.iter().map(|trial| trial.period().seconds());
        let commands = self.commands.iter().zip(periods);
        let weights = self.seen.weights.as_ref();
        let weights = weights.map(|all| all.iter().map(|own| every(own, stride)).collect());
        let seen = Mended { record: None, weights, has_noisy_input: self.seen.has_noisy_input };
        let mut coarse = self.clone();
        coarse.windows = self.windows.iter().filter_map(window).collect();
        coarse.others = Arc::new(self.others.iter().map(|own| every(own, stride)).collect());
        coarse.commands =
            Arc::new(commands.map(|(own, period_s)| own.in_blocks(period_s)).collect());
        coarse.seen = Arc::new(seen);
        coarse.coarse = Some(Coarse { joint, stride });
        coarse
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{Horizon, Split, fit, survey};
    use crate::numerics::testing::normals;
    use crate::units::SamplePeriod;

    /// An integrator with a delay of 0.137 s, whose input is held for so many samples at 100 Hz.
    fn joint(hold: usize, samples: usize) -> Joint {
        let mut normal = normals(5);
        let levels: Vec<f64> = (0..=samples / hold).map(|_| normal()).collect();
        let input: Vec<f64> = (0..samples).map(|k| levels[k / hold]).collect();
        let (mut angle, mut output) = (0.0, Vec::new());
        for k in 0..samples {
            output.push(angle + 0.01 * normal());
            // 13.7 samples: the level changes within an interval.
            let level = |back: usize| input[k.saturating_sub(back)];
            angle += 0.01 * 8.0 * (0.3 * level(13) + 0.7 * level(14));
        }
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        Joint::new("boom", vec![Trial::new("1", 0.0, period, input, output).unwrap()])
    }

    fn stride(joint: &Joint) -> usize {
        joint.trials.property::<Stride>().0
    }

    #[test]
    fn as_many_samples_are_left_out_as_the_input_allows() {
        assert_eq!(stride(&joint(47, 12_000)), 4);
        assert_eq!(stride(&joint(2003, 40_000)), 8, "the largest");
        assert_eq!(stride(&joint(1, 12_000)), 1, "noise has no means");
        assert_eq!(stride(&joint(121, 1900)), 1, "few samples");
    }

    #[test]
    fn a_survey_is_near_the_fit() {
        let joint = joint(120, 12_000);
        let record = FitRecord::new(&joint, Split::Blocks, Horizon::Auto);
        let start = JointModel::integrator(5.0, 0.05);
        let range = record.range_for(&start);
        let coarse = record.coarser_for(&start);
        assert!(3 * coarse.training_samples() < record.training_samples());
        let (surveyed, fitted) =
            (survey(&record, &start, &range).unwrap(), fit(&record, &start, &range).unwrap());
        for (found, name) in [(surveyed.model, "survey"), (fitted.model.clone(), "fit")] {
            assert!((found.delay.value - 0.137).abs() < 2e-3, "{name}: {}", found.delay.value);
            assert!((found.gain.value - 8.0).abs() < 0.02, "{name}: {}", found.gain.value);
        }
    }

    #[test]
    fn a_trial_loses_samples_and_keeps_its_time() {
        let whole = joint(120, 1001);
        let trial = whole.trials[0].every(4).unwrap();
        assert_eq!(trial.len(), 251);
        let (first, last) = (trial.output()[0], trial.output()[250]);
        assert_eq!((first, last), (whole.trials[0].output()[0], whole.trials[0].output()[1000]));
        assert!((trial.time_s(251) - whole.trials[0].time_s(1001)).abs() < 1e-9);
    }
}
