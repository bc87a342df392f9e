//! How much the other joints of a log do: what a shared pump feels.

use super::joint::Joint;
use super::trial::Trial;

/// Another joint of the log, and its delay in seconds: 0 where none is known.
#[derive(Clone, Copy, Debug)]
pub struct Other<'a> {
    /// The joint.
    pub joint: &'a Joint,
    /// Its delay.
    pub delay_s: f64,
}

/// The joints that share a supply, each with the largest magnitude of its input.
#[derive(Debug)]
pub struct Supply<'a>(Vec<(Other<'a>, f64)>);

impl<'a> Supply<'a> {
    /// All `joints` that share it.
    pub fn of(joints: impl IntoIterator<Item = Other<'a>>) -> Self {
        let most = |joint: &Joint| {
            let inputs = joint.trials.iter().flat_map(Trial::input);
            inputs.fold(0.0, |most: f64, input| most.max(input.abs()))
        };
        Self(joints.into_iter().map(|other| (other, most(other.joint))).collect())
    }

    /// The activity of all joints but the one with this index, for each of its trials a value per
    /// sample, from 0 (all at rest) to 1 (all driven as hard as ever in the log).
    ///
    /// It is the mean of `|u| / max|u|` over the other joints, where `u` is the input of a joint
    /// at that time, held between its samples and late by the joint's delay, and the maximum is
    /// over all its trials. Trials belong together by their labels, samples by their times. Where a
    /// joint was not logged it counts as at rest. Without other joints the lists are empty.
    pub fn beside(&self, index: usize) -> Vec<Vec<f64>> {
        let Some((own, _)) = self.0.get(index) else { return Vec::new() };
        let of_trial = |trial: &Trial| {
            let count = self.0.len() - 1;
            let mut sum = vec![0.0; if count > 0 { trial.len() } else { 0 }];
            let others = self.0.iter().enumerate().filter(|(other, _)| *other != index);
            for (_, (other, most)) in others.filter(|(_, (_, most))| *most > 0.0) {
                let parts = at_the_time_of(trial.label(), &other.joint.trials);
                for (sum, sample) in sum.iter_mut().zip(1..) {
                    let time_s = trial.logged_time_s(sample) - other.delay_s;
                    let input: f64 = parts.iter().map(|part| held(part, time_s).abs()).sum();
                    // Trials of one label may overlap; a joint draws no more than all it can.
                    *sum += (input / most).min(1.0) / count as f64;
                }
            }
            sum
        };
        own.joint.trials.iter().map(of_trial).collect()
    }
}

/// Those of `trials` that may run at the same time as one labelled `label`: those with this label; else the parts
/// of the same trial, which were split where one joint has a gap.
fn at_the_time_of<'a>(label: &str, trials: &'a [Trial]) -> Vec<&'a Trial> {
    let same: Vec<&Trial> = trials.iter().filter(|trial| trial.label() == label).collect();
    if !same.is_empty() {
        return same;
    }
    let whole = Trial::whole_label(label);
    trials.iter().filter(|trial| Trial::whole_label(trial.label()) == whole).collect()
}

/// The input of `trial` at a time, held from its last sample; zero before and after it.
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
        Joint { name: name.to_owned(), input_unit, output_unit, covariates, trials: trials.into() }
    }

    /// What the joints but the first do, with their delays.
    fn of_first(joints: &[Joint], delays_s: &[f64]) -> Vec<Vec<f64>> {
        let delays_s = [0.0].iter().chain(delays_s).copied().chain(std::iter::repeat(0.0));
        Supply::of(joints.iter().zip(delays_s).map(|(joint, delay_s)| Other { joint, delay_s }))
            .beside(0)
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

    #[test]
    fn what_many_do_is_what_each_does_added_up() {
        let input = |joint: usize| (0..6).map(|k| ((k * joint) % 5) as f64 - 2.0).collect();
        let inputs: Vec<Vec<f64>> = (1..40).map(input).collect();
        let of = |(index, input): (usize, &Vec<f64>)| {
            joint(&index.to_string(), vec![trial("1", 0.0, 0.1, input)])
        };
        let joints: Vec<Joint> = inputs.iter().enumerate().map(of).collect();
        let supply = Supply::of(joints.iter().map(|joint| Other { joint, delay_s: 0.0 }));
        let most = |input: &[f64]| input.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        for index in 0..joints.len() {
            let others = || inputs.iter().enumerate().filter(|(other, _)| *other != index);
            let found = &supply.beside(index)[0];
            for (sample, found) in found.iter().enumerate() {
                let each = others().map(|(_, input)| input[sample].abs() / most(input));
                let expected = each.sum::<f64>() / others().count() as f64;
                assert!((found - expected).abs() < 1e-15, "{found} and {expected}");
            }
        }
    }

    #[test]
    fn nothing_is_left_of_a_joint_where_the_others_are_at_rest() {
        let input = [0.1, 0.7, 0.3];
        let mut joints = vec![joint("a", vec![trial("1", 0.0, 0.1, &input)])];
        joints.extend(["b", "c"].map(|name| joint(name, vec![trial("1", 0.0, 0.1, &[0.0; 3])])));
        assert_eq!(of_first(&joints, &[]), [[0.0; 3]]);
    }
}
