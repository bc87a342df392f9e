//! The settings of an estimate.

use serde::Serialize;

use crate::delay::{FirstLast, InputKind, Interpolation, Settings};
use crate::numerics::LowPass;

#[derive(Debug, Serialize)]
pub(super) struct SettingsJson {
    method: &'static str,
    alpha: usize,
    beta: usize,
    low_pass: Option<LowPassJson>,
    min_delay: usize,
    max_delay: Option<usize>,
    output_limits: Option<(f64, f64)>,
    min_slope_change: f64,
    max_sse: Option<f64>,
    first_last: &'static str,
    keep_first_last: bool,
    paper: bool,
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
        Self {
            method: settings.method.id(),
            alpha: settings.alpha,
            beta: settings.beta,
            low_pass: settings.low_pass.map(low_pass),
            min_delay: settings.min_delay,
            max_delay: settings.max_delay,
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
