//! Which measured signals may change the gain of a joint.
//!
//! A further column of the joint may be a cause, as the pressure of the supply or the force on the
//! cylinder, or a consequence, as a current that follows the command or another sensor of the angle.
//! One that the joint's own signals tell is none of the former: it is regressed on the input `u`, the
//! angle `y`, its speed `v`, and the magnitudes of input and speed.

use crate::experiment::{Joint, Trial};
use crate::numerics::Regression;
use crate::units::floor_to_index;

/// Names of the signals of `joint` that may change its gain, in the order of the log.
pub(super) fn possible_causes(joint: &Joint) -> Vec<&str> {
    /// Signals that are tried, at most: each costs fits.
    const MOST: usize = 4;
    /// The part of a signal's variance from which on the joint's own signals explain it. Chosen, not
    /// measured: a second sensor of the same motion is nearly 1.
    const TOLD: f64 = 0.8;
    let names = joint.covariates.iter().enumerate();
    let causes = names.filter(|(index, _)| {
        explained_by_own(&joint.trials, *index).is_some_and(|share| share < TOLD)
    });
    causes.map(|(_, signal)| signal.name.as_str()).take(MOST).collect()
}

/// The part of the variance of a further signal that the joint's own signals explain; `None` where
/// it was not measured throughout, or never changes.
fn explained_by_own(trials: &[Trial], index: usize) -> Option<f64> {
    let mut signal = Vec::with_capacity(trials.len());
    for trial in trials {
        let values = trial.covariates().get(index)?;
        if !values.iter().all(|value| value.is_finite()) {
            return None;
        }
        signal.push(values.clone());
    }
    centre(&mut signal);
    let total: f64 = signal.iter().flatten().map(|value| value * value).sum();
    let of = |own: fn(&Trial) -> Vec<f64>| {
        let mut column: Vec<Vec<f64>> = trials.iter().map(own).collect();
        centre(&mut column);
        column
    };
    let own = [
        of(|trial| trial.input().to_vec()),
        of(|trial| trial.output().to_vec()),
        of(speed),
        of(|trial| magnitudes(trial.input())),
        of(|trial| magnitudes(&speed(trial))),
    ];
    let rest = Regression::of(&signal, &own.iter().collect::<Vec<_>>()).error;
    (total > 0.0).then(|| 1.0 - rest / total)
}

fn magnitudes(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| value.abs()).collect()
}

/// The slope of the output over about 0.1 s.
fn speed(trial: &Trial) -> Vec<f64> {
    const REACH_S: f64 = 0.05;
    let period_s = trial.period().seconds();
    let reach = floor_to_index(REACH_S / period_s).max(1);
    let output = trial.output();
    let slope = |k: usize| {
        let (from, to) = (k.saturating_sub(reach), (k + reach).min(output.len() - 1));
        (output[to] - output[from]) / ((to - from).max(1) as f64 * period_s)
    };
    (0..output.len()).map(slope).collect()
}

/// Takes the mean of all trials together from each.
fn centre(column: &mut [Vec<f64>]) {
    let count: usize = column.iter().map(Vec::len).sum();
    let mean = column.iter().flatten().sum::<f64>() / count.max(1) as f64;
    column.iter_mut().flatten().for_each(|value| *value -= mean);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Signal;
    use crate::numerics::testing::noise;
    use crate::units::SamplePeriod;

    #[test]
    fn what_the_joint_does_itself_is_no_cause() {
        let input: Vec<f64> = (0..2000).map(|k| f64::from(k / 80 * 7 % 5) - 2.0).collect();
        let mut angle = 0.0;
        let mut turn = |u: &f64| {
            angle += 0.1 * u;
            angle
        };
        let output: Vec<f64> = input.iter().map(&mut turn).collect();
        let current = input.iter().map(|u| 3.0 * u.abs() + 4.0).collect();
        let second = output.iter().map(|y| 2.0 * y - 1.0).collect();
        let pressure = (0..2000).map(|k| 200.0 + 5.0 * (f64::from(k) * 0.004).sin()).collect();
        let mut gaps = noise(1, 0.9, 2000);
        gaps[700] = f64::NAN;
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("", 0.0, period, input, output).unwrap();
        let all = vec![current, second, pressure, vec![1.0; 2000], gaps];
        let names = ["current", "second", "pressure", "constant", "gaps"];
        let joint = Joint {
            name: "boom".to_owned(),
            input_unit: None,
            output_unit: None,
            covariates: names.map(|name| Signal { name: name.to_owned(), unit: None }).to_vec(),
            trials: [trial.with_covariates(all).unwrap()].into(),
        };
        assert_eq!(possible_causes(&joint), ["pressure"]);
    }
}
