//! The conditions a breakpoint must meet, each with the numbers that were compared.

use std::fmt;

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
        self.words()[0]
    }

    /// What is wrong when it fails, in words.
    pub(crate) fn meaning(self) -> &'static str {
        self.words()[1]
    }

    /// What is so where it is met, in few words.
    #[cfg(feature = "rrd")]
    pub(crate) fn when_met(self) -> &'static str {
        self.words()[2]
    }

    /// What it asks for, in a sentence without its end.
    pub fn asks(self) -> &'static str {
        self.words()[3]
    }

    /// Its id, what is wrong when it fails, what is so where it is met, and what it asks for.
    #[expect(clippy::too_many_lines, reason = "a table: four texts for each condition")]
    fn words(self) -> [&'static str; 4] {
        match self {
            Self::FirstOrLast => [
                "first_or_last",
                "first or last step of the trial",
                "not first or last",
                "the step is neither the first nor the last of the trial",
            ],
            Self::OutputLimit => [
                "output_limit",
                "output touches a limit",
                "output in its limits",
                "no sample of the segment touches a limit of the output",
            ],
            Self::BeforeInput => [
                "before_input",
                "breakpoint before the input step",
                "break after step",
                "the breakpoint q is not before the input step p",
            ],
            Self::SlopeChange => [
                "slope_change",
                "slope changes too little",
                "slope changes",
                "the slopes of the lines before and after q differ by at least the limit",
            ],
            Self::ShortHold => [
                "short_hold",
                "input held too short",
                "next step far off",
                "the input is held at its new level for at least as many samples as the limit",
            ],
            Self::Sse => [
                "sse",
                "lines fit too badly",
                "lines fit",
                "the sum of squared errors of both lines is below the limit",
            ],
            Self::TooShort => [
                "too_short",
                "segment too short for two lines",
                "room for two lines",
                "the segment has two rows of β samples, one for each line",
            ],
            Self::AtRest => [
                "at_rest",
                "joint at rest, before and after",
                "joint moves",
                "the joint moves after the step, and is not at rest or at its stop",
            ],
            Self::NothingHappened => [
                "nothing_happened",
                "no reaction beyond the noise",
                "more than noise",
                "the slope changes by more than noise explains: the p-value is not above the limit",
            ],
            Self::Reviewer => [
                "reviewer",
                "rejected by a reviewer",
                "no reviewer's word",
                "no person rejected the step",
            ],
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

/// The change of slope against noise; the value is the p-value of a reaction, none where
/// there are too few samples for one. The paper has no such condition.
pub(super) fn nothing_happened(p_value: Option<f64>, confidence: f64) -> Check {
    let limit = 1.0 - confidence;
    let outcome = Outcome::from(p_value.is_some_and(|p_value| p_value <= limit));
    Check { condition: Condition::NothingHappened, value: p_value, limit: Some(limit), outcome }
}

impl From<bool> for Outcome {
    /// `true` when the condition is met.
    fn from(met: bool) -> Self {
        if met { Self::Passed } else { Self::Failed }
    }
}
