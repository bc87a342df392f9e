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

use super::window::Window;
use crate::experiment::{Joint, Property, Record, Trial};
use crate::model::Commands;

/// One of so many samples is kept.
#[derive(Debug)]
pub(super) struct Stride(pub(super) usize);

impl Property for Stride {
    /// As many as leave nearly all of the variance of the input between their means: in more samples
    /// its steps would be seen too rarely, or its moves lost.
    fn find(record: &Record) -> Self {
        /// The part of the variance that may be within the blocks. Chosen: a step each 120 samples is
        /// then seen at every eighth. With 0.012, half of that stride, as many of 130 simulated records get
        /// the right model, in half as long again.
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

impl Coarse {
    /// One of some samples of each trial of `joint`; none where all are kept.
    pub(super) fn of(joint: &Joint) -> Option<Self> {
        let stride = joint.trials.property::<Stride>().0;
        if stride == 1 {
            return None;
        }
        let trials: Record =
            joint.trials.iter().map(|trial| trial.every(stride)).collect::<Option<_>>()?;
        Some(Self { joint: Joint { trials, ..joint.clone() }, stride })
    }

    /// Those of `windows` in which samples are kept.
    pub(super) fn windows(&self, windows: &[Window]) -> Vec<Window> {
        let kept = |window: &Window| {
            let [start, end] = [window.start, window.end].map(|end| end.div_ceil(self.stride));
            (start < end).then_some(Window { start, end, ..*window })
        };
        windows.iter().filter_map(kept).collect()
    }

    /// What is kept of values of each trial and sample.
    pub(super) fn kept(&self, values: &[Vec<f64>]) -> Vec<Vec<f64>> {
        values.iter().map(|own| own.iter().step_by(self.stride).copied().collect()).collect()
    }

    /// The changes of the input of each trial.
    pub(super) fn commands(&self, commands: &[Commands]) -> Vec<Commands> {
        let periods = self.joint.trials.iter().map(|trial| trial.period().seconds());
        commands.iter().zip(periods).map(|(own, period_s)| own.in_blocks(period_s)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{FitRecord, Horizon, Split, fit, survey};
    use crate::model::JointModel;
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
