//! Decisions beside those of another result: which steps are the same, and where they differ.

use super::estimate::JointEstimate;
use std::collections::BTreeSet;

use crate::delay::{Condition, Decision, EstimateError, Verdict};
use crate::experiment::{Joint, Trial};
use crate::numerics::{Line, median};

/// What was decided on a step, as far as results are compared.
#[derive(Clone, Debug, PartialEq)]
pub struct StepResult {
    /// Label of the trial.
    pub trial: String,
    /// `i`: number of the step in its trial, from 1.
    pub i: usize,
    /// `p`: sample of the input step, from 1.
    pub p: usize,
    /// First and last sample of the segment.
    pub segment: (usize, usize),
    /// What became of it.
    pub verdict: Verdict,
    /// The delay in samples, accepted or not.
    pub delay: Option<f64>,
    /// The delay in seconds, accepted or not.
    pub delay_s: Option<f64>,
    /// Ends of the delay's interval in samples, where the method gives one.
    pub interval: Option<(f64, f64)>,
    /// The chosen lines before and after the breakpoint.
    pub lines: Option<[Line; 2]>,
}

impl StepResult {
    /// What was decided on a step of `trial`.
    pub(crate) fn of(trial: &Trial, decision: &Decision) -> Self {
        let best = decision.candidates.best();
        let delay = decision.delay();
        Self {
            trial: trial.label().to_owned(),
            i: decision.number,
            p: decision.input_step.sample,
            segment: (decision.segment.first, decision.segment.last),
            verdict: decision.verdict(),
            delay,
            delay_s: delay.map(|delay| delay * trial.period().seconds()),
            interval: decision.fine.map(|fine| (fine.low, fine.high)),
            lines: best.map(|best| [best.before, best.after]),
        }
    }

    /// Whether its delay counts.
    pub(crate) fn is_accepted(&self) -> bool {
        self.verdict == Verdict::Accepted
    }
}

/// The decisions on one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct JointResult {
    /// Name of the joint.
    pub joint: String,
    /// Its steps, trial by trial.
    pub steps: Vec<StepResult>,
}

impl JointResult {
    /// The decisions of `estimate`, which is that of `joint`.
    pub fn of(joint: &Joint, estimate: &JointEstimate) -> Self {
        let trials = joint.trials.iter().zip(&estimate.trials);
        let found = trials.filter_map(|(trial, found)| Some((trial, found.as_ref().ok()?)));
        let steps = found.flat_map(|(trial, found)| {
            found.decisions.iter().map(move |decision| StepResult::of(trial, decision))
        });
        Self { joint: joint.name.clone(), steps: steps.collect() }
    }
}

/// What another run decided: by another method, with other settings, or on another log.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherResult {
    /// What it is called: the method, or the name of its file.
    pub name: String,
    /// What it was made with, where that is known.
    pub settings: Option<String>,
    /// Its joints.
    pub joints: Vec<JointResult>,
}

impl OtherResult {
    /// What came out of `joints`: one result each, in their order.
    pub fn of(
        name: String,
        settings: String,
        joints: &[Joint],
        estimates: &[Result<JointEstimate, EstimateError>],
    ) -> Self {
        let found = joints.iter().zip(estimates);
        let joints =
            found.filter_map(|(joint, found)| Some(JointResult::of(joint, found.as_ref().ok()?)));
        Self { name, settings: Some(settings), joints: joints.collect() }
    }

    /// The joint of this name.
    pub fn joint(&self, name: &str) -> Option<&JointResult> {
        self.joints.iter().find(|joint| joint.joint == name)
    }
}

/// A step that both results have.
#[derive(Clone, Debug, PartialEq)]
pub struct StepPair {
    /// What was decided here.
    pub here: StepResult,
    /// What the other result says.
    pub there: StepResult,
}

/// How the verdicts of two results on a step go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdicts {
    /// Both accept it.
    BothAccepted,
    /// This result accepts it, the other rejects it.
    OnlyHere,
    /// The other result accepts it, this one rejects it.
    OnlyThere,
    /// Both reject it.
    BothRejected,
}

impl StepPair {
    /// Below it two delays are equal, seconds: files have nanoseconds.
    const EQUAL_S: f64 = 2e-9;

    /// How the verdicts go together.
    pub fn verdicts(&self) -> Verdicts {
        match (self.here.is_accepted(), self.there.is_accepted()) {
            (true, true) => Verdicts::BothAccepted,
            (true, false) => Verdicts::OnlyHere,
            (false, true) => Verdicts::OnlyThere,
            (false, false) => Verdicts::BothRejected,
        }
    }

    /// The delay here less the delay there, seconds, where both have one.
    pub fn difference_s(&self) -> Option<f64> {
        Some(self.here.delay_s? - self.there.delay_s?)
    }

    /// Whether the verdict or an accepted delay differs.
    pub fn differs(&self) -> bool {
        match self.verdicts() {
            Verdicts::BothRejected => false,
            Verdicts::OnlyHere | Verdicts::OnlyThere => true,
            Verdicts::BothAccepted => self.size_s() > Self::EQUAL_S,
        }
    }

    /// How far both delays are apart, seconds; 0 where one is missing.
    pub(crate) fn size_s(&self) -> f64 {
        self.difference_s().map_or(0.0, f64::abs)
    }

    /// Whether one accepts what the other rejects, then how far the delays are apart: the
    /// larger, the more the decisions differ.
    pub fn weight(&self) -> (u8, f64) {
        match self.verdicts() {
            Verdicts::OnlyHere | Verdicts::OnlyThere => (2, self.size_s()),
            Verdicts::BothAccepted if self.differs() => (1, self.size_s()),
            Verdicts::BothAccepted | Verdicts::BothRejected => (0, 0.0),
        }
    }
}

/// The decisions on a joint beside those of another result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointDifferences {
    /// Steps of both, the most different first: other verdicts before other delays.
    pub pairs: Vec<StepPair>,
    /// Steps that the other result does not have.
    pub only_here: Vec<StepResult>,
    /// Steps that this result does not have.
    pub only_there: Vec<StepResult>,
    /// Trials in which steps are matched by their number, since they lie at other samples.
    pub by_number: Vec<String>,
}

impl JointDifferences {
    /// Compares a joint with what another result says of it.
    ///
    /// Steps are the same that lie at the same sample of the same trial. Where fewer than half
    /// of a trial's do, as in another log of the experiment, those of the same number are. A
    /// trial is known by its label, or by being the only one.
    pub fn of(here: &JointResult, there: Option<&JointResult>) -> Self {
        let there = there.map_or(&[][..], |joint| &joint.steps);
        let (own, others) = (trials_of(&here.steps), trials_of(there));
        let mut found = Self::default();
        for trial in &own {
            let is_only = own.len() == 1 && others.len() == 1;
            let other = others.iter().find(|other| is_only || **other == *trial);
            let of_trial = |steps: &[StepResult], label: &str| {
                let own = steps.iter().filter(|step| step.trial == label);
                own.cloned().collect::<Vec<_>>()
            };
            let other = other.map_or_else(Vec::new, |label| of_trial(there, label));
            found.add_trial(trial, of_trial(&here.steps, trial), other);
        }
        let is_known = |label: &str| own.len() == 1 && others.len() == 1 || own.contains(&label);
        let strange = there.iter().filter(|step| !is_known(&step.trial));
        found.only_there.extend(strange.cloned());
        found.pairs.sort_by(|a, b| {
            let ((kind_a, size_a), (kind_b, size_b)) = (a.weight(), b.weight());
            kind_b.cmp(&kind_a).then(size_b.total_cmp(&size_a))
        });
        found
    }

    fn add_trial(&mut self, label: &str, here: Vec<StepResult>, mut there: Vec<StepResult>) {
        let same_sample = |step: &StepResult| there.iter().any(|other| other.p == step.p);
        let same = here.iter().filter(|step| same_sample(step)).count();
        let by_sample = 2 * same >= here.len().min(there.len());
        if !by_sample {
            self.by_number.push(label.to_owned());
        }
        for step in here {
            let is_same = |other: &StepResult| {
                if by_sample { other.p == step.p } else { other.i == step.i }
            };
            match there.iter().position(is_same) {
                Some(place) => {
                    let there = there.remove(place);
                    self.pairs.push(StepPair { here: step, there });
                }
                None => self.only_here.push(step),
            }
        }
        self.only_there.extend(there);
    }

    /// How many trials the pairs are of.
    pub fn trials(&self) -> usize {
        let labels: BTreeSet<&str> = self.pairs.iter().map(|p| p.here.trial.as_str()).collect();
        labels.len()
    }

    /// How many pairs have such verdicts.
    pub fn count(&self, verdicts: Verdicts) -> usize {
        self.pairs.iter().filter(|pair| pair.verdicts() == verdicts).count()
    }

    /// The steps on which the results differ, the most different first.
    pub(crate) fn differing(&self) -> impl Iterator<Item = &StepPair> {
        self.pairs.iter().filter(|pair| pair.differs())
    }

    /// Of the steps that both accept: how many have another delay.
    pub fn moved(&self) -> usize {
        self.differing().filter(|pair| pair.verdicts() == Verdicts::BothAccepted).count()
    }

    /// Median distance of the delays of the steps that both accept, seconds.
    pub fn median_s(&self) -> Option<f64> {
        median(&self.sizes_s())
    }

    /// The largest of these distances, seconds.
    pub(crate) fn largest_s(&self) -> Option<f64> {
        self.sizes_s().into_iter().max_by(f64::total_cmp)
    }

    fn sizes_s(&self) -> Vec<f64> {
        let both = self.pairs.iter().filter(|pair| pair.verdicts() == Verdicts::BothAccepted);
        both.map(StepPair::size_s).collect()
    }

    /// The pair of the step at sample `p` of the trial `label`.
    pub fn pair(&self, label: &str, p: usize) -> Option<&StepPair> {
        self.pairs.iter().find(|pair| pair.here.p == p && pair.here.trial == label)
    }
}

/// The labels of the trials in their order.
fn trials_of(steps: &[StepResult]) -> Vec<&str> {
    let mut labels: Vec<&str> = Vec::new();
    for step in steps {
        if !labels.contains(&step.trial.as_str()) {
            labels.push(&step.trial);
        }
    }
    labels
}

/// The verdict that files call `id`.
pub(super) fn verdict_of(id: &str) -> Option<Verdict> {
    let conditions = Condition::ALL.into_iter().chain([Condition::Reviewer]);
    let rejected = conditions.map(|condition| (condition.id(), Verdict::Rejected(condition)));
    let all = std::iter::once(("accepted", Verdict::Accepted)).chain(rejected);
    all.into_iter().find(|(known, _)| *known == id).map(|(_, verdict)| verdict)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step with this delay in samples of 0.01 s; accepted unless it is said otherwise.
    fn step(trial: &str, i: usize, p: usize, delay: f64, verdict: &str) -> StepResult {
        StepResult {
            trial: trial.to_owned(),
            i,
            p,
            segment: (p - 5, p + 50),
            verdict: verdict_of(verdict).unwrap(),
            delay: Some(delay),
            delay_s: Some(delay * 0.01),
            interval: None,
            lines: None,
        }
    }

    fn joint(steps: Vec<StepResult>) -> JointResult {
        JointResult { joint: "boom".to_owned(), steps }
    }

    fn numbers(steps: &[StepResult]) -> Vec<usize> {
        steps.iter().map(|step| step.i).collect()
    }

    #[test]
    fn other_verdicts_come_first_then_other_delays_by_size() {
        let here = joint(vec![
            step("1", 1, 100, 10.0, "accepted"),
            step("1", 2, 200, 10.0, "accepted"),
            step("1", 3, 300, 10.0, "accepted"),
            step("1", 4, 400, 10.0, "sse"),
            step("1", 5, 500, 10.0, "sse"),
        ]);
        let there = joint(vec![
            step("1", 1, 100, 10.0, "accepted"),
            step("1", 2, 200, 12.0, "accepted"),
            step("1", 3, 300, 19.0, "accepted"),
            step("1", 4, 400, 11.0, "accepted"),
            step("1", 5, 500, 40.0, "first_or_last"),
        ]);
        let found = JointDifferences::of(&here, Some(&there));
        let order: Vec<usize> = found.differing().map(|pair| pair.here.i).collect();
        assert_eq!(order, [4, 3, 2]);
        assert_eq!(found.count(Verdicts::OnlyThere), 1);
        assert_eq!(found.count(Verdicts::BothRejected), 1);
        assert_eq!(found.moved(), 2);
        assert!((found.median_s().unwrap() - 0.02).abs() < 1e-12);
        assert!((found.largest_s().unwrap() - 0.09).abs() < 1e-12);
        assert!(found.by_number.is_empty());
    }

    #[test]
    fn steps_at_other_samples_are_matched_by_number_and_what_is_over_is_named() {
        let here = joint(vec![
            step("1", 1, 100, 10.0, "accepted"),
            step("1", 2, 200, 10.0, "accepted"),
            step("1", 3, 300, 10.0, "accepted"),
        ]);
        let there =
            joint(vec![step("b", 1, 107, 10.0, "accepted"), step("b", 2, 207, 10.0, "accepted")]);
        let found = JointDifferences::of(&here, Some(&there));
        assert_eq!(found.by_number, ["1"]);
        assert_eq!((found.pairs.len(), numbers(&found.only_here)), (2, vec![3]));
        // One step more at the same samples shifts the numbers, not the pairs.
        let there = joint(vec![
            step("1", 1, 50, 10.0, "accepted"),
            step("1", 2, 100, 10.0, "accepted"),
            step("1", 3, 200, 10.0, "accepted"),
        ]);
        let found = JointDifferences::of(&here, Some(&there));
        assert!(found.by_number.is_empty());
        assert_eq!(numbers(&found.only_here), [3]);
        assert_eq!(numbers(&found.only_there), [1]);
    }

    #[test]
    fn a_trial_or_a_joint_that_is_missing_leaves_its_steps_over() {
        let here = joint(vec![step("1", 1, 100, 1.0, "sse"), step("2", 1, 100, 1.0, "sse")]);
        let there = joint(vec![step("2", 1, 100, 1.0, "sse"), step("3", 1, 100, 1.0, "sse")]);
        let found = JointDifferences::of(&here, Some(&there));
        assert_eq!((found.pairs.len(), found.only_here.len(), found.only_there.len()), (1, 1, 1));
        assert_eq!(found.only_there[0].trial, "3");
        assert_eq!(JointDifferences::of(&here, None).only_here.len(), 2);
    }
}
