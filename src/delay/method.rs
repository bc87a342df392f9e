//! The methods: one file each, one entry here.

use std::fmt;

use serde::Serialize;

use super::estimate::{Decision, Prepared, Settings};
use super::response::Lag;
use super::{hinge, lag_aware, two_line};

/// How a delay is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Two regression lines that need not meet: Albrecht and Taylor's Algorithm 1.
    #[default]
    TwoLine,
    /// A broken line whose parts meet between two samples, with an interval.
    Hinge,
    /// The broken line behind a lag that all steps of a joint share: dead time apart from
    /// lag, each with an interval.
    LagAware,
}

impl Method {
    /// All methods, in the order the documentation lists them.
    pub const ALL: [Self; 3] = [Self::TwoLine, Self::Hinge, Self::LagAware];

    /// Its name in options and files.
    pub fn id(self) -> &'static str {
        match self {
            Self::TwoLine => "two-line",
            Self::Hinge => "hinge",
            Self::LagAware => "lag-aware",
        }
    }

    /// What it fits, in words.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::TwoLine => "two-line regression",
            Self::Hinge => "broken line",
            Self::LagAware => "broken line behind a lag",
        }
    }

    /// Whether β says anything to it.
    pub fn has_rows(self) -> bool {
        self == Self::TwoLine
    }

    /// Whether it looks at all trials of a joint for a lag that they share.
    pub(super) fn shares_a_lag(self) -> bool {
        self == Self::LagAware
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

/// The lag that the trials of a joint share, where the method looks for it.
pub(super) fn lag_of(trials: &[Prepared<'_>], settings: &Settings) -> Option<Lag> {
    settings.method.shares_a_lag().then(|| lag_aware::lag_of(trials, settings))
}

/// The decisions on all steps of a trial.
pub(super) fn decide_all(
    trial: &Prepared<'_>,
    lag: Option<&Lag>,
    settings: &Settings,
) -> Vec<Decision> {
    let (output, steps) = (trial.output(), trial.steps.as_slice());
    match (settings.method, lag) {
        (Method::TwoLine, _) => two_line::decide_all(output, trial.raw, steps, settings),
        (Method::LagAware, Some(lag)) if lag.order() > 0 => {
            lag_aware::decide_all(output, steps, lag, trial.period, settings)
        }
        // Without a lag there is nothing but the broken line.
        (Method::Hinge | Method::LagAware, _) => hinge::decide_all(output, steps, settings),
    }
}
