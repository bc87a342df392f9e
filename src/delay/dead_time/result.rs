//! The dead time of a joint whose input moves all the time.

use serde::Serialize;

/// The dead time of a joint over its record, and in windows of it; all in seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct DeadTime {
    /// What the record says.
    pub finding: Finding,
    /// The lag after the dead time: by how much a slow motion is late beyond it. None where
    /// nothing was fitted.
    pub lag_s: Option<f64>,
    /// The part of the changes of the output, whitened, that the input explains.
    pub explained: f64,
    /// Whether the speed follows the input, as after a valve; else the output does.
    pub integrates: bool,
    /// How often an interval is to hold the true dead time.
    pub confidence: f64,
    /// Whether the input follows the output.
    pub feedback: Feedback,
    /// The error of each dead time, the best lags being taken.
    pub curve: Vec<ErrorPoint>,
    /// Windows of the record in which the dead time was estimated by itself.
    pub windows: Vec<Window>,
    /// The p-value of windows so far apart, if the dead time were the same in all.
    pub same_in_all: Option<f64>,
}

/// What a record says of a dead time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finding {
    /// There is one.
    Known(Bounds),
    /// None is distinguishable from the lag after it: the interval holds 0.
    LagOnly(Bounds),
    /// It cannot be estimated.
    Unknown(Unknown),
}

/// A dead time and its interval, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The most likely one.
    pub value_s: f64,
    /// Lower end of the interval.
    pub low_s: f64,
    /// Upper end of the interval.
    pub high_s: f64,
}

/// Why a dead time cannot be estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unknown {
    /// The input is constant, or the record too short.
    TooShort,
    /// What the output does is not explained by the input at any delay.
    NotExplained,
    /// The input is a sine of this frequency, Hz: a lag explains its phase as a dead time does.
    OneFrequency(f64),
    /// Longer than any dead time that is tried, in seconds.
    TooLong(f64),
}

/// Whether the input follows the output: the correlation of what is new in the output with what
/// is new in the input later.
///
/// # References
/// L. D. Haugh, "Checking the independence of two covariance-stationary time series", J. Am.
/// Stat. Assoc. 71 (1976). L. Ljung, "System Identification" (1999), section 16.6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feedback {
    /// The p-value of such correlations without feedback.
    pub p_value: f64,
    /// The largest of them.
    pub largest: f64,
}

impl Feedback {
    /// Whether there is enough of it to bias a dead time.
    pub(crate) fn is_present(&self) -> bool {
        /// A test at one in ten thousand: logs are long.
        const P_VALUE: f64 = 1e-4;
        /// A correlation with consequence: less explains 1 % of the input.
        const LARGEST: f64 = 0.1;
        self.p_value < P_VALUE && self.largest > LARGEST
    }
}

/// The error of a dead time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorPoint {
    /// The dead time.
    pub delay_s: f64,
    /// The root mean square of the whitened prediction error, over that of the best.
    pub error: f64,
}

/// The dead time in a part of a trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// Number of the trial, from 0.
    pub trial: usize,
    /// First sample of the window, from 1.
    pub first: usize,
    /// Last sample of the window.
    pub last: usize,
    /// None where the input does not excite enough.
    pub estimate: Option<Bounds>,
    /// The error of each dead time, over the least of them.
    pub curve: Vec<ErrorPoint>,
}

impl DeadTime {
    /// Whether the dead times of windows are more apart than by chance: at 1 %.
    pub fn varies(&self) -> bool {
        /// Below it the same dead time in all windows is not believed.
        const SAME: f64 = 0.01;
        self.same_in_all.is_some_and(|p| p < SAME)
    }

    /// The dead time and its interval, where they are known; one that holds 0, too.
    pub fn bounds(&self) -> Option<Bounds> {
        match self.finding {
            Finding::Known(bounds) | Finding::LagOnly(bounds) => Some(bounds),
            Finding::Unknown(_) => None,
        }
    }
}
