//! A step among all of its trial, and the decision that follows from what was found there.

use crate::delay::condition::Facts;
use crate::delay::decision::Decision;
use crate::delay::interval::FineDelay;
use crate::delay::search::Candidates;
use crate::delay::segment::Segment;
use crate::delay::settings::Settings;
use crate::delay::steps::InputStep;

/// A step among all of its trial.
pub(super) struct StepContext<'a> {
    pub(super) steps: &'a [InputStep],
    pub(super) index: usize,
    pub(super) output: &'a [f64],
    pub(super) settings: &'a Settings,
}

impl StepContext<'_> {
    pub(super) fn step(&self) -> InputStep {
        self.steps[self.index]
    }

    /// `p_(i+1)`: the sample of the next step, or the one behind the trial's last.
    pub(super) fn next_sample(&self) -> usize {
        self.steps.get(self.index + 1).map_or(self.output.len() + 1, |next| next.sample)
    }

    /// The decision that follows from what was found in a segment, in rows of so many samples.
    pub(super) fn decision(
        &self,
        segment: Segment,
        row_length: usize,
        candidates: Candidates,
        fine: Option<FineDelay>,
    ) -> Decision {
        let (number, input_step) = (self.index + 1, self.step());
        let hold = self.next_sample() - input_step.sample;
        let facts = Facts {
            step: number,
            steps: self.steps.len(),
            input_sample: input_step.sample,
            hold,
            output: &self.output[segment.indices()],
            rows: segment.len() / row_length,
            best: candidates.best(),
            fine,
        };
        let checks = facts.check(self.settings);
        Decision { number, input_step, hold, segment, candidates, checks, fine }
    }
}
