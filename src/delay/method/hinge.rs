//! `hinge`: a broken line whose parts meet between two samples, with an interval.

use super::interface::DelayMethod;
use crate::delay::decision::Decision;
use crate::delay::hinge;
use crate::delay::prepared::Prepared;
use crate::delay::response::Lag;
use crate::delay::settings::{CONFIDENCE, Settings};
use crate::delay::spec::{Method, MethodSpec, Scope};

static SPEC: MethodSpec = MethodSpec {
    id: "hinge",
    fits: "broken line",
    source: None,
    summary: "A continuous broken line, with intervals",
    has_rows: false,
    has_intervals: true,
    scope: Scope::Trial,
    low_pass: None,
    confidence: Some(CONFIDENCE),
};

impl Method {
    /// A broken line whose parts meet between two samples, with an interval.
    pub const HINGE: Self = Self::of(&SPEC);
}

pub(super) struct Hinge;

impl DelayMethod for Hinge {
    fn method(&self) -> Method {
        Method::HINGE
    }

    fn decide(&self, trial: &Prepared<'_>, _: Option<&Lag>, settings: &Settings) -> Vec<Decision> {
        hinge::decide_all(trial.output(), &trial.steps, settings)
    }
}
