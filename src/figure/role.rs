//! What is drawn, by meaning: each back end has its own shade for it.

/// What a line, a point or a text means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// Text and axes.
    Ink,
    /// Axes' numbers, remarks.
    Faint,
    /// Grid lines.
    Grid,
    /// What drove the joint.
    Input,
    /// What was measured.
    Measured,
    /// What the lines were fitted to.
    Smoothed,
    /// Accepted.
    Accepted,
    /// Rejected.
    Rejected,
    /// Squared errors.
    Error,
    /// A model.
    Model,
    /// What noise alone would leave.
    Noise,
    /// A part of the record that deserves a look.
    Attention,
}

impl Role {
    pub(crate) const ALL: [Self; 12] = [
        Self::Ink,
        Self::Faint,
        Self::Grid,
        Self::Input,
        Self::Measured,
        Self::Smoothed,
        Self::Accepted,
        Self::Rejected,
        Self::Error,
        Self::Model,
        Self::Noise,
        Self::Attention,
    ];
}
