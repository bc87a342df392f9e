//! Strokes of a simulated cylinder from rest into its stop.

use tauscope::experiment::{Record, Trial};
use tauscope::synthetic::{CylinderSpec, DelayLaw, InputSpec, JointSpec, PlantSpec, simulate};

pub(crate) const PERIOD_S: f64 = 0.01;

const NOISE: f64 = 0.01;

/// Samples before the step.
fn rest(seed: u32) -> usize {
    110 + (seed as usize * 37) % 80
}

/// A cylinder that rests, is driven by `level` into its stop after `delay_s`, and is let go.
pub(crate) fn stroke(seed: u32, level: f64, delay_s: f64) -> Trial {
    let steps = vec![(rest(seed), level), (rest(seed) + 1200, 0.0)];
    simulated(seed, level, steps, delay_s, NOISE)
}

/// Samples from the step until the output, without noise, is off that of a trial without the step
/// by a tenth of the noise.
pub(crate) fn first_motion(seed: u32, level: f64, delay_s: f64) -> f64 {
    let clean = |steps| simulated(seed, level, steps, delay_s, 0.0);
    let (moves, rests) = (clean(vec![(rest(seed), level)]), clean(vec![]));
    let pairs = moves.output().iter().zip(rests.output());
    let apart: Vec<f64> = pairs.map(|(y, still)| (y - still).abs() - 0.1 * NOISE).collect();
    let after = apart.iter().position(|apart| *apart > 0.0).unwrap();
    let part = apart[after - 1] / (apart[after - 1] - apart[after]);
    (after - 1 - rest(seed)) as f64 + part
}

/// A cylinder that starts near the end from which `level` drives it away.
fn simulated(seed: u32, level: f64, steps: Vec<(usize, f64)>, delay_s: f64, noise: f64) -> Trial {
    let input = InputSpec::Steps { steps, initial: 0.0 };
    let cylinder = CylinderSpec::default();
    let [low, high] = cylinder.angle_limits_deg;
    let start = if level > 0.0 { low + 1.0 } else { high - 1.0 };
    let delay = DelayLaw::Constant { seconds: delay_s };
    let cylinder = Some(cylinder);
    let joint = JointSpec { start, noise, cylinder, ..JointSpec::new("boom", input, delay) };
    let made = simulate(&PlantSpec::new(seed.into(), 16.0, vec![joint])).unwrap();
    let trial = &made.joints[0].trials[0];
    let (input, output) = (trial.input().to_vec(), trial.output().to_vec());
    Trial::new(seed.to_string(), 0.0, trial.period(), input, output).unwrap()
}

/// Eight strokes both ways and their delays, samples.
pub(crate) fn strokes() -> (Record, Vec<f64>) {
    let one = |seed: u32| {
        let level = [4.0, -4.0, 6.0, -6.0][seed as usize % 4];
        let delay_s = 0.06 + 0.03 * f64::from(seed);
        (stroke(seed, level, delay_s), delay_s / PERIOD_S)
    };
    let (trials, delays): (Vec<Trial>, _) = (0..8).map(one).unzip();
    (trials.into(), delays)
}
