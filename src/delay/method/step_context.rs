//! A step among all of its trial, and the decision that follows from what was found there.

use crate::delay::condition::{Check, Condition, Outcome};
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

    /// `p_(i+1)`: the sample of the next step, or the one after the trial's last.
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
        let input_step = self.step();
        let unchecked =
            |condition| Check { condition, value: None, limit: None, outcome: Outcome::NotChecked };
        let mut decision = Decision {
            number: self.index + 1,
            input_step,
            hold: self.next_sample() - input_step.sample,
            segment,
            candidates,
            checks: Condition::ALL.map(unchecked),
            fine,
            onset: None,
            reviewer_verdict: None,
        };
        // None of the conditions depends on another.
        decision.checks = Condition::ALL.map(|condition| {
            let (value, limit, outcome) = self.compared(condition, &decision);
            Check { condition, value, limit, outcome }
        });
        decision
    }

    /// What a condition compares, and how it comes out; numbers in brackets are the paper's.
    fn compared(&self, condition: Condition, decision: &Decision) -> Compared {
        let settings = self.settings;
        let best = decision.candidates.best();
        let met = |value: Option<f64>, is_met: &dyn Fn(f64) -> bool| {
            value.map_or(Outcome::NotChecked, |value| Outcome::from(is_met(value)))
        };
        match condition {
            Condition::FirstOrLast => self.first_or_last(),
            Condition::OutputLimit => self.output_limit(decision.segment),
            // (3) q_i < p_i. An interval counts as before the input when all of it is.
            Condition::BeforeInput => {
                let limit = decision.input_step.sample as f64;
                let coarse = best.map(|best| best.breakpoint as f64);
                let value = decision.fine.map_or(coarse, |fine| Some(limit + fine.high));
                (value, Some(limit), met(value, &|q| q >= limit))
            }
            // (4) |slope after − slope before| below the limit.
            Condition::SlopeChange => {
                let limit = settings.min_slope_change;
                let value = best.map(|best| best.slope_change().abs());
                (value, Some(limit), met(value, &|change| change >= limit))
            }
            // (5) p_(i+1) − p_i < τ_min.
            Condition::ShortHold => {
                let outcome = Outcome::from(decision.hold >= settings.min_delay);
                (Some(decision.hold as f64), Some(settings.min_delay as f64), outcome)
            }
            // (6) Not SSE < limit.
            Condition::Sse => {
                let (value, limit) = (best.map(|best| best.sse), settings.max_sse);
                (value, limit, met(value.filter(|_| limit.is_some()), &|sse| limit > Some(sse)))
            }
            // M_i < 2: no pair of lines.
            Condition::TooShort => {
                let rows = decision.segment.len() / settings.beta.max(1);
                let outcome = Outcome::from(best.is_some() || decision.fine.is_some());
                (Some(rows as f64), Some(2.0), outcome)
            }
            // The joint rested when the input changed, and moves no further than one at rest does.
            Condition::AtRest => {
                let rest = self.motion().and_then(|motion| motion.rest);
                let outcome = rest.map_or(Outcome::NotChecked, |rest| (!rest.lasts()).into());
                (rest.map(|rest| rest.moved), rest.map(|rest| rest.limit), outcome)
            }
            Condition::NothingHappened | Condition::Reviewer => (None, None, Outcome::NotChecked),
        }
    }

    /// (1) `i = 1` or the last.
    fn first_or_last(&self) -> Compared {
        let (number, steps) = (self.index + 1, self.trial.steps.len());
        let outcome = if self.settings.first_last.are_judged(steps) {
            Outcome::NotChecked
        } else {
            Outcome::from(number != 1 && number != steps)
        };
        (Some(number as f64), Some(steps as f64), outcome)
    }

    /// (2) Any sample at a limit or beyond; the value is the sample that is farthest out of,
    /// or nearest to, the limits.
    fn output_limit(&self, segment: Segment) -> Compared {
        let Some((low, high)) = self.settings.output_limits else {
            return (None, None, Outcome::NotChecked);
        };
        // Not the rest that the joint starts from, which may be at a stop; what comes after the
        // departure is the reaction.
        let rest = self.motion().filter(|motion| motion.rest.is_some());
        let resting = rest.map_or(0, |motion| (motion.latest + 1).saturating_sub(segment.first));
        let output = self.output()[segment.indices()].get(resting..).unwrap_or_default();
        let room = |y: f64| (high - y).min(y - low);
        let extreme = output.iter().copied().min_by(|a, b| room(*a).total_cmp(&room(*b)));
        let limit = extreme.map(|y| if high - y <= y - low { high } else { low });
        (extreme, limit, Outcome::from(output.iter().all(|&y| y < high && y > low)))
    }
}

/// The value of a step, the limit, and how a condition came out.
type Compared = (Option<f64>, Option<f64>, Outcome);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::Method;
    use crate::experiment::Trial;
    use crate::units::SamplePeriod;

    #[test]
    fn a_delay_needs_no_candidate() {
        let input = (0..300).map(|k| f64::from(k / 75)).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, input, vec![0.0; 300]).unwrap();
        let settings = Settings { low_pass: None, paper: true, ..Settings::of(Method::TWO_LINE) };
        let trial = Prepared::of(&trial, &settings).unwrap();
        let context = StepContext { trial: &trial, index: 1, settings: &settings };
        let failed = |fine| {
            let segment = Segment { first: 140, last: 200 };
            let decision = context.decision(segment, Candidates::default(), fine);
            decision.failed().collect::<Vec<_>>()
        };
        let fine = FineDelay { delay: 12.0, low: 11.0, high: 13.0, confidence: 0.95 };
        assert_eq!(failed(Some(fine)), []);
        assert_eq!(failed(None), [Condition::TooShort]);
        let early = FineDelay { delay: -2.0, low: -3.0, high: -1.0, ..fine };
        assert_eq!(failed(Some(early)), [Condition::BeforeInput]);
    }
}
