//! Schema `tauscope/delay_lookup/1`.

use serde::Serialize;

use super::contents::{JointLookup, Lookup, side};
use crate::delay::{CurvePoint, DelayCurve};

#[derive(Serialize)]
struct LookupJson<'a> {
    schema: &'static str,
    origin: &'a [String],
    rule: &'static str,
    joints: Vec<JointJson<'a>>,
}

const RULE: &str = "side(u) is 1 above the neutral band, -1 below, 0 within; equal sides: change; \
                    from 0: start; to 0: stop; else reversal. Take the curve of this transition, \
                    of the side of level_to (of a stop: level_from) and of the direction; \
                    interpolate delay_s linearly over that level, clamped to its ends";

#[derive(Serialize)]
struct JointJson<'a> {
    joint: &'a str,
    input_unit: Option<&'a str>,
    /// None where it is not known: every side is 0.
    neutral: Option<(f64, f64)>,
    curves: Vec<CurveJson>,
}

#[derive(Serialize)]
struct CurveJson {
    transition: &'static str,
    side: i8,
    rises: bool,
    level: Vec<f64>,
    accepted: Vec<usize>,
    delay_s: Vec<f64>,
    delay_low_s: Vec<Option<f64>>,
    delay_high_s: Vec<Option<f64>>,
}

/// The whole file.
pub(super) fn source(lookup: &Lookup<'_>) -> serde_json::Result<String> {
    let document = LookupJson {
        schema: "tauscope/delay_lookup/1",
        origin: &lookup.origin,
        rule: RULE,
        joints: lookup.joints.iter().map(JointJson::new).collect(),
    };
    Ok(serde_json::to_string_pretty(&document)? + "\n")
}

impl<'a> JointJson<'a> {
    fn new(joint: &'a JointLookup<'_>) -> Self {
        Self {
            joint: joint.name,
            input_unit: joint.input_unit,
            neutral: joint.neutral.map(|neutral| (neutral.low, neutral.high)),
            curves: joint.curves.iter().map(CurveJson::new).collect(),
        }
    }
}

impl CurveJson {
    fn new(curve: &DelayCurve) -> Self {
        let points = &curve.points;
        let end = |which: fn((f64, f64)) -> f64| {
            let of = |point: &CurvePoint| point.delay.interval_s.map(which);
            points.iter().map(of).collect()
        };
        Self {
            transition: curve.transition.id(),
            side: side(curve.side),
            rises: curve.rises,
            level: points.iter().map(|point| point.level).collect(),
            accepted: points.iter().map(|point| point.accepted).collect(),
            delay_s: points.iter().map(|point| point.delay.median_s).collect(),
            delay_low_s: end(|(low, _)| low),
            delay_high_s: end(|(_, high)| high),
        }
    }
}
