//! What shows a lack of fit.

/// What shows that a model lacks something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShownBy {
    /// Shapes that missing effects have explain more than noise would.
    Shapes,
    /// The residual is far beyond the noise of the measurement.
    Size,
    /// The residual is larger on the part that was not fitted.
    UnseenPart,
    /// The residual stands out in a few windows.
    FewWindows,
}
