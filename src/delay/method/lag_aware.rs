//! `lag-aware`: the broken line behind a lag that all steps of a joint share, so that dead
//! time and lag are told apart, each with an interval.

use super::hinge::Hinge;
use super::interface::DelayMethod;
use crate::delay::decision::Decision;
use crate::delay::lag_aware;
use crate::delay::prepared::Prepared;
use crate::delay::response::Lag;
use crate::delay::settings::{CONFIDENCE, Settings};
use crate::delay::spec::{Method, MethodSpec, Scope};

static SPEC: MethodSpec = MethodSpec {
    id: "lag-aware",
    fits: "broken line behind a lag",
    source: None,
    summary: "A broken line behind a lag: dead time apart from lag, with intervals",
    has_rows: false,
    has_intervals: true,
    scope: Scope::Joint,
    low_pass: None,
    confidence: Some(CONFIDENCE),
};

impl Method {
    /// The broken line behind a lag that all steps of a joint share: dead time apart from
    /// lag, each with an interval.
    pub const LAG_AWARE: Self = Self::of(&SPEC);
}

pub(super) struct LagAware;

impl DelayMethod for LagAware {
    fn method(&self) -> Method {
        Method::LAG_AWARE
    }

    fn shared_lag(&self, trials: &[Prepared<'_>], settings: &Settings) -> Option<Lag> {
        Some(lag_aware::lag_of(trials, settings))
    }

    fn decide(
        &self,
        trial: &Prepared<'_>,
        lag: Option<&Lag>,
        settings: &Settings,
    ) -> Vec<Decision> {
        match lag.filter(|lag| lag.order() > 0) {
            Some(lag) => {
                let (output, steps) = (trial.output(), trial.steps.as_slice());
                lag_aware::decide_all(output, steps, lag, trial.period, settings)
            }
            // A joint that follows at once has a broken line.
            None => Hinge.decide(trial, None, settings),
        }
    }
}
