//! What is said on one question.

/// What a reader asks of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Topic {
    /// How large the error is, and whether it is more than noise.
    Error,
    /// In which part of the record most of the error arises.
    WhereItFails,
    /// The parts of the record in which the simulated output is farthest off.
    WorstSegments,
    /// The effect that is missing.
    Missing,
    /// What comes next in a search.
    Next,
    /// What the residual follows.
    Residual,
    /// The measured curves that the model does not follow.
    Curves,
    /// The part of the error that each effect explains.
    Shares,
    /// Why the model has the structure that it has.
    Structure,
    /// The delay of the model beside those that were measured.
    Delay,
    /// In which trials an effect acts.
    Trials,
    /// Where the conclusion holds.
    Limits,
}

impl Topic {
    /// What stands before the sentences.
    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::Error => "Error",
            Self::WhereItFails => "Where the error arises",
            Self::WorstSegments => "Worst segments",
            Self::Missing => "What is missing",
            Self::Next => "What comes next",
            Self::Residual => "What the residual follows",
            Self::Curves => "Measured curves",
            Self::Shares => "What each effect explains",
            Self::Structure => "Structure",
            Self::Delay => "Delay",
            Self::Trials => "Trials",
            Self::Limits => "Limits",
        }
    }
}

/// Sentences on one question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Passage {
    pub(crate) topic: Topic,
    pub(crate) sentences: Vec<String>,
}

impl Passage {
    /// `sentences` on `topic`, where there are any.
    pub(crate) fn of(topic: Topic, sentences: impl IntoIterator<Item = String>) -> Option<Self> {
        let sentences: Vec<String> = sentences.into_iter().collect();
        (!sentences.is_empty()).then_some(Self { topic, sentences })
    }

    /// All sentences in one.
    pub(crate) fn text(&self) -> String {
        self.sentences.join(" ")
    }
}
