//! What every method does.

use std::sync::Arc;

use crate::delay::decision::Decision;
use crate::delay::onset_model::OnsetModel;
use crate::delay::prepared::Prepared;
use crate::delay::settings::Settings;
use crate::delay::spec::Method;

/// What the trials of a joint share: the response behind the dead times, where the method looks for it.
pub(in crate::delay) type Shared = Option<Arc<OnsetModel>>;

/// A way to find the delays of a trial.
pub(in crate::delay) trait DelayMethod: Sync {
    /// Its handle, by which settings name it and which says what it is.
    fn method(&self) -> Method;

    /// What the `trials` of a joint share. Only methods with intervals are asked.
    fn shared(&self, _trials: &[Prepared<'_>], _settings: &Settings) -> Shared {
        None
    }

    /// The decisions on all steps of a trial, one each and in order, with what its joint shares.
    fn decide(&self, trial: &Prepared<'_>, shared: &Shared, settings: &Settings) -> Vec<Decision>;
}
