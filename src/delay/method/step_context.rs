//! A step among all of its trial, and the decision that follows from what was found there.

use crate::delay::condition::Facts;
use crate::delay::decision::Decision;
use crate::delay::interval::FineDelay;
use crate::delay::motion::{DEPARTED, StepMotion};
use crate::delay::onset_model::{FromRest, gradual_onset};
use crate::delay::prepared::Prepared;
use crate::delay::search::Candidates;
use crate::delay::segment::Segment;
use crate::delay::settings::Settings;
use crate::delay::steps::InputStep;
use crate::units::ceil_to_index;

/// Seconds before a step over which its rest is looked at, and samples, at least.
const REST_S: f64 = 0.5;
const FEWEST_AT_REST: usize = 30;

/// A step among all of its trial.
pub(super) struct StepContext<'a> {
    pub(super) trial: &'a Prepared<'a>,
    pub(super) index: usize,
    pub(super) settings: &'a Settings,
}

impl StepContext<'_> {
    /// What the method looks at.
    pub(super) fn output(&self) -> &[f64] {
        self.trial.output()
    }

    pub(super) fn step(&self) -> InputStep {
        self.trial.steps[self.index]
    }

    /// What the output does about the step, where rest or a stop is shown.
    pub(super) fn motion(&self) -> Option<StepMotion> {
        self.trial.motions.get(self.index)?.as_deref().copied()
    }

    /// The p-value of a departure from rest, where the joint departed: the noise of its rest
    /// is known from there, while lines that do not fit make any noise look large.
    pub(super) fn departed(&self) -> Option<f64> {
        self.motion().filter(StepMotion::departs).map(|_| DEPARTED)
    }

    /// The delay of a joint that rested and departed, by the speed that it gathers.
    pub(super) fn gradual(&self) -> Option<FineDelay> {
        let motion = self.motion().filter(StepMotion::departs)?;
        let step = self.step().sample - 1;
        let before = self.index.checked_sub(1).and_then(|before| self.trial.steps.get(before));
        let since = before.map_or(0, |before| before.sample - 1);
        let rest = ceil_to_index(REST_S / self.trial.period.seconds()).max(FEWEST_AT_REST);
        let start = step.saturating_sub(rest).max(since);
        let earliest = step.saturating_sub(self.settings.alpha).max(start);
        let from = FromRest {
            rest: step - start,
            positions: earliest - start..motion.latest + 1 - start,
            departed: motion.latest - start,
        };
        let values = self.output().get(start..self.next_sample() - 1)?;
        gradual_onset(values, &from, self.settings.interval)
    }

    /// `p_(i+1)`: the sample of the next step, or the one behind the trial's last.
    pub(super) fn next_sample(&self) -> usize {
        self.trial.steps.get(self.index + 1).map_or(self.output().len() + 1, |next| next.sample)
    }

    /// The decision that follows from what was found in a segment.
    pub(super) fn decision(
        &self,
        segment: Segment,
        candidates: Candidates,
        fine: Option<FineDelay>,
    ) -> Decision {
        let (number, input_step) = (self.index + 1, self.step());
        let hold = self.next_sample() - input_step.sample;
        let facts = Facts {
            step: number,
            steps: self.trial.steps.len(),
            input_sample: input_step.sample,
            hold,
            output: &self.output()[segment.indices()],
            first: segment.first,
            motion: self.motion(),
            rows: segment.len() / self.settings.beta,
            best: candidates.best(),
            fine,
        };
        Decision {
            number,
            input_step,
            hold,
            segment,
            candidates,
            checks: facts.check(self.settings),
            fine,
            onset: None,
            reviewer_verdict: None,
        }
    }
}
