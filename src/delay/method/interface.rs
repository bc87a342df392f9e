//! What every method does.

use crate::delay::decision::Decision;
use crate::delay::lag::Lag;
use crate::delay::prepared::Prepared;
use crate::delay::settings::Settings;
use crate::delay::spec::Method;

/// A way to find the delays of a trial.
pub(in crate::delay) trait DelayMethod: Sync {
    /// Its handle, by which settings name it and which says what it is.
    fn method(&self) -> Method;

    /// The lag that the `trials` of a joint share. Only methods of
    /// [`Scope::Joint`](crate::delay::Scope::Joint) are asked.
    fn shared_lag(&self, _trials: &[Prepared<'_>], _settings: &Settings) -> Option<Lag> {
        None
    }

    /// The decisions on all steps of a trial, one each and in order; `lag` is what its joint
    /// shares.
    fn decide(&self, trial: &Prepared<'_>, lag: Option<&Lag>, settings: &Settings)
    -> Vec<Decision>;
}
