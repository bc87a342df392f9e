//! What is asked for: the method, and its settings.

use std::fmt;

use serde::Serialize;

use crate::numerics::LowPass;

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

/// How `τ_k` goes on between two steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// `τ_k = δ_i` for `k = p_i … p_(i+1)`: the paper's.
    #[default]
    Hold,
    /// From `δ_i` at `p_i` in a line to `δ_(i+1)` at `p_(i+1)`; held where the next step
    /// was not accepted.
    Linear,
}

/// Settings of a method; the default is the paper's way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Settings {
    /// How a delay is found.
    pub method: Method,
    /// α: samples that a segment reaches beyond its input steps.
    pub alpha: usize,
    /// β: samples per row of Φ, so the distance between two candidates.
    pub beta: usize,
    /// Zero-phase low-pass on the output before anything else.
    pub low_pass: Option<LowPass>,
    /// `τ_min`: the shortest hold, in samples, that is accepted.
    pub min_delay: usize,
    /// The longest delay that is looked for, in samples; a segment then runs from
    /// `p_i − α` at the earliest to `p_i + max_delay + α` at the latest. For holds so long
    /// that the output meets something else on its way, such as an end stop. The paper has
    /// no such limit.
    pub max_delay: Option<usize>,
    /// Lower and upper limit that the output must stay between.
    pub output_limits: Option<(f64, f64)>,
    /// Smallest change of slope that is accepted, output units per sample.
    pub min_slope_change: f64,
    /// Squared error that an accepted step must stay below, output units squared.
    pub max_sse: Option<f64>,
    /// Judge the first and the last step of a trial like the others.
    pub keep_first_last: bool,
    /// Smallest change of the input that is a step, input units; 0 for any change.
    pub min_step: f64,
    /// How `τ_k` goes on between two steps.
    pub interpolation: Interpolation,
    /// Reject a step as `nothing_happened` unless its change of slope is this unlikely to
    /// be noise: 0.99 takes noise for a reaction in one step of a hundred. None accepts it
    /// untested, as the paper does.
    pub confidence: Option<f64>,
    /// How often an interval of a delay is to hold the true one.
    pub interval: f64,
}

/// How sure a reaction must be where nothing else is asked for.
const CONFIDENCE: f64 = 0.99;

impl Settings {
    /// The settings that suit `method`. All but the paper's look at the output as it was
    /// measured, since smoothing takes from noise what intervals are made of.
    pub fn of(method: Method) -> Self {
        match method {
            Method::TwoLine => Self::default(),
            Method::Hinge | Method::LagAware => {
                Self { method, low_pass: None, confidence: Some(CONFIDENCE), ..Self::default() }
            }
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::TwoLine,
            alpha: 10,
            beta: 5,
            low_pass: Some(LowPass { cutoff_hz: 5.0, order: 4 }),
            min_delay: 0,
            max_delay: None,
            output_limits: None,
            min_slope_change: 0.0,
            max_sse: None,
            keep_first_last: false,
            min_step: 0.0,
            interpolation: Interpolation::Hold,
            confidence: None,
            interval: 0.95,
        }
    }
}

/// Why settings make no sense, whatever the log.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// α or β is zero.
    #[error("{name} is 0, but must be at least 1 sample")]
    Zero {
        /// The setting's name.
        name: &'static str,
    },
    /// The limits of the output are not in order.
    #[error("the output limits {low},{high} are not in order: the lower one comes first")]
    LimitsSwapped {
        /// The first limit.
        low: f64,
        /// The second limit.
        high: f64,
    },
    /// A probability is not one.
    #[error("{name} is {value}, but must be between 0 and 1, as in 0.99")]
    Probability {
        /// The setting's name.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// A threshold is negative or not a number.
    #[error("{name} is {value}, but must be a number from 0 up")]
    Threshold {
        /// The setting's name.
        name: &'static str,
        /// What was given.
        value: f64,
    },
}

impl Settings {
    /// Checks what can be checked without a log.
    ///
    /// # Errors
    /// [`SettingsError`], the first that is found.
    pub fn check(&self) -> Result<(), SettingsError> {
        for (name, samples) in [("alpha", self.alpha), ("beta", self.beta)] {
            if samples == 0 {
                return Err(SettingsError::Zero { name });
            }
        }
        if let Some((low, high)) = self.output_limits
            && (low >= high || low.is_nan() || high.is_nan())
        {
            return Err(SettingsError::LimitsSwapped { low, high });
        }
        let probabilities =
            [("confidence", self.confidence.unwrap_or(0.5)), ("interval", self.interval)];
        for (name, value) in probabilities {
            if !(value > 0.0 && value < 1.0) {
                return Err(SettingsError::Probability { name, value });
            }
        }
        let thresholds = [
            ("min-slope-change", self.min_slope_change),
            ("max-sse", self.max_sse.unwrap_or_default()),
            ("min-step", self.min_step),
        ];
        match thresholds.into_iter().find(|(_, value)| value.is_nan() || *value < 0.0) {
            Some((name, value)) => Err(SettingsError::Threshold { name, value }),
            None => Ok(()),
        }
    }
}
