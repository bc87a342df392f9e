//! The settings, in words and in JSON.

use serde_json::{Value, json};

use super::json::without_empty;
use super::{EstimatedJoint, TextTable};
use crate::delay::{CONFIDENCE, FirstLast, Method, Settings};
use crate::units::Length;
use crate::wording::number;

/// The settings of a joint, where it has some of its own: others than `asked`, which are those of
/// all joints.
pub(super) fn own_settings<'a>(
    joint: &EstimatedJoint<'a>,
    asked: &Settings,
) -> Option<&'a Settings> {
    let own = &joint.estimate.settings;
    (own != &asked.in_samples(&joint.joint.trials)).then_some(own)
}

/// Each setting with its value, as a table.
pub(crate) fn settings_table(settings: &Settings) -> TextTable {
    let rows = settings_rows(settings).into_iter();
    let rows = rows.map(|(name, value)| [name.to_owned(), value]);
    TextTable::of(["setting", "value"], &[], rows)
}

/// Each setting with its value, as a person would say it.
fn settings_rows(settings: &Settings) -> Vec<(&'static str, String)> {
    let low_pass = settings.low_pass.map_or_else(
        || "none".to_owned(),
        |filter| {
            let (hz, order) = (filter.cutoff_hz, filter.order);
            format!("Butterworth, {hz} Hz, order {order}, forward and backward")
        },
    );
    let limits = settings.output_limits;
    let not_set = || "not set".to_owned();
    let percent = |part: f64| format!("{} %", number(100.0 * part));
    vec![
        ("method", method(settings.method)),
        ("α", length(settings.alpha_length())),
        ("β", length(settings.beta_length())),
        ("low-pass", low_pass),
        ("shortest hold τ_min", length(settings.min_delay_length())),
        ("longest delay", settings.max_delay_length().map_or_else(not_set, length)),
        ("output limits", limits.map_or_else(not_set, |(low, high)| format!("{low} … {high}"))),
        ("smallest slope change", format!("{} per sample", settings.min_slope_change)),
        ("largest SSE", settings.max_sse.map_or_else(not_set, |limit| limit.to_string())),
        ("rest and stops", if settings.paper { "not looked for" } else { "looked for" }.to_owned()),
        (
            "first and last step",
            match settings.first_last {
                FirstLast::Auto => "judged in trials of three steps or fewer",
                FirstLast::Reject => "left out",
                FirstLast::Keep => "judged",
            }
            .to_owned(),
        ),
        ("smallest input step", settings.min_step.to_string()),
        ("input", format!("{:?}", settings.input).to_lowercase()),
        ("τ between steps", format!("{:?}", settings.interpolation).to_lowercase()),
        ("reaction beyond the noise", reaction(settings)),
        ("interval of a delay", percent(settings.interval)),
    ]
}

/// Whether it is tested that a step shows more than noise.
fn reaction(settings: &Settings) -> String {
    let tested = |confidence: f64| format!("tested at p ≤ {}", number(1.0 - confidence));
    match settings.confidence {
        Some(confidence) => tested(confidence),
        None if settings.paper => "not tested".to_owned(),
        None => {
            format!("{} in trials of few steps and at stops", tested(CONFIDENCE))
        }
    }
}

/// Rows that are said with every method: its lengths and its low-pass, and of some the interval.
const ALWAYS: [&str; 4] = ["α", "β", "low-pass", "interval of a delay"];

/// Those of the [`settings_rows`] that are said `always`, or are not as the method has them by itself.
fn telling<'a>(
    settings: &Settings,
    always: &'a [&str],
) -> impl Iterator<Item = (&'static str, String)> + use<'a> {
    let usual = settings_rows(&Settings::of(settings.method));
    let rows = settings_rows(settings).into_iter().zip(usual);
    rows.filter(|(row, usual)| always.contains(&row.0) || row != usual).map(|(row, _)| row)
}

/// The settings in one line: the method with its lengths and its low-pass, and what is not as the
/// method has it by itself.
pub(super) fn settings_line(settings: &Settings) -> String {
    let spec = settings.method.spec();
    let always = ALWAYS.get(..if spec.has_intervals { 4 } else { 3 }).unwrap_or_default();
    let said = telling(settings, always).map(|(name, value)| format!("{name} {value}"));
    format!("{}; {}", spec.fits, said.collect::<Vec<_>>().join("; "))
}

/// The settings as a name: the method with its lengths and its low-pass, and what is not as the
/// method has it by itself.
pub(crate) fn settings_in_short(settings: &Settings) -> String {
    let Settings { method, low_pass, .. } = settings;
    let (alpha, beta) = (settings.alpha_length(), settings.beta_length());
    let mut parts = vec![method.to_string()];
    parts.push(format!("α {alpha}, β {beta}"));
    parts.extend(low_pass.map(|filter| format!("{} Hz", number(filter.cutoff_hz))));
    let changed = telling(settings, &[]).filter(|(name, _)| !ALWAYS[..3].contains(name));
    parts.extend(changed.map(|(name, value)| format!("{name} {value}")));
    parts.join(", ")
}

/// A length in words: `10 samples` or `0.1 s`.
fn length(length: Length) -> String {
    match length {
        Length::Samples(samples) => format!("{samples} samples"),
        Length::Seconds(seconds) => format!("{seconds} s"),
    }
}

fn method(method: Method) -> String {
    let spec = method.spec();
    spec.source.map_or_else(|| spec.fits.to_owned(), |source| format!("{} ({source})", spec.fits))
}

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
