//! `conclusion`: what was found, how much it explains, and what remains.

use serde::Serialize;
use serde_json::{Map, Value};

use super::joint::parameters;
use crate::explain::Contribution;
use crate::report::consequence::Consequence;
use crate::report::finding::Finding;

/// What is concluded of a joint.
#[derive(Debug, Serialize)]
pub(super) struct ConclusionJson {
    headline: String,
    found: Vec<FoundJson>,
    doubtful: Vec<FoundJson>,
    refinements: Vec<&'static str>,
    explained_percent: Option<f64>,
    sensor_noise: Option<f64>,
    remaining: Option<RemainingJson>,
}

/// An effect with a practical consequence.
#[derive(Debug, Serialize)]
struct FoundJson {
    effect: &'static str,
    error_share_percent: f64,
    alternatives: Vec<&'static str>,
    parameters: Map<String, Value>,
}

/// The error that remains.
#[derive(Debug, Serialize)]
struct RemainingJson {
    rmse: f64,
    times_sensor_noise: Option<f64>,
    percent_of_motion: f64,
}

impl ConclusionJson {
    pub(super) fn of(finding: &Finding<'_>) -> Self {
        Self::new(finding.conclusion().headline, &finding.consequence())
    }

    pub(super) fn new(headline: String, of: &Consequence<'_>) -> Self {
        let all = parameters(of.joint, of.fit);
        let found = |one: &Contribution| {
            let prefix = format!("{}.", one.effect);
            let own = all.iter().filter(|(name, _)| name.starts_with(&prefix));
            FoundJson {
                effect: one.effect,
                error_share_percent: 100.0 * one.error_share,
                alternatives: one.alternatives.clone(),
                parameters: own.map(|(name, value)| (name.clone(), value.clone())).collect(),
            }
        };
        let remaining = of.after.map(|error| RemainingJson {
            rmse: error.rmse,
            times_sensor_noise: of.times_noise(),
            percent_of_motion: 100.0 - error.fit_percent,
        });
        Self {
            headline,
            found: of.attribution.iter().flat_map(|one| &one.found).map(found).collect(),
            doubtful: of.attribution.iter().flat_map(|one| &one.doubtful).map(found).collect(),
            refinements: of.attribution.iter().flat_map(|one| &one.refinements).copied().collect(),
            explained_percent: of.explained().map(|share| 100.0 * share),
            sensor_noise: of.sensor_noise,
            remaining,
        }
    }
}
