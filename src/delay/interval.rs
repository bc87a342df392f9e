//! A delay between samples, and how well it is known.

use crate::numerics::student_quantile;

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
    /// This delay, no earlier than its step unless all of its interval is by more than a sample: the
    /// input may have changed any time after the sample before.
    pub(super) fn not_before_its_step(self) -> Self {
        if self.high < -1.0 {
            return self;
        }
        Self::causal(self.delay, self.low, self.high.max(0.0), self.confidence)
    }

    /// The standard error that an interval of this width stands for.
    pub(crate) fn standard_error(&self) -> f64 {
        (self.high - self.low)
            / 2.0
            / student_quantile(f64::midpoint(1.0, self.confidence), f64::INFINITY)
    }

    /// A delay that cannot be below zero, unless all of its interval is.
    pub(super) fn causal(delay: f64, low: f64, high: f64, confidence: f64) -> Self {
        if high < 0.0 {
            return Self { delay, low, high, confidence };
        }
        Self { delay: delay.max(0.0), low: low.max(0.0), high, confidence }
    }
}
