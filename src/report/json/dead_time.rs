//! How an input moves, and the dead time of one that moves all the time.

use serde::Serialize;

use crate::delay::{Bounds, DeadTime, ErrorPoint, Finding, Unknown, Window};
use crate::experiment::Joint;
use crate::report::{EstimatedJoint, dead_time_sentences};

/// What an input is taken for, and what that was decided from.
#[derive(Debug, Serialize)]
pub(super) struct InputJson {
    kind: &'static str,
    changes: f64,
    held: f64,
    travel_in_steps: Option<f64>,
}

/// A dead time over the record; its numbers are missing where it is not known.
#[derive(Debug, Serialize)]
pub(super) struct DeadTimeJson<'a> {
    verdict: &'static str,
    value_s: Option<f64>,
    low_s: Option<f64>,
    high_s: Option<f64>,
    confidence: f64,
    reason: String,
    lag_s: Option<f64>,
    integrates: bool,
    explained: f64,
    feedback: FeedbackJson,
    same_in_all_p_value: Option<f64>,
    curve: Vec<PointJson>,
    windows: Vec<WindowJson<'a>>,
}

#[derive(Debug, Serialize)]
struct FeedbackJson {
    present: bool,
    p_value: f64,
    correlation: f64,
}

#[derive(Debug, Serialize)]
struct PointJson {
    delay_s: f64,
    error: f64,
}

#[derive(Debug, Serialize)]
struct WindowJson<'a> {
    trial: &'a str,
    first: usize,
    last: usize,
    start_s: Option<f64>,
    end_s: Option<f64>,
    value_s: Option<f64>,
    low_s: Option<f64>,
    high_s: Option<f64>,
}

impl InputJson {
    pub(super) fn of(joint: EstimatedJoint<'_>) -> Self {
        let motion = joint.estimate.motion;
        let is_continuous = joint.estimate.dead_time.is_some();
        Self {
            kind: if is_continuous { "continuous" } else { "steps" },
            changes: motion.changes,
            held: motion.held,
            travel_in_steps: motion.travel_in_steps,
        }
    }
}

impl<'a> DeadTimeJson<'a> {
    pub(super) fn of(joint: EstimatedJoint<'a>) -> Option<Self> {
        let found = joint.estimate.dead_time.as_ref()?;
        let [value_s, low_s, high_s] = numbers(found.bounds());
        let windows = found.windows.iter();
        Some(Self {
            verdict: verdict(found),
            value_s,
            low_s,
            high_s,
            confidence: found.confidence,
            reason: dead_time_sentences(&joint).join("; "),
            lag_s: found.lag_s,
            integrates: found.integrates,
            explained: found.explained,
            feedback: FeedbackJson {
                present: found.feedback.is_present(),
                p_value: found.feedback.p_value,
                correlation: found.feedback.largest,
            },
            same_in_all_p_value: found.same_in_all,
            curve: found.curve.iter().map(|point| PointJson::from(*point)).collect(),
            windows: windows.map(|window| WindowJson::of(joint.joint, window)).collect(),
        })
    }
}

fn verdict(found: &DeadTime) -> &'static str {
    match found.finding {
        Finding::Known(_) => "dead_time",
        Finding::LagOnly(_) => "lag_without_dead_time",
        Finding::Unknown(Unknown::TooShort) => "too_short",
        Finding::Unknown(Unknown::NotExplained) => "not_explained",
        Finding::Unknown(Unknown::OneFrequency(_)) => "one_frequency",
        Finding::Unknown(Unknown::TooLong(_)) => "too_long",
    }
}

fn numbers(bounds: Option<Bounds>) -> [Option<f64>; 3] {
    let part = |of: fn(Bounds) -> f64| bounds.map(of);
    [part(|b| b.value_s), part(|b| b.low_s), part(|b| b.high_s)]
}

impl From<ErrorPoint> for PointJson {
    fn from(ErrorPoint { delay_s, error }: ErrorPoint) -> Self {
        Self { delay_s, error }
    }
}

impl<'a> WindowJson<'a> {
    fn of(joint: &'a Joint, window: &Window) -> Self {
        let trial = joint.trials.get(window.trial);
        let time_s = |sample: usize| trial.map(|trial| trial.logged_time_s(sample));
        let [value_s, low_s, high_s] = numbers(window.estimate);
        Self {
            trial: trial.map_or("", |trial| trial.label()),
            first: window.first,
            last: window.last,
            start_s: time_s(window.first),
            end_s: time_s(window.last),
            value_s,
            low_s,
            high_s,
        }
    }
}
