//! What became of an input step, with the evidence for it.

use std::fmt;

use super::condition::{Check, Condition, Outcome, nothing_happened};
use super::interval::FineDelay;
use super::onset_model::StepOnset;
use super::search::{Candidate, Candidates};
use super::segment::Segment;
use super::steps::InputStep;

use crate::units::signed;

/// The decision on one input step, with the evidence for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// `i`: number of the step in its trial, from 1.
    pub number: usize,
    /// `p_i` and the levels of the input.
    pub input_step: InputStep,
    /// Samples to the next step, or to the end of the trial.
    pub hold: usize,
    /// The samples that it was decided from.
    pub segment: Segment,
    /// Every pair of lines that was compared; none where the segment was too short, or the
    /// method compares none.
    pub candidates: Candidates,
    /// Every condition, in the order of [`Condition::ALL`].
    pub checks: [Check; Condition::ALL.len()],
    /// The delay between samples, where the method gives it.
    pub fine: Option<FineDelay>,
    /// The onset, where the method fits the joint's response.
    pub onset: Option<Box<StepOnset>>,
    /// What a reviewer said of it.
    pub reviewer_verdict: Option<Box<ReviewerVerdict>>,
}

/// What a reviewer says of a decision: it overrides the conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct ReviewerVerdict {
    /// Whether its delay counts.
    pub accepted: bool,
    /// The delay in samples, where the reviewer says it; else the method's own.
    pub delay: Option<f64>,
    /// Why.
    pub note: String,
    /// Who.
    pub reviewer: String,
}

/// The best breakpoint of a segment, accepted or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakpoint {
    /// The pair of lines.
    pub candidate: Candidate,
    /// `δ_i = q_i − p_i` in samples; negative when it comes before the input step.
    pub delay: i64,
}

/// What became of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Its delay counts.
    Accepted,
    /// It does not; the first condition that failed.
    Rejected(Condition),
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Accepted => f.write_str("accepted"),
            Self::Rejected(condition) => f.write_str(condition.id()),
        }
    }
}

impl Decision {
    /// The best breakpoint, if there was a candidate.
    pub fn breakpoint(&self) -> Option<Breakpoint> {
        let candidate = self.candidates.best()?;
        let delay = signed(candidate.breakpoint) - signed(self.input_step.sample);
        Some(Breakpoint { candidate, delay })
    }

    /// `p_(i+1)`: the sample of the next step, or the one after the trial's last.
    pub(crate) fn next_sample(&self) -> usize {
        self.input_step.sample + self.hold
    }

    /// What a reviewer said; where none did, [what the program says](Self::program_verdict).
    pub fn verdict(&self) -> Verdict {
        match &self.reviewer_verdict {
            Some(reviewer) if reviewer.accepted => Verdict::Accepted,
            Some(_) => Verdict::Rejected(Condition::Reviewer),
            None => self.program_verdict(),
        }
    }

    /// Accepted, or the first condition that failed, whatever a reviewer said.
    pub fn program_verdict(&self) -> Verdict {
        self.failed().next().map_or(Verdict::Accepted, Verdict::Rejected)
    }

    /// The checks of all conditions that failed.
    pub(crate) fn failed_checks(&self) -> impl Iterator<Item = Check> + '_ {
        self.checks.into_iter().filter(|check| check.outcome == Outcome::Failed)
    }

    /// All conditions that failed.
    pub fn failed(&self) -> impl Iterator<Item = Condition> + '_ {
        self.failed_checks().map(|check| check.condition)
    }

    /// Puts the result of a test against noise among the checks.
    pub(super) fn test_reaction(&mut self, p_value: Option<f64>, confidence: f64) {
        self.put(nothing_happened(p_value, confidence));
    }

    /// Puts that a condition failed among the checks, with the number that was compared and its limit.
    pub(super) fn fail(&mut self, condition: Condition, value: Option<f64>, limit: Option<f64>) {
        self.put(Check { condition, value, limit, outcome: Outcome::Failed });
    }

    /// Puts a check in the place of that of its condition.
    fn put(&mut self, found: Check) {
        let own = self.checks.iter_mut().filter(|check| check.condition == found.condition);
        own.for_each(|check| *check = found);
    }

    /// The delay in samples, if it was accepted.
    pub fn accepted_delay(&self) -> Option<f64> {
        let accepted = self.verdict() == Verdict::Accepted;
        self.delay().filter(|_| accepted)
    }

    /// The delay in samples, accepted or not: a reviewer's where one was said, else
    /// [the program's](Self::program_delay).
    pub fn delay(&self) -> Option<f64> {
        let said = self.reviewer_verdict.as_ref().and_then(|reviewer| reviewer.delay);
        said.or_else(|| self.program_delay())
    }

    /// The delay that the program found, in samples, where a reviewer says another one.
    #[expect(clippy::float_cmp, reason = "another number is another delay")]
    pub(crate) fn delay_before_review(&self) -> Option<f64> {
        let said = self.reviewer_verdict.as_ref().and_then(|reviewer| reviewer.delay)?;
        self.program_delay().filter(|found| *found != said)
    }

    /// The candidate that is shown: the best one, or the nearest one to where a reviewer put the
    /// breakpoint.
    pub(crate) fn shown_candidate(&self) -> Option<Candidate> {
        let best = self.candidates.best();
        if self.delay_before_review().is_none() {
            return best;
        }
        let q = self.input_step.sample as f64 + self.delay()?;
        let distance = |candidate: &Candidate| (candidate.breakpoint as f64 - q).abs();
        let nearest = self.candidates.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.or(best)
    }

    /// The delay in samples, accepted or not, as finely as the method gives it.
    pub fn program_delay(&self) -> Option<f64> {
        let fine = self.fine.map(|fine| fine.delay);
        fine.or_else(|| self.breakpoint().map(|best| best.delay as f64))
    }
}
