//! The settings of an estimate.

use serde_json::{Value, json};

use super::document::without_empty;
use crate::delay::{FirstLast, Settings};

/// Every setting by name; a length that is given in seconds is `null` in samples.
pub(super) fn settings_json(settings: &Settings) -> Value {
    let in_seconds = settings.in_seconds;
    let in_samples = |seconds: Option<f64>, samples| seconds.is_none().then_some(samples);
    let facts = json!({
        "method": settings.method.id(),
        "alpha": in_samples(in_seconds.alpha, settings.alpha),
        "alpha_s": in_seconds.alpha,
        "beta": in_samples(in_seconds.beta, settings.beta),
        "beta_s": in_seconds.beta,
        "low_pass": settings.low_pass,
        "min_delay": in_samples(in_seconds.min_delay, settings.min_delay),
        "min_delay_s": in_seconds.min_delay,
        "max_delay": settings.max_delay,
        "max_delay_s": in_seconds.max_delay,
        "output_limits": settings.output_limits,
        "min_slope_change": settings.min_slope_change,
        "max_sse": settings.max_sse,
        "first_last": settings.first_last,
        "keep_first_last": settings.first_last == FirstLast::Keep,
        "paper": settings.paper,
        "accept_anyway": settings.accept_anyway,
        "min_step": settings.min_step,
        "input": settings.input,
        "interpolation": settings.interpolation,
        "confidence": settings.confidence,
        "interval": settings.interval,
    });
    let optional = ["alpha_s", "beta_s", "min_delay_s", "max_delay_s", "accept_anyway"];
    without_empty(facts, &optional)
}
