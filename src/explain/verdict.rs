//! What is said of a model.

use super::candidate::Candidate;
use super::contribution::Attribution;
use crate::diagnosis::Comparison;

/// What is to be said of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// No lack of fit is shown: no missing effect found.
    Adequate,
    /// The first of the ranking explains a significant part.
    MissingEffect,
    /// An error remains that no effect accounts for.
    Unexplained,
}

impl Verdict {
    /// Its id in results.
    pub fn id(self) -> &'static str {
        match self {
            Self::Adequate => "adequate",
            Self::MissingEffect => "missing_effect",
            Self::Unexplained => "unexplained",
        }
    }

    /// The verdict of this id.
    pub fn by_id(id: &str) -> Option<Self> {
        [Self::Adequate, Self::MissingEffect, Self::Unexplained]
            .into_iter()
            .find(|verdict| verdict.id() == id)
    }
}

impl Explanation {
    /// The candidate that is proposed or, where none is, the one that leaves least.
    pub fn proposed(&self) -> Option<&Candidate> {
        let mut added = self.ranking.iter().filter(|candidate| candidate.judgement.is_added());
        added.next().or(self.ranking.first())
    }
}

/// What is missing from a model.
#[derive(Clone, Debug)]
pub struct Explanation {
    /// The model as it is, fitted.
    pub base: Comparison,
    /// What is to be said of it.
    pub verdict: Verdict,
    /// The candidates, best first; none where the model is adequate.
    pub ranking: Vec<Candidate>,
    /// What the effects that are named would carry.
    pub attribution: Attribution,
}
