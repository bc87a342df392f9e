//! Schema `tauscope/delay_lookup/1`.

use serde_json::{Value, json};

use super::contents::{JointLookup, Lookup, side};
use crate::delay::{CurvePoint, DelayCurve};

const RULE: &str = "side(u) is 1 above the neutral band, -1 below, 0 within; equal sides: change; \
                    from 0: start; to 0: stop; else reversal. Take the curve of this transition, \
                    of the side of level_to (of a stop: level_from) and of the direction; \
                    interpolate delay_s linearly over that level, clamped to its ends";

/// The whole file; `neutral` is `null` where it is not known, and every side is 0.
pub(super) fn source(lookup: &Lookup<'_>) -> serde_json::Result<String> {
    let joint = |joint: &JointLookup<'_>| {
        json!({
            "joint": joint.name,
            "input_unit": joint.input_unit,
            "neutral": joint.neutral.map(|neutral| (neutral.low, neutral.high)),
            "curves": joint.curves.iter().map(curve).collect::<Value>(),
        })
    };
    let document = json!({
        "schema": "tauscope/delay_lookup/1",
        "origin": lookup.origin,
        "rule": RULE,
        "joints": lookup.joints.iter().map(joint).collect::<Value>(),
    });
    Ok(serde_json::to_string_pretty(&document)? + "\n")
}

fn curve(curve: &DelayCurve) -> Value {
    let points = || curve.points.iter();
    let end = |which: fn((f64, f64)) -> f64| {
        let of = |point: &CurvePoint| point.delay.interval_s.map(which);
        points().map(of).collect::<Vec<_>>()
    };
    json!({
        "transition": curve.transition,
        "side": side(curve.side),
        "rises": curve.rises,
        "level": points().map(|point| point.level).collect::<Vec<_>>(),
        "accepted": points().map(|point| point.accepted).collect::<Vec<_>>(),
        "delay_s": points().map(|point| point.delay.median_s).collect::<Vec<_>>(),
        "delay_low_s": end(|(low, _)| low),
        "delay_high_s": end(|(_, high)| high),
    })
}
