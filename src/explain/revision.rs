//! Models as they change: what was added and removed, and the error before and after.

use std::sync::Arc;

use super::candidate::Candidate;
use super::contribution::Attribution;
use super::extension::ids;
use super::verdict::Verdict;
use crate::diagnosis::Comparison;
use crate::fit::FitError;
use crate::model::JointModel;

/// What a revision changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Nothing: the model as it was given.
    Start,
    /// An effect was added.
    Added(&'static str),
    /// An effect that others made useless was removed.
    Removed(&'static str),
    /// An effect gave way to one that does the same better: to its finer form, or now that others
    /// are there.
    Replaced {
        /// What was removed.
        old: &'static str,
        /// What was added.
        new: &'static str,
    },
}

impl Change {
    /// What adding `new` has made of the model `before`: an effect whose finer form it is has gone.
    pub(super) fn between(before: &JointModel, after: &JointModel, new: &'static str) -> Self {
        let kept = ids(after);
        match ids(before).into_iter().find(|id| !kept.contains(id)) {
            Some(old) => Self::Replaced { old, new },
            None => Self::Added(new),
        }
    }

    /// The effect that it brought.
    pub(super) fn new_effect(self) -> Option<&'static str> {
        match self {
            Self::Replaced { new, .. } | Self::Added(new) => Some(new),
            Self::Removed(_) | Self::Start => None,
        }
    }
}

/// A model and its error.
#[derive(Clone, Debug)]
pub struct Revision {
    /// What changed.
    pub change: Change,
    /// The model, fitted.
    pub comparison: Comparison,
    /// The candidates for what comes next, best first; none where none was looked for.
    pub ranking: Vec<Candidate>,
}

impl Revision {
    /// Keeps what it came to, and not what its model simulates.
    pub(super) fn drop_series(&mut self) {
        let evaluation = &mut self.comparison.fit.evaluation;
        *evaluation = Arc::new(evaluation.without_series());
    }
}

/// A model that was improved.
#[derive(Clone, Debug)]
pub struct Improvement {
    /// The model as it was given, and after each change.
    pub revisions: Vec<Revision>,
    /// What is to be said of the last.
    pub verdict: Verdict,
    /// What each effect that was added carries; nothing where it was stopped.
    pub attribution: Attribution,
}

/// A model before and after an effect was added.
#[derive(Clone, Debug)]
pub struct Addition {
    /// The model as it was, fitted.
    pub before: Comparison,
    /// The model with the effect, fitted.
    pub after: Comparison,
    /// Probability of so much or more when the effect is not there, as for a
    /// [`Candidate`]; `None` where the two models do not nest.
    pub p_value: Option<f64>,
    /// What the effect carries.
    pub attribution: Attribution,
}

/// Why an effect cannot be added.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AddError {
    /// The model has it.
    #[error("`{effect}` is in the model already")]
    AlreadyThere {
        /// Its id.
        effect: &'static str,
    },
    /// The model has an effect that contains it.
    #[error("`{effect}` is a part of `{whole}`, which is in the model already")]
    Contained {
        /// Its id.
        effect: &'static str,
        /// The id of the other.
        whole: &'static str,
    },
    /// The model cannot be fitted.
    #[error(transparent)]
    Fit(#[from] FitError),
}
