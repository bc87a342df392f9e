//! Effects on a held level of the input.
//!
//! Corners are rounded over an edge, a small part of the largest level; `ramp` is a rounded
//! `max(x, 0)`.

use super::shapes::{ramp, rise, window};
use super::twin::Stage::Valve;
use super::twin::{LARGEST_LEVEL, Twin, rises};
use crate::error::{FINITE, NOT_NEGATIVE, NOT_POSITIVE, POSITIVE, SHARE, TWO_OR_MORE};

/// The valve is open a little at zero input: `u + offset`.
pub(super) static INPUT_OFFSET: Twin = Twin {
    act: |&[offset, ..], u, _, _, _| u + offset,
    drawn: |draw| vec![draw.sign(0) * draw.strength],
    ..Twin::new("input_offset", Valve, &["offset"], &[FINITE])
};

/// No flow between two levels, `lower` ≤ 0 ≤ `upper`: `ramp(u - upper) - ramp(lower - u)`.
pub(super) static DEAD_BAND: Twin = Twin {
    act: |&[lower, upper, ..], u, at, _, _| ramp(u - upper, at.edge) - ramp(lower - u, at.edge),
    drawn: |draw| {
        let end = |index| 1.5 * draw.strength * draw.between(index, 0.6, 1.0);
        vec![-end(0), end(1)]
    },
    ..Twin::new("dead_band", Valve, &["lower", "upper"], &[NOT_POSITIVE, NOT_NEGATIVE])
};

/// A flow that grows with a power of the opening; 1 is a straight line:
/// `u ((u² + e²) / (1 + e²))^((exponent - 1) / 2)`, e: the edge.
pub(super) static FLOW_CURVE: Twin = Twin {
    act: |&[exponent, ..], u, at, _, _| {
        let square = at.edge * at.edge;
        u * ((u * u + square) / (1.0 + square)).powf(0.5 * (exponent - 1.0))
    },
    drawn: |draw| vec![(draw.sign(0) * draw.strength).exp()],
    ..Twin::new("flow_curve", Valve, &["exponent"], &[POSITIVE])
};

/// Speed for a negative input over that for a positive one:
/// `u (1 + (negative_factor - 1) rise(-u))`.
pub(super) static DIRECTION_GAIN: Twin = Twin {
    act: |&[factor, ..], u, at, _, _| u * (1.0 + (factor - 1.0) * rise(-u, at.edge)),
    drawn: |draw| vec![(draw.sign(0) * draw.strength).exp()],
    ..Twin::new("direction_gain", Valve, &["negative_factor"], &[POSITIVE])
};

/// Not in the catalogue: a worn land passes the part `share` in a range of the input.
pub(super) static INPUT_NOTCH: Twin = Twin {
    related: rises,
    act: |&[from, to, share, ..], u, at, _, _| {
        u * (1.0 - (1.0 - share) * window(u, from, to, at.edge))
    },
    // Around one of the levels between the largest and the smallest, of either sign.
    drawn: |draw| {
        let middle = draw.sign(0) * draw.between(1, 0.9, 1.5);
        vec![middle - 0.35, middle + 0.35, 1.0 - draw.strength]
    },
    ..Twin::new("input_notch", Valve, &["from", "to", "share"], &[FINITE, FINITE, SHARE])
};

/// The flow ends at a limit: `u (1 + abs(u / limit)^p)^(-1/p)`.
///
/// At the limit `2^(-1/p)` of it is passed, with the sharpness p.
pub(super) static INPUT_SATURATION: Twin = Twin {
    optional: &[HARD],
    act: |&[limit, sharpness, ..], u, _, _, _| limited(u, limit, sharpness),
    // Where the corners of the valve are rounded, this one is as a rule, too.
    drawn: |draw| {
        let sharp = HARD * (0.004 / draw.valve_edge).sqrt();
        vec![drawn_limit(draw.strength), if draw.sign(0) > 0.0 { sharp } else { SOFT }]
    },
    ..Twin::new("input_saturation", Valve, &["limit", "sharpness"], &[POSITIVE, TWO_OR_MORE])
};

/// The flow ends at another limit in each direction; `negative_ratio` is the negative one over the
/// positive one.
pub(super) static ASYMMETRIC_SATURATION: Twin = Twin {
    instead_of: Some("input_saturation"),
    optional: &[HARD],
    act: |&[limit, ratio, sharpness, ..], u, _, _, _| {
        limited(u, if u < 0.0 { ratio * limit } else { limit }, sharpness)
    },
    // The limits differ by a quarter or more.
    drawn: |draw| {
        let apart = draw.between(1, 1.25, 1.6);
        let ratio = if draw.sign(2) > 0.0 { apart } else { apart.recip() };
        vec![drawn_limit(draw.strength), ratio, if draw.sign(0) > 0.0 { HARD } else { SOFT }]
    },
    ..Twin::new(
        "asymmetric_saturation",
        Valve,
        &["limit", "negative_ratio", "sharpness"],
        &[POSITIVE, POSITIVE, TWO_OR_MORE],
    )
};

/// Sharpness of a saturation with a hard corner, within 2 % of the limit, and of a soft one.
const HARD: f64 = 40.0;
const SOFT: f64 = 8.0;

fn drawn_limit(strength: f64) -> f64 {
    LARGEST_LEVEL * (1.05 - 0.95 * strength)
}

fn limited(u: f64, limit: f64, power: f64) -> f64 {
    let ratio = u.abs() / limit;
    if ratio <= 1.0 {
        return u * (1.0 + ratio.powf(power)).powf(-1.0 / power);
    }
    // Multiplied out, so that no power overflows.
    (limit * (1.0 + ratio.powf(-power)).powf(-1.0 / power)).copysign(u)
}
