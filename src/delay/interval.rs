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
