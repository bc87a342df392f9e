//! The settings of an estimate.

use serde::Serialize;

use crate::delay::{FirstLast, InputKind, Interpolation, Settings};
use crate::numerics::LowPass;

#[derive(Debug, Serialize)]
pub(super) struct SettingsJson {
    method: &'static str,
    /// `null` where it is given in seconds; so are those below.
    alpha: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha_s: Option<f64>,
    beta: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    beta_s: Option<f64>,
    low_pass: Option<LowPassJson>,
    min_delay: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    min_delay_s: Option<f64>,
    max_delay: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_delay_s: Option<f64>,
    output_limits: Option<(f64, f64)>,
    min_slope_change: f64,
    max_sse: Option<f64>,
    first_last: &'static str,
    keep_first_last: bool,
    paper: bool,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    accept_anyway: bool,
    min_step: f64,
    input: &'static str,
    interpolation: &'static str,
    confidence: Option<f64>,
    interval: f64,
}

#[derive(Debug, Serialize)]
struct LowPassJson {
    cutoff_hz: f64,
    order: usize,
}

impl From<&Settings> for SettingsJson {
    fn from(settings: &Settings) -> Self {
        let low_pass = |LowPass { cutoff_hz, order }: LowPass| LowPassJson { cutoff_hz, order };
        let in_seconds = settings.in_seconds;
        let in_samples = |seconds: Option<f64>, samples| seconds.is_none().then_some(samples);
        Self {
            method: settings.method.id(),
            alpha: in_samples(in_seconds.alpha, settings.alpha),
            alpha_s: in_seconds.alpha,
            beta: in_samples(in_seconds.beta, settings.beta),
            beta_s: in_seconds.beta,
            low_pass: settings.low_pass.map(low_pass),
            min_delay: in_samples(in_seconds.min_delay, settings.min_delay),
            min_delay_s: in_seconds.min_delay,
            max_delay: settings.max_delay,
            max_delay_s: in_seconds.max_delay,
            output_limits: settings.output_limits,
            min_slope_change: settings.min_slope_change,
            max_sse: settings.max_sse,
            first_last: match settings.first_last {
                FirstLast::Auto => "auto",
                FirstLast::Reject => "reject",
                FirstLast::Keep => "keep",
            },
            keep_first_last: settings.first_last == FirstLast::Keep,
            paper: settings.paper,
            accept_anyway: settings.accept_anyway,
            min_step: settings.min_step,
            input: match settings.input {
                InputKind::Auto => "auto",
                InputKind::Steps => "steps",
                InputKind::Continuous => "continuous",
            },
            interpolation: match settings.interpolation {
                Interpolation::Hold => "hold",
                Interpolation::Linear => "linear",
            },
            confidence: settings.confidence,
            interval: settings.interval,
        }
    }
}
