//! What the methods do; what each says of itself stands in its [`MethodSpec`](super::MethodSpec).

mod by_onset;
mod next_reaction;
mod noise_test;
mod step_context;
mod two_line;

use super::decision::Decision;
use super::neutral::Neutral;
use super::onset_model::{Family, OnsetModel};
use super::prepared::Prepared;
use super::settings::Settings;
use super::spec::Method;

impl Method {
    /// The response after the dead times that the `trials` of a joint share, where the method looks
    /// for it.
    pub(super) fn shared(
        self,
        trials: &[Prepared<'_>],
        neutral: Option<Neutral>,
        settings: &Settings,
    ) -> Option<OnsetModel> {
        let families: &[Family] = match self {
            Self::TWO_LINE => return None,
            Self::HINGE => &[Family::Bend],
            Self::LAG_AWARE => &Family::MOVING,
            _ => &Family::ALL,
        };
        OnsetModel::of(trials, neutral, settings, families)
    }

    /// The decisions on all steps of a trial, one each and in order, with what its joint shares.
    pub(super) fn decide(
        self,
        trial: &Prepared<'_>,
        model: Option<&OnsetModel>,
        settings: &Settings,
    ) -> Vec<Decision> {
        if self.spec().has_intervals {
            by_onset::decide(trial, model, settings)
        } else {
            two_line::decide(trial, settings)
        }
    }
}
