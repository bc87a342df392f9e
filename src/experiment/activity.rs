//! How much the other joints of a log do: what a shared pump feels.

use super::joint::{Joint, Trial};

/// Another joint of the log, and its delay in seconds: 0 where none is known.
#[derive(Clone, Copy, Debug)]
pub struct Other<'a> {
    /// The joint.
    pub joint: &'a Joint,
    /// Its delay.
    pub delay_s: f64,
}

/// The activity of the `others`, for each trial of `own` a value per sample, from 0 (all at
/// rest) to 1 (all driven as hard as ever in the log).
///
/// It is the mean of `|u| / max|u|` over the other joints, where `u` is the input of a joint
/// at that time, held between its samples and late by the joint's delay, and the maximum is
/// over all its trials. Trials belong together by their labels, samples by their times. Where a
/// joint was not logged it counts as at rest. Without other joints the lists are empty.
pub fn activity(own: &Joint, others: &[Other<'_>]) -> Vec<Vec<f64>> {
    let others: Vec<(&Other<'_>, f64)> = others.iter().map(|other| (other, other.most())).collect();
    own.trials.iter().map(|trial| of_trial(trial, &others)).collect()
}

impl<'a> Other<'a> {
    /// The largest magnitude of its input.
    fn most(&self) -> f64 {
        let inputs = self.joint.trials.iter().flat_map(Trial::input);
        inputs.fold(0.0, |most, input| most.max(input.abs()))
    }

    /// Its trials that may run at the same time as one labelled `label`: the one with this
    /// label; else the parts of the same trial, which were split where one joint has a gap.
    fn at_the_time_of(&self, label: &str) -> Vec<&'a Trial> {
        let same = self.joint.trials.iter().filter(|trial| trial.label() == label);
        let same: Vec<_> = same.collect();
        if !same.is_empty() {
            return same;
        }
        let parts = self.joint.trials.iter().filter(|trial| whole(trial.label()) == whole(label));
        parts.collect()
    }
}

/// The label of the trial that `label` is a part of: `a` of `a#2`.
fn whole(label: &str) -> &str {
    label.split_once('#').map_or(label, |(whole, _)| whole)
}

fn of_trial(trial: &Trial, others: &[(&Other<'_>, f64)]) -> Vec<f64> {
    if others.is_empty() {
        return Vec::new();
    }
    let mut activity = vec![0.0; trial.len()];
    for (other, most) in others.iter().filter(|(_, most)| *most > 0.0) {
        let share = 1.0 / (most * others.len() as f64);
        for part in other.at_the_time_of(trial.label()) {
            for (value, sample) in activity.iter_mut().zip(1..) {
                *value += share * held(part, trial.logged_time_s(sample) - other.delay_s).abs();
            }
        }
    }
    activity
}

/// The input of `trial` at a time, held from its last sample; zero before and behind it.
fn held(trial: &Trial, time_s: f64) -> f64 {
    /// Part of a period by which equal times may differ in rounding.
    const ROUNDING: f64 = 1e-3;
    let place = (time_s - trial.logged_time_s(1)) / trial.period().seconds() + ROUNDING;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative")]
    let index = (place >= 0.0).then_some(place as usize);
    index.and_then(|index| trial.input().get(index)).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    fn trial(label: &str, start_s: f64, period_s: f64, input: &[f64]) -> Trial {
        let period = SamplePeriod::from_seconds(period_s).unwrap();
        Trial::new(label, start_s, period, input.to_vec(), vec![0.0; input.len()]).unwrap()
    }

    fn joint(name: &str, trials: Vec<Trial>) -> Joint {
        let (input_unit, output_unit, covariates) = (None, None, Vec::new());
        Joint { name: name.to_owned(), input_unit, output_unit, covariates, trials }
    }

    /// What the joints but the first do, with their delays.
    fn of_first(joints: &[Joint], delays_s: &[f64]) -> Vec<Vec<f64>> {
        let delays_s = delays_s.iter().copied().chain(std::iter::repeat(0.0));
        let others = joints[1..].iter().zip(delays_s);
        let others: Vec<_> = others.map(|(joint, delay_s)| Other { joint, delay_s }).collect();
        activity(&joints[0], &others)
    }

    #[test]
    fn a_joint_alone_has_no_others() {
        let alone = [joint("a", vec![trial("1", 0.0, 0.1, &[1.0, 2.0])])];
        assert_eq!(of_first(&alone, &[]), [Vec::<f64>::new()]);
    }

    #[test]
    fn it_is_the_mean_share_of_the_others() {
        let joints = [
            joint("a", vec![trial("1", 0.0, 0.1, &[9.0, 9.0, 9.0])]),
            joint("b", vec![trial("1", 0.0, 0.1, &[0.0, -2.0, 1.0])]),
            joint("c", vec![trial("1", 0.0, 0.1, &[8.0, 4.0, 0.0])]),
            joint("never moves", vec![trial("1", 0.0, 0.1, &[0.0; 3])]),
        ];
        let expected = [1.0 / 3.0, 0.5, 0.5 / 3.0];
        let found = &of_first(&joints, &[])[0];
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    }

    #[test]
    fn each_joint_is_late_by_its_own_delay() {
        let joints = [
            joint("a", vec![trial("1", 0.0, 0.1, &[0.0; 4])]),
            joint("b", vec![trial("1", 0.0, 0.1, &[2.0, -2.0, 0.0, 0.0])]),
        ];
        assert_eq!(of_first(&joints, &[0.2])[0], [0.0, 0.0, 1.0, 1.0]);
    }

    #[test]
    fn slower_samples_are_held_and_what_is_not_logged_is_at_rest() {
        let joints = [
            joint("a", vec![trial("1", 10.0, 0.1, &[0.0; 7]), trial("2", 0.0, 0.1, &[0.0; 2])]),
            joint("b", vec![trial("1", 10.1, 0.2, &[1.0, 2.0])]),
        ];
        let found = of_first(&joints, &[]);
        assert_eq!(found[0], [0.0, 0.5, 0.5, 1.0, 1.0, 0.0, 0.0]);
        assert_eq!(found[1], [0.0, 0.0]);
    }

    #[test]
    fn parts_of_a_split_trial_are_found_by_their_times() {
        let parts = vec![trial("1#1", 0.0, 0.1, &[1.0; 2]), trial("1#2", 0.4, 0.1, &[1.0; 2])];
        let joints = [joint("a", vec![trial("1", 0.0, 0.1, &[0.0; 6])]), joint("b", parts.clone())];
        assert_eq!(of_first(&joints, &[])[0], [1.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
        let joints = [joint("a", parts), joint("b", vec![trial("1", 0.0, 0.1, &[1.0; 6])])];
        assert_eq!(of_first(&joints, &[]), [[1.0; 2], [1.0; 2]]);
    }
}
