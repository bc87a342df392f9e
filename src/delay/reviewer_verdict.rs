//! What a reviewer says of a decision: it overrides the conditions.

/// A reviewer's verdict on a step.
#[derive(Clone, Debug, PartialEq)]
pub struct ReviewerVerdict {
    /// Whether its delay counts.
    pub accepted: bool,
    /// The delay in samples, where the reviewer says it; else the method's own.
    pub delay: Option<f64>,
    /// Why.
    pub note: String,
    /// Who.
    pub reviewer: String,
}
