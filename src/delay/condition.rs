//! The conditions a breakpoint must meet, each with the numbers that were compared.

use std::fmt;

use super::interval::FineDelay;
use super::motion::StepMotion;
use super::search::Candidate;
use super::settings::Settings;

/// What a decision may fail, in the paper's order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Condition {
    /// (1) The first and the last step of a trial have no neighbour to judge them by.
    FirstOrLast,
    /// (2) The output touches a limit in the segment.
    OutputLimit,
    /// (3) The breakpoint comes before the input step: `q < p`.
    BeforeInput,
    /// (4) The slope changes by less than the limit.
    SlopeChange,
    /// (5) The input is held for less than `τ_min`.
    ShortHold,
    /// (6) The squared error is not below the limit.
    Sse,
    /// There are fewer than two rows of β samples, so no candidate, nor a delay without one.
    TooShort,
    /// The joint stood still, or at its stop, when the input changed, and went on doing so.
    AtRest,
    /// The slope changes no more than noise makes it.
    NothingHappened,
    /// A reviewer rejected the step: no condition of the program's, and never checked.
    Reviewer,
}

impl Condition {
    /// All conditions that are checked, in the order they are reported.
    pub const ALL: [Self; 9] = [
        Self::FirstOrLast,
        Self::OutputLimit,
        Self::BeforeInput,
        Self::SlopeChange,
        Self::ShortHold,
        Self::Sse,
        Self::TooShort,
        Self::AtRest,
        Self::NothingHappened,
    ];

    /// Its name in files and tables.
    pub fn id(self) -> &'static str {
        match self {
            Self::FirstOrLast => "first_or_last",
            Self::OutputLimit => "output_limit",
            Self::BeforeInput => "before_input",
            Self::SlopeChange => "slope_change",
            Self::ShortHold => "short_hold",
            Self::Sse => "sse",
            Self::TooShort => "too_short",
            Self::AtRest => "at_rest",
            Self::NothingHappened => "nothing_happened",
            Self::Reviewer => "reviewer",
        }
    }

    /// What is wrong when it fails, in words.
    pub(crate) fn meaning(self) -> &'static str {
        match self {
            Self::FirstOrLast => "first or last step of the trial",
            Self::OutputLimit => "output touches a limit",
            Self::BeforeInput => "breakpoint before the input step",
            Self::SlopeChange => "slope changes too little",
            Self::ShortHold => "input held too short",
            Self::Sse => "lines fit too badly",
            Self::TooShort => "segment too short for two lines",
            Self::AtRest => "joint at rest, before and after",
            Self::NothingHappened => "no reaction beyond the noise",
            Self::Reviewer => "rejected by a reviewer",
        }
    }
}

impl Condition {
    /// What is so where it is met, in few words.
    #[cfg(feature = "rrd")]
    pub(crate) fn when_met(self) -> &'static str {
        match self {
            Self::FirstOrLast => "not first or last",
            Self::OutputLimit => "output in its limits",
            Self::BeforeInput => "break after step",
            Self::SlopeChange => "slope changes",
            Self::ShortHold => "next step far off",
            Self::Sse => "lines fit",
            Self::TooShort => "room for two lines",
            Self::AtRest => "joint moves",
            Self::NothingHappened => "more than noise",
            Self::Reviewer => "no reviewer's word",
        }
    }
}

impl Condition {
    /// What it asks for, in a sentence without its end.
    pub fn asks(self) -> &'static str {
        match self {
            Self::FirstOrLast => "there is a step before it and one behind it in the trial",
            Self::OutputLimit => "no sample of the segment touches a limit of the output",
            Self::BeforeInput => "the breakpoint q is not before the input step p",
            Self::SlopeChange => {
                "the slopes of the lines before and after q differ by no less than the limit"
            }
            Self::ShortHold => {
                "the input keeps its new level, until the next step, for no fewer samples than the \
                 limit"
            }
            Self::Sse => "the squared errors of both lines add up to less than the limit",
            Self::TooShort => "the segment has two rows of β samples, one for each line",
            Self::AtRest => {
                "the joint moves, and does not stand still or at its stop before and after the step"
            }
            Self::NothingHappened => {
                "the slope changes more than noise makes it: the p-value is not above the limit"
            }
            Self::Reviewer => "no person rejected the step",
        }
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

/// How a condition came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Met.
    Passed,
    /// Not met.
    Failed,
    /// No limit is set, or there is no candidate to compare with it.
    NotChecked,
}

/// A condition, the number it looked at, and the limit that it was compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Check {
    /// Which one.
    pub condition: Condition,
    /// The number of this step, where there is one.
    pub value: Option<f64>,
    /// The limit, where one is set.
    pub limit: Option<f64>,
    /// How it came out.
    pub outcome: Outcome,
}

/// What the conditions of Algorithm 1 look at; numbers in brackets are the paper's.
pub(super) struct Facts<'a> {
    pub(super) step: usize,
    pub(super) steps: usize,
    pub(super) input_sample: usize,
    /// Samples to the next step, or to the end of the trial.
    pub(super) hold: usize,
    /// Output over the segment, whose first sample has the number `first`.
    pub(super) output: &'a [f64],
    pub(super) first: usize,
    /// What the output does about the step, where rest or a stop is shown.
    pub(super) motion: Option<StepMotion>,
    /// Whole rows of β samples in the segment.
    pub(super) rows: usize,
    /// The best candidate, where the method compares any.
    pub(super) best: Option<Candidate>,
    /// The delay between samples, where the method gives it.
    pub(super) fine: Option<FineDelay>,
}

impl Facts<'_> {
    /// All conditions, in the order of [`Condition::ALL`]; none of them depends on another.
    pub(super) fn check(&self, settings: &Settings) -> [Check; Condition::ALL.len()] {
        [
            self.first_or_last(settings),
            self.output_limit(settings),
            self.before_input(),
            self.slope_change(settings),
            self.short_hold(settings),
            self.sse(settings),
            self.too_short(),
            self.at_rest(),
            check(Condition::NothingHappened, None, None, Outcome::NotChecked),
        ]
    }

    /// (1) `i = 1` or the last.
    fn first_or_last(&self, settings: &Settings) -> Check {
        let at_an_end = self.step == 1 || self.step == self.steps;
        let outcome = match (settings.first_last.are_judged(self.steps), at_an_end) {
            (true, _) => Outcome::NotChecked,
            (false, true) => Outcome::Failed,
            (false, false) => Outcome::Passed,
        };
        check(Condition::FirstOrLast, Some(self.step as f64), Some(self.steps as f64), outcome)
    }

    /// (2) Any sample at a limit or beyond; the value is the sample that is farthest out of,
    /// or nearest to, the limits.
    fn output_limit(&self, settings: &Settings) -> Check {
        let Some((low, high)) = settings.output_limits else {
            return check(Condition::OutputLimit, None, None, Outcome::NotChecked);
        };
        let room = |y: f64| (high - y).min(y - low);
        let output = self.in_motion();
        let extreme = output.iter().copied().min_by(|a, b| room(*a).total_cmp(&room(*b)));
        let limit = extreme.map(|y| if high - y <= y - low { high } else { low });
        let inside = output.iter().all(|&y| y < high && y > low);
        check(Condition::OutputLimit, extreme, limit, Outcome::from(inside))
    }

    /// The output over the segment without the rest that the joint starts from, which may be
    /// at a stop.
    fn in_motion(&self) -> &[f64] {
        let rest = self.motion.filter(|motion| motion.rest.is_some());
        // Up to the departure; what comes behind it is the reaction.
        let resting = rest.map_or(0, |motion| (motion.latest + 1).saturating_sub(self.first));
        self.output.get(resting..).unwrap_or_default()
    }

    /// (3) `q_i < p_i`.
    fn before_input(&self) -> Check {
        let limit = self.input_sample as f64;
        let coarse = self.best.map(|best| best.breakpoint as f64);
        // An interval counts as before the input when all of it is.
        let value = self.fine.map_or(coarse, |fine| Some(limit + fine.high));
        let outcome = value.map_or(Outcome::NotChecked, |q| Outcome::from(q >= limit));
        check(Condition::BeforeInput, value, Some(limit), outcome)
    }

    /// (4) `|slope after − slope before|` below the limit.
    fn slope_change(&self, settings: &Settings) -> Check {
        let limit = settings.min_slope_change;
        let value = self.best.map(|best| best.slope_change().abs());
        let outcome = value.map_or(Outcome::NotChecked, |change| Outcome::from(change >= limit));
        check(Condition::SlopeChange, value, Some(limit), outcome)
    }

    /// (5) `p_(i+1) − p_i < τ_min`.
    fn short_hold(&self, settings: &Settings) -> Check {
        let outcome = Outcome::from(self.hold >= settings.min_delay);
        let limit = Some(settings.min_delay as f64);
        check(Condition::ShortHold, Some(self.hold as f64), limit, outcome)
    }

    /// (6) Not `SSE < limit`.
    fn sse(&self, settings: &Settings) -> Check {
        let value = self.best.map(|best| best.sse);
        let outcome = match (value, settings.max_sse) {
            (Some(sse), Some(limit)) => Outcome::from(sse < limit),
            _ => Outcome::NotChecked,
        };
        check(Condition::Sse, value, settings.max_sse, outcome)
    }

    /// `M_i < 2`: no pair of lines.
    fn too_short(&self) -> Check {
        let outcome = Outcome::from(self.best.is_some() || self.fine.is_some());
        check(Condition::TooShort, Some(self.rows as f64), Some(2.0), outcome)
    }

    /// The joint rested when the input changed, and moves no further than one at rest does.
    fn at_rest(&self) -> Check {
        let rest = self.motion.and_then(|motion| motion.rest);
        let outcome = rest.map_or(Outcome::NotChecked, |rest| Outcome::from(!rest.lasts()));
        let (moved, limit) = (rest.map(|rest| rest.moved), rest.map(|rest| rest.limit));
        check(Condition::AtRest, moved, limit, outcome)
    }
}

fn check(condition: Condition, value: Option<f64>, limit: Option<f64>, outcome: Outcome) -> Check {
    Check { condition, value, limit, outcome }
}

/// The change of slope against noise; the value is the p-value of a reaction, none where
/// there are too few samples for one. The paper has no such condition.
pub(super) fn nothing_happened(p_value: Option<f64>, confidence: f64) -> Check {
    let limit = 1.0 - confidence;
    let outcome = Outcome::from(p_value.is_some_and(|p_value| p_value <= limit));
    check(Condition::NothingHappened, p_value, Some(limit), outcome)
}

impl From<bool> for Outcome {
    /// `true` when the condition is met.
    fn from(met: bool) -> Self {
        if met { Self::Passed } else { Self::Failed }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::Method;

    #[test]
    fn a_delay_needs_no_candidate() {
        let fine = FineDelay { delay: 12.0, low: 11.0, high: 13.0, confidence: 0.95 };
        let facts = |fine| Facts {
            step: 2,
            steps: 3,
            input_sample: 100,
            hold: 50,
            output: &[0.0; 60],
            first: 1,
            motion: None,
            rows: 0,
            best: None,
            fine,
        };
        let failed = |fine| {
            let checks = facts(fine).check(&Settings::of(Method::TWO_LINE));
            let failed = checks.into_iter().filter(|check| check.outcome == Outcome::Failed);
            failed.map(|check| check.condition).collect::<Vec<_>>()
        };
        assert_eq!(failed(Some(fine)), []);
        assert_eq!(failed(None), [Condition::TooShort]);
        let early = FineDelay { delay: -2.0, low: -3.0, high: -1.0, ..fine };
        assert_eq!(failed(Some(early)), [Condition::BeforeInput]);
    }
}
