//! Which lengths of time were given in seconds.

/// The settings that were given in seconds; the others are numbers of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InSeconds {
    /// α.
    pub alpha: Option<f64>,
    /// β.
    pub beta: Option<f64>,
    /// `τ_min`.
    pub min_delay: Option<f64>,
    /// The longest delay that is looked for.
    pub max_delay: Option<f64>,
}

impl InSeconds {
    /// Each with its name.
    pub(super) fn named(self) -> [(&'static str, Option<f64>); 4] {
        [
            ("α in seconds", self.alpha),
            ("β in seconds", self.beta),
            ("the shortest hold in seconds", self.min_delay),
            ("the longest delay in seconds", self.max_delay),
        ]
    }
}
