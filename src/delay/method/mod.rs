//! The methods: one entry each in the registry, where help, defaults, sweeps, reports and
//! recordings find what it says of itself.

mod by_onset;
mod next_reaction;
mod noise_test;
mod registry;
mod step_context;
mod two_line;

use super::decision::Decision;
use super::onset_model::OnsetModel;
use super::prepared::Prepared;
use super::settings::Settings;

pub(crate) use next_reaction::end_at_the_next_step;
pub use registry::{Method, MethodSpec};

impl Method {
    /// The response behind the dead times that the `trials` of a joint share, where the method looks
    /// for it.
    pub(super) fn shared(self, trials: &[Prepared<'_>], settings: &Settings) -> Option<OnsetModel> {
        let families = self.spec().families;
        if families.is_empty() { None } else { OnsetModel::of(trials, settings, families) }
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
