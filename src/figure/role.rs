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
    /// The revisions of a model after the first one, which is [`Self::Model`].
    Revision(Revision),
    /// A colour of its own, which a recording has beside these: red, green, blue.
    Own(u8, u8, u8),
}

/// One of the colours of revisions after the first, counted from 1 to [`Revision::COUNT`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Revision(u8);

impl Revision {
    /// Colours; then they begin anew.
    pub(crate) const COUNT: u8 = 9;

    /// Its place among the colours, from 0.
    pub(crate) const fn place(self) -> usize {
        self.0 as usize - 1
    }
}

impl Role {
    /// That of the revision with this number, counted from 0.
    pub(crate) fn of_revision(number: usize) -> Self {
        let place = number % (usize::from(Revision::COUNT) + 1);
        match u8::try_from(place) {
            Ok(place @ 1..) => Self::Revision(Revision(place)),
            _ => Self::Model,
        }
    }

    /// All but colours of their own.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let usual = [
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
        usual.into_iter().chain((1..=Revision::COUNT).map(|one| Self::Revision(Revision(one))))
    }
}
