//! A delay between samples, and how well it is known.

/// A delay finer than a sample, and how well it is known; all in samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FineDelay {
    /// The delay that the true one is as likely below as above.
    pub delay: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end of its interval.
    pub high: f64,
    /// How often such an interval holds the true delay.
    pub confidence: f64,
}

impl FineDelay {
    /// A delay that cannot be below zero, unless all of its interval is.
    pub(super) fn causal(delay: f64, low: f64, high: f64, confidence: f64) -> Self {
        if high < 0.0 {
            return Self { delay, low, high, confidence };
        }
        Self { delay: delay.max(0.0), low: low.max(0.0), high, confidence }
    }
}
